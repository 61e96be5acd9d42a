//! Cuts, and what grows after them; ages.

use treesynth::glam::Vec3;
use treesynth::self_organizing::{
    DeadWood, Environment, Forest, ForestError, Habit, NodeId, SelfOrganizing, ShadowPropagation, Stature,
    Tree,
};
use treesynth::shape::Cuboid;
use treesynth::{Bounds, Shape};

fn grown(seed: u64, seasons: u32) -> SelfOrganizing {
    let mut tree = SelfOrganizing::new(ShadowPropagation::default(), Habit::default(), seed);
    tree.grow(seasons).unwrap();
    tree
}

/// Identities last: nodes named before a cut are the same after it, in whatever order they are cut.
#[test]
fn identities_last() {
    for seed in 1..=4 {
        let mut tree = grown(seed, 10);
        let standing = tree.tree().unwrap();
        let line = 0.6 * standing.positions().map(|node| node.y).fold(0.0, f32::max);
        let named: Vec<(NodeId, Vec3)> = standing.ids().zip(standing.positions()).collect();
        for &(id, place) in &named {
            if place.y > line {
                let stands = tree.tree().unwrap().index_of(id).is_some();
                assert_eq!(tree.cut(id).is_ok(), stands);
            }
        }
        let standing = tree.tree().unwrap();
        assert!(standing.positions().all(|node| node.y <= line));
        tree.grow(4).unwrap();
        let standing = tree.tree().unwrap();
        let mut kept = 0;
        for (id, place) in named {
            if let Some(index) = standing.index_of(id) {
                assert_eq!(standing.positions().nth(index), Some(place));
                kept += 1;
            }
        }
        assert!(kept > 20);
    }
}

/// A cut leader has a successor within two seasons in nine of ten trees: a shoot that begins at the cut or within
/// eight nodes below, and rises above it.
#[test]
fn a_cut_leader_has_a_successor() {
    let mut successors = 0;
    for seed in 1..=20 {
        let mut tree = grown(seed, 9);
        let skeleton = tree.skeleton().unwrap();
        let leader: Vec<usize> = (1..skeleton.len()).filter(|&node| skeleton.orders()[node] == 0).collect();
        let cut = leader[leader.len() / 2];
        let stump = skeleton.positions()[skeleton.parent(cut).unwrap()];
        let id = tree.tree().unwrap().ids().nth(cut).unwrap();
        tree.cut(id).unwrap();
        tree.grow(2).unwrap();
        let skeleton = tree.skeleton().unwrap();
        let rises = |node: usize| {
            let place = skeleton.positions()[node];
            skeleton.stages()[node] > 9 && place.y > stump.y + 0.02 && place.distance(stump) < 0.25
        };
        successors += u32::from((1..skeleton.len()).any(rises));
    }
    assert!(successors >= 18, "{successors} of 20");
}

/// A limb cut back bears shoots again, wherever it is.
#[test]
fn a_cut_limb_sprouts() {
    let mut sprouted = 0;
    let mut limbs = 0;
    for seed in 1..=8 {
        let tree = grown(seed, 12);
        let skeleton = tree.skeleton().unwrap();
        let thick = |&node: &usize| skeleton.orders()[node] > 0 && skeleton.radii()[node] > 4.0 * 0.0005;
        for node in (1..skeleton.len()).filter(thick).step_by(7).take(6) {
            let mut tree = tree.clone();
            let id = tree.tree().unwrap().ids().nth(node).unwrap();
            let stump = skeleton.positions()[skeleton.parent(node).unwrap()];
            tree.cut(id).unwrap();
            tree.step().unwrap();
            let standing = tree.skeleton().unwrap();
            limbs += 1;
            let fresh = |other: usize| {
                standing.stages()[other] == 13
                    && standing.positions()[standing.parent(other).unwrap()] == stump
            };
            sprouted += u32::from((1..standing.len()).any(fresh));
        }
    }
    assert!(sprouted * 10 >= limbs * 9 && limbs > 20, "{sprouted} of {limbs}");
}

/// A tree that is cut at its foot, and has no light to sprout from, is buried after its grace; removed trees go at once.
#[test]
fn felled_trees_go() {
    for seed in 1..=4 {
        let mut forest = Forest::new(ShadowPropagation::default(), Habit::default(), seed);
        forest.plant(Vec3::ZERO).unwrap();
        forest.plant(Vec3::X * 0.5).unwrap();
        forest.grow(6).unwrap();
        let first = forest.trees()[0].ids().nth(1).unwrap();
        forest.cut(0, first).unwrap();
        assert_eq!(forest.trees()[0].metamers(), 0);
        forest.habits_mut()[0] = Habit::default().with_vigor_multiplier(0.0).with_regrowth(None);
        forest.grow(6).unwrap();
        assert!(forest.trees().iter().all(|tree| tree.number() != 0));
        let mut forest = Forest::new(ShadowPropagation::default(), Habit::default(), seed);
        let number = forest.plant(Vec3::ZERO).unwrap();
        forest.grow(8).unwrap();
        let metamers = forest.metamers();
        let nodes: Vec<Vec3> = forest.trees()[0].positions().collect();
        assert_eq!(forest.remove(number), Ok(metamers));
        assert!(forest.trees().is_empty() && forest.remove(number).is_err());
        assert!(nodes.iter().all(|&node| forest.environment().shadow(node) == 0.0));
    }
}

/// Nothing is left outside of the shape, shadows are those of what stands, and it grows again.
#[test]
fn pruning_keeps_a_shape() {
    let shape = Cuboid::new(Vec3::new(-0.3, -0.1, -0.3), Vec3::new(0.3, 0.5, 0.3));
    for seed in 1..=4 {
        let mut tree = grown(seed, 12);
        let before = tree.metamers();
        let fallen = tree.prune(&shape).unwrap();
        assert_eq!(before, tree.metamers() + fallen);
        let standing: Vec<Vec3> = tree.tree().unwrap().positions().collect();
        assert!(standing.iter().all(|&node| shape.contains(node)));
        let mut fresh = ShadowPropagation::default();
        fresh.update(&standing, &[]);
        assert!(*tree.environment() == fresh);
        tree.skeleton().unwrap().check().unwrap();
        let left = tree.metamers();
        tree.grow(1).unwrap();
        assert!(tree.metamers() > left);
    }
}

fn top(tree: &Tree) -> f32 {
    tree.positions().map(|node| node.y).fold(0.0, f32::max)
}

/// Height follows the curve, within a tenth, and ends at its limit; the old die.
#[test]
fn height_follows_its_curve() {
    let bounds = Bounds::new(Vec3::new(-4.0, 0.0, -4.0), Vec3::new(4.0, 9.0, 4.0));
    let stature = Stature::default().with_height(6.0).with_pace(12.0).with_lifespan(60);
    for seed in 1..=4 {
        let habit = Habit::default().with_length(0.1).with_stature(stature);
        let mut tree = SelfOrganizing::new(ShadowPropagation::new(bounds).with_cell(0.1), habit, seed);
        for age in (10..=60).step_by(10) {
            tree.grow(10).unwrap();
            let (height, wanted) = (tree.tree().map_or(0.0, top), stature.height_at(age));
            assert!(
                height <= wanted + 1e-3 && height > 0.9 * wanted,
                "seed {seed}: {height} m at {age}, {wanted} m"
            );
        }
        tree.grow(20).unwrap();
        assert!(tree.tree().is_none(), "seed {seed}: it has died of age");
    }
}

/// Four trees far from each other, in a season that was broken off once the first had grown.
fn broken_off(seed: u64) -> Forest {
    let habit = Habit::default().with_dead_wood(DeadWood::default().with_seasons(4));
    let mut forest = Forest::new(ShadowPropagation::default(), habit, seed);
    for i in 0..4u8 {
        forest.plant(Vec3::X * 6.0 * f32::from(i)).unwrap();
    }
    forest.grow(8).unwrap();
    let whole = forest.metamers();
    for most in (whole..).step_by(10) {
        let mut tried = forest.clone().with_most_metamers(most);
        assert!(matches!(tried.step(), Err(ForestError::Limit { .. })));
        if tried.trees()[0] != forest.trees()[0] {
            return tried.with_most_metamers(1_000_000);
        }
    }
    unreachable!("the first tree grows")
}

/// Work done while a season is broken off is, for a tree that has had its turn, work after that season; and the forest can be
/// saved then.
#[test]
fn work_in_mid_season_is_work_after_it() {
    let works: [fn(&mut Forest); 4] = [
        |forest| assert_eq!(forest.plant(Vec3::Z * 6.0), Ok(4)),
        |forest| forest.kill(0).unwrap(),
        |forest| {
            let node = forest.trees()[0].ids().nth(3).unwrap();
            forest.cut(0, node).unwrap();
        },
        |forest| {
            let low = Cuboid::new(Vec3::new(-1.0, -1.0, -1.0), Vec3::new(1.0, 0.1, 1.0));
            let rest = Cuboid::new(Vec3::new(1.0, -1.0, -9.0), Vec3::new(99.0, 9.0, 9.0));
            assert!(forest.prune(&treesynth::shape::Union::new(low, rest)).unwrap() > 0);
        },
    ];
    for seed in 1..=4 {
        for (number, work) in works.iter().enumerate() {
            let mut during = broken_off(seed);
            let mut after = during.clone();
            work(&mut during);
            #[cfg(feature = "json")]
            {
                let text = serde_json::to_string(&during).unwrap();
                let read: Forest =
                    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{number}: {error}"));
                assert_eq!(read.trees(), during.trees());
                during = read;
            }
            during.step().unwrap();
            after.step().unwrap();
            work(&mut after);
            for _ in 0..6 {
                let of_it = |forest: &Forest| {
                    let trees = forest.trees().iter().filter(|tree| tree.number() % 4 == 0);
                    trees.cloned().collect::<Vec<Tree>>()
                };
                assert_eq!(of_it(&during), of_it(&after), "seed {seed}, work {number}");
                during.step().unwrap();
                after.step().unwrap();
            }
        }
    }
}
