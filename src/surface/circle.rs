//! Corners of regular polygons.

use super::lanes::LANES;
use crate::math;
use glam::Vec4;
use std::f32::consts::TAU;

/// A regular polygon.
#[derive(Debug, Clone, Default)]
pub(super) struct Circle {
    /// Cosine and sine of each corner, the first repeated at the end: textures end where they begin.
    pub(super) corners: Vec<[f32; 2]>,
    /// Cosines and sines of four corners each, without that end; the last four are filled up with the first corner.
    pub(super) fours: Vec<[Vec4; 2]>,
}

impl Circle {
    fn new(sides: usize) -> Self {
        let corner = |corner: usize| {
            let (sin, cos) = math::sin_cos((corner % sides) as f32 / sides as f32 * TAU);
            [cos, sin]
        };
        let corners: Vec<_> = (0..=sides).map(corner).collect();
        let four = |first: usize| {
            let of = |which: usize| {
                Vec4::from_array(std::array::from_fn(|lane| corners[(first + lane).min(sides)][which]))
            };
            [of(0), of(1)]
        };
        Self { fours: (0..sides).step_by(LANES).map(four).collect(), corners }
    }
}

/// The polygons that the rings of a mesh have, by their number of sides.
#[derive(Debug, Default)]
pub(super) struct Circles(Vec<Circle>);

impl Circles {
    pub(super) fn new(sides: impl Iterator<Item = u32>) -> Self {
        let mut circles = Vec::new();
        for sides in sides.map(|sides| sides as usize) {
            if circles.len() <= sides {
                circles.resize(sides + 1, Circle::default());
            }
            if circles[sides].corners.is_empty() {
                circles[sides] = Circle::new(sides);
            }
        }
        Self(circles)
    }

    pub(super) fn of(&self, sides: u32) -> &Circle {
        &self.0[sides as usize]
    }
}
