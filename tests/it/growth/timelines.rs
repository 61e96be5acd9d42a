//! Trees of the other systems, grown year by year.

use proptest::prelude::*;
use treesynth::glam::Vec3;
use treesynth::growth::Timeline;
use treesynth::{Skeleton, presets};

fn elm() -> Skeleton {
    presets::by_name("figure-07")
        .expect("a preset")
        .guided()
        .unwrap()
        .synth(3000)
        .synthesize(1)
        .expect("a tree")
}

/// A stem of 2 m whose foot is 3 cm thick and whose top 1 cm, with a side branch of 1 m as thick as the top.
fn fork() -> Skeleton {
    let nodes = vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::new(1.0, 1.0, 0.0)];
    let skeleton = Skeleton::new(nodes, vec![None, Some(0), Some(1), Some(1)]).expect("a fork");
    skeleton.with_radii(vec![0.03, 0.02, 0.01, 0.01]).expect("radii")
}

/// Births by hand, in 10 years. By distance alone the fork is reached at 5, both tips at 10. By radius the
/// fork, half way between the thinnest and the foot, is 5 years old too.
#[test]
fn births_by_hand() {
    let timeline = Timeline::new(fork(), 10.0).expect("a timeline");
    assert_eq!(timeline.births(), [0.0, 5.0, 10.0, 10.0]);
    let thick = fork().with_radii(vec![0.03, 0.025, 0.01, 0.02]).expect("radii");
    let timeline = Timeline::new(thick, 10.0).expect("a timeline");
    // The fork: 0.5·0.5 + 0.5·0.25. The thick tip: 0.5·1 + 0.5·0.5.
    for (birth, expected) in timeline.births().iter().zip([0.0, 3.75, 10.0, 7.5]) {
        assert!((birth - expected).abs() < 1e-5, "{birth} instead of {expected}");
    }
    let by_distance = timeline.with_radius_share(0.0).expect("in range");
    assert_eq!(by_distance.births(), [0.0, 5.0, 10.0, 10.0]);
    let tree = by_distance.at(7.5).expect("a tree");
    assert_eq!(tree.positions(), [Vec3::ZERO, Vec3::Y, Vec3::Y * 1.5, Vec3::new(0.5, 1.0, 0.0)]);
    assert_eq!((tree.stages(), tree.orders()), (&[0, 1, 6, 6][..], &[0, 0, 0, 1][..]));
    // The foot has had 7.5 of its 10 rings, the tips half of theirs: they began in year 5.
    for (radius, expected) in tree.radii().iter().zip([0.025, 0.021_25, 0.01, 0.015]) {
        assert!((radius - expected).abs() < 1e-6, "{radius}");
    }
}

#[test]
fn the_last_age_is_the_tree_itself() {
    let elm = elm();
    let timeline = Timeline::new(elm.clone(), 60.0).expect("a timeline");
    let whole = timeline.at(60.0).expect("a tree");
    assert_eq!(
        (whole.positions(), whole.orders(), whole.hops()),
        (elm.positions(), elm.orders(), elm.hops())
    );
    for (old, radius) in elm.radii().iter().zip(whole.radii()) {
        assert!((old - radius).abs() < 1e-6);
    }
    assert_eq!(timeline.at(0.0).expect("a root").len(), 1);
}

#[test]
fn what_cannot_be_is_named() {
    for years in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e5] {
        let error = Timeline::new(fork(), years).expect_err("no such time");
        assert!(error.to_string().starts_with("Timeline.years is "), "{error}");
    }
    let timeline = Timeline::new(fork(), 10.0).expect("a timeline");
    for age in [-0.1, 10.1, f32::NAN] {
        let error = timeline.at(age).expect_err("no such age").to_string();
        assert!(error.starts_with("Timeline.age is ") && error.ends_with("0 to 10.0 years"), "{error}");
    }
    for share in [-0.1, 1.0, f32::NAN] {
        assert!(timeline.clone().with_radius_share(share).is_err());
    }
}

/// A root alone, all nodes in one place, no radii, and distances beyond 32-bit floats.
#[test]
fn degenerate_trees_have_timelines() {
    let root = Skeleton::new(vec![Vec3::ZERO], vec![None]).expect("a root");
    let point = Skeleton::new(vec![Vec3::ZERO; 3], vec![None, Some(0), Some(1)]).expect("a point");
    let far = [Vec3::ZERO, Vec3::splat(3e38), Vec3::splat(-3e38)];
    let far = Skeleton::new(far.to_vec(), vec![None, Some(0), Some(1)]).expect("a tree");
    for skeleton in [root, point, far] {
        let timeline = Timeline::new(skeleton.clone(), 5.0).expect("a timeline");
        assert!(timeline.births().iter().all(|birth| (0.0..=5.0).contains(birth)));
        assert_eq!(timeline.at(5.0).expect("the tree").positions(), skeleton.positions());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Nodes come and stay, radii and stages never fall, and no tip outruns the bound.
    #[test]
    fn growth_is_monotone_and_continuous(skeleton in treesynth::testing::skeletons(60), share in 0.0f32..0.9, age in 0.0f32..19.0) {
        let timeline = Timeline::new(skeleton, 20.0).expect("a timeline").with_radius_share(share).expect("in range");
        for (node, parent) in timeline.skeleton().edges() {
            prop_assert!(timeline.births()[node] >= timeline.births()[parent]);
        }
        let step = 0.01;
        let [before, after] = [age, age + step].map(|age| timeline.standing(age).expect("in range"));
        let [young, old] = [age, age + step].map(|age| timeline.at(age).expect("a tree"));
        prop_assert_eq!(young.check(), Ok(()));
        let whole = timeline.skeleton();
        let mut way = vec![0.0f32; whole.len()];
        for (node, parent) in whole.edges() {
            way[node] = way[parent] + whole.positions()[node].distance(whole.positions()[parent]);
        }
        let longest = way.iter().copied().fold(0.0, f32::max);
        let farthest = step * longest / (20.0 * (1.0 - share)) * 1.05 + 1e-4 * longest;
        for (place, node) in before.iter().enumerate() {
            let later = after.binary_search(node);
            prop_assert!(later.is_ok(), "node {} is gone", node);
            let later = later.unwrap_or_default();
            prop_assert!(young.positions()[place].distance(old.positions()[later]) <= farthest);
            prop_assert!(old.radii()[later] >= young.radii()[place] - 1e-6);
            prop_assert_eq!((old.stages()[later], old.orders()[later]), (young.stages()[place], young.orders()[place]));
        }
    }
}
