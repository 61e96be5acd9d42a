//! Triangles as plain arrays.

use super::{Instance, Wind};
use crate::shape::Bounds;
use glam::{Vec2, Vec3, Vec4};

/// A triangle mesh in metres: vertices with a normal each, and three indices per triangle, counter-clockwise
/// seen from outside.
///
/// The fields are public, so that any engine's buffers can be filled from them and any mesh can be put in.
/// Results of this crate satisfy [`check`](Self::check); input of a user is checked where it is used.
///
/// Memory: 24 bytes per vertex, 16 more with tangents, 8 with texture coordinates, 12 with colours, 68 with
/// wind; 12 bytes per triangle.
///
/// ```
/// use treesynth::{glam::Vec3, surface::Mesh};
///
/// let triangle = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2]);
/// assert_eq!(triangle.triangles().count(), 1);
/// triangle.check()?;
/// # Ok::<(), treesynth::surface::MeshError>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[non_exhaustive]
pub struct Mesh {
    /// Positions of the vertices, metres.
    pub positions: Vec<Vec3>,
    /// One unit normal per vertex, pointing outward.
    pub normals: Vec<Vec3>,
    /// One tangent per vertex, or none at all: the unit direction in which u grows, perpendicular to the
    /// normal, and 1 or
    /// -1. As in glTF, normal times tangent (the cross product) times that number is the direction in which v
    /// **falls**, for normal maps are drawn with up as up and v counts from the upper edge down.
    pub tangents: Vec<Vec4>,
    /// One texture coordinate per vertex, or none at all. They are not confined to [0, 1]: textures repeat.
    pub uvs: Vec<Vec2>,
    /// Factors on the material's colour at each vertex, or none: linear red, green and blue, each 0
    /// to 1. glTF has them as `COLOR_0`, PLY multiplied, and `preview` draws them; the other formats leave them out.
    pub colors: Vec<[f32; 3]>,
    /// Motion of each vertex in the wind, or none.
    pub wind: Vec<Wind>,
    /// Three vertices per triangle, counter-clockwise seen from outside.
    pub indices: Vec<u32>,
}

/// Error of checking a mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// An array is not as long as the positions.
    #[error("{array} has {length} entries, but there are {vertices} vertices")]
    Length {
        /// The array's name.
        array: &'static str,
        /// Its length.
        length: usize,
        /// The number of positions.
        vertices: usize,
    },
    /// The indices do not come in threes.
    #[error("there are {indices} indices, but a triangle has three")]
    Indices {
        /// The number of indices.
        indices: usize,
    },
    /// An index with no vertex.
    #[error("triangle {triangle} names the vertex {index}, but there are {vertices}")]
    Index {
        /// The triangle.
        triangle: usize,
        /// The vertex it names.
        index: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// A position that is NaN or infinite.
    #[error("vertex {vertex} has the position {position}, but positions must be finite")]
    Position {
        /// The vertex.
        vertex: usize,
        /// Its position.
        position: Vec3,
    },
    /// A normal that is not of length 1 within 0.001.
    #[error("vertex {vertex} has the normal {normal}, but normals must be of length 1")]
    Normal {
        /// The vertex.
        vertex: usize,
        /// Its normal.
        normal: Vec3,
    },
    /// A tangent that is not a unit vector perpendicular to the normal, within 0.001, and 1 or -1.
    #[error(
        "vertex {vertex} has the tangent {tangent}, but tangents must be of length 1, across the normal, and end in 1 or -1"
    )]
    Tangent {
        /// The vertex.
        vertex: usize,
        /// Its tangent.
        tangent: Vec4,
    },
    /// A vertex whose wind is NaN or infinite.
    #[error("vertex {vertex} has the wind {wind:?}, but this must be finite")]
    Wind {
        /// The vertex.
        vertex: usize,
        /// Its motion in the wind.
        wind: Wind,
    },
    /// A colour with a channel that is not in 0 to 1.
    #[error("vertex {vertex} has the colour {color:?}, but channels must be 0 to 1")]
    Color {
        /// The vertex.
        vertex: usize,
        /// Its colour.
        color: [f32; 3],
    },
    /// A texture coordinate that is NaN or infinite.
    #[error("vertex {vertex} has the texture coordinate {uv}, but these must be finite")]
    Uv {
        /// The vertex.
        vertex: usize,
        /// Its texture coordinate.
        uv: Vec2,
    },
    /// A mesh that is to wear textures, but has no texture coordinates.
    #[error("the mesh of {vertices} vertices has textures but no texture coordinates")]
    NoUvs {
        /// The number of positions.
        vertices: usize,
    },
    /// A copy of the mesh that has no place: NaN, an infinity, a scale that is not positive, a rotation that is
    /// not of length 1 within 0.001, or a tint that is not within 0 to 1.
    #[error("instance {index} cannot be placed: {instance:?}")]
    Instance {
        /// The number of the instance.
        index: usize,
        /// The instance.
        instance: Instance,
    },
    /// A triangle without area.
    #[error("triangle {triangle} has no area: its vertices are {corners:?}")]
    Degenerate {
        /// The triangle.
        triangle: usize,
        /// The positions of its vertices.
        corners: [Vec3; 3],
    },
}

impl Mesh {
    /// A mesh of no more than these. Nothing is checked here; see [`check`](Self::check).
    pub fn new(positions: Vec<Vec3>, normals: Vec<Vec3>, indices: Vec<u32>) -> Self {
        Self { positions, normals, indices, ..Self::default() }
    }

    /// Gives each vertex a texture coordinate.
    #[must_use]
    pub fn with_uvs(mut self, uvs: Vec<Vec2>) -> Self {
        self.uvs = uvs;
        self
    }

    /// Area of all triangles, square metres: of one side of a leaf. O(triangles).
    pub fn area(&self) -> f32 {
        let of = |corners: [u32; 3]| {
            let [a, b, c] = corners.map(|corner| self.positions[corner as usize]);
            0.5 * (b - a).cross(c - a).length()
        };
        self.triangles().map(of).sum()
    }

    /// `true` if there are no triangles.
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    /// The box around all vertices; `None` if there are none, or one is NaN. O(n).
    pub fn bounds(&self) -> Option<Bounds> {
        let sound = !self.positions.iter().any(|position| position.is_nan());
        Some(Bounds::of(self.positions.iter().copied())).filter(|bounds| sound && !bounds.is_empty())
    }

    /// The three vertices of each triangle. `.triangles().len()` is their number.
    pub fn triangles(&self) -> impl ExactSizeIterator<Item = [u32; 3]> + '_ {
        self.indices.chunks_exact(3).map(|triangle| [triangle[0], triangle[1], triangle[2]])
    }

    /// The triangles for which `keep` holds, which is asked of each in turn, with the vertices that they need and no others; and
    /// what each of these was.
    #[cfg_attr(not(feature = "texture"), allow(dead_code, reason = "only what wears images is taken apart"))]
    pub(crate) fn selected(&self, mut keep: impl FnMut([u32; 3]) -> bool) -> (Self, Vec<u32>) {
        let mut numbers = vec![u32::MAX; self.positions.len()];
        let (mut kept, mut indices) = (Vec::new(), Vec::new());
        for corners in self.triangles().filter(|&corners| keep(corners)) {
            for corner in corners {
                let number = &mut numbers[corner as usize];
                if *number == u32::MAX {
                    *number = kept.len() as u32;
                    kept.push(corner);
                }
                indices.push(*number);
            }
        }
        (Self { indices, ..self.gathered(&kept) }, kept)
    }

    /// These vertices, without triangles.
    pub(crate) fn gathered(&self, vertices: &[u32]) -> Self {
        fn of<T: Copy>(all: &[T], vertices: &[u32]) -> Vec<T> {
            if all.is_empty() { Vec::new() } else { vertices.iter().map(|&i| all[i as usize]).collect() }
        }
        Self {
            positions: of(&self.positions, vertices),
            normals: of(&self.normals, vertices),
            tangents: of(&self.tangents, vertices),
            uvs: of(&self.uvs, vertices),
            colors: of(&self.colors, vertices),
            wind: of(&self.wind, vertices),
            indices: Vec::new(),
        }
    }

    /// Checks that the arrays fit together: lengths, indices in range, finite positions, unit normals, and no
    /// triangle without area. An empty mesh is sound. O(n).
    ///
    /// # Errors
    /// The first violation found.
    pub fn check(&self) -> Result<(), MeshError> {
        self.check_arrays()?;
        for (triangle, corners) in self.triangles().enumerate() {
            let corners = corners.map(|index| self.positions[index as usize]);
            if !has_area(corners) {
                return Err(MeshError::Degenerate { triangle, corners });
            }
        }
        Ok(())
    }

    /// As [`check`](Self::check), but triangles need no area: they do no harm where meshes are written or drawn.
    pub(crate) fn check_arrays(&self) -> Result<(), MeshError> {
        self.check_vertices()?;
        let vertices = self.positions.len();
        for (triangle, corners) in self.triangles().enumerate() {
            for index in corners {
                if index as usize >= vertices {
                    return Err(MeshError::Index { triangle, index, vertices });
                }
            }
        }
        Ok(())
    }

    fn check_vertices(&self) -> Result<(), MeshError> {
        let vertices = self.positions.len();
        if self.normals.len() != vertices {
            return Err(MeshError::Length { array: "normals", length: self.normals.len(), vertices });
        }
        for (array, length) in [
            ("tangents", self.tangents.len()),
            ("uvs", self.uvs.len()),
            ("colors", self.colors.len()),
            ("wind", self.wind.len()),
        ] {
            if length != 0 && length != vertices {
                return Err(MeshError::Length { array, length, vertices });
            }
        }
        if !self.indices.len().is_multiple_of(3) {
            return Err(MeshError::Indices { indices: self.indices.len() });
        }
        let of = |vertex: Option<usize>| vertex.map(|vertex| (vertex, self.positions[vertex]));
        if let Some((vertex, position)) = of(self.positions.iter().position(|p| !p.is_finite())) {
            return Err(MeshError::Position { vertex, position });
        }
        let unit = |normal: &Vec3| (normal.length_squared() - 1.0).abs() <= 2e-3;
        if let Some(vertex) = self.normals.iter().position(|normal| !unit(normal)) {
            return Err(MeshError::Normal { vertex, normal: self.normals[vertex] });
        }
        let sound = |(tangent, normal): (&Vec4, &Vec3)| {
            let across = tangent.truncate();
            unit(&across) && across.dot(*normal).abs() <= 1e-3 && [1.0, -1.0].contains(&tangent.w)
        };
        if let Some(vertex) = self.tangents.iter().zip(&self.normals).position(|pair| !sound(pair)) {
            return Err(MeshError::Tangent { vertex, tangent: self.tangents[vertex] });
        }
        if let Some(vertex) = self.wind.iter().position(|wind| !wind.is_finite()) {
            return Err(MeshError::Wind { vertex, wind: self.wind[vertex] });
        }
        let sound = |color: &[f32; 3]| color.iter().all(|channel| (0.0..=1.0).contains(channel));
        if let Some(vertex) = self.colors.iter().position(|color| !sound(color)) {
            return Err(MeshError::Color { vertex, color: self.colors[vertex] });
        }
        if let Some(vertex) = self.uvs.iter().position(|uv| !uv.is_finite()) {
            return Err(MeshError::Uv { vertex, uv: self.uvs[vertex] });
        }
        Ok(())
    }
}

/// `true` if a triangle has an area that 32-bit floats can tell from zero.
#[inline]
pub(super) fn has_area([a, b, c]: [Vec3; 3]) -> bool {
    (b - a).cross(c - a).length_squared() > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> Mesh {
        Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2])
    }

    #[test]
    fn a_sound_mesh_is_sound() {
        assert_eq!(triangle().check(), Ok(()));
        assert_eq!(triangle().with_uvs(vec![Vec2::ZERO; 3]).check(), Ok(()));
        assert_eq!(Mesh::default().check(), Ok(()));
    }

    #[test]
    fn each_fault_is_named() {
        type Fault = (fn(&mut Mesh), fn(&MeshError) -> bool);
        let faults: [Fault; 10] = [
            (|m| m.normals.truncate(2), |e| matches!(e, MeshError::Length { array: "normals", .. })),
            (|m| m.uvs.push(Vec2::ZERO), |e| matches!(e, MeshError::Length { array: "uvs", .. })),
            (|m| m.indices.push(0), |e| matches!(e, MeshError::Indices { indices: 4 })),
            (|m| m.indices[2] = 3, |e| matches!(e, MeshError::Index { index: 3, .. })),
            (|m| m.colors.push([1.0; 3]), |e| matches!(e, MeshError::Length { array: "colors", .. })),
            (
                |m| m.colors = vec![[0.0; 3], [0.0, 1.1, 0.0], [0.0; 3]],
                |e| matches!(e, MeshError::Color { vertex: 1, .. }),
            ),
            (|m| m.positions[1].x = f32::NAN, |e| matches!(e, MeshError::Position { vertex: 1, .. })),
            (|m| m.normals[2] *= 2.0, |e| matches!(e, MeshError::Normal { vertex: 2, .. })),
            (|m| m.uvs = vec![Vec2::INFINITY; 3], |e| matches!(e, MeshError::Uv { vertex: 0, .. })),
            (|m| m.positions[1] = m.positions[2], |e| matches!(e, MeshError::Degenerate { .. })),
        ];
        for (break_it, is_named) in faults {
            let mut mesh = triangle();
            break_it(&mut mesh);
            let error = mesh.check().expect_err("the mesh is broken");
            assert!(is_named(&error), "{error}");
        }
    }

    #[test]
    fn bounds_are_tight() {
        let bounds = triangle().bounds().expect("there are vertices");
        assert_eq!((bounds.min, bounds.max), (Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)));
        assert_eq!(bounds.corners()[7], bounds.max);
        assert_eq!(bounds.center() * 2.0, bounds.size());
        assert_eq!(Mesh::default().bounds(), None);
        let mut broken = triangle();
        broken.positions[1].x = f32::NAN;
        assert_eq!(broken.bounds(), None);
    }
}
