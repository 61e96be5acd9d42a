//! Snow, moss and lichen on an asset's bark.

use super::{Asset, AssetError, Piece};
use crate::surface::{Instance, Mask, Material};
use crate::texture::Textures;
use std::sync::Arc;

impl Asset {
    /// The asset with the part of its bark that a mask covers in a material of its own: white, wearing
    /// `textures`, up to `thickness` metres thick. Coats that lie on the bark already are covered too, so
    /// that snow comes last.
    ///
    /// Bark is [cut](Mask::cut) along the mask's border, so that every engine shows it; each level of detail
    /// has its border in the same places as far as its triangles allow. This costs triangles: snow, moss and
    /// lichen together multiplied the triangles of a bare oak's bark by five. Leave room for them in the
    /// budget, or look at [`triangles`](Self::triangles). Texture coordinates are the bark's, so that a tile
    /// is as large as the bark's. Leaves and cards stay as they are.
    ///
    /// ```
    /// use treesynth::{asset::AssetBuilder, presets, surface::Mask, texture::Coat};
    ///
    /// let tree = presets::by_name("figure-06b").unwrap().guided().unwrap().synth(2000).synthesize(1)?;
    /// let asset = AssetBuilder::default().with_triangles(Some(3_000)).build(&tree, 1)?;
    /// let snow = Coat::snow().with_resolution(64).bake()?;
    /// let white = asset.coated("snow", &Mask::snow(), &snow.textures, 0.02)?;
    /// assert!(white.parts().iter().any(|part| part.name() == "snow"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Mask::cut`]; a setting of the textures out of its range.
    pub fn coated(
        &self,
        name: &'static str,
        mask: &Mask,
        textures: &Textures,
        thickness: f32,
    ) -> Result<Self, AssetError> {
        textures.check()?;
        let mut asset = self.clone();
        let textures = Arc::new(textures.clone());
        let mut coats = Vec::new();
        let under = std::iter::once(&mut asset.bark).chain(&mut asset.young).chain(&mut asset.coats);
        for piece in under.filter(|piece| !piece.mesh.is_empty()) {
            let [bare, mut covered] = mask.cut(&piece.mesh, thickness)?;
            piece.mesh = bare;
            // It is not of the colour of what it lies on.
            covered.colors = Vec::new();
            coats.push(Piece {
                name,
                mesh: covered,
                material: Material::white().with_roughness(1.0),
                textures: Some(Arc::clone(&textures)),
                instances: vec![Instance::IDENTITY],
                bent: None,
            });
        }
        asset.coats.extend(coats);
        Ok(asset)
    }

    /// The asset with its bark's colours multiplied by `color` (linear, each channel 0 to 1) where the mask is 1: wet, or green
    /// with algae. Vertex colours carry it, so that it costs nothing; wetness as a gloss is a matter of the material.
    ///
    /// # Errors
    /// As [`Mask::tint`].
    pub fn tinted(&self, mask: &Mask, color: [f32; 3]) -> Result<Self, AssetError> {
        let mut asset = self.clone();
        for mesh in asset.barks_mut() {
            mask.tint(mesh, color)?;
        }
        Ok(asset)
    }
}
