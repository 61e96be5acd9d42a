//! Species by name: grows one and draws it, draws all on one sheet, or measures all beside published figures.
//!
//!     cargo run --release --example species -- --list
//!     cargo run --release --example species -- --species "silver birch" --height 12 --seed 3 --out out
//!     cargo run --release --example species -- --species "English oak" --dead 20
//!     cargo run --release --example species -- --sheet --out docs/figures
//!     cargo run --release --example species -- --sheet=blossom --out docs/figures
//!     cargo run --release --example species -- --table --seeds 20
//!     cargo run --release --example species -- --classify --seeds 20

mod bark;
mod classify;
#[path = "../common/mod.rs"]
mod common;
mod meadow;
mod measure;
mod reference;
mod sheet;
mod table;
mod twig;

use common::{Failure, Outputs, number, print, text};
use lexopt::prelude::*;
use std::fs;
use std::path::PathBuf;
use treesynth::asset::{Asset, Impostor};
use treesynth::export::{GlbOptions, write_glb_levels};
use treesynth::species::{self, Request, Species};

const USAGE: &str = "\
Usage: species (--list | --species NAME | --file TEXT | --sheet | --table | --classify) [options]
  --list              the names of all species
  --species NAME      grow one: English or Latin name; writes NAME.glb, with two
                      coarser levels and an impostor, and NAME.png
  --file TEXT         the same, of a species that is read from a text file
  --height M, --dbh M, --age YEARS
  --stand M           in a stand of that spacing; otherwise in the open
  --day DAY           day of the year, 1 to 366 [196]
  --dead YEARS        a snag, so many years dead, 0 to 80
  --storm PART        damaged by a storm, 0 to 1 [0]
  --seed N            [0]
  --budget N          triangles of the finest level, 100 to 100000000, or none [20000]
  --textures N        side of the images, pixels: a power of two, 128 to 8192 [512]
  --sheet[=KIND]      a picture of all species; KIND is
                      trees    bare and in leaf, at one scale: species.png (default)
                      autumn   in autumn, at one scale: species-autumn.png
                      twigs    twigs, bare and in leaf: species-twigs.png
                      meadow   several species in a meadow: species-meadow.png
                      blossom  blossom, fruit and cones: species-blossom.png
                      barks    old trunk and young wood from 2 m: species-barks.png
                      trunks   of six species from 2 m: species-trunks.png
  --table             measures beside published figures, as Markdown
  --classify          how many trees are named right by the nearest centroid of their measures
  --seeds N           trees of each species for the table and the naming [20]
  --out DIR           [out]";

/// What is done with all species.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Task {
    List,
    Sheet(Sheet),
    Table,
    Classify,
}

/// What is on a sheet.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sheet {
    Trees,
    Autumn,
    Twigs,
    Blossom,
    Meadow,
    Barks,
    Trunks,
}

impl Sheet {
    fn named(name: Option<&str>) -> Result<Self, Failure> {
        match name {
            None | Some("trees") => Ok(Self::Trees),
            Some("autumn") => Ok(Self::Autumn),
            Some("twigs") => Ok(Self::Twigs),
            Some("meadow") => Ok(Self::Meadow),
            Some("blossom") => Ok(Self::Blossom),
            Some("barks") => Ok(Self::Barks),
            Some("trunks") => Ok(Self::Trunks),
            Some(other) => Err(format!(
                "--sheet is {other:?}, but must be trees, autumn, twigs, blossom, meadow, barks or trunks"
            )
            .into()),
        }
    }
}

#[derive(Default)]
struct Options {
    task: Option<Task>,
    species: Option<String>,
    file: Option<PathBuf>,
    height: Option<f32>,
    dbh: Option<f32>,
    age: Option<f32>,
    stand: Option<f32>,
    day: Option<f32>,
    dead: Option<f32>,
    storm: Option<f32>,
    seed: u64,
    seeds: u64,
    budget: Option<usize>,
    textures: u32,
    out: PathBuf,
}

fn main() {
    common::run(|| match options()? {
        None => Ok(()),
        Some(options) => run(&options),
    });
}

fn options() -> Result<Option<Options>, Failure> {
    let mut options =
        Options { seeds: 20, budget: Some(20_000), textures: 512, out: "out".into(), ..Options::default() };
    let mut arguments = lexopt::Parser::from_env();
    let metres = 0.0..=1000.0;
    while let Some(argument) = arguments.next()? {
        match argument {
            Long("list") => options.task = Some(Task::List),
            Long("sheet") => {
                let name = arguments.optional_value().map(|name| name.to_string_lossy().into_owned());
                options.task = Some(Task::Sheet(Sheet::named(name.as_deref())?));
            }
            Long("table") => options.task = Some(Task::Table),
            Long("classify") => options.task = Some(Task::Classify),
            Long("species") => options.species = Some(text(&mut arguments, "--species")?),
            Long("file") => options.file = Some(text(&mut arguments, "--file")?.into()),
            Long("height") => options.height = Some(number(&mut arguments, "--height", metres.clone(), "m")?),
            Long("dbh") => options.dbh = Some(number(&mut arguments, "--dbh", metres.clone(), "m")?),
            Long("age") => options.age = Some(number(&mut arguments, "--age", 0.0..=10_000.0, "years")?),
            Long("stand") => options.stand = Some(number(&mut arguments, "--stand", metres.clone(), "m")?),
            Long("dead") => options.dead = Some(number(&mut arguments, "--dead", 0.0..=80.0, "years")?),
            Long("storm") => options.storm = Some(number(&mut arguments, "--storm", 0.0..=1.0, "")?),
            Long("day") => options.day = Some(number(&mut arguments, "--day", 1.0..=366.0, "")?),
            Long("seed") => options.seed = number(&mut arguments, "--seed", 0..=u64::MAX, "")?,
            Long("seeds") => options.seeds = number(&mut arguments, "--seeds", 2..=1000, "")?,
            Long("budget") => {
                options.budget = match text(&mut arguments, "--budget")?.as_str() {
                    "none" => None,
                    number => Some(
                        number
                            .parse()
                            .ok()
                            .filter(|budget| (100..=100_000_000).contains(budget))
                            .ok_or_else(|| {
                                format!(
                                    "--budget is {number:?}, but must be 100 to 100000000 triangles or none"
                                )
                            })?,
                    ),
                }
            }
            Long("textures") => {
                options.textures =
                    number(&mut arguments, "--textures", 128..=8192, "pixels, a power of two")?;
                if !options.textures.is_power_of_two() {
                    let side = options.textures;
                    return Err(format!(
                        "--textures is {side}, but must be a power of two, 128 to 8192 pixels"
                    )
                    .into());
                }
            }
            Long("out") => options.out = text(&mut arguments, "--out")?.into(),
            Long("help") | Short('h') => {
                print([USAGE]);
                return Ok(None);
            }
            other => return Err(other.unexpected().into()),
        }
    }
    Ok(Some(options))
}

fn run(options: &Options) -> Result<(), Failure> {
    match options.task {
        Some(Task::List) => print(
            species::all()
                .iter()
                .map(|species| format!("{:18} {:28} {}", species.name, species.latin, species.about)),
        ),
        Some(Task::Table) => print(table::lines(options.seeds)?),
        Some(Task::Classify) => print(classify::lines(options.seeds)?),
        Some(Task::Sheet(kind)) => {
            let only = options.species.as_deref().map(species::by_name).transpose()?;
            let mut outputs = Outputs::new("--out", &options.out)?;
            let (name, sheet) = match kind {
                Sheet::Trees => ("species.png", sheet::draw(options.seed)?),
                Sheet::Autumn => ("species-autumn.png", sheet::autumn(options.seed)?),
                Sheet::Twigs => ("species-twigs.png", twig::leaves(options.seed)?),
                Sheet::Meadow => ("species-meadow.png", meadow::draw(options.seed)?),
                Sheet::Blossom => ("species-blossom.png", twig::blossom(options.seed)?),
                Sheet::Barks => ("species-barks.png", bark::sheet(options.seed, only)?),
                Sheet::Trunks => ("species-trunks.png", bark::trunks(options.seed, only)?),
            };
            let path = outputs.path(name);
            outputs.write(&path, |writer| Ok(sheet.write_png(writer)?))?;
            outputs.finish()?;
        }
        None => grow(options)?,
    }
    Ok(())
}

/// One species, by its name or from a file.
fn grow(options: &Options) -> Result<(), Failure> {
    if let Some(path) = &options.file {
        let content = fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
        let own = Species::parse(&content).map_err(|error| format!("{}: {error}", path.display()))?;
        one(&own, options)?;
    } else if let Some(name) = &options.species {
        one(species::by_name(name)?, options)?;
    } else {
        return Err(USAGE.into());
    }
    Ok(())
}

fn request<'a>(species: &'a Species, options: &Options) -> Request<'a> {
    let mut request = species.request().with_seed(options.seed).with_day(options.day.unwrap_or(196.0));
    for (wish, set) in [
        (options.height, Request::with_height as fn(Request<'a>, f32) -> Request<'a>),
        (options.dbh, Request::with_dbh),
        (options.age, Request::with_age),
        (options.stand, Request::in_a_stand),
        (options.dead, Request::with_years_dead),
        (options.storm, Request::with_storm_damage),
    ] {
        if let Some(value) = wish {
            request = set(request, value);
        }
    }
    request
}

/// One tree: a picture and a model.
fn one(species: &Species, options: &Options) -> Result<(), Failure> {
    let tree = request(species, options).grow()?;
    let mut outputs = Outputs::new("--out", &options.out)?;
    let name = species.name.replace(' ', "-").to_lowercase();
    let mut levels = tree.levels(options.budget, options.textures, &[1.0, 0.3, 0.08])?;
    levels.push(Impostor::default().billboards(&levels[0].parts())?);
    let levels: Vec<_> = levels.iter().map(Asset::parts).collect();
    let path = outputs.path(&format!("{name}.glb"));
    outputs.write(&path, |writer| {
        Ok(write_glb_levels(&levels, &GlbOptions::default().with_name(&name), writer)?)
    })?;
    let picture = sheet::portrait(&levels[0])?;
    let path = outputs.path(&format!("{name}.png"));
    outputs.write(&path, |writer| Ok(picture.write_png(writer)?))?;
    outputs.finish()?;
    let numbers = tree.numbers;
    print([format!(
        "{}, seed {}: {:.1} m tall, {:.2} m thick at 1.3 m, about {:.0} years, crown {:.1} m wide from {:.1} m up, {} leaves, {:.0} m² in summer",
        species.name,
        tree.seed,
        numbers.height,
        numbers.dbh,
        numbers.age,
        numbers.crown_width,
        numbers.crown_base,
        tree.leaves.as_ref().map_or(0, |leaves| leaves.instances.len()),
        numbers.leaf_area,
    )]);
    Ok(())
}
