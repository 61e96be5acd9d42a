//! Four neighbouring pixels at a time.

use glam::Vec4;
use std::array;

/// Adding this to a number of at most 2²² in size rounds it to the nearest integer, and leaves that in the lowest bits.
const ROUNDING: f32 = 12_582_912.0;
/// Bits of a positive integer that was added to [`ROUNDING`].
const INTEGER: u32 = 0x003f_ffff;

/// The largest integers that are not larger; for numbers of at most 2²² in size.
#[inline]
pub(super) fn floor(x: Vec4) -> Vec4 {
    let nearest = (x + ROUNDING) - ROUNDING;
    nearest - Vec4::select(nearest.cmpgt(x), Vec4::ONE, Vec4::ZERO)
}

/// The fractional parts, 0 to 1.
#[inline]
pub(super) fn fraction(x: Vec4) -> Vec4 {
    x - floor(x)
}

/// Numbers from 0 to 2²² as the nearest indices.
#[inline]
pub(super) fn indices(x: Vec4) -> [usize; 4] {
    (x + ROUNDING).to_array().map(|x| (x.to_bits() & INTEGER) as usize)
}

/// Numbers from 0 to 1 in 8 bits.
#[inline]
pub(super) fn bytes(x: Vec4) -> [u8; 4] {
    let scaled = x.clamp(Vec4::ZERO, Vec4::ONE) * 255.0;
    (scaled + ROUNDING).to_array().map(|x| x.to_bits() as u8)
}

/// The columns of four rows.
#[inline]
pub(super) fn transposed([a, b, c, d]: [Vec4; 4]) -> [Vec4; 4] {
    let columns = glam::Mat4::from_cols(a, b, c, d).transpose();
    [columns.x_axis, columns.y_axis, columns.z_axis, columns.w_axis]
}

/// 0 up to `low`, 1 from `high` on, smooth in between.
#[inline]
pub(super) fn smooth(low: f32, high: f32, x: Vec4) -> Vec4 {
    let t = ((x - low) * (1.0 / (high - low))).clamp(Vec4::ZERO, Vec4::ONE);
    t * t * (3.0 - 2.0 * t)
}

/// The same between bounds of each lane's own.
#[inline]
pub(super) fn smooth_between(low: Vec4, high: Vec4, x: Vec4) -> Vec4 {
    let t = ((x - low) / (high - low)).clamp(Vec4::ZERO, Vec4::ONE);
    t * t * (3.0 - 2.0 * t)
}

/// From `a` to `b` by the part `t`.
#[inline]
pub(super) fn mix(a: Vec4, b: Vec4, t: Vec4) -> Vec4 {
    a + (b - a) * t
}

/// Four neighbouring pixels of a row.
#[derive(Debug)]
pub(super) struct Quad<'a> {
    /// In tiles around the branch.
    pub(super) x: Vec4,
    /// In tiles along the branch.
    pub(super) y: Vec4,
    /// The plain fields along the whole row, field after field.
    lines: &'a [f32],
    side: usize,
    first: usize,
}

impl<'a> Quad<'a> {
    /// All of a row at `y`; `lines` are its plain fields.
    pub(super) fn all(side: usize, y: f32, lines: &'a [f32]) -> impl Iterator<Item = Self> {
        let scale = 1.0 / side as f32;
        (0..side / 4).map(move |i| {
            let first = 4 * i;
            let x = Vec4::from_array(array::from_fn(|lane| ((first + lane) as f32 + 0.5) * scale));
            Self { x, y: Vec4::splat(y), lines, side, first }
        })
    }

    /// The values of the first plain fields of the pattern.
    #[inline]
    pub(super) fn plain<const N: usize>(&self) -> [Vec4; N] {
        self.plain_from(0)
    }

    /// The same from the field of this number on.
    #[inline]
    pub(super) fn plain_from<const N: usize>(&self, field: usize) -> [Vec4; N] {
        array::from_fn(|i| Vec4::from_slice(&self.lines[(field + i) * self.side + self.first..]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_are_found() {
        for x in [-3.0f32, -2.5, -0.001, 0.0, 0.3, 0.5, 1.0, 1.5, 2.999_999, 1000.25, 1_048_576.5] {
            let found = floor(Vec4::splat(x));
            assert_eq!(found, Vec4::splat(x.floor()), "{x}");
            assert_eq!(fraction(Vec4::splat(x)), Vec4::splat(x - x.floor()), "{x}");
            if x >= 0.0 {
                assert_eq!(indices(found), [x as usize; 4]);
            }
        }
    }

    #[test]
    fn bytes_are_rounded_and_bounded() {
        assert_eq!(bytes(Vec4::new(-1.0, 0.0, 0.5, 0.499)), [0, 0, 128, 127]);
        assert_eq!(bytes(Vec4::new(1.0, 2.0, 254.6 / 255.0, 1.0 / 255.0)), [255, 255, 255, 1]);
    }
}
