//! Thickness that narrows along a branch instead of stepping down at its forks.

use super::{RadiusError, RadiusModel, check_radii};
use crate::{ParameterError, Skeleton};

/// Narrows the radii of another model along each run, the unbranched way from one fork to the next or to a tip.
///
/// Models of pipes give one radius to a whole run and a step at the fork. Here the radius goes, linearly in arc
/// length, from the inner model's at the run's start towards that of the thickest child at its end, and on a
/// twig, a run that ends in a tip, towards a [part](Self::with_tip_fraction) of its own. Each internode has the
/// radius of its upper end.
///
/// Guaranteed: no radius is above the inner model's; radii never grow towards the tips; the root keeps its
/// radius, hence a trunk diameter set in the inner model; runs without length keep theirs. Not guaranteed:
/// equation 2 of the pipe model no longer holds at the nodes of the forks themselves. O(n).
///
/// ```
/// use treesynth::radius::{PipeModel, RadiusModel, Taper};
/// use treesynth::{Skeleton, glam::Vec3};
///
/// let y = |y: f32| Vec3::new(0.0, y, 0.0);
/// let twig = Skeleton::new(vec![y(0.0), y(1.0), y(2.0)], vec![None, Some(0), Some(1)])?;
/// let inner = PipeModel::default().with_tip_diameter(0.02);
/// assert_eq!(inner.radii(&twig)?, [0.01, 0.01, 0.01]);
/// assert_eq!(Taper::new(inner).with_tip_fraction(0.5).radii(&twig)?, [0.01, 0.0075, 0.005]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Taper<M> {
    inner: M,
    fraction: f32,
    tip_fraction: f32,
}

crate::recipe::readable!(@[M] Taper<M> { fraction: f32, tip_fraction: f32 });

crate::recipe::mapped!(Taper { inner; fraction, tip_fraction });

impl<M: RadiusModel> Taper<M> {
    /// Narrows what `inner` gives: fully between forks, and to 0.3 of a twig's radius at its tip. Both are our
    /// choice: the first makes limbs without steps, the second tips of about the size of a bud.
    pub fn new(inner: M) -> Self {
        Self { inner, fraction: 1.0, tip_fraction: 0.3 }
    }

    /// Sets how far a run goes towards the radius of the thickest child at its end, in [0, 1]; 1 by default. 0
    /// leaves the inner model's radii and their steps.
    pub fn with_fraction(mut self, fraction: f32) -> Self {
        self.fraction = fraction;
        self
    }

    /// Sets the radius of a tip as a part of the inner model's, in [0, 1]; 0.3 by default. 0 ends twigs in a
    /// point, 1 leaves them as cylinders.
    pub fn with_tip_fraction(mut self, fraction: f32) -> Self {
        self.tip_fraction = fraction;
        self
    }

    /// The model inside.
    pub fn inner(&self) -> &M {
        &self.inner
    }
}

/// Position of a node on its run.
struct Runs {
    /// Way from the run's start to each node, metres.
    arc: Vec<f64>,
    /// The last node of each node's run: a fork, or a tip.
    end: Vec<u32>,
    /// Number of children, up to 2.
    children: Vec<u8>,
}

impl Runs {
    fn new(skeleton: &Skeleton) -> Self {
        let positions = skeleton.positions();
        let mut children = vec![0u8; skeleton.len()];
        for (_, parent) in skeleton.edges() {
            children[parent] = (children[parent] + 1).min(2);
        }
        let mut arc = vec![0.0; skeleton.len()];
        for (node, parent) in skeleton.edges() {
            let before = if children[parent] == 1 { arc[parent] } else { 0.0 };
            // In f64, where no distance of two f32 positions overflows.
            arc[node] = before + positions[node].as_dvec3().distance(positions[parent].as_dvec3());
        }
        let mut end: Vec<u32> = (0..skeleton.len() as u32).collect();
        for (node, parent) in skeleton.edges().rev() {
            if children[parent] == 1 {
                end[parent] = end[node];
            }
        }
        Self { arc, end, children }
    }
}

impl<M: RadiusModel> RadiusModel for Taper<M> {
    /// # Errors
    /// Options out of range, the inner model's errors, and whatever [`check_radii`] finds in the inner radii.
    fn radii(&self, skeleton: &Skeleton) -> Result<Vec<f32>, RadiusError> {
        self.check()?;
        let inner = self.inner.radii(skeleton)?;
        check_radii(skeleton, &inner)?;
        let mut thickest = vec![0.0_f32; skeleton.len()];
        for (node, parent) in skeleton.edges() {
            thickest[parent] = thickest[parent].max(inner[node]);
        }
        let runs = Runs::new(skeleton);
        let mut radii = Vec::with_capacity(inner.len());
        for (node, &start) in inner.iter().enumerate() {
            let end = runs.end[node] as usize;
            let (target, fraction) = if runs.children[end] == 0 {
                (inner[end] * self.tip_fraction, 1.0)
            } else {
                (thickest[end], self.fraction)
            };
            let whole = runs.arc[end];
            let along = if whole > 0.0 { (runs.arc[node] / whole) as f32 * fraction } else { 0.0 };
            let mut radius = start * (1.0 - along) + target * along;
            // Rounding may lift a radius above its bounds by a bit.
            radius = radius.min(start);
            if let Some(parent) = skeleton.parent(node) {
                radius = radius.min(radii[parent]);
            }
            radii.push(radius);
        }
        Ok(radii)
    }

    fn check(&self) -> Result<(), ParameterError> {
        let unit =
            |name, value: f32| ParameterError::unless((0.0..=1.0).contains(&value), name, value, "in [0, 1]");
        unit("Taper.fraction", self.fraction)?;
        unit("Taper.tip_fraction", self.tip_fraction)?;
        self.inner.check()
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample::{any_skeleton, chain, y_fork};
    use super::super::{PipeModel, Variational};
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;
    use std::error::Error;

    /// Radii that someone else worked out.
    struct Given(Vec<f32>);

    impl RadiusModel for Given {
        fn radii(&self, _: &Skeleton) -> Result<Vec<f32>, RadiusError> {
            Ok(self.0.clone())
        }
    }

    #[test]
    fn fork_by_hand() -> Result<(), Box<dyn Error>> {
        let y = |y: f32| Vec3::new(0.0, y, 0.0);
        // A stem of 4 m with a node after 1 m; at its top a long limb with a node half way, and a short twig.
        let positions = vec![y(0.0), y(1.0), y(4.0), y(6.0), y(8.0), Vec3::new(1.0, 4.0, 0.0)];
        let tree = Skeleton::new(positions, vec![None, Some(0), Some(1), Some(2), Some(3), Some(2)])?;
        let inner = || Given(vec![1.0, 1.0, 1.0, 0.5, 0.5, 0.25]);
        let full = Taper::new(inner()).with_tip_fraction(0.0).radii(&tree)?;
        assert_eq!(full, [1.0, 0.875, 0.5, 0.25, 0.0, 0.0]);
        let half = Taper::new(inner()).with_fraction(0.5).with_tip_fraction(1.0).radii(&tree)?;
        assert_eq!(half, [1.0, 0.9375, 0.75, 0.5, 0.5, 0.25]);
        let none = Taper::new(inner()).with_fraction(0.0).with_tip_fraction(1.0).radii(&tree)?;
        assert_eq!(none, inner().0);
        Ok(())
    }

    #[test]
    fn extremes() -> Result<(), Box<dyn Error>> {
        assert_eq!(Taper::new(PipeModel::default()).radii(&chain(1)?)?, [0.002]);
        let still = Skeleton::new(vec![Vec3::X; 3], vec![None, Some(0), Some(1)])?;
        assert_eq!(Taper::new(PipeModel::default()).radii(&still)?, [0.002; 3]);
        let deep = Taper::new(PipeModel::default()).radii(&chain(1_000_000)?)?;
        assert!((deep[999_999] - 0.0006).abs() < 1e-8);
        let huge = Skeleton::new(vec![Vec3::splat(f32::MIN), Vec3::splat(f32::MAX)], vec![None, Some(0)])?;
        assert!(Taper::new(PipeModel::default()).radii(&huge)?[1] > 0.0);
        Ok(())
    }

    #[test]
    fn bad_options_and_bad_models_are_refused() -> Result<(), Box<dyn Error>> {
        for bad in [-0.1, 1.1, f32::NAN, f32::INFINITY] {
            let model = Taper::new(PipeModel::default());
            let named = |model: Taper<_>| model.check().map_err(|error| error.parameter);
            assert_eq!(named(model.with_fraction(bad)), Err("Taper.fraction".into()));
            assert_eq!(named(model.with_tip_fraction(bad)), Err("Taper.tip_fraction".into()));
            let inner = Taper::new(PipeModel::default().with_exponent(-bad.abs()));
            assert_eq!(named(inner), Err("PipeModel.exponent".into()));
        }
        let fork = y_fork()?;
        let growing = Taper::new(Given(vec![1.0, 2.0, 1.0, 1.0])).radii(&fork);
        assert!(matches!(growing, Err(RadiusError::Growing { node: 1, .. })));
        let short = Taper::new(Given(vec![1.0])).radii(&fork);
        assert_eq!(short, Err(RadiusError::Length { radii: 1, nodes: 4 }));
        Ok(())
    }

    proptest! {
        #[test]
        fn keeps_the_contract_and_the_inner_bound(
            skeleton in any_skeleton(),
            fraction in 0.0f32..=1.0,
            tip_fraction in 0.0f32..=1.0,
        ) {
            let inner = Variational::guided([Vec3::X, Vec3::Z], 1.0).with_trunk_diameter(0.4);
            let want = inner.radii(&skeleton).unwrap();
            let taper = Taper::new(inner).with_fraction(fraction).with_tip_fraction(tip_fraction);
            let radii = taper.radii(&skeleton).unwrap();
            prop_assert_eq!(check_radii(&skeleton, &radii), Ok(()));
            prop_assert!(radii.iter().zip(&want).all(|(radius, inner)| radius <= inner));
            prop_assert_eq!(radii[0].to_bits(), want[0].to_bits());
            prop_assert_eq!(taper.radii(&skeleton).unwrap(), radii);
        }
    }
}
