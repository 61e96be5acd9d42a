//! Meshes and skeletons as bytes, through [`std::io::Write`]: one format a module.
//!
//! | format | module | what goes in | feature |
//! |---|---|---|---|
//! | glTF 2.0 binary, `.glb` | [`gltf`] | a [`Mesh`](crate::surface::Mesh) | |
//! | JSON | `json` | a [`Skeleton`](crate::Skeleton), and back | `json` |
//!
//! Writers get many small pieces: hand in a [`BufWriter`](std::io::BufWriter) around a file.

pub mod gltf;
#[cfg(feature = "json")]
pub mod json;

pub use gltf::{GlbOptions, write_glb};
#[cfg(feature = "json")]
pub use json::{ReadError, read_skeleton, write_skeleton};

use crate::ParameterError;
use crate::surface::MeshError;

/// Why something could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The writer refused.
    #[error("writing failed: {0}")]
    Io(#[from] std::io::Error),
    /// An option out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The mesh has no triangles, which the format does not allow.
    #[error("the mesh has no triangles, and the format has no way to say so")]
    EmptyMesh,
    /// The mesh's arrays do not fit together.
    #[error("the mesh is not sound: {0}")]
    Mesh(#[from] MeshError),
    /// More bytes than the format can count.
    #[error("the file would have {bytes} bytes, but the format counts at most {limit}")]
    TooLarge {
        /// The bytes needed.
        bytes: u64,
        /// The bytes allowed.
        limit: u64,
    },
}
