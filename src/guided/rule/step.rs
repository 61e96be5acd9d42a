//! View that a rule has of a node.

use super::BendAxis;
use crate::guided::context::Context;
use crate::guided::fork::Fork;
use crate::math::{Rotation, UP};
use crate::random::{Purpose, unit};
use glam::Vec3;

/// View that a rule has of a node that has just been settled.
#[must_use]
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Step<'a> {
    pub(in crate::guided) context: Context<'a>,
    /// The node of the tree that the path starts from.
    pub(in crate::guided) source: u32,
    /// The node that gets its vector.
    pub node: u32,
    /// The node before it on its path.
    pub from: u32,
    /// Position of the node, metres.
    pub position: Vec3,
    /// Unit vector along the edge to the node.
    pub edge: Vec3,
    /// Length of that edge, metres.
    pub length: f32,
    /// The unit guiding vector of the node before.
    pub vector: Vec3,
    /// Edges from the source of this stage: 1 at the first node off the tree.
    pub hops: u32,
    /// Metres of path from the source of this stage to the node, the edge to it included.
    pub path_length: f32,
    /// The stage, from 0.
    pub stage: usize,
    /// The seed of the tree.
    pub seed: u64,
}

impl Step<'static> {
    /// A step to try a rule with: the first off the tree, to `position` along `edge` (metres, not zero), where the node
    /// before has the guiding vector `vector` (of any length but zero). Source, root and the node before are one,
    /// node 0, on a trunk that points up; the fields can be set.
    pub fn new(position: Vec3, edge: Vec3, vector: Vec3) -> Self {
        let start = position - edge;
        Self {
            context: Context::Alone { start, end: position, root: start, fork: Fork::new(UP) },
            source: 0,
            node: 1,
            from: 0,
            position,
            edge: edge.normalize_or(UP),
            length: edge.length(),
            vector: vector.normalize_or(UP),
            hops: 1,
            path_length: edge.length(),
            stage: 0,
            seed: 0,
        }
    }

    /// Behind another fork.
    pub fn with_fork(mut self, fork: Fork) -> Self {
        if let Context::Alone { fork: own, .. } = &mut self.context {
            *own = fork;
        }
        self
    }

    /// In a tree whose root is elsewhere, metres.
    pub fn with_root(mut self, root: Vec3) -> Self {
        if let Context::Alone { root: own, .. } = &mut self.context {
            *own = root;
        }
        self
    }
}

impl Step<'_> {
    /// The node of the tree that this path starts from.
    pub fn source(&self) -> u32 {
        self.source
    }

    /// The parent branch at the source. O(1); the first call of a stage takes O(n) for the n nodes of the tree.
    pub fn fork(&self) -> Fork {
        self.context.fork(self.source)
    }

    /// The number, among the graph's [roots](crate::guided::Graph::roots), of the tree that the path starts from. O(1).
    pub fn tree(&self) -> u32 {
        self.context.tree(self.source)
    }

    /// The node before `node` on its path; `None` for a root.
    ///
    /// # Panics
    /// When there is no such node.
    pub fn parent_of(&self, node: u32) -> Option<u32> {
        self.context.parent(node)
    }

    /// Position of `node`, metres.
    ///
    /// # Panics
    /// When there is no such node.
    pub fn position_of(&self, node: u32) -> Vec3 {
        self.context.position(node)
    }

    /// Position of the tree's root, metres.
    pub fn root(&self) -> Vec3 {
        self.context.root(self.source)
    }

    /// A number in [0, 1) that belongs to `node` in this stage, the same whenever it is asked for.
    pub fn random(&self, purpose: Purpose, node: u32) -> f32 {
        unit(self.seed, self.stage as u32, purpose, u64::from(node))
    }

    /// The vector of the node before, turned by `rotation` about `axis`. Where the axis vanishes (a vertical
    /// edge, or a vertical vector) nothing is turned.
    ///
    /// Positive angles turn from up towards the horizontal direction of the edge (of the vector), then down; negative
    /// ones the other way. So where the vector leans to the same side as the edge, a positive angle turns it away
    /// from up. Where an edge leads back against the vector, as irregular graphs have them, it turns it towards up.
    #[inline]
    pub fn bent(&self, rotation: Rotation, axis: BendAxis) -> Vec3 {
        let axis = match axis {
            BendAxis::UpCrossEdge => UP.cross(self.edge),
            BendAxis::UpCrossVector => UP.cross(self.vector),
        };
        let length = axis.length();
        // Below this the direction is mere rounding.
        if length < 1e-5 { self.vector } else { rotation.about(axis / length, self.vector) }
    }
}

/// A node of the tree as it enters a stage.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Source<'a> {
    pub(in crate::guided) context: Context<'a>,
    /// The node.
    pub node: u32,
    /// Position, metres.
    pub position: Vec3,
    /// The unit guiding vector it has; up for the root of a new tree.
    pub vector: Vec3,
    /// The stage that begins, from 0.
    pub stage: usize,
    /// The seed of the tree.
    pub seed: u64,
}

impl Source<'static> {
    /// A source to try a rule with: node 0 at `position`, metres, with a guiding vector of any length but zero, on a
    /// tree rooted at the origin.
    pub fn new(position: Vec3, vector: Vec3, fork: Fork) -> Self {
        let context = Context::Alone { start: position, end: position, root: Vec3::ZERO, fork };
        Self { context, node: 0, position, vector: vector.normalize_or(UP), stage: 0, seed: 0 }
    }
}

impl Source<'_> {
    /// The branch at this node, the parent branch of what leaves it. O(1); the first call of a stage takes O(n) for
    /// the n nodes of the tree.
    pub fn fork(&self) -> Fork {
        self.context.fork(self.node)
    }

    /// The number, among the graph's [roots](crate::guided::Graph::roots), of the tree that it is on. O(1).
    pub fn tree(&self) -> u32 {
        self.context.tree(self.node)
    }

    /// Position of the tree's root, metres.
    pub fn root(&self) -> Vec3 {
        self.context.root(self.node)
    }
}
