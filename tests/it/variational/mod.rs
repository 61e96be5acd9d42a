//! Trees that fill a shape: what each term of the energy says, what the optimization promises, what its figures show.

mod topology;

use crate::sample::cases;
use proptest::prelude::*;
use treesynth::glam::{DVec3, Vec3};
use treesynth::presets;
use treesynth::shape::{Ellipsoid, HalfEllipsoid, Sphere};
use treesynth::variational::*;
use treesynth::{ParameterError, Silent, Skeleton};

fn crown() -> HalfEllipsoid {
    HalfEllipsoid::new(Vec3::Y * 2.0, Vec3::new(2.5, 5.0, 2.5))
}

fn filled(count: usize) -> GuidanceShape {
    GuidanceShape::in_volume(&crown(), count, 1).expect("a crown")
}

/// A trunk, a branch at each of its nodes.
fn ladder() -> Skeleton {
    let at = |x, y, z| Vec3::new(x, y, z);
    Skeleton::new(
        vec![at(0.0, 0.0, 0.0), at(0.0, 1.0, 0.0), at(1.0, 1.0, 0.0), at(0.0, 2.0, 0.0), at(0.0, 3.0, 1.0)],
        vec![None, Some(0), Some(1), Some(1), Some(3)],
    )
    .expect("a tree")
}

#[test]
fn each_term_by_hand() -> Result<(), ParameterError> {
    let tree = ladder().with_radii(vec![0.5, 0.5, 0.25, 0.25, 0.25]).expect("five radii");
    let wood = 1.0 + 0.25 * (1.0 + 1.0 + 2.0_f64.sqrt());
    assert!((structure(&tree, 2.0)?.value - wood).abs() < 1e-12);

    // One metre above the last node, and halfway between two: diameters weigh.
    let shape = GuidanceShape::from_points([Vec3::new(0.0, 4.0, 1.0), Vec3::new(0.5, 1.0, 0.0)], 1.0)
        .with_diameters(vec![3.0, 1.0]);
    let near = guidance(&tree, &shape)?;
    assert!((near.value - (3.0 * 1.0 + 0.5) / 4.0).abs() < 1e-12);
    assert_eq!(near.gradient[4], DVec3::NEG_Y * 0.75);
    assert_eq!(near.gradient[1], DVec3::NEG_X * 0.25, "of nodes equally near the first");

    // The first branch stands at 90°, and from above the second is turned by -90° against it. All but the trunk's foot
    // have d² = 0.25.
    let mut wishes = vec![Wish::new(1.0); 5];
    wishes[2] = Wish::new(2.0).with_angle(60_f64.to_radians());
    wishes[3] = Wish::new(1.0).with_angle(0.0);
    let branch = Wish::new(2.0_f64.sqrt()).with_angle(45_f64.to_radians());
    wishes[4] = branch.with_turn(2, 0.0);
    let first = 2.0 * 0.25 * (30_f64.to_radians() + 0.5);
    let turned = 2.0_f64.sqrt() * 0.25 * 90_f64.to_radians();
    let strain = penalty(&tree, &wishes, 2.0)?.value;
    assert!((strain - (first + turned)).abs() < 1e-6, "{strain}");
    wishes[4] = branch.with_turn(2, -90_f64.to_radians());
    assert!((penalty(&tree, &wishes, 2.0)?.value - first).abs() < 1e-6);
    Ok(())
}

#[test]
fn bad_terms_are_named() {
    let tree = ladder();
    let named = |node: usize, wish: Wish| {
        let mut wishes = vec![Wish::new(1.0); 5];
        wishes[node] = wish;
        penalty(&tree, &wishes, 2.0).map(|_| ()).map_err(|error| error.parameter)
    };
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(named(2, Wish::new(bad)), Err("Wish.length".into()));
    }
    for bad in [-0.1, 3.2, f64::NAN] {
        assert_eq!(named(2, Wish::new(1.0).with_angle(bad)), Err("Wish.angle".into()));
    }
    assert_eq!(named(4, Wish::new(1.0).with_turn(2, 1.0)), Ok(()));
    for (node, mate, turn) in
        [(4, 2, f64::NAN), (4, 3, 1.0), (4, 4, 1.0), (4, 99, 1.0), (2, 1, 1.0), (1, 0, 0.0)]
    {
        assert_eq!(named(node, Wish::new(1.0).with_turn(mate, turn)), Err("Wish.turn".into()));
    }
    assert!(
        penalty(&tree, &[], 2.0).is_err()
            && penalty(&tree, &[Wish::new(1.0); 5], 7.0).is_err()
            && structure(&tree, -1.0).is_err()
    );
    assert!(guidance(&tree, &GuidanceShape::from_points([], 1.0)).is_err());
}

/// A tree whose nodes are apart, with every kind of wish.
fn wished() -> impl Strategy<Value = (Skeleton, Vec<Wish>)> {
    (prop::collection::vec([-0.3f32..0.3, -0.3f32..0.3, -0.3f32..0.3], 7), 0.2f64..2.9).prop_map(
        |(off, angle)| {
            let place = |i: usize, x: f32, y: f32, z: f32| Vec3::new(x, y, z) + Vec3::from_array(off[i]);
            let positions = vec![
                place(0, 0.0, 0.0, 0.0),
                place(1, 0.0, 2.0, 0.0),
                place(2, 2.0, 3.0, 0.0),
                place(3, 0.0, 4.0, 0.0),
                place(4, 0.0, 5.0, 2.0),
                place(5, -1.5, 5.0, 0.0),
                place(6, 0.0, 6.0, 0.0),
            ];
            let parents = vec![None, Some(0), Some(1), Some(1), Some(3), Some(3), Some(3)];
            let tree = Skeleton::new(positions, parents)
                .and_then(|tree| tree.with_radii(vec![0.5, 0.5, 0.2, 0.4, 0.1, 0.2, 0.3]));
            let wish = Wish::new(1.3).with_angle(angle);
            let wishes =
                vec![wish, wish, wish, wish, wish.with_turn(2, angle), wish.with_turn(2, -angle), wish];
            (tree.expect("a tree"), wishes)
        },
    )
}

proptest! {
    #![proptest_config(cases(64))]

    /// Central differences in f32 positions; where a term has a kink in between, both slopes differ and are left out.
    #[test]
    fn gradients_are_slopes((tree, wishes) in wished(), node in 0usize..7, axis in 0usize..3) {
        let shape = GuidanceShape::from_points([Vec3::new(1.0, 4.5, 1.0), Vec3::new(-2.0, 1.0, 0.4)], 0.3);
        let terms: [&dyn Fn(&Skeleton) -> Energy; 3] = [
            &|tree| structure(tree, 2.0).unwrap(),
            &|tree| guidance(tree, &shape).unwrap(),
            &|tree| penalty(tree, &wishes, 2.0).unwrap(),
        ];
        let moved = |by: f32| {
            let mut positions = tree.positions().to_vec();
            positions[node][axis] += by;
            tree.clone().with_positions(positions).unwrap()
        };
        let step = 1.0 / 1024.0;
        for (term, energy) in terms.iter().enumerate() {
            let (ahead, here, behind) = (moved(step), energy(&tree), moved(-step));
            let width = f64::from(ahead.positions()[node][axis] - behind.positions()[node][axis]) * 0.5;
            let (up, down) = (energy(&ahead).value - here.value, here.value - energy(&behind).value);
            prop_assume!((up - down).abs() < 0.02 * width);
            let slope = (up + down) / (2.0 * width);
            prop_assert!((slope - here.gradient[node][axis]).abs() < 0.02, "term {term}: {slope} {}", here.gradient[node][axis]);
        }
    }

    #[test]
    fn trees_keep_their_promises(
        size in [0.5f32..4.0, 0.5f32..4.0, 0.5f32..4.0],
        base in -3.0f32..6.0,
        count in 2usize..300,
        trunk in any_level(),
        branch in any_level(),
        lambda in 0.0f32..5.0,
        mu in 0.0f32..2.0,
        seed: u64,
    ) {
        let shape = Ellipsoid::new(Vec3::Y * base, Vec3::from_array(size));
        let shape = GuidanceShape::in_volume(&shape, count, seed).unwrap();
        let synth = VariationalSynth::new(shape.clone()).with_levels([trunk, branch, branch]).with_weights(lambda, mu);
        let growth = synth.grow(seed, &Silent).unwrap();
        check_growth(&growth, &shape)?;
        // Angles that no tree can have, together with a large μ, push nodes out; the most that was seen is 3.6.
        let most = if branch.angle().max(trunk.angle()) > 2.2 && mu > 0.5 { 5.0 } else { 3.0 };
        prop_assert!(overreach(&growth, &shape) <= most, "{}", overreach(&growth, &shape));
    }
}

fn any_level() -> impl Strategy<Value = Level> {
    (1u32..12, 0.01f32..=1.0, 1u32..5, 0.0f32..3.1, -6.2f32..6.2).prop_map(
        |(metamers, apical, laterals, angle, turn)| {
            Level::default()
                .with_metamers(metamers)
                .with_apical_control(apical)
                .with_laterals(laterals)
                .with_angle(angle)
                .with_turn(turn)
        },
    )
}

/// Guarantees of every growth.
fn check_growth(growth: &Growth, shape: &GuidanceShape) -> Result<(), TestCaseError> {
    let tree = &growth.skeleton;
    prop_assert_eq!(tree.check(), Ok(()));
    prop_assert_eq!(&tree.positions()[growth.branch_nodes..], shape.positions());
    let tips: Vec<usize> = tree.tips().collect();
    prop_assert_eq!(
        tips,
        (growth.branch_nodes..tree.len()).collect::<Vec<_>>(),
        "the tips are the shape nodes"
    );
    for pair in growth.trace.windows(2) {
        // Twigs in place of bundles are new nodes with wishes of their own; their wood may cost a little more. 1.16 was seen
        // on a tree of twenty, 1.104 on one of sixty.
        let more = (1.1 + 4.0 / shape.positions().len() as f64).min(1.3);
        if let StepKind::Twigs = pair[1].kind {
            prop_assert!(pair[1].structure <= pair[0].structure * more, "{:?}", pair);
        } else if !matches!(pair[1].kind, StepKind::Initialization { .. } | StepKind::Refinement { .. }) {
            prop_assert!(pair[1].total <= pair[0].total, "{:?}", pair);
        }
        if let StepKind::Partition { .. } = pair[1].kind {
            prop_assert!(pair[1].guidance <= pair[0].guidance + 1e-9, "{:?}", pair);
        }
    }
    // The public functions say the same of the tree as the trace of its step.
    let (step, structure) = (growth.trace[growth.best], growth.structure().unwrap());
    prop_assert!(guidance(&structure, shape).unwrap().value <= step.guidance + 1e-4);
    let strain = strain(growth, shape);
    // Rounded places tell an angle near π to some 5e-4 only, whose square counts for each node.
    prop_assert!((strain - step.penalty).abs() <= 1e-2 * step.penalty + 1e-4, "{} {}", strain, step.penalty);
    Ok(())
}

/// Greatest distance of a branch node from a shape node that it carries, over its cluster's reach:
/// the largest distance between any two of what meets there, its shape nodes, its parent and its
/// children.
fn overreach(growth: &Growth, shape: &GuidanceShape) -> f32 {
    let tree = &growth.skeleton;
    let mut meet: Vec<Vec<Vec3>> = vec![Vec::new(); growth.branch_nodes];
    for (node, parent) in tree.edges() {
        meet[parent].push(tree.positions()[node]);
        if node < growth.branch_nodes {
            meet[node].push(tree.positions()[parent]);
        }
    }
    let mut most = 0.0_f32;
    for (node, &place) in (growth.branch_nodes..).zip(shape.positions()) {
        let owner = tree.parent(node).expect("not the root");
        let all = &meet[owner];
        let reach = all.iter().flat_map(|a| all.iter().map(|b| a.distance(*b))).fold(0.0, f32::max);
        most = most.max(tree.positions()[owner].distance(place) / reach);
    }
    most
}

/// `F_P` of the branch nodes, in the shape nodes' own diameters.
fn strain(growth: &Growth, shape: &GuidanceShape) -> f64 {
    let tree = &growth.skeleton;
    let mut carries = vec![0.0_f64; tree.len()];
    for (node, &d) in (growth.branch_nodes..).zip(shape.diameters()) {
        carries[node] = f64::from(d).powf(2.5);
    }
    for (node, parent) in tree.edges().rev() {
        carries[parent] += carries[node];
    }
    let radii = carries[..growth.branch_nodes].iter().map(|flow| 0.5 * flow.powf(0.4) as f32).collect();
    let structure = growth.structure().and_then(|structure| structure.with_radii(radii)).expect("a tree");
    penalty(&structure, &growth.wishes, 2.0).expect("wishes").value
}

/// F by the book, of any tree that carries the shape nodes: each node's diameter from what it carries.
fn cost(nodes: &[Vec3], parents: &[usize], owners: &[usize], shape: &GuidanceShape, penalty: f64) -> f64 {
    let sum: f64 = shape.diameters().iter().map(|&d| f64::from(d)).sum();
    let mut carries = vec![0.0_f64; nodes.len()];
    let mut wood = 0.0;
    let mut away = 0.0;
    for ((&owner, &place), &d) in owners.iter().zip(shape.positions()).zip(shape.diameters()) {
        let d = f64::from(d);
        carries[owner] += d.powf(2.5);
        let length = f64::from(nodes[owner].distance(place));
        wood += length * d * d;
        let nearest = nodes.iter().map(|node| f64::from(node.distance(place))).fold(f64::MAX, f64::min);
        away += nearest * d / sum;
    }
    for node in (1..nodes.len()).rev() {
        carries[parents[node]] += carries[node];
        wood += f64::from(nodes[node].distance(nodes[parents[node]])) * carries[node].powf(2.0 / 2.5);
    }
    let foot = carries[0].powf(2.0 / 2.5);
    wood + foot * away + 0.2 * penalty
}

/// As Prim did it: the minimum spanning tree of the root and the shape nodes.
fn spanning(shape: &GuidanceShape) -> f64 {
    let places = [&[Vec3::ZERO], shape.positions()].concat();
    let mut best: Vec<(f32, usize)> = places.iter().map(|place| (place.length(), 0)).collect();
    let mut names = vec![usize::MAX; places.len()];
    let (mut nodes, mut parents) = (vec![Vec3::ZERO], vec![0]);
    names[0] = 0;
    while nodes.len() < places.len() {
        let free = (0..places.len()).filter(|&i| names[i] == usize::MAX);
        let next = free.min_by(|&a, &b| best[a].0.total_cmp(&best[b].0)).expect("one left");
        names[next] = nodes.len();
        nodes.push(places[next]);
        parents.push(names[best[next].1]);
        for i in 0..places.len() {
            let length = places[i].distance(places[next]);
            if length < best[i].0 {
                best[i] = (length, next);
            }
        }
    }
    let owners: Vec<usize> = names[1..].to_vec();
    cost(&nodes, &parents, &owners, shape, 0.0)
}

#[test]
fn every_preset_costs_less_than_a_star_and_a_spanning_tree() {
    for preset in presets() {
        let synth = preset.synth(600).expect("600 shape nodes");
        let shape = synth.shape();
        let growth = synth.grow(preset.seed, &Silent).expect("a tree");
        check_growth(&growth, shape).unwrap_or_else(|error| panic!("{}: {error}", preset.name));
        assert!(overreach(&growth, shape) <= 1.1, "{}: {}", preset.name, overreach(&growth, shape));
        let tree = &growth.skeleton;
        let parents: Vec<usize> = (0..tree.len()).map(|node| tree.parent(node).unwrap_or(0)).collect();
        let (parents, owners) = parents.split_at(growth.branch_nodes);
        let nodes = &tree.positions()[..growth.branch_nodes];
        let found = cost(nodes, parents, owners, shape, strain(&growth, shape));
        let step = growth.trace[growth.best];
        assert!(found <= step.total * (1.0 + 1e-4), "{}: {found} {}", preset.name, step.total);
        let top = Vec3::Y * shape.bounds().max.y;
        let stars = [Vec3::Y * shape.bounds().min.y.max(0.5), top]
            .map(|top| cost(&[Vec3::ZERO, top], &[0, 0], &vec![1; shape.len()], shape, 0.0));
        let others = [stars[0], stars[1], spanning(shape)];
        println!("{}: {found:.3} of {others:.3?}", preset.name);
        assert!(others.iter().all(|&other| found < other), "{}: {found} {others:?}", preset.name);
    }
}

/// A growth of a preset with so many shape nodes.
fn grown(name: &str, count: usize) -> Growth {
    let preset = presets::by_name(name).unwrap().variational().unwrap();
    preset.synth(count).map(|synth| synth.grow(preset.seed, &Silent).expect("a tree")).expect("a preset")
}

/// Height of the stem of the first level, as a part of the tree's height.
fn stem(growth: &Growth) -> f32 {
    let tree = &growth.skeleton;
    let highest = |stage: u16| {
        let all = tree.positions().iter().zip(tree.stages()).filter(|&(_, &of)| of <= stage);
        all.map(|(position, _)| position.y).fold(0.0, f32::max)
    };
    highest(0) / highest(u16::MAX)
}

/// For each branch node off the stem: the direction of the stem below it, and its own.
fn branches(growth: &Growth) -> Vec<(usize, Vec3, Vec3)> {
    let tree = &growth.skeleton;
    let at = |node: usize| tree.positions()[node];
    let off_stem = tree
        .edges()
        .take(growth.branch_nodes - 1)
        .filter(|&(node, parent)| parent > 0 && tree.stages()[node] == 1 && tree.stages()[parent] == 0);
    off_stem
        .map(|(node, parent)| {
            let before = tree.parent(parent).expect("not the root");
            (parent, at(parent) - at(before), at(node) - at(parent))
        })
        .collect()
}

/// The median: on the upper stem, where internodes are short, single branches go their own ways.
fn typical_angle(growth: &Growth) -> f32 {
    let mut angles: Vec<f32> =
        branches(growth).iter().map(|(_, stem, branch)| stem.angle_between(*branch).to_degrees()).collect();
    angles.sort_by(f32::total_cmp);
    angles[angles.len() / 2]
}

#[track_caller]
fn ascending(what: &str, numbers: &[f32]) {
    println!("{what}: {numbers:.3?}");
    assert!(numbers.windows(2).all(|pair| pair[0] < pair[1]), "{what}: {numbers:?}");
}

#[test]
fn figure_07() {
    let each = |names: [&str; 3]| names.map(|name| grown(&format!("variational-07-{name}"), 1500));
    let count = |growth: &Growth| branches(growth).len() as f32;
    ascending(
        "branches off the stem with N = 5, 7, 9",
        &each(["n5", "n7", "n9"]).map(|growth| count(&growth)),
    );
    ascending("height of the stem with P", &each(["p02", "p06", "p10"]).map(|growth| stem(&growth)));
    ascending("branches off the stem with n", &each(["l1", "l2", "l3"]).map(|growth| count(&growth)));
    let angles = each(["a25", "a45", "a65"]).map(|growth| typical_angle(&growth));
    ascending("angle of branches with θ", &angles);
    for (found, wanted) in angles.into_iter().zip([25.0, 45.0, 65.0]) {
        assert!((found - wanted).abs() < 9.0, "θ = {wanted}: {found}");
    }
}

/// Mean of the turns between the first branches of neighbouring nodes of the stem, degrees in [0, 90]: a plane has no
/// front.
fn mean_turn(growth: &Growth) -> f32 {
    let branches = branches(growth);
    let tree = &growth.skeleton;
    let first = |node: usize| branches.iter().find(|branch| branch.0 == node);
    let mut turns = Vec::new();
    for node in (1..growth.branch_nodes).filter(|&node| tree.stages()[node] == 0) {
        if let (Some(here), Some(before)) = (first(node), tree.parent(node).and_then(first)) {
            let axis = here.1.normalize();
            let turn = here.2.reject_from(axis).angle_between(before.2.reject_from(axis)).to_degrees();
            turns.push(turn.min(180.0 - turn));
        }
    }
    turns.iter().sum::<f32>() / turns.len() as f32
}

#[test]
fn figure_08() {
    let [alternate, opposite, decussate] =
        ["alternate", "opposite", "decussate"].map(|name| grown(&format!("variational-08-{name}"), 1500));
    let count = |growth: &Growth| branches(growth).len() as f32;
    ascending("branches, alternate and opposite", &[count(&alternate), count(&opposite)]);
    ascending(
        "turn from pair to pair, opposite and decussate",
        &[mean_turn(&opposite), 45.0, mean_turn(&decussate)],
    );
}

#[test]
fn figure_14() {
    let of = |name: &str| grown(&format!("variational-14-{name}"), 1500);
    let slim = |growth: &Growth| {
        let tree = &growth.skeleton;
        (treesynth::metrics::crown_width(tree) / treesynth::metrics::height(tree)) as f32
    };
    let [maple, pine, ash, camphor, oak] = ["maple", "pine", "ash", "camphor", "oak"].map(of);
    let [elm, spruce, birch, box_elder] = ["elm", "spruce", "birch", "boxelder"].map(of);
    for growth in [&elm, &camphor, &box_elder, &maple] {
        ascending("stems that dissolve", &[stem(growth), 0.6]);
    }
    for growth in [&pine, &spruce, &birch] {
        ascending("stems to the top", &[0.7, stem(growth)]);
    }
    ascending("angles of elm, oak and spruce", &[&elm, &oak, &spruce].map(typical_angle));
    ascending("width over height", &[&birch, &ash, &maple, &camphor].map(slim));
}

#[test]
fn figure_12() {
    let [left, centre, right] =
        ["left", "centre", "right"].map(|name| grown(&format!("variational-12-{name}"), 1500));
    ascending("height of the stem", &[stem(&right), 0.2, stem(&centre), 0.5, stem(&left), 1.0]);
}

/// The farther a shape node is from its twig, the less of the shape is seen.
#[test]
fn every_preset_fills_its_shape() {
    for preset in presets() {
        let growth = grown(preset.name, 1500);
        let tree = &growth.skeleton;
        let d = preset.synth(1500).expect("a shape").shape().diameters().to_vec();
        let near = tree.edges().skip(growth.branch_nodes - 1).filter(|&(node, parent)| {
            tree.positions()[node].distance(tree.positions()[parent]) <= 2.0 * d[node - growth.branch_nodes]
        });
        let share = near.count() as f32 / 1500.0;
        assert!(share > 0.75, "{}: {share}", preset.name);
        // Of all twigs, not only the one it is the tip of.
        let at = |node: usize| tree.positions()[node];
        let twigs: Vec<(Vec3, Vec3)> =
            tree.edges().take(growth.branch_nodes - 1).map(|(node, parent)| (at(parent), at(node))).collect();
        let near = (growth.branch_nodes..tree.len()).filter(|&node| {
            let reach = d[node - growth.branch_nodes];
            twigs.iter().any(|&(from, to)| {
                let way = to - from;
                let share = (at(node) - from).dot(way) / way.length_squared().max(f32::MIN_POSITIVE);
                at(node).distance_squared(from + way * share.clamp(0.0, 1.0)) <= reach * reach
            })
        });
        let share = near.count() as f32 / 1500.0;
        println!("{}: {share:.3} of the shape nodes within their diameter of a twig", preset.name);
        assert!(share > 0.45, "{}: {share}", preset.name);
    }
}

#[test]
fn bad_options_are_named() {
    let good = VariationalSynth::new(filled(50));
    let named = |synth: VariationalSynth| match synth.synthesize(1) {
        Err(VariationalError::Parameter(error)) => error.parameter,
        other => panic!("{other:?}"),
    };
    assert!(good.check().is_ok());
    for point in [Vec3::NAN, Vec3::INFINITY, Vec3::X * 1e5] {
        assert_eq!(named(good.clone().with_root(point)), "VariationalSynth.root");
    }
    for (alpha, beta) in [(2.0, 2.0), (1.0, 2.0), (f32::NAN, 2.0), (11.0, 2.0)] {
        assert_eq!(named(good.clone().with_exponents(alpha, beta)), "VariationalSynth.alpha");
    }
    for beta in [0.0, -1.0, 7.0, f32::NAN] {
        assert_eq!(named(good.clone().with_exponents(9.0, beta)), "VariationalSynth.beta");
    }
    for weight in [-1.0, 1001.0, f32::NAN, f32::INFINITY] {
        assert_eq!(named(good.clone().with_weights(weight, 0.1)), "VariationalSynth.lambda");
        assert_eq!(named(good.clone().with_weights(1.0, weight)), "VariationalSynth.mu");
    }
    assert_eq!(named(good.clone().with_levels([])), "VariationalSynth.levels");
    assert_eq!(named(good.clone().with_levels(vec![Level::default(); 17])), "VariationalSynth.levels");
    assert_eq!(named(good.clone().with_levels([Level::default().with_metamers(0)])), "Level.metamers");
    assert_eq!(named(good.clone().with_rounds(0)), "VariationalSynth.rounds");
    assert_eq!(named(good.clone().with_least_cluster(1)), "VariationalSynth.least_cluster");
    assert_eq!(named(good.clone().with_refinements(1001, 2)), "VariationalSynth.refinements");
    assert_eq!(named(good.clone().with_refinements(2, 0)), "VariationalSynth.prune_order");
    let one = GuidanceShape::from_points([Vec3::Y], 0.1);
    assert_eq!(named(VariationalSynth::new(one)), "GuidanceShape.positions");
    let radius = treesynth::radius::PipeModel::default().with_exponent(0.0);
    assert_eq!(named(good.with_radius(radius)), "PipeModel.exponent");
}

/// Wherever the root is, and whatever the points, there is a tree.
#[test]
fn odd_shapes_grow() -> Result<(), VariationalError> {
    let line: Vec<Vec3> = (1..200).map(|i| Vec3::Y * (i as f32 * 0.05)).collect();
    let plane: Vec<Vec3> = (0..400).map(|i| Vec3::new((i % 20) as f32, (i / 20) as f32, 0.0)).collect();
    let tiny: Vec<Vec3> = (0..50).map(|i| Vec3::new(1.0, 2.0 + i as f32 * 1e-3, 0.0)).collect();
    let pair = vec![Vec3::Y, Vec3::X];
    for points in [line, plane, tiny, pair] {
        let shape = GuidanceShape::from_points(points, 0.1);
        let growth = VariationalSynth::new(shape.clone()).grow(1, &Silent)?;
        check_growth(&growth, &shape).expect("promises");
        assert!(overreach(&growth, &shape) <= 3.0, "{}", overreach(&growth, &shape));
    }
    let ball = Sphere::new(Vec3::Y * 3.0, 1.0);
    let shape = GuidanceShape::on_surface(&ball, 200, 1)?;
    for root in [Vec3::Y * 3.0, Vec3::Y * 10.0, Vec3::X * 100.0, shape.positions()[7]] {
        let synth = VariationalSynth::new(shape.clone()).with_root(root);
        let growth = synth.grow(1, &Silent)?;
        check_growth(&growth, &shape).expect("promises");
        assert!(overreach(&growth, &shape) <= 3.0, "{}", overreach(&growth, &shape));
        assert_eq!(growth.skeleton.positions()[0], root);
    }
    Ok(())
}

/// A tree twice as large has the same form: λ and μ have no unit.
#[test]
fn form_does_not_depend_on_scale() -> Result<(), VariationalError> {
    let small = filled(300);
    let points: Vec<Vec3> = small.positions().iter().map(|&position| position * 4.0).collect();
    let large = GuidanceShape::from_points(points, small.diameters()[0] * 4.0);
    let [small, large] = [small, large].map(|shape| VariationalSynth::new(shape).synthesize(1));
    let (small, large) = (small?, large?);
    assert_eq!(small.len(), large.len());
    for (small, large) in small.positions().iter().zip(large.positions()) {
        assert!((*small * 4.0).distance(*large) < 1e-3, "{small} {large}");
    }
    Ok(())
}

#[test]
fn an_observer_cancels() {
    let synth = VariationalSynth::new(filled(200));
    let stop = |_: treesynth::Progress| std::ops::ControlFlow::Break(());
    assert_eq!(synth.grow(1, &stop), Err(VariationalError::Cancelled));
    let last = std::sync::Mutex::new(0.0);
    let watch = |progress: treesynth::Progress| {
        let before = std::mem::replace(&mut *last.lock().unwrap(), progress.fraction);
        assert!(before <= progress.fraction);
        std::ops::ControlFlow::Continue(())
    };
    assert!(synth.grow(1, &watch).is_ok());
    assert_eq!(*last.lock().unwrap(), 1.0);
}
