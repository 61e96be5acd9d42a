//! Rules by which guiding vectors turn along a branch (section 3.2.1).

mod bend;
mod combine;
mod field;
mod fork;
mod step;

pub use bend::{Bend, BendAxis};
pub use combine::{Blend, ByHeight, ByStage, ByTree, Jitter, SourceElevation, SourceVector};
pub use field::FollowField;
pub use fork::ForkAngle;
pub use step::{Source, Step};

use crate::parameter::ParameterError;
use glam::Vec3;
use std::sync::Arc;

/// Gives each node its guiding vector, the direction in which travel is cheap.
///
/// # Contract
/// - [`guide`](Self::guide) and [`source`](Self::source) return a finite vector that is not zero; the search
///   makes it a unit vector. Anything else ends the synthesis with [`SearchError::Vector`].
/// - The same step gives the same vector, whatever was asked before: randomness comes from
///   [`Step::random`] or a [`stream`](crate::random::stream), never from a generator kept inside. If not, equal
///   seeds no longer give equal trees.
///
/// [`SearchError::Vector`]: super::SearchError::Vector
///
/// ```
/// use treesynth::{GuidingRule, glam::Vec3, guided::Step};
///
/// /// Turns towards the light a little at every node.
/// struct Phototropism { light: Vec3, strength: f32 }
///
/// impl GuidingRule for Phototropism {
///     fn guide(&self, step: &Step<'_>) -> Vec3 {
///         step.vector + (self.light - step.position).normalize_or_zero() * self.strength
///     }
/// }
///
/// // A step of one's own making tries a rule without a tree.
/// let rule = Phototropism { light: Vec3::new(9.0, 1.0, 0.0), strength: 0.1 };
/// let step = Step::new(Vec3::Y, Vec3::Y * 0.2, Vec3::Y);
/// assert!(rule.guide(&step).x > 0.0);
/// ```
pub trait GuidingRule: Send + Sync {
    /// The guiding vector of a node that is being settled. Asked again for the same node where a better way to it is
    /// found.
    fn guide(&self, step: &Step<'_>) -> Vec3;

    /// The guiding vector with which a node of the tree enters a stage as a source. It keeps its own unless a
    /// rule says otherwise (section 3.1.4: "optionally, the guiding vectors for the source nodes are changed").
    fn source(&self, source: &Source<'_>) -> Vec3 {
        source.vector
    }

    /// Checks that the options are in range; called once, before synthesis starts.
    ///
    /// # Errors
    /// The first option that is not.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

macro_rules! forward {
    ($($pointer:ty),*) => {$(
        impl<T: GuidingRule + ?Sized> GuidingRule for $pointer {
            fn guide(&self, step: &Step<'_>) -> Vec3 {
                (**self).guide(step)
            }
            fn source(&self, source: &Source<'_>) -> Vec3 {
                (**self).source(source)
            }
            fn check(&self) -> Result<(), ParameterError> {
                (**self).check()
            }
        }
    )*};
}
forward!(&T, Box<T>, Arc<T>);
