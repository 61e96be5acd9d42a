//! Least-cost paths (section 3.1.2) against petgraph's Dijkstra on the weights as they were fixed.

use crate::sample::{AfterSearch, Nothing, Uphill, cases, cube_graph, degrees, plot, uphill};
use petgraph::algo::dijkstra;
use petgraph::graph::{DiGraph, NodeIndex};
use proptest::prelude::*;
use std::collections::BTreeSet;
use std::sync::Arc;
use treesynth::glam::Vec3;
use treesynth::guided::{
    Bend, Count, Graph, Guided, HopSurface, InShape, Jitter, Length, NearestTo, Search, Side, Stage,
    TreeSynth, Within,
};
use treesynth::shape::{Ellipsoid, Sphere};
use treesynth::{EndpointPolicy, Shape, Silent, WeightFn};

/// (start, end, guiding vector of the start) to cost.
type Formula = fn(Vec3, Vec3, Vec3) -> f32;

/// "The weight of an edge E is d (1 - e·v)", written down once more.
fn paper(start: Vec3, end: Vec3, vector: Vec3) -> f32 {
    let d = start.distance(end);
    let e = (end - start) / d;
    let weight = d * (1.0 - e.dot(vector));
    if weight > 0.0 { weight } else { 0.0 }
}

fn length(start: Vec3, end: Vec3, _: Vec3) -> f32 {
    start.distance(end)
}

const POST: Sphere = Sphere::new(Vec3::new(0.4, 1.5, 0.0), 0.9);

/// The paper's weight, and infinite for edges whose end or middle is in a ball.
fn around_post(start: Vec3, end: Vec3, vector: Vec3) -> f32 {
    let blocked = POST.contains(end) || POST.contains(start + (end - start) * 0.5);
    if blocked { f32::INFINITY } else { paper(start, end, vector) }
}

fn weights() -> [(Arc<dyn WeightFn>, Formula); 4] {
    [
        (Arc::new(Guided), paper),
        (Arc::new(Length), length),
        (Arc::new(Uphill), uphill),
        (Arc::new(Within::obstacle(Guided, POST)), around_post),
    ]
}

/// Costs from `sources`, by petgraph, over the edges of nodes whose vectors `search` has fixed.
fn costs(search: &Search<'_>, sources: &[u32], formula: Formula) -> Vec<f32> {
    let graph = search.graph();
    let mut net = DiGraph::<(), f32>::new();
    let nodes: Vec<NodeIndex> = (0..graph.nodes()).map(|_| net.add_node(())).collect();
    let start = net.add_node(());
    for &source in sources {
        net.add_edge(start, nodes[source as usize], 0.0);
    }
    for from in 0..graph.nodes() as u32 {
        let Some(vector) = search.vector(from) else { continue };
        for &to in graph.neighbours(from) {
            let weight = formula(graph.position(from), graph.position(to), vector);
            net.add_edge(nodes[from as usize], nodes[to as usize], weight);
        }
    }
    let found = dijkstra(&net, start, None, |edge| *edge.weight());
    nodes.iter().map(|node| found.get(node).copied().unwrap_or(f32::INFINITY)).collect()
}

/// Runs one stage and holds its costs against petgraph's. Returns its endpoints.
fn check_stage(
    synth: &TreeSynth,
    search: &mut Search<'_>,
    stage: usize,
    seed: u64,
    formula: Formula,
) -> Vec<u32> {
    let sources = search.tree().to_vec();
    let was_on_tree: BTreeSet<u32> = sources.iter().copied().collect();
    let chosen = synth.grow_stage(search, stage, seed, &Silent).expect("endpoints enough");
    let expected = costs(search, &sources, formula);
    let mut compared = 0;
    for node in 0..search.graph().nodes() as u32 {
        if search.is_on_tree(node) {
            assert!(search.cost(node).is_none_or(|cost| cost == 0.0));
        } else if let Some(cost) = search.cost(node) {
            assert_eq!(cost.to_bits(), expected[node as usize].to_bits(), "stage {stage}, node {node}");
            compared += 1;
        } else if search.is_complete() {
            assert_eq!(expected[node as usize], f32::INFINITY, "node {node} was not reached");
        }
    }
    assert!(!search.is_complete() || compared > search.graph().nodes() / 3);
    // A path that has joined costs nothing now; its edges add up to the least cost.
    for &endpoint in &chosen {
        let mut path = vec![endpoint];
        while !was_on_tree.contains(&path[path.len() - 1]) {
            path.push(search.parent(path[path.len() - 1]).expect("a path to the tree"));
        }
        let cost = path.windows(2).rev().fold(0.0, |cost, edge| {
            let [to, from] = [edge[0], edge[1]];
            assert!(search.graph().neighbours(from).contains(&to) && search.is_on_tree(to));
            let vector = search.vector(from).expect("settled");
            cost + formula(search.graph().position(from), search.graph().position(to), vector)
        });
        assert_eq!(cost.to_bits(), expected[endpoint as usize].to_bits(), "endpoint {endpoint}");
    }
    chosen
}

fn synth(policies: [Arc<dyn EndpointPolicy>; 3], weight: &Arc<dyn WeightFn>) -> TreeSynth {
    let rules = [
        Jitter::new(Bend::none(), 0.1),
        Jitter::new(Bend::random(degrees(30.0), degrees(120.0), 0.0, 1), 0.0),
        Jitter::new(Bend::piecewise(degrees(30.0), degrees(-4.0), 3), 0.4),
    ];
    let mut synth = TreeSynth::new(treesynth::guided::PoissonYao::new(plot(6.0, 6.0)));
    for (policy, rule) in policies.into_iter().zip(rules) {
        synth = synth.stage(Stage::new(rule, policy).with_weight(Arc::clone(weight)));
    }
    synth.stage(Stage::new(Bend::constant(degrees(5.0)), Nothing).with_weight(Arc::clone(weight)))
}

fn crown() -> Ellipsoid {
    Ellipsoid::new(Vec3::Y * 3.6, Vec3::new(2.0, 1.6, 2.0))
}

/// Policies that let a search stop early.
fn early() -> [Arc<dyn EndpointPolicy>; 3] {
    [
        Arc::new(NearestTo::new(Vec3::Y * 4.0)),
        Arc::new(InShape::poisson_disc(crown(), Count::UpTo(12))),
        Arc::new(HopSurface::new(2, Count::UpTo(25))),
    ]
}

/// The same, told to wait.
fn late() -> [Arc<dyn EndpointPolicy>; 3] {
    early().map(|policy| Arc::new(AfterSearch(policy)) as Arc<dyn EndpointPolicy>)
}

fn check_tree(graph: &Graph, seed: u64, policies: [Arc<dyn EndpointPolicy>; 3], which: usize) {
    let (weight, formula) = &weights()[which];
    let synth = synth(policies, weight);
    let mut search = Search::new(graph);
    for stage in 0..synth.stages().len() {
        check_stage(&synth, &mut search, stage, seed, *formula);
    }
    assert!(search.is_complete() && search.tree().len() > 10);
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn costs_of_whole_searches_are_petgraphs(seed: u64, nodes in 300usize..1500, which in 0usize..4) {
        check_tree(&cube_graph(nodes, seed), seed, late(), which);
    }

    #[test]
    fn costs_of_stopped_searches_are_petgraphs(seed: u64, nodes in 300usize..1500, which in 0usize..4) {
        check_tree(&cube_graph(nodes, seed), seed, early(), which);
    }

    #[test]
    fn stopping_early_changes_nothing(seed: u64, nodes in 300usize..1500, which in 0usize..3) {
        let graph = cube_graph(nodes, seed);
        let (weight, _) = &weights()[which];
        let (stopped, whole) = (synth(early(), weight), synth(late(), weight));
        let (mut short, mut long) = (Search::new(&graph), Search::new(&graph));
        let mut stops = 0;
        for stage in 0..3 {
            let chosen = stopped.grow_stage(&mut short, stage, seed, &Silent).expect("endpoints enough");
            prop_assert_eq!(&chosen, &whole.grow_stage(&mut long, stage, seed, &Silent).expect("as many"));
            prop_assert!(long.is_complete());
            stops += usize::from(!short.is_complete());
            for node in (0..graph.nodes() as u32).filter(|&node| short.is_settled(node)) {
                prop_assert_eq!(short.cost(node), long.cost(node));
                prop_assert_eq!(short.vector(node), long.vector(node));
                prop_assert_eq!(short.parent(node), long.parent(node));
                prop_assert_eq!(short.hops(node), long.hops(node));
            }
            prop_assert_eq!(short.tree(), long.tree());
        }
        prop_assert!(stops > 0, "no search stopped early: nothing was compared");
        prop_assert_eq!(stopped.synthesize_on(&graph, seed), whole.synthesize_on(&graph, seed));
    }
}

#[test]
fn sides_of_the_surface_need_the_search_and_its_costs_hold() {
    for side in [Side::Lower, Side::Higher] {
        let policies: [Arc<dyn EndpointPolicy>; 3] = [
            Arc::new(NearestTo::new(Vec3::Y * 4.0)),
            Arc::new(HopSurface::new(3, Count::UpTo(10)).only(side)),
            Arc::new(HopSurface::new(1, Count::UpTo(20)).only(side)),
        ];
        check_tree(&cube_graph(1000, 3), 3, policies, 0);
    }
}

/// One run with the numbers of section 4, so that sizes do not hide anything.
#[test]
fn costs_in_a_large_graph_are_petgraphs() {
    let graph = cube_graph(20_000, 1);
    for which in [0, 2] {
        check_tree(&graph, 9, early(), which);
    }
}

/// With plain lengths, and only with them, costs are the distances that geometry bounds from below.
#[test]
fn plain_lengths_are_at_least_the_distance() {
    let graph = cube_graph(2000, 5);
    let synth = TreeSynth::new(treesynth::guided::PoissonYao::new(plot(6.0, 6.0)))
        .stage(Stage::new(Bend::none(), Nothing).with_weight(Length));
    let mut search = Search::new(&graph);
    synth.grow_stage(&mut search, 0, 1, &Silent).expect("nothing can fail");
    for node in 0..graph.nodes() as u32 {
        let cost = search.cost(node).expect("all of a Yao graph in a box is reached");
        let straight = graph.position(node).length();
        assert!(cost >= straight * 0.99999 && cost <= straight * 2.0, "node {node}: {cost} for {straight}");
    }
}
