//! Cells around scattered points (Worley 1996), and dashes scattered like them; both repeat after one tile.

use super::lanes::{fraction, indices, smooth, transposed};
use super::noise::{Seed, cell};
use glam::Vec4;

/// The lowest bits of a distance, which are a point's number instead.
const NUMBER: u32 = 15;

/// The cells that four places lie in.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    /// To the cell's border, in tiles.
    pub(super) border: Vec4,
    /// The cell's random number, in [0, 1).
    pub(super) value: Vec4,
    /// That of the border: the same from both sides.
    pub(super) edge: Vec4,
    /// Direction of the nearest border: along the branch (0) or around it (1).
    pub(super) across: Vec4,
    /// From the cell's point, in tiles.
    pub(super) offset: [Vec4; 2],
}

/// Points on a lattice, a cell apart, each moved at random.
#[derive(Debug, Clone)]
pub(super) struct Cells {
    columns: u32,
    rows: u32,
    /// For each cell the nine points in it and around it: the way there from the cell's corner, a random number, nothing.
    points: Vec<[Vec4; 9]>,
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
        let point = |column: u32, row: u32| {
            let (x, y) = ((column + columns - 1) % columns, (row + rows - 1) % rows);
            let index = (y * columns + x) as usize;
            let draw = |which| seed.unit(salt + which, index);
            let shift = if staggered { 0.25 - 0.5 * (y % 2) as f32 } else { 0.0 };
            let place = |which| 0.5 + jitter * (draw(which) - 0.5);
            [place(0) + shift, place(1), draw(2)]
        };
        Self {
            columns,
            rows,
            points: nine(columns, rows, point, |[x, y, value], j, i| Vec4::new(x + j, y + i, value, 0.0)),
        }
    }

    #[inline]
    pub(super) fn at(&self, x: Vec4, y: Vec4) -> Cell {
        let (columns, rows) = (self.columns as f32, self.rows as f32);
        let ((column, dx), (row, dy)) = (cell(x, columns), cell(y, rows));
        let cells = indices(row * columns + column);
        let squared = |x: Vec4, y: Vec4| {
            let (x, y) = (x - dx, y - dy);
            x * x + y * y
        };
        let (mut first, mut second) = (Vec4::MAX, Vec4::MAX);
        let mut meet = |number: usize, squared: Vec4| {
            // Positive floats are in the order of their bits.
            let number = number as u32;
            let marked =
                Vec4::from_array(squared.to_array().map(|d| f32::from_bits(d.to_bits() & !NUMBER | number)));
            second = second.min(first.max(marked));
            first = first.min(marked);
        };
        let [a, b, c, d] = cells.map(|cell| &self.points[cell]);
        if cells == [cells[0]; 4] {
            for (number, point) in a.iter().enumerate() {
                meet(number, squared(Vec4::splat(point.x), Vec4::splat(point.y)));
            }
        } else {
            for number in 0..9 {
                let [x, y, ..] = transposed([a[number], b[number], c[number], d[number]]);
                meet(number, squared(x, y));
            }
        }
        let found = |marked: Vec4| {
            let [i, j, k, l] = marked.to_array().map(|d| (d.to_bits() & NUMBER) as usize % 9);
            let [x, y, value, _] = transposed([a[i], b[j], c[k], d[l]]);
            [x - dx, y - dy, value]
        };
        let (near, next) = (found(first), found(second));
        let [first, second] = [near, next].map(|[x, y, _]| x * x + y * y);
        // The border is where both are equally far; in tiles the lattice's cells need not be square.
        let (gx, gy) = ((next[0] - near[0]) * columns, (next[1] - near[1]) * rows);
        let slope = (gx * gx + gy * gy).max(Vec4::splat(1e-12));
        Cell {
            border: 0.5 * (second - first).max(Vec4::ZERO) / slope.sqrt(),
            value: near[2],
            edge: fraction((near[2] + next[2]) * 7.31),
            across: gy * gy / slope,
            offset: [near[0] * (-1.0 / columns), near[1] * (-1.0 / rows)],
        }
    }
}

/// For each cell what is in it and around it, of a lattice with a margin of one on each side; `of` is told how many cells
/// to the right and down it is.
fn nine<P, T>(
    columns: u32,
    rows: u32,
    point: impl Fn(u32, u32) -> P,
    of: impl Fn(P, f32, f32) -> T,
) -> Vec<[T; 9]> {
    let around = |cell: u32| {
        std::array::from_fn(|k| {
            let (i, j) = (k as u32 / 3, k as u32 % 3);
            of(point(cell % columns + j, cell / columns + i), j as f32 - 1.0, i as f32 - 1.0)
        })
    };
    (0..columns * rows).map(around).collect()
}

/// Short strokes across the branch: lenticels.
#[derive(Debug, Clone)]
pub(super) struct Dashes {
    columns: u32,
    rows: u32,
    /// Index of each cell's first stroke, and the end of the last one's.
    firsts: Vec<u32>,
    /// Those that reach into each cell, cell by cell.
    strokes: Vec<Stroke>,
}

#[derive(Debug, Clone, Copy)]
struct Stroke {
    x: f32,
    y: f32,
    /// One over half its length and half its width, in cells.
    inverse: [f32; 2],
    strength: f32,
}

impl Stroke {
    /// `true` if it reaches into the cell from whose corner its place is measured.
    fn reaches(&self) -> bool {
        let away = |at: f32| (at - at.clamp(0.0, 1.0)).abs();
        away(self.x) * self.inverse[0] < 1.0 && away(self.y) * self.inverse[1] < 1.0
    }

    /// Strength of the stroke at a place.
    #[inline]
    fn at(&self, dx: Vec4, dy: Vec4) -> Vec4 {
        let u = (self.x - dx) * self.inverse[0];
        let v = (self.y - dy) * self.inverse[1];
        // A lens: as wide as 1 - u² along it.
        self.strength * smooth(0.0, 0.5, 1.0 - u * u - v.abs())
    }
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
        let stroke = |column: u32, row: u32| {
            let (x, y) = ((column + columns - 1) % columns, (row + rows - 1) % rows);
            let index = (y * columns + x) as usize;
            let draw = |which| seed.unit(salt + which, index);
            let long = draw(3) * draw(4);
            let size = |[low, high]: [f32; 2], part: f32| 1.0 / (low + (high - low) * part);
            (draw(0) < chance).then(|| Stroke {
                x: draw(1),
                y: 0.15 + 0.7 * draw(2),
                inverse: [size(lengths, long), size(widths, draw(5))],
                strength: 0.6 + 0.4 * draw(6),
            })
        };
        let around = nine(columns, rows, stroke, |stroke, j, i| {
            stroke.map(|stroke| Stroke { x: stroke.x + j, y: stroke.y + i, ..stroke })
        });
        let (mut firsts, mut strokes) = (vec![0], Vec::new());
        for cell in around {
            strokes.extend(cell.into_iter().flatten().filter(Stroke::reaches));
            firsts.push(strokes.len() as u32);
        }
        Self { columns, rows, firsts, strokes }
    }

    /// Strength of the strongest stroke at each place, 0 to 1; greatest along its middle.
    #[inline]
    pub(super) fn at(&self, x: Vec4, y: Vec4) -> Vec4 {
        let ((column, dx), (row, dy)) = (cell(x, self.columns as f32), cell(y, self.rows as f32));
        let cells = indices(row * self.columns as f32 + column);
        let most = |cell: usize| {
            let strokes = &self.strokes[self.firsts[cell] as usize..self.firsts[cell + 1] as usize];
            strokes.iter().fold(Vec4::ZERO, |most, stroke| most.max(stroke.at(dx, dy)))
        };
        let first = most(cells[0]);
        if cells == [cells[0]; 4] {
            return first;
        }
        Vec4::new(first.x, most(cells[1]).y, most(cells[2]).z, most(cells[3]).w)
    }
}
