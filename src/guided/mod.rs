//! Trees as least-cost paths in an irregular graph, steered by guiding vectors.
//!
//! After Xu and Mould 2015, "Procedural Tree Modeling with Guiding Vectors"; sections and figures named in this
//! module are that paper's.
//!
//! Beyond the paper, a stage with a [`Refinement`] runs on a finer graph around the tree so far.
//!
//! [`TreeSynth`] composes a [`GraphBuilder`], a list of [`Stage`]s, each with a [`GuidingRule`], a [`WeightFn`] and
//! an [`EndpointPolicy`], and a [`RadiusModel`](crate::RadiusModel).

mod around;
mod context;
mod curve;
mod drawn;
mod edit;
mod endpoint;
mod example;
mod fork;
mod graph;
mod queue;
mod recipe;
mod refine;
mod repair;
mod rule;
mod run;
mod search;
mod shed;
mod synth;
mod territory;
mod weight;

pub use around::AroundTree;
pub use drawn::{Canvas, DrawnLimbs, Stroke};
pub use edit::Regrowth;
pub use endpoint::{
    AboveEachRoot, AroundEachRoot, Count, EndpointError, EndpointPolicy, HopSurface, InShape, LimbSurface,
    NearestTo, NearestToEach, Side, StageView,
};
pub use example::{Example, OrderTraits, TrunkTraits};
pub use fork::Fork;
pub use graph::{
    Edges, GradedYao, Graph, GraphBuilder, GraphError, Lattice, Leader, NearSurface, PointCloud,
    PoissonDelaunay, PoissonSurface, PoissonYao, SizingField, SizingFn, Spacing, SurfaceNodes,
};
#[cfg(feature = "json")]
pub use recipe::RecipeError;
pub use recipe::{EndpointRecipe, GraphRecipe, Recipe, RuleRecipe, SizingRecipe, StageRecipe, WeightRecipe};
pub use refine::Refinement;
pub use rule::{
    Bend, BendAxis, Blend, ByHeight, ByStage, ByTree, FollowField, ForkAngle, GuidingRule, Jitter, Source,
    SourceElevation, SourceVector, Step,
};
pub use search::{Search, SearchError};
pub use shed::Shedding;
pub use synth::{Growth, Stage, SynthesisError, TreeSynth};
pub use territory::Territory;
pub use weight::{Apart, Edge, Guided, GuidedPower, Length, Multimodal, Star, WeightFn, Within};
