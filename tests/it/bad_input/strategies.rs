//! Strategies from outside that break their contract, and observers that break off.

use crate::sample::{Named, cube_graph, plot};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use treesynth::glam::Vec3;
use treesynth::guided::{
    Bend, Count, Edge, Edges, EndpointError, FollowField, Graph, GraphBuilder, GraphError, HopSurface,
    InShape, Lattice, NearestTo, PointCloud, PoissonYao, Search, SearchError, Source, Stage, StageView, Step,
    TreeSynth,
};
use treesynth::radius::RadiusError;
use treesynth::shape::Sphere;
use treesynth::{
    EndpointPolicy, GuidingRule, Observer, Progress, RadiusModel, Silent, Skeleton, SkeletonError,
    SynthesisError, VectorField, WeightFn,
};

fn trunk() -> Stage {
    Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 4.0))
}

/// A trunk, then `stage`.
fn grow(stage: Stage) -> Result<Skeleton, SynthesisError> {
    TreeSynth::new(PoissonYao::new(plot(6.0, 6.0)))
        .stage(trunk())
        .stage(stage)
        .synthesize_on(&cube_graph(500, 1), 1)
}

fn search_error(stage: Stage) -> (SearchError, String) {
    match grow(stage) {
        Err(SynthesisError::Search(error)) => (error.clone(), SynthesisError::Search(error).to_string()),
        other => panic!("{:?}", other.map(|tree| tree.len())),
    }
}

/// Weighs everything the same.
struct Flat {
    weight: f32,
    forbids: bool,
}

impl WeightFn for Flat {
    fn weight(&self, _: &Edge) -> f32 {
        self.weight
    }
    fn forbids(&self) -> bool {
        self.forbids
    }
}

#[test]
fn weights_that_are_none() {
    for weight in [f32::NAN, -f32::NAN, -1.0, -f32::MIN_POSITIVE, f32::NEG_INFINITY] {
        for forbids in [false, true] {
            let (error, text) = search_error(trunk().with_weight(Flat { weight, forbids }));
            let SearchError::Weight { stage: 1, from, to, weight: found } = error else {
                panic!("{error:?}")
            };
            assert!(found == weight || found.is_nan() && weight.is_nan());
            let expected =
                format!("stage 1: the weight function gave edge {from} -> {to} the weight {weight}, but");
            assert!(text.starts_with(&expected), "{text}");
        }
    }
    // Zero of either sign is a weight.
    for weight in [0.0, -0.0, f32::MIN_POSITIVE, 1e-45] {
        assert!(grow(trunk().with_weight(Flat { weight, forbids: false })).is_ok(), "{weight}");
    }
}

#[test]
fn weights_that_forbid_everything() {
    let flat = |forbids| Flat { weight: f32::INFINITY, forbids };
    let (error, text) = search_error(Stage::new(Bend::none(), Named(vec![400])).with_weight(flat(true)));
    assert_eq!(error, SearchError::Unreachable { stage: 1, node: 400 });
    assert!(text.ends_with("the endpoint 400"), "{text}");
    let (error, _) = search_error(Stage::new(Bend::none(), Named(vec![400])).with_weight(flat(false)));
    assert_eq!(error, SearchError::Unreachable { stage: 1, node: 400 });
    // A weight that says that it forbids is believed: no endpoints are chosen where no path leads.
    let policies: [Box<dyn EndpointPolicy>; 3] = [
        Box::new(NearestTo::new(Vec3::X)),
        Box::new(InShape::uniform(Sphere::new(Vec3::Y, 9.0), Count::UpTo(5))),
        Box::new(HopSurface::new(1, Count::UpTo(5))),
    ];
    for policy in policies {
        match grow(Stage::new(Bend::none(), policy).with_weight(flat(true))) {
            Err(SynthesisError::Endpoints {
                stage: 1,
                error: EndpointError::TooFew { available: 0, .. },
            }) => {}
            other => panic!("{:?}", other.map(|tree| tree.len())),
        }
    }
    // Sums beyond f32 are as good as infinite.
    let huge = Flat { weight: 3e38, forbids: false };
    let far = Stage::new(Bend::none(), NearestTo::new(Vec3::X * 3.0)).with_weight(huge);
    assert!(matches!(search_error(far).0, SearchError::Unreachable { stage: 1, .. }));
}

/// Points everything one way; from sources, or from all others.
struct Point {
    way: Vec3,
    sources: bool,
}

impl GuidingRule for Point {
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        if self.sources { step.vector } else { self.way }
    }
    fn source(&self, source: &Source) -> Vec3 {
        if self.sources { self.way } else { source.vector }
    }
}

#[test]
fn vectors_that_are_none() {
    for way in
        [Vec3::ZERO, Vec3::NAN, Vec3::X * f32::INFINITY, Vec3::new(0.0, f32::NAN, 1.0), Vec3::NEG_INFINITY]
    {
        for sources in [false, true] {
            let (error, text) = search_error(Stage::new(Point { way, sources }, NearestTo::new(Vec3::X)));
            let SearchError::Vector { stage: 1, node, vector } = error else { panic!("{error:?}") };
            assert_eq!(format!("{vector:?}"), format!("{way:?}"));
            let expected =
                format!("stage 1: the guiding rule gave node {node} the vector {way}, but it must be");
            assert!(text.starts_with(&expected), "{text}");
        }
    }
}

/// "A finite vector that is not zero; the search makes it a unit vector": its length is no matter.
#[test]
fn vectors_of_any_length() {
    let tree = |length: f32| {
        let way = Vec3::new(0.36, 0.48, 0.8) * length;
        grow(Stage::new(Point { way, sources: false }, InShape::uniform(Sphere::new(Vec3::Y * 3.0, 2.0), 20)))
    };
    let unit = tree(1.0).expect("a unit vector");
    for length in [1e-6, 1e6, 1e-18, 1e18, 1e-25, 1e25] {
        let tree = tree(length).unwrap_or_else(|error| panic!("length {length:e}: {error}"));
        assert!(tree.len().abs_diff(unit.len()) < unit.len() / 5, "length {length:e}");
    }
}

struct Broken;

impl VectorField for Broken {
    fn at(&self, _: Vec3) -> Vec3 {
        Vec3::NAN
    }
}

#[test]
fn fields_that_lie() {
    let (error, _) = search_error(Stage::new(FollowField::new(Broken), NearestTo::new(Vec3::X)));
    assert!(matches!(error, SearchError::Vector { stage: 1, .. }), "{error:?}");
}

#[test]
fn endpoints_that_are_none() {
    let nodes = cube_graph(500, 1).nodes();
    for node in [nodes as u32, u32::MAX] {
        let (error, text) = search_error(Stage::new(Bend::none(), Named(vec![3, node])));
        assert_eq!(error, SearchError::UnknownEndpoint { stage: 1, node, nodes });
        assert_eq!(
            text,
            format!("stage 1: the endpoint policy named node {node}, but there are {nodes} nodes")
        );
    }
    let once = grow(Stage::new(Bend::none(), Named(vec![7, 400]))).expect("two endpoints");
    let root = cube_graph(500, 1).root();
    let often = grow(Stage::new(Bend::none(), Named(vec![7, 7, root, 400, root, 7, 400])));
    assert_eq!(often, Ok(once), "named twice or on the tree: adds nothing");
    let trunk_only = TreeSynth::new(PoissonYao::new(plot(6.0, 6.0))).stage(trunk());
    let trunk_only = trunk_only.synthesize_on(&cube_graph(500, 1), 1);
    assert_eq!(grow(Stage::new(Bend::none(), Named(Vec::new()))), trunk_only, "none at all: nothing grows");
}

struct Refuses;

impl EndpointPolicy for Refuses {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        Err(EndpointError::Other(format!("not in stage {}", view.stage())))
    }
}

impl GraphBuilder for Refuses {
    fn build(&self, _: u64, _: &dyn Observer) -> Result<Graph, GraphError> {
        Err(GraphError::Other("no graphs today".to_owned()))
    }
}

impl RadiusModel for Refuses {
    fn radii(&self, _: &Skeleton) -> Result<Vec<f32>, RadiusError> {
        Err(RadiusError::Other { reason: "no radii today".to_owned() })
    }
}

#[test]
fn reasons_of_others_come_through() {
    let error = grow(Stage::new(Bend::none(), Refuses)).expect_err("refused");
    assert_eq!(error.to_string(), "stage 1: not in stage 1");
    let error = TreeSynth::new(Refuses).stage(trunk()).synthesize(1).expect_err("refused");
    assert_eq!(error.to_string(), "the graph: no graphs today");
    let synth = TreeSynth::new(PoissonYao::new(plot(6.0, 6.0)).with_nodes(300)).stage(trunk());
    let error = synth.with_radius(Refuses).synthesize(1).expect_err("refused");
    assert_eq!(error.to_string(), "the radii: no radii today");
}

/// This radius, for as many nodes more than there are.
struct Radii(f32, isize);

impl RadiusModel for Radii {
    fn radii(&self, skeleton: &Skeleton) -> Result<Vec<f32>, RadiusError> {
        Ok(vec![self.0; skeleton.len().saturating_add_signed(self.1)])
    }
}

#[test]
fn radii_that_are_none() {
    let synth = TreeSynth::new(PoissonYao::new(plot(6.0, 6.0)).with_nodes(300)).stage(trunk());
    for radius in [f32::NAN, f32::INFINITY, -1.0] {
        let error = synth.clone().with_radius(Radii(radius, 0)).synthesize(1).expect_err("no radius");
        assert!(
            matches!(error, SynthesisError::Skeleton(SkeletonError::Radius { node: 0, .. })),
            "{error:?}"
        );
        assert!(
            error.to_string().starts_with(&format!("the tree: node 0 has the radius {radius}")),
            "{error}"
        );
    }
    for off in [-1, 1, isize::MIN] {
        let error = synth.clone().with_radius(Radii(0.1, off)).synthesize(1).expect_err("wrong length");
        assert!(matches!(error, SynthesisError::Skeleton(SkeletonError::Length { array: "radii", .. })));
    }
}

/// Breaks off at a call.
struct BreakAt {
    call: usize,
    calls: AtomicUsize,
}

impl BreakAt {
    fn new(call: usize) -> Self {
        Self { call, calls: AtomicUsize::new(0) }
    }
}

impl Observer for BreakAt {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        assert!((0.0..=1.0).contains(&progress.fraction));
        let call = self.calls.fetch_add(1, Ordering::SeqCst);
        assert!(call <= self.call, "asked again after breaking off");
        if call == self.call { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Cancels at every call until there is none left. Returns how many there were.
fn cancel_everywhere(work: impl Fn(&dyn Observer) -> bool) -> usize {
    (0..10_000).find(|&call| !work(&BreakAt::new(call))).expect("an end")
}

fn three_stages() -> TreeSynth {
    TreeSynth::new(PoissonYao::new(plot(6.0, 6.0)).with_nodes(20_000))
        .stage(trunk())
        .stage(Stage::new(Bend::constant(0.1), InShape::poisson_disc(Sphere::new(Vec3::Y * 4.0, 1.5), 20)))
        .stage(Stage::new(Bend::piecewise(0.5, 0.0, 1), HopSurface::new(2, 30)))
}

#[test]
fn work_can_be_cancelled_at_every_step() {
    let synth = three_stages();
    let whole = synth.synthesize(3).expect("a tree");
    let calls = cancel_everywhere(|observer| match synth.synthesize_observed(3, observer) {
        Err(error) => {
            assert_eq!(error, SynthesisError::Cancelled);
            assert_eq!(error.to_string(), "cancelled by the observer");
            true
        }
        Ok(tree) => {
            assert_eq!(tree, whole);
            false
        }
    });
    assert!(calls > 10, "only {calls} reports");
    let cloud =
        (0..3000).map(|i| Vec3::new((i % 19) as f32, (i / 19 % 17) as f32, (i / 323) as f32)).collect();
    let builders: [Box<dyn GraphBuilder>; 4] = [
        Box::new(PoissonYao::new(plot(6.0, 6.0)).with_nodes(5000)),
        Box::new(Lattice::new(plot(6.0, 6.0), 0.4)),
        Box::new(PointCloud::new(cloud, Edges::Nearest(6))),
        Box::new(PoissonYao::new(plot(6.0, 6.0)).with_nodes(5000).planar()),
    ];
    for builder in builders {
        let calls = cancel_everywhere(|observer| match builder.build(1, observer) {
            Err(error) => error == GraphError::Cancelled,
            Ok(_) => false,
        });
        assert!(calls >= 2);
    }
}

/// A search that was cancelled can be begun again in the same memory.
#[test]
fn a_cancelled_search_is_as_good_as_new() {
    let graph = cube_graph(20_000, 4);
    let synth = three_stages();
    let expected = synth.grow(&mut Search::new(&graph), 3, &Silent).expect("a tree");
    let search = std::cell::RefCell::new(Search::new(&graph));
    cancel_everywhere(|observer| {
        let cancelled = synth.grow(&mut search.borrow_mut(), 3, observer) == Err(SynthesisError::Cancelled);
        assert_eq!(synth.grow(&mut search.borrow_mut(), 3, &Silent).as_ref(), Ok(&expected));
        cancelled
    });
}

/// Leans every source a little more at every stage.
struct Lean;

impl GuidingRule for Lean {
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        step.vector
    }
    fn source(&self, source: &Source) -> Vec3 {
        source.vector + Vec3::X * 0.5
    }
}

/// "After `Break` the work ends with its error `Cancelled`, and nothing it was given has changed."
#[test]
fn a_cancelled_stage_changes_nothing() {
    let graph = cube_graph(3000, 4);
    let crown = Sphere::new(Vec3::Y * 3.0, 2.0);
    let synth = TreeSynth::new(PoissonYao::new(plot(6.0, 6.0)))
        .stage(trunk())
        .stage(Stage::new(Lean, InShape::uniform(crown, 20)));
    let mut search = Search::new(&graph);
    synth.grow_stage(&mut search, 0, 3, &Silent).expect("a trunk");
    let before = search.tree().to_vec();
    let mut fresh = search.clone();
    synth.grow_stage(&mut fresh, 1, 3, &Silent).expect("limbs");
    let calls = cancel_everywhere(|observer| {
        let mut search = search.clone();
        if synth.grow_stage(&mut search, 1, 3, observer).is_ok() {
            return false;
        }
        assert_eq!(search.tree(), before);
        synth.grow_stage(&mut search, 1, 3, &Silent).expect("limbs");
        assert_eq!(search.tree(), fresh.tree(), "begun again, the stage grew something else");
        true
    });
    assert!(calls >= 2);
}
