//! A tree while it grows: nodes with their order and rank, and axes in it.

use super::draw::Draw;
use crate::math::{self, UP, perpendicular};
use glam::Vec3;

/// Rank of a node, from the stem to the shoots.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rank {
    #[default]
    Stem,
    Limb,
    Branch,
    Twig,
    Shoot,
}

#[derive(Debug, Default, Clone)]
pub(super) struct Wood {
    pub(super) positions: Vec<Vec3>,
    pub(super) parents: Vec<u32>,
    pub(super) orders: Vec<u16>,
    pub(super) ranks: Vec<Rank>,
}

impl Wood {
    pub(super) fn push(&mut self, position: Vec3, parent: u32, order: u16, rank: Rank) -> u32 {
        self.positions.push(position);
        self.parents.push(parent);
        self.orders.push(order);
        self.ranks.push(rank);
        self.positions.len() as u32 - 1
    }

    pub(super) fn at(&self, node: u32) -> Vec3 {
        self.positions[node as usize]
    }
}

/// An axis of the tree: its nodes, the base on the parent axis included.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    pub(super) nodes: Vec<u32>,
    pub(super) length: f32,
    pub(super) draw: Draw,
}

impl Axis {
    /// The node nearest to a part of its way, and the direction there.
    pub(super) fn station(&self, wood: &Wood, share: f32) -> (u32, Vec3) {
        let last = self.nodes.len() - 1;
        let index = ((share * last as f32).round() as usize).clamp(1.min(last), last);
        (self.nodes[index], self.direction(wood, index))
    }

    pub(super) fn direction(&self, wood: &Wood, index: usize) -> Vec3 {
        let before = self.nodes[index.saturating_sub(1)];
        let at = self.nodes[index];
        (wood.at(at) - wood.at(before)).normalize_or(UP)
    }
}

/// Settings for the growth of an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course {
    pub(super) base: u32,
    pub(super) direction: Vec3,
    pub(super) length: f32,
    pub(super) step: f32,
    pub(super) order: u16,
    pub(super) rank: Rank,
    /// Multiple of the up vector that is added to the direction over the whole way.
    pub(super) rise: f32,
    /// Radians per square root of a metre.
    pub(super) crooked: f32,
}

/// No branch comes nearer to the ground, metres.
const GROUND: f32 = 0.15;

impl Course {
    pub(super) fn grow(self, wood: &mut Wood, mut draw: Draw) -> Axis {
        let steps = (self.length / self.step).round().clamp(1.0, 200.0);
        let step = self.length / steps;
        let mut direction = self.direction;
        let (mut drift, mut nodes, mut at) = (Vec3::ZERO, vec![self.base], wood.at(self.base));
        let wander = self.crooked * step.sqrt();
        for _ in 0..steps as usize {
            drift = drift * 0.5 + Vec3::new(draw.normal(), draw.normal(), draw.normal()) * wander;
            direction = (direction + UP * (self.rise / steps) + drift).normalize_or(direction);
            let next = at + direction * step;
            if next.y < GROUND && direction.y < 0.0 && self.rank > Rank::Stem {
                break;
            }
            at = next;
            let parent = nodes.last().copied().unwrap_or(self.base);
            nodes.push(wood.push(at, parent, self.order, self.rank));
        }
        let length = step * (nodes.len() - 1) as f32;
        Axis { nodes, length, draw: draw.child(7, 0) }
    }
}

/// A level vector across a direction, and one across both.
pub(super) fn frame(direction: Vec3, draw: &mut Draw) -> (Vec3, Vec3) {
    let level = direction.cross(UP);
    let side = if level.length_squared() > 0.01 {
        level.normalize()
    } else {
        let any = perpendicular(direction);
        let (sin, cos) = math::sin_cos(draw.unit() * std::f32::consts::TAU);
        any * cos + direction.cross(any) * sin
    };
    (side, side.cross(direction).normalize_or(UP))
}
