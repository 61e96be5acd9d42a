//! The flow primitives of Wejchert and Haumann 1991: uniform, source, sink and vortex.
//!
//! They are those of potential flow. An ideal source or vortex is infinitely fast in its middle; here a core
//! of a given radius softens it, so that the field is finite everywhere, zero in the very middle, and within
//! two percent of the ideal one from ten core radii on.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::{VectorField, check_nonzero, check_position, check_positive, check_vector, finite_or_zero};
use crate::ParameterError;

/// Radius of the core of sources, sinks and vortices if not set, metres: less than the spacing of the graphs
/// that trees are grown in, so that it changes little but the singularity.
const CORE: f32 = 0.1;

/// The same vector everywhere: gravity, light from one side, a prevailing wind.
///
/// ```
/// use treesynth::{VectorField, field::Uniform, glam::Vec3};
///
/// let lean = Uniform::new(Vec3::new(0.3, 1.0, 0.0));
/// assert_eq!(lean.at(Vec3::splat(7.0)), Vec3::new(0.3, 1.0, 0.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Uniform {
    direction: Vec3,
}

impl Uniform {
    /// The field that is `direction` everywhere, not normalized; its length is from 1e-6 to 1e6.
    pub const fn new(direction: Vec3) -> Self {
        Self { direction }
    }
}

impl VectorField for Uniform {
    fn at(&self, point: Vec3) -> Vec3 {
        if point.is_finite() { finite_or_zero(self.direction) } else { Vec3::ZERO }
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_vector("Uniform.direction", self.direction)
    }
}

/// Away from a point, the weaker the farther: `strength / (4π d²)` at the distance d metres, so that
/// `strength` in all flows through every sphere around it.
///
/// With the core radius c, it is `strength d / (4π (d² + c²)^1.5)`: zero in the middle.
///
/// ```
/// use treesynth::{VectorField, field::Source, glam::Vec3};
///
/// let source = Source::new(Vec3::ZERO, 4.0 * std::f32::consts::PI);
/// assert!((source.at(Vec3::X * 2.0).x - 0.25).abs() < 0.01);
/// ```
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Source {
    center: Vec3,
    strength: f32,
    core: f32,
}

crate::recipe::readable!(Source { core: f32 });

impl Source {
    /// The source at `center` (metres, at most 1e6 from 0 on each axis) of `strength`, from 1e-6 to 1e6, with a
    /// core of 0.1 m.
    pub const fn new(center: Vec3, strength: f32) -> Self {
        Self { center, strength, core: CORE }
    }

    /// Sets the radius of the core, metres, from 1e-3 to 1e6; the field is strongest at 0.7 of it.
    pub const fn with_core(mut self, radius: f32) -> Self {
        self.core = radius;
        self
    }
}

impl VectorField for Source {
    fn at(&self, point: Vec3) -> Vec3 {
        outwards(point - self.center, self.strength, self.core)
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_position("Source.center", self.center)?;
        check_positive("Source.strength", self.strength)?;
        check_core("Source.core", self.core)
    }
}

/// Towards a point, the weaker the farther: a [`Source`] the other way round. A lamp, a gap in the canopy.
///
/// ```
/// use treesynth::{VectorField, field::{Sink, Source}, glam::Vec3};
///
/// let (sink, source) = (Sink::new(Vec3::Y, 2.0), Source::new(Vec3::Y, 2.0));
/// assert_eq!(sink.at(Vec3::X), -source.at(Vec3::X));
/// ```
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Sink {
    center: Vec3,
    strength: f32,
    core: f32,
}

crate::recipe::readable!(Sink { core: f32 });

impl Sink {
    /// The sink at `center` (metres, at most 1e6 from 0 on each axis) of `strength`, from 1e-6 to 1e6, with a
    /// core of 0.1 m.
    pub const fn new(center: Vec3, strength: f32) -> Self {
        Self { center, strength, core: CORE }
    }

    /// Sets the radius of the core, metres, from 1e-3 to 1e6; the field is strongest at 0.7 of it.
    pub const fn with_core(mut self, radius: f32) -> Self {
        self.core = radius;
        self
    }
}

impl VectorField for Sink {
    fn at(&self, point: Vec3) -> Vec3 {
        -outwards(point - self.center, self.strength, self.core)
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_position("Sink.center", self.center)?;
        check_positive("Sink.strength", self.strength)?;
        check_core("Sink.core", self.core)
    }
}

/// Around a line, the weaker the farther: `strength / (2π d)` at the distance d metres from it, so that the
/// circulation along every circle around it is `strength`.
///
/// Right-handed about the axis for a positive strength. With the core radius c, it is
/// `strength d / (2π (d² + c²))`: zero on the axis. For a field of constant length see
/// [`Rotation`](super::Rotation).
///
/// ```
/// use treesynth::{VectorField, field::Vortex, glam::Vec3};
///
/// let vortex = Vortex::new(Vec3::ZERO, Vec3::Y, 4.0 * std::f32::consts::PI);
/// assert!(vortex.at(Vec3::new(2.0, 5.0, 0.0)).abs_diff_eq(Vec3::NEG_Z, 0.01));
/// ```
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Vortex {
    center: Vec3,
    axis: Vec3,
    strength: f32,
    core: f32,
}

crate::recipe::readable!(Vortex { core: f32 });

impl Vortex {
    /// The vortex around the line through `center` (metres, at most 1e6 from 0 on each axis) along `axis` (any
    /// length from 1e-6 to 1e6) of `strength`, from 1e-6 to 1e6 or negative, with a core of 0.1 m.
    pub const fn new(center: Vec3, axis: Vec3, strength: f32) -> Self {
        Self { center, axis, strength, core: CORE }
    }

    /// Sets the radius of the core, metres, from 1e-3 to 1e6; the field is strongest at it.
    pub const fn with_core(mut self, radius: f32) -> Self {
        self.core = radius;
        self
    }
}

impl VectorField for Vortex {
    fn at(&self, point: Vec3) -> Vec3 {
        let around = self.axis.normalize_or_zero().cross(point - self.center);
        finite_or_zero(around * (self.strength / (TAU * (around.length_squared() + self.core * self.core))))
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_position("Vortex.center", self.center)?;
        check_vector("Vortex.axis", self.axis)?;
        check_nonzero("Vortex.strength", self.strength)?;
        check_core("Vortex.core", self.core)
    }
}

fn outwards(offset: Vec3, strength: f32, core: f32) -> Vec3 {
    let squared = offset.length_squared() + core * core;
    finite_or_zero(offset / squared.sqrt() * (strength / (4.0 * PI * squared)))
}

fn check_core(parameter: &str, radius: f32) -> Result<(), ParameterError> {
    ParameterError::unless((1e-3..=1e6).contains(&radius), parameter, radius, "from 1e-3 to 1e6 metres")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn source_by_hand() {
        let source = Source::new(Vec3::Y, 8.0 * PI).with_core(3.0);
        // At 4 m the softened distance is 5 m: 8π · 4 / (4π · 125).
        assert!(source.at(Vec3::new(0.0, 1.0, 4.0)).abs_diff_eq(Vec3::Z * 0.064, 1e-6));
        assert_eq!(source.at(Vec3::Y), Vec3::ZERO);
        let sharp = Source::new(Vec3::ZERO, 4.0 * PI).with_core(0.001);
        assert!(sharp.at(Vec3::NEG_Y * 2.0).abs_diff_eq(Vec3::NEG_Y * 0.25, 1e-6));
    }

    #[test]
    fn sink_reverses_source() {
        let point = Vec3::new(0.3, 2.0, -1.0);
        let (source, sink) = (Source::new(Vec3::ONE, 3.0), Sink::new(Vec3::ONE, 3.0).with_core(0.1));
        assert_eq!(sink.at(point), -source.at(point));
        assert!(sink.at(point).dot(Vec3::ONE - point) > 0.0);
    }

    #[test]
    fn vortex_by_hand() {
        let vortex = Vortex::new(Vec3::X, Vec3::Z * 9.0, TAU).with_core(2.0);
        // 1 m from the axis: 2π · 1 / (2π (1 + 4)), and the height along the axis does not matter.
        assert!(vortex.at(Vec3::new(2.0, 0.0, 40.0)).abs_diff_eq(Vec3::Y * 0.2, 1e-6));
        assert!(vortex.at(Vec3::new(1.0, 1.0, 0.0)).abs_diff_eq(Vec3::NEG_X * 0.2, 1e-6));
        assert_eq!(vortex.at(Vec3::new(1.0, 0.0, 5.0)), Vec3::ZERO);
        let left = Vortex::new(Vec3::X, Vec3::Z, -TAU).with_core(2.0);
        assert!(left.at(Vec3::new(2.0, 0.0, 0.0)).abs_diff_eq(Vec3::NEG_Y * 0.2, 1e-6));
    }

    #[test]
    fn ten_cores_away_nothing_is_left_of_the_core() {
        let ideal = 1.0 / (4.0 * PI);
        assert!((Source::new(Vec3::ZERO, 1.0).at(Vec3::X).x / ideal - 1.0).abs() < 0.016);
        let vortex = Vortex::new(Vec3::ZERO, Vec3::Y, 1.0).at(Vec3::X).length();
        assert!((vortex * TAU - 1.0).abs() < 0.011);
    }
}
