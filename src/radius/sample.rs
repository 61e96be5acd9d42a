//! Skeletons for the tests of this crate's measures.

use glam::Vec3;
use proptest::prelude::*;

use crate::{Skeleton, SkeletonError};

/// A stem of 1 m and two arms.
pub(crate) fn y_fork() -> Result<Skeleton, SkeletonError> {
    Skeleton::new(
        vec![Vec3::ZERO, Vec3::Y, Vec3::new(-0.5, 1.8, 0.0), Vec3::new(0.5, 1.8, 0.0)],
        vec![None, Some(0), Some(1), Some(1)],
    )
}

/// `nodes` nodes one above the other, 1 cm apart.
pub(crate) fn chain(nodes: u32) -> Result<Skeleton, SkeletonError> {
    Skeleton::new(
        (0..nodes).map(|i| Vec3::Y * (0.01 * i as f32)).collect(),
        (0..nodes).map(|i| i.checked_sub(1)).collect(),
    )
}

/// Node i has the children 2i + 1 and 2i + 2; `depth` levels.
pub(crate) fn binary(depth: u32) -> Result<Skeleton, SkeletonError> {
    let nodes = (1u32 << depth) - 1;
    Skeleton::new(
        (0..nodes).map(|i| Vec3::new((i % 7) as f32, (i + 1).ilog2() as f32, (i % 3) as f32)).collect(),
        (0..nodes).map(|i| i.checked_sub(1).map(|i| i / 2)).collect(),
    )
}

/// A skeleton of up to 120 nodes at places on a coarse lattice, so that some coincide; each parent any
/// earlier node, or, in half of the cases, one of the last three, which gives long branches.
pub(crate) fn any_skeleton() -> impl Strategy<Value = Skeleton> {
    let node = (prop::array::uniform3(-20i8..20), any::<prop::sample::Index>());
    (prop::collection::vec(node, 1..120), any::<bool>()).prop_map(|(nodes, long)| {
        let positions = nodes.iter().map(|(p, _)| Vec3::from_array(p.map(|c| f32::from(c) * 0.1))).collect();
        let parents = nodes
            .iter()
            .enumerate()
            .map(|(i, (_, parent))| {
                let first = if long { i.saturating_sub(3) } else { 0 };
                (i > 0).then(|| (first + parent.index(i - first)) as u32)
            })
            .collect();
        Skeleton::new(positions, parents).expect("parents come first, positions are finite")
    })
}
