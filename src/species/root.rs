//! The bases of roots, which spread from the base of a trunk and go into the ground.

use super::Specimen;
use super::draw::Draw;
use super::wood::Rank;
use crate::math;
use crate::{Skeleton, SkeletonError};
use glam::Vec3;
use std::f32::consts::TAU;

/// Trunks thinner than this show no roots, metres.
const THINNEST: f32 = 0.08;
/// The way of a root: distance from the trunk's axis in radii of its base, height in radii of its base, and radius
/// as a part of the first.
const WAY: [[f32; 3]; 6] = [
    [0.3, 1.5, 0.85],
    [0.66, 0.92, 1.0],
    [1.0, 0.4, 1.0],
    [1.4, 0.05, 0.8],
    [1.9, -0.14, 0.58],
    [2.5, -0.34, 0.4],
];
/// Radius of the thickest root at its base, as a part of the trunk's there.
const THICKEST: f32 = 0.4;
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
            .take_while(|&node| skeleton.positions()[node].y <= 1.5 * base)
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
}
