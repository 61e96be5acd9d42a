//! Arrangement of leaves about a twig.

use crate::ParameterError;
use std::f32::consts::{PI, TAU};

/// The golden angle, 137.5°: a full turn less the golden section of one.
const GOLDEN_ANGLE: f32 = 2.399_963_2;

/// Phyllotaxis: how many leaves stand at one height of a twig, and by what angle the next ones are turned.
///
/// ```
/// use treesynth::foliage::{Arrangement, Foliage, Leaf};
///
/// let maple = Foliage::new(Leaf::lobed()).with_arrangement(Arrangement::Decussate);
/// assert_eq!(Arrangement::Whorled(3).per_whorl(), 3);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum Arrangement {
    /// One at a time, on two sides in turn, in the plane that lies flattest: elm, beech, linden.
    Alternate,
    /// Pairs, all in the plane that lies flattest: dawn redwood.
    Opposite,
    /// Pairs, each at a right angle to the one before: maple, ash, horse chestnut.
    Decussate,
    /// This number of leaves at one height, at least 1, each whorl in the gaps of the one before: juniper,
    /// oleander.
    Whorled(u32),
    /// One at a time, each turned by this angle (radians) from the one before: oak, poplar, spruce.
    /// [`SPIRAL`](Self::SPIRAL) has the usual angle.
    Spiral(f32),
}

impl Arrangement {
    /// A spiral by the golden angle, 137.5°.
    pub const SPIRAL: Self = Self::Spiral(GOLDEN_ANGLE);

    /// Leaves at one height.
    pub fn per_whorl(self) -> u32 {
        match self {
            Self::Alternate | Self::Spiral(_) => 1,
            Self::Opposite | Self::Decussate => 2,
            Self::Whorled(leaves) => leaves,
        }
    }

    /// The angle by which a whorl is turned from the one before, radians.
    pub fn divergence(self) -> f32 {
        match self {
            Self::Alternate => PI,
            Self::Opposite => 0.0,
            Self::Decussate => PI / 2.0,
            Self::Whorled(leaves) => PI / leaves.max(1) as f32,
            Self::Spiral(angle) => angle,
        }
    }

    /// `true` if all leaves of a twig lie in one plane.
    pub(super) fn is_flat(self) -> bool {
        matches!(self, Self::Alternate | Self::Opposite)
    }

    /// The angle about the twig of a leaf of a whorl, radians, within a turn.
    pub(super) fn azimuth(self, whorl: u32, leaf: u32) -> f32 {
        let around = leaf as f32 / self.per_whorl() as f32 * TAU;
        // In double precision, or the angle of the thousandth whorl would have lost its last digits.
        let turned = f64::from(whorl) * f64::from(self.divergence()) % std::f64::consts::TAU;
        around + turned as f32
    }

    pub(super) fn check(self) -> Result<(), ParameterError> {
        match self {
            Self::Whorled(leaves) => {
                ParameterError::unless((1..=256).contains(&leaves), "Arrangement.Whorled", leaves, "1 to 256")
            }
            Self::Spiral(angle) => {
                ParameterError::unless(angle.abs() <= TAU, "Arrangement.Spiral", angle, "within ±2π rad")
            }
            _ => Ok(()),
        }
    }
}
