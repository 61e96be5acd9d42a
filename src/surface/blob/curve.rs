//! Curves with a thickness, as pieces that bend and cone segments.

use super::bend::Course;
use super::error::BlobError;
use super::primitive::Primitive;
use super::{BARK, FieldFunction};
use crate::{ParameterError, math};
use glam::Vec3;
use smallvec::SmallVec;

/// Most cone segments between two points.
const MOST_PARTS: f32 = 64.0;
/// Times the turn of cone segments: that of a piece that bends.
const PIECE: f32 = 3.0;
/// What turns by less than this, radians, is straight.
const STRAIGHT: f32 = 0.005;
/// Cosine of the sharpest turn that is rounded, 120°; at a sharper one the curve has a corner.
const SHARPEST_TURN: f32 = -0.5;

/// As many as a shoot has; more are on the heap.
type Few<T> = SmallVec<[T; 16]>;

/// A smooth curve through points, with a radius interpolated between theirs, monotone and smooth: a skeletal primitive made of pieces.
///
/// Between two points lies the cubic Hermite curve with the tangents of Catmull and Rom 1974 for points at their chords'
/// lengths, each as long as the chord. Pieces that bend follow it, at most three times
/// [`with_turn`](Self::with_turn) each; two that meet share direction, radius and taper, so the surface has no crease on
/// either side of a bend. Where the axis turns within less than about two radii, or the radius changes by more than
/// half a metre per metre, straight cone segments take their place: the surface is round on the outer side where they
/// meet, and has a crease of one turn on the inner side. There are at most 64 pieces from point to point, and corners
/// sharper than 120° stay.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Curve {
    points: Vec<Vec3>,
    radii: Vec<f32>,
    tangents: [Option<Vec3>; 2],
    turn: f32,
    field: FieldFunction,
    strength: f32,
    color: [f32; 3],
}

crate::recipe::readable!(Curve {
    tangents: [Option<Vec3>; 2], turn: f32, field: FieldFunction, strength: f32, color: [f32; 3],
});

impl Curve {
    /// Through `points` (metres), with the radius of each, metres. A single point is a ball.
    pub fn new(points: Vec<Vec3>, radii: Vec<f32>) -> Self {
        let (field, strength) = (FieldFunction::default(), 1.0);
        Self { points, radii, tangents: [None; 2], turn: 0.15, field, strength, color: BARK }
    }

    /// The directions at both ends, vectors of any length above zero, in place of those that follow from the
    /// points.
    pub fn with_tangents(mut self, start: Option<Vec3>, end: Option<Vec3>) -> Self {
        self.tangents = [start, end];
        self
    }

    /// The greatest turn between two cone segments, and a third of that of a piece that bends, radians, 0.01 to 3; default
    /// 0.15.
    pub fn with_turn(mut self, radians: f32) -> Self {
        self.turn = radians;
        self
    }

    /// The field function; see [`Primitive::with_field`].
    pub fn with_field(mut self, field: FieldFunction) -> Self {
        self.field = field;
        self
    }

    /// A factor of the field, 0 to 1; see [`Primitive::with_strength`].
    pub fn with_strength(mut self, strength: f32) -> Self {
        self.strength = strength;
        self
    }

    /// The linear RGB colour, each 0 to 1.
    pub fn with_color(mut self, linear: [f32; 3]) -> Self {
        self.color = linear;
        self
    }

    /// The cone segments, one after another. Ends that are not finite are left for them to refuse.
    pub(super) fn primitives(&self) -> Result<Vec<Primitive>, BlobError> {
        let (points, radii) = (self.points.len(), self.radii.len());
        if points == 0 || points != radii {
            return Err(BlobError::Curve { points, radii });
        }
        let holds = (0.01..=3.0).contains(&self.turn);
        ParameterError::unless(holds, "Curve.turn", self.turn, "0.01 to 3")?;
        for tangent in self.tangents.into_iter().flatten() {
            let holds = tangent.try_normalize().is_some();
            ParameterError::unless(holds, "Curve.tangents", tangent, "finite and not zero")?;
        }
        let knots = self.knots();
        let cone = |ends, radii| {
            Primitive::cone(ends, radii)
                .with_field(self.field)
                .with_strength(self.strength)
                .with_color(self.color)
        };
        if knots.len() == 1 {
            return Ok(vec![cone([knots[0].0; 2], [knots[0].1; 2])]);
        }
        let ways: Few<Vec3> = knots.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
        let rises: Few<f32> = knots
            .windows(2)
            .zip(&ways)
            .map(|(pair, way)| (pair[1].1 - pair[0].1) / way.length().max(f32::MIN_POSITIVE))
            .collect();
        let mut cones = Vec::with_capacity(ways.len());
        let mut next_joint = None;
        for (i, pair) in knots.windows(2).enumerate() {
            let ([(from, start), (to, end)], way) = ([pair[0], pair[1]], ways[i]);
            let joints = [next_joint, ways.get(i + 1).map(|&after| Joint::between(way, after))];
            next_joint = joints[1];
            let [leaving, arriving] = [0, 1].map(|i| match joints[i] {
                Some(joint) => joint.tangent.unwrap_or(way),
                None => self.tangents[i].unwrap_or(way),
            });
            let rise =
                [i.saturating_sub(1), (i + 1).min(rises.len() - 1)].map(|k| between(rises[k], rises[i]));
            let bend = math::angle_between(leaving, way) + math::angle_between(way, arriving);
            let turn = bend + (rise[0] - rises[i]).abs() + (rise[1] - rises[i]).abs();
            let span = Span {
                ends: [from, to],
                radii: [start, end],
                directions: [leaving, arriving].map(Vec3::normalize_or_zero),
                rises: rise,
            };
            let parts = |most: f32| ((turn / most).ceil().min(MOST_PARTS) as u32).max(1);
            let knot = |k: u32, of: u32| span.at(k as f32 / of as f32);
            let cone_of = |from: &Knot, to: &Knot| cone([from.point, to.point], [from.radius, to.radius]);
            if turn > STRAIGHT {
                // As many pieces as keep each within a radius of its chord, for boxes to be narrow; no more
                // than there would be cones.
                let pieces = (0.15 * bend * way.length() / start.min(end)).sqrt();
                let count = parts((turn / pieces).clamp(self.turn, PIECE * self.turn));
                // A piece goes on where its neighbour has its direction.
                let goes_on = joints.map(|joint| joint.is_some_and(|joint| !joint.is_corner));
                let (before, mut from) = (cones.len(), knot(0, count));
                let bends = (0..count).all(|k| {
                    let to = knot(k + 1, count);
                    let bent = cone_of(&from, &to).bent(&Course {
                        directions: [from.direction, to.direction],
                        slopes: [from.slope, to.slope],
                        is_flat: [goes_on[0] || k > 0, goes_on[1] || k + 1 < count],
                    });
                    from = to;
                    bent.map(|bent| cones.push(bent)).is_some()
                });
                if bends {
                    continue;
                }
                cones.truncate(before);
            }
            let count = parts(self.turn);
            let mut from = knot(0, count);
            cones.extend((1..=count).map(|k| {
                let to = knot(k, count);
                let cone = cone_of(&from, &to);
                from = to;
                cone
            }));
        }
        Ok(cones)
    }

    /// Points with their radii, without those that are where the one before is.
    fn knots(&self) -> Few<(Vec3, f32)> {
        let mut knots: Few<(Vec3, f32)> = SmallVec::new();
        for (&point, &radius) in self.points.iter().zip(&self.radii) {
            match knots.last_mut() {
                Some(last) if last.0 == point => last.1 = last.1.max(radius),
                _ => knots.push((point, radius)),
            }
        }
        knots
    }
}

/// The curve between two points.
struct Span {
    ends: [Vec3; 2],
    radii: [f32; 2],
    directions: [Vec3; 2],
    /// The slope of the radius at each.
    rises: [f32; 2],
}

/// A place of a curve.
struct Knot {
    point: Vec3,
    direction: Vec3,
    radius: f32,
    slope: f32,
}

impl Span {
    fn at(&self, t: f32) -> Knot {
        let ([from, to], [start, end], rise) = (self.ends, self.radii, self.rises);
        if t <= 0.0 || t >= 1.0 {
            let i = usize::from(t >= 1.0);
            let (point, radius) = (self.ends[i], self.radii[i]);
            return Knot { point, direction: self.directions[i], radius, slope: rise[i] };
        }
        let length = from.distance(to);
        let slopes = self.directions.map(|direction| direction * length);
        // The Hermite polynomials.
        let (back, square) = (1.0 - t, t * t);
        let point = from * ((1.0 + 2.0 * t) * back * back)
            + to * (square * (3.0 - 2.0 * t))
            + slopes[0] * (t * back * back)
            - slopes[1] * (square * back);
        let radius = start * ((1.0 + 2.0 * t) * back * back)
            + end * (square * (3.0 - 2.0 * t))
            + length * (rise[0] * (t * back * back) - rise[1] * (square * back));
        // Their derivatives.
        let [over, first, last] = [6.0 * t * back, back * (1.0 - 3.0 * t), t * (3.0 * t - 2.0)];
        let change = (to - from) * over + slopes[0] * first + slopes[1] * last;
        let slope = (end - start) * over + length * (rise[0] * first + rise[1] * last);
        Knot {
            point,
            direction: change.normalize_or_zero(),
            radius: radius.max(start.min(end)).min(start.max(end)),
            slope: slope / change.length().max(f32::MIN_POSITIVE),
        }
    }
}

/// The slope of the radius between two cones' (Fritsch and Butland 1984): no radius then leaves the range of its neighbours.
fn between(before: f32, after: f32) -> f32 {
    if before * after > 0.0 { 2.0 * before * after / (before + after) } else { 0.0 }
}

/// Where two ways meet.
#[derive(Clone, Copy)]
struct Joint {
    is_corner: bool,
    /// None at a corner, or where the ways have no direction.
    tangent: Option<Vec3>,
}

impl Joint {
    fn between(before: Vec3, after: Vec3) -> Self {
        let (first, second) = (before.normalize_or_zero(), after.normalize_or_zero());
        // A curve is not rounded where it turns too sharply.
        let is_corner = first.dot(second) < SHARPEST_TURN;
        let tangent = first * after.length() + second * before.length();
        Self { is_corner, tangent: if is_corner { None } else { tangent.try_normalize() } }
    }
}
