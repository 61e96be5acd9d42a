//! Fall of a primitive's field with the distance from its skeleton.

use crate::ParameterError;

/// The field's value on a surface.
pub(super) const ISO: f32 = 0.5;

/// Radius, in units of that at which it is 1/2, at which the polynomial (1 - r²)³ ends, which is often called
/// Wyvill's: 1/√(1 - ∛½).
const WYVILL_REACH: f32 = 2.201_663_5;

/// A primitive's field as a function of x, the distance from its skeleton over the radius there.
///
/// All are 1 or their peak at the skeleton, fall, and are exactly 0 from their [reach](Self::reach) on. The first two
/// are for solids: 1/2 at x = 1, so that a primitive alone has its surface at its radius. The last two are for
/// bounding fields (section 3.1 of Galbraith, Mündermann and Wyvill 2004): 0 at x = 1, so that the radius says how
/// far they reach.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum FieldFunction {
    /// From 1 at x = 1 - w to 0 at 1 + w for the `width` w, above 0 and at most 1, by the polynomial of
    /// degree 5 without slope or curvature at both ends. The width w is therefore the reach of blends, in
    /// radii.
    Smooth {
        /// Half the way from 1 to 0, in radii.
        width: f32,
    },
    /// (1 - (x/X)²)³ to X = 2.2017: cheap, and blends reach far.
    Wyvill,
    /// The paper's ((1 - r)²)³, where r goes from 0 at x = `inner`, from 0 to below 1, to 1 at x = 1; up to `inner` it is 1.
    /// Continuous; at r = 0 its slope jumps from 0 to -6, which the paper's own condition (∇F = 0 where F = 1)
    /// forbids.
    Steep {
        /// Distance up to which the field is 1, as a share of the radius.
        inner: f32,
    },
    /// (1 - r²)³ with r as in `Steep`, without a slope at both ends: what the paper's conditions ask for.
    Bounding {
        /// Distance up to which the field is 1, as a share of the radius.
        inner: f32,
    },
}

impl Default for FieldFunction {
    /// `Smooth` with the width 1/2.
    fn default() -> Self {
        Self::Smooth { width: 0.5 }
    }
}

impl FieldFunction {
    /// Reach of the field, in radii.
    pub fn reach(self) -> f32 {
        match self {
            Self::Smooth { width } => 1.0 + width,
            Self::Wyvill => WYVILL_REACH,
            Self::Steep { .. } | Self::Bounding { .. } => 1.0,
        }
    }

    /// Distance at which the field begins to fall, in radii.
    pub(super) fn plateau(self) -> f32 {
        match self {
            Self::Smooth { width } => 1.0 - width,
            Self::Wyvill => 0.0,
            Self::Steep { inner } | Self::Bounding { inner } => inner,
        }
    }

    /// The value at x radii from the skeleton.
    #[inline]
    pub fn value(self, x: f32) -> f32 {
        self.at(x).0
    }

    /// The value at x radii, and its derivative.
    #[inline]
    pub fn at(self, x: f32) -> (f32, f32) {
        if x >= self.reach() {
            return (0.0, 0.0);
        }
        if x <= self.plateau() {
            return (1.0, 0.0);
        }
        match self {
            Self::Smooth { width } => {
                let s = ((x - 1.0) / width).clamp(-1.0, 1.0);
                // As a product, it is above 0 as long as its slope is.
                let (left, rest) = (1.0 - s, 1.0 - s * s);
                let value = left * left * left * (8.0 + s * (9.0 + 3.0 * s)) * (1.0 / 16.0);
                (value.min(1.0), -15.0 / 16.0 * rest * rest / width)
            }
            Self::Wyvill => {
                let r = x * (1.0 / WYVILL_REACH);
                bump(r, 1.0 / WYVILL_REACH)
            }
            Self::Steep { inner } => {
                let scale = 1.0 / (1.0 - inner);
                let rest = (1.0 - (x - inner) * scale).max(0.0);
                let square = rest * rest;
                (square * square * square, -6.0 * square * square * rest * scale)
            }
            Self::Bounding { inner } => {
                let scale = 1.0 / (1.0 - inner);
                bump((x - inner) * scale, scale)
            }
        }
    }

    /// Upper bound of the fall, in value per radius, between `near` and `far` radii.
    pub(super) fn steepest(self, near: f32, far: f32) -> f32 {
        // Slopes grow to one place and fall beyond it.
        let place = match self {
            Self::Smooth { .. } => 1.0,
            // (1 - r²)³ is steepest at r = 1/√5.
            Self::Wyvill => WYVILL_REACH * 0.447_213_6,
            Self::Steep { inner } => inner,
            Self::Bounding { inner } => inner + (1.0 - inner) * 0.447_213_6,
        };
        let place = place.clamp(near, far.max(near));
        let slope = match self {
            // It jumps there; any place beyond is flatter.
            Self::Steep { inner } if place <= inner => 6.0 / (1.0 - inner),
            _ => -self.at(place).1,
        };
        slope * 1.0001
    }

    pub(super) fn check(self) -> Result<(), ParameterError> {
        match self {
            Self::Smooth { width } => {
                let holds = (1e-3..=1.0).contains(&width);
                ParameterError::unless(holds, "FieldFunction.width", width, "0.001 to 1")
            }
            Self::Wyvill => Ok(()),
            Self::Steep { inner } | Self::Bounding { inner } => {
                let holds = (0.0..=0.99).contains(&inner);
                ParameterError::unless(holds, "FieldFunction.inner", inner, "0 to 0.99")
            }
        }
    }
}

/// (1 - r²)³ and its derivative by x, where r grows by `scale` with x.
#[inline]
fn bump(r: f32, scale: f32) -> (f32, f32) {
    let rest = (1.0 - r * r).max(0.0);
    let square = rest * rest;
    (square * rest, -6.0 * r * square * scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [FieldFunction; 6] = [
        FieldFunction::Smooth { width: 0.5 },
        FieldFunction::Smooth { width: 1.0 },
        FieldFunction::Wyvill,
        FieldFunction::Steep { inner: 0.0 },
        FieldFunction::Bounding { inner: 0.4 },
        FieldFunction::Steep { inner: 0.7 },
    ];

    #[test]
    fn fields_fall_from_one_to_zero_as_their_slopes_say() {
        for field in ALL {
            let end = field.reach();
            assert_eq!((field.value(0.0), field.value(end)), (1.0, 0.0), "{field:?}");
            for i in 0..1000 {
                let (x, next) = (end * i as f32 / 1000.0, end * (i + 1) as f32 / 1000.0);
                let (value, slope) = field.at(x);
                let rise = field.value(next) - value;
                assert!(rise <= 1e-6 && -rise <= field.steepest(x, next) * (next - x) + 1e-6, "{field:?}");
                let middle = field.at(0.5 * (x + next)).1;
                let jumps = matches!(field, FieldFunction::Steep { inner } if x <= inner);
                assert!(
                    jumps || (rise / (next - x) - middle).abs() < 2e-2 * (1.0 + middle.abs()),
                    "{field:?} {x} {slope}"
                );
            }
        }
    }

    #[test]
    fn solids_have_their_surface_at_one_radius_and_bounding_fields_are_the_papers() {
        for field in [ALL[0], ALL[1], ALL[2]] {
            assert!((field.value(1.0) - ISO).abs() < 1e-6, "{field:?}");
        }
        // ((1 - r)²)³ and (1 - r²)³ at r = 1/2.
        let steep = FieldFunction::Steep { inner: 0.0 }.value(0.5);
        let bounding = FieldFunction::Bounding { inner: 0.0 }.value(0.5);
        assert_eq!([steep, bounding].map(f32::to_bits), [1.0f32 / 64.0, 27.0 / 64.0].map(f32::to_bits));
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        for field in [
            FieldFunction::Smooth { width: 0.0 },
            FieldFunction::Smooth { width: f32::NAN },
            FieldFunction::Bounding { inner: 1.0 },
            FieldFunction::Steep { inner: -0.1 },
        ] {
            let error = field.check().unwrap_err();
            assert!(error.parameter.starts_with("FieldFunction."), "{error}");
        }
    }
}
