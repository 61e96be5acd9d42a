//! Edges as weights see them.

use crate::guided::context::Context;
use crate::guided::fork::Fork;
use crate::math::UP;
use glam::{Vec3, Vec4};

/// Edges whose weights are worked out together.
pub(super) const LANES: usize = 4;

/// An edge of the graph, as seen from a settled node.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Edge<'a> {
    pub(in crate::guided) context: Context<'a>,
    pub(in crate::guided) source: u32,
    /// The node it starts from.
    pub from: u32,
    /// The node it leads to.
    pub to: u32,
    /// Starting point, metres.
    pub start: Vec3,
    /// End point, metres.
    pub end: Vec3,
    /// Unit vector along it.
    pub direction: Vec3,
    /// Its length, metres.
    pub length: f32,
    /// The unit guiding vector of the node it starts from.
    pub vector: Vec3,
    /// Least cost from the tree to the node it starts from.
    pub cost: f32,
    /// Edges from the source of this stage to the node it starts from; 0 on the tree.
    pub hops: u32,
    /// Metres of path from the source of this stage to the node it starts from; 0 on the tree.
    pub path_length: f32,
    /// The stage, from 0.
    pub stage: usize,
    /// The seed of the tree.
    pub seed: u64,
}

/// Edges that start from one node, which is settled: at most 8 of a node's at a time, and only those that may still
/// lead to something cheaper.
#[derive(Debug, Clone, Copy)]
pub struct Star<'a> {
    pub(in crate::guided) context: Context<'a>,
    pub(in crate::guided) from: u32,
    pub(in crate::guided) source: u32,
    pub(in crate::guided) start: Vec3,
    pub(in crate::guided) vector: Vec3,
    pub(in crate::guided) cost: f32,
    pub(in crate::guided) hops: u32,
    pub(in crate::guided) path_length: f32,
    pub(in crate::guided) stage: usize,
    pub(in crate::guided) seed: u64,
    /// The nodes that they lead to, and where those are.
    pub(in crate::guided) ends: &'a [(u32, Vec3)],
}

impl<'a> Star<'a> {
    /// The number of edges.
    pub fn edges(&self) -> usize {
        self.ends.len()
    }

    /// One of the edges.
    ///
    /// # Panics
    /// When there is no edge `i`.
    #[inline]
    pub fn edge(&self, i: usize) -> Edge<'a> {
        let (to, end) = self.ends[i];
        let way = end - self.start;
        let length = way.length();
        Edge {
            context: self.context,
            source: self.source,
            from: self.from,
            to,
            start: self.start,
            end,
            direction: way / length,
            length,
            vector: self.vector,
            cost: self.cost,
            hops: self.hops,
            path_length: self.path_length,
            stage: self.stage,
            seed: self.seed,
        }
    }
}

impl Star<'_> {
    /// [`Edge::guided`] of four edges: the same operations in the same order.
    #[inline]
    pub(super) fn guided(&self, edges: [usize; LANES]) -> [f32; LANES] {
        let ends = edges.map(|i| self.ends[i].1);
        let axis = |coordinate: fn(Vec3) -> f32| Vec4::from(ends.map(coordinate)) - coordinate(self.start);
        let (x, y, z) = (axis(|v| v.x), axis(|v| v.y), axis(|v| v.z));
        let lengths = (x * x + y * y + z * z).sqrt();
        let (x, y, z) = (x / lengths, y / lengths, z / lengths);
        let cosines = x * self.vector.x + y * self.vector.y + z * self.vector.z;
        (lengths * (Vec4::ONE - cosines).max(Vec4::ZERO)).to_array()
    }
}

impl Edge<'static> {
    /// An edge to try a weight with: from node 0, the root of a trunk that points up, at `start` to node 1 at `end`
    /// (metres, not the same place), with a guiding vector of any length but zero. The fields can be set.
    pub fn new(start: Vec3, end: Vec3, vector: Vec3) -> Self {
        let way = end - start;
        Self {
            context: Context::Alone { start, end, root: start, fork: Fork::new(UP) },
            source: 0,
            from: 0,
            to: 1,
            start,
            end,
            direction: way.normalize_or(UP),
            length: way.length(),
            vector: vector.normalize_or(UP),
            cost: 0.0,
            hops: 0,
            path_length: 0.0,
            stage: 0,
            seed: 0,
        }
    }
}

impl Edge<'_> {
    /// The node of the tree that the path to its start comes from; its start itself on the tree.
    pub fn source(&self) -> u32 {
        self.source
    }

    /// The parent branch at the source. O(1); the first call of a stage takes O(n) for the n nodes of the tree.
    pub fn fork(&self) -> Fork {
        self.context.fork(self.source)
    }

    /// Position of the tree's root, metres.
    pub fn root(&self) -> Vec3 {
        self.context.root(self.source)
    }

    /// `true` if it ends one edge away from the tree. O(edges of its end).
    pub fn is_beside_tree(&self) -> bool {
        self.context.is_beside_tree(self.to)
    }

    /// The paper's weight, `d (1 - e·v)`: 0 along the guiding vector, 2d against it.
    #[inline]
    pub fn guided(&self) -> f32 {
        self.length * self.deviation()
    }

    /// `1 - e·v`, in [0, 2], clamped at 0 against rounding.
    #[inline]
    pub fn deviation(&self) -> f32 {
        (1.0 - self.direction.dot(self.vector)).max(0.0)
    }
}
