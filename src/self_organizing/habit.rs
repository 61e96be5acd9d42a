//! How a species grows: the parameters of vigor, shoots, shedding and width.

use super::offspring::Offspring;
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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
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
}

/// In which direction lateral buds point.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Phyllotaxis {
    /// Anywhere within the lateral angle of the metamer's direction, each direction as likely: the original's.
    Scattered,
    /// At the lateral angle, each bud so many radians further around the axis than the one before: π for leaves
    /// in two rows, 2.4 (137.5°) for the golden angle.
    Spiral {
        /// The angle from one bud to the next, radians, finite.
        divergence: f32,
    },
}

/// When a tree gives up a branch: once its vigor falls below `multiplier · (child count^(1/n))^exponent`, the
/// branch's width being the measure of what it costs, and it is older than a period of grace.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Shedding {
    pub(super) multiplier: f32,
    pub(super) exponent: f32,
    pub(super) grace: u16,
}

impl Default for Shedding {
    /// Multiplier 0.3, exponent 1.5, a grace of 4 seasons: the original's.
    fn default() -> Self {
        Self { multiplier: 0.3, exponent: 1.5, grace: 4 }
    }
}

impl Shedding {
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
    /// shedding, no offspring, width exponent 2.5, tips of 0.5 mm.
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

    /// Whether all parameters are in range.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.vigor_model.check()?;
        within("Habit.vigor_multiplier", self.vigor_multiplier, 0.0, 1e6)?;
        within("Habit.length", self.length, 1e-6, 1e3)?;
        within("Habit.lateral_angle", self.lateral_angle, 0.0, std::f32::consts::PI)?;
        if let Phyllotaxis::Spiral { divergence } = self.phyllotaxis {
            within("Phyllotaxis::Spiral.divergence", divergence, -1e3, 1e3)?;
        }
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
        within("Habit.tip_radius", self.tip_radius, 0.0, 1e3)
    }

    /// The direction after `direction`, one metamer on.
    pub(super) fn turned(&self, direction: Vec3, optimal: Vec3) -> Vec3 {
        let wanted = direction * self.default_weight
            + optimal * self.optimal_weight
            + self.tropism * self.tropism_weight;
        wanted.normalize_or(direction)
    }
}

pub(super) fn within(parameter: &str, value: f32, least: f32, most: f32) -> Result<(), ParameterError> {
    if (least..=most).contains(&value) {
        return Ok(());
    }
    Err(ParameterError::new(parameter, format_args!("{value:?}"), format!("in [{least:?}, {most:?}]")))
}
