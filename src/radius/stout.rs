//! Thickness that holds what it carries up.

use super::{RadiusError, RadiusModel, check_radii};
use crate::{ParameterError, Skeleton};

/// Another model's radii, but no branch thinner than a share of the way from it to its farthest tip.
///
/// The pipe model gives a limb of seven metres that ends in one tip the thickness of a twig. Wood of that slenderness
/// would break under its own weight; measured limbs are seldom thinner than a hundredth of their length. O(n).
///
/// ```
/// use treesynth::radius::{PipeModel, RadiusModel, Stout};
/// use treesynth::{Skeleton, glam::Vec3};
///
/// let whip = Skeleton::new(vec![Vec3::ZERO, Vec3::Y * 2.0, Vec3::Y * 4.0], vec![None, Some(0), Some(1)])?;
/// let thin = PipeModel::default().with_tip_diameter(0.004);
/// let radii = Stout::new(thin, 0.01).radii(&whip)?;
/// assert_eq!(radii, [0.02, 0.02, 0.01]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Stout<M> {
    inner: M,
    share: f32,
}

crate::recipe::mapped!(Stout { inner; share });

impl<M: RadiusModel> Stout<M> {
    /// A diameter of at least `share` of the way along the branches to the farthest tip, in [0, 1]; internodes count
    /// from their lower end. The root has the radius of the thickest that leaves it.
    pub fn new(inner: M, share: f32) -> Self {
        Self { inner, share }
    }

    /// The model inside.
    pub fn inner(&self) -> &M {
        &self.inner
    }
}

impl<M: RadiusModel> RadiusModel for Stout<M> {
    fn radii(&self, skeleton: &Skeleton) -> Result<Vec<f32>, RadiusError> {
        self.check()?;
        let mut radii = self.inner.radii(skeleton)?;
        check_radii(skeleton, &radii)?;
        // In f64, where no sum of f32 distances overflows.
        let mut reach = vec![0f64; skeleton.len()];
        let at = |node: usize| skeleton.positions()[node].as_dvec3();
        for (node, parent) in skeleton.edges().rev() {
            let from_base = reach[node] + at(node).distance(at(parent));
            reach[parent] = reach[parent].max(from_base);
            radii[node] = radii[node].max((from_base * f64::from(self.share) * 0.5) as f32);
            radii[parent] = radii[parent].max(radii[node]);
        }
        Ok(radii)
    }

    fn check(&self) -> Result<(), ParameterError> {
        let fits = (0.0..=1.0).contains(&self.share);
        ParameterError::unless(fits, "Stout.share", self.share, "in [0, 1]")?;
        self.inner.check()
    }
}

#[cfg(test)]
mod tests {
    use super::super::PipeModel;
    use super::super::sample::{any_skeleton, chain, y_fork};
    use super::*;
    use proptest::prelude::*;
    use std::error::Error;

    #[test]
    fn y_fork_by_hand() -> Result<(), Box<dyn Error>> {
        let thin = PipeModel::default().with_tip_diameter(1e-4);
        let arm = (0.5_f32 * 0.5 + 0.8 * 0.8).sqrt();
        let radii = Stout::new(thin, 0.1).radii(&y_fork()?)?;
        let wanted = [0.05 * (1.0 + arm), 0.05 * (1.0 + arm), 0.05 * arm, 0.05 * arm];
        assert!(radii.iter().zip(wanted).all(|(radius, wanted)| (radius - wanted).abs() < 1e-6), "{radii:?}");
        // Wood that is thick enough stays as it is.
        let thick = PipeModel::default().with_tip_diameter(0.4);
        assert_eq!(Stout::new(thick, 0.1).radii(&y_fork()?)?, thick.radii(&y_fork()?)?);
        assert_eq!(Stout::new(thin, 1.0).radii(&chain(1)?)?, [5e-5]);
        Ok(())
    }

    #[test]
    fn bad_options_are_named() -> Result<(), Box<dyn Error>> {
        let model = PipeModel::default();
        assert_eq!(Stout::new(model, 1.0).check(), Ok(()));
        assert_eq!(Stout::new(model, 0.0).check(), Ok(()));
        for share in [-0.1, 1.1, f32::NAN] {
            let named = Stout::new(model, share).check().map_err(|error| error.parameter);
            assert_eq!(named, Err("Stout.share".into()));
            assert!(Stout::new(model, share).radii(&chain(2)?).is_err());
        }
        let inner = Stout::new(model.with_exponent(0.0), 0.5).check().map_err(|error| error.parameter);
        assert_eq!(inner, Err("PipeModel.exponent".into()));
        Ok(())
    }

    proptest! {
        #[test]
        fn no_branch_is_thinner(skeleton in any_skeleton(), share in 0.0f32..0.2) {
            let model = PipeModel::default();
            let (plain, radii) = (model.radii(&skeleton).unwrap(), Stout::new(model, share).radii(&skeleton).unwrap());
            prop_assert_eq!(check_radii(&skeleton, &radii), Ok(()));
            prop_assert!(radii.iter().zip(&plain).all(|(stout, plain)| stout >= plain));
            for (node, parent) in skeleton.edges() {
                let length = skeleton.positions()[node].distance(skeleton.positions()[parent]);
                prop_assert!(2.0 * radii[node] >= share * length * 0.9999);
            }
        }
    }
}
