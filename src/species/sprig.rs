//! Models of leaves: the meshes of `foliage`, and some of needles and leaflets.

use super::data::{LeafData, LeafShape};
use crate::foliage::Leaf;
use crate::math;
use crate::surface::Mesh;
use glam::{Vec2, Vec3};

/// The leaf of a species, 1 long.
pub(super) fn leaf(data: &LeafData) -> Leaf {
    let leaf = match data.shape {
        LeafShape::Ovate => Leaf::ovate(),
        LeafShape::Deltoid => Leaf::deltoid(),
        LeafShape::Heart => Leaf::new(heart()),
        LeafShape::Lanceolate => Leaf::lanceolate(),
        LeafShape::Sickle => Leaf::new(sickle()),
        LeafShape::Lobed => Leaf::lobed(),
        LeafShape::Sinuate => Leaf::sinuate(),
        LeafShape::Pinnate => Leaf::pinnate(),
        LeafShape::Bipinnate => Leaf::new(bipinnate()),
        LeafShape::Palmate => Leaf::palmate(),
        LeafShape::Needles => Leaf::needles(),
        LeafShape::Tuft => Leaf::new(tuft()),
        LeafShape::Scales => Leaf::new(scales()),
        LeafShape::Strap => Leaf::new(strap()),
    };
    if data.petiole > 0.0 { leaf.with_petiole(data.petiole) } else { leaf }
}

/// Blades of two triangles.
#[derive(Default)]
struct Blades {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    indices: Vec<u32>,
}

impl Blades {
    /// From `foot` along `way`, broadest at `broad` of it, its upper side to `up`.
    fn diamond(&mut self, foot: Vec3, way: Vec3, half_width: f32, broad: f32, up: Vec3) {
        let across = way.cross(up).normalize_or(Vec3::X) * half_width;
        let normal = across.cross(way).normalize_or(Vec3::Z);
        let middle = foot + way * broad;
        let first = self.positions.len() as u32;
        self.positions.extend([foot, middle + across, foot + way, middle - across]);
        self.normals.extend([normal; 4]);
        self.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
    }

    /// A blade along a bent midrib: (place, half width) from foot to tip.
    fn strip(&mut self, stations: &[(Vec3, f32)]) {
        let first = self.positions.len() as u32;
        for &(place, half_width) in stations {
            for side in [1.0, -1.0] {
                self.positions.push(place + Vec3::X * (half_width * side));
                self.normals.push(Vec3::Z);
            }
        }
        for station in 0..stations.len() as u32 - 1 {
            let [a, b, c, d] = [0, 1, 2, 3].map(|corner| first + 2 * station + corner);
            let (below, above) = (stations[station as usize].1 > 0.0, stations[station as usize + 1].1 > 0.0);
            if above {
                self.indices.extend([a, c, d]);
            }
            if below {
                self.indices.extend([a, d, b]);
            }
        }
    }

    fn finish(self) -> Mesh {
        let low = self.positions.iter().copied().reduce(Vec3::min).unwrap_or_default();
        let high = self.positions.iter().copied().reduce(Vec3::max).unwrap_or_default();
        let size = (high - low).max(Vec3::splat(1e-9));
        let uvs = self.positions.iter().map(|p| {
            let share = (*p - low) / size;
            Vec2::new(share.x, 1.0 - share.y)
        });
        let uvs = uvs.collect();
        Mesh::new(self.positions, self.normals, self.indices).with_uvs(uvs)
    }
}

fn heart() -> Mesh {
    let mut blades = Blades::default();
    let stations = [(0.0, 0.0), (0.04, 0.3), (0.3, 0.44), (0.65, 0.28), (1.0, 0.0)];
    blades.strip(&stations.map(|(y, w)| (Vec3::new(0.0, y, -0.08 * y * y), w)));
    blades.finish()
}

fn sickle() -> Mesh {
    let mut blades = Blades::default();
    let stations = [(0.0, 0.0), (0.25, 0.075), (0.55, 0.07), (1.0, 0.0)];
    blades.strip(&stations.map(|(y, w): (f32, f32)| (Vec3::new(0.22 * y * y, y, -0.12 * y * y), w)));
    blades.finish()
}

fn strap() -> Mesh {
    let mut blades = Blades::default();
    let stations = [(0.0, 0.0), (0.08, 0.026), (0.6, 0.022), (1.0, 0.0)];
    blades.strip(&stations.map(|(y, w): (f32, f32)| (Vec3::new(0.0, y, -0.25 * y * y), w)));
    blades.finish()
}

/// Needles in pairs that spread from a shoot: 22 needles.
fn tuft() -> Mesh {
    let mut blades = Blades::default();
    let needles = 22;
    for needle in 0..needles {
        let t = needle as f32 / needles as f32;
        let (sin, cos) = math::sin_cos(needle as f32 * 2.399_963_2);
        let outward = Vec3::new(cos, 0.0, sin);
        let tilt = 1.15 - 0.75 * t;
        let (st, ct) = math::sin_cos(tilt);
        let way = (outward * st + Vec3::Y * ct) * 0.55;
        blades.diamond(Vec3::Y * (0.5 * t), way, 0.014, 0.4, Vec3::Y * st - outward * ct);
    }
    blades.finish()
}

/// A flat spray of scaly shoots.
fn scales() -> Mesh {
    let mut blades = Blades::default();
    blades.diamond(Vec3::ZERO, Vec3::Y, 0.045, 0.4, Vec3::Z);
    for i in 0..6 {
        let side = if i % 2 == 0 { 1.0 } else { -1.0 };
        let t = 0.12 + 0.11 * i as f32;
        let way = Vec3::new(side * 0.6, 0.8, 0.1 * side) * (0.5 - 0.35 * t);
        blades.diamond(Vec3::Y * t, way, 0.04, 0.45, Vec3::Z);
    }
    blades.finish()
}

/// Seven pairs of pinnae, each of many tiny leaflets drawn as one blade.
fn bipinnate() -> Mesh {
    let mut blades = Blades::default();
    blades.diamond(Vec3::ZERO, Vec3::Y * 0.95, 0.01, 0.5, Vec3::Z);
    for pair in 0..7 {
        let t = 0.18 + 0.12 * pair as f32;
        for side in [1.0, -1.0] {
            let way = Vec3::new(side * 0.85, 0.5, 0.0) * (0.34 - 0.16 * (t - 0.5).abs());
            blades.diamond(Vec3::Y * t, way, 0.045, 0.5, Vec3::Z);
        }
    }
    blades.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::species::text::Choice;

    #[test]
    fn every_leaf_is_sound() {
        for (name, shape) in LeafShape::NAMES {
            let leaf = leaf(&LeafData { shape: *shape, petiole: 0.2, ..LeafData::default() });
            assert_eq!(leaf.mesh().check(), Ok(()), "{name}");
            let area = leaf.mesh().area();
            assert!(area > 0.01 && area < 2.0, "{name}: {area}");
        }
    }
}
