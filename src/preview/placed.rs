//! A part with all its copies in their places.

use super::wear::{Cut, Wear};
use crate::surface::{Instance, Part};
use crate::texture::Textures;
use glam::{Vec2, Vec3, Vec4};
use std::borrow::Cow;
use std::sync::Arc;

pub(super) struct Placed<'a> {
    part: Part<'a>,
    /// Transforms of the copies; none if the mesh stands alone as it is.
    copies: Option<Cow<'a, [Instance]>>,
    /// Copy by copy, each with all vertices of the mesh.
    pub(super) positions: Cow<'a, [Vec3]>,
    /// The mean of the mesh's vertices.
    middle: Vec3,
    /// The images that it wears.
    wear: Option<Arc<Wear<'a>>>,
    /// The part of each of the mesh's triangles that is not cut out; empty if nothing is.
    shares: Vec<f32>,
}

impl<'a> Placed<'a> {
    /// All parts that have a triangle. Parts with the same images share them.
    pub(super) fn all(parts: &[Part<'a>]) -> Vec<Self> {
        let mut wears: Vec<(&Textures, Arc<Wear<'a>>)> = Vec::new();
        let placed = parts.iter().filter(|part| part.triangles() > 0).map(|part| {
            let wear = part.textures().map(|textures| {
                let known = wears.iter().find(|(other, _)| std::ptr::eq(*other, textures));
                if let Some((_, wear)) = known {
                    return wear.clone();
                }
                let wear = Arc::new(Wear::new(textures));
                wears.push((textures, wear.clone()));
                wear
            });
            Self::new(part, wear)
        });
        placed.collect()
    }

    fn new(part: &Part<'a>, wear: Option<Arc<Wear<'a>>>) -> Self {
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
        let shares = wear.as_ref().filter(|wear| wear.is_masked()).map_or_else(Vec::new, |wear| {
            let uvs = |corners: [u32; 3]| corners.map(|corner| mesh.uvs[corner as usize]);
            mesh.triangles().map(|corners| wear.share(uvs(corners))).collect()
        });
        Self { part: *part, copies, positions, middle, wear, shares }
    }

    /// The images that it wears.
    pub(super) fn wear(&self) -> Option<&Wear<'a>> {
        self.wear.as_deref()
    }

    /// The texture coordinates of a triangle's corners; there are some wherever there are images.
    pub(super) fn uvs(&self, corners: [u32; 3]) -> [Vec2; 3] {
        let mesh = self.part.mesh();
        corners.map(|corner| mesh.uvs[corner as usize % mesh.positions.len()])
    }

    /// The holes of a triangle, if there are any; `triangle` counts over all copies.
    #[inline]
    pub(super) fn cut(&self, triangle: usize, corners: [u32; 3]) -> Option<Cut<'_>> {
        if self.shares.is_empty() {
            return None;
        }
        self.cut_of(corners, self.shares[triangle % self.shares.len()])
    }

    /// The holes of a triangle that is seen.
    #[inline]
    pub(super) fn holes(&self, corners: [u32; 3]) -> Option<Cut<'_>> {
        if self.shares.is_empty() { None } else { self.cut_of(corners, 1.0) }
    }

    fn cut_of(&self, corners: [u32; 3], share: f32) -> Option<Cut<'_>> {
        let wear = self.wear.as_deref()?;
        Some(Cut { wear, uvs: self.uvs(corners), share })
    }

    /// The tangent of a triangle at a point with these weights of its corners, with the sign of glTF; from the mesh's
    /// tangents, or, without, from its texture coordinates.
    pub(super) fn tangent(&self, corners: [u32; 3], weights: [f32; 3], normal: Vec3) -> Option<Vec4> {
        let mesh = self.part.mesh();
        let vertices = mesh.positions.len();
        let across = |tangent: Vec3, sign: f32| {
            let across = (tangent - normal * tangent.dot(normal)).try_normalize()?;
            Some(across.extend(sign))
        };
        if mesh.tangents.is_empty() {
            let [a, b, c] = corners.map(|corner| self.positions[corner as usize]);
            let [p, q, r] = self.uvs(corners);
            let (first, second, along, beside) = (b - a, c - a, q - p, r - p);
            let turn = along.perp_dot(beside);
            if turn == 0.0 {
                return None;
            }
            let tangent = (first * beside.y - second * along.y) / turn;
            let down = (second * along.x - first * beside.x) / turn;
            let sign = if normal.cross(tangent).dot(down) < 0.0 { 1.0 } else { -1.0 };
            return across(tangent, sign);
        }
        let own = corners.map(|corner| mesh.tangents[corner as usize % vertices]);
        let sum =
            own[0].truncate() * weights[0] + own[1].truncate() * weights[1] + own[2].truncate() * weights[2];
        let turned = match &self.copies {
            None => sum,
            Some(copies) => copies[corners[0] as usize / vertices].rotation_matrix() * sum,
        };
        across(turned, own[0].w)
    }

    /// The colour of a triangle at a point with these weights of its corners.
    pub(super) fn color(&self, corners: [u32; 3], weights: [f32; 3]) -> Vec3 {
        let mesh = self.part.mesh();
        let mut color = Vec3::from_array(self.part.material().color());
        if let Some(instances) = &self.copies {
            color *= Vec3::from_array(instances[corners[0] as usize / mesh.positions.len()].tint);
        }
        if mesh.colors.is_empty() {
            return color;
        }
        let own = corners.map(|corner| Vec3::from_array(mesh.colors[corner as usize % mesh.positions.len()]));
        color * (own[0] * weights[0] + own[1] * weights[1] + own[2] * weights[2])
    }

    /// Roughness of the material itself.
    pub(super) fn roughness(&self) -> f32 {
        self.part.material().roughness()
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
