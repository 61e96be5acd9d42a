//! Triangles.

use bevy_asset::RenderAssetUsages;
use bevy_mesh::{Indices, Mesh, MeshVertexAttribute, PrimitiveTopology, VertexFormat};
use treesynth::surface::{Instance, Mesh as Triangles, Wind};

/// Moment of the trunk, and in the fourth number how far a leaf's vertex flutters, metres.
pub const WIND_TRUNK: MeshVertexAttribute = attribute("Wind_Trunk", 0);
/// Moment of the limb; the fourth number is 0.
pub const WIND_LIMB: MeshVertexAttribute = attribute("Wind_Limb", 1);
/// Moment of the twig; the fourth number is 0.
pub const WIND_TWIG: MeshVertexAttribute = attribute("Wind_Twig", 2);
/// Direction of the limb; the fourth number is 0.
pub const WIND_LIMB_AXIS: MeshVertexAttribute = attribute("Wind_Limb_Axis", 3);
/// Direction of the twig; the fourth number is 0.
pub const WIND_TWIG_AXIS: MeshVertexAttribute = attribute("Wind_Twig_Axis", 4);

/// An attribute that Bevy has not. Numbers far from those that others choose.
const fn attribute(name: &'static str, number: u64) -> MeshVertexAttribute {
    MeshVertexAttribute::new(name, 0x7265_6573_796e_7400 + number, VertexFormat::Float32x4)
}

/// A mesh with all that its vertices have: positions, normals, tangents, texture coordinates, colours, wind. `docs/wind.md`
/// of treesynth has the shader that moves them.
pub fn mesh(triangles: &Triangles) -> Mesh {
    let mut mesh = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default());
    mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, three(&triangles.positions));
    mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, three(&triangles.normals));
    if !triangles.uvs.is_empty() {
        let uvs: Vec<[f32; 2]> = triangles.uvs.iter().map(|uv| uv.to_array()).collect();
        mesh.insert_attribute(Mesh::ATTRIBUTE_UV_0, uvs);
    }
    if !triangles.tangents.is_empty() {
        let tangents: Vec<[f32; 4]> = triangles.tangents.iter().map(|tangent| tangent.to_array()).collect();
        mesh.insert_attribute(Mesh::ATTRIBUTE_TANGENT, tangents);
    }
    if !triangles.colors.is_empty() {
        let colors: Vec<[f32; 4]> = triangles.colors.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect();
        mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
    }
    if !triangles.wind.is_empty() {
        let of = |value: fn(&Wind) -> [f32; 4]| triangles.wind.iter().map(value).collect::<Vec<_>>();
        mesh.insert_attribute(WIND_TRUNK, of(|wind| wind.moments[0].extend(wind.flutter).to_array()));
        mesh.insert_attribute(WIND_LIMB, of(|wind| wind.moments[1].extend(0.0).to_array()));
        mesh.insert_attribute(WIND_TWIG, of(|wind| wind.moments[2].extend(0.0).to_array()));
        mesh.insert_attribute(WIND_LIMB_AXIS, of(|wind| wind.axes[0].extend(0.0).to_array()));
        mesh.insert_attribute(WIND_TWIG_AXIS, of(|wind| wind.axes[1].extend(0.0).to_array()));
    }
    mesh.insert_indices(indices(triangles));
    mesh
}

/// All copies of a mesh in one, tints in its colours: one entity instead of thousands. Wind is left out.
pub fn merged(triangles: &Triangles, copies: &[Instance]) -> Mesh {
    let mut all = Triangles::default();
    for copy in copies {
        let first = all.positions.len() as u32;
        let (matrix, turn) = (copy.matrix(), copy.rotation_matrix());
        all.positions.extend(triangles.positions.iter().map(|&position| matrix * position + copy.position));
        all.normals.extend(triangles.normals.iter().map(|&normal| turn * normal));
        all.tangents.extend(triangles.tangents.iter().map(|t| (turn * t.truncate()).extend(t.w)));
        all.uvs.extend_from_slice(&triangles.uvs);
        let color = |i: usize| triangles.colors.get(i).copied().unwrap_or([1.0; 3]);
        let tinted = |i: usize| std::array::from_fn(|channel| color(i)[channel] * copy.tint[channel]);
        all.colors.extend((0..triangles.positions.len()).map(tinted));
        all.indices.extend(triangles.indices.iter().map(|index| first + index));
    }
    mesh(&all)
}

fn three(vectors: &[treesynth::glam::Vec3]) -> Vec<[f32; 3]> {
    vectors.iter().map(|vector| vector.to_array()).collect()
}

/// Two bytes each where they do.
fn indices(triangles: &Triangles) -> Indices {
    if triangles.positions.len() <= usize::from(u16::MAX) {
        Indices::U16(triangles.indices.iter().map(|&index| index as u16).collect())
    } else {
        Indices::U32(triangles.indices.clone())
    }
}
