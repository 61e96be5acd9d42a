//! Fills a shape with a tree: a model (`.glb`), a picture (`.png`) and the energy of each step (`.energy.png`).
//!
//!     cargo run --release --example shape_tree -- [--preset NAME] [--nodes N] [--seed N] [--out DIR] [--size PIXELS]
//!
//! `--list` names the presets.

use indicatif::{ProgressBar, ProgressStyle};
use lexopt::prelude::{Long, ValueExt};
use std::fs::{self, File};
use std::io::BufWriter;
use std::ops::ControlFlow;
use std::path::PathBuf;
use treesynth::Progress;
use treesynth::export::gltf::{GlbOptions, write_glb};
use treesynth::glam::Vec2;
use treesynth::preview::{Picture, Preview, PreviewError};
use treesynth::surface::Tubes;
use treesynth::variational::{self, Step, StepKind};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut name = "variational-14-oak".to_owned();
    let (mut nodes, mut seed, mut size) = (None, None, 800);
    let mut out = PathBuf::from("out");
    let mut arguments = lexopt::Parser::from_env();
    while let Some(argument) = arguments.next()? {
        match argument {
            Long("preset") => name = arguments.value()?.string()?,
            Long("nodes") => nodes = Some(arguments.value()?.parse()?),
            Long("seed") => seed = Some(arguments.value()?.parse()?),
            Long("out") => out = arguments.value()?.into(),
            Long("size") => size = arguments.value()?.parse()?,
            Long("list") => {
                variational::presets().for_each(|preset| println!("{}: {}", preset.name, preset.caption));
                return Ok(());
            }
            other => return Err(other.unexpected().into()),
        }
    }
    let preset = variational::by_name(&name).ok_or_else(|| format!("no preset {name}; --list names them"))?;
    let synth = preset.synth(nodes.unwrap_or(preset.shape_nodes))?;
    let bar =
        ProgressBar::new(1000).with_style(ProgressStyle::with_template("{bar:40} {percent}% {elapsed}")?);
    let watch = |progress: Progress| {
        bar.set_position((progress.fraction * 1000.0) as u64);
        ControlFlow::Continue(())
    };
    let growth = synth.grow(seed.unwrap_or(preset.seed), &watch)?;
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
