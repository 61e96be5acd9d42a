//! Twigs as crossed pictures.

use super::atlas::Grid;
use super::bake::{Baked, Drawn, Raster, View, Wanted};
use super::cluster::{Cluster, Leaf};
use super::leaf::Dress;
use super::twig::{self, Wood};
use crate::observer::{Cancelled, Watch};
use crate::surface::{Instance, Material, Mesh};
use crate::{Skeleton, math, parallel};
use glam::{Mat3, Quat, Vec2, Vec3, Vec4};
use std::f32::consts::FRAC_1_SQRT_2;

/// Triangles of one card: two quads.
pub(super) const TRIANGLES: usize = 4;
/// Points along each side of a baked pixel.
const SAMPLES: usize = 4;
/// Pixels that a line of bare wood is wide at the least.
const LINE: f32 = 1.3;
/// Number of layers of leaves that are as opaque as wood.
const WOOD: f32 = 4.0;

/// Leaves of the tree, or bare twigs, that cards may show.
pub(super) struct Source<'a> {
    pub(super) skeleton: &'a Skeleton,
    pub(super) dresses: &'a [Dress],
    pub(super) all: &'a [Leaf],
    pub(super) bark: Material,
    /// For each node, `true` if its internode is on no mesh of bark.
    pub(super) bare: &'a [bool],
    /// For each node, the numbers of the clusters of this level that it is in; `u32::MAX` for none.
    pub(super) cluster_of: Vec<u32>,
}

/// One kind of card.
#[derive(Debug)]
pub(super) struct Kind {
    /// Mesh in the frame of the model's cluster, from its base.
    pub(super) mesh: Mesh,
    /// Middle of its leaves, from its base.
    middle: Vec3,
    area: f32,
    /// One per quad.
    pub(super) pictures: Vec<Baked>,
}

impl Source<'_> {
    /// Bakes the kinds that these clusters stand for, in cells of this grid, the first after those of the kinds `before`.
    pub(super) fn kinds(
        &self,
        models: &[&(u32, Cluster)],
        grid: Grid,
        before: usize,
        watch: &Watch<'_>,
    ) -> Result<Vec<Kind>, Cancelled> {
        let kinds = parallel::map(models.len(), |number| {
            let (id, cluster) = models[number];
            self.kind(*id, cluster, grid, 2 * (before + number), watch)
        });
        watch.pass(0)?;
        Ok(kinds)
    }

    fn kind(&self, id: u32, cluster: &Cluster, grid: Grid, first: usize, watch: &Watch<'_>) -> Kind {
        let frame = cluster.frame;
        let inverse = frame.transpose();
        let base = self.base(cluster);
        let copies = self.copies(cluster);
        // Everything that is to be seen, in the cluster's frame about its middle.
        let mut points = Vec::new();
        for (dress, copies) in self.dresses.iter().zip(&copies) {
            for copy in copies {
                let matrix = inverse * copy.matrix();
                let offset = inverse * (copy.position - cluster.middle);
                points.extend(dress.mesh.positions.iter().map(|&point| matrix * point + offset));
            }
        }
        let is_bare = points.is_empty();
        if is_bare {
            let ends = self.wood(id, cluster, |_| true).into_iter().flat_map(|wood| wood.ends);
            points.extend(ends.map(|end| inverse * (end - cluster.middle)));
        }
        // Wood is seen only among the leaves: it would widen the picture, and they would be small in it.
        let low = points.iter().copied().reduce(Vec3::min).unwrap_or_default();
        let high = points.iter().copied().reduce(Vec3::max).unwrap_or_default();
        let wood = self.wood(id, cluster, |point| {
            let at = inverse * (point - cluster.middle);
            at.cmpge(low).all() && at.cmple(high).all()
        });
        let bend = Bend::of(self.all, cluster);
        // One quad lies where the twig is flattest; the other stands on it, turned by half a right angle, so that it is
        // seen from the base as well as from the side.
        let quads = [
            [Vec3::X, Vec3::Y, Vec3::Z],
            [
                Vec3::new(-FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0),
                Vec3::Z,
                Vec3::new(FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0),
            ],
        ];
        let mut mesh = Mesh::default();
        let mut pictures = Vec::new();
        let origin = inverse * (cluster.middle - base);
        for (quad, [right, up, toward]) in quads.into_iter().enumerate() {
            let flat = |point: &Vec3| Vec2::new(point.dot(right), point.dot(up));
            let low = points.iter().map(flat).reduce(Vec2::min).unwrap_or_default();
            let high = points.iter().map(flat).reduce(Vec2::max).unwrap_or_default();
            let half = (0.5 * (high - low)).max(Vec2::splat(1e-3 * cluster.size()));
            let middle = 0.5 * (low + high);
            let view = View {
                right: frame * right,
                up: frame * up,
                toward: frame * toward,
                center: cluster.middle + frame * (right * middle.x + up * middle.y),
                half,
            };
            let side = grid.cell - 2 * super::atlas::PADDING;
            let mut raster = Raster::new(view, [side; 2], SAMPLES, Wanted::Layers);
            for (dress, copies) in self.dresses.iter().zip(&copies) {
                raster.draw(
                    &Drawn {
                        mesh: &dress.mesh,
                        copies: copies.into(),
                        color: dress.material.color(),
                        double_sided: true,
                        skin: dress.skin.as_deref(),
                        layers: 1.0,
                    },
                    watch,
                );
            }
            // Lines thinner than a pixel would be dashes: rather fewer and thicker ones.
            let least = LINE * half.max_element() / side as f32;
            let ribbons = if is_bare {
                ribbons(&twig::fewer(&wood, least), view.toward)
            } else {
                ribbons(&wood, view.toward)
            };
            raster.draw(
                &Drawn {
                    mesh: &ribbons,
                    copies: (&[Instance::IDENTITY][..]).into(),
                    color: self.bark.color(),
                    double_sided: true,
                    skin: None,
                    layers: WOOD,
                },
                watch,
            );
            pictures.push(raster.finish(|sample| sample.color));
            let vertex = mesh.positions.len() as u32;
            let ([u, v], [across, down]) = grid.inner(first + quad);
            for (sx, sy) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let at = middle + half * Vec2::new(sx, sy);
                let flat = right * at.x + up * at.y;
                let bent = if quad == 0 { Vec3::Z * bend.at(at) } else { Vec3::ZERO };
                mesh.positions.push(origin + flat + bent);
                mesh.normals.push(toward);
                if grid.normals {
                    mesh.tangents.push(Vec4::from((right, 1.0)));
                }
                let uv = Vec2::new(u + across * (0.5 + 0.5 * sx), v + down * (0.5 - 0.5 * sy));
                // Files hold these whole in 16 bits.
                mesh.uvs.push((uv * 65_535.0).round() / 65_535.0);
            }
            mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| vertex + corner));
        }
        Kind { mesh, middle: origin, area: cluster.area, pictures }
    }

    /// Base of a card.
    fn base(&self, cluster: &Cluster) -> Vec3 {
        self.skeleton.positions()[self.skeleton.parent(cluster.root as usize).unwrap_or(0)]
    }

    /// The leaves of a cluster, as copies of each of the meshes.
    fn copies(&self, cluster: &Cluster) -> Vec<Vec<Instance>> {
        let mut copies = vec![Vec::new(); self.dresses.len()];
        for &leaf in &cluster.leaves {
            let Leaf { dress, mut copy, .. } = self.all[leaf as usize];
            let Some(own) = copies.get_mut(dress as usize) else { continue };
            for (tint, mean) in copy.tint.iter_mut().zip(cluster.tint) {
                // The mean comes back as the tint of the card.
                *tint /= mean.max(1e-3);
            }
            own.push(copy);
        }
        copies
    }

    /// The internodes of a cluster that have no bark of their own and an end where it `is_seen`, parents before children.
    fn wood(&self, id: u32, cluster: &Cluster, is_seen: impl Fn(Vec3) -> bool) -> Vec<Wood> {
        let mut wood = Vec::new();
        let positions = self.skeleton.positions();
        for node in cluster.root as usize..self.skeleton.len() {
            if self.cluster_of[node] == id && self.bare[node] {
                let Some(parent) = self.skeleton.parent(node) else { continue };
                let ends = [positions[parent], positions[node]];
                if ends.into_iter().any(&is_seen) {
                    wood.push(Wood { node, parent, ends, radius: self.skeleton.radii()[node] });
                }
            }
        }
        wood
    }
}

/// Transform of the card of a kind for a cluster, `larger` than it.
pub(super) fn instance(cluster: &Cluster, kind: &Kind, larger: f32) -> Instance {
    let scale = (cluster.area / kind.area.max(f32::MIN_POSITIVE)).sqrt() * larger;
    let scale = scale.clamp(1e-20, 1e20);
    let rotation = math::unit_rotation(Quat::from_mat3(&cluster.frame));
    let turned = Mat3::from_quat(rotation) * kind.middle;
    let (position, node) = (cluster.middle - turned * scale, cluster.root);
    Instance { position, rotation, scale, node, tint: cluster.tint }
}

/// Deviation of a flat twig from its plane: `a + b·x + c·y + d·x·y` by least squares.
struct Bend([f64; 4]);

impl Bend {
    fn of(all: &[Leaf], cluster: &Cluster) -> Self {
        let mut rows = [[0.0f64; 5]; 4];
        let inverse = cluster.frame.transpose();
        for &leaf in &cluster.leaves {
            let leaf = &all[leaf as usize];
            let at = (inverse * (leaf.middle - cluster.middle)).as_dvec3();
            let terms = [1.0, at.x, at.y, at.x * at.y];
            for i in 0..4 {
                for j in 0..4 {
                    rows[i][j] += terms[i] * terms[j];
                }
                rows[i][4] += terms[i] * at.z;
            }
        }
        // A little stiffness, so that few leaves cannot bend it far.
        let size = f64::from(cluster.size());
        let count = cluster.leaves.len() as f64;
        for (i, stiff) in [0.5, size * size, size * size, size * size * size * size].into_iter().enumerate() {
            rows[i][i] += 0.05 * stiff * count + 1e-18;
        }
        Self(solve(rows))
    }

    fn at(&self, at: Vec2) -> f32 {
        let [a, b, c, d] = self.0;
        let (x, y) = (f64::from(at.x), f64::from(at.y));
        (a + b * x + c * y + d * x * y) as f32
    }
}

/// The solution of four positive definite equations, by elimination.
fn solve(mut rows: [[f64; 5]; 4]) -> [f64; 4] {
    for i in 0..4 {
        for j in i + 1..4 {
            let factor = rows[j][i] / rows[i][i];
            let above = rows[i];
            for (entry, above) in rows[j].iter_mut().zip(above).skip(i) {
                *entry -= factor * above;
            }
        }
    }
    let mut solution = [0.0; 4];
    for i in (0..4).rev() {
        let rest: f64 = (i + 1..4).map(|j| rows[i][j] * solution[j]).sum();
        solution[i] = (rows[i][4] - rest) / rows[i][i];
    }
    solution.map(|x| if x.is_finite() { x } else { 0.0 })
}

/// Strips along internodes that face the viewer.
fn ribbons(wood: &[Wood], toward: Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    for &Wood { ends: [from, to], radius, .. } in wood {
        let across = (to - from).cross(toward).normalize_or_zero() * radius;
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([from - across, from + across, to + across, to - across]);
        mesh.normals.extend([toward; 4]);
        mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
    }
    mesh
}
