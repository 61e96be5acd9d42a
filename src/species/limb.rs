//! Limbs: each on its way to the outline of the crown, and those that leave it there.

use super::draw::Draw;
use super::growing::{Growing, Stem};
use super::wood::{Axis, Rank};
use crate::math;
use glam::Vec3;
use std::f32::consts::PI;

/// Range of the places at which a limb forks, as parts of its way.
const FORK: [f32; 2] = [0.22, 0.62];
/// Highest order of a limb that forks.
const FORKINGS: u16 = 3;
/// The part of its way to the crown's outline that a fork must have, as a share of the crown's radius.
const SHORTEST_FORK: f32 = 0.3;

/// The way of a limb.
#[derive(Debug, Clone, Copy)]
struct Way {
    node: u32,
    /// From the vertical, radians, at its start.
    pitch: f32,
    azimuth: f32,
    /// Upward turn at its middle and at its end, radians.
    mid: f32,
    end: f32,
    length: f32,
    order: u16,
}

/// The direction at an angle to the vertical, towards an azimuth.
fn heading(pitch: f32, azimuth: f32) -> Vec3 {
    let ((sp, cp), (sa, ca)) = (math::sin_cos(pitch), math::sin_cos(azimuth));
    Vec3::new(sp * ca, cp, sp * sa)
}

impl Growing<'_> {
    pub(super) fn limb(
        &mut self,
        stem: &Stem,
        height: f32,
        azimuth: f32,
        vigor: f32,
        fork: bool,
        mut draw: Draw,
    ) -> Axis {
        let species = self.species;
        let table = &species.limbs;
        let nodes = &stem.axis.nodes;
        let node = nodes.partition_point(|&node| self.wood.at(node).y <= height + 1e-4);
        let node = nodes[node.saturating_sub(1).max(1.min(nodes.len() - 1))];
        let from = self.wood.at(node);
        let share = self.outline.share(from.y);
        let lerp = |[low, high]: [f32; 2]| (low + (high - low) * share).to_radians();
        let base = if fork { species.trunk.fork_angle.to_radians() } else { lerp(table.angle) };
        let base = base + table.angle_spread.to_radians() * draw.normal();
        let (mid, end) = (lerp(table.rise), lerp(table.rise_at_end));
        let length = if table.length[1] > 0.0 {
            draw.within(table.length) * vigor
        } else {
            let most = 2.5 * self.outline.radius() + 0.6 * self.outline.top();
            let mean = heading(base - 0.6 * mid - 0.15 * end, azimuth);
            self.outline.way_out(from, mean, most) * vigor
        };
        let length = length.max(1.5 * species.shoots.length);
        let way = Way { node, pitch: base, azimuth, mid, end, length, order: stem.order + 1 };
        self.run(&way, draw)
    }

    /// Limbs that leave a limb on its way, as strong as it is: each a fork of its own.
    pub(super) fn forks(&mut self, number: usize, mut draw: Draw, limbs: &mut Vec<Axis>) {
        let table = &self.species.limbs;
        let limb = &limbs[number];
        let order = self.wood.orders[limb.nodes[limb.nodes.len() - 1] as usize];
        let shortest = SHORTEST_FORK * self.outline.radius();
        if table.forks <= 0.0 || order > FORKINGS || limb.length < shortest || limb.nodes.len() < 4 {
            return;
        }
        // Long limbs fork most.
        let count = table.forks * (limb.length / self.outline.radius().max(shortest)).min(1.5);
        let count = (count + draw.unit()).floor() as usize;
        let side = if draw.unit() < 0.5 { 1.0 } else { -1.0 };
        let stations: Vec<(u32, Vec3)> = (0..count)
            .map(|i| {
                let [from, to] = FORK;
                let share = from + (to - from) * (i as f32 + draw.unit()) / count as f32;
                limb.station(&self.wood, share)
            })
            .collect();
        for (i, (node, direction)) in stations.into_iter().enumerate() {
            let mut draw = draw.child(1, i);
            // In turn to both sides, and a little up or down.
            let side = if i % 2 == 0 { side } else { -side };
            let apart = (table.forks_angle + table.angle_spread * draw.normal()).to_radians();
            let level = (direction.x * direction.x + direction.z * direction.z).sqrt();
            let pitch = math::atan2(level, direction.y);
            // The same angle is more of a turn, the steeper the limb is.
            let azimuth = math::atan2(direction.z, direction.x) + side * apart / level.max(0.35);
            let pitch = pitch + 0.35 * apart * draw.normal();
            let from = self.wood.at(node);
            let most = 2.0 * self.outline.radius() + 0.4 * self.outline.top();
            let length = self.outline.way_out(from, heading(pitch, azimuth), most);
            let length = length * (1.0 - 0.5 * table.unequal * draw.unit());
            if length < shortest {
                continue;
            }
            let share = self.outline.share(from.y);
            let [low, high] = table.rise_at_end;
            let end = 0.6 * (low + (high - low) * share).to_radians();
            let order = self.wood.orders[node as usize] + 1;
            let way = Way { node, pitch, azimuth, mid: 0.3 * end, end, length, order };
            let axis = self.run(&way, draw);
            limbs.push(axis);
        }
    }

    /// A limb on its way.
    fn run(&mut self, way: &Way, mut draw: Draw) -> Axis {
        let Way { node, pitch, azimuth, mid, end, length, order } = *way;
        let step = self.species.branches.spacing.clamp(length / 60.0, length / 4.0);
        let steps = (length / step).round().clamp(2.0, 80.0);
        let step = length / steps;
        let wander = self.species.limbs.crooked.to_radians() * step.sqrt();
        let (mut turned, mut dipped) = (0.0f32, 0.0f32);
        let (mut drift, mut sink) = (0.0f32, 0.0f32);
        // A limb that was turned aside comes back to its way within a part of its length, and makes no hoops.
        let back = 1.0 - (6.0 / steps).min(0.25);
        let (mut at, mut nodes) = (self.wood.at(node), vec![node]);
        for i in 0..steps as usize {
            let t = (i as f32 + 0.5) / steps;
            let rise = if t < 0.5 { mid * 2.0 * t } else { mid + (end - mid) * (2.0 * t - 1.0) };
            drift = drift * 0.6 + wander * draw.normal();
            sink = sink * 0.6 + wander * draw.normal();
            turned = (turned + drift) * back;
            dipped = (dipped + sink) * back;
            let pitch = (pitch - rise + dipped).clamp(-PI, PI);
            let next = at + heading(pitch, azimuth + turned) * step;
            if next.y < 0.3 {
                break;
            }
            at = next;
            let parent = nodes.last().copied().unwrap_or(node);
            nodes.push(self.wood.push(at, parent, order, Rank::Limb));
        }
        let length = step * (nodes.len() - 1) as f32;
        let axis = Axis { nodes, length, draw: draw.child(13, 0) };
        self.end_shoot(&axis, order);
        axis
    }
}
