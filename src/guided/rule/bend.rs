//! Incremental rotations: constant, piecewise (equation 1), random, and by the angle to the axis (equation 2).

use super::{GuidingRule, Step};
use crate::math::{Rotation, UP, angle_between};
use crate::parameter::ParameterError;
use crate::random::Purpose;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// The axis of an incremental rotation. The paper says both.
///
/// ```
/// use treesynth::guided::{Bend, BendAxis};
///
/// let rule = Bend::constant(0.1).with_axis(BendAxis::UpCrossVector);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum BendAxis {
    /// Perpendicular to up and the traversed edge (section 3.2.1): branches of a vertical trunk bend each to its
    /// own side. The default.
    #[default]
    UpCrossEdge,
    /// Perpendicular to up and the parent's vector (section 3.1.2). A vertical vector stays vertical, so sources
    /// need other vectors, e.g. by [`SourceVector`](super::SourceVector).
    UpCrossVector,
}

/// The vector of the node before, turned from up towards the side of the edge by an angle (radians); see
/// [`Step::bent`].
///
/// Angles from -2π to 2π; negative ones turn towards up.
///
/// ```
/// use treesynth::{GuidingRule, guided::Bend};
///
/// // The upper right tree of figure 5: outwards and downwards for 20 hops, then up again.
/// let degrees = f32::to_radians;
/// Bend::piecewise(degrees(6.0), degrees(-6.0), 20).check().unwrap();
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Bend {
    angle: Angle,
    axis: BendAxis,
    /// Metres of a hop, where angles are by path length.
    hop_length: Option<f32>,
}

crate::recipe::readable!(Bend { hop_length: Option<f32>, axis: BendAxis });

/// An angle in radians, and the rotation by it: sine and cosine are worked out once.
#[derive(Clone, Copy)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(from = "f32", into = "f32")
)]
struct Turn {
    angle: f32,
    rotation: Rotation,
}

impl From<f32> for Turn {
    fn from(angle: f32) -> Self {
        Self { angle, rotation: Rotation::new(angle) }
    }
}

impl From<Turn> for f32 {
    fn from(turn: Turn) -> Self {
        turn.angle
    }
}

impl PartialEq for Turn {
    fn eq(&self, other: &Self) -> bool {
        self.angle == other.angle
    }
}

impl std::fmt::Debug for Turn {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.angle.fmt(f)
    }
}

#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
enum Angle {
    Piecewise { first: Turn, rest: Turn, hops: u32 },
    Random { low: f32, high: f32, rest: Turn, hops: u32 },
    FromAxis { theta: f32 },
}

impl Bend {
    fn new(angle: Angle) -> Self {
        Self { angle, axis: BendAxis::default(), hop_length: None }
    }

    /// No rotation: every node keeps the vector of the node before, as along a straight trunk.
    pub fn none() -> Self {
        Self::constant(0.0)
    }

    /// The same `angle` at every hop.
    pub fn constant(angle: f32) -> Self {
        Self::piecewise(angle, angle, 0)
    }

    /// Equation 1: `first` at the first `hops` nodes from the source, `rest` after that.
    pub fn piecewise(first: f32, rest: f32, hops: u32) -> Self {
        Self::new(Angle::Piecewise { first: first.into(), rest: rest.into(), hops })
    }

    /// Equation 1 with a random first angle in [`low`, `high`): one for each source node, so that "each node on
    /// the trunk has a different random direction" (figure 6 (c)).
    pub fn random(low: f32, high: f32, rest: f32, hops: u32) -> Self {
        Self::new(Angle::Random { low, high, rest: rest.into(), hops })
    }

    /// Equation 2: `theta * √(β / π)`, with β the angle between up and the way from the root to the node.
    pub fn from_axis(theta: f32) -> Self {
        Self::new(Angle::FromAxis { theta })
    }

    /// Counts hops by metres of path: an angle per hop becomes an angle for `metres` of path, in equal parts,
    /// and h0 hops become h0 times `metres`. Branches then bend alike on graphs of any spacing, and across a
    /// [`Refinement`](crate::guided::Refinement); by edges, as in the paper, a finer graph bends them more.
    ///
    /// Finite and above 0. With 1 m, angles are curvatures.
    pub fn with_hop_length(mut self, metres: f32) -> Self {
        self.hop_length = Some(metres);
        self
    }

    /// The angle of one edge where a hop is `hop` metres of path.
    fn angle_by_length(&self, step: &Step<'_>, hop: f32) -> f32 {
        let (start, end) = (step.path_length - step.length, step.path_length);
        let piecewise = |first: f32, rest: f32, hops: u32| {
            let until = hops as f32 * hop;
            let (before, after) = ((end.min(until) - start).max(0.0), (end - start.max(until)).max(0.0));
            (first * before + rest * after) / hop
        };
        match self.angle {
            Angle::Piecewise { first, rest, hops } => piecewise(first.angle, rest.angle, hops),
            Angle::Random { low, high, rest, hops } => {
                let draw = step.random(Purpose::SOURCE_ANGLE, step.source());
                piecewise(low + (high - low) * draw, rest.angle, hops)
            }
            Angle::FromAxis { theta } => from_axis(theta, step) * step.length / hop,
        }
    }

    /// Turns about another axis.
    pub fn with_axis(mut self, axis: BendAxis) -> Self {
        self.axis = axis;
        self
    }
}

/// Equation 2.
fn from_axis(theta: f32, step: &Step<'_>) -> f32 {
    theta * (angle_between(step.position - step.root(), UP) / PI).sqrt()
}

impl GuidingRule for Bend {
    #[inline]
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        if let Some(hop) = self.hop_length {
            return step.bent(Rotation::new(self.angle_by_length(step, hop)), self.axis);
        }
        let rotation = match &self.angle {
            Angle::Piecewise { first, rest, hops } => {
                if step.hops > *hops {
                    rest.rotation
                } else {
                    first.rotation
                }
            }
            Angle::Random { rest, hops, .. } if step.hops > *hops => rest.rotation,
            Angle::Random { low, high, .. } => {
                let draw = step.random(Purpose::SOURCE_ANGLE, step.source());
                Rotation::new(low + (high - low) * draw)
            }
            Angle::FromAxis { theta } => Rotation::new(from_axis(*theta, step)),
        };
        step.bent(rotation, self.axis)
    }

    fn check(&self) -> Result<(), ParameterError> {
        let hop = self.hop_length.unwrap_or(1.0);
        let fits = hop > 0.0 && hop.is_finite();
        ParameterError::unless(fits, "Bend.hop_length", hop, "finite and above 0 m")?;
        let angle = |parameter, angle: f32| {
            ParameterError::unless(angle.abs() <= TAU, parameter, angle, "in [-2π, 2π] radians")
        };
        match self.angle {
            Angle::Piecewise { first, rest, hops: 0 } if first.angle.to_bits() == rest.angle.to_bits() => {
                angle("Bend.angle", first.angle)
            }
            Angle::Piecewise { first, rest, .. } => {
                angle("Bend.first", first.angle)?;
                angle("Bend.rest", rest.angle)
            }
            Angle::Random { low, high, rest, .. } => {
                angle("Bend.low", low)?;
                angle("Bend.high", high)?;
                angle("Bend.rest", rest.angle)?;
                ParameterError::unless(low <= high, "Bend.low", low, "at most Bend.high")
            }
            Angle::FromAxis { theta } => angle("Bend.theta", theta),
        }
    }
}
