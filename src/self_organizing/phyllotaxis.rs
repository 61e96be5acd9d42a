//! Arrangement of laterals around their axis.

use crate::ParameterError;
use crate::math::{self, UP};
use glam::Vec3;
use std::f32::consts::TAU;

/// In which direction lateral buds point.
///
/// ```
/// use treesynth::self_organizing::{Habit, Phyllotaxis};
///
/// let elm = Habit::default().with_phyllotaxis(Phyllotaxis::Spiral { divergence: std::f32::consts::PI });
/// let ash = Habit::default().with_phyllotaxis(Phyllotaxis::Whorled { count: 2 });
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Phyllotaxis {
    /// Anywhere within the lateral angle of the metamer's direction, each direction as likely: the original's.
    Scattered,
    /// At the lateral angle, each bud so many radians further around its axis than the one before, from year to year
    /// too: π for leaves in two rows, 2.4 (137.5°) for the golden angle.
    ///
    /// The first lateral of an axis stands to its side, level with it. Angles are kept to 256ths of a turn, 1.4°.
    Spiral {
        /// The angle from one bud to the next, radians, in [-1e3, 1e3].
        divergence: f32,
    },
    /// At the lateral angle, in whorls of equal angles at the end of each metamer; each whorl stands over the gaps of
    /// the one before. 2 for opposite (decussate) laterals, 3 and more for whorls.
    ///
    /// A whorl is so many nodes, one on top of the other with a fiftieth of the metamer between two, so that
    /// a tree has so many times as many nodes as without.
    Whorled {
        /// Laterals in a whorl, in [1, 8].
        count: u8,
    },
}

/// The part of a metamer's length from one node of a whorl to the next.
const GAP: f32 = 0.02;

impl Phyllotaxis {
    pub(super) fn check(self) -> Result<(), ParameterError> {
        match self {
            Self::Scattered => Ok(()),
            Self::Spiral { divergence } => {
                super::habit::within("Phyllotaxis::Spiral.divergence", divergence, -1e3, 1e3)
            }
            Self::Whorled { count } => ParameterError::unless(
                (1..=8).contains(&count),
                "Phyllotaxis::Whorled.count",
                count,
                "1 to 8 laterals",
            ),
        }
    }

    /// Number of nodes of a metamer.
    #[inline]
    pub(super) fn nodes(self) -> u32 {
        if let Self::Whorled { count } = self { u32::from(count) } else { 1 }
    }

    /// Share of the metamer's length below node `i` of its nodes.
    #[inline]
    pub(super) fn part(self, i: u32) -> f32 {
        match self.nodes() {
            1 => 1.0,
            count if i == 0 => 1.0 - GAP * (count - 1) as f32,
            _ => GAP,
        }
    }

    /// Angle around the axis from the node before to node `i` of a metamer's nodes, radians.
    fn step(self, i: u32) -> f32 {
        match self {
            Self::Scattered => 0.0,
            Self::Spiral { divergence } => divergence,
            // From the last of a whorl one step leads to its first, half a step more over the gap after it.
            Self::Whorled { count } if i == 0 => 1.5 * TAU / f32::from(count),
            Self::Whorled { count } => TAU / f32::from(count),
        }
    }

    /// The azimuth of node `i` of a metamer that is headed along `direction`. `before` has the direction and the
    /// azimuth of the node before on the same axis; `first` is what a straight trunk begins with.
    pub(super) fn azimuth(self, i: u32, direction: Vec3, before: Option<(Vec3, u8)>, first: u8) -> u8 {
        if matches!(self, Self::Scattered) {
            return 0;
        }
        let (sideways, turn) = match before {
            // Carried along without a twist, then around.
            Some((before, azimuth)) => (carried(side(before, azimuth), before, direction), self.step(i)),
            None => (UP.cross(direction).try_normalize().unwrap_or_else(|| side(direction, first)), 0.0),
        };
        let (across, along) = direction.any_orthonormal_pair();
        let angle = math::atan2(sideways.dot(along), sideways.dot(across)) + turn;
        let turns = angle / TAU;
        ((turns - turns.floor()) * 256.0).round() as u32 as u8
    }
}

/// The direction of `azimuth` across `direction`.
fn side(direction: Vec3, azimuth: u8) -> Vec3 {
    let (across, along) = direction.any_orthonormal_pair();
    let (s, c) = math::sin_cos(f32::from(azimuth) * (TAU / 256.0));
    across * c + along * s
}

/// `across`, at right angles to `from`, turned as the smallest rotation turns `from` into `to`.
fn carried(across: Vec3, from: Vec3, to: Vec3) -> Vec3 {
    let both = 1.0 + from.dot(to);
    if both > 1e-6 { across - (from + to) * (across.dot(to) / both) } else { across }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_of_a_metamer_make_it_up() {
        for count in 1..=8 {
            let whorl = Phyllotaxis::Whorled { count };
            let all: f32 = (0..whorl.nodes()).map(|i| whorl.part(i)).sum();
            assert!((all - 1.0).abs() < 1e-6);
        }
    }
}
