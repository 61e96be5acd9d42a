//! The command line.

use super::common::{Failure, number, print, text};
use lexopt::prelude::{Long, Short};
use std::path::PathBuf;
use treesynth::presets::{self, Found, Grown};

const HELP: &str = "\
Grows a tree over the years and writes an animation (NAME.apng) with its frames (NAME/*.png), a contact sheet of several
ages (NAME-sheet.png), a model of one age (NAME.glb) and its picture (NAME.png).

cargo run --release --example growth -- [OPTIONS]

  --species NAME  one of --list, or words that its name ends in, e.g. oak or spreading-oak  [cottonwood]
  --list          the presets, one a line, and nothing else
  --age YEARS     of the model, 0 to as long as the species is grown, e.g. 12.5  [the last of the preset's ages]
  --seed N        the seed, 0 to 18446744073709551615          [the preset's]
  --from YEARS    where the animation begins                   [0.6]
  --to YEARS      where it ends                                [the last summer]
  --frames N      its pictures, 2 to 1000                      [one a year; 48 if it lasts less than two years]
  --size N        their height, 16 to 8192 pixels              [640]
  --skin          pictures of a blended skin with scars and ridges, cast ray by ray, and of a fork of the trunk as it ages
                  (NAME-close.png)                             [tubes]
  --out DIR       where files go; made if it is not there      [out]
  --help          this text";

/// What to grow and where to put it.
pub(crate) struct Options {
    pub(crate) species: String,
    pub(crate) age: Option<f32>,
    pub(crate) seed: Option<u64>,
    pub(crate) from: Option<f32>,
    pub(crate) to: Option<f32>,
    pub(crate) frames: Option<u32>,
    pub(crate) size: u32,
    pub(crate) skin: bool,
    pub(crate) out: PathBuf,
}

impl Options {
    /// `None` when the user asked for a text, which has been printed.
    pub(crate) fn from_arguments() -> Result<Option<Self>, Failure> {
        let mut options = Self {
            species: "cottonwood".into(),
            age: None,
            seed: None,
            from: None,
            to: None,
            frames: None,
            size: 640,
            skin: false,
            out: "out".into(),
        };
        let mut arguments = lexopt::Parser::from_env();
        while let Some(argument) = arguments.next()? {
            match argument {
                Long("species") => options.species = text(&mut arguments, "--species")?,
                Long("age") => options.age = Some(number(&mut arguments, "--age", 0.0..=1000.0, "years")?),
                Long("seed") => options.seed = Some(number(&mut arguments, "--seed", 0..=u64::MAX, "")?),
                Long("from") => options.from = Some(number(&mut arguments, "--from", 0.0..=1000.0, "years")?),
                Long("to") => options.to = Some(number(&mut arguments, "--to", 0.0..=1000.0, "years")?),
                Long("frames") => {
                    options.frames = Some(number(&mut arguments, "--frames", 2..=1000, "pictures")?);
                }
                Long("size") => options.size = number(&mut arguments, "--size", 16..=8192, "pixels")?,
                Long("skin") => options.skin = true,
                Long("out") => options.out = arguments.value()?.into(),
                Long("list") => {
                    print(species().map(|preset| format!("{:22} {}", preset.name, preset.caption)));
                    return Ok(None);
                }
                Long("help") | Short('h') => {
                    print([HELP]);
                    return Ok(None);
                }
                other => return Err(other.unexpected().into()),
            }
        }
        Ok(Some(options))
    }
}

/// The preset of that name, or whose name ends in these words; a part of a word is none.
pub(crate) fn named(words: &str) -> Result<&'static Grown, Failure> {
    let ends = |name: &str| {
        let before = name.strip_suffix(words).filter(|_| !words.is_empty());
        before.is_some_and(|before| before.is_empty() || before.ends_with('-'))
    };
    if let Some(preset) = species().find(|preset| ends(preset.name)) {
        return Ok(preset);
    }
    let found = presets::by_name(words).and_then(Found::grown);
    Ok(found.map_err(|error| format!("--species: {error}; see --list"))?)
}

/// All but the figures' drawings in the plane, which the example `gallery` draws.
pub(crate) fn species() -> impl Iterator<Item = &'static Grown> {
    presets::grown().filter(|preset| !preset.planar)
}
