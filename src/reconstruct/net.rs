//! The graph of the nodes: neighbours, bridges over gaps, and the cost of edges.

use std::num::NonZeroUsize;

use glam::Vec3;
use kiddo::SquaredEuclidean;

use super::nodes::{Nodes, Tree};
use crate::guided::{Edge, Graph, GraphError, GuidingRule, Step, WeightFn};
use crate::nearest::nearest;
use crate::parallel;

/// Sets that are joined one by one.
pub(super) struct Sets(Vec<u32>);

impl Sets {
    pub(super) fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    pub(super) fn of(&mut self, mut at: u32) -> u32 {
        while self.0[at as usize] != at {
            self.0[at as usize] = self.0[self.0[at as usize] as usize];
            at = self.0[at as usize];
        }
        at
    }

    /// The set of the lower number stays.
    pub(super) fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a.max(b) as usize] = a.min(b);
        a != b
    }
}

/// Sides of a cube that edges reach at least, at most where nodes are dense, and at most where they are sparse: with more, twigs beside
/// each other are one.
const REACH: [f32; 3] = [2.5, 3.0, 6.0];

/// The same in distances to the second nearest node, where nodes are sparse.
const SPARSE: f32 = 2.2;

/// Edges in one direction, the lower number first: neighbours within a reach that follows density.
pub(super) fn edges(nodes: &Nodes) -> Vec<(u32, u32)> {
    let reach: Vec<f32> = nodes
        .near
        .iter()
        .map(|near| {
            let eighth = near.get(7).map_or(f32::INFINITY, |near| near.1);
            let second = near.get(1).map_or(f32::INFINITY, |near| near.1);
            (2.0 * eighth)
                .min((SPARSE * second).clamp(REACH[1] * nodes.side, REACH[2] * nodes.side))
                .max(REACH[0] * nodes.side)
        })
        .collect();
    let mut edges = Vec::with_capacity(nodes.len() * 8);
    for (node, near) in (0_u32..).zip(&nodes.near) {
        for &(other, distance) in near {
            if distance <= reach[node as usize].max(reach[other as usize]) && distance > 1e-6 {
                edges.push((node.min(other), node.max(other)));
            }
        }
    }
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Number of nodes around each node to which a bridge is tried.
const LOOKED: usize = 6;
/// Bridges of each part at one time.
const BRIDGES: usize = 2;
/// Greatest number of rounds in which parts are joined to the largest.
const ROUNDS: usize = 100;

/// Edges over gaps of at most `gap` metres from parts of at least three nodes to the main part, which grows by them: shortest
/// first, and along the limbs' directions rather than across. Main is what hangs together with one of the nodes `from`; without
/// any, the largest part.
pub(super) fn bridges(nodes: &Nodes, edges: &[(u32, u32)], gap: f32, from: &[u32]) -> Vec<(u32, u32)> {
    let count = nodes.len() as u32;
    let mut sets = Sets::new(nodes.len());
    for &(a, b) in edges {
        sets.join(a, b);
    }
    for &node in from {
        sets.join(from[0], node);
    }
    let mut owners: Vec<u32> = (0..count).map(|node| sets.of(node)).collect();
    let mut sizes = vec![0_u32; nodes.len()];
    for &owner in &owners {
        sizes[owner as usize] += 1;
    }
    let largest = |&set: &u32| (sizes[set as usize], std::cmp::Reverse(set));
    let first = from.first().map(|&node| owners[node as usize]).or((0..count).max_by_key(largest));
    let Some(first) = first else { return Vec::new() };
    let mut asking: Vec<u32> = (0..count)
        .filter(|&node| sizes[owners[node as usize] as usize] >= 3 && owners[node as usize] != first)
        .collect();
    let mut main = first;
    let mut found = Vec::new();
    let mut reach = (4.0 * nodes.side).min(gap);
    for _ in 0..ROUNDS {
        let within: Vec<u32> = (0..count).filter(|&node| owners[node as usize] == main).collect();
        let places: Vec<[f32; 3]> =
            within.iter().map(|&node| nodes.positions[node as usize].to_array()).collect();
        let tree = Tree::new_from_slice(&places);
        let wanted = NonZeroUsize::new(LOOKED).unwrap_or(NonZeroUsize::MIN);
        let candidates = parallel::map(asking.len(), |i| {
            let node = asking[i];
            let place = nodes.positions[node as usize].to_array();
            let near = tree.nearest_n_within::<SquaredEuclidean>(&place, reach * reach, wanted, true);
            near.into_iter()
                .map(|near| within[near.item as usize])
                .map(|other| (score(nodes, node, other), node, other))
                .min_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)))
        });
        let mut candidates: Vec<(u32, f32, u32, u32)> =
            candidates.into_iter().flatten().map(|(score, a, b)| (owners[a as usize], score, a, b)).collect();
        candidates.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        for part in candidates.chunk_by(|a, b| a.0 == b.0) {
            for &(_, _, a, b) in part.iter().take(BRIDGES) {
                sets.join(a, b);
                found.push((a.min(b), a.max(b)));
            }
        }
        if candidates.is_empty() {
            if reach >= gap {
                break;
            }
            reach = (1.7 * reach).min(gap);
            continue;
        }
        owners = (0..count).map(|node| sets.of(node)).collect();
        main = owners[first as usize];
        asking.retain(|&node| owners[node as usize] != main);
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// The cost of a bridge: its length, more where it leaves the limbs' directions.
fn score(nodes: &Nodes, a: u32, b: u32) -> f32 {
    let way = nodes.positions[b as usize] - nodes.positions[a as usize];
    let length = way.length();
    let across = |node: u32| {
        let (along, linear) = nodes.along[node as usize];
        linear * (1.0 - (along.dot(way) / length.max(1e-6)).abs())
    };
    length * (1.0 + across(a) + across(b))
}

/// The way so far and the direction of the limb, together.
pub(super) struct Along<'a> {
    pub(super) along: &'a [(Vec3, f32)],
    /// Length over which a path forgets its earlier direction, metres.
    pub(super) memory: f32,
}

impl GuidingRule for Along<'_> {
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        let share = step.length / (step.length + self.memory);
        let way = step.vector * (1.0 - share) + step.edge * share;
        let (along, linear) = self.along.get(step.node as usize).copied().unwrap_or((Vec3::ZERO, 0.0));
        let along = if along.dot(way) < 0.0 { -along } else { along };
        let guide = way + along * (share * linear);
        if guide.length_squared() > 1e-6 { guide } else { step.edge }
    }
}

/// Length, dearer off the guiding vector and over gaps.
pub(super) struct Dear {
    /// Longer edges are gaps, metres.
    pub(super) gap: f32,
    /// The price of the way off the guiding vector.
    pub(super) turn: f32,
}

impl WeightFn for Dear {
    fn weight(&self, edge: &Edge<'_>) -> f32 {
        let off = 1.0 - edge.direction.dot(edge.vector);
        let gap = (edge.length / self.gap - 1.0).clamp(0.0, 4.0);
        edge.length * (1.0 + off * (self.turn + gap) + gap)
    }
}

/// The guiding vectors within one tree.
pub(super) fn along(nodes: &Nodes) -> Along<'_> {
    Along { along: &nodes.along, memory: 0.08 }
}

/// The weights within one tree.
pub(super) fn dear(nodes: &Nodes) -> Dear {
    Dear { gap: 3.0 * nodes.side, turn: 0.5 }
}

/// For each of `asked` the nearest of `places`, of which there is at least one.
pub(super) fn nearest_of(places: &[Vec3], asked: &[Vec3]) -> Vec<u32> {
    let wide = |places: &[Vec3]| places.iter().map(|place| place.as_dvec3()).collect::<Vec<_>>();
    nearest(&wide(places), &wide(asked))
}

/// The nodes, then a root for each base: linked to the nodes around it in the lowest part of its trunk, or to the nearest.
/// O(n log b) for n nodes and b bases.
pub(super) fn graph(
    nodes: &Nodes,
    edges: &[(u32, u32)],
    bridges: &[(u32, u32)],
    bases: &[Vec3],
) -> Result<Graph, GraphError> {
    let mut positions = nodes.positions.clone();
    let mut all: Vec<(u32, u32)> = edges.iter().chain(bridges).copied().collect();
    // The nodes that are nearer to a base than to any other.
    let mut own: Vec<Vec<(u32, Vec3)>> = vec![Vec::new(); bases.len()];
    let of = nearest_of(bases, &nodes.positions);
    for ((node, &place), base) in (0_u32..).zip(&nodes.positions).zip(of) {
        own[base as usize].push((node, place));
    }
    for (&base, own) in bases.iter().zip(&own) {
        let root = positions.len() as u32;
        let least = own.iter().map(|node| node.1.distance(base)).fold(f32::INFINITY, f32::min);
        // For the case that a node lies in the very place of the base.
        let base = if least < 1e-5 { base - Vec3::Y * 0.5 * nodes.side } else { base };
        // All of the trunk's lowest ring: what lies no higher than a hand, and within what no trunk is wider than.
        let slab = base.y + 8.0 * nodes.side;
        let low = own.iter().filter(|node| node.1.y <= slab);
        let mut flat: Vec<f32> = low.map(|node| node.1.with_y(base.y).distance(base)).collect();
        let half = flat.len() / 2;
        let wide = if flat.is_empty() { 0.0 } else { *flat.select_nth_unstable_by(half, f32::total_cmp).1 };
        let reach = (2.0 * wide).min(3.0).max(4.0 * nodes.side).max(least * 1.01);
        let around = own.iter().filter(|(_, place)| {
            place.y <= slab.max(base.y + least) && place.distance(base) <= reach
                || place.distance(base) <= least
        });
        all.extend(around.map(|node| (node.0, root)));
        positions.push(base);
    }
    all.sort_unstable();
    all.dedup();
    let both: Vec<(u32, u32)> = all.iter().flat_map(|&(a, b)| [(a, b), (b, a)]).collect();
    let first = nodes.len() as u32;
    Graph::new(positions, &both, first)?.with_roots((first..).take(bases.len()).collect())
}
