//! Vectors computed four at a time.

use glam::{Vec3, Vec4};
use std::ops::{Add, Mul, Sub};

/// Number present.
pub(super) const LANES: usize = 4;

/// Four vectors, their components side by side: one instruction works on all four, where roots and quotients are slow.
/// Each lane has the bits that [`Vec3`] would give.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Lanes {
    pub(super) x: Vec4,
    pub(super) y: Vec4,
    pub(super) z: Vec4,
}

impl Lanes {
    #[inline]
    pub(super) fn splat(v: Vec3) -> Self {
        Self { x: Vec4::splat(v.x), y: Vec4::splat(v.y), z: Vec4::splat(v.z) }
    }

    #[inline]
    pub(super) fn of([a, b, c, d]: [Vec3; LANES]) -> Self {
        Self {
            x: Vec4::new(a.x, b.x, c.x, d.x),
            y: Vec4::new(a.y, b.y, c.y, d.y),
            z: Vec4::new(a.z, b.z, c.z, d.z),
        }
    }

    #[inline]
    pub(super) fn to_array(self) -> [Vec3; LANES] {
        let [x, y, z] = [self.x.to_array(), self.y.to_array(), self.z.to_array()];
        std::array::from_fn(|lane| Vec3::new(x[lane], y[lane], z[lane]))
    }

    #[inline]
    pub(super) fn dot(self, other: Self) -> Vec4 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline]
    pub(super) fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - other.y * self.z,
            y: self.z * other.x - other.z * self.x,
            z: self.x * other.y - other.x * self.y,
        }
    }

    #[inline]
    pub(super) fn lerp(self, other: Self, t: f32) -> Self {
        self * Vec4::splat(1.0 - t) + other * Vec4::splat(t)
    }

    /// Unit vectors; `fallback`'s lanes for those that have no direction.
    #[inline]
    pub(super) fn normalize_or(self, fallback: impl FnOnce() -> Self) -> Self {
        let reciprocal = Vec4::ONE / self.dot(self).sqrt();
        let sound = reciprocal.cmpgt(Vec4::ZERO) & reciprocal.cmplt(Vec4::INFINITY);
        let unit = self * reciprocal;
        if sound.all() {
            return unit;
        }
        let other = fallback();
        Self {
            x: Vec4::select(sound, unit.x, other.x),
            y: Vec4::select(sound, unit.y, other.y),
            z: Vec4::select(sound, unit.z, other.z),
        }
    }
}

impl Add for Lanes {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl Sub for Lanes {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl Mul<Vec4> for Lanes {
    type Output = Self;

    #[inline]
    fn mul(self, factor: Vec4) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vectors() -> impl Strategy<Value = [Vec3; LANES]> {
        // Zeros and what overflows have no direction.
        let number = || prop_oneof![8 => -10f32..10.0, 1 => Just(0.0), 1 => Just(1e-30), 1 => Just(3e38)];
        let vector = || (number(), number(), number()).prop_map(|(x, y, z)| Vec3::new(x, y, z));
        [vector(), vector(), vector(), vector()]
    }

    proptest! {
        #[test]
        fn each_lane_has_the_bits_of_one_vector(a in vectors(), b in vectors(), t in 0f32..1.0) {
            let (four, other) = (Lanes::of(a), Lanes::of(b));
            let unit = four.normalize_or(|| other).to_array();
            let [sum, difference, cross] = [four + other, four - other, four.cross(other)].map(Lanes::to_array);
            let (between, dot) = (four.lerp(other, t).to_array(), four.dot(other));
            let scaled = (four * Vec4::splat(t)).to_array();
            let bits = |v: Vec3| v.to_array().map(|x| if x.is_nan() { u32::MAX } else { x.to_bits() });
            for i in 0..LANES {
                let (a, b) = (a[i], b[i]);
                prop_assert_eq!(bits(unit[i]), bits(a.normalize_or(b)));
                prop_assert_eq!(bits(sum[i]), bits(a + b));
                prop_assert_eq!(bits(difference[i]), bits(a - b));
                prop_assert_eq!(bits(cross[i]), bits(a.cross(b)));
                prop_assert_eq!(bits(between[i]), bits(a.lerp(b, t)));
                prop_assert_eq!(bits(scaled[i]), bits(a * t));
                prop_assert_eq!(bits(Vec3::splat(dot[i])), bits(Vec3::splat(a.dot(b))));
            }
        }
    }
}
