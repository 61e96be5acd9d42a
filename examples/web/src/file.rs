//! Trees as bytes of a file.

use crate::ask::Ask;
use crate::preview;
use crate::tree::{Look, Tree};
use std::error::Error;
use treesynth::export::{self, GlbOptions, LevelNodes, UsdStage};

/// What can be written. `obj` is several files, one after the other.
pub const FORMATS: [&str; 6] = ["glb", "levels", "obj", "usdz", "json", "recipe"];

/// Bytes, and the names and lengths of the files that they are if they are several.
#[derive(Debug, Default)]
pub struct Written {
    pub bytes: Vec<u8>,
    pub files: Vec<(String, usize)>,
}

impl Written {
    fn add(&mut self, name: &str, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
        self.files.push((name.to_owned(), bytes.len()));
    }
}

pub fn write(ask: &Ask, tree: &Tree<'_>) -> Result<Written, Box<dyn Error>> {
    let mut written = Written::default();
    let options = GlbOptions::default().with_name(tree.name);
    if let Look::Preview(pieces) = &tree.look {
        pieces.iter().for_each(|piece| preview::write(piece, &mut written.bytes));
        return Ok(written);
    }
    let parts = tree.look.parts(ask.level);
    let file = &mut written.bytes;
    match ask.format.as_str() {
        "json" => export::write_skeleton(&tree.skeleton, file)?,
        "recipe" => *file = tree.recipe.clone().into_bytes(),
        "usdz" => export::write_usdz(&UsdStage::of_parts(&parts).with_name(tree.name), file)?,
        "levels" => {
            let levels: Vec<_> = tree.look.levels().iter().map(treesynth::asset::Asset::parts).collect();
            export::write_glb_levels(&levels, &options.with_levels(LevelNodes::Named), file)?;
        }
        "obj" => {
            let (mut obj, mut materials) = (Vec::new(), Vec::new());
            export::write_obj(&parts, "tree.mtl", &mut obj)?;
            export::write_mtl(&parts, &mut materials)?;
            written.add("tree.obj", &obj);
            written.add("tree.mtl", &materials);
            for image in export::mtl_images(&parts) {
                written.add(image.name(), &image.png());
            }
        }
        _ => export::write_glb_parts(&parts, &options, file)?,
    }
    Ok(written)
}
