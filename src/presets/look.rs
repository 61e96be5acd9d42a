//! Bark and leaves of the presets: kinds of trees, with sizes and arrangements as floras give them and colours chosen
//! by eye.

use crate::foliage::{Arrangement, Foliage, Leaf};
use crate::surface::Material;
#[cfg(feature = "texture")]
use crate::texture::Bark;

/// A time of the year.
///
/// ```
/// use treesynth::presets::{self, Season};
///
/// let elm = presets::by_name("figure-07")?.guided()?;
/// assert!(elm.foliage(Season::Summer).is_some() && elm.foliage(Season::Winter).is_none());
/// # Ok::<(), presets::PresetError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Season {
    /// No leaves.
    Winter,
    /// Green.
    #[default]
    Summer,
    /// As in summer, in other colours.
    Autumn,
}

/// Look of a kind of tree.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    bark: [u8; 3],
    /// Behaviour of the bark as it ages.
    #[cfg(feature = "texture")]
    texture: fn() -> Bark,
    summer: [u8; 3],
    autumn: [u8; 3],
    leaves: Option<fn() -> Foliage>,
}

impl Look {
    pub(super) fn bark(&self) -> Material {
        Material::bark().with_srgb(self.bark)
    }

    #[cfg(feature = "texture")]
    pub(super) fn bark_texture(&self) -> Bark {
        (self.texture)().with_color(self.bark)
    }

    pub(super) fn foliage(&self, season: Season) -> Option<Foliage> {
        let color = match season {
            Season::Winter => return None,
            Season::Summer => self.summer,
            Season::Autumn => self.autumn,
        };
        self.leaves.map(|leaves| leaves().with_material(Material::leaf().with_srgb(color)))
    }
}

/// A dead tree, or a drawing.
pub(super) const BARE: Look = Look {
    bark: [112, 96, 83],
    #[cfg(feature = "texture")]
    texture: Bark::oak,
    summer: [0; 3],
    autumn: [0; 3],
    leaves: None,
};

pub(super) const ASH: Look = Look {
    bark: [116, 107, 96],
    #[cfg(feature = "texture")]
    texture: Bark::ash,
    summer: [84, 124, 54],
    autumn: [200, 176, 70],
    leaves: Some(|| {
        Foliage::new(Leaf::pinnate().with_petiole(0.15))
            .with_arrangement(Arrangement::Decussate)
            .with_spacing(0.09)
            .with_size(0.2)
            .with_reach(0.5)
    }),
};

pub(super) const ELM: Look = Look {
    bark: [98, 84, 71],
    #[cfg(feature = "texture")]
    texture: Bark::ash,
    summer: [78, 112, 46],
    autumn: [206, 168, 58],
    leaves: Some(|| {
        Foliage::new(Leaf::ovate().with_petiole(0.1)).with_spacing(0.02).with_size(0.11).with_reach(0.9)
    }),
};

/// For trees that organize themselves, whose metamers are some 10 cm long.
pub(super) const HORNBEAM: Look = Look {
    bark: [112, 104, 94],
    #[cfg(feature = "texture")]
    texture: Bark::beech,
    summer: [82, 120, 46],
    autumn: [208, 172, 62],
    leaves: Some(|| {
        Foliage::new(Leaf::ovate().with_petiole(0.12)).with_spacing(0.03).with_size(0.1).with_reach(1e6)
    }),
};

pub(super) const LINDEN: Look = Look {
    bark: [104, 94, 82],
    #[cfg(feature = "texture")]
    texture: Bark::ash,
    summer: [88, 126, 52],
    autumn: [214, 184, 72],
    leaves: Some(|| {
        Foliage::new(Leaf::deltoid().with_petiole(0.4)).with_spacing(0.025).with_size(0.11).with_reach(0.9)
    }),
};

pub(super) const OAK: Look = Look {
    bark: [92, 80, 67],
    #[cfg(feature = "texture")]
    texture: Bark::oak,
    summer: [74, 106, 44],
    autumn: [158, 104, 48],
    leaves: Some(|| {
        Foliage::new(Leaf::sinuate().with_petiole(0.06))
            .with_arrangement(Arrangement::SPIRAL)
            .with_spacing(0.02)
            .with_size(0.13)
            .with_reach(0.7)
    }),
};

pub(super) const MAPLE: Look = Look {
    bark: [106, 94, 82],
    #[cfg(feature = "texture")]
    texture: Bark::ash,
    summer: [84, 120, 48],
    autumn: [206, 92, 42],
    leaves: Some(|| {
        Foliage::new(Leaf::lobed().with_petiole(0.7))
            .with_arrangement(Arrangement::Decussate)
            .with_spacing(0.06)
            .with_size(0.1)
    }),
};

pub(super) const CHESTNUT: Look = Look {
    bark: [98, 84, 72],
    #[cfg(feature = "texture")]
    texture: Bark::pine,
    summer: [72, 108, 44],
    autumn: [186, 122, 56],
    leaves: Some(|| {
        Foliage::new(Leaf::palmate().with_petiole(0.7))
            .with_arrangement(Arrangement::Decussate)
            .with_spacing(0.12)
            .with_size(0.15)
            .with_reach(0.45)
    }),
};

pub(super) const WILLOW: Look = Look {
    bark: [108, 97, 76],
    #[cfg(feature = "texture")]
    texture: Bark::oak,
    summer: [118, 142, 78],
    autumn: [208, 190, 90],
    leaves: Some(|| {
        Foliage::new(Leaf::lanceolate().with_petiole(0.08))
            .with_arrangement(Arrangement::SPIRAL)
            .with_spacing(0.018)
            .with_size(0.13)
            .with_rise(-0.8)
            .with_turn(0.4)
            .with_reach(2.0)
    }),
};

/// The bark is as light as it may be and still stand out from white paper in full sun.
pub(super) const BIRCH: Look = Look {
    bark: [142, 138, 132],
    #[cfg(feature = "texture")]
    texture: Bark::birch,
    summer: [104, 140, 60],
    autumn: [222, 190, 70],
    leaves: Some(|| {
        Foliage::new(Leaf::deltoid().with_petiole(0.4))
            .with_spacing(0.016)
            .with_size(0.075)
            .with_rise(-0.4)
            .with_disorder(0.5)
            .with_reach(1.0)
    }),
};

pub(super) const POPLAR: Look = Look {
    bark: [138, 130, 114],
    #[cfg(feature = "texture")]
    texture: Bark::oak,
    summer: [102, 134, 62],
    autumn: [220, 184, 60],
    leaves: Some(|| {
        Foliage::new(Leaf::deltoid().with_petiole(0.8))
            .with_arrangement(Arrangement::SPIRAL)
            .with_spacing(0.022)
            .with_size(0.1)
            .with_disorder(0.6)
            .with_reach(0.9)
    }),
};

pub(super) const HAZEL: Look = Look {
    bark: [122, 104, 84],
    #[cfg(feature = "texture")]
    texture: Bark::beech,
    summer: [96, 130, 56],
    autumn: [212, 178, 74],
    leaves: Some(|| {
        Foliage::new(Leaf::ovate().with_petiole(0.12)).with_spacing(0.025).with_size(0.12).with_reach(0.9)
    }),
};

pub(super) const SPRUCE: Look = Look {
    bark: [98, 76, 62],
    #[cfg(feature = "texture")]
    texture: Bark::pine,
    summer: [50, 78, 46],
    autumn: [50, 78, 46],
    leaves: Some(|| {
        Foliage::new(Leaf::needles())
            .with_arrangement(Arrangement::SPIRAL)
            .with_spacing(0.035)
            .with_size(0.16)
            .with_angle(0.7)
            .with_turn(0.2)
            .with_reach(1.4)
            .with_thickest(0.015)
    }),
};
