//! Trees in a world: materials, and levels of detail by distance.

use crate::{Piece, pieces};
use bevy_asset::{Assets, Handle};
use bevy_camera::visibility::{Visibility, VisibilityRange};
use bevy_color::{Color, LinearRgba};
use bevy_ecs::prelude::{Commands, Entity};
use bevy_image::Image;
use bevy_material::AlphaMode;
use bevy_mesh::{Mesh, Mesh3d};
use bevy_pbr::{MeshMaterial3d, StandardMaterial};
use bevy_transform::components::Transform;
use std::fmt;
use treesynth::asset::Asset;

/// Share of a distance over which two levels are mixed.
const FADE: f32 = 0.1;

/// A tree whose meshes and materials are kept in a world's assets, to be spawned as often as wished.
#[derive(Clone)]
pub struct Kept {
    levels: Vec<Vec<(String, Handle<Mesh>, Handle<StandardMaterial>)>>,
    ranges: Vec<VisibilityRange>,
}

// `VisibilityRange` has no `Debug`.
impl fmt::Debug for Kept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let distances: Vec<_> = self.ranges.iter().map(|range| range.start_margin.start).collect();
        f.debug_struct("Kept").field("levels", &self.levels).field("distances", &distances).finish()
    }
}

/// The material of a piece. Bevy multiplies it by the colours of the vertices.
pub fn material(piece: &Piece, images: &mut Assets<Image>) -> StandardMaterial {
    let [red, green, blue] = piece.color;
    let mut kept = |image: &Option<Image>| image.clone().map(|image| images.add(image));
    let roughness = kept(&piece.images.occlusion_roughness_metallic);
    StandardMaterial {
        base_color: Color::LinearRgba(LinearRgba::rgb(red, green, blue)),
        base_color_texture: kept(&piece.images.base_color),
        normal_map_texture: kept(&piece.images.normal),
        occlusion_texture: roughness.clone(),
        metallic_roughness_texture: roughness,
        perceptual_roughness: piece.roughness,
        metallic: 0.0,
        reflectance: 0.3,
        double_sided: piece.double_sided,
        cull_mode: (!piece.double_sided).then_some(wgpu_types::Face::Back),
        alpha_mode: piece.alpha_cutoff.map_or(AlphaMode::Opaque, AlphaMode::Mask),
        ..StandardMaterial::default()
    }
}

/// From where to where each level of a tree is seen, metres from the camera: a level is shown while its error is less than a
/// pixel, on a screen so many `lines` high, with a camera of a vertical `angle`, radians. Neighbours are mixed.
pub fn ranges(levels: &[Asset], height: f32, lines: f32, angle: f32) -> Vec<VisibilityRange> {
    // A tree of this height is `pixels` high at this distance.
    let distance = |pixels: f32| height * lines / (2.0 * (angle * 0.5).tan() * pixels.max(1.0));
    let mut begins = vec![0.0_f32];
    for level in levels.iter().skip(1) {
        let last = begins.last().copied().unwrap_or(0.0);
        begins.push(distance(level.pixels(height)).max(last + 1.0));
    }
    let margin = |at: f32| at..at * (1.0 + FADE);
    (0..begins.len())
        .map(|i| VisibilityRange {
            start_margin: if i == 0 { 0.0..0.0 } else { margin(begins[i]) },
            end_margin: begins.get(i + 1).map_or(f32::MAX..f32::MAX, |&end| margin(end)),
            use_aabb: false,
        })
        .collect()
}

/// Puts the meshes and materials of all levels, the finest first, into a world's assets.
pub fn keep(
    levels: &[Asset],
    ranges: Vec<VisibilityRange>,
    meshes: &mut Assets<Mesh>,
    materials: &mut Assets<StandardMaterial>,
    images: &mut Assets<Image>,
) -> Kept {
    let mut kept = |level: &Asset| {
        let add = |piece: Piece| {
            let material = materials.add(material(&piece, images));
            // Thousands of leaves are one entity: Bevy draws them at once, and none has to be looked at in a frame.
            (piece.name, meshes.add(piece.all.unwrap_or(piece.mesh)), material)
        };
        pieces(level).into_iter().map(add).collect()
    };
    Kept { levels: levels.iter().map(&mut kept).collect(), ranges }
}

/// A tree in its place: an entity with a child a piece of each level. Trees of the same meshes are drawn together.
pub fn spawn(commands: &mut Commands<'_, '_>, tree: &Kept, place: Transform) -> Entity {
    let root = commands.spawn((place, Visibility::default())).id();
    for (pieces, range) in tree.levels.iter().zip(&tree.ranges) {
        for (_, mesh, material) in pieces {
            let piece =
                (Mesh3d(mesh.clone()), MeshMaterial3d(material.clone()), Transform::default(), range.clone());
            let child = commands.spawn(piece).id();
            commands.entity(root).add_child(child);
        }
    }
    root
}
