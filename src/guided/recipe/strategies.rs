//! Built-in strategies as data: an enum for each trait of the pipeline.

use crate::field::FieldRecipe;
use crate::guided::endpoint::{
    AboveEachRoot, AroundEachRoot, EndpointError, EndpointPolicy, HopSurface, InShape, LimbSurface,
    NearestTo, NearestToEach, StageView,
};
use crate::guided::graph::{
    GradedYao, Graph, GraphBuilder, GraphError, Lattice, NearSurface, PointCloud, PoissonDelaunay,
    PoissonYao, SizingField,
};
use crate::guided::rule::{
    Bend, Blend, ByHeight, ByTree, FollowField, ForkAngle, GuidingRule, Jitter, Source, SourceElevation,
    SourceVector, Step,
};
use crate::guided::weight::{Apart, Edge, Guided, GuidedPower, Length, Multimodal, Star, WeightFn, Within};
use crate::guided::{around::AroundTree, territory::Territory};
use crate::observer::Observer;
use crate::parameter::ParameterError;
use crate::recipe::recipe;
use crate::shape::ShapeRecipe;
use glam::Vec3;

recipe! {
    /// A built-in sizing field as data.
    SizingRecipe: SizingField {
        nested NearSurface<ShapeRecipe>,
    }
}

impl SizingField for SizingRecipe {
    fn at(&self, point: Vec3) -> f32 {
        self.strategy().at(point)
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.strategy().check()
    }
}

recipe! {
    /// A built-in graph builder as data.
    GraphRecipe: GraphBuilder {
        plain PointCloud,
        nested PoissonYao<ShapeRecipe>,
        nested PoissonDelaunay<ShapeRecipe>,
        nested Lattice<ShapeRecipe>,
        nested AroundTree<ShapeRecipe>,
        pair GradedYao<ShapeRecipe, SizingRecipe>,
    }
}

impl GraphBuilder for GraphRecipe {
    fn build(&self, seed: u64, observer: &dyn Observer) -> Result<Graph, GraphError> {
        self.strategy().build(seed, observer)
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.strategy().check()
    }
}

recipe! {
    /// A built-in guiding rule as data.
    RuleRecipe: GuidingRule {
        plain Bend,
        nested ForkAngle<RuleRecipe>,
        nested FollowField<FieldRecipe>,
        nested Jitter<RuleRecipe>,
        nested SourceElevation<RuleRecipe>,
        nested SourceVector<RuleRecipe>,
        nested ByTree<RuleRecipe>,
        pair ByHeight<RuleRecipe, RuleRecipe>,
        pair Blend<RuleRecipe, RuleRecipe>,
    }
}

impl std::fmt::Debug for ByTree<RuleRecipe> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ByTree").field("rules", &self.rules()).finish()
    }
}

impl GuidingRule for RuleRecipe {
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        self.strategy().guide(step)
    }

    fn source(&self, source: &Source<'_>) -> Vec3 {
        self.strategy().source(source)
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.strategy().check()
    }
}

recipe! {
    /// A built-in weight as data.
    WeightRecipe: WeightFn {
        unit Guided,
        unit Length,
        plain GuidedPower,
        plain Multimodal,
        nested Apart<WeightRecipe>,
        nested Territory<WeightRecipe>,
        pair Within<WeightRecipe, ShapeRecipe>,
    }
}

impl WeightFn for WeightRecipe {
    fn weight(&self, edge: &Edge<'_>) -> f32 {
        self.strategy().weight(edge)
    }

    fn weights(&self, star: &Star<'_>, weights: &mut [f32]) {
        self.strategy().weights(star, weights);
    }

    fn forbids(&self) -> bool {
        self.strategy().forbids()
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.strategy().check()
    }
}

recipe! {
    /// A built-in endpoint policy as data.
    EndpointRecipe: EndpointPolicy {
        plain NearestTo,
        plain NearestToEach,
        plain HopSurface,
        plain LimbSurface,
        plain AboveEachRoot,
        nested InShape<ShapeRecipe>,
        nested AroundEachRoot<ShapeRecipe>,
    }
}

impl EndpointPolicy for EndpointRecipe {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        self.strategy().select(view)
    }

    fn needs_search(&self) -> bool {
        self.strategy().needs_search()
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.strategy().check()
    }
}
