//! From a skeleton to what is written: bark, leaves and levels of detail within a budget.

use crate::Failure;
use crate::failure::refused;
use crate::number::{Budget, Side, budget, number, side};
use clap::{Args, ValueEnum};
use std::f32::consts::TAU;
use treesynth::asset::{Asset, AssetBuilder, Impostor};
use treesynth::foliage::Leaves;
use treesynth::species::Specimen;
use treesynth::surface::blob::Skin;
use treesynth::surface::{Implicit, Material, Mesh, Part, Polygonizer, Sway, Tubes};
use treesynth::texture::Bark;
use treesynth::{Bounds, Skeleton};

/// Blocks of voxels of a skin at most.
const MOST_BLOCKS: usize = 20_000_000;
/// The finest voxels, over the reach of the skin.
const FINEST: f32 = 1.0 / 30_000.0;
/// Radius of the thinnest twig of a skin, in voxels.
const THINNEST: f32 = 0.867;
/// Triangles of a skin, about, where no detail was asked for and its twigs would need more.
const USUAL: f32 = 4e6;
/// Triangles for each voxel's side of a surface, about.
const PER_VOXEL: f32 = 2.5;
/// Triangles of each level over those of the one before.
const SHARE: f32 = 0.3;

/// Kinds of surfaces of branches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Surface {
    /// Tubes with collars, within the budget, with images
    Tubes,
    /// One closed mesh, for printers; without budget, levels, images and wind
    Closed,
    /// As closed, smooth at forks, with coloured scars and bark ridges that age
    Skin,
}

/// Options for the images and leaves of a tree.
#[derive(Args, Debug)]
pub(crate) struct Clothes {
    /// Triangles of bark, leaves and cards of the finest level, 100 to 100000000, or none: the dense model [default: 20000]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = budget)]
    pub(crate) budget: Option<Budget>,
    /// Levels of detail, 1 to 8, each of 0.3 of the triangles of the one before; several are followed by an impostor [default: 3]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number(1..=8_u32, "levels"))]
    pub(crate) levels: Option<u32>,
    /// Side of the images, a power of two, 128 to 8192 pixels, or none [default: 512]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = side)]
    pub(crate) textures: Option<Side>,
    /// Vertices that move in the wind: attributes, see docs/wind.md
    #[arg(long)]
    pub(crate) wind: bool,
    /// Surface of the branches
    #[arg(long, value_enum, default_value = "tubes", value_name = "KIND")]
    pub(crate) surface: Surface,
    /// Voxels per radius of the closed surface and the skin, 0.867 to 64 [default: 1, but a skin has voxels so large that it
    /// has some four million triangles at most; twigs thinner than these are thickened to them]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number(0.867..=64.0_f32, "voxels per radius"))]
    pub(crate) detail: Option<f32>,
}

/// The model that is written.
pub(crate) enum Model {
    /// The finest first; if there are several, the last is an impostor.
    Levels(Vec<Asset>),
    /// One closed mesh, and leaves.
    Closed(Box<Mesh>, Material, Vec<Leaves>),
}

impl Clothes {
    /// Refuses options that exclude each other.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        let given = [
            ("--budget", self.budget.is_some()),
            ("--levels", self.levels.is_some()),
            ("--textures", self.textures.is_some()),
            ("--wind", self.wind),
        ];
        match (self.surface, given.iter().find(|(_, is_given)| *is_given)) {
            (Surface::Closed | Surface::Skin, Some((name, _))) => {
                let surface = if self.surface == Surface::Skin { "skin" } else { "closed" };
                Err(refused(format!("{name} goes with --surface tubes, not with --surface {surface}")))
            }
            (Surface::Tubes, _) if self.detail.is_some() => {
                Err(refused("--detail goes with --surface closed and skin, not with --surface tubes"))
            }
            _ => Ok(()),
        }
    }

    fn triangles(&self) -> Option<usize> {
        self.budget.map_or(Some(20_000), |budget| budget.0)
    }

    fn side(&self) -> Option<u32> {
        self.textures.map_or(Some(512), |side| side.0)
    }

    fn shares(&self) -> Vec<f32> {
        std::iter::successors(Some(1.0), |share| Some(share * SHARE))
            .take(self.levels.unwrap_or(3) as usize)
            .collect()
    }

    fn closed(&self, skeleton: &Skeleton) -> Result<Box<Mesh>, Failure> {
        Ok(Box::new(Implicit::default().with_detail(self.detail.unwrap_or(1.0)).mesh(skeleton)?))
    }

    /// The closed mesh of a skeleton in a skin, with its colours; twigs thinner than a voxel are thickened to that.
    fn skin(&self, skeleton: &Skeleton, skin: &Skin, bark: Material) -> Result<Box<Mesh>, Failure> {
        let (radii, positions) = (skeleton.radii(), skeleton.positions());
        let thinnest = radii.iter().copied().filter(|&radius| radius > 0.0).fold(f32::INFINITY, f32::min);
        let thickest = radii.iter().copied().fold(0.0, f32::max);
        let size = Bounds::of(positions.iter().copied()).grown(2.0 * thickest).size();
        let least = size.length() * FINEST;
        let area = |voxel: f32| {
            let wide = |node: usize| TAU * radii[node].max(THINNEST * voxel);
            skeleton
                .edges()
                .map(|(node, parent)| wide(node) * positions[node].distance(positions[parent]))
                .sum::<f32>()
        };
        let detail = self.detail.unwrap_or(1.0);
        let mut voxel = (thinnest / detail).max(least);
        while self.detail.is_none() && PER_VOXEL * area(voxel) > USUAL * voxel * voxel {
            voxel *= 1.1;
        }
        let thick = radii.iter().map(|&radius| radius.max(THINNEST * voxel)).collect();
        let skin = skin.clone().with_bark(bark.color()).blob_tree(&skeleton.clone().with_radii(thick)?)?;
        let surface =
            Polygonizer::default().with_voxel(voxel).with_detail(detail).with_most_blocks(MOST_BLOCKS);
        Ok(Box::new(surface.mesh(&skin)?))
    }

    /// The one mesh of a surface that is closed, and leaves; `None` for tubes. The age is that of a
    /// [`Skin`].
    fn whole(
        &self,
        skeleton: &Skeleton,
        age: Option<f32>,
        bark: Material,
        leaves: impl FnOnce() -> Vec<Leaves>,
    ) -> Result<Option<Model>, Failure> {
        Ok(match self.surface {
            Surface::Tubes => None,
            Surface::Closed => Some(Model::Closed(self.closed(skeleton)?, bark, leaves())),
            Surface::Skin => {
                let skin = age.map_or_else(Skin::default, |age| Skin::default().with_age(age));
                // Its colours are absolute.
                Some(Model::Closed(self.skin(skeleton, &skin, bark)?, Material::white(), leaves()))
            }
        })
    }

    /// A species' tree.
    pub(crate) fn specimen(&self, tree: &Specimen) -> Result<Model, Failure> {
        let whole = self.whole(&tree.skeleton, None, tree.bark(), || tree.foliage().cloned().collect())?;
        if let Some(model) = whole {
            return Ok(model);
        }
        let Some(side) = self.side() else {
            let leaves: Vec<Leaves> = tree.foliage().cloned().collect();
            return self.dressed(&tree.skeleton, &leaves, tree.bark(), None);
        };
        let levels = if self.wind {
            tree.levels_in_wind(self.triangles(), side, &self.shares())?
        } else {
            tree.levels(self.triangles(), side, &self.shares())?
        };
        self.ended(levels, &tree.skeleton)
    }

    /// Any other tree, in bark of a colour or of images.
    pub(crate) fn dressed(
        &self,
        skeleton: &Skeleton,
        leaves: &[Leaves],
        bark: Material,
        images: Option<Bark>,
    ) -> Result<Model, Failure> {
        self.dressed_at(None, skeleton, leaves, bark, images)
    }

    /// As [`dressed`](Self::dressed), at an age of which the stages of the skeleton count the years.
    pub(crate) fn dressed_at(
        &self,
        age: Option<f32>,
        skeleton: &Skeleton,
        leaves: &[Leaves],
        bark: Material,
        images: Option<Bark>,
    ) -> Result<Model, Failure> {
        if let Some(model) = self.whole(skeleton, age, bark, || leaves.to_vec())? {
            return Ok(model);
        }
        let tubes = Tubes::default().with_square_tiles(true).with_wind(self.wind);
        let mut builder = AssetBuilder::default()
            .with_triangles(self.triangles())
            .with_bark(bark)
            .with_leaf_size(self.side().map(|side| (side / 4).clamp(32, 2048)))
            .with_texture_size(self.side().unwrap_or(512))
            .with_tubes(tubes);
        if let (Some(side), Some(images)) = (self.side(), images) {
            builder = builder.with_bark_of(&images.with_resolution(side))?;
        }
        let mut levels = builder.levels_with(skeleton, leaves, &self.shares())?;
        if self.wind {
            let sway = Sway::of(skeleton)?;
            levels = levels.iter().map(|level| level.in_wind(&sway)).collect::<Result<_, _>>()?;
        }
        self.ended(levels, skeleton)
    }

    /// Levels with an impostor behind them.
    fn ended(&self, mut levels: Vec<Asset>, skeleton: &Skeleton) -> Result<Model, Failure> {
        if levels.len() > 1 {
            // It is for trees that are less high than this many pixels.
            let side = self.side().unwrap_or(512).clamp(128, 256);
            let impostor = Impostor::default().with_texture_size(side).billboards(&levels[0].parts())?;
            levels.push(if self.wind { impostor.in_wind(&Sway::of(skeleton)?)? } else { impostor });
        }
        Ok(Model::Levels(levels))
    }
}

impl Model {
    /// Of a tree of which skeletons alone are written.
    pub(crate) fn none() -> Self {
        Self::Levels(Vec::new())
    }

    /// The parts of each level.
    pub(crate) fn levels(&self) -> Vec<Vec<Part<'_>>> {
        match self {
            Self::Levels(levels) => levels.iter().map(Asset::parts).collect(),
            Self::Closed(mesh, bark, leaves) => {
                let bark = Part::new(mesh).with_material(*bark);
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

/// Triangles of each level, all copies counted.
pub(crate) fn triangles(levels: &[Vec<Part<'_>>]) -> Vec<u64> {
    levels.iter().map(|level| level.iter().map(Part::triangles).sum()).collect()
}
