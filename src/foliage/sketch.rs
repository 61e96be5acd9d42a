//! Blades of few triangles.

use crate::math;
use crate::surface::Mesh;
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// A blade: pairs of points on either side of a midrib.
#[derive(Debug, Clone, Copy)]
pub(super) struct Blade<'a> {
    /// Start of the midrib.
    pub(super) base: Vec3,
    /// The midrib, as long as the blade.
    pub(super) along: Vec3,
    /// The upper side; of length 1, perpendicular to the midrib.
    pub(super) up: Vec3,
    /// Distances along the midrib, and half the width there, in lengths of the blade. The first and the last
    /// have no width.
    pub(super) profile: &'a [(f32, f32)],
    /// Sine of the angle by which either half is lifted off the plane.
    pub(super) fold: f32,
    /// Droop of the tip, in lengths of the blade.
    pub(super) curl: f32,
}

impl<'a> Blade<'a> {
    /// A blade 1 long on +Y, a little folded and hanging.
    pub(super) fn along(profile: &'a [(f32, f32)]) -> Self {
        Self { base: Vec3::ZERO, along: Vec3::Y, up: Vec3::Z, profile, fold: 0.3, curl: 0.08 }
    }

    pub(super) fn curled(self, curl: f32) -> Self {
        Self { curl, ..self }
    }
}

/// Outline of leaflets: the base, the broadest place, the tip.
const LEAFLET: [(f32, f32); 3] = [(0.0, 0.0), (0.42, 0.17), (1.0, 0.0)];

/// A mesh in the making.
#[derive(Debug, Default)]
pub(super) struct Sketch {
    positions: Vec<Vec3>,
    indices: Vec<u32>,
}

impl Sketch {
    fn vertex(&mut self, position: Vec3) -> u32 {
        self.positions.push(position);
        self.positions.len() as u32 - 1
    }

    /// Between its ends a blade has three vertices per station: right, midrib, left, seen from above.
    pub(super) fn blade(&mut self, blade: &Blade<'_>) {
        let length = blade.along.length();
        let across = blade.along.cross(blade.up);
        let flat = (1.0 - blade.fold * blade.fold).sqrt();
        let mut before: Option<[u32; 3]> = None;
        for &(t, width) in blade.profile {
            let rib = blade.base + blade.along * t - blade.up * (blade.curl * length * t * t);
            let lifted = blade.up * (width * blade.fold * length);
            let here = if width > 0.0 {
                let right = self.vertex(rib + across * (width * flat) + lifted);
                // A flat blade needs no midrib.
                let middle = if blade.fold > 0.0 { self.vertex(rib) } else { right };
                [right, middle, self.vertex(rib - across * (width * flat) + lifted)]
            } else {
                [self.vertex(rib); 3]
            };
            if let Some(before) = before {
                for side in 0..2 {
                    let [right, left] = [side, side + 1];
                    self.triangle(before[left], before[right], here[right]);
                    self.triangle(before[left], here[right], here[left]);
                }
            }
            before = Some(here);
        }
    }

    /// A blade seen from +Z whose right half has this outline, from the tip to the base, as (x, y); all of it
    /// can be seen from `middle`.
    pub(super) fn star(&mut self, middle: Vec3, right: &[(f32, f32)]) {
        let center = self.vertex(middle);
        // Points far out hang, as the tips of lobes do.
        let at =
            |x: f32, y: f32| Vec3::new(x, y, -0.1 * (Vec2::new(x, y) - middle.truncate()).length_squared());
        let left = right.iter().rev().filter(|(x, _)| *x > 0.0).map(|(x, y)| (-x, *y));
        let outline: Vec<u32> =
            right.iter().copied().chain(left).map(|(x, y)| self.vertex(at(x, y))).collect();
        for (i, &corner) in outline.iter().enumerate() {
            self.triangle(center, outline[(i + 1) % outline.len()], corner);
        }
    }

    /// A straight stalk, `half_width` to either side.
    fn stalk(&mut self, base: Vec3, top: Vec3, up: Vec3, half_width: f32) {
        let across = (top - base).normalize_or_zero().cross(up) * half_width;
        let [a, b, c, d] = [base - across, base + across, top + across, top - across].map(|p| self.vertex(p));
        self.triangle(a, b, c);
        self.triangle(a, c, d);
    }

    fn triangle(&mut self, a: u32, b: u32, c: u32) {
        if a != b && b != c && c != a {
            self.indices.extend([a, b, c]);
        }
    }

    /// The mesh, with normals that are smooth where triangles share vertices, and texture coordinates that lay the
    /// picture of a leaf flat over it, its tip up: u goes right, v down, as glTF has it.
    pub(super) fn finish(self) -> Mesh {
        let mut normals = vec![Vec3::ZERO; self.positions.len()];
        for corners in self.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i| self.positions[corners[i] as usize]);
            let normal = (b - a).cross(c - a);
            for &corner in corners {
                normals[corner as usize] += normal;
            }
        }
        let normals = normals.into_iter().map(|normal| normal.normalize_or(Vec3::Z)).collect();
        let low = self.positions.iter().copied().reduce(Vec3::min).unwrap_or_default();
        let high = self.positions.iter().copied().reduce(Vec3::max).unwrap_or_default();
        let uvs =
            self.positions.iter().map(|p| ((*p - low) / (high - low).max(Vec3::splat(1e-9))).truncate());
        let uvs = uvs.map(|uv| Vec2::new(uv.x, 1.0 - uv.y)).collect();
        Mesh::new(self.positions, normals, self.indices).with_uvs(uvs)
    }
}

pub(super) fn pinnate(pairs: u32) -> Mesh {
    let mut sketch = Sketch::default();
    let end = Vec3::Y * 0.74;
    sketch.stalk(Vec3::ZERO, end, Vec3::Z, 0.012);
    let leaflet = |base: Vec3, along: Vec3| Blade { base, along, ..Blade::along(&LEAFLET) };
    for pair in 0..pairs {
        let t = 0.2 + 0.5 * pair as f32 / (pairs - 1).max(1) as f32;
        // Those in the middle are the longest.
        let length = 0.26 + 0.08 * (1.0 - (t - 0.45).abs() * 4.0);
        for side in [-1.0, 1.0] {
            let along = Vec3::new(side * 0.86, 0.5, 0.0).normalize() * length;
            sketch.blade(&leaflet(Vec3::Y * t, along));
        }
    }
    sketch.blade(&leaflet(end, Vec3::Y * 0.26));
    sketch.finish()
}

pub(super) fn palmate(leaflets: u32) -> Mesh {
    let mut sketch = Sketch::default();
    for leaflet in 0..leaflets {
        let turn = (leaflet as f32 / (leaflets - 1).max(1) as f32 - 0.5) * 4.2;
        let (sin, cos) = math::sin_cos(turn);
        let along = Vec3::new(sin, cos, 0.0) * (1.0 - 0.15 * turn.abs());
        sketch.blade(&Blade { along, ..Blade::along(&LEAFLET).curled(0.16) });
    }
    sketch.finish()
}

pub(super) fn shoot(needles: u32) -> Mesh {
    let mut sketch = Sketch::default();
    sketch.stalk(Vec3::ZERO, Vec3::Y * 0.9, Vec3::Z, 0.012);
    for needle in 0..needles {
        let t = needle as f32 / (needles - 1).max(1) as f32;
        let turn = math::Rotation::new(needle as f32 * super::Arrangement::SPIRAL.divergence() % TAU);
        let outward = turn.about(Vec3::Y, Vec3::X);
        // At right angles to the shoot at its base, and along it at its end.
        let (sin, cos) = math::sin_cos(1.2 * (1.0 - t));
        let direction = outward * sin + Vec3::Y * cos;
        let base = Vec3::Y * (0.72 * t);
        let up = Vec3::Y * sin - outward * cos;
        let profile = [(0.0, 0.0), (0.4, 0.05), (1.0, 0.0)];
        sketch.blade(&Blade { base, along: direction * 0.28, up, fold: 0.0, curl: 0.0, profile: &profile });
    }
    sketch.finish()
}

/// Moves `mesh` along +Y and puts a stalk under it.
pub(super) fn add_petiole(mesh: &mut Mesh, length: f32, half_width: f32) {
    mesh.positions.iter_mut().for_each(|position| position.y += length);
    let mut sketch = Sketch::default();
    sketch.stalk(Vec3::ZERO, Vec3::Y * length, Vec3::Z, half_width);
    let stalk = sketch.finish();
    let first = mesh.positions.len() as u32;
    if mesh.uvs.len() == mesh.positions.len() {
        // The midrib's place in a picture of a leaf.
        mesh.uvs.extend([Vec2::new(0.5, 1.0); 4]);
    }
    mesh.positions.extend(stalk.positions);
    mesh.normals.extend(stalk.normals);
    mesh.indices.extend(stalk.indices.iter().map(|index| first + index));
}
