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

/// The points that are not ground, and whether there is any. O(n log n).
pub(super) fn without_ground(points: &[Vec3]) -> (Vec<u32>, bool) {
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
    let all = || (0..points.len() as u32).collect();
    if cells < CELLS {
        return (all(), false);
    }
    let above = |point: &&u32| {
        let point = points[**point as usize];
        surface.get(&cell(point)).is_none_or(|ground| point.y - ground > THICK)
    };
    let which: Vec<u32> = all();
    (which.iter().filter(above).copied().collect(), true)
}

/// A trunk in a slice of a cloud.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Trunk {
    /// The middle of its lowest nodes.
    pub(super) base: Vec3,
    /// Nodes of the slice.
    pub(super) nodes: usize,
}

/// The things that stand in the slice of nodes from `low` up to `high`, the one of most nodes first.
pub(super) fn trunks(positions: &[Vec3], low: f32, high: f32) -> Vec<Trunk> {
    const SIDE: f32 = 0.1;
    let mut cells: BTreeMap<Cell, Vec<u32>> = BTreeMap::new();
    for (node, position) in (0_u32..).zip(positions).filter(|(_, p)| p.y >= low && p.y <= high) {
        let at = ((position.x / SIDE).floor() as i32, (position.z / SIDE).floor() as i32);
        cells.entry(at).or_default().push(node);
    }
    let mut found = Vec::new();
    while let Some((first, nodes)) = cells.pop_first() {
        let (mut all, mut stack) = (nodes, vec![first]);
        while let Some((x, z)) = stack.pop() {
            for beside in (-1..=1).flat_map(|dx| (-1..=1).map(move |dz| (x + dx, z + dz))) {
                if let Some(nodes) = cells.remove(&beside) {
                    all.extend(nodes);
                    stack.push(beside);
                }
            }
        }
        let lowest = all.iter().map(|&node| positions[node as usize].y).fold(f32::INFINITY, f32::min);
        let at_base: Vec<Vec3> = all
            .iter()
            .map(|&node| positions[node as usize])
            .filter(|p| p.y <= lowest + 0.5 * (high - low))
            .collect();
        let middle = at_base.iter().sum::<Vec3>() / at_base.len() as f32;
        found.push(Trunk { base: middle.with_y(lowest), nodes: all.len() });
    }
    found.sort_by_key(|trunk| std::cmp::Reverse(trunk.nodes));
    found
}
