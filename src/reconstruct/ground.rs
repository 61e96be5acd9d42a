//! The points of the ground, and the places where trunks come out of it.

use std::collections::BTreeMap;

use glam::Vec3;

/// The side of the cells in which the lowest point is looked for, metres.
const CELL: f32 = 0.25;
/// Greatest slope of ground, metres per metre.
const STEEP: f32 = 0.6;
/// Largest distance of the ground's points from the lowest surface, metres.
const THICK: f32 = 0.12;
/// Cells with ground that make a ground: 1.5 square metres, more than any trunk's base.
const CELLS: usize = 24;

type Cell = (i32, i32);

fn cell(point: Vec3) -> Cell {
    ((point.x / CELL).floor() as i32, (point.z / CELL).floor() as i32)
}

/// The lowest height of each cell of at least four points, leaving out the lowest two and the lowest fiftieth: stray points.
fn lowest(points: &[Vec3]) -> BTreeMap<Cell, f32> {
    let mut heights: Vec<(Cell, f32)> = points.iter().map(|&point| (cell(point), point.y)).collect();
    heights.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let cells = heights.chunk_by(|a, b| a.0 == b.0).filter(|cell| cell.len() > 3);
    cells.map(|cell| (cell[0].0, cell[(cell.len() / 50).max(2)].1)).collect()
}

/// The lowest surface below some points that is nowhere steeper than a slope: as one height per cell.
fn surface(mut lowest: BTreeMap<Cell, f32>) -> BTreeMap<Cell, f32> {
    // The lowest cell first; each may lift its neighbours' bound by a step, as in Dijkstra's algorithm.
    let mut queue: std::collections::BinaryHeap<std::cmp::Reverse<(u32, Cell)>> =
        std::collections::BinaryHeap::new();
    let key = |height: f32| {
        let bits = height.to_bits();
        if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
    };
    for (&at, &height) in &lowest {
        queue.push(std::cmp::Reverse((key(height), at)));
    }
    while let Some(std::cmp::Reverse((bits, at))) = queue.pop() {
        let height = lowest[&at];
        if key(height) != bits {
            continue;
        }
        for (dx, dz, far) in [
            (-1, 0, 1.0),
            (1, 0, 1.0),
            (0, -1, 1.0),
            (0, 1, 1.0),
            (-1, -1, 1.414),
            (-1, 1, 1.414),
            (1, -1, 1.414),
            (1, 1, 1.414),
        ] {
            let beside = (at.0.saturating_add(dx), at.1.saturating_add(dz));
            let most = height + STEEP * CELL * far;
            if let Some(other) = lowest.get_mut(&beside)
                && *other > most
            {
                *other = most;
                queue.push(std::cmp::Reverse((key(most), beside)));
            }
        }
    }
    lowest
}

/// The ground below a cloud, if there is any, and the points above it.
pub(super) struct Ground {
    /// The numbers of the points that are not ground, ascending.
    pub(super) above: Vec<u32>,
    /// Its height in each cell; none without ground.
    surface: BTreeMap<Cell, f32>,
    /// The lowest of these heights; 0 without ground.
    lowest: f32,
}

impl Ground {
    /// All points are above the ground.
    pub(super) fn none(points: &[Vec3]) -> Self {
        Self { above: (0..points.len() as u32).collect(), surface: BTreeMap::new(), lowest: 0.0 }
    }

    /// Finds the points that are ground. O(n log n).
    pub(super) fn found(points: &[Vec3]) -> Self {
        let lowest = lowest(points);
        let surface = surface(lowest.clone());
        // Beside cells that are ground too: twigs that hang low are alone.
        let is_low = |at: &Cell| {
            lowest.get(at).zip(surface.get(at)).is_some_and(|(low, ground)| low - ground < 0.5 * THICK)
        };
        let beside = |at: Cell| {
            let around = [(-1, 0), (1, 0), (0, -1), (0, 1)];
            around.iter().filter(|by| is_low(&(at.0 + by.0, at.1 + by.1))).count() >= 2
        };
        let cells = lowest.keys().filter(|at| is_low(at) && beside(**at)).count();
        if cells < CELLS {
            return Self::none(points);
        }
        let lowest = surface.values().copied().fold(f32::INFINITY, f32::min);
        let mut ground = Self { above: Vec::new(), surface, lowest };
        let is_above = |point: &u32| ground.below(points[*point as usize]).is_none_or(|far| far > THICK);
        ground.above = (0..points.len() as u32).filter(is_above).collect();
        ground
    }

    /// Whether there is ground.
    pub(super) fn is_found(&self) -> bool {
        !self.surface.is_empty()
    }

    /// The height of a place above the ground; where there is none above the lowest, and above 0 without any.
    pub(super) fn height(&self, place: Vec3) -> f32 {
        self.below(place).unwrap_or(place.y - self.lowest)
    }

    /// How far the ground is below a place, metres; `None` where there is none.
    pub(super) fn below(&self, place: Vec3) -> Option<f32> {
        self.surface.get(&cell(place)).map(|ground| place.y - ground)
    }
}
