//! Grows a tree and writes it as a model file, a picture and data.
//!
//!     cargo run --release --example tree -- --preset figure-06c --seed 7 --out out

mod options;
mod stats;
mod watch;

use options::Options;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::time::Instant;
use treesynth::export::{gltf, json};
use treesynth::guided::Search;
use treesynth::preview::Preview;
use treesynth::surface::Tubes;
use treesynth::{Metrics, presets};

type Failure = Box<dyn std::error::Error>;

fn main() {
    let done = Options::from_arguments().and_then(|options| match options {
        None => Ok(()),
        Some(options) => run(&options),
    });
    if let Err(error) = done {
        eprintln!("error: {error}");
        std::process::exit(1);
    }
}

fn run(options: &Options) -> Result<(), Failure> {
    if let Some(threads) = options.threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    }
    let preset = presets::by_name(&options.preset)
        .ok_or_else(|| format!("--preset is {:?}, but must be one of --list", options.preset))?;
    let seed = options.seed.unwrap_or(preset.seed);
    fs::create_dir_all(&options.out).map_err(|error| format!("--out {}: {error}", options.out.display()))?;

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
    let mut mesh = None;
    step("mesh", &mut || {
        mesh = Some(Tubes::default().mesh(&skeleton.relaxed(0.5, 3)?)?);
        Ok(())
    })?;
    let mesh = mesh.ok_or("no mesh")?;
    let file = |extension: &str| options.out.join(format!("{}.{extension}", preset.name));
    step("glb", &mut || {
        let look = gltf::GlbOptions::default().with_name(preset.name);
        write(&file("glb"), |writer| Ok(gltf::write_glb(&mesh, &look, writer)?))
    })?;
    step("png", &mut || {
        let picture = Preview::default().draw(&mesh)?;
        write(&file("png"), |writer| Ok(picture.write_png(writer)?))
    })?;
    step("json", &mut || write(&file("json"), |writer| Ok(json::write_skeleton(skeleton, writer)?)))?;

    let metrics = Metrics::of(skeleton);
    let endpoints: Vec<usize> = growth.endpoints.iter().map(Vec::len).collect();
    if let Some(path) = &options.stats {
        let stats = stats::stats(preset.name, seed, &graph, skeleton, &endpoints, &steps, &metrics)?;
        write(path, |writer| Ok(serde_json::to_writer_pretty(writer, &stats)?))?;
    }
    let milliseconds: f64 = steps.iter().map(|(_, time)| time.as_secs_f64() * 1e3).sum();
    println!(
        "{}, seed {seed}: {} nodes, {} endpoints, {} segments, {} tips, {:.1} m tall, {:.1} m wide, {milliseconds:.0} ms -> {}",
        preset.name,
        graph.nodes(),
        endpoints.iter().sum::<usize>(),
        skeleton.segments(),
        metrics.tips,
        metrics.height,
        metrics.crown_width,
        file("{glb,png,json}").display(),
    );
    Ok(())
}

/// Writes to a file; a failure names it.
fn write(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<File>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let mut writer = BufWriter::new(File::create(path).map_err(|error: io::Error| named(&error))?);
    content(&mut writer).map_err(|error| named(&error))?;
    Ok(writer.flush().map_err(|error| named(&error))?)
}
