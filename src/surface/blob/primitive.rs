//! Skeletal primitives: points, lines and cone segments with a field around them.

use super::FieldFunction;
use super::bend::{Bend, Course};
use crate::surface::implicit::span::{Passage, Span};
use crate::{Bounds, ParameterError};
use glam::Vec3;

/// Farther out or thicker than this, in metres, products of coordinates leave the range of 32-bit floats.
const FARTHEST: f32 = 1e9;
/// Thinner than this, in metres, squares of distances vanish in them.
const THINNEST: f32 = 1e-9;
/// Times a coordinate: more than what rounding may change in the distance of two points.
const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// A skeletal primitive: a point, a line or a cone segment, its radius, the field around it and its colour.
///
/// A cone segment is the union of the balls along its axis, whose radii are interpolated between its ends,
/// and its field the greatest of theirs: it depends on the least distance from a point of the axis over the
/// radius there. Cones of one taper, end to end, are therefore smooth where they meet, and round where the
/// second tapers more. Values out of range are refused when the primitive is
/// [added](super::BlobTreeBuilder::add).
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Primitive {
    pub(super) ends: [Vec3; 2],
    pub(super) radii: [f32; 2],
    pub(super) field: FieldFunction,
    pub(super) strength: f32,
    pub(super) color: [f32; 3],
    /// Its axis and radius, if they are not straight: in the pieces of a `Curve`, which are given to nobody and so never saved.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) bend: Option<Bend>,
}

crate::recipe::readable!(Primitive { field: FieldFunction, strength: f32, color: [f32; 3] });

impl Primitive {
    /// A ball: a point with a radius, metres.
    pub fn point(at: Vec3, radius: f32) -> Self {
        Self::cone([at; 2], [radius; 2])
    }

    /// A capsule: a line with a radius, metres.
    pub fn line(from: Vec3, to: Vec3, radius: f32) -> Self {
        Self::cone([from, to], [radius; 2])
    }

    /// A cone segment with round ends and a radius at each, metres.
    pub fn cone(ends: [Vec3; 2], radii: [f32; 2]) -> Self {
        let bark = super::BARK;
        Self { ends, radii, field: FieldFunction::default(), strength: 1.0, color: bark, bend: None }
    }

    /// The field function; default [`FieldFunction::Smooth`] with the width 1/2.
    pub fn with_field(mut self, field: FieldFunction) -> Self {
        self.field = field;
        self
    }

    /// As a bounding field: the paper's ((1 - r)²)³ ([`FieldFunction::Steep`]), r the distance over the radius, times a strength
    /// of 0 to 1. [`FieldFunction::Bounding`] is smoother.
    pub fn bounding(self, strength: f32) -> Self {
        self.with_field(FieldFunction::Steep { inner: 0.0 }).with_strength(strength)
    }

    /// A factor of the field, 0 to 1; default 1. For bounding fields that fade; a solid of less than 1/2 has no surface.
    pub fn with_strength(mut self, strength: f32) -> Self {
        self.strength = strength;
        self
    }

    /// The linear RGB colour, each 0 to 1; default a grey brown.
    pub fn with_color(mut self, linear: [f32; 3]) -> Self {
        self.color = linear;
        self
    }

    /// Length from end to end, metres.
    pub(super) fn length(&self) -> f32 {
        self.ends[0].distance(self.ends[1])
    }

    /// With an axis of such a course, if it does not bend too sharply for one piece.
    pub(super) fn bent(self, course: &Course) -> Option<Self> {
        let bend = Bend::new(self.ends[1] - self.ends[0], course, self.radii, self.field.reach())?;
        Some(Self { bend: Some(bend), ..self })
    }

    /// Cut in two, at a fraction of its length: together they are as it was.
    pub(super) fn halves(self, t: f32) -> [Self; 2] {
        let ([from, to], [start, end]) = (self.ends, self.radii);
        if let Some(bend) = self.bend {
            let (place, courses) = bend.halves(t);
            let (middle, radius) = (from + place, bend.radius_at(t));
            let parts = [([from, middle], [start, radius]), ([middle, to], [radius, end])];
            let part = |i: usize| {
                let (ends, radii) = parts[i];
                let straight = Self { ends, radii, bend: None, ..self };
                straight.bent(&courses[i]).unwrap_or(straight)
            };
            return [part(0), part(1)];
        }
        let (place, radius) = (from.lerp(to, t), start + (end - start) * t);
        [
            Self { ends: [from, place], radii: [start, radius], ..self },
            Self { ends: [place, to], radii: [radius, end], ..self },
        ]
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        for end in self.ends {
            let holds = end.is_finite() && end.abs().max_element() <= FARTHEST;
            ParameterError::unless(holds, "Primitive.ends", end, "within a million kilometres, and finite")?;
        }
        for radius in self.radii {
            let holds = (THINNEST..=FARTHEST).contains(&radius);
            ParameterError::unless(holds, "Primitive.radius", radius, "1e-9 to 1e9 m")?;
        }
        self.field.check()?;
        let holds = (0.0..=1.0).contains(&self.strength);
        ParameterError::unless(holds, "Primitive.strength", self.strength, "0 to 1")?;
        let holds = self.color.iter().all(|channel| (0.0..=1.0).contains(channel));
        ParameterError::unless(holds, "Primitive.color", self.color, "0 to 1 each")
    }
}

/// Number of the bend of a leaf that is straight.
pub(super) const STRAIGHT: u32 = u32::MAX;

/// A primitive as it is evaluated, 68 bytes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leaf {
    from: Vec3,
    way: Vec3,
    /// One over the square of the length, or 0 where there is none.
    inverse: f32,
    radius: f32,
    /// Growth of the radius along the way, as a share of it.
    growth: f32,
    field: FieldFunction,
    strength: f32,
    pub(super) color: [f32; 3],
    /// Number of the affine warp that takes points into its space; 0 is none.
    pub(super) warp: u32,
    /// Number of its axis and radius in a list of bends; or [`STRAIGHT`].
    bend: u32,
}

/// Knowledge of a field in a cube.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range {
    pub(super) least: f32,
    pub(super) most: f32,
    /// Upper bound of the change of the value per metre.
    pub(super) slope: f32,
}

impl Range {
    pub(super) const NOTHING: Self = Self { least: 0.0, most: 0.0, slope: 0.0 };

    pub(super) fn is_nothing(self) -> bool {
        self.most <= 0.0
    }
}

impl Leaf {
    /// With the number of its bend in a list of them, without a warp.
    pub(super) fn new(primitive: &Primitive, bend: u32) -> Self {
        let [from, to] = primitive.ends;
        let way = to - from;
        let square = way.length_squared();
        // A way too short for its square, or the square's inverse, to be told from zero is none.
        let [start, end] = primitive.radii;
        // Neither is one along which the radius changes a million times faster: squares of that leave the range of floats.
        let sound = square > 1e-30 && square.is_finite() && (end - start).abs() <= 1e6 * square.sqrt();
        Self {
            from,
            way: if sound { way } else { Vec3::ZERO },
            inverse: if sound { 1.0 / square } else { 0.0 },
            radius: if sound { start } else { start.max(end) },
            growth: if sound { (end - start) / start } else { 0.0 },
            field: primitive.field,
            strength: primitive.strength,
            color: primitive.color,
            warp: 0,
            bend,
        }
    }

    /// The same, this much nearer to the origin, in the space of a warp.
    pub(super) fn placed(&self, offset: Vec3, warp: u32) -> Self {
        Self { from: self.from - offset, warp, ..*self }
    }

    #[inline]
    fn bend<'a>(&self, bends: &'a [Bend]) -> Option<&'a Bend> {
        if self.bend == STRAIGHT { None } else { bends.get(self.bend as usize) }
    }

    /// The radius so far along the way.
    #[inline]
    fn radius(&self, t: f32) -> f32 {
        self.radius + self.radius * self.growth * t
    }

    fn thickest(&self) -> f32 {
        self.radius(if self.growth > 0.0 { 1.0 } else { 0.0 })
    }

    fn thinnest(&self) -> f32 {
        self.radius(if self.growth < 0.0 { 1.0 } else { 0.0 })
    }

    /// A box of its own space that holds every point where it is felt.
    pub(super) fn bounds(&self, bends: &[Bend]) -> Bounds {
        if let Some(bend) = self.bend(bends) {
            return bend.bounds(self.from, self.field.reach());
        }
        let at = |end: Vec3, radius: f32| {
            let rounding = ROUNDING * (end.abs().max_element() + self.way.abs().max_element());
            Bounds::around(end, Vec3::splat(radius * self.field.reach() * 1.0001 + rounding))
        };
        at(self.from, self.radius).union(at(self.from + self.way, self.radius(1.0)))
    }

    /// The ball of the cone that is felt most: its place along the way, as numerator and denominator of a
    /// fraction (below 0 and above 1 it is the ball at that end), and the square of the distance from the
    /// line.
    #[inline]
    fn strongest(&self, offset: Vec3) -> ([f32; 2], f32) {
        let beside = offset.dot(self.way) * self.inverse;
        let square = (offset - self.way * beside).length_squared();
        // The place where the derivative of (distance / radius)² is 0. If the radius would be below 0 there,
        // it is the thick end.
        let swell = 1.0 + self.growth * beside;
        ([beside * swell + self.growth * square * self.inverse, swell], square)
    }

    /// The distance from the middle of that ball over its radius.
    #[inline]
    fn distance(&self, offset: Vec3, [at, swell]: [f32; 2], square: f32) -> f32 {
        let (square, radius) = if at <= 0.0 {
            (offset.length_squared(), self.radius * self.radius)
        } else if at >= swell {
            let end = self.radius(1.0);
            ((offset - self.way).length_squared(), end * end)
        } else {
            // The radius beside the point r and the distance from the line h are r (1 + q) and h √(1 + q) at
            // the ball, where q is the square of h/r times the change of the radius per metre.
            let (beside, change) = (self.radius * swell, self.radius * self.growth);
            (square, beside * beside + change * change * self.inverse * square)
        };
        (square / radius).sqrt()
    }

    /// The field's value at a point of its own space.
    #[inline]
    pub(super) fn value(&self, point: Vec3, bends: &[Bend]) -> f32 {
        let offset = point - self.from;
        if let Some(bend) = self.bend(bends) {
            return self.strength * self.field.value(bend.distance(offset));
        }
        let (at, square) = self.strongest(offset);
        self.strength * self.field.value(self.distance(offset, at, square))
    }

    /// The field's value at a point of its own space, and its gradient.
    #[inline]
    pub(super) fn gradient(&self, point: Vec3, bends: &[Bend]) -> (f32, Vec3) {
        let offset = point - self.from;
        if let Some(bend) = self.bend(bends) {
            let (distance, direction) = bend.gradient(offset);
            let (value, slope) = self.field.at(distance);
            return (self.strength * value, direction * (self.strength * slope));
        }
        let (fraction, square) = self.strongest(offset);
        let (value, slope) = self.field.at(self.distance(offset, fraction, square));
        let [at, swell] = fraction;
        let t = if at <= 0.0 {
            0.0
        } else if at >= swell {
            1.0
        } else {
            at / swell
        };
        // The gradient of this ball, since no other is felt more.
        let away = offset - self.way * t;
        let direction = away / (away.length().max(f32::MIN_POSITIVE) * self.radius(t));
        (self.strength * value, direction * (self.strength * slope))
    }

    /// Part of a passage, in its own space, where it may be felt.
    #[cfg_attr(not(feature = "preview"), allow(dead_code, reason = "only rays ask"))]
    pub(super) fn span(&self, passage: &Passage, bends: &[Bend]) -> Option<Span> {
        if let Some(bend) = self.bend(bends) {
            return bend.span(self.from, passage, self.field.reach());
        }
        passage.near(self.from, self.way, self.inverse, self.thickest() * self.field.reach())
    }

    /// Bounds of its values within `reach` metres of a point, all in its own space; and the least radius there.
    #[inline]
    pub(super) fn range(&self, point: Vec3, reach: f32, bends: &[Bend]) -> (Range, f32) {
        let offset = point - self.from;
        let along = offset.dot(self.way) * self.inverse;
        let rounding = ROUNDING * (point.abs().max_element() + self.from.abs().max_element() + reach);
        let reach = reach * 1.0001 + rounding;
        if let Some(bend) = self.bend(bends) {
            let (range, thin) = bend.range(self.field, offset, reach);
            let Range { least, most, slope } = range;
            let of = |share: f32| self.strength * share;
            return (Range { least: of(least), most: of(most), slope: of(slope) }, thin);
        }
        // The distance from the axis, and the radius beside the point.
        let beside = clamped(along);
        let away = offset - self.way * beside;
        let (thinnest, thickest) = (self.thinnest(), self.thickest());
        let felt = thickest * self.field.reach() * 1.0002 + reach;
        // Most are too far away.
        if away.length_squared() > felt * felt {
            return (Range::NOTHING, thinnest);
        }
        self.range_near(along, away.length(), reach)
    }

    fn range_near(&self, along: f32, distance: f32, reach: f32) -> (Range, f32) {
        let (here, taper) = (self.radius(along), self.radius * self.growth.abs() * self.inverse.sqrt());
        // No clamp: the least and the greatest even beside what is not a number.
        let (thinnest, thickest) = (self.thinnest(), self.thickest());
        // The ball that is felt most is thicker than the radius beside a point: by 1 / (1 - lean²), where it is felt.
        let lean = taper * self.field.reach();
        let swell = 1.0 - lean * lean;
        let thin = (here - taper * reach).max(thinnest).min(thickest) * 0.9999;
        let thick =
            if swell > 0.0 { ((here + taper * reach) / swell).min(thickest).max(thinnest) } else { thickest };
        let near = (distance - reach).max(0.0) / (thick * 1.0001);
        if near >= self.field.reach() {
            return (Range::NOTHING, thin);
        }
        let far = (distance + reach) / (self.radius(clamped(along)) * 0.9999);
        // Rounding may change the last bits of a value, but not those of a 1 on the plateau.
        let slack = |x: f32, by: f32| {
            if x <= self.field.plateau() { 1.0 } else { (self.field.value(x) + by).clamp(0.0, 1.0) }
        };
        let (least, most) = (slack(far, -1e-5), slack(near, 1e-5));
        let slope = self.field.steepest(near, far) / thin;
        let range =
            Range { least: self.strength * least, most: self.strength * most, slope: self.strength * slope };
        (range, thin)
    }
}

/// Clamps to 0 to 1; NaN becomes 0.
#[inline]
fn clamped(t: f32) -> f32 {
    if t > 0.0 { t.min(1.0) } else { 0.0 }
}
