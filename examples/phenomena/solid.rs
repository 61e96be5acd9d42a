//! Plain meshes for what is not a tree.

use treesynth::glam::Vec3;
use treesynth::math::sin_cos;
use treesynth::surface::Mesh;

/// The upper part of a ball of a grid of squares, `n` around: all of it, or with `rings` of `n / 4` the half.
pub(crate) fn ball(center: Vec3, radius: f32, n: u32, rings: u32) -> Mesh {
    let (mut positions, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for ring in 0..=rings {
        let (across, up) = sin_cos(std::f32::consts::TAU * ring as f32 / n as f32);
        for step in 0..=n {
            let (sin, cos) = sin_cos(std::f32::consts::TAU * (step % n) as f32 / n as f32);
            let normal = Vec3::new(across * sin, up, across * cos);
            positions.push(center + normal * radius);
            normals.push(normal);
            if ring > 0 && step > 0 {
                let here = ring * (n + 1) + step;
                let above = here - n - 1;
                indices.extend([above - 1, here - 1, here, above - 1, here, above]);
            }
        }
    }
    Mesh::new(positions, normals, indices)
}

/// A flat square with corners counter-clockwise, a colour at each.
pub(crate) fn quad(mesh: &mut Mesh, corners: [Vec3; 4], colors: [[f32; 3]; 4]) {
    let first = mesh.positions.len() as u32;
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or(Vec3::Y);
    mesh.positions.extend(corners);
    mesh.normals.extend([normal; 4]);
    mesh.colors.extend(colors);
    mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
}
