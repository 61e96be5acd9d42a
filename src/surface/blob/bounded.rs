//! Generalized bounded blending.

use super::jet::Jet;
use super::operator::{Operator, mixed};
use super::primitive::Range;
use crate::{Bounds, ParameterError};
use smallvec::SmallVec;

/// From this value on, the second greatest field is felt in full.
const MEETING: f32 = 0.45;

/// Joint of parts by [generalized bounded blending](super::BlobTreeBuilder::bounded).
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Bounded {
    pub(super) inside: Operator,
    pub(super) outside: Operator,
    color: Option<[f32; 3]>,
}

crate::recipe::readable!(Bounded { color: Option<[f32; 3]> });

impl Bounded {
    /// The operators where the bounding field is 1 and where it is 0: the paper's B₁ and B₂.
    pub fn new(inside: Operator, outside: Operator) -> Self {
        Self { inside, outside, color: None }
    }

    /// The linear RGB colour that the surface takes where the parts meet, as far as the bounding field is 1; default none.
    ///
    /// Its share is the bounding field, as far as the second greatest field of the parts is felt: so all of it where two
    /// surfaces meet, and nothing where but one is felt (figure 6).
    pub fn with_color(mut self, linear: [f32; 3]) -> Self {
        self.color = Some(linear);
        self
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        self.inside.check()?;
        self.outside.check()?;
        let color = self.color.unwrap_or_default();
        let holds = color.iter().all(|channel| (0.0..=1.0).contains(channel));
        ParameterError::unless(holds, "Bounded.color", color, "0 to 1 each")
    }

    /// The one of its operators that needs more parts.
    pub(super) fn needy(&self) -> Operator {
        if self.inside.least_parts() > self.outside.least_parts() { self.inside } else { self.outside }
    }

    /// `true` if parts of value 0 make no difference, to the bit.
    pub(super) fn ignores_nothing(&self) -> bool {
        self.inside.ignores_nothing() && self.outside.ignores_nothing()
    }

    /// `true` if it makes creases.
    pub(super) fn has_contact(&self) -> bool {
        self.inside.is_contact() || self.outside.is_contact()
    }

    pub(super) fn has_no_color(&self) -> bool {
        self.color.is_none()
    }

    pub(super) fn bounds(&self, parts: &[Bounds]) -> Bounds {
        self.inside.bounds(parts).union(self.outside.bounds(parts))
    }

    /// Equation 4, as `b₂ + F_b (b₁ - b₂)`: so where both operators give the same, that is the result, to the bit.
    #[inline]
    pub(super) fn combine<J: Jet>(&self, parts: &[J], field: J) -> J {
        if field.value() <= 0.0 {
            return self.outside.combine(parts);
        }
        let (inside, outside) = (self.inside.combine(parts), self.outside.combine(parts));
        let difference = inside.plus(outside.chain(-outside.value(), -1.0));
        let mixed = outside.plus(field.times(difference));
        if field.value() < 1.0 {
            return mixed;
        }
        // The part added has the value 0 and the slope of the bounding field, if it has one here.
        let slope = difference.chain(difference.value(), 0.0).times(field);
        inside.plus(slope.chain(0.0, 1.0))
    }

    pub(super) fn range(&self, parts: &[Range], field: Range) -> Range {
        let (inside, outside) = (self.inside.range(parts), self.outside.range(parts));
        let apart = (inside.most - outside.least).max(outside.most - inside.least).max(0.0);
        Range {
            least: (inside.least.min(outside.least) - 1e-6 * (1.0 + inside.most + outside.most)).max(0.0),
            most: inside.most.max(outside.most) * (1.0 + 1e-6),
            slope: inside.slope.max(outside.slope) + apart * field.slope,
        }
    }

    /// The colour of all parts together from their values and colours, where the bounding field has a value.
    pub(super) fn color_of(&self, parts: &[(f32, [f32; 3])], field: f32) -> [f32; 3] {
        let outside = self.outside.color(parts);
        if field <= 0.0 {
            return outside;
        }
        let values: SmallVec<[f32; 8]> = parts.iter().map(|part| part.0).collect();
        let shares = [(1.0 - field) * self.outside.combine(&values), field * self.inside.combine(&values)];
        let mut color = mixed(&[(shares[0], outside), (shares[1], self.inside.color(parts))]);
        if let Some(own) = self.color {
            let (mut best, mut second) = (0.0f32, 0.0f32);
            for &(value, _) in parts {
                second = second.max(value.min(best));
                best = best.max(value);
            }
            let meeting = (second / MEETING).min(1.0);
            let share = field * meeting * meeting * (3.0 - 2.0 * meeting);
            color = mixed(&[(1.0 - share, color), (share, own)]);
        }
        color
    }
}

impl Default for Bounded {
    /// Precise contact inside, the sum outside.
    fn default() -> Self {
        Self::new(Operator::contact(), Operator::Sum)
    }
}
