//! Operator that joins the fields of several parts.

use super::field::ISO;
use super::jet::Jet;
use super::primitive::Range;
use crate::{Bounds, ParameterError, math};

/// Distance around a solid within which another one yields to it, for precise contact modelling.
///
/// Pressed by a solid F₂, F₁ becomes F₁ + G(½ - F₂), with G(u) = u within F₂ (u below 0): so both have the
/// value 1/2 where F₁ = F₂, which is the contact surface. Around F₂, where its field is felt less, F₁ bulges
/// by G(u) = u (1 - u/w)² (1 + b u/w) for u up to the `reach` w, and by nothing beyond: G has slope 1 on the
/// surface of F₂ and none at w, so the pressed surface is C¹. (Gascuel 1993; Desbrun and Cani 1998; there of
/// distances, here of field values, so that it is an operator like any other.)
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Contact {
    pub(super) reach: f32,
    pub(super) bulge: f32,
}

crate::recipe::readable!(Contact { reach: f32, bulge: f32 });

impl Default for Contact {
    /// Reach 1/2, so all around where the other solid is felt; bulge 0.
    fn default() -> Self {
        Self { reach: ISO, bulge: 0.0 }
    }
}

impl Contact {
    /// Fall of the other solid's field below 1/2 within which a solid still bulges, 0.01 to 1/2; default 1/2.
    pub fn with_reach(mut self, reach: f32) -> Self {
        self.reach = reach;
        self
    }

    /// The factor b that makes bulges higher, 0 to 3; default 0. The highest bulge is 4/27 of the reach at 0,
    /// 0.32 of it at 3.
    pub fn with_bulge(mut self, bulge: f32) -> Self {
        self.bulge = bulge;
        self
    }

    /// The change of a solid's field where the field of what presses on it is `other`, and its derivative by `other`.
    #[inline]
    fn change(self, other: f32) -> (f32, f32) {
        let u = ISO - other;
        if u <= 0.0 {
            return (u, -1.0);
        }
        if u >= self.reach {
            return (0.0, 0.0);
        }
        let v = u / self.reach;
        let (rest, lift) = (1.0 - v, 1.0 + self.bulge * v);
        let slope = rest * ((1.0 - 3.0 * v) * lift + self.bulge * v * rest);
        (u * rest * rest * lift, -slope)
    }

    /// Upper bound of the slope of the change.
    fn steepest(self) -> f32 {
        1.0 + 0.2 * self.bulge
    }

    /// Upper bound of the change.
    fn highest(self) -> f32 {
        self.reach * (0.15 + 0.06 * self.bulge)
    }

    /// A solid, pressed by another.
    #[inline]
    fn press<J: Jet>(self, solid: J, other: J) -> J {
        let (change, slope) = self.change(other.value());
        solid.plus(other.chain(change, slope))
    }

    fn check(self) -> Result<(), ParameterError> {
        let holds = (0.01..=ISO).contains(&self.reach);
        ParameterError::unless(holds, "Contact.reach", self.reach, "0.01 to 0.5")?;
        let holds = (0.0..=3.0).contains(&self.bulge);
        ParameterError::unless(holds, "Contact.bulge", self.bulge, "0 to 3")
    }
}

/// An operator of a [`BlobTree`](super::BlobTree): a function of the fields of its parts, all at least 0.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum Operator {
    /// The sum: a smooth blend.
    Sum,
    /// The root of the sum of powers, (Σ fⁿ)^(1/n), of Ricci 1973: a blend that is the sum at n = 1 and ever tighter as n
    /// grows, 1 to 64.
    SuperElliptic(f32),
    /// The greatest: CSG union, with a crease.
    Union,
    /// The least: CSG intersection.
    Intersection,
    /// The first without the others: min(f₁, 1 - f₂), at least 0. CSG difference.
    Difference,
    /// Solids that press on each other, none going into another: the union of all, each pressed by the strongest of
    /// the others; and where two were in one place it is solid (their second greatest field), so no rift of width 0 is
    /// left between them.
    Contact(Contact),
    /// The first alone, pressed by the strongest of the others: the contact surface is part of its surface. At least 0.
    Pressed(Contact),
}

impl Operator {
    /// Precise contact modelling as [`Contact::default`] has it.
    pub fn contact() -> Self {
        Self::Contact(Contact::default())
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Sum => "Sum",
            Self::SuperElliptic(_) => "SuperElliptic",
            Self::Union => "Union",
            Self::Intersection => "Intersection",
            Self::Difference => "Difference",
            Self::Contact(_) => "Contact",
            Self::Pressed(_) => "Pressed",
        }
    }

    pub(super) fn check(self) -> Result<(), ParameterError> {
        match self {
            Self::SuperElliptic(power) => {
                let holds = (1.0..=64.0).contains(&power);
                ParameterError::unless(holds, "Operator.SuperElliptic", power, "1 to 64")
            }
            Self::Contact(contact) | Self::Pressed(contact) => contact.check(),
            _ => Ok(()),
        }
    }

    /// Number of parts needed.
    pub(super) fn least_parts(self) -> usize {
        match self {
            Self::Difference | Self::Contact(_) | Self::Pressed(_) => 2,
            _ => 1,
        }
    }

    /// `true` if f(f(a, b), c) = f(a, b, c), in whatever order.
    pub(super) fn is_associative(self) -> bool {
        matches!(self, Self::Sum | Self::SuperElliptic(_) | Self::Union | Self::Intersection)
    }

    /// `true` if parts of value 0 make no difference, to the bit, and a single other part remains as it is.
    pub(super) fn ignores_nothing(self) -> bool {
        matches!(self, Self::Sum | Self::SuperElliptic(_) | Self::Union | Self::Contact(_))
    }

    /// `true` if it makes creases or bulges finer than its parts.
    pub(super) fn is_contact(self) -> bool {
        matches!(self, Self::Contact(_) | Self::Pressed(_))
    }

    /// Region where the whole is felt, from those of the parts.
    pub(super) fn bounds(self, parts: &[Bounds]) -> Bounds {
        let bounds = parts.iter().copied();
        match self {
            Self::Intersection => bounds.reduce(Bounds::intersection).unwrap_or(Bounds::EMPTY),
            Self::Difference => parts.first().copied().unwrap_or(Bounds::EMPTY),
            _ => bounds.fold(Bounds::EMPTY, Bounds::union),
        }
    }

    /// The value of all parts together, and its derivatives.
    #[inline]
    pub(super) fn combine<J: Jet>(self, parts: &[J]) -> J {
        match self {
            Self::Sum => parts.iter().fold(J::ZERO, |sum, &part| sum.plus(part)),
            Self::Union => greatest(parts),
            Self::Intersection => {
                let least = |least: J, &part: &J| if part.value() < least.value() { part } else { least };
                parts[1..].iter().fold(parts[0], least)
            }
            Self::Difference => {
                let other = greatest(&parts[1..]);
                let rest =
                    other.chain((1.0 - other.value()).max(0.0), if other.value() < 1.0 { -1.0 } else { 0.0 });
                if rest.value() < parts[0].value() { rest } else { parts[0] }
            }
            Self::SuperElliptic(power) => super_elliptic(power, parts),
            Self::Contact(contact) => {
                // The others are pressed by the strongest, as the second is, and are less.
                let [best, second] = two_greatest(parts);
                greatest(&[contact.press(best, second), contact.press(second, best), second])
            }
            Self::Pressed(contact) => {
                let pressed = contact.press(parts[0], greatest(&parts[1..]));
                if pressed.value() > 0.0 { pressed } else { J::ZERO }
            }
        }
    }

    /// Knowledge of the whole from that of the parts.
    pub(super) fn range(self, parts: &[Range]) -> Range {
        let most = |f: fn(&Range) -> f32| parts.iter().map(f).fold(0.0, f32::max);
        let slope = most(|part| part.slope);
        match self {
            Self::Sum => parts.iter().fold(Range::NOTHING, |sum, part| Range {
                least: sum.least + part.least,
                most: sum.most + part.most,
                slope: sum.slope + part.slope,
            }),
            Self::Union => Range { least: most(|part| part.least), most: most(|part| part.most), slope },
            Self::Intersection => {
                let least = |f: fn(&Range) -> f32| parts.iter().map(f).fold(f32::INFINITY, f32::min);
                Range { least: least(|part| part.least), most: least(|part| part.most), slope }
            }
            Self::Difference => {
                let others = Self::Union.range(&parts[1..]);
                let (least, most) = ((1.0 - others.most).max(0.0), (1.0 - others.least).max(0.0));
                Range { least: parts[0].least.min(least), most: parts[0].most.min(most), slope }
            }
            Self::SuperElliptic(power) => {
                // The root of powers is least at the greatest of its values and at most their sum.
                let bound = |f: fn(&Range) -> f32| {
                    let values: smallvec::SmallVec<[f32; 8]> = parts.iter().map(f).collect();
                    super_elliptic(power, &values)
                };
                // The norm of the slopes, by Hölder's inequality.
                let slope = bound(|part| part.slope);
                let least = bound(|part| part.least) * (1.0 - 1e-5);
                Range { least, most: bound(|part| part.most) * (1.0 + 1e-5), slope: slope * (1.0 + 1e-5) }
            }
            Self::Contact(contact) => {
                let [least, most, slopes] =
                    [|part: &Range| part.least, |part: &Range| part.most, |part: &Range| part.slope].map(
                        |f| {
                            let values: smallvec::SmallVec<[f32; 8]> = parts.iter().map(f).collect();
                            two_greatest(&values)
                        },
                    );
                Range {
                    // No value is pressed below the second greatest, and the greatest only by the second.
                    least: least[1].max(least[0] + (ISO - most[1]).min(0.0)),
                    most: most[0] + if most[1] > 0.0 { contact.highest() } else { 0.0 },
                    slope: (slopes[0] + slopes[1]) * contact.steepest(),
                }
            }
            Self::Pressed(contact) => {
                let others = Self::Union.range(&parts[1..]);
                let change = if others.least > ISO { ISO - others.least } else { contact.highest() };
                Range {
                    least: (parts[0].least + (ISO - others.most).min(0.0)).max(0.0),
                    most: (parts[0].most + change).max(0.0),
                    slope: parts[0].slope + others.slope * contact.steepest(),
                }
            }
        }
    }

    /// The colour of all parts together from their values and colours.
    pub(super) fn color(self, parts: &[(f32, [f32; 3])]) -> [f32; 3] {
        let by = |better: fn(f32, f32) -> bool| {
            parts.iter().copied().reduce(|best, part| if better(part.0, best.0) { part } else { best })
        };
        let one = match self {
            Self::Sum | Self::SuperElliptic(_) => return mixed(parts),
            Self::Union | Self::Contact(_) => by(|a, b| a > b),
            Self::Intersection => by(|a, b| a < b),
            Self::Difference => {
                let other =
                    parts[1..].iter().copied().reduce(|best, part| if part.0 > best.0 { part } else { best });
                other.filter(|other| other.0 > 0.0 && 1.0 - other.0 < parts[0].0).or(Some(parts[0]))
            }
            Self::Pressed(_) => Some(parts[0]),
        };
        one.map_or([0.0; 3], |(_, color)| color)
    }
}

/// Colours in the shares of their values.
pub(super) fn mixed(parts: &[(f32, [f32; 3])]) -> [f32; 3] {
    let sum: f32 = parts.iter().map(|(value, _)| value).sum();
    let first = parts.iter().find(|(value, _)| *value > 0.0).unwrap_or(&parts[0]);
    let mut mix = first.1;
    if sum > 0.0 {
        // From the first on, so that a single colour stays as it is.
        for (value, color) in parts {
            for (mix, (to, from)) in mix.iter_mut().zip(color.iter().zip(&first.1)) {
                *mix += (to - from) * (value / sum);
            }
        }
    }
    mix
}

/// The greatest; the first of equals; 0 of none.
#[inline]
pub(super) fn greatest<J: Jet>(parts: &[J]) -> J {
    parts.iter().fold(J::ZERO, |best, &part| if part.value() > best.value() { part } else { best })
}

/// The two greatest; 0 where there are none.
#[inline]
fn two_greatest<J: Jet>(parts: &[J]) -> [J; 2] {
    parts.iter().fold([J::ZERO; 2], |[best, second], &part| {
        if part.value() > best.value() {
            [part, best]
        } else if part.value() > second.value() {
            [best, part]
        } else {
            [best, second]
        }
    })
}

#[inline]
fn super_elliptic<J: Jet>(power: f32, parts: &[J]) -> J {
    let mut felt = parts.iter().filter(|part| part.value() > 0.0);
    let (Some(&first), second) = (felt.next(), felt.next()) else { return J::ZERO };
    if second.is_none() {
        return first;
    }
    let is_square = power.to_bits() == 2.0f32.to_bits();
    // Over the greatest, no power overflows or vanishes.
    let scale = greatest(parts).value();
    let raised = |part: &J| {
        let share = part.value() / scale;
        let (below, raised) = if is_square {
            (share, share * share)
        } else {
            let below = math::powf(share, power - 1.0);
            (below, below * share)
        };
        part.chain(raised, power * below / scale)
    };
    let sum =
        parts.iter().fold(J::ZERO, |sum, part| if part.value() > 0.0 { sum.plus(raised(part)) } else { sum });
    let total = sum.value();
    let root = if is_square { total.sqrt() } else { math::powf(total, 1.0 / power) };
    sum.chain(scale * root, scale * root / (power * total))
}
