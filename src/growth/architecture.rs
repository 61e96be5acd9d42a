//! The parameters that distinguish species: the curves and limits of the paper.

use super::curve::Curve;
use super::phenology::Phenology;
use crate::ParameterError;
use std::f32::consts::TAU;

/// A species: the paper's functions G as [`Curve`]s, with their limits.
///
/// `Architecture::default()` is the paper's, [`cottonwood`](Self::cottonwood); there are seven others. A
/// value is checked where growth starts.
///
/// ```
/// use treesynth::growth::{Curve, Architecture};
///
/// let pollard = Architecture::default().with_height(Curve::new([[0.0, 0.0], [0.2, 2.0], [1.0, 2.5]])?);
/// assert!(pollard.check().is_ok());
/// assert!(pollard.with_years(0).check().is_err());
/// # Ok::<(), treesynth::ParameterError>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Architecture {
    pub(super) years: u16,
    pub(super) least_shoot: f32,
    pub(super) longest_branch: f32,
    pub(super) least_scale: f32,
    pub(super) most_order: u16,
    pub(super) divergence: f32,
    #[cfg_attr(feature = "serde", serde(default = "one"))]
    pub(super) whorl: u16,
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) forking: f32,
    pub(super) stoutness: f32,
    pub(super) twig_radius: f32,
    pub(super) variation: f32,
    pub(super) scale_variation: f32,
    pub(super) tropism: f32,
    pub(super) height: Curve,
    pub(super) young_silhouette: Curve,
    pub(super) mature_silhouette: Curve,
    pub(super) short_heading: Curve,
    pub(super) long_heading: Curve,
    pub(super) branch_scale: Curve,
    pub(super) lifespan: Curve,
    pub(super) metamers: Curve,
    pub(super) shoot_scale: Curve,
    pub(super) branching_angle: Curve,
    pub(super) phenology: Phenology,
}

crate::recipe::readable!(Architecture {
    longest_branch: f32,
    least_scale: f32,
    most_order: u16,
    divergence: f32,
    whorl: u16,
    forking: f32,
    stoutness: f32,
    twig_radius: f32,
    variation: f32,
    scale_variation: f32,
    tropism: f32,
});

crate::recipe::readable!(&Architecture {
    height: Curve,
    young_silhouette: Curve,
    mature_silhouette: Curve,
    short_heading: Curve,
    long_heading: Curve,
    branch_scale: Curve,
    lifespan: Curve,
    metamers: Curve,
    shoot_scale: Curve,
    branching_angle: Curve,
});

impl Architecture {
    /// The greatest age, `y_max`, years, 1 to 1000.
    pub fn with_years(mut self, years: u16) -> Self {
        self.years = years;
        self
    }

    /// The length by which every branch grows every year at least, `l_min`, metres, 0.0001 to 10.
    pub fn with_least_shoot(mut self, metres: f32) -> Self {
        self.least_shoot = metres;
        self
    }

    /// The length from which on a branch takes the [long heading](Self::with_long_heading) alone, `l_max`, metres, 0.001 to
    /// 10,000.
    pub fn with_longest_branch(mut self, metres: f32) -> Self {
        self.longest_branch = metres;
        self
    }

    /// The scale below which there is no branch, `s_min`, 0 to 1.
    pub fn with_least_scale(mut self, scale: f32) -> Self {
        self.least_scale = scale;
        self
    }

    /// The highest order of branches, 0 (a trunk alone) to 16.
    pub fn with_most_order(mut self, order: u16) -> Self {
        self.most_order = order;
        self
    }

    /// The angle from one metamer's leaf and bud to the next one's about the axis, radians, -2π to 2π; the paper's is
    /// 137.5°.
    pub fn with_divergence(mut self, radians: f32) -> Self {
        self.divergence = radians;
        self
    }

    /// Number of leaves, buds and laterals at each metamer, spread evenly around the axis, 1 to 8: 2 for
    /// opposite ones, together with a [divergence](Self::with_divergence) of a right angle for decussate
    /// ones.
    pub fn with_whorl(mut self, count: u16) -> Self {
        self.whorl = count;
        self
    }

    /// Probability that a branch forks at the end of a year's shoot, 0 to 1: into itself and a twin that is
    /// as strong from then on; the two lean away from each other.
    pub fn with_forking(mut self, chance: f32) -> Self {
        self.forking = chance;
        self
    }

    /// Thickness of the trunk base at the greatest age: its radius over the trunk's length if that length is
    /// the [greatest of a branch](Self::with_longest_branch), 0 to 1; otherwise as length to the power of
    /// 1.5, as elastic similarity has it (`McMahon` 1973).
    ///
    /// All other wood follows by the pipe model (Shinozaki and others 1964), `r^a` being in proportion to the number of
    /// metamers ever borne. Its exponent a, in [2, 2.4], is chosen so that the trunk base comes out as thick; twigs get
    /// between half and one and a half of their [radius](Self::with_twig_radius) if that does not suffice.
    pub fn with_stoutness(mut self, ratio: f32) -> Self {
        self.stoutness = ratio;
        self
    }

    /// The radius of a tip, metres, 0.000001 to 1.
    pub fn with_twig_radius(mut self, metres: f32) -> Self {
        self.twig_radius = metres;
        self
    }

    /// Random deviation of directions, 0 to 1: the breadth of a random walk from shoot to shoot along each branch. The
    /// trunk strays a third as far.
    pub fn with_variation(mut self, breadth: f32) -> Self {
        self.variation = breadth;
        self
    }

    /// Greatest share by which a branch's scale and lifespan fall short, 0 to 0.9.
    pub fn with_scale_variation(mut self, part: f32) -> Self {
        self.scale_variation = part;
        self
    }

    /// Turn of branches upwards or, if negative, downwards, the more the nearer to their tips: the weight of
    /// up at the tip relative to that of the heading, -4 to 4. The headings of the curves turn them towards
    /// the parent branch instead, which for twigs is not the light.
    pub fn with_tropism(mut self, share: f32) -> Self {
        self.tropism = share;
        self
    }

    /// `G_h`: the length of the trunk, metres, 0 to 1000, over the greatest age. In each year it grows at least by the
    /// [least shoot](Self::with_least_shoot).
    pub fn with_height(mut self, curve: Curve) -> Self {
        self.height = curve;
        self
    }

    /// `G_s1`: length of branches relative to the parent branch, 0 to 10, over their relative position on it,
    /// when the tree is young. The value is divided by 1.5 for branches of order 1, by 2 for order 2, and so
    /// on ([equation 12](super::equation::higher_order_length)).
    pub fn with_young_silhouette(mut self, curve: Curve) -> Self {
        self.young_silhouette = curve;
        self
    }

    /// `G_s2`: the same when the tree has reached its greatest age; linear in time in between.
    pub fn with_mature_silhouette(mut self, curve: Curve) -> Self {
        self.mature_silhouette = curve;
        self
    }

    /// `G_o1`: the angle between the places of a very short branch and its first heading, radians, -2.5 to
    /// 2.5, positive towards the parent branch, over the relative position on the branch.
    pub fn with_short_heading(mut self, curve: Curve) -> Self {
        self.short_heading = curve;
        self
    }

    /// `G_o2`: the same for branches of the [greatest length](Self::with_longest_branch). Below zero first and above then,
    /// it gives limbs an S.
    pub fn with_long_heading(mut self, curve: Curve) -> Self {
        self.long_heading = curve;
        self
    }

    /// `G_bs`: the scale of branches, 0 to 1, over the relative position on the parent branch at the greatest
    /// age.
    pub fn with_branch_scale(mut self, curve: Curve) -> Self {
        self.branch_scale = curve;
        self
    }

    /// `G_a`: the age at which a branch is lost, years, 0 to 10,000, over its scale. No branch is lost in its first year.
    pub fn with_lifespan(mut self, curve: Curve) -> Self {
        self.lifespan = curve;
        self
    }

    /// `G_m`: the number of metamers of a shoot, 0 to 1000, rounded and at least 1, over its length relative
    /// to the longest shoot of the trunk. It differs by up to two and a third of it where the longest
    /// laterals of successive years would stand less than 40° apart.
    pub fn with_metamers(mut self, curve: Curve) -> Self {
        self.metamers = curve;
        self
    }

    /// `G_ss`: the scale of branches, 0 to 1, over their relative position on the shoot that bears them.
    pub fn with_shoot_scale(mut self, curve: Curve) -> Self {
        self.shoot_scale = curve;
        self
    }

    /// The angle between a branch and its parent branch, radians, 0.05 to 2.8, over the length of its first
    /// shoot relative to the longest shoot of the trunk.
    pub fn with_branching_angle(mut self, curve: Curve) -> Self {
        self.branching_angle = curve;
        self
    }

    /// Events over a year.
    pub fn with_phenology(mut self, phenology: Phenology) -> Self {
        self.phenology = phenology;
        self
    }

    /// The greatest age, years.
    pub fn years(&self) -> u16 {
        self.years
    }

    /// Events over a year.
    pub fn phenology(&self) -> &Phenology {
        &self.phenology
    }

    /// The length by which every branch grows every year at least, metres.
    pub fn least_shoot(&self) -> f32 {
        self.least_shoot
    }

    /// Every curve with the name of its option, for [plots](Curve::svg).
    pub fn curves(&self) -> impl Iterator<Item = (&'static str, &Curve)> {
        self.ranges().into_iter().map(|(name, curve, ..)| (name, curve)).chain(self.phenology.curves())
    }

    /// Each curve of its own with its name, and its least and greatest value.
    fn ranges(&self) -> [(&'static str, &Curve, f32, f32); 10] {
        [
            ("height", &self.height, 0.0, 1000.0),
            ("young_silhouette", &self.young_silhouette, 0.0, 10.0),
            ("mature_silhouette", &self.mature_silhouette, 0.0, 10.0),
            ("short_heading", &self.short_heading, -2.5, 2.5),
            ("long_heading", &self.long_heading, -2.5, 2.5),
            ("branch_scale", &self.branch_scale, 0.0, 1.0),
            ("lifespan", &self.lifespan, 0.0, 10000.0),
            ("metamers", &self.metamers, 0.0, 1000.0),
            ("shoot_scale", &self.shoot_scale, 0.0, 1.0),
            ("branching_angle", &self.branching_angle, 0.05, 2.8),
        ]
    }

    /// Checks that all options are in range. O(points of the curves).
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        let years = self.years;
        ParameterError::unless((1..=1000).contains(&years), "Architecture.years", years, "1 to 1000")?;
        let order = self.most_order;
        ParameterError::unless(order <= 16, "Architecture.most_order", order, "0 to 16")?;
        let whorl = self.whorl;
        ParameterError::unless((1..=8).contains(&whorl), "Architecture.whorl", whorl, "1 to 8")?;
        for (name, value, least, most) in [
            ("forking", self.forking, 0.0, 1.0),
            ("least_shoot", self.least_shoot, 0.0001, 10.0),
            ("longest_branch", self.longest_branch, 0.001, 10000.0),
            ("least_scale", self.least_scale, 0.0, 1.0),
            ("divergence", self.divergence, -TAU, TAU),
            ("stoutness", self.stoutness, 0.0, 1.0),
            ("twig_radius", self.twig_radius, 1e-06, 1.0),
            ("variation", self.variation, 0.0, 1.0),
            ("scale_variation", self.scale_variation, 0.0, 0.9),
            ("tropism", self.tropism, -4.0, 4.0),
        ] {
            let range = format!("{least:?} to {most:?}");
            let holds = (least..=most).contains(&value);
            ParameterError::unless(holds, &format!("Architecture.{name}"), value, &range)?;
        }
        for (name, curve, least, most) in self.ranges() {
            curve.check(&format!("Architecture.{name}"), least, most)?;
        }
        self.phenology.check()
    }
}

#[cfg(feature = "serde")]
fn one() -> u16 {
    1
}
