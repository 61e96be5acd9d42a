//! Where a branch leaves the one that bears it.

use super::axis::{Axes, Axis, Station};
use super::circle::Circles;
use super::lanes::{LANES, Lanes};
use crate::math::{atan2, parallel_transport};
use glam::{Vec3, Vec4};
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

/// The curves of four neighbouring vertices.
#[derive(Debug, Clone, Copy)]
pub(super) struct Curves {
    points: [Lanes; 3],
    /// The bearer's normals at the feet and at the inner control points.
    normals: [Lanes; 2],
}

impl Curves {
    pub(super) fn point(&self, t: f32) -> Lanes {
        let [a, b, c] = self.points;
        a.lerp(b, t).lerp(b.lerp(c, t), t)
    }

    /// The bearer's normals below the points.
    pub(super) fn normal(&self, t: f32) -> Lanes {
        let [foot, inner] = self.normals;
        inner.lerp(foot, (1.0 - t) * (1.0 - t))
    }

    /// The directions in which they go on, of no particular length.
    pub(super) fn direction(&self, t: f32) -> Lanes {
        let [a, b, c] = self.points;
        (b - a).lerp(c - b, t)
    }

    /// Where they end, in the first level ring.
    pub(super) fn rim(&self) -> Lanes {
        self.points[2]
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

    /// The curve of each vertex of a ring, the last group of four filled up with the first vertex.
    pub(super) fn curves(&self, axes: &Axes, circles: &Circles, sides: u32, curves: &mut Vec<Curves>) {
        let end = &self.end;
        let bearer = Bearer::new(axes, circles, self.bearing);
        let here = &bearer.stations[bearer.place];
        let direction = (end.position - here.position).normalize_or(end.tangent);
        let normal = parallel_transport(end.tangent, direction, end.normal);
        let binormal = direction.cross(normal);
        let end_binormal = end.tangent.cross(end.normal);
        let slope = direction - here.tangent * direction.dot(here.tangent);
        let a = slope.length_squared();
        let thickness = end.radius.min(THICKEST * here.radius);
        let flare = FLARE * thickness * ((sides as f32 - 3.0) / (FLARE_SIDES - 3.0)).clamp(0.2, 1.0);
        // The edges of the foot cut through the bearer's round.
        let edge = TAU / sides as f32 * (thickness + flare);
        let sunk = SUNK * thickness + (edge * edge / (8.0 * here.radius)).min(0.5 * thickness);

        let each = Vec4::splat;
        let [direction, slope, normal, binormal] = [direction, slope, normal, binormal].map(Lanes::splat);
        let [tangent, here_normal, here_binormal] =
            [here.tangent, here.normal, bearer.binormal].map(Lanes::splat);
        let level = |v: Lanes| v - tangent * v.dot(tangent);
        // Where the lines from points inside of the bearer come out.
        let exit = |points: Lanes| {
            let flat = level(points);
            let b = flat.dot(slope);
            let c = flat.dot(flat) - each(here.radius * here.radius);
            points + direction * ((-b + (b * b - each(a) * c).max(Vec4::ZERO).sqrt()) / each(a))
        };
        let center = exit(Lanes::default());
        curves.clear();
        for &[cos, sin] in &circles.of(sides).fours {
            let points = exit((normal * cos + binormal * sin) * each(thickness));
            let radial = level(points);
            let radial = Lanes {
                x: radial.x / each(here.radius),
                y: radial.y / each(here.radius),
                z: radial.z / each(here.radius),
            };
            let outward = points - center;
            let outward = (outward - radial * outward.dot(radial)).normalize_or(Lanes::default) * each(flare);
            let heights = points.dot(tangent);
            let (y, x) = (points.dot(here_binormal), points.dot(here_normal));
            let turns = Vec4::from_array(std::array::from_fn(|lane| atan2(y[lane], x[lane])));
            let (inner, inner_normals) = bearer.surface(heights, turns);
            // Along the bearer's round, not off along its tangent.
            let turns = turns + outward.dot(tangent.cross(radial)) / each(here.radius);
            let (feet, foot_normals) = bearer.surface(heights + outward.dot(tangent), turns);
            let rim = Lanes::splat(end.normal) * cos + Lanes::splat(end_binormal) * sin;
            curves.push(Curves {
                points: [
                    feet - foot_normals * each(sunk),
                    inner,
                    Lanes::splat(end.position) + rim * each(end.radius),
                ],
                normals: [foot_normals, inner_normals],
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
    /// How far the stations below and above it are, metres.
    next: [f32; 2],
    circle: &'a [[f32; 2]],
}

impl<'a> Bearer<'a> {
    fn new(axes: &'a Axes, circles: &'a Circles, (axis, place): (usize, usize)) -> Self {
        let axis = &axes.all[axis];
        let range = axis.stations.clone();
        let here = axes.stations[place];
        let place = place - range.start;
        let stations = &axes.stations[range];
        let distance = |to: usize| stations.get(to).map_or(0.0, |next| next.position.distance(here.position));
        Self {
            place,
            stations,
            next: [distance(place.wrapping_sub(1)), distance(place + 1)],
            binormal: here.tangent.cross(here.normal),
            circle: &circles.of(axis.sides).corners,
        }
    }

    /// The stations below and above a height above the node, metres, and the part of the way between them.
    #[inline]
    fn around(&self, height: f32) -> (&'a Station, &'a Station, f32) {
        let (mut from, mut rest) = (self.place, height.abs());
        let mut length = self.next[usize::from(height >= 0.0)];
        loop {
            let here = &self.stations[from];
            let to = if height < 0.0 { from.wrapping_sub(1) } else { from + 1 };
            let Some(next) = self.stations.get(to) else { return (here, here, 0.0) };
            if from != self.place {
                length = here.position.distance(next.position);
            }
            if rest < length {
                return (here, next, rest / length);
            }
            (from, rest) = (to, rest - length);
        }
    }

    /// The points of the bearer's triangles at heights above the node, metres, and angles from the beginning of its
    /// ring, radians; and the normals there.
    fn surface(&self, heights: Vec4, turns: Vec4) -> (Lanes, Lanes) {
        let sides = self.circle.len() - 1;
        let turns = turns / Vec4::splat(TAU);
        let places = (turns - turns.floor()) * Vec4::splat(sides as f32);
        let (mut points, mut normals, mut fallbacks) =
            ([Vec3::ZERO; LANES], [Vec3::ZERO; LANES], [Vec3::ZERO; LANES]);
        for lane in 0..LANES {
            let (from, to, t) = self.around(heights[lane]);
            let corner = (places[lane] as usize).min(sides - 1);
            let [[from_cos, from_sin], [to_cos, to_sin]] = [self.circle[corner], self.circle[corner + 1]];
            let share = places[lane] - corner as f32;
            let (cos, sin) = (from_cos + (to_cos - from_cos) * share, from_sin + (to_sin - from_sin) * share);
            let side = |station: &Station| station.normal * cos + station.tangent.cross(station.normal) * sin;
            let (a, b) = (side(from), side(to));
            points[lane] = (from.position + a * from.radius).lerp(to.position + b * to.radius, t);
            normals[lane] = a.lerp(b, t);
            fallbacks[lane] = a;
        }
        (Lanes::of(points), Lanes::of(normals).normalize_or(|| Lanes::of(fallbacks)))
    }
}
