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
use treesynth::export::gltf::{GlbOptions, write_glb};
use treesynth::preview::{Camera, Picture, Preview};
use treesynth::surface::{Mesh, Tubes};
use treesynth::{Forest, Progress, Work, presets};

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
    let mut forest = stand.plant(options.seed.unwrap_or(stand.seed))?;

    let bar = ProgressBar::new(u64::from(seasons) * 4);
    bar.set_style(ProgressStyle::with_template("{msg:>24} [{bar:40}] {percent:>3}% {elapsed_precise}")?);
    let mut meshes = Vec::new();
    for season in 0..seasons {
        let watch = |progress: Progress| {
            if let Work::Season { .. } = progress.work {
                bar.set_position(u64::from(season) * 4 + (progress.fraction * 4.0) as u64);
            }
            ControlFlow::Continue(())
        };
        forest.grow_observed(1, &watch)?;
        bar.set_message(format!("{} trees, {} metamers", forest.trees().len(), forest.metamers()));
        // Half of the detail will do for the small pictures of the animation.
        meshes.extend(surface(&forest, if season + 1 == seasons { 8 } else { 4 })?);
    }
    bar.finish_and_clear();
    let last = meshes.last().ok_or("nothing has grown: --seasons must be at least 1")?;

    let file = |extension: &str| options.out.join(format!("{}.{extension}", stand.name));
    let look = GlbOptions::default().with_name(stand.name);
    write(&file("glb"), |writer| Ok(write_glb(last, &look, writer)?))?;
    write(&file("png"), |writer| Ok(Preview::default().draw(last)?.write_png(writer)?))?;
    let camera = Camera::default().framing(last.bounds().ok_or("the mesh is empty")?);
    let preview = Preview::default().with_camera(camera).with_size(options.size, options.size);
    let frames = meshes.iter().map(|mesh| preview.clone().with_ground_height(0.0).draw(mesh));
    let frames: Vec<Picture> = frames.collect::<Result<_, _>>()?;
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

/// All trees in one mesh; `None` while there are only seeds.
fn surface(forest: &Forest, sides: u32) -> Result<Option<Mesh>, Failure> {
    let tubes = Tubes::default().with_sides(sides);
    let mut all = Mesh::default();
    for tree in forest.skeletons()?.iter().filter(|tree| tree.len() > 1) {
        let mesh = tubes.mesh(tree)?;
        let first = all.positions.len() as u32;
        all.positions.extend(mesh.positions);
        all.normals.extend(mesh.normals);
        all.uvs.extend(mesh.uvs);
        all.indices.extend(mesh.indices.iter().map(|index| index + first));
    }
    Ok((!all.is_empty()).then_some(all))
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
