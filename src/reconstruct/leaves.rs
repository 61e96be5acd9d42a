//! Points on wood told from those on leaves, by shape and by the paths that run through them.

use glam::Vec3;
use kiddo::SquaredEuclidean;

use super::nodes::{Nodes, Tree, principal};
use super::{MOST_NODES, Reconstruct, ReconstructError, Start, net};
use crate::guided::Search;
use crate::{Silent, math, parallel};

/// What a point was taken for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PointKind {
    /// Wood: the tree is made of these points.
    Wood,
    /// A leaf, or a twig among leaves that is told from them by nothing: set aside.
    Leaf,
    /// Ground: set aside.
    Ground,
    /// Too far from the rest, or too few together.
    Stray,
}

/// The side of the cubes whose points are one node, metres, at least: leaves are of one size on tall trees and on low ones.
const SIDE: f32 = 0.014;
/// The radii within which the shape of a cloud is looked at, metres, and in sides of cubes at least.
const AROUND: [f32; 2] = [0.035, 0.07];
const SIDES: [f32; 2] = [2.5, 5.0];
/// Nodes of a path over which its direction is taken.
const HOPS: usize = 5;
/// Rounds in which a node's evidence becomes the mean of its own and its neighbours'.
const ROUNDS: usize = 2;
/// Nodes searched by one task.
const CHUNK: usize = 1024;

/// The evidence for wood of one node, as the logarithm of odds: a logistic regression on scans of trees in leaf, with their truth.
struct Evidence {
    /// Of the logarithm of the length of path ahead, metres, the greatest of the node's neighbours and of their neighbours.
    ahead: [f32; 2],
    /// Of the ratio of the least to the greatest spread at either radius.
    round: [f32; 2],
    /// Of the least spread over the radius.
    thick: [f32; 2],
    /// Of the cosine of the steepness of the direction of greatest spread.
    upright: f32,
    /// Of the cosine of the angle between that and the path.
    along: f32,
    none: f32,
}

const EVIDENCE: Evidence = Evidence {
    ahead: [0.55, 0.64],
    round: [-8.77, -6.25],
    thick: [15.85, 9.21],
    upright: -1.74,
    along: -1.4,
    none: 3.89,
};

/// Least length of path ahead that counts, metres.
const LEAST_AHEAD: f32 = 0.01;

/// The spread of the nodes around one.
#[derive(Clone, Copy, Default)]
struct Spread {
    along: Vec3,
    /// Least over greatest.
    round: f32,
    /// Least over the radius.
    thick: f32,
}

impl Spread {
    fn of(places: &[Vec3], radius: f32) -> Self {
        let middle = places.iter().sum::<Vec3>() / places.len() as f32;
        let off = || places.iter().map(|&place| place - middle);
        let (along, _) = principal(off());
        if along == Vec3::ZERO {
            return Self::default();
        }
        let count = places.len() as f32;
        let across = along.any_orthonormal_vector();
        let beside = along.cross(across);
        // The covariance in a plane across the first direction.
        let (mut a, mut b, mut c, mut first) = (0.0, 0.0, 0.0, 0.0);
        for place in off() {
            let (u, v, w) = (place.dot(across), place.dot(beside), place.dot(along));
            a += u * u;
            b += u * v;
            c += v * v;
            first += w * w;
        }
        let least = 0.5 * (a + c - ((a - c) * (a - c) + 4.0 * b * b).sqrt());
        let [first, least] = [first, least].map(|square: f32| (square / count).max(0.0).sqrt());
        Self { along, round: least / first.max(1e-6), thick: least / radius }
    }
}

/// The spread around each node at both radii. O(n m) for m nodes within the larger radius.
fn spreads(nodes: &Nodes) -> Vec<[Spread; 2]> {
    let places: Vec<[f32; 3]> = nodes.positions.iter().map(Vec3::to_array).collect();
    let tree = Tree::new_from_slice(&places);
    let radii = [0, 1].map(|i| AROUND[i].max(SIDES[i] * nodes.side));
    let of = |node: usize| {
        let within = tree.within_unsorted::<SquaredEuclidean>(&places[node], radii[1] * radii[1]);
        // In the order of their numbers, whatever the tree's.
        let mut near: Vec<(u32, f32)> = within.into_iter().map(|near| (near.item, near.distance)).collect();
        near.sort_unstable_by_key(|near| near.0);
        let at = |near: &(u32, f32)| nodes.positions[near.0 as usize];
        let all: Vec<Vec3> = near.iter().map(at).collect();
        let close: Vec<Vec3> = near.iter().filter(|near| near.1 <= radii[0] * radii[0]).map(at).collect();
        [Spread::of(&close, radii[0]), Spread::of(&all, radii[1])]
    };
    let chunks = places.len().div_ceil(CHUNK);
    let found = parallel::map(chunks, |chunk| {
        (chunk * CHUNK..((chunk + 1) * CHUNK).min(places.len())).map(of).collect::<Vec<_>>()
    });
    found.into_iter().flatten().collect()
}

/// Each value becomes what `join` makes of it and those of its neighbours.
fn joined(values: &[f32], edges: &[(u32, u32)], join: impl Fn(&mut f32, f32)) -> Vec<f32> {
    let mut result = values.to_vec();
    for &(a, b) in edges {
        join(&mut result[a as usize], values[b as usize]);
        join(&mut result[b as usize], values[a as usize]);
    }
    result
}

impl Reconstruct {
    /// Those of the points of one tree that are on wood; the others' kind becomes `Leaf`.
    pub(super) fn without_leaves(
        &self,
        points: &[Vec3],
        which: &[u32],
        start: Start,
        kinds: &mut [PointKind],
    ) -> Result<Vec<u32>, ReconstructError> {
        let side = self.side.unwrap_or(SIDE).max(SIDE);
        let nodes = Self { side: Some(side), ..*self }.nodes(points, which, MOST_NODES)?;
        let edges = net::edges(&nodes);
        let bridges = net::bridges(&nodes, &edges, self.gap, &[]);
        let graph = net::graph(&nodes, &edges, &bridges, &[start.base])?;
        let mut search = Search::new(&graph);
        search.explore(&net::along(&nodes), &net::dear(&nodes), 0, &Silent)?;
        let is_wood = wood(&nodes, &search, &edges);
        let mut own = Vec::new();
        for (node, is_wood) in is_wood.into_iter().enumerate() {
            if is_wood {
                own.extend(nodes.of(node));
            } else if search.is_settled(node as u32) {
                nodes.of(node).iter().for_each(|&point| kinds[point as usize] = PointKind::Leaf);
            }
        }
        own.sort_unstable();
        Ok(own)
    }
}

/// For each node whether it is on wood: of all parts of the tree of paths that hang together with the base, that of the greatest
/// sum of evidence. A limb goes on behind a few leaves if there is enough of it, and no leaf is wood for its shape alone.
fn wood(nodes: &Nodes, search: &Search<'_>, edges: &[(u32, u32)]) -> Vec<bool> {
    let count = nodes.len();
    let parent = |node: usize| search.parent(node as u32).map(|parent| parent as usize);
    let is_node = |node: &usize| *node < count;
    let mut order: Vec<u32> = (0..count as u32).filter(|&node| search.is_settled(node)).collect();
    // Paths are longer than their parents' unless steps are lost in rounding; hops tell then.
    let key = |&node: &u32| (search.path_length(node).to_bits(), search.hops(node), node);
    order.sort_unstable_by_key(key);
    let mut ahead = vec![0.0_f32; count];
    for &node in order.iter().rev() {
        let node = node as usize;
        if let Some(before) = parent(node).filter(is_node) {
            let step = nodes.positions[node].distance(nodes.positions[before]);
            ahead[before] = ahead[before].max(ahead[node] + step);
        }
    }
    let most = |value: &mut f32, other: f32| *value = value.max(other);
    let near = joined(&ahead, edges, most);
    let far = joined(&near, edges, most);
    let spreads = spreads(nodes);
    let mut evidence: Vec<f32> = (0..count)
        .map(|node| {
            let mut back = node;
            for _ in 0..HOPS {
                back = parent(back).filter(is_node).unwrap_or(back);
            }
            let way = (nodes.positions[node] - nodes.positions[back]).normalize_or_zero();
            let [small, large] = spreads[node];
            let rule = &EVIDENCE;
            rule.none
                + rule.ahead[0] * math::ln(near[node] + LEAST_AHEAD)
                + rule.ahead[1] * math::ln(far[node] + LEAST_AHEAD)
                + rule.round[0] * small.round
                + rule.round[1] * large.round
                + rule.thick[0] * small.thick
                + rule.thick[1] * large.thick
                + rule.upright * small.along.y.abs()
                + rule.along * small.along.dot(way).abs()
        })
        .collect();
    let mut degrees = vec![1.0_f32; count];
    for &(a, b) in edges {
        degrees[a as usize] += 1.0;
        degrees[b as usize] += 1.0;
    }
    for _ in 0..ROUNDS {
        evidence = joined(&evidence, edges, |value, other| *value += other);
        evidence.iter_mut().zip(&degrees).for_each(|(value, degree)| *value /= degree);
    }
    // The greatest sum of each node and what is worth its while behind it.
    let mut sums = evidence;
    for &node in order.iter().rev() {
        let node = node as usize;
        if let Some(before) = parent(node).filter(|before| *before < count && sums[node] > 0.0) {
            sums[before] += sums[node];
        }
    }
    let mut is_wood = vec![false; count];
    for &node in &order {
        let node = node as usize;
        let hangs = parent(node).is_none_or(|before| before >= count || is_wood[before]);
        is_wood[node] = hangs && sums[node] > 0.0;
    }
    is_wood
}
