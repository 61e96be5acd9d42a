//! The command line.

use super::files::FORMATS;
use lexopt::prelude::{Long, Short, ValueExt};
use std::path::PathBuf;
use treesynth::presets::{self, Season, TYPICAL_NODES};

const HELP: &str = "\
Grows a tree and writes NAME.glb, NAME.png and NAME.json, or what --format says.

cargo run --release --example tree -- [OPTIONS]

  --preset NAME   one of --list                                [fine-oak]
  --list          the presets, one a line, and nothing else
  --seed N        the seed                                     [the preset's]
  --nodes N       nodes of the graph                           [150000]
  --season TIME   winter (no leaves), summer or autumn         [summer]
  --surface KIND  tubes, with collars, or implicit: one closed mesh  [tubes]
  --detail N      voxels a radius of the closed mesh, 0.867 to 64    [1]
  --levels N      levels of detail in the .glb (MSFT_lod), 1 to 8, of at most
                  half the triangles each; the finest is what else is written.
                  For tubes; more than one start at an error of 1 mm  [1]
  --format LIST   of glb, nodes.glb (leaves as nodes, for what knows no
                  instances), obj, ply, stl, svg, png, json, relaxed.json
                  (the skeleton of the surface)                [glb,png,json]
  --threads N     threads for the graph, at least 1            [all]
  --out DIR       where files go; made if it is not there      [out]
  --stats FILE    figures as JSON: sizes, milliseconds of each step, peak
                  memory, metrics
  --help          this text";

/// Which surface the branches get.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Surface {
    Tubes,
    Implicit,
}

/// What to grow and where to put it.
pub(crate) struct Options {
    pub(crate) preset: String,
    pub(crate) seed: Option<u64>,
    pub(crate) nodes: usize,
    pub(crate) season: Season,
    pub(crate) surface: Surface,
    pub(crate) detail: f32,
    pub(crate) levels: u32,
    pub(crate) formats: Vec<String>,
    pub(crate) threads: Option<usize>,
    pub(crate) out: PathBuf,
    pub(crate) stats: Option<PathBuf>,
}

impl Options {
    /// `None` when the user asked for a text, which has been printed.
    pub(crate) fn from_arguments() -> Result<Option<Self>, super::Failure> {
        let mut options = Self {
            preset: "fine-oak".into(),
            seed: None,
            nodes: TYPICAL_NODES,
            season: Season::Summer,
            surface: Surface::Tubes,
            detail: 1.0,
            levels: 1,
            formats: ["glb", "png", "json"].map(String::from).to_vec(),
            threads: None,
            out: "out".into(),
            stats: None,
        };
        let mut arguments = lexopt::Parser::from_env();
        while let Some(argument) = arguments.next()? {
            match argument {
                Long("preset") => options.preset = arguments.value()?.string()?,
                Long("seed") => options.seed = Some(arguments.value()?.parse()?),
                Long("nodes") => options.nodes = arguments.value()?.parse()?,
                Long("season") => options.season = season(&arguments.value()?.string()?)?,
                Long("surface") => options.surface = surface(&arguments.value()?.string()?)?,
                Long("detail") => options.detail = arguments.value()?.parse()?,
                Long("levels") => options.levels = levels(&arguments.value()?.string()?)?,
                Long("format") => {
                    options.formats = arguments.value()?.string()?.split(',').map(String::from).collect();
                    if let Some(other) = options.formats.iter().find(|f| !FORMATS.contains(&f.as_str())) {
                        let all = FORMATS.join(", ");
                        return Err(format!("--format has {other:?}, but must have some of {all}").into());
                    }
                }
                Long("threads") => {
                    let threads = arguments.value()?.parse()?;
                    if !(1..=1024).contains(&threads) {
                        return Err(format!("--threads is {threads}, but must be in [1, 1024]").into());
                    }
                    options.threads = Some(threads);
                }
                Long("out") => options.out = arguments.value()?.into(),
                Long("stats") => options.stats = Some(arguments.value()?.into()),
                Long("list") => {
                    for preset in presets::all() {
                        println!("{:26} {}", preset.name, preset.caption);
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
        if options.levels > 1 && matches!(options.surface, Surface::Implicit) {
            let levels = options.levels;
            return Err(format!("--levels is {levels}, but must be 1 with --surface implicit").into());
        }
        Ok(Some(options))
    }
}

fn surface(name: &str) -> Result<Surface, String> {
    match name {
        "tubes" => Ok(Surface::Tubes),
        "implicit" => Ok(Surface::Implicit),
        _ => Err(format!("--surface is {name:?}, but must be tubes or implicit")),
    }
}

fn levels(number: &str) -> Result<u32, String> {
    number
        .parse()
        .ok()
        .filter(|levels| (1..=8).contains(levels))
        .ok_or_else(|| format!("--levels is {number:?}, but must be in [1, 8]"))
}

fn season(name: &str) -> Result<Season, String> {
    match name {
        "winter" => Ok(Season::Winter),
        "summer" => Ok(Season::Summer),
        "autumn" => Ok(Season::Autumn),
        _ => Err(format!("--season is {name:?}, but must be winter, summer or autumn")),
    }
}
