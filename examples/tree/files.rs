//! Files by the names of their formats.

use super::Failure;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use treesynth::Skeleton;
use treesynth::export::{self, GlbOptions, Instancing, PlyFormat, SvgOptions};
use treesynth::presets::Preset;
use treesynth::preview::Preview;
use treesynth::surface::Part;

/// The formats of `--format`.
pub(crate) const FORMATS: [&str; 9] =
    ["glb", "nodes.glb", "obj", "ply", "stl", "svg", "png", "json", "relaxed.json"];

/// Writes the tree into a folder in one of the [`FORMATS`]; its finest level alone where there can be no others.
pub(crate) fn write(
    format: &str,
    folder: &Path,
    preset: &Preset,
    skeleton: &Skeleton,
    levels: &[Vec<Part<'_>>],
) -> Result<(), Failure> {
    let parts = &levels[0];
    let file = |extension: &str| format!("{}.{extension}", preset.name);
    create(&folder.join(file(format)), |writer| {
        let glb = GlbOptions::default().with_name(preset.name);
        match format {
            "glb" => export::write_glb_levels(levels, &glb, writer)?,
            "nodes.glb" => {
                export::write_glb_levels(levels, &glb.with_instancing(Instancing::Nodes), writer)?;
            }
            "obj" => export::write_obj(parts, &file("mtl"), writer)?,
            "ply" => export::write_ply(parts, PlyFormat::Binary, writer)?,
            "stl" => export::write_stl(parts, writer)?,
            "svg" => {
                let look = SvgOptions::default().with_material(preset.bark());
                export::write_svg(skeleton, &look, writer)?;
            }
            "png" => Preview::default().draw_parts(parts)?.write_png(writer)?,
            _ => export::write_skeleton(skeleton, writer)?,
        }
        Ok(())
    })?;
    if format == "obj" {
        create(&folder.join(file("mtl")), |writer| Ok(export::write_mtl(parts, writer)?))?;
    }
    Ok(())
}

/// Fills a new file; a failure names it.
pub(crate) fn create(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<File>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let fill = || -> Result<(), Failure> {
        let mut writer = BufWriter::new(File::create(path)?);
        content(&mut writer)?;
        Ok(writer.flush()?)
    };
    fill().map_err(|error| format!("{}: {error}", path.display()).into())
}
