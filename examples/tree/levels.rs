//! The tree in levels of detail, each of at most half the triangles of the one before.

use super::common::Failure;
use super::options::{Options, Surface};
use treesynth::Skeleton;
use treesynth::foliage::Leaves;
use treesynth::surface::{Implicit, Instance, Levels, Mesh, Part, Tubes};

/// 2^32 over the golden ratio: multiples of it leave any share of a row evenly spread.
const SPREAD: u32 = 0x9e37_79b9;

/// The bark of each level, finest first.
pub(crate) fn barks(options: &Options, skeleton: &Skeleton) -> Result<Vec<Mesh>, Failure> {
    Ok(match options.surface {
        Surface::Tubes if options.levels > 1 => {
            let levels = Levels::default().with_count(options.levels).of(skeleton)?;
            levels.into_iter().map(|level| level.mesh).collect()
        }
        Surface::Tubes => vec![Tubes::default().mesh(skeleton)?],
        Surface::Implicit => vec![Implicit::default().with_detail(options.detail).mesh(skeleton)?],
    })
}

/// The leaves of the level after so many others: half as many a level, each of twice the area, so that the crown stays
/// as dense (Cook et al. 2007). Those of a level are among those of the level before.
pub(crate) fn thinned(leaves: &Leaves, level: usize) -> Vec<Instance> {
    let mut order: Vec<usize> = (0..leaves.instances.len()).collect();
    if level > 0 {
        order.sort_by_key(|&leaf| (leaf as u32).wrapping_mul(SPREAD));
        order.truncate(leaves.instances.len() >> level);
        order.sort_unstable();
    }
    let larger = ((1u32 << level) as f32).sqrt();
    order
        .into_iter()
        .map(|leaf| {
            let instance = leaves.instances[leaf];
            Instance { scale: instance.scale * larger, ..instance }
        })
        .collect()
}

/// Triangles of a level, all copies counted.
pub(crate) fn triangles(level: &[Part<'_>]) -> u64 {
    level.iter().map(Part::triangles).sum()
}
