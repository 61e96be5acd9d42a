//! Pipelines of built-in strategies as data: to print, compare, save and change.

mod strategies;
#[cfg(feature = "json")]
mod text;

pub use strategies::{EndpointRecipe, GraphRecipe, RuleRecipe, SizingRecipe, WeightRecipe};
#[cfg(feature = "json")]
pub use text::RecipeError;

use super::refine::Refinement;
use super::shed::Shedding;
use super::synth::{Stage, SynthesisError, TreeSynth};
use super::weight::Guided;
use crate::parameter::ParameterError;
use crate::radius::{PipeModel, RadiusRecipe};
use crate::shape::ShapeRecipe;
use crate::skeleton::Skeleton;

/// A [`TreeSynth`] of built-in strategies as plain data: graph, stages, shedding, radii and the seed.
///
/// `Debug` prints every parameter, `PartialEq` compares them, serde writes and reads them (feature `serde`), `to_json` and
/// `from_json` as text (feature `json`). The fields are open; strategies change by their `with_*` methods, in text by
/// hand. Angles are in radians and lengths in metres, as in the strategies. A number that may be infinite is written as the
/// word `infinite`.
///
/// Every [preset](crate::presets::Preset::recipe) has one. Strategies of your own are traits, and no data: turn the recipe
/// into a `TreeSynth` first, and go on with its `stage`. Shapes and fields made of files or closures are no data either:
/// `TriangleMesh`, `Sketch`, `Extrusion`, `GridField`, `FieldFn`, `SizingFn`, nor `PoissonSurface` and `ByStage`.
///
/// ```
/// use treesynth::{glam::Vec3, presets};
/// use treesynth::guided::{Bend, EndpointRecipe, HopSurface, NearestTo, Stage, TreeSynth};
///
/// let mut recipe = presets::by_name("figure-06b")?.guided()?.recipe(4_000);
/// let published = recipe.clone();
/// // A higher trunk, and less of everything after the limbs.
/// recipe.stages[0].endpoints = NearestTo::new(Vec3::Y * 9.0).into();
/// recipe.stages.truncate(3);
/// assert_ne!(recipe, published);
/// let tree = recipe.synthesize()?;
/// assert!(tree.len() > 100);
///
/// // A last stage that may have any rule, weight and policy.
/// let more = TreeSynth::from(recipe).stage(Stage::new(Bend::none(), HopSurface::new(1, 100)));
/// assert!(more.synthesize(1)?.tips().count() > tree.tips().count());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[non_exhaustive]
pub struct Recipe {
    /// The seed of the tree that [`synthesize`](Self::synthesize) grows.
    #[cfg_attr(feature = "serde", serde(default))]
    pub seed: u64,
    /// The graph in which the tree grows.
    pub graph: GraphRecipe,
    /// One search each, in their order.
    pub stages: Vec<StageRecipe>,
    /// Rule by which branches fall after the last stage.
    pub shedding: Option<Shedding>,
    /// Model of branch radii.
    pub radius: RadiusRecipe,
}

/// A [`Stage`] of built-in strategies as plain data.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[non_exhaustive]
pub struct StageRecipe {
    /// Rule that turns guiding vectors.
    pub rule: RuleRecipe,
    /// Weight of edges.
    pub weight: WeightRecipe,
    /// Nodes to which branches grow.
    pub endpoints: EndpointRecipe,
    /// The finer graph from this stage on.
    pub refinement: Option<Refinement<ShapeRecipe>>,
}

impl StageRecipe {
    /// As [`Stage::new`]: with the paper's weight.
    pub fn new(rule: impl Into<RuleRecipe>, endpoints: impl Into<EndpointRecipe>) -> Self {
        Self { rule: rule.into(), weight: Guided.into(), endpoints: endpoints.into(), refinement: None }
    }

    /// Other weights.
    pub fn with_weight(mut self, weight: impl Into<WeightRecipe>) -> Self {
        self.weight = weight.into();
        self
    }

    /// A finer graph around the tree so far, from this stage on.
    pub fn with_refinement(mut self, refinement: Refinement<impl Into<ShapeRecipe>>) -> Self {
        self.refinement = Some(refinement.map(Into::into));
        self
    }
}

impl From<StageRecipe> for Stage {
    fn from(recipe: StageRecipe) -> Self {
        let StageRecipe { rule, weight, endpoints, refinement } = recipe;
        let stage = Self::new(rule.shared(), endpoints.shared()).with_weight(weight.shared());
        match refinement {
            Some(refinement) => stage.with_refinement(refinement),
            None => stage,
        }
    }
}

impl Recipe {
    /// No stages yet, the pipe model's radii, seed 0.
    pub fn new(graph: impl Into<GraphRecipe>) -> Self {
        let radius = PipeModel::default().into();
        Self { seed: 0, graph: graph.into(), stages: Vec::new(), shedding: None, radius }
    }

    /// Adds a stage.
    pub fn stage(mut self, stage: StageRecipe) -> Self {
        self.stages.push(stage);
        self
    }

    /// Branches that bear too little fall after the last stage.
    pub fn with_shedding(mut self, shedding: Shedding) -> Self {
        self.shedding = Some(shedding);
        self
    }

    /// Another radius model.
    pub fn with_radius(mut self, radius: impl Into<RadiusRecipe>) -> Self {
        self.radius = radius.into();
        self
    }

    /// Another seed.
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// The pipeline, for trees of any seed.
    pub fn synth(&self) -> TreeSynth {
        self.clone().into()
    }

    /// Checks that all parameters are in range, with the same errors as [`TreeSynth::check`].
    ///
    /// # Errors
    /// The first parameter that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.synth().check()
    }

    /// Grows the tree of the recipe's own seed.
    ///
    /// # Errors
    /// As [`TreeSynth::synthesize`].
    pub fn synthesize(&self) -> Result<Skeleton, SynthesisError> {
        self.synth().synthesize(self.seed)
    }
}

impl From<Recipe> for TreeSynth {
    fn from(recipe: Recipe) -> Self {
        let Recipe { seed: _, graph, stages, shedding, radius } = recipe;
        let stages: Vec<Stage> = stages.into_iter().map(Stage::from).collect();
        let synth = Self::new(graph.shared()).with_stages(stages).with_radius(radius.shared());
        match shedding {
            Some(shedding) => synth.with_shedding(shedding),
            None => synth,
        }
    }
}
