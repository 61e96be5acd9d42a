//! Shapes that stand on a disc: the cone and the cylinder.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3, Vec3Swizzles};
use rand::RngExt;

use super::{Bounds, Shape, check_length, check_position, draw_inside};
use crate::{ParameterError, math};

/// An upright cone, apex up: the crown of a conifer.
///
/// ```
/// use treesynth::{Shape, glam::Vec3, shape::Cone};
///
/// let spruce = Cone::new(Vec3::Y, 2.0, 8.0);
/// assert!(spruce.contains(Vec3::new(0.0, 9.0, 0.0)) && spruce.contains(Vec3::new(1.0, 5.0, 0.0)));
/// assert!(!spruce.contains(Vec3::new(1.1, 5.0, 0.0)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Cone {
    base_center: Vec3,
    radius: f32,
    height: f32,
}

impl Cone {
    /// The cone on the disc of `radius` metres around `base_center`, with its apex `height` metres above.
    ///
    /// Lengths from 1e-6 to 1e6, coordinates at most 1e6 from 0.
    pub const fn new(base_center: Vec3, radius: f32, height: f32) -> Self {
        Self { base_center, radius, height }
    }

    /// The middle of the disc it stands on, metres.
    pub const fn base_center(&self) -> Vec3 {
        self.base_center
    }

    /// Radius of the disc it stands on, metres.
    pub const fn radius(&self) -> f32 {
        self.radius
    }

    /// Height of the apex above the disc, metres.
    pub const fn height(&self) -> f32 {
        self.height
    }
}

impl Shape for Cone {
    fn contains(&self, point: Vec3) -> bool {
        let offset = point - self.base_center;
        let below_apex = 1.0 - offset.y / self.height;
        self.bounds().contains(point)
            && (offset.xz() / self.radius).length_squared() <= below_apex * below_apex
    }

    fn bounds(&self) -> Bounds {
        standing(self.base_center, self.radius, self.height)
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_position("Cone.base_center", self.base_center)?;
        check_length("Cone.radius", self.radius)?;
        check_length("Cone.height", self.height)
    }

    fn volume(&self) -> f32 {
        if self.check().is_ok() { PI / 3.0 * self.radius * self.radius * self.height } else { 0.0 }
    }

    fn sample(&self, random: &mut dyn rand::Rng) -> Option<Vec3> {
        self.check().ok()?;
        draw_inside(self, || {
            let below_apex = math::cbrt(random.random());
            let disc = unit_disc(random) * (self.radius * below_apex);
            self.base_center + Vec3::new(disc.x, self.height * (1.0 - below_apex), disc.y)
        })
    }
}

/// An upright cylinder: a columnar crown, or with [`Shell`](super::Shell) the wall around one.
///
/// ```
/// use treesynth::{Shape, glam::Vec3, shape::Cylinder};
///
/// let poplar = Cylinder::new(Vec3::Y, 1.0, 12.0);
/// assert!((poplar.volume() - 37.7).abs() < 0.01);
/// assert_eq!(poplar.bounds().max, Vec3::new(1.0, 13.0, 1.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Cylinder {
    base_center: Vec3,
    radius: f32,
    height: f32,
}

impl Cylinder {
    /// The cylinder `height` metres high on the disc of `radius` metres around `base_center`.
    ///
    /// Lengths from 1e-6 to 1e6, coordinates at most 1e6 from 0.
    pub const fn new(base_center: Vec3, radius: f32, height: f32) -> Self {
        Self { base_center, radius, height }
    }

    /// The middle of the disc it stands on, metres.
    pub const fn base_center(&self) -> Vec3 {
        self.base_center
    }

    /// Radius, metres.
    pub const fn radius(&self) -> f32 {
        self.radius
    }

    /// Height, metres.
    pub const fn height(&self) -> f32 {
        self.height
    }
}

impl Shape for Cylinder {
    fn contains(&self, point: Vec3) -> bool {
        let offset = point - self.base_center;
        self.bounds().contains(point) && (offset.xz() / self.radius).length_squared() <= 1.0
    }

    fn bounds(&self) -> Bounds {
        standing(self.base_center, self.radius, self.height)
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_position("Cylinder.base_center", self.base_center)?;
        check_length("Cylinder.radius", self.radius)?;
        check_length("Cylinder.height", self.height)
    }

    fn volume(&self) -> f32 {
        if self.check().is_ok() { PI * self.radius * self.radius * self.height } else { 0.0 }
    }

    fn sample(&self, random: &mut dyn rand::Rng) -> Option<Vec3> {
        self.check().ok()?;
        draw_inside(self, || {
            let disc = unit_disc(random) * self.radius;
            self.base_center + Vec3::new(disc.x, self.height * random.random::<f32>(), disc.y)
        })
    }
}

fn standing(base_center: Vec3, radius: f32, height: f32) -> Bounds {
    let sideways = Vec3::new(radius, 0.0, radius);
    Bounds::new(base_center - sideways, base_center + sideways.with_y(height))
}

/// Uniform in the disc of radius 1.
fn unit_disc(random: &mut dyn rand::Rng) -> Vec2 {
    let (sin, cos) = math::sin_cos(random.random::<f32>() * TAU);
    Vec2::new(cos, sin) * random.random::<f32>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_belong_to_them() {
        let cone = Cone::new(Vec3::new(1.0, 0.0, 0.0), 2.0, 4.0);
        for point in [Vec3::new(3.0, 0.0, 0.0), Vec3::new(1.0, 4.0, 0.0), Vec3::new(1.0, 2.0, 1.0)] {
            assert!(cone.contains(point), "{point}");
        }
        for point in [Vec3::new(1.0, 2.0, 1.01), Vec3::new(1.0, -0.01, 0.0), Vec3::new(1.0, 4.01, 0.0)] {
            assert!(!cone.contains(point), "{point}");
        }
        let cylinder = Cylinder::new(Vec3::ZERO, 1.0, 2.0);
        assert!(cylinder.contains(Vec3::new(0.0, 2.0, -1.0)) && cylinder.contains(Vec3::ZERO));
        assert!(!cylinder.contains(Vec3::new(0.8, 1.0, 0.8)) && !cylinder.contains(Vec3::NAN));
    }

    #[test]
    fn no_second_cone_above_the_apex() {
        assert!(!Cone::new(Vec3::ZERO, 1.0, 1.0).contains(Vec3::new(0.0, 1.5, 0.0)));
    }

    #[test]
    fn cone_is_uniform() {
        let cone = Cone::new(Vec3::ZERO, 1.0, 1.0);
        let mut random = crate::random::stream(4, 0, crate::random::Purpose::CUSTOM, 0);
        let low = (0..20_000).filter(|_| cone.sample(&mut random).is_some_and(|p| p.y < 0.5)).count();
        assert!((low as f32 / 20_000.0 - 0.875).abs() < 0.01, "seven eighths lie in the lower half: {low}");
    }
}
