//! Thickness of synthesized trees: equation 2 of the variational paper, `d^a = Σ d_j^a` at every fork.

use crate::sample::{cases, cube_graph, degrees, plot};
use proptest::prelude::*;
use treesynth::glam::Vec3;
use treesynth::guided::{Bend, Count, HopSurface, InShape, NearestTo, PoissonYao, Stage, TreeSynth};
use treesynth::radius::{PipeModel, Taper, Variational};
use treesynth::random::{Purpose, unit};
use treesynth::shape::Ellipsoid;
use treesynth::{RadiusModel, Skeleton};

fn tree(seed: u64, model: impl RadiusModel + 'static) -> Skeleton {
    let crown = Ellipsoid::new(Vec3::Y * 3.6, Vec3::new(2.0, 1.6, 2.0));
    let fork = || Bend::piecewise(degrees(40.0), 0.0, 1);
    TreeSynth::new(PoissonYao::new(plot(6.0, 6.0)))
        .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 4.5)))
        .stage(Stage::new(fork(), InShape::poisson_disc(crown, 15)))
        .stage(Stage::new(fork(), HopSurface::new(2, Count::UpTo(60))))
        .stage(Stage::new(fork(), HopSurface::new(1, Count::UpTo(100))))
        .with_radius(model)
        .synthesize_on(&cube_graph(2500, seed), seed)
        .expect("a sound tree")
}

/// `|Σ d_j^a / d^a - 1|`, the largest of all nodes that bear any.
fn residual(tree: &Skeleton, exponent: f32) -> f64 {
    let power = |node: usize| (2.0 * f64::from(tree.radii()[node])).powf(f64::from(exponent));
    let mut sums = vec![0.0; tree.len()];
    for node in 1..tree.len() {
        sums[tree.parent(node).expect("not the root")] += power(node);
    }
    let bears = (0..tree.len()).filter(|&node| sums[node] > 0.0);
    bears.map(|node| (sums[node] / power(node) - 1.0).abs()).fold(0.0, f64::max)
}

fn assert_never_growing(tree: &Skeleton) {
    for node in 1..tree.len() {
        let parent = tree.parent(node).expect("not the root");
        assert!(tree.radii()[node] <= tree.radii()[parent], "node {node} is thicker than its parent");
    }
    assert!(tree.radii().iter().all(|&radius| radius > 0.0 && radius.is_finite()));
}

fn samples(seed: u64) -> Vec<Vec3> {
    let draw = |i, axis| unit(seed, axis, Purpose::CUSTOM, i) * 4.0;
    (0..3000).map(|i| Vec3::new(draw(i, 0) - 2.0, draw(i, 1) + 2.0, draw(i, 2) - 2.0)).collect()
}

proptest! {
    #![proptest_config(cases(10))]

    #[test]
    fn pipes_add_up(seed: u64, exponent in 1.2f32..4.0, diameter in 0.001f32..0.5) {
        let model = PipeModel::default().with_exponent(exponent);
        let by_tip = tree(seed, model.with_tip_diameter(diameter));
        prop_assert!(residual(&by_tip, exponent) < 1e-4);
        assert_never_growing(&by_tip);
        prop_assert!(by_tip.tips().all(|tip| (by_tip.radii()[tip] * 2.0 / diameter - 1.0).abs() < 1e-5));
        let by_trunk = tree(seed, model.with_trunk_diameter(diameter));
        prop_assert!(residual(&by_trunk, exponent) < 1e-4);
        assert_never_growing(&by_trunk);
        prop_assert!((by_trunk.radii()[0] * 2.0 / diameter - 1.0).abs() < 1e-5);
        // n equal tips: the foot is n^(1/a) of them across.
        let foot = (by_tip.tips().count() as f64).powf(1.0 / f64::from(exponent)) * f64::from(diameter);
        prop_assert!((f64::from(by_tip.radii()[0]) * 2.0 / foot - 1.0).abs() < 1e-4);
    }

    #[test]
    fn supported_areas_add_up(seed: u64, exponent in 1.2f32..4.0) {
        let even = tree(seed, Variational::uniform(0.02).with_exponent(exponent));
        prop_assert!(residual(&even, exponent) < 1e-4);
        assert_never_growing(&even);
        // d = 2 √(A / 2π).
        let tip = 2.0 * (0.02 / std::f64::consts::TAU).sqrt();
        prop_assert!(even.tips().all(|at| (f64::from(even.radii()[at]) * 2.0 / tip - 1.0).abs() < 1e-4));
        let guided = tree(seed, Variational::guided(samples(seed), 30.0).with_exponent(exponent));
        prop_assert!(residual(&guided, exponent) < 1e-4);
        assert_never_growing(&guided);
        // The areas of the tips are those of the crown, but for what the least share adds.
        let area = |at: usize| f64::from(guided.radii()[at]).powi(2) * std::f64::consts::TAU;
        let total: f64 = guided.tips().map(area).sum();
        prop_assert!((30.0 * 0.999..30.0 * 1.1).contains(&total), "{total} m² of 30");
        let scaled = tree(seed, Variational::guided(samples(seed), 30.0).with_trunk_diameter(0.4));
        prop_assert!(residual(&scaled, 2.5) < 1e-4 && (scaled.radii()[0] - 0.2).abs() < 1e-6);
    }

    #[test]
    fn tapered_radii_are_within_the_inner_ones(seed: u64, fraction in 0f32..=1.0, tip in 0.01f32..=1.0) {
        let inner = PipeModel::default().with_trunk_diameter(0.3);
        let plain = tree(seed, inner);
        let tapered = tree(seed, Taper::new(inner).with_fraction(fraction).with_tip_fraction(tip));
        assert_never_growing(&tapered);
        prop_assert_eq!(plain.positions(), tapered.positions());
        prop_assert!(plain.radii().iter().zip(tapered.radii()).all(|(plain, tapered)| tapered <= plain));
        prop_assert_eq!(plain.radii()[0], tapered.radii()[0]);
    }
}
