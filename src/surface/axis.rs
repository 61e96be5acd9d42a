//! The smooth axes of branches, sampled where rings go.

use super::simplify::simplify;
use super::tube::Dropped;
use super::wood::Wood;
use super::{SurfaceError, Tubes};
use crate::Skeleton;
use crate::math::{UP, parallel_transport, perpendicular};
use crate::observer::Watch;
use glam::Vec3;
use std::ops::Range;

/// Farther out than this, in metres, products of coordinates leave the range of 32-bit floats.
const FARTHEST: f32 = 1e9;
/// Shorter or thinner than this, in metres, the products that make an area vanish in 32-bit floats.
const FINEST: f32 = 1e-9;
/// Times a coordinate: what 32-bit floats can still tell apart there, with two bits to spare.
const RESOLUTION: f32 = 4.0 * f32::EPSILON;
/// Cosine of the sharpest turn an axis follows, 120°; at a sharper one it ends and another begins.
const SHARPEST_TURN: f32 = -0.5;
/// Most parts of an internode: a turn of 240° within one is then smooth to 4°.
const MOST_PARTS: f32 = 64.0;
/// Height of the root flare, in radii of the trunk base.
const FLARE_REACH: f32 = 4.0;
/// The longest part of a flared internode, in radii of the trunk base.
const FLARE_PART: f32 = 0.5;

/// Place of a ring.
#[derive(Debug, Clone, Copy)]
pub(super) struct Station {
    pub(super) position: Vec3,
    /// Radius; zero where it is too small for 32-bit floats to tell it from zero.
    pub(super) radius: f32,
    /// The unit direction of the axis.
    pub(super) tangent: Vec3,
    /// Metres from the root along the axes.
    pub(super) along: f32,
    /// Direction of the ring's first corner: a unit vector perpendicular to the tangent, carried along without twist.
    pub(super) normal: Vec3,
    /// Growth of the radius along the branch, metres per metre; zero until the axis is attached to its parent branch.
    pub(super) taper: f32,
    /// Position between the nodes of its branch: the fractional number of a node.
    pub(super) at: f32,
}

impl Station {
    const NONE: Self = Self {
        position: Vec3::ZERO,
        radius: 0.0,
        tangent: Vec3::Y,
        along: 0.0,
        normal: Vec3::X,
        taper: 0.0,
        at: 0.0,
    };

    /// The station at the part `t` of the straight way to `next`.
    pub(super) fn lerp(&self, next: &Self, t: f32) -> Self {
        let tangent = self.tangent.lerp(next.tangent, t).normalize_or(self.tangent);
        Self {
            position: self.position.lerp(next.position, t),
            radius: self.radius + (next.radius - self.radius) * t,
            tangent,
            along: self.along + (next.along - self.along) * t,
            normal: parallel_transport(self.tangent, tangent, self.normal),
            taper: 0.0,
            at: self.at + (next.at - self.at) * t,
        }
    }
}

/// A branch, or the part of one between two sharp turns: at least two stations, not all of radius zero.
#[derive(Debug)]
pub(super) struct Axis {
    /// The stations of its rings.
    pub(super) stations: Range<usize>,
    /// `true` if the station before these is the start of a collar that leads to the first of them.
    pub(super) has_collar: bool,
    /// The first station of its wood: that of its first ring, or the start of its collar.
    pub(super) wood: usize,
    /// Its base: its first station before it was attached to its parent branch.
    pub(super) base: Station,
    pub(super) sides: u32,
    /// The number of the branch in [`Skeleton::branches`].
    pub(super) branch: usize,
    /// The node where this springs from another branch; `None` for the trunk, and after a sharp turn.
    pub(super) bearer: Option<u32>,
    /// The numbers of the axis that it is attached to and of a station there; `None` before it is attached.
    pub(super) bearing: Option<(usize, usize)>,
}

/// The axes of a skeleton, each parent axis before its laterals.
#[derive(Debug, Default)]
pub(super) struct Axes {
    pub(super) stations: Vec<Station>,
    pub(super) all: Vec<Axis>,
    /// For each node the numbers of its axis and its station; `None` if it is on none.
    places: Vec<Option<(u32, u32)>>,
}

impl Axes {
    /// The axes of the branches that `options` keep. O(nodes).
    pub(super) fn of(skeleton: &Skeleton, options: &Tubes, watch: &Watch<'_>) -> Result<Self, SurfaceError> {
        let thickest = thickest(skeleton)?;
        let branches = skeleton.branches();
        let dropped = options.dropped(skeleton, &branches);
        let lengths = lengths(skeleton);
        let mut axes = Self { places: vec![None; skeleton.len()], ..Self::default() };
        axes.stations.reserve(skeleton.len() + 2 * branches.len());
        let mut sampler = Sampler { options, dropped: &dropped, knots: Vec::new(), marks: Vec::new() };
        for (number, branch) in branches.iter().enumerate() {
            let nodes = branch.nodes();
            watch.pass(nodes.len() - 1)?;
            if dropped.contains(number) || nodes.len() < 2 {
                continue;
            }
            sampler.gather(skeleton, nodes, number == 0);
            let widest = sampler.knots.iter().map(|knot| knot.radius).fold(0.0, f32::max);
            let sides = options.sides_of(widest, thickest);
            let swelling = options.swelling(sides);
            let (mut start, mut along) = (0, lengths[nodes[0] as usize]);
            while start + 1 < sampler.knots.len() {
                let end = sampler.end_of_run(start);
                let bearer = (number != 0 && start == 0).then_some(nodes[0]);
                // Room for the start of a collar.
                let room = usize::from(bearer.is_some());
                axes.stations.extend((0..room).map(|_| Station::NONE));
                let first = axes.stations.len();
                let seam = if start == 0 { seam(skeleton, nodes[0] as usize) } else { Vec3::ZERO };
                if sampler.sample(start..end, number == 0 && start == 0, seam, along, &mut axes.stations) {
                    axes.stations[first..].iter_mut().for_each(|station| station.radius *= swelling);
                    let axis = axes.all.len() as u32;
                    for (knot, &mark) in sampler.knots[start..end].iter().zip(&sampler.marks) {
                        axes.places[knot.node as usize].get_or_insert((axis, mark));
                    }
                    along = axes.stations.last().map_or(along, |last| last.along);
                    axes.all.push(Axis {
                        stations: first..axes.stations.len(),
                        has_collar: false,
                        wood: first,
                        base: axes.stations[first],
                        sides,
                        branch: number,
                        bearer,
                        bearing: None,
                    });
                } else {
                    axes.stations.truncate(first - room);
                }
                start = end - 1;
            }
            // Nodes that were passed over are where the one before them is.
            for pair in nodes.windows(2) {
                let [before, node] = [pair[0] as usize, pair[1] as usize];
                axes.places[node] = axes.places[node].or(axes.places[before]);
            }
        }
        Ok(axes)
    }

    /// The numbers of a node's axis and station; `None` if it is on none.
    pub(super) fn place(&self, node: u32) -> Option<(usize, usize)> {
        self.places[node as usize].map(|(axis, station)| (axis as usize, station as usize))
    }

    /// The wood of an axis.
    pub(super) fn wood(&self, axis: usize) -> Wood<'_> {
        let axis = &self.all[axis];
        Wood { stations: &self.stations[axis.wood..axis.stations.end] }
    }
}

/// A node of a branch that is far enough from the one before it, and the unit way from there.
#[derive(Debug, Clone, Copy)]
struct Knot {
    position: Vec3,
    radius: f32,
    node: u32,
    /// Its number in the branch.
    number: u32,
    direction: Vec3,
    length: f32,
}

/// Makes stations of nodes, branch after branch.
struct Sampler<'a> {
    options: &'a Tubes,
    dropped: &'a Dropped,
    /// Knots of the current branch.
    knots: Vec<Knot>,
    /// The station of each knot of the latest sample.
    marks: Vec<u32>,
}

impl Sampler<'_> {
    /// Collects the knots of a branch. The trunk base has a radius of its own; any other branch starts with
    /// the radius of its first internode.
    fn gather(&mut self, skeleton: &Skeleton, nodes: &[u32], is_trunk: bool) {
        self.knots.clear();
        for (i, &node) in nodes.iter().enumerate() {
            let position = skeleton.positions()[node as usize];
            let mut radius = skeleton.radii()[node as usize];
            if i == 0 && !(is_trunk && radius > 0.0) {
                radius = skeleton.radii()[nodes[1] as usize];
            }
            let finest = finest(position);
            let (mut direction, mut length) = (Vec3::ZERO, 0.0);
            if let Some(last) = self.knots.last() {
                direction = position - last.position;
                length = direction.length();
                if length <= finest.max(self::finest(last.position)) {
                    continue;
                }
                direction /= length;
            }
            let radius = if radius > finest { self.dropped.widened(radius) } else { 0.0 };
            self.knots.push(Knot { position, radius, node, number: i as u32, direction, length });
        }
    }

    /// The knot after the last one before the next sharp turn.
    fn end_of_run(&self, start: usize) -> usize {
        let knots = &self.knots;
        let turns = |i: &usize| knots[*i].direction.dot(knots[i + 1].direction) < SHARPEST_TURN;
        (start + 1..knots.len() - 1).find(turns).map_or(knots.len(), |turn| turn + 1)
    }

    /// Adds the stations of a run of knots; adds nothing and says false if all their radii are zero.
    ///
    /// Between two knots lies the cubic Hermite curve whose tangents at a knot are those of Catmull and Rom 1974 for
    /// knots at their chords' lengths, as long as the chord: it cannot overshoot where a long internode meets a
    /// short one.
    fn sample(
        &mut self,
        run: Range<usize>,
        stands: bool,
        seam: Vec3,
        along: f32,
        stations: &mut Vec<Station>,
    ) -> bool {
        let knots = &self.knots[run];
        let last = knots.len() - 1;
        if knots.iter().all(|knot| knot.radius == 0.0) {
            return false;
        }
        // A trunk that leans up to 60° still stands on the ground with its whole base.
        let stands = stands && knots[1].direction.dot(UP) > 0.5;
        let tangent_at = |i: usize| match i {
            0 if stands => UP,
            0 => knots[1].direction,
            _ if i == last => knots[last].direction,
            _ => {
                let (before, after) = (&knots[i], &knots[i + 1]);
                (before.direction * after.length + after.direction * before.length)
                    .normalize_or(before.direction)
            }
        };
        let base = if stands { knots[0].radius } else { 0.0 };
        let flared = |radius: f32, height: f32| {
            let rest = 1.0 - height / (base * FLARE_REACH);
            if rest > 0.0 { radius * (1.0 + self.options.root_flare * rest * rest * rest) } else { radius }
        };
        let mut tangent = tangent_at(0);
        let mut station = Station {
            position: knots[0].position,
            radius: flared(knots[0].radius, 0.0),
            tangent,
            along,
            normal: across(seam, tangent),
            taper: 0.0,
            at: knots[0].number as f32,
        };
        let first = stations.len();
        stations.push(station);
        self.marks.clear();
        self.marks.push(first as u32);
        for i in 1..=last {
            let (from, to) = (&knots[i - 1], &knots[i]);
            let (before, after) = (tangent * to.length, tangent_at(i) * to.length);
            let turn = tangent.distance(to.direction) + to.direction.distance(after / to.length);
            let mut parts = self.options.parts(turn, to.length);
            if station.along - along < base * FLARE_REACH && self.options.root_flare > 0.0 {
                parts = parts.max((to.length / (base * FLARE_PART)).ceil());
            }
            let parts = parts.min(MOST_PARTS) as u32;
            for part in 1..=parts {
                let t = part as f32 / parts as f32;
                let (position, direction) = if part == parts {
                    (to.position, tangent_at(i))
                } else {
                    hermite(from.position, before, to.position, after, t)
                };
                let length = station.along + station.position.distance(position);
                // Near the ground rings are level: those of a thick trunk that leans at once would cross.
                let upright = (1.0 - (length - along) / (base * FLARE_REACH)).max(0.0);
                let direction = (direction.normalize_or(station.tangent) * (1.0 - upright) + UP * upright)
                    .normalize_or(station.tangent);
                station = Station {
                    position,
                    radius: flared(from.radius + (to.radius - from.radius) * t, length - along),
                    tangent: direction,
                    along: length,
                    normal: parallel_transport(station.tangent, direction, station.normal),
                    taper: 0.0,
                    at: from.number as f32 + (to.number - from.number) as f32 * t,
                };
                stations.push(station);
            }
            tangent = tangent_at(i);
            self.marks.push(stations.len() as u32 - 1);
        }
        if let Some(error) = self.options.error {
            let ball = |i: usize| (stations[first + i].position, stations[first + i].radius);
            // The other half of the error went into the sampling.
            let kept = simplify(stations.len() - first, ball, 0.5 * error);
            for (i, &station) in kept.iter().enumerate() {
                stations[first + i] = stations[first + station as usize];
            }
            stations.truncate(first + kept.len());
            for mark in &mut self.marks {
                let station = *mark - first as u32;
                *mark = (first + kept.partition_point(|&kept| kept <= station) - 1) as u32;
            }
        }
        true
    }
}

/// The point and the derivative of the cubic Hermite curve at `t`.
fn hermite(from: Vec3, before: Vec3, to: Vec3, after: Vec3, t: f32) -> (Vec3, Vec3) {
    let (way, rest) = (to - from, 1.0 - t);
    let point = from + way * (t * t * (3.0 - 2.0 * t)) + (before * rest - after * t) * (t * rest);
    let derivative =
        way * (6.0 * t * rest) + before * (rest * (1.0 - 3.0 * t)) + after * (t * (3.0 * t - 2.0));
    (point, derivative)
}

/// The unit vector perpendicular to `tangent` on the side of `seam`.
fn across(seam: Vec3, tangent: Vec3) -> Vec3 {
    let across = seam - tangent * seam.dot(tangent);
    // Nearly parallel ones leave nothing but rounding.
    if across.length_squared() > 1e-4 { across.normalize() } else { perpendicular(tangent) }
}

/// Rings begin where they are seen least: on the side of the parent branch's base.
fn seam(skeleton: &Skeleton, bearer: usize) -> Vec3 {
    let Some(parent) = skeleton.parent(bearer) else { return Vec3::ZERO };
    (skeleton.positions()[parent] - skeleton.positions()[bearer]).normalize_or_zero()
}

/// Metres from the root along the axes, to each node.
fn lengths(skeleton: &Skeleton) -> Vec<f32> {
    let positions = skeleton.positions();
    let mut lengths = vec![0.0; skeleton.len()];
    for (node, parent) in skeleton.edges() {
        lengths[node] = lengths[parent] + positions[parent].distance(positions[node]);
    }
    lengths
}

/// The largest radius; refuses what floats cannot compute with.
pub(super) fn thickest(skeleton: &Skeleton) -> Result<f32, SurfaceError> {
    let mut thickest = 0.0f32;
    for (node, (&position, &radius)) in skeleton.positions().iter().zip(skeleton.radii()).enumerate() {
        if position.abs().max_element() > FARTHEST || radius > FARTHEST {
            return Err(SurfaceError::TooFar { node, position, radius });
        }
        thickest = thickest.max(radius);
    }
    if thickest > 0.0 { Ok(thickest) } else { Err(SurfaceError::NoRadii { nodes: skeleton.len() }) }
}

/// The smallest length that can be told from zero at `position`, metres.
fn finest(position: Vec3) -> f32 {
    (position.abs().max_element() * RESOLUTION).max(FINEST)
}
