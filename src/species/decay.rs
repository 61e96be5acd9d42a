//! Damage: limbs that break in a winter storm, everything in turn on a dead tree, and dead limbs
//! below the crown.

use super::data::Species;
use super::draw::Draw;
use super::request::Numbers;
use super::wood::{Rank, Wood, frame};
use crate::foliage::Leaves;
use crate::math::{self, UP};
use glam::Vec3;
use std::f32::consts::TAU;

/// Years after which axes of a rank are broken off, from the first to the last: limbs, branches, twigs, shoots. General
/// knowledge of standing dead wood: twigs within some years, limbs over decades.
const LIVES: [[f32; 2]; 4] = [[6.0, 55.0], [3.0, 24.0], [1.0, 9.0], [0.3, 4.0]];
/// Places of the break along them, as parts of their length.
const STUBS: [[f32; 2]; 4] = [[0.12, 0.7], [0.08, 0.6], [0.0, 0.5], [0.0, 0.0]];
/// Breakage in a storm relative to that of limbs: limbs, branches, twigs, shoots.
const STORM: [f32; 4] = [1.0, 0.5, 0.25, 0.15];
/// Years from which the top of a dead stem breaks, and in which it comes down to half of its height.
const TOP: [f32; 2] = [4.0, 40.0];
/// No stem is broken lower, metres.
const LOWEST: f32 = 2.2;
/// Thinner ends are not splintered, metres.
const SPLINTERED: f32 = 0.006;
/// Years after which bark begins to fall, and in which it is gone.
const BARK: [f32; 2] = [2.0, 22.0];
/// The size of patches of bark, metres.
const PATCH: f32 = 0.35;

/// A tree with radii, and how bare of bark it is at each node: 0 in bark, 1 bare wood.
#[derive(Debug, Default)]
pub(super) struct Timber {
    pub(super) wood: Wood,
    pub(super) radii: Vec<f32>,
    pub(super) bare: Vec<f32>,
}

impl Timber {
    pub(super) fn new(wood: Wood, radii: Vec<f32>) -> Self {
        let bare = vec![0.0; radii.len()];
        Self { wood, radii, bare }
    }

    fn push(&mut self, at: Vec3, parent: u32, order: u16, rank: Rank, radius: f32, bare: f32) -> u32 {
        self.radii.push(radius);
        self.bare.push(bare);
        self.wood.push(at, parent, order, rank)
    }

    /// The direction in which the wood reaches a node.
    fn direction(&self, node: usize) -> Vec3 {
        let parent = self.wood.parents[node] as usize;
        (self.wood.positions[node] - self.wood.positions[parent]).normalize_or(UP)
    }
}

/// Each node's axis, by its first node; how far along it is, and how long the axis is at that first node, metres.
struct Axes {
    start: Vec<usize>,
    along: Vec<f32>,
    length: Vec<f32>,
}

impl Axes {
    fn of(wood: &Wood) -> Self {
        let count = wood.positions.len();
        let mut axes = Self { start: vec![0; count], along: vec![0.0; count], length: vec![0.0; count] };
        for node in 1..count {
            let parent = wood.parents[node] as usize;
            let goes_on = wood.orders[node] == wood.orders[parent]
                && wood.ranks[node] == wood.ranks[parent]
                && parent > 0;
            let step = wood.positions[node].distance(wood.positions[parent]);
            (axes.start[node], axes.along[node]) =
                if goes_on { (axes.start[parent], axes.along[parent] + step) } else { (node, step) };
            let start = axes.start[node];
            axes.length[start] = axes.length[start].max(axes.along[node]);
        }
        axes
    }
}

/// Breaks what the plan says; gives the new number of each node, `u32::MAX` for nodes that are gone.
pub(super) fn wreck(timber: &mut Timber, plan: &Numbers, seed: u64) -> Vec<u32> {
    let draw = Draw::new(seed).child(50, 0);
    let count = timber.radii.len();
    let whole = |count: usize| (0..count as u32).collect::<Vec<_>>();
    if plan.dead.is_none() && plan.damage <= 0.0 {
        return whole(count);
    }
    let wood = &timber.wood;
    let axes = Axes::of(wood);
    let mut gone = vec![false; count];
    let mut broken = vec![false; count];
    for node in 1..count {
        let parent = wood.parents[node] as usize;
        let start = axes.start[node];
        let left = left(wood, plan, &draw, start, axes.length[start]);
        gone[node] = gone[parent] || axes.along[node] > left;
        // The end of a stub: where its own axis went on.
        let own = axes.start[parent] == start && parent >= start;
        broken[parent] |= gone[node] && !gone[parent] && own;
    }
    let mut number = vec![u32::MAX; count];
    let mut kept = Timber::default();
    for node in (0..count).filter(|&node| !gone[node]) {
        let parent = number[wood.parents[node] as usize];
        let parent = if node == 0 { 0 } else { parent };
        let bare = plan.dead.map_or(0.0, |years| bark_lost(wood.positions[node], years, seed));
        let (order, rank) = (wood.orders[node], wood.ranks[node]);
        number[node] = kept.push(wood.positions[node], parent, order, rank, timber.radii[node], bare);
    }
    for node in (0..count).filter(|&node| broken[node] && timber.radii[node] > SPLINTERED) {
        splinter(&mut kept, number[node], draw.child(2, node));
    }
    *timber = kept;
    number
}

/// Length of an axis that still stands, metres.
fn left(wood: &Wood, plan: &Numbers, draw: &Draw, start: usize, length: f32) -> f32 {
    let mut draw = draw.child(1, start);
    let (storm, where_, life, stub) = (draw.unit(), draw.unit(), draw.unit(), draw.unit());
    let rank = wood.ranks[start];
    if rank == Rank::Stem {
        let mut share = 1.0f32;
        if let Some(years) = plan.dead {
            share = 1.0 - 0.5 * ((years - TOP[0]) / TOP[1]).clamp(0.0, 1.3) * (0.5 + life);
        }
        // The top breaks in heavy storms only.
        if storm < 1.2 * (plan.damage - 0.5) {
            share = share.min(0.5 + 0.35 * where_);
        }
        return if share < 1.0 { (share * length).max(LOWEST) } else { f32::INFINITY };
    }
    let index = rank as usize - 1;
    let between = |[low, high]: [f32; 2], share: f32| low + (high - low) * share;
    let mut share = f32::INFINITY;
    // Higher up there is more wind.
    let exposed = 0.5 + 0.7 * (wood.positions[start].y / plan.height).clamp(0.0, 1.0);
    if storm < plan.damage * STORM[index] * exposed {
        share = between([0.06, 0.65], where_);
    }
    if let Some(years) = plan.dead {
        let life = between(LIVES[index], life);
        if years > life {
            // Stubs become shorter as time goes on.
            share = share.min(between(STUBS[index], stub) * (1.6 * life / years).min(1.0));
        }
    }
    share * length
}

/// Share of the bark that a dead tree has lost at a place, 0 to 1.
fn bark_lost(place: Vec3, years: f32, seed: u64) -> f32 {
    let lost = ((years - BARK[0]) / (BARK[1] - BARK[0])).clamp(0.0, 1.0);
    let cell = (place / Vec3::new(PATCH, 2.5 * PATCH, PATCH)).floor().as_ivec3();
    let key =
        cell.to_array().into_iter().fold(0u64, |key, at| key.wrapping_mul(0x1_0001) ^ (at as u32 as u64));
    let own = Draw::new(seed ^ key).child(51, 0).unit();
    ((lost - own) * 6.0 + 0.5).clamp(0.0, 1.0) * f32::from(lost > 0.0)
}

/// Splinters at a broken end.
fn splinter(timber: &mut Timber, node: u32, mut draw: Draw) {
    let end = node as usize;
    timber.bare[end] = 1.0;
    let (radius, order, rank) = (timber.radii[end], timber.wood.orders[end], timber.wood.ranks[end]);
    let direction = timber.direction(end);
    let at = timber.wood.positions[end];
    let (side, normal) = frame(direction, &mut draw);
    let start = draw.unit() * TAU;
    for i in 0..4 {
        let (sin, cos) = math::sin_cos(start + i as f32 * TAU / 4.0 + 0.5 * draw.normal());
        let outward = side * cos + normal * sin;
        let foot = at + outward * (0.5 * radius) + direction * (0.25 * radius);
        let length = radius * draw.within([1.6, 5.0]);
        let tip = foot + direction * length + outward * (0.12 * length);
        let low = timber.push(foot, node, order + 1, rank, 0.42 * radius, 1.0);
        timber.push(tip, low, order + 1, rank, 0.04 * radius, 1.0);
    }
}

/// Leaves of the nodes that are left.
pub(super) fn keep(leaves: &mut Leaves, number: &[u32]) {
    leaves.instances.retain(|leaf| number[leaf.node as usize] != u32::MAX);
    for leaf in &mut leaves.instances {
        leaf.node = number[leaf.node as usize];
    }
}

/// Leaves that a dead evergreen still has, brown; none if there are none.
pub(super) fn wither(leaves: Leaves, years: f32, seed: u64) -> Option<Leaves> {
    const HANG: f32 = 2.0;
    let Leaves { leaf, mut instances } = leaves;
    let draw = Draw::new(seed).child(52, 0);
    let mut index = 0;
    instances.retain(|_| {
        index += 1;
        draw.child(1, index).unit() > years / HANG
    });
    let brown = leaf.material().with_srgb([132, 78, 44]);
    for leaf in &mut instances {
        let light = leaf.tint.iter().fold(0.0f32, |most, tint| most.max(*tint));
        leaf.tint = [light; 3];
    }
    (!instances.is_empty()).then(|| Leaves { leaf: leaf.with_material(brown), instances })
}

/// Dead limbs between the ground and the crown, more of them the closer the neighbours are.
pub(super) fn dead_limbs(timber: &mut Timber, species: &Species, plan: &Numbers, seed: u64) {
    let [open, closed] = species.limbs.dead;
    let a_metre = open + (closed - open) * (1.5 * plan.crowding).min(1.0);
    let trunk: Vec<u32> = (1..timber.radii.len() as u32)
        .filter(|&node| {
            let node = node as usize;
            timber.wood.ranks[node] == Rank::Stem && timber.wood.orders[node] == 0
        })
        .collect();
    // The lowest have fallen long ago.
    let low = 0.25 * plan.crown_base;
    let count = (a_metre * (plan.crown_base - low)).min(400.0) as usize;
    let draw = Draw::new(seed).child(53, 0);
    for limb in 0..count {
        let mut draw = draw.child(1, limb);
        let mut height = low + (plan.crown_base - low) * draw.unit().sqrt();
        let spacing = species.limbs.whorl_spacing;
        if spacing > 0.0 {
            height = ((height / spacing).round() * spacing + 0.03 * draw.normal()).min(plan.crown_base);
        }
        let at = trunk.partition_point(|&node| timber.wood.at(node).y < height).min(trunk.len().max(1) - 1);
        let Some(&node) = trunk.get(at) else { continue };
        let thickest = timber.radii[node as usize];
        let share = (height / plan.crown_base).clamp(0.1, 1.0);
        let length = 0.5 * plan.crown_width * share * draw.within([0.25, 0.95]);
        let angle = (species.limbs.angle[0] + 12.0 * draw.unit()).to_radians();
        let ((sp, cp), (sa, ca)) = (math::sin_cos(angle), math::sin_cos(draw.unit() * TAU));
        let mut direction = Vec3::new(sp * ca, cp, sp * sa);
        let radius = (0.006 + 0.009 * length).min(0.35 * thickest);
        let (mut parent, mut place) = (node, timber.wood.at(node));
        let steps = (length / 0.25).ceil().clamp(2.0, 12.0);
        for step in 0..steps as usize {
            let t = (step as f32 + 1.0) / steps;
            let off = Vec3::new(draw.normal(), draw.normal() - 0.6, draw.normal()) * 0.06;
            direction = (direction + off).normalize_or(direction);
            place += direction * (length / steps);
            if place.y < 0.2 {
                break;
            }
            parent = timber.push(place, parent, 1, Rank::Limb, radius * (1.0 - 0.6 * t), 0.6);
            if draw.unit() < 0.3 {
                let (side, normal) = frame(direction, &mut draw);
                let (sin, cos) = math::sin_cos(draw.unit() * TAU);
                let way = (direction + side * cos + normal * (0.6 * sin)).normalize_or(side);
                let twig = length * draw.within([0.08, 0.3]);
                timber.push(place + way * twig, parent, 2, Rank::Branch, 0.25 * radius, 0.6);
            }
        }
    }
}
