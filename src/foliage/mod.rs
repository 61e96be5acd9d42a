//! Leaves: where they go, and what they look like.
//!
//! [`Foliage`] places a [`Leaf`] along the twigs of a [`Skeleton`]; what comes out is one mesh and many
//! [`Instance`]s of it, never copied triangles.
//!
//! ```
//! use treesynth::foliage::{Arrangement, Foliage, Leaf};
//! use treesynth::{Skeleton, glam::Vec3};
//!
//! let twig = Skeleton::new(vec![Vec3::ZERO, Vec3::Y * 0.28], vec![None, Some(0)])?.with_radii(vec![0.003; 2])?;
//! let maple = Foliage::new(Leaf::lobed().with_petiole(0.6))
//!     .with_arrangement(Arrangement::Decussate)
//!     .with_spacing(0.05);
//! let leaves = maple.place(&twig, 7)?;
//! // Pairs 0, 5, 10, 15, 20 and 25 cm from the tip.
//! assert_eq!(leaves.instances.len(), 12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arrangement;
mod grown;
mod leaf;
mod measure;
mod normals;
mod place;
mod shade;
mod sketch;
mod wind;

pub use arrangement::Arrangement;
pub use leaf::Leaf;
#[cfg(feature = "texture")]
pub(crate) use normals::bend_about;
pub use normals::bend_normals;
#[cfg(feature = "texture")]
pub(crate) use shade::Canopy;
pub use wind::LeafWind;

use crate::math::UP;
use crate::observer::{Cancelled, Observer, Silent, Watch, Work};
use crate::surface::{Instance, Material, Part};
use crate::{ParameterError, Skeleton};
use glam::Vec3;
use std::f32::consts::PI;

/// Most leaves of one tree, 16.8 million: 800 MB of instances.
const MOST_LEAVES: f64 = (1 << 24) as f64;

/// Error of placing leaves.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FoliageError {
    /// An option out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The observer cancelled the work.
    #[error("cancelled by the observer")]
    Cancelled,
    /// Every radius is zero: no radius model has been applied yet.
    #[error("all {nodes} nodes have the radius zero; give them some, e.g. by radius::PipeModel")]
    NoRadii {
        /// The number of nodes.
        nodes: usize,
    },
    /// More leaves than memory should be asked for.
    #[error("there would be {leaves:e} leaves, but at most {MOST_LEAVES:e} are placed; space them wider")]
    TooMany {
        /// An upper bound of the leaves before thinning.
        leaves: f64,
    },
    /// A leaf is so far from the origin that 32-bit floats cannot tell its corners apart.
    #[error(
        "at {position} m 32-bit floats have steps of {step} m, too coarse for the shape of a leaf of {length} m; \
         subtract an offset, such as the trunk base, from the positions, place leaves there, and move them back in \
         64-bit numbers"
    )]
    Shapeless {
        /// Position of the leaf, metres.
        position: Vec3,
        /// Distance between neighbouring 32-bit floats there, metres.
        step: f32,
        /// The size of the leaf, metres.
        length: f32,
    },
}

impl From<Cancelled> for FoliageError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// The leaves of a tree.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Leaves {
    /// Look of each of them.
    pub leaf: Leaf,
    /// Their places: branch by branch, on each from its tip backwards.
    pub instances: Vec<Instance>,
}

impl Leaves {
    /// The leaves as a part named `leaves`, to be written or drawn.
    pub fn part(&self) -> Part<'_> {
        Part::new(self.leaf.mesh())
            .with_name("leaves")
            .with_material(self.leaf.material())
            .with_instances(&self.instances)
    }
}

/// Places leaves along the twigs of a tree.
///
/// On every branch leaves stand at even distances from its tip backwards, on the bark: their distance from the axis is
/// the branch's radius there. They leave the axis at an [angle](Self::with_angle), rise or hang, and turn about their
/// midribs to the light. No leaf stands inside of the branch that bears the twig.
///
/// Random numbers are drawn for each leaf from its branch and its number on it, so leaves stay where they are
/// when others are [thinned](Self::with_kept) out. O(nodes + leaves) time; 48 bytes of memory per leaf.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Foliage {
    leaf: Leaf,
    arrangement: Arrangement,
    spacing: f32,
    size: f32,
    size_at_tip: f32,
    size_by_order: f32,
    size_variation: f32,
    reach: f32,
    thickest: f32,
    angle: f32,
    rise: f32,
    light: Vec3,
    turn: f32,
    disorder: f32,
    kept: f32,
    tint_variation: f32,
}

impl Foliage {
    /// The leaf's material, set by [`with_material`](Self::with_material).
    pub fn material(&self) -> Material {
        self.leaf.material()
    }
}

crate::recipe::readable!(Foliage {
    arrangement: Arrangement,
    spacing: f32,
    size: f32,
    size_at_tip: f32,
    size_by_order: f32,
    size_variation: f32,
    reach: f32,
    thickest: f32,
    angle: f32,
    rise: f32,
    light: Vec3,
    turn: f32,
    disorder: f32,
    kept: f32,
    tint_variation: f32,
});

impl Foliage {
    /// These leaves, in the default manner of each option below: one every 3 cm in turn on both sides, 7 cm long,
    /// within 0.6 m of tips and on what is thinner than 4 cm.
    pub fn new(leaf: Leaf) -> Self {
        Self {
            leaf,
            arrangement: Arrangement::Alternate,
            spacing: 0.03,
            size: 0.07,
            size_at_tip: 0.7,
            size_by_order: 1.0,
            size_variation: 0.2,
            reach: 0.6,
            thickest: 0.02,
            angle: 0.9,
            rise: 0.0,
            light: UP,
            turn: 0.7,
            disorder: 0.25,
            kept: 1.0,
            tint_variation: 0.0,
        }
    }

    /// Arrangement of leaves about the twig; default [`Arrangement::Alternate`].
    pub fn with_arrangement(mut self, arrangement: Arrangement) -> Self {
        self.arrangement = arrangement;
        self
    }

    /// Length of twig from one leaf, pair or whorl to the next (a botanist's internode), metres, positive; default
    /// 0.03.
    pub fn with_spacing(mut self, metres: f32) -> Self {
        self.spacing = metres;
        self
    }

    /// Factor by which the leaf's mesh is enlarged, positive; the built-in leaves are 1 long, so that this is their length
    /// in metres. Default 0.07; a mesh of your own in metres wants 1.
    pub fn with_size(mut self, size: f32) -> Self {
        self.size = size;
        self
    }

    /// Size of the leaf at the very tip relative to those where leaves begin, positive; in between linear.
    /// Default 0.7.
    pub fn with_size_at_tip(mut self, ratio: f32) -> Self {
        self.size_at_tip = ratio;
        self
    }

    /// Size of leaves relative to those on the parent branch, positive: leaves have this ratio to the power
    /// of the branch [order](Skeleton::orders) as a factor. Default 1: all alike.
    pub fn with_size_by_order(mut self, ratio: f32) -> Self {
        self.size_by_order = ratio;
        self
    }

    /// Greatest random deviation of a leaf's size, as a share of it, 0 to 0.9, evenly distributed; default 0.2.
    pub fn with_size_variation(mut self, part: f32) -> Self {
        self.size_variation = part;
        self
    }

    /// Greatest distance of leaves from the tips: a place has leaves if the farthest tip that it bears is no
    /// farther than this, metres along the branches, positive; default 0.6. The tips' twigs are leafy, the
    /// limbs are bare.
    pub fn with_reach(mut self, metres: f32) -> Self {
        self.reach = metres;
        self
    }

    /// The radius above which a branch has no leaves, metres, positive; default 0.02.
    pub fn with_thickest(mut self, radius: f32) -> Self {
        self.thickest = radius;
        self
    }

    /// The angle between the twig and its leaves, radians, 0 (along it) to π (back); default 0.9 (52°).
    pub fn with_angle(mut self, angle: f32) -> Self {
        self.angle = angle;
        self
    }

    /// Multiple of the up vector that is added to the direction of leaves, -10 to 10: they rise or, if
    /// negative, hang. Default 0.
    pub fn with_rise(mut self, rise: f32) -> Self {
        self.rise = rise;
        self
    }

    /// Direction of the light that blades turn to; any length but zero; default up.
    pub fn with_light(mut self, towards: Vec3) -> Self {
        self.light = towards;
        self
    }

    /// Share by which blades turn about their midribs to the light, 0 (their upper side faces the twig's tip,
    /// as they grew) to 1 (all the way); default 0.7.
    pub fn with_turn(mut self, share: f32) -> Self {
        self.turn = share;
        self
    }

    /// Greatest random deviation of azimuth, angle and turn of a leaf, radians, 0 to 1; default 0.25.
    pub fn with_disorder(mut self, angle: f32) -> Self {
        self.disorder = angle;
        self
    }

    /// The part of the leaves that is there, 0 to 1; default 1. With one seed, the leaves of a smaller part are among
    /// those of a larger one. A crown stays as dense if the rest are larger: half of the leaves √2 times as long, and so on for
    /// each [level](crate::surface::Levels).
    pub fn with_kept(mut self, share: f32) -> Self {
        self.kept = share;
        self
    }

    /// Greatest random darkening of a leaf's colour, 0 to 0.9: its [tint](Instance::tint) has a
    /// brightness from 1 less this to 1, evenly distributed, and up to a third of this less of red or of blue. Default 0: all
    /// alike; 0.25 looks natural.
    pub fn with_tint_variation(mut self, spread: f32) -> Self {
        self.tint_variation = spread;
        self
    }

    /// Material of the leaf, in another season for example.
    pub fn with_material(mut self, material: Material) -> Self {
        self.leaf = self.leaf.with_material(material);
        self
    }

    /// The leaf that is placed.
    pub fn leaf(&self) -> &Leaf {
        &self.leaf
    }

    /// The leaves of a tree. One that is only a root has none.
    ///
    /// # Errors
    /// An option out of range; radii that are all zero though there are internodes; more than 16.8 million leaves; a leaf so far
    /// out that it is not eight steps of 32-bit floats long, [`FoliageError::Shapeless`].
    pub fn place(&self, skeleton: &Skeleton, seed: u64) -> Result<Leaves, FoliageError> {
        self.place_observed(skeleton, seed, &Silent)
    }

    /// As [`place`](Self::place), reporting progress to `observer`, which can cancel the work.
    ///
    /// # Errors
    /// As [`place`](Self::place), and [`FoliageError::Cancelled`].
    pub fn place_observed(
        &self,
        skeleton: &Skeleton,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<Leaves, FoliageError> {
        let watch = Watch::new(observer, Work::Leaves, 4 * skeleton.len(), place::STEPS);
        let leaves = self.place_watched(skeleton, seed, &watch)?;
        watch.finish()?;
        Ok(leaves)
    }

    /// As [`place`](Self::place), with one step per leaf and one per four nodes.
    pub(crate) fn place_watched(
        &self,
        skeleton: &Skeleton,
        seed: u64,
        watch: &Watch<'_>,
    ) -> Result<Leaves, FoliageError> {
        self.check()?;
        Ok(Leaves { leaf: self.leaf.clone(), instances: place::place(self, skeleton, seed, watch)? })
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.arrangement.check()?;
        let positive = [
            ("spacing", self.spacing),
            ("size", self.size),
            ("size_at_tip", self.size_at_tip),
            ("size_by_order", self.size_by_order),
        ];
        for (name, value) in positive {
            let holds = (1e-6..=1e6).contains(&value);
            ParameterError::unless(holds, &format!("Foliage.{name}"), value, "a millionth to a million")?;
        }
        for (name, value) in [("reach", self.reach), ("thickest", self.thickest)] {
            ParameterError::unless(value > 0.0, &format!("Foliage.{name}"), value, "positive, metres")?;
        }
        for (name, value, most) in [
            ("size_variation", self.size_variation, 0.9),
            ("turn", self.turn, 1.0),
            ("disorder", self.disorder, 1.0),
            ("tint_variation", self.tint_variation, 0.9),
            ("kept", self.kept, 1.0),
        ] {
            let holds = (0.0..=most).contains(&value);
            ParameterError::unless(holds, &format!("Foliage.{name}"), value, &format!("0 to {most}"))?;
        }
        ParameterError::unless((0.0..=PI).contains(&self.angle), "Foliage.angle", self.angle, "0 to π rad")?;
        ParameterError::unless(self.rise.abs() <= 10.0, "Foliage.rise", self.rise, "-10 to 10")?;
        let length = self.light.length();
        let range = "a direction: finite and not zero";
        ParameterError::unless(length > 1e-9 && length < 1e9, "Foliage.light", self.light, range)
    }
}
