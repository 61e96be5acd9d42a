//! Trees that one can ship: bark and leaves within a budget of triangles, twigs as cards, levels of detail, impostors.

mod atlas;
mod bake;
mod builder;
mod card;
mod cluster;
mod coat;
mod fit;
mod impostor;
mod leaf;
mod levels;
mod light;
mod measure;
mod skin;
mod tangents;
mod tree;
mod twig;
mod wind;
mod young;

pub use builder::AssetBuilder;
pub use impostor::{Impostor, Octahedral};
pub use leaf::LeafImages;
pub use measure::{Likeness, portrait};

use crate::ParameterError;
use crate::foliage::FoliageError;
use crate::observer::Cancelled;
use crate::surface::{Instance, Material, Mesh, MeshError, Part, SurfaceError};
use crate::texture::{TextureError, Textures};
use std::sync::Arc;

impl From<Cancelled> for AssetError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<SurfaceError> for AssetError {
    fn from(error: SurfaceError) -> Self {
        if error == SurfaceError::Cancelled { Self::Cancelled } else { Self::Surface(error) }
    }
}

impl From<FoliageError> for AssetError {
    fn from(error: FoliageError) -> Self {
        if error == FoliageError::Cancelled { Self::Cancelled } else { Self::Foliage(error) }
    }
}

/// Error of building an asset.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AssetError {
    /// The observer cancelled the work.
    #[error("cancelled by the observer")]
    Cancelled,
    /// An option out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The bark cannot be made.
    #[error(transparent)]
    Surface(SurfaceError),
    /// The leaves cannot be placed.
    #[error(transparent)]
    Foliage(FoliageError),
    /// A mesh or an instance cannot be drawn.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// An image cannot be made.
    #[error(transparent)]
    Texture(#[from] TextureError),
    /// A budget that not even the trunk and one card keep.
    #[error("a budget of {triangles} triangles is too small: the trunk and one card need {least}")]
    TooFewTriangles {
        /// The triangles allowed.
        triangles: usize,
        /// Least number needed.
        least: usize,
    },
    /// There is no triangle to be seen.
    #[error("there is nothing to be seen: no part has a triangle")]
    Nothing,
}

/// A mesh at many places.
#[derive(Debug, Clone, PartialEq)]
struct Piece {
    name: &'static str,
    mesh: Mesh,
    material: Material,
    textures: Option<Arc<Textures>>,
    instances: Vec<Instance>,
    /// All copies in one mesh, their normals bent by the crown.
    bent: Option<Mesh>,
}

impl Piece {
    fn part(&self) -> Part<'_> {
        let mesh = self.bent.as_ref().unwrap_or(&self.mesh);
        let mut part = Part::new(mesh).with_name(self.name).with_material(self.material);
        if let Some(textures) = &self.textures {
            part = part.with_textures(textures);
        }
        // A part that stands once at the root needs no instances.
        let is_once = self.instances.len() == 1 && self.instances[0] == Instance::IDENTITY;
        if is_once || self.bent.is_some() { part } else { part.with_instances(&self.instances) }
    }
}

/// A tree's bark, leaves and cards, or its impostor.
#[derive(Debug, Clone, PartialEq)]
pub struct Asset {
    bark: Piece,
    /// Bark of thin wood, if that is another.
    young: Option<Piece>,
    /// Coats, such as snow, on bark and young bark.
    coats: Vec<Piece>,
    leaves: Vec<Piece>,
    cards: Vec<Piece>,
    error: f32,
    /// Crown that bends the normals of leaves and cards, if they are bent.
    crown: Option<light::Crown>,
}

/// Height, in lines, of the screen for which sizes of levels are given.
const SCREEN_LINES: f32 = 1080.0;
/// Each level is shown down to this part of the size of the one before at the most.
const SMALLER: f32 = 0.7;

impl Asset {
    /// One piece without bark or leaves.
    fn of_card(card: Piece, error: f32) -> Self {
        let bark = Piece {
            name: "bark",
            mesh: Mesh::default(),
            material: Material::default(),
            textures: None,
            instances: Vec::new(),
            bent: None,
        };
        Self {
            bark,
            young: None,
            coats: Vec::new(),
            leaves: Vec::new(),
            cards: vec![card],
            error,
            crown: None,
        }
    }

    /// The parts that are written and drawn: `bark`; `young bark`, if
    /// [thin wood](AssetBuilder::with_young_bark) has its own; the [coats](Asset::coated); `leaves`, one
    /// part for each variant of their images; and `cards`, one part for each kind of twig, which
    /// all share the same images. With [bent normals](AssetBuilder::with_bent_normals) all copies
    /// of a part are one mesh, without instances. Empty parts are left out. An impostor has one
    /// part, `impostor`.
    pub fn parts(&self) -> Vec<Part<'_>> {
        let pieces = std::iter::once(&self.bark)
            .chain(&self.young)
            .chain(&self.coats)
            .chain(&self.leaves)
            .chain(&self.cards);
        pieces
            .filter(|piece| !piece.mesh.is_empty() && !piece.instances.is_empty())
            .map(Piece::part)
            .collect()
    }

    /// Triangles of all copies of all parts.
    pub fn triangles(&self) -> usize {
        self.parts().iter().map(|part| part.triangles() as usize).sum()
    }

    /// The bark, that of thin wood apart.
    pub fn bark(&self) -> &Mesh {
        &self.bark.mesh
    }

    /// The bark of [thin wood](AssetBuilder::with_young_bark), if that has images of its own.
    pub fn young_bark(&self) -> Option<&Mesh> {
        self.young.as_ref().map(|piece| &piece.mesh)
    }

    /// All bark, and what lies on it.
    pub(crate) fn barks_mut(&mut self) -> impl Iterator<Item = &mut Mesh> {
        let bark = std::iter::once(&mut self.bark).chain(&mut self.young);
        bark.chain(&mut self.coats).map(|piece| &mut piece.mesh)
    }

    /// Number of leaves that are shown as they are.
    pub fn leaves(&self) -> usize {
        self.leaves.iter().map(|piece| piece.instances.len()).sum()
    }

    /// Number of cards.
    pub fn cards(&self) -> usize {
        self.cards.iter().map(|piece| piece.instances.len()).sum()
    }

    /// The images of the cards, or of the impostor, if there are any.
    pub fn card_textures(&self) -> Option<&Textures> {
        self.cards.first()?.textures.as_deref()
    }

    /// The error, metres: how far the bark is from the smooth tubes at the most, or the size of an impostor's texel; 0 for a dense
    /// model. Show it from where this is less than a pixel.
    pub fn error(&self) -> f32 {
        self.error
    }

    /// Height in pixels of the picture of a tree of this height when the asset's error is one
    /// pixel: the asset is made for this size and smaller ones. Infinite for a dense model.
    pub fn pixels(&self, height: f32) -> f32 {
        if self.error > 0.0 { height / self.error } else { f32::INFINITY }
    }

    /// The share of the screen's height, on a screen of 1080 lines, down to which each of these
    /// levels of a tree of this height in metres is shown: for
    /// [`GlbOptions::with_coverages`](crate::export::GlbOptions::with_coverages). The finest level
    /// comes first. Each level ends at 0.7 of the size at which the one before does, or below; the
    /// last ends at 0. Empty if there are fewer than two.
    pub fn screen_coverages(levels: &[Self], height: f32) -> Vec<f32> {
        let Some((_, coarser)) = levels.split_first().filter(|(_, coarser)| !coarser.is_empty()) else {
            return Vec::new();
        };
        let shrink = |least: &mut f32, level: &Self| {
            // The impostor would do for larger trees, but has fewer leaves to show.
            *least = (level.pixels(height) / SCREEN_LINES).min(*least);
            let ends = *least;
            *least *= SMALLER;
            Some(ends)
        };
        coarser.iter().scan(1.0, shrink).chain([0.0]).collect()
    }
}
