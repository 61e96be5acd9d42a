//! A tree in leaf within a budget of triangles.

use super::tree::{DRAWN, Tree};
use super::young::{self, Young};
use super::{Asset, AssetError, Piece};
use crate::foliage::{Foliage, Leaves};
use crate::observer::{Observer, Silent, Watch, Work};
use crate::surface::{Material, Tubes};
use crate::texture::{Bark, Image, Textures};
use crate::{ParameterError, Skeleton};
use std::sync::Arc;

/// Makes [`Asset`]s: a tree's bark and leaves within a budget of triangles.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct AssetBuilder {
    pub(super) bark: Material,
    /// Images are no options: they are not written.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) bark_textures: Option<Arc<Textures>>,
    #[cfg_attr(feature = "serde", serde(skip))]
    young: Option<Young>,
    pub(super) twigs: Option<Material>,
    tubes: Tubes,
    pub(super) foliage: Option<Foliage>,
    pub(super) triangles: Option<usize>,
    pub(super) bark_share: f32,
    pub(super) kinds: u32,
    pub(super) texture_size: u32,
    pub(super) leaf_size: Option<u32>,
    pub(super) canopy_shade: f32,
    pub(super) bent_normals: f32,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) on_bark: bool,
}

impl AssetBuilder {
    /// The textures set by [`with_bark_textures`](Self::with_bark_textures).
    pub fn bark_textures(&self) -> Option<&Textures> {
        self.bark_textures.as_deref()
    }

    /// The foliage set by [`with_foliage`](Self::with_foliage).
    pub fn foliage(&self) -> Option<&Foliage> {
        self.foliage.as_ref()
    }
}

crate::recipe::readable!(AssetBuilder {
    bark: Material, twigs: Option<Material>, triangles: Option<usize>, bark_share: f32, kinds: u32,
    texture_size: u32, leaf_size: Option<u32>, canopy_shade: f32, bent_normals: f32,
});

crate::recipe::readable!(&AssetBuilder { tubes: Tubes });

impl Default for AssetBuilder {
    /// 10,000 triangles, of which bark gets at most 35%; the default bark without images; no leaves; 8 kinds of cards in
    /// images of 1024 x 1024 pixels; half the crown's shade, normals bent half-way.
    fn default() -> Self {
        Self {
            bark: Material::bark(),
            bark_textures: None,
            young: None,
            twigs: None,
            tubes: Tubes::default(),
            foliage: None,
            triangles: Some(10_000),
            bark_share: 0.35,
            kinds: 8,
            texture_size: 1024,
            leaf_size: Some(128),
            canopy_shade: 0.5,
            bent_normals: 0.5,
            on_bark: false,
        }
    }
}

impl AssetBuilder {
    /// Material of the bark; default [`Material::bark`].
    pub fn with_bark(mut self, material: Material) -> Self {
        self.bark = material;
        self
    }

    /// The images that the bark wears; default none. They are multiplied by the [material](Self::with_bark), so that goes with
    /// [`Material::white`] of roughness 1; the size of a tile is that of the [tubes](Self::with_tubes).
    pub fn with_bark_textures(mut self, textures: Textures) -> Self {
        self.bark_textures = Some(Arc::new(textures));
        self
    }

    /// The images that wood thinner than `radius` metres wears, with a tile of `tile` metres; default none, so that all wears the
    /// [same](Self::with_bark_textures). They are multiplied by the same material.
    ///
    /// Wood thinner than 40% of the trunk is thin too, whatever the radius. Bark changes at forks alone:
    /// where a lateral thinner than that begins, or at the first fork of a branch after it has become
    /// thinner; all that it bears is thin. Towards that place the mean colours of both fade to one within
    /// twice the radius, by vertex colours. It costs no triangles, and one more part, `young bark`.
    pub fn with_young_bark(mut self, textures: Textures, tile: f32, radius: f32) -> Self {
        self.young = Some(Young { textures: Arc::new(textures), tile, radius });
        self
    }

    /// Old bark and young of one kind: `bark` on thick wood, and on wood thinner than 3 cm ([`THIN`](Self::THIN)) the same
    /// [`young`](Bark::young), in images a quarter as wide, 64 pixels at the least. The material is white, and the size of a tile that of
    /// the bark; tubes that are set later need [`Tubes::with_tile`] again.
    ///
    /// # Errors
    /// As [`Bark::bake`].
    pub fn with_bark_of(self, bark: &Bark) -> Result<Self, AssetError> {
        self.with_bark_in_colors(bark, &bark.clone().young(), Self::THIN)
    }

    /// As [`with_bark_of`](Self::with_bark_of), given the young bark and the radius below which wood wears it, metres.
    pub(crate) fn with_bark_in_colors(
        mut self,
        bark: &Bark,
        young: &Bark,
        radius: f32,
    ) -> Result<Self, AssetError> {
        let young = young.clone().with_resolution((bark.resolution() / 4).max(64)).bake()?;
        let old = bark.bake()?;
        self.tubes = self.tubes.with_tile(old.size);
        let own = self.with_bark(Material::white().with_roughness(1.0)).with_bark_textures(old.textures);
        Ok(own.with_young_bark(young.textures, young.size, radius))
    }

    /// Leaves whose twigs the budget has no room for stand on the nearest wood that is drawn, if they are so few that one would see them
    /// hang in the air: fruit in winter.
    pub(crate) fn with_leaves_on_bark(mut self, moved: bool) -> Self {
        self.on_bark = moved;
        self
    }

    /// The radius below which wood wears young bark by default, metres.
    pub const THIN: f32 = 0.03;

    /// Material of the wood on cards; by default that of the bark in the mean colour of its images, those of
    /// thin wood if there are any.
    pub fn with_twigs(mut self, material: Material) -> Self {
        self.twigs = Some(material);
        self
    }

    /// Tubes of the bark: collars, root flare, squares of bark, wind. Within a budget its sides and turn do not matter.
    pub fn with_tubes(mut self, tubes: Tubes) -> Self {
        self.tubes = tubes;
        self
    }

    /// The leaves that [`build`](Self::build) places; default none.
    pub fn with_foliage(mut self, foliage: Foliage) -> Self {
        self.foliage = Some(foliage);
        self
    }

    /// The most triangles of bark, leaves and cards together; `None` for all there are. Default 10,000.
    pub fn with_triangles(mut self, triangles: Option<usize>) -> Self {
        self.triangles = triangles;
        self
    }

    /// The part of the triangles that bark may take if there are leaves, 0.05 to 0.95; default 0.35. The
    /// triangles that bark does not take go to the leaves, and those that leaves do not take go to the bark. Where that is too little
    /// for all twigs, bark takes 60% of it, and the rest goes to cards of bare twigs.
    pub fn with_bark_share(mut self, share: f32) -> Self {
        self.bark_share = share;
        self
    }

    /// Greatest number of kinds of cards, 1 to 16; default 8. Two of them are of bare twigs where whole leaves hang on such, beside
    /// at least one of leaves.
    pub fn with_kinds(mut self, kinds: u32) -> Self {
        self.kinds = kinds;
        self
    }

    /// The longest side of the cards' images, pixels: a power of two, 128 to 8192; default 1024.
    pub fn with_texture_size(mut self, side: u32) -> Self {
        self.texture_size = side;
        self
    }

    /// The side of the image of one leaf, of which there are four variants: a power of two, 32 to 2048; `None` for leaves
    /// in one colour. Default 128. Cards show the same images.
    pub fn with_leaf_size(mut self, side: Option<u32>) -> Self {
        self.leaf_size = side;
        self
    }

    /// Darkening of leaves and bark deep in the crown, 0 (none) to 1; default 0.5. Leaves are darkened by
    /// their tints, as [`Leaves::shaded`] does it; cards and impostors take it over from them; bark is
    /// darkened in its [colours](crate::surface::Mesh::colors), which are there only with leaves. It is
    /// occlusion of the sky, the same in every level.
    pub fn with_canopy_shade(mut self, strength: f32) -> Self {
        self.canopy_shade = strength;
        self
    }

    /// Share by which the normals of leaves and cards are bent outwards, away from the crown's middle, 0
    /// (they are not) to 1; default 0.5. Light falls on the crown as on a round body then, and no back is
    /// black: see [`bend_normals`](crate::foliage::bend_normals).
    ///
    /// Copies with normals of their own become one mesh, without instances; without a budget, of a dense model, they
    /// are left as they are.
    pub fn with_bent_normals(mut self, share: f32) -> Self {
        self.bent_normals = share;
        self
    }

    /// The wood on cards, which has no images.
    pub(super) fn wood(&self) -> Material {
        if let Some(twigs) = self.twigs {
            return twigs;
        }
        if let Some(young) = &self.young {
            return young::on_cards(young, self.bark);
        }
        let image = self.bark_textures.as_ref().and_then(|textures| textures.base_color());
        let mean = image.map_or([1.0; 3], Image::mean_color);
        let own = self.bark.color();
        self.bark.with_color([own[0] * mean[0], own[1] * mean[1], own[2] * mean[2]])
    }

    /// The asset of a tree, its leaves placed with this seed.
    ///
    /// # Errors
    /// An option out of range; a budget too small for the trunk and one card, [`AssetError::TooFewTriangles`]; whatever
    /// [`Foliage::place`] and [`Tubes::mesh`] refuse.
    pub fn build(&self, skeleton: &Skeleton, seed: u64) -> Result<Asset, AssetError> {
        self.build_observed(skeleton, seed, &Silent)
    }

    /// As [`build`](Self::build), reporting progress to `observer`, which can cancel the work.
    ///
    /// # Errors
    /// As [`build`](Self::build), and [`AssetError::Cancelled`].
    pub fn build_observed(
        &self,
        skeleton: &Skeleton,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<Asset, AssetError> {
        self.build_with_observed(skeleton, &self.placed(skeleton, seed, observer)?, observer)
    }

    /// The leaves of the foliage.
    pub(super) fn placed(
        &self,
        skeleton: &Skeleton,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<Vec<Leaves>, AssetError> {
        match &self.foliage {
            Some(foliage) => Ok(vec![foliage.place_observed(skeleton, seed, observer)?]),
            None => Ok(Vec::new()),
        }
    }

    /// The asset of a tree with these leaves, such as those of a tree that grows over the years
    /// ([`Leaves::grown`]); the foliage is not asked.
    ///
    /// # Errors
    /// As [`build`](Self::build); leaves at nodes that do not exist.
    pub fn build_with(&self, skeleton: &Skeleton, leaves: &[Leaves]) -> Result<Asset, AssetError> {
        self.build_with_observed(skeleton, leaves, &Silent)
    }

    /// As [`build_with`](Self::build_with), reporting progress to `observer`, which can cancel the work.
    ///
    /// # Errors
    /// As [`build_with`](Self::build_with), and [`AssetError::Cancelled`].
    pub fn build_with_observed(
        &self,
        skeleton: &Skeleton,
        leaves: &[Leaves],
        observer: &dyn Observer,
    ) -> Result<Asset, AssetError> {
        let watch = watch(skeleton, leaves, observer);
        let tree = Tree::new(self, skeleton, leaves, &watch)?;
        let (asset, _) = tree.level(self.triangles, self.texture_size, None)?;
        watch.finish()?;
        Ok(asset)
    }

    pub(super) fn check(&self) -> Result<(), AssetError> {
        let share = self.bark_share;
        ParameterError::unless(
            (0.05..=0.95).contains(&share),
            "AssetBuilder.bark_share",
            share,
            "0.05 to 0.95",
        )?;
        ParameterError::unless((1..=16).contains(&self.kinds), "AssetBuilder.kinds", self.kinds, "1 to 16")?;
        for (name, share) in [
            ("AssetBuilder.canopy_shade", self.canopy_shade),
            ("AssetBuilder.bent_normals", self.bent_normals),
        ] {
            ParameterError::unless((0.0..=1.0).contains(&share), name, share, "0 to 1")?;
        }
        check_side("AssetBuilder.texture_size", self.texture_size)?;
        if let Some(textures) = &self.bark_textures {
            textures.check()?;
        }
        if let Some(young) = &self.young {
            young.textures.check()?;
            let holds = (1e-4..=1e4).contains(&young.tile);
            ParameterError::unless(holds, "AssetBuilder.young_bark.tile", young.tile, "1e-4 to 1e4 m")?;
            let holds = young.radius >= 0.0 && young.radius.is_finite();
            ParameterError::unless(
                holds,
                "AssetBuilder.young_bark.radius",
                young.radius,
                "at least 0 m and finite",
            )?;
        }
        self.bark.check()?;
        self.wood().check()?;
        Ok(())
    }

    /// The tubes as the bark is made: where thin wood is another piece, their wind has the node of each
    /// vertex.
    pub(super) fn own_tubes(&self) -> Tubes {
        if self.young.is_some() { self.tubes.clone().with_wind(true) } else { self.tubes.clone() }
    }

    /// Takes thin wood out of the bark, and from both the wind if it is not wanted.
    pub(super) fn split(&self, bark: &mut Piece, skeleton: &Skeleton) -> Option<Piece> {
        let mut young = self.young.as_ref()?.split(bark, skeleton, self.tubes.has_even_texels());
        if !self.tubes.has_wind() {
            bark.mesh.wind = Vec::new();
            young.mesh.wind = Vec::new();
        }
        Some(young)
    }
}

/// Sides of images that are baked.
pub(super) fn check_side(name: &str, side: u32) -> Result<(), ParameterError> {
    let holds = side.is_power_of_two() && (128..=Image::LONGEST_SIDE).contains(&side);
    ParameterError::unless(holds, name, side, "a power of two, 128 to 8192 pixels")
}

/// Watch of an asset in the making: bark is planned a few times, and the dense model drawn from four sides.
pub(super) fn watch<'a>(skeleton: &Skeleton, leaves: &[Leaves], observer: &'a dyn Observer) -> Watch<'a> {
    let triangles: u64 = leaves.iter().map(|leaves| leaves.part().triangles()).sum();
    Watch::new(observer, Work::Asset, 20 * skeleton.len() + 4 * triangles as usize / 20, DRAWN)
}
