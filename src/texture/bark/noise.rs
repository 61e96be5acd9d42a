//! Noise that repeats after one tile: gradients on a lattice whose ends meet (Perlin 1985, 2002).
//!
//! Along a row of pixels the noise in each cell is a blend of two lines, whose four numbers are computed once
//! per row and cell ([`Fractal::line`]); only places that are moved by other noise ask the lattice itself
//! ([`Fractal::at`]).

use super::lanes::{floor, fraction, indices, mix, transposed};
use crate::random::{self, Purpose};
use glam::{Vec2, Vec4};

/// Smooth at both ends: the first and second derivatives vanish (Perlin 2002).
#[inline]
fn fade(t: Vec4) -> Vec4 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// Places on a lattice that repeats after `cells` cells: the number of the cell, and the way into
/// it.
#[inline]
pub(super) fn cell(x: Vec4, cells: f32) -> (Vec4, Vec4) {
    let x = fraction(x) * cells;
    // Rounding may leave a whole tile: the last cell's end.
    let cell = floor(x).min(Vec4::splat(cells - 1.0));
    (cell, x - cell)
}

/// Source of a texture's random numbers: each table of a pattern has a salt of its own.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seed(pub(super) u64);

impl Seed {
    /// A number in [0, 1) for a cell of the table `salt`.
    pub(super) fn unit(self, salt: u32, index: usize) -> f32 {
        random::unit(self.0, salt, Purpose::BARK, index as u64)
    }
}

/// Gradient noise with this number of cells in a tile across and down, multiplied by a weight.
#[derive(Debug, Clone)]
struct Noise {
    columns: u32,
    rows: u32,
    /// One gradient per lattice point, row by row; the first column and row come again at the end.
    gradients: Vec<f32>,
}

impl Noise {
    fn new(seed: Seed, salt: u32, columns: u32, rows: u32, weight: f32) -> Self {
        let mut gradients = Vec::with_capacity((2 * (columns + 1) * (rows + 1)) as usize);
        let steep = 1.45 * weight;
        for row in 0..=rows {
            for column in 0..=columns {
                let index = ((row % rows) * columns + column % columns) as usize;
                let angle = seed.unit(salt, index) * std::f32::consts::TAU;
                let (sin, cos) = crate::math::sin_cos(angle);
                gradients.extend([steep * cos, steep * sin]);
            }
        }
        Self { columns, rows, gradients }
    }

    /// Numbers of a row of gradients.
    fn stride(&self) -> usize {
        2 * (self.columns as usize + 1)
    }

    /// About -1 to 1, times the weight.
    #[inline]
    fn at(&self, x: Vec4, y: Vec4) -> Vec4 {
        let ((column, dx), (row, dy)) = (cell(x, self.columns as f32), cell(y, self.rows as f32));
        let stride = self.stride();
        let first = indices(row * stride as f32 + 2.0 * column);
        let pairs =
            |offset: usize| transposed(first.map(|i| Vec4::from_slice(&self.gradients[i + offset..])));
        let [ax, ay, bx, by] = pairs(0);
        let [cx, cy, ex, ey] = pairs(stride);
        let (u, v) = (fade(dx), fade(dy));
        let (right, lower) = (dx - 1.0, dy - 1.0);
        let above = mix(ax * dx + ay * dy, bx * right + by * dy, u);
        let below = mix(cx * dx + cy * lower, ex * right + ey * lower, u);
        mix(above, below, v)
    }

    /// Adds the noise at a row of pixels at `y`. `steps` has their places on the lattice; `slopes` is overwritten.
    fn add(&self, y: f32, steps: &Steps, slopes: &mut Vec<f32>, sum: &mut [f32]) {
        let (row, dy) = cell(Vec4::splat(y), self.rows as f32);
        let ([row, ..], dy, v) = (indices(row), dy.x, fade(dy).x);
        let stride = self.stride();
        let [above, below] =
            [row, row + 1].map(|row| self.gradients[row * stride..][..stride].chunks_exact(2));
        slopes.clear();
        for (above, below) in above.zip(below) {
            let (over, under) = (above[1] * dy, below[1] * (dy - 1.0));
            slopes.extend([over + (under - over) * v, above[0] + (below[0] - above[0]) * v]);
        }
        let quads = steps.cells.chunks_exact(4).zip(steps.ways.chunks_exact(4)).zip(sum.chunks_exact_mut(4));
        for ((cells, ways), sum) in quads {
            let lines = |i: usize| Vec4::from_slice(&slopes[cells[i] as usize..]);
            let [left, rise, right, fall] = transposed([lines(0), lines(1), lines(2), lines(3)]);
            let [dx, u] = transposed_pairs(ways);
            let value = mix(left + rise * dx, right + fall * (dx - 1.0), u);
            (Vec4::from_slice(sum) + value).write_to_slice(sum);
        }
    }
}

/// The first and the second numbers of four pairs.
#[inline]
fn transposed_pairs(pairs: &[Vec2]) -> [Vec4; 2] {
    let [a, b, c, d] = [pairs[0], pairs[1], pairs[2], pairs[3]];
    [Vec4::new(a.x, b.x, c.x, d.x), Vec4::new(a.y, b.y, c.y, d.y)]
}

/// Places on a lattice of the pixels of every row.
#[derive(Debug)]
struct Steps {
    /// The place of each one's cell in a row of pairs.
    cells: Vec<u32>,
    /// The way into the cell, and how far the right side counts.
    ways: Vec<Vec2>,
}

impl Steps {
    fn new(columns: u32, side: usize) -> Self {
        let all = (0..side).map(|i| {
            let (cell, way) = cell(Vec4::splat((i as f32 + 0.5) / side as f32), columns as f32);
            (2 * indices(cell)[0] as u32, Vec2::new(way.x, fade(way).x))
        });
        let (cells, ways) = all.unzip();
        Self { cells, ways }
    }
}

/// Octaves of noise, each twice as fine as the one before and half as strong; or one alone.
#[derive(Debug, Clone)]
pub(super) struct Fractal(Vec<Noise>);

impl Fractal {
    /// About -1 to 1; `finest` is the number of cells in a tile beyond which no octave is made: half the pixels.
    pub(super) fn new(seed: Seed, salt: u32, (columns, rows): (u32, u32), octaves: u32, finest: u32) -> Self {
        let octave = |i: u32| Noise::new(seed, salt + i, columns << i, rows << i, 0.65 / (1u32 << i) as f32);
        let fits = |i: &u32| *i == 0 || (columns << i).max(rows << i) <= finest;
        Self((0..octaves).take_while(fits).map(octave).collect())
    }

    /// One octave, about -1 to 1.
    pub(super) fn single(seed: Seed, salt: u32, (columns, rows): (u32, u32)) -> Self {
        Self(vec![Noise::new(seed, salt, columns, rows, 1.0)])
    }

    /// At any places; the tile is [0, 1) squared, and repeats.
    #[inline]
    pub(super) fn at(&self, x: Vec4, y: Vec4) -> Vec4 {
        self.0.iter().fold(Vec4::ZERO, |sum, octave| sum + octave.at(x, y))
    }
}

/// Fields at the pixels of whole rows.
#[derive(Debug)]
pub(super) struct Lines<'a> {
    side: usize,
    fields: Vec<Vec<(&'a Noise, Steps)>>,
}

impl<'a> Lines<'a> {
    pub(super) fn new(fields: &[&'a Fractal], side: usize) -> Self {
        let of = |field: &&'a Fractal| {
            field.0.iter().map(|noise| (noise, Steps::new(noise.columns, side))).collect()
        };
        Self { side, fields: fields.iter().map(of).collect() }
    }

    /// All fields along the row at `y`, field after field.
    pub(super) fn at(&self, y: f32) -> Vec<f32> {
        let mut lines = vec![0.0; self.fields.len() * self.side];
        let mut slopes = Vec::new();
        for (field, line) in self.fields.iter().zip(lines.chunks_exact_mut(self.side)) {
            for (noise, steps) in field {
                noise.add(y, steps, &mut slopes, line);
            }
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_what_each_of_its_places_is() {
        for (columns, rows, octaves) in [(1, 1, 1), (5, 3, 4), (90, 45, 2)] {
            let field = Fractal::new(Seed(3), 11, (columns, rows), octaves, 1024);
            let side = 256;
            let lines = Lines::new(&[&field], side);
            for y in [0.001, 0.3, 0.62, 0.999] {
                let line = lines.at(y);
                for (i, value) in line.into_iter().enumerate() {
                    let x = (i as f32 + 0.5) / side as f32;
                    let place = field.at(Vec4::splat(x), Vec4::splat(y)).x;
                    assert!((value - place).abs() < 1e-5, "{value} for {place} at {x}, {y}");
                    let beyond = field.at(Vec4::splat(x - 1.0), Vec4::splat(y + 1.0)).x;
                    assert!(
                        (beyond - place).abs() < 2e-3 * columns as f32,
                        "{beyond} for {place} at {x}, {y}"
                    );
                }
            }
        }
    }
}
