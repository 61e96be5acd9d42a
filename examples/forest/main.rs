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
use treesynth::self_organizing::Environment;
use treesynth::surface::{Material, Mesh, Part, Tubes};
use treesynth::{Bounds, Forest, Progress, Skeleton, Work};

fn main() {
    common::run(|| match Options::from_arguments()? {
        None => Ok(()),
        Some(options) => run(&options),
    });
}

fn run(options: &Options) -> Result<(), Failure> {
    match presets::by_name(&options.preset).map_err(|error| format!("--preset: {error}; see --list"))? {
        Found::Space(stand) => grow(stand, options),
        found => grow(found.stand().map_err(|error| format!("--preset: {error}; see --list"))?, options),
    }
}

fn grow<E: Environment + Clone>(stand: &Stand<E>, options: &Options) -> Result<(), Failure> {
    let mut outputs = Outputs::new("--out", &options.out)?;
    let seasons = options.seasons.unwrap_or(stand.seasons);
    let seed = options.seed.unwrap_or(stand.seed);
    let file = |extension: &str| options.out.join(format!("{}.{extension}", stand.name));
    let glb = GlbOptions::default().with_name(stand.name);

    // Grown twice, for the pictures of the seasons are framed as the last one is: to keep all seasons' trees would take
    // gigabytes.
    let bar = ProgressBar::new(u64::from(seasons) * 8);
    bar.set_style(ProgressStyle::with_template("{msg:>24} [{bar:40}] {percent:>3}% {elapsed_precise}")?);
    let pass = |forest: &mut Forest<E>, from: u64| -> Result<(), Failure> {
        let watch = |progress: Progress| {
            if let Work::Season { .. } = progress.work {
                bar.set_position(from + (progress.fraction * 4.0) as u64);
            }
            ControlFlow::Continue(())
        };
        forest.grow_observed(1, &watch)?;
        stand.tend(forest)?;
        bar.set_message(format!("{} trees, {} metamers", forest.trees().len(), forest.metamers()));
        Ok(())
    };
    let planted = stand.plant(seed)?.with_most_metamers(options.metamers);
    let mut forest = planted.clone();
    for season in 0..u64::from(seasons) {
        pass(&mut forest, season * 4)?;
    }
    let last = look(stand, &forest, &forest.skeletons()?, 8)?;
    let bounds = last.iter().filter_map(|look| look.mesh.bounds()).reduce(Bounds::union);
    let bounds = bounds.ok_or_else(|| format!("nothing has sprouted after --seasons {seasons}"))?;
    let ground = stand.ground(bounds);
    // From higher up than a slope is steep.
    let front = if ground.is_some() { Camera::default().with_elevation(0.6) } else { Camera::default() };
    {
        let parts: Vec<Part<'_>> = last.iter().flat_map(Look::parts).chain(under(ground.as_ref())).collect();
        outputs.write(&file("glb"), |writer| Ok(write_glb_parts(&parts, &glb, writer)?))?;
        let picture = Preview::default().with_size(800, 800).with_camera(front.clone()).draw_parts(&parts)?;
        outputs.write(&file("png"), |writer| Ok(picture.write_png(writer)?))?;
        let aside = Preview::default().with_size(800, 800).with_camera(front.clone().with_azimuth(2.2));
        outputs.write(&file("side.png"), |writer| Ok(aside.draw_parts(&parts)?.write_png(writer)?))?;
    }
    drop(last);

    let camera = front.with_frame(bounds);
    let preview = Preview::default().with_camera(camera).with_size(options.size, options.size);
    let preview = if ground.is_some() { preview } else { preview.with_ground_height(0.0) };
    let (mut again, mut frames) = (planted, Vec::new());
    for season in 0..seasons {
        let before = again.clone();
        pass(&mut again, u64::from(seasons + season) * 4)?;
        // Half of the detail will do for the small pictures of the animation.
        for frame in 1..=options.frames {
            let skeletons = again.skeletons_since(&before, frame as f32 / options.frames as f32)?;
            let looks = match options.frames {
                1 => look(stand, &again, &skeletons, 4)?,
                _ => bare(&skeletons, 4)?,
            };
            let parts: Vec<Part<'_>> = looks.iter().flat_map(Look::parts).collect();
            if !parts.is_empty() {
                frames.push(
                    preview
                        .draw_parts(&parts.into_iter().chain(under(ground.as_ref())).collect::<Vec<_>>())?,
                );
            }
        }
        if options.models {
            let looks = look(stand, &again, &again.skeletons()?, 8)?;
            let parts: Vec<Part<'_>> =
                looks.iter().flat_map(Look::parts).chain(under(ground.as_ref())).collect();
            let path = options.out.join(stand.name).join(format!("{:03}.glb", again.season()));
            if !looks.is_empty() {
                outputs.write(&path, |writer| Ok(write_glb_parts(&parts, &glb, writer)?))?;
            }
        }
    }
    bar.finish_and_clear();
    let milliseconds = (250 / options.frames).max(40) as u16;
    outputs.write(&file("apng"), |writer| Ok(Picture::write_animation(&frames, milliseconds, writer)?))?;
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

/// The ground of a stand on a slope.
fn under(ground: Option<&Mesh>) -> impl Iterator<Item = Part<'_>> {
    let earth = Material::bark().with_srgb([150, 142, 120]);
    ground.into_iter().map(move |mesh| Part::new(mesh).with_name("ground").with_material(earth))
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
fn look<E: Environment>(
    stand: &Stand<E>,
    forest: &Forest<E>,
    skeletons: &[Skeleton],
    sides: u32,
) -> Result<Vec<Look>, Failure> {
    let tubes = Tubes::default().with_sides(sides);
    let sprouted = forest.trees().iter().zip(skeletons).filter(|(_, skeleton)| skeleton.len() > 1);
    sprouted
        .map(|(tree, skeleton)| {
            let leaves = stand.leaves(tree, skeleton, Season::Summer)?;
            Ok(Look { mesh: tubes.mesh(skeleton)?, leaves })
        })
        .collect()
}

/// Trees without leaves.
fn bare(skeletons: &[Skeleton], sides: u32) -> Result<Vec<Look>, Failure> {
    let tubes = Tubes::default().with_sides(sides);
    let sprouted = skeletons.iter().filter(|skeleton| skeleton.len() > 1);
    sprouted.map(|skeleton| Ok(Look { mesh: tubes.mesh(skeleton)?, leaves: None })).collect()
}
