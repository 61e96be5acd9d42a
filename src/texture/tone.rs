//! Light to bytes.

use crate::math;
use glam::Vec4;

/// Linear values to the 8 bits of sRGB, by a table.
#[derive(Debug)]
pub(crate) struct Tones(Vec<u8>);

impl Tones {
    const STEPS: usize = 16384;

    pub(crate) fn new() -> Self {
        let tone = |i: usize| (math::srgb(i as f32 / Self::STEPS as f32) * 255.0 + 0.5) as u8;
        Self((0..=Self::STEPS).map(tone).collect())
    }

    #[inline]
    pub(crate) fn of(&self, linear: f32) -> u8 {
        self.0[(linear.clamp(0.0, 1.0) * Self::STEPS as f32 + 0.5) as usize]
    }

    /// Of four at a time.
    #[inline]
    pub(crate) fn of_four(&self, linear: Vec4) -> [u8; 4] {
        // Added to this, whole numbers are in the lowest bits.
        let steps = linear.clamp(Vec4::ZERO, Vec4::ONE) * Self::STEPS as f32 + 8_388_608.0;
        steps.to_array().map(|step| self.0[(step.to_bits() & 0x007f_ffff) as usize])
    }
}
