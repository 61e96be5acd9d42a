//! A ruined wall of blocks, with a window and a buttress: something to climb.

use treesynth::glam::{IVec3, Vec3};
use treesynth::random::{Purpose, unit};
use treesynth::surface::Mesh;

/// Side of a block, metres.
const BLOCK: f32 = 0.15;
const SIZE: IVec3 = IVec3::new(30, 24, 6);

/// The wall's surface; only what stands on the ground is open.
pub(crate) struct Ruin {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The block of each triangle.
    blocks: Vec<IVec3>,
}

fn draw(at: IVec3, purpose: u32) -> f32 {
    let index =
        at.to_array().iter().fold(0, |key: u64, &n| key << 16 | u64::from((n + 64).cast_unsigned() & 0xffff));
    unit(3, purpose, Purpose::CUSTOM, index)
}

/// The wall is three blocks thick; the buttress, on the left, six.
fn is_solid(at: IVec3) -> bool {
    if at.cmplt(IVec3::ZERO).any() || at.cmpge(SIZE).any() {
        return false;
    }
    let (x, y) = (at.x as f32, at.y as f32);
    // The top has crumbled, in steps of two blocks, more to the right.
    let step = IVec3::new(at.x / 2, 0, 0);
    let top = 21.0 - 0.28 * x + 4.0 * draw(step, 0) - if (12..17).contains(&at.x) { 3.0 } else { 0.0 };
    let window = (x - 20.5).abs() < 3.5
        && y >= 5.0
        && (y < 9.0 || (x - 20.5) * (x - 20.5) + (y - 9.0) * (y - 9.0) < 12.0);
    let buttress = at.x < 5 && y < 15.0 - 2.5 * (at.z - 3).max(0) as f32;
    y < top && !window && (at.z < 3 || buttress)
}

impl Ruin {
    pub(crate) fn new() -> Self {
        let mut ruin = Self { positions: Vec::new(), triangles: Vec::new(), blocks: Vec::new() };
        let mut places: std::collections::BTreeMap<[i32; 3], u32> = std::collections::BTreeMap::new();
        for z in 0..SIZE.z {
            for y in 0..SIZE.y {
                for x in 0..SIZE.x {
                    let block = IVec3::new(x, y, z);
                    for (axis, ahead) in (0..3).flat_map(|axis| [(axis, false), (axis, true)]) {
                        let mut step = IVec3::ZERO;
                        step[axis] = if ahead { 1 } else { -1 };
                        let on_ground = axis == 1 && !ahead && y == 0;
                        if !is_solid(block) || is_solid(block + step) || on_ground {
                            continue;
                        }
                        let (mut u, mut v) = (IVec3::ZERO, IVec3::ZERO);
                        u[(axis + 1) % 3] = 1;
                        v[(axis + 2) % 3] = 1;
                        let first = if ahead { block + step } else { block };
                        let mut corners = [first, first + u, first + u + v, first + v];
                        if !ahead {
                            corners.swap(1, 3);
                        }
                        let [a, b, c, d] = corners.map(|corner| {
                            *places.entry(corner.to_array()).or_insert_with(|| {
                                let shift = [1, 2, 3].map(|purpose| draw(corner, purpose) - 0.5);
                                let level = if corner.y == 0 { 0.0 } else { 1.0 };
                                let shift = Vec3::from_array(shift) * Vec3::new(1.0, level, 1.0);
                                ruin.positions.push((corner.as_vec3() + shift * 0.3) * BLOCK);
                                ruin.positions.len() as u32 - 1
                            })
                        });
                        ruin.triangles.extend([[a, b, c], [a, c, d]]);
                        ruin.blocks.extend([block; 2]);
                    }
                }
            }
        }
        ruin
    }

    /// Flat triangles, each block in its own tone.
    pub(crate) fn mesh(&self) -> Mesh {
        let mut mesh = Mesh::default();
        for (corners, &block) in self.triangles.iter().zip(&self.blocks) {
            let [a, b, c] = corners.map(|corner| self.positions[corner as usize]);
            let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
            let tone = 0.75 + 0.35 * draw(block, 4);
            let first = mesh.positions.len() as u32;
            mesh.positions.extend([a, b, c]);
            mesh.normals.extend([normal; 3]);
            mesh.colors.extend([[0.5 * tone, 0.45 * tone, 0.385 * tone]; 3]);
            mesh.indices.extend([first, first + 1, first + 2]);
        }
        mesh
    }
}
