//! Skeletons that try the surfaces.

use crate::{Skeleton, math};
use glam::Vec3;
use proptest::prelude::*;

prop_compose! {
    /// Chains and forks of up to `most` nodes, some without length, some that turn back to the root, some radii zero;
    /// the others from the scale of the internodes, 1e-6 to 10 to the power of `largest`, and a number of 0 to 1.
    pub(super) fn any_skeleton(most: usize, largest: f32, radius: fn(f32, f32) -> f32)(
        nodes in prop::collection::vec((any::<prop::sample::Index>(), -1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0,
            0.0f32..1.0, 0u8..10), 1..most),
        scale in -6.0..largest,
    ) -> Skeleton {
        let scale = math::powf(10.0, scale);
        let mut points: Vec<Vec3> = Vec::new();
        let (mut parents, mut radii) = (Vec::new(), Vec::new());
        for (i, (parent, x, y, z, part, kind)) in nodes.into_iter().enumerate() {
            let parent = (i > 0).then(|| if kind < 5 { i - 1 } else { parent.index(i) });
            let from = parent.map_or(Vec3::ZERO, |p| points[p]);
            points.push(match kind {
                0 => from,
                1 => points.first().copied().unwrap_or_default(),
                _ => from + Vec3::new(x, y, z) * scale,
            });
            parents.push(parent.map(|p| p as u32));
            radii.push(if kind == 2 { 0.0 } else { radius(scale, part) });
        }
        Skeleton::new(points, parents).and_then(|s| s.with_radii(radii)).expect("made to be sound")
    }
}
