//! From light to bytes.

use crate::math;
use glam::Vec3;

/// From linear light to 8 bits of sRGB.
pub(super) struct Tones(Vec<f32>);

impl Tones {
    const STEPS: usize = 8192;
    /// Order in which the pixels of a 4 by 4 block round up (Bayer), so that slow gradients show no bands.
    const ORDER: [[u8; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

    pub(super) fn new() -> Self {
        Self((0..Self::STEPS).map(|i| math::srgb(i as f32 / (Self::STEPS - 1) as f32) * 255.0).collect())
    }

    pub(super) fn of(&self, color: Vec3, (column, row): (usize, usize)) -> [u8; 3] {
        let threshold = (f32::from(Self::ORDER[row % 4][column % 4]) + 0.5) / 16.0;
        let scaled = color.clamp(Vec3::ZERO, Vec3::ONE) * (Self::STEPS - 1) as f32 + 0.5;
        scaled.to_array().map(|channel| (self.0[channel as usize] + threshold) as u8)
    }
}
