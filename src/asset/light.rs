//! A crown's light on its leaves and cards: normals that look outwards.

use super::{Asset, AssetError, Piece};
use crate::foliage::bend_about;
use crate::shape::Bounds;

/// The round body that light falls on, and how far normals are bent by it, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crown {
    pub(super) bounds: Bounds,
    pub(super) share: f32,
}

/// Colours as files have them: in 256 steps, so that none is lost there.
pub(super) fn in_bytes(colors: &mut [[f32; 3]]) {
    for color in colors {
        *color = color.map(|channel| (channel.clamp(0.0, 1.0) * 255.0).round() / 255.0);
    }
}

impl Asset {
    /// Bends the normals of leaves and cards, whose copies become one mesh.
    pub(super) fn bend(&mut self, crown: Crown) -> Result<(), AssetError> {
        for piece in self.leaves.iter_mut().chain(&mut self.cards) {
            piece.bend(crown)?;
        }
        self.crown = Some(crown);
        Ok(())
    }
}

impl Piece {
    fn bend(&mut self, crown: Crown) -> Result<(), AssetError> {
        let mut mesh = self.mesh.merged(&self.instances)?;
        bend_about(&mut mesh, crown.bounds, crown.share);
        in_bytes(&mut mesh.colors);
        self.bent = Some(mesh);
        Ok(())
    }
}
