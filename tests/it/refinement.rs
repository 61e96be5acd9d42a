//! A stage on a finer graph around the tree: what that graph is, and what it does to the tree.

use std::collections::BTreeSet;
use treesynth::glam::Vec3;
use treesynth::guided::{
    Bend, Count, EndpointError, HopSurface, InShape, NearestTo, PoissonYao, Refinement, Search, Stage,
    StageView, TreeSynth,
};
use treesynth::shape::{Cuboid, Ellipsoid};
use treesynth::{EndpointPolicy, GraphBuilder, Silent, SynthesisError, testing};

const COARSE: f32 = 0.3;
const FINE: f32 = 0.12;
const REACH: u32 = 4;

struct Nothing;

impl EndpointPolicy for Nothing {
    fn select(&self, _: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        Ok(Vec::new())
    }
}

fn region() -> Cuboid {
    Cuboid::new(Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 6.0, 3.0))
}

fn refinement() -> Refinement<Cuboid> {
    Refinement::new(region(), FINE).with_reach(REACH)
}

fn limbs() -> TreeSynth {
    let crown = Ellipsoid::new(Vec3::Y * 3.8, Vec3::splat(1.5));
    TreeSynth::new(PoissonYao::new(region()).with_spacing(COARSE))
        .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 4.0)))
        .stage(Stage::new(Bend::piecewise(1.0, 0.0, 1), InShape::poisson_disc(crown, 12)))
}

#[test]
fn the_finer_graph_is_a_yao_graph_around_the_tree_and_holds_it() {
    for seed in 1..4 {
        let synth = limbs().stage(Stage::new(Bend::none(), Nothing).with_refinement(refinement()));
        let coarse = synth.build_graph(seed, &Silent).unwrap();
        let mut search = Search::new(&coarse);
        for stage in 0..2 {
            synth.grow_stage(&mut search, stage, seed, &Silent).unwrap();
        }
        let old: Vec<Vec3> = search.tree().iter().map(|&node| coarse.position(node)).collect();
        synth.grow_stage(&mut search, 2, seed, &Silent).unwrap();
        let (graph, tree) = (search.graph(), search.tree());
        assert_eq!(graph.root(), 0);
        assert_eq!(graph.position(0), old[0]);
        assert!(tree.len() > 2 * old.len(), "{} nodes from {}", tree.len(), old.len());
        assert_eq!(tree, (0..tree.len() as u32).collect::<Vec<_>>());

        // Memory grows with the tree, not with the space.
        let uniform = PoissonYao::new(region()).with_spacing(FINE).build(seed, &Silent).unwrap();
        assert!(graph.nodes() * 3 < uniform.nodes(), "{} of {}", graph.nodes(), uniform.nodes());

        let at = |node: usize| graph.positions()[node];
        // A voxel of two spacings, half its diagonal on either side, and a node's place in its own.
        let reach = REACH as f32 * 1.3 * FINE + 2.0 * 3f32.sqrt() * FINE;
        for node in tree.len()..graph.nodes() {
            let nearest = |range: std::ops::Range<usize>| {
                range.filter(|&i| i != node).map(|i| at(i).distance(at(node))).fold(f32::INFINITY, f32::min)
            };
            assert!(nearest(0..graph.nodes()) >= FINE * 0.999_99, "node {node} keeps its distance");
            assert!(nearest(0..tree.len()) <= reach, "node {node} is around the tree");
            assert!((0.0..=6.0).contains(&at(node).y), "node {node} is in the region");
        }
        for node in 0..graph.nodes() {
            let mut nearest = [(f32::INFINITY, 0u32); 8];
            for other in (0..graph.nodes()).filter(|&other| other != node) {
                let to = at(other) - at(node);
                let octant =
                    usize::from(to.x < 0.0) | usize::from(to.y < 0.0) << 1 | usize::from(to.z < 0.0) << 2;
                if (to.length_squared(), other as u32) < nearest[octant] {
                    nearest[octant] = (to.length_squared(), other as u32);
                }
            }
            let longest = (3.0 * FINE) * (3.0 * FINE);
            let mut expected: BTreeSet<u32> = nearest
                .iter()
                .filter(|&&(distance, _)| distance <= longest)
                .map(|&(_, other)| other)
                .collect();
            expected.extend(tree.iter().filter(|&&child| search.parent(child) == Some(node as u32)));
            let found: BTreeSet<u32> = graph.neighbours(node as u32).iter().copied().collect();
            assert_eq!(found, expected, "node {node}");
        }
    }
}

/// Turning per metre along the axes of the limbs, in radians.
fn crookedness(search: &Search<'_>) -> f64 {
    let at = |node: u32| search.graph().position(node).as_dvec3();
    let (mut turned, mut length) = (0.0, 0.0);
    for &node in search.tree() {
        let Some(parent) = search.parent(node) else { continue };
        let way = at(node) - at(parent);
        length += way.length();
        if let Some(before) = search.parent(parent) {
            turned += way.angle_between(at(parent) - at(before));
        }
    }
    turned / length
}

#[test]
fn limbs_become_smooth() {
    let synth = |passes: u32| {
        let refinement = refinement().with_relaxation(passes);
        limbs().stage(Stage::new(Bend::none(), Nothing).with_refinement(refinement))
    };
    let coarse = synth(2).build_graph(5, &Silent).unwrap();
    let after = |synth: &TreeSynth, stages: usize| {
        let mut search = Search::new(&coarse);
        for stage in 0..stages {
            synth.grow_stage(&mut search, stage, 5, &Silent).unwrap();
        }
        crookedness(&search)
    };
    let before = after(&synth(2), 2);
    let relaxed = after(&synth(2), 3);
    // Forks count too, and they keep their angles.
    assert!(relaxed < 0.75 * before, "{before} to {relaxed} radians per metre");
    assert!(relaxed < 0.9 * after(&synth(0), 3));
}

#[test]
fn stages_go_on_as_ever() {
    let twigs = |count| Stage::new(Bend::piecewise(0.5, 0.0, 1), HopSurface::new(3, Count::UpTo(count)));
    let synth = limbs()
        .stage(twigs(60).with_refinement(refinement()))
        .stage(twigs(200).with_refinement(Refinement::new(region(), FINE * 0.6)))
        .stage(twigs(200));
    let graph = synth.build_graph(3, &Silent).unwrap();
    testing::check_synth(&synth, &graph, 3).unwrap();
    let mut search = Search::new(&graph);
    let growth = synth.grow(&mut search, 3, &Silent).unwrap();
    let finer = growth.graph.as_ref().expect("refined");
    assert_eq!(finer.nodes(), search.graph().nodes());
    assert_eq!(growth.endpoints.iter().map(Vec::len).collect::<Vec<_>>(), [1, 12, 60, 200, 200]);
    // The first trunk's end is still the end of the trunk, and where it was.
    let top = growth.endpoints[0][0];
    let coarse = NearestTo::new(Vec3::Y * 4.0);
    let alone = limbs().first_stages(1).stage(Stage::new(Bend::none(), coarse));
    let first = alone.grow(&mut Search::new(&graph), 3, &Silent);
    let place = growth.nodes.iter().position(|&node| node == top).expect("in the tree");
    assert_eq!(growth.skeleton.stages()[place], 0);
    if let Ok(first) = first {
        let end = graph.position(first.endpoints[0][0]);
        assert!(finer.position(top).distance(end) < COARSE, "moved by relaxing alone");
    }
    // A search that is used again begins on the coarse graph.
    search.reset();
    assert_eq!(search.graph().nodes(), graph.nodes());
    assert_eq!(search.tree(), [graph.root()]);
}

#[test]
fn a_stage_that_failed_can_be_tried_again() {
    let twigs = |count: usize| Stage::new(Bend::piecewise(0.5, 0.0, 1), HopSurface::new(3, count));
    let wanting = |count| limbs().stage(twigs(count).with_refinement(refinement()));
    let graph = wanting(60).build_graph(3, &Silent).unwrap();
    let mut search = Search::new(&graph);
    for stage in 0..2 {
        wanting(60).grow_stage(&mut search, stage, 3, &Silent).unwrap();
    }
    let before = search.tree().to_vec();
    assert!(wanting(9_999_999).grow_stage(&mut search, 2, 3, &Silent).is_err());
    assert_eq!((search.tree(), search.graph().nodes()), (&*before, graph.nodes()));
    let endpoints = wanting(60).grow_stage(&mut search, 2, 3, &Silent).unwrap();
    let growth = wanting(60).grow(&mut Search::new(&graph), 3, &Silent).unwrap();
    assert_eq!(endpoints, growth.endpoints[2]);
    // A single stage is checked as a whole synthesis is.
    let bad = limbs().stage(twigs(5).with_refinement(Refinement::new(region(), -1.0)));
    assert!(matches!(bad.grow_stage(&mut search, 2, 3, &Silent), Err(SynthesisError::Parameter(_))));
    let bad = limbs().stage(Stage::new(Bend::constant(30.0), Nothing));
    let error = bad.grow_stage(&mut search, 2, 3, &Silent).expect_err("degrees").to_string();
    assert!(error.contains("Bend.angle is 30"), "{error}");
}

#[test]
fn bad_options_are_named() {
    let with = |refinement: Refinement<Cuboid>| {
        limbs().stage(Stage::new(Bend::none(), Nothing).with_refinement(refinement)).synthesize(1)
    };
    for (refinement, name) in [
        (Refinement::new(region(), 0.0), "Refinement.spacing"),
        (Refinement::new(region(), -1.0), "Refinement.spacing"),
        (Refinement::new(region(), f32::NAN), "Refinement.spacing"),
        (Refinement::new(region(), f32::INFINITY), "Refinement.spacing"),
        (Refinement::new(region(), 1e-30), "Refinement.spacing"),
        (Refinement::new(region(), 1e-9), "Refinement.spacing"),
        (Refinement::new(region(), 1e-5), "Refinement.spacing"),
        (Refinement::new(region(), 3e-4), "Refinement.spacing"),
        (Refinement::new(Cuboid::centered(Vec3::X * 50.0, Vec3::splat(2.0)), 0.1), "Refinement.region"),
        (refinement().with_reach(0), "Refinement.reach"),
        (refinement().with_reach(25), "Refinement.reach"),
        (refinement().with_relaxation(1001), "Refinement.relaxation"),
    ] {
        match with(refinement) {
            Err(SynthesisError::Parameter(error)) => assert_eq!(error.parameter, name),
            other => panic!("{name}: {other:?}"),
        }
    }
}

#[test]
fn without_refinements_it_is_as_if_none_had_been_asked_for() {
    let twigs = || Stage::new(Bend::none(), HopSurface::new(3, Count::UpTo(100)));
    let (refined, plain) = (limbs().stage(twigs().with_refinement(refinement())), limbs().stage(twigs()));
    assert!(refined.refines() && !plain.refines());
    let stripped = refined.without_refinements();
    assert!(!stripped.refines());
    assert_eq!(stripped.synthesize(5).unwrap(), plain.synthesize(5).unwrap());
}
