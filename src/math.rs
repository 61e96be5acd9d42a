//! The functions whose results must agree on every platform, and rotations.
//!
//! `std`'s transcendental functions call the platform's C library, whose last bit differs; these call
//! [`libm`], which is the same Rust code everywhere. Addition, product, quotient and `sqrt` are exact by
//! IEEE 754 and are used directly.

use glam::{Quat, Vec3};

/// Up in every module: +Y.
pub const UP: Vec3 = Vec3::Y;

/// Sine of an angle in radians.
#[inline]
pub fn sin(x: f32) -> f32 {
    libm::sinf(x)
}

/// Cosine of an angle in radians.
#[inline]
pub fn cos(x: f32) -> f32 {
    libm::cosf(x)
}

/// Sine and cosine of an angle in radians.
#[inline]
pub fn sin_cos(x: f32) -> (f32, f32) {
    libm::sincosf(x)
}

/// Arc cosine in radians; the argument is clamped to [-1, 1], so that rounding in a dot product is harmless.
#[inline]
pub fn acos(x: f32) -> f32 {
    libm::acosf(x.clamp(-1.0, 1.0))
}

/// Arc sine in radians; the argument is clamped to [-1, 1].
#[inline]
pub fn asin(x: f32) -> f32 {
    libm::asinf(x.clamp(-1.0, 1.0))
}

/// Angle of the point (x, y) in radians, in (-π, π].
#[inline]
pub fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}

/// `x` to the power of `exponent`.
#[inline]
pub fn powf(x: f32, exponent: f32) -> f32 {
    libm::powf(x, exponent)
}

/// e to the power of `x`.
#[inline]
pub fn exp(x: f32) -> f32 {
    libm::expf(x)
}

/// Natural logarithm.
#[inline]
pub fn ln(x: f32) -> f32 {
    libm::logf(x)
}

/// Cube root.
#[inline]
pub fn cbrt(x: f32) -> f32 {
    libm::cbrtf(x)
}

/// A linear channel of light, cut off at 0 and 1, as the sRGB standard encodes it (IEC 61966-2-1); 0 to 1.
pub fn srgb(linear: f32) -> f32 {
    let linear = linear.clamp(0.0, 1.0);
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * powf(linear, 1.0 / 2.4) - 0.055 }
}

/// The linear channel of light that an sRGB channel means, both 0 to 1: the inverse of [`srgb`].
pub fn linear(encoded: f32) -> f32 {
    let encoded = encoded.clamp(0.0, 1.0);
    if encoded <= 0.04045 { encoded / 12.92 } else { powf((encoded + 0.055) / 1.055, 2.4) }
}

/// The same as [`f32::floor`], without the call that processors without SSE 4.1 need; minus zero may become zero.
#[cfg(feature = "texture")]
#[inline]
pub(crate) fn floor(x: f32) -> f32 {
    if x.abs() < 1e9 {
        let whole = x as i32 as f32;
        if whole > x { whole - 1.0 } else { whole }
    } else {
        x.floor()
    }
}

/// A quaternion's rotation at length 1, term by term: glam's own sums take other steps on other processors.
pub fn unit_rotation(rotation: Quat) -> Quat {
    let [x, y, z, w] = rotation.to_array();
    let length = (x * x + y * y + z * z + w * w).sqrt();
    Quat::from_xyzw(x / length, y / length, z / length, w / length)
}

/// The rotation by `b`, then by `a`, term by term, for the same reason.
pub(crate) fn product(a: Quat, b: Quat) -> Quat {
    Quat::from_xyzw(
        a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
        a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
        a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
        a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
    )
}

/// A unit vector perpendicular to the unit vector `v`.
#[inline]
pub fn perpendicular(v: Vec3) -> Vec3 {
    v.any_orthonormal_vector()
}

/// Angle between two vectors in radians, in [0, π]; accurate for small angles too. Zero if one is zero.
#[inline]
pub fn angle_between(a: Vec3, b: Vec3) -> f32 {
    atan2(a.cross(b).length(), a.dot(b))
}

/// A rotation by a fixed angle about an axis that is given later (Rodrigues' formula).
///
/// Keeping sine and cosine makes applying it cheap enough for every node of a graph.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    sin: f32,
    cos: f32,
}

impl Rotation {
    /// A rotation by `angle` radians, right-handed about its axis.
    pub fn new(angle: f32) -> Self {
        let (sin, cos) = sin_cos(angle);
        Self { sin, cos }
    }

    /// Turns `v` about the unit vector `axis`.
    #[inline]
    pub fn about(self, axis: Vec3, v: Vec3) -> Vec3 {
        v * self.cos + axis.cross(v) * self.sin + axis * (axis.dot(v) * (1.0 - self.cos))
    }
}

/// Carries `normal`, perpendicular to the unit tangent `from`, to the unit tangent `to` by the smallest
/// rotation between them (parallel transport), so that a frame along a curve does not twist.
///
/// For opposite tangents the rotation is undefined and the normal is kept.
#[inline]
pub fn parallel_transport(from: Vec3, to: Vec3, normal: Vec3) -> Vec3 {
    let cos = from.dot(to);
    let axis = from.cross(to);
    if cos <= -0.999_999 {
        return normal;
    }
    let turned = normal * cos + axis.cross(normal) + axis * (axis.dot(normal) / (1.0 + cos));
    (turned - to * turned.dot(to)).normalize_or(perpendicular(to))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::{FRAC_PI_2, PI};

    #[test]
    fn rotation_is_right_handed() {
        let quarter = Rotation::new(FRAC_PI_2);
        assert!(quarter.about(Vec3::Z, Vec3::X).abs_diff_eq(Vec3::Y, 1e-6));
        assert!(quarter.about(Vec3::Y, Vec3::Z).abs_diff_eq(Vec3::X, 1e-6));
    }

    #[test]
    fn angles_are_accurate_at_both_ends() {
        assert!((angle_between(Vec3::X, Vec3::new(1.0, 1e-4, 0.0)) - 1e-4).abs() < 1e-8);
        assert!((angle_between(Vec3::X, Vec3::new(-1.0, 1e-4, 0.0)) - (PI - 1e-4)).abs() < 1e-6);
        assert!(angle_between(Vec3::ZERO, Vec3::X).abs() < 1e-9);
    }

    #[test]
    fn transport_keeps_length_and_right_angle() {
        let (from, to) = (Vec3::Y, Vec3::new(0.6, 0.8, 0.0));
        let normal = parallel_transport(from, to, Vec3::X);
        assert!(normal.abs_diff_eq(Vec3::new(0.8, -0.6, 0.0), 1e-6));
        assert_eq!(parallel_transport(from, -from, Vec3::X), Vec3::X);
    }
}
