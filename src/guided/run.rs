//! Dijkstra's algorithm with weights fixed lazily (sections 3.1.2 to 3.1.4).

use super::context::Context;
use super::graph::Graph;
use super::rule::{GuidingRule, Source, Step};
use super::search::{Guide, NONE, Search, SearchError, Way};
use super::weight::{Star, WeightFn};
use crate::observer::{Observer, Work, report};
use glam::Vec3;

/// Nodes settled between two reports.
const REPORT_EVERY: usize = 1 << 14;
/// Edges whose weights are asked for together.
const STAR: usize = 8;

/// What a search runs with.
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
        if self.place[here] == NONE {
            self.guides[here] = self.guide(graph, node, terms)?;
        }
        let cost = self.ways[here].cost;
        let positions = graph.positions();
        let mut ends = [(0, Vec3::ZERO); STAR];
        let mut weights = [0.0; STAR];
        for neighbours in graph.neighbours(node).chunks(STAR) {
            let mut open = 0;
            for &to in neighbours {
                ends[open % STAR] = (to, positions[to as usize]);
                // As cheap already, so settled or about to be: asking for the weight would be in vain.
                open += usize::from(self.ways[to as usize].cost > cost);
            }
            if open == 0 {
                continue;
            }
            let (ends, weights) = (&ends[..open], &mut weights[..open]);
            terms.weight.weights(&self.star(graph, node, ends, terms), weights);
            let mut sound = true;
            for (&(to, _), &weight) in ends.iter().zip(&*weights) {
                sound &= weight >= 0.0;
                // `+ 0.0` turns a weight of -0 into 0, whose bits are in order.
                let through = cost + weight + 0.0;
                let known = &mut self.ways[to as usize];
                if through < known.cost {
                    *known = Way { cost: through, parent: node };
                    self.queue.push(through, to);
                }
            }
            if !sound {
                check_weights(node, ends, weights, terms.stage)?;
            }
        }
        Ok(())
    }

    /// What a node off the tree leaves to those after it; its way is final.
    #[inline]
    pub(super) fn guide(&self, graph: &Graph, node: u32, terms: &Terms<'_>) -> Result<Guide, SearchError> {
        let position = graph.position(node);
        let parent = self.ways[node as usize].parent;
        let way = position - graph.position(parent);
        let length = way.length();
        let before = self.guides[parent as usize];
        let (hops, start) =
            if self.place[parent as usize] == NONE { (before.hops, before.length) } else { (0, 0.0) };
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
        terms.weight.weights(&self.star(graph, node, ends, terms), weights);
        check_weights(node, ends, weights, terms.stage)
    }

    /// Edges from a settled node.
    #[inline]
    fn star<'a>(&'a self, graph: &Graph, node: u32, ends: &'a [(u32, Vec3)], terms: &Terms<'_>) -> Star<'a> {
        let here = node as usize;
        let guide = self.guides[here];
        let (hops, path_length) =
            if self.place[here] == NONE { (guide.hops, guide.length) } else { (0, 0.0) };
        Star {
            context: Context::Search(self),
            from: node,
            source: guide.source,
            start: graph.position(node),
            vector: guide.vector,
            cost: self.ways[here].cost,
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

    /// Whether the endpoints are nodes that paths lead to.
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
