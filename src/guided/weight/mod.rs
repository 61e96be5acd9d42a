//! Weights of edges (section 3.1.2).

mod apart;
mod edge;
mod guided;
mod multimodal;
mod within;

pub use apart::Apart;
pub use edge::{Edge, Star};
pub use guided::{Guided, GuidedPower, Length};
pub use multimodal::Multimodal;
pub use within::Within;

use crate::parameter::ParameterError;
use std::sync::Arc;

/// Gives each edge its weight, once the node it starts from has its guiding vector.
///
/// # Contract
/// - A weight is at least 0, and infinite where an edge is forbidden. NaN and negative weights end the synthesis
///   with [`SearchError::Weight`]: least-cost paths would not exist.
/// - The same edge gives the same weight. If not, equal seeds no longer give equal trees.
/// - A function that may return infinity says so in [`forbids`](Self::forbids). If it does not, endpoints may be
///   chosen where no path leads, and the synthesis ends with [`SearchError::Unreachable`].
///
/// [`SearchError::Weight`]: super::SearchError::Weight
/// [`SearchError::Unreachable`]: super::SearchError::Unreachable
///
/// ```
/// use treesynth::{WeightFn, guided::Edge};
///
/// /// Guided as in the paper, but climbing costs extra.
/// struct Heavy { gravity: f32 }
///
/// impl WeightFn for Heavy {
///     fn weight(&self, edge: &Edge<'_>) -> f32 {
///         edge.guided() + self.gravity * (edge.end.y - edge.start.y).max(0.0)
///     }
/// }
/// ```
pub trait WeightFn: Send + Sync {
    /// The weight of `edge`.
    fn weight(&self, edge: &Edge<'_>) -> f32;

    /// The weights of a star's edges, in their order. The search asks for all weights by it, so that one call through a
    /// pointer serves many edges; also for those of a way that proves not to be the best. Calls [`weight`](Self::weight) for each; override it only to share work between
    /// the edges, and give the same weights.
    fn weights(&self, star: &Star<'_>, weights: &mut [f32]) {
        for (i, weight) in weights.iter_mut().enumerate() {
            *weight = self.weight(&star.edge(i));
        }
    }

    /// `true` if a weight may be infinite. Endpoints are then chosen after the search, among nodes it
    /// reached.
    fn forbids(&self) -> bool {
        false
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
        impl<T: WeightFn + ?Sized> WeightFn for $pointer {
            fn weight(&self, edge: &Edge<'_>) -> f32 {
                (**self).weight(edge)
            }
            fn weights(&self, star: &Star<'_>, weights: &mut [f32]) {
                (**self).weights(star, weights);
            }
            fn forbids(&self) -> bool {
                (**self).forbids()
            }
            fn check(&self) -> Result<(), ParameterError> {
                (**self).check()
            }
        }
    )*};
}
forward!(&T, Box<T>, Arc<T>);

fn check_factor(parameter: &str, factor: f32, infinite: bool) -> Result<(), ParameterError> {
    let range = if infinite { "at least 0, or infinite" } else { "at least 0 and finite" };
    ParameterError::unless(factor >= 0.0 && (infinite || factor.is_finite()), parameter, factor, range)
}
