//! Points become fewer nodes: one per cube, each with the direction of the limb it is on.

use std::num::NonZeroUsize;

use glam::{DVec3, Vec3};
use kiddo::SquaredEuclidean;
use kiddo::immutable::float::kdtree::ImmutableKdTree;

use crate::parallel;

/// Neighbours of a node.
pub(super) const NEAREST: usize = 12;
/// Places searched by one task.
const CHUNK: usize = 1024;

pub(super) type Tree = ImmutableKdTree<f32, u32, 3, 32>;

/// Nodes, the points of each, and their neighbours.
pub(super) struct Nodes {
    /// The side of the cubes, metres.
    pub(super) side: f32,
    pub(super) positions: Vec<Vec3>,
    /// The numbers of the points, those of one node after the other.
    pub(super) points: Vec<u32>,
    /// The start in `points` of each node's points, and the end of the last's.
    pub(super) starts: Vec<u32>,
    /// The nearest other nodes of each, nearest first, and their distances.
    pub(super) near: Vec<Vec<(u32, f32)>>,
    /// The direction in which the nodes around lie, and how much they lie on a line, 0 to 1.
    pub(super) along: Vec<(Vec3, f32)>,
}

impl Nodes {
    /// Makes at most about `most` nodes: the cubes' side grows until there are no more. O(n log n).
    pub(super) fn new(points: &[Vec3], which: &[u32], side: f32, most: usize) -> Self {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for &point in which {
            (low, high) = (low.min(points[point as usize]), high.max(points[point as usize]));
        }
        // 2 million cubes along an axis at most.
        let mut side = side.max((high - low).max_element() / 2e6);
        let keys = loop {
            let mut keys: Vec<(u64, u32)> =
                which.iter().map(|&point| (key(points[point as usize] - low, side), point)).collect();
            keys.sort_unstable();
            let count = keys.chunk_by(|a, b| a.0 == b.0).count();
            if count <= most {
                break keys;
            }
            side *= 1.3;
        };
        let (mut positions, mut starts) = (Vec::new(), Vec::new());
        let mut start = 0;
        for cube in keys.chunk_by(|a, b| a.0 == b.0) {
            let sum: DVec3 = cube.iter().map(|&(_, point)| points[point as usize].as_dvec3()).sum();
            positions.push((sum / cube.len() as f64).as_vec3());
            starts.push(start);
            start += cube.len() as u32;
        }
        starts.push(start);
        let points = keys.into_iter().map(|(_, point)| point).collect();
        Self { side, positions, points, starts, near: Vec::new(), along: Vec::new() }
    }

    /// Finds the neighbours and directions of all nodes.
    pub(super) fn survey(&mut self) {
        let places: Vec<[f32; 3]> = self.positions.iter().map(Vec3::to_array).collect();
        let tree = Tree::new_from_slice(&places);
        let wanted = NonZeroUsize::new(NEAREST + 1).unwrap_or(NonZeroUsize::MIN);
        let chunks = places.len().div_ceil(CHUNK);
        let found = parallel::map(chunks, |chunk| {
            let nodes = chunk * CHUNK..((chunk + 1) * CHUNK).min(places.len());
            nodes
                .map(|node| {
                    let mut near: Vec<(u32, f32)> = tree
                        .nearest_n::<SquaredEuclidean>(&places[node], wanted)
                        .into_iter()
                        .map(|near| (near.item, near.distance.sqrt()))
                        .filter(|near| near.0 as usize != node)
                        .collect();
                    near.sort_unstable_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
                    near.truncate(NEAREST);
                    let along = direction(&self.positions, node, &near, 6.0 * self.side);
                    (near, along)
                })
                .collect::<Vec<_>>()
        });
        (self.near, self.along) = found.into_iter().flatten().unzip();
    }

    /// Median distance of a node from its fourth nearest: on a surface, the distance from one node to the
    /// next.
    pub(super) fn spacing(&self) -> f32 {
        let mut fourth: Vec<f32> =
            self.near.iter().filter_map(|near| near.get(3).map(|near| near.1)).collect();
        if fourth.is_empty() {
            return 0.0;
        }
        let half = fourth.len() / 2;
        *fourth.select_nth_unstable_by(half, f32::total_cmp).1
    }

    pub(super) fn len(&self) -> usize {
        self.positions.len()
    }

    /// The points of a node.
    pub(super) fn of(&self, node: usize) -> &[u32] {
        &self.points[self.starts[node] as usize..self.starts[node + 1] as usize]
    }
}

/// 21 bits per axis.
fn key(place: Vec3, side: f32) -> u64 {
    let [x, y, z] = (place / side).to_array().map(|at| (at as u64).min((1 << 21) - 1));
    (x << 42) | (y << 21) | z
}

/// The first principal direction of the nodes near one, and how much more they spread along it than across.
fn direction(positions: &[Vec3], node: usize, near: &[(u32, f32)], reach: f32) -> (Vec3, f32) {
    let near = near.iter().filter(|near| near.1 <= reach).map(|near| positions[near.0 as usize]);
    let all: Vec<Vec3> = near.chain([positions[node]]).collect();
    if all.len() < 3 {
        return (Vec3::ZERO, 0.0);
    }
    let middle = all.iter().sum::<Vec3>() / all.len() as f32;
    principal(all.iter().map(|&place| place - middle))
}

/// The first principal direction of places about 0, and by what part their spread along it exceeds that across.
pub(super) fn principal(places: impl Iterator<Item = Vec3>) -> (Vec3, f32) {
    let mut rows = [Vec3::ZERO; 3];
    for place in places {
        for axis in 0..3 {
            rows[axis] += place * place[axis];
        }
    }
    let trace = rows[0].x + rows[1].y + rows[2].z;
    // Power iteration, from the longest row, on.
    let mut along = rows
        .into_iter()
        .max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))
        .unwrap_or(Vec3::ZERO);
    for _ in 0..12 {
        along = along.normalize_or_zero();
        along = Vec3::new(rows[0].dot(along), rows[1].dot(along), rows[2].dot(along));
    }
    let first = along.length();
    let along = along.normalize_or_zero();
    if along == Vec3::ZERO || trace <= 0.0 {
        return (Vec3::ZERO, 0.0);
    }
    // The second eigenvalue is at most the rest, at least half of it.
    let second = 0.75 * (trace - first).max(0.0);
    (along, ((first - second) / first).clamp(0.0, 1.0))
}
