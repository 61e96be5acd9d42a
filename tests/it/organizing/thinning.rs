//! Dense stands thin themselves; species of different tolerance live side by side.

use treesynth::Bounds;
use treesynth::glam::Vec3;
use treesynth::random::{Purpose, unit};
use treesynth::self_organizing::{Forest, Habit, ShadowPropagation, Shedding, Stature, Tree, VigorModel};

fn light(half: f32) -> ShadowPropagation {
    let bounds = Bounds::new(Vec3::new(-half, 0.0, -half), Vec3::new(half, 12.0, half));
    ShadowPropagation::new(bounds).with_cell(0.1)
}

fn habit(apical_control: f32) -> Habit {
    let model = VigorModel::BorchertHonda { apical_control };
    Habit::default().with_vigor_model(model).with_length(0.1).with_tip_radius(0.0025)
}

fn height(tree: &Tree) -> f32 {
    tree.positions().map(|node| node.y).fold(0.0, f32::max)
}

/// The volume of a tree's wood, cubic metres.
fn volume(forest: &Forest, tree: &Tree) -> f64 {
    let skeleton = forest.skeleton(tree).unwrap();
    let of = |(child, parent): (usize, usize)| {
        let radius = f64::from(skeleton.radii()[child]);
        let length = skeleton.positions()[child].distance(skeleton.positions()[parent]);
        std::f64::consts::PI * radius * radius * f64::from(length)
    };
    skeleton.edges().map(of).sum()
}

/// The slope of log mean stem volume against log density (reduced major axis), and the square of their correlation, over the
/// seasons since a stand of one age, 0.7 m apart, has lost a seventh of its trees. Its edge does not count.
fn thinning(shedding: Shedding, seed: u64) -> (f64, f64) {
    let mut forest = Forest::new(light(9.1), habit(0.53).with_shedding(shedding), seed);
    for i in 0..676u16 {
        let aside = |stage: u32| 0.6 * (unit(seed, stage, Purpose::CUSTOM, i.into()) - 0.5);
        let place = Vec3::new(f32::from(i % 26) + aside(0), 0.0, f32::from(i / 26) + aside(1));
        forest.plant((place - Vec3::new(12.5, 0.0, 12.5)) * 0.7).unwrap();
    }
    let (mut points, mut first): (Vec<(f64, f64)>, f64) = (Vec::new(), 0.0);
    for _ in 0..22 {
        forest.step().unwrap();
        let inside = |tree: &&Tree| tree.foot().with_y(0.0).abs().max_element() < 8.1 && tree.metamers() > 0;
        let volumes: Vec<f64> =
            forest.trees().iter().filter(inside).map(|tree| volume(&forest, tree)).collect();
        let trees = volumes.len() as f64;
        first = first.max(trees);
        if trees < 0.85 * first {
            points.push((trees.ln(), (volumes.iter().sum::<f64>() / trees).ln()));
        }
    }
    assert!(points.len() >= 15, "seed {seed}: {} seasons", points.len());
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(&|point| point.0), mean(&|point| point.1));
    let both = mean(&|point| (point.0 - x) * (point.1 - y));
    let (xs, ys) = (mean(&|point| (point.0 - x).powi(2)), mean(&|point| (point.1 - y).powi(2)));
    (both.signum() * (ys / xs).sqrt(), both * both / (xs * ys))
}

/// The self-thinning rule: mean stem mass goes with density to the power of about -3/2. By the default shedding the
/// density soon stays as it is.
#[test]
fn stands_thin_themselves() {
    for seed in 1..=5 {
        let (slope, fit) = thinning(Shedding::self_thinning(), seed);
        assert!((-1.8..=-1.3).contains(&slope) && fit > 0.95, "seed {seed}: {slope}, r² {fit}");
    }
    let (slope, _) = thinning(Shedding::default(), 1);
    assert!(slope < -5.0, "{slope} by default");
}

/// The trees of the canopy and of the understory after 30 seasons: how many live of 50, and their metamers and least and
/// greatest height.
fn storeys(tolerance: f32, seed: u64) -> [(usize, usize, f32, f32); 2] {
    let canopy = habit(0.53).with_stature(Stature::default().with_height(14.0));
    let low = Stature::default().with_height(2.5).with_pace(10.0);
    let understory = habit(0.48).with_stature(low).with_shade_tolerance(tolerance);
    // Shadows that reach down to the understory.
    let mut forest = Forest::new(light(8.0).with_height(16).with_falloff(1.15), canopy, seed);
    let understory = forest.add_habit(understory);
    for i in 0..100u8 {
        let (column, row) = (i % 10, i / 10);
        let place = Vec3::new(f32::from(column) - 4.5, 0.0, f32::from(row) - 4.5) * 1.5;
        forest.plant_as(place, if (column + row) % 2 == 0 { 0 } else { understory }).unwrap();
    }
    forest.grow(30).unwrap();
    [0, understory].map(|habit| {
        let trees: Vec<&Tree> = forest.trees().iter().filter(|tree| tree.habit() == habit).collect();
        let heights = || trees.iter().map(|tree| height(tree));
        let metamers = trees.iter().map(|tree| tree.metamers()).sum();
        (trees.len(), metamers, heights().fold(f32::MAX, f32::min), heights().fold(0.0, f32::max))
    })
}

/// A tall species and a shade-tolerant one below it live side by side for 30 seasons; one that needs light dies there.
#[test]
fn canopy_and_understory_coexist() {
    for seed in 1..=3 {
        let [canopy, understory] = storeys(8.0, seed);
        assert!(canopy.0 >= 45 && understory.0 >= 45, "seed {seed}: {canopy:?} {understory:?}");
        assert!(
            canopy.2 > 3.0 * understory.3 && understory.2 > 1.5,
            "seed {seed}: {canopy:?} {understory:?}"
        );
        let [canopy, starved] = storeys(1.0, seed);
        assert!(
            canopy.0 >= 45 && starved.0 <= 5 && starved.1 * 50 < understory.1,
            "seed {seed}: {starved:?}"
        );
    }
}
