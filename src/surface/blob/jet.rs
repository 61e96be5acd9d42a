//! Values, alone or with their gradients, by the same arithmetic: so both have the same bits.

use glam::Vec3;

/// A value, perhaps with its gradient.
pub(super) trait Jet: Copy {
    const ZERO: Self;

    fn value(self) -> f32;

    /// The sum.
    fn plus(self, other: Self) -> Self;

    /// A function of it, from the function's value and its slope.
    fn chain(self, value: f32, slope: f32) -> Self;

    /// The product.
    fn times(self, other: Self) -> Self;
}

impl Jet for f32 {
    const ZERO: Self = 0.0;

    #[inline]
    fn value(self) -> f32 {
        self
    }

    #[inline]
    fn plus(self, other: Self) -> Self {
        self + other
    }

    #[inline]
    fn chain(self, value: f32, _: f32) -> Self {
        value
    }

    #[inline]
    fn times(self, other: Self) -> Self {
        self * other
    }
}

impl Jet for (f32, Vec3) {
    const ZERO: Self = (0.0, Vec3::ZERO);

    #[inline]
    fn value(self) -> f32 {
        self.0
    }

    #[inline]
    fn plus(self, other: Self) -> Self {
        (self.0 + other.0, self.1 + other.1)
    }

    #[inline]
    fn chain(self, value: f32, slope: f32) -> Self {
        (value, self.1 * slope)
    }

    #[inline]
    fn times(self, other: Self) -> Self {
        (self.0 * other.0, self.1 * other.0 + other.1 * self.0)
    }
}
