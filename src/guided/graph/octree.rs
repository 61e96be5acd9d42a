//! Poisson-disc nodes of varying spacing: a tree of tiles, each as large as some discs that it holds.

use super::GraphError;
use super::leaf::Tile;
use super::spacing::Spacing;
use crate::observer::{Observer, Work, report};
use crate::parallel;
use crate::shape::{Bounds, Shape};
use glam::{IVec3, Vec3};

/// The most cells along an axis of a tile, where the spacing lets it be divided.
const CELLS: f32 = 20.0;

/// Plan of the nodes' places. Options are in range.
pub(super) struct Octree<'a> {
    pub(super) region: &'a dyn Shape,
    pub(super) spacing: &'a Spacing,
    /// The corner and the side of the cube around the region.
    origin: Vec3,
    side: f32,
    branches: Vec<Branch>,
    leaves: Vec<Leaf>,
    /// Offsets of cells, those nearest to a cell first, with the square of the gap between both, in cells.
    pub(super) reach: Vec<(f32, IVec3)>,
}

#[derive(Clone, Copy)]
enum Branch {
    /// None of the region.
    Empty,
    /// The number of the first of eight.
    Inner(usize),
    /// The number of a leaf.
    Leaf(usize),
}

/// A tile: a cube of cells whose diagonal is a hair below the least spacing in it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leaf {
    pub(super) bounds: Bounds,
    /// The least and the largest spacing in it.
    pub(super) low: f32,
    pub(super) high: f32,
    /// Along each axis; even.
    pub(super) cells: i32,
    level: u32,
    color: usize,
}

impl<'a> Octree<'a> {
    pub(super) fn new(region: &'a dyn Shape, spacing: &'a Spacing) -> Self {
        let bounds = region.bounds();
        let side = bounds.size().max_element() * 1.000_01;
        let mut tree = Self {
            region,
            spacing,
            origin: bounds.min,
            side,
            branches: vec![Branch::Empty],
            leaves: Vec::new(),
            reach: Vec::new(),
        };
        tree.grow(0, IVec3::ZERO, 0, spacing.extremes().1);
        let far = tree.leaves.iter().map(Leaf::reach).fold(0.0, f32::max);
        let around = far.ceil() as i32;
        let line = || -around..=around;
        tree.reach = line()
            .flat_map(|x| line().flat_map(move |y| line().map(move |z| IVec3::new(x, y, z))))
            .map(|d| ((d.abs() - 1).max(IVec3::ZERO).length_squared() as f32, d))
            .filter(|&(gap, _)| gap < far * far)
            .collect();
        tree.reach.sort_by(|(a, d), (b, e)| a.total_cmp(b).then(d.length_squared().cmp(&e.length_squared())));
        tree
    }

    /// Tiles are divided until they have few cells, and never below the largest spacing in them: tiles of one level
    /// and colour are a tile apart and can be filled in any order.
    fn grow(&mut self, branch: usize, place: IVec3, level: u32, largest: f32) {
        let side = self.side / (1u32 << level) as f32;
        let corner = self.origin + place.as_vec3() * side;
        let bounds = Bounds::new(corner, corner + side);
        if self.region.bounds().intersection(bounds).is_empty() || !self.region.touches(bounds) {
            return;
        }
        let cells = |low: f32| side * 3f32.sqrt() / (low * 0.9999);
        let divides = |low: f32, high: f32| cells(low) > CELLS && high <= 0.5 * side;
        if !divides(largest, largest) {
            let (low, high) = self.spacing.range(bounds);
            if !divides(low, high) {
                let parity = place & 1;
                self.branches[branch] = Branch::Leaf(self.leaves.len());
                self.leaves.push(Leaf {
                    bounds,
                    low,
                    high,
                    cells: 2 * (cells(low) * 0.5).ceil() as i32,
                    level,
                    color: (parity.x | parity.y << 1 | parity.z << 2) as usize,
                });
                return;
            }
        }
        let first = self.branches.len();
        self.branches[branch] = Branch::Inner(first);
        self.branches.resize(first + 8, Branch::Empty);
        for child in 0..8 {
            let octant = IVec3::new(child & 1, child >> 1 & 1, child >> 2);
            self.grow(first + child as usize, place * 2 + octant, level + 1, largest);
        }
    }

    /// The fixed nodes, as near to each other as they like, then all others, tile by tile in Morton order. The others keep
    /// away from the fixed ones; O(f) per tile for f of these.
    ///
    /// Large tiles come first, so that few nodes of others lie within reach of those that follow.
    pub(super) fn nodes(
        &self,
        fixed: &[Vec3],
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<Vec<Vec3>, GraphError> {
        report(observer, Work::Nodes, 0.0)?;
        let mut order: Vec<usize> = (0..self.leaves.len()).collect();
        let phase = |leaf: usize| (self.leaves[leaf].level, self.leaves[leaf].color);
        order.sort_by_key(|&leaf| phase(leaf));
        let mut filled: Vec<Vec<Vec3>> = vec![Vec::new(); self.leaves.len()];
        let mut done = 0;
        for leaves in order.chunk_by(|&a, &b| phase(a) == phase(b)) {
            let nodes = parallel::map(leaves.len(), |i| {
                let tile = Tile::new(self, self.leaves[leaves[i]]);
                let (low, high) = tile.surroundings();
                let within = |node: &&Vec3| node.cmpge(low).all() && node.cmple(high).all();
                let mut around: Vec<Vec3> = fixed.iter().filter(within).copied().collect();
                self.visit(0, IVec3::ZERO, 0, Bounds::new(low, high), &mut |leaf| {
                    around.extend_from_slice(&filled[leaf]);
                });
                tile.fill(seed, leaves[i] as u64, &around)
            });
            for (&leaf, nodes) in leaves.iter().zip(nodes) {
                filled[leaf] = nodes;
            }
            done += leaves.len();
            report(observer, Work::Nodes, done as f32 / order.len() as f32)?;
        }
        let mut nodes = Vec::with_capacity(fixed.len() + filled.iter().map(Vec::len).sum::<usize>());
        nodes.extend_from_slice(fixed);
        nodes.extend(filled.into_iter().flatten());
        Ok(nodes)
    }

    /// Calls `f` with every leaf that reaches into a box.
    fn visit(&self, branch: usize, place: IVec3, level: u32, within: Bounds, f: &mut impl FnMut(usize)) {
        let side = self.side / (1u32 << level) as f32;
        let corner = self.origin + place.as_vec3() * side;
        if Bounds::new(corner, corner + side).intersection(within).is_empty() {
            return;
        }
        match self.branches[branch] {
            Branch::Empty => {}
            Branch::Leaf(leaf) => f(leaf),
            Branch::Inner(first) => {
                for child in 0..8 {
                    let octant = IVec3::new(child & 1, child >> 1 & 1, child >> 2);
                    self.visit(first + child as usize, place * 2 + octant, level + 1, within, f);
                }
            }
        }
    }
}

impl Leaf {
    /// Side of a cell, metres.
    pub(super) fn cell(&self) -> f32 {
        (self.bounds.max.x - self.bounds.min.x) / self.cells as f32
    }

    /// The largest spacing, in cells.
    pub(super) fn reach(&self) -> f32 {
        self.high / self.cell()
    }
}
