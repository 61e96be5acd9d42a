//! From a [`Skeleton`](crate::Skeleton) to triangles.
//!
//! | builder | what it gives |
//! |---|---|
//! | [`Tubes`] | a smooth tube along each branch, with a collar where it leaves its parent branch: fast, exact radii |
//! | [`Levels`] | the same in several levels of detail, each of at most half the triangles of the one before |
//! | [`Implicit`] | one closed, watertight mesh of the whole tree, its branches blended into each other |
//! | [`blob`] | any solid of primitives and operators, a `BlobTree`; [`Skin`](blob::Skin): a tree's, with scars and ridges that age |
//! | [`Polygonizer`] | one closed mesh of any [`BlobTree`](blob::BlobTree), with its colours |
//! | [`Unwrap`] | texture coordinates for closed meshes, along branches and around them |
//! | [`Mask`] | the parts under snow, moss and lichen: a mesh cut in two, each with its own images |
//! | [`Sway`] | the bending of a tree in the wind, for each vertex of any mesh |
//! | [`Capsules`] | branches as [`Capsule`]s, for collisions |
//!
//! [`Skeleton::relaxed`](crate::Skeleton::relaxed) takes the kinks out of a skeleton first. Meshes are plain arrays, [`Mesh`], with
//! [`Wind`] where it is wanted. A [`Part`] is a mesh with its [`Material`], once or at many places
//! ([`Instance`]), with [`Textures`](crate::texture::Textures) if it has any: what is written and drawn. A [`Scene`] has many
//! trees in their places.

mod attach;
#[cfg(test)]
mod attached;
mod axis;
pub mod blob;
mod capsule;
mod circle;
mod collar;
mod far;
mod implicit;
mod internodes;
mod lanes;
mod level;
mod mask;
mod material;
mod mesh;
mod part;
mod plan;
mod rig;
#[cfg(test)]
mod sample;
mod scene;
mod simplify;
mod sway;
mod swung;
mod transform;
mod tube;
mod unwrap;
mod weave;
mod wind;
mod wood;

pub use capsule::{Capsule, Capsules};
pub(crate) use far::{is_far, step};
pub use implicit::{Implicit, Polygonizer};
#[cfg(feature = "preview")]
pub(crate) use implicit::{solid, span};
pub use level::{Level, Levels};
pub use mask::Mask;
pub use material::Material;
pub use mesh::{Mesh, MeshError};
pub use part::{Instance, Part};
pub(crate) use rig::Rig;
pub use scene::{PlacedAsset, Scene};
pub use sway::Sway;
pub use transform::Transform;
pub use tube::Tubes;
pub use unwrap::Unwrap;
pub(crate) use wind::Air;
pub use wind::Wind;

use crate::ParameterError;
use crate::observer::Cancelled;
use glam::Vec3;

/// Error of making a surface.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// An option out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The observer cancelled the work.
    #[error("cancelled by the observer")]
    Cancelled,
    /// Every radius is zero: no radius model has been applied yet.
    #[error("all {nodes} nodes have the radius zero; give them some, e.g. by radius::PipeModel")]
    NoRadii {
        /// The number of nodes.
        nodes: usize,
    },
    /// The closed surface needs more blocks of voxels than were allowed.
    #[error(
        "the surface needs more than the {most} blocks allowed (most_blocks), each of 4 x 4 x 4 voxels, the finest \
         of {voxel} m; a block counts once more for every 32 primitives felt in it; allow more, which take about \
         0.6 GB per million, or use a larger voxel or a smaller detail"
    )]
    TooManyBlocks {
        /// The side of the finest voxels, metres.
        voxel: f32,
        /// The number of blocks allowed.
        most: usize,
    },
    /// A budget that not even the trunk keeps.
    #[error("a budget of {triangles} triangles is too small: the trunk alone needs {least}")]
    TooFewTriangles {
        /// The triangles allowed.
        triangles: usize,
        /// Least number that the trunk needs.
        least: usize,
    },
    /// More vertices than are made: [`Tubes`] make at most 150 million, which take 11 GB with their triangles; other surfaces as
    /// many as 32-bit indices can name.
    #[error(
        "the mesh would need {vertices} vertices, but at most {most} are made; use fewer sides, or a larger error or voxel"
    )]
    TooLarge {
        /// An upper bound of the vertices needed.
        vertices: usize,
        /// The most that are made.
        most: usize,
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
    /// The surface is so far from the origin that 32-bit floats cannot tell its vertices apart.
    #[error(
        "at {position} m 32-bit floats have steps of {step} m, which turn over or flatten the triangles of {}% of the \
         surface; subtract an offset, such as the trunk base, from the positions, make the surface there, and move it \
         back in 64-bit numbers",
        (lost * 100.0).ceil()
    )]
    Shapeless {
        /// Position of the surface, metres; 0 on axes on which it is near the origin.
        position: Vec3,
        /// Distance between neighbouring 32-bit floats there, metres.
        step: f32,
        /// The share of the surface whose triangles lose their shape, 0 to 1.
        lost: f32,
    },
}

impl From<Cancelled> for SurfaceError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}
