//! Curves with a thickness, as pieces that bend and cone segments.

use super::bend::Course;
use super::error::BlobError;
use super::primitive::Primitive;
use super::{BARK, FieldFunction};
use crate::{ParameterError, math};
use glam::Vec3;

/// Most cone segments between two points.
const MOST_PARTS: f32 = 64.0;
/// Times the turn of cone segments: that of a piece that bends.
const PIECE: f32 = 3.0;
/// What turns by less than this, radians, is straight.
const STRAIGHT: f32 = 0.005;
/// Cosine of the sharpest turn that is rounded, 120°; at a sharper one the curve has a corner.
const SHARPEST_TURN: f32 = -0.5;

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
        let knots: Vec<_> = self.knots();
        let cone = |ends, radii| {
            Primitive::cone(ends, radii)
                .with_field(self.field)
                .with_strength(self.strength)
                .with_color(self.color)
        };
        if knots.len() == 1 {
            return Ok(vec![cone([knots[0].0; 2], [knots[0].1; 2])]);
        }
        let ways: Vec<Vec3> = knots.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
        let rises: Vec<f32> = knots
            .windows(2)
            .zip(&ways)
            .map(|(pair, way)| (pair[1].1 - pair[0].1) / way.length().max(f32::MIN_POSITIVE))
            .collect();
        let mut cones = Vec::with_capacity(ways.len());
        for (i, pair) in knots.windows(2).enumerate() {
            let [(from, start), (to, end)] = [pair[0], pair[1]];
            let [way, before, after] =
                [Some(ways[i]), i.checked_sub(1).map(|i| ways[i]), ways.get(i + 1).copied()]
                    .map(Option::unwrap_or_default);
            let leaving = if i == 0 { self.tangents[0].unwrap_or(way) } else { tangent(before, way, way) };
            let arriving =
                if i + 1 == ways.len() { self.tangents[1].unwrap_or(way) } else { tangent(way, after, way) };
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
            let parts = |turn: f32, most: f32| {
                // NaN if there are points that are not finite.
                let parts = ((turn / most).ceil().min(MOST_PARTS) as u32).max(1);
                let knots = (0..=parts).map(|k| span.at(k as f32 / parts as f32));
                knots.collect::<Vec<_>>()
            };
            let cones_of = |knots: &[Knot]| {
                let pair =
                    |pair: &[Knot]| cone([pair[0].point, pair[1].point], [pair[0].radius, pair[1].radius]);
                knots.windows(2).map(pair).collect::<Vec<_>>()
            };
            if turn > STRAIGHT {
                // As many pieces as keep each within a radius of its chord, for boxes to be narrow; no more
                // than there would be cones.
                let pieces = (0.15 * bend * way.length() / start.min(end)).sqrt();
                let knots = parts(turn, (turn / pieces).clamp(self.turn, PIECE * self.turn));
                // A piece goes on where its neighbour has its direction.
                let goes_on = |i: usize| i > 0 && i < ways.len() && !is_corner(ways[i - 1], ways[i]);
                let (first, last) = (!goes_on(i), !goes_on(i + 1));
                let count = knots.len() - 1;
                let bent = cones_of(&knots).into_iter().zip(knots.windows(2)).enumerate();
                let bent = bent.map(|(k, (cone, pair))| {
                    cone.bent(&Course {
                        directions: [pair[0].direction, pair[1].direction],
                        slopes: [pair[0].slope, pair[1].slope],
                        is_flat: [!first || k > 0, !last || k + 1 < count],
                    })
                });
                if let Some(bent) = bent.collect::<Option<Vec<_>>>() {
                    cones.extend(bent);
                    continue;
                }
            }
            cones.extend(cones_of(&parts(turn, self.turn)));
        }
        Ok(cones)
    }

    /// Points with their radii, without those that are where the one before is.
    fn knots(&self) -> Vec<(Vec3, f32)> {
        let mut knots: Vec<(Vec3, f32)> = Vec::with_capacity(self.points.len());
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
        let length = from.distance(to);
        let slopes = self.directions.map(|direction| direction * length);
        if t <= 0.0 || t >= 1.0 {
            let i = usize::from(t >= 1.0);
            let (point, radius) = (self.ends[i], self.radii[i]);
            return Knot { point, direction: self.directions[i], radius, slope: rise[i] };
        }
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

/// The tangent between two ways, or along the one at hand where they turn back.
fn tangent(before: Vec3, after: Vec3, way: Vec3) -> Vec3 {
    let [a, b] = [before.length(), after.length()];
    let (first, second) = (before.normalize_or_zero(), after.normalize_or_zero());
    if is_corner(before, after) { way } else { (first * b + second * a).normalize_or(way) }
}

/// `true` if a curve turns too sharply between two ways to be rounded.
fn is_corner(before: Vec3, after: Vec3) -> bool {
    before.normalize_or_zero().dot(after.normalize_or_zero()) < SHARPEST_TURN
}
