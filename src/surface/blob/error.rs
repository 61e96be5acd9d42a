//! Errors of making a [`BlobTree`](super::BlobTree).

use crate::observer::Cancelled;
use crate::{Bounds, ParameterError};
use glam::Affine3A;

/// Error of making a [`BlobTree`](super::BlobTree).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BlobError {
    /// The observer cancelled the work.
    #[error("cancelled by the observer")]
    Cancelled,
    /// An option out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// An operator on nothing, or on one part where two are needed.
    #[error("{operator} needs {least} parts or more, but got {parts}")]
    TooFewParts {
        /// The operator.
        operator: &'static str,
        /// Number needed.
        least: usize,
        /// Number given.
        parts: usize,
    },
    /// A node of another builder.
    #[error("node {node} belongs to another builder")]
    Stranger {
        /// Its number.
        node: u32,
    },
    /// A bounding field may exceed 1.
    #[error("a bounding field must be 0 to 1, but this may reach {most}")]
    BoundingField {
        /// The greatest value it may have.
        most: f32,
    },
    /// An affine map without a usable inverse.
    #[error(
        "a warp must be finite and stretch no direction 100,000 times as much as another, alone and together with the \
         warps around it, but this is {map}"
    )]
    Singular {
        /// The map.
        map: Box<Affine3A>,
    },
    /// The tree is empty: the field is nowhere 1/2.
    #[error("the BlobTree is empty: its field is at most {most}, but a surface is where it is 0.5")]
    Empty {
        /// The greatest value it may have.
        most: f32,
    },
    /// Farther out than can be computed with.
    #[error("the BlobTree reaches from {} to {}, but at most 4e9 m out can be computed with", bounds.min, bounds.max)]
    TooFar {
        /// Box in which anything is felt, metres.
        bounds: Bounds,
    },
    /// More nodes than 32-bit numbers can name.
    #[error("a BlobTree has at most a billion nodes, this has {nodes}")]
    TooLarge {
        /// The number of nodes so far.
        nodes: usize,
    },
    /// A curve without points, or with another number of radii.
    #[error("a curve needs one point at least and as many radii, but has {points} points and {radii} radii")]
    Curve {
        /// The number of points.
        points: usize,
        /// The number of radii.
        radii: usize,
    },
    /// A skeleton's node without thickness.
    #[error("node {node} has the radius {radius}, but a skin needs 1e-9 to 1e9 m; set radii first")]
    Radius {
        /// The node.
        node: usize,
        /// Its radius, metres.
        radius: f32,
    },
}

impl From<Cancelled> for BlobError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}
