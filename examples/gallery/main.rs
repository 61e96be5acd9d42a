//! Draws every preset, and a sheet for each figure, into `docs/figures/`.
//!
//!     cargo run --release --example gallery -- [--nodes N] [--out DIR] [--size PIXELS] [--only TEXT]

mod plane;

use base64::Engine;
use lexopt::prelude::{Long, ValueExt};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use treesynth::Silent;
use treesynth::guided::{Graph, Search, TreeSynth};
use treesynth::presets::{self, Preset, TYPICAL_NODES};
use treesynth::preview::{Picture, Preview};
use treesynth::surface::Tubes;
use treesynth::{Skeleton, variational};

type Failure = Box<dyn std::error::Error>;

struct Options {
    nodes: usize,
    out: PathBuf,
    size: u32,
    only: String,
}

fn main() -> Result<(), Failure> {
    let mut options =
        Options { nodes: TYPICAL_NODES, out: "docs/figures".into(), size: 400, only: String::new() };
    let mut arguments = lexopt::Parser::from_env();
    while let Some(argument) = arguments.next()? {
        match argument {
            Long("nodes") => options.nodes = arguments.value()?.parse()?,
            Long("out") => options.out = arguments.value()?.into(),
            Long("size") => options.size = arguments.value()?.parse()?,
            Long("only") => options.only = arguments.value()?.string()?,
            other => return Err(other.unexpected().into()),
        }
    }
    fs::create_dir_all(&options.out)?;
    if options.only.is_empty() {
        overview(&options)?;
    }
    let mut sheets: BTreeMap<u8, Vec<Picture>> = BTreeMap::new();
    for preset in presets::all().filter(|preset| preset.name.contains(&options.only)) {
        let pictures = draw(preset, &options)?;
        if let Some(last) = pictures.last() {
            write(&options.out.join(format!("{}.png", preset.name)), last)?;
        }
        println!("{}: {}", preset.name, preset.caption);
        sheets.entry(preset.figure).or_default().extend(pictures);
    }
    for (figure, pictures) in &sheets {
        let columns = if pictures.len() > 5 { pictures.len().div_ceil(2) } else { pictures.len() };
        let sheet = Picture::sheet(pictures, columns as u32, 6, [255, 255, 255])?;
        write(&options.out.join(format!("sheet-{figure:02}.png")), &sheet)?;
    }
    shapes(&options)
}

/// The trees that fill shapes, a sheet for each figure of theirs.
fn shapes(options: &Options) -> Result<(), Failure> {
    let mut sheets: BTreeMap<u8, Vec<Picture>> = BTreeMap::new();
    for preset in variational::presets().filter(|preset| preset.name.contains(&options.only)) {
        let nodes = preset.shape_nodes.min(options.nodes / 10);
        let mut picture = shaded(&preset.synth(nodes)?.synthesize(preset.seed)?, options.size)?;
        picture.label(preset.name, 6, 6, 1, [60, 60, 60]);
        println!("{}: {}", preset.name, preset.caption);
        sheets.entry(preset.figure).or_default().push(picture);
    }
    for (figure, pictures) in &sheets {
        let sheet = Picture::sheet(pictures, 3, 6, [255, 255, 255])?;
        write(&options.out.join(format!("sheet-variational-{figure:02}.png")), &sheet)?;
    }
    Ok(())
}

/// Small pictures of a few presets on one sheet, which the documentation of the crate carries within itself.
fn overview(options: &Options) -> Result<(), Failure> {
    let small = Options { size: 140, out: options.out.clone(), only: String::new(), ..*options };
    let names = ["figure-06a", "figure-07", "figure-13", "figure-16-05", "figure-17d", "figure-17g"];
    let mut pictures = Vec::new();
    for preset in names.into_iter().filter_map(presets::by_name) {
        let synth = preset.synth(options.nodes);
        let graph = synth.build_graph(preset.seed, &Silent)?;
        pictures.push(draw_stages(preset, &synth, &graph, synth.stages().len(), &small)?);
    }
    let mut png = Vec::new();
    Picture::sheet(&pictures, 6, 2, [255, 255, 255])?.write_png(&mut png)?;
    fs::write(options.out.join("overview.base64"), base64::prelude::BASE64_STANDARD.encode(&png))?;
    Ok(fs::write(options.out.join("overview.png"), png)?)
}

fn write(path: &Path, picture: &Picture) -> Result<(), Failure> {
    let mut writer = BufWriter::new(File::create(path)?);
    picture.write_png(&mut writer)?;
    Ok(writer.flush()?)
}

/// The unfinished tree, if the figure shows it, and the finished one.
fn draw(preset: &Preset, options: &Options) -> Result<Vec<Picture>, Failure> {
    let synth = preset.synth(options.nodes);
    let graph = synth.build_graph(preset.seed, &Silent)?;
    let stages = synth.stages().len();
    let shown = preset.partial_stages.into_iter().chain([stages]);
    shown
        .map(|count| {
            let label = if count < stages {
                format!("{}, {count} of {stages}", preset.name)
            } else {
                preset.name.into()
            };
            let mut picture = draw_stages(preset, &synth, &graph, count, options)?;
            picture.label(&label, 6, 6, 1, [60, 60, 60]);
            Ok(picture)
        })
        .collect()
}

fn draw_stages(
    preset: &Preset,
    synth: &TreeSynth,
    graph: &Graph,
    stages: usize,
    options: &Options,
) -> Result<Picture, Failure> {
    let mut search = Search::new(graph);
    let growth = synth.clone().first_stages(stages).grow(&mut search, preset.seed, &Silent)?;
    if preset.planar {
        return plane::draw(&search, &growth.skeleton, options.size);
    }
    shaded(&growth.skeleton.relaxed(0.5, 3)?, options.size)
}

fn shaded(skeleton: &Skeleton, size: u32) -> Result<Picture, Failure> {
    let mesh = Tubes::default().mesh(skeleton)?;
    // A plain background keeps the files small.
    let paper = [0.97, 0.965, 0.955];
    Ok(Preview::default().with_size(size, size).with_background(paper, paper).draw(&mesh)?)
}
