//! The command line.

use super::common::{Failure, number, print, text};
use super::files::FORMATS;
use lexopt::prelude::{Long, Short};
use std::path::PathBuf;
use treesynth::presets::{self, Season, TYPICAL_NODES};
use treesynth::shape::UpAxis;

const HELP: &str = "\
Grows a tree and writes NAME.glb, NAME.png and NAME.json, or what --format says.

cargo run --release --example tree -- [OPTIONS]

  --preset NAME   one of --list                                [fine-oak]
  --list          the presets, one a line, and nothing else
  --seed N        the seed, 0 to 18446744073709551615          [the preset's]
  --nodes N       nodes of the graph, 100 to 200000000         [150000]
  --season TIME   winter (no leaves), summer or autumn         [summer]
  --surface KIND  tubes, with collars, or implicit: one closed mesh  [tubes]
  --detail N      voxels a radius of the closed mesh, 0.867 to 64    [1]
  --levels N      levels of detail in the .glb (MSFT_lod), 1 to 8, of at most
                  half the triangles each; the finest is what else is written.
                  For tubes; more than one start at an error of 1 mm  [1]
  --format LIST   of glb, nodes.glb (leaves as nodes, for what knows no
                  instances), obj, ply, stl, svg, png, json, relaxed.json
                  (the skeleton of the surface)                [glb,png,json]
  --up AXIS       y or z: what is up in .ply and .stl files    [y]
  --unit M        metres in a unit of .ply and .stl files, 0.000001 to 1000000;
                  0.001 for printers                           [1]
  --threads N     threads for the graph, 1 to 1024             [all]
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
    pub(crate) up: UpAxis,
    pub(crate) unit: f32,
    pub(crate) threads: Option<usize>,
    pub(crate) out: PathBuf,
    pub(crate) stats: Option<PathBuf>,
}

impl Options {
    /// `None` when the user asked for a text, which has been printed.
    pub(crate) fn from_arguments() -> Result<Option<Self>, Failure> {
        let mut options = Self {
            preset: "fine-oak".into(),
            seed: None,
            nodes: TYPICAL_NODES,
            season: Season::Summer,
            surface: Surface::Tubes,
            detail: 1.0,
            levels: 1,
            formats: ["glb", "png", "json"].map(String::from).to_vec(),
            up: UpAxis::Y,
            unit: 1.0,
            threads: None,
            out: "out".into(),
            stats: None,
        };
        let mut arguments = lexopt::Parser::from_env();
        while let Some(argument) = arguments.next()? {
            match argument {
                Long("preset") => options.preset = text(&mut arguments, "--preset")?,
                Long("seed") => options.seed = Some(number(&mut arguments, "--seed", 0..=u64::MAX, "")?),
                Long("nodes") => {
                    options.nodes =
                        number(&mut arguments, "--nodes", 100..=200_000_000, "nodes of the graph")?;
                }
                Long("season") => options.season = season(&text(&mut arguments, "--season")?)?,
                Long("surface") => options.surface = surface(&text(&mut arguments, "--surface")?)?,
                Long("detail") => {
                    options.detail = number(&mut arguments, "--detail", 0.867..=64.0, "voxels a radius")?;
                }
                Long("levels") => options.levels = number(&mut arguments, "--levels", 1..=8, "levels")?,
                Long("format") => {
                    options.formats =
                        text(&mut arguments, "--format")?.split(',').map(String::from).collect();
                    if let Some(other) = options.formats.iter().find(|f| !FORMATS.contains(&f.as_str())) {
                        let all = FORMATS.join(", ");
                        return Err(format!("--format has {other:?}, but must have some of {all}").into());
                    }
                }
                Long("threads") => {
                    options.threads = Some(number(&mut arguments, "--threads", 1..=1024, "threads")?);
                }
                Long("up") => options.up = up(&text(&mut arguments, "--up")?)?,
                Long("unit") => options.unit = number(&mut arguments, "--unit", 1e-6..=1e6, "metres")?,
                Long("out") => options.out = arguments.value()?.into(),
                Long("stats") => options.stats = Some(text(&mut arguments, "--stats")?.into()),
                Long("list") => {
                    print(presets::all().map(|preset| format!("{:26} {}", preset.name, preset.caption)));
                    return Ok(None);
                }
                Long("help") | Short('h') => {
                    print([HELP]);
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

fn up(name: &str) -> Result<UpAxis, String> {
    match name {
        "y" | "Y" => Ok(UpAxis::Y),
        "z" | "Z" => Ok(UpAxis::Z),
        _ => Err(format!("--up is {name:?}, but must be y or z")),
    }
}

fn season(name: &str) -> Result<Season, String> {
    match name {
        "winter" => Ok(Season::Winter),
        "summer" => Ok(Season::Summer),
        "autumn" => Ok(Season::Autumn),
        _ => Err(format!("--season is {name:?}, but must be winter, summer or autumn")),
    }
}
