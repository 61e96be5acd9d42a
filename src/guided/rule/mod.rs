//! How guiding vectors turn along a branch (section 3.2.1).

mod bend;
mod combine;
mod field;

pub use bend::{Bend, BendAxis};
pub use combine::{Blend, ByHeight, ByStage, Jitter, SourceElevation, SourceVector};
pub use field::FollowField;

use super::search::Search;
use crate::math::{Rotation, UP};
use crate::parameter::ParameterError;
use crate::random::{Purpose, unit};
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
/// ```
pub trait GuidingRule: Send + Sync {
    /// The guiding vector of a node that has just been settled.
    fn guide(&self, step: &Step<'_>) -> Vec3;

    /// The guiding vector with which a node of the tree enters a stage as a source. It keeps its own unless a
    /// rule says otherwise (section 3.1.4: "optionally, the guiding vectors for the source nodes are changed").
    fn source(&self, source: &Source) -> Vec3 {
        source.vector
    }

    /// Whether the options are in range; asked once, before synthesis starts.
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
            fn source(&self, source: &Source) -> Vec3 {
                (**self).source(source)
            }
            fn check(&self) -> Result<(), ParameterError> {
                (**self).check()
            }
        }
    )*};
}
forward!(&T, Box<T>, Arc<T>);

/// What a rule knows of a node that has just been settled.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Step<'a> {
    pub(super) search: &'a Search<'a>,
    /// The node that gets its vector.
    pub node: u32,
    /// The node before it on its path.
    pub from: u32,
    /// Where the node is, metres.
    pub position: Vec3,
    /// Unit vector along the edge to the node.
    pub edge: Vec3,
    /// Length of that edge, metres.
    pub length: f32,
    /// The unit guiding vector of the node before.
    pub vector: Vec3,
    /// Edges from the source of this stage: 1 at the first node off the tree.
    pub hops: u32,
    /// The stage, from 0.
    pub stage: usize,
    /// The seed of the tree.
    pub seed: u64,
}

impl Step<'_> {
    /// The node of the tree that this path starts from. O(hops).
    pub fn source(&self) -> u32 {
        self.search.source(self.from).unwrap_or(self.from)
    }

    /// Where `node` is, metres.
    ///
    /// # Panics
    /// When there is no such node.
    pub fn position_of(&self, node: u32) -> Vec3 {
        self.search.graph().position(node)
    }

    /// Where the root is, metres.
    pub fn root(&self) -> Vec3 {
        self.search.graph().position(self.search.graph().root())
    }

    /// A number in [0, 1) that belongs to `node` in this stage, the same whenever it is asked for.
    pub fn random(&self, purpose: Purpose, node: u32) -> f32 {
        unit(self.seed, self.stage as u32, purpose, u64::from(node))
    }

    /// The vector of the node before, turned by `rotation` about `axis`. Where the axis vanishes (a vertical
    /// edge, or a vertical vector) nothing is turned.
    ///
    /// Positive angles turn away from up, so that branches bend outward, then down; negative ones bend them back.
    #[inline]
    pub fn bent(&self, rotation: Rotation, axis: BendAxis) -> Vec3 {
        let axis = match axis {
            BendAxis::UpCrossEdge => UP.cross(self.edge),
            BendAxis::UpCrossVector => UP.cross(self.vector),
        };
        let length = axis.length();
        // Below this the direction is mere rounding.
        if length < 1e-5 { self.vector } else { rotation.about(axis / length, self.vector) }
    }
}

/// A node of the tree as it enters a stage.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Source {
    /// The node.
    pub node: u32,
    /// Where it is, metres.
    pub position: Vec3,
    /// Where the root is, metres.
    pub root: Vec3,
    /// The unit guiding vector it has; up for the root of a new tree.
    pub vector: Vec3,
    /// The stage that begins, from 0.
    pub stage: usize,
    /// The seed of the tree.
    pub seed: u64,
}
