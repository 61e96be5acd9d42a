//! Presets that are tended: a hedge, a pollard, strokes of a brush; environments that change while a forest grows.

use super::forest_hash;
use treesynth::glam::Vec3;
use treesynth::self_organizing::{Forest, Habit, ShadowPropagation, SpaceColonization, Tree};
use treesynth::shape::{Brush, Cuboid, HalfEllipsoid};
use treesynth::{Bounds, Shape, presets};

fn tended(name: &str, seed: u64) -> Forest {
    presets::by_name(name).unwrap().stand().unwrap().grow(seed).unwrap()
}

fn colony(name: &str, seed: u64) -> Forest<SpaceColonization> {
    presets::by_name(name).unwrap().space().unwrap().grow(seed).unwrap()
}

/// All 20 are alive after 30 seasons, a fifth of their nodes in the lowest third, and nothing sticks out.
#[test]
fn a_hedge_keeps_all_its_trees() {
    for seed in 1..=6 {
        let hedge = tended("stand-hedge", seed);
        assert_eq!(hedge.season(), 30);
        let alive = hedge.trees().iter().filter(|tree| tree.metamers() > 10).count();
        assert_eq!(alive, 20, "seed {seed}");
        let nodes: Vec<Vec3> = hedge.trees().iter().flat_map(Tree::positions).collect();
        let low = nodes.iter().filter(|node| node.y < 0.5).count();
        assert!(low * 5 >= nodes.len(), "seed {seed}: {low} of {}", nodes.len());
        let bounds = Bounds::of(nodes.iter().copied());
        assert!(
            bounds.max.y <= 1.5 && bounds.max.y > 1.4 && bounds.size().z <= 1.2 && bounds.size().x <= 10.0
        );
        // It closes: each quarter of a metre along it has nodes at each height.
        for place in 0..39 {
            for height in [0.25, 0.75, 1.25] {
                let at = Vec3::new(-4.75 + 0.25 * place as f32, height, 0.0);
                assert!(
                    nodes.iter().any(|node| (*node - at).with_z(0.0).length() < 0.25),
                    "seed {seed}: {at}"
                );
            }
        }
    }
}

/// In the default habit too all 20 live, 15 cm apart under light from the sides, and as the default light has it with ten
/// metamers between them.
#[test]
fn a_hedge_of_the_default_habit_lives() {
    let sides = || ShadowPropagation::default().with_height(1);
    for (light, spacing) in [(sides(), 0.1), (sides(), 0.15), (ShadowPropagation::default(), 0.2)] {
        for seed in 1..=6 {
            let mut hedge = Forest::new(light.clone(), Habit::default(), seed);
            for i in 0..20u8 {
                hedge.plant(Vec3::X * (spacing * (f32::from(i) - 9.5))).unwrap();
            }
            let half = Vec3::new(10.0 * spacing, 0.3, 0.12);
            let shape = Cuboid::new(half.with_y(0.1) * -1.0, half);
            for _ in 0..30 {
                hedge.step().unwrap();
                hedge.prune(&shape).unwrap();
            }
            let alive = hedge.trees().iter().filter(|tree| tree.metamers() > 10).count();
            assert_eq!(alive, 20, "seed {seed}, {spacing} m apart");
        }
    }
}

/// Each year from its twelfth on the bird is clipped to its shape, all of it is filled, and each side of its outline is
/// there: from the left it covers its silhouette and nothing else.
#[test]
fn a_peacock_keeps_its_shape() {
    for seed in 1..=3 {
        let stand = presets::by_name("stand-peacock").unwrap().stand().unwrap();
        let mut forest = stand.plant(seed).unwrap();
        for season in 1..=stand.seasons {
            forest.step().unwrap();
            let grown = forest.metamers();
            stand.tend(&mut forest).unwrap();
            if season < 16 {
                continue;
            }
            assert!(forest.metamers() < grown, "there was something to clip");
            let nodes: Vec<Vec3> = forest.trees().iter().flat_map(Tree::positions).collect();
            let inside = nodes.iter().filter(|&&node| presets::Peacock.contains(node)).count();
            assert!(inside * 100 >= nodes.len() * 95, "seed {seed}: {inside} of {}", nodes.len());
            let bounds = presets::Peacock.bounds();
            let (mut all, mut filled) = (0, 0);
            for i in 0..22 * 18 * 11 {
                let place = Vec3::new((i % 22) as f32, (i / 22 % 18) as f32, (i / (22 * 18)) as f32) * 0.15;
                let place = bounds.min + place;
                if place.y > 0.0 && presets::Peacock.contains(place) {
                    all += 1;
                    filled += u32::from(nodes.iter().any(|node| node.distance(place) < 0.15));
                }
            }
            assert!(all > 500 && filled * 100 >= all * 95, "seed {seed}, {season}: {filled} of {all}");
        }
    }
}

/// Above the head there are only shoots of the years since it was last cut.
#[test]
fn a_pollard_sprouts_from_its_head() {
    for seed in 1..=4 {
        let forest = tended("stand-pollard", seed);
        let tree = forest.skeletons().unwrap().remove(0);
        let above = (1..tree.len()).filter(|&node| tree.positions()[node].y > 2.01).collect::<Vec<_>>();
        assert!(above.len() > 100, "seed {seed}: {}", above.len());
        assert!(above.iter().all(|&node| tree.stages()[node] > 31), "seed {seed}");
        let sprouts =
            above.iter().filter(|&&node| tree.positions()[tree.parent(node).unwrap()].y <= 2.01).count();
        assert!(sprouts >= 4, "seed {seed}: {sprouts} from the head");
    }
}

/// At least 95% of the nodes lie in the strokes, and each stroke is filled from end to end.
#[test]
fn a_brush_paints_where_it_grows() {
    for seed in 1..=4 {
        let forest = colony("space-brush", seed);
        let nodes: Vec<Vec3> = forest.trees().iter().flat_map(Tree::positions).collect();
        let strokes = presets::strokes();
        let inside = nodes.iter().filter(|&&node| strokes.iter().any(|stroke| stroke.contains(node))).count();
        assert!(inside * 100 >= nodes.len() * 95 && inside > 300, "seed {seed}: {inside} of {}", nodes.len());
        for stroke in &strokes {
            for &point in stroke.points() {
                assert!(nodes.iter().any(|node| node.distance(point) < 0.45), "seed {seed}: {point}");
            }
        }
    }
}

#[test]
fn a_crown_of_markers_is_filled() {
    let crown = HalfEllipsoid::new(Vec3::Y * 1.2, Vec3::new(2.0, 3.2, 2.0));
    for seed in 1..=3 {
        let forest = colony("space-crown", seed);
        let nodes: Vec<Vec3> = forest.trees().iter().flat_map(Tree::positions).collect();
        let stem = Brush::new(vec![Vec3::ZERO, Vec3::Y * 1.6], 0.25);
        assert!(nodes.iter().all(|&node| crown.contains(node) || stem.contains(node)));
        let free = forest.environment().free() as f32 / forest.environment().markers().len() as f32;
        assert!(free < 0.2 && nodes.len() > 1000, "seed {seed}: {free} free, {} nodes", nodes.len());
    }
}

/// What does not change leaves all bits as they were; another cell is that of a light that always had it.
#[test]
fn environments_change_and_know_what_stands() {
    let planted = |seed: u64| {
        let mut forest = super::growth::stand(seed);
        forest.grow(7).unwrap();
        forest
    };
    for seed in 1..=3 {
        let (mut one, mut other) = (planted(seed), planted(seed));
        one.environment_mut(|_| ());
        assert!(one.environment() == other.environment());
        one.grow(3).unwrap();
        other.grow(3).unwrap();
        assert_eq!(forest_hash(&one), forest_hash(&other));
        let wider = |light: &ShadowPropagation| light.clone().with_cell(0.05);
        one.environment_mut(|light| *light = wider(light));
        let nodes: Vec<Vec3> = one.trees().iter().flat_map(Tree::positions).collect();
        // The shade of a species follows from the cell, so it is told at the next season.
        one.step().unwrap();
        assert!(nodes.iter().any(|&node| one.environment().shadow(node) > 0.0));
        #[cfg(feature = "json")]
        {
            let text = serde_json::to_string(&one).unwrap();
            let read: Forest = serde_json::from_str(&text).unwrap();
            assert!(read.environment() == one.environment());
        }
    }
}

/// Painted on in mid-life, saved and read, it goes on to the same bits.
#[cfg(feature = "json")]
#[test]
fn painted_forests_can_be_saved() {
    for seed in 1..=3 {
        let stand = presets::by_name("space-brush").unwrap().space().unwrap();
        let mut forest = stand.plant(seed).unwrap();
        for _ in 0..12 {
            forest.step().unwrap();
            stand.tend(&mut forest).unwrap();
        }
        let text = serde_json::to_string(&forest).unwrap();
        let mut read: Forest<SpaceColonization> = serde_json::from_str(&text).unwrap();
        for forest in [&mut forest, &mut read] {
            for _ in 0..8 {
                forest.step().unwrap();
                stand.tend(forest).unwrap();
            }
        }
        assert_eq!(forest_hash(&forest), forest_hash(&read));
        assert_eq!(forest.environment().free(), read.environment().free());
    }
}

/// The ground of the slope lies under all its trees; level stands have none of their own.
#[test]
fn a_slope_has_its_ground() {
    let stand = presets::by_name("stand-slope").unwrap().stand().unwrap();
    let forest = stand.grow(1).unwrap();
    let bounds = Bounds::of(forest.trees().iter().flat_map(Tree::positions));
    let ground = stand.ground(bounds).unwrap();
    ground.check().unwrap();
    let around = ground.bounds().unwrap();
    assert!(around.min.x <= bounds.min.x && around.max.x >= bounds.max.x);
    assert!(around.min.z <= bounds.min.z && around.max.z >= bounds.max.z);
    let mut tops = 0;
    for (place, normal) in ground.positions.iter().zip(&ground.normals) {
        if normal.y > 0.8 {
            assert!((place.y - 0.5 * place.x).abs() < 1e-4, "{place}");
            tops += 1;
        } else {
            assert!(normal.y.abs() < 1e-4 && place.y < 0.5 * place.x + 1e-4, "a wall: {place}");
        }
    }
    assert!(tops > 500 && ground.area() > around.size().x * around.size().z);
    assert!(presets::by_name("stand-wall").unwrap().stand().unwrap().ground(bounds).is_none());
}
