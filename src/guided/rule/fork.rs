//! Forks relative to the parent branch.

use super::{GuidingRule, Source, Step};
use crate::math::{Rotation, sin_cos};
use crate::parameter::ParameterError;
use crate::random::Purpose;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Branches leave their parent branch at an angle to *it*, not to up; another rule guides them from there on.
///
/// The guiding vector of the first node off the tree is at the angle from the parent branch's direction. Its side is
/// that of the edge that leads there, unless a [divergence](Self::with_divergence) gives each place on the parent
/// branch a side of its own.
///
/// ```
/// use treesynth::{GuidingRule, glam::Vec3, guided::{Bend, Fork, ForkAngle, Step}};
///
/// let rule = ForkAngle::new(60f32.to_radians(), Bend::none());
/// let limb = Fork::new(Vec3::X);
/// let step = Step::new(Vec3::Y, Vec3::new(0.1, 0.2, 0.0), Vec3::Y).with_fork(limb);
/// assert!((rule.guide(&step).dot(Vec3::X) - 0.5).abs() < 1e-5);
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ForkAngle<R> {
    angle: f32,
    spread: f32,
    divergence: Option<(f32, f32)>,
    rule: R,
}

crate::recipe::readable!(@[R] ForkAngle<R> { spread: f32, divergence: Option<(f32, f32)> });

crate::recipe::mapped!(ForkAngle { rule; angle, spread, divergence });

impl<R: GuidingRule> ForkAngle<R> {
    /// Branches leave at `angle` radians, in [0, π], from the direction of their parent branch, then follow `rule`.
    pub fn new(angle: f32, rule: R) -> Self {
        Self { angle, spread: 0.0, divergence: None, rule }
    }

    /// Largest random deviation of the angle, one for each source node, each way: radians, in [0,
    /// π].
    pub fn with_spread(mut self, spread: f32) -> Self {
        self.spread = spread;
        self
    }

    /// Sides by phyllotaxis: from one internode of `internode` metres (above 0) to the next along the parent branch the
    /// side turns by `angle` radians, in [-2π, 2π], about that branch. Paths then leave it where the side suits them.
    /// 137.5° is a spiral, 180° two ranks, 90° two forks later opposite pairs.
    pub fn with_divergence(mut self, angle: f32, internode: f32) -> Self {
        self.divergence = Some((angle, internode));
        self
    }
}

impl<R: GuidingRule> GuidingRule for ForkAngle<R> {
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        if step.hops > 1 {
            return self.rule.guide(step);
        }
        let fork = step.fork();
        let side = if let Some((angle, internode)) = self.divergence {
            let number = (fork.from_base / internode).floor();
            // In turns, so that thousands of internodes lose no precision.
            let turns = number * (angle / TAU);
            Rotation::new((turns - turns.floor()) * TAU).about(fork.direction, fork.normal)
        } else {
            let across = step.edge - fork.direction * step.edge.dot(fork.direction);
            // An edge along the branch has no side of its own.
            if across.length_squared() < 1e-8 { fork.normal } else { across.normalize() }
        };
        let draw = 2.0 * step.random(Purpose::SOURCE_ANGLE, step.source()) - 1.0;
        let (sin, cos) = sin_cos((self.angle + self.spread * draw).clamp(0.0, PI));
        fork.direction * cos + side * sin
    }

    fn source(&self, source: &Source<'_>) -> Vec3 {
        self.rule.source(source)
    }

    fn check(&self) -> Result<(), ParameterError> {
        let angle = |parameter, angle: f32| {
            ParameterError::unless((0.0..=PI).contains(&angle), parameter, angle, "in [0, π] radians")
        };
        angle("ForkAngle.angle", self.angle)?;
        angle("ForkAngle.spread", self.spread)?;
        if let Some((turn, internode)) = self.divergence {
            ParameterError::unless(turn.abs() <= TAU, "ForkAngle.divergence", turn, "in [-2π, 2π] radians")?;
            let fits = internode > 0.0 && internode.is_finite();
            ParameterError::unless(fits, "ForkAngle.internode", internode, "finite and above 0 m")?;
        }
        self.rule.check()
    }
}
