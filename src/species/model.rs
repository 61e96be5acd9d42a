//! Models of organs: flowers, catkins, fruit and cones of few triangles, 1 long and 1 wide at most.

use super::organ::{Organ, OrganKind};
use crate::foliage::Leaf;
use crate::math;
use crate::surface::{Material, Mesh};
use glam::Vec3;
use std::f32::consts::TAU;

const GOLDEN: f32 = 2.399_963_2;
/// Colours by which an organ's own is multiplied.
const OWN: [f32; 3] = [1.0; 3];
const GREEN: [f32; 3] = [0.32, 0.42, 0.16];
const YELLOW: [f32; 3] = [0.95, 0.72, 0.3];
const DARK: [f32; 3] = [0.55, 0.5, 0.45];

/// The organ as a leaf: its base at the origin, its length along +Y.
pub(super) fn organ(data: &Organ) -> Leaf {
    let mut model = Model::default();
    match data.kind {
        OrganKind::Flower => model.flower(),
        OrganKind::Candle => model.candle(),
        OrganKind::Cluster => model.cluster(),
        OrganKind::Catkin => model.lathe(&[(0.12, 0.4), (0.4, 0.5), (0.85, 0.42)], 5, DARK, OWN),
        OrganKind::Ball => model.lathe(&[(0.12, 0.36), (0.5, 0.5), (0.88, 0.36)], 6, OWN, OWN),
        OrganKind::Cone => model.cone(),
        OrganKind::Wings => {
            model.wing(1.0);
            model.wing(-1.0);
        }
        OrganKind::Key => model.wing(0.0),
        OrganKind::Bract => model.bract(),
    }
    for (position, normal) in model.mesh.positions.iter_mut().zip(&mut model.mesh.normals) {
        *position *= Vec3::new(data.width, 1.0, data.width);
        *normal = (*normal / Vec3::new(data.width, 1.0, data.width)).normalize_or(Vec3::Z);
    }
    if data.stalk > 0.0 {
        model.stalk(data.stalk);
    }
    let solid = matches!(data.kind, OrganKind::Ball | OrganKind::Cone | OrganKind::Catkin);
    let material = if solid { Material::bark() } else { Material::leaf() };
    // The stalk is a blade in any case.
    Leaf::new(model.mesh).with_material(material.with_double_sided(true))
}

/// A mesh with colours in the making.
#[derive(Default)]
struct Model {
    mesh: Mesh,
}

impl Model {
    fn vertex(&mut self, position: Vec3, normal: Vec3, color: [f32; 3]) -> u32 {
        self.mesh.positions.push(position);
        self.mesh.normals.push(normal.normalize_or(Vec3::Y));
        self.mesh.colors.push(color);
        self.mesh.positions.len() as u32 - 1
    }

    /// Two triangles from `foot` to `tip`, broadest at `broad` of the way, their upper side to `up`.
    fn blade(
        &mut self,
        [foot, tip]: [Vec3; 2],
        half_width: f32,
        broad: f32,
        up: Vec3,
        colors: [[f32; 3]; 2],
    ) {
        let way = tip - foot;
        let across = way.cross(up).normalize_or(Vec3::X);
        let normal = across.cross(way);
        let middle = foot + way * broad;
        let first = self.vertex(foot, normal, colors[0]);
        self.vertex(middle + across * half_width, normal, colors[1]);
        self.vertex(tip, normal, colors[1]);
        self.vertex(middle - across * half_width, normal, colors[1]);
        self.mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
    }

    /// A body of rotation about +Y from 0 to 1 through rings (place, radius).
    fn lathe(&mut self, rings: &[(f32, f32)], sides: u32, foot: [f32; 3], color: [f32; 3]) {
        let start = self.vertex(Vec3::ZERO, -Vec3::Y, foot);
        let mut before = None;
        for (index, &(y, radius)) in rings.iter().enumerate() {
            // Normals as of the ellipsoid through the broadest ring.
            let first = self.mesh.positions.len() as u32;
            for side in 0..sides {
                let around = (side as f32 + 0.5 * (index % 2) as f32) / sides as f32 * TAU;
                let (sin, cos) = math::sin_cos(around);
                let normal = Vec3::new(cos * radius, y - 0.5, sin * radius);
                self.vertex(Vec3::new(cos * radius, y, sin * radius), normal, color);
            }
            let odd = index % 2 == 1;
            for side in 0..sides {
                let next = (side + 1) % sides;
                let [c, d] = [first + side, first + next];
                if let Some(low) = before {
                    let [a, b]: [u32; 2] = [low + side, low + next];
                    // Rings are turned by half a side against each other.
                    let corners = if odd { [a, c, b, b, c, d] } else { [a, c, d, a, d, b] };
                    self.mesh.indices.extend(corners);
                } else {
                    self.mesh.indices.extend([start, c, d]);
                }
            }
            before = Some(first);
        }
        let end = self.vertex(Vec3::Y, Vec3::Y, foot);
        if let Some(last) = before {
            for side in 0..sides {
                self.mesh.indices.extend([last + side, end, last + (side + 1) % sides]);
            }
        }
    }

    fn flower(&mut self) {
        for petal in 0..5 {
            let (sin, cos) = math::sin_cos(petal as f32 / 5.0 * TAU);
            let tip = Vec3::new(0.5 * cos, 0.2, 0.5 * sin);
            self.blade([Vec3::ZERO, tip], 0.21, 0.62, Vec3::Y, [YELLOW, OWN]);
        }
    }

    fn candle(&mut self) {
        self.blade([Vec3::ZERO, Vec3::Y * 0.95], 0.02, 0.4, Vec3::Z, [GREEN; 2]);
        for flower in 0..36 {
            let t = 0.08 + 0.88 * flower as f32 / 35.0;
            let (sin, cos) = math::sin_cos(flower as f32 * GOLDEN);
            let reach = 0.5 * (1.0 - 0.85 * t) * (0.7 + 0.3 * (t * 8.0).min(1.0));
            let foot = Vec3::new(0.2 * reach * cos, t, 0.2 * reach * sin);
            let tip = Vec3::new(reach * cos, t + 0.05, reach * sin);
            let color = if flower % 3 == 0 { [1.0, 0.86, 0.7] } else { OWN };
            self.blade([foot, tip], 0.2, 0.55, Vec3::Y, [color, OWN]);
        }
    }

    fn cluster(&mut self) {
        for flower in 0..14 {
            let t = (flower as f32 + 0.5) / 14.0;
            let height = 1.0 - 1.5 * t;
            let out = (1.0 - height * height).max(0.0).sqrt();
            let (sin, cos) = math::sin_cos(flower as f32 * GOLDEN);
            let way = Vec3::new(out * cos, height, out * sin) * 0.5;
            let up = Vec3::new(-height * cos, out, -height * sin);
            self.blade([Vec3::Y * 0.4, Vec3::Y * 0.5 + way], 0.09, 0.75, up, [GREEN, OWN]);
        }
    }

    fn cone(&mut self) {
        self.lathe(&[(0.1, 0.3), (0.45, 0.4), (0.85, 0.22)], 5, DARK, DARK);
        for scale in 0..24 {
            let t = 0.06 + 0.86 * scale as f32 / 23.0;
            let (sin, cos) = math::sin_cos(scale as f32 * GOLDEN);
            let body = 0.4 * math::sin((0.12 + 0.8 * t) * std::f32::consts::PI);
            let outward = Vec3::new(cos, 0.0, sin);
            let foot = outward * (0.7 * body) + Vec3::Y * t;
            let tip = outward * (body * 1.22) + Vec3::Y * (t + 0.1).min(1.0);
            self.blade([foot, tip], 0.15 * (0.4 + body), 0.65, outward, [DARK, OWN]);
        }
    }

    /// A nutlet with its wing, to the side of this sign; straight down for 0.
    fn wing(&mut self, side: f32) {
        let way = Vec3::new(0.5 * side, 1.0, 0.0);
        let nut = way * 0.28;
        self.blade([Vec3::ZERO, nut], 0.1, 0.55, Vec3::Z, [DARK, DARK]);
        let half_width = if side == 0.0 { 0.5 } else { 0.16 };
        self.blade([nut * 0.7, way], half_width, 0.65, Vec3::Z, [DARK, OWN]);
    }

    fn bract(&mut self) {
        self.blade([Vec3::ZERO, Vec3::new(0.1, 1.0, 0.0)], 0.1, 0.55, Vec3::Z, [OWN; 2]);
        self.blade([Vec3::new(0.04, 0.45, 0.0), Vec3::new(-0.12, 0.9, 0.0)], 0.012, 0.5, Vec3::Z, [GREEN; 2]);
        for (x, y) in [(-0.14, 0.9), (-0.02, 0.94), (-0.24, 0.84)] {
            let middle = Vec3::new(x, y, 0.02);
            let ends = [Vec3::Y, -Vec3::Y, Vec3::X, -Vec3::X, Vec3::Z, -Vec3::Z];
            let [up, down, right, left, front, back] =
                ends.map(|end| self.vertex(middle + end * 0.055, end, YELLOW));
            for [a, b] in [[right, front], [front, left], [left, back], [back, right]] {
                self.mesh.indices.extend([a, up, b, a, b, down]);
            }
        }
    }

    /// Moves all so far along +Y and puts a stalk under it.
    fn stalk(&mut self, length: f32) {
        for position in &mut self.mesh.positions {
            position.y += length;
        }
        let half_width = (0.012 * length).clamp(0.008, 0.05);
        self.blade([Vec3::ZERO, Vec3::Y * (length + 0.03)], half_width, 0.5, Vec3::Z, [GREEN; 2]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::species::text::Choice;

    #[test]
    fn every_organ_is_sound_and_has_the_triangles_it_promises() {
        let triangles = [10, 74, 28, 30, 36, 78, 8, 4, 28];
        for ((name, kind), triangles) in OrganKind::NAMES.iter().zip(triangles) {
            for (stalk, width) in [(0.0, 1.0), (2.0, 0.2), (20.0, 4.0)] {
                let leaf = organ(&Organ { kind: *kind, stalk, width, ..Organ::default() });
                let mesh = leaf.mesh();
                assert_eq!(mesh.check(), Ok(()), "{name}");
                let more = if stalk > 0.0 { 2 } else { 0 };
                assert_eq!(mesh.triangles().len(), triangles + more, "{name}");
                let bounds = mesh.bounds().expect("there are vertices");
                let long = bounds.max.y - stalk;
                assert!(long <= 1.1 && (long > 0.9 || *kind == OrganKind::Flower), "{name}: {long}");
                assert!(mesh.colors.iter().flatten().all(|channel| (0.0..=1.0).contains(channel)), "{name}");
            }
        }
    }

    #[test]
    fn bodies_face_outward() {
        for kind in [OrganKind::Ball, OrganKind::Catkin] {
            let leaf = organ(&Organ { kind, stalk: 0.0, ..Organ::default() });
            let mesh = leaf.mesh();
            for corners in mesh.triangles() {
                let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
                let out = (a + b + c) / 3.0 - Vec3::Y * 0.5;
                assert!((b - a).cross(c - a).dot(out) > 0.0, "{kind:?}: {corners:?}");
            }
        }
    }
}
