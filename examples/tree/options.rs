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
  --budget N      triangles of bark, leaves and cards together, 100 to 100000000,
                  or none: the dense model                     [20000]
  --levels N      levels of detail in the .glb, 1 to 8, each of 0.3 of the
                  triangles of the one before; several are followed by an
                  impostor. The finest is what else is written  [3]
  --lod-names     levels as nodes named NAME_LOD0 and so on, not by MSFT_lod
  --textures N    side of the bark's images, pixels: a power of two, 128 to
                  8192, or none                                [512]
  --quantize      vertices of the .glb are rounded: a third smaller, for
                  readers that know KHR_mesh_quantization
  --wind          vertices move in the wind: attributes, see docs/wind.md
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
    pub(crate) budget: Option<usize>,
    pub(crate) levels: u32,
    pub(crate) named: bool,
    pub(crate) textures: Option<u32>,
    pub(crate) quantize: bool,
    pub(crate) wind: bool,
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
            budget: Some(20_000),
            levels: 3,
            named: false,
            textures: Some(512),
            quantize: false,
            wind: false,
            formats: ["glb", "png", "json"].map(String::from).to_vec(),
            up: UpAxis::Y,
            unit: 1.0,
            threads: None,
            out: "out".into(),
            stats: None,
        };
        let mut asked = Vec::new();
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
                Long("budget") => {
                    options.budget = or_none(&text(&mut arguments, "--budget")?, "--budget", |text| {
                        text.parse().ok().filter(|triangles| (100..=100_000_000).contains(triangles))
                    })
                    .map_err(|error| format!("{error} 100 to 100000000 triangles or none"))?;
                    asked.push("--budget");
                }
                Long("levels") => {
                    options.levels = number(&mut arguments, "--levels", 1..=8, "levels")?;
                    asked.push("--levels");
                }
                Long("lod-names") => options.named = true,
                Long("quantize") => options.quantize = true,
                Long("textures") => {
                    options.textures = or_none(&text(&mut arguments, "--textures")?, "--textures", |text| {
                        text.parse()
                            .ok()
                            .filter(|side: &u32| side.is_power_of_two() && (128..=8192).contains(side))
                    })
                    .map_err(|error| format!("{error} a power of two, 128 to 8192 pixels, or none"))?;
                    asked.push("--textures");
                }
                Long("wind") => {
                    options.wind = true;
                    asked.push("--wind");
                }
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
                    print(presets::guided().map(|preset| format!("{:26} {}", preset.name, preset.caption)));
                    return Ok(None);
                }
                Long("help") | Short('h') => {
                    print([HELP]);
                    return Ok(None);
                }
                other => return Err(other.unexpected().into()),
            }
        }
        if let (Surface::Implicit, Some(option)) = (options.surface, asked.first()) {
            return Err(format!("{option} goes with --surface tubes alone, not with implicit").into());
        }
        Ok(Some(options))
    }
}

/// A number, or nothing by the word `none`; an error names the option and what it is.
fn or_none<T>(text: &str, option: &str, number: impl Fn(&str) -> Option<T>) -> Result<Option<T>, String> {
    match text {
        "none" => Ok(None),
        _ => number(text).map(Some).ok_or_else(|| format!("{option} is {text:?}, but must be")),
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
