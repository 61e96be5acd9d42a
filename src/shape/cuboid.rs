//! The axis-aligned box as a region to grow in.

use glam::Vec3;

use super::{Bounds, SMALLEST, Shape, check_position, draw_inside, unit_cube};
use crate::ParameterError;

/// A box with faces parallel to the axes: the cubic volume of the paper's figure 18.
///
/// ```
/// use treesynth::{Shape, glam::Vec3, shape::Cuboid};
///
/// let crown = Cuboid::centered(Vec3::new(0.0, 4.0, 0.0), Vec3::splat(3.0));
/// assert!(crown.contains(Vec3::new(1.5, 2.5, -1.5)));
/// assert_eq!(crown.volume(), 27.0);
/// assert!(Cuboid::new(Vec3::ONE, Vec3::ZERO).check().is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Cuboid {
    min: Vec3,
    max: Vec3,
}

impl Cuboid {
    /// The box between the corner with the smallest coordinates and the one with the largest, metres.
    ///
    /// Coordinates at most 1e6 from 0; `max` above `min` by at least 1e-6 on every axis. For a planar tree
    /// any depth around z = 0 will do.
    pub const fn new(min: Vec3, max: Vec3) -> Self {
        Self { min, max }
    }

    /// The box of the given width, height and depth around `center`, metres.
    pub fn centered(center: Vec3, size: Vec3) -> Self {
        Self::new(center - size * 0.5, center + size * 0.5)
    }

    /// The corner with the smallest coordinates, metres.
    pub const fn min(&self) -> Vec3 {
        self.min
    }

    /// The corner with the largest coordinates, metres.
    pub const fn max(&self) -> Vec3 {
        self.max
    }
}

impl From<Bounds> for Cuboid {
    fn from(bounds: Bounds) -> Self {
        Self::new(bounds.min, bounds.max)
    }
}

impl Shape for Cuboid {
    fn contains(&self, point: Vec3) -> bool {
        self.bounds().contains(point)
    }

    fn bounds(&self) -> Bounds {
        Bounds::new(self.min, self.max)
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_position("Cuboid.min", self.min)?;
        check_position("Cuboid.max", self.max)?;
        ParameterError::unless(
            Vec3::splat(SMALLEST).cmple(self.max - self.min).all(),
            "Cuboid.max",
            self.max,
            "above Cuboid.min by at least 1e-6 metres on every axis",
        )
    }

    fn volume(&self) -> f32 {
        if self.check().is_ok() { self.bounds().volume() } else { 0.0 }
    }

    fn sample(&self, random: &mut dyn rand::Rng) -> Option<Vec3> {
        self.check().ok()?;
        draw_inside(self, || self.bounds().at(unit_cube(random)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_belong_to_it() {
        let cuboid = Cuboid::new(Vec3::new(-1.0, 0.0, 2.0), Vec3::new(1.0, 3.0, 4.0));
        for point in [cuboid.min(), cuboid.max(), Vec3::new(0.0, 0.0, 3.0)] {
            assert!(cuboid.contains(point), "{point}");
        }
        for point in [Vec3::new(1.001, 1.0, 3.0), Vec3::new(0.0, -0.001, 3.0), Vec3::NAN, Vec3::INFINITY] {
            assert!(!cuboid.contains(point), "{point}");
        }
        assert_eq!(cuboid, cuboid.bounds().into());
    }

    #[test]
    fn infinite_box_holds_no_infinite_point() {
        let all = Cuboid::new(Vec3::NEG_INFINITY, Vec3::INFINITY);
        assert!(all.check().is_err() && !all.contains(Vec3::INFINITY));
    }
}
