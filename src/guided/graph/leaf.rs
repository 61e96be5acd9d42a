//! A tile of varying spacing, being filled.

use super::bvh::morton;
use super::octree::{Leaf, Octree};
use super::tiles::direction;
use crate::random::{Purpose, stream};
use glam::{IVec3, Vec3};
use rand::{Rng, RngExt};

/// Candidates tried around a node before it is given up.
const TRIES: u32 = 7;
/// No node.
const NONE: u32 = u32::MAX;

/// A tile and the halo of cells around it that hold nodes within the largest spacing of it.
pub(super) struct Tile<'a> {
    tree: &'a Octree<'a>,
    leaf: Leaf,
    cell: f32,
    per_cell: f32,
    halo: i32,
    /// Cells along each axis, halo included.
    dims: i32,
    /// The first node of each cell, or [`NONE`].
    heads: Vec<u32>,
    /// Nodes, each with the next of its cell. Cells of the halo may hold many of a finer tile.
    nodes: Vec<(Vec3, u32)>,
    /// Squares of gaps in metres and offsets in `heads` of the cells within reach, the nearest first.
    reach: Vec<(f32, i32)>,
    /// Nodes around which there may be room.
    active: Vec<Vec3>,
    fresh: Vec<Vec3>,
}

impl<'a> Tile<'a> {
    pub(super) fn new(tree: &'a Octree<'a>, leaf: Leaf) -> Self {
        let (cell, halo) = (leaf.cell(), leaf.reach().ceil() as i32);
        let dims = leaf.cells + 2 * halo;
        let far = leaf.reach() * leaf.reach();
        let within = &tree.reach[..tree.reach.partition_point(|&(gap, _)| gap < far)];
        // A little less, for cells are told by rounded numbers.
        let square = cell * cell * 0.9999;
        Self {
            tree,
            leaf,
            cell,
            per_cell: 1.0 / cell,
            halo,
            dims,
            heads: vec![NONE; (dims * dims * dims) as usize],
            nodes: Vec::new(),
            reach: within.iter().map(|&(gap, d)| (gap * square, (d.z * dims + d.y) * dims + d.x)).collect(),
            active: Vec::new(),
            fresh: Vec::new(),
        }
    }

    /// The box that the tile and its halo lie in.
    pub(super) fn surroundings(&self) -> (Vec3, Vec3) {
        let margin = self.leaf.high * 1.001;
        (self.leaf.bounds.min - margin, self.leaf.bounds.max + margin)
    }

    fn cell_of(&self, p: Vec3) -> IVec3 {
        ((p - self.leaf.bounds.min) * self.per_cell + self.halo as f32).as_ivec3() - self.halo
    }

    fn owns(&self, cell: IVec3) -> bool {
        cell.cmpge(IVec3::ZERO).all() && cell.cmplt(IVec3::splat(self.leaf.cells)).all()
    }

    /// Of a cell of the tile or its halo.
    fn slot(&self, cell: IVec3) -> usize {
        let local = cell + self.halo;
        ((local.z * self.dims + local.y) * self.dims + local.x) as usize
    }

    /// All nodes of this tile, in Morton order of their cells.
    pub(super) fn fill(mut self, seed: u64, stream_index: u64, around: &[Vec3]) -> Vec<Vec3> {
        let (low, high) = self.surroundings();
        let bounds = self.leaf.bounds;
        for &node in around.iter().filter(|node| node.cmpge(low).all() && node.cmple(high).all()) {
            let margin = IVec3::splat(self.halo);
            let cell = self.cell_of(node).clamp(-margin, margin + self.leaf.cells - 1);
            self.insert(node, cell);
            let r = self.tree.spacing.at(node);
            if node.clamp(bounds.min, bounds.max).distance_squared(node) < 0.3 * r * r {
                self.active.push(node);
            }
        }
        let mut random = stream(seed, 0, Purpose::NODES, stream_index);
        self.spread(&mut random);
        self.sweep(&mut random);
        let mut nodes = std::mem::take(&mut self.fresh);
        nodes.sort_by_cached_key(|&node| morton(self.cell_of(node).as_vec3().to_array()));
        nodes
    }

    fn insert(&mut self, node: Vec3, cell: IVec3) {
        let slot = self.slot(cell);
        self.nodes.push((node, self.heads[slot]));
        self.heads[slot] = self.nodes.len() as u32 - 1;
    }

    /// Puts a node at `p` if it may stand there: in this tile and the region, and no nearer than the spacing at `p`
    /// to another.
    fn place(&mut self, p: Vec3) -> bool {
        let cell = self.cell_of(p);
        let free = self.owns(cell)
            && !self.is_covered(p, self.tree.spacing.at(p), cell)
            && self.tree.region.contains(p);
        if free {
            self.insert(p, cell);
            self.active.push(p);
            self.fresh.push(p);
        }
        free
    }

    /// `true` if a node lies within `r` of `p`, which is in a cell of the tile.
    #[inline]
    fn is_covered(&self, p: Vec3, r: f32, cell: IVec3) -> bool {
        let (slot, square) = (self.slot(cell) as i32, r * r);
        for &(gap, offset) in &self.reach {
            if gap >= square {
                break;
            }
            let mut next = self.heads[(slot + offset) as usize];
            while next != NONE {
                let (node, after) = self.nodes[next as usize];
                if node.distance_squared(p) < square {
                    return true;
                }
                next = after;
            }
        }
        false
    }

    /// As in a tile of one spacing: candidates on the sphere around the newest node. The candidate's own spacing
    /// counts, so the sphere bulges to where nodes are farther apart.
    fn spread(&mut self, random: &mut impl Rng) {
        let spacing = self.tree.spacing;
        while let Some(&node) = self.active.last() {
            let r = spacing.at(node);
            let found = (0..TRIES).any(|_| {
                let way = direction(random, false);
                let near = node + way * r;
                if !self.owns(self.cell_of(near)) {
                    return false;
                }
                // The distance from the node that equals the spacing there, if the spacing goes on
                // like this.
                let slope = (spacing.at(near) - r) / r;
                self.place(node + way * (r / (1.0 - slope) * (1.000_01 + 0.01 * slope.abs())))
            });
            if !found {
                self.active.pop();
            }
        }
    }

    /// Makes sure that no ball of radius 2 r(c) around c inside the region is empty.
    ///
    /// With l the least spacing in the tile, c lies in a block of 2 x 2 x 2 cells whose diagonal is 2l. If the block
    /// holds a node, it is within 2l of c. If not, we make sure that the centre of c's cell, at most l/2 from c, has a
    /// node within its own spacing, which is at most r(c) + L l/2 for a spacing that changes by at most L times the
    /// way: within (1.5 + L/2) r(c) of c, and L is below 1. Where the spacing b at the block's centre is at least
    /// (1 + 2L) l, that centre does for all: l + b is at most 2 (b - L l), hence at most 2 r(c).
    fn sweep(&mut self, random: &mut impl Rng) {
        let blocks = self.leaf.cells / 2;
        let bounds = self.tree.region.bounds();
        for block in 0..blocks * blocks * blocks {
            let first = IVec3::new(block % blocks, block / blocks % blocks, block / blocks / blocks) * 2;
            let octants = |i: i32| IVec3::new(i & 1, i >> 1 & 1, i >> 2);
            if (0..8).any(|i| self.heads[self.slot(first + octants(i))] != NONE) {
                continue;
            }
            let corner = self.leaf.bounds.min + first.as_vec3() * self.cell;
            // Tiles stick out of the region's bounds.
            if corner.cmpgt(bounds.max).any() {
                continue;
            }
            let centre = corner + self.cell;
            let anywhere = |random: &mut dyn Rng| {
                corner + Vec3::new(random.random(), random.random(), random.random()) * (2.0 * self.cell)
            };
            let tries = [anywhere(random), anywhere(random)];
            let one = self.tree.spacing.at(centre) >= 1.5 * self.leaf.low;
            let found = tries.into_iter().any(|p| self.place(p))
                || (one && self.place(centre))
                || (!one && (0..8).any(|i| self.place(corner + (octants(i).as_vec3() + 0.5) * self.cell)));
            if found {
                self.spread(random);
            }
        }
    }
}
