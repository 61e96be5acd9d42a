//! Limbs that bend under their own load.

use super::forest_hash;
use std::sync::Arc;
use treesynth::glam::Vec3;
use treesynth::self_organizing::{
    Axis, Environment, Forest, ForestError, Habit, Phyllotaxis, Sag, SelfOrganizing, ShadowPropagation,
    Terrain, Tree, VigorModel,
};
use treesynth::shape::Cuboid;
use treesynth::{Bounds, Shape, Skeleton, math};

const SEASONS: u16 = 17;

fn light() -> ShadowPropagation {
    let bounds = Bounds::new(Vec3::new(-9.0, 0.0, -9.0), Vec3::new(9.0, 12.0, 9.0));
    ShadowPropagation::new(bounds).with_cell(0.1)
}

/// Limbs that leave the trunk at 30 degrees.
fn habit(sag: Option<Sag>) -> Habit {
    let limbs = Axis::default().with_angle(30f32.to_radians()).with_optimal_weight(0.03);
    Habit::default()
        .with_length(0.1)
        .with_tip_radius(0.0025)
        .with_vigor_model(VigorModel::BorchertHonda { apical_control: 0.53 })
        .with_phyllotaxis(Phyllotaxis::Spiral { divergence: 2.4 })
        .with_axes([Axis::default(), limbs])
        .with_sag(sag)
}

fn soft() -> Sag {
    Sag::default().with_modulus(7e8)
}

/// The mean angle from the vertical, degrees, of the first 8 metamers of limbs of these ages.
fn limb_angle(tree: &Skeleton, ages: std::ops::RangeInclusive<u16>) -> f32 {
    let mut next = vec![None; tree.len()];
    for (node, parent) in tree.edges().filter(|&(node, parent)| tree.orders()[node] == tree.orders()[parent])
    {
        next[parent] = Some(node);
    }
    let mut angles = Vec::new();
    for (node, parent) in tree.edges() {
        let is_base = parent > 0 && tree.orders()[node] == 1 && tree.orders()[parent] == 0;
        if is_base && ages.contains(&(SEASONS - tree.stages()[node])) {
            let way = std::iter::successors(Some(node), |&node| next[node]).take(8).collect::<Vec<_>>();
            if way.len() >= 4 {
                let along = tree.positions()[way[way.len() - 1]] - tree.positions()[parent];
                angles.push(math::angle_between(along, Vec3::Y).to_degrees());
            }
        }
    }
    assert!(angles.len() >= 3, "{} limbs", angles.len());
    angles.iter().sum::<f32>() / angles.len() as f32
}

/// From 30 degrees to 55 and more; without sag they stay as they have grown. Trunks stay upright.
#[test]
fn limb_angles_open_with_age() {
    for divergence in [2.4f32, 2.2, 1.7, 2.6] {
        let grown = |sag: Option<Sag>| {
            let habit = habit(sag).with_phyllotaxis(Phyllotaxis::Spiral { divergence });
            let mut tree = SelfOrganizing::new(light(), habit, 1);
            tree.grow(SEASONS.into()).unwrap();
            tree.skeleton().unwrap()
        };
        let (bent, straight) = (grown(Some(soft())), grown(None));
        let (young, old) = (limb_angle(&bent, 0..=3), limb_angle(&bent, 10..=SEASONS));
        assert!(young < 38.0 && old > 55.0 && old < 85.0, "{divergence}: {young} to {old} degrees");
        let stays = limb_angle(&straight, 10..=SEASONS);
        assert!(stays < 32.0, "{divergence}: {stays} degrees without sag");
        for node in (1..bent.len()).filter(|&node| bent.orders()[node] == 0) {
            let along = bent.positions()[node] - bent.positions()[bent.parent(node).unwrap()];
            assert!(math::angle_between(along, Vec3::Y) < 0.3);
        }
    }
    // Laterals that are scattered, over seeds: the limbs of one tree open by 20 degrees at least.
    for seed in 1..=4 {
        let habit = habit(Some(soft())).with_phyllotaxis(Phyllotaxis::Scattered);
        let mut tree = SelfOrganizing::new(light(), habit, seed);
        tree.grow(SEASONS.into()).unwrap();
        let tree = tree.skeleton().unwrap();
        let (young, old) = (limb_angle(&tree, 0..=3), limb_angle(&tree, 10..=SEASONS));
        assert!(old > young + 20.0, "seed {seed}: {young} to {old} degrees");
    }
}

/// A node that stands for years only ever goes down while nothing falls, and metamers keep their length.
#[test]
fn limbs_go_down_and_stay_as_long() {
    for seed in 1..=3 {
        let habit = habit(Some(soft())).with_shedding(None);
        let mut tree = SelfOrganizing::new(light(), habit, seed);
        tree.grow(8).unwrap();
        let lengths = |tree: &Tree| -> Vec<(f32, f32)> {
            let skeleton = tree.skeleton().unwrap();
            (1..skeleton.len())
                .map(|node| {
                    let place = skeleton.positions()[node];
                    (place.distance(skeleton.positions()[skeleton.parent(node).unwrap()]), place.y)
                })
                .collect()
        };
        let before = lengths(tree.tree().unwrap());
        let ids: Vec<_> = tree.tree().unwrap().ids().skip(1).collect();
        tree.grow(5).unwrap();
        let standing = tree.tree().unwrap();
        let after = lengths(standing);
        let (mut lower, mut deepest) = (0, 0.0f32);
        for (id, (length, height)) in ids.iter().zip(before) {
            let (now, low) = after[standing.index_of(*id).unwrap() - 1];
            assert!((now - length).abs() < 1e-5, "{length} m became {now} m");
            lower += usize::from(low < height);
            deepest = deepest.max(height - low);
        }
        assert!(lower * 2 > ids.len() && deepest > 0.3, "{lower} of {}, {deepest} m", ids.len());
    }
}

/// However soft the wood: nothing sinks into the ground or a wall or hangs out of the envelope, and shadows are those of
/// what stands.
#[test]
fn limbs_come_to_lie_where_there_is_something() {
    let wall = Cuboid::new(Vec3::new(0.4, 0.0, -9.0), Vec3::new(0.6, 1.2, 9.0));
    let envelope = Cuboid::new(Vec3::new(-1.5, -9.0, -1.5), Vec3::new(1.5, 5.0, 1.5));
    let slope = |x: f32, _: f32| 0.3 * x;
    for seed in 1..=4 {
        for soft in [1e8, 1e6, 1e3] {
            let habit =
                habit(Some(Sag::default().with_modulus(soft))).with_phyllotaxis(Phyllotaxis::Scattered);
            let mut forest = Forest::new(light(), habit, seed).with_obstacle(wall).with_envelope(envelope);
            forest = forest.with_terrain(slope);
            forest.plant(Vec3::ZERO).unwrap();
            forest.grow(10).unwrap();
            let nodes: Vec<Vec3> = forest.trees().iter().flat_map(Tree::positions).collect();
            assert!(nodes.len() > 100);
            for &node in &nodes {
                assert!(node.is_finite() && node.y >= slope(node.x, node.z) - 1e-5, "{node}");
                assert!(!wall.contains(node) && envelope.contains(node), "{node}");
            }
            let mut fresh = light();
            let ground: Arc<dyn Terrain> = Arc::new(slope);
            fresh.obstruct(&[], Some(&ground));
            fresh.update(&nodes, &[]);
            assert!(nodes.iter().all(|&node| fresh.shadow(node) == forest.environment().shadow(node)));
            forest.skeletons().unwrap().iter().for_each(|tree| tree.check().unwrap());
        }
    }
}

/// In parts too, on any number of threads, saved in between.
#[test]
fn bent_forests_are_the_same_however_they_grew() {
    for (seed, parts) in [(1, 1), (2, 3)] {
        let planted = || {
            let mut forest = Forest::new(light(), habit(Some(soft())), seed).with_parts(parts);
            for x in [-1.0, 0.0, 1.5] {
                forest.plant(Vec3::X * x).unwrap();
            }
            forest
        };
        let grown = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut forest = planted();
            pool.install(|| forest.grow(9)).unwrap();
            forest_hash(&forest)
        };
        let one = grown(1);
        assert_eq!([grown(2), grown(5)], [one; 2]);
        #[cfg(feature = "json")]
        {
            let mut forest = planted();
            forest.grow(5).unwrap();
            let text = serde_json::to_string(&forest).unwrap();
            let mut read: Forest = serde_json::from_str(&text).unwrap();
            read.grow(4).unwrap();
            assert_eq!(forest_hash(&read), one);
        }
    }
}

#[test]
fn bad_sag_is_named() {
    for bad in [f32::NAN, -1.0, f32::INFINITY, 1e20] {
        for (sag, name) in [
            (Sag::default().with_modulus(bad), "Sag.modulus"),
            (Sag::default().with_density(bad), "Sag.density"),
        ] {
            let mut tree = SelfOrganizing::new(light(), Habit::default().with_sag(sag), 1);
            assert!(matches!(tree.step(), Err(ForestError::Parameter(error)) if error.parameter == name));
        }
    }
}
