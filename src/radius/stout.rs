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
