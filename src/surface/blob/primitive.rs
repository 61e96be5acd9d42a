//! Skeletal primitives: points, lines and cone segments with a field around them.

use super::FieldFunction;
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
/// The field depends on the distance from the axis over the radius there. Ends are round; the radius of a
/// cone segment is interpolated between its ends along the axis. What is out of range is refused where it is
/// [added](super::BlobTreeBuilder::add).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Primitive {
    pub(super) ends: [Vec3; 2],
    pub(super) radii: [f32; 2],
    pub(super) field: FieldFunction,
    pub(super) strength: f32,
    pub(super) color: [f32; 3],
}

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
        Self { ends, radii, field: FieldFunction::default(), strength: 1.0, color: bark }
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

/// A primitive as it is evaluated, 64 bytes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leaf {
    from: Vec3,
    way: Vec3,
    /// One over the square of the length, or 0 where there is none.
    inverse: f32,
    radius: f32,
    /// By how much the radius grows along the way.
    growth: f32,
    field: FieldFunction,
    strength: f32,
    pub(super) color: [f32; 3],
    /// Which affine warp takes points into its space; 0 is none.
    pub(super) warp: u32,
}

/// What is known of a field in a cube.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range {
    pub(super) least: f32,
    pub(super) most: f32,
    /// At least the greatest change of the value a metre.
    pub(super) slope: f32,
}

impl Range {
    pub(super) const NOTHING: Self = Self { least: 0.0, most: 0.0, slope: 0.0 };

    pub(super) fn is_nothing(self) -> bool {
        self.most <= 0.0
    }
}

impl Leaf {
    pub(super) fn new(primitive: &Primitive, warp: u32) -> Self {
        let [from, to] = primitive.ends;
        let way = to - from;
        let square = way.length_squared();
        // A way too short for its square, or the square's inverse, to be told from zero is none.
        let sound = square > 1e-30 && square.is_finite();
        let [start, end] = primitive.radii;
        Self {
            from,
            way: if sound { way } else { Vec3::ZERO },
            inverse: if sound { 1.0 / square } else { 0.0 },
            radius: if sound { start } else { start.max(end) },
            growth: if sound { end - start } else { 0.0 },
            field: primitive.field,
            strength: primitive.strength,
            color: primitive.color,
            warp,
        }
    }

    fn thickest(&self) -> f32 {
        self.radius + self.growth.max(0.0)
    }

    fn thinnest(&self) -> f32 {
        self.radius + self.growth.min(0.0)
    }

    /// A box of its own space that holds every point where it is felt.
    pub(super) fn bounds(&self) -> Bounds {
        let at = |end: Vec3, radius: f32| {
            let rounding = ROUNDING * (end.abs().max_element() + self.way.abs().max_element());
            Bounds::around(end, Vec3::splat(radius * self.field.reach() * 1.0001 + rounding))
        };
        at(self.from, self.radius).union(at(self.from + self.way, self.radius + self.growth))
    }

    /// How far along the way the nearest point of the axis is, 0 to 1, and the way from it.
    #[inline]
    fn nearest(&self, point: Vec3) -> (f32, Vec3) {
        let offset = point - self.from;
        let t = (offset.dot(self.way) * self.inverse).clamp(0.0, 1.0);
        (t, offset - self.way * t)
    }

    /// The field's value at a point of its own space.
    #[inline]
    pub(super) fn value(&self, point: Vec3) -> f32 {
        let (t, away) = self.nearest(point);
        let x = away.length() / (self.radius + t * self.growth);
        self.strength * self.field.value(x)
    }

    /// The field's value at a point of its own space, and its gradient.
    #[inline]
    pub(super) fn gradient(&self, point: Vec3) -> (f32, Vec3) {
        let (t, away) = self.nearest(point);
        let radius = self.radius + t * self.growth;
        let distance = away.length();
        let x = distance / radius;
        let (value, slope) = self.field.at(x);
        let growth = if t > 0.0 && t < 1.0 { self.growth * self.inverse } else { 0.0 };
        let radial = away / distance.max(f32::MIN_POSITIVE);
        let direction = (radial - self.way * (growth * x)) / radius;
        (self.strength * value, direction * (self.strength * slope))
    }

    /// Where it may be felt along a passage in its own space.
    pub(super) fn span(&self, passage: &Passage) -> Option<Span> {
        passage.near(self.from, self.way, self.inverse, self.thickest() * self.field.reach())
    }

    /// What its values may be within `reach` metres of a point, all in its own space; and the least radius there.
    #[inline]
    pub(super) fn range(&self, point: Vec3, reach: f32) -> (Range, f32) {
        let (t, away) = self.nearest(point);
        let rounding = ROUNDING * (point.abs().max_element() + self.from.abs().max_element() + reach);
        let reach = reach * 1.0001 + rounding;
        let felt = self.thickest() * self.field.reach() * 1.0002 + reach;
        // Most are too far away.
        if away.length_squared() > felt * felt {
            return (Range::NOTHING, self.thinnest());
        }
        self.range_near(t, away.length(), reach)
    }

    fn range_near(&self, t: f32, distance: f32, reach: f32) -> (Range, f32) {
        // By how much the radius changes a metre.
        let taper = self.growth.abs() * self.inverse.sqrt();
        let here = self.radius + t * self.growth;
        let thin = (here - taper * reach).max(self.thinnest()) * 0.9999;
        let thick = (here + taper * reach).min(self.thickest()) * 1.0001;
        let near = (distance - reach).max(0.0) / thick;
        if near >= self.field.reach() {
            return (Range::NOTHING, thin);
        }
        let far = (distance + reach) / thin;
        // Rounding may change the last bits of a value, but not those of a 1 on the plateau.
        let slack = |x: f32, by: f32| {
            if x <= self.field.plateau() { 1.0 } else { (self.field.value(x) + by).clamp(0.0, 1.0) }
        };
        let (least, most) = (slack(far, -1e-5), slack(near, 1e-5));
        // The distance changes by a metre a metre, the radius by the taper.
        let lean = taper * far.min(self.field.reach());
        let stretch = (1.0 + lean * lean).sqrt() / thin;
        let slope = self.field.steepest(near, far) * stretch;
        let range =
            Range { least: self.strength * least, most: self.strength * most, slope: self.strength * slope };
        (range, thin)
    }
}
