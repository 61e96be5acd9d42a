//! `shape`: a tree that fills a mesh or a drawing.

use crate::arguments::Common;
use crate::clothe::{Clothes, Model, triangles};
use crate::failure::refused;
use crate::number::{number, text};
use crate::progress::Bar;
use crate::wish::stem;
use crate::write::{Out, Tree, Up};
use crate::{Failure, report};
use clap::Args;
use serde_json::json;
use std::path::{Path, PathBuf};
use treesynth::glam::Vec2;
use treesynth::presets::{self, Found};
use treesynth::preview::{Picture, PreviewError};
use treesynth::shape::{Import, MeshFormat, Outline, Sketch};
use treesynth::surface::Material;
use treesynth::variational::{GuidanceShape, Level, Step, StepKind, VariationalSynth};
use treesynth::{Metrics, ParameterError, Shape};

/// Grow a tree that fills a mesh, an SVG drawing or a preset's shape
#[derive(Args)]
#[command(after_help = "\
Examples:
  treesynth shape bunny.obj --height 3 --nodes 8000
  treesynth shape heart.svg --out trees
  treesynth shape statue.stl --up-in z --seed 5 --format glb,png,swc
  treesynth shape variational-14-oak --energy")]
pub(crate) struct Options {
    /// An .obj, .stl, .ply, .glb or .gltf file; an .svg file, of which the first shape is the crown's silhouette from the
    /// front and a second that from the side; or a name of `treesynth list shapes`
    #[arg(value_name = "FILE|NAME", value_parser = text)]
    shape: String,
    /// Height of the mesh or the drawing, 0.01 to 10000 m; a trunk of a sixth of it is below [default: 8]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = number(0.01..=10_000.0_f32, "metres"))]
    height: Option<f32>,
    /// Axis that points up in the mesh file [default: y]
    #[arg(long, value_enum, value_name = "AXIS")]
    up_in: Option<Up>,
    /// Shape nodes, 4 to 10000000: more make finer branches [default: 4000, or the preset's]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number(4..=10_000_000_usize, "shape nodes"))]
    nodes: Option<usize>,
    /// Seed, 0 to 18446744073709551615 [default: 1, or the preset's]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number(0..=u64::MAX, ""))]
    seed: Option<u64>,
    /// Write NAME.energy.png too, the energy of each step
    #[arg(long)]
    energy: bool,
    #[command(flatten, next_help_heading = "Model")]
    clothes: Clothes,
    #[command(flatten, next_help_heading = "Files")]
    out: Out,
}

/// The shape to fill.
enum Source {
    Mesh(PathBuf),
    Drawing(PathBuf),
    Preset(&'static treesynth::variational::Preset),
}

pub(crate) fn run(options: &Options, common: &Common) -> Result<(), Failure> {
    options.clothes.check()?;
    let source = options.source()?;
    let mut outputs = options.out.outputs()?;
    let bar = Bar::new(common.quiet);
    bar.step("reading the shape");
    let (name, synth, seed, note) = options.synth(source)?;
    bar.parts("filling the shape", 1000);
    let growth = synth.grow(seed, &bar)?;
    let best = growth.trace[growth.best];
    bar.step("bark and levels");
    let bark = Material::bark();
    let model = if options.out.has_triangles() {
        options.clothes.dressed(&growth.skeleton, &[], bark, Some(treesynth::texture::Bark::oak()))?
    } else {
        Model::none()
    };
    let metrics = Metrics::of(&growth.skeleton);
    let (levels, coverages) = (model.levels(), model.coverages(metrics.height as f32));
    bar.step("writing files");
    let name = options.out.name.clone().unwrap_or(name);
    let tree = Tree { levels: &levels, coverages: &coverages, skeleton: &growth.skeleton, bark };
    let mut files = options.out.tree(&mut outputs, &name, &tree)?;
    if options.energy {
        let picture = plot(&growth.trace, options.out.size)?;
        let path = outputs.path(&format!("{name}.energy.png"));
        outputs.write(&path, |writer| Ok(picture.write_png(writer)?))?;
        files.push(path);
    }
    outputs.finish()?;
    let milliseconds = bar.finish();
    let value = json!({
        "name": name,
        "seed": seed,
        "note": note,
        "nodes": synth.shape().len(),
        "internodes": growth.skeleton.segments(),
        "energy": best.total,
        "steps": growth.trace.len(),
        "triangles": triangles(&levels),
        "metrics": serde_json::to_value(&metrics)?,
        "files": files,
        "milliseconds": milliseconds,
    });
    report::tell(common, &value, || {
        let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
        let note = note.as_ref().map_or_else(String::new, |note| format!("{note}\n"));
        format!(
            "{note}{name}, seed {seed}: {} shape nodes, {} internodes, energy {:.4} after {} steps, {milliseconds:.0} ms\n{}",
            synth.shape().len(),
            growth.skeleton.segments(),
            best.total,
            growth.best + 1,
            files.join("\n"),
        )
    })
}

impl Options {
    fn source(&self) -> Result<Source, Failure> {
        let path = Path::new(&self.shape);
        let is_svg = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("svg"));
        let source = if is_svg {
            Source::Drawing(path.into())
        } else if MeshFormat::of(path).is_some() {
            Source::Mesh(path.into())
        } else if path.extension().is_some() && path.exists() {
            return Err(refused(format!(
                "{}: the name of a shape's file must end in .obj, .stl, .ply, .glb, .gltf or .svg",
                self.shape
            )));
        } else {
            Source::Preset(presets::by_name(&self.shape).and_then(Found::variational).map_err(refused)?)
        };
        if self.up_in.is_some() && !matches!(source, Source::Mesh(_)) {
            return Err(refused("--up-in goes with a mesh file"));
        }
        if self.height.is_some() && matches!(source, Source::Preset(_)) {
            return Err(refused("--height goes with a mesh or a drawing, not with a preset"));
        }
        Ok(source)
    }

    /// The files' name, the synthesis, its seed, and what is to be said of the file that was read.
    fn synth(&self, source: Source) -> Result<(String, VariationalSynth, u64, Option<String>), Failure> {
        let (height, nodes, seed) =
            (self.height.unwrap_or(8.0), self.nodes.unwrap_or(4000), self.seed.unwrap_or(1));
        Ok(match source {
            Source::Preset(preset) => {
                let synth = preset.synth(self.nodes.unwrap_or(preset.shape_nodes))?;
                (preset.name.to_owned(), synth, self.seed.unwrap_or(preset.seed), None)
            }
            Source::Mesh(path) => {
                let up = self.up_in.unwrap_or(Up::Y);
                let mesh = Import::default().with_up(up.into()).open(&path)?;
                let note = format!("{} triangles: {}", mesh.triangles().len(), mesh.flaws());
                // On a trunk of a sixth of the height.
                let shape = mesh.fitted(height / 6.0, height)?;
                (named(&path), filled(&shape, nodes)?, seed, Some(note))
            }
            Source::Drawing(path) => (named(&path), filled(&sketch(&path, height)?, nodes)?, seed, None),
        })
    }
}

fn named(path: &Path) -> String {
    stem(path.file_stem().and_then(|stem| stem.to_str()).unwrap_or("shape"))
}

fn sketch(path: &Path, height: f32) -> Result<Sketch, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let told = |error: ParameterError| format!("{}: {error}", path.display());
    let mut outlines = Outline::from_svg(&text).map_err(told)?.into_iter();
    let fitted = |outline: Outline| outline.fitted(height / 6.0, height);
    let front = outlines.next().map(fitted);
    let front = front.ok_or_else(|| format!("{}: it draws nothing", path.display()))?;
    let mut sketch = Sketch::new(front);
    if let Some(side) = outlines.next() {
        sketch = sketch.with_side(fitted(side));
    }
    sketch.check().map_err(told)?;
    Ok(sketch)
}

/// Half of the shape nodes on the surface, half in the volume.
fn filled(shape: &dyn Shape, nodes: usize) -> Result<VariationalSynth, Failure> {
    let surface = GuidanceShape::on_surface(shape, nodes / 2, 1)?;
    let shape = surface.joined(&GuidanceShape::in_volume(shape, nodes - nodes / 2, 1)?);
    let axis = Level::default().with_apical_control(0.9);
    Ok(VariationalSynth::new(shape).with_levels([axis.with_metamers(7), axis, axis, axis]))
}

/// F over the steps, as in figure 10: red where a level begins, brown where branches were pruned.
fn plot(trace: &[Step], size: u32) -> Result<Picture, PreviewError> {
    let mut picture = Picture::new(size, size / 2, [255, 255, 255])?;
    let (least, most) = trace
        .iter()
        .fold((f64::MAX, 0.0_f64), |(least, most), step| (least.min(step.total), most.max(step.total)));
    let (width, height) = (size as f32 - 80.0, (size / 2) as f32 - 40.0);
    let at = |number: usize| {
        let up = ((trace[number].total - least) / (most - least).max(f64::MIN_POSITIVE)) as f32;
        Vec2::new(60.0 + width * number as f32 / trace.len().max(2) as f32, 20.0 + height * (1.0 - up))
    };
    for number in 1..trace.len() {
        picture.line(at(number - 1), at(number), 1.5, [60, 60, 60]);
    }
    for (number, step) in trace.iter().enumerate() {
        match step.kind {
            StepKind::Initialization { .. } => picture.disc(at(number), 4.0, [200, 40, 40]),
            StepKind::Refinement { .. } => picture.disc(at(number), 4.0, [140, 90, 40]),
            _ => picture.disc(at(number), 2.5, [60, 60, 60]),
        }
    }
    picture.label(&format!("{most:.0}"), 4, 16, 1, [60, 60, 60]);
    picture.label(&format!("{least:.0}"), 4, (size / 2).cast_signed() - 26, 1, [60, 60, 60]);
    Ok(picture)
}
