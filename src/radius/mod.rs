//! Thickness of a tree: from the branching alone to a radius for every internode.
//!
//! | model | thickness comes from |
//! |---|---|
//! | [`PipeModel`] | the number of tips a branch carries |
//! | [`Variational`] | the area of crown each tip supports |
//! | [`Taper`] | any other model, narrowed smoothly between forks |
//! | [`Stout`] | any other model, and no branch thinner than a share of its length |
//!
//! The first two are section 3.2, equation 2 and section 5 of the paper on variational tree synthesis;
//! [`structure_energy`] is its equation 5, the cost of such a tree.

mod energy;
mod pipe;
mod recipe;
#[cfg(test)]
pub(crate) mod sample;
mod stout;
mod taper;
mod variational;

pub use energy::structure_energy;
pub use pipe::{Calibration, PipeModel};
pub use recipe::RadiusRecipe;
pub use stout::Stout;
pub use taper::Taper;
pub use variational::{Support, Variational};

use std::sync::Arc;

use crate::{ParameterError, Skeleton};

/// Gives every internode of a skeleton its radius.
///
/// # Contract
/// [`radii`](Self::radii) returns one number per node, each finite and at least zero, and never growing
/// towards the tips: a child's radius is at most its parent's. The same skeleton always gets the same radii.
///
/// [`check_radii`] tests this. If an implementation breaks the contract: a wrong length, NaN or a negative
/// number is refused by [`Skeleton::with_radii`], and the caller of the model fails; a radius that grows
/// towards the tips goes through, and surfaces then bulge or cross themselves at forks, and
/// [`metrics::pipe_exponent`](crate::metrics::pipe_exponent) finds nothing to fit. Nothing becomes unsound.
///
/// # A model of your own
/// ```
/// use treesynth::radius::{RadiusError, RadiusModel, check_radii};
/// use treesynth::{ParameterError, Skeleton, glam::Vec3};
///
/// /// Each branch a fixed part of the thickness of the branch that bears it.
/// struct ByOrder {
///     trunk: f32,
/// }
///
/// impl RadiusModel for ByOrder {
///     fn radii(&self, skeleton: &Skeleton) -> Result<Vec<f32>, RadiusError> {
///         self.check()?;
///         // An order is never smaller than the parent's, so this never grows towards the tips.
///         Ok(skeleton.orders().iter().map(|&order| self.trunk / (1.0 + f32::from(order))).collect())
///     }
///
///     fn check(&self) -> Result<(), ParameterError> {
///         let holds = self.trunk >= 0.0 && self.trunk.is_finite();
///         ParameterError::unless(holds, "ByOrder.trunk", self.trunk, "finite and at least 0 metres")
///     }
/// }
///
/// let fork = Skeleton::new(
///     vec![Vec3::ZERO, Vec3::Y, Vec3::new(-0.5, 1.8, 0.0), Vec3::new(0.5, 1.8, 0.0)],
///     vec![None, Some(0), Some(1), Some(1)],
/// )?;
/// let radii = ByOrder { trunk: 0.1 }.radii(&fork)?;
/// check_radii(&fork, &radii)?;
/// assert_eq!(radii, [0.1, 0.1, 0.1, 0.05]);
/// assert!(ByOrder { trunk: f32::NAN }.radii(&fork).is_err());
/// let fork = fork.with_radii(radii)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait RadiusModel: Send + Sync {
    /// One radius per node, metres: that of the internode from the node's parent to it. The root's is that of
    /// the trunk base.
    ///
    /// # Errors
    /// Options out of range (whatever [`check`](Self::check) finds), and radii that the model cannot give for
    /// this skeleton.
    fn radii(&self, skeleton: &Skeleton) -> Result<Vec<f32>, RadiusError>;

    /// Checks that the options are in range, without a skeleton; called where synthesis starts, so that a
    /// mistake shows before the long work. The default accepts. A model that accepts here what
    /// [`radii`](Self::radii) refuses only costs the time until then.
    ///
    /// # Errors
    /// The first option out of range.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

macro_rules! forward {
    ($($pointer:ty),*) => {$(
        impl<T: RadiusModel + ?Sized> RadiusModel for $pointer {
            fn radii(&self, skeleton: &Skeleton) -> Result<Vec<f32>, RadiusError> {
                (**self).radii(skeleton)
            }

            fn check(&self) -> Result<(), ParameterError> {
                (**self).check()
            }
        }
    )*};
}

forward!(&T, Box<T>, Arc<T>);

/// Error of computing radii, or of radii that break the [contract](RadiusModel).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RadiusError {
    /// An option out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The number of radii is not that of the nodes.
    #[error("there are {radii} radii for {nodes} nodes")]
    Length {
        /// The number of radii.
        radii: usize,
        /// The number of nodes.
        nodes: usize,
    },
    /// A radius that is NaN or too large for `f32`.
    #[error("node {node} gets the radius {radius}, but radii must be finite")]
    NotFinite {
        /// The node.
        node: usize,
        /// Its radius, metres.
        radius: f32,
    },
    /// A radius below zero.
    #[error("node {node} gets the radius {radius}, but radii must not be negative")]
    Negative {
        /// The node.
        node: usize,
        /// Its radius, metres.
        radius: f32,
    },
    /// A child thicker than its parent.
    #[error(
        "node {node} gets the radius {radius}, more than the {parent_radius} of its parent {parent}, but radii \
         must not grow towards the tips"
    )]
    Growing {
        /// The child.
        node: usize,
        /// Its radius, metres.
        radius: f32,
        /// Its parent.
        parent: usize,
        /// The parent's radius, metres.
        parent_radius: f32,
    },
    /// A reason of a model outside this crate.
    #[error("{reason}")]
    Other {
        /// The reason, as a sentence.
        reason: String,
    },
}

/// Checks that `radii` keep the [contract](RadiusModel) on `skeleton`. O(n).
///
/// # Errors
/// The first violation: [`Length`](RadiusError::Length), [`NotFinite`](RadiusError::NotFinite),
/// [`Negative`](RadiusError::Negative) or [`Growing`](RadiusError::Growing).
pub fn check_radii(skeleton: &Skeleton, radii: &[f32]) -> Result<(), RadiusError> {
    if radii.len() != skeleton.len() {
        return Err(RadiusError::Length { radii: radii.len(), nodes: skeleton.len() });
    }
    for (node, &radius) in radii.iter().enumerate() {
        if !radius.is_finite() {
            return Err(RadiusError::NotFinite { node, radius });
        }
        if radius < 0.0 {
            return Err(RadiusError::Negative { node, radius });
        }
        if let Some(parent) = skeleton.parent(node) {
            let parent_radius = radii[parent];
            if radius > parent_radius {
                return Err(RadiusError::Growing { node, radius, parent, parent_radius });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::sample::y_fork;
    use super::*;
    use std::error::Error;

    #[test]
    fn models_go_behind_pointers() -> Result<(), Box<dyn Error>> {
        let fork = y_fork()?;
        let model = PipeModel::default();
        let want = model.radii(&fork)?;
        let boxed: Box<dyn RadiusModel> = Box::new(model);
        let shared: Arc<dyn RadiusModel> = Arc::new(model);
        assert_eq!(boxed.radii(&fork)?, want);
        assert_eq!(shared.radii(&fork)?, want);
        assert_eq!((&&model).radii(&fork)?, want);
        let bad: Box<dyn RadiusModel> = Box::new(model.with_exponent(0.0));
        assert!(bad.check().is_err());
        Ok(())
    }

    #[test]
    fn each_breach_of_the_contract_is_named() -> Result<(), Box<dyn Error>> {
        let fork = y_fork()?;
        let check = |radii: &[f32]| check_radii(&fork, radii);
        assert_eq!(check(&[1.0, 1.0, 0.5, 0.0]), Ok(()));
        assert_eq!(check(&[1.0]), Err(RadiusError::Length { radii: 1, nodes: 4 }));
        assert_eq!(
            check(&[f32::INFINITY, 1.0, 1.0, 1.0]),
            Err(RadiusError::NotFinite { node: 0, radius: f32::INFINITY })
        );
        assert!(matches!(check(&[1.0, 1.0, f32::NAN, 1.0]), Err(RadiusError::NotFinite { node: 2, .. })));
        assert_eq!(check(&[1.0, 1.0, 1.0, -1.0]), Err(RadiusError::Negative { node: 3, radius: -1.0 }));
        assert_eq!(
            check(&[1.0, 0.5, 0.5, 0.6]),
            Err(RadiusError::Growing { node: 3, radius: 0.6, parent: 1, parent_radius: 0.5 })
        );
        Ok(())
    }
}
