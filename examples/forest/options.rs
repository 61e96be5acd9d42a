//! The command line.

use super::common::{Failure, number, print, text};
use lexopt::prelude::{Long, Short};
use std::path::PathBuf;
use treesynth::presets;

const HELP: &str = "\
Grows a stand season by season and writes NAME.glb, NAME.png and NAME.apng.

cargo run --release --example forest -- [OPTIONS]

  --preset NAME   one of --list                                [stand-generations]
  --list          the presets, one a line, and nothing else
  --seed N        the seed, 0 to 18446744073709551615          [the preset's]
  --seasons N     how long it grows, 1 to 200                  [the preset's]
  --metamers N    the most metamers, 1 to 5000000              [300000]
  --size N        sides of the animation, 16 to 4096 pixels    [320]
  --out DIR       where files go; made if it is not there      [out]
  --help          this text";

/// What to grow and where to put it.
pub(crate) struct Options {
    pub(crate) preset: String,
    pub(crate) seed: Option<u64>,
    pub(crate) seasons: Option<u32>,
    pub(crate) metamers: usize,
    pub(crate) size: u32,
    pub(crate) out: PathBuf,
}

impl Options {
    /// `None` when the user asked for a text, which has been printed.
    pub(crate) fn from_arguments() -> Result<Option<Self>, Failure> {
        let mut options = Self {
            preset: "stand-generations".into(),
            seed: None,
            seasons: None,
            metamers: 300_000,
            size: 320,
            out: "out".into(),
        };
        let mut arguments = lexopt::Parser::from_env();
        while let Some(argument) = arguments.next()? {
            match argument {
                Long("preset") => options.preset = text(&mut arguments, "--preset")?,
                Long("seed") => options.seed = Some(number(&mut arguments, "--seed", 0..=u64::MAX, "")?),
                Long("seasons") => {
                    options.seasons = Some(number(&mut arguments, "--seasons", 1..=200, "seasons")?);
                }
                Long("metamers") => {
                    options.metamers = number(&mut arguments, "--metamers", 1..=5_000_000, "metamers")?;
                }
                Long("size") => options.size = number(&mut arguments, "--size", 16..=4096, "pixels")?,
                Long("out") => options.out = arguments.value()?.into(),
                Long("list") => {
                    print(presets::stands().map(|stand| format!("{:26} {}", stand.name, stand.caption)));
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
