//! The interface of an implicit surface for polygonizers and ray casters.

use super::span::{Passage, Span};
use crate::Bounds;
use glam::Vec3;

/// A solid bounded by an implicit surface: its value is 0 on the surface, above 0 inside, below 0 outside.
///
/// A solid is never evaluated as a whole. It gives the [part](Solid::part) of it that counts within a cube,
/// then the part of that within a smaller cube, and so on down an octree. Parts are evaluated.
pub(crate) trait Solid: Sync {
    /// Part of it that counts within a cube.
    type Part: Part;

    /// A box that holds every point whose value is not negative.
    fn bounds(&self) -> Bounds;

    /// Part that counts within a cube, of the whole or of the part that counted within a larger cube around it.
    fn part(&self, of: Option<&Self::Part>, cube: Bounds) -> Coverage<Self::Part>;
}

/// Knowledge of all points of a cube.
#[derive(Debug)]
pub(crate) enum Coverage<P> {
    /// All values are below 0.
    Outside,
    /// All values are above 0.
    Inside,
    /// Perhaps both.
    Crossed(P),
}

/// Number of primitives or operators that are as much work as one more cube.
pub(crate) const CROWD: usize = 32;

/// Part of a [`Solid`] that counts within a cube: there its values and gradients are the whole's, to the bit.
pub(crate) trait Part: Send + Sync {
    /// The value at a point of the cube.
    fn value(&self, point: Vec3) -> f32;

    /// The value and its gradient, per metre, at a point of the cube. The gradient has length 0 only where
    /// there is none.
    fn gradient(&self, point: Vec3) -> (f32, Vec3);

    /// The values at 4 · 4 · 4 points of the cube: entry `x + 4y + 16z` is that of the point x, y and z steps
    /// of `step` metres along the axes from `start`.
    fn sample(&self, start: Vec3, step: f32) -> [f32; 64] {
        std::array::from_fn(|i| {
            let offset = Vec3::new((i & 3) as f32, (i >> 2 & 3) as f32, (i >> 4) as f32);
            self.value(start + offset * step)
        })
    }

    /// The places of a passage within the cube between which its values may be 0 or above; `None` if there
    /// are none.
    #[cfg_attr(not(feature = "preview"), allow(dead_code, reason = "only rays ask"))]
    fn span(&self, passage: &Passage) -> Option<Span> {
        Some((0.0, passage.length))
    }

    /// The linear RGB colour at a point on the surface.
    fn color(&self, point: Vec3) -> [f32; 3];

    /// The longest voxel, in metres, that shows the finest feature within the cube.
    fn detail(&self) -> f32;

    /// The number of primitives and operators that count: time and memory of a cube grow with it.
    fn count(&self) -> usize {
        1
    }

    /// No value within the cube changes by more than this per metre.
    fn lipschitz(&self) -> f32;
}
