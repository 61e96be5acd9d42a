//! The tree as it is written: within a budget of triangles, in levels of detail, in its bark.

use super::common::Failure;
use super::options::{Options, Surface};
use treesynth::Skeleton;
use treesynth::asset::{Asset, AssetBuilder, Impostor};
use treesynth::foliage::{Foliage, Leaves};
use treesynth::presets::Preset;
use treesynth::surface::{Implicit, Mesh, Part, Sway, Tubes};

/// Triangles of each level over those of the one before.
const SHARE: f32 = 0.3;

/// What is written.
pub(crate) enum Model {
    /// The finest first; if there are several, the last is an impostor.
    Levels(Vec<Asset>),
    /// One closed mesh, and leaves.
    Closed(Box<Mesh>, Vec<Leaves>),
}

impl Model {
    pub(crate) fn new(
        options: &Options,
        preset: &Preset,
        skeleton: &Skeleton,
        seed: u64,
    ) -> Result<Self, Failure> {
        let leaves = preset
            .foliage(options.season)
            .map(|foliage: Foliage| foliage.place(skeleton, seed))
            .transpose()?;
        if let Surface::Implicit = options.surface {
            let mesh = Implicit::default().with_detail(options.detail).mesh(skeleton)?;
            return Ok(Self::Closed(Box::new(mesh), leaves.into_iter().collect()));
        }
        let tubes = Tubes::default().with_square_tiles(true).with_wind(options.wind);
        let mut builder = AssetBuilder::default()
            .with_triangles(options.budget)
            .with_bark(preset.bark())
            .with_leaf_size(options.textures.map(|side| (side / 4).clamp(32, 2048)))
            .with_texture_size(options.textures.unwrap_or(512).max(128))
            .with_tubes(tubes);
        if let Some(side) = options.textures {
            builder = builder.with_bark_of(&preset.bark_texture().with_seed(seed).with_resolution(side))?;
        }
        let shares: Vec<f32> = std::iter::successors(Some(1.0), |share| Some(share * SHARE))
            .take(options.levels as usize)
            .collect();
        let mut levels = builder.levels_with(skeleton, leaves.as_slice(), &shares)?;
        if options.levels > 1 {
            // It is for trees that are less high than this many pixels.
            let side = options.textures.unwrap_or(512).clamp(128, 256);
            levels.push(Impostor::default().with_texture_size(side).billboards(&levels[0].parts())?);
        }
        if options.wind {
            let sway = Sway::of(skeleton)?;
            levels = levels.iter().map(|level| level.in_wind(&sway)).collect::<Result<_, _>>()?;
        }
        Ok(Self::Levels(levels))
    }

    /// The parts of each level.
    pub(crate) fn levels(&self, preset: &Preset) -> Vec<Vec<Part<'_>>> {
        match self {
            Self::Levels(levels) => levels.iter().map(Asset::parts).collect(),
            Self::Closed(mesh, leaves) => {
                let bark = Part::new(mesh).with_material(preset.bark());
                vec![[bark].into_iter().chain(leaves.iter().map(Leaves::part)).collect()]
            }
        }
    }

    /// Down to which part of the screen's height each level of a tree of this height is shown, if they can be told apart.
    pub(crate) fn coverages(&self, height: f32) -> Vec<f32> {
        let Self::Levels(levels) = self else { return Vec::new() };
        Asset::screen_coverages(levels, height)
    }
}

/// Triangles of a level, all copies counted.
pub(crate) fn triangles(level: &[Part<'_>]) -> u64 {
    level.iter().map(Part::triangles).sum()
}
