//! Triangles in a tree of boxes, and the first that a ray meets.

use glam::Vec3;

/// Triangles that share one box.
const LEAF: usize = 4;

/// A box, and either its two halves or some triangles.
#[derive(Debug, Clone, Copy)]
struct Node {
    low: Vec3,
    high: Vec3,
    /// The first triangle, or the number of the second half; the first half follows its parent.
    at: u32,
    /// Triangles; 0 where there are halves.
    count: u32,
}

/// A ray with a length.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    pub(super) start: Vec3,
    pub(super) direction: Vec3,
    pub(super) reach: f32,
}

/// Triangles with their numbers.
#[derive(Debug)]
pub(super) struct Bvh {
    nodes: Vec<Node>,
    /// A corner and two edges.
    triangles: Vec<[Vec3; 3]>,
    numbers: Vec<u32>,
}

impl Bvh {
    /// O(n log n); there may be no triangle.
    pub(super) fn new(corners: &[[Vec3; 3]]) -> Self {
        let middles: Vec<Vec3> = corners.iter().map(|&[a, b, c]| (a + b + c) / 3.0).collect();
        let mut numbers: Vec<u32> = (0..corners.len() as u32).collect();
        let mut nodes = Vec::with_capacity(corners.len());
        // Ranges to be enclosed, each with the parent whose second half it is.
        let mut stack = vec![(0, corners.len(), u32::MAX)];
        while let Some((start, end, parent)) = stack.pop() {
            let number = nodes.len() as u32;
            if let Some(parent) = nodes.get_mut(parent as usize) {
                let parent: &mut Node = parent;
                parent.at = number;
            }
            let own = &mut numbers[start..end];
            let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            let (mut first, mut last) = (low, high);
            for &triangle in own.iter() {
                for corner in corners[triangle as usize] {
                    (low, high) = (low.min(corner), high.max(corner));
                }
                let middle = middles[triangle as usize];
                (first, last) = (first.min(middle), last.max(middle));
            }
            if end - start <= LEAF {
                nodes.push(Node { low, high, at: start as u32, count: (end - start) as u32 });
                continue;
            }
            nodes.push(Node { low, high, at: 0, count: 0 });
            let size = last - first;
            let axis = if size.x >= size.y.max(size.z) { 0 } else { 1 + usize::from(size.z > size.y) };
            let half = own.len() / 2;
            let key = |triangle: u32| middles[triangle as usize][axis];
            own.select_nth_unstable_by(half, |&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
            stack.push((start + half, end, number));
            stack.push((start, start + half, u32::MAX));
        }
        let triangles = numbers.iter().map(|&triangle| {
            let [a, b, c] = corners[triangle as usize];
            [a, b - a, c - a]
        });
        Self { nodes, triangles: triangles.collect(), numbers }
    }

    /// The triangles that rays within `radius` of this one may meet, as places for [`first_of`](Self::first_of).
    pub(super) fn around(&self, ray: &Ray, radius: f32, found: &mut Vec<u32>) {
        found.clear();
        let inverse = ray.direction.recip();
        let mut stack = [0_u32; 64];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let number = stack[depth];
            let node = &self.nodes[number as usize];
            let a = (node.low - radius - ray.start) * inverse;
            let b = (node.high + radius - ray.start) * inverse;
            // NaN, 0 · ∞ on a face, bounds nothing.
            let near = a.x.min(b.x).max(a.y.min(b.y)).max(a.z.min(b.z)).max(0.0);
            let far = a.x.max(b.x).min(a.y.max(b.y)).min(a.z.max(b.z)).min(ray.reach);
            if near > far * 1.000_001 {
                continue;
            }
            if node.count > 0 {
                found.extend(node.at..node.at + node.count);
            } else if node.at > 0 {
                // Halves keep the depth below 64.
                stack[depth] = number + 1;
                stack[depth + 1] = node.at;
                depth += 2;
            }
        }
    }

    /// Distance at which the ray first meets one of these triangles, and the triangle's number; of several at
    /// one distance the lowest number.
    pub(super) fn first_of(&self, ray: &Ray, places: &[u32]) -> Option<(f32, u32)> {
        let mut best: Option<(f32, u32)> = None;
        for &place in places {
            let Some(distance) = meet(ray, &self.triangles[place as usize]) else { continue };
            let number = self.numbers[place as usize];
            if best.is_none_or(|best| distance < best.0 || (distance <= best.0 && number < best.1)) {
                best = Some((distance, number));
            }
        }
        best
    }
}

/// Möller and Trumbore 1997, "Fast, minimum storage ray-triangle intersection", from both sides.
fn meet(ray: &Ray, &[corner, first, second]: &[Vec3; 3]) -> Option<f32> {
    let across = ray.direction.cross(second);
    let volume = first.dot(across);
    if volume == 0.0 {
        return None;
    }
    let from = ray.start - corner;
    let u = from.dot(across) / volume;
    let turned = from.cross(first);
    let v = ray.direction.dot(turned) / volume;
    let distance = second.dot(turned) / volume;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0 && distance <= ray.reach).then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn equals_brute_force(
            corners in prop::collection::vec(prop::array::uniform9(-3.0_f32..3.0), 0..60),
            rays in prop::collection::vec(prop::array::uniform6(-4.0_f32..4.0), 1..20),
        ) {
            let corners: Vec<[Vec3; 3]> = corners
                .iter()
                .map(|c| [0, 3, 6].map(|at| Vec3::new(c[at], c[at + 1], c[at + 2])))
                .collect();
            let bvh = Bvh::new(&corners);
            for [x, y, z, u, v, w] in rays {
                let direction = Vec3::new(u, v, w).normalize_or(Vec3::Y);
                let ray = Ray { start: Vec3::new(x, y, z), direction, reach: 20.0 };
                let all = corners.iter().enumerate().filter_map(|(i, &[a, b, c])| {
                    Some((meet(&ray, &[a, b - a, c - a])?, i as u32))
                });
                let wanted = all.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                let mut found = Vec::new();
                bvh.around(&ray, 0.0, &mut found);
                prop_assert_eq!(bvh.first_of(&ray, &found), wanted);
                // A ray beside this one, within a radius that reaches it everywhere.
                let beside = Ray { start: ray.start + Vec3::splat(0.05), ..ray };
                bvh.around(&beside, 0.1, &mut found);
                prop_assert_eq!(bvh.first_of(&ray, &found), wanted);
            }
        }
    }
}
