//! Landscapes with options of any value: an error that names one, or tiles whose trees are sound and each its own.

use super::Target;
use super::numbers::Numbers;
use super::options::{seeds, some_of};
use treesynth::glam::{IVec2, Vec3};
use treesynth::self_organizing::{DeadWood, Habit, Landscape, ShadowPropagation, Shedding, Tree};

pub(super) fn all() -> Vec<Target> {
    vec![Target { name: "landscape", seeds: seeds(96), run: landscape }]
}

/// A few cells, or none, or so many that they are refused.
fn cells(n: &mut Numbers<'_>) -> u32 {
    let count = n.count();
    if count > 4096 { count } else { count % 5 }
}

fn landscape(bytes: &[u8]) -> bool {
    let mut n = Numbers(bytes);
    let dead = some_of!(n, DeadWood::default().with_seasons(2), with_shade(float));
    let habit =
        some_of!(n, Habit::default().with_dead_wood(dead), with_length(float), with_shade_tolerance(float));
    let habit = if n.is_set() { habit.with_shedding(Shedding::self_thinning()) } else { habit };
    let light = |bounds| ShadowPropagation::new(bounds).with_cell(0.1);
    let few = Landscape::new(light, habit.clone(), 1).with_tile(1 + cells(&mut n) % 5).with_margin(1);
    let mut landscape =
        some_of!(n, few, with_spacing(float), with_scatter(float), with_height(float)).with_spacing(0.5);
    if n.is_set() {
        landscape = landscape.with_spacing(n.float());
    }
    if n.is_set() {
        landscape = landscape.with_tile(cells(&mut n));
    }
    if n.is_set() {
        landscape = landscape.with_margin(cells(&mut n));
    }
    if n.is_set() {
        let (height, slope) = (n.float(), n.float());
        landscape = landscape.with_terrain(move |x: f32, z: f32| height + slope * (x - 0.5 * z));
    }
    if n.is_set() {
        let other = landscape.add_habit(habit);
        let kinds = 1 + usize::from(n.byte() % 4);
        landscape =
            landscape.with_species(move |_, _, draw| Some((draw * kinds as f32) as usize % (other + 2)));
    }
    let tile =
        IVec2::from_array([(); 2].map(|()| if n.is_set() { n.count() as i32 } else { i32::from(n.byte()) }));
    let Ok(forest) = landscape.plant(tile) else { return false };
    let mut forest = forest.with_most_metamers(3_000);
    let _ = forest.grow(3);
    let planted = forest.trees().first().map(Tree::number);
    if let Some(tree) = planted {
        assert_eq!(forest.kill(tree), Ok(()));
    }
    let _ = forest.step();
    let side = landscape.side();
    for tree in landscape.own(&forest) {
        assert!((0.0..side).contains(&tree.foot().x) && (0.0..side).contains(&tree.foot().z));
    }
    assert!(forest.trees().iter().all(|tree| tree.positions().all(Vec3::is_finite)));
    assert!(forest.trees().windows(2).all(|pair| pair[0].number() < pair[1].number()));
    let text = serde_json::to_vec(&forest).expect("a forest can be written");
    let read = serde_json::from_slice(&text).expect("what has grown can be read");
    assert_eq!(landscape.grounded(tile, read).trees(), forest.trees());
    true
}
