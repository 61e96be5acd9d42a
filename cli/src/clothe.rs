//! From a skeleton to what is written: bark, leaves and levels of detail within a budget.

use crate::Failure;
use crate::failure::refused;
use crate::number::{Budget, Side, budget, number, side};
use clap::{Args, ValueEnum};
use treesynth::Skeleton;
use treesynth::asset::{Asset, AssetBuilder, Impostor};
use treesynth::foliage::Leaves;
use treesynth::species::Specimen;
use treesynth::surface::{Implicit, Material, Mesh, Part, Sway, Tubes};
use treesynth::texture::Bark;

/// Triangles of each level over those of the one before.
const SHARE: f32 = 0.3;

/// Kinds of surfaces of branches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Surface {
    /// Tubes with collars, within the budget, with images
    Tubes,
    /// One closed mesh, for printers; without budget, levels, images and wind
    Closed,
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
    /// Voxels per radius of the closed surface, 0.867 to 64 [default: 1]
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
            (Surface::Closed, Some((name, _))) => {
                Err(refused(format!("{name} goes with --surface tubes, not with --surface closed")))
            }
            (Surface::Tubes, _) if self.detail.is_some() => {
                Err(refused("--detail goes with --surface closed, not with --surface tubes"))
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

    /// A species' tree.
    pub(crate) fn specimen(&self, tree: &Specimen) -> Result<Model, Failure> {
        if self.surface == Surface::Closed {
            let leaves = tree.foliage().cloned().collect();
            return Ok(Model::Closed(self.closed(&tree.skeleton)?, tree.bark(), leaves));
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
        self.ended(levels)
    }

    /// Any other tree, in bark of a colour or of images.
    pub(crate) fn dressed(
        &self,
        skeleton: &Skeleton,
        leaves: &[Leaves],
        bark: Material,
        images: Option<Bark>,
    ) -> Result<Model, Failure> {
        if self.surface == Surface::Closed {
            return Ok(Model::Closed(self.closed(skeleton)?, bark, leaves.to_vec()));
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
        self.ended(levels)
    }

    /// Levels with an impostor behind them.
    fn ended(&self, mut levels: Vec<Asset>) -> Result<Model, Failure> {
        if levels.len() > 1 {
            // It is for trees that are less high than this many pixels.
            let side = self.side().unwrap_or(512).clamp(128, 256);
            levels.push(Impostor::default().with_texture_size(side).billboards(&levels[0].parts())?);
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
