//! Strokes joined to one tree.

use super::stroke::{Course, Stroke};
use crate::math::{Rotation, angle_between, perpendicular, sin_cos};
use crate::parameter::ParameterError;
use crate::skeleton::{Skeleton, SkeletonError};
use glam::Vec3;
use std::collections::BTreeSet;

/// The tree so far. Parents need not come before their children: internodes are split.
#[derive(Debug)]
pub(super) struct Joined {
    positions: Vec<Vec3>,
    /// The root's is itself.
    parents: Vec<usize>,
    children: Vec<u32>,
    radii: Vec<f32>,
    orders: Vec<u16>,
    /// The stroke that each node belongs to.
    strokes: Vec<usize>,
    /// Laterals of each stroke so far.
    laterals: Vec<u32>,
    /// The bits of all positions: no two nodes lie in one place.
    taken: BTreeSet<[u32; 3]>,
    detail: f32,
    angle: f32,
    depth: f32,
}

/// Possible start of a stroke: on the internode of a node, at a share of the way from its parent.
#[derive(Debug, Clone, Copy)]
struct Place {
    node: usize,
    share: f32,
    gap: f32,
}

/// A stroke on its way into the tree.
struct Limb<'a> {
    stroke: &'a Stroke,
    number: usize,
    order: u16,
    /// Offset of its plane in metres (`shift`), and its distance from that plane per metre of its
    /// way (`lean`).
    shift: Vec3,
    lean: Vec3,
}

/// Distances in parts of the detail: a stroke starts at a node within `SAME`, and divides an
/// internode within `ON`; from farther away it starts at a node within `AT_NODE` of the nearest
/// place.
const SAME: f32 = 1e-5;
const ON: f32 = 0.05;
const AT_NODE: f32 = 0.1;
/// The golden ratio's share of a turn spreads laterals evenly in front of the plane and behind it, however many.
const GOLDEN: f32 = 0.618_034;

impl Joined {
    pub(super) fn new(detail: f32, angle: f32, depth: f32) -> Self {
        Self {
            positions: Vec::new(),
            parents: Vec::new(),
            children: Vec::new(),
            radii: Vec::new(),
            orders: Vec::new(),
            strokes: Vec::new(),
            laterals: Vec::new(),
            taken: BTreeSet::new(),
            detail,
            angle,
            depth,
        }
    }

    /// One more stroke, which errors call `name`.
    pub(super) fn add(&mut self, stroke: &Stroke, course: &Course, name: &str) -> Result<(), ParameterError> {
        let number = self.laterals.len();
        self.laterals.push(0);
        let mut limb = Limb { stroke, number, order: 0, shift: Vec3::ZERO, lean: Vec3::ZERO };
        let start = course.points[0];
        if self.positions.is_empty() {
            self.push(start, None, &limb, 0.0);
            return self.follow(&limb, course, 1, 0, 0.0, name);
        }
        let place = self.nearest(start, course.normal);
        let flat = |way: Vec3| course.normal.map_or(way, |normal| way - normal * way.dot(normal));
        let is_on = place.gap <= ON * self.detail;
        let base = if is_on {
            self.divide(place, |at| flat(start) + (at - flat(at)))
        } else if place.gap <= self.detail {
            self.node_near(place)
        } else {
            self.further_down(place.node, start, flat)
        };
        let is_tip = self.children[base] == 0;
        limb.order = self.orders[base].saturating_add(u16::from(!is_tip));
        limb.shift = (self.positions[base] - start) - flat(self.positions[base] - start);
        if let (Some(normal), false) = (course.normal, is_tip) {
            let parent = self.strokes[base];
            self.laterals[parent] += 1;
            let turns = GOLDEN * self.laterals[parent] as f32 + 0.25;
            let (sin, cos) = sin_cos(self.depth * (2.0 * (turns - turns.floor()) - 1.0));
            limb.lean = normal * (sin / cos);
        }
        if is_on {
            return self.follow(&limb, course, 1, base, 0.0, name);
        }
        let (mut before, mut from, mut way) = (base, self.positions[base], 0.0);
        for point in self.connection(base, start + limb.shift, course) {
            way += point.distance(from);
            from = point;
            before = self.push_if_free(point + limb.lean * way, before, &limb, 0.0);
        }
        way += from.distance(start + limb.shift);
        self.follow(&limb, course, 0, before, way, name)
    }

    /// Adds the points of a stroke from one of them on, `way` metres off the parent branch.
    fn follow(
        &mut self,
        limb: &Limb<'_>,
        course: &Course,
        first: usize,
        base: usize,
        mut way: f32,
        name: &str,
    ) -> Result<(), ParameterError> {
        let points = &course.points;
        let length: f32 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        let (mut before, mut done) = (base, 0.0);
        for i in first..points.len() {
            if i > 0 {
                done += points[i].distance(points[i - 1]);
                way += points[i].distance(points[i - 1]);
            }
            let place = points[i] + limb.shift + limb.lean * way;
            if let Some(number) = course.given[i] {
                let name = format!("{name}.points[{number}]");
                let range = "at a place of its own: the tree has a node there";
                ParameterError::unless(!self.taken.contains(&bits(place)), &name, points[i], range)?;
            }
            before = self.push_if_free(place, before, limb, done / length);
        }
        Ok(())
    }

    /// The new node, or the parent where there is a node already.
    fn push_if_free(&mut self, place: Vec3, parent: usize, limb: &Limb<'_>, share: f32) -> usize {
        if self.taken.contains(&bits(place)) {
            return parent;
        }
        self.push(place, Some(parent), limb, share)
    }

    fn push(&mut self, place: Vec3, parent: Option<usize>, limb: &Limb<'_>, share: f32) -> usize {
        let node = self.positions.len();
        self.taken.insert(bits(place));
        self.positions.push(place);
        self.parents.push(parent.unwrap_or(node));
        if let Some(parent) = parent {
            self.children[parent] += 1;
        }
        self.children.push(0);
        self.radii.push(limb.stroke.radius(share));
        self.orders.push(limb.order);
        self.strokes.push(limb.number);
        node
    }

    /// The nearest place of the tree, as seen along `normal` if there is one.
    fn nearest(&self, point: Vec3, normal: Option<Vec3>) -> Place {
        let seen = |way: Vec3| normal.map_or(way, |normal| way - normal * way.dot(normal));
        let mut best = Place { node: 0, share: 1.0, gap: f32::INFINITY };
        for node in 1..self.positions.len() {
            let from = self.positions[self.parents[node]];
            let (internode, way) = (seen(self.positions[node] - from), seen(point - from));
            let length = internode.length_squared();
            let share = if length > 0.0 { (way.dot(internode) / length).clamp(0.0, 1.0) } else { 0.0 };
            let gap = (way - internode * share).length();
            if gap < best.gap {
                best = Place { node, share, gap };
            }
        }
        best
    }

    /// A node in the middle of an internode, at the place that `place` makes of the internode's; an end of it where
    /// that is as good.
    fn divide(&mut self, at: Place, place: impl Fn(Vec3) -> Vec3) -> usize {
        let (node, parent) = (at.node, self.parents[at.node]);
        let point = place(self.positions[parent].lerp(self.positions[node], at.share));
        for end in [parent, node] {
            if self.positions[end].distance(point) <= SAME * self.detail {
                return end;
            }
        }
        let new = self.positions.len();
        self.taken.insert(bits(point));
        self.positions.push(point);
        self.parents.push(parent);
        self.parents[node] = new;
        self.children.push(1);
        self.radii.push(self.radii[node]);
        self.orders.push(self.orders[node]);
        self.strokes.push(self.strokes[node]);
        new
    }

    /// A node at about a place.
    fn node_near(&mut self, at: Place) -> usize {
        let (node, parent) = (at.node, self.parents[at.node]);
        let near = AT_NODE * self.detail;
        let length = self.positions[node].distance(self.positions[parent]);
        match at.share * length {
            from_base if from_base <= near => parent,
            from_base if length - from_base <= near => node,
            _ => self.divide(at, |point| point),
        }
    }

    /// The node of a branch, at `node` or below it, from which the way to `point` is at the natural angle.
    fn further_down(&self, node: usize, point: Vec3, flat: impl Fn(Vec3) -> Vec3) -> usize {
        let mut base = node;
        while base != 0 && self.strokes[self.parents[base]] == self.strokes[base] {
            let direction = flat(self.positions[base] - self.positions[self.parents[base]]);
            if angle_between(direction, flat(point - self.positions[base])) <= self.angle {
                break;
            }
            base = self.parents[base];
        }
        base
    }

    /// Points between a node of the tree and the first of a stroke, on a Hermite curve that leaves the parent branch at
    /// the natural angle at most.
    fn connection(&self, base: usize, start: Vec3, course: &Course) -> Vec<Vec3> {
        let from = self.positions[base];
        let way = start - from;
        let length = way.length();
        let before = self.parents[base];
        let parent = (from - self.positions[before]).normalize_or(way.normalize_or(Vec3::Y));
        let leaves = if angle_between(parent, way) > self.angle {
            let axis = parent.cross(way).normalize_or(perpendicular(parent));
            Rotation::new(self.angle).about(axis, parent)
        } else {
            way.normalize_or(parent)
        };
        let arrives = (course.points[1] - course.points[0]).normalize_or(leaves);
        let parts = (1.2 * length / self.detail).ceil().clamp(1.0, 1e6) as u32;
        let point = |part: u32| {
            let t = part as f32 / parts as f32;
            let (s, rest) = (t * t * (3.0 - 2.0 * t), 1.0 - t);
            from + way * s + (leaves * (t * rest * rest) - arrives * (t * t * rest)) * length
        };
        (1..parts).map(point).collect()
    }

    /// All nodes, each after its parent.
    pub(super) fn skeleton(self) -> Result<Skeleton, ParameterError> {
        let nodes = self.positions.len();
        let mut children = vec![Vec::new(); nodes];
        for node in (1..nodes).rev() {
            children[self.parents[node]].push(node);
        }
        let mut sorted = Vec::with_capacity(nodes);
        let mut open = vec![0];
        while let Some(node) = open.pop() {
            sorted.push(node);
            open.append(&mut children[node]);
        }
        let mut new = vec![0u32; nodes];
        for (place, &node) in (0u32..).zip(&sorted) {
            new[node] = place;
        }
        let orders: Vec<u16> = sorted.iter().map(|&node| self.orders[node]).collect();
        let build = || -> Result<Skeleton, SkeletonError> {
            Skeleton::new(
                sorted.iter().map(|&node| self.positions[node]).collect(),
                sorted.iter().map(|&node| (node != 0).then(|| new[self.parents[node]])).collect(),
            )?
            .with_stages(orders.clone())?
            .with_radii(sorted.iter().map(|&node| self.radii[node]).collect())?
            .with_orders(orders.clone())
        };
        build().map_err(|error| ParameterError::new("DrawnLimbs.strokes", nodes, error.to_string()))
    }
}

/// One key per place; plus zero, so that -0 is 0.
fn bits(place: Vec3) -> [u32; 3] {
    (place + Vec3::ZERO).to_array().map(f32::to_bits)
}
