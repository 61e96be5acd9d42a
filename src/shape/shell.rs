//! The rind of a shape.

use glam::Vec3;

use super::{Bounds, Shape, check_position};
use crate::ParameterError;

/// Shape without a smaller copy of itself: the outer shell, where the twigs and the light are.
///
/// The copy is shrunk towards a point by a fraction. The point is the middle of the shape's bounds unless
/// [`about`](Self::about) names another: for a shape that stands on its base, such as
/// [`HalfEllipsoid`](super::HalfEllipsoid) or [`Cone`](super::Cone), shrinking about the middle of the base
/// leaves the dome open below, as crowns are.
///
/// The copy's surface is not part of the shell. [`volume`](Shape::volume) is the default estimate.
///
/// ```
/// use treesynth::{Shape, glam::Vec3, shape::{HalfEllipsoid, Shell}};
///
/// let crown = HalfEllipsoid::new(Vec3::new(0.0, 2.0, 0.0), Vec3::splat(4.0));
/// let dome = Shell::new(crown, 0.25).about(crown.base_center());
/// assert!(dome.contains(Vec3::new(0.0, 5.5, 0.0)));
/// assert!(!dome.contains(Vec3::new(0.0, 2.1, 0.0)), "open below");
/// assert!(Shell::new(crown, 0.25).contains(Vec3::new(0.0, 2.1, 0.0)), "closed below");
/// ```
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Shell<S> {
    shape: S,
    thickness: f32,
    about: Vec3,
}

crate::recipe::mapped!(Shell { shape; thickness, about });

impl<S: Shape> Shell<S> {
    /// The outermost `thickness` of `shape`, a fraction of the way to the middle of its bounds: from 0.001,
    /// below which sampling is hopeless, to 1, which is all of the shape.
    pub fn new(shape: S, thickness: f32) -> Self {
        let about = shape.bounds().center();
        Self { shape, thickness, about }
    }

    /// Shrinks the copy towards `point` (metres, at most 1e6 from 0 on each axis) instead.
    ///
    /// A point outside the shape is allowed and gives a shell that is thicker on one side.
    pub fn about(mut self, point: Vec3) -> Self {
        self.about = point;
        self
    }
}

impl<S> Shell<S> {
    /// The shape of which this is the rind.
    pub const fn shape(&self) -> &S {
        &self.shape
    }
}

impl<S: Shape> Shape for Shell<S> {
    fn contains(&self, point: Vec3) -> bool {
        let outwards = self.about + (point - self.about) / (1.0 - self.thickness);
        self.shape.contains(point) && !self.shape.contains(outwards)
    }

    fn bounds(&self) -> Bounds {
        self.shape.bounds()
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.shape.check()?;
        check_position("Shell.about", self.about)?;
        ParameterError::unless(
            (0.001..=1.0).contains(&self.thickness),
            "Shell.thickness",
            self.thickness,
            "a fraction from 0.001 to 1",
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Cone, Sphere};

    #[test]
    fn sphere_has_a_hole() {
        let shell = Shell::new(Sphere::new(Vec3::ONE, 2.0), 0.5);
        assert!(!shell.contains(Vec3::new(1.9, 1.0, 1.0)));
        assert!(shell.contains(Vec3::new(2.1, 1.0, 1.0)) && shell.contains(Vec3::new(3.0, 1.0, 1.0)));
        let exact = shell.shape().volume() * 7.0 / 8.0;
        assert!((shell.volume() / exact - 1.0).abs() < 0.02, "{} {exact}", shell.volume());
    }

    #[test]
    fn whole_and_thinnest() {
        let sphere = Sphere::new(Vec3::ZERO, 1.0);
        let whole = Shell::new(sphere, 1.0);
        assert!(whole.check().is_ok() && whole.contains(Vec3::ZERO) && whole.contains(Vec3::X * 0.01));
        let thin = Shell::new(Cone::new(Vec3::ZERO, 1.0, 5.0), 0.001);
        let mut random = crate::random::stream(5, 0, crate::random::Purpose::CUSTOM, 0);
        assert!(thin.check().is_ok());
        assert!((0..20).all(|_| thin.sample(&mut random).is_some_and(|point| thin.contains(point))));
    }

    #[test]
    fn names_its_parameters() {
        let sphere = Sphere::new(Vec3::ZERO, 1.0);
        for thickness in [0.0, -0.5, 1.5, f32::NAN, f32::INFINITY] {
            let error = Shell::new(sphere, thickness).check().unwrap_err();
            assert_eq!(error.parameter, "Shell.thickness");
        }
        assert_eq!(Shell::new(sphere, 0.5).about(Vec3::NAN).check().unwrap_err().parameter, "Shell.about");
        let inner = Shell::new(Sphere::new(Vec3::ZERO, -1.0), 0.5).check().unwrap_err();
        assert_eq!(inner.parameter, "Sphere.radius");
    }
}
