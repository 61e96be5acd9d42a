//! What growth promises: the same bits always, limits, nothing in obstacles, widths, seeds.

use super::forest_hash;
use crate::sample::cases;
use proptest::prelude::*;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use treesynth::glam::Vec3;
use treesynth::self_organizing::{
    Bud, Environment, Forest, ForestError, Habit, NodeId, Offspring, Phyllotaxis, SelfOrganizing,
    ShadowPropagation, Shedding, SpaceColonization, Tree, VigorModel, Width,
};
use treesynth::shape::{Cuboid, Sphere};
use treesynth::{Progress, RadiusModel, Shape, Silent};

/// Nine trees that sow themselves, with neighbours near enough to compete.
pub(super) fn stand(seed: u64) -> Forest {
    let offspring = Offspring::default().with_maturity(6).with_interval(2);
    let mut forest =
        Forest::new(ShadowPropagation::default(), Habit::default().with_offspring(offspring), seed);
    let priority = VigorModel::Priority { first: 2.0, last: 0.5, part: 0.4 };
    let spiral = Phyllotaxis::Spiral { divergence: 2.4 };
    let other = forest.add_habit(Habit::default().with_vigor_model(priority).with_phyllotaxis(spiral));
    for i in 0..9 {
        let foot = Vec3::new((i % 3) as f32 * 0.4, 0.0, (i / 3) as f32 * 0.4);
        forest.plant_as(foot, if i % 2 == 0 { 0 } else { other }).expect("there is room");
    }
    forest
}

fn grown(seed: u64, seasons: u32) -> Forest {
    let mut forest = stand(seed);
    forest.grow(seasons).expect("no limit is near");
    forest
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let hashes = [1, 2, 8].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| forest_hash(&grown(1, 12)))
    });
    assert!(hashes.iter().all(|&hash| hash == hashes[0]), "{hashes:x?}");
    assert_ne!(forest_hash(&grown(2, 12)), hashes[0]);
    assert_eq!(hashes[0], PINNED, "equal seeds no longer give equal forests: a line for CHANGELOG.md");
}
pub(super) const PINNED: u64 = 0x8923_c84f_bbe2_a628;

#[test]
fn looking_ahead_changes_nothing() {
    let mut forest = grown(3, 6);
    let before = forest_hash(&forest);
    let ahead = forest.ahead(4).unwrap();
    assert_eq!(forest_hash(&forest), before);
    assert_eq!(ahead.season(), 10);
    forest.grow(4).unwrap();
    assert_eq!(forest_hash(&forest), forest_hash(&ahead));
}

#[cfg(feature = "json")]
#[test]
fn saved_at_any_season_it_goes_on_bit_for_bit() {
    let straight = forest_hash(&grown(4, 10));
    for season in [0, 1, 5, 9] {
        let text = serde_json::to_string(&grown(4, season)).unwrap();
        let mut read: Forest = serde_json::from_str(&text).unwrap();
        read.grow(10 - season).unwrap();
        assert_eq!(forest_hash(&read), straight, "saved at {season}");
    }
    let ball = Sphere::new(Vec3::Y * 0.5, 0.5);
    let space = SpaceColonization::in_shape(&ball, 1000, 3).unwrap();
    let mut tree = SelfOrganizing::new(space, Habit::default(), 1);
    tree.grow(5).unwrap();
    let mut read: SelfOrganizing<SpaceColonization> =
        serde_json::from_str(&serde_json::to_string(&tree).unwrap()).unwrap();
    tree.grow(5).unwrap();
    read.grow(5).unwrap();
    assert_eq!(read.tree(), tree.tree());
}

#[cfg(feature = "json")]
#[test]
fn files_that_cannot_have_grown_are_refused() {
    let good = serde_json::to_value(grown(4, 4)).unwrap();
    let refused = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut bad = good.clone();
        change(&mut bad);
        let error = serde_json::from_value::<Forest>(bad).expect_err("it cannot have grown");
        assert!(error.to_string().contains(", but must be "), "{error}");
    };
    refused(&|forest| forest["trees"][0]["nodes"][3]["parent"] = 7.into());
    refused(&|forest| forest["trees"][0]["nodes"][1]["children"][0] = 1.into());
    refused(&|forest| forest["trees"][0]["nodes"][1]["children"][0] = u32::MAX.into());
    refused(&|forest| forest["trees"][0]["nodes"][2]["position"][1] = 1e30.into());
    refused(&|forest| forest["trees"][0]["nodes"][2]["number"] = 1_000_000.into());
    refused(&|forest| forest["trees"][0]["nodes"][2]["born"] = 60_000.into());
    refused(&|forest| forest["trees"][0]["habit"] = 9.into());
    refused(&|forest| forest["trees"][1]["number"] = 0.into());
    refused(&|forest| forest["trees"][0]["nodes"] = serde_json::Value::Array(Vec::new()));
    refused(&|forest| forest["habits"][0]["length"] = 0.into());
    refused(&|forest| forest["habits"] = serde_json::Value::Array(Vec::new()));
    refused(&|forest| forest["environment"]["cell"] = 0.into());
    refused(&|forest| forest["turn"] = 4.into());
    refused(&|forest| forest["parts"] = 0.into());
}

#[test]
fn parameters_may_change_between_seasons() {
    let mut tree = SelfOrganizing::new(ShadowPropagation::default(), Habit::default(), 1);
    tree.grow(8).unwrap();
    let mut stopped = tree.clone();
    *stopped.habit_mut() = Habit::default().with_vigor_multiplier(0.0).with_shedding(None);
    stopped.grow(3).unwrap();
    assert_eq!(stopped.metamers(), tree.metamers());
    *tree.habit_mut() = Habit::default().with_length(f32::NAN);
    assert!(matches!(tree.step(), Err(ForestError::Parameter(error)) if error.parameter == "Habit.length"));
}

#[test]
fn growth_stops_at_the_limit_and_keeps_what_it_has() {
    let mut forest = stand(5).with_most_metamers(3000);
    let error = forest.grow(30).expect_err("there is a limit");
    assert!(matches!(error, ForestError::Limit { limit: 3000, metamers: 3001.., .. }), "{error}");
    let kept = forest.metamers();
    assert!((1000..=3000).contains(&kept));
    assert!(forest.skeletons().is_ok());
    // A higher limit, and it goes on as if nothing had been.
    let seasons = u32::from(forest.season());
    let mut forest = forest.with_most_metamers(100_000);
    forest.step().unwrap();
    assert_eq!(forest_hash(&forest), forest_hash(&grown(5, seasons + 1)));
}

#[test]
fn an_observer_hears_of_each_season_and_may_stop_it() {
    let straight = forest_hash(&grown(6, 6));
    let calls = AtomicUsize::new(0);
    let count = |_: Progress| {
        calls.fetch_add(1, Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    stand(6).grow_observed(6, &count).unwrap();
    let all = calls.into_inner();
    assert!(all >= 12);
    for stop in 0..all {
        let calls = AtomicUsize::new(0);
        let watch = |_: Progress| match calls.fetch_add(1, Ordering::Relaxed) {
            call if call == stop => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        let mut forest = stand(6);
        assert_eq!(forest.grow_observed(6, &watch), Err(ForestError::Cancelled));
        // A season broken off between two turns is finished first.
        while u32::from(forest.season()) < 6 {
            forest.grow_observed(1, &Silent).unwrap();
        }
        assert_eq!(forest_hash(&forest), straight, "stopped at report {stop}");
    }
}

/// Light 1 everywhere.
struct Even;

impl Environment for Even {
    fn light(&self, _: &Bud<'_>) -> f32 {
        1.0
    }
    fn direction(&self, _: &Bud<'_>) -> Vec3 {
        Vec3::Y
    }
}

#[test]
fn a_shoot_of_a_million_metamers() {
    let habit = Habit::default().with_vigor_multiplier(1e6).with_length(1e-4);
    let mut tree = SelfOrganizing::new(Even, habit, 1);
    tree.step().unwrap();
    assert_eq!(tree.metamers(), 1_000_000);
    assert_eq!(tree.skeleton().unwrap().hops()[1_000_000], 1_000_000);
    assert!(matches!(tree.step(), Err(ForestError::Limit { .. })));
    *tree.habit_mut() = Habit::default().with_vigor_multiplier(1e-6);
    tree.step().unwrap();
    tree.cut(NodeId(1)).unwrap();
    assert_eq!(tree.metamers(), 0);
}

/// An environment that lies.
struct Liar(f32);

impl Environment for Liar {
    fn light(&self, _: &Bud<'_>) -> f32 {
        self.0
    }
    fn direction(&self, _: &Bud<'_>) -> Vec3 {
        Vec3::splat(self.0)
    }
}

#[test]
fn lies_of_an_environment_do_no_harm() {
    for light in [f32::NAN, -1.0, f32::NEG_INFINITY, f32::INFINITY] {
        let mut tree = SelfOrganizing::new(Liar(light), Habit::default(), 1);
        tree.grow(3).unwrap();
        assert_eq!(tree.metamers(), 0);
    }
    let mut tree = SelfOrganizing::new(Liar(1e30), Habit::default(), 1);
    assert!(matches!(tree.step(), Err(ForestError::Limit { .. })));
}

proptest! {
    #![proptest_config(cases(16))]

    #[test]
    fn no_node_is_ever_inside_an_obstacle_or_outside_an_envelope(
        seed: u64, spheres in prop::collection::vec((prop::array::uniform3(-0.4f32..0.4), 0.05f32..0.3), 1..5),
    ) {
        let spheres: Vec<Sphere> = spheres
            .into_iter()
            .map(|(at, radius)| Sphere::new(Vec3::from_array(at) + Vec3::Y * 0.75, radius))
            .collect();
        let envelope = Cuboid::new(Vec3::new(-0.5, -0.1, -0.5), Vec3::new(0.5, 0.9, 0.5));
        let tree = SelfOrganizing::new(ShadowPropagation::default(), Habit::default(), seed).with_envelope(envelope);
        let mut tree = spheres.iter().fold(tree, |tree, &sphere| tree.with_obstacle(sphere));
        for _ in 0..6 {
            tree.grow(2).unwrap();
            // A tree that an obstacle leaves no room may die.
            for node in tree.tree().into_iter().flat_map(Tree::positions) {
                prop_assert!(envelope.contains(node));
                prop_assert!(spheres.iter().all(|sphere| !sphere.contains(node)));
            }
        }
    }
}

/// A cut branch grows again from a bud at its stump, and the tree below it does not thin.
#[test]
fn a_cut_branch_grows_again() {
    let mut tree = SelfOrganizing::new(ShadowPropagation::default(), Habit::default(), 2);
    tree.grow(10).unwrap();
    let (before, skeleton) = (tree.metamers(), tree.skeleton().unwrap());
    // The leader, low down, so that light falls on the stump.
    let branch = 3;
    assert_eq!(skeleton.orders()[branch], 0);
    let stump = skeleton.parent(branch).unwrap();
    let place = skeleton.positions()[stump];
    let id = |tree: &SelfOrganizing, node: usize| tree.tree().unwrap().ids().nth(node).unwrap();
    tree.cut(id(&tree, branch)).unwrap();
    let left = tree.metamers();
    assert!(left < before / 2, "{left} of {before}");
    assert_eq!(tree.skeleton().unwrap().radii()[..=stump], skeleton.radii()[..=stump]);
    let buds = |tree: &SelfOrganizing| {
        let tree = tree.tree().unwrap();
        let stump = tree.positions().position(|node| node == place).unwrap();
        tree.buds().nth(stump).unwrap().map(usize::from).iter().sum::<usize>()
    };
    assert!(buds(&tree) > 0);
    tree.grow(2).unwrap();
    assert_eq!(buds(&tree), 0, "the bud has grown");
    tree.grow(8).unwrap();
    assert!(tree.metamers() > 4 * left.max(25));
    assert!(tree.cut(NodeId(0)).is_err() && tree.cut(NodeId(1_000_000)).is_err());
}

/// Step 5: `w^n = Σ w_child^n`, a bud having the width of a tip, as long as nothing has fallen.
#[test]
fn widths_add_up() {
    let habit = Habit::default().with_shedding(None).with_width_exponent(2.2).with_tip_radius(0.003);
    let mut tree = SelfOrganizing::new(ShadowPropagation::default(), habit.clone(), 3);
    tree.grow(9).unwrap();
    let skeleton = tree.skeleton().unwrap();
    let power = |radius: f32| f64::from(radius).powf(2.2);
    let mut sums: Vec<f64> = tree
        .tree()
        .unwrap()
        .buds()
        .map(|buds| buds.iter().filter(|&&bud| bud).count() as f64 * power(0.003))
        .collect();
    for (child, parent) in skeleton.edges() {
        sums[parent] += power(skeleton.radii()[child]);
    }
    for (node, sum) in sums.iter().enumerate() {
        let here = power(skeleton.radii()[node]);
        assert!((here - sum).abs() < 1e-4 * here, "node {node}: {here} for {sum}");
    }
    let other = SelfOrganizing::new(Even, habit.clone(), 1).skeleton().unwrap();
    let width = Width::new(tree.tree().unwrap(), &habit);
    assert!(width.check().is_ok() && width.radii(&other).is_err(), "another tree's skeleton");
}

/// A tree that sheds does not thin.
#[test]
fn no_node_ever_thins() {
    let mut forest = stand(7);
    let foot =
        |forest: &Forest| forest.skeletons().unwrap().iter().map(|tree| tree.radii()[0]).collect::<Vec<_>>();
    let mut last = foot(&forest);
    for _ in 0..12 {
        forest.step().unwrap();
        let now = foot(&forest);
        assert!(last.iter().zip(&now).take(9).all(|(before, after)| after >= before));
        last = now;
    }
}

/// Step 6: seeds fall within a distance that grows with the logarithm of the vigor.
#[test]
fn seeds_fall_within_reach() {
    let offspring = Offspring::default().with_maturity(5).with_interval(1).with_seeds(2.0).with_distance(0.1);
    assert!((offspring.reach(std::f32::consts::E.powi(3)) - 0.3).abs() < 1e-6);
    let habit = Habit::default().with_offspring(offspring);
    let mut forest = Forest::new(ShadowPropagation::default(), habit, 1).with_most_trees(40);
    forest.plant(Vec3::ZERO).unwrap();
    forest.grow(4).unwrap();
    assert_eq!(forest.trees().len(), 1);
    forest.step().unwrap();
    let first = &forest.trees()[0];
    let reach = offspring.reach(first.vigor());
    let expected = 2.0 * first.vigor().ln();
    let seeds = &forest.trees()[1..];
    assert!((seeds.len() as f32 - expected).abs() <= 1.0, "{} for {expected}", seeds.len());
    assert!(seeds.iter().all(|tree| tree.foot().length() <= reach && tree.generation() == 1));
    assert!(seeds.iter().any(|tree| tree.foot().length() > 0.5 * reach));
    forest.grow(6).unwrap();
    assert!(forest.trees().len() <= 40);
}

/// Two seedlings of one age: the one under a grown tree dies, the one in the open lives.
#[test]
fn the_strong_outlive_the_weak() {
    let mut forest = Forest::new(ShadowPropagation::default(), Habit::default(), 4);
    forest.plant(Vec3::ZERO).unwrap();
    forest.grow(14).unwrap();
    // Where the shade is deepest.
    let light = forest.environment();
    let places = (0..400).map(|i| Vec3::new((i % 20) as f32 * 0.05 - 0.5, 0.0, (i / 20) as f32 * 0.05 - 0.5));
    let darkest = places.max_by(|a, b| light.shadow(*a).total_cmp(&light.shadow(*b))).unwrap();
    assert!(light.shadow(darkest) > 2.5, "{}", light.shadow(darkest));
    let shaded = forest.plant(darkest).unwrap();
    let open = forest.plant(Vec3::new(1.6, 0.0, 1.6)).unwrap();
    forest.grow(8).unwrap();
    let metamers =
        |number: u32| forest.trees().iter().find(|tree| tree.number() == number).map(Tree::metamers);
    assert_eq!(metamers(shaded), None, "it has died");
    assert!(metamers(open).is_some_and(|metamers| metamers > 300));
}

#[test]
fn bad_input_is_named() {
    let named = |environment: ShadowPropagation, habit: Habit, parameter: &str| {
        let mut tree = SelfOrganizing::new(environment, habit, 1);
        match tree.step() {
            Err(ForestError::Parameter(error)) => {
                assert_eq!(error.parameter, parameter);
                assert!(error.to_string().contains(", but must be "), "{error}");
            }
            other => panic!("{parameter}: {other:?}"),
        }
    };
    let light = ShadowPropagation::default;
    let habit = |habit: Habit, parameter: &str| named(light(), habit, parameter);
    for bad in [f32::NAN, f32::INFINITY, -1.0] {
        habit(Habit::default().with_vigor_multiplier(bad), "Habit.vigor_multiplier");
        habit(Habit::default().with_length(bad), "Habit.length");
        habit(Habit::default().with_lateral_angle(bad), "Habit.lateral_angle");
        habit(Habit::default().with_default_weight(bad), "Habit.default_weight");
        habit(Habit::default().with_width_exponent(bad), "Habit.width_exponent");
        habit(Habit::default().with_tip_radius(bad), "Habit.tip_radius");
        habit(Habit::default().with_tropism(Vec3::X * bad * 1e9, 1.0), "Habit.tropism");
        let model = VigorModel::BorchertHonda { apical_control: bad };
        habit(Habit::default().with_vigor_model(model), "VigorModel::BorchertHonda.apical_control");
        let model = VigorModel::Priority { first: 1.0, last: bad, part: 0.5 };
        habit(Habit::default().with_vigor_model(model), "VigorModel::Priority.last");
        let shedding = Shedding::default();
        habit(Habit::default().with_shedding(shedding.with_multiplier(bad)), "Shedding.multiplier");
        habit(Habit::default().with_shedding(shedding.with_exponent(bad)), "Shedding.exponent");
        let offspring = Offspring::default();
        habit(Habit::default().with_offspring(offspring.with_seeds(bad)), "Offspring.seeds");
        habit(Habit::default().with_offspring(offspring.with_distance(bad)), "Offspring.distance");
        named(light().with_cell(bad), Habit::default(), "ShadowPropagation.cell");
        named(light().with_full_exposure(bad), Habit::default(), "ShadowPropagation.full_exposure");
        named(light().with_strength(bad), Habit::default(), "ShadowPropagation.strength");
        named(light().with_falloff(bad), Habit::default(), "ShadowPropagation.falloff");
        named(light().with_darkest(bad), Habit::default(), "ShadowPropagation.darkest");
        let bounds = treesynth::Bounds::around(Vec3::ZERO, Vec3::splat(bad));
        named(ShadowPropagation::new(bounds), Habit::default(), "ShadowPropagation.bounds");
        let space = SpaceColonization::new(vec![Vec3::splat(bad * 1e9)]);
        assert_eq!(space.check().unwrap_err().parameter, "SpaceColonization.markers");
        assert!(SpaceColonization::new(vec![Vec3::ZERO]).with_occupancy(bad).check().is_err());
        assert!(Forest::new(Even, Habit::default(), 1).plant(Vec3::X * bad * 1e9).is_err());
    }
    named(light().with_height(33), Habit::default(), "ShadowPropagation.height");
    named(light().with_cell(1e-5), Habit::default(), "ShadowPropagation.bounds");
    let fine = Forest::new(light().with_cell(1e-5), Habit::default(), 1).check().unwrap_err();
    assert!(fine.range.contains("ShadowPropagation.cell is 0.00001 m"), "{fine}");
    habit(Habit::default().with_offspring(Offspring::default().with_interval(0)), "Offspring.interval");
    assert!(SpaceColonization::new(Vec::new()).check().is_err());
    assert!(SpaceColonization::in_shape(&Sphere::new(Vec3::ZERO, 1.0), 0, 1).is_err());
    assert!(SpaceColonization::in_shape(&Sphere::new(Vec3::ZERO, 1.0), usize::MAX, 1).is_err());
    let mut walled =
        SelfOrganizing::new(light(), Habit::default(), 1).with_obstacle(Sphere::new(Vec3::ZERO, 1.0));
    assert!(matches!(walled.step(), Err(ForestError::Parameter(error)) if error.parameter == "foot"));
    assert!(Forest::new(light(), Habit::default(), 1).plant_as(Vec3::ZERO, 1).is_err());
    assert!(Forest::new(light(), Habit::default(), 1).with_most_trees(0).plant(Vec3::ZERO).is_err());
    assert!(Forest::new(light(), Habit::default(), 1).cut(0, NodeId(1)).is_err());
    for parts in [0, 65, u32::MAX] {
        let error = SelfOrganizing::new(light(), Habit::default(), 1).with_parts(parts).step();
        assert!(matches!(error, Err(ForestError::Parameter(error)) if error.parameter == "Forest.parts"));
    }
}
