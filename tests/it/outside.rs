//! Every public trait, implemented outside of the crate and put together.

use crate::sample::{Named, cube_graph, plot};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use treesynth::glam::Vec3;
use treesynth::guided::{
    Bend, Count, Edge, EndpointError, FollowField, Graph, GraphError, HopSurface, InShape, NearestTo,
    PoissonYao, Search, Source, Stage, StageView, Step, Within,
};
use treesynth::radius::RadiusError;
use treesynth::rand::RngExt;
use treesynth::random::Purpose;
use treesynth::{
    Bounds, EndpointPolicy, GraphBuilder, GuidingRule, Observer, ParameterError, Progress, RadiusModel,
    Shape, Silent, Skeleton, SynthesisError, TreeSynth, VectorField, WeightFn, Work,
};

/// Storeys of nodes on a circle, each linked to its neighbours, to the middle and to the storey above.
struct Tower {
    storeys: u32,
}

const SIDES: u32 = 7;

impl GraphBuilder for Tower {
    fn build(&self, seed: u64, _: &dyn Observer) -> Result<Graph, GraphError> {
        let mut random = treesynth::random::stream(seed, 0, Purpose::CUSTOM, 0);
        let per_storey = SIDES + 1;
        let mut positions = Vec::new();
        let mut edges = Vec::new();
        for storey in 0..self.storeys {
            let middle = storey * per_storey;
            positions.push(Vec3::Y * storey as f32 * 0.5);
            for side in 0..SIDES {
                let turn =
                    (side as f32 + random.random::<f32>() * 0.5) / SIDES as f32 * std::f32::consts::TAU;
                let (sin, cos) = treesynth::math::sin_cos(turn);
                positions.push(Vec3::new(cos, storey as f32 * 0.5 + 0.1, sin));
                let (node, next) = (middle + 1 + side, middle + 1 + (side + 1) % SIDES);
                edges.extend([(node, next), (next, node), (middle, node), (node, middle)]);
            }
            if storey + 1 < self.storeys {
                edges.extend((middle..middle + per_storey).map(|node| (node, node + per_storey)));
            }
        }
        Graph::new(positions, &edges, 0)
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(self.storeys > 0, "Tower.storeys", self.storeys, "at least 1")
    }
}

/// Swings about the trunk, more with every hop.
struct Swing {
    strength: f32,
}

impl GuidingRule for Swing {
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        let around = Vec3::Y.cross(step.position_of(step.source()) - step.root() + step.edge);
        let draw = step.random(Purpose::CUSTOM, step.source()) - 0.5;
        step.vector + around * self.strength * draw * step.hops as f32
    }

    fn source(&self, source: &Source) -> Vec3 {
        assert!(source.vector.is_normalized());
        source.vector + Vec3::Y * 0.1 * source.stage as f32
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(self.strength.is_finite(), "Swing.strength", self.strength, "finite")
    }
}

/// Thin air is dear.
struct Altitude {
    per_metre: f32,
}

impl WeightFn for Altitude {
    fn weight(&self, edge: &Edge) -> f32 {
        edge.guided() + edge.length * 0.1 + edge.end.y.max(0.0) * self.per_metre
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(self.per_metre >= 0.0, "Altitude.per_metre", self.per_metre, "at least 0")
    }
}

/// The dearest nodes that can be reached.
struct Dearest {
    count: usize,
}

impl EndpointPolicy for Dearest {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        let mut nodes = view.candidates(|_, position| position.is_finite());
        if nodes.len() < self.count {
            return Err(EndpointError::TooFew { wanted: self.count, available: nodes.len(), place: "dear" });
        }
        let cost = |node: u32| view.search().cost(node).expect("reachable");
        nodes.sort_by(|&a, &b| cost(b).total_cmp(&cost(a)).then(a.cmp(&b)));
        nodes.truncate(self.count);
        Ok(nodes)
    }

    fn needs_search(&self) -> bool {
        true
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(self.count > 0, "Dearest.count", self.count, "at least 1")
    }
}

/// Thinner with every hop from the root.
struct Thinning {
    foot: f32,
}

impl RadiusModel for Thinning {
    fn radii(&self, skeleton: &Skeleton) -> Result<Vec<f32>, RadiusError> {
        let mut radii = vec![self.foot; skeleton.len()];
        for (node, parent) in skeleton.edges() {
            radii[node] = radii[parent] * 0.9;
        }
        Ok(radii)
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(self.foot > 0.0, "Thinning.foot", self.foot, "above 0")
    }
}

/// A wedge: the higher, the narrower along X.
struct Wedge {
    height: f32,
}

impl Shape for Wedge {
    fn contains(&self, point: Vec3) -> bool {
        self.bounds().contains(point) && point.x.abs() * self.height <= 2.0 * (self.height - point.y)
    }

    fn bounds(&self) -> Bounds {
        Bounds::new(Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, self.height, 2.0))
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(self.height > 0.0, "Wedge.height", self.height, "above 0")
    }
}

/// Away from the middle plane.
struct Part {
    strength: f32,
}

impl VectorField for Part {
    fn at(&self, point: Vec3) -> Vec3 {
        Vec3::new(point.x * self.strength, 1.0, 0.0)
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(self.strength.is_finite(), "Part.strength", self.strength, "finite")
    }
}

/// Remembers what it was told.
#[derive(Default)]
struct Log {
    entries: Mutex<Vec<Progress>>,
}

impl Observer for Log {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        self.entries.lock().expect("no panics").push(progress);
        ControlFlow::Continue(())
    }
}

static TOWER: Tower = Tower { storeys: 20 };
static SWING: Swing = Swing { strength: 0.3 };
static ALTITUDE: Altitude = Altitude { per_metre: 0.05 };
static DEAREST: Dearest = Dearest { count: 5 };
static THINNING: Thinning = Thinning { foot: 0.2 };
static WEDGE: Wedge = Wedge { height: 6.0 };
static PART: Part = Part { strength: 0.5 };

/// Everything by reference.
fn borrowed() -> TreeSynth {
    TreeSynth::new(&TOWER)
        .stage(Stage::new(&SWING, &DEAREST).with_weight(&ALTITUDE))
        .stage(Stage::new(FollowField::new(&PART), InShape::uniform(&WEDGE, Count::UpTo(12))))
        .stage(Stage::new(&SWING, &DEAREST).with_weight(Within::new(&ALTITUDE, &WEDGE, 2.0)))
        .with_radius(&THINNING)
}

/// The same in boxes of traits.
fn boxed() -> TreeSynth {
    let rule = || Box::new(Swing { strength: 0.3 }) as Box<dyn GuidingRule>;
    let policy = || Box::new(Dearest { count: 5 }) as Box<dyn EndpointPolicy>;
    let weight = || Box::new(Altitude { per_metre: 0.05 }) as Box<dyn WeightFn>;
    let shape = || Box::new(Wedge { height: 6.0 }) as Box<dyn Shape>;
    let field = Box::new(Part { strength: 0.5 }) as Box<dyn VectorField>;
    TreeSynth::new(Box::new(Tower { storeys: 20 }) as Box<dyn GraphBuilder>)
        .stage(Stage::new(rule(), policy()).with_weight(weight()))
        .stage(Stage::new(FollowField::new(field), InShape::uniform(shape(), Count::UpTo(12))))
        .stage(Stage::new(rule(), policy()).with_weight(Within::new(weight(), shape(), 2.0)))
        .with_radius(Box::new(Thinning { foot: 0.2 }) as Box<dyn RadiusModel>)
}

/// The same, shared.
fn shared() -> TreeSynth {
    let rule: Arc<dyn GuidingRule> = Arc::new(Swing { strength: 0.3 });
    let policy: Arc<dyn EndpointPolicy> = Arc::new(Dearest { count: 5 });
    let weight: Arc<dyn WeightFn> = Arc::new(Altitude { per_metre: 0.05 });
    let shape: Arc<dyn Shape> = Arc::new(Wedge { height: 6.0 });
    let field: Arc<dyn VectorField> = Arc::new(Part { strength: 0.5 });
    let graph: Arc<dyn GraphBuilder> = Arc::new(Tower { storeys: 20 });
    let radius: Arc<dyn RadiusModel> = Arc::new(Thinning { foot: 0.2 });
    TreeSynth::new(graph)
        .stage(Stage::new(Arc::clone(&rule), Arc::clone(&policy)).with_weight(Arc::clone(&weight)))
        .stage(Stage::new(FollowField::new(field), InShape::uniform(Arc::clone(&shape), Count::UpTo(12))))
        .stage(Stage::new(rule, policy).with_weight(Within::new(weight, shape, 2.0)))
        .with_radius(radius)
}

#[test]
fn all_traits_from_outside_in_one_tree() {
    let tree = borrowed().synthesize(5).expect("a tree in the tower");
    assert!(tree.len() > 20 && tree.tips().count() > 5);
    assert_eq!(tree.check(), Ok(()));
    assert_eq!(tree.stages().iter().max(), Some(&2));
    assert_eq!(tree.radii()[0], 0.2);
    assert!(tree.edges().all(|(node, parent)| tree.radii()[node] == tree.radii()[parent] * 0.9));
    assert_eq!(boxed().synthesize(5).as_ref(), Ok(&tree));
    assert_eq!(shared().synthesize(5).as_ref(), Ok(&tree));
    assert_ne!(borrowed().synthesize(6).as_ref(), Ok(&tree));
}

#[test]
fn pointers_to_pointers_too() {
    let synth = TreeSynth::new(Arc::new(Box::new(&TOWER)))
        .stage(
            Stage::new(Box::new(Arc::new(&SWING)), Arc::new(Box::new(&DEAREST)))
                .with_weight(Box::new(&ALTITUDE)),
        )
        .with_radius(Arc::new(&THINNING));
    let plain = TreeSynth::new(&TOWER)
        .stage(Stage::new(&SWING, &DEAREST).with_weight(&ALTITUDE))
        .with_radius(&THINNING);
    assert_eq!(synth.synthesize(1).expect("a tree"), plain.synthesize(1).expect("a tree"));
}

/// Pointers pass `check`, `forbids` and `needs_search` on, not their defaults.
#[test]
fn checks_go_through_pointers() {
    let refused = |synth: TreeSynth, parameter: &str| {
        assert_eq!(synth.check().expect_err(parameter).parameter, parameter);
        let Err(SynthesisError::Parameter(error)) = synth.synthesize(1) else { panic!("{parameter}") };
        assert_eq!(error.parameter, parameter);
    };
    let stage = || Stage::new(&SWING, &DEAREST);
    refused(TreeSynth::new(Arc::new(Tower { storeys: 0 })).stage(stage()), "Tower.storeys");
    let with = |stage| TreeSynth::new(&TOWER).stage(stage);
    refused(with(Stage::new(Box::new(Swing { strength: f32::NAN }), &DEAREST)), "Swing.strength");
    refused(with(Stage::new(&SWING, Arc::new(Dearest { count: 0 }))), "Dearest.count");
    refused(with(stage().with_weight(Box::new(Altitude { per_metre: -1.0 }))), "Altitude.per_metre");
    refused(with(stage()).with_radius(Box::new(Thinning { foot: 0.0 })), "Thinning.foot");
    let wedge = || Arc::new(Wedge { height: -1.0 });
    refused(with(Stage::new(&SWING, InShape::uniform(wedge(), 3))), "Wedge.height");
    refused(TreeSynth::new(PoissonYao::new(wedge())).stage(stage()), "Wedge.height");
    let part = Arc::new(Part { strength: f32::INFINITY });
    refused(with(Stage::new(FollowField::new(part), &DEAREST)), "Part.strength");
    let obstacle: Arc<dyn WeightFn> = Arc::new(Within::obstacle(&ALTITUDE, &WEDGE));
    assert!(obstacle.forbids() && !(&ALTITUDE as &dyn WeightFn).forbids());
    assert!((Box::new(&DEAREST) as Box<dyn EndpointPolicy>).needs_search());
}

/// A shape of one's own as the region.
#[test]
fn outside_shapes_hold_graphs() {
    let builder = PoissonYao::new(&WEDGE).with_nodes(4000);
    let graph = builder.build(2, &Silent).expect("a wedge is not empty");
    assert!(graph.nodes().abs_diff(4000) < 400, "{}", graph.nodes());
    assert!(graph.positions().iter().all(|&p| WEDGE.contains(p)));
    let tree = borrowed().with_graph(builder).synthesize(2).expect("a tree in the wedge");
    assert!(tree.positions().iter().all(|&p| WEDGE.contains(p)));
}

#[test]
fn observers_hear_all_work_to_its_end() {
    let log = Log::default();
    let synth = borrowed().with_graph(PoissonYao::new(plot(6.0, 6.0)).with_nodes(40_000));
    let tree = synth.synthesize_observed(1, &log).expect("a tree");
    assert_eq!(synth.synthesize(1).as_ref(), Ok(&tree), "watching changes nothing");
    let entries = log.entries.into_inner().expect("no panics");
    let mut kinds: Vec<Work> = Vec::new();
    for pair in entries.windows(2) {
        let same = pair[0].work == pair[1].work;
        assert!(
            if same { pair[0].fraction <= pair[1].fraction } else { pair[0].fraction == 1.0 },
            "{pair:?}"
        );
    }
    for entry in &entries {
        if kinds.last() != Some(&entry.work) {
            kinds.push(entry.work);
        }
    }
    let stage = |index| Work::Stage { index, of: 3 };
    assert_eq!(kinds, [Work::Nodes, Work::Edges, stage(0), stage(1), stage(2), Work::Radii]);
    assert_eq!(entries.last().map(|entry| entry.fraction), Some(1.0));
    // A closure is an observer too.
    let calls = AtomicUsize::new(0);
    let count = |_: Progress| {
        calls.fetch_add(1, Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    synth.synthesize_observed(1, &count).expect("a tree");
    assert_eq!(calls.load(Ordering::Relaxed), entries.len());
}

/// One graph, four trees at a time.
#[test]
fn threads_share_a_graph() {
    let graph = cube_graph(6000, 9);
    let fork = || Bend::random(0.5, 1.5, 0.0, 1);
    let synth = TreeSynth::new(PoissonYao::new(plot(6.0, 6.0)))
        .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 4.0)))
        .stage(Stage::new(fork(), InShape::poisson_disc(&WEDGE, 25)))
        .stage(Stage::new(&SWING, HopSurface::new(2, 60)).with_weight(&ALTITUDE));
    // Nothing has been asked of the graph yet, so that what it works out once is worked out by several at once.
    let fresh = || graph.clone();
    for _ in 0..3 {
        let graph = fresh();
        let threads: Vec<Skeleton> = std::thread::scope(|scope| {
            let (synth, graph) = (&synth, &graph);
            let work = |seed| move || synth.synthesize_on(graph, seed).expect("a tree");
            let handles: Vec<_> = (0..4).map(|seed| scope.spawn(work(seed))).collect();
            handles.into_iter().map(|handle| handle.join().expect("no panics")).collect()
        });
        let graph = fresh();
        let alone: Vec<_> = (0..4).map(|seed| synth.synthesize_on(&graph, seed).expect("a tree")).collect();
        assert_eq!(threads, alone);
        assert!(alone.windows(2).all(|pair| pair[0] != pair[1]));
    }
}

/// Memory that is used again holds nothing of the tree before.
#[test]
fn searches_can_be_used_again() {
    let graph = TOWER.build(5, &Silent).expect("a tower");
    let synth = borrowed();
    let mut search = Search::new(&graph);
    let expected = Search::new(&graph);
    for seed in [5, 1, 5, 9] {
        let again = synth.grow(&mut search, seed, &Silent).expect("a tree");
        let fresh = synth.grow(&mut expected.clone(), seed, &Silent).expect("a tree");
        assert_eq!(again, fresh);
        assert_eq!(Ok(&again.skeleton), synth.synthesize_on(&graph, seed).as_ref());
        // Places of the tree's nodes in its graph.
        assert_eq!(again.nodes, search.tree());
        let positions: Vec<Vec3> = again.nodes.iter().map(|&node| graph.position(node)).collect();
        assert_eq!(again.skeleton.positions(), &positions[..]);
        assert_eq!(again.endpoints.len(), 3);
        assert!(again.endpoints.iter().flatten().all(|node| again.nodes.contains(node)));
        let stages = again.endpoints.iter().enumerate().all(|(stage, endpoints)| {
            endpoints
                .iter()
                .all(|&node| again.skeleton.stages()[search.place(node).expect("joined")] <= stage as u16)
        });
        assert!(stages, "an endpoint joined after its stage");
    }
    let twice = TreeSynth::new(&TOWER).stage(Stage::new(&SWING, Named(vec![20]))).synthesize(1);
    assert!(twice.is_ok_and(|tree| tree.len() > 1));
}
