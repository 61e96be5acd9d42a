//! Round shapes: the sphere, the ellipsoid and its upper half.

use std::f32::consts::{PI, TAU};

use glam::Vec3;
use rand::RngExt;

use super::{Bounds, Shape, check_length, check_lengths, check_position, draw_inside};
use crate::{ParameterError, math};

/// A ball.
///
/// ```
/// use treesynth::{Shape, glam::Vec3, shape::Sphere};
///
/// let crown = Sphere::new(Vec3::new(0.0, 5.0, 0.0), 2.0);
/// assert!(crown.contains(Vec3::new(0.0, 7.0, 0.0)));
/// assert!((crown.volume() - 33.51).abs() < 0.01);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Sphere {
    center: Vec3,
    radius: f32,
}

impl Sphere {
    /// The ball of `radius` metres, from 1e-6 to 1e6, around `center`, metres, at most 1e6 from 0 on each axis.
    pub const fn new(center: Vec3, radius: f32) -> Self {
        Self { center, radius }
    }

    /// The middle, metres.
    pub const fn center(&self) -> Vec3 {
        self.center
    }

    /// The radius, metres.
    pub const fn radius(&self) -> f32 {
        self.radius
    }

    const fn ellipsoid(self) -> Ellipsoid {
        Ellipsoid::new(self.center, Vec3::splat(self.radius))
    }
}

impl Shape for Sphere {
    fn contains(&self, point: Vec3) -> bool {
        self.ellipsoid().contains(point)
    }

    fn bounds(&self) -> Bounds {
        self.ellipsoid().bounds()
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_position("Sphere.center", self.center)?;
        check_length("Sphere.radius", self.radius)
    }

    fn volume(&self) -> f32 {
        self.ellipsoid().volume()
    }

    fn sample(&self, random: &mut dyn rand::Rng) -> Option<Vec3> {
        self.ellipsoid().sample(random)
    }
}

/// An ellipsoid with axes parallel to the coordinate axes: the crowns of the paper's figure 10.
///
/// ```
/// use treesynth::{Shape, glam::Vec3, shape::Ellipsoid};
///
/// let crown = Ellipsoid::new(Vec3::new(0.0, 6.0, 0.0), Vec3::new(2.0, 3.0, 2.0));
/// assert_eq!(crown.bounds().size(), Vec3::new(4.0, 6.0, 4.0));
/// assert!(!crown.contains(Vec3::new(1.9, 8.9, 0.0)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Ellipsoid {
    center: Vec3,
    radii: Vec3,
}

impl Ellipsoid {
    /// The ellipsoid around `center`, metres, at most 1e6 from 0 on each axis, that reaches `radii` metres,
    /// from 1e-6 to 1e6, to each side.
    pub const fn new(center: Vec3, radii: Vec3) -> Self {
        Self { center, radii }
    }

    /// The middle, metres.
    pub const fn center(&self) -> Vec3 {
        self.center
    }

    /// Half the width, height and depth, metres.
    pub const fn radii(&self) -> Vec3 {
        self.radii
    }
}

impl Shape for Ellipsoid {
    fn contains(&self, point: Vec3) -> bool {
        // The bounds come first since rounding could put a point of the surface outside them.
        self.bounds().contains(point) && ((point - self.center) / self.radii).length_squared() <= 1.0
    }

    fn bounds(&self) -> Bounds {
        Bounds::around(self.center, self.radii)
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_position("Ellipsoid.center", self.center)?;
        check_lengths("Ellipsoid.radii", self.radii)
    }

    fn volume(&self) -> f32 {
        if self.check().is_ok() { 4.0 / 3.0 * PI * self.radii.element_product() } else { 0.0 }
    }

    fn sample(&self, random: &mut dyn rand::Rng) -> Option<Vec3> {
        self.check().ok()?;
        draw_inside(self, || self.center + self.radii * unit_ball(random))
    }
}

/// The upper half of an ellipsoid, standing on its flat side: the volume that the paper recommends (section
/// 3.2.2) and varies in its figure 16.
///
/// ```
/// use treesynth::{Shape, glam::Vec3, shape::HalfEllipsoid};
///
/// // Figure 16, second from the left: 0.9 times as high as wide.
/// let crown = HalfEllipsoid::with_aspect(Vec3::new(0.0, 2.0, 0.0), 9.0, 0.9);
/// assert_eq!(crown.bounds().size(), Vec3::new(10.0, 9.0, 10.0));
/// assert!(crown.contains(Vec3::new(0.0, 2.0, 5.0)) && !crown.contains(Vec3::new(0.0, 1.9, 0.0)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct HalfEllipsoid {
    base_center: Vec3,
    radii: Vec3,
}

impl HalfEllipsoid {
    /// The half ellipsoid on the flat side around `base_center`, metres, at most 1e6 from 0 on each axis.
    ///
    /// It reaches `radii.x` and `radii.z` to each side and `radii.y`, its whole height, upwards; all from
    /// 1e-6 to 1e6 metres.
    pub const fn new(base_center: Vec3, radii: Vec3) -> Self {
        Self { base_center, radii }
    }

    /// The round half ellipsoid of `height` metres on the flat side around `base_center`, whose height
    /// divided by its width, the diameter of the flat side, is `aspect`.
    ///
    /// The paper's figure 16 has the aspect ratios 1.5, 0.9, 0.5 and 0.3, from slender to broad; 0.5 is half
    /// a ball. Both numbers must be positive, and [`radii`](Self::radii) that come from them within the limits.
    pub fn with_aspect(base_center: Vec3, height: f32, aspect: f32) -> Self {
        let radius = height / aspect * 0.5;
        Self::new(base_center, Vec3::new(radius, height, radius))
    }

    /// The middle of the flat side, metres.
    pub const fn base_center(&self) -> Vec3 {
        self.base_center
    }

    /// Half the width, the whole height, half the depth, metres.
    pub const fn radii(&self) -> Vec3 {
        self.radii
    }
}

impl Shape for HalfEllipsoid {
    fn contains(&self, point: Vec3) -> bool {
        self.bounds().contains(point) && ((point - self.base_center) / self.radii).length_squared() <= 1.0
    }

    fn bounds(&self) -> Bounds {
        let sideways = self.radii.with_y(0.0);
        Bounds::new(self.base_center - sideways, self.base_center + self.radii)
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_position("HalfEllipsoid.base_center", self.base_center)?;
        check_lengths("HalfEllipsoid.radii", self.radii)
    }

    fn volume(&self) -> f32 {
        if self.check().is_ok() { 2.0 / 3.0 * PI * self.radii.element_product() } else { 0.0 }
    }

    fn sample(&self, random: &mut dyn rand::Rng) -> Option<Vec3> {
        self.check().ok()?;
        draw_inside(self, || {
            let point = unit_ball(random);
            self.base_center + self.radii * point.with_y(point.y.abs())
        })
    }
}

/// Uniform in the ball of radius 1: by Archimedes, the height of a point on the sphere is uniform.
fn unit_ball(random: &mut dyn rand::Rng) -> Vec3 {
    let y = random.random::<f32>() * 2.0 - 1.0;
    let (sin, cos) = math::sin_cos(random.random::<f32>() * TAU);
    let around = (1.0 - y * y).sqrt();
    Vec3::new(around * cos, y, around * sin) * math::cbrt(random.random())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_belong_to_them() {
        let sphere = Sphere::new(Vec3::new(1.0, 2.0, 3.0), 2.0);
        let ellipsoid = Ellipsoid::new(Vec3::ZERO, Vec3::new(1.0, 2.0, 4.0));
        let half = HalfEllipsoid::new(Vec3::Y, Vec3::new(1.0, 2.0, 4.0));
        assert!(sphere.contains(Vec3::new(3.0, 2.0, 3.0)) && !sphere.contains(Vec3::new(2.5, 3.5, 3.0)));
        assert!(
            ellipsoid.contains(Vec3::new(0.0, -2.0, 0.0)) && !ellipsoid.contains(Vec3::new(0.9, 1.8, 0.0))
        );
        for point in [Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::new(0.0, 3.0, 0.0), Vec3::new(0.0, 1.0, -4.0)]
        {
            assert!(half.contains(point), "{point}");
        }
        assert!(!half.contains(Vec3::new(0.0, 0.999, 0.0)) && !half.contains(Vec3::new(0.9, 2.8, 0.0)));
        assert!(!half.contains(Vec3::NAN));
    }

    #[test]
    fn aspect_is_height_over_width() {
        for aspect in [1.5, 0.9, 0.5, 0.3] {
            let size = HalfEllipsoid::with_aspect(Vec3::ZERO, 10.0, aspect).bounds().size();
            assert!((size.y / size.x - aspect).abs() < 1e-6 && (size.z - size.x).abs() < 1e-6);
        }
        for aspect in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(HalfEllipsoid::with_aspect(Vec3::ZERO, 10.0, aspect).check().is_err(), "{aspect}");
        }
    }

    #[test]
    fn ball_is_uniform() {
        let mut random = crate::random::stream(3, 0, crate::random::Purpose::CUSTOM, 0);
        let points: Vec<_> = (0..20_000).map(|_| unit_ball(&mut random)).collect();
        let share = |test: fn(Vec3) -> bool| {
            points.iter().filter(|&&point| test(point)).count() as f32 / points.len() as f32
        };
        assert!((share(|p| p.length() < 0.5) - 0.125).abs() < 0.01);
        assert!((share(|p| p.x > 0.5) - 0.156_25).abs() < 0.01, "a cap is 5/32 of the ball");
        assert!((share(|p| p.y > 0.5) - 0.156_25).abs() < 0.01);
        assert!((share(|p| p.z < 0.0) - 0.5).abs() < 0.015);
    }
}
