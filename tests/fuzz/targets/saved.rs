//! Forms of this crate's own: skeletons, recipes, forests, species.

use super::Target;
use treesynth::export::{read_skeleton, write_skeleton};
use treesynth::glam::Vec3;
use treesynth::guided::Recipe;
use treesynth::self_organizing::{Environment, Forest, Habit, ShadowPropagation, SpaceColonization};
use treesynth::shape::Sphere;
use treesynth::species::Species;
use treesynth::{Skeleton, presets, species};

pub(super) fn all() -> Vec<Target> {
    let target = |name, seeds, run| Target { name, seeds, run };
    vec![
        target("skeleton", vec![skeleton()], |bytes| {
            let Ok(skeleton) = read_skeleton(bytes) else { return false };
            assert_eq!(skeleton.check(), Ok(()));
            true
        }),
        target("recipe", recipes(), recipe),
        target("species", vec![species("hazel"), species("Norway spruce")], |bytes| {
            let Ok(species) = Species::parse(&String::from_utf8_lossy(bytes)) else { return false };
            let text = species.to_text();
            assert!(Species::parse(&text).ok().as_ref() == Some(&species), "{text}");
            true
        }),
        target("forest", vec![serde_json::to_vec(&forest()).expect("a forest can be written")], |bytes| {
            serde_json::from_slice::<Forest>(bytes).is_ok_and(one_season)
        }),
        target(
            "colonization",
            vec![serde_json::to_vec(&space()).expect("a forest can be written")],
            |bytes| serde_json::from_slice::<Forest<SpaceColonization>>(bytes).is_ok_and(one_season),
        ),
        target("compact", vec![compact()], |bytes| {
            Forest::<ShadowPropagation>::read_compact(bytes).is_ok_and(one_season)
        }),
    ]
}

/// A tree of four nodes.
pub(super) fn fork() -> Skeleton {
    let nodes = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 2.0, 0.0], [-1.0, 2.0, 0.5]].map(Vec3::from);
    let tree = Skeleton::new(nodes.into(), vec![None, Some(0), Some(1), Some(1)]);
    tree.and_then(|tree| tree.with_radii(vec![0.2, 0.1, 0.05, 0.05])).expect("a tree")
}

fn skeleton() -> Vec<u8> {
    let mut bytes = Vec::new();
    write_skeleton(&fork(), &mut bytes).expect("vectors take everything");
    bytes
}

/// A recipe that its check takes is written and read as it is.
fn recipe(bytes: &[u8]) -> bool {
    let Ok(recipe) = Recipe::from_json(&String::from_utf8_lossy(bytes)) else { return false };
    let text = recipe.to_json().expect("what was read can be written");
    assert!(Recipe::from_json(&text).ok().as_ref() == Some(&recipe), "{text}");
    true
}

fn recipes() -> Vec<Vec<u8>> {
    let text = |name: &str| {
        let preset = presets::by_name(name).and_then(presets::Found::guided).expect("a preset");
        preset.recipe(300).to_json().expect("a recipe").into_bytes()
    };
    ["figure-06c", "figure-17e", "figure-13"].map(text).into()
}

fn species(name: &str) -> Vec<u8> {
    species::by_name(name).expect("a species").to_text().into_bytes()
}

/// A sound forest goes on, or says what limits it.
fn one_season<E: Environment>(forest: Forest<E>) -> bool {
    let mut forest = forest.with_most_metamers(20_000);
    let _ = forest.step();
    for tree in forest.trees() {
        assert!(tree.positions().all(Vec3::is_finite));
    }
    true
}

fn forest() -> Forest {
    let mut forest = Forest::new(ShadowPropagation::default(), Habit::default(), 1);
    forest.plant(Vec3::ZERO).expect("there is room");
    forest.plant(Vec3::X).expect("there is room");
    forest.grow(4).expect("no limit is near");
    forest
}

fn space() -> Forest<SpaceColonization> {
    let ball = Sphere::new(Vec3::Y * 0.5, 0.5);
    let space = SpaceColonization::in_shape(&ball, 40, 1).expect("a sound shape");
    let mut forest = Forest::new(space, Habit::default(), 1);
    forest.plant(Vec3::ZERO).expect("there is room");
    forest.grow(2).expect("no limit is near");
    forest
}

fn compact() -> Vec<u8> {
    let mut bytes = Vec::new();
    forest().write_compact(&mut bytes).expect("vectors take everything");
    bytes
}
