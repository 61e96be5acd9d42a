//! Draws every preset, a sheet for each figure, and a sheet of all trees in summer, into `docs/figures/`.
//!
//!     cargo run --release --example gallery -- --help

mod blobs;
#[path = "../common/mod.rs"]
mod common;
mod growth;
mod marks;
mod plane;
mod shapes;
mod stands;

use base64::Engine;
use common::{Failure, Outputs, number, print};
use lexopt::prelude::{Long, Short, ValueExt};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use treesynth::Silent;
use treesynth::foliage::Leaves;
use treesynth::guided::{Graph, Search, TreeSynth};
use treesynth::presets::{self, Preset, Season, TYPICAL_NODES};
use treesynth::preview::{Picture, Preview};
use treesynth::surface::{Material, Part, Tubes};

const HELP: &str = "\
Draws every preset, a sheet for each figure, and a sheet of all trees in summer.

cargo run --release --example gallery -- [OPTIONS]

  --only TEXT   presets whose names contain it             [all]
  --nodes N     nodes of the graphs, 100 to 200000000      [150000]
  --size N      side of a picture, 16 to 4096 pixels       [400]
  --out DIR     where pictures go; made if it is not there [docs/figures]
  --help        this text";

struct Options {
    nodes: usize,
    out: PathBuf,
    size: u32,
    only: String,
}

fn main() {
    common::run(run);
}

fn run() -> Result<(), Failure> {
    let mut options =
        Options { nodes: TYPICAL_NODES, out: "docs/figures".into(), size: 400, only: String::new() };
    let mut arguments = lexopt::Parser::from_env();
    while let Some(argument) = arguments.next()? {
        match argument {
            Long("nodes") => options.nodes = number(&mut arguments, "--nodes", 100..=200_000_000, "nodes")?,
            Long("out") => options.out = arguments.value()?.into(),
            Long("size") => options.size = number(&mut arguments, "--size", 16..=4096, "pixels")?,
            Long("only") => options.only = arguments.value()?.string()?,
            Long("help") | Short('h') => {
                print([HELP]);
                return Ok(());
            }
            other => return Err(other.unexpected().into()),
        }
    }
    drop(Outputs::new("--out", &options.out)?);
    if options.only.is_empty() {
        overview(&options)?;
    }
    let mut sheets: BTreeMap<u8, Vec<Picture>> = BTreeMap::new();
    let mut summers = Vec::new();
    for preset in presets::guided().filter(|preset| preset.name.contains(&options.only)) {
        let pictures = draw(preset, &options)?;
        if let Some(last) = pictures.last() {
            write(&options.out.join(format!("{}.png", preset.name)), last)?;
        }
        println!("{}: {}", preset.name, preset.caption);
        sheets.entry(preset.figure).or_default().extend(pictures);
        if preset.foliage(Season::Summer).is_some() {
            summers.push(summer(preset, &options)?);
        }
    }
    if !summers.is_empty() {
        let sheet = Picture::sheet(&summers, 9, 2, [255, 255, 255])?;
        write(&options.out.join("sheet-summer.png"), &sheet)?;
    }
    for (figure, pictures) in &sheets {
        let columns = if pictures.len() > 5 { pictures.len().div_ceil(2) } else { pictures.len() };
        let sheet = Picture::sheet(pictures, columns as u32, 6, [255, 255, 255])?;
        write(&options.out.join(format!("sheet-{figure:02}.png")), &sheet)?;
    }
    let (mut pictures, mut summers) = (Vec::new(), Vec::new());
    for stand in presets::stands().filter(|stand| stand.name.contains(&options.only)) {
        let picture = stands::draw(stand, Season::Winter, options.size)?;
        write(&options.out.join(format!("{}.png", stand.name)), &picture)?;
        println!("{}: {}", stand.name, stand.caption);
        pictures.push(picture);
        summers.push(stands::draw(stand, Season::Summer, options.size)?);
    }
    for stand in presets::spaces().filter(|stand| stand.name.contains(&options.only)) {
        let picture = stands::draw(stand, Season::Winter, options.size)?;
        write(&options.out.join(format!("{}.png", stand.name)), &picture)?;
        println!("{}: {}", stand.name, stand.caption);
        pictures.push(picture);
        summers.push(stands::draw(stand, Season::Summer, options.size)?);
    }
    pictures.append(&mut summers);
    if !pictures.is_empty() {
        let sheet = Picture::sheet(&pictures, 5, 6, [255, 255, 255])?;
        write(&options.out.join("sheet-stands.png"), &sheet)?;
    }
    growth::draw_all(&options)?;
    shapes::draw_all(&options)?;
    blobs::draw_all(&options)
}

/// Small pictures of a few presets on one sheet, which the documentation of the crate carries within itself.
fn overview(options: &Options) -> Result<(), Failure> {
    let small = Options { size: 140, out: options.out.clone(), only: String::new(), ..*options };
    let names = ["figure-06a", "figure-07", "figure-13", "figure-16-05", "figure-17d", "figure-17g"];
    let mut pictures = Vec::new();
    for name in names {
        let preset = presets::by_name(name)?.guided()?;
        let synth = preset.synth(options.nodes);
        let graph = synth.build_graph(preset.seed, &Silent)?;
        pictures.push(draw_stages(preset, &synth, &graph, synth.stages().len(), Season::Winter, &small)?);
    }
    let mut png = Vec::new();
    Picture::sheet(&pictures, 6, 2, [255, 255, 255])?.write_png(&mut png)?;
    let text = base64::prelude::BASE64_STANDARD.encode(&png);
    let mut outputs = Outputs::new("--out", &options.out)?;
    outputs.write(&options.out.join("overview.base64"), |writer| Ok(writer.write_all(text.as_bytes())?))?;
    outputs.write(&options.out.join("overview.png"), |writer| Ok(writer.write_all(&png)?))?;
    outputs.finish()
}

/// The tree in leaf, at two fifths of the size, with a label.
fn summer(preset: &Preset, options: &Options) -> Result<Picture, Failure> {
    let size = (options.size * 2 / 5).max(1);
    let small = Options { size, out: options.out.clone(), only: String::new(), ..*options };
    let synth = preset.synth(options.nodes);
    let graph = synth.build_graph(preset.seed, &Silent)?;
    let stages = synth.stages().len();
    let mut picture = draw_stages(preset, &synth, &graph, stages, Season::Summer, &small)?;
    picture.label(preset.name.trim_start_matches("figure-"), 3, 3, 1, [60, 60, 60]);
    Ok(picture)
}

fn write(path: &Path, picture: &Picture) -> Result<(), Failure> {
    let mut outputs = Outputs::new("--out", path.parent().unwrap_or(path))?;
    outputs.write(path, |writer| Ok(picture.write_png(writer)?))?;
    outputs.finish()
}

/// The unfinished tree, if the figure shows it, and the finished one; of a tree that refines the one at a single
/// resolution first, in a graph of all the nodes.
fn draw(preset: &Preset, options: &Options) -> Result<Vec<Picture>, Failure> {
    let synth = preset.synth(options.nodes);
    let mut pictures = Vec::new();
    if synth.refines() {
        // The first graph of a tree that refines has a quarter of the nodes.
        let synth = preset.synth(4 * options.nodes).without_refinements();
        let graph = synth.build_graph(preset.seed, &Silent)?;
        let mut picture = draw_stages(preset, &synth, &graph, synth.stages().len(), Season::Winter, options)?;
        picture.label(&format!("{}, one resolution", preset.name), 6, 6, 1, [60, 60, 60]);
        pictures.push(picture);
    }
    let graph = synth.build_graph(preset.seed, &Silent)?;
    let stages = synth.stages().len();
    if preset.figure == 11 {
        pictures.extend(marks::surface(preset, &synth, &graph, options)?);
        return Ok(pictures);
    }
    // Figure 4 shows every iteration.
    let partial: Vec<usize> =
        if preset.figure == 4 { (1..stages).collect() } else { preset.partial_stages.into_iter().collect() };
    for count in partial.into_iter().chain([stages]) {
        let label =
            if count < stages { format!("{}, {count} of {stages}", preset.name) } else { preset.name.into() };
        let mut picture = draw_stages(preset, &synth, &graph, count, Season::Winter, options)?;
        picture.label(&label, 6, 6, 1, [60, 60, 60]);
        pictures.push(picture);
    }
    Ok(pictures)
}

fn draw_stages(
    preset: &Preset,
    synth: &TreeSynth,
    graph: &Graph,
    stages: usize,
    season: Season,
    options: &Options,
) -> Result<Picture, Failure> {
    let mut search = Search::new(graph);
    let growth = synth.clone().first_stages(stages).grow(&mut search, preset.seed, &Silent)?;
    if preset.planar {
        return plane::draw(&search, &growth.skeleton, options.size);
    }
    let tree = growth.skeleton.relaxed(0.5, 3)?;
    let mesh = Tubes::default().mesh(&tree)?;
    let leaves = preset.foliage(season).map(|foliage| foliage.place(&tree, preset.seed)).transpose()?;
    let bark = Part::new(&mesh).with_material(preset.bark());
    let mut parts: Vec<_> = [bark].into_iter().chain(leaves.as_ref().map(Leaves::part)).collect();
    let wires = preset.volume().map(|volume| marks::wires(volume, 0.03)).transpose()?;
    let blue = Material::bark().with_srgb([70, 110, 190]);
    parts.extend(wires.as_ref().map(|wires| Part::new(wires).with_material(blue)));
    // A plain background keeps the files small.
    let paper = [0.97, 0.965, 0.955];
    let preview = Preview::default().with_size(options.size, options.size).with_background(paper, paper);
    Ok(preview.draw_parts(&parts)?)
}
