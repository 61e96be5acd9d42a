//! Axes: where laterals stand, which child goes on, architecture by order.

use treesynth::glam::Vec3;
use treesynth::self_organizing::{
    Axis, Habit, NodeId, Phyllotaxis, SelfOrganizing, ShadowPropagation, VigorModel,
};
use treesynth::{Skeleton, math};

fn grown(habit: Habit, seasons: u32, seed: u64) -> SelfOrganizing {
    let mut tree = SelfOrganizing::new(ShadowPropagation::default(), habit.with_shedding(None), seed);
    tree.grow(seasons).unwrap();
    tree
}

fn heading(tree: &Skeleton, node: usize) -> Vec3 {
    let parent = tree.parent(node).unwrap();
    (tree.positions()[node] - tree.positions()[parent]).normalize()
}

/// The child on the same axis, and the one on another.
fn children(tree: &Skeleton) -> Vec<[Option<usize>; 2]> {
    let mut children = vec![[None; 2]; tree.len()];
    for (node, parent) in tree.edges() {
        children[parent][usize::from(tree.orders()[node] != tree.orders()[parent])] = Some(node);
    }
    children
}

/// The angles around the axis from each lateral to the next on the same axis, radians, and whether a year lies between.
fn divergences(tree: &Skeleton) -> Vec<(f32, bool)> {
    let children = children(tree);
    let mut found = Vec::new();
    for (node, parent) in tree.edges() {
        let [Some(_), Some(one)] = children[parent] else { continue };
        let (Some(other), true) = (children[node][1], tree.orders()[node] == tree.orders()[parent]) else {
            continue;
        };
        if parent == 0 {
            continue;
        }
        // Laterals turn towards the light at once; across the axis they keep their side.
        let axis = heading(tree, node);
        let across = |lateral: usize, along: Vec3| {
            let heading = heading(tree, lateral);
            heading - along * heading.dot(along)
        };
        let before = across(one, heading(tree, parent));
        let carried = (before - axis * before.dot(axis)).normalize_or_zero();
        let after = across(other, axis).normalize_or_zero();
        let angle = math::atan2(carried.cross(after).dot(axis), carried.dot(after));
        found.push((angle, tree.stages()[node] != tree.stages()[parent]));
    }
    found
}

/// At least 95% of all pairs within 5 degrees of the divergence, years included.
#[test]
fn a_spiral_goes_on_from_year_to_year() {
    for divergence in [2.4f32, std::f32::consts::PI] {
        let (mut near, mut all, mut years) = (0, 0, 0);
        for seed in 1..=6 {
            let habit = Habit::default()
                .with_phyllotaxis(Phyllotaxis::Spiral { divergence })
                .with_lateral_angle(0.9)
                .with_optimal_weight(0.0);
            let tree = grown(habit, 9, seed).skeleton().unwrap();
            for (angle, is_year) in divergences(&tree) {
                let off = (angle - divergence).rem_euclid(std::f32::consts::TAU);
                let off = off.min(std::f32::consts::TAU - off);
                near += u32::from(off < 5f32.to_radians());
                all += 1;
                years += u32::from(is_year);
            }
        }
        assert!(near * 100 >= all * 95 && years > 100, "{near} of {all}, {years} over a year");
    }
}

#[test]
fn opposite_and_whorled_laterals() {
    for (count, seed) in [(2u8, 1), (2, 2), (3, 1), (5, 2)] {
        let habit = Habit::default()
            .with_phyllotaxis(Phyllotaxis::Whorled { count })
            .with_lateral_angle(1.0)
            .with_optimal_weight(0.0)
            .with_vigor_model(VigorModel::BorchertHonda { apical_control: 0.6 });
        let tree = grown(habit, 8, seed).skeleton().unwrap();
        // Nodes of one whorl are a fiftieth of a metamer apart.
        let mut angles = Vec::new();
        for (node, parent) in tree.edges() {
            let gap = tree.positions()[node].distance(tree.positions()[parent]);
            if gap < 0.1 * 0.02 {
                angles.push(gap);
            }
        }
        let share = angles.len() as f32 / tree.segments() as f32;
        let expected = f32::from(count - 1) / f32::from(count);
        assert!((share - expected).abs() < 0.05, "{count}: {share}");
        let step = std::f32::consts::TAU / f32::from(count);
        let pairs = divergences(&tree);
        let within = pairs.iter().filter(|(angle, _)| {
            let off = |to: f32| {
                let off = (angle - to).rem_euclid(std::f32::consts::TAU);
                off.min(std::f32::consts::TAU - off)
            };
            off(step).min(off(1.5 * step)) < 5f32.to_radians()
        });
        assert!(within.count() * 100 >= pairs.len() * 95 && pairs.len() > 20, "{count}: {}", pairs.len());
    }
}

/// The axis goes on in the main child: of two that grow in one season it has the lower identity.
#[test]
fn skeletons_know_their_axes() {
    let mut guessed_wrong = 0;
    for seed in 1..=4 {
        let habit = Habit::default().with_vigor_model(VigorModel::BorchertHonda { apical_control: 0.46 });
        let mut tree = SelfOrganizing::new(ShadowPropagation::default(), habit, seed);
        tree.grow(14).unwrap();
        let skeleton = tree.skeleton().unwrap();
        skeleton.check().unwrap();
        let ids: Vec<NodeId> = tree.tree().unwrap().ids().collect();
        let parents =
            (0..skeleton.len()).map(|node| skeleton.parent(node).map(|parent| parent as u32)).collect();
        let guess = Skeleton::new(skeleton.positions().to_vec(), parents).unwrap();
        let guess = guess.with_stages(skeleton.stages().to_vec()).unwrap();
        for children in children(&skeleton) {
            let [Some(main), Some(lateral)] = children else { continue };
            if skeleton.stages()[main] == skeleton.stages()[lateral] {
                assert!(ids[main] < ids[lateral]);
                guessed_wrong += u32::from(guess.orders()[main] > guess.orders()[lateral]);
            }
        }
    }
    assert!(guessed_wrong > 50, "{guessed_wrong}");
}

/// The mean angle, radians, between branches of order 1 and the trunk, over their first three metamers.
fn limb_angle(tree: &Skeleton) -> f32 {
    let mut angles = Vec::new();
    for (node, parent) in tree.edges() {
        if tree.orders()[node] == 1 && tree.orders()[parent] == 0 && parent > 0 {
            angles.push(math::angle_between(heading(tree, node), heading(tree, parent)));
        }
    }
    angles.iter().sum::<f32>() / angles.len() as f32
}

#[test]
fn limbs_stand_at_their_angle() {
    for seed in 1..=4 {
        let limbs = Axis::default().with_angle(60f32.to_radians()).with_optimal_weight(0.0);
        let habit = Habit::default()
            .with_phyllotaxis(Phyllotaxis::Spiral { divergence: 2.4 })
            .with_vigor_model(VigorModel::BorchertHonda { apical_control: 0.55 })
            .with_axes([Axis::default(), limbs]);
        let tree = grown(habit, 10, seed).skeleton().unwrap();
        let angle = limb_angle(&tree).to_degrees();
        assert!((55.0..65.0).contains(&angle), "seed {seed}: {angle} degrees");
    }
}

/// Plagiotropic axes are level, a beech's spray is flat.
#[test]
fn level_axes_are_level() {
    for seed in 1..=4 {
        let limbs = Axis::default().with_angle(1.3).with_level_weight(0.6).with_optimal_weight(0.0);
        let habit = Habit::default()
            .with_phyllotaxis(Phyllotaxis::Spiral { divergence: 2.4 })
            .with_vigor_model(VigorModel::BorchertHonda { apical_control: 0.55 })
            .with_axes([Axis::default(), limbs]);
        let tree = grown(habit, 10, seed).skeleton().unwrap();
        let slopes =
            (1..tree.len()).filter(|&node| tree.orders()[node] > 0).map(|node| heading(&tree, node).y.abs());
        let slopes: Vec<f32> = slopes.collect();
        let mean = slopes.iter().sum::<f32>() / slopes.len() as f32;
        assert!(mean < 0.2 && slopes.len() > 100, "seed {seed}: {mean}");
    }
}

/// In acrotony only the upper laterals of a shoot live; in sympodial growth no axis outlives its flower.
#[test]
fn buds_have_their_fate() {
    for seed in 1..=4 {
        let axis = Axis::default().with_laterals(0.7, 1.0);
        let habit = Habit::default().with_axes([axis]).with_vigor_multiplier(4.0);
        let tree = grown(habit, 4, seed);
        let dormant = tree.tree().unwrap().dormant_buds().filter(|buds| buds[1]).count();
        assert!(dormant * 2 > tree.metamers(), "{dormant} of {}", tree.metamers());
        let axis = Axis::default().with_flowers(true);
        let tree = grown(Habit::default().with_axes([axis]), 8, seed);
        let skeleton = tree.skeleton().unwrap();
        for (node, parent) in skeleton.edges() {
            let years = skeleton.stages()[node] != skeleton.stages()[parent];
            if parent > 0 && years && skeleton.orders()[node] == skeleton.orders()[parent] {
                let siblings = skeleton.edges().filter(|&(_, of)| of == parent).count();
                assert_eq!(siblings, 1, "the lateral has taken over, and is alone");
            }
        }
        assert!(skeleton.len() > 50);
    }
}

/// Branches of an order that has a lifespan fall when it is over.
#[test]
fn branches_have_their_lifespan() {
    for seed in 1..=4 {
        let limbs = Axis::default().with_lifespan(5);
        let tree = grown(Habit::default().with_axes([Axis::default(), limbs]), 12, seed);
        let skeleton = tree.skeleton().unwrap();
        let bases =
            skeleton.edges().filter(|&(node, parent)| skeleton.orders()[node] > skeleton.orders()[parent]);
        let oldest = bases.map(|(node, _)| 12 - skeleton.stages()[node]).max();
        assert!(oldest <= Some(5), "{oldest:?}");
    }
}
