//! Rules made of rules.

use super::{GuidingRule, Source, Step};
use crate::math::{Rotation, UP, perpendicular, sin_cos};
use crate::parameter::ParameterError;
use crate::random::{Purpose, unit};
use glam::Vec3;
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// One rule for branches that start below a height, another for those above (figure 17 (b)).
///
/// The height of the source above the root counts, so that a branch keeps its rule to the tip.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ByHeight<Below, Above> {
    height: f32,
    below: Below,
    above: Above,
}

crate::recipe::mapped!(ByHeight { below, above; height });

impl<Below: GuidingRule, Above: GuidingRule> ByHeight<Below, Above> {
    /// `below` for sources under `height` metres above the root, `above` for the rest.
    pub fn new(height: f32, below: Below, above: Above) -> Self {
        Self { height, below, above }
    }
}

impl<Below: GuidingRule, Above: GuidingRule> GuidingRule for ByHeight<Below, Above> {
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        let height = step.position_of(step.source()).y - step.root().y;
        if height < self.height { self.below.guide(step) } else { self.above.guide(step) }
    }

    fn source(&self, source: &Source<'_>) -> Vec3 {
        let height = source.position.y - source.root().y;
        if height < self.height { self.below.source(source) } else { self.above.source(source) }
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(self.height.is_finite(), "ByHeight.height", self.height, "finite, in metres")?;
        self.below.check()?;
        self.above.check()
    }
}

/// A rule for each stage; the last one for all stages that follow.
#[must_use]
#[derive(Clone, Default)]
pub struct ByStage {
    rules: Vec<Arc<dyn GuidingRule>>,
}

impl std::fmt::Debug for ByStage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ByStage").field("rules", &self.rules.len()).finish()
    }
}

impl ByStage {
    /// No rules yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds the rule of the next stage.
    pub fn then(mut self, rule: impl GuidingRule + 'static) -> Self {
        self.rules.push(Arc::new(rule));
        self
    }

    fn rule(&self, stage: usize) -> Option<&dyn GuidingRule> {
        self.rules.get(stage).or(self.rules.last()).map(|rule| &**rule)
    }
}

impl GuidingRule for ByStage {
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        self.rule(step.stage).map_or(step.vector, |rule| rule.guide(step))
    }

    fn source(&self, source: &Source<'_>) -> Vec3 {
        self.rule(source.stage).map_or(source.vector, |rule| rule.source(source))
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(!self.rules.is_empty(), "ByStage.rules", self.rules.len(), "at least 1 rule")?;
        self.rules.iter().try_for_each(GuidingRule::check)
    }
}

/// A rule for each of the graph's [roots](crate::guided::Graph::roots), in their order; the last one for all roots that
/// follow.
#[must_use]
#[derive(Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ByTree<R = Arc<dyn GuidingRule>> {
    rules: Vec<R>,
}

impl<A> ByTree<A> {
    /// The same of other rules.
    pub(crate) fn map<B>(self, rule: impl FnMut(A) -> B) -> ByTree<B> {
        ByTree { rules: self.rules.into_iter().map(rule).collect() }
    }
}

impl std::fmt::Debug for ByTree {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ByTree").field("rules", &self.rules.len()).finish()
    }
}

impl ByTree {
    /// No rules yet.
    pub fn new() -> Self {
        Self { rules: Vec::new() }
    }

    /// Adds the rule of the next root's tree.
    pub fn then(mut self, rule: impl GuidingRule + 'static) -> Self {
        self.rules.push(Arc::new(rule));
        self
    }
}

impl Default for ByTree {
    fn default() -> Self {
        Self::new()
    }
}

impl<R: GuidingRule> ByTree<R> {
    /// These rules, all of one type.
    pub fn of(rules: impl Into<Vec<R>>) -> Self {
        Self { rules: rules.into() }
    }

    /// The rules, one for each root.
    pub fn rules(&self) -> &[R] {
        &self.rules
    }

    fn rule(&self, tree: u32) -> Option<&R> {
        self.rules.get(tree as usize).or(self.rules.last())
    }
}

impl<R: GuidingRule> GuidingRule for ByTree<R> {
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        self.rule(step.tree()).map_or(step.vector, |rule| rule.guide(step))
    }

    fn source(&self, source: &Source<'_>) -> Vec3 {
        self.rule(source.tree()).map_or(source.vector, |rule| rule.source(source))
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(!self.rules.is_empty(), "ByTree.rules", self.rules.len(), "at least 1 rule")?;
        self.rules.iter().try_for_each(GuidingRule::check)
    }
}

/// The weighted sum of two rules' unit vectors.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Blend<A, B> {
    first: A,
    second: B,
    share: f32,
}

crate::recipe::mapped!(Blend { first, second; share });

impl<A: GuidingRule, B: GuidingRule> Blend<A, B> {
    /// `share` in [0, 1] of `second`, the rest of `first`.
    pub fn new(first: A, second: B, share: f32) -> Self {
        Self { first, second, share }
    }

    fn mix(&self, first: Vec3, second: Vec3) -> Vec3 {
        let sum = first.normalize_or_zero() * (1.0 - self.share) + second.normalize_or_zero() * self.share;
        // Opposite vectors of equal share cancel out: then the first has it.
        if sum.length_squared() < 1e-12 { first } else { sum }
    }
}

impl<A: GuidingRule, B: GuidingRule> GuidingRule for Blend<A, B> {
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        self.mix(self.first.guide(step), self.second.guide(step))
    }

    fn source(&self, source: &Source<'_>) -> Vec3 {
        self.mix(self.first.source(source), self.second.source(source))
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless((0.0..=1.0).contains(&self.share), "Blend.share", self.share, "in [0, 1]")?;
        self.first.check()?;
        self.second.check()
    }
}

/// Another rule's vector, tilted at each node by a random angle to a random side.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Jitter<R> {
    rule: R,
    angle: f32,
}

crate::recipe::mapped!(Jitter { rule; angle });

impl<R: GuidingRule> Jitter<R> {
    /// Tilts by up to `angle` radians, in [0, π].
    pub fn new(rule: R, angle: f32) -> Self {
        Self { rule, angle }
    }
}

impl<R: GuidingRule> GuidingRule for Jitter<R> {
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        let vector = self.rule.guide(step).normalize_or_zero();
        if vector == Vec3::ZERO {
            return vector; // The search says what is wrong with it.
        }
        let side = Rotation::new(step.random(Purpose::JITTER, step.node) * TAU);
        let axis = side.about(vector, perpendicular(vector));
        let tilt = unit(step.seed, !(step.stage as u32), Purpose::JITTER, u64::from(step.node));
        Rotation::new(tilt * self.angle).about(axis, vector)
    }

    fn source(&self, source: &Source<'_>) -> Vec3 {
        self.rule.source(source)
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(
            (0.0..=PI).contains(&self.angle),
            "Jitter.angle",
            self.angle,
            "in [0, π] radians",
        )?;
        self.rule.check()
    }
}

/// Sets the vectors with which branches start by the height of their source, then leaves the rest to another rule:
/// "initial guiding vector directions set according to height, pointing more steeply upward as the source point
/// elevation increases" (section 4, trees (e) and (i) of figure 17).
///
/// The first node off the tree gets a vector at the height's angle from up, to the side of the edge that leads to
/// it: a source on a vertical trunk has no side of its own, and branches leave it to all sides.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct SourceElevation<R> {
    rule: R,
    angles: [f32; 2],
    heights: [f32; 2],
}

crate::recipe::mapped!(SourceElevation { rule; angles, heights });

impl<R: GuidingRule> SourceElevation<R> {
    /// Branches from sources at `heights[0]` metres above the root and below start `angles[0]` radians away from
    /// up, those from `heights[1]` and above `angles[1]`; linear between. Angles in [0, π].
    pub fn new(rule: R, angles: [f32; 2], heights: [f32; 2]) -> Self {
        Self { rule, angles, heights }
    }
}

impl<R: GuidingRule> GuidingRule for SourceElevation<R> {
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        let across = step.edge.with_y(0.0).normalize_or_zero();
        if step.hops > 1 || across == Vec3::ZERO {
            return self.rule.guide(step);
        }
        let ([low, high], [bottom, top]) = (self.angles, self.heights);
        let height = step.position_of(step.from).y - step.root().y;
        let share = ((height - bottom) / (top - bottom)).clamp(0.0, 1.0);
        let (sin, cos) = sin_cos(low + (high - low) * share);
        UP * cos + across * sin
    }

    fn source(&self, source: &Source<'_>) -> Vec3 {
        self.rule.source(source)
    }

    fn check(&self) -> Result<(), ParameterError> {
        for angle in self.angles {
            ParameterError::unless(
                (0.0..=PI).contains(&angle),
                "SourceElevation.angles",
                angle,
                "in [0, π] radians",
            )?;
        }
        let [bottom, top] = self.heights;
        ParameterError::unless(
            bottom < top && bottom.is_finite() && top.is_finite(),
            "SourceElevation.heights",
            self.heights,
            "finite and ascending, in metres",
        )?;
        self.rule.check()
    }
}

/// All sources enter the stage with one vector, whatever they had, and another rule does the rest: "optionally, the
/// guiding vectors for the source nodes are changed" (section 3.1.4).
///
/// With up, the forks of a stage are measured from up and not from the parent branch's vector; for forks measured from
/// the parent branch itself see [`ForkAngle`](super::ForkAngle).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct SourceVector<R> {
    rule: R,
    vector: Vec3,
}

crate::recipe::mapped!(SourceVector { rule; vector });

impl<R: GuidingRule> SourceVector<R> {
    /// All sources get `vector`, of any length but zero.
    pub fn new(rule: R, vector: Vec3) -> Self {
        Self { rule, vector }
    }
}

impl<R: GuidingRule> GuidingRule for SourceVector<R> {
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        self.rule.guide(step)
    }

    fn source(&self, _: &Source<'_>) -> Vec3 {
        self.vector
    }

    fn check(&self) -> Result<(), ParameterError> {
        let usable = self.vector.is_finite() && self.vector != Vec3::ZERO;
        ParameterError::unless(usable, "SourceVector.vector", self.vector, "finite and not zero")?;
        self.rule.check()
    }
}
