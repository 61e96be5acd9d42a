//! The samples of some rows of pixels.

use super::cast::Glimpse;
use glam::Vec3;

/// No triangle.
pub(super) const NOTHING: u32 = u32::MAX;
/// A solid instead.
pub(super) const SOLID: u32 = u32::MAX - 1;
/// Part of a pixel over which something thin passes on into the next one.
const SOFTNESS: f32 = 0.75;
/// Points along the side of a pixel at which it is counted how many thin triangles lie on each other.
pub(super) const POINTS: usize = 8;
/// Distance from a crack within which solid samples are looked for, in samples.
const WIDEST_CRACK: isize = 4;

/// A sample that only a thin triangle covers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crack {
    pub(super) column: usize,
    /// Within the strip.
    pub(super) row: usize,
    pub(super) member: u32,
    pub(super) nearness: f32,
}

/// Sums over the thin triangles of a pixel.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Thin {
    /// Colour times area of those that are seen.
    color: Vec3,
    /// That area, pixels.
    seen: f32,
    /// Area of all that nothing solid hides, pixels.
    area: f32,
    /// A bit for each of the pixel's points that lies in one of them or more.
    points: u64,
    /// Those with nothing solid behind them.
    open: u64,
    /// Number of times that points lie in one.
    hits: u32,
}

impl Thin {
    /// Counts a point, by its column and row in the pixel; it is `open` if nothing solid is behind it.
    #[inline]
    pub(super) fn hit(&mut self, column: usize, row: usize, open: bool) {
        let point = 1 << (row * POINTS + column);
        self.points |= point;
        self.open |= if open { point } else { 0 };
        self.hits += 1;
    }

    /// Mean colour, and the part that is covered of what nothing solid covers, `holes` of the pixel; of all if there is none.
    /// Areas side by side add up, areas on each other do not.
    #[inline]
    pub(super) fn cover(&self, holes: f32) -> Option<(Vec3, f32)> {
        let once = match self.hits {
            0 => 1.0,
            hits if holes > 0.0 => self.open.count_ones() as f32 / (hits as f32 * holes),
            hits => self.points.count_ones() as f32 / hits as f32,
        };
        (self.seen > 0.0).then(|| (self.color / self.seen, (self.area * once).min(1.0)))
    }
}

/// Some rows of samples, and the pixels they make.
pub(super) struct Strip {
    pub(super) top: usize,
    pub(super) rows: usize,
    /// Nearness of solid triangles.
    pub(super) solid: Vec<f32>,
    pub(super) facets: Vec<u32>,
    /// Nearness of all triangles.
    pub(super) nearest: Vec<f32>,
    /// Thin parts, per pixel.
    pub(super) over: Vec<Thin>,
    /// Pixels in a row.
    pub(super) width: usize,
    /// Visible points of the solid, where it is nearest; empty without one.
    pub(super) seen: Vec<Glimpse>,
}

impl Strip {
    /// A strip of this number of samples, with `samples` of them per pixel in each direction.
    pub(super) fn new(columns: usize, rows: usize, samples: usize) -> Self {
        let width = columns / samples;
        Self {
            top: 0,
            rows,
            solid: vec![f32::NEG_INFINITY; columns * rows],
            facets: vec![NOTHING; columns * rows],
            nearest: vec![f32::NEG_INFINITY; columns * rows],
            over: vec![Thin::default(); width * (rows / samples)],
            width,
            seen: Vec::new(),
        }
    }

    pub(super) fn clear(&mut self, top: usize, rows: usize) {
        (self.top, self.rows) = (top, rows);
        self.solid.fill(f32::NEG_INFINITY);
        self.facets.fill(NOTHING);
        self.over.fill(Thin::default());
    }

    /// The sample at a place, or the nearest to it of the strip.
    pub(super) fn sample(&self, place: Vec3, columns: usize) -> usize {
        let column = (place.x.max(0.0) as usize).min(columns - 1);
        let row = ((place.y - self.top as f32).max(0.0) as usize).min(self.rows - 1);
        row * columns + column
    }

    /// Lays an area, in samples, over the four pixels around a place; of no colour if it is not seen.
    pub(super) fn lay(&mut self, place: Vec3, area: f32, color: Option<Vec3>, samples: usize) {
        let scale = 1.0 / samples as f32;
        let width = self.width;
        let (x, y) = (place.x * scale - 0.5, (place.y - self.top as f32) * scale - 0.5);
        let pass = |fraction: f32| ((fraction - 0.5) / SOFTNESS + 0.5).clamp(0.0, 1.0);
        let (left, above) = (x.floor(), y.floor());
        let (right_share, lower_share) = (pass(x - left), pass(y - above));
        let height = (self.rows / samples) as f32;
        let coverage = area * scale * scale;
        for (row, vertical) in [(above, 1.0 - lower_share), (above + 1.0, lower_share)] {
            for (column, horizontal) in [(left, 1.0 - right_share), (left + 1.0, right_share)] {
                if row >= 0.0 && row < height && column >= 0.0 && column < width as f32 {
                    let share = coverage * vertical * horizontal;
                    let thin = &mut self.over[row as usize * width + column as usize];
                    thin.area += share;
                    if let Some(color) = color {
                        thin.color += color * share;
                        thin.seen += share;
                    }
                }
            }
        }
    }

    /// Makes cracks solid that have solid samples close behind and before them, in one of four directions: narrow triangles
    /// between wide ones. Of several in one place the nearest.
    pub(super) fn close(&mut self, cracks: Vec<Crack>, columns: usize, bias: impl Fn(f32) -> f32) {
        let rows = self.rows;
        let is_solid = |crack: &Crack, (right, down): (isize, isize)| {
            (1..=WIDEST_CRACK).any(|step| {
                let column = crack.column.checked_add_signed(right * step).filter(|&column| column < columns);
                let row = crack.row.checked_add_signed(down * step).filter(|&row| row < rows);
                let at = column.zip(row).map(|(column, row)| row * columns + column);
                at.is_some_and(|at| {
                    self.facets[at] < SOLID && (self.solid[at] - crack.nearness).abs() < bias(crack.nearness)
                })
            })
        };
        let is_narrow = |crack: &Crack| {
            let ways = [(1, 0), (0, 1), (1, 1), (1, -1)];
            ways.into_iter().any(|(x, y)| is_solid(crack, (x, y)) && is_solid(crack, (-x, -y)))
        };
        let narrow: Vec<Crack> = cracks.into_iter().filter(is_narrow).collect();
        for Crack { column, row, member, nearness } in narrow {
            let at = row * columns + column;
            if nearness > self.solid[at] {
                (self.solid[at], self.facets[at]) = (nearness, member);
            }
        }
    }
}
