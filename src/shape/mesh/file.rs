//! Models in files: OBJ, STL and PLY.

use std::io::{BufRead, Read, Seek};

use glam::Vec3;
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};

use super::{TriangleMesh, TriangleMeshError};

fn unreadable(error: impl std::fmt::Display) -> TriangleMeshError {
    TriangleMeshError::File(error.to_string())
}

/// Polygons as fans of triangles.
fn fan(corners: &[u32]) -> impl Iterator<Item = [u32; 3]> + '_ {
    (2..corners.len()).map(|last| [corners[0], corners[last - 1], corners[last]])
}

impl TriangleMesh {
    /// All objects of a Wavefront OBJ file as one solid; polygons as fans, materials ignored.
    ///
    /// # Errors
    /// What `tobj` cannot read, and as [`new`](Self::new).
    pub fn read_obj(mut reader: impl BufRead) -> Result<Self, TriangleMeshError> {
        let options = tobj::LoadOptions {
            triangulate: true,
            ignore_points: true,
            ignore_lines: true,
            ..tobj::LoadOptions::default()
        };
        let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
        let (models, _) = tobj::load_obj_buf(&mut reader, &options, no_materials).map_err(unreadable)?;
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for model in models {
            let first = positions.len() as u32;
            positions.extend(model.mesh.positions.chunks_exact(3).map(Vec3::from_slice));
            triangles.extend(
                model.mesh.indices.chunks_exact(3).map(|t| [first + t[0], first + t[1], first + t[2]]),
            );
        }
        Self::new(&positions, &triangles)
    }

    /// An STL file, binary or text.
    ///
    /// # Errors
    /// What `stl_io` cannot read, and as [`new`](Self::new).
    pub fn read_stl(mut reader: impl Read + Seek) -> Result<Self, TriangleMeshError> {
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for triangle in stl_io::create_stl_reader(&mut reader).map_err(unreadable)? {
            let first = positions.len() as u32;
            positions.extend(triangle.map_err(unreadable)?.vertices.map(|vertex| Vec3::from_array(vertex.0)));
            triangles.push([first, first + 1, first + 2]);
        }
        Self::new(&positions, &triangles)
    }

    /// A PLY file, binary or text, with `x`, `y` and `z` of each `vertex` and the `vertex_indices` or `vertex_index` of
    /// each `face`; polygons as fans.
    ///
    /// # Errors
    /// What `ply-rs-bw` cannot read, a file without these, and as [`new`](Self::new).
    pub fn read_ply(mut reader: impl BufRead) -> Result<Self, TriangleMeshError> {
        let ply = Parser::<DefaultElement>::new().read_ply(&mut reader).map_err(unreadable)?;
        let part =
            |name: &str| ply.payload.get(name).ok_or_else(|| unreadable(format_args!("it has no {name}")));
        let coordinate = |vertex: &DefaultElement, name: &str| {
            vertex
                .get(name)
                .and_then(Property::to_f32_lossy)
                .ok_or_else(|| unreadable(format_args!("a vertex has no {name}")))
        };
        let mut positions = Vec::new();
        for vertex in part("vertex")? {
            let [x, y, z] = ["x", "y", "z"].map(|name| coordinate(vertex, name));
            positions.push(Vec3::new(x?, y?, z?));
        }
        let mut triangles = Vec::new();
        for face in part("face")? {
            let list = face.get("vertex_indices").or_else(|| face.get("vertex_index"));
            let corners = list.and_then(Property::to_u32_list);
            triangles.extend(fan(&corners.ok_or_else(|| unreadable("a face has no vertex_indices"))?));
        }
        Self::new(&positions, &triangles)
    }
}
