//! Rays through the octree, front to back, and the roots they find.

use super::octree::{Cube, Leaf, Node, Octree};
use crate::surface::solid::{Part, Solid};
use crate::surface::span::Passage;
use glam::{BVec3, Vec3};
use std::ops::ControlFlow;

/// Steps of regula falsi at a root, at most.
const REFINEMENTS: usize = 12;

/// Steps through a leaf, at most about: more than its tolerance asks for where it is as small as its detail, and some
/// hundredths of a pixel where it is as large as a pixel.
const MOST_STEPS: f32 = 128.0;

/// A piece of a straight line: the points `origin + way * t` for t from `from` to `to`.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Ray {
    pub(in super::super) origin: Vec3,
    /// Of length 1.
    pub(in super::super) way: Vec3,
    pub(in super::super) from: f32,
    pub(in super::super) to: f32,
}

/// Point where a ray enters or leaves the solid.
pub(super) struct Crossing<'a, P> {
    /// Metres along the ray, on the outer side of the surface.
    pub(super) t: f32,
    /// The leaf it lies in; none if the ray starts within.
    pub(super) leaf: Option<(&'a Leaf<P>, Cube)>,
}

impl<P: Part> Crossing<'_, P> {
    /// The point, and the normal of the surface there; against the ray where the surface has none.
    pub(super) fn place(&self, ray: &Ray) -> (Vec3, Vec3) {
        let point = ray.origin + ray.way * self.t;
        let Some((leaf, cube)) = self.leaf else { return (point, -ray.way) };
        let bounds = cube.bounds();
        let point = point.clamp(bounds.min, bounds.max);
        (point, -leaf.part.gradient(point).1.normalize_or(ray.way))
    }
}

/// All rays within `radius + spread · t` metres of one.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Beam {
    pub(in super::super) ray: Ray,
    pub(in super::super) radius: f32,
    pub(in super::super) spread: f32,
}

/// A cube to be walked through.
pub(super) struct Entry<'o, P> {
    pub(super) node: &'o Node<P>,
    pub(super) cube: Cube,
}

impl<P> Clone for Entry<'_, P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<P> Copy for Entry<'_, P> {}

/// A ray on its way.
struct Walk<'a, 'o, S: Solid, V> {
    octree: &'o Octree<'a, S>,
    ray: &'o Ray,
    inverse: Vec3,
    /// The bits of the axes along which the ray goes backwards.
    mirror: usize,
    /// `true` if the ray is within the solid.
    inside: bool,
    last: Option<(&'o Leaf<S::Part>, Cube)>,
    visit: V,
}

impl Ray {
    /// The bits of the axes along which it goes backwards.
    pub(super) fn mirror(&self) -> usize {
        (0..3).filter(|&axis| self.way[axis].is_sign_negative()).fold(0, |bits, axis| bits | 1 << axis)
    }
}

impl<S: Solid> Octree<'_, S> {
    pub(super) fn whole(&self) -> [Entry<'_, S::Part>; 1] {
        [Entry { node: &self.root, cube: self.cube }]
    }

    /// Visits every crossing of a ray with the surface in some cubes, in their order, until told to stop.
    pub(super) fn crossings<'o>(
        &'o self,
        among: &[Entry<'o, S::Part>],
        ray: &'o Ray,
        visit: impl FnMut(Crossing<'o, S::Part>) -> ControlFlow<()>,
    ) {
        // No axis is quite parallel: then no product below is one of zero and infinity.
        let way = ray.way.to_array().map(|x| if x.abs() < 1e-18 { 1e-18f32.copysign(x) } else { x });
        let inverse = Vec3::from_array(way.map(|x| 1.0 / x));
        let mirror = ray.mirror();
        let mut walk = Walk { octree: self, ray, inverse, mirror, inside: false, last: None, visit };
        for entry in among {
            let bounds = entry.cube.bounds();
            let (low, high) = ((bounds.min - ray.origin) * inverse, (bounds.max - ray.origin) * inverse);
            if walk.node(entry.node, entry.cube, low.min(high), low.max(high)).is_break() {
                break;
            }
        }
    }

    /// Adds the cubes in which a beam may meet the surface, front to back for all rays that go as `mirror` says: leaves,
    /// and cubes that are smaller than `part` of the beam's width there.
    pub(super) fn gather<'o>(
        &'o self,
        Entry { node, cube }: Entry<'o, S::Part>,
        beam: &Beam,
        mirror: usize,
        part: f32,
        near: &mut Vec<Entry<'o, S::Part>>,
    ) {
        if matches!(node, Node::Outside) {
            return;
        }
        let Beam { ray, radius, spread } = beam;
        // The ball around the cube, as far from the ray as its middle.
        let ball = 0.867 * cube.side;
        let offset = cube.middle() - ray.origin;
        let along = offset.dot(ray.way);
        let width = radius + spread * (along + ball).max(0.0);
        let reach = ball + width;
        let away = (offset - ray.way * along).length_squared();
        if along + reach < ray.from || along - reach > ray.to || away > reach * reach {
            return;
        }
        let Node::Inner(inner) = node else { return near.push(Entry { node, cube }) };
        if cube.side < part * width {
            return near.push(Entry { node, cube });
        }
        let children = self.children(inner, cube);
        for i in 0..8 {
            // Bits of `i` count along the ray: a cube comes after those whose bits it has.
            let index = i ^ mirror;
            let child = Entry { node: &children[index], cube: cube.child(index) };
            self.gather(child, beam, mirror, part, near);
        }
    }
}

impl<'o, S: Solid, V: FnMut(Crossing<'o, S::Part>) -> ControlFlow<()>> Walk<'_, 'o, S, V> {
    /// Goes through a cube that the ray enters at the largest of `low` and leaves at the smallest of `high`.
    fn node(&mut self, node: &'o Node<S::Part>, cube: Cube, low: Vec3, high: Vec3) -> ControlFlow<()> {
        let enter = low.max_element().max(self.ray.from);
        let leave = high.min_element().min(self.ray.to);
        // A NaN cannot be: coordinates are finite.
        if enter > leave {
            return ControlFlow::Continue(());
        }
        match node {
            Node::Outside => self.uniform(enter, false),
            Node::Inside => self.uniform(enter, true),
            Node::Leaf(leaf) => self.leaf(leaf, cube, enter, leave),
            Node::Inner(inner) => {
                let middle = (cube.middle() - self.ray.origin) * self.inverse;
                let children = self.octree.children(inner, cube);
                // Behind which of the middle planes the ray is; first, where it enters.
                let mut behind = middle.cmple(Vec3::splat(enter)).bitmask() as usize;
                loop {
                    let index = behind ^ self.mirror;
                    let far = BVec3::new(behind & 1 != 0, behind & 2 != 0, behind & 4 != 0);
                    let end = Vec3::select(far, high, middle);
                    if self.inside || !matches!(children[index], Node::Outside) {
                        let start = Vec3::select(far, middle, low);
                        self.node(&children[index], cube.child(index), start, end)?;
                    }
                    // On through the nearest plane, unless it is one of the cube's sides.
                    let next = 1 << end.min_position();
                    if behind & next != 0 || end.min_element() > leave {
                        return ControlFlow::Continue(());
                    }
                    behind |= next;
                }
            }
        }
    }

    /// In a cube that is all inside or all outside, which the last one may have ended just short of.
    fn uniform(&mut self, enter: f32, inside: bool) -> ControlFlow<()> {
        if inside == self.inside { ControlFlow::Continue(()) } else { self.cross(enter) }
    }

    fn cross(&mut self, t: f32) -> ControlFlow<()> {
        self.inside = !self.inside;
        (self.visit)(Crossing { t, leaf: self.last })
    }

    fn leaf(&mut self, leaf: &'o Leaf<S::Part>, cube: Cube, enter: f32, leave: f32) -> ControlFlow<()> {
        let bounds = cube.bounds();
        let value = |t: f32| {
            let point = self.ray.origin + self.ray.way * t;
            leaf.part.value(point.clamp(bounds.min, bounds.max))
        };
        let last = Some((leaf, cube));
        // For the passage, and then for each value.
        if !self.octree.works(leaf.crowd) {
            return ControlFlow::Break(());
        }
        // Only from what is felt first to what is felt last; but a way out may be anywhere.
        let exit = leave;
        let (enter, leave) = if self.inside {
            (enter, exit)
        } else {
            let origin = self.ray.origin + self.ray.way * enter;
            let passage = Passage { origin, way: self.ray.way, length: leave - enter };
            let Some((low, high)) = leaf.part.span(&passage) else {
                self.last = last;
                return ControlFlow::Continue(());
            };
            (enter + low, enter + high)
        };
        // No finer than 32-bit floats can tell apart, and not too many steps where the bound is far
        // above the actual slopes.
        let tolerance = leaf.tolerance.max(enter.abs().max(leave.abs()) * 4e-7);
        let least = tolerance.max((leave - enter) / MOST_STEPS);
        let inverse = 1.0 / leaf.lipschitz;
        let (mut t, mut here) = (enter, value(enter));
        let mut before = None;
        loop {
            if (here >= 0.0) != self.inside {
                let t =
                    before.map_or(t, |before| root(before, (t, here), 0.1 * tolerance, value, self.inside));
                self.last = last;
                self.cross(t)?;
            }
            let end = if self.inside { exit } else { leave };
            if t >= end {
                break;
            }
            before = Some((t, here));
            // No root is nearer than that.
            let step = here.abs() * inverse;
            if step > end - t {
                break;
            }
            t = if step >= least { t + step } else { (t + least).min(end) };
            if !self.octree.works(leaf.crowd) {
                return ControlFlow::Break(());
            }
            here = value(t);
        }
        self.last = last;
        ControlFlow::Continue(())
    }
}

/// Between two places of which one is inside, the root to within `tolerance` and on the outer side.
/// Regula falsi that keeps off both ends, so that neither stays where it is for long.
fn root(
    mut a: (f32, f32),
    mut b: (f32, f32),
    tolerance: f32,
    value: impl Fn(f32) -> f32,
    a_inside: bool,
) -> f32 {
    for _ in 0..REFINEMENTS {
        if (b.0 - a.0).abs() <= tolerance {
            break;
        }
        let share = a.1 / (a.1 - b.1);
        let share = if share.is_finite() { share.clamp(0.1, 0.9) } else { 0.5 };
        let t = a.0 + (b.0 - a.0) * share;
        let here = value(t);
        if (here >= 0.0) == a_inside {
            a = (t, here);
        } else {
            b = (t, here);
        }
    }
    if a_inside { b.0 } else { a.0 }
}
