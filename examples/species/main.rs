//! Draws all species on one sheet, or measures them beside published figures: the pictures and the table of docs/species.md.
//!
//!     cargo run --release --example species -- --sheet blossom --out docs/figures
//!     cargo run --release --example species -- --table --seeds 20

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
use std::path::PathBuf;
use treesynth::species;

const USAGE: &str = "\
Usage: species (--sheet KIND | --table | --classify) [options]
  --sheet KIND        a picture of all species; KIND is
                      trees    bare and in leaf, at one scale: species.png
                      autumn   in autumn, at one scale: species-autumn.png
                      twigs    twigs, bare and in leaf: species-twigs.png
                      meadow   several species in a meadow: species-meadow.png
                      blossom  blossom, fruit and cones: species-blossom.png
                      barks    old trunk and young wood from 2 m: species-barks.png
                      trunks   of six species from 2 m: species-trunks.png
  --species NAME      this one alone on a sheet of barks or trunks
  --seed N            of a sheet [0]
  --table             measures beside published figures, as Markdown
  --classify          how many trees are named right by the nearest centroid of their measures
  --seeds N           trees of each species for the table and the naming [20]
  --out DIR           [out]";

/// Work to be done with all species.
enum Task {
    Sheet(String),
    Table,
    Classify,
}

fn main() {
    common::run(run);
}

fn run() -> Result<(), Failure> {
    let (mut task, mut species, mut seed, mut seeds, mut out) = (None, None, 0, 20, PathBuf::from("out"));
    let mut arguments = lexopt::Parser::from_env();
    while let Some(argument) = arguments.next()? {
        match argument {
            Long("sheet") => task = Some(Task::Sheet(text(&mut arguments, "--sheet")?)),
            Long("table") => task = Some(Task::Table),
            Long("classify") => task = Some(Task::Classify),
            Long("species") => species = Some(species::by_name(&text(&mut arguments, "--species")?)?),
            Long("seed") => seed = number(&mut arguments, "--seed", 0..=u64::MAX, "")?,
            Long("seeds") => seeds = number(&mut arguments, "--seeds", 2..=1000, "")?,
            Long("out") => out = text(&mut arguments, "--out")?.into(),
            Long("help") | Short('h') => {
                print([USAGE]);
                return Ok(());
            }
            other => return Err(other.unexpected().into()),
        }
    }
    let kind = match task.ok_or(USAGE)? {
        Task::Table => {
            print(table::lines(seeds)?);
            return Ok(());
        }
        Task::Classify => {
            print(classify::lines(seeds)?);
            return Ok(());
        }
        Task::Sheet(kind) => kind,
    };
    let mut outputs = Outputs::new("--out", &out)?;
    let sheet = match kind.as_str() {
        "trees" => sheet::draw(seed)?,
        "autumn" => sheet::autumn(seed)?,
        "twigs" => twig::leaves(seed)?,
        "meadow" => meadow::draw(seed)?,
        "blossom" => twig::blossom(seed)?,
        "barks" => bark::sheet(seed, species)?,
        "trunks" => bark::trunks(seed, species)?,
        _ => {
            let kinds = "trees, autumn, twigs, meadow, blossom, barks or trunks";
            return Err(format!("--sheet is {kind:?}, but must be {kinds}").into());
        }
    };
    let name = if kind == "trees" { "species.png".to_owned() } else { format!("species-{kind}.png") };
    let path = outputs.path(&name);
    outputs.write(&path, |writer| Ok(sheet.write_png(writer)?))?;
    outputs.finish()
}
