//! Assets that move in the wind.

use super::impostor::IMPOSTOR;
use super::light::{Crown, in_bytes};
use super::{Asset, AssetError};
use crate::foliage::{Leaf, Leaves, bend_about};
use crate::surface::{Instance, Sway};

impl Asset {
    /// The asset with [`Wind`](crate::surface::Wind) in all its vertices, so that bark, leaves and cards move together: each leaf and
    /// each card goes with the twig that bears it. Copies become one mesh, since glTF and engines cannot bend instances. Bark that
    /// has wind already, from [`Tubes::with_wind`](crate::surface::Tubes::with_wind), keeps it, and its junctions stay closed; other
    /// bark moves with the internode next to each vertex, which may open a junction a little. An impostor leans with the trunk.
    /// O(vertices · log nodes).
    ///
    /// ```
    /// use treesynth::{asset::AssetBuilder, presets, surface::Sway};
    ///
    /// let preset = presets::by_name("figure-06b").unwrap().guided().unwrap();
    /// let tree = preset.synth(2000).synthesize(1)?;
    /// let foliage = preset.foliage(presets::Season::Summer).unwrap();
    /// let asset = AssetBuilder::default().with_foliage(foliage).build(&tree, 1)?;
    /// let moving = asset.in_wind(&Sway::of(&tree)?)?;
    /// assert_eq!(moving.triangles(), asset.triangles());
    /// assert!(moving.parts().iter().all(|part| part.mesh().wind.len() == part.mesh().positions.len()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// More vertices than 32-bit indices can name.
    ///
    /// # Panics
    /// When the sway is of another, smaller skeleton.
    pub fn in_wind(&self, sway: &Sway) -> Result<Self, AssetError> {
        let mut asset = self.clone();
        for mesh in asset.barks_mut().filter(|mesh| mesh.wind.is_empty()) {
            sway.clothe(mesh);
        }
        for piece in asset.leaves.iter_mut().chain(&mut asset.cards) {
            if piece.name == IMPOSTOR {
                sway.lean(&mut piece.mesh);
                continue;
            }
            let leaves = Leaves { leaf: Leaf::new(piece.mesh.clone()), instances: piece.instances.clone() };
            piece.mesh = leaves.mesh_in_wind(sway)?;
            piece.instances = vec![Instance::IDENTITY];
            piece.bent = None;
            if let Some(Crown { bounds, share }) = self.crown {
                bend_about(&mut piece.mesh, bounds, share);
                in_bytes(&mut piece.mesh.colors);
            }
        }
        Ok(asset)
    }
}
