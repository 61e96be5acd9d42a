//! Search for the internode that is nearest to a point.

use super::sway::part;
use glam::Vec3;

/// Internodes that share one box.
const LEAF: usize = 8;

/// A tree of boxes around internodes: each is halved at the middle of its longest side.
#[derive(Debug)]
pub(super) struct Internodes<'a> {
    ends: &'a [Vec3],
    parents: &'a [u32],
    radii: &'a [f32],
    /// Nodes in the order of the boxes.
    order: Vec<u32>,
    /// Low and high corners of the axes, and the greatest radius; the halves of box i are 2·i + 1 and 2·i + 2.
    boxes: Vec<(Vec3, Vec3, f32)>,
}

impl<'a> Internodes<'a> {
    /// O(n log n). The root is an internode of no length.
    pub(super) fn new(ends: &'a [Vec3], parents: &'a [u32], radii: &'a [f32]) -> Self {
        let leaves = ends.len().div_ceil(LEAF).next_power_of_two();
        let mut internodes = Self {
            ends,
            parents,
            radii,
            order: (0..ends.len() as u32).collect(),
            boxes: vec![(Vec3::INFINITY, Vec3::NEG_INFINITY, 0.0); 2 * leaves - 1],
        };
        let mut order = std::mem::take(&mut internodes.order);
        internodes.enclose(0, &mut order);
        internodes.order = order;
        internodes
    }

    fn middle(&self, node: u32) -> Vec3 {
        (self.ends[node as usize] + self.ends[self.parents[node as usize] as usize]) * 0.5
    }

    fn enclose(&mut self, number: usize, nodes: &mut [u32]) {
        let mut all = (Vec3::INFINITY, Vec3::NEG_INFINITY, 0.0f32);
        for &node in nodes.iter() {
            let [a, b] = [node, self.parents[node as usize]].map(|node| self.ends[node as usize]);
            all = (all.0.min(a).min(b), all.1.max(a).max(b), all.2.max(self.radii[node as usize]));
        }
        self.boxes[number] = all;
        if 2 * number + 2 < self.boxes.len() {
            let size = all.1 - all.0;
            let axis = if size.x >= size.y.max(size.z) { 0 } else { 1 + usize::from(size.z > size.y) };
            let half = nodes.len() / 2;
            if half > 0 {
                let key = |node: u32| self.middle(node)[axis];
                nodes.select_nth_unstable_by(half, |&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
            }
            let (low, high) = nodes.split_at_mut(half);
            self.enclose(2 * number + 1, low);
            self.enclose(2 * number + 2, high);
        }
    }

    /// The node of the internode whose surface is nearest, or in which the point is deepest; of those equally near the
    /// lowest. The root only if there is no other.
    pub(super) fn nearest(&self, point: Vec3) -> u32 {
        let mut best = (f32::INFINITY, 0);
        self.visit(0, 0..self.order.len(), point, &mut best);
        best.1
    }

    fn visit(&self, number: usize, range: std::ops::Range<usize>, point: Vec3, best: &mut (f32, u32)) {
        if self.bound(number, point) > best.0 {
            return;
        }
        if 2 * number + 2 < self.boxes.len() {
            let half = range.start + range.len() / 2;
            let mut halves = [(2 * number + 1, range.start..half), (2 * number + 2, half..range.end)];
            if self.bound(halves[1].0, point) < self.bound(halves[0].0, point) {
                halves.swap(0, 1);
            }
            for (number, range) in halves {
                self.visit(number, range, point, best);
            }
            return;
        }
        for &node in self.order[range].iter().filter(|&&node| node > 0) {
            let [from, to] = [self.parents[node as usize], node].map(|node| self.ends[node as usize]);
            let near = from.lerp(to, part(point, from, to));
            let outside = point.distance(near) - self.radii[node as usize];
            if (outside, node) < *best {
                *best = (outside, node);
            }
        }
    }

    /// Lower bound of a point's distance outside of all internodes in a box.
    fn bound(&self, number: usize, point: Vec3) -> f32 {
        let (low, high, radius) = self.boxes[number];
        // A little low, so that rounding hides nothing.
        point.clamp(low.min(high), high.max(low)).distance(point) * 0.999_999 - radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::skeletons;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_nearest_is_found(skeleton in skeletons(60), x in -12f32..12.0, y in -12f32..12.0, z in -12f32..12.0) {
            let parents: Vec<u32> =
                (0..skeleton.len()).map(|node| skeleton.parent(node).unwrap_or(0) as u32).collect();
            let (ends, radii) = (skeleton.positions(), skeleton.radii());
            let point = Vec3::new(x, y, z);
            let outside = |node: usize| {
                let (from, to) = (ends[parents[node] as usize], ends[node]);
                point.distance(from.lerp(to, part(point, from, to))) - radii[node]
            };
            let found = Internodes::new(ends, &parents, radii).nearest(point) as usize;
            let least = (1..skeleton.len()).map(outside).fold(f32::INFINITY, f32::min);
            prop_assert!(skeleton.len() == 1 && found == 0 || outside(found) <= least);
        }
    }
}
