//! From a [`Skeleton`](crate::Skeleton) to triangles.
//!
//! | builder | what it gives |
//! |---|---|
//! | [`Tubes`] | a generalized cylinder along each branch: fast, exact radii, branches stuck into what bears them |
//!
//! [`Skeleton::relaxed`](crate::Skeleton::relaxed) takes the kinks out of a skeleton first. All builders end in a [`Mesh`].
//! A [`Part`] is a mesh with its [`Material`], once or at many places ([`Instance`]): what is written and drawn.

mod material;
mod mesh;
mod part;
mod tube;

pub use material::Material;
pub use mesh::{Mesh, MeshError};
pub use part::{Instance, Part};
pub use tube::Tubes;

use crate::ParameterError;
use glam::Vec3;

/// Why no surface can be made of a skeleton.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// An option out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Every radius is zero: no radius model has been applied yet.
    #[error("all {nodes} nodes have the radius zero; set radii before making a surface")]
    NoRadii {
        /// The number of nodes.
        nodes: usize,
    },
    /// More vertices than 32-bit indices can name.
    #[error(
        "the mesh would need {vertices} vertices, but 32-bit indices name at most {}; use fewer sides",
        u32::MAX
    )]
    TooLarge {
        /// An upper bound of the vertices needed.
        vertices: usize,
    },
    /// A node so far out or so thick that its surface cannot be computed in 32-bit floats.
    #[error("node {node} at {position} with the radius {radius} reaches beyond a million kilometres")]
    TooFar {
        /// The node.
        node: usize,
        /// Its position, metres.
        position: Vec3,
        /// Its radius, metres.
        radius: f32,
    },
}
