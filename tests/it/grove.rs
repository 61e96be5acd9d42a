//! Several trees in one graph: they share no node, give way to each other, and are each a tree.

use proptest::prelude::*;
use std::collections::BTreeMap;
use treesynth::glam::{IVec3, Vec2, Vec3};
use treesynth::guided::{
    AboveEachRoot, AroundEachRoot, Bend, ByTree, Count, GradedYao, Graph, GraphError, Growth, Guided,
    HopSurface, Leader, LimbSurface, NearSurface, PoissonYao, Refinement, Search, Stage, Territory,
    TreeSynth,
};
use treesynth::shape::{Cuboid, Ellipsoid};
use treesynth::{GraphBuilder, Silent, Skeleton, SynthesisError, testing};

const CROWN: Vec3 = Vec3::new(2.6, 2.4, 2.6);

fn crown() -> Ellipsoid {
    Ellipsoid::new(Vec3::Y * 5.0, CROWN)
}

/// Five by four, two and a half metres apart, so that the crowns would overlap by half.
fn feet() -> Vec<Vec3> {
    (0..20).map(|i| Vec3::new((i % 5) as f32 * 2.5 - 5.0, 0.0, (i / 5) as f32 * 2.5 - 3.75)).collect()
}

fn plot() -> Cuboid {
    Cuboid::new(Vec3::new(-8.5, 0.0, -7.5), Vec3::new(8.5, 8.5, 7.5))
}

fn rules() -> ByTree {
    (0..20).fold(ByTree::new(), |rules, i| {
        rules.then(Bend::piecewise((35.0 + 2.0 * i as f32).to_radians(), 0.0, 1).with_hop_length(0.25))
    })
}

fn stages(synth: TreeSynth, feet: &[Vec3]) -> TreeSynth {
    let own = |stage: Stage| stage.with_weight(Territory::new(Guided, feet, 0.5));
    let twig = || Bend::piecewise(0.5, 0.0, 1).with_hop_length(0.25);
    let along = |hops, spacing| LimbSurface::new(hops, spacing).with_hop_length(0.25).with_least_order(1);
    synth
        .stage(own(Stage::new(rules(), AroundEachRoot::new(crown(), Count::UpTo(30)))))
        .stage(own(Stage::new(twig(), along(3, 0.5))))
        .stage(own(Stage::new(twig(), along(2, 0.4))))
}

fn graph_of(feet: Vec<Vec3>) -> PoissonYao<Cuboid> {
    PoissonYao::new(plot())
        .with_nodes(300_000)
        .with_roots(feet)
        .with_leader(Leader::new(Vec3::ZERO, Vec3::Y * 6.0))
}

fn grown(synth: &TreeSynth, graph: &Graph, seed: u64) -> Vec<Growth> {
    synth.grow_all(&mut Search::new(graph), seed, &Silent).expect("trees")
}

/// Andrew's monotone chain.
fn hull(points: impl Iterator<Item = Vec2>) -> Vec<Vec2> {
    let mut points: Vec<Vec2> = points.collect();
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |points: &mut dyn Iterator<Item = &Vec2>| {
        let mut chain: Vec<Vec2> = Vec::new();
        for &p in points {
            while chain.len() > 1
                && (chain[chain.len() - 1] - chain[chain.len() - 2]).perp_dot(p - chain[chain.len() - 1])
                    <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let (lower, upper) = (half(&mut points.iter()), half(&mut points.iter().rev()));
    [lower, upper].concat()
}

fn is_in(hull: &[Vec2], p: Vec2) -> bool {
    (0..hull.len()).all(|i| (hull[(i + 1) % hull.len()] - hull[i]).perp_dot(p - hull[i]) >= 0.0)
}

/// Of the area that the crowns' convex hulls cover from above, the share that more than one covers.
fn overlap(trees: &[Skeleton]) -> f32 {
    let crown =
        |tree: &Skeleton| hull(tree.positions().iter().filter(|p| p.y > 2.0).map(|p| Vec2::new(p.x, p.z)));
    let hulls: Vec<Vec<Vec2>> = trees.iter().map(crown).collect();
    let (mut once, mut more) = (0, 0);
    for i in 0..170 * 150 {
        let p = Vec2::new((i % 170) as f32 * 0.1 - 8.45, (i / 170) as f32 * 0.1 - 7.45);
        let count = hulls.iter().filter(|hull| is_in(hull, p)).count();
        once += usize::from(count > 0);
        more += usize::from(count > 1);
    }
    more as f32 / once as f32
}

/// Of the cubes of half a metre that the crowns reach into, the share that more than one does.
fn shared_room(trees: &[Skeleton]) -> f32 {
    let mut cubes: BTreeMap<[i32; 3], Vec<usize>> = BTreeMap::new();
    for (number, tree) in trees.iter().enumerate() {
        for place in tree.positions().iter().filter(|p| p.y > 2.0) {
            let cube = (*place / 0.5).floor().as_ivec3().to_array();
            let owners = cubes.entry(cube).or_default();
            if owners.last() != Some(&number) {
                owners.push(number);
            }
        }
    }
    cubes.values().filter(|owners| owners.len() > 1).count() as f32 / cubes.len() as f32
}

/// For each tree the least distance of its crown to another's; the mean and the least.
fn gaps(trees: &[Skeleton]) -> (f32, f32) {
    let cube = |p: Vec3| (p / 0.6).floor().as_ivec3();
    let mut cubes: BTreeMap<[i32; 3], Vec<(usize, Vec3)>> = BTreeMap::new();
    for (number, tree) in trees.iter().enumerate() {
        for &p in tree.positions() {
            cubes.entry(cube(p).to_array()).or_default().push((number, p));
        }
    }
    let gap = |(number, tree): (usize, &Skeleton)| {
        let mut least = 0.6f32;
        for &p in tree.positions() {
            for i in 0..27 {
                let near = cube(p) + IVec3::new(i % 3, i / 3 % 3, i / 9) - 1;
                for &(other, q) in cubes.get(&near.to_array()).into_iter().flatten() {
                    if other != number {
                        least = least.min(p.distance(q));
                    }
                }
            }
        }
        least
    };
    let gaps: Vec<f32> = trees.iter().enumerate().map(gap).collect();
    (gaps.iter().sum::<f32>() / gaps.len() as f32, gaps.iter().copied().fold(f32::INFINITY, f32::min))
}

#[test]
fn twenty_trees_give_way_to_each_other() {
    for seed in 1..4 {
        let builder = graph_of(feet());
        let spacing = builder.spacing().expect("a sound region");
        let synth = stages(TreeSynth::new(builder), &feet());
        let graph = synth.build_graph(seed, &Silent).expect("a graph");
        assert!((280_000..320_000).contains(&graph.nodes()), "{} nodes", graph.nodes());
        let growths = grown(&synth, &graph, seed);
        assert_eq!(growths.len(), 20);
        check_grove(&graph, &growths);
        let together: Vec<Skeleton> = growths.into_iter().map(|growth| growth.skeleton).collect();
        for (tree, foot) in together.iter().zip(feet()) {
            assert_eq!(tree.positions()[0], foot);
            assert!(tree.tips().count() > 60, "{} tips at {foot}", tree.tips().count());
        }
        // Each alone in a graph of its own, as fine and as wide as a tree needs.
        let lonely = |foot: Vec3| {
            let around = Cuboid::new(foot + Vec3::new(-3.6, 0.0, -3.6), foot + Vec3::new(3.6, 8.5, 3.6));
            let leader = Leader::new(Vec3::ZERO, Vec3::Y * 6.0);
            let graph = PoissonYao::new(around).with_spacing(spacing).with_root(foot).with_leader(leader);
            stages(TreeSynth::new(graph), &[foot]).synthesize(seed).expect("a tree")
        };
        let alone: Vec<Skeleton> = feet().into_iter().map(lonely).collect();
        let measures = [&together, &alone].map(|trees| (overlap(trees), shared_room(trees), gaps(trees)));
        let [(area, room, (gap, least)), (area_alone, room_alone, (gap_alone, _))] = measures;
        println!(
            "seed {seed}: hulls overlap by {area} of their area (alone {area_alone}), rooms by {room} ({room_alone}); \
             gap {gap} m, at least {least} ({gap_alone}); spacing {spacing}"
        );
        assert!(area < 0.5 * area_alone, "{area} of the hulls' area, {area_alone} alone");
        assert!(room < 0.4 * room_alone, "{room} of the room, {room_alone} alone");
        assert!(least >= spacing * 0.999 && gap > gap_alone, "{gap} m, at least {least}; {gap_alone} alone");
    }
}

/// No node in two trees, every skeleton sound, endpoints on their trees.
fn check_grove(graph: &Graph, growths: &[Growth]) {
    let mut all: Vec<u32> = growths.iter().flat_map(|growth| growth.nodes.iter().copied()).collect();
    let count = all.len();
    all.sort_unstable();
    all.dedup();
    assert_eq!(all.len(), count, "a node is in two trees");
    for growth in growths {
        let graph = growth.graph.as_deref().unwrap_or(graph);
        testing::check_skeleton(&growth.skeleton).expect("a sound skeleton");
        assert_eq!(growth.nodes.len(), growth.skeleton.len());
        for (&node, &place) in growth.nodes.iter().zip(growth.skeleton.positions()) {
            assert_eq!(graph.position(node), place);
        }
        for node in growth.endpoints.iter().flatten() {
            assert!(growth.nodes.contains(node), "endpoint {node} is on its tree");
        }
    }
}

fn small(feet: &[Vec3], nodes: usize) -> PoissonYao<Cuboid> {
    let region = Cuboid::new(Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 5.0, 3.0));
    PoissonYao::new(region).with_nodes(nodes).with_roots(feet)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn groves_are_sound(
        seed: u64,
        places in prop::collection::btree_set((-2i8..=2, -2i8..=2), 1..7),
        led: bool,
        refined: bool,
        nodes in 1500usize..5000,
    ) {
        let feet: Vec<Vec3> = places.iter().map(|&(x, z)| Vec3::new(f32::from(x), 0.0, f32::from(z))).collect();
        let builder = small(&feet, nodes);
        let region = Cuboid::new(Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 5.0, 3.0));
        let rule = ByTree::new().then(Bend::constant(0.1)).then(Bend::piecewise(1.0, 0.0, 1));
        let twigs = Stage::new(Bend::piecewise(0.5, 0.0, 1), HopSurface::new(2, Count::UpTo(40)));
        let twigs = if refined { twigs.with_refinement(Refinement::new(region, 0.15).with_reach(3)) } else { twigs };
        let synth = if led {
            TreeSynth::new(builder.with_leader(Leader::new(Vec3::ZERO, Vec3::Y * 3.0)))
        } else {
            TreeSynth::new(builder).stage(Stage::new(Bend::none(), AboveEachRoot::new(3.0)))
        };
        let crown = Ellipsoid::new(Vec3::Y * 3.0, Vec3::splat(1.2));
        let synth = synth.stage(Stage::new(rule, AroundEachRoot::new(crown, Count::UpTo(8)))).stage(twigs);
        let grow = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| {
                let graph = synth.build_graph(seed, &Silent).expect("a graph");
                let growths = grown(&synth, &graph, seed);
                (graph, growths)
            })
        };
        let (graph, growths) = grow(1);
        prop_assert_eq!(growths.len(), feet.len());
        check_grove(&graph, &growths);
        for (growth, &foot) in growths.iter().zip(&feet) {
            prop_assert_eq!(growth.skeleton.positions()[0], foot);
            if led {
                let trunk = growth.skeleton.positions().iter().map(|p| p.y).fold(0.0, f32::max);
                prop_assert!(trunk >= 2.999, "a leader at every root: {trunk}");
            }
        }
        let (graph_again, again) = grow(2);
        prop_assert_eq!(graph, graph_again);
        prop_assert_eq!(growths, again);
    }
}

#[test]
fn roots_that_cannot_be_are_named() {
    let refused = |feet: &[Vec3]| small(feet, 3000).build(1, &Silent).expect_err("no graph");
    for (feet, named) in [
        (vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Z * 0.05], ["number 1", "number 2"]),
        (vec![Vec3::X, Vec3::ZERO, Vec3::X], ["number 0", "number 2"]),
    ] {
        match refused(&feet) {
            GraphError::Parameter(error) => {
                assert_eq!(error.parameter, "PoissonYao.roots");
                assert!(named.iter().all(|name| error.value.contains(name)), "{error}");
            }
            other => panic!("{other}"),
        }
    }
    assert_eq!(refused(&[Vec3::ZERO, Vec3::X * 9.0]), GraphError::RootOutside { root: Vec3::X * 9.0 });
    assert!(refused(&[]).to_string().contains("PoissonYao.roots is 0"));
    let led = small(&[Vec3::ZERO, Vec3::X * 9.0], 3000).with_leader(Leader::new(Vec3::ZERO, Vec3::Y));
    assert_eq!(led.build(1, &Silent), Err(GraphError::RootOutside { root: Vec3::X * 9.0 }));
    // One tree where there are two roots.
    let synth = TreeSynth::new(small(&[Vec3::ZERO, Vec3::X], 3000))
        .stage(Stage::new(Bend::none(), AboveEachRoot::new(2.0)));
    assert!(matches!(synth.synthesize(1), Err(SynthesisError::Parameter(_))));
}

/// Leaders of their own, and trees that stand beside bare roots.
#[test]
fn each_root_has_its_leader() {
    let feet = [Vec3::new(-1.5, 0.0, 0.0), Vec3::ZERO, Vec3::new(1.5, 0.0, 0.0)];
    let leader =
        |height: f32| Leader::new(Vec3::X * 50.0, Vec3::new(50.0, height, 0.0)).with_waywardness(0.05);
    let graph =
        small(&feet, 4000).with_leaders([leader(2.0), leader(3.0)]).build(3, &Silent).expect("a graph");
    let tops = |graph: &Graph| -> Vec<f32> {
        let trees = grown(&TreeSynth::new(small(&feet, 9)).stage(nothing()), graph, 1);
        trees.iter().map(|tree| tree.skeleton.positions().iter().map(|p| p.y).fold(0.0, f32::max)).collect()
    };
    assert_eq!(tops(&graph), [2.0, 3.0, 3.0]);
    // They stray each in a way of its own.
    let trees = grown(&TreeSynth::new(small(&feet, 9)).stage(nothing()), &graph, 1);
    let shape =
        |i: usize| -> Vec<Vec3> { trees[i].skeleton.positions().iter().map(|&p| p - feet[i]).collect() };
    assert_ne!(shape(1), shape(2));
    let drawn = leader(4.0).skeleton(1, 0.3).expect("a trunk");
    let drawn = drawn.clone().with_positions(drawn.positions().iter().map(|&p| p - Vec3::X * 50.0).collect());
    let beside = small(&feet[..1], 4000).with_tree(drawn.expect("moved")).build(3, &Silent).expect("a graph");
    assert_eq!(tops(&beside), [0.0, 4.0]);
}

fn nothing() -> Stage {
    Stage::new(Bend::none(), HopSurface::new(1, 1).with_outermost(1e-9)).with_endpoints(Nothing)
}

struct Nothing;

impl treesynth::EndpointPolicy for Nothing {
    fn select(
        &self,
        _: &treesynth::guided::StageView<'_>,
    ) -> Result<Vec<u32>, treesynth::guided::EndpointError> {
        Ok(Vec::new())
    }
}

/// On a graph of varying spacing a leader is as straight as it says, and the graph as sound as without.
#[test]
fn leaders_stand_in_graded_graphs() {
    let sizing = || NearSurface::new(Ellipsoid::new(Vec3::Y * 3.5, Vec3::splat(1.5)), 0.12, 0.4, 1.5);
    let region = Cuboid::new(Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 6.0, 3.0));
    let feet = [Vec3::new(-1.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 0.5)];
    for seed in 1..6 {
        let builder = GradedYao::new(region, sizing())
            .with_roots(feet)
            .with_leader(Leader::new(Vec3::ZERO, Vec3::Y * 5.0));
        testing::check_builder(&builder, seed).expect("a sound graph");
        let graph = builder.build(seed, &Silent).expect("a graph");
        let spacing = builder.spacing().expect("a sound region");
        let trees = grown(&TreeSynth::new(builder).stage(nothing()), &graph, seed);
        let mut trunks = 0;
        for (tree, foot) in trees.iter().zip(feet) {
            trunks += tree.skeleton.len();
            let stray = |p: &Vec3| (*p - foot).with_y(0.0).length();
            let sweep = tree.skeleton.positions().iter().map(stray).fold(0.0, f32::max) / 5.0;
            assert!(sweep <= 0.02, "sweep {sweep}");
            for (node, parent) in tree.skeleton.edges() {
                let (p, q) = (tree.skeleton.positions()[node], tree.skeleton.positions()[parent]);
                assert!(p.distance(q) < 1.6 * spacing.at(p).max(spacing.at(q)), "{} m", p.distance(q));
            }
        }
        for node in trunks..graph.nodes() {
            let p = graph.positions()[node];
            let apart = |q: &Vec3| p.distance(*q) >= 0.9999 * spacing.at(p).min(spacing.at(*q));
            assert!(graph.positions()[..node].iter().all(apart), "node {node} keeps its distance");
        }
        assert_eq!(graph.unreachable(), 0);
    }
    let near = GradedYao::new(region, sizing()).with_roots([Vec3::ZERO, Vec3::X * 0.05]).build(1, &Silent);
    assert!(near.expect_err("too near").to_string().starts_with("GradedYao.roots is"));
}

/// The presets that are finest at the crown's surface have straight trunks.
#[test]
fn graded_presets_have_straight_trunks() {
    for name in ["graded-ash", "graded-elm"] {
        let synth = treesynth::presets::by_name(name).expect("a preset").guided().unwrap().synth(40_000);
        for seed in 1..6 {
            let tree = synth.synthesize(seed).expect("a tree");
            let own: Vec<Vec3> =
                (0..tree.len()).filter(|&i| tree.stages()[i] == 0).map(|i| tree.positions()[i]).collect();
            let top = own.iter().copied().max_by(|a, b| a.y.total_cmp(&b.y)).expect("nodes");
            let off = |p: &Vec3| (*p - top * (p.dot(top) / top.length_squared())).length();
            let sweep = own.iter().map(off).fold(0.0, f32::max) / top.length();
            assert!(sweep <= 0.021, "{name}, seed {seed}: {sweep}");
        }
    }
}
