//! Meshes and skeletons as bytes, through [`std::io::Write`]: one format per module.
//!
//! | format | module | what goes in | feature |
//! |---|---|---|---|
//! | glTF 2.0 binary, `.glb` | [`gltf`] | a [`Mesh`](crate::surface::Mesh), or [`Part`]s, or levels of them, or a [`Scene`] | |
//! | Wavefront OBJ and its materials, `.obj`, `.mtl` | [`obj`] | [`Part`]s | |
//! | PLY, binary or text, `.ply` | [`ply`] | [`Part`]s | |
//! | STL, binary, `.stl` | [`stl`] | [`Part`]s | |
//! | USD, `.usda`, `.usdz` | [`usd`] | [`Part`]s, or levels or seasons of them, or a [`Scene`] | |
//! | SVG, `.svg` | [`svg`] | a [`Skeleton`](crate::Skeleton) as a drawing | |
//! | 3D Tiles 1.1, `tileset.json` | [`tileset`] | the places of models | |
//! | Apache Parquet | `parquet` | the [`TreeRecord`](crate::self_organizing::TreeRecord)s of an inventory | `parquet` |
//! | JSON | `json` | a [`Skeleton`](crate::Skeleton), and back | `json` |
//!
//! USD writes instances, and glTF on request ([`GlbOptions::with_instancing`]); glTF by default and the
//! others get each leaf's triangles one by one, which never are in memory together. All input is checked
//! before the first byte is written, so an error after it is the writer's own.

mod axes;
pub mod gltf;
mod images;
#[cfg(feature = "json")]
pub mod json;
pub mod obj;
#[cfg(feature = "parquet")]
pub mod parquet;
pub mod ply;
mod pool;
pub mod stl;
pub mod svg;
pub mod tileset;
pub mod usd;
mod watched;
mod worn;

pub use axes::Axes;
pub use gltf::{
    Breeze, GlbOptions, Instancing, LevelNodes, WindEncoding, write_glb, write_glb_levels, write_glb_parts,
    write_glb_scene,
};
#[cfg(feature = "texture")]
pub use images::ImageFile;
#[cfg(feature = "json")]
pub use json::{ReadError, read_skeleton, write_skeleton};
#[cfg(feature = "texture")]
pub use obj::mtl_images;
pub use obj::{write_mtl, write_obj, write_obj_with};
#[cfg(feature = "parquet")]
pub use parquet::write_parquet;
pub use ply::{PlyFormat, write_ply, write_ply_with};
pub use stl::{write_stl, write_stl_with};
pub use svg::{SvgOptions, write_svg};
pub use tileset::{TileModel, Tileset, write_tileset};
#[cfg(feature = "texture")]
pub use usd::usd_images;
pub use usd::{UsdStage, write_usda, write_usdz};
pub use watched::Watched;

use crate::ParameterError;
use crate::observer::Cancelled;
use crate::surface::{MeshError, Part, Scene};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// Error of writing a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The writer refused.
    #[error("writing failed: {0}")]
    Io(#[source] std::io::Error),
    /// The observer of a [`Watched`] writer cancelled the work.
    #[error("cancelled by the observer")]
    Cancelled,
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
    /// More of something than the format can count.
    #[error("there are {count} {what}, but the format counts at most {}", u32::MAX)]
    TooMany {
        /// Name of the quantity that is over its limit.
        what: &'static str,
        /// Amount.
        count: u64,
    },
}

impl From<std::io::Error> for ExportError {
    fn from(error: std::io::Error) -> Self {
        if matches!(error.get_ref(), Some(inner) if inner.is::<Cancelled>()) {
            Self::Cancelled
        } else {
            Self::Io(error)
        }
    }
}

impl ExportError {
    fn counted(what: &'static str, count: u64) -> Result<u32, Self> {
        u32::try_from(count).map_err(|_| Self::TooMany { what, count })
    }
}

/// Checks that there is a triangle, and that everything is sound.
fn check_parts(parts: &[Part<'_>]) -> Result<(), ExportError> {
    parts.iter().try_for_each(Part::check::<ExportError>)?;
    if parts.iter().all(|part| part.triangles() == 0) {
        return Err(ExportError::EmptyMesh);
    }
    Ok(())
}

/// Checks that there is a triangle, everything is sound, and everything is within range where it stands. Each
/// tree is checked once, however often it stands in the scene.
fn check_scene(scene: &Scene<'_>) -> Result<(), ExportError> {
    let mut reaches = BTreeMap::new();
    let mut triangles = 0;
    for asset in scene.assets() {
        asset.check()?;
        let (parts, transform) = (asset.parts(), asset.transform());
        let reach = match reaches.entry((parts.as_ptr(), parts.len())) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(new) => {
                parts.iter().try_for_each(Part::check::<ExportError>)?;
                triangles += parts.iter().map(Part::triangles).sum::<u64>();
                *new.insert(parts.iter().map(Part::reach).fold(0.0, f32::max))
            }
        };
        let farthest = transform.position.abs().max_element() + 2.0 * transform.scale * reach;
        let range = "a place from which the whole tree reaches no point beyond all numbers";
        ParameterError::unless(farthest.is_finite(), "Scene.transform", transform, range)?;
    }
    if triangles == 0 { Err(ExportError::EmptyMesh) } else { Ok(()) }
}
