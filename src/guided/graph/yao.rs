//! Yao graphs: an edge to the nearest node in each sector (Yao 1977), exactly.

use super::bvh::Bvh;
use super::sectors::Sectors;
use crate::math::cbrt;
use crate::observer::{Cancelled, Observer, Work, report};
use crate::parallel;
use glam::{BVec3, Vec3, Vec4};
use std::sync::OnceLock;

/// Nodes a task works on.
const CHUNK: usize = 2048;
/// Tasks between two reports.
const WAVE: usize = 32;
/// Points that are looked at together.
const LANES: usize = 4;

/// Out-edges of all nodes, flat: node `i` has `targets[starts[i]..starts[i + 1]]`, in the order of the sectors.
pub(super) struct Adjacency {
    pub(super) starts: Vec<u32>,
    pub(super) targets: Vec<u32>,
}

/// The longest edge that may start from a node, metres.
///
/// Without a bound the nearest node of an octant that looks out of the region is wherever the hull comes back into
/// it: on the far side.
#[derive(Debug, Clone, Copy)]
pub(super) enum Reach<'a> {
    /// One for all nodes; infinite for no bound.
    Same(f32),
    /// One for each node.
    Each(&'a [f32]),
}

impl Reach<'_> {
    /// Its square.
    #[inline]
    fn squared(self, node: u32) -> f32 {
        match self {
            Self::Same(reach) => reach * reach,
            Self::Each(reaches) => reaches[node as usize] * reaches[node as usize],
        }
    }
}

/// The reach of edges where nodes are one unit apart: far enough for each of `sectors` sectors to
/// hold as many nodes as an octant within three spacings, nine and a half. In the plane, as an
/// eighth of a turn: 2.7.
pub(super) fn reach_of(sectors: usize, planar: bool) -> f32 {
    let share = (sectors as f32 / 8.0).max(1.0);
    3.0 * if planar { share.sqrt() } else { cbrt(share) }
}

/// The Yao graph of `positions`, which must be finite and distinct. Ties go to the lower number. Edges longer than
/// the reach of the node that they start from are left out.
///
/// Nodes in the surrounding cells of a lattice settle nearly all sectors; what they leave open, mostly sectors
/// that look out of the region or where points are sparse, is searched in a hierarchy of boxes. O(n log n) for points
/// spread evenly.
pub(super) fn yao(
    positions: &[Vec3],
    sectors: &Sectors,
    reach: Reach<'_>,
    observer: &dyn Observer,
) -> Result<Adjacency, Cancelled> {
    report(observer, Work::Edges, 0.0)?;
    // Five cells, of which two lie to each side of a node's own, then reach as far as an edge may.
    let side = match reach {
        Reach::Same(reach) if reach.is_finite() => Some(reach * 0.5),
        _ => None,
    };
    let cells = Cells::new(positions, side);
    let search = Search {
        positions,
        sectors,
        half_spaces: (0..sectors.count()).map(|sector| sectors.half_spaces(sector)).collect(),
        bvh: OnceLock::new(),
        cells,
        reach,
    };
    let mut all = Adjacency {
        starts: Vec::with_capacity(positions.len() + 1),
        targets: Vec::with_capacity(positions.len() * sectors.count().min(8)),
    };
    all.starts.push(0);
    let chunks = positions.len().div_ceil(CHUNK);
    for wave in (0..chunks).step_by(WAVE) {
        let parts = parallel::map(WAVE.min(chunks - wave), |i| {
            let first = (wave + i) * CHUNK;
            search.edges(first..(first + CHUNK).min(positions.len()))
        });
        for part in parts {
            let base = all.targets.len() as u32;
            all.starts.extend(part.starts.iter().map(|start| base + start));
            all.targets.extend(part.targets);
        }
        report(observer, Work::Edges, (wave + WAVE).min(chunks) as f32 / chunks as f32)?;
    }
    Ok(all)
}

struct Search<'a> {
    positions: &'a [Vec3],
    sectors: &'a Sectors,
    half_spaces: Vec<Vec<Vec3>>,
    /// Made when the first sector needs it; where edges are kept short, none does.
    bvh: OnceLock<Bvh<'a>>,
    cells: Option<Cells>,
    reach: Reach<'a>,
}

/// Squared distance and number in one key. The bits of floats that are not negative are in the floats' order, so the
/// smaller key is the nearer node, and the lower number in a tie.
#[inline]
fn key(distance: f32, node: u32) -> u64 {
    u64::from(distance.to_bits()) << 32 | u64::from(node)
}

const NONE: u64 = (f32::INFINITY.to_bits() as u64) << 32 | u32::MAX as u64;

/// The nearest node of each of at most `N` sectors so far.
struct Nearest<const N: usize> {
    keys: [u64; N],
    /// The same for what is not merged yet, each lane by itself, so that none waits for the others.
    lanes: [[u64; N]; LANES],
    count: usize,
}

impl<const N: usize> Nearest<N> {
    #[inline]
    fn offer(&mut self, lane: usize, sector: usize, distance: f32, node: u32) {
        let nearest = &mut self.lanes[lane][sector % N];
        *nearest = key(distance, node).min(*nearest);
    }

    #[inline]
    fn merge(&mut self) {
        for lane in &self.lanes {
            for (key, &other) in self.keys.iter_mut().zip(lane) {
                *key = other.min(*key);
            }
        }
    }

    /// Squared distance and number.
    #[inline]
    fn get(&self, sector: usize) -> (f32, u32) {
        (f32::from_bits((self.keys[sector] >> 32) as u32), self.keys[sector] as u32)
    }

    /// The nodes within a reach, given by its square, in the order of the sectors.
    #[inline]
    fn list(&self, reach: f32, targets: &mut Vec<u32>) {
        let far = NONE.min(key(reach, u32::MAX));
        targets.extend(self.keys[..self.count].iter().filter(|&&key| key < far).map(|&key| key as u32));
    }

    /// The largest squared distance of the octants that cells on these sides in y and z can lie in.
    #[inline]
    fn farthest_octant(&self, y: i32, z: i32) -> f32 {
        let mut far = 0;
        for octant in 0..8 {
            let away = (octant >> 1 & 1 == 0 && y < 0) || (octant >> 1 & 1 == 1 && y > 0);
            let apart = (octant >> 2 == 0 && z < 0) || (octant >> 2 == 1 && z > 0);
            if !away && !apart {
                far = far.max(self.keys[octant % N]);
            }
        }
        f32::from_bits((far >> 32) as u32)
    }

    /// The largest squared distance of all sectors; infinite while one is empty.
    #[inline]
    fn farthest(&self) -> f32 {
        f32::from_bits((self.keys[..self.count].iter().fold(0, |far, &key| far.max(key)) >> 32) as u32)
    }
}

impl Search<'_> {
    /// `starts` holds where the edges of each node end.
    fn edges(&self, nodes: std::ops::Range<usize>) -> Adjacency {
        let mut part = Adjacency {
            starts: Vec::with_capacity(nodes.len()),
            targets: Vec::with_capacity(nodes.len() * self.sectors.count().min(8)),
        };
        for node in nodes {
            let reach = self.reach.squared(node as u32);
            if matches!(self.sectors, Sectors::Octants) {
                self.nearest::<8>(node as u32, reach, octants).list(reach, &mut part.targets);
            } else {
                let sectors_of = |x: Vec4, y: Vec4, z: Vec4| {
                    std::array::from_fn(|i| self.sectors.of(Vec3::new(x[i], y[i], z[i])))
                };
                self.nearest::<64>(node as u32, reach, sectors_of).list(reach, &mut part.targets);
            }
            part.starts.push(part.targets.len() as u32);
        }
        part
    }

    #[inline]
    fn nearest<const N: usize>(
        &self,
        node: u32,
        reach: f32,
        sectors_of: impl Fn(Vec4, Vec4, Vec4) -> [usize; LANES],
    ) -> Nearest<N> {
        let from = self.positions[node as usize];
        let mut nearest = Nearest { keys: [NONE; N], lanes: [[NONE; N]; LANES], count: self.sectors.count() };
        let octants = matches!(self.sectors, Sectors::Octants);
        let mut searched = -1.0;
        if let Some(cells) = &self.cells {
            searched = cells.scan(from, &mut nearest, octants, |nearest, group| {
                let (x, y, z) = (group.x - from.x, group.y - from.y, group.z - from.z);
                let distances = x * x + y * y + z * z;
                let sectors = sectors_of(x, y, z);
                for lane in 0..LANES {
                    let other = group.numbers[lane];
                    // A node is not its own neighbour: NaN is larger than every distance, infinity included.
                    let distance = if other == node { f32::NAN } else { distances[lane] };
                    nearest.offer(lane, sectors[lane], distance, other);
                }
            });
        }
        for sector in 0..nearest.count {
            let found = nearest.get(sector);
            let best = if found.0 <= reach { found } else { (reach, u32::MAX) };
            if best.0 <= searched {
                continue;
            }
            let outside = |min: Vec3, max: Vec3| {
                if octants {
                    return outside_octant(sector, from, min, max);
                }
                self.half_spaces[sector].iter().any(|normal| {
                    let farthest = Vec3::select(normal.cmpgt(Vec3::ZERO), max, min) - from;
                    normal.dot(farthest) < -1e-5 * farthest.abs().max_element()
                })
            };
            let (distance, other) = self.bvh.get_or_init(|| Bvh::new(self.positions)).nearest(
                from,
                best,
                outside,
                |position, other| other != node && self.sectors.of(position - from) == sector,
            );
            nearest.keys[sector] = key(distance, other);
        }
        nearest
    }
}

/// Points side by side, coordinate by coordinate; NaN where there are none.
#[derive(Clone, Copy)]
struct Group {
    x: Vec4,
    y: Vec4,
    z: Vec4,
    numbers: [u32; LANES],
}

/// The octants of four points at once, as [`Sectors::Octants`] numbers them.
#[inline]
fn octants(x: Vec4, y: Vec4, z: Vec4) -> [usize; LANES] {
    let [x, y, z] = [x, y, z].map(|way| way.cmplt(Vec4::ZERO).bitmask());
    std::array::from_fn(|i| (x >> i & 1 | (y >> i & 1) << 1 | (z >> i & 1) << 2) as usize)
}

/// `true` if no point of the box is in the octant of `from`. Exact: signs survive subtraction.
#[inline]
fn outside_octant(octant: usize, from: Vec3, min: Vec3, max: Vec3) -> bool {
    let low = BVec3::new(octant & 1 != 0, octant & 2 != 0, octant & 4 != 0);
    (low & min.cmpge(from) | !low & max.cmplt(from)).any()
}

/// Points sorted into the cells of a lattice, about four per cell where most of them are.
struct Cells {
    min: Vec3,
    side: f32,
    dims: [i32; 3],
    starts: Vec<u32>,
    points: Vec<Group>,
}

impl Cells {
    /// Cells of the given side, or one that makes for about four points per cell. `None` where points are too
    /// uneven for a lattice.
    fn new(positions: &[Vec3], given: Option<f32>) -> Option<Self> {
        let (min, max) = positions
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), &p| (min.min(p), max.max(p)));
        let extent = max - min;
        let cells_at = |side: f32| (extent / side).floor() + Vec3::ONE;
        let mut side = extent.max_element();
        if !(side > 0.0 && side.is_finite()) {
            return None;
        }
        if let Some(given) =
            given.filter(|&given| cells_at(given).element_product() < 16.0 * positions.len() as f32)
        {
            side = given;
        } else {
            while cells_at(side).element_product() < positions.len() as f32 * 0.25 {
                side *= 0.95;
            }
        }
        let n = positions.len() as u64;
        let (mut grid, mut crowding) = Self::counted(positions, min, side, cells_at(side));
        // Finer where most points crowd in few cells, for those are what takes time.
        while crowding > 7 * n
            && given.is_none()
            && cells_at(side * 0.75).element_product() < 16.0 * positions.len() as f32
        {
            side *= 0.75;
            (grid, crowding) = Self::counted(positions, min, side, cells_at(side));
        }
        if crowding > 16 * n {
            return None;
        }
        let cells = grid.starts.len() - 1;
        for cell in 0..cells {
            grid.starts[cell + 1] += grid.starts[cell];
        }
        let mut next = grid.starts.clone();
        let missing = Group { x: Vec4::NAN, y: Vec4::NAN, z: Vec4::NAN, numbers: [0; LANES] };
        grid.points = vec![missing; positions.len().div_ceil(LANES)];
        for (&position, number) in positions.iter().zip(0..) {
            let slot = &mut next[grid.index(grid.cell(position))];
            let (group, i) = (&mut grid.points[*slot as usize / LANES], *slot as usize % LANES);
            (group.x[i], group.y[i], group.z[i]) = position.into();
            group.numbers[i] = number;
            *slot += 1;
        }
        Some(grid)
    }

    /// Cells that are empty yet, but hold how many points will come before each; and the sum of the squares of these.
    fn counted(positions: &[Vec3], min: Vec3, side: f32, dims: Vec3) -> (Self, u64) {
        let dims = dims.to_array().map(|n| n as i32);
        let cells = dims.iter().map(|&n| n as usize).product::<usize>();
        let mut grid = Self { min, side, dims, starts: vec![0; cells + 1], points: Vec::new() };
        for &position in positions {
            let cell = grid.index(grid.cell(position));
            grid.starts[cell + 1] += 1;
        }
        let crowding = grid.starts.iter().map(|&n| u64::from(n) * u64::from(n)).sum();
        (grid, crowding)
    }

    #[inline]
    fn cell(&self, position: Vec3) -> [i32; 3] {
        let cell = ((position - self.min) / self.side).to_array();
        [0, 1, 2].map(|axis| (cell[axis] as i32).min(self.dims[axis] - 1))
    }

    #[inline]
    fn index(&self, [x, y, z]: [i32; 3]) -> usize {
        (((z * self.dims[1]) + y) * self.dims[0] + x) as usize
    }

    /// Offers every point in the 3 x 3 x 3 cells around `from`, then, if that leaves a sector open, in the
    /// 5 x 5 x 5. Returns the squared distance within which no point was missed.
    #[inline]
    fn scan<const N: usize>(
        &self,
        from: Vec3,
        nearest: &mut Nearest<N>,
        octants: bool,
        offer: impl Fn(&mut Nearest<N>, &Group),
    ) -> f32 {
        let [x, y, z] = self.cell(from);
        let inside = (from - self.min) - Vec3::new(x as f32, y as f32, z as f32) * self.side;
        // From the point to the nearest face of its own cell, a little low for rounding.
        let margin = (inside.min(Vec3::splat(self.side) - inside).min_element() - self.side * 1e-4).max(0.0);
        let row = |nearest: &mut Nearest<N>, x0: i32, x1: i32, y: i32, z: i32| {
            let (x0, x1) = (x0.max(0), x1.min(self.dims[0] - 1));
            if y < 0 || z < 0 || y >= self.dims[1] || z >= self.dims[2] || x0 > x1 {
                return;
            }
            let first = self.starts[self.index([x0, y, z])] as usize;
            let last = self.starts[self.index([x1, y, z]) + 1] as usize;
            for group in &self.points[first / LANES..last.div_ceil(LANES)] {
                offer(nearest, group);
            }
        };
        for dz in -1..=1 {
            for dy in -1..=1 {
                row(nearest, x - 1, x + 1, y + dy, z + dz);
            }
        }
        nearest.merge();
        let searched = margin + self.side;
        if nearest.farthest() <= searched * searched {
            return searched * searched;
        }
        // The way to the cells at an offset along an axis, a little short for rounding.
        let way = |offset: i32, inside: f32| match offset {
            0 => 0.0,
            1.. => (offset as f32 * self.side - inside) - self.side * 1e-4,
            _ => ((-1 - offset) as f32 * self.side + inside) - self.side * 1e-4,
        };
        let (left, right) = (way(-2, inside.x), way(2, inside.x));
        for dz in -2i32..=2 {
            for dy in -2i32..=2 {
                let (across, deep) = (way(dy, inside.y), way(dz, inside.z));
                let farthest = if octants { nearest.farthest_octant(dy, dz) } else { nearest.farthest() };
                let reach = farthest - (across * across + deep * deep);
                if reach < 0.0 {
                    continue;
                }
                let (x0, x1) =
                    (x - 1 - i32::from(left * left <= reach), x + 1 + i32::from(right * right <= reach));
                if dy.abs() == 2 || dz.abs() == 2 {
                    row(nearest, x0, x1, y + dy, z + dz);
                    continue;
                }
                if x0 == x - 2 {
                    row(nearest, x0, x0, y + dy, z + dz);
                }
                if x1 == x + 2 {
                    row(nearest, x1, x1, y + dy, z + dz);
                }
            }
        }
        nearest.merge();
        let searched = margin + 2.0 * self.side;
        searched * searched
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::Silent;
    use crate::random::{Purpose, unit};

    fn brute_force(positions: &[Vec3], sectors: &Sectors) -> Vec<Vec<u32>> {
        (0..positions.len())
            .map(|node| {
                let mut best = vec![(f32::INFINITY, u32::MAX); sectors.count()];
                for (other, &position) in positions.iter().enumerate() {
                    if other != node {
                        let to = position - positions[node];
                        let slot = &mut best[sectors.of(to)];
                        if (to.length_squared(), other as u32) < *slot {
                            *slot = (to.length_squared(), other as u32);
                        }
                    }
                }
                best.into_iter().map(|(_, other)| other).filter(|&other| other != u32::MAX).collect()
            })
            .collect()
    }

    fn holds(positions: &[Vec3], sectors: &Sectors) {
        let found = yao(positions, sectors, Reach::Same(f32::INFINITY), &Silent).unwrap();
        for (node, expected) in brute_force(positions, sectors).into_iter().enumerate() {
            let range = found.starts[node] as usize..found.starts[node + 1] as usize;
            assert_eq!(found.targets[range], expected, "node {node}, {sectors:?}");
        }
    }

    fn cloud(count: u64, seed: u64, shape: impl Fn(Vec3) -> Vec3) -> Vec<Vec3> {
        let draw = |i, axis| unit(seed, axis, Purpose::CUSTOM, i);
        (0..count).map(|i| shape(Vec3::new(draw(i, 0), draw(i, 1), draw(i, 2)))).collect()
    }

    #[test]
    fn equals_brute_force_whatever_the_sectors_and_the_cloud() {
        for count in [3, 6, 8, 12, 26] {
            for planar in [false, true] {
                let sectors = Sectors::new(count, planar);
                let flat = if planar { Vec3::new(1.0, 1.0, 0.0) } else { Vec3::ONE };
                // Even, elongated, dense in one corner, and on a lattice where distances tie.
                holds(&cloud(700, 1, |p| p * flat), &sectors);
                holds(&cloud(300, 2, |p| p * Vec3::new(100.0, 1.0, 0.1) * flat), &sectors);
                holds(&cloud(300, 3, |p| p * p * p * p * p * p * p * p * flat), &sectors);
            }
        }
        let lattice: Vec<_> =
            (0..343).map(|i| Vec3::new((i % 7) as f32, (i / 7 % 7) as f32, (i / 49) as f32)).collect();
        holds(&lattice, &Sectors::new(8, false));
    }

    #[test]
    fn small_clouds() {
        for count in 0..10 {
            holds(&cloud(count, 9, |p| p), &Sectors::new(8, false));
        }
        holds(&[Vec3::ZERO, Vec3::X * 1e6, Vec3::X * 1e-6], &Sectors::new(8, false));
    }
}
