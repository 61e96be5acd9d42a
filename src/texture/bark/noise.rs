//! Noise that repeats after one tile: gradients on a lattice whose ends meet (Perlin 1985, 2002).

use crate::random::{self, Purpose};

/// Smooth at both ends: the first and second derivatives vanish (Perlin 2002).
#[inline]
fn fade(t: f32) -> f32 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// 0 up to `low`, 1 from `high` on, smooth in between.
#[inline]
pub(super) fn smooth(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// From `a` to `b` by the part `t`.
#[inline]
pub(super) fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// The fractional part of a number that is not far below zero.
#[inline]
pub(super) fn fraction(x: f32) -> f32 {
    let x = x + 64.0;
    x - (x as i32) as f32
}

/// The cell of a lattice that repeats after so many, and the way into it: `x` in tiles, from -4 on.
#[inline]
pub(super) fn cell(x: f32, cells: u32) -> (usize, f32) {
    let x = (x + 4.0) * cells as f32;
    let whole = x as u32;
    // Whole tiles are taken off without a slow division; rounding may leave one too many.
    let tiles = (whole as f32 / cells as f32) as u32;
    let cell = whole - tiles * cells;
    (if cell >= cells { cell - cells } else { cell } as usize, x - whole as f32)
}

/// Where the random numbers of a texture come from: each table of a pattern has a salt of its own.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seed(pub(super) u64);

impl Seed {
    /// A number in [0, 1) for a cell of the table `salt`.
    pub(super) fn unit(self, salt: u32, index: usize) -> f32 {
        random::unit(self.0, salt, Purpose::BARK, index as u64)
    }
}

/// Gradient noise with so many cells in a tile across and down.
#[derive(Debug, Clone)]
pub(super) struct Noise {
    columns: u32,
    rows: u32,
    /// A gradient a lattice point; the first column and row come again at the end.
    gradients: Vec<[f32; 2]>,
}

impl Noise {
    pub(super) fn new(seed: Seed, salt: u32, columns: u32, rows: u32) -> Self {
        let mut gradients = Vec::with_capacity(((columns + 1) * (rows + 1)) as usize);
        for row in 0..=rows {
            for column in 0..=columns {
                let index = ((row % rows) * columns + column % columns) as usize;
                let angle = seed.unit(salt, index) * std::f32::consts::TAU;
                let (sin, cos) = crate::math::sin_cos(angle);
                gradients.push([1.45 * cos, 1.45 * sin]);
            }
        }
        Self { columns, rows, gradients }
    }

    /// About -1 to 1 at a point; the tile is [0, 1) squared, and repeats from -4 on.
    #[inline]
    pub(super) fn at(&self, x: f32, y: f32) -> f32 {
        let ((column, dx), (row, dy)) = (cell(x, self.columns), cell(y, self.rows));
        let stride = self.columns as usize + 1;
        let upper = &self.gradients[row * stride + column..][..2];
        let lower = &self.gradients[(row + 1) * stride + column..][..2];
        let (u, v) = (fade(dx), fade(dy));
        let slope = |[gx, gy]: [f32; 2], x: f32, y: f32| gx * x + gy * y;
        let above = mix(slope(upper[0], dx, dy), slope(upper[1], dx - 1.0, dy), u);
        let below = mix(slope(lower[0], dx, dy - 1.0), slope(lower[1], dx - 1.0, dy - 1.0), u);
        mix(above, below, v)
    }
}

/// Octaves of noise, each twice as fine as the one before and half as strong.
#[derive(Debug, Clone)]
pub(super) struct Fractal(Vec<Noise>);

impl Fractal {
    /// `finest` is the number of cells in a tile beyond which no octave is made: half the pixels.
    pub(super) fn new(seed: Seed, salt: u32, (columns, rows): (u32, u32), octaves: u32, finest: u32) -> Self {
        let octave = |i: u32| Noise::new(seed, salt + i, columns << i, rows << i);
        let fits = |i: &u32| *i == 0 || (columns << i).max(rows << i) <= finest;
        Self((0..octaves).take_while(fits).map(octave).collect())
    }

    /// About -1 to 1.
    #[inline]
    pub(super) fn at(&self, x: f32, y: f32) -> f32 {
        let (mut sum, mut weight) = (0.0, 0.5);
        for octave in &self.0 {
            sum += weight * octave.at(x, y);
            weight *= 0.5;
        }
        1.3 * sum
    }
}
