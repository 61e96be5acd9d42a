//! Files by the names of their formats.

use super::common::{Failure, Outputs};
use super::options::Options;
use treesynth::Skeleton;
use treesynth::export::{self, Axes, GlbOptions, Instancing, LevelNodes, PlyFormat, SvgOptions};
use treesynth::presets::Preset;
use treesynth::preview::Preview;
use treesynth::surface::Part;

/// The formats of `--format`.
pub(crate) const FORMATS: [&str; 9] =
    ["glb", "nodes.glb", "obj", "ply", "stl", "svg", "png", "json", "relaxed.json"];

/// Writes the tree into a folder in one of the [`FORMATS`]; its finest level alone where there can be no others.
pub(crate) fn write(
    format: &str,
    outputs: &mut Outputs,
    options: &Options,
    preset: &Preset,
    skeleton: &Skeleton,
    levels: &[Vec<Part<'_>>],
    coverages: &[f32],
) -> Result<(), Failure> {
    let parts = &levels[0];
    let file = |extension: &str| format!("{}.{extension}", preset.name);
    let axes = Axes::default().with_up(options.up).with_unit(options.unit);
    let path = outputs.path(&file(format));
    outputs.write(&path, |writer| {
        let glb = GlbOptions::default()
            .with_name(preset.name)
            .with_coverages(coverages)
            .with_quantization(options.quantize)
            .with_levels(if options.named { LevelNodes::Named } else { LevelNodes::Extension });
        match format {
            "glb" => export::write_glb_levels(levels, &glb, writer)?,
            "nodes.glb" => {
                export::write_glb_levels(levels, &glb.with_instancing(Instancing::Nodes), writer)?;
            }
            "obj" => export::write_obj(parts, &file("mtl"), writer)?,
            "ply" => export::write_ply_with(parts, PlyFormat::Binary, axes, writer)?,
            "stl" => export::write_stl_with(parts, axes, writer)?,
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
        let path = outputs.path(&file("mtl"));
        outputs.write(&path, |writer| Ok(export::write_mtl(parts, writer)?))?;
        outputs.write_images(&export::mtl_images(parts))?;
    }
    Ok(())
}
