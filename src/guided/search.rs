//! State of each node while trees grow: costs, paths, guiding vectors, and which are on the tree.

use super::fork::{Fork, Parts};
use super::graph::{Graph, Planted};
use super::queue::Queue;
use crate::math::UP;
use crate::observer::Cancelled;
use crate::skeleton::{Skeleton, SkeletonError};
use glam::Vec3;
use std::ops::Deref;
use std::sync::{Arc, OnceLock};

/// Not a node; also: not on the tree.
pub(super) const NONE: u32 = u32::MAX;

/// The search through one graph and the trees that grow in it: one, or one for each of the graph's roots.
///
/// A tree begins as the root alone. Each stage searches paths from all nodes of the trees, and the paths to some
/// endpoints become part of them. A value can be used for many trees on one graph: what it holds is allocated once,
/// 36 bytes per node; a refinement brings a graph and memory of its own.
#[derive(Debug, Clone)]
pub struct Search<'g> {
    /// The graph that every new tree begins in.
    base: &'g Graph,
    pub(super) graph: Ground<'g>,
    /// The least cost to each node so far, 0 on the tree: what the frontier asks for at every edge.
    pub(super) costs: Vec<f32>,
    /// The node before each on that way.
    pub(super) parents: Vec<u32>,
    /// State that a settled node passes on.
    pub(super) guides: Vec<Guide>,
    /// Index in `tree`, or `NONE`.
    pub(super) place: Vec<u32>,
    /// One bit per node.
    pub(super) on_tree: Vec<u64>,
    /// Nodes of the trees, each after its parent.
    pub(super) tree: Vec<u32>,
    /// Stage in which each node of `tree` joined.
    pub(super) stages: Vec<u16>,
    /// The number of the tree that each node of `tree` is on.
    pub(super) owners: Vec<u32>,
    /// The least radius of each node of `tree`, metres; shorter where none is given for the rest.
    pub(super) radii: Vec<f32>,
    /// The fork at each node of `tree`, worked out when a rule or a weight first asks in a stage.
    pub(super) forks: OnceLock<Vec<Fork>>,
    /// Set when a weight has asked in a stage what lies beside the tree.
    pub(super) asked_beside: OnceLock<()>,
    pub(super) queue: Queue,
    /// One bit per node: the search stops when all of these are settled.
    pub(super) wanted: Vec<u64>,
    pub(super) complete: bool,
    /// Nothing is known of nodes off the tree.
    pub(super) forgotten: bool,
    /// Stages that the graph's own tree has used up.
    pub(super) stages_before: u16,
}

/// The graph that a search runs in: the one it was given, or a finer one of its own.
#[derive(Debug, Clone)]
pub(super) enum Ground<'g> {
    Base(&'g Graph),
    Finer(Arc<Graph>),
}

impl Deref for Ground<'_> {
    type Target = Graph;

    #[inline]
    fn deref(&self) -> &Graph {
        match self {
            Self::Base(graph) => graph,
            Self::Finer(graph) => graph,
        }
    }
}

/// State of a settled node.
#[derive(Debug, Clone, Copy)]
pub(super) struct Guide {
    pub(super) vector: Vec3,
    /// Edges and metres from the source of the stage in which it was settled.
    pub(super) hops: u32,
    pub(super) length: f32,
    /// That source; on the tree the node itself.
    pub(super) source: u32,
}

/// Not settled: no rule may give this vector.
pub(super) const NO_VECTOR: Vec3 = Vec3::NAN;
pub(super) const NO_GUIDE: Guide = Guide { vector: NO_VECTOR, hops: 0, length: 0.0, source: NONE };

/// Fault of a rule or a weight with which no search can go on.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SearchError {
    /// The guiding rule's vector has no direction.
    #[error(
        "stage {stage}: the guiding rule gave node {node} the vector {vector}, but it must be finite and not zero"
    )]
    Vector {
        /// The stage, from 0.
        stage: usize,
        /// The node.
        node: u32,
        /// Vector that the rule returned.
        vector: Vec3,
    },
    /// The weight of an edge is NaN or negative.
    #[error(
        "stage {stage}: the weight function gave edge {from} -> {to} the weight {weight}, but it must be at least 0, or infinite to forbid the edge"
    )]
    Weight {
        /// The stage, from 0.
        stage: usize,
        /// First node of the edge.
        from: u32,
        /// Last node of the edge.
        to: u32,
        /// Weight that the function returned.
        weight: f32,
    },
    /// An endpoint that is not a node of the graph.
    #[error("stage {stage}: the endpoint policy named node {node}, but there are {nodes} nodes")]
    UnknownEndpoint {
        /// The stage, from 0.
        stage: usize,
        /// The node named.
        node: u32,
        /// The number of nodes.
        nodes: usize,
    },
    /// No path leads to an endpoint.
    #[error("stage {stage}: no path leads from the tree to the endpoint {node}")]
    Unreachable {
        /// The stage, from 0.
        stage: usize,
        /// The endpoint.
        node: u32,
    },
    /// The observer cancelled the work.
    #[error("cancelled by the observer")]
    Cancelled,
}

impl From<Cancelled> for SearchError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl<'g> Search<'g> {
    /// The root alone, or the tree that the graph was built [around](super::AroundTree); nothing searched.
    pub fn new(graph: &'g Graph) -> Self {
        let nodes = graph.nodes();
        let mut search = Self {
            base: graph,
            graph: Ground::Base(graph),
            costs: vec![f32::INFINITY; nodes],
            parents: vec![NONE; nodes],
            guides: vec![NO_GUIDE; nodes],
            place: vec![NONE; nodes],
            on_tree: vec![0; nodes.div_ceil(64)],
            tree: Vec::new(),
            stages: Vec::new(),
            owners: Vec::new(),
            radii: Vec::new(),
            forks: OnceLock::new(),
            asked_beside: OnceLock::new(),
            queue: Queue::default(),
            wanted: Vec::new(),
            complete: false,
            forgotten: true,
            stages_before: 0,
        };
        search.plant();
        search
    }

    /// Forgets the tree; the next begins as the first did.
    pub fn reset(&mut self) {
        self.stand_on(Ground::Base(self.base));
        self.plant();
    }

    /// No tree, on another graph.
    fn stand_on(&mut self, graph: Ground<'g>) {
        let nodes = graph.nodes();
        self.graph = graph;
        self.costs.clear();
        self.costs.resize(nodes, f32::INFINITY);
        self.parents.clear();
        self.parents.resize(nodes, NONE);
        self.guides.clear();
        self.guides.resize(nodes, NO_GUIDE);
        self.place.clear();
        self.place.resize(nodes, NONE);
        self.on_tree.clear();
        self.on_tree.resize(nodes.div_ceil(64), 0);
        self.tree.clear();
        self.stages.clear();
        self.owners.clear();
        self.radii.clear();
        self.forgotten = true;
    }

    /// Goes on with a tree that is carried over to a finer graph, whose first nodes are the tree's.
    pub(super) fn adopt(&mut self, graph: Graph, tree: &Planted) {
        self.stand_on(Ground::Finer(Arc::new(graph)));
        self.take_over(tree);
    }

    fn take_over(&mut self, tree: &Planted) {
        self.forget();
        for (node, &parent) in (0u32..).zip(&tree.parents) {
            let i = node as usize;
            self.parents[i] = if node == parent { NONE } else { parent };
            let (vector, hops, length) = (tree.vectors[i], tree.hops[i], tree.lengths[i]);
            self.guides[i] = Guide { vector, hops, length, source: node };
            self.join(node, tree.stages[i]);
        }
        if tree.radii.iter().any(|&radius| radius > 0.0) {
            self.radii.clone_from(&tree.radii);
        }
    }

    fn plant(&mut self) {
        if let Some(tree) = self.graph.planted().cloned() {
            self.take_over(&tree);
            self.stages_before = tree.stages.iter().max().map_or(0, |stage| stage.saturating_add(1));
            return;
        }
        self.forget();
        for i in 0..self.graph.roots().len() {
            let root = self.graph.roots()[i];
            self.parents[root as usize] = NONE;
            // "The root node has distance zero, and has a vertical guiding vector."
            self.guides[root as usize] = Guide { vector: UP, hops: 0, length: 0.0, source: root };
            self.join(root, 0);
        }
    }

    /// "Nodes that are not part of the structure are reinitialized" (section 3.1.4).
    pub(super) fn forget(&mut self) {
        if !self.forgotten {
            for node in 0..self.costs.len() {
                if self.place[node] == NONE {
                    (self.costs[node], self.parents[node]) = (f32::INFINITY, NONE);
                    self.guides[node].vector = NO_VECTOR;
                }
            }
            self.forgotten = true;
        }
        self.queue.clear();
        self.forks = OnceLock::new();
        self.asked_beside = OnceLock::new();
        self.complete = false;
    }

    /// The vectors of the tree's nodes.
    pub(super) fn source_vectors(&self) -> Vec<Vec3> {
        self.tree.iter().map(|&node| self.guides[node as usize].vector).collect()
    }

    /// Undoes a stage that failed before [`extend`](Self::extend).
    pub(super) fn restore(&mut self, source_vectors: &[Vec3]) {
        for (&node, &vector) in self.tree.iter().zip(source_vectors) {
            self.guides[node as usize].vector = vector;
        }
        self.forget();
    }

    pub(super) fn join(&mut self, node: u32, stage: u16) {
        let owner = match self.parent(node) {
            Some(parent) => self.owners[self.place[parent as usize] as usize],
            None => self.owners.last().map_or(0, |&owner| owner + 1),
        };
        self.owners.push(owner);
        self.place[node as usize] = self.tree.len() as u32;
        self.on_tree[node as usize / 64] |= 1 << (node % 64);
        self.costs[node as usize] = 0.0;
        self.guides[node as usize].source = node;
        self.tree.push(node);
        self.stages.push(stage);
    }

    /// The graph; after a [`Refinement`](super::Refinement) the finer one.
    pub fn graph(&self) -> &Graph {
        &self.graph
    }

    /// Roots that the next trees begin with.
    pub(super) fn roots(&self) -> usize {
        self.base.roots().len()
    }

    /// The finer graph, if there has been a refinement.
    pub(super) fn finer_graph(&self) -> Option<Arc<Graph>> {
        match &self.graph {
            Ground::Base(_) => None,
            Ground::Finer(graph) => Some(graph.clone()),
        }
    }

    /// The nodes of the trees so far, the roots first, each after its parent.
    pub fn tree(&self) -> &[u32] {
        &self.tree
    }

    /// The stage in which each node of [`tree`](Self::tree) joined it.
    pub fn stages(&self) -> &[u16] {
        &self.stages
    }

    /// `true` if `node` is on the tree.
    ///
    /// # Panics
    /// As all methods that take a node: when there is no such node.
    #[inline]
    pub fn is_on_tree(&self, node: u32) -> bool {
        self.on_tree[node as usize / 64] >> (node % 64) & 1 == 1
    }

    /// The tree that `node` is on, or that its path starts from: its number among the graph's
    /// [roots](Graph::roots). `None` off the trees if not settled.
    pub fn tree_of(&self, node: u32) -> Option<u32> {
        let source = if self.is_on_tree(node) { node } else { self.source(node)? };
        Some(self.owners[self.place[source as usize] as usize])
    }

    /// Place of `node` in [`tree`](Self::tree).
    pub fn place(&self, node: u32) -> Option<usize> {
        Some(self.place[node as usize]).filter(|&place| place != NONE).map(|place| place as usize)
    }

    /// `true` if the latest search went to its end, so that nodes that are not settled cannot be
    /// reached.
    pub fn is_complete(&self) -> bool {
        self.complete
    }

    /// `true` if the latest search has settled `node`: its cost and path are final.
    #[inline]
    pub fn is_settled(&self, node: u32) -> bool {
        !self.guides[node as usize].vector.x.is_nan()
    }

    /// Least cost from the tree to `node` in the latest search, if settled. Zero on the tree.
    pub fn cost(&self, node: u32) -> Option<f32> {
        self.is_settled(node).then(|| self.costs[node as usize])
    }

    /// The unit guiding vector of `node`, if settled.
    pub fn vector(&self, node: u32) -> Option<Vec3> {
        self.is_settled(node).then(|| self.guides[node as usize].vector)
    }

    /// The node before `node` on its path; `None` for the root and where nothing has been found.
    pub fn parent(&self, node: u32) -> Option<u32> {
        Some(self.parents[node as usize]).filter(|&parent| parent != NONE)
    }

    /// Edges from the source of the stage in which `node` was settled; 0 at the root.
    pub fn hops(&self, node: u32) -> u32 {
        self.guides[node as usize].hops
    }

    /// Metres of path from the source of the stage in which `node` was settled; 0 at a root.
    pub fn path_length(&self, node: u32) -> f32 {
        self.guides[node as usize].length
    }

    /// The node of the tree that the path to `node` starts from: itself on the tree, `None` if not settled.
    pub fn source(&self, node: u32) -> Option<u32> {
        self.is_settled(node).then(|| self.guides[node as usize].source)
    }

    /// The parent branch at a node of the tree, as it was when the stage began; `None` off the tree. O(1); the first
    /// call of a stage takes O(n) for the n nodes of the tree.
    pub fn fork(&self, node: u32) -> Option<Fork> {
        let forks = self.forks.get_or_init(|| {
            let mut forks = vec![Fork::new(UP); self.tree.len()];
            // A tree of distinct nodes in parents' order is a skeleton.
            for (number, (skeleton, places)) in (0u32..).zip(self.skeletons().unwrap_or_default()) {
                for (fork, place) in Fork::all(&skeleton, number).into_iter().zip(places) {
                    forks[place] = fork;
                }
            }
            forks
        });
        forks.get(self.place(node)?).copied()
    }

    /// The trees so far, one per root, without radii but those that were given; and the place in
    /// [`tree`](Self::tree) of each of their nodes.
    pub(super) fn skeletons(&self) -> Result<Vec<(Skeleton, Vec<usize>)>, SkeletonError> {
        let parent = |&node: &u32| self.parent(node).map(|parent| self.place[parent as usize]);
        let parts = Parts {
            positions: self.tree.iter().map(|&node| self.graph.position(node)).collect(),
            parents: self.tree.iter().map(parent).collect(),
            stages: self.stages.clone(),
            hops: self.tree.iter().map(|&node| self.hops(node)).collect(),
            radii: &self.radii,
        };
        parts.skeletons()
    }
}
