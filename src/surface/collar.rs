//! Where a branch leaves the one that bears it.

use super::axis::{Axes, Axis, Station};
use super::circle::Circles;
use crate::math::{atan2, parallel_transport};
use glam::Vec3;
use std::f32::consts::TAU;

/// How far the foot of a collar reaches beyond the branch, in radii of the branch, for rings of so many sides and more;
/// the feet of fewer have such long edges and sharp corners that they keep closer.
const FLARE: f32 = 0.7;
const FLARE_SIDES: f32 = 8.0;
/// How far out of the bearing branch a collar ends, in radii of the branch.
const CLEARANCE: f32 = 0.8;
/// How deep the foot of a collar is sunk into the bearing branch, in radii of the branch.
const SUNK: f32 = 0.03;
/// The longest collar, in radii of both branches together: what runs on beside its bearing branch has none.
const LONGEST: f32 = 8.0;
/// The thickest foot, in radii of the bearing branch.
const THICKEST: f32 = 0.9;
/// The shortest way from a collar to the next ring, in radii of the branch.
const SHORTEST: f32 = 0.25;

/// The blend between a branch and its bearer: a round fillet from the bearer's surface to the first level ring.
///
/// Each vertex of that ring is joined to the bearer by a quadratic Bézier curve. Its inner control point is where
/// the branch, as a straight tube, meets the bearer's triangles; its foot lies farther out on these triangles. So the
/// curve leaves the bearer along the bearer and arrives along the branch.
#[derive(Debug)]
pub(super) struct Collar {
    /// The first level ring.
    pub(super) end: Station,
    /// The number of the station after that ring.
    pub(super) next: usize,
    /// The numbers of the bearing axis and of its station where the branch springs.
    bearing: (usize, usize),
}

/// The curve of one vertex.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Curve {
    pub(super) points: [Vec3; 3],
    /// The bearer's normals at the foot and at the inner control point.
    normals: [Vec3; 2],
}

impl Curve {
    pub(super) fn point(&self, t: f32) -> Vec3 {
        let [a, b, c] = self.points;
        a.lerp(b, t).lerp(b.lerp(c, t), t)
    }

    /// The bearer's normal below the point.
    pub(super) fn normal(&self, t: f32) -> Vec3 {
        let [foot, inner] = self.normals;
        inner.lerp(foot, (1.0 - t) * (1.0 - t))
    }

    /// The direction in which it goes on, of no particular length.
    pub(super) fn direction(&self, t: f32) -> Vec3 {
        let [a, b, c] = self.points;
        (b - a).lerp(c - b, t)
    }
}

impl Collar {
    /// The collar of `axis`; `None` for the trunk, and for what does not come out of its bearer in time.
    pub(super) fn of(axes: &Axes, axis: &Axis) -> Option<Self> {
        // Where the bearer has no surface, the branch itself is what is found there.
        let bearing = axes.place(axis.bearer?).filter(|(_, place)| !axis.stations.contains(place))?;
        let here = axes.stations[bearing.1];
        let stations = &axes.stations[axis.stations.clone()];
        let longest = LONGEST * (here.radius + stations[0].radius);
        // How far a ring is outside of the bearer, less the clearance.
        let outside = |station: &Station| {
            let way = station.position - here.position;
            let lateral = way - here.tangent * way.dot(here.tangent);
            let distance = lateral.length();
            let sideways = station.tangent.dot(lateral.normalize_or_zero());
            let reach = (1.0 - sideways * sideways).max(0.0).sqrt();
            distance - here.radius - station.radius * (reach + CLEARANCE)
        };
        let mut before = -here.radius - stations[0].radius;
        for (i, pair) in stations.windows(2).enumerate() {
            if pair[0].along - stations[0].along > longest {
                return None;
            }
            let after = outside(&pair[1]);
            if after >= 0.0 {
                let t = (before / (before - after)).clamp(0.0, 1.0);
                let rest = (1.0 - t) * pair[0].position.distance(pair[1].position);
                let too_near = rest < SHORTEST * pair[1].radius;
                let end = if too_near { pair[1] } else { pair[0].lerp(&pair[1], t) };
                let next = axis.stations.start + i + 1 + usize::from(too_near);
                let short = end.along - stations[0].along <= longest;
                return (here.radius > 0.0 && end.radius > 0.0 && short).then_some(Self {
                    end,
                    next,
                    bearing,
                });
            }
            before = after;
        }
        None
    }

    /// The curve of each vertex of a ring.
    pub(super) fn curves(&self, axes: &Axes, circles: &Circles, sides: u32, curves: &mut Vec<Curve>) {
        let end = &self.end;
        let bearer = Bearer::new(axes, circles, self.bearing);
        let here = &bearer.stations[bearer.place];
        let direction = (end.position - here.position).normalize_or(end.tangent);
        let normal = parallel_transport(end.tangent, direction, end.normal);
        let binormal = direction.cross(normal);
        let end_binormal = end.tangent.cross(end.normal);
        let level = |v: Vec3| v - here.tangent * v.dot(here.tangent);
        let slope = level(direction);
        let a = slope.length_squared();
        let thickness = end.radius.min(THICKEST * here.radius);
        let flare = FLARE * thickness * ((sides as f32 - 3.0) / (FLARE_SIDES - 3.0)).clamp(0.2, 1.0);
        // The edges of the foot cut through the bearer's round.
        let edge = TAU / sides as f32 * (thickness + flare);
        let sunk = SUNK * thickness + (edge * edge / (8.0 * here.radius)).min(0.5 * thickness);
        // Where the line from a point inside of the bearer comes out.
        let exit = |point: Vec3| {
            let flat = level(point);
            let b = flat.dot(slope);
            let c = flat.length_squared() - here.radius * here.radius;
            point + direction * ((-b + (b * b - a * c).max(0.0).sqrt()) / a)
        };
        let center = exit(Vec3::ZERO);
        curves.clear();
        for &[cos, sin] in circles.of(sides) {
            let point = exit((normal * cos + binormal * sin) * thickness);
            let radial = level(point) / here.radius;
            let outward = point - center;
            let outward = (outward - radial * outward.dot(radial)).normalize_or_zero() * flare;
            let height = point.dot(here.tangent);
            let turn = atan2(point.dot(bearer.binormal), point.dot(here.normal));
            let (inner, inner_normal) = bearer.surface(height, turn);
            // Along the bearer's round, not off along its tangent.
            let turn = turn + outward.dot(here.tangent.cross(radial)) / here.radius;
            let (foot, foot_normal) = bearer.surface(height + outward.dot(here.tangent), turn);
            let rim = end.position + (end.normal * cos + end_binormal * sin) * end.radius;
            curves.push(Curve {
                points: [foot - foot_normal * sunk, inner, rim],
                normals: [foot_normal, inner_normal],
            });
        }
    }
}

/// The triangles of the bearing branch around the node where a branch springs.
struct Bearer<'a> {
    stations: &'a [Station],
    /// The station at the node.
    place: usize,
    /// Of that station.
    binormal: Vec3,
    circle: &'a [[f32; 2]],
}

impl<'a> Bearer<'a> {
    fn new(axes: &'a Axes, circles: &'a Circles, (axis, place): (usize, usize)) -> Self {
        let axis = &axes.all[axis];
        let range = axis.stations.clone();
        let here = axes.stations[place];
        Self {
            place: place - range.start,
            stations: &axes.stations[range],
            binormal: here.tangent.cross(here.normal),
            circle: circles.of(axis.sides),
        }
    }

    /// The stations below and above a height above the node, metres, and the part of the way between them.
    fn around(&self, height: f32) -> (&'a Station, &'a Station, f32) {
        let (mut from, mut rest) = (self.place, height.abs());
        loop {
            let here = &self.stations[from];
            let to = if height < 0.0 { from.wrapping_sub(1) } else { from + 1 };
            let Some(next) = self.stations.get(to) else { return (here, here, 0.0) };
            let length = here.position.distance(next.position);
            if rest < length {
                return (here, next, rest / length);
            }
            (from, rest) = (to, rest - length);
        }
    }

    /// The point of the bearer's triangles at a height above the node, metres, and an angle from the beginning of its
    /// ring, radians; and the normal there.
    fn surface(&self, height: f32, turn: f32) -> (Vec3, Vec3) {
        let (from, to, t) = self.around(height);
        let sides = self.circle.len() - 1;
        let turn = turn / TAU;
        let place = (turn - turn.floor()) * sides as f32;
        let corner = (place as usize).min(sides - 1);
        let [[from_cos, from_sin], [to_cos, to_sin]] = [self.circle[corner], self.circle[corner + 1]];
        let share = place - corner as f32;
        let (cos, sin) = (from_cos + (to_cos - from_cos) * share, from_sin + (to_sin - from_sin) * share);
        let side = |station: &Station| station.normal * cos + station.tangent.cross(station.normal) * sin;
        let (a, b) = (side(from), side(to));
        let point = (from.position + a * from.radius).lerp(to.position + b * to.radius, t);
        (point, a.lerp(b, t).normalize_or(a))
    }
}
