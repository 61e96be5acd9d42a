//! An edited tree is the tree that grows from nothing, to the bit.

use proptest::prelude::*;
use std::time::Instant;
use treesynth::glam::Vec3;
use treesynth::guided::{
    Apart, Bend, Count, Edge, EndpointError, ForkAngle, Graph, Growth, Guided, HopSurface, InShape, Lattice,
    Leader, Length, Multimodal, NearestTo, PoissonYao, Refinement, Regrowth, Search, Stage, StageView,
    TreeSynth, Within,
};
use treesynth::shape::{Cuboid, Ellipsoid, Sphere, Union};
use treesynth::{Bounds, EndpointPolicy, GraphBuilder, Shape, Silent, SynthesisError, WeightFn};

fn region() -> Cuboid {
    Cuboid::new(Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 4.0, 2.0))
}

/// Looks at the search, so that it goes to its end, and chooses what another policy does.
struct Whole<P>(P);

impl<P: EndpointPolicy> EndpointPolicy for Whole<P> {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        self.0.select(view)
    }
    fn needs_search(&self) -> bool {
        true
    }
}

/// Nodes that are nearest to places.
struct Places(Vec<Vec3>);

impl EndpointPolicy for Places {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        Ok(self
            .0
            .iter()
            .map(|&place| view.graph().nearest(place))
            .filter(|&node| view.is_reachable(node))
            .collect())
    }
    fn needs_search(&self) -> bool {
        true
    }
}

/// Many ways of one cost, and ways that cost nothing.
struct Steps(u32);

impl WeightFn for Steps {
    fn weight(&self, edge: &Edge<'_>) -> f32 {
        ((edge.from ^ edge.to) % self.0) as f32
    }
}

/// Weights by a number.
fn weigh(stage: Stage, which: u8, obstacle: Sphere) -> Stage {
    match which % 7 {
        0 => stage.with_weight(Within::obstacle(Guided, obstacle)),
        1 => stage.with_weight(Within::new(Length, obstacle, 3.0)),
        2 => stage.with_weight(Within::obstacle(Apart::new(Guided, 0.3), obstacle)),
        3 => stage.with_weight(Within::new(Multimodal::new().with_cone(0.8, 0.5), obstacle, 0.0)),
        4 => stage.with_weight(Within::new(Steps(2), obstacle, 2.0)),
        5 => stage.with_weight(Within::new(Steps(5), obstacle, 0.0)),
        _ => stage.with_weight(Within::new(Guided, obstacle, 1.5)),
    }
}

#[derive(Debug, Clone)]
struct Edit {
    places: Vec<Vec3>,
    crown: Vec3,
    obstacle: Vec3,
    twigs: usize,
    /// Number of the part that an edit changes.
    which: u8,
}

fn edits() -> impl Strategy<Value = Edit> {
    let place = || prop::array::uniform3(-1.8f32..1.8).prop_map(|p| Vec3::from_array(p) + Vec3::Y * 2.0);
    (prop::collection::vec(place(), 1..6), place(), place(), 1usize..40, any::<u8>())
        .prop_map(|(places, crown, obstacle, twigs, which)| Edit { places, crown, obstacle, twigs, which })
}

fn graph(lattice: bool, nodes: usize, seed: u64) -> Graph {
    if lattice {
        Lattice::new(region(), 0.4).build(seed, &Silent).expect("a graph")
    } else {
        PoissonYao::new(region()).with_nodes(nodes).build(seed, &Silent).expect("a graph")
    }
}

fn bits(v: Option<Vec3>) -> Option<[u32; 3]> {
    v.map(|v| v.to_array().map(f32::to_bits))
}

/// Trees, costs, ways and vectors of every stage are those of a pipeline that starts from nothing.
fn check_same(regrowth: &Regrowth<'_>, synth: &TreeSynth, graph: &Graph, seed: u64) {
    let mut search = Search::new(graph);
    let fresh = synth.grow_all(&mut search, seed, &Silent).expect("trees");
    assert_eq!(regrowth.trees(), fresh);
    search.reset();
    for stage in 0..synth.stages().len() {
        let before = search.tree().to_vec();
        synth.grow_stage(&mut search, stage, seed, &Silent).expect("a stage");
        let kept = regrowth.search(stage).expect("a stage");
        assert_eq!(kept.tree(), before, "stage {stage}");
        for node in 0..graph.nodes() as u32 {
            assert_eq!(kept.is_settled(node), search.is_settled(node), "node {node} in stage {stage}");
            if kept.is_settled(node) {
                assert_eq!(kept.parent(node), search.parent(node), "way to {node} in stage {stage}");
                assert_eq!(
                    bits(kept.vector(node)),
                    bits(search.vector(node)),
                    "vector of {node} in stage {stage}"
                );
                assert_eq!(kept.hops(node), search.hops(node));
                assert_eq!(kept.path_length(node).to_bits(), search.path_length(node).to_bits());
                // Joining sets the cost to 0.
                if !search.is_on_tree(node) {
                    let cost = |search: &Search<'_>| search.cost(node).map(f32::to_bits);
                    assert_eq!(cost(kept), cost(&search), "cost of {node} in stage {stage}");
                    assert_eq!(kept.source(node), search.source(node));
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(160))]
    #[test]
    fn edits_give_what_growing_anew_gives(
        seed: u64,
        lattice: bool,
        nodes in 300usize..1500,
        kinds in prop::array::uniform3(any::<u8>()),
        forks: bool,
        row in prop::collection::vec(edits(), 2..6),
    ) {
        let graph = graph(lattice, nodes, seed);
        let sphere = |edit: &Edit| Sphere::new(edit.obstacle, 0.5);
        let bend = |angle: f32| Bend::piecewise(angle, -0.1, 2);
        let crown = |edit: &Edit| InShape::poisson_disc(Sphere::new(edit.crown, 1.2), Count::UpTo(9));
        let first = &row[0];
        let stage = |number: usize, edit: &Edit| {
            let stage = match number {
                0 => Stage::new(Bend::none(), Places(edit.places.clone())),
                1 if forks => Stage::new(ForkAngle::new(1.0, bend(0.2)), Whole(crown(edit))),
                1 => Stage::new(bend(0.8), Whole(crown(edit))),
                _ => Stage::new(bend(0.4), Whole(HopSurface::new(2, Count::UpTo(edit.twigs)))),
            };
            weigh(stage, kinds[number], sphere(edit))
        };
        let mut stages: Vec<Stage> = (0..3).map(|number| stage(number, first)).collect();
        let synth = |stages: &[Stage]| TreeSynth::new(Lattice::new(region(), 1.0)).with_stages(stages);
        let grow = |synth: &TreeSynth| synth.grow_all(&mut Search::new(&graph), seed, &Silent);
        prop_assume!(grow(&synth(&stages)).is_ok());
        let mut regrowth = Regrowth::new(&synth(&stages), &graph, seed, &Silent).expect("trees");
        check_same(&regrowth, &synth(&stages), &graph, seed);
        let mut obstacle = first;
        for edit in &row[1..] {
            let before = stages.clone();
            let mut boxes: Vec<Bounds> = Vec::new();
            for number in 0..3 {
                if edit.which >> number & 1 == 1 {
                    // The endpoints alone.
                    stages[number] = match number {
                        0 => stages[0].clone().with_endpoints(Places(edit.places.clone())),
                        1 => stages[1].clone().with_endpoints(Whole(crown(edit))),
                        _ => stages[2].clone().with_endpoints(Whole(HopSurface::new(2, Count::UpTo(edit.twigs)))),
                    };
                }
            }
            if edit.which >> 3 & 1 == 1 {
                boxes = vec![sphere(obstacle).bounds(), sphere(edit).bounds()];
                for number in 0..3 {
                    stages[number] = weigh(stages[number].clone(), kinds[number], sphere(edit));
                }
            }
            let edited = synth(&stages);
            match grow(&edited) {
                Ok(_) => {
                    regrowth.regrow(&edited, &boxes, &Silent).expect("trees");
                    check_same(&regrowth, &edited, &graph, seed);
                    if edit.which >> 3 & 1 == 1 {
                        obstacle = edit;
                    }
                }
                Err(fresh) => {
                    let trees = regrowth.trees().to_vec();
                    let error = regrowth.regrow(&edited, &boxes, &Silent).expect_err("as from nothing");
                    prop_assert_eq!(error, fresh);
                    prop_assert_eq!(regrowth.trees(), trees);
                    stages = before;
                    regrowth.regrow(&synth(&stages), &[], &Silent).expect("what was");
                    check_same(&regrowth, &synth(&stages), &graph, seed);
                }
            }
        }
    }
}

#[test]
fn stages_come_and_go_and_refinements_are_refused() {
    let graph = graph(false, 1500, 1);
    let crown = || InShape::poisson_disc(Sphere::new(Vec3::Y * 2.5, 1.2), 9);
    let twigs = || Stage::new(Bend::constant(0.1), Whole(HopSurface::new(2, 20)));
    let synth = TreeSynth::new(Lattice::new(region(), 1.0))
        .stage(Stage::new(Bend::none(), Whole(NearestTo::new(Vec3::Y * 2.5))))
        .stage(Stage::new(Bend::constant(0.2), Whole(crown())));
    let mut tree = Regrowth::new(&synth, &graph, 1, &Silent).expect("a tree");
    let longer = synth.clone().stage(twigs()).stage(twigs());
    for synth in [&longer, &synth, &longer, &longer.clone().first_stages(3)] {
        tree.regrow(synth, &[], &Silent).expect("a tree");
        check_same(&tree, synth, &graph, 1);
    }
    let before = tree.trees().to_vec();
    tree.regrow(&longer.clone().first_stages(3), &[], &Silent).expect("a tree");
    assert_eq!(tree.searched_anew(), 0, "nothing has changed");
    assert_eq!(tree.trees(), before);
    let refined = synth.stage(twigs().with_refinement(Refinement::new(region(), 0.2)));
    let error = tree.regrow(&refined, &[], &Silent).expect_err("refused");
    assert!(
        matches!(&error, SynthesisError::Parameter(error) if error.parameter == "Stage.refinement"),
        "{error}"
    );
    assert_eq!(tree.trees(), before);
}

/// The share of nodes farther than so many metres from every limb that has come or gone that still have their parent.
fn share_kept(
    before: &[Growth],
    after: &[Growth],
    limbs: u16,
    beside: &dyn Fn(Vec3) -> bool,
    far: f32,
) -> f32 {
    let nodes = |growth: &Growth, most: u16| -> Vec<(u32, Vec3, u32)> {
        let tree = &growth.skeleton;
        (0..tree.len())
            .filter(|&i| tree.stages()[i] <= most)
            .map(|i| {
                (growth.nodes[i], tree.positions()[i], tree.parent(i).map_or(u32::MAX, |p| growth.nodes[p]))
            })
            .collect()
    };
    let (old, new) = (nodes(&before[0], limbs), nodes(&after[0], limbs));
    let moved: Vec<Vec3> = old
        .iter()
        .filter(|n| !new.contains(n))
        .chain(new.iter().filter(|n| !old.contains(n)))
        .map(|n| n.1)
        .collect();
    let elsewhere = |place: Vec3| !beside(place) && moved.iter().all(|other| other.distance(place) > far);
    let mut now: Vec<(u32, u32)> = nodes(&after[0], u16::MAX).into_iter().map(|n| (n.0, n.2)).collect();
    now.sort_unstable();
    let old: Vec<_> = nodes(&before[0], u16::MAX).into_iter().filter(|n| elsewhere(n.1)).collect();
    old.iter().filter(|n| now.binary_search(&(n.0, n.2)).is_ok()).count() as f32 / old.len() as f32
}

/// At the size of a typical tree: what an edit leaves alone, and what it searches.
#[test]
fn an_edit_of_a_typical_tree_keeps_what_is_elsewhere() {
    let region = Cuboid::new(Vec3::new(-6.0, 0.0, -6.0), Vec3::new(6.0, 12.5, 6.0));
    let crown = |x: f32| {
        let lobe = Ellipsoid::new(Vec3::new(3.4 + x, 6.0, 0.0), Vec3::splat(0.9));
        InShape::poisson_disc(Union::new(Ellipsoid::new(Vec3::Y * 6.8, Vec3::new(3.2, 3.0, 3.2)), lobe), 74)
    };
    let degrees = f32::to_radians;
    let twig = || Bend::piecewise(degrees(25.0), 0.0, 1);
    // Each node of the whole surface by a draw of its own: a count, a share and the outermost fraction are a choice among
    // all, here and elsewhere.
    let surface =
        |hops, share| HopSurface::new(hops, Count::Each(share)).with_outermost(1.0).with_hop_length(0.28);
    let base = TreeSynth::new(PoissonYao::new(region).with_leader(Leader::new(Vec3::ZERO, Vec3::Y * 8.4)))
        .stage(Stage::new(Bend::piecewise(degrees(60.0), 0.0, 1), crown(0.0)))
        .stage(Stage::new(twig(), surface(4, 0.04)))
        .stage(Stage::new(twig(), surface(4, 0.08)))
        .stage(Stage::new(twig(), surface(3, 0.12)));
    let changed = |number: usize, edit: &dyn Fn(Stage) -> Stage| {
        let mut stages = base.stages().to_vec();
        stages[number] = edit(stages[number].clone());
        base.clone().with_stages(stages)
    };
    let (mut near, mut worst, mut most, mut times) = (Vec::new(), 1.0f32, 0.0f32, Vec::new());
    for seed in 1..4 {
        let graph = base.build_graph(seed, &Silent).expect("a graph");
        let mut tree = Regrowth::new(&base, &graph, seed, &Silent).expect("a tree");
        let limbs: Vec<Vec3> =
            tree.trees()[0].endpoints[0].iter().map(|&node| graph.position(node)).collect();
        let mut edits: Vec<(String, TreeSynth, TreeSynth, Vec<Bounds>)> = Vec::new();
        for limb in [5, 30, 60] {
            let mut moved = limbs.clone();
            moved[limb] += Vec3::new(0.2, 0.15, -0.2);
            let listed = |places: &[Vec3]| changed(0, &|stage| stage.with_endpoints(Places(places.to_vec())));
            edits.push((format!("endpoint {limb}"), listed(&limbs), listed(&moved), Vec::new()));
        }
        let lobe = |x: f32| changed(0, &|stage| stage.with_endpoints(crown(x)));
        edits.push(("shape".to_owned(), lobe(0.0), lobe(0.2), Vec::new()));
        for place in [Vec3::new(2.5, 6.0, 0.0), Vec3::new(0.0, 9.0, 2.0)] {
            let around = |x: f32| Sphere::new(place + Vec3::X * x, 0.4);
            let beside = |x: f32| {
                let stages = base.stages().iter().cloned();
                let stages = stages.map(|stage| stage.with_weight(Within::obstacle(Guided, around(x))));
                base.clone().with_stages(stages.collect::<Vec<_>>())
            };
            let boxes = vec![around(0.0).bounds().union(around(0.3).bounds())];
            edits.push((format!("obstacle {place}"), beside(0.0), beside(0.3), boxes));
        }
        let mut search = Search::new(&graph);
        for (name, before, after, boxes) in edits {
            tree.regrow(&before, &[], &Silent).expect("a tree");
            let old = tree.trees().to_vec();
            let start = Instant::now();
            tree.regrow(&after, &boxes, &Silent).expect("a tree");
            let edited = start.elapsed();
            let start = Instant::now();
            let fresh = after.grow_all(&mut search, seed, &Silent).expect("a tree");
            let anew = start.elapsed();
            assert_eq!(tree.trees(), fresh, "{name}, seed {seed}");
            let [one, two, three] = [1.0, 2.0, 3.0].map(|far: f32| {
                let beside = |place: Vec3| boxes.iter().any(|bounds| bounds.grown(far).contains(place));
                share_kept(&old, &fresh, 1, &beside, far)
            });
            let searched = tree.searched_anew() as f32 / (4 * graph.nodes()) as f32;
            let time = edited.as_secs_f64() / anew.as_secs_f64();
            println!(
                "seed {seed}, {name}: {one} kept beyond 1 m, {two} beyond 2 m, {three} beyond 3 m; {searched} \
                 searched, {time} of the time ({edited:?}, {anew:?})"
            );
            near.push(one);
            worst = worst.min(two);
            most = most.max(searched);
            times.push(time);
        }
    }
    near.sort_unstable_by(f32::total_cmp);
    times.sort_unstable_by(f64::total_cmp);
    let (median, time) = (near[near.len() / 2], times[times.len() / 2]);
    println!(
        "median {median} kept beyond 1 m, worst {worst} beyond 2 m, {most} searched, median {time} of the time"
    );
    // Twigs upon twigs reach two metres from a limb that has changed.
    assert!(median >= 0.98, "{median} of the nodes kept beyond 1 m");
    assert!(worst >= 0.98, "{worst} of the nodes kept beyond 2 m");
    assert!(most <= 0.2, "{most} of the nodes searched anew");
}
