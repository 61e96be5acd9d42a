//! Dijkstra's algorithm with weights fixed lazily (sections 3.1.2 to 3.1.4).

use super::context::Context;
use super::graph::Graph;
use super::rule::{GuidingRule, Source, Step};
use super::search::{Guide, NO_GUIDE, Search, SearchError};
use super::weight::{Star, WeightFn};
use crate::observer::{Observer, Work, report};
use glam::Vec3;

/// Nodes settled between two reports.
const REPORT_EVERY: usize = 1 << 14;
/// Edges whose weights are asked for together.
const STAR: usize = 8;

/// Parameters of a search.
pub(super) struct Terms<'a> {
    pub(super) rule: &'a dyn GuidingRule,
    pub(super) weight: &'a dyn WeightFn,
    pub(super) stage: usize,
    pub(super) stages: usize,
    pub(super) seed: u64,
    pub(super) observer: &'a dyn Observer,
}

impl Search<'_> {
    /// Searches from all nodes of the tree; to the end, or until all of `targets` are settled.
    ///
    /// Expects [`forget`](Self::forget) before it. Stopping is exact: weights are not negative, so later nodes cannot
    /// change the path to a settled one.
    pub(super) fn run(&mut self, terms: &Terms<'_>, targets: Option<&[u32]>) -> Result<(), SearchError> {
        let work = Work::Stage { index: terms.stage, of: terms.stages };
        report(terms.observer, work, 0.0)?;
        self.forgotten = false;
        for index in 0..self.tree.len() {
            let node = self.tree[index];
            self.guides[node as usize].vector = self.source_vector(node, terms)?;
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
        let mut ahead = Ahead::new();
        let mut count = 0;
        loop {
            if ahead.first > 0 && self.queue.opened().len() == ahead.first {
                ahead.work_out(self, &ground, terms);
            }
            let Some((cost, node, place)) = self.queue.pop_opened() else {
                let costs = &self.costs;
                if self.queue.open(&mut |cost, node| cost <= costs[node as usize]).is_none() {
                    break;
                }
                ahead.first = self.queue.opened().len();
                continue;
            };
            // Stale: the node has been settled at a lower cost.
            if cost > self.costs[node as usize] {
                continue;
            }
            match place.and_then(|place| ahead.get(place)) {
                Some((guide, ends, weights)) => {
                    self.guides[node as usize] = guide;
                    for (&(to, _), &weight) in ends.iter().zip(weights) {
                        self.relax(node, to, cost, weight);
                    }
                }
                None => self.settle(&ground, node, terms)?,
            }
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

    /// Searches from the trees as they stand to the end: then every node that a path leads to has its cost, path and guiding
    /// vector. For those who have a graph and endpoints of their own; [`TreeSynth`](super::TreeSynth) does it for each stage.
    ///
    /// # Errors
    /// A vector without a direction, a weight that is NaN or negative, and when the observer says so.
    pub fn explore(
        &mut self,
        rule: &dyn GuidingRule,
        weight: &dyn WeightFn,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<(), SearchError> {
        self.forget();
        self.run(&Terms { rule, weight, stage: 0, stages: 1, seed, observer }, None)
    }

    /// "The event of finalizing a node's cost also fixes its guiding vector", then its edges get their weights.
    fn settle(&mut self, graph: &Graph, node: u32, terms: &Terms<'_>) -> Result<(), SearchError> {
        let here = node as usize;
        if !self.is_on_tree(node) {
            self.guides[here] = self.guide(graph, node, terms)?;
        }
        let cost = self.costs[here];
        let positions = graph.positions();
        let mut ends = [(0, Vec3::ZERO); STAR];
        let mut weights = [0.0; STAR];
        for neighbours in graph.neighbours(node).chunks(STAR) {
            let mut open = 0;
            for &to in neighbours {
                ends[open % STAR].0 = to;
                // As cheap already, so settled or about to be: asking for the weight would be in vain.
                open += usize::from(self.costs[to as usize] > cost);
            }
            if open == 0 {
                continue;
            }
            // Only positions of open ends are read, so that the others need not be in the cache.
            for (to, end) in &mut ends[..open] {
                *end = positions[*to as usize];
            }
            let (ends, weights) = (&ends[..open], &mut weights[..open]);
            terms.weight.weights(&self.star(graph, node, self.guides[here], ends, terms), weights);
            let mut sound = true;
            for (&(to, _), &weight) in ends.iter().zip(&*weights) {
                sound &= weight >= 0.0;
                self.relax(node, to, cost, weight);
            }
            if !sound {
                check_weights(node, ends, weights, terms.stage)?;
            }
        }
        Ok(())
    }

    /// Takes the way over an edge if it is better than what is known.
    #[inline]
    fn relax(&mut self, node: u32, to: u32, cost: f32, weight: f32) {
        // `+ 0.0` turns a weight of -0 into 0, whose bits are in order.
        let through = cost + weight + 0.0;
        let known = &mut self.costs[to as usize];
        if through < *known {
            *known = through;
            self.parents[to as usize] = node;
            self.queue.push(through, to);
        }
    }

    /// State that a node off the tree passes on; its way is final.
    #[inline]
    pub(super) fn guide(&self, graph: &Graph, node: u32, terms: &Terms<'_>) -> Result<Guide, SearchError> {
        let position = graph.position(node);
        let parent = self.parents[node as usize];
        let way = position - graph.position(parent);
        let length = way.length();
        let before = self.guides[parent as usize];
        let (hops, start) = if self.is_on_tree(parent) { (0, 0.0) } else { (before.hops, before.length) };
        let (hops, path_length) = (hops + 1, start + length);
        let step = Step {
            context: Context::Search(self),
            node,
            from: parent,
            source: before.source,
            position,
            edge: way / length,
            length,
            vector: before.vector,
            hops,
            path_length,
            stage: terms.stage,
            seed: terms.seed,
        };
        let vector = unit_vector(terms.rule.guide(&step), terms.stage, node)?;
        Ok(Guide { vector, hops, length: path_length, source: before.source })
    }

    /// The weights of edges from a settled node.
    pub(super) fn weigh(
        &self,
        graph: &Graph,
        node: u32,
        ends: &[(u32, Vec3)],
        weights: &mut [f32],
        terms: &Terms<'_>,
    ) -> Result<(), SearchError> {
        terms.weight.weights(&self.star(graph, node, self.guides[node as usize], ends, terms), weights);
        check_weights(node, ends, weights, terms.stage)
    }

    /// Edges from a settled node.
    #[inline]
    fn star<'a>(
        &'a self,
        graph: &Graph,
        node: u32,
        guide: Guide,
        ends: &'a [(u32, Vec3)],
        terms: &Terms<'_>,
    ) -> Star<'a> {
        let (hops, path_length) = if self.is_on_tree(node) { (0, 0.0) } else { (guide.hops, guide.length) };
        Star {
            context: Context::Search(self),
            from: node,
            source: guide.source,
            start: graph.position(node),
            vector: guide.vector,
            cost: self.costs[node as usize],
            hops,
            path_length,
            stage: terms.stage,
            seed: terms.seed,
            ends,
        }
    }

    /// The vector with which a node of the tree enters the stage.
    pub(super) fn source_vector(&self, node: u32, terms: &Terms<'_>) -> Result<Vec3, SearchError> {
        let source = Source {
            context: Context::Search(self),
            node,
            position: self.graph.position(node),
            vector: self.guides[node as usize].vector,
            stage: terms.stage,
            seed: terms.seed,
        };
        unit_vector(terms.rule.source(&source), terms.stage, node)
    }

    /// The stage that nodes are marked with that join in a stage of the pipeline.
    pub(super) fn joining(&self, stage: usize) -> u16 {
        self.stages_before.saturating_add(stage as u16)
    }

    /// Checks that the endpoints are nodes that paths lead to.
    pub(super) fn check_endpoints(&self, endpoints: &[u32], stage: usize) -> Result<(), SearchError> {
        for &node in endpoints {
            if node as usize >= self.graph.nodes() {
                return Err(SearchError::UnknownEndpoint { stage, node, nodes: self.graph.nodes() });
            }
            if !self.is_settled(node) {
                return Err(SearchError::Unreachable { stage, node });
            }
        }
        Ok(())
    }

    /// Adds the least-cost paths to `endpoints` to the tree.
    pub(super) fn extend(&mut self, endpoints: &[u32], stage: usize) -> Result<(), SearchError> {
        self.check_endpoints(endpoints, stage)?;
        let joined = self.joining(stage);
        let mut path = Vec::new();
        for &endpoint in endpoints {
            let mut node = endpoint;
            while !self.is_on_tree(node) {
                path.push(node);
                node = self.parents[node as usize];
            }
            while let Some(node) = path.pop() {
                self.join(node, joined);
            }
        }
        Ok(())
    }
}

/// State that a node passes on, the ends of its edges, and their weights.
type WorkedOut<'a> = (Guide, &'a [(u32, Vec3)], &'a [f32]);

/// Nodes of the open bucket that are worked out ahead, together.
const AHEAD: usize = 64;

/// The vectors of the next nodes to be settled, and the weights of their edges, worked out before the first of them is
/// settled.
///
/// One by one, each node would wait for the vector and the weights of the one before, for whether an edge is a better
/// way cannot be foretold; here they overlap. Rules and weights hang on nothing that settling the nodes could change but
/// the way to the node itself, and where a better one is found, the node comes again as one that is late.
#[derive(Debug)]
struct Ahead {
    /// The place in the open bucket of the first node that is worked out; they are from there on.
    first: usize,
    guides: Vec<Guide>,
    ends: Vec<(u32, Vec3)>,
    weights: Vec<f32>,
    /// Index of each node's first edge, and the end.
    starts: Vec<usize>,
}

impl Ahead {
    /// With room for nodes of sixteen edges, so that there is one allocation per array and not one per
    /// doubling.
    fn new() -> Self {
        Self {
            first: 0,
            guides: Vec::with_capacity(AHEAD),
            ends: Vec::with_capacity(16 * AHEAD),
            weights: Vec::with_capacity(16 * AHEAD),
            starts: Vec::with_capacity(AHEAD + 1),
        }
    }

    /// The last nodes of the open bucket. A fault that ends a search is left until its node is
    /// settled.
    fn work_out(&mut self, search: &Search<'_>, graph: &Graph, terms: &Terms<'_>) {
        let opened = search.queue.opened();
        self.first = opened.len().saturating_sub(AHEAD);
        let opened = &opened[self.first..];
        // Read first what will be far away in memory, all of it at once.
        let (mut read, last) = (0, graph.nodes() as u32 - 1);
        for entry in opened {
            let node = entry.node();
            let parent = search.parents[node as usize].min(last);
            read ^=
                graph.neighbours(node).first().copied().unwrap_or(0) ^ search.guides[parent as usize].hops;
        }
        std::hint::black_box(read);
        self.guides.clear();
        for entry in opened {
            let node = entry.node();
            let guide = if search.is_on_tree(node) {
                search.guides[node as usize]
            } else {
                search.guide(graph, node, terms).unwrap_or(NO_GUIDE)
            };
            self.guides.push(guide);
        }
        self.starts.clear();
        self.starts.push(0);
        let mut open = 0;
        for (entry, guide) in opened.iter().zip(&self.guides) {
            let neighbours = graph.neighbours(entry.node());
            let is_stale = entry.cost() > search.costs[entry.node() as usize] || guide.vector.x.is_nan();
            let neighbours = if is_stale { &[] } else { neighbours };
            if self.ends.len() < open + neighbours.len() {
                self.ends.resize(open + neighbours.len(), (0, Vec3::ZERO));
            }
            for &to in neighbours {
                self.ends[open] = (to, graph.positions()[to as usize]);
                // As cheap already, so settled or about to be: asking for the weight would be in vain.
                open += usize::from(search.costs[to as usize] > entry.cost());
            }
            self.starts.push(open);
        }
        self.weights.clear();
        self.weights.resize(open, 0.0);
        for (i, (entry, &guide)) in opened.iter().zip(&self.guides).enumerate() {
            let edges = self.starts[i]..self.starts[i + 1];
            let (ends, weights) = (&self.ends[edges.clone()], &mut self.weights[edges]);
            for (ends, weights) in ends.chunks(STAR).zip(weights.chunks_mut(STAR)) {
                terms.weight.weights(&search.star(graph, entry.node(), guide, ends, terms), weights);
            }
        }
        if !self.weights.iter().all(|&weight| weight >= 0.0) {
            self.guides.clear();
        }
    }

    /// Guide, edges and weights of the node at a place in the open bucket; `None` where they have
    /// to be computed when it is settled.
    #[inline]
    fn get(&self, place: usize) -> Option<WorkedOut<'_>> {
        let i = place.checked_sub(self.first)?;
        let guide = *self.guides.get(i).filter(|guide| !guide.vector.x.is_nan())?;
        let edges = self.starts[i]..self.starts[i + 1];
        Some((guide, &self.ends[edges.clone()], &self.weights[edges]))
    }
}

/// No weight is NaN or negative.
fn check_weights(from: u32, ends: &[(u32, Vec3)], weights: &[f32], stage: usize) -> Result<(), SearchError> {
    for (&(to, _), &weight) in ends.iter().zip(weights) {
        if weight.is_nan() || weight < 0.0 {
            return Err(SearchError::Weight { stage, from, to, weight });
        }
    }
    Ok(())
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
