//! Tangents of meshes that have texture coordinates, so that readers need not make them up.

use crate::math;
use crate::surface::Mesh;
use crate::texture::Textures;
use glam::Vec3;

/// The mesh with one tangent per vertex, if images with normals are laid on it and it has none.
pub(super) fn with_tangents(mut mesh: Mesh, textures: Option<&Textures>) -> Mesh {
    let needs = textures.is_some_and(|textures| textures.normal().is_some());
    if !needs || !mesh.tangents.is_empty() || mesh.uvs.is_empty() {
        return mesh;
    }
    // The directions in which u and v grow, summed over the triangles at each vertex.
    let mut ways = vec![[Vec3::ZERO; 2]; mesh.positions.len()];
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
        let [p, q, r] = corners.map(|corner| mesh.uvs[corner as usize]);
        let (first, second, along, beside) = (b - a, c - a, q - p, r - p);
        let turn = along.perp_dot(beside);
        if turn != 0.0 {
            let u = (first * beside.y - second * along.y) / turn;
            let v = (second * along.x - first * beside.x) / turn;
            for corner in corners {
                let [along_u, along_v] = &mut ways[corner as usize];
                *along_u += u;
                *along_v += v;
            }
        }
    }
    let tangent = |(&normal, [u, v]): (&Vec3, &[Vec3; 2])| {
        let across = (*u - normal * u.dot(normal)).try_normalize();
        let tangent = across.unwrap_or_else(|| math::perpendicular(normal));
        // v falls along the bitangent.
        tangent.extend(if normal.cross(tangent).dot(*v) > 0.0 { -1.0 } else { 1.0 })
    };
    mesh.tangents = mesh.normals.iter().zip(&ways).map(tangent).collect();
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::Image;
    use glam::Vec2;

    #[test]
    fn tangents_follow_the_texture_coordinates() {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let quad = Mesh::new(corners, vec![Vec3::Z; 4], vec![0, 1, 2, 0, 2, 3]);
        let flat = Image::new(1, 1, 3, vec![128, 128, 255]).expect("one pixel");
        let textures = Textures::default().with_normal(flat);
        // The image upright, mirrored, and turned by a quarter.
        for (uvs, u, sign) in [
            ([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]], Vec3::X, 1.0),
            ([[1.0, 1.0], [0.0, 1.0], [0.0, 0.0], [1.0, 0.0]], -Vec3::X, -1.0),
            ([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]], Vec3::Y, 1.0),
        ] {
            let worn = quad.clone().with_uvs(uvs.map(Vec2::from_array).to_vec());
            let mesh = with_tangents(worn.clone(), Some(&textures));
            mesh.check().expect("sound");
            assert!(mesh.tangents.iter().all(|tangent| *tangent == u.extend(sign)), "{:?}", mesh.tangents);
            assert!(with_tangents(worn, None).tangents.is_empty());
        }
    }
}
