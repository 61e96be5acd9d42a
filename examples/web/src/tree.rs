//! Trees of all systems that the page has, as they look.

use crate::ask::{Ask, Progress};
use crate::preview::{self, Piece};
use serde_json::json;
use std::error::Error;
use std::ops::ControlFlow;
use std::sync::Mutex;
use treesynth::asset::{Asset, AssetBuilder, Impostor};
use treesynth::foliage::Leaves;
use treesynth::growth::Growth;
use treesynth::guided::Search;
use treesynth::presets::{Grown, Preset, Season};
use treesynth::species::{Request, Species};
use treesynth::surface::{Material, Part, Sway, Tubes};
use treesynth::texture::Bark;
use treesynth::{Observer, Skeleton, Work};

/// Triangles of the levels over those of the finest; the last one is of images that cross.
const SHARES: [f32; 3] = [1.0, 0.3, 0.08];

/// Least side of the images that cross, pixels.
const IMPOSTOR: u32 = 256;

pub struct Tree<'a> {
    pub name: &'a str,
    pub skeleton: Skeleton,
    pub look: Look,
    pub leaves: usize,
    pub age: Option<f32>,
    /// What it was grown by, as JSON.
    pub recipe: String,
}

/// The look of a tree.
pub enum Look {
    /// Levels of detail, as many as are needed: the finest first.
    Levels(Vec<Asset>),
    Preview(Vec<Piece>),
    /// The skeleton or the recipe alone is asked for.
    Nothing,
}

impl Look {
    /// A level of detail; the last one if there are fewer.
    pub fn parts(&self, level: usize) -> Vec<Part<'_>> {
        let levels = self.levels();
        levels.get(level).or(levels.last()).map(Asset::parts).unwrap_or_default()
    }

    pub fn levels(&self) -> &[Asset] {
        if let Self::Levels(levels) = self { levels } else { &[] }
    }

    /// Triangles of a level.
    pub fn triangles(&self, level: usize) -> u64 {
        match self {
            Self::Preview(pieces) => pieces.iter().map(Piece::triangles).sum(),
            _ => self.parts(level).iter().map(Part::triangles).sum(),
        }
    }
}

impl Ask {
    fn has_look(&self) -> bool {
        self.preview > 0 || !matches!(self.format.as_str(), "json" | "recipe")
    }

    /// Shares of the levels that are needed.
    fn shares(&self) -> &'static [f32] {
        if self.format == "levels" || self.level > 0 { &SHARES } else { &SHARES[..1] }
    }

    /// With images that cross, if they are needed.
    fn with_impostor(&self, mut levels: Vec<Asset>) -> Result<Look, Box<dyn Error>> {
        if self.format == "levels" || self.level >= SHARES.len() {
            let finest = levels.first().ok_or("no level")?;
            let far = Impostor::default()
                .with_texture_size(self.textures.max(IMPOSTOR))
                .billboards(&finest.parts())?;
            levels.push(far);
        }
        Ok(Look::Levels(levels))
    }
}

impl<'a> Tree<'a> {
    pub fn of_species(
        ask: &Ask,
        species: &'a Species,
        progress: Progress<'_>,
    ) -> Result<Self, Box<dyn Error>> {
        progress(0.05, "branches");
        let request = requested(ask, species);
        let recipe = serde_json::to_string_pretty(&request)?;
        let tree = if ask.preview > 0 { preview::grow(ask, species)? } else { request.grow()? };
        progress(0.5, "bark and leaves");
        let look = if ask.preview > 0 {
            let bark = tree.bark_mesh(&preview::tubes(tree.numbers.height))?;
            Look::Preview(preview::pieces(ask.preview, bark, Material::white(), tree.foliage()))
        } else if ask.has_look() {
            let (budget, side) = (Some(ask.budget), ask.textures);
            ask.with_impostor(match ask.wind {
                true => tree.levels_in_wind(budget, side, ask.shares())?,
                false => tree.levels(budget, side, ask.shares())?,
            })?
        } else {
            Look::Nothing
        };
        let leaves = tree.leaves.as_ref().map_or(0, |leaves| leaves.instances.len());
        let age = Some(tree.numbers.age);
        Ok(Self { name: &species.name, look, leaves, age, skeleton: tree.skeleton, recipe })
    }

    pub fn of_guided(
        ask: &Ask,
        preset: &'static Preset,
        progress: Progress<'_>,
    ) -> Result<Self, Box<dyn Error>> {
        if !(100..=200_000).contains(&ask.nodes) {
            return Err(format!("nodes is {}, but must be 100 to 200000", ask.nodes).into());
        }
        let season = match ask.season.as_str() {
            "winter" => Season::Winter,
            "summer" => Season::Summer,
            "autumn" => Season::Autumn,
            other => {
                return Err(format!("season is {other:?}, but must be winter, summer or autumn").into());
            }
        };
        let recipe = preset.recipe(ask.nodes).with_seed(ask.seed).to_json()?;
        let synth = preset.synth(ask.nodes);
        let watch = Watch(progress);
        let graph = synth.build_graph(ask.seed, &watch)?;
        let skeleton = synth.grow(&mut Search::new(&graph), ask.seed, &watch)?.skeleton.relaxed(0.5, 3)?;
        progress(0.65, "bark and leaves");
        let leaves = preset.foliage(season).map(|foliage| foliage.place(&skeleton, ask.seed)).transpose()?;
        let look = dressed(ask, &skeleton, leaves.as_slice(), preset.bark(), &preset.bark_texture())?;
        let leaves = leaves.as_ref().map_or(0, |leaves: &Leaves| leaves.instances.len());
        Ok(Self { name: preset.name, skeleton, look, leaves, age: None, recipe })
    }

    pub fn of_years(
        ask: &Ask,
        preset: &'static Grown,
        progress: Progress<'_>,
    ) -> Result<Self, Box<dyn Error>> {
        progress(0.05, "branches");
        let growth = growth(preset, ask.seed)?;
        let oldest = f32::from(growth.years());
        let age = ask.age.unwrap_or(0.5 * oldest);
        let tree = growth.at(age)?;
        if tree.skeleton.segments() == 0 {
            return Err(format!("age is {age} years, but must be more: nothing has sprouted then").into());
        }
        let recipe = json!({ "architecture": growth.architecture(), "seed": ask.seed, "age": age });
        keep(preset, ask.seed, growth);
        progress(0.4, "bark and leaves");
        let leaves = preset.leaves(&tree);
        let look = dressed(ask, &tree.skeleton, &leaves, preset.bark(), &preset.bark_texture())?;
        let count = leaves.iter().map(|leaves| leaves.instances.len()).sum();
        let recipe = serde_json::to_string_pretty(&recipe)?;
        Ok(Self { name: preset.name, skeleton: tree.skeleton, look, leaves: count, age: Some(age), recipe })
    }
}

/// The tree of the last request that grew over the years: while its age moves, it is the same one.
static KEPT: Mutex<Option<(&str, u64, Growth)>> = Mutex::new(None);

fn growth(preset: &'static Grown, seed: u64) -> Result<Growth, Box<dyn Error>> {
    let kept = KEPT.lock().ok().and_then(|mut kept| kept.take());
    match kept {
        Some((name, of, growth)) if name == preset.name && of == seed => Ok(growth),
        _ => Ok(preset.grow(seed)?),
    }
}

fn keep(preset: &'static Grown, seed: u64, growth: Growth) {
    if let Ok(mut kept) = KEPT.lock() {
        *kept = Some((preset.name, seed, growth));
    }
}

/// The species' tree of a request.
pub fn requested<'a>(ask: &Ask, species: &'a Species) -> Request<'a> {
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
    request
}

/// The look of a tree that is no species.
fn dressed(
    ask: &Ask,
    skeleton: &Skeleton,
    leaves: &[Leaves],
    material: Material,
    bark: &Bark,
) -> Result<Look, Box<dyn Error>> {
    if ask.preview > 0 {
        let height = treesynth::metrics::height(skeleton) as f32;
        let bark = preview::tubes(height).mesh(skeleton)?;
        return Ok(Look::Preview(preview::pieces(ask.preview, bark, material, leaves.iter())));
    }
    if !ask.has_look() {
        return Ok(Look::Nothing);
    }
    let bark = bark.clone().with_seed(ask.seed).with_resolution(ask.textures);
    let builder = AssetBuilder::default()
        .with_triangles(Some(ask.budget))
        .with_bark(material)
        .with_leaf_size(Some((ask.textures / 4).clamp(32, 2048)))
        .with_texture_size(ask.textures)
        .with_tubes(Tubes::default().with_square_tiles(true).with_wind(ask.wind))
        .with_bark_of(&bark)?;
    let mut levels = builder.levels_with(skeleton, leaves, ask.shares())?;
    if ask.wind {
        let sway = Sway::of(skeleton)?;
        levels = levels.iter().map(|level| level.in_wind(&sway)).collect::<Result<_, _>>()?;
    }
    ask.with_impostor(levels)
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
