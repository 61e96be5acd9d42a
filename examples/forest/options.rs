//! The command line.

use lexopt::prelude::{Long, Short, ValueExt};
use std::path::PathBuf;
use treesynth::presets;

const HELP: &str = "\
Grows a stand season by season and writes NAME.glb, NAME.png and NAME.apng.

cargo run --release --example forest -- [OPTIONS]

  --preset NAME   one of --list                                [stand-generations]
  --list          the presets, one a line, and nothing else
  --seed N        the seed                                     [the preset's]
  --seasons N     how long it grows, at least 1                [the preset's]
  --size N        pixels of the animation's sides              [320]
  --out DIR       where files go; made if it is not there      [out]
  --help          this text";

/// What to grow and where to put it.
pub(crate) struct Options {
    pub(crate) preset: String,
    pub(crate) seed: Option<u64>,
    pub(crate) seasons: Option<u32>,
    pub(crate) size: u32,
    pub(crate) out: PathBuf,
}

impl Options {
    /// `None` when the user asked for a text, which has been printed.
    pub(crate) fn from_arguments() -> Result<Option<Self>, super::Failure> {
        let mut options = Self {
            preset: "stand-generations".into(),
            seed: None,
            seasons: None,
            size: 320,
            out: "out".into(),
        };
        let mut arguments = lexopt::Parser::from_env();
        while let Some(argument) = arguments.next()? {
            match argument {
                Long("preset") => options.preset = arguments.value()?.string()?,
                Long("seed") => options.seed = Some(arguments.value()?.parse()?),
                Long("seasons") => options.seasons = Some(arguments.value()?.parse()?),
                Long("size") => options.size = arguments.value()?.parse()?,
                Long("out") => options.out = arguments.value()?.into(),
                Long("list") => {
                    for stand in presets::stands() {
                        println!("{:26} {}", stand.name, stand.caption);
                    }
                    return Ok(None);
                }
                Long("help") | Short('h') => {
                    println!("{HELP}");
                    return Ok(None);
                }
                other => return Err(other.unexpected().into()),
            }
        }
        Ok(Some(options))
    }
}
