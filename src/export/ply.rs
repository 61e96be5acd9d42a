//! PLY (`.ply`), binary or text: vertices with normals, texture coordinates and colours, and triangles.

use super::{Axes, ExportError, check_parts};
use crate::surface::Part;
use glam::Vec3;
use std::io::{self, Write};

/// Encoding of a PLY file's numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum PlyFormat {
    /// `binary_little_endian`: 27 bytes per vertex, 8 more with texture coordinates, 13 per triangle.
    #[default]
    Binary,
    /// `ascii`, for eyes and scripts. Every number reads back as the same bits.
    Ascii,
}

/// Writes all parts as one list of vertices and one of triangles, instances multiplied out one by one. The parts'
/// colours go to the vertices (sRGB), times the vertices' own and the copies' tints; texture coordinates `s` and `t` are there if every part has them, `t` going up.
///
/// Metres, +Y up, unless other axes are passed to [`write_ply_with`]. O(vertices + triangles) time, O(1)
/// memory.
///
/// ```
/// use treesynth::export::{self, PlyFormat};
/// use treesynth::{glam::Vec3, surface::{Mesh, Part}};
///
/// let triangle = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2]);
/// let mut ply = Vec::new();
/// export::write_ply(&[Part::new(&triangle)], PlyFormat::Ascii, &mut ply)?;
/// assert!(String::from_utf8_lossy(&ply).ends_with("3 0 1 2\n"));
/// # Ok::<(), export::ExportError>(())
/// ```
///
/// # Errors
/// Parts without a single triangle, or that are not sound; more vertices or triangles than 32 bits count; whatever the
/// writer returns. Once a byte is written, nothing but the writer can fail.
pub fn write_ply(parts: &[Part<'_>], format: PlyFormat, writer: impl Write) -> Result<(), ExportError> {
    write_ply_with(parts, format, Axes::default(), writer)
}

/// As [`write_ply`], with another axis up or in another unit. A comment of the header says which.
///
/// # Errors
/// As of [`write_ply`]; axes out of range.
pub fn write_ply_with(
    parts: &[Part<'_>],
    format: PlyFormat,
    axes: Axes,
    writer: impl Write,
) -> Result<(), ExportError> {
    axes.check()?;
    check_parts(parts)?;
    let vertices = ExportError::counted("vertices", parts.iter().map(Part::vertices).sum())?;
    let triangles = ExportError::counted("triangles", parts.iter().map(Part::triangles).sum())?;
    let has_uvs = parts.iter().all(|part| !part.mesh().uvs.is_empty());
    let mut writer = io::BufWriter::with_capacity(1 << 16, writer);
    let name = match format {
        PlyFormat::Binary => "binary_little_endian",
        PlyFormat::Ascii => "ascii",
    };
    let note = axes.note();
    writeln!(writer, "ply\nformat {name} 1.0\ncomment treesynth, {note}\nelement vertex {vertices}")?;
    let uvs: &[&str] = if has_uvs { &["s", "t"] } else { &[] };
    for property in ["x", "y", "z", "nx", "ny", "nz"].iter().chain(uvs) {
        writeln!(writer, "property float {property}")?;
    }
    for property in ["red", "green", "blue"] {
        writeln!(writer, "property uchar {property}")?;
    }
    writeln!(writer, "element face {triangles}\nproperty list uchar uint vertex_indices\nend_header")?;

    for part in parts {
        let (mesh, material) = (part.mesh(), part.material());
        let (look, color) = (Vec3::from_array(material.color()), material.srgb());
        for copy in part.placed().iter() {
            let tint = Vec3::from_array(copy.tint);
            let tinted = tint != Vec3::ONE;
            let (matrix, rotation) = (copy.matrix(), copy.rotation_matrix());
            for (i, (&position, &normal)) in mesh.positions.iter().zip(&mesh.normals).enumerate() {
                let position = axes.placed(matrix * position + copy.position).to_array();
                let normal = axes.turned(rotation * normal).to_array();
                let mut floats = [0.0; 8];
                floats[..3].copy_from_slice(&position);
                floats[3..6].copy_from_slice(&normal);
                if has_uvs {
                    floats[6..].copy_from_slice(&[mesh.uvs[i].x, 1.0 - mesh.uvs[i].y]);
                }
                let own = mesh.colors.get(i).map(|&own| look * Vec3::from_array(own));
                let own = if tinted { Some(own.unwrap_or(look) * tint) } else { own };
                let color = own.map_or(color, |own| material.with_color(own.to_array()).srgb());
                vertex(&mut writer, format, &floats[..6 + uvs.len()], color)?;
            }
        }
    }
    let mut first = 0;
    for part in parts {
        for _ in part.copies() {
            for corners in part.mesh().triangles() {
                triangle(&mut writer, format, corners.map(|corner| first + corner))?;
            }
            first += part.mesh().positions.len() as u32;
        }
    }
    // Flushing by hand: dropping a BufWriter swallows the error.
    writer.flush()?;
    Ok(())
}

fn vertex(writer: &mut impl Write, format: PlyFormat, floats: &[f32], color: [u8; 3]) -> io::Result<()> {
    if format == PlyFormat::Binary {
        for float in floats {
            writer.write_all(&float.to_le_bytes())?;
        }
        return writer.write_all(&color);
    }
    for float in floats {
        write!(writer, "{float} ")?;
    }
    let [red, green, blue] = color;
    writeln!(writer, "{red} {green} {blue}")
}

fn triangle(writer: &mut impl Write, format: PlyFormat, corners: [u32; 3]) -> io::Result<()> {
    if format == PlyFormat::Binary {
        writer.write_all(&[3])?;
        return writer.write_all(corners.map(u32::to_le_bytes).as_flattened());
    }
    let [a, b, c] = corners;
    writeln!(writer, "3 {a} {b} {c}")
}
