//! Bark as images, made on the CPU.

mod bake;
mod cells;
mod coat;
mod fissured;
mod lanes;
mod noise;
mod pattern;
mod peeling;
mod plain;
mod plated;
mod scaly;
mod shed;

pub use coat::Coat;

use super::{Image, TextureError, Textures};
use crate::ParameterError;
use crate::math;
use fissured::{Ash, Oak};
use glam::Vec4;
use noise::Seed;
use pattern::Recipe;
use peeling::{Birch, Cherry};
use plain::{Beech, Cedar, Palm};
use plated::Pine;
use scaly::Scales;
use shed::{Plane, Ribbons};

/// Behaviour of a bark as the wood under it grows.
///
/// ```
/// use treesynth::texture::{Bark, BarkKind};
///
/// let larch = Bark::of_kind(BarkKind::Plated).with_color([112, 84, 70]).with_resolution(64).bake()?;
/// # Ok::<(), treesynth::texture::TextureError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum BarkKind {
    /// Deep fissures between long ridges that split, join and break crosswise: oak, elm, willow, locust.
    Ridged,
    /// A net of ridges with diamonds between them: ash, young walnut, Norway maple.
    Netted,
    /// Large plates of many flakes between dark fissures: pine, larch.
    Plated,
    /// Small, thin scales that lift at their lower edges: spruce, sycamore, apple, horse chestnut.
    Scaly,
    /// Plates fall off and leave patches of different age: plane, sycamore, lacebark elm.
    Patched,
    /// Long ribbons fall off and leave streaks along the trunk: eucalyptus.
    Ribboned,
    /// A pale skin like paper with dark lenticels around the branch; black cracks when old: birch.
    Papery,
    /// A glossy skin with bands of large, pale lenticels: cherry.
    Banded,
    /// Smooth all its life, with blotches and faint wrinkles: beech, hornbeam.
    Smooth,
    /// Long strips of fibres: cedar, juniper, yew, redwood.
    Stringy,
    /// The scars of fallen leaves, ring over ring: palms.
    Ringed,
}

impl BarkKind {
    /// All kinds.
    pub const ALL: [Self; 11] = [
        Self::Ridged,
        Self::Netted,
        Self::Plated,
        Self::Scaly,
        Self::Patched,
        Self::Ribboned,
        Self::Papery,
        Self::Banded,
        Self::Smooth,
        Self::Stringy,
        Self::Ringed,
    ];
}

/// A tile of bark as images, and how large it is.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct BarkSet {
    /// Base colour, normals, and occlusion with roughness: what a [`Part`](crate::surface::Part) wears.
    pub textures: Textures,
    /// Height map, one channel: 0 is the deepest, 255 lies [`depth`](Self::depth) above.
    pub height: Image,
    /// The side of the tile, metres: for [`Tubes::with_tile`](crate::surface::Tubes::with_tile).
    pub size: f32,
    /// From 0 to 255 of the heights, metres.
    pub depth: f32,
}

/// A tile of bark that continues into itself on all sides: u runs around the branch, v along it.
///
/// Guarantees: opposite edges continue, since the noise has the tile as its period; normals have
/// unit length within the 8 bits of a channel and are the slopes of the heights; the mean of the
/// base colour, as light, is the [colour](Self::with_color) asked for, unless it is out of reach (a
/// spread so wide that half of the pixels would have to be brighter than white); the same options
/// give the same bytes on every platform and at every thread count.
///
/// O(resolution²) time: 0.25 to 0.5 s for 1024 x 1024 on one thread. Memory while it is made: 36 bytes per
/// pixel.
///
/// ```
/// use treesynth::texture::Bark;
///
/// let old = Bark::oak().with_resolution(64).bake()?;
/// let young = Bark::oak().young().with_resolution(64).bake()?;
/// assert_eq!(old.textures.base_color().map(|image| image.width()), Some(64));
/// assert!(young.depth < old.depth);
/// # Ok::<(), treesynth::texture::TextureError>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Bark {
    kind: BarkKind,
    size: f32,
    depth: f32,
    age: f32,
    color: [u8; 3],
    /// The mean colour of young wood.
    young: [u8; 3],
    /// Colours of the outer surface, of hollows, and of special parts.
    palette: [[u8; 3]; 3],
    spread: f32,
    seed: u64,
    resolution: u32,
}

crate::recipe::readable!(Bark {
    depth: f32,
    age: f32,
    color: [u8; 3],
    palette: [[u8; 3]; 3],
    spread: f32,
    seed: u64,
    resolution: u32,
});

impl Bark {
    fn of(
        kind: BarkKind,
        (size, depth): (f32, f32),
        [color, young]: [[u8; 3]; 2],
        palette: [[u8; 3]; 3],
    ) -> Self {
        Self { kind, size, depth, age: 0.8, color, young, palette, spread: 1.0, seed: 0, resolution: 1024 }
    }

    /// Deep, long, interlaced ridges, grey over dark brown. A tile of 0.5 m.
    pub fn oak() -> Self {
        let colors = [[104, 92, 79], [104, 102, 88]];
        Self::of(BarkKind::Ridged, (0.5, 0.03), colors, [[134, 122, 106], [38, 29, 22], [128, 131, 112]])
    }

    /// A net of pale grey ridges with diamonds between them. A tile of 0.5 m.
    pub fn ash() -> Self {
        let colors = [[118, 111, 100], [122, 122, 108]];
        Self::of(BarkKind::Netted, (0.5, 0.018), colors, [[150, 143, 130], [58, 50, 42], [142, 144, 124]])
    }

    /// Red-brown plates between dark fissures. A tile of 0.6 m.
    pub fn pine() -> Self {
        let colors = [[118, 86, 68], [140, 100, 70]];
        Self::of(BarkKind::Plated, (0.6, 0.028), colors, [[136, 118, 106], [42, 30, 24], [158, 116, 92]])
    }

    /// Patches of cream, olive and brown-grey. A tile of 0.6 m.
    pub fn plane() -> Self {
        let colors = [[152, 147, 118], [150, 145, 112]];
        Self::of(BarkKind::Patched, (0.6, 0.006), colors, [[142, 142, 122], [110, 104, 94], [190, 186, 162]])
    }

    /// Thin scales of red-brown and grey. A tile of 0.35 m.
    pub fn spruce() -> Self {
        let colors = [[112, 90, 76], [112, 88, 70]];
        Self::of(BarkKind::Scaly, (0.35, 0.008), colors, [[128, 108, 94], [54, 38, 30], [146, 98, 74]])
    }

    /// Streaks of cream, blue-grey and tan. A tile of 0.8 m.
    pub fn eucalyptus() -> Self {
        let colors = [[172, 162, 146], [176, 168, 140]];
        Self::of(BarkKind::Ribboned, (0.8, 0.006), colors, [[158, 156, 150], [124, 100, 80], [206, 194, 168]])
    }

    /// White paper with dark lenticels, and black diamonds where old bark has burst. A tile of 0.8 m.
    pub fn birch() -> Self {
        let colors = [[198, 193, 184], [150, 122, 102]];
        Self::of(BarkKind::Papery, (0.8, 0.010), colors, [[228, 225, 217], [34, 30, 28], [208, 172, 146]])
    }

    /// Glossy red-brown with bands of tan lenticels. A tile of 0.5 m.
    pub fn cherry() -> Self {
        let colors = [[104, 76, 68], [122, 78, 64]];
        Self::of(BarkKind::Banded, (0.5, 0.008), colors, [[114, 84, 76], [48, 34, 30], [188, 142, 106]])
    }

    /// Smooth silver grey. A tile of 0.6 m.
    pub fn beech() -> Self {
        let colors = [[146, 146, 138], [122, 122, 110]];
        Self::of(BarkKind::Smooth, (0.6, 0.004), colors, [[152, 152, 145], [112, 112, 103], [182, 185, 173]])
    }

    /// Long strips of red-brown and grey fibres. A tile of 0.5 m.
    pub fn cedar() -> Self {
        let colors = [[116, 88, 70], [124, 86, 64]];
        Self::of(BarkKind::Stringy, (0.5, 0.014), colors, [[136, 100, 78], [44, 28, 20], [150, 132, 116]])
    }

    /// Rings of leaf scars, grey-brown. A tile of 0.4 m.
    pub fn palm() -> Self {
        let colors = [[128, 115, 98], [128, 124, 88]];
        Self::of(BarkKind::Ringed, (0.4, 0.010), colors, [[130, 117, 100], [56, 46, 36], [166, 153, 132]])
    }

    /// The preset of a kind.
    pub fn of_kind(kind: BarkKind) -> Self {
        match kind {
            BarkKind::Ridged => Self::oak(),
            BarkKind::Netted => Self::ash(),
            BarkKind::Plated => Self::pine(),
            BarkKind::Scaly => Self::spruce(),
            BarkKind::Patched => Self::plane(),
            BarkKind::Ribboned => Self::eucalyptus(),
            BarkKind::Papery => Self::birch(),
            BarkKind::Banded => Self::cherry(),
            BarkKind::Smooth => Self::beech(),
            BarkKind::Stringy => Self::cedar(),
            BarkKind::Ringed => Self::palm(),
        }
    }

    /// The same for limbs and twigs: age 0.15, the colour of young wood, and a tile of half the size.
    pub fn young(mut self) -> Self {
        (self.age, self.color) = (0.15, self.young);
        self.size *= 0.5;
        self
    }

    /// The side of the tile, metres, 0.01 to 100. Ridges and plates grow with it; the depth does not.
    pub fn with_size(mut self, metres: f32) -> Self {
        self.size = metres;
        self
    }

    /// Depth of the oldest bark, metres, 0 to a quarter of the size. Young bark has a part of it.
    pub fn with_depth(mut self, metres: f32) -> Self {
        self.depth = metres;
        self
    }

    /// 0 (smooth, of this year) to 1 (as deep as it gets); default 0.8.
    pub fn with_age(mut self, age: f32) -> Self {
        self.age = age;
        self
    }

    /// The mean colour, sRGB.
    pub fn with_color(mut self, srgb: [u8; 3]) -> Self {
        self.color = srgb;
        self
    }

    /// The colours of the outer surface, of hollows, and of parts special to the kind (lenticels,
    /// fresh flakes, lichen), sRGB. All are then multiplied by one colour, so that the mean is
    /// [`with_color`](Self::with_color)'s.
    pub fn with_palette(mut self, outer: [u8; 3], deep: [u8; 3], special: [u8; 3]) -> Self {
        self.palette = [outer, deep, special];
        self
    }

    /// Spread of the colours about their mean, 0 (one colour) to 2 (twice as far); default 1.
    pub fn with_spread(mut self, spread: f32) -> Self {
        self.spread = spread;
        self
    }

    /// Another seed gives another piece of bark; default 0.
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Pixels per side, a power of two from 16 to 8192; default 1024.
    pub fn with_resolution(mut self, pixels: u32) -> Self {
        self.resolution = pixels;
        self
    }

    /// The kind of bark, by its growth.
    pub fn kind(&self) -> BarkKind {
        self.kind
    }

    /// The side of the tile, metres.
    pub fn size(&self) -> f32 {
        self.size
    }

    /// Makes the images.
    ///
    /// # Errors
    /// An option out of its range.
    pub fn bake(&self) -> Result<BarkSet, TextureError> {
        self.check()?;
        let [outer, inner, accent] = self.palette.map(|srgb| linear(srgb).map(Vec4::splat));
        let recipe = Recipe {
            seed: Seed(self.seed),
            age: self.age,
            finest: (self.resolution / 2).max(8),
            outer,
            inner,
            accent,
        };
        match self.kind {
            BarkKind::Ridged => bake::bake(self, &Oak::new(recipe)),
            BarkKind::Netted => bake::bake(self, &Ash::new(recipe)),
            BarkKind::Plated => bake::bake(self, &Pine::new(recipe)),
            BarkKind::Scaly => bake::bake(self, &Scales::new(recipe)),
            BarkKind::Patched => bake::bake(self, &Plane::new(recipe)),
            BarkKind::Ribboned => bake::bake(self, &Ribbons::new(recipe)),
            BarkKind::Papery => bake::bake(self, &Birch::new(recipe)),
            BarkKind::Banded => bake::bake(self, &Cherry::new(recipe)),
            BarkKind::Smooth => bake::bake(self, &Beech::new(recipe)),
            BarkKind::Stringy => bake::bake(self, &Cedar::new(recipe)),
            BarkKind::Ringed => bake::bake(self, &Palm::new(recipe)),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        let holds = (0.01..=100.0).contains(&self.size);
        ParameterError::unless(holds, "Bark.size", self.size, "0.01 to 100 m")?;
        let holds = self.depth >= 0.0 && self.depth <= 0.25 * self.size;
        ParameterError::unless(holds, "Bark.depth", self.depth, "0 to a quarter of the size, metres")?;
        ParameterError::unless((0.0..=1.0).contains(&self.age), "Bark.age", self.age, "0 to 1")?;
        ParameterError::unless((0.0..=2.0).contains(&self.spread), "Bark.spread", self.spread, "0 to 2")?;
        let pixels = self.resolution;
        let holds = pixels.is_power_of_two() && (16..=8192).contains(&pixels);
        ParameterError::unless(holds, "Bark.resolution", pixels, "a power of two from 16 to 8192")
    }

    /// The mean colour, linear.
    fn linear_color(&self) -> [f32; 3] {
        linear(self.color)
    }

    /// Depth at its age, metres.
    fn relief(&self) -> f32 {
        self.depth * (0.12 + 0.88 * self.age)
    }

    /// Darkness of its hollows: 1 where fissures are as deep as wide.
    fn hollows(&self) -> f32 {
        (self.relief() / self.size * 25.0).min(1.2)
    }
}

fn linear(srgb: [u8; 3]) -> [f32; 3] {
    srgb.map(|channel| math::linear(f32::from(channel) / 255.0))
}

#[cfg(test)]
mod tests;
