//! A tree in a world: all its pieces, with the materials they share, each level at its distance.
#![cfg(feature = "pbr")]

use bevy_asset::Assets;
use bevy_camera::visibility::VisibilityRange;
use bevy_ecs::prelude::{ChildOf, Commands, World};
use bevy_ecs::world::CommandQueue;
use bevy_image::Image;
use bevy_mesh::{Mesh, Mesh3d};
use bevy_pbr::{MeshMaterial3d, StandardMaterial};
use bevy_transform::components::Transform;
use treesynth::asset::Asset;
use treesynth::species;
use treesynth_bevy::{keep, pieces, ranges, spawn};

const HEIGHT: f32 = 4.0;

fn levels() -> Vec<Asset> {
    let birch = species::by_name("silver birch").unwrap().request().with_height(HEIGHT).with_seed(3).grow();
    birch.unwrap().levels(Some(3_000), 128, &[1.0, 0.3]).unwrap()
}

#[test]
fn levels_follow_one_another_without_a_gap() {
    let ranges = ranges(&levels(), HEIGHT, 1080.0, 0.785);
    assert_eq!(ranges[0].start_margin, 0.0..0.0);
    for pair in ranges.windows(2) {
        assert_eq!(pair[0].end_margin, pair[1].start_margin);
        assert!(pair[0].end_margin.start > 0.0 && pair[0].end_margin.start < pair[0].end_margin.end);
    }
    assert_eq!(ranges.last().unwrap().end_margin, f32::MAX..f32::MAX);
}

#[test]
fn trees_share_meshes_and_stand_where_they_are_put() {
    let levels = levels();
    let mut meshes = Assets::<Mesh>::default();
    let mut materials = Assets::<StandardMaterial>::default();
    let mut images = Assets::<Image>::default();
    let kept =
        keep(&levels, ranges(&levels, HEIGHT, 1080.0, 0.785), &mut meshes, &mut materials, &mut images);
    let count: usize = levels.iter().map(|level| pieces(level).len()).sum();
    assert_eq!([meshes.len(), materials.len()], [count; 2]);
    assert!(!images.is_empty());

    let mut world = World::new();
    let mut queue = CommandQueue::default();
    let mut commands = Commands::new(&mut queue, &world);
    let roots = [0.0, 8.0].map(|x| spawn(&mut commands, &kept, Transform::from_xyz(x, 0.0, 0.0)));
    queue.apply(&mut world);
    for (root, x) in roots.into_iter().zip([0.0, 8.0]) {
        assert_eq!(world.get::<Transform>(root).unwrap().translation.x, x);
    }
    let mut all = world.query::<(&Mesh3d, &MeshMaterial3d<StandardMaterial>, &VisibilityRange, &ChildOf)>();
    let all: Vec<_> = all.iter(&world).collect();
    assert_eq!(all.len(), 2 * count);
    for (mesh, material, _, parent) in all {
        assert!(meshes.get(mesh.0.id()).is_some() && materials.get(material.0.id()).is_some());
        assert!(roots.contains(&parent.0));
    }
}
