//! Corners of regular polygons.

use crate::math;
use std::f32::consts::TAU;

/// The polygons that the rings of a mesh have, by their number of sides.
#[derive(Debug, Default)]
pub(super) struct Circles(Vec<Vec<[f32; 2]>>);

impl Circles {
    pub(super) fn new(sides: impl Iterator<Item = u32>) -> Self {
        let mut circles = Vec::new();
        for sides in sides.map(|sides| sides as usize) {
            if circles.len() <= sides {
                circles.resize(sides + 1, Vec::new());
            }
            if circles[sides].is_empty() {
                // The first corner comes twice: textures end where they begin.
                circles[sides] = (0..=sides)
                    .map(|corner| {
                        let (sin, cos) = math::sin_cos((corner % sides) as f32 / sides as f32 * TAU);
                        [cos, sin]
                    })
                    .collect();
            }
        }
        Self(circles)
    }

    /// Cosine and sine of each corner, the first repeated at the end.
    pub(super) fn of(&self, sides: u32) -> &[[f32; 2]] {
        &self.0[sides as usize]
    }
}
