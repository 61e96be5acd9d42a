//! Least-cost paths from the tree so far, with weights fixed lazily (sections 3.1.2 to 3.1.4).

use super::graph::Graph;
use super::queue::Queue;
use super::refine::Carried;
use super::rule::{GuidingRule, Source, Step};
use super::weight::{Star, WeightFn};
use crate::math::UP;
use crate::observer::{Cancelled, Observer, Work, report};
use glam::Vec3;
use std::ops::Deref;
use std::sync::Arc;

/// Not a node; also: not on the tree.
const NONE: u32 = u32::MAX;
/// Nodes settled between two reports.
const REPORT_EVERY: usize = 1 << 14;
/// Edges whose weights are asked for together.
const STAR: usize = 8;

/// The search through one graph and the tree that grows in it.
///
/// A tree begins as the root alone. Each stage searches paths from all nodes of the tree, and the paths to some
/// endpoints become part of it. A value can be used for many trees on one graph: what it holds is allocated once,
/// 28 bytes a node; a refinement brings a graph and memory of its own.
#[derive(Debug, Clone)]
pub struct Search<'g> {
    /// The graph that every new tree begins in.
    base: &'g Graph,
    graph: Ground<'g>,
    /// What the frontier asks for at every edge.
    ways: Vec<Way>,
    /// What a settled node leaves to those after it.
    guides: Vec<Guide>,
    /// Index in `tree`, or `NONE`.
    place: Vec<u32>,
    /// Nodes of the tree, each after its parent.
    tree: Vec<u32>,
    /// Stage in which each node of `tree` joined.
    stages: Vec<u16>,
    queue: Queue,
    /// A bit a node: the search stops when all of these are settled.
    wanted: Vec<u64>,
    complete: bool,
    /// Stages that the graph's own tree has used up.
    stages_before: u16,
}

/// The graph that a search runs in: the one it was given, or a finer one of its own.
#[derive(Debug, Clone)]
enum Ground<'g> {
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

/// The best way to a node so far.
#[derive(Debug, Clone, Copy)]
struct Way {
    /// 0 on the tree.
    cost: f32,
    parent: u32,
}

/// Guiding vector and hops of a settled node.
#[derive(Debug, Clone, Copy)]
struct Guide {
    vector: Vec3,
    hops: u32,
}

const NO_WAY: Way = Way { cost: f32::INFINITY, parent: NONE };
/// Not settled: no rule may give this vector.
const NO_VECTOR: Vec3 = Vec3::NAN;

/// What a rule or a weight did that no search can go on with.
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
        /// What the rule returned.
        vector: Vec3,
    },
    /// The weight of an edge is NaN or negative.
    #[error(
        "stage {stage}: the weight function gave edge {from} -> {to} the weight {weight}, but it must be at least 0, or infinite to forbid the edge"
    )]
    Weight {
        /// The stage, from 0.
        stage: usize,
        /// Where the edge starts.
        from: u32,
        /// Where it ends.
        to: u32,
        /// What the function returned.
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

/// What a search runs with.
pub(super) struct Terms<'a> {
    pub(super) rule: &'a dyn GuidingRule,
    pub(super) weight: &'a dyn WeightFn,
    pub(super) stage: usize,
    pub(super) stages: usize,
    pub(super) seed: u64,
    pub(super) observer: &'a dyn Observer,
}

impl<'g> Search<'g> {
    /// The root alone, or the tree that the graph was built [around](super::AroundTree); nothing searched.
    pub fn new(graph: &'g Graph) -> Self {
        let nodes = graph.nodes();
        let mut search = Self {
            base: graph,
            graph: Ground::Base(graph),
            ways: vec![NO_WAY; nodes],
            guides: vec![Guide { vector: NO_VECTOR, hops: 0 }; nodes],
            place: vec![NONE; nodes],
            tree: Vec::new(),
            stages: Vec::new(),
            queue: Queue::default(),
            wanted: Vec::new(),
            complete: false,
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
        self.ways.clear();
        self.ways.resize(nodes, NO_WAY);
        self.guides.clear();
        self.guides.resize(nodes, Guide { vector: NO_VECTOR, hops: 0 });
        self.place.clear();
        self.place.resize(nodes, NONE);
        self.tree.clear();
        self.stages.clear();
    }

    /// Goes on with a tree that is carried over to a finer graph, whose first nodes are the tree's.
    pub(super) fn adopt(&mut self, graph: Graph, carried: &Carried) {
        self.stand_on(Ground::Finer(Arc::new(graph)));
        self.take_over(carried);
    }

    fn take_over(&mut self, carried: &Carried) {
        self.forget();
        for (node, &parent) in (0u32..).zip(&carried.parents) {
            let i = node as usize;
            self.ways[i].parent = if node == 0 { NONE } else { parent };
            self.guides[i] = Guide { vector: carried.vectors[i], hops: carried.hops[i] };
            self.join(node, carried.stages[i]);
        }
    }

    fn plant(&mut self) {
        if let Some(tree) = self.graph.planted().cloned() {
            self.take_over(&tree);
            self.stages_before = tree.stages.iter().max().map_or(0, |stage| stage.saturating_add(1));
            return;
        }
        let root = self.graph.root();
        self.forget();
        self.ways[root as usize].parent = NONE;
        // "The root node has distance zero, and has a vertical guiding vector."
        self.guides[root as usize] = Guide { vector: UP, hops: 0 };
        self.join(root, 0);
    }

    /// "Nodes that are not part of the structure are reinitialized" (section 3.1.4).
    pub(super) fn forget(&mut self) {
        for node in 0..self.ways.len() {
            if self.place[node] == NONE {
                self.ways[node] = NO_WAY;
                self.guides[node].vector = NO_VECTOR;
            }
        }
        self.queue.clear();
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

    /// Searches from all nodes of the tree; to the end, or until all of `targets` are settled.
    ///
    /// Expects [`forget`](Self::forget) before it. Stopping is exact: weights are not negative, so later nodes cannot change the path to a settled one.
    pub(super) fn run(&mut self, terms: &Terms<'_>, targets: Option<&[u32]>) -> Result<(), SearchError> {
        let work = Work::Stage { index: terms.stage, of: terms.stages };
        report(terms.observer, work, 0.0)?;
        for index in 0..self.tree.len() {
            let node = self.tree[index];
            let source = Source {
                node,
                position: self.graph.position(node),
                root: self.graph.position(self.graph.root()),
                vector: self.guides[node as usize].vector,
                stage: terms.stage,
                seed: terms.seed,
            };
            self.guides[node as usize].vector = unit_vector(terms.rule.source(&source), terms.stage, node)?;
            self.queue.push(0.0, node);
        }
        self.wanted.clear();
        self.wanted.resize(self.graph.nodes().div_ceil(64), 0);
        let mut left = targets.map(|targets| {
            for &node in targets.iter().filter(|&&node| (node as usize) < self.graph.nodes()) {
                self.wanted[node as usize / 64] |= 1 << (node % 64);
            }
            self.wanted.iter().map(|bits| bits.count_ones()).sum::<u32>()
        });
        let ground = self.graph.clone();
        let mut count = 0;
        loop {
            let ways = &self.ways;
            let mut read = 0;
            let next = self.queue.pop(|cost, node| {
                let fresh = cost <= ways[node as usize].cost;
                if fresh {
                    // Read ahead, so that the list is in the cache when the node is settled.
                    read ^= ground.neighbours(node).first().copied().unwrap_or(0);
                }
                fresh
            });
            std::hint::black_box(read);
            let Some((cost, node)) = next else { break };
            // Stale: the node has been settled at a lower cost.
            if cost > self.ways[node as usize].cost {
                continue;
            }
            self.settle(&ground, node, terms)?;
            if let Some(left) = &mut left
                && self.wanted[node as usize / 64] >> (node % 64) & 1 == 1
            {
                *left -= 1;
                if *left == 0 {
                    return Ok(report(terms.observer, work, 1.0)?);
                }
            }
            count += 1;
            if count % REPORT_EVERY == 0 {
                report(terms.observer, work, count as f32 / (self.graph.nodes() + 1) as f32)?;
            }
        }
        self.complete = true;
        Ok(report(terms.observer, work, 1.0)?)
    }

    /// "The event of finalizing a node's cost also fixes its guiding vector", then its edges get their weights.
    fn settle(&mut self, graph: &Graph, node: u32, terms: &Terms<'_>) -> Result<(), SearchError> {
        let here = node as usize;
        let position = graph.position(node);
        if self.place[here] == NONE {
            let parent = self.ways[here].parent;
            let start = graph.position(parent);
            let way = position - start;
            let length = way.length();
            let before = self.guides[parent as usize];
            let hops = if self.place[parent as usize] == NONE { before.hops + 1 } else { 1 };
            let step = Step {
                search: self,
                node,
                from: parent,
                position,
                edge: way / length,
                length,
                vector: before.vector,
                hops,
                stage: terms.stage,
                seed: terms.seed,
            };
            let vector = unit_vector(terms.rule.guide(&step), terms.stage, node)?;
            self.guides[here] = Guide { vector, hops };
        }
        let (vector, cost) = (self.guides[here].vector, self.ways[here].cost);
        let mut ends = [(0, Vec3::ZERO); STAR];
        let mut weights = [0.0; STAR];
        for neighbours in graph.neighbours(node).chunks(STAR) {
            let mut open = 0;
            for &to in neighbours {
                ends[open] = (to, graph.position(to));
                // As cheap already, so settled or about to be: asking for the weight would be in vain.
                open += usize::from(self.ways[to as usize].cost > cost);
            }
            let star = Star {
                from: node,
                start: position,
                vector,
                stage: terms.stage,
                seed: terms.seed,
                ends: &ends[..open],
            };
            terms.weight.weights(&star, &mut weights[..open]);
            for (&(to, _), &weight) in ends[..open].iter().zip(&weights) {
                if weight.is_nan() || weight < 0.0 {
                    return Err(SearchError::Weight { stage: terms.stage, from: node, to, weight });
                }
                // `+ 0.0` turns a weight of -0 into 0, whose bits are in order.
                let through = cost + weight + 0.0;
                let known = &mut self.ways[to as usize];
                if through < known.cost {
                    *known = Way { cost: through, parent: node };
                    self.queue.push(through, to);
                }
            }
        }
        Ok(())
    }

    /// Adds the least-cost paths to `endpoints` to the tree.
    pub(super) fn extend(&mut self, endpoints: &[u32], stage: usize) -> Result<(), SearchError> {
        for &node in endpoints {
            if node as usize >= self.graph.nodes() {
                return Err(SearchError::UnknownEndpoint { stage, node, nodes: self.graph.nodes() });
            }
            if !self.is_settled(node) {
                return Err(SearchError::Unreachable { stage, node });
            }
        }
        let joined = self.stages_before.saturating_add(stage as u16);
        let mut path = Vec::new();
        for &endpoint in endpoints {
            let mut node = endpoint;
            while self.place[node as usize] == NONE {
                path.push(node);
                node = self.ways[node as usize].parent;
            }
            while let Some(node) = path.pop() {
                self.join(node, joined);
            }
        }
        Ok(())
    }

    fn join(&mut self, node: u32, stage: u16) {
        self.place[node as usize] = self.tree.len() as u32;
        self.ways[node as usize].cost = 0.0;
        self.tree.push(node);
        self.stages.push(stage);
    }

    /// The graph; after a [`Refinement`](super::Refinement) the finer one.
    pub fn graph(&self) -> &Graph {
        &self.graph
    }

    /// The finer graph, if there has been a refinement.
    pub(super) fn finer_graph(&self) -> Option<Arc<Graph>> {
        match &self.graph {
            Ground::Base(_) => None,
            Ground::Finer(graph) => Some(graph.clone()),
        }
    }

    /// The nodes of the tree so far, the root first, each after its parent.
    pub fn tree(&self) -> &[u32] {
        &self.tree
    }

    /// The stage in which each node of [`tree`](Self::tree) joined it.
    pub fn stages(&self) -> &[u16] {
        &self.stages
    }

    /// Whether `node` is on the tree.
    ///
    /// # Panics
    /// As all methods that take a node: when there is no such node.
    #[inline]
    pub fn is_on_tree(&self, node: u32) -> bool {
        self.place[node as usize] != NONE
    }

    /// Place of `node` in [`tree`](Self::tree).
    pub fn place(&self, node: u32) -> Option<usize> {
        Some(self.place[node as usize]).filter(|&place| place != NONE).map(|place| place as usize)
    }

    /// Whether the latest search went to its end, so that what is not settled cannot be reached.
    pub fn is_complete(&self) -> bool {
        self.complete
    }

    /// Whether the latest search has settled `node`: its cost and path are final.
    #[inline]
    pub fn is_settled(&self, node: u32) -> bool {
        !self.guides[node as usize].vector.x.is_nan()
    }

    /// Least cost from the tree to `node` in the latest search, if settled. Zero on the tree.
    pub fn cost(&self, node: u32) -> Option<f32> {
        self.is_settled(node).then(|| self.ways[node as usize].cost)
    }

    /// The unit guiding vector of `node`, if settled.
    pub fn vector(&self, node: u32) -> Option<Vec3> {
        self.is_settled(node).then(|| self.guides[node as usize].vector)
    }

    /// The node before `node` on its path; `None` for the root and where nothing has been found.
    pub fn parent(&self, node: u32) -> Option<u32> {
        Some(self.ways[node as usize].parent).filter(|&parent| parent != NONE)
    }

    /// Edges from the source of the stage in which `node` was settled; 0 at the root.
    pub fn hops(&self, node: u32) -> u32 {
        self.guides[node as usize].hops
    }

    /// The node of the tree that the path to `node` starts from. O(hops).
    pub fn source(&self, node: u32) -> Option<u32> {
        let mut node = node;
        while !self.is_on_tree(node) {
            node = self.parent(node)?;
        }
        Some(node)
    }
}

#[inline]
fn unit_vector(vector: Vec3, stage: usize, node: u32) -> Result<Vec3, SearchError> {
    let length = vector.length_squared();
    if (length - 1.0).abs() < 1e-6 {
        return Ok(vector);
    }
    // The largest part first, so that no square over- or underflows.
    let scaled = vector / vector.abs().max_element();
    scaled.try_normalize().ok_or(SearchError::Vector { stage, node, vector })
}
