//! Rules and endpoints by metre of path, limbs that know their parent branch, clothed limbs, straight trunks.

use treesynth::glam::Vec3;
use treesynth::guided::{
    Bend, Fork, ForkAngle, GuidingRule, InShape, Leader, NearestTo, PoissonYao, Refinement, Stage, Step,
    TreeSynth,
};
use treesynth::shape::{Cuboid, Ellipsoid};
use treesynth::{Metrics, Silent, Skeleton, guided::Search, presets};

fn degrees(angle: f32) -> f32 {
    angle.to_radians()
}

fn region() -> Cuboid {
    Cuboid::new(Vec3::new(-6.0, 0.0, -6.0), Vec3::new(6.0, 12.5, 6.0))
}

/// The mean angle from up of the last 0.8 m of the limbs of stage 1, degrees.
fn tilt(tree: &Skeleton) -> f32 {
    let mut tilts = Vec::new();
    for branch in tree.branches().iter() {
        let nodes = branch.nodes();
        let at = |i: usize| tree.positions()[nodes[i] as usize];
        let (mut i, mut length) = (nodes.len() - 1, 0.0);
        while i > 0 && length < 0.8 {
            length += at(i).distance(at(i - 1));
            i -= 1;
        }
        if length >= 0.8 && tree.stages()[nodes[nodes.len() - 1] as usize] == 1 {
            let end = (at(nodes.len() - 1) - at(i)).normalize();
            tilts.push(end.y.clamp(-1.0, 1.0).acos().to_degrees());
        }
    }
    tilts.iter().sum::<f32>() / tilts.len() as f32
}

/// The mean tilt over three seeds.
fn tilt_of(rule: &Bend, nodes: usize, refined: bool) -> f32 {
    let crown = Ellipsoid::new(Vec3::Y * 6.8, Vec3::new(3.2, 3.0, 3.2));
    let builder = PoissonYao::new(region()).with_nodes(nodes);
    let spacing = builder.spacing().unwrap();
    let mut limbs = Stage::new(rule.clone(), InShape::poisson_disc(crown, 70));
    if refined {
        limbs = limbs.with_refinement(Refinement::new(region(), spacing * 0.6).with_reach(24));
    }
    let synth =
        TreeSynth::new(builder).stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 8.4))).stage(limbs);
    (1..=3).map(|seed| tilt(&synth.synthesize(seed).unwrap())).sum::<f32>() / 3.0
}

#[test]
fn angles_by_metre_do_not_depend_on_the_spacing() {
    let rules = [
        ("down", Bend::constant(degrees(10.0))),
        ("straight", Bend::piecewise(degrees(60.0), 0.0, 1)),
        ("out and up", Bend::piecewise(degrees(15.0), degrees(-5.0), 5)),
        ("out, down, up", Bend::piecewise(degrees(6.0), degrees(-6.0), 20)),
    ];
    let mut by_hops = 0f32;
    for (name, rule) in rules {
        let tilts =
            [20_000, 40_000, 160_000].map(|nodes| tilt_of(&rule.clone().with_hop_length(0.27), nodes, false));
        let spread = |tilts: &[f32]| {
            tilts.iter().copied().fold(f32::MIN, f32::max) - tilts.iter().copied().fold(f32::MAX, f32::min)
        };
        assert!(spread(&tilts) < 6.0, "{name}: {tilts:?}");
        let hops = [40_000, 160_000].map(|nodes| tilt_of(&rule, nodes, false));
        by_hops = by_hops.max(spread(&hops));
    }
    assert!(by_hops > 15.0, "a rule by hops is a rule by spacings: {by_hops}");
}

#[test]
fn angles_by_metre_hold_across_a_refinement() {
    let rule = Bend::constant(degrees(10.0)).with_hop_length(0.27);
    let [plain, refined] = [false, true].map(|refined| tilt_of(&rule, 30_000, refined));
    assert!((plain - refined).abs() < 6.0, "{plain} and {refined}");
}

/// The nodes change the detail and not the tree.
#[test]
fn presets_keep_their_size_on_any_graph() {
    for name in ["figure-07", "figure-17g", "figure-06b", "fine-oak", "fine-ash"] {
        let preset = presets::by_name(name).unwrap().guided().unwrap();
        let size = |nodes: usize| {
            let size = |seed| {
                let metrics = Metrics::of(&preset.synth(nodes).synthesize(seed).unwrap());
                [metrics.height, metrics.crown_width]
            };
            let [a, b, c] = [1, 2, 3].map(size);
            [0, 1].map(|i| (a[i] + b[i] + c[i]) / 3.0)
        };
        let (coarse, typical) = (size(20_000), size(150_000));
        for i in 0..2 {
            let ratio = coarse[i] / typical[i];
            assert!((0.93..1.07).contains(&ratio), "{name}: {coarse:?} and {typical:?}");
        }
    }
}

#[test]
fn forks_are_measured_from_the_parent_branch() {
    let rule = ForkAngle::new(degrees(60.0), Bend::none());
    for direction in [Vec3::Y, Vec3::X, Vec3::new(1.0, -2.0, 0.5)] {
        for edge in [Vec3::new(0.1, 0.2, 0.0), Vec3::new(-0.2, 0.0, 0.1), Vec3::NEG_Y] {
            let step = Step::new(Vec3::Y, edge, Vec3::Y).with_fork(Fork::new(direction));
            let vector = rule.guide(&step);
            let angle = vector.angle_between(direction).to_degrees();
            assert!((angle - 60.0).abs() < 0.01, "{direction} {edge}: {angle}");
            let mut later = step;
            later.hops = 2;
            assert_eq!(rule.guide(&later), step.vector, "later nodes follow the other rule");
        }
    }
    // Two ranks: sides alternate from one internode to the next.
    let ranks = ForkAngle::new(degrees(90.0), Bend::none()).with_divergence(degrees(180.0), 0.5);
    let side = |from_base: f32| {
        let mut fork = Fork::new(Vec3::Y);
        fork.from_base = from_base;
        ranks.guide(&Step::new(Vec3::Y, Vec3::X * 0.1, Vec3::Y).with_fork(fork))
    };
    assert!((side(0.1) + side(0.6)).length() < 1e-5 && (side(0.1) - side(1.2)).length() < 1e-5);
}

/// In a tree: forks of the limbs' twigs stand at the angle from the limb, not from up.
#[test]
fn forks_know_order_length_and_direction_in_a_tree() {
    let crown = Ellipsoid::new(Vec3::Y * 6.8, Vec3::new(3.2, 3.0, 3.2));
    let graph = PoissonYao::new(region()).with_nodes(20_000);
    let synth = TreeSynth::new(graph)
        .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 8.4)))
        .stage(Stage::new(Bend::piecewise(degrees(60.0), 0.0, 1), InShape::poisson_disc(crown, 40)));
    let graph = synth.build_graph(3, &Silent).unwrap();
    let mut search = Search::new(&graph);
    let tree = synth.grow(&mut search, 3, &Silent).unwrap();
    // The search was asked for forks in no stage; asked now it tells of the tree as the last stage began, so begin
    // one more.
    let skeleton = &tree.skeleton;
    let last = synth.clone().stage(Stage::new(Bend::none(), NearestTo::new(Vec3::new(3.0, 7.0, 0.0))));
    last.grow_stage(&mut search, 2, 3, &Silent).unwrap();
    let mut from_root = vec![0.0f32; skeleton.len()];
    for (node, parent) in skeleton.edges() {
        from_root[node] =
            from_root[parent] + skeleton.positions()[node].distance(skeleton.positions()[parent]);
    }
    for (place, &node) in tree.nodes.iter().enumerate() {
        let fork = search.fork(node).expect("a node of the tree");
        assert!((fork.from_root - from_root[place]).abs() < 1e-3);
        assert!((fork.direction.length() - 1.0).abs() < 1e-4);
        assert!(fork.direction.dot(fork.normal).abs() < 1e-3);
        assert!(fork.thickness > 0.0 && fork.thickness <= 1.0 && fork.tips >= 1);
    }
    assert!(search.fork(tree.nodes[0]).unwrap().direction.y > 0.8, "the trunk points up");
}

/// Beyond the paper no limb is a bare whip, none is too thin to hold itself up.
#[test]
fn limbs_beyond_the_paper_are_clothed_and_stout() {
    for preset in presets::guided().filter(|preset| preset.figure == 0) {
        for seed in 1..=3 {
            let tree = preset.synth(60_000).synthesize(seed).unwrap();
            let children = tree.children();
            for branch in tree.branches().iter().filter(|branch| branch.nodes().len() > 1) {
                let nodes = branch.nodes();
                let at = |i: usize| tree.positions()[nodes[i] as usize];
                let length: f32 = (1..nodes.len()).map(|i| at(i).distance(at(i - 1))).sum();
                let is_bare = nodes[1..].iter().all(|&node| children.of(node as usize).len() < 2);
                assert!(!is_bare || length <= 1.0, "{} {seed}: {length} m bear nothing", preset.name);
                let diameter = 2.0 * tree.radii()[nodes[1] as usize];
                assert!(diameter >= length / 100.0, "{} {seed}: {diameter} for {length} m", preset.name);
            }
        }
    }
}

/// Points on one another, on the ends, near them: a trunk goes from its base to its top, whole.
#[test]
fn leaders_pass_their_points() {
    let (base, top) = (Vec3::new(0.0, -10.0, 0.0), Vec3::new(0.0, 10.0, 0.0));
    let side = Vec3::new(2.0, 1.0, 0.0);
    let tiny = Vec3::new(1e-15, 0.0, 0.0);
    for points in [
        vec![Vec3::ZERO, tiny],
        vec![base, side, side, top],
        vec![top],
        vec![base, base + tiny, side, top + tiny],
    ] {
        let leader = Leader::new(base, top).with_points(points.clone()).with_waywardness(0.0);
        let line = leader.skeleton(1, 0.1).unwrap();
        let (first, last) = (line.positions()[0], line.positions()[line.len() - 1]);
        assert!(first.distance(base) < 1e-4 && last.distance(top) < 1e-4, "{points:?}: {first} {last}");
        if points.contains(&side) {
            let nearest = line.positions().iter().map(|place| place.distance(side)).fold(f32::MAX, f32::min);
            assert!(nearest < 0.06, "{points:?}: {nearest}");
        }
    }
    let named =
        |point: Vec3| Leader::new(base, top).with_points([point]).skeleton(1, 0.1).unwrap_err().to_string();
    assert!(named(Vec3::NAN).starts_with("Leader.points[0] is"), "{}", named(Vec3::NAN));
    assert!(named(Vec3::X * 2e6).starts_with("Leader.points[0] is"));
}

#[test]
fn leaders_are_as_straight_as_they_say() {
    for (waywardness, seed) in [(0.0, 1), (0.02, 1), (0.02, 2), (0.1, 3)] {
        let leader = Leader::new(Vec3::ZERO, Vec3::Y * 8.0).with_waywardness(waywardness);
        let synth = TreeSynth::new(PoissonYao::new(region()).with_nodes(20_000).with_leader(leader)).stage(
            Stage::new(
                Bend::piecewise(degrees(60.0), 0.0, 1),
                InShape::poisson_disc(Ellipsoid::new(Vec3::Y * 6.8, Vec3::new(3.2, 3.0, 3.2)), 40),
            ),
        );
        let tree = synth.synthesize(seed).unwrap();
        let trunk = (0..tree.len()).filter(|&node| tree.stages()[node] == 0);
        let sweep = trunk.map(|node| tree.positions()[node].with_y(0.0).length()).fold(0.0, f32::max) / 8.0;
        assert!((0.9 * waywardness..=1.02 * waywardness + 1e-6).contains(&sweep), "{waywardness}: {sweep}");
        assert!(tree.tips().count() > 30);
    }
}
