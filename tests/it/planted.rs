//! Trees that stand in a graph from the beginning keep their places and their radii.

use treesynth::glam::Vec3;
use treesynth::guided::{AroundTree, Bend, Count, HopSurface, PoissonYao, Refinement, Stage, TreeSynth};
use treesynth::shape::Cuboid;
use treesynth::{GraphBuilder, Skeleton};

fn region() -> Cuboid {
    Cuboid::new(Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 6.0, 3.0))
}

/// A trunk with a base of half a metre, and two limbs that a seed bends.
fn drawn(seed: u32) -> Skeleton {
    let bend = 0.1 + 0.05 * seed as f32;
    let places = [
        Vec3::ZERO,
        Vec3::new(bend, 1.0, 0.0),
        Vec3::new(0.0, 2.1, bend),
        Vec3::new(0.0, 3.3, 0.0),
        Vec3::new(1.0, 2.9, bend),
        Vec3::new(1.9, 3.2, 0.3),
        Vec3::new(-0.7, 1.9, -0.4),
        Vec3::new(-1.5, 2.5, -bend),
    ];
    let parents = [None, Some(0), Some(1), Some(2), Some(2), Some(4), Some(1), Some(6)];
    let tree = Skeleton::new(places.to_vec(), parents.to_vec()).expect("a tree");
    tree.with_radii(vec![0.5, 0.4, 0.3, 0.1, 0.2, 0.12, 0.15, 0.08]).expect("radii")
}

fn twigs() -> Stage {
    Stage::new(Bend::piecewise(0.5, 0.0, 1), HopSurface::new(3, Count::UpTo(200)))
}

/// Each given node is there to the bit, at least as thick as given, and so is all on the way to its parent.
fn assert_kept(given: &Skeleton, tree: &Skeleton, name: &str) {
    let find = |place: Vec3| {
        let same = |p: &Vec3| p.to_array().map(f32::to_bits) == place.to_array().map(f32::to_bits);
        tree.positions().iter().position(same).unwrap_or_else(|| panic!("{name}: no node at {place}"))
    };
    assert_eq!(find(given.positions()[0]), 0, "{name}");
    assert!(tree.radii()[0] >= given.radii()[0], "{name}: base of {} m", tree.radii()[0]);
    for (node, parent) in given.edges() {
        let (mut at, end) = (find(given.positions()[node]), find(given.positions()[parent]));
        while at != end {
            assert!(tree.radii()[at] >= given.radii()[node], "{name}: {} m at {node}", tree.radii()[at]);
            at = tree.parent(at).unwrap_or_else(|| panic!("{name}: {node} hangs on {parent}"));
        }
    }
    for (node, parent) in tree.edges() {
        assert!(tree.radii()[parent] >= tree.radii()[node], "{name}: thicker than its parent");
    }
    assert!(tree.tips().count() > 100, "{name}: {} tips", tree.tips().count());
}

#[test]
fn given_radii_are_the_least_and_given_nodes_stay() {
    for seed in 0..6 {
        let given = drawn(seed);
        let refinement = || Refinement::new(region(), 0.15).with_reach(5);
        let around = AroundTree::new(given.clone(), refinement());
        let in_graph = PoissonYao::new(region()).with_nodes(20_000).with_tree(given.clone());
        let builders: [(&str, Box<dyn GraphBuilder>); 2] =
            [("around", Box::new(around)), ("planted", Box::new(in_graph))];
        for (name, builder) in builders {
            let tree = TreeSynth::new(builder).stage(twigs()).stage(twigs()).synthesize(u64::from(seed));
            assert_kept(&given, &tree.expect("a tree"), name);
        }
        // Through a later refinement that does not relax, too.
        let unmoved = Refinement::new(region(), 0.12).with_reach(5).with_relaxation(0);
        let tree = TreeSynth::new(PoissonYao::new(region()).with_nodes(8_000).with_tree(given.clone()))
            .stage(twigs())
            .stage(twigs().with_refinement(unmoved))
            .synthesize(u64::from(seed));
        assert_kept(&given, &tree.expect("a tree"), "refined");
        // Unless it is asked for.
        let relaxed = AroundTree::new(given.clone(), refinement().with_relaxation(5));
        let tree = TreeSynth::new(relaxed).stage(twigs()).synthesize(u64::from(seed)).expect("a tree");
        assert!(!tree.positions().contains(&given.positions()[1]), "relaxed");
        assert!(tree.radii()[0] >= 0.5);
    }
}

#[test]
fn a_pipeline_says_what_its_stages_are() {
    let synth = TreeSynth::new(PoissonYao::new(region()))
        .stage(twigs())
        .stage(twigs().with_refinement(Refinement::new(region(), 0.1)));
    let text = format!("{synth:?}");
    assert!(
        text.contains("Refinement") && text.contains("spacing: 0.1") && text.contains("needs_search"),
        "{text}"
    );
    let bad = synth.stage(Stage::new(Bend::constant(30.0), HopSurface::new(2, 5)));
    let error = bad.synthesize(1).expect_err("degrees").to_string();
    assert!(error.starts_with("Bend.angle is 30") && error.contains("stage 2"), "{error}");
}
