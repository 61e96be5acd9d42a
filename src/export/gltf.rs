//! glTF 2.0, the binary container (`.glb`).
//!
//! One scene and one buffer inside the file; a material for each look, a mesh for each [`Part`], instances through
//! `EXT_mesh_gpu_instancing` or as nodes, levels of detail through `MSFT_lod`. Specification:
//! <https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>; the numbers below are its constants.

mod document;
mod skin;
mod wind;

use super::{ExportError, check_parts};
use crate::ParameterError;
use crate::surface::{Instance, Material, Mesh, Part, Wind};
use document::Document;
use glam::{Vec2, Vec3, Vec4};
pub use skin::Breeze;
use skin::Skins;
use std::io::{self, Write};
use wind::Column;
pub use wind::WindEncoding;

/// `glTF`, `JSON` and `BIN\0` as little-endian numbers.
const MAGIC: u32 = 0x4654_6C67;
const CHUNK_JSON: u32 = 0x4E4F_534A;
const CHUNK_BINARY: u32 = 0x004E_4942;
const VERSION: u32 = 2;

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const UNSIGNED_SHORT: u32 = 5123;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// How a glTF file says that a mesh stands in many places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Instancing {
    /// `EXT_mesh_gpu_instancing`: 40 bytes an instance, drawn at once. Blender and three.js read it
    /// (`scripts/check_exports`), and others; a program that does not shows one leaf at the foot of the tree.
    #[default]
    Extension,
    /// A node an instance, which every program reads: about 200 bytes each, and as many objects in the program.
    Nodes,
}

/// What a glTF file says besides the triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct GlbOptions {
    name: String,
    material: Material,
    instancing: Instancing,
    coverages: Vec<f32>,
    wind: WindEncoding,
    breeze: Option<Breeze>,
}

impl Default for GlbOptions {
    /// Named `tree`, [`Material::bark`], [`Instancing::Extension`], no screen coverages, [`WindEncoding::Attributes`], no breeze.
    fn default() -> Self {
        Self {
            name: "tree".into(),
            material: Material::bark(),
            instancing: Instancing::default(),
            coverages: Vec::new(),
            wind: WindEncoding::default(),
            breeze: None,
        }
    }
}

impl GlbOptions {
    /// The name of the scene's node; any text; default `tree`.
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// How the mesh that [`write_glb`] is given looks; default [`Material::bark`]. Parts bring their own.
    pub fn with_material(mut self, material: Material) -> Self {
        self.material = material;
        self
    }

    /// How instances are written; default [`Instancing::Extension`].
    pub fn with_instancing(mut self, instancing: Instancing) -> Self {
        self.instancing = instancing;
        self
    }

    /// For each level of [`write_glb_levels`] the part of the screen's height down to which it is shown, 0 to 1,
    /// falling: `MSFT_screencoverage`. Default none: the program decides.
    pub fn with_coverages(mut self, coverages: impl Into<Vec<f32>>) -> Self {
        self.coverages = coverages.into();
        self
    }

    /// How the [`Wind`] of vertices is written, if they have it; default [`WindEncoding::Attributes`].
    pub fn with_wind(mut self, encoding: WindEncoding) -> Self {
        self.wind = encoding;
        self
    }

    /// Bones and an animation of a breeze for the parts that have [`Wind`], in a file of one level; default none.
    pub fn with_breeze(mut self, breeze: Breeze) -> Self {
        self.breeze = Some(breeze);
        self
    }

    fn check(&self, levels: usize) -> Result<(), ParameterError> {
        self.material.check()?;
        let coverages = &self.coverages;
        let holds = coverages.is_empty()
            || coverages.len() == levels
                && coverages.iter().all(|coverage| (0.0..=1.0).contains(coverage))
                && coverages.is_sorted_by(|a, b| a > b);
        let still = self.breeze.is_none() || levels == 1;
        ParameterError::unless(still, "GlbOptions.breeze", levels, "in a file of one level")?;
        let range = "falling numbers from 1 to 0, one a level, or none";
        ParameterError::unless(holds, "GlbOptions.coverages", coverages, range)
    }
}

/// Writes `mesh` as a glTF 2.0 binary file: positions, normals, indices, and whatever else the vertices have: tangents,
/// texture coordinates (`TEXCOORD_0`), colours (`COLOR_0`), and [`Wind`] by the [encoding](WindEncoding) asked for.
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

/// Writes bark, leaves and whatever else a tree has into one file. A mesh and a material are written once, however many
/// instances and parts have them; parts without triangles or without instances are left out.
///
/// O(vertices + triangles + instances) time; O(parts) memory, and a node's text an instance with
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
    let parts = levels.first().map_or(&[][..], |level| level.as_ref());
    let skins = options.breeze.as_ref().map(|breeze| Skins::new(breeze, parts)).transpose()?;
    let document = Document::new(levels, options, skins.as_ref()).ok_or(ExportError::EmptyMesh)?;
    let mut json = document.json(options).into_bytes();
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
    // Every element is a whole number of 4-byte words, so each array starts aligned and the chunk needs no padding.
    for data in document.arrays() {
        data.write(&mut writer)?;
    }
    // Flushing by hand: dropping a BufWriter swallows the error.
    writer.flush()?;
    Ok(())
}

/// The vertex attributes of a mesh, positions first.
fn attributes<'a>(mesh: &'a Mesh, options: &GlbOptions) -> Vec<(&'static str, Data<'a>)> {
    let mut attributes =
        vec![("POSITION", Data::Vec3(&mesh.positions)), ("NORMAL", Data::Vec3(&mesh.normals))];
    for (name, data) in [
        ("TANGENT", Data::Vec4(&mesh.tangents)),
        ("TEXCOORD_0", Data::Vec2(&mesh.uvs)),
        ("COLOR_0", Data::Colors(&mesh.colors)),
    ] {
        if data.count() > 0 {
            attributes.push((name, data));
        }
    }
    attributes.extend(wind::attributes(mesh, options.wind));
    attributes
}

/// One array of the buffer: where its numbers come from.
#[derive(Debug, Clone, Copy)]
enum Data<'a> {
    Vec2(&'a [Vec2]),
    Vec3(&'a [Vec3]),
    Vec4(&'a [Vec4]),
    Colors(&'a [[f32; 3]]),
    Wind(&'a [Wind], Column),
    Bones(&'a [[u16; 4]]),
    Matrices(&'a [[f32; 16]]),
    Times(&'a [f32]),
    Turns(&'a [Vec4]),
    Indices(&'a [u32]),
    Translations(&'a [Instance]),
    Rotations(&'a [Instance]),
    Scales(&'a [Instance]),
}

impl Data<'_> {
    fn count(self) -> usize {
        match self {
            Self::Vec2(array) => array.len(),
            Self::Vec3(array) => array.len(),
            Self::Vec4(array) | Self::Turns(array) => array.len(),
            Self::Colors(array) => array.len(),
            Self::Wind(array, _) => array.len(),
            Self::Bones(array) => array.len(),
            Self::Matrices(array) => array.len(),
            Self::Times(array) => array.len(),
            Self::Indices(array) => array.len(),
            Self::Translations(array) | Self::Rotations(array) | Self::Scales(array) => array.len(),
        }
    }

    /// Words of four bytes an element, and what glTF calls that.
    fn kind(self) -> (u64, &'static str) {
        match self {
            Self::Wind(_, column) => match column.words() {
                1 => (1, "SCALAR"),
                2 => (2, "VEC2"),
                _ => (3, "VEC3"),
            },
            Self::Indices(_) | Self::Times(_) => (1, "SCALAR"),
            // Four numbers of two bytes.
            Self::Bones(_) => (2, "VEC4"),
            Self::Matrices(_) => (16, "MAT4"),
            Self::Vec2(_) => (2, "VEC2"),
            Self::Vec3(_) | Self::Colors(_) | Self::Translations(_) | Self::Scales(_) => (3, "VEC3"),
            Self::Vec4(_) | Self::Rotations(_) | Self::Turns(_) => (4, "VEC4"),
        }
    }

    fn bytes(self) -> u64 {
        self.count() as u64 * self.kind().0 * 4
    }

    fn component(self) -> u32 {
        match self {
            Self::Indices(_) => UNSIGNED_INT,
            Self::Bones(_) => UNSIGNED_SHORT,
            _ => FLOAT,
        }
    }

    /// What the array is for; instances and animations are not for the vertex pipeline.
    fn target(self) -> Option<u32> {
        match self {
            Self::Indices(_) => Some(ELEMENT_ARRAY_BUFFER),
            Self::Translations(_)
            | Self::Rotations(_)
            | Self::Scales(_)
            | Self::Matrices(_)
            | Self::Times(_)
            | Self::Turns(_) => None,
            _ => Some(ARRAY_BUFFER),
        }
    }

    fn write(self, writer: &mut impl Write) -> io::Result<()> {
        let floats = f32::to_le_bytes;
        match self {
            Self::Vec2(array) => write_all(writer, array, |v| v.to_array().map(floats)),
            Self::Vec3(array) => write_all(writer, array, |v| v.to_array().map(floats)),
            Self::Vec4(array) => write_all(writer, array, |v| v.to_array().map(floats)),
            Self::Colors(array) => write_all(writer, array, |color| color.map(floats)),
            Self::Wind(array, column) => match column.words() {
                1 => write_all(writer, array, |wind| [floats(column.of(wind)[0])]),
                2 => write_all(writer, array, |wind| {
                    let [x, y, _] = column.of(wind);
                    [x, y].map(floats)
                }),
                _ => write_all(writer, array, |wind| column.of(wind).map(floats)),
            },
            Self::Bones(array) => write_all(writer, array, |&[a, b, c, d]| {
                let pair = |low: u16, high: u16| (u32::from(low) | u32::from(high) << 16).to_le_bytes();
                [pair(a, b), pair(c, d)]
            }),
            Self::Matrices(array) => write_all(writer, array, |matrix| matrix.map(floats)),
            Self::Times(array) => write_all(writer, array, |time| [floats(*time)]),
            Self::Turns(array) => write_all(writer, array, |turn| turn.to_array().map(floats)),
            Self::Indices(array) => write_all(writer, array, |i| [i.to_le_bytes()]),
            Self::Translations(array) => write_all(writer, array, |i| i.position.to_array().map(floats)),
            Self::Rotations(array) => write_all(writer, array, |i| i.rotation.to_array().map(floats)),
            Self::Scales(array) => write_all(writer, array, |i| [i.scale; 3].map(floats)),
        }
    }
}

/// Thousands of elements a call, since calls cost more than bytes.
fn write_all<T, const N: usize>(
    writer: &mut impl Write,
    array: &[T],
    words: impl Fn(&T) -> [[u8; 4]; N],
) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(4096 * 4 * N);
    for elements in array.chunks(4096) {
        bytes.clear();
        for element in elements {
            bytes.extend_from_slice(words(element).as_flattened());
        }
        writer.write_all(&bytes)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
