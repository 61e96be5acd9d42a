//! A branch as a line with ways, directions and frames.

use crate::guided::curve::Line;
use crate::math::UP;
use crate::skeleton::{Branch, Skeleton};
use glam::Vec3;

/// The nodes of a branch, from the one it leaves.
#[derive(Debug)]
pub(super) struct Axis {
    pub(super) nodes: Vec<u32>,
    pub(super) line: Line,
}

/// Half the chord that a direction is taken over, in lengths of the branch, and the fewest nodes each way.
const CHORD: f32 = 0.06;
const NODES: usize = 2;

impl Axis {
    pub(super) fn of(skeleton: &Skeleton, branch: &Branch<'_>) -> Self {
        let nodes = branch.nodes().to_vec();
        let points = nodes.iter().map(|&node| skeleton.positions()[node as usize]).collect();
        Self::new(nodes, points)
    }

    /// Nodes and where they are.
    pub(super) fn new(nodes: Vec<u32>, points: Vec<Vec3>) -> Self {
        Self { nodes, line: Line::new(points) }
    }

    pub(super) fn length(&self) -> f32 {
        self.line.length()
    }

    /// From base to tip, straight.
    pub(super) fn chord(&self) -> Vec3 {
        self.line.points[self.line.points.len() - 1] - self.line.points[0]
    }

    /// The farthest that it strays from its chord, as a share of the chord.
    pub(super) fn sweep(&self) -> f32 {
        let chord = self.chord();
        let along = chord.normalize_or(UP);
        let aside = |&point: &Vec3| {
            let way = point - self.line.points[0];
            (way - along * way.dot(along)).length()
        };
        self.line.points.iter().map(aside).fold(0.0, f32::max) / chord.length().max(f32::MIN_POSITIVE)
    }

    /// The place of the node nearest to a share of the way, but not the tip.
    pub(super) fn place(&self, share: f32) -> usize {
        let way = share * self.length();
        let after = self.line.ways.partition_point(|&other| other < way).min(self.line.ways.len() - 1);
        let nearer = after > 0 && way - self.line.ways[after - 1] < self.line.ways[after] - way;
        (after - usize::from(nearer)).min(self.line.ways.len().saturating_sub(2))
    }

    /// Unit vector along the branch at one of its nodes.
    pub(super) fn direction(&self, place: usize) -> Vec3 {
        let half = CHORD * self.length();
        let before = self.line.ways.partition_point(|&way| way < self.line.ways[place] - half);
        let after = self.line.ways.partition_point(|&way| way < self.line.ways[place] + half);
        let before = before.min(place.saturating_sub(NODES));
        let after = after.max(place + NODES).min(self.line.points.len() - 1);
        (self.line.points[after] - self.line.points[before]).normalize_or(UP)
    }

    /// Difference in tilt between its second half and its first, in radians per metre: above 0 it
    /// turns down.
    pub(super) fn bend(&self) -> f32 {
        let middle = self.place(0.5).max(1).min(self.line.points.len() - 1);
        let tilt = |way: Vec3| crate::math::angle_between(way, UP);
        let [first, second] = [
            self.line.points[middle] - self.line.points[0],
            self.line.points[self.line.points.len() - 1] - self.line.points[middle],
        ];
        let usable = first.length_squared() > 0.0 && second.length_squared() > 0.0 && self.length() > 0.0;
        if usable { (tilt(second) - tilt(first)) / (0.5 * self.length()) } else { 0.0 }
    }
}

/// Along a branch, as far up as is perpendicular to it, and to its side.
pub(super) fn frame(direction: Vec3) -> [Vec3; 3] {
    let side = direction.cross(UP).normalize_or(Vec3::X);
    [direction, side.cross(direction).normalize_or(UP), side]
}
