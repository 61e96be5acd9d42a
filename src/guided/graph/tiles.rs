//! Poisson-disc nodes, tile by tile.

use super::GraphError;
use super::bvh::morton;
use crate::observer::{Observer, Work, report};
use crate::parallel;
use crate::random::{Purpose, stream};
use crate::shape::{Bounds, Shape};
use glam::{IVec3, Vec3};
use rand::{Rng, RngExt};

/// Candidates tried around a node before it is given up.
const TRIES: u32 = 10;
/// Cells around a tile that hold nodes within r of it.
const HALO: i32 = 2;
const NOWHERE: Vec3 = Vec3::INFINITY;

/// Discs to place. Options are in range.
pub(super) struct Discs<'a> {
    pub(super) region: &'a dyn Shape,
    /// Nodes that are there already, as near to each other as they like; the others keep away from them.
    pub(super) fixed: &'a [Vec3],
    /// r, metres.
    pub(super) spacing: f32,
    pub(super) planar: bool,
}

impl Discs<'_> {
    /// The fixed nodes, then all others in Morton order.
    pub(super) fn place(&self, seed: u64, observer: &dyn Observer) -> Result<Vec<Vec3>, GraphError> {
        Plan::new(self, seed).nodes(observer)
    }
}

/// The lattice of cells and tiles over the region.
///
/// A cell's diagonal is a hair below r, so it holds one placed node at the most. Tiles of the same colour (2 x 2 x 2
/// colours) are more than r apart and are filled independently, each from its own random stream.
struct Plan<'a> {
    region: &'a dyn Shape,
    fixed: &'a [Vec3],
    seed: u64,
    planar: bool,
    r: f32,
    origin: Vec3,
    cell: f32,
    /// 1 / cell.
    per_cell: f32,
    /// Cells along each axis of a tile.
    tile: IVec3,
    tiles: IVec3,
    /// Cells within reach of a node, the nearest first.
    reach: Vec<IVec3>,
}

impl<'a> Plan<'a> {
    fn new(discs: &Discs<'a>, seed: u64) -> Self {
        let &Discs { region, fixed, spacing: r, planar } = discs;
        let bounds = region.bounds();
        let cell = r / if planar { 2f32 } else { 3f32 }.sqrt() * 0.9999;
        let origin = if planar { bounds.min.with_z(-0.5 * cell) } else { bounds.min };
        let tile = if planar { IVec3::new(32, 32, 1) } else { IVec3::splat(16) };
        let cells = (bounds.size() / cell).floor().as_ivec3() + IVec3::ONE;
        let cells = if planar { cells.with_z(1) } else { cells };
        let flat = if planar { 0 } else { HALO };
        let mut reach: Vec<IVec3> = (-HALO..=HALO)
            .flat_map(|x| (-HALO..=HALO).flat_map(move |y| (-flat..=flat).map(move |z| IVec3::new(x, y, z))))
            // The gap between two cells, in cells; r is a hair above the diagonal.
            .filter(|d| {
                let gap = (d.abs() - 1).max(IVec3::ZERO);
                gap.length_squared() < if planar { 2 } else { 3 }
            })
            .collect();
        reach.sort_by_key(|d| d.length_squared());
        Self {
            region,
            fixed,
            seed,
            planar,
            r,
            origin,
            cell,
            per_cell: 1.0 / cell,
            tile,
            tiles: (cells + tile - 1) / tile,
            reach,
        }
    }

    fn cell_of(&self, p: Vec3) -> IVec3 {
        const DETOUR: i32 = 8;
        ((p - self.origin) * self.per_cell + DETOUR as f32).as_ivec3() - DETOUR
    }

    fn nodes(&self, observer: &dyn Observer) -> Result<Vec<Vec3>, GraphError> {
        report(observer, Work::Nodes, 0.0)?;
        let count = self.tiles.element_product() as usize;
        let at = |index: usize| {
            let (i, n) = (index as i32, self.tiles);
            IVec3::new(i % n.x, i / n.x % n.y, i / n.x / n.y)
        };
        let index = |place: IVec3| ((place.z * self.tiles.y + place.y) * self.tiles.x + place.x) as usize;
        let mut fixed: Vec<Vec<Vec3>> = vec![Vec::new(); count];
        for &node in self.fixed {
            let place = (self.cell_of(node) / self.tile).clamp(IVec3::ZERO, self.tiles - 1);
            fixed[index(place)].push(node);
        }
        let mut filled: Vec<Vec<Vec3>> = vec![Vec::new(); count];
        let colors = if self.planar { 4 } else { 8 };
        for color in 0..colors {
            let phase: Vec<usize> = (0..count)
                .filter(|&index| {
                    let tile = at(index) & 1;
                    tile.x | tile.y << 1 | tile.z << 2 == color && self.touches(at(index))
                })
                .collect();
            let nodes = parallel::map(phase.len(), |i| {
                let place = at(phase[i]);
                let around = self.around(place).flat_map(|near| [&filled[index(near)], &fixed[index(near)]]);
                Tile::new(self, place).fill(phase[i] as u64, around.flatten().copied())
            });
            for (index, nodes) in phase.into_iter().zip(nodes) {
                filled[index] = nodes;
            }
            report(observer, Work::Nodes, (color + 1) as f32 / colors as f32)?;
        }
        let mut order: Vec<usize> = (0..count).filter(|&index| !filled[index].is_empty()).collect();
        order.sort_by_key(|&index| morton(at(index).as_vec3().to_array()));
        let mut nodes = Vec::with_capacity(self.fixed.len() + filled.iter().map(Vec::len).sum::<usize>());
        nodes.extend_from_slice(self.fixed);
        nodes.extend(order.into_iter().flat_map(|index| std::mem::take(&mut filled[index])));
        Ok(nodes)
    }

    /// `true` if any of the region can lie in a tile.
    fn touches(&self, place: IVec3) -> bool {
        let corner = |place: IVec3| self.origin + (place * self.tile).as_vec3() * self.cell;
        self.region.touches(Bounds::new(corner(place), corner(place + 1)))
    }

    /// The tile itself and those around it.
    fn around(&self, place: IVec3) -> impl Iterator<Item = IVec3> {
        let tiles = self.tiles;
        (-1..=1)
            .flat_map(|x| (-1..=1).flat_map(move |y| (-1..=1).map(move |z| IVec3::new(x, y, z))))
            .map(move |d| place + d)
            .filter(move |p| p.cmpge(IVec3::ZERO).all() && p.cmplt(tiles).all())
    }
}

/// A tile being filled, with the halo of cells around it.
struct Tile<'a> {
    plan: &'a Plan<'a>,
    /// The tile's first cell.
    first: IVec3,
    /// Cells along each axis, halo included.
    dims: IVec3,
    halo: IVec3,
    /// The node in each cell, or [`NOWHERE`].
    grid: Vec<Vec3>,
    /// Nodes around which there may be room.
    active: Vec<Vec3>,
    /// Offsets in `grid` of the cells within reach.
    reach: Vec<i32>,
    /// Fixed nodes that share a cell with another one.
    crowd: Vec<Vec3>,
    fresh: Vec<Vec3>,
}

impl<'a> Tile<'a> {
    fn new(plan: &'a Plan<'a>, place: IVec3) -> Self {
        let halo = if plan.planar { IVec3::new(HALO, HALO, 0) } else { IVec3::splat(HALO) };
        let dims = plan.tile + 2 * halo;
        let reach = plan.reach.iter().map(|d| (d.z * dims.y + d.y) * dims.x + d.x).collect();
        Self {
            plan,
            first: place * plan.tile,
            dims,
            halo,
            grid: vec![NOWHERE; dims.element_product() as usize],
            active: Vec::new(),
            reach,
            crowd: Vec::new(),
            fresh: Vec::new(),
        }
    }

    /// The cell in this tile's grid, if it is in the tile or its halo.
    fn slot(&self, cell: IVec3) -> Option<usize> {
        let local = cell - self.first + self.halo;
        let within = local.cmpge(IVec3::ZERO).all() && local.cmplt(self.dims).all();
        within.then(|| ((local.z * self.dims.y + local.y) * self.dims.x + local.x) as usize)
    }

    fn owns(&self, cell: IVec3) -> bool {
        cell.cmpge(self.first).all() && cell.cmplt(self.first + self.plan.tile).all()
    }

    /// All nodes of this tile, in Morton order of their cells.
    fn fill(mut self, stream_index: u64, around: impl Iterator<Item = Vec3>) -> Vec<Vec3> {
        // A cheap test first: most nodes of the tiles around are far from this one.
        let reach = self.plan.cell * (HALO as f32 + 0.1);
        let corner = |cell: IVec3| self.plan.origin + cell.as_vec3() * self.plan.cell;
        let (low, high) = (corner(self.first) - reach, corner(self.first + self.plan.tile) + reach);
        for node in around.filter(|node| node.cmpge(low).all() && node.cmple(high).all()) {
            if let Some(slot) = self.slot(self.plan.cell_of(node)) {
                if self.grid[slot] == NOWHERE {
                    self.grid[slot] = node;
                } else {
                    self.crowd.push(node);
                }
                self.active.push(node);
            }
        }
        let mut random = stream(self.plan.seed, 0, Purpose::NODES, stream_index);
        self.spread(&mut random);
        self.sweep(&mut random);
        let first = self.first;
        let mut nodes = std::mem::take(&mut self.fresh);
        nodes.sort_by_cached_key(|&node| morton((self.plan.cell_of(node) - first).as_vec3().to_array()));
        nodes
    }

    fn place(&mut self, node: Vec3) {
        if let Some(slot) = self.slot(self.plan.cell_of(node)) {
            self.grid[slot] = node;
            self.active.push(node);
            self.fresh.push(node);
        }
    }

    /// `true` if a node may stand at `p`: in this tile and the region, and no nearer than r to
    /// another.
    fn is_free(&self, p: Vec3) -> bool {
        let cell = self.plan.cell_of(p);
        self.owns(cell) && !self.is_covered(p, cell) && self.plan.region.contains(p)
    }

    #[inline]
    fn is_covered(&self, p: Vec3, cell: IVec3) -> bool {
        let Some(slot) = self.slot(cell) else { return true };
        let r_squared = self.plan.r * self.plan.r;
        let near = |node: &Vec3| node.distance_squared(p) < r_squared;
        self.reach.iter().any(|&offset| near(&self.grid[(slot as i32 + offset) as usize]))
            || self.crowd.iter().any(near)
    }

    /// Bridson's algorithm with candidates on the sphere of radius r itself, around the newest node first: denser
    /// packing than candidates between r and 2r, and fewer of them fail.
    fn spread(&mut self, random: &mut impl Rng) {
        let reach = self.plan.r * 1.000_01;
        while let Some(&node) = self.active.last() {
            let found = (0..TRIES)
                .map(|_| node + direction(random, self.plan.planar) * reach)
                .find(|&candidate| self.is_free(candidate));
            match found {
                Some(candidate) => self.place(candidate),
                None => {
                    self.active.pop();
                }
            }
        }
    }

    /// Makes sure that no ball of radius 2r inside the region is empty.
    ///
    /// The centre c of such a ball lies in a block of 2 x 2 x 2 cells whose diagonal is 2r. If the block holds
    /// a node, it is within 2r of c. If not, the block's centre is within r of c, hence in the region, and we
    /// make sure that a node lies within r of it. Random points in empty blocks first: they find parts of the
    /// region that no node leads to, and leave fewer nodes on the lattice.
    fn sweep(&mut self, random: &mut impl Rng) {
        let blocks = (self.plan.tile + 1) / 2;
        let span = self.plan.cell * 2.0;
        let bounds = self.plan.region.bounds();
        let (flat, depth) = if self.plan.planar { (Vec3::new(1.0, 1.0, 0.0), 1) } else { (Vec3::ONE, 2) };
        for block in 0..blocks.element_product() {
            let place =
                IVec3::new(block % blocks.x, block / blocks.x % blocks.y, block / blocks.x / blocks.y);
            let first = self.first + place * 2;
            let empty = (0..4 * depth).all(|i| {
                let cell = first + IVec3::new(i & 1, i >> 1 & 1, i >> 2);
                self.slot(cell).is_none_or(|slot| self.grid[slot] == NOWHERE)
            });
            if !empty {
                continue;
            }
            let corner = self.plan.origin + first.as_vec3() * self.plan.cell;
            // Tiles stick out of the region's bounds.
            if corner.cmpgt(bounds.max).any() {
                continue;
            }
            let corner = if self.plan.planar { corner.with_z(0.0) } else { corner };
            for attempt in 0..3 {
                let within = if attempt < 2 {
                    Vec3::new(random.random(), random.random(), random.random())
                } else {
                    Vec3::splat(0.5)
                };
                let candidate = corner + within * flat * span;
                if self.is_free(candidate) {
                    self.place(candidate);
                    self.spread(random);
                    break;
                }
            }
        }
    }
}

/// A random unit vector (Marsaglia 1972), in the plane z = 0 if planar.
pub(super) fn direction(random: &mut impl Rng, planar: bool) -> Vec3 {
    loop {
        let bits = random.next_u64();
        // Two 31-bit fractions in [-1, 1).
        let x = (bits as u32).cast_signed() as f32 * (1.0 / 2_147_483_648.0);
        let y = ((bits >> 32) as u32).cast_signed() as f32 * (1.0 / 2_147_483_648.0);
        let s = x * x + y * y;
        if !(1e-12..1.0).contains(&s) {
            continue;
        }
        if planar {
            return Vec3::new(x, y, 0.0) / s.sqrt();
        }
        let across = 2.0 * (1.0 - s).sqrt();
        return Vec3::new(x * across, y * across, 1.0 - 2.0 * s);
    }
}
