//! Trees and stands that organize themselves.

use super::common::Failure;
use treesynth::Bounds;
use treesynth::foliage::Leaves;
use treesynth::presets::{Season, Stand};
use treesynth::preview::{Camera, Picture, Preview};
use treesynth::self_organizing::Environment;
use treesynth::surface::{Material, Mesh, Part, Tubes};

/// The stand after all its seasons.
pub(crate) fn draw<E: Environment>(stand: &Stand<E>, season: Season, size: u32) -> Result<Picture, Failure> {
    let forest = stand.grow(stand.seed)?;
    let skeletons = forest.skeletons()?;
    // A seed that has not sprouted has no surface.
    let trees = || forest.trees().iter().zip(&skeletons).filter(|(_, skeleton)| skeleton.len() > 1);
    let tubes = Tubes::default().with_sides(6);
    let meshes: Vec<Mesh> = trees().map(|(_, skeleton)| tubes.mesh(skeleton)).collect::<Result<_, _>>()?;
    let leaves: Vec<Option<Leaves>> =
        trees().map(|(tree, skeleton)| stand.leaves(tree, skeleton, season)).collect::<Result<_, _>>()?;
    let parts: Vec<Part<'_>> =
        meshes.iter().map(Part::new).chain(leaves.iter().flatten().map(Leaves::part)).collect();
    let bounds = meshes.iter().filter_map(Mesh::bounds).reduce(Bounds::union);
    let ground = bounds.and_then(|bounds| stand.ground(bounds));
    let earth = Material::bark().with_srgb([150, 142, 120]);
    let parts: Vec<Part<'_>> =
        parts.into_iter().chain(ground.iter().map(|mesh| Part::new(mesh).with_material(earth))).collect();
    let paper = [0.97, 0.965, 0.955];
    // From higher up than the slope is steep.
    let camera = if ground.is_some() { Camera::default().with_elevation(0.6) } else { Camera::default() };
    let mut picture = Preview::default()
        .with_camera(camera)
        .with_size(size, size)
        .with_background(paper, paper)
        .draw_parts(&parts)?;
    picture.label(stand.name, 6, 6, 1, [60, 60, 60]);
    Ok(picture)
}
