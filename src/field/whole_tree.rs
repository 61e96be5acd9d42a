//! The fields of the paper's figure 8, each made for a whole tree. All vectors have length 1, or 0 where the
//! field is undefined.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::Vec3;

use super::{VectorField, check_nonzero, check_position, check_vector};
use crate::{
    ParameterError,
    math::{self, UP},
};

/// Around a vertical axis and upwards at once, like the thread of a screw: figure 8 (a).
///
/// With a [pitch](Self::new) every turn climbs the same height, so the field is upright near the axis and the
/// flatter the farther out: a trunk on the axis grows straight, the crown swirls. With an
/// [angle](Self::with_angle) it is equally steep everywhere, and upright on the axis itself.
///
/// ```
/// use std::f32::consts::TAU;
/// use treesynth::{VectorField, field::Helix, glam::Vec3};
///
/// // One metre a radian: 45° steep one metre from the axis.
/// let helix = Helix::new(Vec3::ZERO, TAU);
/// assert!(helix.at(Vec3::X).abs_diff_eq(Vec3::new(0.0, 1.0, -1.0).normalize(), 1e-6));
/// assert_eq!(helix.at(Vec3::Y), Vec3::Y);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Helix {
    center: Vec3,
    rise: Rise,
}

#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
enum Rise {
    Pitch(f32),
    Angle(f32),
}

impl Helix {
    /// The helix about the vertical line through `center` (metres, at most 1e6 from 0 on each axis) that
    /// climbs `pitch` metres per turn.
    ///
    /// Positive pitches, from 1e-6 to 1e6, are right-handed (anticlockwise seen from above), negative ones
    /// left-handed. Both climb.
    pub const fn new(center: Vec3, pitch: f32) -> Self {
        Self { center, rise: Rise::Pitch(pitch) }
    }

    /// The helix about the vertical line through `center` that climbs at `angle` radians above the
    /// horizontal, at every distance from the axis.
    ///
    /// The angle is from 0, a [`Rotation`] about the vertical, to π/2, straight up. Right-handed for positive
    /// angles, left-handed for negative ones, which climb as well.
    pub const fn with_angle(center: Vec3, angle: f32) -> Self {
        Self { center, rise: Rise::Angle(angle) }
    }
}

impl VectorField for Helix {
    fn at(&self, point: Vec3) -> Vec3 {
        let around = UP.cross(point - self.center);
        let vector = match self.rise {
            Rise::Pitch(pitch) => around * 1.0_f32.copysign(pitch) + UP * (pitch.abs() / TAU),
            Rise::Angle(angle) => match around.try_normalize() {
                Some(around) => {
                    let (sin, cos) = math::sin_cos(angle.abs());
                    around * cos.copysign(angle) + UP * sin
                }
                None if around == Vec3::ZERO => UP,
                None => Vec3::ZERO,
            },
        };
        vector.normalize_or_zero()
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_position("Helix.center", self.center)?;
        match self.rise {
            Rise::Pitch(pitch) => check_nonzero("Helix.pitch", pitch),
            Rise::Angle(angle) => ParameterError::unless(
                angle.abs() <= FRAC_PI_2,
                "Helix.angle",
                angle,
                "from -π/2 to π/2 radians",
            ),
        }
    }
}

/// Around an axis: figure 8 (b).
///
/// The paper's "rotational field about the z-axis" is `Rotation::new(center, Vec3::Z)`: in this crate's frame,
/// where +Y is up, z is horizontal, so branches climb on one side of the center, cross over above it and come
/// down on the other. With the center beside the root, at −x, the tree starts straight up and arches over.
/// Seen from the tip of the axis the field turns anticlockwise; on the axis itself it is zero.
///
/// ```
/// use treesynth::{VectorField, field::Rotation, glam::Vec3};
///
/// let arch = Rotation::new(Vec3::new(-3.0, 0.0, 0.0), Vec3::Z);
/// assert_eq!(arch.at(Vec3::ZERO), Vec3::Y);
/// assert_eq!(arch.at(Vec3::new(-3.0, 3.0, 0.0)), Vec3::NEG_X);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Rotation {
    center: Vec3,
    axis: Vec3,
}

impl Rotation {
    /// The rotation about the line through `center` (metres, at most 1e6 from 0 on each axis) along `axis`, of
    /// any length from 1e-6 to 1e6; right-handed.
    pub const fn new(center: Vec3, axis: Vec3) -> Self {
        Self { center, axis }
    }
}

impl VectorField for Rotation {
    fn at(&self, point: Vec3) -> Vec3 {
        self.axis.normalize_or_zero().cross(point - self.center).normalize_or_zero()
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_position("Rotation.center", self.center)?;
        check_vector("Rotation.axis", self.axis)
    }
}

/// Upwards along spheres around a center: figure 8 (c).
///
/// At each point, the direction of the meridian that runs from the lowest point of the sphere through it to
/// the highest. Below the center it points outwards and up, above it inwards and up: crowns become onions. On
/// the vertical line through the center, where all meridians meet, it is zero.
///
/// ```
/// use treesynth::{VectorField, field::SphericalMeridians, glam::Vec3};
///
/// let onion = SphericalMeridians::new(Vec3::new(0.0, 5.0, 0.0));
/// assert_eq!(onion.at(Vec3::new(2.0, 5.0, 0.0)), Vec3::Y);
/// assert!(onion.at(Vec3::new(1.0, 4.0, 0.0)).abs_diff_eq(Vec3::new(1.0, 1.0, 0.0).normalize(), 1e-6));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct SphericalMeridians {
    center: Vec3,
}

impl SphericalMeridians {
    /// The meridians of the spheres around `center`, metres, at most 1e6 from 0 on each axis.
    pub const fn new(center: Vec3) -> Self {
        Self { center }
    }
}

impl VectorField for SphericalMeridians {
    fn at(&self, point: Vec3) -> Vec3 {
        let outwards = point - self.center;
        // Up without its part along `outwards`, times that vector's squared length. Written without a
        // difference of large numbers, which keeps it exact near the vertical line.
        let sideways = outwards.with_y(0.0);
        (UP * sideways.length_squared() - sideways * outwards.y).normalize_or_zero()
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_position("SphericalMeridians.center", self.center)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::{FRAC_PI_4, FRAC_PI_6};

    #[test]
    fn helix_with_pitch_by_hand() {
        let helix = Helix::new(Vec3::new(1.0, 7.0, 0.0), TAU * 0.75);
        // 1 m out, 0.75 m up a radian: the 3-4-5 triangle.
        assert!(helix.at(Vec3::new(2.0, 0.0, 0.0)).abs_diff_eq(Vec3::new(0.0, 0.6, -0.8), 1e-6));
        assert!(helix.at(Vec3::new(1.0, 9.0, 1.0)).abs_diff_eq(Vec3::new(0.8, 0.6, 0.0), 1e-6));
        assert_eq!(helix.at(Vec3::new(1.0, 2.0, 0.0)), UP);
        let left = Helix::new(Vec3::ZERO, -TAU);
        assert!(left.at(Vec3::X).abs_diff_eq(Vec3::new(0.0, 1.0, 1.0).normalize(), 1e-6));
    }

    #[test]
    fn helix_with_angle_by_hand() {
        for distance in [0.01, 1.0, 50.0] {
            let (point, half, root) = (Vec3::X * distance, 0.5, 0.75_f32.sqrt());
            let right = Helix::with_angle(Vec3::ZERO, FRAC_PI_6).at(point);
            let left = Helix::with_angle(Vec3::ZERO, -FRAC_PI_6).at(point);
            assert!(right.abs_diff_eq(Vec3::new(0.0, half, -root), 1e-6), "{right}");
            assert!(left.abs_diff_eq(Vec3::new(0.0, half, root), 1e-6), "{left}");
        }
        assert_eq!(Helix::with_angle(Vec3::ZERO, FRAC_PI_4).at(Vec3::Y), UP);
        assert!(Helix::with_angle(Vec3::ZERO, FRAC_PI_2).at(Vec3::X).abs_diff_eq(UP, 1e-6));
        let flat = Helix::with_angle(Vec3::ZERO, 0.0).at(Vec3::Z);
        assert_eq!(flat, Rotation::new(Vec3::ZERO, UP).at(Vec3::Z));
    }

    #[test]
    fn rotation_by_hand() {
        let rotation = Rotation::new(Vec3::ONE, Vec3::X * 3.0);
        assert_eq!(rotation.at(Vec3::new(5.0, 3.0, 1.0)), Vec3::Z);
        assert_eq!(rotation.at(Vec3::new(5.0, 1.0, 3.0)), Vec3::NEG_Y);
        assert_eq!(rotation.at(Vec3::new(-4.0, 1.0, 1.0)), Vec3::ZERO);
    }

    #[test]
    fn meridians_by_hand() {
        let field = SphericalMeridians::new(Vec3::Y);
        assert!(field.at(Vec3::new(0.6, 1.8, 0.0)).abs_diff_eq(Vec3::new(-0.8, 0.6, 0.0), 1e-6));
        assert!(field.at(Vec3::new(0.0, 0.2, -0.6)).abs_diff_eq(Vec3::new(0.0, 0.6, -0.8), 1e-6));
        for pole in [Vec3::ZERO, Vec3::Y, Vec3::Y * 4.0] {
            assert_eq!(field.at(pole), Vec3::ZERO);
        }
        let near_pole = field.at(Vec3::new(1e-4, 1000.0, 0.0));
        assert!(near_pole.abs_diff_eq(Vec3::NEG_X, 1e-5), "{near_pole}");
    }
}
