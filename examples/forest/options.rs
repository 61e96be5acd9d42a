//! The command line.

use lexopt::prelude::{Long, Short, ValueExt};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use treesynth::presets;

const HELP: &str = "\
Grows a stand season by season and writes NAME.glb, NAME.png and NAME.apng.

cargo run --release --example forest -- [OPTIONS]

  --preset NAME   one of --list                                [stand-generations]
  --list          the presets, one a line, and nothing else
  --seed N        the seed                                     [the preset's]
  --seasons N     how long it grows, 1 to 200                  [the preset's]
  --metamers N    the most metamers, 1 to 5000000              [300000]
  --size N        pixels of the animation's sides, 16 to 4096  [320]
  --out DIR       where files go; made if it is not there      [out]
  --help          this text";

/// A number in `range`; a failure names the option.
fn number(option: &str, value: &std::ffi::OsStr, range: RangeInclusive<u32>) -> Result<u32, super::Failure> {
    let parsed = value.to_str().and_then(|text| text.parse().ok());
    let found = parsed.filter(|number| range.contains(number));
    let (value, least, most) = (value.to_string_lossy(), range.start(), range.end());
    found.ok_or_else(|| format!("{option} is {value}, but must be {least} to {most}").into())
}

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
    pub(crate) fn from_arguments() -> Result<Option<Self>, super::Failure> {
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
                Long("preset") => options.preset = arguments.value()?.string()?,
                Long("seed") => options.seed = Some(arguments.value()?.parse()?),
                Long("seasons") => {
                    options.seasons = Some(number("--seasons", &arguments.value()?, 1..=200)?);
                }
                Long("metamers") => {
                    options.metamers = number("--metamers", &arguments.value()?, 1..=5_000_000)? as usize;
                }
                Long("size") => options.size = number("--size", &arguments.value()?, 16..=4096)?,
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
