//! Grows a stand season by season and writes it as a model file, a picture and an animation of its seasons.
//!
//!     cargo run --release --example forest -- --preset stand-generations --out out

mod options;

use indicatif::{ProgressBar, ProgressStyle};
use options::Options;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::ops::ControlFlow;
use std::path::Path;
use treesynth::export::gltf::{GlbOptions, write_glb_parts};
use treesynth::foliage::Leaves;
use treesynth::presets::{self, Season, Stand};
use treesynth::preview::{Camera, Picture, Preview};
use treesynth::surface::{Mesh, Part, Tubes};
use treesynth::{Bounds, Forest, Progress, Work};

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
    let stand = presets::stand_by_name(&options.preset)
        .ok_or_else(|| format!("--preset is {:?}, but must be one of --list", options.preset))?;
    fs::create_dir_all(&options.out).map_err(|error| format!("--out {}: {error}", options.out.display()))?;
    let seasons = options.seasons.unwrap_or(stand.seasons);
    let planted = stand.plant(options.seed.unwrap_or(stand.seed))?.with_most_metamers(options.metamers);
    let mut forest = planted.clone();

    // Twice: what the last season looks like says what the pictures of the others have to hold, and only one season at
    // a time is kept as triangles.
    let bar = ProgressBar::new(u64::from(seasons) * 8);
    bar.set_style(ProgressStyle::with_template("{msg:>24} [{bar:40}] {percent:>3}% {elapsed_precise}")?);
    let mut last = Vec::new();
    let mut frames: Vec<Picture> = Vec::new();
    let mut preview = Preview::default().with_size(options.size, options.size).with_ground_height(0.0);
    for season in 0..2 * seasons {
        let watch = |progress: Progress| {
            if let Work::Season { .. } = progress.work {
                bar.set_position(u64::from(season) * 4 + (progress.fraction * 4.0) as u64);
            }
            ControlFlow::Continue(())
        };
        forest.grow_observed(1, &watch)?;
        bar.set_message(format!("{} trees, {} metamers", forest.trees().len(), forest.metamers()));
        if season + 1 == seasons {
            last = look(stand, &forest, 8)?;
            let bounds = last.iter().filter_map(|look| look.mesh.bounds()).reduce(Bounds::union);
            preview =
                preview.with_camera(Camera::default().with_frame(bounds.ok_or("nothing has sprouted yet")?));
            forest = planted.clone();
        } else if season >= seasons {
            // Half of the detail will do for the small pictures of the animation.
            let looks = look(stand, &forest, 4)?;
            let parts: Vec<Part<'_>> = looks.iter().flat_map(Look::parts).collect();
            if !parts.is_empty() {
                frames.push(preview.draw_parts(&parts)?);
            }
        }
    }
    bar.finish_and_clear();
    let parts: Vec<Part<'_>> = last.iter().flat_map(Look::parts).collect();

    let file = |extension: &str| options.out.join(format!("{}.{extension}", stand.name));
    let name = GlbOptions::default().with_name(stand.name);
    write(&file("glb"), |writer| Ok(write_glb_parts(&parts, &name, writer)?))?;
    write(&file("png"), |writer| Ok(Preview::default().draw_parts(&parts)?.write_png(writer)?))?;
    write(&file("apng"), |writer| Ok(Picture::write_animation(&frames, 250, writer)?))?;
    println!(
        "{}: {} seasons, {} trees, {} metamers -> {}",
        stand.name,
        forest.season(),
        forest.trees().len(),
        forest.metamers(),
        file("{glb,png,apng}").display(),
    );
    Ok(())
}

/// A tree to be drawn and written.
struct Look {
    mesh: Mesh,
    leaves: Option<Leaves>,
}

impl Look {
    fn parts(&self) -> impl Iterator<Item = Part<'_>> {
        [Part::new(&self.mesh)].into_iter().chain(self.leaves.as_ref().map(Leaves::part))
    }
}

/// The trees that are more than seeds, in summer.
fn look(stand: &Stand, forest: &Forest, sides: u32) -> Result<Vec<Look>, Failure> {
    let tubes = Tubes::default().with_sides(sides);
    let skeletons = forest.skeletons()?;
    let sprouted = forest.trees().iter().zip(&skeletons).filter(|(_, skeleton)| skeleton.len() > 1);
    sprouted
        .map(|(tree, skeleton)| {
            let leaves = stand.leaves(tree, skeleton, Season::Summer)?;
            Ok(Look { mesh: tubes.mesh(skeleton)?, leaves })
        })
        .collect()
}

/// Writes to a file; a failure names it.
fn write(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<File>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let mut writer = BufWriter::new(File::create(path).map_err(|error| named(&error))?);
    content(&mut writer).map_err(|error| named(&error))?;
    Ok(writer.flush().map_err(|error| named(&error))?)
}
