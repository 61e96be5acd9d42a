//! One tree, asked for as JSON and answered as a file.

use serde::Deserialize;
use serde_json::{Value, json};
use std::error::Error;
use std::ops::ControlFlow;
use treesynth::asset::{Asset, AssetBuilder};
use treesynth::export::{self, GlbOptions, UsdStage};
use treesynth::foliage::Leaves;
use treesynth::guided::Search;
use treesynth::presets::{self, Found, Preset, Season};
use treesynth::species::Species;
use treesynth::surface::{Material, Mesh, Part, Sway, Tubes};
use treesynth::{Metrics, Observer, Skeleton, Work};

/// A request for a tree; fields that are left out have the default.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Ask {
    /// A species or a preset of the guided system.
    pub tree: String,
    pub seed: u64,
    /// Of species; metres and years.
    pub height: Option<f32>,
    pub age: Option<f32>,
    pub dbh: Option<f32>,
    pub spacing: Option<f32>,
    pub day: Option<f32>,
    pub dead: Option<f32>,
    pub storm: Option<f32>,
    /// Of presets: nodes of the graph; winter, summer or autumn.
    pub nodes: usize,
    pub season: String,
    /// Triangles, side of images in pixels, attributes for wind.
    pub budget: usize,
    pub textures: u32,
    pub wind: bool,
    /// Soon there rather than fine: thin tubes without images, and fewer, larger leaves. A file of glb alone.
    pub preview: bool,
    /// glb, usdz or json.
    pub format: String,
}

impl Default for Ask {
    fn default() -> Self {
        Self {
            tree: "English oak".into(),
            seed: 0,
            height: None,
            age: None,
            dbh: None,
            spacing: None,
            day: None,
            dead: None,
            storm: None,
            nodes: 20_000,
            season: "summer".into(),
            budget: 20_000,
            textures: 256,
            wind: false,
            preview: false,
            format: "glb".into(),
        }
    }
}

/// A file, and what is to be said of the tree.
#[derive(Debug, Clone)]
pub struct Answer {
    pub file: Vec<u8>,
    pub report: Value,
}

/// Told how much of the work is done, 0 to 1, and what is being done.
pub type Progress<'a> = &'a (dyn Fn(f32, &str) + Sync);

/// Reads what is asked for, and grows it.
///
/// # Errors
/// A text that is not what [`Ask`] is; a tree that cannot be had, with the range.
pub fn answer(text: &str, progress: Progress<'_>) -> Result<Answer, Box<dyn Error>> {
    let ask: Ask = serde_json::from_str(text)?;
    if !["glb", "usdz", "json"].contains(&ask.format.as_str()) {
        return Err(format!("format is {:?}, but must be glb, usdz or json", ask.format).into());
    }
    let tree = match presets::by_name(&ask.tree)? {
        Found::Species(species) => of_species(&ask, species, progress)?,
        Found::Guided(preset) => of_preset(&ask, preset, progress)?,
        other => return Err(format!("{:?} is neither a species nor a guided preset", other.name()).into()),
    };
    progress(0.95, "file");
    let mut file = Vec::new();
    if ask.format == "json" {
        export::write_skeleton(&tree.skeleton, &mut file)?;
    }
    let parts = tree.look.parts();
    let triangles: u64 = parts.iter().map(Part::triangles).sum();
    match ask.format.as_str() {
        "json" => {}
        "usdz" => export::write_usdz(&UsdStage::of_parts(&parts).with_name(tree.name), &mut file)?,
        _ => export::write_glb_parts(&parts, &GlbOptions::default().with_name(tree.name), &mut file)?,
    }
    let metrics = Metrics::of(&tree.skeleton);
    let report = json!({
        "name": tree.name,
        "height": metrics.height,
        "width": metrics.crown_width,
        "dbh": metrics.breast_height_diameter,
        "age": tree.age,
        "branches": metrics.branches,
        "leaves": tree.leaves,
        "triangles": triangles,
        "bytes": file.len(),
    });
    Ok(Answer { file, report })
}

struct Tree<'a> {
    name: &'a str,
    skeleton: Skeleton,
    look: Look,
    leaves: usize,
    age: Option<f32>,
}

/// The look of the tree.
enum Look {
    Asset(Box<Asset>),
    Preview(Box<Mesh>, Material, Vec<Leaves>),
    /// The skeleton alone is asked for.
    Nothing,
}

impl Look {
    fn parts(&self) -> Vec<Part<'_>> {
        match self {
            Self::Asset(asset) => asset.parts(),
            Self::Preview(bark, material, leaves) => {
                let bark = Part::new(bark).with_material(*material);
                [bark].into_iter().chain(leaves.iter().map(Leaves::part)).collect()
            }
            Self::Nothing => Vec::new(),
        }
    }
}

/// Leaves of a preview at the most.
const PREVIEW: usize = 4_000;

fn preview<'a>(bark: Mesh, material: Material, leaves: impl Iterator<Item = &'a Leaves>) -> Look {
    let all: Vec<&Leaves> = leaves.collect();
    let count: usize = all.iter().map(|leaves| leaves.instances.len()).sum();
    let step = count.div_ceil(PREVIEW).max(1);
    // As much leaf area as all have.
    let larger = (step as f32).sqrt();
    let few = all.into_iter().map(|leaves| {
        let mut few = leaves.clone();
        few.instances = leaves.instances.iter().step_by(step).copied().collect();
        few.instances.iter_mut().for_each(|leaf| leaf.scale *= larger);
        few
    });
    Look::Preview(Box::new(bark), material, few.filter(|leaves| !leaves.instances.is_empty()).collect())
}

/// Error of a preview's tubes, as a share of the tree's height: a pixel or two of the page.
const PREVIEW_ERROR: f32 = 0.002;

/// Tubes of few triangles for a tree of some height, metres.
fn coarse(height: f32) -> Tubes {
    Tubes::default().with_error((PREVIEW_ERROR * height).max(1e-4)).with_collars(false).with_root_flare(0.0)
}

fn of_species<'a>(
    ask: &Ask,
    species: &'a Species,
    progress: Progress<'_>,
) -> Result<Tree<'a>, Box<dyn Error>> {
    let mut request = species.request().with_seed(ask.seed);
    if let Some(height) = ask.height {
        request = request.with_height(height);
    }
    if let Some(dbh) = ask.dbh {
        request = request.with_dbh(dbh);
    }
    if let Some(age) = ask.age {
        request = request.with_age(age);
    }
    if let Some(spacing) = ask.spacing {
        request = request.in_a_stand(spacing);
    }
    if let Some(day) = ask.day {
        request = request.with_day(day);
    }
    if let Some(years) = ask.dead {
        request = request.with_years_dead(years);
    }
    if let Some(part) = ask.storm {
        request = request.with_storm_damage(part);
    }
    progress(0.05, "branches");
    let tree = request.grow()?;
    progress(0.5, "bark and leaves");
    let look = if ask.format == "json" {
        Look::Nothing
    } else if ask.preview {
        preview(tree.bark_mesh(&coarse(tree.numbers.height))?, Material::white(), tree.foliage())
    } else {
        let mut levels = match ask.wind {
            true => tree.levels_in_wind(Some(ask.budget), ask.textures, &[1.0])?,
            false => tree.levels(Some(ask.budget), ask.textures, &[1.0])?,
        };
        Look::Asset(Box::new(levels.pop().ok_or("no level")?))
    };
    let leaves = tree.leaves.as_ref().map_or(0, |leaves| leaves.instances.len());
    Ok(Tree { name: &species.name, look, leaves, age: Some(tree.numbers.age), skeleton: tree.skeleton })
}

/// Makes one number of the progress of graph, stages and radii.
struct Watch<'a>(Progress<'a>);

impl Observer for Watch<'_> {
    fn report(&self, progress: treesynth::Progress) -> ControlFlow<()> {
        let (from, to, what) = match progress.work {
            Work::Nodes => (0.0, 0.2, "nodes"),
            Work::Edges => (0.2, 0.4, "edges"),
            Work::Stage { index, of } => {
                let part = |i: usize| 0.4 + 0.2 * i as f32 / of as f32;
                (part(index), part(index + 1), "branches")
            }
            _ => (0.6, 0.65, "radii"),
        };
        (self.0)(from + (to - from) * progress.fraction, what);
        ControlFlow::Continue(())
    }
}

fn of_preset(
    ask: &Ask,
    preset: &'static Preset,
    progress: Progress<'_>,
) -> Result<Tree<'static>, Box<dyn Error>> {
    if !(100..=200_000).contains(&ask.nodes) {
        return Err(format!("nodes is {}, but must be 100 to 200000", ask.nodes).into());
    }
    let season = match ask.season.as_str() {
        "winter" => Season::Winter,
        "summer" => Season::Summer,
        "autumn" => Season::Autumn,
        other => return Err(format!("season is {other:?}, but must be winter, summer or autumn").into()),
    };
    let synth = preset.synth(ask.nodes);
    let watch = Watch(progress);
    let graph = synth.build_graph(ask.seed, &watch)?;
    let skeleton = synth.grow(&mut Search::new(&graph), ask.seed, &watch)?.skeleton.relaxed(0.5, 3)?;
    progress(0.65, "bark and leaves");
    let leaves = preset.foliage(season).map(|foliage| foliage.place(&skeleton, ask.seed)).transpose()?;
    let look = if ask.format == "json" {
        Look::Nothing
    } else if ask.preview {
        preview(
            coarse(treesynth::metrics::height(&skeleton) as f32).mesh(&skeleton)?,
            preset.bark(),
            leaves.iter(),
        )
    } else {
        Look::Asset(Box::new(preset_asset(ask, preset, &skeleton, leaves.as_slice())?))
    };
    let leaves = leaves.as_ref().map_or(0, |leaves: &Leaves| leaves.instances.len());
    Ok(Tree { name: preset.name, skeleton, look, leaves, age: None })
}

fn preset_asset(
    ask: &Ask,
    preset: &'static Preset,
    skeleton: &Skeleton,
    leaves: &[Leaves],
) -> Result<Asset, Box<dyn Error>> {
    let bark = preset.bark_texture().with_seed(ask.seed).with_resolution(ask.textures);
    let builder = AssetBuilder::default()
        .with_triangles(Some(ask.budget))
        .with_bark(preset.bark())
        .with_leaf_size(Some((ask.textures / 4).clamp(32, 2048)))
        .with_texture_size(ask.textures)
        .with_tubes(Tubes::default().with_square_tiles(true).with_wind(ask.wind))
        .with_bark_of(&bark)?;
    let asset = builder.levels_with(skeleton, leaves, &[1.0])?.pop().ok_or("no level")?;
    Ok(if ask.wind { asset.in_wind(&Sway::of(skeleton)?)? } else { asset })
}
