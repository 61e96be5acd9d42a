//! A forest that is stopped anywhere, by anything, can be written, read, and goes on to the same bits.

use super::forest_hash;
use super::growth::stand;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use treesynth::Progress;
use treesynth::glam::Vec3;
use treesynth::self_organizing::{
    Environment, Forest, ForestError, Habit, Offspring, ShadowPropagation, SpaceColonization,
};
use treesynth::shape::{Cuboid, Sphere};

fn reread(forest: &Forest) -> Forest {
    let text = serde_json::to_string(forest).expect("a forest can be written");
    serde_json::from_str(&text).expect("what was just written")
}

pub(super) fn finish<E: Environment>(mut forest: Forest<E>, seasons: u16) -> u64 {
    while forest.season() < seasons {
        forest.step().expect("no limit is near");
    }
    forest_hash(&forest)
}

/// A stand whose growth an observer stops at this report.
pub(super) fn stopped_at(seed: u64, stop: usize) -> Forest {
    let calls = AtomicUsize::new(0);
    let watch = |_: Progress| match calls.fetch_add(1, Ordering::Relaxed) {
        call if call == stop => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    };
    let mut forest = stand(seed);
    assert_eq!(forest.grow_observed(8, &watch), Err(ForestError::Cancelled));
    forest
}

/// Stopped by an observer at each of its reports, between turns too.
#[test]
fn cancelled_anywhere() {
    for seed in 1..=3 {
        let straight = finish(stand(seed), 8);
        for stop in 0..40 {
            let forest = stopped_at(seed, stop);
            assert_eq!(finish(reread(&forest), 8), straight, "seed {seed}, stopped at report {stop}");
        }
    }
}

/// Stopped by the limit of metamers, in whichever turn.
#[test]
fn stopped_by_the_limit() {
    let (mut in_season, straight) = (0, finish(stand(5), 9));
    for limit in 0..40 {
        let mut forest = stand(5).with_most_metamers(300 + 50 * limit);
        assert!(matches!(forest.grow(30), Err(ForestError::Limit { .. })));
        let text = serde_json::to_value(&forest).expect("a forest can be written");
        in_season += u32::from(text["turn"] != 0);
        if forest.season() < 9 {
            assert_eq!(finish(reread(&forest).with_most_metamers(100_000), 9), straight, "limit {limit}");
        }
    }
    assert!(in_season >= 5, "{in_season} in mid-season");
}

#[test]
fn cut_pruned_planted_and_in_the_other_environment() {
    for seed in 1..=4 {
        let mut forest = stand(seed);
        forest.grow(7).expect("no limit is near");
        let node = forest.trees()[0].ids().nth(5).expect("it has grown");
        forest.cut(0, node).expect("it stands");
        forest.prune(&Sphere::new(Vec3::ZERO, 0.45)).expect("a sound shape");
        forest.remove(3).expect("it stands");
        forest.plant(Vec3::new(0.2, 0.0, 0.2)).expect("there is room");
        assert_eq!(finish(reread(&forest), 12), finish(forest, 12));
        let ball = Sphere::new(Vec3::Y * 0.5, 0.5);
        let space = SpaceColonization::in_shape(&ball, 1500, seed).expect("a sound shape");
        let mut forest = Forest::new(space, Habit::default(), seed);
        forest.plant(Vec3::ZERO).expect("there is room");
        forest.grow(6).expect("no limit is near");
        let text = serde_json::to_string(&forest).expect("a forest can be written");
        let read: Forest<SpaceColonization> = serde_json::from_str(&text).expect("what was just written");
        assert_eq!(finish(read, 12), finish(forest, 12));
    }
}

/// Light that has no end is not written as a vigor that cannot be read.
#[test]
fn under_endless_light() {
    let light = ShadowPropagation::default().with_full_exposure(1e6);
    let mut forest = Forest::new(light, Habit::default().with_vigor_multiplier(1e6), 1);
    forest.plant(Vec3::ZERO).expect("there is room");
    assert!(forest.grow(1).is_err());
    drop(reread(&forest));
}

/// Two environments are equal if one is read from the other's text.
#[test]
fn environments_are_equal_once_read() {
    let mut forest = stand(2);
    forest.grow(9).expect("no limit is near");
    assert!(*reread(&forest).environment() == *forest.environment());
    let node = forest.trees()[0].ids().nth(2).expect("it has grown");
    let whole = reread(&forest);
    forest.cut(0, node).expect("it stands");
    assert!(*reread(&forest).environment() == *forest.environment());
    assert!(*whole.environment() != *forest.environment());
}

/// A forest without its obstacles, envelopes or ground is not the same forest.
#[test]
fn shapes_must_be_added_again() {
    let wall = || Cuboid::new(Vec3::new(0.2, 0.0, -1.0), Vec3::new(0.3, 1.0, 1.0));
    let slope = |x: f32, _: f32| 0.2 * x;
    let mut forest = stand(1).with_terrain(slope).with_obstacle(wall());
    forest.grow(3).expect("no limit is near");
    let named = |forest: Forest, parameter: &str| match forest.clone().step() {
        Err(ForestError::Parameter(error)) => assert_eq!(error.parameter, parameter),
        other => panic!("{other:?}"),
    };
    named(reread(&forest), "Forest.obstacles");
    named(reread(&forest).with_obstacle(wall()), "Forest.terrain");
    named(
        reread(&forest).with_obstacle(Sphere::new(Vec3::X * 5.0, 1.0)).with_terrain(slope),
        "Forest.obstacles",
    );
    named(reread(&forest).with_obstacle(wall()).with_terrain(|_: f32, _: f32| 0.0), "Forest.terrain");
    let whole = reread(&forest).with_terrain(slope).with_obstacle(wall());
    assert_eq!(finish(whole, 9), finish(forest, 9));
}

#[test]
fn files_that_cannot_be_are_refused() {
    let mut forest = Forest::new(ShadowPropagation::default(), Habit::default(), 1);
    forest.plant(Vec3::ZERO).expect("there is room");
    forest.grow(6).expect("no limit is near");
    let good = serde_json::to_value(&forest).expect("a forest can be written");
    let refused = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut bad = good.clone();
        change(&mut bad);
        assert!(serde_json::from_value::<Forest>(bad).is_err());
    };
    // A twig thicker than its trunk, more to pay for than its width, below the ground, of no number.
    refused(&|forest| forest["trees"][0]["nodes"][9]["count"] = 1_000_000.into());
    refused(&|forest| forest["trees"][0]["nodes"][9]["load"] = 1_000_000.into());
    refused(&|forest| forest["trees"][0]["nodes"][9]["position"][1] = (-1.0).into());
    refused(&|forest| forest["trees"][0]["nodes"][9]["number"] = 2.into());
    refused(&|forest| forest["trees"][0]["nodes"][9]["born"] = 0.into());
    // At the limit of numbers a tree can be read, but none planted.
    let mut last = good.clone();
    last["next_tree"] = u32::MAX.into();
    let mut last: Forest = serde_json::from_value(last).expect("it can be");
    assert!(last.plant(Vec3::X * 0.5).is_err());
}

/// Only its own metamers are counted, and seeds do not make another tree of it.
#[test]
fn one_tree_is_one_tree() {
    let offspring = Offspring::default().with_maturity(4).with_interval(1).with_seeds(2.0);
    let mut tree = treesynth::SelfOrganizing::new(
        ShadowPropagation::default(),
        Habit::default().with_offspring(offspring),
        3,
    );
    tree.grow(9).expect("no limit is near");
    assert_eq!(tree.metamers(), tree.skeleton().expect("radii").segments());
}
