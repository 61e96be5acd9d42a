//! A tree of a species as one ships it.

use super::Specimen;
use super::bark_colors::{BarkColors, FRESH, WEATHERED, linear};
use super::root;
use crate::asset::{Asset, AssetBuilder, AssetError};
use crate::surface::{Material, Sway, Tubes};
use crate::texture::{Bark, BarkKind};

/// Years after which a dead tree's images are of wood, not of bark.
const BARE: f32 = 12.0;
/// The trunk's diameter from which bark is as deep as it becomes, metres.
const OLD: f32 = 0.6;

impl Specimen {
    /// The bark of its species as images, the older the thicker the trunk is. Its mean colour is the lightest of trunk, limbs and twigs,
    /// channel by channel; the vertex colours of [`levels`](Self::levels) darken it to each of them.
    pub fn bark_texture(&self) -> Bark {
        // Long dead trees show the grain of their wood.
        let wood = self.numbers.dead.is_some_and(|years| years > BARE);
        let age = 0.2 + 0.7 * (self.numbers.dbh / OLD).min(1.0);
        let bark = if wood {
            Bark::of_kind(BarkKind::Stringy).with_age(age)
        } else {
            self.species.bark.texture(age)
        };
        bark.with_color(self.lightest().map(|channel| channel as u8)).with_seed(self.seed)
    }

    fn lightest(&self) -> [f32; 3] {
        let bark = &self.species.bark;
        let broken = self.numbers.dead.is_some() || self.numbers.damage > 0.0;
        let wood = [FRESH, WEATHERED].map(|wood| if broken { wood } else { [0.0; 3] });
        [0, 1, 2].map(|i| bark.trunk[i].max(bark.limbs[i]).max(bark.twigs[i]).max(wood[0][i]).max(wood[1][i]))
    }

    /// Bark with images, leaves and cards in levels of detail, as [`AssetBuilder::levels`]: the
    /// finest has at most `triangles` triangles (`None` for all there are), the others these shares
    /// of them; images of `side` pixels, a power of two from 128 to 8192. No vertex has wind: for
    /// that there is [`levels_in_wind`](Self::levels_in_wind).
    ///
    /// ```
    /// use treesynth::species;
    ///
    /// let birch = species::by_name("silver birch")?.request().with_height(4.0).grow()?;
    /// let levels = birch.levels(Some(5_000), 128, &[1.0, 0.3])?;
    /// assert!(levels[0].triangles() <= 5_000 && levels[1].triangles() <= 1_500);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`AssetBuilder::levels`], and a side that no bark can have.
    #[doc(alias = "LOD")]
    pub fn levels(
        &self,
        triangles: Option<usize>,
        side: u32,
        shares: &[f32],
    ) -> Result<Vec<Asset>, AssetError> {
        let mut levels = self.grown(triangles, side, shares)?;
        for mesh in levels.iter_mut().flat_map(Asset::barks_mut) {
            mesh.wind = Vec::new();
        }
        Ok(levels)
    }

    /// As [`levels`](Self::levels), with [`Wind`](crate::surface::Wind) in all vertices, see [`Asset::in_wind`]: bark has it from its tubes,
    /// so that its junctions stay closed.
    ///
    /// # Errors
    /// As [`levels`](Self::levels); more vertices than 32-bit indices can name.
    pub fn levels_in_wind(
        &self,
        triangles: Option<usize>,
        side: u32,
        shares: &[f32],
    ) -> Result<Vec<Asset>, AssetError> {
        let sway = Sway::of(&self.rooted())?;
        self.grown(triangles, side, shares)?.iter().map(|level| level.in_wind(&sway)).collect()
    }

    /// The levels, with wind in their bark.
    fn grown(&self, triangles: Option<usize>, side: u32, shares: &[f32]) -> Result<Vec<Asset>, AssetError> {
        let rooted = self.rooted();
        let bark = self.bark_texture().with_resolution(side);
        // One mean: the colours of trunk and twigs are the vertices'.
        let young = bark.clone().young().with_color(self.lightest().map(|channel| channel as u8));
        let tubes = Tubes::default().with_root_flare(0.0).with_wind(true);
        let twigs = Material::bark().with_color(linear(self.species.bark.twigs));
        let builder = AssetBuilder::default()
            .with_triangles(triangles)
            .with_tubes(tubes.with_square_tiles(true))
            .with_bark_in_colors(&bark, &young, root::thinnest(&rooted).min(AssetBuilder::THIN))?
            .with_twigs(twigs)
            .with_leaves_on_bark(self.leaves.is_none())
            .with_texture_size(side)
            .with_leaf_size(Some((side / 4).clamp(32, 2048)));
        let mut levels =
            builder.levels_with(&rooted, &self.foliage().cloned().collect::<Vec<_>>(), shares)?;
        let (colors, lightest) = (BarkColors::new(self), linear(self.lightest()));
        for level in &mut levels {
            let color = |node: u32, height: f32| {
                let own = colors.at(node as usize, height);
                [0, 1, 2].map(|i| (own[i] / lightest[i].max(1e-6)).clamp(0.0, 1.0))
            };
            for mesh in level.barks_mut() {
                self.blend_roots(mesh);
                // The wind tells the node of each vertex. There may be the crown's shade already.
                mesh.colors.resize(mesh.positions.len(), [1.0; 3]);
                for ((shade, wind), place) in mesh.colors.iter_mut().zip(&mesh.wind).zip(&mesh.positions) {
                    let own = color(wind.node, place.y);
                    *shade = [0, 1, 2].map(|i| (shade[i] * own[i] * 255.0).round() / 255.0);
                }
            }
        }
        Ok(levels)
    }
}
