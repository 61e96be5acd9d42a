//! Poisson-disc nodes with Yao edges: the paper's graph.

use super::bvh::morton;
use super::sectors::Sectors;
use super::yao::{Adjacency, yao};
use super::{Graph, GraphBuilder, GraphError};
use crate::observer::{Observer, Work, report};
use crate::parallel;
use crate::parameter::ParameterError;
use crate::random::{Purpose, stream};
use crate::shape::Shape;
use glam::{IVec3, Vec3};
use rand::{Rng, RngExt};
use std::sync::Arc;

/// The graph of section 3.1.1: nodes in a Poisson-disc distribution, edges to the nearest node in each sector.
///
/// No two nodes are nearer than the spacing r, and no ball of radius 2r inside the region is empty. The second
/// promise is kept by construction, not by chance: see `Tile::sweep`. The root is a node; in 2D
/// ([`planar`](Self::planar)) all nodes lie in the plane z = 0 of the region.
///
/// Cost: O(n log n) time, about 75 bytes a node at the peak. With the feature `parallel` tiles of the region
/// are filled on several threads, in phases, and the result is the same to the bit.
///
/// ```
/// use treesynth::{Silent, guided::{GraphBuilder, PoissonYao}, shape::Cuboid, glam::Vec3};
///
/// let region = Cuboid::new(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0));
/// let graph = PoissonYao::new(region).with_nodes(5_000).build(42, &Silent)?;
/// assert!((4_500..5_500).contains(&graph.nodes()));
/// assert_eq!(graph.position(graph.root()), Vec3::ZERO);
/// # Ok::<(), treesynth::guided::GraphError>(())
/// ```
#[derive(Clone)]
pub struct PoissonYao {
    region: Arc<dyn Shape>,
    size: Size,
    planar: bool,
    sectors: usize,
    root: Vec3,
}

#[derive(Debug, Clone, Copy)]
enum Size {
    Nodes(usize),
    Spacing(f32),
}

impl std::fmt::Debug for PoissonYao {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PoissonYao")
            .field("size", &self.size)
            .field("planar", &self.planar)
            .field("sectors", &self.sectors)
            .field("root", &self.root)
            .finish_non_exhaustive()
    }
}

/// Nodes in a cube of side r, far from its border; and what a face of the region adds, in layers of r.
const DENSITY: [f32; 2] = [0.6687, 0.762];
const FACE: f32 = 0.444;
/// Candidates tried around a node before it is given up.
const TRIES: u32 = 10;
/// Nodes and tiles are kept well within 32-bit indices and a machine's memory.
const MAX_NODES: f32 = 2e8;
const MAX_TILES: f32 = 4e6;
/// Edges are numbered in 32 bits.
const MAX_EDGES: f32 = 4e9;

impl PoissonYao {
    /// 150,000 nodes (section 4: "a typical result was created in a graph of 150,000 nodes") in `region`,
    /// 8 sectors, root at the origin.
    pub fn new(region: impl Shape + 'static) -> Self {
        Self {
            region: Arc::new(region),
            size: Size::Nodes(150_000),
            planar: false,
            sectors: 8,
            root: Vec3::ZERO,
        }
    }

    /// About so many nodes, within a few percent; at least 2. The spacing follows from the region's volume.
    pub fn with_nodes(mut self, nodes: usize) -> Self {
        self.size = Size::Nodes(nodes);
        self
    }

    /// The least distance between two nodes, metres: "the branch feature size and the minimum branch tip
    /// spacing".
    pub fn with_spacing(mut self, spacing: f32) -> Self {
        self.size = Size::Spacing(spacing);
        self
    }

    /// All nodes in the plane z = 0 of the region, and sectors that divide that plane.
    pub fn planar(mut self) -> Self {
        self.planar = true;
        self
    }

    /// The number of sectors, in [3, 64]. In 3D, 8 are the octants, other counts the regions nearest to each of
    /// so many directions spread evenly; in 2D they are equal wedges. Fewer than 6 in 3D may leave nodes
    /// unreached.
    pub fn with_sectors(mut self, sectors: usize) -> Self {
        self.sectors = sectors;
        self
    }

    /// Where the root is, metres; it must lie in the region.
    pub fn with_root(mut self, root: Vec3) -> Self {
        self.root = root;
        self
    }

    /// The spacing in metres, given or from the number of nodes and the region's volume (area, if planar).
    ///
    /// # Errors
    /// When an option is out of range or the region is empty.
    pub fn spacing(&self) -> Result<f32, ParameterError> {
        self.region.check()?;
        let bounds = self.region.bounds();
        let size = bounds.size();
        let r = match self.size {
            Size::Spacing(r) => {
                ParameterError::unless(
                    r > 0.0 && r.is_finite(),
                    "PoissonYao.spacing",
                    r,
                    "finite and above 0 m",
                )?;
                r
            }
            Size::Nodes(nodes) => {
                ParameterError::unless(
                    (2..=MAX_NODES as usize).contains(&nodes),
                    "PoissonYao.nodes",
                    nodes,
                    "in [2, 200000000]",
                )?;
                let measure = if self.planar { self.area() } else { self.region.volume() };
                ParameterError::unless(
                    measure > 0.0 && measure.is_finite(),
                    "PoissonYao.region",
                    measure,
                    "a shape whose volume (in 2D: area at z = 0) is above 0 and finite",
                )?;
                self.spacing_for(nodes as f32, measure)
            }
        };
        let measure = if self.planar { self.area() } else { self.region.volume() };
        let nodes = self.nodes_at(r, measure);
        ParameterError::unless(
            nodes <= MAX_NODES,
            "PoissonYao.spacing",
            r,
            "coarse enough for at most 200000000 nodes in the region",
        )?;
        let cells = size / r;
        let box_nodes = if self.planar { cells.x * cells.y } else { cells.element_product() };
        let tiles = box_nodes / if self.planar { 512.0 } else { 780.0 };
        ParameterError::unless(
            tiles <= MAX_TILES
                && cells.max_element() <= 1e6
                && r > bounds.min.abs().max(bounds.max.abs()).max_element() * 1e-6,
            "PoissonYao.spacing",
            r,
            "coarser: at most 3e9 discs in the region's bounds, and above a millionth of their coordinates",
        )?;
        Ok(r)
    }

    /// Nodes at a spacing, by `density (s + FACE)^d`, with s the side, in spacings, of a cube of the region's measure.
    fn nodes_at(&self, spacing: f32, measure: f32) -> f32 {
        let side = self.root_of(measure) / spacing + FACE;
        if self.planar { DENSITY[1] * side * side } else { DENSITY[0] * side * side * side }
    }

    /// The other way around.
    fn spacing_for(&self, nodes: f32, measure: f32) -> f32 {
        let side = self.root_of(nodes / DENSITY[usize::from(self.planar)]) - FACE;
        self.root_of(measure) / side.max(0.5)
    }

    fn root_of(&self, x: f32) -> f32 {
        if self.planar { x.sqrt() } else { crate::math::cbrt(x) }
    }

    /// Area of the region's cut with z = 0, by a lattice of 512 x 512.
    fn area(&self) -> f32 {
        let bounds = self.region.bounds();
        let step = bounds.size() / 512.0;
        let inside = (0..512 * 512)
            .filter(|i| {
                let p = bounds.min + step * Vec3::new((i % 512) as f32 + 0.5, (i / 512) as f32 + 0.5, 0.0);
                self.region.contains(p.with_z(0.0))
            })
            .count();
        inside as f32 * step.x * step.y
    }
}

impl GraphBuilder for PoissonYao {
    fn build(&self, seed: u64, observer: &dyn Observer) -> Result<Graph, GraphError> {
        self.check()?;
        if !self.region.contains(self.root) {
            return Err(GraphError::RootOutside { root: self.root });
        }
        let plan = Plan::new(self, seed)?;
        let positions = plan.nodes(observer)?;
        let root = positions.iter().position(|&p| p == self.root).unwrap_or_default() as u32;
        let Adjacency { starts, targets } =
            yao(&positions, &Sectors::new(self.sectors, self.planar), observer)?;
        Ok(Graph::from_parts(positions, starts, targets, root))
    }

    fn check(&self) -> Result<(), ParameterError> {
        Sectors::check("PoissonYao.sectors", self.sectors)?;
        ParameterError::unless(self.root.is_finite(), "PoissonYao.root", self.root, "finite")?;
        ParameterError::unless(
            !self.planar || self.root.z == 0.0,
            "PoissonYao.root",
            self.root,
            "in the plane z = 0 of a planar graph",
        )?;
        let spacing = self.spacing()?;
        let measure = if self.planar { self.area() } else { self.region.volume() };
        let edges = self.nodes_at(spacing, measure) * self.sectors as f32;
        ParameterError::unless(
            edges < MAX_EDGES,
            "PoissonYao.sectors",
            self.sectors,
            "few enough for at most 4000000000 edges",
        )
    }
}

/// The lattice of cells and tiles over the region.
///
/// A cell's diagonal is a hair below r, so it holds one node at the most. Tiles of the same colour (2 x 2 x 2
/// colours) are more than r apart and are filled independently, each from its own random stream.
struct Plan<'a> {
    region: &'a dyn Shape,
    root: Vec3,
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

/// Cells around a tile that hold nodes within r of it.
const HALO: i32 = 2;
const NOWHERE: Vec3 = Vec3::INFINITY;

impl<'a> Plan<'a> {
    fn new(options: &'a PoissonYao, seed: u64) -> Result<Self, ParameterError> {
        let r = options.spacing()?;
        let planar = options.planar;
        let bounds = options.region.bounds();
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
        Ok(Self {
            region: &*options.region,
            root: options.root,
            seed,
            planar,
            r,
            origin,
            cell,
            per_cell: 1.0 / cell,
            tile,
            tiles: (cells + tile - 1) / tile,
            reach,
        })
    }

    /// Rounds down by a detour over positive numbers: x86-64 alone has no instruction for it. Points lie at most
    /// a few cells below the origin.
    #[inline]
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
        let mut filled: Vec<Vec<Vec3>> = vec![Vec::new(); count];
        let root_tile = self.cell_of(self.root) / self.tile;
        for colour in 0..if self.planar { 4 } else { 8 } {
            let phase: Vec<usize> = (0..count)
                .filter(|&index| {
                    let tile = at(index) & 1;
                    tile.x | tile.y << 1 | tile.z << 2 == colour
                })
                .collect();
            let nodes = parallel::map(phase.len(), |i| {
                let place = at(phase[i]);
                let root = (place == root_tile).then_some(self.root);
                // The root too, so that tiles filled before its own keep away from it.
                let around = self.around(place, &filled).chain([self.root]);
                Tile::new(self, place).fill(phase[i] as u64, root, around)
            });
            for (index, nodes) in phase.into_iter().zip(nodes) {
                filled[index] = nodes;
            }
            report(observer, Work::Nodes, (colour + 1) as f32 / if self.planar { 4.0 } else { 8.0 })?;
        }
        let mut order: Vec<usize> = (0..count).filter(|&index| !filled[index].is_empty()).collect();
        order.sort_by_key(|&index| morton(at(index).as_vec3().to_array()));
        let nodes = order.into_iter().flat_map(|index| std::mem::take(&mut filled[index])).collect();
        Ok(nodes)
    }

    /// The nodes that lie in the tiles around `place` so far.
    fn around<'b>(&self, place: IVec3, filled: &'b [Vec<Vec3>]) -> impl Iterator<Item = Vec3> + 'b {
        let tiles = self.tiles;
        (-1..=1)
            .flat_map(|x| (-1..=1).flat_map(move |y| (-1..=1).map(move |z| IVec3::new(x, y, z))))
            .map(move |d| place + d)
            .filter(move |&p| p != place && p.cmpge(IVec3::ZERO).all() && p.cmplt(tiles).all())
            .flat_map(move |p| &filled[((p.z * tiles.y + p.y) * tiles.x + p.x) as usize])
            .copied()
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
    fn fill(
        mut self,
        stream_index: u64,
        root: Option<Vec3>,
        around: impl Iterator<Item = Vec3>,
    ) -> Vec<Vec3> {
        // A cheap test first: most nodes of the tiles around are far from this one.
        let reach = self.plan.cell * (HALO as f32 + 0.1);
        let corner = |cell: IVec3| self.plan.origin + cell.as_vec3() * self.plan.cell;
        let (low, high) = (corner(self.first) - reach, corner(self.first + self.plan.tile) + reach);
        for node in around.filter(|node| node.cmpge(low).all() && node.cmple(high).all()) {
            if let Some(slot) = self.slot(self.plan.cell_of(node)) {
                self.grid[slot] = node;
                self.active.push(node);
            }
        }
        let mut random = stream(self.plan.seed, 0, Purpose::NODES, stream_index);
        if let Some(root) = root {
            self.place(root);
        }
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

    /// Whether a node may stand at `p`: in this tile and the region, and no nearer than r to another.
    fn is_free(&self, p: Vec3) -> bool {
        let cell = self.plan.cell_of(p);
        self.owns(cell) && !self.is_covered(p, cell) && self.plan.region.contains(p)
    }

    fn is_covered(&self, p: Vec3, cell: IVec3) -> bool {
        let Some(slot) = self.slot(cell) else { return true };
        let r_squared = self.plan.r * self.plan.r;
        self.reach
            .iter()
            .any(|&offset| self.grid[(slot as i32 + offset) as usize].distance_squared(p) < r_squared)
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
fn direction(random: &mut impl Rng, planar: bool) -> Vec3 {
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
