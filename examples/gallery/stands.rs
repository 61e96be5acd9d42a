//! Trees and stands that organize themselves.

use super::Failure;
use treesynth::presets::Stand;
use treesynth::preview::{Picture, Preview};
use treesynth::surface::{Mesh, Part, Tubes};

/// The stand after all its seasons.
pub(crate) fn draw(stand: &Stand, size: u32) -> Result<Picture, Failure> {
    let skeletons = stand.grow(stand.seed)?.skeletons()?;
    let tubes = Tubes::default().with_sides(6);
    // A seed that has not sprouted has no surface.
    let meshes = skeletons.iter().filter(|tree| tree.len() > 1).map(|tree| tubes.mesh(tree));
    let meshes: Vec<Mesh> = meshes.collect::<Result<_, _>>()?;
    let parts: Vec<Part<'_>> = meshes.iter().map(Part::new).collect();
    let paper = [0.97, 0.965, 0.955];
    let mut picture =
        Preview::default().with_size(size, size).with_background(paper, paper).draw_parts(&parts)?;
    picture.label(stand.name, 6, 6, 1, [60, 60, 60]);
    Ok(picture)
}
