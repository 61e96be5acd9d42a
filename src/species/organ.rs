//! Organs of a species besides leaves: blossom, catkins, fruit and cones, as data.

use super::text::{Choice, Fields};

/// The forms that organs are drawn with. All are 1 long, from where they are fixed to their end.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum OrganKind {
    /// An open flower of five petals, as wide as long: cherry, apple. 10 triangles.
    #[default]
    Flower,
    /// An upright or hanging panicle of many flowers: horse chestnut, sycamore. 74 triangles.
    Candle,
    /// A round bunch of tiny flowers: Norway maple, elm, eucalyptus. 28 triangles.
    Cluster,
    /// A soft hanging cylinder: hazel, birch, poplar. 30 triangles.
    Catkin,
    /// A round fruit: apple, walnut, coconut, the balls of planes. 36 triangles.
    Ball,
    /// A woody cone with scales: pine, spruce, fir, cypress. 78 triangles.
    Cone,
    /// Two winged nutlets: maple, sycamore. 8 triangles.
    Wings,
    /// One winged nutlet: ash, elm. 4 triangles.
    Key,
    /// A narrow bract with three nutlets under it: lime. 28 triangles.
    Bract,
}

impl Choice for OrganKind {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("flower", Self::Flower),
        ("candle", Self::Candle),
        ("cluster", Self::Cluster),
        ("catkin", Self::Catkin),
        ("ball", Self::Ball),
        ("cone", Self::Cone),
        ("wings", Self::Wings),
        ("key", Self::Key),
        ("bract", Self::Bract),
    ];
}

/// Places of organs on a tree.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum OrganPlace {
    /// At the tips of short shoots: cherry, apple.
    #[default]
    ShortShoots,
    /// At the tips of long shoots: horse chestnut, maple, spruce.
    Tips,
    /// Along long shoots, from the tip backwards: hazel, poplar, pine.
    Along,
    /// Around stems, at their highest place within [`heights`](Organ::heights): coconut.
    Stem,
}

impl Choice for OrganPlace {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("short shoots", Self::ShortShoots),
        ("tips", Self::Tips),
        ("along", Self::Along),
        ("stem", Self::Stem),
    ];
}

/// One sort of blossom, catkin, fruit or cone. In a text each is a table `[[organs]]`, of which there are at most
/// [`MOST`](Self::MOST).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Organ {
    /// The form with which it is drawn.
    pub kind: OrganKind,
    /// Its place on the shoots.
    pub place: OrganPlace,
    /// The part of these places that bear any, 0 to 1.
    pub share: f32,
    /// Along shoots: from one place to the next, metres, 0.005 to 5.
    pub spacing: f32,
    /// Organs at one place: fewest and most, 1 to 200.
    pub bunch: [f32; 2],
    /// Range of heights in the crown at which it is borne: parts of the way from the crown's base
    /// to its top, 0 to 1.
    pub heights: [f32; 2],
    /// Its length, metres, 0.001 to 2.
    pub size: f32,
    /// Largest deviation of single ones from this size, as a part of it, 0 to 0.9.
    pub variation: f32,
    /// Its greatest width over its length, 0.02 to 4.
    pub width: f32,
    /// Its stalk, in lengths of its own, 0 to 20.
    pub stalk: f32,
    /// Angle to the shoot, degrees, 0 to 180.
    pub angle: f32,
    /// Upward tendency, or, if negative, downward, -10 to 10; as
    /// [`Foliage::with_rise`](crate::foliage::Foliage::with_rise).
    pub rise: f32,
    /// Two colours between which single ones vary, sRGB.
    pub colors: [f32; 6],
    /// Days: the first one is there, all are there, the first one falls, the last has fallen, 1 to 732, ascending. Days
    /// after 366 are of the next year; `[1, 1, 732, 732]` is always.
    pub days: [f32; 4],
}

impl Default for Organ {
    fn default() -> Self {
        Self {
            kind: OrganKind::Flower,
            place: OrganPlace::ShortShoots,
            share: 0.5,
            spacing: 0.05,
            bunch: [1.0, 3.0],
            heights: [0.0, 1.0],
            size: 0.03,
            variation: 0.2,
            width: 1.0,
            stalk: 0.5,
            angle: 40.0,
            rise: 0.0,
            colors: [245.0, 240.0, 236.0, 244.0, 222.0, 226.0],
            days: [105.0, 115.0, 125.0, 135.0],
        }
    }
}

impl Organ {
    /// The most sorts that a species can have.
    pub const MOST: usize = 8;

    pub(super) fn fields(&mut self, fields: &mut impl Fields) {
        fields.choice("kind", &mut self.kind);
        fields.choice("place", &mut self.place);
        fields.number("share", &mut self.share, [0.0, 1.0]);
        fields.number("spacing", &mut self.spacing, [0.005, 5.0]);
        fields.ascending("bunch", &mut self.bunch, [1.0, 200.0]);
        fields.ascending("heights", &mut self.heights, [0.0, 1.0]);
        fields.number("size", &mut self.size, [0.001, 2.0]);
        fields.number("variation", &mut self.variation, [0.0, 0.9]);
        fields.number("width", &mut self.width, [0.02, 4.0]);
        fields.number("stalk", &mut self.stalk, [0.0, 20.0]);
        fields.number("angle", &mut self.angle, [0.0, 180.0]);
        fields.number("rise", &mut self.rise, [-10.0, 10.0]);
        fields.numbers("colors", &mut self.colors, [0.0, 255.0]);
        fields.ascending("days", &mut self.days, [1.0, 732.0]);
    }
}
