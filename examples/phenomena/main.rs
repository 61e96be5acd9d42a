//! Least-cost paths steered by guiding vectors make more than trees: ivy on a ruin, roots in the soil, rivers, lightning,
//! cracks, and what the wind of a simulation bends. A picture (`phenomenon-NAME.png`) of each.
//!
//!     cargo run --release --example phenomena -- --help

mod cracks;
mod ivy;
mod lightning;
mod planar;
mod rivers;
mod roots;
mod ruin;
mod solid;
mod wind;

use lexopt::prelude::{Long, Short, ValueExt};
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::PathBuf;
use std::time::Instant;
use treesynth::preview::Picture;

type Failure = Box<dyn std::error::Error>;

const HELP: &str = "\
Draws what else guided paths can make: phenomenon-NAME.png.

cargo run --release --example phenomena -- [OPTIONS]

  --only NAME   one of --list                              [all of them]
  --list        their names, one a line, and nothing else
  --nodes N     nodes of the graph                         [each has its own]
  --seed N      the seed                                   [1]
  --size N      side of the picture, pixels                [800]
  --out DIR     where files go; made if it is not there    [out]
  --help        this text";

/// Draws on a graph of so many nodes, of a seed, in a picture of so many pixels; says what it has measured.
type Draw = fn(usize, u64, u32) -> Result<(Picture, String), Failure>;

/// Name, nodes of the graph, and what draws it.
const ALL: [(&str, usize, Draw); 6] = [
    ("wind", 60_000, wind::draw),
    ("ivy", 30_000, ivy::draw),
    ("roots", 80_000, roots::draw),
    ("rivers", 12_000, rivers::draw),
    ("lightning", 60_000, lightning::draw),
    ("cracks", 12_000, cracks::draw),
];

fn main() {
    if let Err(error) = run() {
        eprintln!("error: {error}");
        std::process::exit(1);
    }
}

fn run() -> Result<(), Failure> {
    let (mut only, mut nodes, mut seed, mut size) = (None, None, 1, 800);
    let mut out = PathBuf::from("out");
    let mut arguments = lexopt::Parser::from_env();
    while let Some(argument) = arguments.next()? {
        match argument {
            Long("only") => only = Some(arguments.value()?.string()?),
            Long("nodes") => nodes = Some(arguments.value()?.parse()?),
            Long("seed") => seed = arguments.value()?.parse()?,
            Long("size") => size = arguments.value()?.parse()?,
            Long("out") => out = arguments.value()?.into(),
            Long("list") => {
                for (name, ..) in ALL {
                    println!("{name}");
                }
                return Ok(());
            }
            Long("help") | Short('h') => {
                println!("{HELP}");
                return Ok(());
            }
            other => return Err(other.unexpected().into()),
        }
    }
    if let Some(name) = only.as_ref().filter(|name| ALL.iter().all(|(other, ..)| other != name)) {
        return Err(format!("there is no {name}; --list has all").into());
    }
    fs::create_dir_all(&out)?;
    for (name, usual, draw) in
        ALL.iter().filter(|(name, ..)| only.as_deref().is_none_or(|only| only == *name))
    {
        let start = Instant::now();
        let (picture, measured) = draw(nodes.unwrap_or(*usual), seed, size)?;
        println!("{name}: {measured} ({:.1} s)", start.elapsed().as_secs_f32());
        let mut writer = BufWriter::new(File::create(out.join(format!("phenomenon-{name}.png")))?);
        picture.write_png(&mut writer)?;
        writer.flush()?;
    }
    Ok(())
}
