//! Draws options over their ranges, a strip of small pictures each, into `docs/figures/strip-*.png`: the guide's page of options.
//!
//!     cargo run --release --example strips -- --help

mod bark;
#[path = "../common/mod.rs"]
mod common;
mod guided;
mod habits;
mod leaves;
mod palette;

use common::{Failure, Outputs, number, print};
use lexopt::prelude::{Long, Short, ValueExt};
use std::path::PathBuf;
use treesynth::preview::Picture;

const HELP: &str = "\
Draws options over their ranges, a strip of small pictures each.

cargo run --release --example strips -- [OPTIONS]

  --only TEXT   strips whose names contain it              [all]
  --size N      side of a picture, 16 to 1024 pixels       [176]
  --out DIR     where pictures go; made if it is not there [docs/figures]
  --help        this text";

/// Draws the pictures of a strip of this size.
type Draw = fn(u32) -> Result<Vec<Picture>, Failure>;

/// Light paper, which keeps the files small.
const PAPER: [f32; 3] = [0.97, 0.965, 0.955];

fn main() {
    common::run(run);
}

fn run() -> Result<(), Failure> {
    let (mut only, mut size, mut out) = (String::new(), 176, PathBuf::from("docs/figures"));
    let mut arguments = lexopt::Parser::from_env();
    while let Some(argument) = arguments.next()? {
        match argument {
            Long("only") => only = arguments.value()?.string()?,
            Long("size") => size = number(&mut arguments, "--size", 16..=1024, "pixels")?,
            Long("out") => out = arguments.value()?.into(),
            Long("help") | Short('h') => {
                print([HELP]);
                return Ok(());
            }
            other => return Err(other.unexpected().into()),
        }
    }
    let strips = [guided::STRIPS, habits::STRIPS, leaves::STRIPS, bark::STRIPS].concat();
    for (name, draw) in strips.into_iter().filter(|(name, _)| name.contains(&only)) {
        let pictures = draw(size)?;
        let strip = Picture::sheet(&pictures, pictures.len() as u32, 2, [255; 3])?;
        let mut outputs = Outputs::new("--out", &out)?;
        let path = outputs.path(&format!("strip-{name}.png"));
        outputs.write(&path, |writer| palette::write(&strip, writer))?;
        outputs.finish()?;
        println!("{name}");
    }
    Ok(())
}

/// A picture with what it is of.
fn labelled(mut picture: Picture, label: &str) -> Picture {
    picture.label(label, 4, 4, 1, [60; 3]);
    picture
}
