//! Species as data: the numbers of their text files.

use super::organ::Organ;
use super::text::Choice;
use crate::foliage::Arrangement;

/// A species as data: sizes, architecture, shoots, leaves and bark. Each part documents its fields; the same names
/// stand in the text form ([`Species::parse`], [`Species::to_text`]).
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Species {
    /// The English name, e.g. `silver birch`.
    pub name: String,
    /// The Latin name, e.g. `Betula pendula`.
    pub latin: String,
    /// Other names it is found by, separated by commas.
    pub aliases: String,
    /// One line on what makes it known.
    pub about: String,
    /// Its size.
    pub size: Size,
    /// Its stem.
    pub trunk: Trunk,
    /// The outline of its crown.
    pub crown: Crown,
    /// Branches of the first order.
    pub limbs: Limbs,
    /// Branches of the second order.
    pub branches: Laterals,
    /// Branches of the third order.
    pub twigs: Laterals,
    /// Shoots of the last year or two, which end everything.
    pub shoots: Shoots,
    /// Its leaves.
    pub leaves: LeafData,
    /// Its bark.
    pub bark: BarkData,
    /// Its blossom, catkins, fruit and cones.
    pub organs: Vec<Organ>,
}

/// Size of a species. Values "at" two trunks are for diameters of 20 and 40 cm at 1.3 m; in between
/// and beyond they follow a power of the diameter.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Size {
    /// Least and greatest height, metres.
    pub height: [f32; 2],
    /// Least and greatest diameter of the trunk at 1.3 m, metres.
    pub diameter: [f32; 2],
    /// Diameter of the trunk that is grown if nothing is asked for, metres: the median.
    pub usual_diameter: f32,
    /// Height at trunks of 20 and 40 cm, metres.
    pub height_at: [f32; 2],
    /// Mean diameter of the crown at trunks of 20 and 40 cm, metres.
    pub width_at: [f32; 2],
    /// One-sided area of all leaves at trunks of 20 and 40 cm, square metres.
    pub leaf_area_at: [f32; 2],
    /// Spread of height, crown diameter and leaf area about these: standard deviations of logarithms.
    pub spread: [f32; 3],
    /// Least and greatest height over diameter of the trunk that occur.
    pub slenderness: [f32; 2],
    /// Growth of a young trunk's diameter, metres per year.
    pub growth: f32,
}

impl Default for Size {
    fn default() -> Self {
        Self {
            height: [2.0, 30.0],
            diameter: [0.02, 1.5],
            usual_diameter: 0.35,
            height_at: [8.5, 12.0],
            width_at: [5.5, 8.5],
            leaf_area_at: [60.0, 240.0],
            spread: [0.1, 0.08, 0.15],
            slenderness: [8.0, 120.0],
            growth: 0.007,
        }
    }
}

/// The stem of a species.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Trunk {
    /// Stems from the ground: fewest and most.
    pub stems: [f32; 2],
    /// Share of the height up to which there is one stem; 1 for a leader to the very top.
    pub leader: f32,
    /// Limbs into which it divides where the leader ends: fewest and most.
    pub forks: [f32; 2],
    /// Angle of these to the vertical, degrees.
    pub fork_angle: f32,
    /// Lean of the stem, degrees.
    pub lean: f32,
    /// Bend along its way, degrees.
    pub sweep: f32,
    /// Diameter at a quarter, half and three quarters of the height over that at 1.3 m.
    pub profile: [f32; 3],
    /// Share by which the base is thicker than the taper alone gives.
    pub flare: f32,
    /// Roots that show at the base of the trunk: fewest and most.
    pub roots: [f32; 2],
    /// Height of the crown's base over that of the tree: in the open, and crowded in a stand.
    pub clear: [f32; 2],
}

impl Default for Trunk {
    fn default() -> Self {
        Self {
            stems: [1.0; 2],
            leader: 1.0,
            forks: [2.0, 3.0],
            fork_angle: 28.0,
            lean: 2.0,
            sweep: 3.0,
            profile: [0.83, 0.64, 0.40],
            flare: 0.3,
            roots: [5.0, 8.0],
            clear: [0.2, 0.55],
        }
    }
}

/// The outline of a crown.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Crown {
    /// Radii from the crown's base to its top at even distances, parts of the largest; 2 to 12 of them.
    pub profile: Vec<f32>,
    /// Offset of the crown's middle from the stem, as a share of its mean radius: least and most.
    pub eccentricity: [f32; 2],
    /// Bulges and bays of the outline, parts of the radius.
    pub roughness: f32,
    /// The part of the shoots, those in the deepest shade, that dies.
    pub shed: f32,
}

impl Default for Crown {
    fn default() -> Self {
        Self {
            profile: vec![0.7, 0.95, 1.0, 0.9, 0.65, 0.25],
            eccentricity: [0.12, 0.36],
            roughness: 0.12,
            shed: 0.25,
        }
    }
}

/// Branches of the first order. Pairs are for the crown's base and its top; in between they change evenly.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Limbs {
    /// Number in all, if they stand one at a time.
    pub count: f32,
    /// Distance of whorls, metres; 0 if limbs stand one at a time.
    pub whorl_spacing: f32,
    /// Limbs of a whorl: fewest and most.
    pub whorl: [f32; 2],
    /// Weak limbs between two whorls.
    pub between: f32,
    /// Angle to the stem, degrees.
    pub angle: [f32; 2],
    /// Spread of that angle, degrees.
    pub angle_spread: f32,
    /// Upward turn of a limb at its middle, degrees; negative: downwards.
    pub rise: [f32; 2],
    /// The same at its end.
    pub rise_at_end: [f32; 2],
    /// Fraction by which weak limbs fall short of the crown's outline, 0 to 1.
    pub unequal: f32,
    /// Crookedness: the mean turn over one metre, degrees; over other ways it grows with their square root.
    pub crooked: f32,
    /// The inner part of a limb without branches.
    pub bare: f32,
    /// Least and greatest length, metres; 0 and 0 if limbs reach for the crown's outline.
    pub length: [f32; 2],
    /// Limbs that leave a limb on its way and are as strong: the mean number on one as long as the crown's radius.
    pub forks: f32,
    /// Angle of these to the limb, degrees.
    pub forks_angle: f32,
    /// Greatest radius of a limb over that of its stem.
    pub thickest: f32,
    /// Dead limbs per metre of stem below the crown: in the open, and crowded in a stand.
    pub dead: [f32; 2],
}

impl Default for Limbs {
    fn default() -> Self {
        Self {
            count: 14.0,
            whorl_spacing: 0.0,
            whorl: [1.0; 2],
            between: 0.0,
            angle: [65.0, 35.0],
            angle_spread: 8.0,
            rise: [10.0, 5.0],
            rise_at_end: [20.0, 10.0],
            unequal: 0.4,
            crooked: 8.0,
            bare: 0.2,
            length: [0.0; 2],
            forks: 0.0,
            forks_angle: 38.0,
            thickest: 0.86,
            dead: [0.0; 2],
        }
    }
}

/// Arrangement of laterals about their parent branch.
///
/// ```
/// use treesynth::species::{Species, Stand};
///
/// let mut own = Species::default();
/// own.shoots.stand = Stand::Decussate;
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum Stand {
    /// Each 137.5° around from the one before.
    #[default]
    Spiral,
    /// On two sides in turn, in a level plane.
    TwoRanked,
    /// Pairs, each at a right angle to the one before.
    Decussate,
    /// Pairs in a level plane.
    Paired,
    /// In threes and more at one height, as the last whorl of each year's shoot.
    Whorled,
}

impl Choice for Stand {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("spiral", Self::Spiral),
        ("two-ranked", Self::TwoRanked),
        ("decussate", Self::Decussate),
        ("paired", Self::Paired),
        ("whorled", Self::Whorled),
    ];
}

/// Branches of a higher order.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Laterals {
    /// Arrangement.
    pub stand: Stand,
    /// Distance of one from the next along their parent branch, metres.
    pub spacing: f32,
    /// Angle to their parent branch, degrees.
    pub angle: f32,
    /// Spread of that angle, degrees.
    pub angle_spread: f32,
    /// Length over the length of the parent branch, for the longest; those nearer its end are
    /// shorter.
    pub ratio: f32,
    /// Least and greatest length, metres.
    pub length: [f32; 2],
    /// Upward turn along their way, as a share of a right angle; negative: they hang.
    pub rise: f32,
    /// Flattening towards the horizontal plane: 0 none, 1 flat sprays.
    pub flat: f32,
    /// Crookedness: the mean turn over one metre, degrees; over other ways it grows with their square root.
    pub crooked: f32,
    /// The inner part without laterals of its own.
    pub bare: f32,
    /// Fraction by which weak laterals are shorter than their position alone gives, 0 to 1.
    pub unequal: f32,
}

impl Default for Laterals {
    fn default() -> Self {
        Self {
            stand: Stand::Spiral,
            spacing: 0.3,
            angle: 50.0,
            angle_spread: 10.0,
            ratio: 0.5,
            length: [0.15, 6.0],
            rise: 0.2,
            flat: 0.4,
            crooked: 15.0,
            bare: 0.15,
            unequal: 0.5,
        }
    }
}

/// Shoots of the last year or two.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Shoots {
    /// Radius of a shoot, millimetres: the mean.
    pub radius: f32,
    /// Its coefficient of variation.
    pub radius_cv: f32,
    /// Length of a long shoot, metres: the median.
    pub length: f32,
    /// Standard deviation of its logarithm.
    pub length_spread: f32,
    /// The part of all shoots that are short.
    pub short: f32,
    /// Length of a short shoot, metres.
    pub short_length: f32,
    /// Distance of one from the next, metres.
    pub spacing: f32,
    /// Angle to their parent branch, degrees.
    pub angle: f32,
    /// As [`Laterals::rise`].
    pub rise: f32,
    /// Arrangement.
    pub stand: Stand,
}

impl Default for Shoots {
    fn default() -> Self {
        Self {
            radius: 1.3,
            radius_cv: 0.2,
            length: 0.1,
            length_spread: 0.6,
            short: 0.4,
            short_length: 0.015,
            spacing: 0.07,
            angle: 45.0,
            rise: 0.2,
            stand: Stand::Spiral,
        }
    }
}

/// The outlines that leaves are drawn with.
///
/// ```
/// use treesynth::species::{LeafShape, Species};
///
/// let mut own = Species::default();
/// own.leaves.shape = LeafShape::Heart;
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum LeafShape {
    /// Egg-shaped: beech, cherry, apple, elm, hazel.
    #[default]
    Ovate,
    /// As broad as long with a drawn-out tip: birch, poplar.
    Deltoid,
    /// Heart-shaped: lime.
    Heart,
    /// Long and narrow: willow.
    Lanceolate,
    /// Long, narrow and bent like a sickle: eucalyptus.
    Sickle,
    /// Five pointed lobes: maple, plane.
    Lobed,
    /// Round lobes: oak.
    Sinuate,
    /// Leaflets along a rachis: ash, walnut.
    Pinnate,
    /// Twice pinnate, of tiny leaflets: thorn, acacia.
    Bipinnate,
    /// Leaflets from one point: horse chestnut.
    Palmate,
    /// A short shoot of needles all around: spruce, fir.
    Needles,
    /// A tuft of long needles: pine.
    Tuft,
    /// A spray of scales: cypress.
    Scales,
    /// A long narrow band: the leaflets of palms.
    Strap,
}

impl Choice for LeafShape {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("ovate", Self::Ovate),
        ("deltoid", Self::Deltoid),
        ("heart", Self::Heart),
        ("lanceolate", Self::Lanceolate),
        ("sickle", Self::Sickle),
        ("lobed", Self::Lobed),
        ("sinuate", Self::Sinuate),
        ("pinnate", Self::Pinnate),
        ("bipinnate", Self::Bipinnate),
        ("palmate", Self::Palmate),
        ("needles", Self::Needles),
        ("tuft", Self::Tuft),
        ("scales", Self::Scales),
        ("strap", Self::Strap),
    ];
}

/// The leaves of a species.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct LeafData {
    /// Style in which they are drawn.
    pub shape: LeafShape,
    /// Length of a blade (of a shoot or tuft with its needles), metres.
    pub length: f32,
    /// Length of the petiole over that of the blade.
    pub petiole: f32,
    /// Arrangement: `spiral`, `two-ranked`, `decussate` or `paired`.
    pub stand: Stand,
    /// Distance of one from the next along a shoot, metres, before the tree's leaf area is met.
    pub spacing: f32,
    /// Greatest distance of leaves from a shoot's end, metres.
    pub reach: f32,
    /// Angle to the shoot, degrees.
    pub angle: f32,
    /// Rise or, if negative, droop; as [`Foliage::with_rise`](crate::foliage::Foliage::with_rise).
    pub rise: f32,
    /// Turn to the light, 0 to 1.
    pub turn: f32,
    /// Random deviation of each, radians.
    pub disorder: f32,
    /// `true` if leaves stay over the winter.
    pub evergreen: bool,
    /// Colour in summer, sRGB.
    pub summer: [f32; 3],
    /// Two colours between which they turn in autumn, sRGB.
    pub autumn: [f32; 6],
    /// Days of the year, of the northern half: first leaves, all leaves, first colours, last leaf.
    pub days: [f32; 4],
}

impl Default for LeafData {
    fn default() -> Self {
        Self {
            shape: LeafShape::Ovate,
            length: 0.07,
            petiole: 0.2,
            stand: Stand::Spiral,
            spacing: 0.03,
            reach: 0.3,
            angle: 52.0,
            rise: 0.0,
            turn: 0.7,
            disorder: 0.35,
            evergreen: false,
            summer: [86.0, 122.0, 52.0],
            autumn: [196.0, 150.0, 50.0, 150.0, 90.0, 40.0],
            days: [105.0, 140.0, 265.0, 320.0],
        }
    }
}

impl LeafData {
    pub(super) fn arrangement(&self) -> Arrangement {
        match self.stand {
            Stand::Spiral => Arrangement::SPIRAL,
            Stand::TwoRanked => Arrangement::Alternate,
            Stand::Decussate => Arrangement::Decussate,
            Stand::Paired => Arrangement::Opposite,
            Stand::Whorled => Arrangement::Whorled(3),
        }
    }
}

/// The kinds of bark.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum BarkForm {
    /// Even, with fine lines at most: beech.
    #[default]
    Smooth,
    /// Deep furrows between ridges: oak, lime, willow.
    Fissured,
    /// A net of ridges with diamonds between them: ash, walnut.
    Netted,
    /// Plates: pine.
    Plated,
    /// Small scales: spruce, maple.
    Scaly,
    /// White, peeling in strips across: birch.
    Papery,
    /// Patches of several colours: plane.
    Mottled,
    /// Long ribbons that fall and leave streaks of several colours along the trunk: eucalyptus.
    Ribboned,
    /// Lines of pores around: cherry.
    Banded,
    /// Strips of fibre: cypress.
    Stringy,
    /// Rings of leaf scars: palm.
    Ringed,
}

impl Choice for BarkForm {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("smooth", Self::Smooth),
        ("fissured", Self::Fissured),
        ("netted", Self::Netted),
        ("plated", Self::Plated),
        ("scaly", Self::Scaly),
        ("papery", Self::Papery),
        ("mottled", Self::Mottled),
        ("ribboned", Self::Ribboned),
        ("banded", Self::Banded),
        ("stringy", Self::Stringy),
        ("ringed", Self::Ringed),
    ];
}

/// The bark of a species.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct BarkData {
    /// Traits on an old trunk.
    pub kind: BarkForm,
    /// Colour of an old trunk, sRGB.
    pub trunk: [f32; 3],
    /// Colour of limbs, sRGB.
    pub limbs: [f32; 3],
    /// Colour of twigs, sRGB.
    pub twigs: [f32; 3],
    /// Colour of an old trunk's base, up to a height of three of its diameters, sRGB: birches turn
    /// black there. 0, 0, 0: the trunk's.
    pub foot: [f32; 3],
    /// Side of the tile of images, metres: ridges, plates and lenticels grow with it. 0: the kind's
    /// own.
    pub tile: f32,
    /// Depth of the oldest bark, metres, at most a quarter of the tile. 0: the kind's own.
    pub depth: f32,
    /// Colours of the outer surface, of hollows, and of special parts (lenticels, fresh flakes,
    /// lichen), sRGB: only their differences count, for their mean becomes that of the trunk. All
    /// 0: the kind's own.
    pub palette: [f32; 9],
    /// Spread of the colours about their mean, 0 (all the same) to 2; 1: as in the palette.
    pub spread: f32,
}

impl Default for BarkData {
    fn default() -> Self {
        Self {
            kind: BarkForm::Smooth,
            trunk: [112.0, 100.0, 86.0],
            limbs: [112.0, 100.0, 86.0],
            twigs: [92.0, 78.0, 64.0],
            foot: [0.0; 3],
            tile: 0.0,
            depth: 0.0,
            palette: [0.0; 9],
            spread: 1.0,
        }
    }
}
