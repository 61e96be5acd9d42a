//! Winding number of a surface around a point.
//!
//! Jacobson and others 2013, "Robust inside-outside segmentation using generalized winding numbers"; the hierarchy
//! after Barill and others 2018, "Fast winding numbers for soups and clouds".

use std::f32::consts::PI;

use glam::Vec3;

use crate::math::atan2;

/// Triangles of a leaf, at most.
const LEAF: usize = 8;

/// A node farther away than this many of its radii counts as one small surface. Summed over all such nodes
/// the error is up to 0.023 in the Stanford bunny; what matters is that it is far below a half.
const FAR: f32 = 3.0;

/// Triangles in a hierarchy of balls.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Winding {
    /// Triangles in the order of the leaves.
    triangles: Vec<[Vec3; 3]>,
    /// A node, its first half, its second half; the root first.
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Node {
    center: Vec3,
    radius: f32,
    /// The sum of area times normal of its triangles.
    pole: Vec3,
    start: u32,
    end: u32,
    /// The second half; 0 for a leaf.
    second: u32,
}

impl Winding {
    /// O(n log n); all triangles have an area and finite corners.
    pub(super) fn new(mut triangles: Vec<[Vec3; 3]>) -> Self {
        let mut nodes = Vec::with_capacity(2 * triangles.len() / LEAF + 1);
        let end = triangles.len();
        if end > 0 {
            build(&mut triangles, 0, end, &mut nodes);
        }
        Self { triangles, nodes }
    }

    pub(super) fn triangles(&self) -> &[[Vec3; 3]] {
        &self.triangles
    }

    /// 1 inside of a closed surface whose triangles are counter-clockwise seen from outside, 0 outside; between them
    /// near holes. About O(log n).
    pub(super) fn number(&self, point: Vec3) -> f32 {
        let mut sum = 0.0;
        // Halves are of equal size, so that no more than a node for each level waits.
        let mut waiting = [0_u32; 40];
        let mut left = usize::from(!self.nodes.is_empty());
        while left > 0 {
            left -= 1;
            let at = waiting[left];
            let node = &self.nodes[at as usize];
            let way = node.center - point;
            let square = way.length_squared();
            if square > FAR * FAR * node.radius * node.radius {
                sum += node.pole.dot(way) / (square * square.sqrt());
            } else if node.second == 0 {
                let triangles = &self.triangles[node.start as usize..node.end as usize];
                sum += triangles.iter().map(|triangle| solid_angle(triangle, point)).sum::<f32>();
            } else {
                waiting[left] = node.second;
                waiting[left + 1] = at + 1;
                left += 2;
            }
        }
        sum / (4.0 * PI)
    }
}

#[cfg(test)]
impl Winding {
    /// The plain sum, O(n).
    pub(super) fn exact(&self, point: Vec3) -> f32 {
        self.triangles.iter().map(|triangle| solid_angle(triangle, point)).sum::<f32>() / (4.0 * PI)
    }
}

/// Terms of a node, summed in an order that is the same everywhere.
#[derive(Clone, Copy)]
struct Sums {
    pole: Vec3,
    /// Mean of the centroids, weighted by area.
    middle: Vec3,
    area: f32,
}

/// Appends the hierarchy of these triangles.
fn build(triangles: &mut [[Vec3; 3]], start: usize, end: usize, nodes: &mut Vec<Node>) -> Sums {
    let here = nodes.len();
    let node = Node {
        center: Vec3::ZERO,
        radius: 0.0,
        pole: Vec3::ZERO,
        start: start as u32,
        end: end as u32,
        second: 0,
    };
    nodes.push(node);
    let part = &mut triangles[start..end];
    let (low, high) = part
        .iter()
        .map(centroid)
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
    let sums = if part.len() > LEAF {
        let half = part.len() / 2;
        let size = high - low;
        let axis = if size.x >= size.y.max(size.z) { 0 } else { 1 + usize::from(size.z > size.y) };
        part.select_nth_unstable_by(half, |a, b| {
            let order = centroid(a)[axis].total_cmp(&centroid(b)[axis]);
            order.then_with(|| key(a).cmp(&key(b)))
        });
        let first = build(triangles, start, start + half, nodes);
        nodes[here].second = nodes.len() as u32;
        let second = build(triangles, start + half, end, nodes);
        Sums {
            pole: first.pole + second.pole,
            middle: first.middle + second.middle,
            area: first.area + second.area,
        }
    } else {
        part.sort_unstable_by_key(key);
        let none = Sums { pole: Vec3::ZERO, middle: Vec3::ZERO, area: 0.0 };
        part.iter().fold(none, |sums, triangle| {
            let normal = area_vector(triangle);
            let area = normal.length();
            Sums {
                pole: sums.pole + normal,
                middle: sums.middle + centroid(triangle) * area,
                area: sums.area + area,
            }
        })
    };
    let center = (sums.middle / sums.area.max(f32::MIN_POSITIVE)).clamp(low, high);
    let corners = triangles[start..end].iter().flatten();
    nodes[here].radius = corners.map(|corner| corner.distance(center)).fold(0.0, f32::max);
    (nodes[here].center, nodes[here].pole) = (center, sums.pole);
    sums
}

/// The order of two triangles with one centroid is the same everywhere.
fn key(triangle: &[Vec3; 3]) -> [[u32; 3]; 3] {
    triangle.map(|corner| corner.to_array().map(f32::to_bits))
}

fn centroid(triangle: &[Vec3; 3]) -> Vec3 {
    (triangle[0] + triangle[1] + triangle[2]) / 3.0
}

/// Vector along the normal whose length is the triangle's area.
pub(super) fn area_vector(triangle: &[Vec3; 3]) -> Vec3 {
    let [a, b, c] = triangle;
    (b - a).cross(c - a) * 0.5
}

/// The solid angle a triangle takes up seen from a point, positive seen from behind: Van Oosterom and Strackee 1983.
fn solid_angle(triangle: &[Vec3; 3], point: Vec3) -> f32 {
    let [a, b, c] = triangle.map(|corner| corner - point);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let volume = a.dot(b.cross(c));
    let across = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * atan2(volume, across)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, stream};
    use proptest::prelude::*;
    use rand::RngExt;

    fn octahedron() -> Vec<[Vec3; 3]> {
        let sign = |bits: u32, axis: u32| if bits >> axis & 1 == 0 { 1.0 } else { -1.0 };
        (0..8)
            .map(|bits| {
                let corners = [Vec3::X * sign(bits, 0), Vec3::Y * sign(bits, 1), Vec3::Z * sign(bits, 2)];
                if bits.count_ones() % 2 == 0 { corners } else { [corners[0], corners[2], corners[1]] }
            })
            .collect()
    }

    #[test]
    fn by_hand() {
        let whole = Winding::new(octahedron());
        assert!((whole.number(Vec3::splat(0.2)) - 1.0).abs() < 1e-5);
        assert!(whole.number(Vec3::splat(0.5)).abs() < 1e-5 && whole.number(Vec3::X * 9.0).abs() < 1e-3);
        // Each face takes up an eighth of what is seen from the middle.
        let open = Winding::new(octahedron()[1..].to_vec());
        assert!((open.number(Vec3::ZERO) - 0.875).abs() < 1e-5);
        assert!(Winding::new(Vec::new()).number(Vec3::ZERO).abs() < 1e-9);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// The hierarchy against the plain sum, on triangles that make no surface at all.
        #[test]
        fn equals_brute_force(count in 1_usize..400, size in 0.05_f32..1.0, seed: u64) {
            let mut random = stream(seed, 0, Purpose::CUSTOM, 0);
            let mut point = || Vec3::new(random.random(), random.random(), random.random());
            let triangles: Vec<[Vec3; 3]> = (0..count)
                .map(|_| {
                    let at = point();
                    [at, at + point() * size, at + point() * size]
                })
                .collect();
            let places: Vec<Vec3> = (0..50).map(|_| point() * 3.0 - 1.0).collect();
            let winding = Winding::new(triangles.clone());
            for place in places {
                let exact: f64 = triangles
                    .iter()
                    .map(|triangle| f64::from(solid_angle(triangle, place)))
                    .sum::<f64>() / (4.0 * std::f64::consts::PI);
                let found = f64::from(winding.number(place));
                let faces: f64 = triangles.iter().map(|t| f64::from(area_vector(t).length())).sum();
                prop_assert!((found - exact).abs() < 0.01 * faces.max(1.0), "{found} {exact}");
            }
        }
    }
}
