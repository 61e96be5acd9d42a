//! Space colonization: light or none, whatever the density of markers, and only where space is free.

use treesynth::glam::Vec3;
use treesynth::self_organizing::{Habit, SelfOrganizing, SpaceColonization, VigorModel};
use treesynth::shape::HalfEllipsoid;
use treesynth::{Shape, Skeleton};

const CROWN: HalfEllipsoid = HalfEllipsoid::new(Vec3::ZERO, Vec3::new(2.0, 3.2, 2.0));

fn grown(density: f32, apical_control: f32, seed: u64) -> SelfOrganizing<SpaceColonization> {
    let markers = (density * CROWN.volume()) as usize;
    let space = SpaceColonization::in_shape(&CROWN, markers, seed).unwrap();
    let space = space.with_occupancy(0.2).with_perception(0.6, std::f32::consts::FRAC_PI_4);
    let habit = Habit::default()
        .with_length(0.1)
        .with_optimal_weight(0.5)
        .with_vigor_model(VigorModel::BorchertHonda { apical_control });
    let mut tree = SelfOrganizing::new(space, habit, seed);
    tree.grow(15).unwrap();
    tree
}

/// The longest run of nodes of one axis and one season, metres.
fn longest_shoot(tree: &Skeleton) -> f32 {
    let mut lengths = vec![0.0f32; tree.len()];
    for (node, parent) in tree.edges() {
        let goes_on =
            tree.stages()[node] == tree.stages()[parent] && tree.orders()[node] == tree.orders()[parent];
        let before = if goes_on { lengths[parent] } else { 0.0 };
        lengths[node] = before + tree.positions()[node].distance(tree.positions()[parent]);
    }
    lengths.into_iter().fold(0.0, f32::max)
}

#[test]
fn the_density_of_markers_matters_little() {
    let cases = [0.46, 0.48, 0.5, 0.52, 0.55]
        .into_iter()
        .flat_map(|control| (1..=4).map(move |seed| (seed, control)));
    for (seed, apical_control) in cases {
        let trees = [50.0, 100.0, 200.0].map(|density| grown(density, apical_control, seed));
        let metamers = trees.each_ref().map(SelfOrganizing::metamers);
        let (least, most) = (metamers.iter().min().unwrap(), metamers.iter().max().unwrap());
        assert!(*most <= 2 * *least && *least > 500, "{metamers:?}");
        for tree in &trees {
            let skeleton = tree.skeleton().unwrap();
            assert!(skeleton.positions().iter().all(|&node| CROWN.contains(node)));
            assert!(longest_shoot(&skeleton) < 1.0);
        }
    }
}

/// A crown that is full stays as it is: under 2% of its metamers are of the latest season.
#[test]
fn a_full_crown_rests() {
    for seed in 1..=3 {
        let mut tree = grown(50.0, 0.5, seed);
        tree.grow(12).unwrap();
        let skeleton = tree.skeleton().unwrap();
        let latest = skeleton.stages().iter().filter(|&&stage| stage == 27).count();
        assert!(latest * 50 < skeleton.len(), "{latest} of {}", skeleton.len());
        assert!(skeleton.len() > 500);
    }
}
