//! What each preset shows, as a number.

use super::forest_hash;
use std::collections::{BTreeMap, BTreeSet};
use treesynth::glam::Vec3;
use treesynth::self_organizing::{Forest, Tree};
use treesynth::shape::{Cuboid, Sphere};
use treesynth::{Metrics, Shape, Skeleton, presets};

fn grown(name: &str, seed: u64) -> Forest {
    presets::by_name(name).expect("a stand of this name").stand().unwrap().grow(seed).expect("it grows")
}

fn alone(name: &str, seed: u64) -> Skeleton {
    grown(name, seed).skeletons().expect("radii")[0].clone()
}

/// The mean of `measure` over trees of four seeds.
fn mean(name: &str, measure: impl Fn(&Skeleton) -> f64) -> f64 {
    (1..=4).map(|seed| measure(&alone(name, seed))).sum::<f64>() / 4.0
}

fn slenderness(tree: &Skeleton) -> f64 {
    let metrics = Metrics::of(tree);
    metrics.height / metrics.crown_width
}

/// The share of internodes that are headed downwards.
fn hanging(tree: &Skeleton) -> f64 {
    let down = tree.edges().filter(|&(child, parent)| tree.positions()[child].y < tree.positions()[parent].y);
    down.count() as f64 / tree.segments() as f64
}

/// The middle of all nodes.
fn middle(tree: &Skeleton) -> Vec3 {
    tree.positions().iter().sum::<Vec3>() / tree.len() as f32
}

#[test]
fn slenderness_rises_with_apical_control() {
    let [excurrent, between, decurrent] =
        ["stand-excurrent", "stand-between", "stand-decurrent"].map(|name| mean(name, slenderness));
    assert!(excurrent > 1.25 * between && between > 1.25 * decurrent, "{excurrent} {between} {decurrent}");
}

#[test]
fn a_weeping_tree_hangs() {
    assert!(mean("stand-weeping", hanging) > 0.5);
    assert!(mean("stand-between", hanging) < 0.02);
}

#[test]
fn the_wind_blows_to_the_right() {
    let leaning = |name: &str| mean(name, |tree| f64::from(middle(tree).x) / Metrics::of(tree).height);
    assert!(leaning("stand-wind") > 0.3 && leaning("stand-between").abs() < 0.1);
}

/// A shrub is wider than high, and has lost its leader before it is as high as a child.
#[test]
fn a_shrub_forks_low() {
    assert!(mean("stand-shrub", slenderness) < 1.0);
    let limbs = |tree: &Skeleton| {
        let radii = tree.radii();
        let forks = tree.edges().filter(|&(child, parent)| {
            tree.positions()[child].y < 0.8
                && tree.orders()[child] > tree.orders()[parent]
                && radii[child] > 0.3 * radii[0]
        });
        forks.count() as f64
    };
    assert!(mean("stand-shrub", limbs) >= 2.0, "{}", mean("stand-shrub", limbs));
}

/// Nothing sticks out, and there are twigs in every eighth of both balls.
#[test]
fn a_topiary_fills_its_shape() {
    let tree = alone("stand-topiary", 1);
    let balls = [Sphere::new(Vec3::Y * 1.5, 0.8), Sphere::new(Vec3::Y * 3.1, 0.6)];
    let stem = Cuboid::new(Vec3::new(-0.2, -0.1, -0.2), Vec3::new(0.2, 3.4, 0.2));
    let inside = |node: &Vec3| stem.contains(*node) || balls.iter().any(|ball| ball.contains(*node));
    assert!(tree.positions().iter().all(inside));
    for (center, radius) in [(1.5, 0.8), (3.1, 0.6)] {
        for eighth in 0..8 {
            let side = |axis: u32| if eighth >> axis & 1 == 0 { -1.0 } else { 1.0 };
            let corner = Vec3::Y * center + Vec3::new(side(0), side(1), side(2)) * radius * 0.5;
            let near = tree.positions().iter().filter(|node| node.distance(corner) < 0.4 * radius).count();
            assert!(near > 20, "{near} nodes around {corner}");
        }
    }
}

#[test]
fn a_wall_takes_light() {
    let (beside, open) = (
        mean("stand-wall", |tree| f64::from(middle(tree).x)),
        mean("stand-between", |tree| f64::from(middle(tree).x)),
    );
    assert!(beside > open + 0.15, "{beside} m from the foot, {open} m in the open");
}

#[test]
fn nothing_is_inside_the_wall() {
    for seed in 1..=4 {
        let tree = alone("stand-wall", seed);
        assert!(tree.positions().iter().all(|&node| !presets::WALL.contains(node)));
        let face = presets::WALL.max().x;
        let beyond = tree.positions().iter().filter(|node| node.x < face && node.y < 12.0).count();
        assert_eq!(beyond, 0);
        assert!(tree.positions().iter().any(|node| node.x < face + 0.5), "it grows up beside the wall");
    }
}

/// The part of a tree's nodes that are farther than `half` metres to one side, the side where there are most.
fn beyond(tree: &Skeleton, half: f32) -> f64 {
    let foot = tree.positions()[0];
    let share = |direction: Vec3| {
        tree.positions().iter().filter(|&&node| (node - foot).dot(direction) > half).count() as f64
            / tree.len() as f64
    };
    [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z].into_iter().map(share).fold(0.0, f64::max)
}

/// Crowns of neighbours do not touch, and reach into each other's space by far less than they would alone.
#[test]
fn crowns_are_shy() {
    let lone = mean("stand-between", |tree| beyond(tree, 1.75));
    let (mut gaps, mut middle) = (Vec::new(), 0.0);
    for seed in 1..=4 {
        let stand = grown("stand-shyness", seed).skeletons().expect("radii");
        gaps.extend(gaps_between(&stand));
        // The tree in the middle has neighbours on all sides.
        middle += beyond(&stand[4], 1.75) / 4.0;
    }
    assert_eq!(gaps.len(), 48);
    let mean_gap = gaps.iter().sum::<f32>() / 48.0;
    assert!(mean_gap > 0.1 && gaps.iter().all(|&gap| gap > 0.005), "{mean_gap} {gaps:?}");
    assert!(middle < 0.6 * lone, "{middle} for {lone}");
}

/// The gaps between the nodes of neighbours, metres.
fn gaps_between(stand: &[Skeleton]) -> Vec<f32> {
    let mut gaps = Vec::new();
    for (i, one) in stand.iter().enumerate() {
        for other in &stand[i + 1..] {
            if one.positions()[0].distance(other.positions()[0]) < 3.6 {
                let nearest = |node: &Vec3| {
                    let squares = other.positions().iter().map(|to| node.distance_squared(*to));
                    squares.fold(f32::MAX, f32::min)
                };
                gaps.push(one.positions().iter().map(nearest).fold(f32::MAX, f32::min).sqrt());
            }
        }
    }
    gaps
}

/// Trees of three generations and more stand at once; of those of one age, the ones under the first tree are shorter, on
/// the mean over seeds and ages.
#[test]
fn the_shaded_are_shorter() {
    let ratios: Vec<f32> = (1..=3).flat_map(shaded_by_open).collect();
    let mean = ratios.iter().sum::<f32>() / ratios.len() as f32;
    assert!(ratios.len() >= 9 && mean < 0.75, "{ratios:?}");
}

/// For each age that has more than three trees of both kinds, the mean height under the first tree over that in the open.
fn shaded_by_open(seed: u64) -> Vec<f32> {
    let forest = grown("stand-generations", seed);
    let generations: BTreeSet<u16> = forest.trees().iter().map(Tree::generation).collect();
    assert!((0..3).all(|generation| generations.contains(&generation)), "{generations:?}");
    let sown = forest.trees().last().expect("there are trees").number();
    assert!(usize::from(sown as u16) > forest.trees().len(), "some have died");
    let mut heights: BTreeMap<u16, [Vec<f32>; 2]> = BTreeMap::new();
    for tree in &forest.trees()[1..] {
        let under = tree.foot().distance(forest.trees()[0].foot()) < 2.5;
        let top = tree.positions().map(|node| node.y).fold(0.0, f32::max);
        heights.entry(tree.born()).or_default()[usize::from(under)].push(top);
    }
    let mean = |heights: &[f32]| heights.iter().sum::<f32>() / heights.len() as f32;
    let ages = heights.values().filter(|[open, under]| open.len() > 3 && under.len() > 3);
    ages.map(|[open, under]| mean(under) / mean(open)).collect()
}

/// Equal seeds give equal stands; a change of these is a line in the CHANGELOG.
#[test]
fn stands_grow_the_same_trees_as_ever() {
    let hash = |stand: &presets::Stand| {
        let mut forest = stand.plant(stand.seed).expect("there is room");
        forest.grow(stand.seasons.min(12)).expect("no limit is near");
        forest_hash(&forest)
    };
    let found: Vec<(&str, u64)> = presets::stands().map(|stand| (stand.name, hash(stand))).collect();
    assert_eq!(found, PINNED, "{found:#x?}");
}

const PINNED: &[(&str, u64)] = &[
    ("stand-excurrent", 0xfd9f_6dff_e111_4e67),
    ("stand-between", 0xae48_d1ac_8ca0_268d),
    ("stand-decurrent", 0xa402_1cb6_0902_4a50),
    ("stand-weeping", 0x5830_9521_6500_90ea),
    ("stand-wind", 0x2a77_179e_fcf9_133b),
    ("stand-shrub", 0x9bbb_95c6_131d_9d22),
    ("stand-topiary", 0x1ad7_5c32_88cb_b022),
    ("stand-priority", 0xa19c_6d82_5660_7a58),
    ("stand-spruce", 0x87b5_2f72_44eb_9b86),
    ("stand-spray", 0x3aa3_f207_f8dc_e14a),
    ("stand-spreading", 0x1df5_9cd4_e4e4_0e1c),
    ("stand-bowed", 0xfdf1_d881_29e7_d489),
    ("stand-slope", 0xec8e_04f0_f4bb_a2d9),
    ("stand-sun", 0x2764_026e_1891_0e74),
    ("stand-hedge", 0x9f03_531e_7702_6dcb),
    ("stand-peacock", 0xdb8a_1f56_10f7_ccf4),
    ("stand-pollard", 0x5790_219a_019d_872a),
    ("stand-wall", 0x983e_2479_2987_926f),
    ("stand-shyness", 0x0ed9_4b9a_3356_91aa),
    ("stand-thinning", 0x9aed_8eeb_c8fc_f433),
    ("stand-generations", 0x5409_3c58_f5fc_cce3),
];
