//! Grows a stand season by season and writes it as a model file, a picture and an animation of its seasons.
//!
//!     cargo run --release --example forest -- --preset stand-generations --out out

#[path = "../common/mod.rs"]
mod common;
mod options;

use common::{Failure, Outputs, print};
use indicatif::{ProgressBar, ProgressStyle};
use options::Options;
use std::ops::ControlFlow;
use treesynth::export::gltf::{GlbOptions, write_glb_parts};
use treesynth::foliage::Leaves;
use treesynth::presets::{self, Found, Season, Stand};
use treesynth::preview::{Camera, Picture, Preview};
use treesynth::surface::{Mesh, Part, Tubes};
use treesynth::{Bounds, Forest, Progress, Work};

fn main() {
    common::run(|| match Options::from_arguments()? {
        None => Ok(()),
        Some(options) => run(&options),
    });
}

fn run(options: &Options) -> Result<(), Failure> {
    let stand = presets::by_name(&options.preset)
        .and_then(Found::stand)
        .map_err(|error| format!("--preset: {error}; see --list"))?;
    let mut outputs = Outputs::new("--out", &options.out)?;
    let seasons = options.seasons.unwrap_or(stand.seasons);
    let seed = options.seed.unwrap_or(stand.seed);
    let file = |extension: &str| options.out.join(format!("{}.{extension}", stand.name));

    // Grown twice, for the pictures of the seasons are framed as the last one is: to keep all seasons' trees would take
    // gigabytes.
    let bar = ProgressBar::new(u64::from(seasons) * 8);
    bar.set_style(ProgressStyle::with_template("{msg:>24} [{bar:40}] {percent:>3}% {elapsed_precise}")?);
    let grow = |forest: &mut Forest, from: u64| -> Result<(), Failure> {
        let watch = |progress: Progress| {
            if let Work::Season { .. } = progress.work {
                bar.set_position(from + (progress.fraction * 4.0) as u64);
            }
            ControlFlow::Continue(())
        };
        forest.grow_observed(1, &watch)?;
        bar.set_message(format!("{} trees, {} metamers", forest.trees().len(), forest.metamers()));
        Ok(())
    };
    let planted = stand.plant(seed)?.with_most_metamers(options.metamers);
    let mut forest = planted.clone();
    for season in 0..u64::from(seasons) {
        grow(&mut forest, season * 4)?;
    }
    let last = look(stand, &forest, 8)?;
    let bounds = last.iter().filter_map(|look| look.mesh.bounds()).reduce(Bounds::union);
    let bounds = bounds.ok_or_else(|| format!("nothing has sprouted after --seasons {seasons}"))?;
    {
        let parts: Vec<Part<'_>> = last.iter().flat_map(Look::parts).collect();
        let name = GlbOptions::default().with_name(stand.name);
        outputs.write(&file("glb"), |writer| Ok(write_glb_parts(&parts, &name, writer)?))?;
        let picture = Preview::default().draw_parts(&parts)?;
        outputs.write(&file("png"), |writer| Ok(picture.write_png(writer)?))?;
    }
    drop(last);

    let camera = Camera::default().with_frame(bounds);
    let preview = Preview::default().with_camera(camera).with_size(options.size, options.size);
    let preview = preview.with_ground_height(0.0);
    let (mut again, mut frames) = (planted, Vec::new());
    for season in 0..u64::from(seasons) {
        grow(&mut again, (u64::from(seasons) + season) * 4)?;
        // Half of the detail will do for the small pictures of the animation.
        let looks = look(stand, &again, 4)?;
        if !looks.is_empty() {
            frames.push(preview.draw_parts(&looks.iter().flat_map(Look::parts).collect::<Vec<_>>())?);
        }
    }
    bar.finish_and_clear();
    outputs.write(&file("apng"), |writer| Ok(Picture::write_animation(&frames, 250, writer)?))?;
    outputs.finish()?;
    print([format!(
        "{}: {} seasons, {} trees, {} metamers -> {}",
        stand.name,
        forest.season(),
        forest.trees().len(),
        forest.metamers(),
        file("{glb,png,apng}").display(),
    )]);
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
