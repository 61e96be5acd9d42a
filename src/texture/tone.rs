//! Light to bytes.

use crate::math;

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
}
