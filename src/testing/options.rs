//! Random pipelines.

use super::strategies::{Region, regions};
use crate::field::Helix;
use crate::guided::{
    Bend, BendAxis, Blend, ByHeight, Count, EndpointPolicy, FollowField, Guided, GuidedPower, GuidingRule,
    HopSurface, InShape, Jitter, Length, Multimodal, NearestTo, PoissonYao, Refinement, Side,
    SourceElevation, Stage, TreeSynth, WeightFn, Within,
};
use crate::radius::{PipeModel, Taper, Variational};
use crate::shape::Sphere;
use glam::Vec3;
use proptest::prelude::*;

/// The options of a random pipeline; [`synth`](Self::synth) makes it.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Options {
    /// Region in which nodes are placed.
    pub region: Region,
    /// Number.
    pub nodes: usize,
    /// `true` if all nodes are in the plane z = 0.
    pub planar: bool,
    /// Sectors of the Yao graph.
    pub sectors: usize,
    /// The stages, one to four.
    pub stages: Vec<StageOptions>,
    /// Radius model.
    pub radius: u8,
}

/// The options of a random stage.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct StageOptions {
    /// The guiding rule.
    pub rule: RuleOption,
    /// The weight function.
    pub weight: WeightOption,
    /// k of the endpoint surface; 0 for endpoints in the region instead, above 4 for a single one.
    pub hops: u32,
    /// t of the endpoint surface.
    pub outermost: f32,
    /// Greatest number of endpoints.
    pub count: usize,
    /// Random weights in place of hops.
    pub randomness: f32,
    /// Restricts endpoints to those lower or to those higher than the source.
    pub side: Option<Side>,
    /// Share of the spacing to which the stage refines the graph; `None` if it does not.
    pub refinement: Option<f32>,
}

/// The guiding rules of the crate.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum RuleOption {
    Constant(f32),
    Piecewise(f32, f32, u32),
    Random(f32, f32, u32),
    FromAxis(f32),
    OtherAxis(f32),
    Field,
    Height(f32, f32),
    Mixed(f32, f32),
    Elevation(f32, f32),
}

/// The weight functions of the crate.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum WeightOption {
    Guided,
    Power(f32),
    Length,
    Multimodal(f32),
    Costly(f32),
    Obstacle(f32),
}

impl RuleOption {
    fn rule(self) -> Box<dyn GuidingRule> {
        match self {
            Self::Constant(angle) => Box::new(Bend::constant(angle)),
            Self::Piecewise(first, rest, hops) => Box::new(Bend::piecewise(first, rest, hops)),
            Self::Random(low, rest, hops) => Box::new(Bend::random(low, low + 1.0, rest, hops)),
            Self::FromAxis(theta) => Box::new(Bend::from_axis(theta)),
            Self::OtherAxis(angle) => Box::new(Bend::constant(angle).with_axis(BendAxis::UpCrossVector)),
            Self::Field => Box::new(FollowField::new(Helix::with_angle(Vec3::ZERO, 0.7))),
            Self::Height(low, high) => {
                Box::new(ByHeight::new(1.0, Bend::constant(low), Bend::constant(high)))
            }
            Self::Mixed(angle, share) => {
                Box::new(Jitter::new(Blend::new(Bend::constant(angle), Bend::none(), share), 0.3))
            }
            Self::Elevation(low, high) => {
                Box::new(SourceElevation::new(Bend::none(), [low, high], [0.0, 3.0]))
            }
        }
    }
}

impl WeightOption {
    fn weight(self) -> Box<dyn WeightFn> {
        match self {
            Self::Guided => Box::new(Guided),
            Self::Power(exponent) => Box::new(GuidedPower::new(exponent)),
            Self::Length => Box::new(Length),
            Self::Multimodal(angle) => {
                Box::new(Multimodal::new().with_cone(angle, 1.2).with_direction(Vec3::X, 2.0))
            }
            Self::Costly(radius) => Box::new(Within::new(Guided, Sphere::new(Vec3::Y * 1.5, radius), 5.0)),
            Self::Obstacle(radius) => Box::new(Within::obstacle(Guided, Sphere::new(Vec3::Y * 1.5, radius))),
        }
    }
}

impl StageOptions {
    fn stage(&self, region: &Region, spacing: f32) -> Stage {
        let count = Count::UpTo(self.count);
        let endpoints: Box<dyn EndpointPolicy> = match self.hops {
            0 if self.count.is_multiple_of(2) => Box::new(InShape::uniform(region.clone(), count)),
            0 => Box::new(InShape::poisson_disc(region.clone(), count)),
            1..=4 => {
                let surface = HopSurface::new(self.hops, count)
                    .with_outermost(self.outermost)
                    .with_random_weights(self.randomness);
                Box::new(match self.side {
                    Some(side) => surface.only(side),
                    None => surface,
                })
            }
            _ => Box::new(NearestTo::new(Vec3::Y * self.outermost * 4.0)),
        };
        let stage = Stage::new(self.rule.rule(), endpoints).with_weight(self.weight.weight());
        match self.refinement {
            Some(share) => {
                stage.with_refinement(Refinement::new(region.clone(), spacing * share).with_reach(4))
            }
            None => stage,
        }
    }
}

impl Options {
    /// The graph builder.
    pub fn builder(&self) -> PoissonYao<Region> {
        let builder = PoissonYao::new(self.region.clone()).with_nodes(self.nodes).with_sectors(self.sectors);
        if self.planar { builder.planar() } else { builder }
    }

    /// The pipeline. Synthesis may end with [`SynthesisError::Endpoints`](crate::SynthesisError), for a random
    /// stage may find no candidate; with no other error.
    pub fn synth(&self) -> TreeSynth {
        let builder = self.builder();
        // An error here is one of `check`, which synthesis reports.
        let spacing = builder.spacing().unwrap_or(f32::NAN);
        let synth = self
            .stages
            .iter()
            .fold(TreeSynth::new(builder), |synth, stage| synth.stage(stage.stage(&self.region, spacing)));
        match self.radius {
            0 => synth,
            1 => synth
                .with_radius(Taper::new(PipeModel::default().with_exponent(2.1).with_trunk_diameter(0.4))),
            _ => synth.with_radius(Variational::uniform(1e-3)),
        }
    }
}

/// Pipelines of 100 to 1,500 nodes and one to four stages, over every rule, weight and policy of the crate.
pub fn options() -> impl Strategy<Value = Options> {
    let angle = -1.5f32..1.5;
    let rule = prop_oneof![
        angle.clone().prop_map(RuleOption::Constant),
        (angle.clone(), angle.clone(), 0u32..8).prop_map(|(a, b, h)| RuleOption::Piecewise(a, b, h)),
        (angle.clone(), angle.clone(), 0u32..4).prop_map(|(a, b, h)| RuleOption::Random(a, b, h)),
        angle.clone().prop_map(RuleOption::FromAxis),
        angle.clone().prop_map(RuleOption::OtherAxis),
        Just(RuleOption::Field),
        (angle.clone(), angle.clone()).prop_map(|(a, b)| RuleOption::Height(a, b)),
        (angle, 0f32..1.0).prop_map(|(a, share)| RuleOption::Mixed(a, share)),
        (0f32..3.0, 0f32..3.0).prop_map(|(a, b)| RuleOption::Elevation(a, b)),
    ];
    let weight = prop_oneof![
        4 => Just(WeightOption::Guided),
        1 => (0f32..4.0).prop_map(WeightOption::Power),
        1 => Just(WeightOption::Length),
        1 => (0f32..2.0).prop_map(WeightOption::Multimodal),
        1 => (0.2f32..1.0).prop_map(WeightOption::Costly),
        1 => (0.2f32..1.0).prop_map(WeightOption::Obstacle),
    ];
    let side = prop_oneof![4 => Just(None), 1 => Just(Some(Side::Lower)), 1 => Just(Some(Side::Higher))];
    let randomness = prop_oneof![3 => Just(0f32), 1 => 0f32..0.9];
    let refinement = prop_oneof![4 => Just(None), 1 => (0.5f32..0.9).prop_map(Some)];
    let stage = (rule, weight, 0u32..6, 0.05f32..=1.0, 1usize..60, randomness, side, refinement).prop_map(
        |(rule, weight, hops, outermost, count, randomness, side, refinement)| StageOptions {
            rule,
            weight,
            hops,
            outermost,
            count,
            randomness,
            side,
            refinement,
        },
    );
    let sectors = prop_oneof![4 => Just(8usize), 1 => 6usize..20];
    let stages = prop::collection::vec(stage, 1..=4);
    (regions(), 100usize..1500, any::<bool>(), sectors, stages, 0u8..3).prop_map(
        |(region, nodes, planar, sectors, stages, radius)| Options {
            region,
            nodes,
            planar,
            sectors,
            stages,
            radius,
        },
    )
}
