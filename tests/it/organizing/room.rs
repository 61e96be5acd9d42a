//! Room: boxes that grow, buds that wait, roofs that shade, ground that slopes.

use treesynth::glam::{Vec2, Vec3};
use treesynth::self_organizing::{
    Environment, Forest, ForestError, Habit, Heightmap, Offspring, SelfOrganizing, ShadowPropagation,
    Terrain, Tree, VigorModel,
};
use treesynth::shape::Cuboid;
use treesynth::{Bounds, presets};

fn top(tree: &Tree) -> f32 {
    tree.positions().map(|node| node.y).fold(f32::MIN, f32::max)
}

fn light(half: f32, height: f32) -> ShadowPropagation {
    let bounds = Bounds::new(Vec3::new(-half, 0.0, -half), Vec3::new(half, height, half));
    ShadowPropagation::new(bounds).with_cell(0.1)
}

/// Beyond the top of the box a tree is as pointed as below it.
#[test]
fn the_box_is_no_lid() {
    for seed in 1..=3 {
        let mut forest = presets::by_name("stand-excurrent").unwrap().stand().unwrap().plant(seed).unwrap();
        forest.grow(22).unwrap();
        let tree = &forest.trees()[0];
        let top = top(tree);
        let near = tree.positions().filter(|node| node.y > top - 0.3).count();
        assert!(top > 20.0 && near < 40, "seed {seed}: {near} nodes below {top}");
    }
    let priority = VigorModel::Priority { first: 4.0, last: 1.0, part: 0.3 };
    let mut forest =
        Forest::new(light(7.0, 6.0), Habit::default().with_length(0.1).with_vigor_model(priority), 1);
    forest.plant(Vec3::ZERO).unwrap();
    let mut last = 0;
    for _ in 0..6 {
        forest.grow(2).unwrap();
        assert!(forest.metamers() > last);
        last = forest.metamers();
    }
    assert!(top(&forest.trees()[0]) > 7.0);
}

/// What no grid can hold is an error, and nothing is lost.
#[test]
fn the_end_of_the_grid_is_an_error() {
    let mut forest = Forest::new(ShadowPropagation::default(), Habit::default(), 1);
    let refused = forest.plant(Vec3::X * 1e5);
    assert!(
        matches!(refused, Err(ForestError::Parameter(error)) if error.parameter == "ShadowPropagation.bounds")
    );
    assert!(forest.trees().is_empty());
    forest.plant(Vec3::ZERO).unwrap();
    forest.grow(2).unwrap();
}

/// Points just inside of the box's edge, whose cells round to one beyond.
#[test]
fn plants_on_the_very_edge() {
    for (size, cell) in [(4.0f32, 0.1f32), (0.3, 0.1), (2.1, 0.07), (51.2, 0.2), (7.7, 0.06)] {
        let bounds = Bounds::new(Vec3::new(-size, 0.0, -size), Vec3::splat(size));
        let mut forest = Forest::new(ShadowPropagation::new(bounds).with_cell(cell), Habit::default(), 1);
        for edge in [size, size.next_down(), -size, (-size).next_up()] {
            forest.plant(Vec3::new(edge, 0.0, edge)).unwrap();
            forest.plant(Vec3::new(edge, size.next_down(), 0.0)).unwrap();
        }
        forest.grow(2).unwrap();
    }
}

/// A seed under a stone waits; a hedge that has filled its box lives on.
#[test]
fn blocked_buds_wait() {
    let stone = Cuboid::new(Vec3::new(-1.0, 0.01, -1.0), Vec3::new(1.0, 0.3, 1.0));
    for seed in 1..=5 {
        let mut forest =
            Forest::new(light(2.0, 2.0).with_scattered(1.0), Habit::default(), seed).with_obstacle(stone);
        forest.plant(Vec3::ZERO).unwrap();
        forest.grow(20).unwrap();
        assert_eq!(forest.trees().len(), 1);
        assert_eq!(forest.trees()[0].buds().next(), Some([true, false]));
    }
    let shape = Cuboid::new(Vec3::new(-1.0, -0.1, -0.5), Vec3::new(1.0, 1.0, 0.5));
    for seed in 1..=5 {
        let habit = Habit::default().with_length(0.1);
        let mut forest = Forest::new(light(2.0, 2.0), habit, seed).with_envelope(shape);
        forest.plant(Vec3::ZERO).unwrap();
        forest.grow(15).unwrap();
        let then = forest.metamers();
        forest.grow(15).unwrap();
        assert!(2 * forest.metamers() > then && then > 20, "seed {seed}: {} of {then}", forest.metamers());
    }
}

/// A roof of 8 m, 0.6 m above the ground, perhaps with a hole of 0.5 m around x = 0.5.
fn roofed(seed: u64, hole: bool) -> SelfOrganizing {
    let tree = SelfOrganizing::new(ShadowPropagation::default(), Habit::default(), seed);
    let half = if hole { 0.25 } else { 0.0 };
    let (low, high) = (-4.0, 4.0);
    let parts = [
        [low, low, 0.5 - half, high],
        [0.5 + half, low, high, high],
        [0.5 - half, low, 0.5 + half, -half],
        [0.5 - half, half, 0.5 + half, high],
    ];
    parts.into_iter().filter(|part| part[0] < part[2]).fold(tree, |tree, [x, z, right, front]| {
        tree.with_obstacle(Cuboid::new(Vec3::new(x, 0.6, z), Vec3::new(right, 0.7, front)))
    })
}

/// Under a closed roof little grows; a hole aside draws the crown.
#[test]
fn obstacles_cast_shade() {
    let (mut leaning, mut closed, mut open) = (0.0, 0, 0);
    for seed in 1..=12 {
        let mut tree = roofed(seed, true);
        tree.grow(20).unwrap();
        let tree = tree.tree().expect("it lives on the light of the hole");
        leaning += tree.positions().map(|node| node.x).sum::<f32>() / tree.positions().len() as f32 / 12.0;
        let mut tree = roofed(seed, false);
        tree.grow(8).unwrap();
        closed += tree.metamers();
        let mut tree = SelfOrganizing::new(ShadowPropagation::default(), Habit::default(), seed);
        tree.grow(8).unwrap();
        open += tree.metamers();
    }
    assert!(leaning >= 0.15, "the crowns lean {leaning} m");
    assert!(closed * 20 < open, "{closed} metamers under the roof, {open} in the open");
}

/// How many seeds sprout on this ground, once all that must hold on it has been looked at.
fn sown_on(ground: &(impl Terrain + Clone + 'static), seed: u64) -> usize {
    let offspring = Offspring::default().with_maturity(4).with_interval(2).with_seeds(1.0);
    let habit = Habit::default().with_offspring(offspring);
    let mut forest = Forest::new(ShadowPropagation::default(), habit, seed).with_terrain(ground.clone());
    forest.plant(Vec3::new(0.3, 7.0, 0.1)).unwrap();
    forest.grow(11).unwrap();
    for tree in forest.trees() {
        let foot = tree.foot();
        assert_eq!(foot.y, ground.height(foot.x, foot.z));
        for node in tree.positions() {
            assert!(node.y >= ground.height(node.x, node.z) - 1e-6, "{node}");
        }
    }
    forest.trees().len() - 1
}

/// Sown trees stand on the ground, as planted ones do, and nothing grows below it.
#[test]
fn nothing_floats_on_a_slope() {
    let slope = |x: f32, _z: f32| 0.5 * x;
    let heights = (0..9).flat_map(|z| (0..9).map(move |x| (x * z % 5) as f32 * 0.1)).collect();
    let map = Heightmap::new(Vec2::splat(-2.0), 0.5, 9, heights);
    let sown: usize = (1..=4).map(|seed| sown_on(&slope, seed) + sown_on(&map, seed)).sum();
    assert!(sown > 40, "{sown}");
}

/// Shadows on a slope are those of what stands, whenever the ground was given.
#[test]
fn the_ground_may_come_later() {
    let slope = |x: f32, _z: f32| 0.5 * x;
    let mut forest = Forest::new(ShadowPropagation::default(), Habit::default(), 1);
    forest.plant(Vec3::new(0.5, 0.0, 0.0)).unwrap();
    forest.grow(6).unwrap();
    let later = forest.with_terrain(slope);
    let mut fresh = ShadowPropagation::default();
    let nodes: Vec<Vec3> = later.trees().iter().flat_map(Tree::positions).collect();
    fresh.update(&nodes, &[]);
    for &node in &nodes {
        assert_eq!(later.environment().shadow(node), fresh.shadow(node));
    }
}

/// Species of short metamers grow in wide cells about as high as in their own.
#[test]
fn short_metamers_live_in_wide_cells() {
    for seed in 1..=4 {
        let height = |cell: f32| {
            let mut tree = SelfOrganizing::new(light(4.0, 4.0).with_cell(cell), Habit::default(), seed);
            tree.grow(15).unwrap();
            tree.tree().map_or(0.0, top)
        };
        let (own, wide) = (height(0.02), height(0.1));
        assert!(
            wide > 0.75 * own && wide < 1.25 * own,
            "seed {seed}: {wide} m in wide cells, {own} m in its own"
        );
    }
}

/// When a species casts another shade, all its nodes do.
#[test]
fn shade_may_change_between_seasons() {
    let mut forest = Forest::new(light(4.0, 4.0), Habit::default().with_length(0.1), 1);
    forest.plant(Vec3::ZERO).unwrap();
    forest.grow(8).unwrap();
    forest.habits_mut()[0] =
        Habit::default().with_length(0.1).with_shade(0.5).with_vigor_multiplier(0.0).with_shedding(None);
    let before = forest.environment().shadow(Vec3::new(0.0, 0.35, 0.0));
    forest.step().unwrap();
    let after = forest.environment().shadow(Vec3::new(0.0, 0.35, 0.0));
    assert!(before > 0.5 && (after - 0.5 * before).abs() < 0.02 * before, "{before} {after}");
    assert!(matches!(
        { forest.habits_mut()[0] = Habit::default().with_shade(9.0); forest.step() },
        Err(ForestError::Parameter(error)) if error.parameter == "Habit.shade"
    ));
}
