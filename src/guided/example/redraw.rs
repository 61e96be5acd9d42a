//! Branches of the graph drawn anew, with the example's internodes, angles and straightness.

use super::axis::Axis;
use super::laterals::{LateralsLike, Planned};
use super::learn::{Model, chord_angles, models};
use crate::math::{Rotation, UP, angle_between, perpendicular};
use crate::metrics::branch_angles;
use crate::random::{Purpose, stream};
use crate::skeleton::{Skeleton, SkeletonError};
use glam::{Mat3, Vec3};
use rand::RngExt;
use rand::seq::SliceRandom;

/// Traits of an example that a graph cannot give: its nodes keep their spacing, so that first
/// internodes stand out wide, and paths wind.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Redraw {
    /// Metres, by order.
    internodes: Vec<f32>,
    /// The most internodes of a branch, by order.
    most: Vec<u32>,
    /// Angles at the first internode by order, radians.
    angles: Vec<Vec<f32>>,
    /// Mean and standard deviation of the angles between parent branches and chords, by order from 1.
    pub(super) chords: Vec<[f32; 2]>,
    /// Mean of how far branches stray from their chords, as a share of those.
    sweep: f32,
    /// Branches of each order.
    counts: Vec<usize>,
}

/// Share that the number of branches of an order may be above the example's, or below.
const NUMBERS: f32 = 0.1;

/// A branch drawn anew.
#[derive(Debug, Clone)]
struct Drawn {
    /// Its nodes and where they are, as shares of its length; the first is that of its parent branch.
    nodes: Vec<(u32, f32)>,
    /// Rotation.
    turn: Mat3,
    order: u16,
    /// Places of its laterals.
    bears: Vec<usize>,
}

/// Mean over all branches of three nodes or more, but the trunk.
fn mean_sweep<'a>(axes: impl Iterator<Item = &'a Axis>) -> f32 {
    let (mut sum, mut count) = (0.0, 0.0);
    for axis in axes.filter(|axis| axis.nodes.len() > 2) {
        sum += axis.sweep().min(1.0);
        count += 1.0;
    }
    if count > 0.0 { sum / count } else { 0.0 }
}

fn all_chords(models: &[Vec<Model>]) -> Vec<[f32; 2]> {
    models[..models.len() - 1].iter().enumerate().map(|(order, models)| chord_angles(models, order)).collect()
}

impl Redraw {
    pub(super) fn of(skeleton: &Skeleton, models: &[Vec<Model>]) -> Self {
        let mut internodes: Vec<[f32; 2]> = Vec::new();
        let branches = skeleton.branches();
        let axes: Vec<Axis> = branches.iter().map(|branch| Axis::of(skeleton, &branch)).collect();
        for (branch, axis) in branches.iter().zip(&axes) {
            let order = usize::from(branch.order());
            internodes.resize(internodes.len().max(order + 1), [0.0; 2]);
            internodes[order][0] += axis.length();
            internodes[order][1] += (axis.nodes.len() - 1) as f32;
        }
        let mut most = vec![0; internodes.len()];
        for (branch, axis) in branches.iter().zip(&axes) {
            let own = &mut most[usize::from(branch.order())];
            *own = (axis.nodes.len() as u32 - 1).max(*own);
        }
        let mut angles = vec![Vec::new(); internodes.len()];
        for angle in branch_angles(skeleton, 0.0).unwrap_or_default() {
            angles[usize::from(angle.order)].push(angle.angle);
        }
        let internodes = internodes.into_iter().map(|[length, count]| length / count.max(1.0)).collect();
        Self {
            internodes,
            most,
            angles,
            chords: all_chords(models),
            sweep: mean_sweep(axes.iter().skip(1)),
            counts: models.iter().map(Vec::len).collect(),
        }
    }

    /// The same branches from about the same bases to the same tips, then the `laterals`, by order from 1, that their branches
    /// should have and the graph had no room for, in so many rounds at most.
    pub(super) fn apply(
        &self,
        tree: &Skeleton,
        laterals: &[LateralsLike],
        seed: u64,
        rounds: u64,
    ) -> Result<Skeleton, SkeletonError> {
        let branches = tree.branches();
        let axes: Vec<(u16, Axis)> =
            branches.iter().map(|branch| (branch.order(), Axis::of(tree, &branch))).collect();
        let mut home = vec![(0usize, 0.0f32); tree.len()];
        let mut bears = vec![false; axes.len()];
        for (number, (order, axis)) in axes.iter().enumerate() {
            for (place, &node) in axis.nodes.iter().enumerate().skip(usize::from(*order > 0)) {
                home[node as usize] = (number, axis.line.ways[place] / axis.length().max(f32::MIN_POSITIVE));
            }
        }
        for (_, axis) in axes.iter().skip(1) {
            bears[home[axis.nodes[0] as usize].0] = true;
        }
        let winding = mean_sweep(axes.iter().skip(1).map(|(_, axis)| axis));
        let kept = if winding > 0.0 { (self.sweep / winding).min(1.0) } else { 0.0 };
        let found = all_chords(&models(tree));
        let mut drawing = Drawing::new(self, tree.positions()[0], seed);
        for (number, (order, axis)) in axes.iter().enumerate() {
            let (mut parent, mut place, mut turn) = (0, 0, Mat3::IDENTITY);
            if number > 0 {
                let share;
                (parent, share) = home[axis.nodes[0] as usize];
                place = drawing.branches[parent].nearest(share, parent == 0);
                let before = drawing.branches[parent].turn;
                let direction = if *order == 1 { UP } else { drawing.direction(parent, place) };
                turn = self.turned(usize::from(*order), &found, direction, before * axis.chord()) * before;
            }
            let least = if bears[number] { 2 } else { 1 };
            drawing.draw(*order, (number > 0).then_some((parent, place)), axis, turn, kept, least);
        }
        drawing.complete(laterals, rounds);
        drawing.skeleton()
    }
}

/// Branches drawn so far.
struct Drawing<'a> {
    redraw: &'a Redraw,
    seed: u64,
    positions: Vec<Vec3>,
    parents: Vec<Option<u32>>,
    orders: Vec<u16>,
    hops: Vec<u32>,
    branches: Vec<Drawn>,
}

impl<'a> Drawing<'a> {
    fn new(redraw: &'a Redraw, root: Vec3, seed: u64) -> Self {
        Self {
            redraw,
            seed,
            positions: vec![root],
            parents: vec![None],
            orders: vec![0],
            hops: vec![0],
            branches: Vec::new(),
        }
    }

    /// Adds a branch along an axis; all but the trunk leave a place of a parent branch.
    fn draw(
        &mut self,
        order: u16,
        parent: Option<(usize, usize)>,
        axis: &Axis,
        turn: Mat3,
        kept: f32,
        least: u32,
    ) {
        let number = self.branches.len();
        let last = self.redraw.internodes.len() - 1;
        let internode = self.redraw.internodes[usize::from(order).min(last)].max(1e-6);
        // Where branches of the example have next to no length, a branch is not cut into millions.
        let most = self.redraw.most[usize::from(order).min(last)].saturating_mul(2).clamp(least, 1_000_000);
        let parts = (axis.length() / internode).round().clamp(least as f32, most as f32) as u32;
        let (mut base, mut leaves) = (0, None);
        if let Some((parent, place)) = parent {
            base = self.branches[parent].nodes[place].0;
            self.branches[parent].bears.push(place);
            let angles = &self.redraw.angles[usize::from(order).min(last)];
            if !angles.is_empty() {
                let at = |node: u32| self.positions[node as usize];
                let before = self.parents[base as usize].map_or(UP, |before| at(base) - at(before));
                let mut random = stream(self.seed, u32::from(order), Purpose::LATERAL, number as u64);
                leaves = Some((before.normalize_or(UP), angles[random.random_range(0..angles.len())]));
            }
        }
        let line = Line::new(axis, self.positions[base as usize], turn, kept, leaves);
        let mut own = Drawn { nodes: vec![(base, 0.0)], turn, order, bears: Vec::new() };
        let mut before = base;
        for part in 1..=parts {
            let share = part as f32 / parts as f32;
            let node = self.positions.len() as u32;
            self.positions.push(line.at(share, 1.0 / parts as f32));
            self.parents.push(Some(before));
            self.orders.push(order);
            self.hops.push(part);
            own.nodes.push((node, share));
            before = node;
        }
        self.branches.push(own);
    }

    /// Adds laterals that branches lack, order by order, up to about the example's number: paths of a graph merge, and twigs of
    /// centimetres would take a graph of centimetres.
    fn complete(&mut self, laterals: &[LateralsLike], rounds: u64) {
        for (order, like) in (0u16..).zip(laterals) {
            let mut random = stream(self.seed, u32::from(order), Purpose::COMPLETION, u64::MAX);
            let share = 1.0 + NUMBERS * (2.0 * random.random::<f32>() - 1.0);
            let wanted = (self.redraw.counts[usize::from(order) + 1] as f32 * share).round() as usize;
            let there = self.branches.iter().filter(|branch| branch.order == order + 1).count();
            let mut left = wanted.saturating_sub(there);
            for round in 0..rounds {
                let mut missing =
                    self.missing(order, like, round, round > 0 && 2 * round >= rounds && left == wanted);
                missing.shuffle(&mut random);
                missing.truncate(left);
                left -= missing.len();
                for (parent, Planned { place, way }) in missing {
                    let base = self.at(self.branches[parent].nodes[place].0);
                    let axis = Axis::new(vec![0, 0], vec![base, base + way]);
                    self.draw(order + 1, Some((parent, place)), &axis, Mat3::IDENTITY, 0.0, 1);
                }
                if left == 0 {
                    break;
                }
            }
        }
    }

    /// Laterals that branches of an order should have and have not, each with the number of its parent branch; in later rounds
    /// all that branches of their lengths have, for there are fewer such branches than in the example; `like_bearers` if no
    /// branch is as long as those that bear any.
    fn missing(
        &self,
        order: u16,
        like: &LateralsLike,
        round: u64,
        like_bearers: bool,
    ) -> Vec<(usize, Planned)> {
        let mut missing = Vec::new();
        let own = |(_, branch): &(usize, &Drawn)| branch.order == order && branch.nodes.len() > 2;
        for (number, branch) in self.branches.iter().enumerate().filter(own) {
            let nodes: Vec<u32> = branch.nodes.iter().map(|&(node, _)| node).collect();
            let points = nodes.iter().map(|&node| self.at(node)).collect();
            let mut random =
                stream(self.seed, u32::from(order), Purpose::COMPLETION, number as u64 | round << 32);
            let axis = Axis::new(nodes, points);
            let mut planned = if like_bearers {
                like.of_bearer(&axis, &mut random)
            } else {
                like.of_branch(&axis, &mut random)
            };
            for &place in branch.bears.iter().filter(|_| round == 0) {
                let near = (0..planned.len()).min_by_key(|&i| planned[i].place.abs_diff(place));
                near.map(|near| planned.remove(near));
            }
            let least = usize::from(order > 0);
            missing.extend(
                planned.into_iter().map(|one| (number, Planned { place: one.place.max(least), ..one })),
            );
        }
        missing
    }

    fn at(&self, node: u32) -> Vec3 {
        self.positions[node as usize]
    }

    /// Direction of a branch over two nodes each way.
    fn direction(&self, branch: usize, place: usize) -> Vec3 {
        let nodes = &self.branches[branch].nodes;
        let [before, after] = [place.saturating_sub(2), (place + 2).min(nodes.len() - 1)];
        (self.at(nodes[after].0) - self.at(nodes[before].0)).normalize_or(UP)
    }

    fn skeleton(self) -> Result<Skeleton, SkeletonError> {
        let stages = self.orders.clone();
        let tree = Skeleton::new(self.positions, self.parents)?;
        tree.with_stages(stages)?.with_hops(self.hops)?.with_orders(self.orders)
    }
}

impl Redraw {
    /// Turns a chord, that is at some angle to its parent branch, as far as the angles of its order are off.
    fn turned(&self, order: usize, found: &[[f32; 2]], direction: Vec3, chord: Vec3) -> Mat3 {
        let (Some(&[wanted, wanted_spread]), Some(&[mean, spread])) =
            (self.chords.get(order - 1), found.get(order - 1))
        else {
            return Mat3::IDENTITY;
        };
        let angle = angle_between(direction, chord);
        let narrower = if spread > 0.0 { (wanted_spread / spread).min(1.0) } else { 1.0 };
        let turn = (wanted + (angle - mean) * narrower).clamp(0.0, 3.1) - angle;
        let axis = direction.cross(chord).normalize_or(perpendicular(direction));
        let rotation = Rotation::new(turn);
        Mat3::from_cols(
            rotation.about(axis, Vec3::X),
            rotation.about(axis, Vec3::Y),
            rotation.about(axis, Vec3::Z),
        )
    }
}

impl Drawn {
    /// The place of the node nearest to a share, neither the tip nor, but of the trunk, the base.
    fn nearest(&self, share: f32, is_trunk: bool) -> usize {
        let inner = usize::from(!is_trunk)..(self.nodes.len() - 1).max(1);
        let away = |place: &usize| (self.nodes[*place].1 - share).abs();
        inner.min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0)
    }
}

/// A branch between its base and its tip.
struct Line<'a> {
    axis: &'a Axis,
    base: Vec3,
    turn: Mat3,
    /// From its base to its tip.
    chord: Vec3,
    /// Share of its winding that it keeps.
    kept: f32,
    /// The way it leaves its parent branch; none for the trunk.
    leaves: Option<Vec3>,
}

impl<'a> Line<'a> {
    /// On a base, turned, leaving a parent branch of some direction at an angle, on the side of its tip.
    fn new(axis: &'a Axis, base: Vec3, turn: Mat3, kept: f32, leaves: Option<(Vec3, f32)>) -> Self {
        let chord = turn * axis.chord();
        let leaves = leaves.map(|(parent, angle)| {
            let axis = parent.cross(chord).normalize_or(perpendicular(parent));
            Rotation::new(angle).about(axis, parent)
        });
        Self { axis, base, turn, chord, kept, leaves }
    }

    /// Point at a share of its way; the first internode ends at `first`, and from there on the branch comes to its chord.
    fn at(&self, share: f32, first: f32) -> Vec3 {
        let axis = self.axis;
        let old = axis.line.at(share);
        let Some(leaves) = self.leaves else { return old };
        let winding = self.turn * (old - (axis.line.points[0] + axis.chord() * share)) * self.kept;
        if first >= 1.0 {
            return self.base + self.chord;
        }
        let aside = (leaves * self.chord.length() - self.chord) * first;
        if share <= first {
            return self.base + self.chord * share + aside * (share / first);
        }
        let rest = (1.0 - share) / (1.0 - first);
        self.base + self.chord * share + aside * rest + winding * (1.0 - rest)
    }
}
