//! Architecture by branch order.

use super::habit::within;
use crate::ParameterError;

/// Traits of the axes of one branch order of a [`Habit`](super::Habit): how they leave their parent branch,
/// in which direction they grow, which of their buds live, and how they end.
///
/// The defaults are the habit's own parameters and nothing besides.
///
/// The words are those of Hallé, Oldeman and Tomlinson 1978, "Tropical trees and forests": an axis is orthotropic when
/// it grows upright ([`with_up_weight`](Self::with_up_weight)), plagiotropic when it grows level
/// ([`with_level_weight`](Self::with_level_weight)); monopodial when its terminal bud lives on, sympodial when each
/// shoot ends in a flower and its uppermost lateral takes over ([`with_flowers`](Self::with_flowers)).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
#[must_use]
pub struct Axis {
    pub(super) angle: Option<f32>,
    pub(super) optimal_weight: Option<f32>,
    pub(super) tropism_weight: Option<f32>,
    pub(super) level_weight: f32,
    pub(super) up_weight: f32,
    pub(super) vigor: f32,
    pub(super) longest: f32,
    pub(super) lifespan: Option<u16>,
    pub(super) laterals: [f32; 2],
    pub(super) flowers: bool,
}

crate::recipe::readable!(Axis {
    angle: Option<f32>, optimal_weight: Option<f32>, tropism_weight: Option<f32>, level_weight: f32,
    up_weight: f32, vigor: f32, longest: f32, lifespan: Option<u16>, laterals: [f32; 2], flowers: bool,
});

impl Default for Axis {
    fn default() -> Self {
        Self {
            angle: None,
            optimal_weight: None,
            tropism_weight: None,
            level_weight: 0.0,
            up_weight: 0.0,
            vigor: 1.0,
            longest: 1e6,
            lifespan: None,
            laterals: [0.0, 1.0],
            flowers: false,
        }
    }
}

impl Axis {
    /// Sets the angle at which axes of this order leave their parent branch, radians, in [0, π]; the habit's lateral
    /// angle by default.
    pub fn with_angle(mut self, radians: f32) -> Self {
        self.angle = Some(radians);
        self
    }

    /// Sets the weight of the environment's optimal direction, in [-1e3, 1e3]; the habit's by default.
    pub fn with_optimal_weight(mut self, weight: f32) -> Self {
        self.optimal_weight = Some(weight);
        self
    }

    /// Sets the weight of the habit's tropism, in [-1e3, 1e3]; the habit's by default.
    pub fn with_tropism_weight(mut self, weight: f32) -> Self {
        self.tropism_weight = Some(weight);
        self
    }

    /// Sets how strongly axes are drawn level, in [-1e3, 1e3]; 0 by default. Plagiotropic axes have more than 0.
    pub fn with_level_weight(mut self, weight: f32) -> Self {
        self.level_weight = weight;
        self
    }

    /// Sets how strongly axes are drawn upright, in [-1e3, 1e3]; 0 by default. Orthotropic axes have more than 0,
    /// hanging ones less.
    pub fn with_up_weight(mut self, weight: f32) -> Self {
        self.up_weight = weight;
        self
    }

    /// Sets by what the vigor of shoots is multiplied, in [0, 1e3]; 1 by default.
    pub fn with_vigor(mut self, factor: f32) -> Self {
        self.vigor = factor;
        self
    }

    /// Sets the most vigor that a shoot makes use of, in [1, 1e6]: its length in metamers. 1e6 by default.
    pub fn with_longest(mut self, vigor: f32) -> Self {
        self.longest = vigor;
        self
    }

    /// Sets after how many seasons a branch of this order falls, at least 1; `None`, the default, for never. The trunk
    /// does not fall.
    pub fn with_lifespan(mut self, seasons: impl Into<Option<u16>>) -> Self {
        self.lifespan = seasons.into();
        self
    }

    /// Sets where along each shoot, from 0 at its base to 1 at its tip, laterals live; the others stay dormant. All by
    /// default, from 0 to 1. 0.6 to 1 is acrotony, the habit of most trees; 0 to 0.4 basitony, that of shrubs. At
    /// least one lateral of a shoot lives, the nearest to the middle of the range.
    pub fn with_laterals(mut self, from: f32, to: f32) -> Self {
        self.laterals = [from, to];
        self
    }

    /// Sets whether each shoot ends in a flower: sympodial growth, in which the uppermost lateral takes over the axis
    /// in the next season. False by default.
    pub fn with_flowers(mut self, flowers: bool) -> Self {
        self.flowers = flowers;
        self
    }

    /// `true` if the lateral of the metamer of this index, of `of` metamers, lives.
    pub(super) fn lives(&self, index: u32, of: u32) -> bool {
        let [from, to] = self.laterals;
        let place = |index: u32| (index as f32 + 0.5) / of as f32;
        let nearest = (((from + to) * 0.5 * of as f32) as u32).min(of - 1);
        (from..=to).contains(&place(index)) || index == nearest
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        within("Axis.angle", self.angle.unwrap_or_default(), 0.0, std::f32::consts::PI)?;
        within("Axis.optimal_weight", self.optimal_weight.unwrap_or_default(), -1e3, 1e3)?;
        within("Axis.tropism_weight", self.tropism_weight.unwrap_or_default(), -1e3, 1e3)?;
        within("Axis.level_weight", self.level_weight, -1e3, 1e3)?;
        within("Axis.up_weight", self.up_weight, -1e3, 1e3)?;
        within("Axis.vigor", self.vigor, 0.0, 1e3)?;
        within("Axis.longest", self.longest, 1.0, 1e6)?;
        let lifespan = self.lifespan.unwrap_or(1);
        ParameterError::unless(lifespan > 0, "Axis.lifespan", lifespan, "at least 1 season")?;
        let [from, to] = self.laterals;
        let holds = from >= 0.0 && from <= to && to <= 1.0;
        ParameterError::unless(holds, "Axis.laterals", self.laterals, "two ascending places in [0, 1]")
    }
}
