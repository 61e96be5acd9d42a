//! `forest`: a stand that grows season by season, or trees of species in their places.

mod stand;

use crate::arguments::Common;
use crate::clothe::{Clothes, Surface};
use crate::failure::refused;
use crate::number::{number, text};
use crate::progress::Bar;
use crate::wish::{Wish, stem};
use crate::write::Out;
use crate::{Failure, report};
use clap::Args;
use serde_json::json;
use treesynth::asset::Asset;
use treesynth::glam::{Quat, Vec3};
use treesynth::math;
use treesynth::presets::{self, Found};
use treesynth::random::{Purpose, unit};
use treesynth::species::Species;
use treesynth::surface::{Part, Scene, Transform};

/// Grow a stand season by season, or a forest of species
#[derive(Args)]
#[command(after_help = "\
Examples:
  treesynth forest stand-generations --seasons 20
  treesynth forest stand-slope --format glb,png,obj --animation --frames 8
  treesynth forest beech \"scots pine\" --trees 40 --spacing 5 --budget 3000
  treesynth forest oak --trees 9 --variants 3 --day 290 --format usdz")]
pub(crate) struct Options {
    /// One stand, or one or more species; `treesynth list stands`, `treesynth list species`
    #[arg(required = true, value_parser = text)]
    names: Vec<String>,
    /// Seed, 0 to 18446744073709551615 [default: 1, or the stand's]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number(0..=u64::MAX, ""))]
    seed: Option<u64>,
    /// Seasons that a stand grows for, 1 to 200 [default: the stand's]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number(1..=200_u32, "seasons"), help_heading = "Stands")]
    seasons: Option<u32>,
    /// Metamers that a stand may have, 1 to 5000000 [default: 300000]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number(1..=5_000_000_usize, "metamers"), help_heading = "Stands")]
    metamers: Option<usize>,
    /// Write NAME.apng too, a film of the seasons; takes as long again
    #[arg(long, help_heading = "Stands")]
    animation: bool,
    /// Pictures of the film for each season, 1 to 24; with more than one the trees are bare [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number(1..=24_u32, "pictures"), requires = "animation", help_heading = "Stands")]
    frames: Option<u32>,
    /// Write the files of each season too, NAME/001.glb and so on
    #[arg(long, help_heading = "Stands")]
    models: bool,
    /// Trees of a forest of species, 1 to 10000 [default: 25]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number(1..=10_000_usize, "trees"), help_heading = "Forests of species")]
    trees: Option<usize>,
    /// Metres from one tree to the next, 0.3 to 1000; crowns are as narrow as that makes them [default: 5]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = number(0.3..=1000.0_f32, "m"), help_heading = "Forests of species")]
    spacing: Option<f32>,
    /// Different trees of each species, 1 to 100; each stands in several places [default: 4]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number(1..=100_usize, "trees"), help_heading = "Forests of species")]
    variants: Option<usize>,
    #[command(flatten, next_help_heading = "Forests of species")]
    wish: Wish,
    #[command(flatten, next_help_heading = "Forests of species")]
    clothes: Clothes,
    #[command(flatten, next_help_heading = "Files")]
    out: Out,
}

/// Metres from one tree to the next.
const SPACING: f32 = 5.0;

pub(crate) fn run(options: &Options, common: &Common) -> Result<(), Failure> {
    options.out.check_scene()?;
    let found: Vec<Found> =
        options.names.iter().map(|name| presets::by_name(name)).collect::<Result<_, _>>().map_err(refused)?;
    if let [Found::Stand(_) | Found::Space(_)] = found[..] {
        let name = found[0].name();
        let others = [
            ("--trees", options.trees.is_some()),
            ("--spacing", options.spacing.is_some()),
            ("--variants", options.variants.is_some()),
            ("--budget", options.clothes.budget.is_some()),
            ("--levels", options.clothes.levels.is_some()),
            ("--textures", options.clothes.textures.is_some()),
            ("--wind", options.clothes.wind),
        ];
        let other = others.iter().find(|(_, is_given)| *is_given).map(|(name, _)| (*name).to_owned());
        return match other.or(options.wish.first().map(|name| format!("--{name}"))) {
            Some(option) => Err(refused(format!("{option} goes with species, but {name:?} is a stand"))),
            None => match found[0] {
                Found::Space(stand) => options.stand(stand, common),
                found => options.stand(found.stand().map_err(refused)?, common),
            },
        };
    }
    let species: Vec<&'static Species> = found
        .into_iter()
        .map(|found| match found {
            Found::Stand(_) | Found::Space(_) => {
                Err(refused(format!("{:?} is a stand, which grows alone", found.name())))
            }
            other => other.species().map_err(refused),
        })
        .collect::<Result<_, _>>()?;
    options.species(&species, common)
}

impl Options {
    fn species(&self, species: &[&'static Species], common: &Common) -> Result<(), Failure> {
        let others = [
            ("--seasons", self.seasons.is_some()),
            ("--metamers", self.metamers.is_some()),
            ("--animation", self.animation),
            ("--models", self.models),
            ("--surface closed", self.clothes.surface == Surface::Closed),
            ("--surface skin", self.clothes.surface == Surface::Skin),
            ("--detail", self.clothes.detail.is_some()),
            ("--wind", self.clothes.wind),
            ("--levels", self.clothes.levels.is_some_and(|levels| levels > 1)),
        ];
        if let Some((option, _)) = others.iter().find(|(_, is_given)| *is_given) {
            return Err(refused(format!("{option} does not go with a forest of species")));
        }
        let spacing = self.spacing.unwrap_or(SPACING);
        if self.wish.stand_spacing.is_some() {
            return Err(refused("--stand-spacing goes with grow; a forest has --spacing"));
        }
        let seed = self.seed.unwrap_or(1);
        let count = self.trees.unwrap_or(25);
        let variants = self.variants.unwrap_or(4).min(count.div_ceil(species.len()));
        let wish = Wish { stand_spacing: Some(spacing), ..self.wish };
        // All that may be refused is, before the first tree grows.
        let mut requests = Vec::new();
        for kind in species {
            for variant in 0..variants {
                requests.push((kind, wish.request(kind, seed.wrapping_add(variant as u64))?.0));
            }
        }
        let mut outputs = self.out.outputs()?;
        let bar = Bar::new(common.quiet);
        bar.parts("growing trees", requests.len() as u64);
        let side = self.clothes.textures.map_or(Some(512), |side| side.0).unwrap_or(128);
        let budget = self.clothes.budget.map_or(Some(5_000), |budget| budget.0);
        let mut assets: Vec<(&str, Asset)> = Vec::new();
        for (done, (kind, request)) in requests.into_iter().enumerate() {
            bar.message(kind.name.as_str());
            let mut levels = request.grow()?.levels(budget, side, &[1.0])?;
            if let Some(asset) = levels.pop() {
                assets.push((kind.name.as_str(), asset));
            }
            bar.done(done as u64 + 1);
        }
        let parts: Vec<Vec<Part<'_>>> = assets.iter().map(|(_, asset)| asset.parts()).collect();
        let mut triangles = 0;
        let mut counts = vec![0_usize; species.len()];
        let scene = places(count, spacing, seed).into_iter().enumerate().fold(
            Scene::default(),
            |scene, (number, (place, draw))| {
                // Species by chance, their trees in turn.
                let kind = (draw * species.len() as f32) as usize % species.len();
                let tree = kind * variants + counts[kind] % variants;
                counts[kind] += 1;
                triangles += assets[tree].1.triangles() as u64;
                // The golden angle: no two neighbours look alike.
                let turn = Quat::from_rotation_y((number as f32 * 2.399_963_1) % std::f32::consts::TAU);
                scene.with_asset(
                    assets[tree].0,
                    &parts[tree],
                    Transform { rotation: turn, ..Transform::at(place) },
                )
            },
        );
        bar.step("writing files");
        let names: Vec<String> = species.iter().map(|kind| stem(&kind.name)).collect();
        let name = self.out.name.clone().unwrap_or_else(|| format!("forest-{}", names.join("-")));
        let files = self.out.scene(&mut outputs, &name, &scene)?;
        outputs.finish()?;
        let milliseconds = bar.finish();
        let of: Vec<(&str, usize)> = species.iter().map(|kind| kind.name.as_str()).zip(counts).collect();
        let value = json!({
            "name": name,
            "seed": seed,
            "trees": count,
            "species": of,
            "spacing": spacing,
            "different": assets.len(),
            "triangles": triangles,
            "files": files,
            "milliseconds": milliseconds,
        });
        report::tell(common, &value, || {
            let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
            let of: Vec<String> = of.iter().map(|(name, count)| format!("{count} {name}")).collect();
            format!(
                "{count} trees, {} of them different: {}; {triangles} triangles, {milliseconds:.0} ms\n{}",
                assets.len(),
                of.join(", "),
                files.join("\n"),
            )
        })
    }
}

/// Places in a disc, none two nearer than 0.6 of the spacing, with a number from 0 to 1 each: a sunflower's, a little off.
fn places(count: usize, spacing: f32, seed: u64) -> Vec<(Vec3, f32)> {
    let draw = |number: usize, which: u64| unit(seed, 0, Purpose::CUSTOM, number as u64 * 3 + which);
    (0..count)
        .map(|number| {
            // An area of a square of the spacing each.
            let radius = spacing * ((number as f32 + 0.5) / std::f32::consts::PI).sqrt();
            let (sin, cos) = math::sin_cos((number as f32 * 2.399_963_1) % std::f32::consts::TAU);
            let off = Vec3::new(draw(number, 0) - 0.5, 0.0, draw(number, 1) - 0.5) * (0.2 * spacing);
            (Vec3::new(radius * cos, 0.0, radius * sin) + off, draw(number, 2))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::places;

    #[test]
    fn trees_keep_their_distance() {
        for seed in 0..20 {
            let trees = places(200, 5.0, seed);
            for (number, (place, draw)) in trees.iter().enumerate() {
                assert!((0.0..1.0).contains(draw));
                for (other, _) in &trees[..number] {
                    assert!(place.distance(*other) > 2.5, "seed {seed}: {place} {other}");
                }
            }
        }
    }
}
