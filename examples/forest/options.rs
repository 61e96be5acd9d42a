//! The command line.

use super::common::{Failure, number, print, text};
use lexopt::prelude::{Long, Short};
use std::path::PathBuf;
use treesynth::presets;

const HELP: &str = "\
Grows a stand season by season and writes NAME.glb, NAME.png, NAME.side.png and NAME.apng.

cargo run --release --example forest -- [OPTIONS]

  --preset NAME   one of --list                                [stand-generations]
  --list          the presets, one a line, and nothing else
  --seed N        the seed, 0 to 18446744073709551615          [the preset's]
  --seasons N     how long it grows, 1 to 200                  [the preset's]
  --metamers N    the most metamers, 1 to 5000000              [300000]
  --frames N      pictures a season, 1 to 24; more than 1 in winter [1]
  --models        NAME/SEASON.glb too, a model a season
  --size N        sides of the animation, 16 to 4096 pixels    [320]
  --out DIR       where files go; made if it is not there      [out]
  --help          this text";

/// What to grow and where to put it.
pub(crate) struct Options {
    pub(crate) preset: String,
    pub(crate) seed: Option<u64>,
    pub(crate) seasons: Option<u32>,
    pub(crate) metamers: usize,
    pub(crate) frames: u32,
    pub(crate) models: bool,
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
            frames: 1,
            models: false,
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
                Long("frames") => options.frames = number(&mut arguments, "--frames", 1..=24, "pictures")?,
                Long("models") => options.models = true,
                Long("size") => options.size = number(&mut arguments, "--size", 16..=4096, "pixels")?,
                Long("out") => options.out = arguments.value()?.into(),
                Long("list") => {
                    let lines = presets::stands().map(|stand| (stand.name, stand.caption));
                    let lines = lines.chain(presets::spaces().map(|stand| (stand.name, stand.caption)));
                    print(lines.map(|(name, caption)| format!("{name:26} {caption}")));
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
