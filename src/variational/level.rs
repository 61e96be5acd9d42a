//! The botanical parameters of one level: section 3.2, table 1 and figure 4.

use std::f32::consts::{PI, TAU};

use crate::ParameterError;

/// R = (N, P, n, θ, φ): how an axis of one level is built before anything is optimized.
///
/// ```
/// use treesynth::variational::{Level, Phyllotaxis};
///
/// let trunk = Level::default().with_metamers(7).with_phyllotaxis(Phyllotaxis::Decussate);
/// assert_eq!(trunk.laterals(), 2);
/// assert!(trunk.with_apical_control(0.0).check().is_err());
/// ```
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Level {
    metamers: u32,
    apical_control: f32,
    laterals: u32,
    angle: f32,
    turn: f32,
}

/// Number of branches at a node, and their rotation relative to those of the node before.
///
/// ```
/// use treesynth::variational::{Level, Phyllotaxis};
///
/// // A maple: pairs of branches, each across the one before.
/// let level = Level::default().with_phyllotaxis(Phyllotaxis::Decussate);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum Phyllotaxis {
    /// One, by turns on either side: n = 1, φ = 180°.
    Alternate,
    /// Two facing each other, all in one plane: n = 2, φ = 0.
    Opposite,
    /// Two facing each other, each pair across the one before: n = 2, φ = 90°.
    Decussate,
    /// This number n of branches around the node, in the gaps of the whorl before: φ = 180° / n.
    Whorled(u32),
    /// One, on by the golden angle: n = 1, φ = 137.5°.
    Spiral,
}

impl Default for Level {
    /// N = 5 (figure 4); P = 0.8 and θ = 45°, the middle of what figure 7 shows; a golden spiral.
    fn default() -> Self {
        Self { metamers: 5, apical_control: 0.8, laterals: 1, angle: PI / 4.0, turn: GOLDEN }
    }
}

/// The golden angle, radians.
const GOLDEN: f32 = 2.399_963_2;

impl Level {
    /// Sets N, the metamers of an axis, in [1, 64]; 5 by default. More of them make a denser tree.
    pub fn with_metamers(mut self, metamers: u32) -> Self {
        self.metamers = metamers;
        self
    }

    /// Sets P, the length of an axis over the longest that the shape allows, in (0, 1]; 0.8 by default. At 1 the axis
    /// goes on to the shape's end; the less, the earlier it dissolves into its branches.
    pub fn with_apical_control(mut self, share: f32) -> Self {
        self.apical_control = share;
        self
    }

    /// Sets n, the branches at each node, in [1, 16]; 1 by default.
    pub fn with_laterals(mut self, laterals: u32) -> Self {
        self.laterals = laterals;
        self
    }

    /// Sets θ, the angle between a branch and its parent axis, radians in [0, π]; π/4 by default.
    pub fn with_angle(mut self, angle: f32) -> Self {
        self.angle = angle;
        self
    }

    /// Sets φ, by which the branches of a node are turned about the axis against those of the node before, radians in
    /// [-2π, 2π]; the golden angle by default.
    pub fn with_turn(mut self, turn: f32) -> Self {
        self.turn = turn;
        self
    }

    /// Sets n and φ.
    pub fn with_phyllotaxis(self, phyllotaxis: Phyllotaxis) -> Self {
        let (laterals, turn) = match phyllotaxis {
            Phyllotaxis::Alternate => (1, PI),
            Phyllotaxis::Opposite => (2, 0.0),
            Phyllotaxis::Decussate => (2, PI / 2.0),
            Phyllotaxis::Whorled(laterals) => (laterals, PI / laterals.max(1) as f32),
            Phyllotaxis::Spiral => (1, GOLDEN),
        };
        self.with_laterals(laterals).with_turn(turn)
    }

    /// N, the metamers of an axis.
    pub fn metamers(&self) -> u32 {
        self.metamers
    }

    /// P, the length of an axis over the longest possible.
    pub fn apical_control(&self) -> f32 {
        self.apical_control
    }

    /// n, the branches at each node.
    pub fn laterals(&self) -> u32 {
        self.laterals
    }

    /// θ, radians.
    pub fn angle(&self) -> f32 {
        self.angle
    }

    /// φ, radians.
    pub fn turn(&self) -> f32 {
        self.turn
    }

    /// Checks that all parameters are in range.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        let Self { metamers, apical_control, laterals, angle, turn } = *self;
        ParameterError::unless((1..=64).contains(&metamers), "Level.metamers", metamers, "in [1, 64]")?;
        let holds = apical_control > 0.0 && apical_control <= 1.0;
        ParameterError::unless(holds, "Level.apical_control", apical_control, "in (0, 1]")?;
        ParameterError::unless((1..=16).contains(&laterals), "Level.laterals", laterals, "in [1, 16]")?;
        ParameterError::unless((0.0..=PI).contains(&angle), "Level.angle", angle, "in [0, π] radians")?;
        ParameterError::unless((-TAU..=TAU).contains(&turn), "Level.turn", turn, "in [-2π, 2π] radians")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_parameter_has_its_range() {
        let named = |level: Level| level.check().map_err(|error| error.parameter);
        let level = Level::default();
        assert_eq!(named(level), Ok(()));
        for metamers in [0, 65, u32::MAX] {
            assert_eq!(named(level.with_metamers(metamers)), Err("Level.metamers".into()));
        }
        for share in [0.0, -0.5, 1.01, f32::NAN, f32::INFINITY] {
            assert_eq!(named(level.with_apical_control(share)), Err("Level.apical_control".into()));
        }
        for laterals in [0, 17] {
            let whorl = level.with_phyllotaxis(Phyllotaxis::Whorled(laterals));
            assert_eq!(named(whorl), Err("Level.laterals".into()));
        }
        for angle in [-0.1, 3.2, f32::NAN] {
            assert_eq!(named(level.with_angle(angle)), Err("Level.angle".into()));
        }
        for turn in [-7.0, 7.0, f32::NAN, f32::NEG_INFINITY] {
            assert_eq!(named(level.with_turn(turn)), Err("Level.turn".into()));
        }
    }

    #[test]
    fn phyllotaxis_by_the_book() {
        let of = |phyllotaxis| {
            let level = Level::default().with_phyllotaxis(phyllotaxis);
            (level.laterals(), level.turn().to_degrees().round())
        };
        assert_eq!(of(Phyllotaxis::Alternate), (1, 180.0));
        assert_eq!(of(Phyllotaxis::Opposite), (2, 0.0));
        assert_eq!(of(Phyllotaxis::Decussate), (2, 90.0));
        assert_eq!(of(Phyllotaxis::Whorled(3)), (3, 60.0));
        assert_eq!(of(Phyllotaxis::Spiral), (1, 138.0));
    }
}
