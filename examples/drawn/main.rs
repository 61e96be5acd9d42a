//! Turns strokes into a tree, or an example into more of its kind; writes models and pictures.
//!
//!     cargo run --release --example drawn -- --help

mod strokes;

use lexopt::prelude::{Long, Short, ValueExt};
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use treesynth::export::gltf::{GlbOptions, write_glb_parts};
use treesynth::foliage::{Arrangement, Foliage, Leaf};
use treesynth::glam::{Vec2, Vec3};
use treesynth::guided::{
    Apart, Bend, DrawnLimbs, Example, ForkAngle, Guided, LimbSurface, PoissonYao, Refinement, Stage, Stroke,
    TreeSynth,
};
use treesynth::preview::{Picture, Preview};
use treesynth::radius::{PipeModel, Stout, Taper};
use treesynth::shape::Cuboid;
use treesynth::surface::{Part, Tubes};
use treesynth::{Bounds, Metrics, Skeleton, presets};

type Failure = Box<dyn std::error::Error>;

const HELP: &str = "\
Turns strokes into a tree: a model (drawn.glb) and a picture of the strokes and the tree (drawn.png). Or grows four more
of the kind of a preset: their models (kind-1.glb ...) and a picture of the five (kind.png).

cargo run --release --example drawn -- [--strokes FILE.svg | --like PRESET] [OPTIONS]

  --strokes FILE  an SVG file: each part of its <path>s is a stroke from base to tip, the first is the trunk;
                  stroke-width is thickness; transforms are not looked at                [a pine]
  --height M      how tall the drawing is, metres                                        [5]
  --depth DEG     how far limbs leave the plane, degrees                                 [45]
  --like PRESET   grows trees like this one
  --nodes N       nodes of the graph                                                     [60000]
  --seed N        the seed                                                               [1]
  --size N        height of a picture, pixels                                            [800]
  --out DIR       where files go; made if it is not there                                [out]
  --help          this text";

struct Options {
    strokes: Option<PathBuf>,
    like: Option<String>,
    height: f32,
    depth: f32,
    nodes: usize,
    seed: u64,
    size: u32,
    out: PathBuf,
}

fn main() {
    if let Err(error) = run() {
        eprintln!("error: {error}");
        std::process::exit(1);
    }
}

fn run() -> Result<(), Failure> {
    let mut options = Options {
        strokes: None,
        like: None,
        height: 5.0,
        depth: 45.0,
        nodes: 60_000,
        seed: 1,
        size: 800,
        out: PathBuf::from("out"),
    };
    let mut arguments = lexopt::Parser::from_env();
    while let Some(argument) = arguments.next()? {
        match argument {
            Long("strokes") => options.strokes = Some(arguments.value()?.into()),
            Long("like") => options.like = Some(arguments.value()?.string()?),
            Long("height") => options.height = arguments.value()?.parse()?,
            Long("depth") => options.depth = arguments.value()?.parse()?,
            Long("nodes") => options.nodes = arguments.value()?.parse()?,
            Long("seed") => options.seed = arguments.value()?.parse()?,
            Long("size") => options.size = arguments.value()?.parse()?,
            Long("out") => options.out = arguments.value()?.into(),
            Long("help") | Short('h') => {
                println!("{HELP}");
                return Ok(());
            }
            other => return Err(other.unexpected().into()),
        }
    }
    fs::create_dir_all(&options.out)?;
    match &options.like {
        Some(name) => like(name, &options),
        None => draw(&options),
    }
}

fn draw(options: &Options) -> Result<(), Failure> {
    let strokes = match &options.strokes {
        Some(path) => strokes::read(path, options.height)?,
        None => strokes::built_in()?,
    };
    let drawn = DrawnLimbs::from_strokes(strokes.clone()).with_depth(options.depth.to_radians());
    let limbs = drawn.skeleton()?;
    println!("{} strokes, {} nodes", strokes.len(), limbs.len());
    let tree = clothed(limbs, options)?;
    println!("{} internodes, {} tips", tree.segments(), tree.tips().count());
    let foliage = Foliage::new(Leaf::needles())
        .with_arrangement(Arrangement::SPIRAL)
        .with_spacing(0.05)
        .with_size(0.14)
        .with_reach(0.35);
    let leaves = foliage.place(&tree, options.seed)?;
    let mesh = Tubes::default().mesh(&tree)?;
    let parts = [Part::new(&mesh), leaves.part()];
    write_glb_parts(&parts, &GlbOptions::default().with_name("drawn"), create(&options.out, "drawn.glb")?)?;
    let size = options.size;
    let preview = Preview::default().with_size(size * 5 / 4, size);
    let pictures =
        [sketched(&strokes, size * 5 / 4, size)?, preview.draw(&mesh)?, preview.draw_parts(&parts)?];
    let sheet = Picture::sheet(&pictures, 3, 4, [255; 3])?;
    Ok(sheet.write_png(create(&options.out, "drawn.png")?)?)
}

/// Twigs on the limbs, then finer ones.
fn clothed(limbs: Skeleton, options: &Options) -> Result<Skeleton, Failure> {
    let bounds = limbs.positions().iter().fold(None, |bounds: Option<Bounds>, &point| {
        Some(bounds.map_or(Bounds::new(point, point), |bounds| {
            Bounds::new(bounds.min.min(point), bounds.max.max(point))
        }))
    });
    let bounds = bounds.ok_or("no strokes")?;
    let tall = bounds.size().max_element();
    let margin = Vec3::splat(0.15 * tall);
    let region = Cuboid::new((bounds.min - margin).with_y(bounds.min.y), bounds.max + margin);
    let graph = PoissonYao::new(region).with_nodes(options.nodes).with_tree(limbs);
    let spacing = graph.spacing()?;
    let twigs = |metres: f32, apart: f32| {
        let rule = ForkAngle::new(0.9, Bend::none()).with_spread(0.25);
        let surface = LimbSurface::new(4, apart).with_hop_length(metres / 4.0).with_bare_base(0.35);
        Stage::new(rule, surface.with_least_order(1)).with_weight(Apart::new(Guided, 0.4))
    };
    let finer = Refinement::new(region, spacing * 0.5).with_reach(8).with_relaxation(0);
    let pipes = PipeModel::default().with_trunk_diameter(0.06 * tall);
    Ok(TreeSynth::new(graph)
        .stage(twigs(0.11 * tall, 0.06 * tall))
        .stage(twigs(0.05 * tall, 0.035 * tall).with_refinement(finer))
        .with_radius(Stout::new(Taper::new(pipes), 0.01))
        .synthesize(options.seed)?)
}

/// The strokes alone.
fn sketched(strokes: &[Stroke], width: u32, height: u32) -> Result<Picture, Failure> {
    let lines = strokes::lines(strokes);
    let all = || lines.iter().flatten();
    let low = all().fold(Vec2::INFINITY, |low, &point| low.min(point));
    let high = all().fold(Vec2::NEG_INFINITY, |high, &point| high.max(point));
    let size = Vec2::new(width as f32, height as f32);
    let scale = (size * 0.85 / (high - low).max(Vec2::splat(1e-6))).min_element();
    let middle = (low + high) * 0.5;
    let mut picture = Picture::new(width, height, [255; 3])?;
    let pixel = |point: Vec2| size * 0.5 + (point - middle) * Vec2::new(scale, -scale);
    for line in &lines {
        for pair in line.windows(2) {
            picture.line(pixel(pair[0]), pixel(pair[1]), 4.0, [40, 40, 40]);
        }
    }
    Ok(picture)
}

fn like(name: &str, options: &Options) -> Result<(), Failure> {
    let preset = presets::by_name(name)?.guided()?;
    let tree = preset.synth(options.nodes).synthesize(options.seed)?;
    let example = Example::of(&tree)?.tuned(options.nodes, 8)?;
    let mut pictures = vec![portrait("example", &tree, options)?];
    for number in 1..=4 {
        let grown = example.grow(options.nodes, options.seed + number)?;
        let file = create(&options.out, &format!("kind-{number}.glb"))?;
        let mesh = Tubes::default().mesh(&grown)?;
        write_glb_parts(&[Part::new(&mesh)], &GlbOptions::default().with_name("kind"), file)?;
        pictures.push(portrait(&format!("kind {number}"), &grown, options)?);
    }
    let sheet = Picture::sheet(&pictures, 5, 4, [255; 3])?;
    Ok(sheet.write_png(create(&options.out, "kind.png")?)?)
}

fn portrait(label: &str, tree: &Skeleton, options: &Options) -> Result<Picture, Failure> {
    let metrics = Metrics::of(tree);
    println!(
        "{label}: {:.1} m tall, {:.1} m wide, {} tips, {:.0} m of branches",
        metrics.height, metrics.crown_width, metrics.tips, metrics.total_length
    );
    let preview = Preview::default().with_size(options.size * 4 / 5, options.size);
    let mut picture = preview.draw(&Tubes::default().mesh(tree)?)?;
    picture.label(label, 10, 10, 2, [70; 3]);
    Ok(picture)
}

fn create(folder: &Path, name: &str) -> Result<BufWriter<File>, Failure> {
    let path = folder.join(name);
    Ok(File::create(&path).map(BufWriter::new).map_err(|error| format!("{}: {error}", path.display()))?)
}
