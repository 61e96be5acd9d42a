//! What every tree of every species must look like, over many seeds.

use super::{Trunk, all};
use crate::Skeleton;
use glam::Vec3;
use std::collections::BTreeSet;
use std::error::Error;

const SEEDS: u64 = 6;
const STEM: u16 = 0;
const LIMB: u16 = 1;
const SHOOT: u16 = 4;
const ROOT: u16 = 5;

/// The nodes of each limb, its base on what bears it first.
fn limbs(skeleton: &Skeleton) -> Vec<Vec<usize>> {
    let (stages, orders) = (skeleton.stages(), skeleton.orders());
    let mut limbs: Vec<Vec<usize>> = Vec::new();
    let mut limb_of = vec![usize::MAX; skeleton.len()];
    for (node, parent) in skeleton.edges().filter(|(node, _)| stages[*node] == LIMB) {
        if stages[parent] == LIMB && orders[parent] == orders[node] {
            limb_of[node] = limb_of[parent];
            limbs[limb_of[node]].push(node);
        } else {
            limb_of[node] = limbs.len();
            limbs.push(vec![parent, node]);
        }
    }
    limbs
}

/// The way along some nodes, metres.
fn length(skeleton: &Skeleton, nodes: &[usize]) -> f32 {
    let places = skeleton.positions();
    nodes.windows(2).map(|pair| places[pair[0]].distance(places[pair[1]])).sum()
}

/// No limb is a hoop or a snake: it is little longer than the straight way from its base to its end.
#[test]
fn limbs_keep_to_their_way() -> Result<(), Box<dyn Error>> {
    for species in all() {
        let mut sinuous = Vec::new();
        for seed in 0..SEEDS {
            let tree = species.request().with_seed(seed).grow()?;
            let places = tree.skeleton.positions();
            for limb in limbs(&tree.skeleton).iter().filter(|limb| limb.len() > 8) {
                let chord = places[limb[0]].distance(places[limb[limb.len() - 1]]);
                sinuous.push(length(&tree.skeleton, limb) / chord);
            }
        }
        sinuous.sort_by(f32::total_cmp);
        let Some(&worst) = sinuous.last() else { continue };
        let most = sinuous[sinuous.len() * 99 / 100];
        assert!(most < 1.2 && worst < 1.3, "{}: {most} {worst}", species.name);
    }
    Ok(())
}

/// Leaders bear shoots up to their tip, on the last tenth of the crown too.
#[test]
fn leaders_are_clothed() -> Result<(), Box<dyn Error>> {
    let leads = |trunk: &Trunk| trunk.leader >= 1.0 && trunk.stems[1] <= 1.0;
    for species in all().iter().filter(|species| leads(&species.trunk) && species.shoots.spacing < 1.0) {
        for seed in 0..SEEDS {
            let tree = species.request().with_seed(seed).grow()?;
            let (skeleton, numbers) = (&tree.skeleton, tree.numbers);
            if numbers.height < 3.0 {
                continue;
            }
            let from = numbers.height - 0.1 * (numbers.height - numbers.crown_base);
            let on_leader = skeleton.edges().filter(|&(node, parent)| {
                skeleton.stages()[parent] == STEM
                    && skeleton.orders()[parent] == 0
                    && skeleton.stages()[node] != STEM
                    && skeleton.positions()[parent].y > from
            });
            let count = on_leader.count();
            assert!(
                count >= 4,
                "{} {seed}: {count} on the last {:.2} m",
                species.name,
                numbers.height - from
            );
        }
    }
    Ok(())
}

/// Roots come after all other nodes and change none; each begins within the trunk, is thinner than that, and ends below the ground.
#[test]
fn roots_spread_from_the_trunk_into_the_ground() -> Result<(), Box<dyn Error>> {
    for species in all() {
        for seed in 0..SEEDS {
            let tree = species.request().with_seed(seed).grow()?;
            let (skeleton, rooted) = (&tree.skeleton, tree.rooted());
            let count = skeleton.len();
            assert_eq!(&rooted.positions()[..count], skeleton.positions());
            assert_eq!(&rooted.radii()[..count], skeleton.radii());
            let trunk = &species.trunk;
            if trunk.roots[1] == 0.0 || trunk.stems[1] > 1.0 || tree.numbers.dbh < 0.08 {
                assert_eq!(rooted.len(), count);
                continue;
            }
            let tips: Vec<usize> = rooted.tips().filter(|&tip| tip >= count).collect();
            let range = trunk.roots[0] as usize..=trunk.roots[1] as usize;
            assert!(range.contains(&tips.len()), "{} {seed}: {} roots", species.name, tips.len());
            assert!(tips.iter().all(|&tip| rooted.positions()[tip].y < 0.0));
            for (node, parent) in rooted.edges().filter(|(node, _)| *node >= count) {
                assert_eq!(rooted.stages()[node], ROOT);
                assert!(rooted.radii()[node] < 0.6 * skeleton.radii()[0]);
                if parent < count {
                    let out = (rooted.positions()[node] - rooted.positions()[parent]).with_y(0.0).length();
                    assert!(skeleton.stages()[parent] == STEM && out < skeleton.radii()[parent]);
                }
            }
            rooted.check()?;
        }
    }
    Ok(())
}

/// The stems of a shrub stand apart at the ground.
#[test]
fn stems_stand_apart() -> Result<(), Box<dyn Error>> {
    for species in all().iter().filter(|species| species.trunk.stems[0] > 1.0) {
        for seed in 0..SEEDS {
            let tree = species.request().with_seed(seed).grow()?;
            let (places, stages) = (tree.skeleton.positions(), tree.skeleton.stages());
            let below = |node: usize| places[node].y < 0.0 && stages[node] == STEM;
            let feet: Vec<Vec3> =
                (1..places.len()).filter(|&node| below(node)).map(|node| places[node]).collect();
            assert!(feet.len() + 1 >= species.trunk.stems[0] as usize, "{} {seed}", species.name);
            let apart: BTreeSet<_> =
                feet.iter().map(|foot| [foot.x, foot.z].map(|at| (at * 50.0) as i32)).collect();
            assert!(2 * apart.len() > feet.len(), "{} {seed}: {} places", species.name, apart.len());
        }
    }
    Ok(())
}

/// One seed gives two species two gestures: the crowns lean to different sides.
#[test]
fn species_differ_at_one_seed() -> Result<(), Box<dyn Error>> {
    for seed in 0..3 {
        let mut sectors = BTreeSet::new();
        for species in all() {
            let tree = species.request().with_seed(seed).grow()?;
            let shoots = tree.skeleton.positions().iter().zip(tree.skeleton.stages());
            let way: Vec3 = shoots.filter(|(_, stage)| **stage == SHOOT).map(|(place, _)| *place).sum();
            sectors.insert((crate::math::atan2(way.z, way.x) / std::f32::consts::TAU * 8.0).floor() as i32);
        }
        assert!(sectors.len() >= 5, "seed {seed}: {sectors:?}");
    }
    Ok(())
}
