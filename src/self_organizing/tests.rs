//! Tests of what only the inside shows: light and vigor at each node.

use super::environment::{Bud, Environment};
use super::room::Room;
use super::season::{Part, Setting};
use super::tree::{BUD, DEAD, Node, Tree, is_node};
use super::vigor::Supply;
use super::*;
use glam::Vec3;
use proptest::prelude::*;

/// A tree grown for so many seasons in the default light, and that light.
fn grown(seed: u64, seasons: u32, habit: Habit) -> (Tree, ShadowPropagation) {
    let mut tree = SelfOrganizing::new(ShadowPropagation::default(), habit, seed);
    tree.grow(seasons).expect("room for a tree");
    (tree.tree().expect("it lives").clone(), tree.environment().clone())
}

fn models() -> [VigorModel; 4] {
    [
        VigorModel::default(),
        VigorModel::BorchertHonda { apical_control: 0.62 },
        VigorModel::Priority { first: 1.0, last: 0.3, part: 0.5 },
        VigorModel::Priority { first: 1.0, last: 1.0, part: 0.0 },
    ]
}

fn bud<'a>(tree: &'a Tree, habit: &'a Habit, node: usize, side: usize) -> Bud<'a> {
    Bud { tree, habit, seed: 0, node: node as u32, lateral: side == 1, index: 0 }
}

fn sensed(tree: &Tree, environment: &impl Environment) -> Supply {
    let (habit, mut supply) = (Habit::default(), Supply::default());
    supply.sense(tree, false, |node, side| environment.light(&bud(tree, &habit, node, side)));
    supply
}

/// Parents, children and numbers fit together.
fn assert_sound(tree: &Tree) {
    for (i, node) in tree.nodes.iter().enumerate().skip(1) {
        assert!((node.parent as usize) < i);
        assert_eq!(
            tree.nodes[node.parent as usize].children.iter().filter(|&&child| child == i as u32).count(),
            1
        );
        assert!(node.number < tree.next_number);
    }
    let borne = tree.nodes.iter().flat_map(|node| node.children).filter(|&child| is_node(child)).count();
    assert_eq!(borne, tree.metamers());
}

#[test]
fn light_is_the_sum_over_all_buds_above() {
    for seed in 0..3 {
        let (tree, light) = grown(seed, 12, Habit::default());
        let supply = sensed(&tree, &light);
        let mut sums = vec![0.0f64; tree.nodes.len()];
        let mut buds = 0;
        for node in 0..tree.nodes.len() {
            for side in 0..2 {
                if tree.nodes[node].children[side] == BUD {
                    let here = light.shadow(tree.nodes[node].position);
                    let mut below = node;
                    buds += 1;
                    loop {
                        sums[below] += f64::from((2.5 - here + 0.8).max(0.0));
                        if below == 0 {
                            break;
                        }
                        below = tree.nodes[below].parent as usize;
                    }
                }
            }
        }
        assert!(buds > 1000);
        for (node, &sum) in sums.iter().enumerate() {
            assert!((f64::from(supply.light[node]) - sum).abs() <= 1e-4 * sum.max(1.0), "node {node}");
        }
    }
}

#[test]
fn vigor_is_conserved_at_each_fork() {
    for model in models() {
        let (tree, light) = grown(3, 11, Habit::default().with_vigor_model(model));
        assert_sound(&tree);
        let mut supply = sensed(&tree, &light);
        let root = 2.0 * supply.light[0];
        let mut handed = vec![0.0f64; tree.nodes.len()];
        let mut buds = 0.0;
        supply.share(&tree, model, root, &mut |node, _, vigor| {
            handed[node] += f64::from(vigor);
            buds += f64::from(vigor);
        });
        for (node, data) in tree.nodes.iter().enumerate().skip(1) {
            handed[data.parent as usize] += f64::from(supply.vigor[node]);
        }
        for (node, &sum) in handed.iter().enumerate() {
            let vigor = f64::from(supply.vigor[node]);
            assert!(
                (vigor - sum).abs() <= 1e-4 * vigor.max(1e-3),
                "{model:?}: {vigor} became {sum} at {node}"
            );
        }
        assert!((buds - f64::from(root)).abs() < 1e-3 * f64::from(root));
    }
}

/// A trunk node with a branch of three buds at its side and a branch of four on top; light 1 a bud.
fn by_hand() -> Tree {
    let node = |y: f32, parent: u32, children: [u32; 2], number: u32| Node {
        position: Vec3::Y * y,
        parent,
        children,
        count: 1,
        load: 1,
        number,
        born: 1,
        azimuth: 0,
        order: 0,
    };
    let mut tree = Tree::new(Vec3::ZERO, 0, 0, 0, 0);
    tree.next_number = 9;
    tree.nodes = vec![
        node(0.0, 0, [1, DEAD], 0),
        node(1.0, 0, [2, 3], 1),
        node(2.0, 1, [4, 5], 2),
        node(2.0, 1, [BUD, 6], 3),
        node(3.0, 2, [BUD; 2], 4),
        node(3.0, 2, [BUD; 2], 5),
        node(3.0, 3, [BUD; 2], 6),
    ];
    tree
}

fn shared(tree: &Tree, model: VigorModel, root: f32) -> Supply {
    let mut supply = Supply::default();
    supply.sense(tree, true, |_, _| 1.0);
    supply.share(tree, model, root, &mut |_, _, _| {});
    supply
}

#[test]
fn borchert_honda_by_hand() {
    let tree = by_hand();
    let supply = shared(&tree, VigorModel::BorchertHonda { apical_control: 0.6 }, 18.0);
    assert_eq!(supply.light, [7.0, 7.0, 4.0, 3.0, 2.0, 2.0, 2.0]);
    // Main 0.6 · 4 = 2.4, lateral 0.4 · 3 = 1.2: two thirds and one third of 18.
    assert!((supply.vigor[2] - 12.0).abs() < 1e-5 && (supply.vigor[3] - 6.0).abs() < 1e-5);
    // Main a bud, 0.6 · 1; lateral 0.4 · 2: four sevenths of 6.
    assert!((supply.vigor[6] - 6.0 * 4.0 / 7.0).abs() < 1e-5);
}

#[test]
fn priority_by_hand() {
    let tree = by_hand();
    // The axis 0, 1, 2, 4 feeds its terminal bud (light 1, weight 4), and then by mean light per bud, all 1, from
    // below: 3 (light 3), 5 (light 2) and the lateral bud of 4 (light 1), each of weight 1.
    let supply = shared(&tree, VigorModel::Priority { first: 4.0, last: 1.0, part: 0.0 }, 20.0);
    assert!((supply.vigor[3] - 6.0).abs() < 1e-5, "{:?}", supply.vigor);
    assert!((supply.vigor[5] - 4.0).abs() < 1e-5);
    assert!((supply.vigor[4] - 10.0).abs() < 1e-5);
    assert!((supply.vigor[2] - 14.0).abs() < 1e-5);
    // The axis 3 has its terminal (light 1, weight 4) and 6 (light 2, weight 1): a third of 6.
    assert!((supply.vigor[6] - 2.0).abs() < 1e-5);
}

/// A lateral points within 45° of its metamer when scattered, and at exactly the angle in a spiral.
#[test]
fn laterals_keep_their_angle() {
    let (tree, _) = grown(5, 8, Habit::default());
    let spiral = Habit::default()
        .with_lateral_angle(1.0)
        .with_phyllotaxis(Phyllotaxis::Spiral { divergence: std::f32::consts::PI });
    let scattered = Habit::default();
    let angle = |habit: &Habit, node: u32| {
        crate::math::angle_between(tree.direction(node), tree.lateral_direction(node, habit, 5))
    };
    let angles: Vec<f32> = (1..tree.nodes.len() as u32).map(|node| angle(&scattered, node)).collect();
    assert!(angles.iter().all(|angle| *angle <= std::f32::consts::FRAC_PI_4 + 1e-3));
    assert!(angles.iter().any(|angle| *angle > 0.7) && angles.iter().any(|angle| *angle < 0.2));
    assert!((1..tree.nodes.len() as u32).all(|node| (angle(&spiral, node) - 1.0).abs() < 1e-3));
}

/// Step 3: a shoot of vigor v has floor(v) metamers, v times the base length in all.
#[test]
fn shoots_are_as_long_as_their_vigor() {
    let habit = Habit::default().with_vigor_multiplier(3.0).with_shedding(None);
    let mut tree = SelfOrganizing::new(ShadowPropagation::default(), habit, 1);
    tree.step().expect("room");
    // One bud in full light: 3 · 2.5 = 7.5.
    let top = tree.tree().expect("it lives").positions().last().expect("nodes");
    assert_eq!(tree.metamers(), 7);
    assert!((top.y - 7.5 * 0.02).abs() < 1e-5, "{top}");
}

/// Step 4: what has less vigor than multiplier · (child count^(1/n))^exponent falls after its grace, nothing else.
#[test]
fn shedding_follows_the_rule() {
    let mut tree = by_hand();
    for (node, count) in tree.nodes.iter_mut().zip([7, 7, 4, 32, 2, 2, 2]) {
        node.load = count;
    }
    let habit = |multiplier: f32| {
        let shedding = Shedding::default().with_multiplier(multiplier).with_grace(3);
        Habit::default().with_vigor_multiplier(18.0 / 7.0).with_shedding(shedding)
    };
    // λ = 0.5 gives node 3 a vigor of 18 · 3 / 7 = 7.71; it needs multiplier · 32^(1.5 / 2.5) = 8 multipliers.
    let shed = |multiplier: f32, season: u16| {
        struct Even;
        impl Environment for Even {
            fn light(&self, _: &Bud<'_>) -> f32 {
                1.0
            }
            fn direction(&self, _: &Bud<'_>) -> Vec3 {
                Vec3::Y
            }
        }
        let (mut tree, habit) = (tree.clone(), habit(multiplier));
        let room = Room::default();
        let setting = Setting { environment: &Even, room: &room, habit: &habit, seed: 1, season };
        let mut plan = tree.plan(&setting, 0, 1);
        let change = tree.carry_out(Part { index: 0, of: 1 }, &mut plan, &setting);
        assert_sound(&tree);
        change.fallen.len()
    };
    assert_eq!(shed(0.95, 4), 0);
    assert_eq!(shed(0.97, 4), 2, "node 3 and what it bears");
    assert_eq!(shed(0.97, 3), 0, "the grace is 3 seasons");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any growth and cutting leaves a tree whose parts fit together and whose counts never fall towards the foot.
    #[test]
    fn trees_stay_sound(seed: u64, cuts in prop::collection::vec((1u32..4, any::<prop::sample::Index>()), 0..6)) {
        let mut tree = SelfOrganizing::new(ShadowPropagation::default(), Habit::default(), seed);
        tree.grow(5).unwrap();
        for (seasons, node) in cuts {
            let nodes = tree.metamers();
            if nodes > 0 {
                let node = tree.tree().unwrap().ids().nth(1 + node.index(nodes)).unwrap();
                tree.cut(node).unwrap();
            }
            tree.grow(seasons).unwrap();
            let Some(tree) = tree.tree() else { break };
            assert_sound(tree);
            for node in &tree.nodes[1..] {
                let parent = tree.nodes[node.parent as usize];
                prop_assert!(node.count <= parent.count && node.load <= parent.load && node.load <= node.count);
            }
            tree.skeleton().unwrap().check().unwrap();
        }
    }
}

#[test]
fn seeds_are_counted_even_of_endless_vigor() {
    let offspring = Offspring::default().with_maturity(0).with_seeds(1000.0);
    let seeds = offspring.sow(Vec3::ZERO, f32::INFINITY, 4, 1, 0);
    assert!((88_000..90_000).contains(&seeds.len()), "{}", seeds.len());
    assert!(seeds.iter().all(|seed| seed.is_finite()));
}

#[test]
fn leaves_grow_where_few_buds_are_borne_and_not_near_the_foot() {
    let (tree, _) = grown(3, 9, Habit::default());
    let (skeleton, counts) = (tree.skeleton().unwrap(), tree.child_counts().collect::<Vec<_>>());
    for (most, least) in [(0, 0), (3, 0), (10, 4), (u32::MAX, 6), (u32::MAX, 0)] {
        let leafy = tree.leafy(most, least);
        assert_eq!(leafy.len(), skeleton.len());
        assert!(!leafy[0]);
        for (node, parent) in skeleton.edges() {
            let siblings = skeleton.edges().filter(|&(_, other)| other == parent);
            let dominant = siblings.map(|(child, _)| counts[child]).max().unwrap();
            assert_eq!(leafy[node], skeleton.hops()[parent] >= least && dominant < most, "{node}");
        }
    }
}
