//! The sun's path: crowns lean to it, shadows fall away from it.

use super::forest_hash;
use treesynth::Bounds;
use treesynth::glam::Vec3;
use treesynth::self_organizing::{
    Daylight, Environment, Forest, ForestError, Habit, SelfOrganizing, ShadowPropagation, Shedding, Tree,
};
use treesynth::shape::Cuboid;

const SEEDS: u64 = 20;

fn light(latitude: Option<f32>) -> ShadowPropagation {
    let bounds = Bounds::new(Vec3::new(-5.0, 0.0, -5.0), Vec3::new(5.0, 7.0, 5.0));
    let daylight = latitude.map(|degrees| Daylight::at_latitude(degrees.to_radians()));
    ShadowPropagation::new(bounds).with_cell(0.1).with_daylight(daylight)
}

/// A forest of 6 m that begins 2 m from the tree, to these sides.
fn walls(sides: &[Vec3]) -> Vec<Cuboid> {
    let wall = |side: &Vec3| {
        let (near, far) = (*side * 2.0, *side * 9.0);
        let along = Vec3::new(9.0 * side.z.abs(), 0.0, 9.0 * side.x.abs());
        Cuboid::new((near - along).min(far - along), (near + along).max(far + along).with_y(6.0))
    };
    sides.iter().map(wall).collect()
}

/// How far the middles of crowns are south of the foot, metres, of the trees that live.
fn leans(latitude: Option<f32>, sides: &[Vec3]) -> Vec<f32> {
    let one = |seed: u64| {
        let tree = SelfOrganizing::new(light(latitude), Habit::default().with_length(0.1), seed);
        let mut tree = walls(sides).into_iter().fold(tree, SelfOrganizing::with_obstacle);
        tree.grow(14).unwrap();
        let nodes = tree.tree()?.positions();
        let count = nodes.len() as f32;
        Some(nodes.map(|node| node.z).sum::<f32>() / count)
    };
    (1..=SEEDS).filter_map(one).collect()
}

fn south(leans: &[f32]) -> usize {
    leans.iter().filter(|&&lean| lean > 0.0).count()
}

/// On the northern edge of a clearing crowns lean to the sun, farther than they would to the open sky alone. Where east
/// and west are hidden, and the sky draws them to neither side, the sun does.
#[test]
fn crowns_lean_to_the_sun() {
    let nine_tenths = SEEDS as usize * 9 / 10;
    let edge = [Vec3::NEG_Z, Vec3::X, Vec3::NEG_X];
    let (sunny, overcast) = (leans(Some(50.0), &edge), leans(None, &edge));
    let mean = |leans: &[f32]| leans.iter().sum::<f32>() / leans.len() as f32;
    assert!(south(&sunny) >= nine_tenths, "{sunny:?}");
    assert!(mean(&sunny) > mean(&overcast) + 0.1, "{} and {}", mean(&sunny), mean(&overcast));
    let lane = [Vec3::X, Vec3::NEG_X];
    let (north, beyond, overcast) = (leans(Some(50.0), &lane), leans(Some(-50.0), &lane), leans(None, &lane));
    assert!(south(&north) >= nine_tenths, "{north:?}");
    assert!(beyond.iter().filter(|&&lean| lean < 0.0).count() >= nine_tenths, "{beyond:?}");
    assert!((3..=17).contains(&south(&overcast)) && overcast.len() >= nine_tenths, "{overcast:?}");
}

/// After growth, shedding and cuts the grid is that of what stands; saved, and in parts, and on more threads, the same.
#[test]
fn leaning_shadows_are_those_of_what_stands() {
    for (seed, parts) in [(1, 1), (2, 3), (3, 1)] {
        let shedding = Shedding::default().with_multiplier(0.6).with_grace(1);
        let planted = || {
            let habit = Habit::default().with_length(0.1).with_shedding(shedding);
            let mut forest = Forest::new(light(Some(50.0)), habit, seed).with_parts(parts);
            for x in [-4.9, 0.0, 0.4] {
                forest.plant(Vec3::X * x).unwrap();
            }
            forest
        };
        let mut forest = planted();
        forest.grow(8).unwrap();
        let node = forest.trees()[0].ids().nth(9).unwrap();
        forest.cut(forest.trees()[0].number(), node).unwrap();
        let mut fresh = light(Some(50.0));
        let nodes: Vec<Vec3> = forest.trees().iter().flat_map(Tree::positions).collect();
        fresh.update(&nodes, &[]);
        assert!(nodes.len() > 500 && *forest.environment() == fresh);
        assert!(fresh != light(None));
        let hash = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut forest = planted();
            pool.install(|| forest.grow(8)).unwrap();
            forest_hash(&forest)
        };
        assert_eq!(hash(1), hash(3));
        #[cfg(feature = "json")]
        {
            let text = serde_json::to_string(&forest).unwrap();
            let mut read: Forest = serde_json::from_str(&text).unwrap();
            assert!(read.environment() == forest.environment());
            forest.grow(3).unwrap();
            read.grow(3).unwrap();
            assert_eq!(forest_hash(&read), forest_hash(&forest));
        }
    }
}

#[test]
fn bad_daylight_is_named() {
    for (daylight, name) in [
        (Daylight::at_latitude(50.0), "Daylight.latitude"),
        (Daylight::at_latitude(f32::NAN), "Daylight.latitude"),
        (Daylight::at_latitude(0.5).with_direct(-0.1), "Daylight.direct"),
    ] {
        let light = ShadowPropagation::default().with_daylight(daylight);
        let mut tree = SelfOrganizing::new(light, Habit::default(), 1);
        assert!(matches!(tree.step(), Err(ForestError::Parameter(error)) if error.parameter == name));
    }
}
