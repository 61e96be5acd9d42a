//! Height of a tree over its life.

use super::habit::within;
use crate::ParameterError;
use crate::math;

/// Height that follows a sigmoid, and old age.
///
/// After t seasons a tree is at most `height · (1 - e^(-t / pace))^shape` metres high, the curve of Richards 1959, "A
/// flexible growth function for empirical use". Each season the vigor of all shoots is multiplied by what the most
/// eager of them needs to stay below the curve, at most 1: a tree that is shaded may fall behind, but none runs ahead.
/// So shoots become shorter and fewer with age, in the crown's width as in its height.
///
/// From `lifespan` seasons on the vigor of the whole tree falls in a line, to nothing after a quarter of the lifespan
/// more. The crown dies back, and with it the tree.
///
/// ```
/// use treesynth::self_organizing::Stature;
///
/// let oak = Stature::default().with_height(25.0).with_pace(40.0);
/// assert!(oak.height_at(10) < 4.0 && oak.height_at(300) > 24.9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
#[must_use]
pub struct Stature {
    pub(super) height: f32,
    pub(super) pace: f32,
    pub(super) shape: f32,
    pub(super) lifespan: Option<u16>,
}

crate::recipe::readable!(Stature { height: f32, pace: f32, shape: f32, lifespan: Option<u16> });

impl Default for Stature {
    /// 12 m, pace 15 seasons, shape 1.5, no old age.
    fn default() -> Self {
        Self { height: 12.0, pace: 15.0, shape: 1.5, lifespan: None }
    }
}

impl Stature {
    /// Sets the height that the tree never exceeds, metres, in [1e-6, 1e6]; 12 by default.
    pub fn with_height(mut self, metres: f32) -> Self {
        self.height = metres;
        self
    }

    /// Sets the pace, seasons, in [0.1, 1e4]: 15 by default. After three times as many a tree has about nine tenths
    /// of its height.
    pub fn with_pace(mut self, seasons: f32) -> Self {
        self.pace = seasons;
        self
    }

    /// Sets the shape, in [1, 10]; 1.5 by default. 1 is fastest at once, more has a slower youth: the steepest
    /// season is `pace · ln(shape)`.
    pub fn with_shape(mut self, shape: f32) -> Self {
        self.shape = shape;
        self
    }

    /// Sets the seasons after which a tree grows old, at least 1; `None`, the default, for never.
    pub fn with_lifespan(mut self, seasons: impl Into<Option<u16>>) -> Self {
        self.lifespan = seasons.into();
        self
    }

    /// The most height after so many seasons, metres.
    pub fn height_at(&self, seasons: u16) -> f32 {
        self.height * math::powf(1.0 - math::exp(-f32::from(seasons) / self.pace), self.shape)
    }

    /// Share of a tree's vigor that is left in its season of this number, in [0, 1].
    pub(super) fn strength(&self, season: u16) -> f32 {
        let Some(lifespan) = self.lifespan else { return 1.0 };
        let beyond = season.saturating_sub(lifespan);
        (1.0 - 4.0 * f32::from(beyond) / f32::from(lifespan)).max(0.0)
    }

    pub(super) fn check(self) -> Result<(), ParameterError> {
        within("Stature.height", self.height, 1e-6, 1e6)?;
        within("Stature.pace", self.pace, 0.1, 1e4)?;
        within("Stature.shape", self.shape, 1.0, 10.0)?;
        let lifespan = self.lifespan.unwrap_or(1);
        ParameterError::unless(lifespan > 0, "Stature.lifespan", lifespan, "at least 1 season")
    }
}
