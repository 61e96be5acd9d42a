//! Grows a tree, with leaves or without, and writes it as model files, a picture and data.
//!
//!     cargo run --release --example tree -- --preset fine-oak --seed 7 --out out

#[path = "../common/mod.rs"]
mod common;
mod files;
mod levels;
mod options;
mod stats;
mod watch;

use common::{Failure, Outputs, print};
use levels::Model;
use options::Options;
use std::time::Instant;
use treesynth::Metrics;
use treesynth::guided::Search;
use treesynth::presets::{self, Found};

fn main() {
    common::run(|| match Options::from_arguments()? {
        None => Ok(()),
        Some(options) => run(&options),
    });
}

fn run(options: &Options) -> Result<(), Failure> {
    if let Some(threads) = options.threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    }
    let preset = presets::by_name(&options.preset)
        .and_then(Found::guided)
        .map_err(|error| format!("--preset: {error}; see --list"))?;
    let seed = options.seed.unwrap_or(preset.seed);
    let mut outputs = Outputs::new("--out", &options.out)?;
    if let Some(path) = &options.stats {
        Outputs::check("--stats", path)?;
    }

    let watch = watch::Watch::new();
    let synth = preset.synth(options.nodes);
    let graph = synth.build_graph(seed, &watch)?;
    let growth = synth.grow(&mut Search::new(&graph), seed, &watch)?;
    let mut steps = watch.finish();
    let mut step = |name: &str, work: &mut dyn FnMut() -> Result<(), Failure>| -> Result<(), Failure> {
        let start = Instant::now();
        work()?;
        steps.push((name.into(), start.elapsed()));
        Ok(())
    };

    let skeleton = &growth.skeleton;
    let relaxed = skeleton.relaxed(0.5, 3)?;
    let mut model = None;
    step("model", &mut || {
        model = Some(Model::new(options, preset, &relaxed, seed)?);
        Ok(())
    })?;
    let Some(model) = model else { return Ok(()) };
    let levels = model.levels(preset);
    let metrics = Metrics::of(skeleton);
    let coverages = model.coverages(metrics.height as f32);
    for format in &options.formats {
        let skeleton = if format == "relaxed.json" { &relaxed } else { skeleton };
        step(format, &mut || {
            files::write(format, &mut outputs, options, preset, skeleton, &levels, &coverages)
        })?;
    }

    let endpoints: Vec<usize> = growth.endpoints.iter().map(Vec::len).collect();
    if let Some(path) = &options.stats {
        let stats = stats::stats(preset.name, seed, &graph, skeleton, &endpoints, &steps, &metrics, &levels)?;
        outputs.write(path, |writer| Ok(serde_json::to_writer_pretty(writer, &stats)?))?;
    }
    outputs.finish()?;
    let milliseconds: f64 = steps.iter().map(|(_, time)| time.as_secs_f64() * 1e3).sum();
    print([format!(
        "{}, seed {seed}: {} nodes, {} endpoints, {} segments, {} tips, {} triangles, {:.1} m tall, {:.1} m wide, {milliseconds:.0} ms -> {}",
        preset.name,
        graph.nodes(),
        endpoints.iter().sum::<usize>(),
        skeleton.segments(),
        metrics.tips,
        levels.iter().map(|level| levels::triangles(level).to_string()).collect::<Vec<_>>().join(" / "),
        metrics.height,
        metrics.crown_width,
        options.out.join(format!("{}.{{{}}}", preset.name, options.formats.join(","))).display(),
    )]);
    Ok(())
}
