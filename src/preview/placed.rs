//! A part with all its copies in their places.

use crate::surface::{Instance, Part};
use glam::Vec3;
use std::borrow::Cow;

pub(super) struct Placed<'a> {
    part: Part<'a>,
    /// Where the copies stand; none if the mesh stands alone as it is.
    copies: Option<Cow<'a, [Instance]>>,
    /// Copy by copy, each with all vertices of the mesh.
    pub(super) positions: Cow<'a, [Vec3]>,
    /// The mean of the mesh's vertices.
    middle: Vec3,
}

impl<'a> Placed<'a> {
    /// Of a part with at least one vertex.
    pub(super) fn new(part: &Part<'a>) -> Self {
        let alone = part.instances().is_none() && part.transform().is_identity();
        let copies = (!alone).then(|| part.placed());
        let positions = if let Some(copies) = &copies {
            let mut positions = Vec::with_capacity(part.vertices() as usize);
            for copy in copies.iter() {
                let matrix = copy.matrix();
                positions.extend(part.mesh().positions.iter().map(|&point| matrix * point + copy.position));
            }
            Cow::Owned(positions)
        } else {
            Cow::Borrowed(&part.mesh().positions[..])
        };
        let mesh = part.mesh();
        let middle = mesh.positions.iter().sum::<Vec3>() / mesh.positions.len() as f32;
        Self { part: *part, copies, positions, middle }
    }

    /// The colour of a triangle at a point with these weights of its corners.
    pub(super) fn color(&self, corners: [u32; 3], weights: [f32; 3]) -> Vec3 {
        let color = Vec3::from_array(self.part.material().color());
        let mesh = self.part.mesh();
        if mesh.colors.is_empty() {
            return color;
        }
        let own = corners.map(|corner| Vec3::from_array(mesh.colors[corner as usize % mesh.positions.len()]));
        color * (own[0] * weights[0] + own[1] * weights[1] + own[2] * weights[2])
    }

    pub(super) fn two_sided(&self) -> bool {
        self.part.material().is_double_sided()
    }

    /// The corners of each triangle of each copy, as indices of positions.
    pub(super) fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        let mesh = self.part.mesh();
        let copies = 0..self.part.copies().len() as u32;
        copies.flat_map(move |copy| {
            let first = copy * mesh.positions.len() as u32;
            mesh.triangles().map(move |corners| corners.map(|corner| first + corner))
        })
    }

    pub(super) fn copies(&self) -> usize {
        self.part.copies().len()
    }

    /// The copy a vertex belongs to, if there are several, and the middle of that copy.
    pub(super) fn copy_of(&self, vertex: u32) -> Option<(usize, Vec3)> {
        let instances = self.copies.as_ref()?;
        let copy = vertex as usize / self.part.mesh().positions.len();
        let instance = &instances[copy];
        Some((copy, instance.matrix() * self.middle + instance.position))
    }

    /// The normals at the corners of a triangle.
    pub(super) fn normals(&self, corners: [u32; 3]) -> [Vec3; 3] {
        let mesh = self.part.mesh();
        let vertices = mesh.positions.len();
        let Some(copies) = &self.copies else {
            return corners.map(|corner| mesh.normals[corner as usize]);
        };
        let rotation = copies[corners[0] as usize / vertices].rotation_matrix();
        corners.map(|corner| rotation * mesh.normals[corner as usize % vertices])
    }
}
