//! The bases of roots, which spread from the base of a trunk and go into the ground.

use super::Specimen;
use super::draw::Draw;
use super::wood::Rank;
use crate::math;
use crate::surface::Mesh;
use crate::{Skeleton, SkeletonError};
use glam::Vec3;
use std::f32::consts::TAU;

/// Trunks thinner than this show no roots, metres.
const THINNEST: f32 = 0.08;
/// The way of a root: distance from the trunk's axis in radii of its base, height in radii of its base, and radius
/// as a part of the first.
const WAY: [[f32; 3]; 8] = [
    [0.3, 2.9, 0.5],
    [0.46, 1.95, 0.65],
    [0.64, 1.2, 0.82],
    [0.84, 0.64, 0.98],
    [1.1, 0.22, 1.05],
    [1.42, -0.1, 0.95],
    [1.8, -0.38, 0.75],
    [2.2, -0.6, 0.5],
];
/// Radius of the thickest root at its base, as a part of the trunk's there.
const THICKEST: f32 = 0.4;
/// Distance from the trunk's surface over which normals of roots become its own, in radii of its base.
const BLENDED: f32 = 0.3;
/// The stage of their nodes.
pub(super) const STAGE: u16 = Rank::Shoot as u16 + 1;

/// The radius with which the thinnest root leaves the trunk, metres; infinite without roots. Thicker wood wears old bark.
#[cfg(feature = "texture")]
pub(super) fn thinnest(rooted: &Skeleton) -> f32 {
    let stages = rooted.stages();
    let firsts = rooted.edges().filter(|&(node, parent)| stages[node] == STAGE && stages[parent] != STAGE);
    firsts.map(|(node, _)| rooted.radii()[node]).fold(f32::INFINITY, f32::min)
}

impl Specimen {
    /// The skeleton with the bases of its roots, whose nodes come after all others and have stage 5: what the bark is made of.
    /// Roots reach below the ground, by about half of the trunk's radius. Trees of several stems, trunks below 8 cm and species
    /// without [`roots`](super::Trunk::roots) have none.
    ///
    /// O(nodes) time and memory.
    pub fn rooted(&self) -> Skeleton {
        self.with_roots().unwrap_or_else(|_| self.skeleton.clone())
    }

    fn with_roots(&self) -> Result<Skeleton, SkeletonError> {
        let skeleton = &self.skeleton;
        let trunk = &self.species.trunk;
        let mut draw = Draw::new(Draw::seed_of(&self.species.latin, self.seed)).child(60, 0);
        let count = draw.whole(trunk.roots);
        if count == 0 || trunk.stems[1] > 1.0 || self.numbers.dbh < THINNEST || skeleton.is_empty() {
            return Ok(skeleton.clone());
        }
        let base = skeleton.radii()[0];
        let stem = self.stem();
        // No higher than what is left of a broken stem.
        let top = skeleton.positions()[stem[stem.len() - 1]].y;
        let high = (0.9 * top / (WAY[0][1] * base)).clamp(0.0, 1.0);
        let reach = WAY[0][1] * base * high;
        let from = stem
            .iter()
            .take_while(|&&node| skeleton.positions()[node].y <= reach)
            .last()
            .map_or(0, |&node| node);
        let foot = skeleton.positions()[0];
        let (mut positions, mut radii) = (skeleton.positions().to_vec(), skeleton.radii().to_vec());
        let (mut stages, mut orders) = (skeleton.stages().to_vec(), skeleton.orders().to_vec());
        let mut parents: Vec<Option<u32>> =
            (0..skeleton.len()).map(|node| skeleton.parent(node).map(|parent| parent as u32)).collect();
        let start = draw.unit() * TAU;
        for root in 0..count {
            let mut azimuth = start + (root as f32 + 0.7 * (draw.unit() - 0.5)) * TAU / count as f32;
            let strong = draw.within([0.5, 1.0]);
            let mut parent = from;
            for [out, height, part] in WAY {
                azimuth += 0.1 * draw.normal() * f32::from(out > 1.0);
                let (sin, cos) = math::sin_cos(azimuth);
                let out = out * base * (1.0 + 1.2 * (strong - 0.8) * f32::from(out > 1.0));
                let height = height * base * strong * if height > 0.0 { high } else { 1.0 };
                // Beside the stem, which may lean.
                let beside = self.stem_at(&stem, height).map_or(foot, |[axis, _]| axis).with_y(foot.y);
                positions.push(beside + Vec3::new(out * cos, height, out * sin));
                radii.push(THICKEST * base * strong * part);
                parents.push(Some(parent as u32));
                stages.push(STAGE);
                orders.push(1);
                parent = positions.len() - 1;
            }
        }
        Skeleton::new(positions, parents)?.with_radii(radii)?.with_stages(stages)?.with_orders(orders)
    }

    /// Bends the normals of roots towards the trunk's where they come out of it, so that light falls on both alike. The wind of the mesh
    /// tells the node of each vertex.
    pub(super) fn blend_roots(&self, mesh: &mut Mesh) {
        let (skeleton, stem) = (&self.skeleton, self.stem());
        for (vertex, wind) in mesh.wind.iter().enumerate() {
            if (wind.node as usize) < skeleton.len() {
                continue;
            }
            let place = mesh.positions[vertex];
            let Some([axis, Vec3 { x: radius, y: slope, .. }]) = self.stem_at(&stem, place.y) else {
                continue;
            };
            let out = (place - axis).with_y(0.0);
            let away = (out.length() - radius) / (BLENDED * skeleton.radii()[0]);
            let of_trunk = (out.normalize_or_zero() + Vec3::Y * slope).normalize_or_zero();
            let part = 1.0 - away.clamp(0.0, 1.0);
            let own = mesh.normals[vertex];
            let normal = own.lerp(of_trunk, part * part * (3.0 - 2.0 * part)).normalize_or(own);
            mesh.normals[vertex] = normal;
            if let Some(tangent) = mesh.tangents.get_mut(vertex) {
                let along = tangent.truncate().reject_from_normalized(normal);
                *tangent = along.normalize_or(math::perpendicular(normal)).extend(tangent.w);
            }
        }
    }

    /// Nodes of the stem, from the ground up; splinters at its broken end are not of it.
    pub(super) fn stem(&self) -> Vec<usize> {
        let orders = self.skeleton.orders();
        let goes_on =
            |&node: &usize| node == 0 || orders[node] == 0 && self.skeleton.parent(node) == Some(node - 1);
        (0..self.skeleton.len()).take_while(goes_on).collect()
    }

    /// The stem's middle at a height, metres, and its radius with the rate at which that falls; none above its end.
    fn stem_at(&self, stem: &[usize], height: f32) -> Option<[Vec3; 2]> {
        let (positions, radii) = (self.skeleton.positions(), self.skeleton.radii());
        let pair = stem.windows(2).find(|pair| positions[pair[1]].y >= height)?;
        let [low, high] = [pair[0], pair[1]].map(|node| positions[node]);
        let [thick, thin] = [pair[0], pair[1]].map(|node| radii[node]);
        // A stem that hardly rises has its slope from a steeper one.
        let rise = (high.y - low.y).max(0.1 * low.distance(high)).max(1e-6);
        let share = ((height - low.y) / rise).clamp(0.0, 1.0);
        Some([low.lerp(high, share), Vec3::new(thick + (thin - thick) * share, (thick - thin) / rise, 0.0)])
    }
}
