//! A tree as it grows, what stands along its axes, and the shoots that end them.

use super::data::{Species, Stand};
use super::draw::Draw;
use super::outline::Outline;
use super::wood::{Axis, Course, Rank, Wood, frame};
use crate::math;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// The golden angle.
pub(super) const GOLDEN: f32 = 2.399_963_2;
/// Most nodes of a tree.
pub(super) const MOST_NODES: usize = 3_000_000;

/// A tree as it grows.
pub(super) struct Growing<'a> {
    pub(super) species: &'a Species,
    /// Factor on the distance of laterals in the tables: huge trees keep fewer.
    pub(super) coarse: f32,
    pub(super) outline: Outline,
    pub(super) density: f32,
    pub(super) wood: Wood,
}

/// One stem: an axis, where its limbs begin, and where it ends.
pub(super) struct Stem {
    pub(super) axis: Axis,
    pub(super) base: f32,
    /// The height up to which it bears limbs.
    pub(super) end: f32,
    pub(super) order: u16,
}

impl Growing<'_> {
    pub(super) fn shoots(&mut self, axis: &Axis, bare: f32) {
        let shoots = &self.species.shoots;
        let mut number = 0;
        let angle = shoots.angle.to_radians();
        let spacing = shoots.spacing / self.density;
        self.stations(axis, shoots.stand, spacing, bare, |this, node, direction, outward, _| {
            let mut draw = axis.draw.child(20, number);
            number += 1;
            let (sin, cos) = math::sin_cos(angle + 0.2 * draw.normal());
            this.shoot(node, direction * cos + outward * sin, draw);
        });
    }

    /// Calls `add(node, direction, outward, share of the way)` for each lateral along an axis.
    pub(super) fn stations(
        &mut self,
        axis: &Axis,
        stand: Stand,
        spacing: f32,
        bare: f32,
        mut add: impl FnMut(&mut Self, u32, Vec3, Vec3, f32),
    ) {
        if self.wood.positions.len() > MOST_NODES {
            return;
        }
        let mut draw = axis.draw.child(15, 0);
        let spacing = spacing * self.coarse;
        let flat = match axis.nodes.last().map(|&node| self.wood.ranks[node as usize]) {
            Some(Rank::Limb) => self.species.branches.flat,
            _ => self.species.twigs.flat,
        };
        let start = draw.unit() * TAU;
        let mut at = axis.length * bare + spacing * draw.unit();
        let mut station = 0;
        while at < axis.length * 0.995 && self.wood.positions.len() <= MOST_NODES {
            let share = at / axis.length;
            let (node, direction) = axis.station(&self.wood, share);
            let (side, normal) = frame(direction, &mut draw);
            let turn = station as f32;
            let (count, first, apart, flat) = match stand {
                Stand::Spiral => (1, start + turn * GOLDEN, 0.0, flat),
                Stand::TwoRanked => (1, turn * PI, 0.0, flat.max(0.8)),
                Stand::Decussate => (2, start + turn * PI / 2.0, PI, flat),
                Stand::Paired => (2, 0.0, PI, flat.max(0.8)),
                Stand::Whorled => (4, start + turn * 1.1, PI / 2.0, flat),
            };
            for i in 0..count {
                let around = first + apart * i as f32 + 0.35 * draw.normal();
                let (sin, cos) = math::sin_cos(around);
                let outward = (side * cos + normal * sin * (1.0 - flat)).normalize_or(side);
                add(self, node, direction, outward, share);
            }
            station += 1;
            at += spacing * draw.within([0.6, 1.4]) * if count > 2 { 3.0 } else { count as f32 };
        }
    }

    /// The shoot that an axis goes on in.
    pub(super) fn end_shoot(&mut self, axis: &Axis, order: u16) {
        let last = axis.nodes.len() - 1;
        let direction = axis.direction(&self.wood, last);
        let mut draw = axis.draw.child(21, 0);
        let length = self.species.shoots.length * draw.factor(self.species.shoots.length_spread * 0.6);
        self.extend(axis.nodes[last], direction, length, order, draw);
    }

    pub(super) fn shoot(&mut self, node: u32, direction: Vec3, mut draw: Draw) {
        let shoots = &self.species.shoots;
        let length = if draw.unit() < shoots.short {
            shoots.short_length * draw.factor(0.35)
        } else {
            shoots.length * draw.factor(shoots.length_spread).min(4.0)
        };
        let order = self.wood.orders[node as usize] + 1;
        self.extend(node, direction.normalize_or(Vec3::Y), length, order, draw);
    }

    fn extend(&mut self, node: u32, direction: Vec3, length: f32, order: u16, draw: Draw) {
        let shoots = &self.species.shoots;
        let step = if length > 0.25 {
            0.12
        } else if length > 0.06 {
            length * 0.5
        } else {
            length
        };
        let course = Course {
            base: node,
            direction,
            length,
            step,
            order,
            rank: Rank::Shoot,
            rise: shoots.rise,
            crooked: 0.25,
        };
        course.grow(&mut self.wood, draw);
    }
}
