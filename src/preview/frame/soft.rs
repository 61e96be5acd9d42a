//! Shadows of solids, smoothed: a few rays to the sun from each pixel make a grain, and neighbours' rays the average.

use super::super::ray::Sunlight;
use crate::parallel;
use glam::Vec3;
use std::ops::Range;

/// The widest that a shadow's edge is smoothed, pixels to each side.
const WIDEST: usize = 5;
/// Neighbours lie on one surface if their normals' cosine is at least this.
const FLAT: f32 = 0.85;

/// A pixel whose sunlight is not decided yet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Texel {
    /// Its colour times what of it is covered, without `sun`.
    pub(super) color: Vec3,
    pub(super) covered: f32,
    /// Light that a whole sun adds.
    pub(super) sun: Vec3,
    pub(super) light: Sunlight,
    /// Point that is seen, its normal, and the side of a pixel there.
    pub(super) point: Vec3,
    pub(super) normal: Vec3,
    pub(super) pixel: f32,
}

impl Texel {
    fn is_lit(&self) -> bool {
        self.sun != Vec3::ZERO
    }

    fn is_beside(&self, other: &Self) -> bool {
        other.is_lit()
            && self.normal.dot(other.normal) >= FLAT
            && (other.point - self.point).dot(self.normal).abs() <= 2.0 * self.pixel.max(other.pixel)
    }
}

/// Rows of pixels on their way: they are done once those below them are known.
#[derive(Debug, Default)]
pub(super) struct Rows {
    width: usize,
    /// The first row kept, and the next to be given out.
    first: usize,
    next: usize,
    texels: Vec<Texel>,
}

impl Rows {
    pub(super) fn new(width: usize) -> Self {
        Self { width, ..Self::default() }
    }

    pub(super) fn extend(&mut self, texels: Vec<Texel>) {
        self.texels.extend(texels);
    }

    /// The rows that can be given out now, all if this was the `last` of them, and the first one's number: colour times
    /// coverage, and coverage.
    pub(super) fn finished(&mut self, last: bool) -> (usize, Vec<Vec<(Vec3, f32)>>) {
        let known = self.first + self.texels.len() / self.width;
        let (start, end) =
            (self.next, if last { known } else { known.saturating_sub(WIDEST).max(self.next) });
        let rows = parallel::map(end - start, |i| {
            (0..self.width).map(|column| self.finish(column, start + i, known)).collect::<Vec<_>>()
        });
        self.next = end;
        let kept = end.saturating_sub(WIDEST).max(self.first);
        self.texels.drain(..(kept - self.first) * self.width);
        self.first = kept;
        (start, rows)
    }

    fn at(&self, column: usize, row: usize) -> &Texel {
        &self.texels[(row - self.first) * self.width + column]
    }

    fn around(&self, column: usize, row: usize, known: usize, reach: usize) -> (Range<usize>, Range<usize>) {
        let columns = column.saturating_sub(reach)..(column + reach + 1).min(self.width);
        (columns, row.saturating_sub(reach).max(self.first)..(row + reach + 1).min(known))
    }

    fn finish(&self, column: usize, row: usize, known: usize) -> (Vec3, f32) {
        let texel = self.at(column, row);
        if !texel.is_lit() {
            return (texel.color, texel.covered);
        }
        // As wide as the widest edge of a shadow that reaches here: one that is all lit by chance is in it too.
        let (columns, rows) = self.around(column, row, known, WIDEST);
        let mut reach = 0;
        for y in rows {
            for x in columns.clone() {
                let other = self.at(x, y);
                let away = x.abs_diff(column).max(y.abs_diff(row));
                let softness = (other.light.softness + 0.5) as usize;
                if softness > reach && softness >= away && texel.is_beside(other) {
                    reach = softness.min(WIDEST);
                }
            }
        }
        let (columns, rows) = self.around(column, row, known, reach);
        let (mut seen, mut weights) = (0.0, 0.0);
        for y in rows {
            for x in columns.clone() {
                let other = self.at(x, y);
                if texel.is_beside(other) {
                    // A tent, so that no edge of the window shows.
                    let fall = |a: usize, b: usize| (reach + 1) as f32 - a.abs_diff(b) as f32;
                    let weight = fall(x, column) * fall(y, row);
                    seen += weight * other.light.seen;
                    weights += weight;
                }
            }
        }
        let seen = if weights > 0.0 { seen / weights } else { texel.light.seen };
        (texel.color + texel.sun * seen, texel.covered)
    }
}
