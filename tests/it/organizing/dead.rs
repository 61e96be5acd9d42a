//! Dead wood: trees that die on their feet stand as snags, break from the twigs to the trunk, and fall.

use super::forest_hash;
use treesynth::glam::Vec3;
use treesynth::self_organizing::{
    DeadWood, Environment, Forest, Habit, Offspring, ShadowPropagation, Stature, Tree,
};
use treesynth::shape::Cuboid;

const SEASONS: u16 = 8;

fn habit() -> Habit {
    Habit::default().with_dead_wood(DeadWood::default().with_seasons(SEASONS))
}

/// So close that many starve.
fn thicket(seed: u64, habit: Habit) -> Forest {
    let mut forest = Forest::new(ShadowPropagation::default(), habit, seed);
    for i in 0..49u8 {
        forest.plant(Vec3::new(f32::from(i % 7) * 0.08, 0.0, f32::from(i / 7) * 0.08)).unwrap();
    }
    forest
}

/// The mean branch order of a tree's metamers.
fn mean_order(forest: &Forest, tree: &Tree) -> f32 {
    let skeleton = forest.skeleton(tree).unwrap();
    skeleton.orders().iter().skip(1).map(|&order| f32::from(order)).sum::<f32>() / tree.metamers() as f32
}

/// Each season the thinnest that stands is thicker, orders fall from the high to the low, and in the last all goes.
#[test]
fn snags_break_from_the_twigs_to_the_trunk() {
    for seed in 1..=4 {
        let mut forest = Forest::new(ShadowPropagation::default(), habit(), seed);
        let tree = forest.plant(Vec3::ZERO).unwrap();
        forest.grow(14).unwrap();
        forest.kill(tree).unwrap();
        let (mut metamers, mut order) = (forest.metamers(), mean_order(&forest, &forest.trees()[0]));
        assert!(metamers > 500 && order > 1.0);
        for since in 1..SEASONS {
            forest.step().unwrap();
            let snag = &forest.trees()[0];
            assert_eq!(snag.died(), Some(14));
            let skeleton = forest.skeleton(snag).unwrap();
            skeleton.check().unwrap();
            let (trunk, part) = (skeleton.radii()[1], f32::from(since) / f32::from(SEASONS));
            assert!(skeleton.radii().iter().all(|&radius| radius >= trunk * part * 0.999));
            let left = mean_order(&forest, snag);
            assert!(
                snag.metamers() > 0 && snag.metamers() <= metamers && left <= order,
                "seed {seed}, {since}"
            );
            (metamers, order) = (snag.metamers(), left);
        }
        assert!(order < 0.2, "seed {seed}: mean order {order} of what stands longest");
        forest.step().unwrap();
        assert!(forest.trees().is_empty());
        assert!(*forest.environment() == emptied_light(&forest));
    }
}

/// The light of a forest, told of all that stands at once.
fn emptied_light(forest: &Forest) -> ShadowPropagation {
    let mut light = ShadowPropagation::default();
    let nodes = |dead: bool| -> Vec<Vec3> {
        let trees = forest.trees().iter().filter(|tree| tree.died().is_some() == dead);
        trees.flat_map(Tree::positions).collect()
    };
    light.update_shaded(1.0, &nodes(false), &[]);
    light.update_shaded(0.2, &nodes(true), &[]);
    light
}

/// In a thicket some die; they stand as long as they should without buds, leaves and seeds, and shade a fifth.
#[test]
fn a_thicket_has_snags() {
    let offspring = Offspring::default().with_maturity(8).with_interval(1).with_seeds(0.2);
    for seed in 1..=3 {
        let mut forest = thicket(seed, habit().with_offspring(offspring));
        let (mut snags, mut fallen) = (0, 0);
        for season in 1..=24 {
            let before: Vec<(u32, Option<u16>)> =
                forest.trees().iter().map(|tree| (tree.number(), tree.died())).collect();
            forest.step().unwrap();
            for (number, died) in before {
                let tree = forest.trees().iter().find(|tree| tree.number() == number);
                match (died, tree) {
                    (Some(died), None) => {
                        assert_eq!(season, died + SEASONS, "seed {seed}: tree {number}");
                        fallen += 1;
                    }
                    (Some(died), Some(tree)) => {
                        assert!(tree.died() == Some(died) && season < died + SEASONS);
                        assert!(tree.buds().chain(tree.dormant_buds()).all(|buds| buds == [false; 2]));
                        assert!(tree.leafy(1000, 0).iter().all(|&leafy| !leafy) && tree.vigor() == 0.0);
                    }
                    _ => {}
                }
            }
            snags = snags.max(forest.trees().iter().filter(|tree| tree.died().is_some()).count());
        }
        assert!(snags >= 8 && fallen >= 8, "seed {seed}: {snags} at once, {fallen} fallen");
        assert!(*forest.environment() == emptied_light(&forest));
        // The living and the dead alike can be cut and pruned.
        let snag = forest.trees().iter().find(|tree| tree.died().is_some() && tree.metamers() > 3);
        let (number, node) = snag.map(|tree| (tree.number(), tree.ids().nth(2).unwrap())).unwrap();
        forest.cut(number, node).unwrap();
        forest.prune(&Cuboid::new(Vec3::splat(-1.0), Vec3::new(1.0, 0.2, 1.0))).unwrap();
        assert!(*forest.environment() == emptied_light(&forest));
        let dead = forest.trees().iter().filter(|tree| tree.died().is_some());
        assert!(dead.flat_map(|tree| tree.buds().chain(tree.dormant_buds())).all(|buds| buds == [false; 2]));
    }
}

/// The old die on their feet; without dead wood they are gone at once, and so are seedlings.
#[test]
fn the_old_become_snags() {
    let stature = Stature::default().with_height(1.0).with_pace(6.0).with_lifespan(12);
    let alone = |habit: Habit| {
        let mut forest = Forest::new(ShadowPropagation::default(), habit.with_stature(stature), 1);
        forest.plant(Vec3::ZERO).unwrap();
        forest
    };
    let mut forest = alone(habit());
    while forest.trees()[0].died().is_none() {
        forest.step().unwrap();
    }
    assert!((12..=16).contains(&forest.season()) && forest.metamers() > 20, "{}", forest.metamers());
    let mut forest = alone(Habit::default());
    forest.grow(17).unwrap();
    assert!(forest.trees().is_empty());
    let mut forest = alone(Habit::default());
    forest.grow(4).unwrap();
    forest.kill(0).unwrap();
    assert!(forest.trees().is_empty() && forest.kill(0).is_err());
}

/// Snags are written and read, as text and as bytes, and go on to the same bits; what is no snag is refused.
#[cfg(feature = "json")]
#[test]
fn snags_are_saved() {
    for seed in 1..=3 {
        let mut forest = thicket(seed, habit());
        while forest.trees().iter().filter(|tree| tree.died().is_some()).count() < 4 {
            forest.step().unwrap();
        }
        let season = forest.season();
        let text = serde_json::to_string(&forest).unwrap();
        let mut bytes = Vec::new();
        forest.write_compact(&mut bytes).unwrap();
        let read: Forest = serde_json::from_str(&text).unwrap();
        let compact: Forest = Forest::read_compact(&bytes[..]).unwrap();
        let after = |mut forest: Forest| {
            forest.grow(6).unwrap();
            (forest_hash(&forest), forest)
        };
        let (hash, straight) = after(forest);
        for other in [read, compact] {
            let (read, forest) = after(other);
            assert!(read == hash && forest.trees() == straight.trees());
            assert!(forest.environment() == straight.environment());
        }
        let mut value: serde_json::Value = serde_json::from_str(&text).unwrap();
        let living = value["trees"].as_array().unwrap().iter().position(|tree| tree.get("died").is_none());
        value["trees"][living.unwrap()]["died"] = season.into();
        assert!(serde_json::from_value::<Forest>(value).is_err(), "a snag with buds");
        let mut value: serde_json::Value = serde_json::from_str(&text).unwrap();
        let dead = value["trees"].as_array().unwrap().iter().position(|tree| tree.get("died").is_some());
        value["trees"][dead.unwrap()]["died"] = (season + 1).into();
        assert!(serde_json::from_value::<Forest>(value).is_err(), "a death to come");
    }
}
