//! Landscapes by tiles: what a tile is depends on nothing but the landscape and its place.

use super::forest_hash;
use std::collections::BTreeMap;
use treesynth::glam::{IVec2, Vec3};
use treesynth::self_organizing::{
    Forest, ForestError, Habit, Landscape, Offspring, ShadowPropagation, Terrain, Tree,
};

fn hills(x: f32, z: f32) -> f32 {
    let wave = |along: f32| (along - 20.0 * (along / 20.0).floor() - 10.0).abs();
    0.2 * wave(x) - 0.3 * wave(z)
}

fn plain(seed: u64) -> Landscape {
    let light = |bounds| ShadowPropagation::new(bounds).with_cell(0.1);
    let habit = Habit::default().with_length(0.1).with_tip_radius(0.0025);
    Landscape::new(light, habit, seed).with_spacing(1.2).with_tile(4).with_margin(2)
}

/// Two species by place and chance, gaps, hills, seeds.
fn varied(seed: u64) -> Landscape {
    let mut landscape = plain(seed);
    let offspring = Offspring::default().with_maturity(5).with_interval(3).with_distance(0.5);
    let pioneer = landscape.add_habit(Habit::default().with_length(0.1).with_offspring(offspring));
    let species = move |x: f32, _z: f32, draw: f32| match draw {
        0.0..0.2 => None,
        _ if x > 4.0 => Some(pioneer),
        _ => Some(0),
    };
    landscape.with_species(species).with_terrain(hills)
}

fn nine() -> Vec<IVec2> {
    (0..9).map(|i| IVec2::new(i % 3 - 1, i / 3 - 1)).collect()
}

/// A grid of 3 by 3 tiles in two orders, the second on other threads, has the same bits; so has a tile grown alone.
#[test]
fn tiles_in_any_order_are_the_same() {
    for seed in 1..=2 {
        let landscape = varied(seed);
        let grow = |tile: IVec2| forest_hash(&landscape.grow(tile, 9).unwrap());
        let tiles = nine();
        let forth: Vec<u64> = tiles.iter().map(|&tile| grow(tile)).collect();
        let mut back: Vec<u64> = std::thread::scope(|scope| {
            let work: Vec<_> = tiles.iter().rev().map(|&tile| scope.spawn(move || grow(tile))).collect();
            work.into_iter().map(|work| work.join().unwrap()).collect()
        });
        back.reverse();
        assert_eq!(forth, back);
        // As a process of its own would have it, that has never seen another tile.
        assert_eq!(forest_hash(&varied(seed).grow(IVec2::new(1, 0), 9).unwrap()), forth[5]);
        let distinct: std::collections::BTreeSet<u64> = forth.iter().copied().collect();
        assert_eq!(distinct.len(), 9);
    }
}

/// Each tree of the landscape belongs to one tile; its neighbours plant it with the same number and species at the same
/// place.
#[test]
fn neighbours_agree_on_what_is_planted() {
    for (landscape, far) in [(varied(3), IVec2::ZERO), (varied(4), IVec2::new(-70_000, 90_000))] {
        let mut owners: BTreeMap<u32, u32> = BTreeMap::new();
        let mut known: BTreeMap<u32, (usize, [f64; 2])> = BTreeMap::new();
        for tile in nine() {
            let (tile, mut own) = (tile + far, 0);
            let (forest, origin) = (landscape.plant(tile).unwrap(), landscape.origin(tile));
            for tree in forest.trees() {
                let foot = tree.foot().as_dvec3() + origin;
                let (habit, place) = *known.entry(tree.number()).or_insert((tree.habit(), [foot.x, foot.z]));
                assert!(habit == tree.habit());
                assert!((place[0] - foot.x).abs() < 1e-5 && (place[1] - foot.z).abs() < 1e-5);
                let height = f64::from(hills(foot.x as f32, foot.z as f32));
                assert!((foot.y - height).abs() < 1e-4 * (1.0 + height.abs()), "{} {height}", foot.y);
            }
            for tree in landscape.own(&forest) {
                *owners.entry(tree.number()).or_default() += 1;
                own += 1;
            }
            assert!(own <= 16);
            let full = plain(3).with_terrain(hills);
            assert_eq!(full.own(&full.plant(tile).unwrap()).count(), 16);
        }
        assert!((100..130).contains(&owners.len()), "{} of 144, a fifth being gaps", owners.len());
        assert!(owners.values().all(|&tiles| tiles == 1));
        // Beyond the nine there are only trees of margins.
        assert!(known.len() > owners.len());
    }
}

fn of(tree: &Tree) -> (usize, f32) {
    (tree.metamers(), tree.positions().map(|node| node.y).fold(f32::MIN, f32::max) - tree.foot().y)
}

fn means(trees: &[(usize, f32)]) -> (f32, f32) {
    let count = trees.len() as f32;
    let metamers = trees.iter().map(|tree| tree.0 as f32).sum::<f32>() / count;
    (metamers, trees.iter().map(|tree| tree.1).sum::<f32>() / count)
}

/// With a margin the trees at the edge of a tile are, on the mean, those of the same landscape grown in one piece; without,
/// they grow as at the edge of a wood.
#[test]
fn borders_do_not_show() {
    let whole = plain(1).with_spacing(2.0).with_tile(18).with_margin(3);
    let grown = whole.grow(IVec2::ZERO, 14).unwrap();
    let whole = means(&whole.own(&grown).map(of).collect::<Vec<_>>());
    let edges = |margin: u32| {
        let tiles = plain(1).with_spacing(2.0).with_tile(6).with_margin(margin);
        let mut edge = Vec::new();
        for tile in nine() {
            let forest = tiles.grow(tile + IVec2::ONE, 14).unwrap();
            let near = |along: f32| along < 2.0 || along > tiles.side() - 2.0;
            edge.extend(tiles.own(&forest).filter(|tree| near(tree.foot().x) || near(tree.foot().z)).map(of));
        }
        means(&edge)
    };
    let (with, without) = (edges(2), edges(0));
    assert!(
        (with.0 / whole.0 - 1.0).abs() < 0.06 && (with.1 / whole.1 - 1.0).abs() < 0.05,
        "{with:?} {whole:?}"
    );
    assert!(without.0 > 1.3 * whole.0, "{without:?} {whole:?}");
}

#[test]
fn impossible_landscapes_are_refused() {
    let named = |landscape: Landscape, tile: IVec2, parameter: &str| match landscape.plant(tile) {
        Err(ForestError::Parameter(error)) => assert_eq!(error.parameter, parameter),
        other => panic!("{other:?}"),
    };
    named(plain(1).with_spacing(f32::NAN), IVec2::ZERO, "Landscape.spacing");
    named(plain(1).with_scatter(1.0), IVec2::ZERO, "Landscape.scatter");
    named(plain(1).with_height(0.0), IVec2::ZERO, "Landscape.height");
    named(plain(1).with_tile(0), IVec2::ZERO, "Landscape.tile");
    named(plain(1).with_tile(4097), IVec2::ZERO, "Landscape.tile");
    for margin in [2047, 4096, u32::MAX] {
        named(plain(1).with_margin(margin), IVec2::ZERO, "Landscape.margin");
    }
    named(plain(1), IVec2::MAX, "tile");
    named(plain(1), IVec2::new(0, i32::MIN), "tile");
    named(plain(1).with_species(|_, _, _| Some(7)), IVec2::ZERO, "habit");
    // Where there is no ground nothing is planted.
    let island = plain(1).with_terrain(|x: f32, z: f32| if x * x + z * z < 9.0 { 0.1 * x } else { f32::NAN });
    let forest = island.plant(IVec2::ZERO).unwrap();
    assert!(!forest.trees().is_empty() && forest.trees().len() < 20, "{}", forest.trees().len());
    assert!(island.plant(IVec2::splat(3)).unwrap().trees().is_empty());
}

/// A tile is saved and read as any forest, once it has its ground again.
#[cfg(feature = "json")]
#[test]
fn tiles_are_saved() {
    let (landscape, tile) = (varied(5), IVec2::new(2, -1));
    let straight = landscape.grow(tile, 9).unwrap();
    let mut half = landscape.grow(tile, 4).unwrap();
    let mut bytes = Vec::new();
    half.write_compact(&mut bytes).unwrap();
    half = Forest::read_compact(&bytes[..]).unwrap();
    assert!(half.clone().step().is_err(), "it lacks its ground");
    let mut read = landscape.grounded(tile, half);
    read.grow(5).unwrap();
    assert_eq!(forest_hash(&read), forest_hash(&straight));
    let slope: &dyn Terrain = &hills;
    let foot = straight.trees()[0].foot().as_dvec3() + landscape.origin(tile);
    assert!((slope.height(foot.x as f32, foot.z as f32) - foot.y as f32).abs() < 1e-4);
    assert!(straight.trees().iter().all(|tree| tree.positions().all(Vec3::is_finite)));
}
