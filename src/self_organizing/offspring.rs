//! Seeds: how trees become a forest.

use super::habit::within;
use crate::ParameterError;
use crate::math;
use crate::random::{Purpose, unit};
use glam::Vec3;

/// Sowing of a tree (step 6 of the text): number and distance of its seeds grow with the logarithm of the
/// root's vigor.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Offspring {
    pub(super) maturity: u16,
    pub(super) interval: u16,
    pub(super) least_vigor: f32,
    pub(super) seeds: f32,
    pub(super) distance: f32,
}

crate::recipe::readable!(Offspring {
    maturity: u16,
    interval: u16,
    least_vigor: f32,
    seeds: f32,
    distance: f32,
});

impl Default for Offspring {
    /// Ours, for the text gives no numbers: from 8 seasons and a vigor of 20 on, every 4th season, 0.5 seeds and
    /// 0.25 m for each unit of ln(vigor).
    fn default() -> Self {
        Self { maturity: 8, interval: 4, least_vigor: 20.0, seeds: 0.5, distance: 0.25 }
    }
}

impl Offspring {
    /// Sets the age, in seasons, of the first seeds; 8 by default.
    pub fn with_maturity(mut self, seasons: u16) -> Self {
        self.maturity = seasons;
        self
    }

    /// Sets the seasons from one sowing to the next, at least 1; 4 by default.
    pub fn with_interval(mut self, seasons: u16) -> Self {
        self.interval = seasons;
        self
    }

    /// Sets the least vigor of the root of a tree that sows, in [1, 1e9]; 20 by default.
    pub fn with_least_vigor(mut self, vigor: f32) -> Self {
        self.least_vigor = vigor;
        self
    }

    /// Sets the seeds for each unit of ln(vigor), in [0, 1000]; 0.5 by default. A fraction of a seed is its chance.
    pub fn with_seeds(mut self, seeds: f32) -> Self {
        self.seeds = seeds;
        self
    }

    /// Sets the farthest a seed falls, metres for each unit of ln(vigor), in [0, 1e4]; 0.25 by default.
    pub fn with_distance(mut self, metres: f32) -> Self {
        self.distance = metres;
        self
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(self.interval > 0, "Offspring.interval", self.interval, "at least 1 season")?;
        within("Offspring.least_vigor", self.least_vigor, 1.0, 1e9)?;
        within("Offspring.seeds", self.seeds, 0.0, 1000.0)?;
        within("Offspring.distance", self.distance, 0.0, 1e4)
    }

    /// Reach of the seeds of a tree of this vigor, metres.
    pub fn reach(&self, vigor: f32) -> f32 {
        self.distance * math::ln(vigor.clamp(1.0, f32::MAX))
    }

    /// Places where the seeds fall of a tree at `foot` that is `age` seasons old.
    pub(super) fn sow(&self, foot: Vec3, vigor: f32, age: u16, seed: u64, tree: u32) -> Vec<Vec3> {
        if age < self.maturity
            || vigor < self.least_vigor
            || !(age - self.maturity).is_multiple_of(self.interval)
        {
            return Vec::new();
        }
        let draw = |index: u64| unit(seed, tree, Purpose::SEEDS, (u64::from(age) << 32) | index);
        let count = (self.seeds * math::ln(vigor.min(f32::MAX)) + draw(0)) as u64;
        let reach = self.reach(vigor);
        (0..count)
            .map(|i| {
                let (sin, cos) = math::sin_cos(draw(2 * i + 1) * std::f32::consts::TAU);
                // The root makes each part of the disc as likely as its area.
                foot + Vec3::new(cos, 0.0, sin) * (draw(2 * i + 2).sqrt() * reach)
            })
            .collect()
    }
}
