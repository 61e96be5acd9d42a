//! The pipeline: graph, stages, radii.

use super::endpoint::{EndpointError, EndpointPolicy, StageView};
use super::graph::{Graph, GraphBuilder, GraphError};
use super::refine::Refinement;
use super::rule::GuidingRule;
use super::run::Terms;
use super::search::{Search, SearchError};
use super::shed::Shedding;
use super::weight::{Guided, WeightFn};
use crate::observer::{Cancelled, Observer, Silent, Work, report};
use crate::parameter::ParameterError;
use crate::radius::{PipeModel, RadiusError, RadiusModel};
use crate::shape::Shape;
use crate::skeleton::{Skeleton, SkeletonError};
use std::sync::Arc;

/// One iteration of the paper: a search with its rule and weights, and the endpoints whose paths join the tree.
///
/// Cloning shares the strategies.
#[must_use]
#[derive(Clone)]
pub struct Stage {
    pub(super) rule: Arc<dyn GuidingRule>,
    pub(super) weight: Arc<dyn WeightFn>,
    pub(super) endpoints: Arc<dyn EndpointPolicy>,
    refinement: Option<Refinement<Arc<dyn Shape>>>,
}

impl Stage {
    /// Rule that turns guiding vectors.
    pub fn rule(&self) -> &dyn GuidingRule {
        &*self.rule
    }

    /// Weight of edges.
    pub fn weight(&self) -> &dyn WeightFn {
        &*self.weight
    }

    /// Policy that chooses the nodes to which branches grow.
    pub fn endpoints(&self) -> &dyn EndpointPolicy {
        &*self.endpoints
    }

    /// The finer graph from this stage on.
    pub fn refinement(&self) -> Option<&Refinement<Arc<dyn Shape>>> {
        self.refinement.as_ref()
    }
}

impl std::fmt::Debug for Stage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Stage")
            .field("refinement", &self.refinement.as_ref().map(Refinement::numbers))
            .field("needs_search", &self.endpoints.needs_search())
            .field("forbids", &self.weight.forbids())
            .finish_non_exhaustive()
    }
}

impl Stage {
    /// A stage with the paper's weight, [`Guided`].
    pub fn new(rule: impl GuidingRule + 'static, endpoints: impl EndpointPolicy + 'static) -> Self {
        Self {
            rule: Arc::new(rule),
            weight: Arc::new(Guided),
            endpoints: Arc::new(endpoints),
            refinement: None,
        }
    }

    /// Another rule.
    pub fn with_rule(mut self, rule: impl GuidingRule + 'static) -> Self {
        self.rule = Arc::new(rule);
        self
    }

    /// Other endpoints.
    pub fn with_endpoints(mut self, endpoints: impl EndpointPolicy + 'static) -> Self {
        self.endpoints = Arc::new(endpoints);
        self
    }

    /// Other weights.
    pub fn with_weight(mut self, weight: impl WeightFn + 'static) -> Self {
        self.weight = Arc::new(weight);
        self
    }

    /// A finer graph around the tree so far, from this stage on.
    pub fn with_refinement(mut self, refinement: Refinement<impl Shape + 'static>) -> Self {
        self.refinement = Some(refinement.shared());
        self
    }

    /// As [`check`](Self::check), and the error says which stage it is.
    fn check_as(&self, number: usize) -> Result<(), ParameterError> {
        self.check()
            .map_err(|error| ParameterError { range: format!("{} (stage {number})", error.range), ..error })
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.rule.check()?;
        self.weight.check()?;
        self.refinement.as_ref().map_or(Ok(()), Refinement::check)?;
        self.endpoints.check()
    }
}

/// Grows trees: a graph, stages, and a radius model.
///
/// Cloning shares the strategies. A value can be used from several threads at once.
///
/// ```
/// use treesynth::glam::Vec3;
/// use treesynth::guided::{Bend, Count, HopSurface, InShape, NearestTo, PoissonYao, Stage, TreeSynth};
/// use treesynth::shape::{Cuboid, Ellipsoid};
///
/// let region = Cuboid::new(Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 6.0, 3.0));
/// let crown = Ellipsoid::new(Vec3::Y * 3.8, Vec3::new(1.8, 1.8, 1.8));
/// let degrees = f32::to_radians;
/// let tree = TreeSynth::new(PoissonYao::new(region).with_nodes(10_000))
///     .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 4.5)))
///     .stage(Stage::new(Bend::piecewise(degrees(60.0), 0.0, 1), InShape::poisson_disc(crown, 40)))
///     .stage(Stage::new(Bend::piecewise(degrees(30.0), 0.0, 1), HopSurface::new(2, Count::UpTo(300))))
///     .synthesize(7)?;
/// assert!(tree.tips().count() > 200);
/// # Ok::<(), treesynth::SynthesisError>(())
/// ```
#[must_use]
#[derive(Clone)]
pub struct TreeSynth {
    graph: Arc<dyn GraphBuilder>,
    stages: Vec<Stage>,
    shedding: Option<Shedding>,
    radius: Arc<dyn RadiusModel>,
}

impl TreeSynth {
    /// Builder of the graph in which trees grow.
    pub fn graph(&self) -> &dyn GraphBuilder {
        &*self.graph
    }

    /// Model of branch radii.
    pub fn radius(&self) -> &dyn RadiusModel {
        &*self.radius
    }
}

crate::recipe::readable!(TreeSynth { shedding: Option<Shedding> });

impl std::fmt::Debug for TreeSynth {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TreeSynth")
            .field("stages", &self.stages)
            .field("shedding", &self.shedding)
            .finish_non_exhaustive()
    }
}

/// A tree, and how it lies in its graph.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Growth {
    /// The tree.
    pub skeleton: Skeleton,
    /// The graph's node behind each node of the skeleton.
    pub nodes: Vec<u32>,
    /// The endpoints of each stage that are on the tree, nodes of the graph.
    pub endpoints: Vec<Vec<u32>>,
    /// The graph of the last [`Refinement`], if there was one: then `nodes` and `endpoints` are nodes of this, and
    /// not of the graph that synthesis began with.
    pub graph: Option<Arc<Graph>>,
}

/// Error of growing trees by guided synthesis.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SynthesisError {
    /// An option is out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// There is no graph.
    #[error("the graph: {0}")]
    Graph(#[source] GraphError),
    /// A rule, a weight or an endpoint is no use.
    #[error(transparent)]
    Search(SearchError),
    /// A policy found no endpoints.
    #[error("stage {stage}: {error}")]
    Endpoints {
        /// The stage, from 0.
        stage: usize,
        /// Error of the policy.
        #[source]
        error: EndpointError,
    },
    /// The radius model failed.
    #[error("the radii: {0}")]
    Radius(#[from] RadiusError),
    /// The radius model's numbers are no radii.
    #[error("the tree: {0}")]
    Skeleton(#[from] SkeletonError),
    /// The observer cancelled the work.
    #[error("cancelled by the observer")]
    Cancelled,
}

impl From<Cancelled> for SynthesisError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<GraphError> for SynthesisError {
    fn from(error: GraphError) -> Self {
        match error {
            GraphError::Cancelled => Self::Cancelled,
            GraphError::Parameter(error) => Self::Parameter(error),
            error => Self::Graph(error),
        }
    }
}

impl From<SearchError> for SynthesisError {
    fn from(error: SearchError) -> Self {
        match error {
            SearchError::Cancelled => Self::Cancelled,
            error => Self::Search(error),
        }
    }
}

impl TreeSynth {
    /// No stages yet, and the pipe model's radii.
    pub fn new(graph: impl GraphBuilder + 'static) -> Self {
        Self {
            graph: Arc::new(graph),
            stages: Vec::new(),
            shedding: None,
            radius: Arc::new(PipeModel::default()),
        }
    }

    /// Adds a stage. A tree takes 4 or 5 of them (section 3.1.4); at most 65,535.
    pub fn stage(mut self, stage: Stage) -> Self {
        self.stages.push(stage);
        self
    }

    /// Other stages, all of them: those of [`stages`](Self::stages) with some changed, for one.
    pub fn with_stages(mut self, stages: impl Into<Vec<Stage>>) -> Self {
        self.stages = stages.into();
        self
    }

    /// The first stages alone, to see a tree that is not finished.
    pub fn first_stages(mut self, stages: usize) -> Self {
        self.stages.truncate(stages);
        self
    }

    /// The same stages at one resolution, that of the first graph: no stage refines.
    pub fn without_refinements(mut self) -> Self {
        self.stages.iter_mut().for_each(|stage| stage.refinement = None);
        self
    }

    /// `true` if a stage refines.
    pub fn refines(&self) -> bool {
        self.stages.iter().any(|stage| stage.refinement.is_some())
    }

    /// Branches that bear too little fall after the last stage, before the radii.
    pub fn with_shedding(mut self, shedding: Shedding) -> Self {
        self.shedding = Some(shedding);
        self
    }

    /// Another radius model.
    pub fn with_radius(mut self, radius: impl RadiusModel + 'static) -> Self {
        self.radius = Arc::new(radius);
        self
    }

    /// Another graph.
    pub fn with_graph(mut self, graph: impl GraphBuilder + 'static) -> Self {
        self.graph = Arc::new(graph);
        self
    }

    /// The stages.
    pub fn stages(&self) -> &[Stage] {
        &self.stages
    }

    /// Checks that all options are in range. Synthesis does this first.
    ///
    /// # Errors
    /// The first option that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.graph.check()?;
        self.check_growth()
    }

    pub(super) fn check_growth(&self) -> Result<(), ParameterError> {
        let stages = self.stages.len();
        ParameterError::unless(
            (1..=65_535).contains(&stages),
            "TreeSynth.stages",
            stages,
            "1 to 65535 stages",
        )?;
        self.stages.iter().enumerate().try_for_each(|(number, stage)| stage.check_as(number))?;
        self.shedding.as_ref().map_or(Ok(()), Shedding::check)?;
        self.radius.check()
    }

    /// Builds the graph alone, for [`synthesize_on`](Self::synthesize_on).
    ///
    /// # Errors
    /// Options out of range, or whatever the builder says.
    pub fn build_graph(&self, seed: u64, observer: &dyn Observer) -> Result<Graph, SynthesisError> {
        self.graph.check()?;
        Ok(self.graph.build(seed, observer)?)
    }

    /// Builds the graph and grows the tree of `seed` in it.
    ///
    /// O(s n log n) for n nodes and s stages; in practice linear in n.
    ///
    /// # Errors
    /// Options out of range, a graph that cannot be built, a strategy that breaks its contract, or too few
    /// candidates for endpoints.
    pub fn synthesize(&self, seed: u64) -> Result<Skeleton, SynthesisError> {
        self.synthesize_observed(seed, &Silent)
    }

    /// As [`synthesize`](Self::synthesize), telling `observer` how far it is and stopping when told to.
    ///
    /// # Errors
    /// As `synthesize`, and [`SynthesisError::Cancelled`].
    pub fn synthesize_observed(
        &self,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<Skeleton, SynthesisError> {
        self.check()?;
        let graph = self.build_graph(seed, observer)?;
        Ok(self.grow(&mut Search::new(&graph), seed, observer)?.skeleton)
    }

    /// Grows the tree of `seed` in a graph that is already built; "the same graph could be reused for each
    /// experiment" (section 4). From several threads at once if you like.
    ///
    /// # Errors
    /// As `synthesize`.
    pub fn synthesize_on(&self, graph: &Graph, seed: u64) -> Result<Skeleton, SynthesisError> {
        Ok(self.grow(&mut Search::new(graph), seed, &Silent)?.skeleton)
    }

    /// Builds the graph and grows a tree from each of its [roots](Graph::roots). All trees compete in one search: a node
    /// belongs to the tree whose path to it costs least, so no two trees share one and crowns give way to each other.
    /// In the order of the roots. [`ByTree`](super::ByTree) gives each tree a rule of its own.
    ///
    /// ```
    /// use treesynth::glam::Vec3;
    /// use treesynth::guided::{Bend, InShape, NearestToEach, PoissonYao, Stage, TreeSynth};
    /// use treesynth::shape::Cuboid;
    ///
    /// let region = Cuboid::new(Vec3::new(-4.0, 0.0, -2.0), Vec3::new(4.0, 5.0, 2.0));
    /// let feet = [Vec3::X * -2.0, Vec3::X * 2.0];
    /// let crowns = Cuboid::new(Vec3::new(-4.0, 2.0, -2.0), Vec3::new(4.0, 5.0, 2.0));
    /// let trees = TreeSynth::new(PoissonYao::new(region).with_nodes(10_000).with_roots(feet))
    ///     .stage(Stage::new(Bend::none(), NearestToEach::new(feet.map(|foot| foot + Vec3::Y * 3.0))))
    ///     .stage(Stage::new(Bend::piecewise(1.0, 0.0, 1), InShape::poisson_disc(crowns, 60)))
    ///     .synthesize_all(1)?;
    /// assert_eq!(trees.len(), 2);
    /// # Ok::<(), treesynth::SynthesisError>(())
    /// ```
    ///
    /// # Errors
    /// As [`synthesize`](Self::synthesize).
    pub fn synthesize_all(&self, seed: u64) -> Result<Vec<Skeleton>, SynthesisError> {
        self.check()?;
        let graph = self.build_graph(seed, &Silent)?;
        let grown = self.grow_all(&mut Search::new(&graph), seed, &Silent)?;
        Ok(grown.into_iter().map(|growth| growth.skeleton).collect())
    }

    /// As [`synthesize_on`](Self::synthesize_on), in memory that can be used again for the next tree, and with all
    /// there is to know about the result. Afterwards `search` still holds the tree and the last stage's search.
    ///
    /// # Errors
    /// As `synthesize`, [`SynthesisError::Cancelled`], and a parameter error where the graph has several roots.
    pub fn grow(
        &self,
        search: &mut Search<'_>,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<Growth, SynthesisError> {
        let roots = search.roots();
        ParameterError::unless(
            roots == 1,
            "Graph.roots",
            roots,
            "1; synthesize_all and grow_all take several",
        )?;
        let mut grown = self.grow_all(search, seed, observer)?;
        Ok(grown.swap_remove(0))
    }

    /// As [`grow`](Self::grow), a tree from each root of the graph, in their order.
    ///
    /// # Errors
    /// As `synthesize`, and [`SynthesisError::Cancelled`].
    pub fn grow_all(
        &self,
        search: &mut Search<'_>,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<Vec<Growth>, SynthesisError> {
        self.check_growth()?;
        search.reset();
        let mut endpoints: Vec<Vec<u32>> = Vec::new();
        for stage in 0..self.stages.len() {
            let old = search.tree().to_vec();
            let places = self.refine(search, stage, seed, observer)?;
            if let Some(places) = places {
                let mut moved = vec![0; old.iter().max().map_or(0, |&node| node as usize + 1)];
                for (node, place) in old.into_iter().zip(places) {
                    moved[node as usize] = place;
                }
                endpoints.iter_mut().flatten().for_each(|node| *node = moved[*node as usize]);
            }
            endpoints.push(self.search_stage(search, stage, seed, observer)?);
        }
        self.finish(search.skeletons()?, search.tree(), &endpoints, search.finer_graph().as_ref(), observer)
    }

    /// Sheds and thickens trees, each given with the place of its nodes in `tree`.
    pub(super) fn finish(
        &self,
        trees: Vec<(Skeleton, Vec<usize>)>,
        tree: &[u32],
        endpoints: &[Vec<u32>],
        graph: Option<&Arc<Graph>>,
        observer: &dyn Observer,
    ) -> Result<Vec<Growth>, SynthesisError> {
        report(observer, Work::Radii, 0.0)?;
        let several = trees.len() > 1;
        let grown = trees.into_iter().map(|(skeleton, places)| {
            let mut nodes: Vec<u32> = places.into_iter().map(|place| tree[place]).collect();
            let skeleton = if let Some(shedding) = &self.shedding {
                let (kept, places) = shedding.shed(&skeleton)?;
                nodes = places.into_iter().map(|place| nodes[place as usize]).collect();
                kept
            } else {
                skeleton
            };
            let skeleton = self.thicken(skeleton)?;
            let mut endpoints = endpoints.to_vec();
            if several || self.shedding.is_some() {
                let mut own = nodes.clone();
                own.sort_unstable();
                for stage in &mut endpoints {
                    stage.retain(|node| own.binary_search(node).is_ok());
                }
            }
            Ok(Growth { skeleton, nodes, endpoints, graph: graph.cloned() })
        });
        let grown = grown.collect::<Result<_, SynthesisError>>()?;
        report(observer, Work::Radii, 1.0)?;
        Ok(grown)
    }

    /// The model's radii, but none below what the skeleton has.
    fn thicken(&self, skeleton: Skeleton) -> Result<Skeleton, SynthesisError> {
        let mut radii = self.radius.radii(&skeleton)?;
        if radii.len() == skeleton.len() && skeleton.radii().iter().any(|&least| least > 0.0) {
            radii.iter_mut().zip(skeleton.radii()).for_each(|(radius, &least)| *radius = radius.max(least));
            for (node, parent) in skeleton.edges().rev() {
                radii[parent] = radii[parent].max(radii[node]);
            }
        }
        Ok(skeleton.with_radii(radii)?)
    }

    /// One stage alone: searches from the tree in `search`, adds the paths to the endpoints and returns those.
    /// Costs and vectors of the stage can be read from `search` until the next one begins. After an error the tree
    /// in `search` is what it was.
    ///
    /// # Errors
    /// As `synthesize`, [`SynthesisError::Cancelled`], and a parameter error when there is no such stage.
    pub fn grow_stage(
        &self,
        search: &mut Search<'_>,
        stage: usize,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<Vec<u32>, SynthesisError> {
        let numbered = self.numbered(stage)?;
        numbered.check_as(stage)?;
        if numbered.refinement.is_none() {
            return self.search_stage(search, stage, seed, observer);
        }
        let before = search.clone();
        let refined = self.refine(search, stage, seed, observer);
        let result = refined.and_then(|_| self.search_stage(search, stage, seed, observer));
        if result.is_err() {
            *search = before;
        }
        result
    }

    fn numbered(&self, stage: usize) -> Result<&Stage, ParameterError> {
        let stages = self.stages.len();
        let range = || format!("below the number of stages, {stages}");
        self.stages.get(stage).ok_or_else(|| ParameterError::new("stage", stage, range()))
    }

    /// The new node of each place of the tree, if the stage refines.
    fn refine(
        &self,
        search: &mut Search<'_>,
        stage: usize,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<Option<Vec<u32>>, SynthesisError> {
        let refinement = self.numbered(stage)?.refinement.as_ref();
        Ok(refinement.map(|refinement| refinement.apply(search, stage, seed, observer)).transpose()?)
    }

    fn search_stage(
        &self,
        search: &mut Search<'_>,
        stage: usize,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<Vec<u32>, SynthesisError> {
        let stages = self.stages.len();
        let Stage { rule, weight, endpoints, .. } = self.numbered(stage)?;
        search.forget();
        let before = search.source_vectors();
        let terms = Terms { rule: &**rule, weight: &**weight, stage, stages, seed, observer };
        let select = |search: &Search<'_>| {
            endpoints
                .select(&StageView { search, stage, seed })
                .map_err(|error| SynthesisError::Endpoints { stage, error })
        };
        let mut attempt = || -> Result<Vec<u32>, SynthesisError> {
            let chosen = if endpoints.needs_search() || weight.forbids() {
                search.run(&terms, None)?;
                select(search)?
            } else {
                let chosen = select(search)?;
                search.run(&terms, Some(&chosen))?;
                chosen
            };
            search.extend(&chosen, stage)?;
            Ok(chosen)
        };
        let result = attempt();
        if result.is_err() {
            search.restore(&before);
        }
        result
    }
}
