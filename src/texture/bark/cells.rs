//! Cells around scattered points (Worley 1996), and dashes scattered like them; both repeat after one tile.

use super::noise::{Seed, cell, smooth};

/// The cell that a place lies in.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    /// To the cell's border, in tiles.
    pub(super) border: f32,
    /// The cell's random number, in [0, 1).
    pub(super) value: f32,
    /// That of the border: the same from both sides.
    pub(super) edge: f32,
    /// How much the nearest border runs along the branch (0) or around it (1).
    pub(super) across: f32,
    /// From the cell's point, in tiles.
    pub(super) offset: [f32; 2],
}

/// Points on a lattice, a cell apart, each moved at random.
#[derive(Debug, Clone)]
pub(super) struct Cells {
    columns: u32,
    rows: u32,
    /// Place within the cell and a random number, with a margin of one cell on each side.
    points: Vec<[f32; 3]>,
}

impl Cells {
    /// Points moved by up to `jitter` cells; every other row is half a cell on if `staggered`, for which there must be an
    /// even number of rows.
    pub(super) fn new(
        seed: Seed,
        salt: u32,
        (columns, rows): (u32, u32),
        jitter: f32,
        staggered: bool,
    ) -> Self {
        let mut points = Vec::with_capacity(((columns + 2) * (rows + 2)) as usize);
        for row in 0..rows + 2 {
            for column in 0..columns + 2 {
                let (x, y) = ((column + columns - 1) % columns, (row + rows - 1) % rows);
                let index = (y * columns + x) as usize;
                let draw = |which| seed.unit(salt + which, index);
                let shift = if staggered { 0.25 - 0.5 * (y % 2) as f32 } else { 0.0 };
                let place = |which| 0.5 + jitter * (draw(which) - 0.5);
                points.push([place(0) + shift, place(1), draw(2)]);
            }
        }
        Self { columns, rows, points }
    }

    #[inline]
    pub(super) fn at(&self, x: f32, y: f32) -> Cell {
        let (columns, rows) = (self.columns as f32, self.rows as f32);
        let ((column, dx), (row, dy)) = (cell(x, self.columns), cell(y, self.rows));
        let stride = self.columns as usize + 2;
        let (mut first, mut second) = (f32::MAX, f32::MAX);
        let (mut near, mut next) = ([0.0f32; 3], [0.0f32; 3]);
        for i in 0..3 {
            let line = &self.points[(row + i) * stride + column..][..3];
            for (j, point) in line.iter().enumerate() {
                let away = [point[0] + (j as f32 - 1.0) - dx, point[1] + (i as f32 - 1.0) - dy];
                let squared = away[0] * away[0] + away[1] * away[1];
                if squared < first {
                    (second, next) = (first, near);
                    (first, near) = (squared, [away[0], away[1], point[2]]);
                } else if squared < second {
                    (second, next) = (squared, [away[0], away[1], point[2]]);
                }
            }
        }
        // The border is where both are equally far; in tiles the lattice's cells need not be square.
        let (gx, gy) = ((next[0] - near[0]) * columns, (next[1] - near[1]) * rows);
        let slope = (gx * gx + gy * gy).sqrt().max(1e-6);
        let edge = (near[2] + next[2]) * 7.31;
        Cell {
            border: 0.5 * (second - first) / slope,
            value: near[2],
            edge: edge - (edge as i32) as f32,
            across: gy * gy / (slope * slope),
            offset: [-near[0] / columns, -near[1] / rows],
        }
    }
}

/// Short strokes across the branch: lenticels.
#[derive(Debug, Clone)]
pub(super) struct Dashes {
    columns: u32,
    rows: u32,
    strokes: Vec<Stroke>,
}

#[derive(Debug, Clone, Copy)]
struct Stroke {
    x: f32,
    y: f32,
    /// One over half its length and half its width, in cells; zero for none.
    inverse: [f32; 2],
    strength: f32,
}

impl Dashes {
    /// One in a cell with the given chance; half lengths and half widths in cells, from and to, at most 0.9.
    pub(super) fn new(
        seed: Seed,
        salt: u32,
        (columns, rows): (u32, u32),
        chance: f32,
        [lengths, widths]: [[f32; 2]; 2],
    ) -> Self {
        let mut strokes = Vec::with_capacity(((columns + 2) * (rows + 2)) as usize);
        for row in 0..rows + 2 {
            for column in 0..columns + 2 {
                let (x, y) = ((column + columns - 1) % columns, (row + rows - 1) % rows);
                let index = (y * columns + x) as usize;
                let draw = |which| seed.unit(salt + which, index);
                let long = draw(3) * draw(4);
                let size = |[low, high]: [f32; 2], part: f32| 1.0 / (low + (high - low) * part);
                let is_there = draw(0) < chance;
                let inverse = if is_there { [size(lengths, long), size(widths, draw(5))] } else { [0.0; 2] };
                strokes.push(Stroke {
                    x: draw(1),
                    y: 0.15 + 0.7 * draw(2),
                    inverse,
                    strength: 0.6 + 0.4 * draw(6),
                });
            }
        }
        Self { columns, rows, strokes }
    }

    /// How much of a stroke there is, 0 to 1: 1 along its middle.
    #[inline]
    pub(super) fn at(&self, x: f32, y: f32) -> f32 {
        let ((column, dx), (row, dy)) = (cell(x, self.columns), cell(y, self.rows));
        let stride = self.columns as usize + 2;
        let mut most = 0.0f32;
        for i in 0..3 {
            for (j, stroke) in self.strokes[(row + i) * stride + column..][..3].iter().enumerate() {
                if stroke.inverse[0] == 0.0 {
                    continue;
                }
                let u = (stroke.x + (j as f32 - 1.0) - dx) * stroke.inverse[0];
                let v = (stroke.y + (i as f32 - 1.0) - dy) * stroke.inverse[1];
                // A lens: as wide as 1 - u² along it.
                let width = 1.0 - u * u;
                let inside = width - v.abs();
                if inside > 0.0 {
                    most = most.max(stroke.strength * smooth(0.0, 0.5, inside));
                }
            }
        }
        most
    }
}
