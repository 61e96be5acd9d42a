//! Regions without room, roots that lead nowhere, and graphs that are none.

use crate::sample::{Named, built, plot};
use proptest::prelude::*;
use treesynth::glam::Vec3;
use treesynth::guided::{
    Bend, Count, Edges, EndpointError, GradedYao, Graph, GraphBuilder, GraphError, HopSurface, InShape,
    Lattice, NearSurface, NearestTo, PointCloud, PoissonYao, SearchError, SizingFn, Stage, TreeSynth,
};
use treesynth::shape::{Cuboid, Difference, Intersection, Sphere};
use treesynth::{Bounds, EndpointPolicy, Shape, Silent, SynthesisError};

fn nothing() -> Intersection<Sphere, Sphere> {
    Intersection::new(Sphere::new(Vec3::X * 5.0, 1.0), Sphere::new(Vec3::NEG_X * 5.0, 1.0))
}

/// Empty too, but its bounds do not show it.
fn hidden_nothing() -> Difference<Sphere, Cuboid> {
    Difference::new(Sphere::new(Vec3::Y, 1.0), plot(3.0, 3.0))
}

fn build_error(builder: &dyn GraphBuilder) -> GraphError {
    match builder.check() {
        Err(error) => error.into(),
        Ok(()) => builder.build(1, &Silent).expect_err("a graph of nothing"),
    }
}

#[test]
fn empty_regions() {
    let shapes = || [Box::new(nothing()) as Box<dyn Shape>, Box::new(hidden_nothing())];
    for shape in shapes() {
        let error = build_error(&PoissonYao::new(shape).with_nodes(100));
        let GraphError::Parameter(error) = error else { panic!("{error:?}") };
        assert_eq!(error.parameter, "PoissonYao.region");
        assert!(error.to_string().starts_with("PoissonYao.region is 0.0, but must be a shape whose volume"));
    }
    for shape in shapes() {
        let error = build_error(&PoissonYao::new(shape).with_spacing(0.1));
        assert_eq!(error, GraphError::RootOutside { root: Vec3::ZERO });
        assert!(error.to_string().contains("outside of the region"));
    }
    for shape in shapes() {
        assert_eq!(build_error(&Lattice::new(shape, 0.1)), GraphError::Empty);
    }
    let graded = |sizes: f32| GradedYao::new(hidden_nothing(), SizingFn::new(move |_| sizes));
    for builder in [graded(0.1), graded(1.0).with_nodes(100)] {
        let GraphError::Parameter(error) = build_error(&builder) else { panic!("{builder:?}") };
        assert_eq!(error.parameter, "GradedYao.root");
    }
    // In the plane z = 0 there is nothing of this one.
    let behind = Sphere::new(Vec3::Z * 9.0, 1.0);
    let error = build_error(&PoissonYao::new(behind).with_nodes(100).planar());
    assert!(error.to_string().starts_with("PoissonYao.region is 0.0"), "{error}");
    let flat = Lattice::new(behind, 0.2).with_edges(Edges::PlanarYao(8));
    assert_eq!(build_error(&flat), GraphError::Empty);
}

#[test]
fn roots_outside_of_the_region() {
    for root in [Vec3::Y * 9.0, Vec3::NEG_Y * 1e-3, Vec3::splat(1e30), Vec3::splat(-3e38)] {
        let builder = PoissonYao::new(plot(4.0, 4.0)).with_nodes(100).with_root(root);
        let error = TreeSynth::new(builder).stage(trunk()).synthesize(1).expect_err("a root in the air");
        assert_eq!(error, SynthesisError::Graph(GraphError::RootOutside { root }));
        assert!(
            error.to_string().contains(&format!("PoissonYao.root is {root}, outside of the region")),
            "{error}"
        );
    }
}

/// Shapes from outside that lie about their bounds.
struct Lies(Bounds);

impl Shape for Lies {
    fn contains(&self, _: Vec3) -> bool {
        true
    }
    fn bounds(&self) -> Bounds {
        self.0
    }
}

#[test]
fn impossible_bounds() {
    let bounds = [
        Bounds::EMPTY,
        Bounds::new(Vec3::NAN, Vec3::NAN),
        Bounds::new(Vec3::NEG_INFINITY, Vec3::INFINITY),
        Bounds::new(Vec3::ZERO, Vec3::splat(f32::MAX)),
        Bounds::new(Vec3::ONE, Vec3::ZERO),
        Bounds::new(Vec3::ZERO, Vec3::new(1.0, f32::NAN, 1.0)),
        Bounds::new(Vec3::ZERO, Vec3::ZERO),
    ];
    for bounds in bounds {
        for planar in [false, true] {
            let plane = |builder: PoissonYao<Lies>| if planar { builder.planar() } else { builder };
            // An error or a graph, but an end.
            let _ = plane(PoissonYao::new(Lies(bounds)).with_nodes(100)).build(1, &Silent);
            let _ = plane(PoissonYao::new(Lies(bounds)).with_spacing(0.5)).build(1, &Silent);
        }
        let _ = Lattice::new(Lies(bounds), 0.5).build(1, &Silent);
        let _ = GradedYao::new(Lies(bounds), SizingFn::new(|_| 0.5)).build(1, &Silent);
        let near = NearSurface::new(Lies(bounds), 0.1, 1.0, 1.0);
        let _ = GradedYao::new(plot(2.0, 2.0), near).with_nodes(50).build(1, &Silent);
    }
}

fn trunk() -> Stage {
    Stage::new(Bend::none(), NearestTo::new(Vec3::Y))
}

fn endpoints_error(policy: impl EndpointPolicy + 'static) -> (EndpointError, String) {
    let synth = TreeSynth::new(PoissonYao::new(plot(4.0, 4.0)).with_nodes(400))
        .stage(trunk())
        .stage(Stage::new(Bend::none(), policy));
    match synth.synthesize(1) {
        Err(error @ SynthesisError::Endpoints { stage: 1, .. }) => {
            let text = error.to_string();
            let SynthesisError::Endpoints { error, .. } = error else { unreachable!() };
            (error, text)
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn endpoints_where_there_are_none() {
    for count in [Count::Exactly(7), Count::UpTo(7), Count::Share(0.5), Count::Each(0.5)] {
        let wanted = if count == Count::Exactly(7) { 7 } else { 1 };
        let policies: [Box<dyn EndpointPolicy>; 4] = [
            Box::new(InShape::uniform(nothing(), count)),
            Box::new(InShape::poisson_disc(hidden_nothing(), count)),
            Box::new(InShape::poisson_disc(Sphere::new(Vec3::X * 1000.0, 3.0), count)),
            Box::new(HopSurface::new(1000, count)),
        ];
        for policy in policies {
            let (error, text) = endpoints_error(policy);
            let EndpointError::TooFew { wanted: found, available: 0, .. } = error else {
                panic!("{error:?}")
            };
            assert_eq!(found, wanted);
            let expected = format!("stage 1: {wanted} endpoints are wanted, but only 0 candidate nodes are ");
            assert!(text.starts_with(&expected), "{text}");
        }
    }
}

#[test]
fn more_endpoints_than_candidates() {
    for wanted in [401, usize::MAX] {
        let everywhere = Sphere::new(Vec3::ZERO, 100.0);
        for policy in [InShape::uniform(everywhere, wanted), InShape::poisson_disc(everywhere, wanted)] {
            let (error, text) = endpoints_error(policy);
            let EndpointError::TooFew { wanted: found, available, .. } = error else { panic!("{error:?}") };
            assert!(found == wanted && (350..401).contains(&available), "{error:?}");
            assert!(text.contains(&wanted.to_string()) && text.contains(&available.to_string()), "{text}");
        }
        let (error, _) = endpoints_error(HopSurface::new(1, wanted));
        assert!(matches!(error, EndpointError::TooFew { available, .. } if available > 0), "{error:?}");
    }
}

/// On a graph of the user's.
fn grow(graph: &Graph, policy: impl EndpointPolicy + 'static) -> Result<usize, SynthesisError> {
    let synth =
        TreeSynth::new(PoissonYao::new(plot(1.0, 1.0))).stage(Stage::new(Bend::constant(0.1), policy));
    synth.synthesize_on(graph, 1).map(|tree| tree.len())
}

fn too_few(result: &Result<usize, SynthesisError>) -> bool {
    let none = |error: &EndpointError| matches!(error, EndpointError::TooFew { available: 0, .. });
    matches!(result, Err(SynthesisError::Endpoints { stage: 0, error }) if none(error))
}

#[test]
fn roots_that_lead_nowhere() {
    let everywhere = || Sphere::new(Vec3::ZERO, 100.0);
    let positions = vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0];
    // One node, and a root without edges of its own.
    let one = Graph::new(vec![Vec3::ZERO], &[], 0).expect("one node is a graph");
    let closed = Graph::new(positions, &[(1, 0), (1, 2), (2, 1)], 0).expect("a graph");
    for graph in [&one, &closed] {
        assert!(too_few(&grow(graph, NearestTo::new(Vec3::Y))));
        assert!(too_few(&grow(graph, InShape::uniform(everywhere(), 1))));
        assert!(too_few(&grow(graph, InShape::poisson_disc(everywhere(), Count::UpTo(5)))));
        assert!(too_few(&grow(graph, HopSurface::new(1, 1))));
        assert_eq!(grow(graph, Named(vec![0])), Ok(1), "the root alone is a tree");
    }
    let error = grow(&closed, Named(vec![2])).expect_err("unreachable");
    assert_eq!(error, SynthesisError::Search(SearchError::Unreachable { stage: 0, node: 2 }));
    assert_eq!(error.to_string(), "stage 0: no path leads from the tree to the endpoint 2");
}

fn new_error(positions: &[Vec3], edges: &[(u32, u32)], root: u32) -> (GraphError, String) {
    let error = Graph::new(positions.to_vec(), edges, root).expect_err("not a graph");
    let text = error.to_string();
    (error, text)
}

#[test]
fn graphs_of_the_users() {
    let line: Vec<Vec3> = (0..4).map(|i| Vec3::Y * i as f32).collect();
    assert_eq!(new_error(&[], &[], 0).0, GraphError::Empty);
    for root in [4, u32::MAX] {
        let (error, text) = new_error(&line, &[(0, 1)], root);
        assert_eq!(error, GraphError::Root { root, nodes: 4 });
        assert_eq!(text, format!("the root is node {root}, but there are 4 nodes"));
    }
    for (from, to) in [(0, 4), (4, 0), (u32::MAX, 1), (2, u32::MAX)] {
        let (error, text) = new_error(&line, &[(0, 1), (from, to)], 0);
        assert_eq!(error, GraphError::Dangling { from, to, nodes: 4 });
        assert!(text.contains(&format!("edge {from} -> {to}")), "{text}");
    }
    let (error, text) = new_error(&line, &[(0, 1), (3, 3)], 0);
    assert_eq!(
        (error, text.as_str()),
        (GraphError::SelfEdge { node: 3 }, "edge 3 -> 3 leads back to its own node")
    );
    let (error, text) = new_error(&line, &[(2, 3), (0, 1), (2, 3)], 0);
    assert_eq!(
        (error, text.as_str()),
        (GraphError::Duplicate { from: 2, to: 3 }, "edge 2 -> 3 is there twice")
    );
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.1e9, -f32::MAX] {
        let mut positions = line.clone();
        positions[2].z = bad;
        let (error, text) = new_error(&positions, &[(0, 1)], 0);
        assert!(matches!(error, GraphError::Position { node: 2, .. }), "{error:?}");
        assert!(text.starts_with("node 2 has the position [0, 2, "), "{text}");
    }
    for apart in [0.0, f32::MIN_POSITIVE, 1e-30] {
        let mut positions = line.clone();
        positions[0].x = apart;
        positions[3] = Vec3::ZERO;
        let (error, text) = new_error(&positions, &[(0, 1), (3, 0)], 0);
        assert!(matches!(error, GraphError::Coincident { from: 3, to: 0, .. }), "{error:?}");
        assert!(text.starts_with("edge 3 -> 0 has no length"), "{text}");
    }
    // Nodes in one place are no harm as long as no edge joins them.
    let twins = Graph::new(vec![Vec3::ZERO, Vec3::Y, Vec3::Y], &[(0, 1), (0, 2)], 0).expect("a graph");
    assert_eq!(grow(&twins, Named(vec![1, 2])), Ok(3));
}

#[test]
fn clouds_of_the_users() {
    let edges = [Edges::Yao(8), Edges::Yao(12), Edges::PlanarYao(5), Edges::Nearest(3)];
    for edges in edges {
        assert_eq!(build_error(&PointCloud::new(Vec::new(), edges)), GraphError::Empty);
        let one = built(&PointCloud::new(vec![Vec3::ONE], edges), 1);
        assert_eq!((one.nodes(), one.edges(), one.root()), (1, 0, 0));
        for bad in [f32::NAN, f32::INFINITY, 2e9] {
            let error = build_error(&PointCloud::new(vec![Vec3::ZERO, Vec3::X * bad], edges));
            assert!(matches!(error, GraphError::Position { node: 1, .. }), "{error:?}");
        }
        // All in one place, twice each, and two among many.
        let same = vec![Vec3::ONE; 100];
        let twice: Vec<Vec3> = (0..100).map(|i| Vec3::new((i / 2) as f32, (i / 2 % 7) as f32, 0.0)).collect();
        let mut two: Vec<Vec3> = (0..500).map(|i| Vec3::new((i % 23) as f32, (i / 23) as f32, 0.0)).collect();
        two[400] = two[99];
        for points in [same, twice, two] {
            let error = build_error(&PointCloud::new(points, edges));
            assert!(matches!(error, GraphError::Coincident { .. }), "{error:?}");
        }
        // On a line, in a plane, and at both ends of what there is.
        let line = (0..300).map(|i| Vec3::Y * i as f32).collect();
        assert_eq!(built(&PointCloud::new(line, edges), 1).nodes(), 300);
        let plane = (0..900).map(|i| Vec3::new((i % 30) as f32, (i / 30) as f32, 0.0)).collect();
        assert_eq!(built(&PointCloud::new(plane, edges), 1).nodes(), 900);
        let far = vec![Vec3::splat(1e9), Vec3::splat(-1e9), Vec3::ZERO, Vec3::X * 1e-3];
        assert_eq!(built(&PointCloud::new(far, edges), 1).root(), 2);
    }
}

proptest! {
    /// Whatever the numbers: a graph that can be grown in, or an error.
    #[test]
    fn no_graph_is_trouble(
        points in prop::collection::vec(prop::array::uniform3(prop::num::f32::ANY), 0..8),
        edges in prop::collection::vec((0u32..9, 0u32..9), 0..20),
        root in 0u32..9,
        small: bool,
    ) {
        let sound = |x: f32| if small { (x % 100.0).clamp(-100.0, 100.0) } else { x };
        let points: Vec<Vec3> = points.iter().map(|p| Vec3::from_array(p.map(sound))).collect();
        if let Ok(graph) = Graph::new(points.clone(), &edges, root) {
            let _ = grow(&graph, NearestTo::new(Vec3::Y));
        }
        for edges in [Edges::Yao(8), Edges::PlanarYao(8), Edges::Yao(12), Edges::Nearest(2)] {
            if let Ok(graph) = PointCloud::new(points.clone(), edges).build(0, &Silent) {
                let _ = grow(&graph, NearestTo::new(Vec3::Y));
            }
        }
    }
}
