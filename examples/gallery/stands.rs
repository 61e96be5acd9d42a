//! Trees and stands that organize themselves.

use super::common::Failure;
use treesynth::foliage::Leaves;
use treesynth::presets::{Season, Stand};
use treesynth::preview::{Picture, Preview};
use treesynth::surface::{Mesh, Part, Tubes};

/// The stand after all its seasons.
pub(crate) fn draw(stand: &Stand, season: Season, size: u32) -> Result<Picture, Failure> {
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
    let paper = [0.97, 0.965, 0.955];
    let mut picture =
        Preview::default().with_size(size, size).with_background(paper, paper).draw_parts(&parts)?;
    picture.label(stand.name, 6, 6, 1, [60, 60, 60]);
    Ok(picture)
}
