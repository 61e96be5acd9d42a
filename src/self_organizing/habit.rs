//! Growth parameters of a species: vigor, shoots, shedding and width.

use super::axis::Axis;
use super::cut::Regrowth;
use super::dead::DeadWood;
use super::offspring::Offspring;
use super::phyllotaxis::Phyllotaxis;
use super::sag::Sag;
use super::stature::Stature;
use super::vigor::VigorModel;
use crate::ParameterError;
use crate::math::UP;
use glam::Vec3;

/// Parameters of one species, the defaults those of the original program.
///
/// A value is checked where growth starts, and may change between seasons: [`Forest::habits_mut`].
///
/// [`Forest::habits_mut`]: super::Forest::habits_mut
///
/// ```
/// use treesynth::self_organizing::{Habit, VigorModel};
///
/// let spruce = Habit::default().with_vigor_model(VigorModel::BorchertHonda { apical_control: 0.6 });
/// assert!(spruce.check().is_ok());
/// assert!(spruce.with_length(f32::NAN).check().is_err());
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
#[must_use]
pub struct Habit {
    pub(super) vigor_model: VigorModel,
    pub(super) vigor_multiplier: f32,
    pub(super) length: f32,
    pub(super) lateral_angle: f32,
    pub(super) phyllotaxis: Phyllotaxis,
    pub(super) default_weight: f32,
    pub(super) optimal_weight: f32,
    pub(super) tropism: Vec3,
    pub(super) tropism_weight: f32,
    pub(super) shedding: Option<Shedding>,
    pub(super) offspring: Option<Offspring>,
    pub(super) width_exponent: f32,
    pub(super) tip_radius: f32,
    pub(super) shade: Option<f32>,
    pub(super) shade_tolerance: f32,
    pub(super) regrowth: Option<Regrowth>,
    pub(super) stature: Option<Stature>,
    pub(super) axes: Vec<Axis>,
    pub(super) sag: Option<Sag>,
    pub(super) dead_wood: Option<DeadWood>,
}

impl Habit {
    /// Traits of axes by order; set by [`with_axes`](Self::with_axes).
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The weight that [`with_tropism`](Self::with_tropism) sets.
    pub fn tropism_weight(&self) -> f32 {
        self.tropism_weight
    }
}

crate::recipe::readable!(Habit {
    vigor_model: VigorModel, vigor_multiplier: f32, lateral_angle: f32, phyllotaxis: Phyllotaxis,
    default_weight: f32, optimal_weight: f32, tropism: Vec3, shedding: Option<Shedding>,
    offspring: Option<Offspring>, width_exponent: f32, tip_radius: f32, regrowth: Option<Regrowth>,
    stature: Option<Stature>, sag: Option<Sag>, dead_wood: Option<DeadWood>,
});

/// When a tree gives up a branch: once its vigor falls below `multiplier · (child count^(1/n))^exponent`, the
/// branch's width being the measure of what it costs, and it is older than a period of grace.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Shedding {
    pub(super) multiplier: f32,
    pub(super) exponent: f32,
    pub(super) grace: u16,
}

crate::recipe::readable!(Shedding { multiplier: f32, exponent: f32, grace: u16 });

impl Default for Shedding {
    /// Multiplier 0.3, exponent 1.5, a grace of 4 seasons: the original's.
    fn default() -> Self {
        Self { multiplier: 0.3, exponent: 1.5, grace: 4 }
    }
}

impl Shedding {
    /// Multiplier 0.95, exponent 2.2, a grace of 4 seasons: the shedding of a stand that thins itself.
    ///
    /// The exponent says whether a dense stand goes on thinning. With that of the default, 1.5, neighbours that have
    /// outlived their fifth season stand side by side for ever. The need of a stem rises with its cross-section, for each
    /// living pipe must be fed (Shinozaki et al. 1964, "A quantitative analysis of plant form: the pipe model theory"), so
    /// with an exponent of about 2: then the light of a crown between neighbours no longer pays for the stem that carries
    /// it, the weaker die, and mean stem mass goes with density to the power of -3/2, the self-thinning rule of Yoda et
    /// al. 1963. Measured over 22 seasons of 676 trees with metamers of 0.1 m, 0.5, 0.7 and 0.9 m apart, six seeds each:
    /// -1.32 to -1.77 for an apical control of 0.53; -1.56 to -1.88 for 0.5 and 0.55. A larger multiplier or exponent
    /// thins faster along a flatter line.
    pub fn self_thinning() -> Self {
        Self { multiplier: 0.95, exponent: 2.2, grace: 4 }
    }

    /// Sets the vigor a branch of one bud needs, in [0, 1e6]; 0.3 by default. At 0 nothing is shed.
    pub fn with_multiplier(mut self, multiplier: f32) -> Self {
        self.multiplier = multiplier;
        self
    }

    /// Sets how steeply the need grows with the width, in [0, 10]; 1.5 by default.
    pub fn with_exponent(mut self, exponent: f32) -> Self {
        self.exponent = exponent;
        self
    }

    /// Sets the seasons before a metamer may be shed; 4 by default.
    pub fn with_grace(mut self, seasons: u16) -> Self {
        self.grace = seasons;
        self
    }
}

impl Default for Habit {
    /// The original's: extended Borchert-Honda with apical control 0.5, vigor multiplier 2, metamers of 0.02 m,
    /// lateral buds scattered within 45°, weights 1 (default), 0.1 (optimal) and 0 (its tropism is off), its
    /// shedding, no offspring, width exponent 2.5, tips of 0.5 mm. Ours: regrowth at cuts, no stature, all axes alike, no
    /// sag, no dead wood.
    fn default() -> Self {
        Self {
            vigor_model: VigorModel::default(),
            vigor_multiplier: 2.0,
            length: 0.02,
            lateral_angle: std::f32::consts::FRAC_PI_4,
            phyllotaxis: Phyllotaxis::Scattered,
            default_weight: 1.0,
            optimal_weight: 0.1,
            tropism: UP,
            tropism_weight: 0.0,
            shedding: Some(Shedding::default()),
            offspring: None,
            width_exponent: 2.5,
            tip_radius: 0.0005,
            shade: None,
            shade_tolerance: 1.0,
            regrowth: Some(Regrowth::default()),
            stature: None,
            axes: Vec::new(),
            sag: None,
            dead_wood: None,
        }
    }
}

impl Habit {
    /// Sets how vigor is shared among buds.
    pub fn with_vigor_model(mut self, model: VigorModel) -> Self {
        self.vigor_model = model;
        self
    }

    /// Sets the vigor a tree has for each unit of light, in [0, 1e6]; 2 by default. The most important number for how
    /// fast and how large a tree grows.
    pub fn with_vigor_multiplier(mut self, multiplier: f32) -> Self {
        self.vigor_multiplier = multiplier;
        self
    }

    /// Sets the length of a metamer, metres, in [1e-6, 1e3]; 0.02 by default. A shoot of vigor v has floor(v)
    /// metamers of length · v / floor(v).
    pub fn with_length(mut self, metres: f32) -> Self {
        self.length = metres;
        self
    }

    /// Sets the angle between a lateral bud and its metamer, radians, in [0, π]; 45° by default.
    pub fn with_lateral_angle(mut self, radians: f32) -> Self {
        self.lateral_angle = radians;
        self
    }

    /// Sets how lateral buds stand around the axis.
    pub fn with_phyllotaxis(mut self, phyllotaxis: Phyllotaxis) -> Self {
        self.phyllotaxis = phyllotaxis;
        self
    }

    /// Sets the weight of the direction a shoot already has, in [0, 1e3]; 1 by default.
    pub fn with_default_weight(mut self, weight: f32) -> Self {
        self.default_weight = weight;
        self
    }

    /// Sets the weight of the environment's optimal direction, in [-1e3, 1e3]; 0.1 by default.
    pub fn with_optimal_weight(mut self, weight: f32) -> Self {
        self.optimal_weight = weight;
        self
    }

    /// Sets the direction of a tropism (down for gravity, along the wind), finite, at most 1e3 long, and its weight,
    /// in [-1e3, 1e3]; none by default.
    pub fn with_tropism(mut self, direction: Vec3, weight: f32) -> Self {
        (self.tropism, self.tropism_weight) = (direction, weight);
        self
    }

    /// Sets when branches are shed; `None` for never.
    pub fn with_shedding(mut self, shedding: impl Into<Option<Shedding>>) -> Self {
        self.shedding = shedding.into();
        self
    }

    /// Sets how the tree sows itself; `None`, the default, for not at all.
    pub fn with_offspring(mut self, offspring: impl Into<Option<Offspring>>) -> Self {
        self.offspring = offspring.into();
        self
    }

    /// Sets n of `w^n = Σ w_child^n`, in (1, 10]; 2.5 by default. Shedding uses it too.
    pub fn with_width_exponent(mut self, exponent: f32) -> Self {
        self.width_exponent = exponent;
        self
    }

    /// Sets the radius of a shoot that carries one bud, metres, in [0, 1e3]; 0.0005 by default.
    pub fn with_tip_radius(mut self, metres: f32) -> Self {
        self.tip_radius = metres;
        self
    }

    /// Sets how much shade each metamer casts, as a multiple of the environment's strength, in [0, 4]. `None`, the
    /// default: in proportion to its length over the width of a cell, at most 1, so that species of short metamers
    /// do not stand in their own light, and divided among the nodes of a whorl.
    pub fn with_shade(mut self, shade: impl Into<Option<f32>>) -> Self {
        self.shade = shade.into();
        self
    }

    /// Sets the shade tolerance, in [1e-3, 1e3]; 1 by default. Shadows count for so many times less: with 2 a tree
    /// grows in twice the shade.
    pub fn with_shade_tolerance(mut self, tolerance: f32) -> Self {
        self.shade_tolerance = tolerance;
        self
    }

    /// Sets what sprouts near a cut; `None` for no more than the bud that takes the place of what was cut.
    pub fn with_regrowth(mut self, regrowth: impl Into<Option<Regrowth>>) -> Self {
        self.regrowth = regrowth.into();
        self
    }

    /// Sets how high the tree grows in the course of its life; `None`, the default, for no limit.
    pub fn with_stature(mut self, stature: impl Into<Option<Stature>>) -> Self {
        self.stature = stature.into();
        self
    }

    /// Sets how limbs bend under their own load; `None`, the default, for not at all.
    pub fn with_sag(mut self, sag: impl Into<Option<Sag>>) -> Self {
        self.sag = sag.into();
        self
    }

    /// Sets how dead trees stand and fall; `None`, the default, for trees that go away when they die.
    pub fn with_dead_wood(mut self, dead: impl Into<Option<DeadWood>>) -> Self {
        self.dead_wood = dead.into();
        self
    }

    /// Sets the architecture by branch order: that of the trunk first, then that of branches of order 1, and so on. The
    /// last holds for all higher orders. None by default: all axes are alike, with the habit's own parameters.
    ///
    /// ```
    /// use treesynth::self_organizing::{Axis, Habit};
    ///
    /// // Level limbs on an upright trunk.
    /// let limbs = Axis::default().with_angle(1.2).with_level_weight(0.3).with_optimal_weight(0.02);
    /// let spruce = Habit::default().with_axes([Axis::default(), limbs]);
    /// assert!(spruce.check().is_ok());
    /// ```
    pub fn with_axes(mut self, axes: impl IntoIterator<Item = Axis>) -> Self {
        self.axes = axes.into_iter().collect();
        self
    }

    /// The length of a metamer, metres.
    pub fn length(&self) -> f32 {
        self.length
    }

    /// Value set by [`with_shade`](Self::with_shade).
    pub fn shade(&self) -> Option<f32> {
        self.shade
    }

    /// Value set by [`with_shade_tolerance`](Self::with_shade_tolerance).
    pub fn shade_tolerance(&self) -> f32 {
        self.shade_tolerance
    }

    /// Checks that all parameters are in range.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.vigor_model.check()?;
        within("Habit.vigor_multiplier", self.vigor_multiplier, 0.0, 1e6)?;
        within("Habit.length", self.length, 1e-6, 1e3)?;
        within("Habit.lateral_angle", self.lateral_angle, 0.0, std::f32::consts::PI)?;
        self.phyllotaxis.check()?;
        within("Habit.default_weight", self.default_weight, 0.0, 1e3)?;
        within("Habit.optimal_weight", self.optimal_weight, -1e3, 1e3)?;
        let length = self.tropism.length();
        ParameterError::unless(length <= 1e3, "Habit.tropism", self.tropism, "finite, at most 1000 long")?;
        within("Habit.tropism_weight", self.tropism_weight, -1e3, 1e3)?;
        if let Some(shedding) = self.shedding {
            within("Shedding.multiplier", shedding.multiplier, 0.0, 1e6)?;
            within("Shedding.exponent", shedding.exponent, 0.0, 10.0)?;
        }
        if let Some(offspring) = self.offspring {
            offspring.check()?;
        }
        let n = self.width_exponent;
        ParameterError::unless(n > 1.0 && n <= 10.0, "Habit.width_exponent", n, "above 1, at most 10")?;
        within("Habit.tip_radius", self.tip_radius, 0.0, 1e3)?;
        within("Habit.shade", self.shade.unwrap_or_default(), 0.0, 4.0)?;
        within("Habit.shade_tolerance", self.shade_tolerance, 1e-3, 1e3)?;
        self.regrowth.map_or(Ok(()), Regrowth::check)?;
        self.stature.map_or(Ok(()), Stature::check)?;
        self.sag.map_or(Ok(()), Sag::check)?;
        self.dead_wood.map_or(Ok(()), DeadWood::check)?;
        self.axes.iter().try_for_each(Axis::check)
    }

    /// Differences of the axes of `order`.
    #[inline]
    pub(super) fn axis(&self, order: u8) -> Option<&Axis> {
        self.axes.get(usize::from(order)).or(self.axes.last())
    }

    /// The angle between branches of `order` and their parent branch, radians.
    pub(super) fn angle_of(&self, order: u8) -> f32 {
        self.axis(order).and_then(|axis| axis.angle).unwrap_or(self.lateral_angle)
    }

    /// The direction after `direction`, one metamer on, of an axis of `order`.
    pub(super) fn turned(&self, direction: Vec3, optimal: Vec3, order: u8) -> Vec3 {
        let Some(axis) = self.axis(order) else {
            let wanted = direction * self.default_weight
                + optimal * self.optimal_weight
                + self.tropism * self.tropism_weight;
            return wanted.normalize_or(direction);
        };
        let level = direction.with_y(0.0).normalize_or_zero();
        let wanted = direction * self.default_weight
            + optimal * axis.optimal_weight.unwrap_or(self.optimal_weight)
            + self.tropism * axis.tropism_weight.unwrap_or(self.tropism_weight)
            + level * axis.level_weight
            + UP * axis.up_weight;
        wanted.normalize_or(direction)
    }
}

pub(super) fn within(parameter: &str, value: f32, least: f32, most: f32) -> Result<(), ParameterError> {
    if (least..=most).contains(&value) {
        return Ok(());
    }
    Err(ParameterError::new(parameter, format_args!("{value:?}"), format!("in [{least:?}, {most:?}]")))
}
