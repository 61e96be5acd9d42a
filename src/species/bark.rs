//! The bark of a species as images.

use super::{BarkData, BarkForm};
use crate::texture::{Bark, BarkKind};

/// The smallest tile of images, metres.
const LEAST: f32 = 0.02;

impl BarkData {
    /// The images of an old trunk's bark at an age of 0 (this year's) to 1 (as deep as it gets); their mean colour is the trunk's.
    ///
    /// ```
    /// use treesynth::species;
    ///
    /// let bark = species::by_name("silver birch")?.bark.texture(0.8).with_resolution(64).bake()?;
    /// assert_eq!(bark.height.width(), 64);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn texture(&self, age: f32) -> Bark {
        let mut bark = Bark::of_kind(match self.kind {
            BarkForm::Smooth => BarkKind::Smooth,
            BarkForm::Fissured => BarkKind::Ridged,
            BarkForm::Netted => BarkKind::Netted,
            BarkForm::Plated => BarkKind::Plated,
            BarkForm::Scaly => BarkKind::Scaly,
            BarkForm::Papery => BarkKind::Papery,
            BarkForm::Mottled => BarkKind::Patched,
            BarkForm::Ribboned => BarkKind::Ribboned,
            BarkForm::Banded => BarkKind::Banded,
            BarkForm::Stringy => BarkKind::Stringy,
            BarkForm::Ringed => BarkKind::Ringed,
        });
        if self.tile > 0.0 {
            bark = bark.with_size(self.tile.max(LEAST));
        }
        let depth = if self.depth > 0.0 { self.depth } else { bark.depth() };
        let most = 0.25 * bark.size();
        bark = bark.with_depth(depth.min(most));
        if self.palette.iter().any(|&channel| channel > 0.0) {
            let [r, g, b, dr, dg, db, sr, sg, sb] = self.palette.map(|channel| channel as u8);
            bark = bark.with_palette([r, g, b], [dr, dg, db], [sr, sg, sb]);
        }
        bark.with_color(self.trunk.map(|channel| channel as u8)).with_age(age).with_spread(self.spread)
    }

    /// The same of thin limbs, in their colour.
    pub fn young_texture(&self) -> Bark {
        let bark = self.texture(0.0).young().with_color(self.limbs.map(|channel| channel as u8));
        let depth = bark.depth().min(0.25 * bark.size());
        bark.with_depth(depth)
    }
}
