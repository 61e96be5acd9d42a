//! Fills a shape with a tree: a model (`.glb`), a picture (`.png`) and the energy of each step (`.energy.png`).
//!
//!     cargo run --release --example shape_tree -- --help

use indicatif::{ProgressBar, ProgressStyle};
use lexopt::prelude::{Long, Short, Value, ValueExt};
use std::fs::{self, File};
use std::io::{BufReader, BufWriter};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use treesynth::export::gltf::{GlbOptions, write_glb};
use treesynth::glam::Vec2;
use treesynth::preview::{Picture, Preview, PreviewError};
use treesynth::shape::{Outline, Sketch, TriangleMesh};
use treesynth::surface::Tubes;
use treesynth::variational::{self, GuidanceShape, Level, Step, StepKind, VariationalSynth};
use treesynth::{Progress, Shape};

type Failure = Box<dyn std::error::Error>;

const HELP: &str = "\
Fills a shape with a tree: a model (NAME.glb), a picture (NAME.png) and the energy of each step (NAME.energy.png).

cargo run --release --example shape_tree -- [MESH | --sketch FILE.svg | --preset NAME] [OPTIONS]

  MESH           an OBJ, STL or PLY file; scripts/fetch_bunny fetches one
  --sketch FILE  an SVG file: its first <path> is the crown's silhouette from the front, a second that from the side;
                 transforms are not looked at
  --preset NAME  one of --list                               [variational-14-oak]
  --list         the presets, one a line, and nothing else
  --height M     how tall the mesh or sketch is, metres      [8]
  --nodes N      shape nodes                                 [the preset's, or 4000]
  --seed N       the seed                                    [the preset's, or 1]
  --size N       side of the picture, pixels                 [800]
  --out DIR      where files go; made if it is not there     [out]
  --help         this text";

fn main() {
    if let Err(error) = run() {
        eprintln!("error: {error}");
        std::process::exit(1);
    }
}

fn run() -> Result<(), Failure> {
    let mut name = "variational-14-oak".to_owned();
    let (mut mesh, mut sketch) = (None, None);
    let (mut nodes, mut seed, mut size, mut height) = (None, None, 800, 8.0);
    let mut out = PathBuf::from("out");
    let mut arguments = lexopt::Parser::from_env();
    while let Some(argument) = arguments.next()? {
        match argument {
            Value(path) => mesh = Some(PathBuf::from(path)),
            Long("sketch") => sketch = Some(PathBuf::from(arguments.value()?)),
            Long("height") => height = arguments.value()?.parse()?,
            Long("preset") => name = arguments.value()?.string()?,
            Long("nodes") => nodes = Some(arguments.value()?.parse()?),
            Long("seed") => seed = Some(arguments.value()?.parse()?),
            Long("out") => out = arguments.value()?.into(),
            Long("size") => size = arguments.value()?.parse()?,
            Long("list") => {
                variational::presets().for_each(|preset| println!("{}: {}", preset.name, preset.caption));
                return Ok(());
            }
            Long("help") | Short('h') => {
                println!("{HELP}");
                return Ok(());
            }
            other => return Err(other.unexpected().into()),
        }
    }
    let (synth, seed) = if let Some(path) = mesh.as_ref().or(sketch.as_ref()) {
        path.file_stem().and_then(|stem| stem.to_str()).unwrap_or("shape").clone_into(&mut name);
        let shape = if mesh.is_some() { read_mesh(path, height)? } else { read_sketch(path, height)? };
        (filled(&*shape, nodes.unwrap_or(4000))?, seed.unwrap_or(1))
    } else {
        let preset =
            variational::by_name(&name).ok_or_else(|| format!("no preset {name}; --list names them"))?;
        (preset.synth(nodes.unwrap_or(preset.shape_nodes))?, seed.unwrap_or(preset.seed))
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
    println!("{} shape nodes, {} internodes", synth.shape().len(), growth.skeleton.segments());
    println!("F = {:.4} after {} steps, the least of {}", best.total, growth.best + 1, growth.trace.len());
    fs::create_dir_all(&out)?;
    let create = |ending: &str| File::create(out.join(format!("{name}.{ending}"))).map(BufWriter::new);
    let mesh = Tubes::default().mesh(&growth.skeleton)?;
    write_glb(&mesh, &GlbOptions::default(), create("glb")?)?;
    Preview::default().with_size(size, size).draw(&mesh)?.write_png(create("png")?)?;
    Ok(plot(&growth.trace, size)?.write_png(create("energy.png")?)?)
}

/// On a trunk a sixth as high as the shape.
fn read_mesh(path: &Path, height: f32) -> Result<Box<dyn Shape>, Failure> {
    let file = BufReader::new(File::open(path)?);
    let mesh = match path.extension().and_then(|ending| ending.to_str()) {
        Some("obj") => TriangleMesh::read_obj(file)?,
        Some("stl") => TriangleMesh::read_stl(file)?,
        Some("ply") => TriangleMesh::read_ply(file)?,
        _ => return Err("a mesh is an .obj, .stl or .ply file".into()),
    };
    println!("{} triangles: {}", mesh.triangles().len(), mesh.flaws());
    Ok(Box::new(mesh.fitted(height / 6.0, height)?))
}

fn read_sketch(path: &Path, height: f32) -> Result<Box<dyn Shape>, Failure> {
    let text = fs::read_to_string(path)?;
    let document = roxmltree::Document::parse(&text)?;
    let paths = document.descendants().filter(|node| node.has_tag_name((SVG, "path")));
    let mut outlines = paths.filter_map(|node| node.attribute("d")).map(Outline::from_svg_path);
    let front = outlines.next().ok_or("there is no <path> in the file")??;
    let mut sketch = Sketch::new(front.fitted(height / 6.0, height));
    if let Some(side) = outlines.next() {
        sketch = sketch.with_side(side?.fitted(height / 6.0, height));
    }
    Ok(Box::new(sketch))
}

const SVG: &str = "http://www.w3.org/2000/svg";

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
