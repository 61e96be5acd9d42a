//! Fills a shape with a tree: a model (`.glb`), a picture (`.png`) and the energy of each step (`.energy.png`).
//!
//!     cargo run --release --example shape_tree -- --help

#[path = "common/mod.rs"]
mod common;

use common::{Failure, Outputs, number, print, text};
use indicatif::{ProgressBar, ProgressStyle};
use lexopt::prelude::{Long, Short, Value};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use treesynth::export::gltf::{GlbOptions, write_glb};
use treesynth::glam::Vec2;
use treesynth::presets::{self, Found};
use treesynth::preview::{Picture, Preview, PreviewError};
use treesynth::shape::{Import, Outline, Sketch, UpAxis};
use treesynth::surface::Tubes;
use treesynth::variational::{self, GuidanceShape, Level, Step, StepKind, VariationalSynth};
use treesynth::{ParameterError, Progress, Shape};

const HELP: &str = "\
Fills a shape with a tree: a model (NAME.glb), a picture (NAME.png) and the energy of each step (NAME.energy.png).

cargo run --release --example shape_tree -- [MESH | --sketch FILE.svg | --preset NAME] [OPTIONS]

  MESH           an .obj, .stl, .ply, .glb or .gltf file; scripts/fetch_bunny fetches one
  --up AXIS      y or z: what is up in the mesh              [y]
  --sketch FILE  an SVG file: the first shape that it draws is the crown's silhouette from the front, a second that from
                 the side
  --preset NAME  one of --list                               [variational-14-oak]
  --list         the presets, one a line, and nothing else
  --height M     how tall the mesh or sketch is, 0.01 to 10000 metres  [8]
  --nodes N      shape nodes, 4 to 10000000                  [the preset's, or 4000]
  --seed N       the seed, 0 to 18446744073709551615         [the preset's, or 1]
  --size N       side of the picture, 16 to 8192 pixels      [800]
  --out DIR      where files go; made if it is not there     [out]
  --help         this text";

fn main() {
    common::run(run);
}

/// What is filled.
enum Source {
    Mesh(PathBuf),
    Sketch(PathBuf),
    Preset(String),
}

fn run() -> Result<(), Failure> {
    let mut sources = Vec::new();
    let (mut nodes, mut seed, mut size, mut height) = (None, None, 800, 8.0);
    let mut up = UpAxis::Y;
    let mut out = PathBuf::from("out");
    let mut arguments = lexopt::Parser::from_env();
    while let Some(argument) = arguments.next()? {
        match argument {
            Value(path) => sources.push(Source::Mesh(path.into())),
            Long("sketch") => sources.push(Source::Sketch(text(&mut arguments, "--sketch")?.into())),
            Long("preset") => sources.push(Source::Preset(text(&mut arguments, "--preset")?)),
            Long("up") => {
                up = match text(&mut arguments, "--up")?.as_str() {
                    "y" | "Y" => UpAxis::Y,
                    "z" | "Z" => UpAxis::Z,
                    other => return Err(format!("--up is {other:?}, but must be y or z").into()),
                }
            }
            Long("height") => height = number(&mut arguments, "--height", 0.01..=10_000.0, "metres")?,
            Long("nodes") => nodes = Some(number(&mut arguments, "--nodes", 4..=10_000_000, "shape nodes")?),
            Long("seed") => seed = Some(number(&mut arguments, "--seed", 0..=u64::MAX, "")?),
            Long("out") => out = arguments.value()?.into(),
            Long("size") => size = number(&mut arguments, "--size", 16..=8192, "pixels")?,
            Long("list") => {
                print(variational::presets().map(|preset| format!("{}: {}", preset.name, preset.caption)));
                return Ok(());
            }
            Long("help") | Short('h') => {
                print([HELP]);
                return Ok(());
            }
            other => return Err(other.unexpected().into()),
        }
    }
    if sources.len() > 1 {
        return Err(format!(
            "there are {} of MESH, --sketch and --preset, but one tree fills one shape",
            sources.len()
        )
        .into());
    }
    let mut outputs = Outputs::new("--out", &out)?;
    let source = sources.pop().unwrap_or_else(|| Source::Preset("variational-14-oak".into()));
    let (name, synth, seed) = match source {
        Source::Preset(name) => {
            let preset = presets::by_name(&name)
                .and_then(Found::variational)
                .map_err(|error| format!("--preset: {error}; see --list"))?;
            (
                preset.name.to_owned(),
                preset.synth(nodes.unwrap_or(preset.shape_nodes))?,
                seed.unwrap_or(preset.seed),
            )
        }
        Source::Mesh(path) => {
            let shape = read_mesh(&path, up, height)?;
            (stem(&path), filled(&*shape, nodes.unwrap_or(4000))?, seed.unwrap_or(1))
        }
        Source::Sketch(path) => {
            let shape = read_sketch(&path, height)?;
            (stem(&path), filled(&*shape, nodes.unwrap_or(4000))?, seed.unwrap_or(1))
        }
    };
    let bar =
        ProgressBar::new(1000).with_style(ProgressStyle::with_template("{bar:40} {percent}% {elapsed}")?);
    let watch = |progress: Progress| {
        bar.set_position((progress.fraction * 1000.0) as u64);
        ControlFlow::Continue(())
    };
    let growth = synth.grow(seed, &watch)?;
    bar.finish();
    let best = growth.trace[growth.best];
    let mesh = Tubes::default().mesh(&growth.skeleton)?;
    let file = |ending: &str| out.join(format!("{name}.{ending}"));
    outputs.write(&file("glb"), |writer| Ok(write_glb(&mesh, &GlbOptions::default(), writer)?))?;
    let picture = Preview::default().with_size(size, size).draw(&mesh)?;
    outputs.write(&file("png"), |writer| Ok(picture.write_png(writer)?))?;
    let energy = plot(&growth.trace, size)?;
    outputs.write(&file("energy.png"), |writer| Ok(energy.write_png(writer)?))?;
    outputs.finish()?;
    print([
        format!("{} shape nodes, {} internodes", synth.shape().len(), growth.skeleton.segments()),
        format!("F = {:.4} after {} steps, the least of {}", best.total, growth.best + 1, growth.trace.len()),
    ]);
    Ok(())
}

fn stem(path: &Path) -> String {
    path.file_stem().and_then(|stem| stem.to_str()).unwrap_or("shape").to_owned()
}

/// On a trunk a sixth as high as the shape.
fn read_mesh(path: &Path, up: UpAxis, height: f32) -> Result<Box<dyn Shape>, Failure> {
    let mesh = Import::default().with_up(up).open(path)?;
    print([format!("{} triangles: {}", mesh.triangles().len(), mesh.flaws())]);
    Ok(Box::new(mesh.fitted(height / 6.0, height)?))
}

fn read_sketch(path: &Path, height: f32) -> Result<Box<dyn Shape>, Failure> {
    let text =
        std::fs::read_to_string(path).map_err(|error| format!("--sketch {}: {error}", path.display()))?;
    let named = |error: ParameterError| format!("--sketch {}: {error}", path.display());
    let mut outlines = Outline::from_svg(&text).map_err(named)?.into_iter();
    let fitted = |outline: Outline| outline.fitted(height / 6.0, height);
    let front = outlines.next().map(fitted).ok_or("the sketch draws nothing")?;
    let mut sketch = Sketch::new(front);
    if let Some(side) = outlines.next() {
        sketch = sketch.with_side(fitted(side));
    }
    sketch.check().map_err(named)?;
    Ok(Box::new(sketch))
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
    picture.label(&format!("{least:.0}"), 4, size as i32 / 2 - 26, 1, [60, 60, 60]);
    Ok(picture)
}
