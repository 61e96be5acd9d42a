//! Wavefront OBJ (`.obj`) and its materials (`.mtl`).
//!
//! Text: `v`, `vt`, `vn` and `f` lines, one object and one material per part.

use super::images::{Map, Uses, is_masked};
use super::{Axes, ExportError, check_parts};
use crate::surface::Part;
use std::io::{self, Write};

/// Writes all parts, instances multiplied out one by one, for OBJ knows none. `materials` is the name of the file that
/// [`write_mtl`] writes, as it is found from this one, in one line without a break.
///
/// Metres, +Y up, unless other axes are passed to [`write_obj_with`]. OBJ knows no tints. Textures' v goes
/// up, as OBJ has it, so it is 1 less this crate's. Every number reads back as the same bits. O(vertices +
/// triangles) time, O(1) memory.
///
/// ```
/// use treesynth::{export, glam::Vec3, surface::{Mesh, Part}};
///
/// let triangle = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2]);
/// let parts = [Part::new(&triangle)];
/// let (mut obj, mut mtl) = (Vec::new(), Vec::new());
/// export::write_obj(&parts, "tree.mtl", &mut obj)?;
/// export::write_mtl(&parts, &mut mtl)?;
/// assert!(String::from_utf8_lossy(&obj).contains("f 1//1 2//2 3//3"));
/// # Ok::<(), export::ExportError>(())
/// ```
///
/// # Errors
/// Parts without a single triangle, or that are not sound; whatever the writer returns. Once a byte is written,
/// nothing but the writer can fail.
pub fn write_obj(parts: &[Part<'_>], materials: &str, writer: impl Write) -> Result<(), ExportError> {
    write_obj_with(parts, materials, Axes::default(), writer)
}

/// As [`write_obj`], with another axis up, in another unit or about another origin. A comment at the beginning says which.
///
/// # Errors
/// As of [`write_obj`]; axes out of range.
pub fn write_obj_with(
    parts: &[Part<'_>],
    materials: &str,
    axes: Axes,
    writer: impl Write,
) -> Result<(), ExportError> {
    axes.check()?;
    check_parts(parts)?;
    let mut writer = io::BufWriter::with_capacity(1 << 16, writer);
    writeln!(writer, "# treesynth, {}", axes.note())?;
    writeln!(writer, "mtllib {}", materials.replace(char::is_control, "_"))?;
    // OBJ counts from 1, through all objects, each kind of line by itself.
    let (mut first, mut first_uv) = (1, 1);
    for (part, name) in parts.iter().zip(names(parts)) {
        let mesh = part.mesh();
        writeln!(writer, "o {name}\nusemtl {name}")?;
        for copy in part.placed().iter() {
            let (matrix, rotation) = (copy.matrix(), copy.rotation_matrix());
            for &position in &mesh.positions {
                let [x, y, z] = axes.placed(matrix * position + copy.position).to_array();
                writeln!(writer, "v {x} {y} {z}")?;
            }
            for uv in &mesh.uvs {
                writeln!(writer, "vt {} {}", uv.x, 1.0 - uv.y)?;
            }
            for &normal in &mesh.normals {
                let [x, y, z] = axes.turned(rotation * normal).to_array();
                writeln!(writer, "vn {x} {y} {z}")?;
            }
            for corners in mesh.triangles() {
                write!(writer, "f")?;
                for corner in corners.map(u64::from) {
                    let (vertex, uv) = (first + corner, first_uv + corner);
                    if mesh.uvs.is_empty() {
                        write!(writer, " {vertex}//{vertex}")?;
                    } else {
                        write!(writer, " {vertex}/{uv}/{vertex}")?;
                    }
                }
                writeln!(writer)?;
            }
            first += mesh.positions.len() as u64;
            first_uv += mesh.uvs.len() as u64;
        }
    }
    // Flushing by hand: dropping a BufWriter swallows the error.
    writer.flush()?;
    Ok(())
}

/// Writes the materials of the parts: linear colour (`Kd`), no highlight, roughness (`Pr`, as exporters of
/// physically based materials write it), and the images that they wear: colour (`map_Kd`), cut out by its
/// alpha (`map_d`), normals (`norm`, and `map_Bump`, which Blender reads as normals) and roughness
/// (`map_Pr`). `mtl_images` (feature `texture`) has the images, which belong next to this file under their
/// names. Light from behind is left out: MTL has no word for it.
///
/// # Errors
/// As of [`write_obj`].
pub fn write_mtl(parts: &[Part<'_>], writer: impl Write) -> Result<(), ExportError> {
    check_parts(parts)?;
    let mut writer = io::BufWriter::new(writer);
    writeln!(writer, "# treesynth")?;
    let uses = Uses::of(parts, MAPS);
    for (index, (part, name)) in parts.iter().zip(names(parts)).enumerate() {
        let ([red, green, blue], rough) = (part.material().color(), part.material().roughness());
        writeln!(writer, "newmtl {name}\nKd {red} {green} {blue}\nKs 0 0 0\nPr {rough}\nillum 1")?;
        let keys: [(Map, &[&str]); 3] =
            [(Map::Color, &["map_Kd"]), (Map::Normal, &["norm", "map_Bump"]), (Map::Roughness, &["map_Pr"])];
        for (map, keys) in keys {
            for (key, file) in keys.iter().filter_map(|key| Some((key, uses.name(index, map)?))) {
                writeln!(writer, "{key} {file}")?;
            }
        }
        if let Some(file) = uses.name(index, Map::Color).filter(|_| is_masked(part)) {
            writeln!(writer, "map_d {file}")?;
        }
    }
    writer.flush()?;
    Ok(())
}

/// Properties that MTL has a word for.
const MAPS: &[Map] = &[Map::Color, Map::Normal, Map::Roughness];

/// The images that the file of [`write_mtl`] names, each once, to be written next to it. Roughness is a grey
/// image of its own.
///
/// ```
/// use treesynth::export::{mtl_images, write_mtl};
/// use treesynth::glam::{Vec2, Vec3};
/// use treesynth::surface::{Mesh, Part};
/// use treesynth::texture::{Image, Textures};
///
/// let brown = Textures::default().with_base_color(Image::new(1, 1, 3, vec![90, 60, 40])?);
/// let triangle = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2]);
/// let triangle = triangle.with_uvs(vec![Vec2::ZERO, Vec2::X, Vec2::Y]);
/// let parts = [Part::new(&triangle).with_textures(&brown)];
/// let images = mtl_images(&parts);
/// assert_eq!(images[0].name(), "bark_color.png");
/// let png: Vec<u8> = images[0].png();
/// # assert!(!png.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[cfg(feature = "texture")]
pub fn mtl_images<'a>(parts: &[Part<'a>]) -> Vec<super::ImageFile<'a>> {
    Uses::of(parts, MAPS).files()
}

/// One word per part, no two alike.
fn names(parts: &[Part<'_>]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for part in parts {
        let mut name = part.name().replace(|c: char| c.is_whitespace() || c.is_control(), "_");
        if name.is_empty() {
            name = "part".into();
        }
        while names.contains(&name) {
            name.push('_');
        }
        names.push(name);
    }
    names
}
