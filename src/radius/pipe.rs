//! The pipe model: Shinozaki, Yoda, Hozumi and Kira 1964, as equation 2 of the variational paper (section 3.2).

use super::{RadiusError, RadiusModel};
use crate::{ParameterError, Skeleton};

/// Every tip's pipe runs down to the trunk base, and a branch is the bundle of its pipes: at each fork `d^a =
/// Σ d_j^a` over the children's diameters, with a the [exponent](Self::with_exponent) (equation 2).
///
/// The root's radius is that of the flow through it; unbranched runs have one radius. O(n), summed in `f64`:
/// equation 2 holds within a relative 1e-5 after rounding to `f32`, as long as no radius is subnormal.
///
/// ```
/// use treesynth::radius::{PipeModel, RadiusModel};
/// use treesynth::{Skeleton, glam::Vec3};
///
/// let fork = Skeleton::new(
///     vec![Vec3::ZERO, Vec3::Y, Vec3::new(-0.5, 1.8, 0.0), Vec3::new(0.5, 1.8, 0.0)],
///     vec![None, Some(0), Some(1), Some(1)],
/// )?;
/// // Leonardo's rule: with exponent 2, cross sections add up.
/// let radii = PipeModel::default().with_exponent(2.0).with_tip_diameter(0.02).radii(&fork)?;
/// assert_eq!(radii[3], 0.01);
/// assert!((radii[0] - 0.01 * 2.0_f32.sqrt()).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct PipeModel {
    exponent: f32,
    calibration: Calibration,
}

/// Known diameter, by which the proportions of the pipe model become metres.
///
/// ```
/// use treesynth::radius::{Calibration, PipeModel};
///
/// // A trunk of 40 cm, whatever the number of tips.
/// let model = PipeModel::default().with_trunk_diameter(0.4);
/// assert_eq!(model.calibration(), Calibration::Trunk(0.4));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum Calibration {
    /// Every tip has this diameter, metres; a tree of more tips is thicker.
    Tip(f32),
    /// The trunk base has this diameter, metres; the more tips a tree has, the finer they are.
    Trunk(f32),
}

impl Default for PipeModel {
    /// Exponent 2.5, the middle of the paper's range; tips of 4 mm, our choice after the one-year shoots of
    /// broad-leaved trees: 6,500 of them, the paper-sized tree of `guided`, make a trunk base of 13 cm.
    fn default() -> Self {
        Self { exponent: 2.5, calibration: Calibration::Tip(0.004) }
    }
}

impl PipeModel {
    /// Sets the exponent a, without unit, above 1 and at most 10; 2.5 by default.
    ///
    /// The paper takes it between 2 and 3; Leonardo's rule is 2, Murray's law for vessels 3. Nearer to 1 the
    /// trunk base thickens quickly with the number of tips; above 3 branches hardly thin out. At 1 and below,
    /// a branch would be as thick as its children side by side, or thicker, which no tree is.
    pub fn with_exponent(mut self, exponent: f32) -> Self {
        self.exponent = exponent;
        self
    }

    /// Every tip gets this diameter, metres, finite and above 0; 0.004 by default.
    pub fn with_tip_diameter(mut self, diameter: f32) -> Self {
        self.calibration = Calibration::Tip(diameter);
        self
    }

    /// Sets the diameter of the trunk base, metres, finite and above 0, instead of that of the tips.
    pub fn with_trunk_diameter(mut self, diameter: f32) -> Self {
        self.calibration = Calibration::Trunk(diameter);
        self
    }

    /// The exponent a.
    pub fn exponent(&self) -> f32 {
        self.exponent
    }

    /// Known diameter.
    pub fn calibration(&self) -> Calibration {
        self.calibration
    }
}

impl RadiusModel for PipeModel {
    /// # Errors
    /// Options out of range, and [`RadiusError::NotFinite`] where the radii go beyond `f32`.
    fn radii(&self, skeleton: &Skeleton) -> Result<Vec<f32>, RadiusError> {
        self.check()?;
        // Counting tips, not powers of diameters, neither overflows nor underflows at any exponent.
        let flows = flows(skeleton, |_| 1.0);
        let (flow, diameter) = match self.calibration {
            Calibration::Tip(diameter) => (1.0, diameter),
            Calibration::Trunk(diameter) => (flows[0], diameter),
        };
        bundle(skeleton, &flows, self.exponent, flow, 0.5 * f64::from(diameter))
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_exponent("PipeModel.exponent", self.exponent)?;
        match self.calibration {
            Calibration::Tip(diameter) => check_diameter("PipeModel.tip_diameter", diameter),
            Calibration::Trunk(diameter) => check_diameter("PipeModel.trunk_diameter", diameter),
        }
    }
}

pub(super) fn check_exponent(parameter: &str, exponent: f32) -> Result<(), ParameterError> {
    ParameterError::unless(exponent > 1.0 && exponent <= 10.0, parameter, exponent, "above 1, at most 10")
}

pub(super) fn check_diameter(parameter: &str, diameter: f32) -> Result<(), ParameterError> {
    let holds = diameter > 0.0 && diameter.is_finite();
    ParameterError::unless(holds, parameter, diameter, "finite and above 0 metres")
}

/// For each node the sum of the flows of the tips above it: `d^a` up to a common factor.
pub(super) fn flows(skeleton: &Skeleton, mut of_tip: impl FnMut(usize) -> f64) -> Vec<f64> {
    let mut flows = vec![0.0; skeleton.len()];
    for tip in skeleton.tips() {
        flows[tip] = of_tip(tip);
    }
    for (node, parent) in skeleton.edges().rev() {
        flows[parent] += flows[node];
    }
    flows
}

/// The radii of `flows`, where `flow` of them make `radius` metres.
pub(super) fn bundle(
    skeleton: &Skeleton,
    flows: &[f64],
    exponent: f32,
    flow: f64,
    radius: f64,
) -> Result<Vec<f32>, RadiusError> {
    let root = 1.0 / f64::from(exponent);
    let mut radii: Vec<f32> = Vec::with_capacity(flows.len());
    for (node, &through) in flows.iter().enumerate() {
        let mut thick = (radius * libm::pow(through / flow, root)) as f32;
        if !thick.is_finite() {
            return Err(RadiusError::NotFinite { node, radius: thick });
        }
        // Flows never grow towards the tips, but `pow` may round two neighbours the wrong way round.
        if let Some(parent) = skeleton.parent(node) {
            thick = thick.min(radii[parent]);
        }
        radii.push(thick);
    }
    Ok(radii)
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::check_radii;
    use super::super::sample::{any_skeleton, binary, chain, y_fork};
    use super::*;
    use proptest::prelude::*;
    use std::error::Error;

    /// The worst relative difference between the sides of equation 2.
    pub(in crate::radius) fn residual(skeleton: &Skeleton, radii: &[f32], exponent: f32) -> f64 {
        let power = |node: usize| libm::pow(f64::from(radii[node]), f64::from(exponent));
        let children = skeleton.children();
        let mut worst = 0.0_f64;
        for node in 0..skeleton.len() {
            let sum: f64 = children.of(node).iter().map(|&child| power(child as usize)).sum();
            if !children.of(node).is_empty() && power(node) > 0.0 {
                worst = worst.max((power(node) - sum).abs() / power(node));
            }
        }
        worst
    }

    #[test]
    fn y_fork_by_hand() -> Result<(), Box<dyn Error>> {
        let fork = y_fork()?;
        let radii = PipeModel::default().with_exponent(3.0).with_tip_diameter(0.2).radii(&fork)?;
        assert_eq!(radii[2..], [0.1, 0.1]);
        assert!((radii[1] - 0.1 * 1.259_921).abs() < 1e-7, "cube root of two");
        assert_eq!(radii[0].to_bits(), radii[1].to_bits());
        let radii = PipeModel::default().with_exponent(2.0).with_trunk_diameter(2.0).radii(&fork)?;
        assert_eq!(radii[..2], [1.0, 1.0]);
        assert!((radii[3] - 0.5_f32.sqrt()).abs() < 1e-7);
        Ok(())
    }

    #[test]
    fn extremes() -> Result<(), Box<dyn Error>> {
        let one = chain(1)?;
        assert_eq!(PipeModel::default().radii(&one)?, [0.002]);
        assert_eq!(PipeModel::default().with_trunk_diameter(0.3).radii(&one)?, [0.15]);
        let deep = chain(1_000_000)?;
        assert!(PipeModel::default().radii(&deep)?.iter().all(|&r| (r - 0.002).abs() < 1e-9));
        let wide = binary(10)?;
        let huge = PipeModel::default().with_exponent(1.1).with_tip_diameter(f32::MAX).radii(&wide);
        assert!(matches!(huge, Err(RadiusError::NotFinite { node: 0, .. })));
        let fine = PipeModel::default().with_exponent(10.0).with_tip_diameter(1e-30);
        assert!(
            residual(&wide, &fine.radii(&wide)?.iter().map(|r| r * 1e28).collect::<Vec<_>>(), 10.0) < 1e-4
        );
        Ok(())
    }

    #[test]
    fn bad_options_are_named() {
        let named = |model: PipeModel| model.check().map_err(|error| error.parameter);
        let model = PipeModel::default();
        assert_eq!(named(model), Ok(()));
        assert_eq!(named(model.with_exponent(10.0)), Ok(()));
        assert_eq!(model.with_exponent(2.5).exponent().to_bits(), 2.5_f32.to_bits());
        for exponent in [1.0, 0.0, -2.0, 10.1, f32::NAN, f32::INFINITY] {
            assert_eq!(named(model.with_exponent(exponent)), Err("PipeModel.exponent".into()));
        }
        for diameter in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(named(model.with_tip_diameter(diameter)), Err("PipeModel.tip_diameter".into()));
            assert_eq!(named(model.with_trunk_diameter(diameter)), Err("PipeModel.trunk_diameter".into()));
        }
    }

    proptest! {
        #[test]
        fn equation_2_holds(skeleton in any_skeleton(), exponent in 1.01f32..10.0, trunk in 0.01f32..3.0) {
            let model = PipeModel::default().with_exponent(exponent);
            let radii = model.radii(&skeleton).unwrap();
            prop_assert_eq!(check_radii(&skeleton, &radii), Ok(()));
            prop_assert!(residual(&skeleton, &radii, exponent) < 1e-4);
            let radii = model.with_trunk_diameter(trunk).radii(&skeleton).unwrap();
            prop_assert_eq!(check_radii(&skeleton, &radii), Ok(()));
            prop_assert!(residual(&skeleton, &radii, exponent) < 1e-4);
            prop_assert!((2.0 * radii[0] - trunk).abs() <= 1e-5 * trunk);
        }
    }
}
