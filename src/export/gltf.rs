//! glTF 2.0, the binary container (`.glb`).
//!
//! One scene and one buffer inside the file; a material for each look, its images as PNG, a mesh for each [`Part`]. By default
//! all of it is core glTF, which every reader shows whole; instances through `EXT_mesh_gpu_instancing` or as nodes, levels
//! of detail through `MSFT_lod` or by names, and numbers of few bits through `KHR_mesh_quantization` are [options](GlbOptions).
//! Specification: <https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>; the numbers below are its constants.

mod array;
mod buffer;
mod document;
mod look;
mod options;
mod skin;
pub(super) mod text;
mod wind;

pub use options::{GlbOptions, Instancing, LevelNodes};
pub use skin::Breeze;
pub use wind::WindEncoding;

use super::{ExportError, check_parts, check_scene};
use crate::ParameterError;
use crate::surface::{Mesh, Part, Scene};
use document::Document;
use skin::Skins;
use std::io::{self, Write};

/// `glTF`, `JSON` and `BIN\0` as little-endian numbers.
const MAGIC: u32 = 0x4654_6C67;
const CHUNK_JSON: u32 = 0x4E4F_534A;
const CHUNK_BINARY: u32 = 0x004E_4942;
const VERSION: u32 = 2;

/// Writes `mesh` as a glTF 2.0 binary file: positions, normals, indices, and whatever else the vertices have: tangents,
/// texture coordinates (`TEXCOORD_0`), colours (`COLOR_0`), and [`Wind`](crate::surface::Wind) by the
/// [encoding](WindEncoding) asked for.
///
/// glTF's axes and unit are this crate's (right-handed, +Y up, metres), so nothing is converted and every number
/// comes back as it is. The same mesh and options give the same bytes. O(vertices + triangles) time, O(1) memory.
///
/// ```
/// use treesynth::{export, glam::Vec3, surface::Mesh};
///
/// let triangle = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2]);
/// let mut glb = Vec::new();
/// export::write_glb(&triangle, &export::GlbOptions::default().with_name("leaf"), &mut glb)?;
/// assert_eq!(&glb[..4], b"glTF");
/// # Ok::<(), export::ExportError>(())
/// ```
///
/// # Errors
/// A mesh without triangles, or whose arrays are not [sound](Mesh::check)
/// (triangles without area are written as they are); an option out of range; more than 4 GiB; whatever the
/// writer returns. Once a byte is written, nothing but the writer can fail.
pub fn write_glb(mesh: &Mesh, options: &GlbOptions, writer: impl Write) -> Result<(), ExportError> {
    let part = Part::new(mesh).with_name(&options.name).with_material(options.material);
    write_glb_parts(&[part], options, writer)
}

/// Writes bark, leaves and whatever else a tree has into one file. A material is written once; a mesh once with
/// [`Instancing::Extension`] and [`Instancing::Nodes`], and by default with the vertices of all its copies; parts without triangles or without instances are left out.
///
/// O(vertices + triangles + instances) time; O(parts) memory, and the text of one node per instance with
/// [`Instancing::Nodes`].
///
/// ```
/// use treesynth::foliage::{Foliage, Leaf};
/// use treesynth::surface::{Part, Tubes};
/// use treesynth::{Skeleton, export, glam::Vec3};
///
/// let twig = Skeleton::new(vec![Vec3::ZERO, Vec3::Y * 0.3], vec![None, Some(0)])?.with_radii(vec![0.003; 2])?;
/// let (bark, leaves) = (Tubes::default().mesh(&twig)?, Foliage::new(Leaf::ovate()).place(&twig, 7)?);
/// let mut glb = Vec::new();
/// export::write_glb_parts(&[Part::new(&bark), leaves.part()], &export::GlbOptions::default(), &mut glb)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As of [`write_glb`], when no part has triangles, and for instances that cannot be placed.
pub fn write_glb_parts(
    parts: &[Part<'_>],
    options: &GlbOptions,
    writer: impl Write,
) -> Result<(), ExportError> {
    write_glb_levels(&[parts], options, writer)
}

/// Writes several levels of detail of one tree, the finest first, into one file (`MSFT_lod`). A program that does not
/// know the extension shows the finest.
///
/// # Errors
/// As of [`write_glb_parts`], for every level; no levels at all.
pub fn write_glb_levels<'a>(
    levels: &[impl AsRef<[Part<'a>]>],
    options: &GlbOptions,
    writer: impl Write,
) -> Result<(), ExportError> {
    options.check(levels.len())?;
    levels.iter().try_for_each(|level| check_parts(level.as_ref()))?;
    if levels.is_empty() {
        return Err(ExportError::EmptyMesh);
    }
    let skins = options.breeze.as_ref().map(|breeze| Skins::new(breeze, levels[0].as_ref())).transpose()?;
    let document = match &skins {
        Some(skins) => Document::of_breeze(levels[0].as_ref(), skins, options)?,
        None => Document::of_levels(levels, options)?,
    };
    write_document(&document, writer)
}

/// Writes trees in their places: one node each, with one node per part below it. Meshes and images that are
/// the same, wherever they lie in memory, are written once.
///
/// O(vertices + triangles + instances of all that differs, and again of what is the same) time.
///
/// ```
/// use treesynth::glam::Vec3;
/// use treesynth::surface::{Mesh, Part, Scene, Transform};
/// use treesynth::export;
///
/// let triangle = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2]);
/// let tree = [Part::new(&triangle)];
/// let stand = (0..100).fold(Scene::default(), |stand, i| {
///     stand.with_asset("tree", &tree, Transform::at(Vec3::X * i as f32))
/// });
/// let mut glb = Vec::new();
/// export::write_glb_scene(&stand, &export::GlbOptions::default(), &mut glb)?;
/// assert!(glb.len() < 10_000);
/// # Ok::<(), export::ExportError>(())
/// ```
///
/// # Errors
/// As of [`write_glb_parts`]; a scene without a triangle.
pub fn write_glb_scene(
    scene: &Scene<'_>,
    options: &GlbOptions,
    writer: impl Write,
) -> Result<(), ExportError> {
    options.check(1)?;
    let still = options.breeze.is_none();
    ParameterError::unless(
        still,
        "GlbOptions.breeze",
        "a breeze",
        "none in a scene: a file has one skeleton of bones",
    )?;
    check_scene(scene)?;
    write_document(&Document::of_scene(scene, options)?, writer)
}

fn write_document(document: &Document<'_>, writer: impl Write) -> Result<(), ExportError> {
    let mut json = document.json().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let bytes = 12 + 8 + json.len() as u64 + 8 + document.bytes();
    if bytes > u64::from(u32::MAX) {
        return Err(ExportError::TooLarge { bytes, limit: u64::from(u32::MAX) });
    }

    let mut writer = io::BufWriter::with_capacity(1 << 16, writer);
    for word in [MAGIC, VERSION, bytes as u32, json.len() as u32, CHUNK_JSON] {
        writer.write_all(&word.to_le_bytes())?;
    }
    writer.write_all(&json)?;
    for word in [document.bytes() as u32, CHUNK_BINARY] {
        writer.write_all(&word.to_le_bytes())?;
    }
    for array in document.arrays() {
        array.write(&mut writer)?;
    }
    // Flushing by hand: dropping a BufWriter swallows the error.
    writer.flush()?;
    Ok(())
}

#[cfg(test)]
mod tests;
