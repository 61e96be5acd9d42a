//! A stand that grows season by season.

use super::Options;
use crate::arguments::Common;
use crate::progress::Bar;
use crate::wish::stem;
use crate::write::write_animation;
use crate::{Failure, report};
use serde_json::json;
use std::ops::ControlFlow;
use treesynth::foliage::Leaves;
use treesynth::presets::{Season, Stand};
use treesynth::preview::{Camera, Preview};
use treesynth::self_organizing::Environment;
use treesynth::surface::{Material, Mesh, Part, Scene, Transform, Tubes};
use treesynth::{Bounds, Forest, Progress, Skeleton, Work};

impl Options {
    pub(super) fn stand<E: Environment + Clone>(
        &self,
        stand: &Stand<E>,
        common: &Common,
    ) -> Result<(), Failure> {
        let mut outputs = self.out.outputs()?;
        let seasons = self.seasons.unwrap_or(stand.seasons);
        let seed = self.seed.unwrap_or(stand.seed);
        let bar = Bar::new(common.quiet);
        let again = self.animation || self.models;
        bar.parts(stand.name, u64::from(seasons) * if again { 8 } else { 4 });
        let grow = |forest: &mut Forest<E>, from: u64| -> Result<(), Failure> {
            let watch = |progress: Progress| {
                if let Work::Season { .. } = progress.work {
                    bar.done(from + (progress.fraction * 4.0) as u64);
                }
                ControlFlow::Continue(())
            };
            forest.grow_observed(1, &watch)?;
            stand.tend(forest)?;
            bar.message(format!("{} trees, {} metamers", forest.trees().len(), forest.metamers()));
            Ok(())
        };
        let planted = stand.plant(seed)?.with_most_metamers(self.metamers.unwrap_or(300_000));
        let mut forest = planted.clone();
        for season in 0..u64::from(seasons) {
            grow(&mut forest, season * 4)?;
        }
        let looks = Look::leafy(stand, &forest, 8)?;
        let bounds = looks.iter().filter_map(|look| look.mesh.bounds()).reduce(Bounds::union);
        let bounds = bounds.ok_or_else(|| format!("nothing has sprouted after --seasons {seasons}"))?;
        let ground = stand.ground(bounds);
        let earth = Material::bark().with_srgb([150, 142, 120]);
        let under: Vec<Part<'_>> =
            ground.iter().map(|mesh| Part::new(mesh).with_name("ground").with_material(earth)).collect();
        let name = self.out.name.clone().unwrap_or_else(|| stem(stand.name));
        let mut write = |name: &str, looks: &[Look]| {
            let parts: Vec<Vec<Part<'_>>> = looks.iter().map(|look| look.parts().collect()).collect();
            let all = parts.iter().chain([&under]).filter(|parts| !parts.is_empty());
            let scene = all
                .fold(Scene::default(), |scene, parts| scene.with_asset("tree", parts, Transform::default()));
            self.out.scene(&mut outputs, name, &scene)
        };
        let mut files = write(&name, &looks)?;
        drop(looks);

        // Grown twice, for the pictures of the seasons are framed as the last one is: to keep all seasons' trees would
        // take gigabytes.
        let (mut forest_again, mut pictures) = (planted, Vec::new());
        let frames = self.frames.unwrap_or(1);
        let preview = self.film(bounds, ground.is_some());
        for season in (0..u64::from(seasons)).filter(|_| again) {
            let before = forest_again.clone();
            grow(&mut forest_again, (u64::from(seasons) + season) * 4)?;
            for frame in (1..=frames).filter(|_| self.animation) {
                // Half of the detail will do for the small pictures of the film.
                let looks = if frames == 1 {
                    Look::leafy(stand, &forest_again, 4)?
                } else {
                    Look::bare(&forest_again.skeletons_since(&before, frame as f32 / frames as f32)?, 4)?
                };
                if !looks.is_empty() {
                    let parts = looks.iter().flat_map(Look::parts).chain(under.iter().copied());
                    pictures.push(preview.draw_parts(&parts.collect::<Vec<_>>())?);
                }
            }
            let looks = if self.models { Look::leafy(stand, &forest_again, 8)? } else { Vec::new() };
            if !looks.is_empty() {
                files.extend(write(&format!("{name}/{:03}", season + 1), &looks)?);
            }
        }
        if self.animation {
            let path = outputs.path(&format!("{name}.apng"));
            write_animation(&mut outputs, &path, &pictures, (250 / frames).max(40) as u16)?;
            files.push(path);
        }
        outputs.finish()?;
        let milliseconds = bar.finish();
        let dead = forest.trees().iter().filter(|tree| tree.died().is_some()).count();
        let value = json!({
            "name": stand.name,
            "seed": seed,
            "seasons": forest.season(),
            "trees": forest.trees().len(),
            "dead": dead,
            "metamers": forest.metamers(),
            "files": files,
            "milliseconds": milliseconds,
        });
        report::tell(common, &value, || {
            let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
            format!(
                "{}, seed {seed}: {} seasons, {} trees, {} metamers, {milliseconds:.0} ms\n{}",
                stand.name,
                forest.season(),
                forest.trees().len(),
                forest.metamers(),
                files.join("\n"),
            )
        })
    }

    /// The film shows the box that the trees fill in the end.
    fn film(&self, bounds: Bounds, slope: bool) -> Preview {
        let side = self.out.size.min(480);
        let preview = Preview::default().with_size(side, side);
        let camera = Camera::default().with_frame(bounds);
        if slope {
            // From higher up than a slope is steep.
            preview.with_camera(camera.with_elevation(0.6))
        } else {
            preview.with_camera(camera).with_ground_height(0.0)
        }
    }
}

/// A tree to be drawn and written.
struct Look {
    mesh: Mesh,
    leaves: Option<Leaves>,
}

impl Look {
    /// The trees that are more than seeds, in summer.
    fn leafy<E: Environment>(stand: &Stand<E>, forest: &Forest<E>, sides: u32) -> Result<Vec<Self>, Failure> {
        let tubes = Tubes::default().with_sides(sides);
        let skeletons = forest.skeletons()?;
        let sprouted = forest.trees().iter().zip(&skeletons).filter(|(_, skeleton)| skeleton.len() > 1);
        sprouted
            .map(|(tree, skeleton)| {
                let leaves = stand.leaves(tree, skeleton, Season::Summer)?;
                Ok(Self { mesh: tubes.mesh(skeleton)?, leaves })
            })
            .collect()
    }

    /// Without leaves.
    fn bare(skeletons: &[Skeleton], sides: u32) -> Result<Vec<Self>, Failure> {
        let tubes = Tubes::default().with_sides(sides);
        let sprouted = skeletons.iter().filter(|skeleton| skeleton.len() > 1);
        sprouted.map(|skeleton| Ok(Self { mesh: tubes.mesh(skeleton)?, leaves: None })).collect()
    }

    fn parts(&self) -> impl Iterator<Item = Part<'_>> {
        [Part::new(&self.mesh)].into_iter().chain(self.leaves.as_ref().map(Leaves::part))
    }
}
