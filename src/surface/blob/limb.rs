//! Branches on branches: each blends with its parent branch, and with no other.
//!
//! A limb has two values: its own, that of its axis alone, and the greatest of all that stands on it. At a
//! fork the own values of the parent branch and the lateral are blended; the parent branch keeps its own for
//! the next lateral, and the blend joins the rest, which is never blended with anything. Branches that only
//! pass each other therefore meet as by a union.

use super::bounded::Bounded;
use super::jet::Jet;
use super::operator::{Operator, greatest};
use super::primitive::Range;

/// A fork of a lateral and its parent branch: the number of values of each that are at hand, in the order of
/// evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fork {
    /// The number of the style in which they blend.
    pub(super) style: u32,
    /// The number of values of the parent branch: none, its own, or its own and the rest.
    pub(super) parent: u8,
    /// The same of the lateral.
    pub(super) lateral: u8,
    /// `true` if the bounding field's value comes after them; it does not where it is 0 all around.
    pub(super) is_bounded: bool,
}

impl Fork {
    /// The number of values that it takes.
    pub(super) fn values(self) -> usize {
        usize::from(self.parent + self.lateral) + usize::from(self.is_bounded)
    }

    /// The number of nodes that those belong to.
    pub(super) fn parts(self) -> usize {
        usize::from(self.parent > 0) + usize::from(self.lateral > 0) + usize::from(self.is_bounded)
    }

    /// The limb's own value and the rest, from the values it takes.
    #[inline]
    pub(super) fn combine<J: Jet>(self, style: &Bounded, values: &[J]) -> [J; 2] {
        let (limbs, field) = values.split_at(usize::from(self.parent + self.lateral));
        let (parent, lateral) = limbs.split_at(usize::from(self.parent));
        let own = [parent, lateral].map(|limb| limb.first().copied().unwrap_or(J::ZERO));
        let blend = match field.first() {
            Some(&field) => style.combine(&own, field),
            None => style.outside.combine(&own),
        };
        [own[0], greatest(&[blend, greatest(limbs)])]
    }

    /// The colours of both, where `values` have theirs.
    pub(super) fn color(self, style: &Bounded, values: &[(f32, [f32; 3])]) -> [(f32, [f32; 3]); 2] {
        let (limbs, field) = values.split_at(usize::from(self.parent + self.lateral));
        let (parent, lateral) = limbs.split_at(usize::from(self.parent));
        let own = [parent, lateral].map(|limb| limb.first().copied().unwrap_or((0.0, [0.0; 3])));
        let field = field.first().map_or(0.0, |part| part.0);
        let blend = (style.combine(&own.map(|part| part.0), field), style.color_of(&own, field));
        let stronger =
            |best: (f32, [f32; 3]), part: &(f32, [f32; 3])| if part.0 > best.0 { *part } else { best };
        [own[0], limbs.iter().fold(blend, stronger)]
    }

    /// Knowledge of the rest, from that of both limbs, own and rest of each, and of the bounding field.
    pub(super) fn range(style: &Bounded, parent: [Range; 2], lateral: [Range; 2], field: Range) -> Range {
        let own = [parent[0], lateral[0]];
        let blend = if field.is_nothing() { style.outside.range(&own) } else { style.range(&own, field) };
        Operator::Union.range(&[blend, parent[0], parent[1], lateral[0], lateral[1]])
    }
}
