//! One tree, asked for as JSON and answered as a file.

use crate::tree::Tree;
use crate::{file, preview};
use serde::Deserialize;
use serde_json::{Value, json};
use std::error::Error;
use treesynth::glam::Vec3;
use treesynth::presets::{self, Found};
use treesynth::{Metrics, Skeleton};

/// A request for a tree; fields that are left out have the default.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Ask {
    /// A species, a preset of the guided system, or a tree that grows over the years.
    pub tree: String,
    pub seed: u64,
    /// Of species; metres and years. The age is of trees that grow over the years too.
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
    /// Level of detail: 0 the finest, 1 and 2 coarser ones, 3 crossed images.
    pub level: usize,
    /// Nodes, about, of a species' tree that is to be soon there rather than fine; 0 for the tree itself. A preview is no file but
    /// arrays for the page, see `preview.rs`; the format is not looked at.
    pub preview: usize,
    /// glb, levels (a glb with all levels), obj, usdz, json or recipe.
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
            level: 0,
            preview: 0,
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

/// Levels of detail that a tree has.
pub const LEVELS: usize = 4;

/// Reads what is asked for, and grows it.
///
/// # Errors
/// A text that is not what [`Ask`] is; a tree that cannot be had, with the range.
pub fn answer(text: &str, progress: Progress<'_>) -> Result<Answer, Box<dyn Error>> {
    let ask: Ask = serde_json::from_str(text)?;
    if !file::FORMATS.contains(&ask.format.as_str()) {
        return Err(
            format!("format is {:?}, but must be one of {}", ask.format, file::FORMATS.join(", ")).into()
        );
    }
    if ask.preview != 0 && !preview::NODES.contains(&ask.preview) {
        let (least, most) = (preview::NODES.start(), preview::NODES.end());
        return Err(format!("preview is {}, but must be 0 or {least} to {most}", ask.preview).into());
    }
    if ask.level >= LEVELS {
        return Err(format!("level is {}, but must be 0 to {}", ask.level, LEVELS - 1).into());
    }
    let tree = match presets::by_name(&ask.tree)? {
        Found::Species(species) => Tree::of_species(&ask, species, progress)?,
        Found::Guided(preset) => Tree::of_guided(&ask, preset, progress)?,
        Found::Grown(preset) => Tree::of_years(&ask, preset, progress)?,
        other => return Err(format!("{:?} is not a tree that this page has", other.name()).into()),
    };
    progress(0.95, "file");
    let written = file::write(&ask, &tree)?;
    // Branches are not counted for a preview: nobody reads their number while a slider moves.
    let metrics = (ask.preview == 0).then(|| Metrics::of(&tree.skeleton));
    let [height, width] = size(&tree.skeleton);
    let report = json!({
        "name": tree.name,
        "height": height,
        "width": metrics.as_ref().map_or(f64::from(width), |metrics| metrics.crown_width),
        "dbh": metrics.as_ref().map(|metrics| metrics.breast_height_diameter),
        "age": tree.age,
        "nodes": tree.skeleton.len(),
        "branches": metrics.as_ref().map(|metrics| metrics.branches),
        "leaves": tree.leaves,
        "triangles": tree.look.triangles(ask.level),
        "bytes": written.bytes.len(),
        // Of formats of several files: each with its length, in the order in which they follow one another.
        "files": written.files.iter().map(|(name, length)| json!([name, length])).collect::<Vec<_>>(),
    });
    Ok(Answer { file: written.bytes, report })
}

/// Height, and mean width along two axes, of all nodes; metres.
fn size(skeleton: &Skeleton) -> [f32; 2] {
    let places = skeleton.positions();
    let low = places.iter().copied().reduce(Vec3::min).unwrap_or_default();
    let high = places.iter().copied().reduce(Vec3::max).unwrap_or_default();
    let Vec3 { x, z, .. } = high - low;
    [high.y - places.first().map_or(0.0, |root| root.y), 0.5 * (x + z)]
}
