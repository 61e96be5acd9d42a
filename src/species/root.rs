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
    [0.4, 3.0, 0.5],
    [0.53, 2.1, 0.62],
    [0.68, 1.35, 0.78],
    [0.88, 0.75, 0.95],
    [1.15, 0.32, 1.0],
    [1.5, 0.04, 0.8],
    [2.0, -0.14, 0.58],
    [2.6, -0.34, 0.4],
];
/// Radius of the thickest root at its base, as a part of the trunk's there.
const THICKEST: f32 = 0.4;
/// Distance from the trunk's surface over which normals of roots become its own, in radii of its base.
const BLENDED: f32 = 0.3;
/// The stage of their nodes.
pub(super) const STAGE: u16 = Rank::Shoot as u16 + 1;

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
        let stem: Vec<usize> = (0..skeleton.len())
            .take_while(|&node| node == 0 || skeleton.parent(node) == Some(node - 1))
            .take_while(|&node| skeleton.positions()[node].y <= WAY[0][1] * base)
            .collect();
        let from = stem[stem.len() - 1];
        let foot = skeleton.positions()[0];
        let (mut positions, mut radii) = (skeleton.positions().to_vec(), skeleton.radii().to_vec());
        let (mut stages, mut orders) = (skeleton.stages().to_vec(), skeleton.orders().to_vec());
        let mut parents: Vec<Option<u32>> =
            (0..skeleton.len()).map(|node| skeleton.parent(node).map(|parent| parent as u32)).collect();
        let start = draw.unit() * TAU;
        for root in 0..count {
            let mut azimuth = start + (root as f32 + 0.45 * (draw.unit() - 0.5)) * TAU / count as f32;
            let strong = draw.within([0.65, 1.0]);
            let mut parent = from;
            for [out, height, part] in WAY {
                azimuth += 0.14 * draw.normal() * f32::from(out > 1.0);
                let (sin, cos) = math::sin_cos(azimuth);
                let out = out * base * (1.0 + (strong - 0.8) * f32::from(out > 1.0));
                positions.push(foot + Vec3::new(out * cos, height * base * strong, out * sin));
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
        let skeleton = &self.skeleton;
        let base = skeleton.radii()[0];
        for (vertex, wind) in mesh.wind.iter().enumerate() {
            if (wind.node as usize) < skeleton.len() {
                continue;
            }
            let place = mesh.positions[vertex];
            let after = (1..skeleton.len())
                .take_while(|&node| skeleton.parent(node) == Some(node - 1))
                .find(|&node| skeleton.positions()[node].y >= place.y);
            let Some(after) = after else { continue };
            let [low, high] = [after - 1, after].map(|node| skeleton.positions()[node]);
            let rise = (high.y - low.y).max(1e-6);
            let share = ((place.y - low.y) / rise).clamp(0.0, 1.0);
            let [thick, thin] = [after - 1, after].map(|node| skeleton.radii()[node]);
            let out = (place - low.lerp(high, share)).with_y(0.0);
            let away = (out.length() - (thick + (thin - thick) * share)) / (BLENDED * base);
            let of_trunk = (out.normalize_or_zero() + Vec3::Y * ((thick - thin) / rise)).normalize_or_zero();
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
}
