//! STL, the binary kind (`.stl`): triangles and nothing else, for printing and solvers.
//!
//! A header of 80 bytes, the number of triangles, and 50 bytes per triangle: its normal, its corners, two
//! bytes unused.

use super::{Axes, ExportError, check_parts};
use crate::surface::Part;
use glam::Vec3;
use std::io::{self, Write};

/// Writes the triangles of all parts, instances multiplied out one by one. Normals are those of the
/// triangles. STL knows no unit and no axis; the numbers are metres and +Y is up, unless other axes are
/// passed to [`write_stl_with`].
///
/// O(triangles) time, O(vertices of the largest mesh) memory.
///
/// ```
/// use treesynth::{export, glam::Vec3, surface::{Mesh, Part}};
///
/// let triangle = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2]);
/// let mut stl = Vec::new();
/// export::write_stl(&[Part::new(&triangle)], &mut stl)?;
/// assert_eq!(stl.len(), 84 + 50);
/// # Ok::<(), export::ExportError>(())
/// ```
///
/// # Errors
/// Parts without a single triangle, or that are not sound; more triangles than 32 bits count; whatever the writer
/// returns. Once a byte is written, nothing but the writer can fail.
pub fn write_stl(parts: &[Part<'_>], writer: impl Write) -> Result<(), ExportError> {
    write_stl_with(parts, Axes::default(), writer)
}

/// As [`write_stl`], with another axis up or in another unit. The header says which.
///
/// # Errors
/// As of [`write_stl`]; axes out of range.
pub fn write_stl_with(parts: &[Part<'_>], axes: Axes, writer: impl Write) -> Result<(), ExportError> {
    axes.check()?;
    check_parts(parts)?;
    let triangles = ExportError::counted("triangles", parts.iter().map(Part::triangles).sum())?;
    let mut writer = io::BufWriter::with_capacity(1 << 16, writer);
    // Must not start with `solid`, or programs take the file for the textual kind.
    let mut header = format!("treesynth, binary STL, {}", axes.note()).into_bytes();
    header.resize(80, b' ');
    writer.write_all(&header)?;
    writer.write_all(&triangles.to_le_bytes())?;
    let mut placed: Vec<Vec3> = Vec::new();
    for part in parts {
        for copy in part.placed().iter() {
            let matrix = copy.matrix();
            placed.clear();
            let place = |&point: &Vec3| axes.placed(matrix * point + copy.position);
            placed.extend(part.mesh().positions.iter().map(place));
            for corners in part.mesh().triangles() {
                let [a, b, c] = corners.map(|corner| placed[corner as usize]);
                let normal = (b - a).cross(c - a).normalize_or_zero();
                let words = [normal, a, b, c].map(|v| v.to_array().map(f32::to_le_bytes));
                writer.write_all(words.as_flattened().as_flattened())?;
                writer.write_all(&[0; 2])?;
            }
        }
    }
    // Flushing by hand: dropping a BufWriter swallows the error.
    writer.flush()?;
    Ok(())
}
