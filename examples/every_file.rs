//! Writes one small tree with images in every form that the exporters know, for `scripts/check_exports`.
//!
//!     cargo run --release --example every_file -- OUT

#[path = "common/mod.rs"]
mod common;

use common::{Failure, Outputs, print};
use std::path::Path;
use treesynth::export::{self, Axes, GlbOptions, Instancing, LevelNodes, UsdStage};
use treesynth::glam::{Quat, Vec3};
use treesynth::presets::{self, Season};
use treesynth::shape::UpAxis;
use treesynth::surface::{Levels, Material, Part, Scene, Transform};
use treesynth::texture::{Image, Textures};

/// Stripes of two colours, the second one cut out if it has alpha.
fn stripes(light: &[u8], dark: &[u8]) -> Result<Image, Failure> {
    let channels = light.len();
    let pixels = (0..64 * 64_usize)
        .flat_map(|i| if (i / 8).is_multiple_of(2) { light.to_vec() } else { dark.to_vec() });
    Ok(Image::new(64, 64, channels as u8, pixels.collect())?)
}

fn main() {
    common::run(|| {
        let folder = std::env::args().nth(1).ok_or("name a folder")?;
        let preset = presets::by_name("figure-17e")?.guided()?;
        let skeleton = preset.synth(2_000).synthesize(preset.seed)?.relaxed(0.5, 3)?;
        let barks = Levels::default().with_count(3).of(&skeleton)?;
        let mut leaves =
            preset.foliage(Season::Summer).ok_or("it has no leaves")?.place(&skeleton, preset.seed)?;
        for (i, copy) in leaves.instances.iter_mut().enumerate() {
            copy.tint = [1.0 - (i % 5) as f32 / 10.0, 1.0, 0.9];
        }
        let wood = Textures::default()
            .with_base_color(stripes(&[150, 120, 90], &[80, 60, 50])?)
            .with_normal(stripes(&[128, 128, 255], &[140, 128, 254])?)
            .with_occlusion_roughness_metallic(stripes(&[255, 230, 0], &[200, 200, 0])?);
        let blade = Textures::default()
            .with_base_color(stripes(&[200, 255, 180, 255], &[200, 255, 180, 0])?)
            .with_transmission(stripes(&[60, 120, 20], &[60, 100, 20])?)
            .with_alpha_cutoff(0.5);
        let worn = |index: usize, leaves_kept: usize| {
            let bark = Part::new(&barks[index.min(barks.len() - 1)].mesh);
            let copies = &leaves.instances[..leaves.instances.len() / leaves_kept];
            [
                bark.with_material(Material::white()).with_textures(&wood),
                leaves.part().with_instances(copies).with_textures(&blade),
            ]
        };
        let levels = [worn(0, 1), worn(1, 2), worn(2, 8)];
        let plain = [Part::new(&barks[0].mesh).with_material(preset.bark()), leaves.part()];
        let half = Quat::from_xyzw(0.0, 0.6, 0.0, 0.8);
        let scene = (0..6).fold(Scene::default(), |scene, i| {
            let position = Vec3::new(6.0 * i as f32, 0.0, 0.0);
            let tree = if i % 3 == 0 { &plain[..] } else { &levels[0][..] };
            scene.with_asset("elm", tree, Transform { position, rotation: half, scale: 1.0 + 0.1 * i as f32 })
        });

        let mut outputs = Outputs::new("OUT", Path::new(&folder))?;
        let forms = [
            ("merged", Instancing::Merged),
            ("extension", Instancing::Extension),
            ("nodes", Instancing::Nodes),
        ];
        for (name, instancing) in forms {
            for (numbers, quantization) in [("", false), ("-quantized", true)] {
                let options =
                    GlbOptions::default().with_instancing(instancing).with_quantization(quantization);
                let path = outputs.path(&format!("{name}{numbers}.glb"));
                outputs.write(&path, |out| Ok(export::write_glb_parts(&levels[0], &options, out)?))?;
                let path = outputs.path(&format!("scene-{name}{numbers}.glb"));
                outputs.write(&path, |out| Ok(export::write_glb_scene(&scene, &options, out)?))?;
            }
        }
        for (name, form) in [("lod", LevelNodes::Extension), ("named-lod", LevelNodes::Named)] {
            let options = GlbOptions::default().with_levels(form).with_coverages([0.5, 0.2, 0.0]);
            let path = outputs.path(&format!("{name}.glb"));
            outputs.write(&path, |out| Ok(export::write_glb_levels(&levels, &options, out)?))?;
        }

        let path = outputs.path("tree.obj");
        outputs.write(&path, |out| Ok(export::write_obj(&levels[0], "tree.mtl", out)?))?;
        let path = outputs.path("tree.mtl");
        outputs.write(&path, |out| Ok(export::write_mtl(&levels[0], out)?))?;
        outputs.write_images(&export::mtl_images(&levels[0]))?;

        let seasons = [("summer", &levels[0][..]), ("winter", &levels[0][..1])];
        let centimetres = Axes::default().with_up(UpAxis::Z).with_unit(0.01).with_origin(Vec3::X);
        for (name, stage) in [
            ("parts", UsdStage::of_parts(&levels[0])),
            ("axes", UsdStage::of_parts(&levels[0]).with_axes(centimetres)),
            ("plain", UsdStage::of_parts(&plain)),
            ("levels", UsdStage::of_levels(&levels)),
            ("seasons", UsdStage::of_variants("season", &seasons)),
            ("scene", UsdStage::of_scene(&scene)),
        ] {
            outputs.write_images(&export::usd_images(&stage))?;
            for extension in ["usda", "usdz"] {
                let path = outputs.path(&format!("{name}.{extension}"));
                outputs.write(&path, |out| match extension {
                    "usda" => Ok(export::write_usda(&stage, out)?),
                    _ => Ok(export::write_usdz(&stage, out)?),
                })?;
            }
        }
        outputs.finish()?;

        let (bark, leaf) = (barks[0].mesh.triangles().len(), leaves.leaf.mesh().triangles().len());
        print([format!(
            "{bark} triangles of bark, {} leaves of {leaf} triangles -> {folder}",
            leaves.instances.len()
        )]);
        Ok(())
    });
}
