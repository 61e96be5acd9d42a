//! `grow`: one tree, of a species or a preset.

use crate::arguments::Common;
use crate::clothe::{Clothes, Model, triangles};
use crate::failure::refused;
use crate::number::{number, text};
use crate::progress::Bar;
use crate::wish::{Wish, read_species, stem};
use crate::write::{Out, Tree};
use crate::{Failure, report};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::PathBuf;
use treesynth::guided::Search;
use treesynth::presets::{self, Found, Preset, Season, TYPICAL_NODES};
use treesynth::species::Species;
use treesynth::surface::{Material, Part};
use treesynth::{Metrics, Skeleton};

/// Grow one tree, of a species or a preset of the guided system
#[derive(Args)]
#[command(after_help = "\
Examples:
  treesynth grow oak
  treesynth grow \"Betula pendula\" --height 12 --day 280 --seed 3 --out trees
  treesynth grow beech --dbh 0.4 --stand-spacing 5 --budget 8000 --levels 4 --lod-names
  treesynth grow oak --dead 20 --format glb,obj,usdz,png
  treesynth grow figure-06c --nodes 50000 --season autumn
  treesynth grow fine-oak --surface closed --format stl --up z --unit 0.001
  treesynth grow --species-file my.toml --json | jq .triangles")]
pub(crate) struct Options {
    /// A species by its English, Latin or other name, or a preset; `treesynth list` has them
    #[arg(value_name = "NAME", value_parser = text, required_unless_present = "species_file", conflicts_with = "species_file")]
    name_of_tree: Option<String>,
    /// A species of one's own, from a text as docs/species.md has it
    #[arg(long, value_name = "FILE")]
    species_file: Option<PathBuf>,
    /// Seed, 0 to 18446744073709551615 [default: 0 for species, the preset's own for presets]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number(0..=u64::MAX, ""))]
    seed: Option<u64>,
    #[command(flatten, next_help_heading = "Species")]
    wish: Wish,
    #[command(flatten, next_help_heading = "Presets")]
    detail: Detail,
    #[command(flatten, next_help_heading = "Model")]
    clothes: Clothes,
    #[command(flatten, next_help_heading = "Files")]
    out: Out,
}

/// Options of presets.
#[derive(Args, Debug)]
struct Detail {
    /// Nodes of the graph of a preset, 100 to 200000000 [default: 150000]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number(100..=200_000_000_usize, "nodes of the graph"))]
    nodes: Option<usize>,
    /// Leaves of a preset [default: summer]
    #[arg(long, value_enum, value_name = "TIME")]
    season: Option<Time>,
}

/// Seasons of presets.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Time {
    Winter,
    Summer,
    Autumn,
}

/// The tree to grow, with all of the command line checked.
enum Plan<'a> {
    Species(&'a Species),
    Preset(&'static Preset),
}

/// A grown tree with its numbers.
struct Grown {
    name: String,
    seed: u64,
    /// The skeleton that the surface was made of.
    skeleton: Skeleton,
    model: Model,
    bark: Material,
    /// For the report.
    numbers: Value,
    text: String,
}

pub(crate) fn run(options: &Options, common: &Common) -> Result<(), Failure> {
    options.clothes.check()?;
    let own = options.species_file.as_deref().map(read_species).transpose()?;
    let plan = options.plan(own.as_ref())?;
    let mut outputs = options.out.outputs()?;
    let bar = Bar::new(common.quiet);
    let tree = match plan {
        Plan::Species(species) => options.species(species, &bar)?,
        Plan::Preset(preset) => options.preset(preset, &bar)?,
    };
    let metrics = Metrics::of(&tree.skeleton);
    let levels = tree.model.levels();
    let coverages = tree.model.coverages(metrics.height as f32);
    let name = options.out.name.clone().unwrap_or_else(|| stem(&tree.name));
    bar.step("writing files");
    let written = Tree { levels: &levels, coverages: &coverages, skeleton: &tree.skeleton, bark: tree.bark };
    let files = options.out.tree(&mut outputs, &name, &written)?;
    outputs.finish()?;
    let milliseconds = bar.finish();
    let value = json!({
        "name": tree.name,
        "seed": tree.seed,
        "numbers": tree.numbers,
        "triangles": triangles(&levels),
        "parts": levels.first().map_or(json!({}), |parts| counts(parts)),
        "metrics": serde_json::to_value(&metrics)?,
        "files": files,
        "milliseconds": milliseconds,
    });
    report::tell(common, &value, || {
        let counts: Vec<String> = triangles(&levels).iter().map(u64::to_string).collect();
        let counts =
            if counts.is_empty() { String::new() } else { format!("{} triangles, ", counts.join(" / ")) };
        let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
        format!(
            "{}, seed {}: {}\n{counts}{milliseconds:.0} ms\n{}",
            tree.name,
            tree.seed,
            tree.text,
            files.join("\n"),
        )
    })
}

/// Copies, vertices and triangles of a level's parts; several of one name are counted together.
fn counts(parts: &[Part<'_>]) -> Value {
    let mut counts: BTreeMap<&str, [u64; 3]> = BTreeMap::new();
    for part in parts {
        let more = [part.copies().len() as u64, part.vertices(), part.triangles()];
        let sums = counts.entry(part.name()).or_default();
        *sums = std::array::from_fn(|i| sums[i] + more[i]);
    }
    let entry = |(name, [copies, vertices, triangles]): (&str, [u64; 3])| {
        (name.to_owned(), json!({ "copies": copies, "vertices": vertices, "triangles": triangles }))
    };
    Value::Object(counts.into_iter().map(entry).collect())
}

impl Options {
    fn plan<'a>(&self, own: Option<&'a Species>) -> Result<Plan<'a>, Failure> {
        let species: &'a Species = match (own, self.name_of_tree.as_deref()) {
            (Some(own), _) => own,
            (None, name) => match presets::by_name(name.unwrap_or_default()).map_err(refused)? {
                Found::Species(species) => species,
                Found::Guided(preset) => return self.preset_plan(preset),
                other => {
                    let command = match other {
                        Found::Stand(_) | Found::Space(_) => "forest",
                        Found::Variational(_) => "shape",
                        _ => "years",
                    };
                    let name = other.name();
                    return Err(refused(format!(
                        "{name:?} is a preset of the system {}: treesynth {command} {name}",
                        other.system()
                    )));
                }
            },
        };
        let detail = [("--nodes", self.detail.nodes.is_some()), ("--season", self.detail.season.is_some())];
        if let Some((option, _)) = detail.iter().find(|(_, is_given)| *is_given) {
            let instead = if *option == "--season" { "; --day chooses the day of the year" } else { "" };
            return Err(refused(format!(
                "{option} goes with presets of the guided system, but {:?} is a species{instead}",
                species.name
            )));
        }
        self.wish.request(species, self.seed.unwrap_or(0)).map(drop)?;
        Ok(Plan::Species(species))
    }

    fn preset_plan<'a>(&self, preset: &'static Preset) -> Result<Plan<'a>, Failure> {
        match self.wish.first() {
            Some(option) => Err(refused(format!(
                "--{option} goes with species, but {:?} is a preset of the guided system",
                preset.name
            ))),
            None => Ok(Plan::Preset(preset)),
        }
    }

    fn species(&self, species: &Species, bar: &Bar) -> Result<Grown, Failure> {
        let seed = self.seed.unwrap_or(0);
        bar.step(format!("growing {}", species.name));
        let (request, _) = self.wish.request(species, seed)?;
        let tree = request.grow()?;
        bar.step("bark, leaves and levels");
        let model = if self.out.has_triangles() { self.clothes.specimen(&tree)? } else { Model::none() };
        let (numbers, leaves) =
            (tree.numbers, tree.leaves.as_ref().map_or(0, |leaves| leaves.instances.len()));
        let text = format!(
            "{:.1} m tall, {:.2} m thick at 1.3 m, about {:.0} years, crown {:.1} m wide from {:.1} m up, {leaves} leaves",
            numbers.height, numbers.dbh, numbers.age, numbers.crown_width, numbers.crown_base,
        );
        let mut value = serde_json::to_value(numbers)?;
        value["leaves"] = json!(leaves);
        let (name, bark) = (species.name.clone(), tree.bark());
        Ok(Grown { name, seed, skeleton: tree.skeleton, model, bark, numbers: value, text })
    }

    fn preset(&self, preset: &'static Preset, bar: &Bar) -> Result<Grown, Failure> {
        let seed = self.seed.unwrap_or(preset.seed);
        let season = match self.detail.season {
            None | Some(Time::Summer) => Season::Summer,
            Some(Time::Winter) => Season::Winter,
            Some(Time::Autumn) => Season::Autumn,
        };
        bar.parts(format!("growing {}", preset.name), 1000);
        let synth = preset.synth(self.detail.nodes.unwrap_or(TYPICAL_NODES));
        let graph = synth.build_graph(seed, bar)?;
        let growth = synth.grow(&mut Search::new(&graph), seed, bar)?;
        let endpoints: usize = growth.endpoints.iter().map(Vec::len).sum();
        bar.step("bark, leaves and levels");
        let relaxed = growth.skeleton.relaxed(0.5, 3)?;
        let leaves = preset.foliage(season).map(|foliage| foliage.place(&relaxed, seed)).transpose()?;
        let images = preset.bark_texture().with_seed(seed);
        let model = if self.out.has_triangles() {
            self.clothes.dressed(&relaxed, leaves.as_slice(), preset.bark(), Some(images))?
        } else {
            Model::none()
        };
        let leaves = leaves.map_or(0, |leaves| leaves.instances.len());
        let refined = if synth.refines() { " before refinement" } else { "" };
        let text = format!(
            "{} nodes{refined}, {endpoints} endpoints, {} internodes, {leaves} leaves",
            graph.nodes(),
            relaxed.segments(),
        );
        let numbers = json!({
            "nodes": graph.nodes(),
            "edges": graph.edges(),
            "endpoints": endpoints,
            "leaves": leaves,
        });
        let (name, bark) = (preset.name.to_owned(), preset.bark());
        Ok(Grown { name, seed, skeleton: relaxed, model, bark, numbers, text })
    }
}
