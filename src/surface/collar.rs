//! Collars: the bases of branches where they leave their parent branches.

use super::axis::{Axes, Axis, Station};
use super::circle::Circles;
use super::lanes::{LANES, Lanes};
use super::wood::{Near, Place, Wood};
use crate::math::{atan2, parallel_transport};
use glam::{Vec3, Vec4};
use std::f32::consts::TAU;

/// Reach of a collar's base beyond the branch, in radii of the branch, for rings of `FLARE_SIDES`
/// and more; fewer sides have such long edges and sharp corners that they keep closer.
const FLARE: f32 = 0.7;
const FLARE_SIDES: f32 = 8.0;
/// Distance from the parent branch at which a collar ends, in radii of the branch.
const CLEARANCE: f32 = 0.8;
/// Depth to which a collar's base is sunk into the parent branch, in radii of the branch.
const SUNK: f32 = 0.03;
/// The greatest such depth, in radii of the parent branch: where that bends, it is thinner than its
/// rings are wide.
const DEEPEST: f32 = 0.25;
/// The longest collar, in radii of both branches together: a branch that runs on beside its parent
/// branch has none.
pub(super) const LONGEST: f32 = 8.0;
/// The thickest collar base, in radii of the parent branch.
const THICKEST: f32 = 0.9;
/// The radius at the start of the wood within a collar, in radii of the straight tube there. Between its few rings, and
/// where its ends are sunk, a collar is a little thinner than that tube.
const CORE: f32 = 0.5;
/// The farthest that a branch springs from its parent branch's axis, in radii of the parent branch.
const OFF_AXIS: f32 = 0.5;
/// Tolerance of the place where the branch leaves its parent branch's surface, in radii of the
/// branch.
const TOLERANCE: f32 = 0.1;
/// Distance from the parent branch that ends the collar of a branch that bends before `CLEARANCE`,
/// in radii of the branch.
const BARELY: f32 = 0.1;
/// Tolerance of the distance at which a collar ends, in radii of the branch.
const NEAR: f32 = 0.25;
/// Greatest distance of a branch with a collar from its straight tube, in radii of the branch.
const WAYWARD: f32 = 0.7;
/// The shortest way from a collar to the next ring, in radii of the branch.
const SHORTEST: f32 = 0.25;

/// The blend between a branch and its parent branch: a round fillet from the parent branch's
/// surface to the first level ring.
///
/// Each vertex of that ring is joined to the parent branch by a quadratic Bézier curve. Its inner
/// control point is where the branch, as a straight tube, comes out of the parent branch; its end
/// lies farther out on the parent branch's triangles. So the curve leaves the parent branch along
/// its surface and arrives along the branch.
#[derive(Debug)]
pub(super) struct Collar {
    /// Start of the straight tube within the parent branch, which ends at the first level ring.
    pub(super) start: Station,
    /// The parent branch's ring below that start.
    pub(super) bearing: usize,
    /// The first level ring.
    pub(super) end: Station,
    /// The number of the station after that ring.
    pub(super) next: usize,
}

/// The curves of four neighbouring vertices.
#[derive(Debug, Clone, Copy)]
pub(super) struct Curves {
    points: [Lanes; 3],
    /// The parent branch's normals at the bases and at the inner control points.
    normals: [Lanes; 2],
    /// Places of the bases on the parent branch, and their turns from where its rings begin.
    pub(super) places: [(Place, f32); LANES],
}

impl Curves {
    pub(super) fn point(&self, t: f32) -> Lanes {
        let [a, b, c] = self.points;
        a.lerp(b, t).lerp(b.lerp(c, t), t)
    }

    /// The parent branch's normals below the points.
    pub(super) fn normal(&self, t: f32) -> Lanes {
        let [foot, inner] = self.normals;
        inner.lerp(foot, (1.0 - t) * (1.0 - t))
    }

    /// Their starts, on the parent branch.
    pub(super) fn feet(&self) -> Lanes {
        self.points[0]
    }

    /// The directions in which they go on, of no particular length.
    pub(super) fn direction(&self, t: f32) -> Lanes {
        let [a, b, c] = self.points;
        (b - a).lerp(c - b, t)
    }

    /// Their ends, in the first level ring.
    pub(super) fn rim(&self) -> Lanes {
        self.points[2]
    }
}

impl Collar {
    /// The collar of `axis`, which springs at `base` out of the wood of `bearer`; `None` for an
    /// axis that does not come out of it in time.
    pub(super) fn of(axes: &Axes, axis: &Axis, bearer: usize, base: &Near) -> Option<Self> {
        let wood = axes.wood(bearer);
        let stations = &axes.stations[axis.stations.clone()];
        let mut inside = Inside { number: 0, station: axis.base, near: *base };
        // The first ring that is out of the parent branch, though not clear of it.
        let mut out = None;
        let mut ring = base.place.ring;
        // Distance of a ring from the parent branch's surface, less the clearance.
        let mut outside = |position: Vec3, tangent: Vec3, radius: f32| {
            let near = wood.near(position, ring);
            ring = near.place.ring;
            let sideways = if near.distance > 0.0 { tangent.dot(near.way) / near.distance } else { 0.0 };
            let reach = (1.0 - sideways * sideways).max(0.0).sqrt();
            (near.outside() - radius * (reach + CLEARANCE), near)
        };
        let mut before = -base.radius - axis.base.radius;
        let mut clear = None;
        for (i, pair) in stations.windows(2).enumerate() {
            let [from, to] = [&pair[0], &pair[1]];
            if from.along > inside.farthest() {
                break;
            }
            let (after, near) = outside(to.position, to.tangent, to.radius);
            if after < 0.0 {
                before = after;
                if near.distance <= OFF_AXIS * near.radius {
                    inside = Inside { number: i + 1, station: *to, near };
                    out = None;
                } else if out.is_none() && after >= (BARELY - CLEARANCE) * to.radius {
                    out = Some(i + 1);
                }
                continue;
            }
            let way = to.position - from.position;
            let (mut low, mut high) = ((0.0, before), (1.0, after));
            let mut part = (before / (before - after)).clamp(0.0, 1.0);
            // A parent branch that bends, tapers or flares is left sooner or later than a straight
            // one.
            for _ in 0..6 {
                let radius = from.radius + (to.radius - from.radius) * part;
                let far = outside(from.position + way * part, to.tangent, radius).0;
                if far.abs() <= NEAR * radius {
                    break;
                }
                *(if far < 0.0 { &mut low } else { &mut high }) = (part, far);
                part = low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1)).clamp(0.1, 0.9);
            }
            let too_near = (1.0 - part) * way.length() < SHORTEST * to.radius;
            let end = if too_near { *to } else { from.lerp(to, part) };
            clear = inside.collar(stations, &end, i + 1 + usize::from(too_near));
            break;
        }
        let collar = clear.or_else(|| inside.collar(stations, stations.get(out?)?, out? + 1))?;
        Some(Self { next: axis.stations.start + collar.next, ..collar })
    }
}

/// The last station of a branch that is well within its parent branch; from there the way out is
/// straight.
struct Inside {
    number: usize,
    station: Station,
    near: Near,
}

impl Inside {
    /// End of the longest collar from here, metres from the root.
    fn farthest(&self) -> f32 {
        self.station.along + LONGEST * (self.near.radius + self.station.radius)
    }

    /// The collar from here to `end`, which lies before station `next`; `None` if the branch does not go straight there.
    fn collar(&self, stations: &[Station], end: &Station, next: usize) -> Option<Collar> {
        if self.near.radius <= 0.0 || end.radius <= 0.0 || end.along > self.farthest() {
            return None;
        }
        let start = self.start(end);
        let between = stations.get(self.number + 1..next - 1).unwrap_or_default();
        let collar = Collar { start, bearing: self.near.place.ring, end: *end, next };
        is_straight(&start, between, end).then_some(collar)
    }

    /// The start of the straight tube to `end`, so near to the parent branch's axis and so thin
    /// that it is within the parent branch.
    fn start(&self, end: &Station) -> Station {
        let (near, within) = (&self.near, &self.station);
        let most = OFF_AXIS * near.radius;
        let off = if near.distance > most { near.way * (1.0 - most / near.distance) } else { Vec3::ZERO };
        let position = within.position - off;
        let tangent = (end.position - position).normalize_or(end.tangent);
        Station {
            position,
            radius: CORE * end.radius.min(THICKEST * near.radius - near.distance.min(most)),
            tangent,
            along: within.along,
            normal: parallel_transport(end.tangent, tangent, end.normal),
            taper: 0.0,
            at: within.at,
        }
    }
}

/// `true` if all stations between two others are near the straight way between these.
fn is_straight(start: &Station, between: &[Station], end: &Station) -> bool {
    between.iter().all(|station| {
        let way = station.position - start.position;
        let off = way - start.tangent * way.dot(start.tangent);
        off.length_squared() <= (WAYWARD * end.radius) * (WAYWARD * end.radius)
    })
}

/// The curve of each vertex of the first level ring of an axis with a collar, the last group of four filled up with
/// the first vertex.
pub(super) fn curves(axes: &Axes, circles: &Circles, axis: &Axis, curves: &mut Vec<Curves>) {
    curves.clear();
    let Some((bearer, hint)) = axis.bearing.filter(|_| axis.has_collar) else { return };
    let [start, end] = [axes.stations[axis.stations.start - 1], axes.stations[axis.stations.start]];
    let bearing = Bearing::new(axes, circles, (bearer, hint), start.position);
    let thickness = start.radius / CORE;
    let flare = FLARE * thickness * ((axis.sides as f32 - 3.0) / (FLARE_SIDES - 3.0)).clamp(0.2, 1.0);
    // The edges of the base cut through the round of the parent branch.
    let edge = TAU / axis.sides as f32 * (thickness + flare);
    let sunk = SUNK * thickness + (edge * edge / (8.0 * bearing.base.radius)).min(0.5 * thickness);

    let each = Vec4::splat;
    let mut way = Way::new(&bearing, &start, end.position, thickness);
    let (middle, near) = bearing.exit(&way, start.position, way.guesses(Lanes::default()).x);
    let center = start.position + start.tangent * middle;
    way.straighten(&bearing, &near, center - start.position);
    let [normal, binormal] = [start.normal, start.tangent.cross(start.normal)].map(Lanes::splat);
    let [end_normal, end_binormal] = [end.normal, end.tangent.cross(end.normal)].map(Lanes::splat);
    for &[cos, sin] in &circles.of(axis.sides).fours {
        let offsets = (normal * cos + binormal * sin) * each(thickness);
        let guesses = way.guesses(offsets).to_array();
        let starts = (Lanes::splat(start.position) + offsets).to_array();
        let exits: [_; LANES] = std::array::from_fn(|lane| bearing.exit(&way, starts[lane], guesses[lane]));
        let points = Lanes::of(std::array::from_fn(|lane| starts[lane] + start.tangent * exits[lane].0));
        let nears = exits.map(|(_, near)| near);
        let ways = Lanes::of(nears.map(|near| near.way));
        let radial = ways.normalize_or(Lanes::default);
        let ([tangents, normals], tapers) = bearing.frames(&nears);
        let turned = [ways.dot(tangents.cross(normals)), ways.dot(normals)];
        let outward = points - Lanes::splat(center);
        let outward = (outward - radial * outward.dot(radial)).normalize_or(Lanes::default) * each(flare);
        // Along the round of the parent branch, not off along its tangent.
        let around = outward.dot(tangents.cross(radial));
        let outer = (points + outward).to_array();
        let (mut feet, mut foot_normals) = ([Vec3::ZERO; LANES], [Vec3::ZERO; LANES]);
        let mut places = [(bearing.base.place, 0.0); LANES];
        for (lane, near) in nears.iter().enumerate() {
            let place = bearing.wood.place(outer[lane], near.place.ring);
            let round = if near.radius > 0.0 { around[lane] / near.radius } else { 0.0 };
            let depth = bearing.depth(place, sunk);
            let turns = (atan2(turned[0][lane], turned[1][lane]) + round) / TAU;
            (feet[lane], foot_normals[lane]) = bearing.surface(place, turns, depth);
            places[lane] = (place, turns);
        }
        let (feet, foot_normals) = (Lanes::of(feet), Lanes::of(foot_normals).normalize_or(|| radial));
        let rim = end_normal * cos + end_binormal * sin;
        curves.push(Curves {
            points: [feet, points, Lanes::splat(end.position) + rim * each(end.radius)],
            normals: [foot_normals, radial - tangents * tapers],
            places,
        });
    }
}

/// The wood around the place where a branch springs, and the corners of its rings.
struct Bearing<'a> {
    wood: Wood<'a>,
    /// `true` if it begins with a collar itself, between its first two rings.
    has_collar: bool,
    /// First node of the branch.
    base: Near,
    circle: &'a [[f32; 2]],
}

impl<'a> Bearing<'a> {
    fn new(axes: &'a Axes, circles: &'a Circles, (axis, station): (usize, usize), base: Vec3) -> Self {
        let wood = axes.wood(axis);
        let Axis { has_collar, sides, .. } = axes.all[axis];
        Self { wood, has_collar, base: wood.near(base, station), circle: &circles.of(sides).corners }
    }

    fn exit(&self, way: &Way, start: Vec3, guess: f32) -> (f32, Near) {
        self.wood.exit((start, way.direction), guess, way.length, way.tolerance, self.base.place.ring)
    }

    fn surface(&self, place: Place, turns: f32, depth: f32) -> (Vec3, Vec3) {
        self.wood.surface(self.circle, place, turns, depth)
    }

    /// Depth at a place of a base that is to be sunk this far. Within its own collar the parent branch may be
    /// thin, and so it is between rings that are oblique to each other.
    fn depth(&self, place: Place, sunk: f32) -> f32 {
        let radius = self.wood.radius(place);
        if self.has_collar && place.ring == 0 {
            return CORE * radius;
        }
        let (below, above) = self.wood.around(place);
        sunk.min(DEEPEST * radius * below.tangent.dot(above.tangent).max(0.0))
    }

    /// The directions of the axis at some places, those in which rings begin there, and how it tapers.
    fn frames(&self, nears: &[Near; LANES]) -> ([Lanes; 2], Vec4) {
        let (mut frames, mut tapers) = ([[Vec3::ZERO; LANES]; 2], [0.0; LANES]);
        for (lane, near) in nears.iter().enumerate() {
            let (below, above) = self.wood.around(near.place);
            let part = near.place.part;
            frames[0][lane] = below.tangent.lerp(above.tangent, part);
            frames[1][lane] = below.normal.lerp(above.normal, part);
            tapers[lane] = below.taper + (above.taper - below.taper) * part;
        }
        (frames.map(Lanes::of), Vec4::from_array(tapers))
    }
}

/// The way of the straight tube through the parent branch.
struct Way {
    direction: Vec3,
    /// To the first level ring, metres.
    length: f32,
    tolerance: f32,
    /// The parent branch as a straight cylinder: the direction of its axis, its radius, and the way from
    /// there.
    tangent: Vec3,
    radius: f32,
    from: Vec3,
}

impl Way {
    fn new(bearing: &Bearing<'_>, start: &Station, end: Vec3, thickness: f32) -> Self {
        let mut way = Self {
            direction: start.tangent,
            length: start.position.distance(end),
            tolerance: TOLERANCE * thickness,
            tangent: Vec3::ZERO,
            radius: 0.0,
            from: Vec3::ZERO,
        };
        way.straighten(bearing, &bearing.base, Vec3::ZERO);
        way
    }

    /// Takes the parent branch for what it is near a point, which lies this far from the start.
    fn straighten(&mut self, bearing: &Bearing<'_>, near: &Near, offset: Vec3) {
        let (below, above) = bearing.wood.around(near.place);
        self.tangent = below.tangent.lerp(above.tangent, near.place.part).normalize_or(below.tangent);
        self.radius = near.radius;
        self.from = near.way - offset;
    }

    /// Estimated distances from these offsets at which the way leaves a straight parent branch.
    fn guesses(&self, offsets: Lanes) -> Vec4 {
        let level = |v: Vec3| v - self.tangent * v.dot(self.tangent);
        let slope = level(self.direction);
        // Along the parent branch it never comes out.
        let a = Vec4::splat(slope.length_squared().max(f32::MIN_POSITIVE));
        let flat = offsets + Lanes::splat(self.from);
        let tangent = Lanes::splat(self.tangent);
        let flat = flat - tangent * flat.dot(tangent);
        let b = flat.dot(Lanes::splat(slope));
        let c = flat.dot(flat) - Vec4::splat(self.radius * self.radius);
        ((-b + (b * b - a * c).max(Vec4::ZERO).sqrt()) / a).clamp(Vec4::ZERO, Vec4::splat(self.length))
    }
}
