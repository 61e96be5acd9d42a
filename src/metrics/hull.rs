//! Convex hulls in the plane and in space.

use glam::{DVec2, DVec3};
use std::collections::BTreeMap;

/// The corners, counterclockwise, without those on straight edges (Andrew's monotone chain, 1979). At least one
/// corner for at least one point.
pub(super) fn convex_hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let mut hull: Vec<DVec2> = Vec::new();
    let mut half = |points: &mut dyn Iterator<Item = DVec2>| {
        let fixed = hull.len();
        for point in points {
            while let [.., a, b] = hull[fixed..] {
                if (b - a).perp_dot(point - a) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(point);
        }
        // The last point is the first of the other half.
        hull.pop();
    };
    half(&mut points.iter().copied());
    half(&mut points.iter().rev().copied());
    hull
}

/// Area inside of corners that go round counterclockwise.
pub(super) fn area(corners: &[DVec2]) -> f64 {
    let Some(&first) = corners.first() else { return 0.0 };
    corners.windows(2).map(|pair| (pair[0] - first).perp_dot(pair[1] - first)).sum::<f64>().max(0.0) / 2.0
}

/// A share of the points' extent: what lies closer to a face than that counts as on it.
const FLAT: f64 = 1e-10;

/// Volume of the convex hull of some points; 0 where they lie in a plane. Quickhull (Barber, Dobkin and Huhdanpaa 1996):
/// O(n log n) for points like those of trees.
pub(super) fn hull_volume(points: &[DVec3]) -> f64 {
    let (low, high) = points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &point| {
        (low.min(point), high.max(point))
    });
    let extent = (high - low).max_element();
    if points.len() < 4 || extent <= 0.0 {
        return 0.0;
    }
    // In units of the extent, so that no product overflows.
    let points: Vec<DVec3> = points.iter().map(|&point| (point - low) / extent).collect();
    let unit = Hull::of(&points).map_or(0.0, |hull| hull.volume());
    unit * extent * extent * extent
}

/// A triangle of a hull, its corners counterclockwise seen from outside.
struct Face {
    corners: [usize; 3],
    /// The face beyond the edge from each corner to the next.
    beyond: [usize; 3],
    normal: DVec3,
    /// Points that see this face, and none of those that were made before it.
    outside: Vec<usize>,
    is_gone: bool,
}

struct Hull<'a> {
    points: &'a [DVec3],
    faces: Vec<Face>,
}

impl<'a> Hull<'a> {
    /// `None` for points in a plane.
    fn of(points: &'a [DVec3]) -> Option<Self> {
        let mut hull = Self { points, faces: Vec::new() };
        let corners = hull.first_corners()?;
        let [a, b, c, d] = corners;
        for (corners, beyond) in
            [([a, b, c], [1, 2, 3]), ([b, a, d], [0, 3, 2]), ([c, b, d], [0, 1, 3]), ([a, c, d], [0, 2, 1])]
        {
            hull.add(corners, beyond);
        }
        hull.assign((0..points.len()).collect(), 0);
        let mut next = 0;
        while next < hull.faces.len() {
            if hull.faces[next].is_gone || hull.faces[next].outside.is_empty() {
                next += 1;
            } else {
                // Faces that arise come later.
                hull.grow(next);
            }
        }
        Some(hull)
    }

    /// Four points that span a tetrahedron, the first three clockwise seen from the fourth.
    fn first_corners(&self) -> Option<[usize; 4]> {
        let farthest = |measure: &dyn Fn(DVec3) -> f64| {
            let all = self.points.iter().enumerate().map(|(i, &point)| (measure(point), i));
            all.max_by(|x, y| x.0.total_cmp(&y.0)).filter(|&(most, _)| most > FLAT).map(|(_, i)| i)
        };
        let a = 0;
        let start = self.points[a];
        let b = farthest(&|p| p.distance(start))?;
        let axis = (self.points[b] - start).normalize();
        let c = farthest(&|p| (p - start).cross(axis).length())?;
        let normal = axis.cross(self.points[c] - start).normalize();
        let d = farthest(&|p| (p - start).dot(normal).abs())?;
        let is_above = (self.points[d] - start).dot(normal) > 0.0;
        Some(if is_above { [a, c, b, d] } else { [a, b, c, d] })
    }

    fn add(&mut self, corners: [usize; 3], beyond: [usize; 3]) {
        let [a, b, c] = corners.map(|corner| self.points[corner]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        self.faces.push(Face { corners, beyond, normal, outside: Vec::new(), is_gone: false });
    }

    fn distance(&self, face: usize, point: usize) -> f64 {
        let Face { corners, normal, .. } = &self.faces[face];
        (self.points[point] - self.points[corners[0]]).dot(*normal)
    }

    /// Gives each point to the first face from `first` on that it sees; those that see none lie inside.
    fn assign(&mut self, points: Vec<usize>, first: usize) {
        for point in points {
            let seen = (first..self.faces.len()).find(|&face| self.distance(face, point) > FLAT);
            if let Some(face) = seen {
                self.faces[face].outside.push(point);
            }
        }
    }

    /// Adds the point farthest from a face: the faces that it sees give way to a cone to their
    /// border.
    fn grow(&mut self, start: usize) {
        let far = |&x: &usize, &y: &usize| self.distance(start, x).total_cmp(&self.distance(start, y));
        let Some(apex) = self.faces[start].outside.iter().copied().max_by(|x, y| far(x, y)) else { return };
        self.faces[start].is_gone = true;
        let (mut stack, mut gone, mut border) = (vec![start], vec![start], Vec::new());
        while let Some(face) = stack.pop() {
            let Face { corners, beyond, .. } = self.faces[face];
            for side in 0..3 {
                let other = beyond[side];
                if self.faces[other].is_gone {
                    continue;
                }
                if self.distance(other, apex) > FLAT {
                    self.faces[other].is_gone = true;
                    stack.push(other);
                    gone.push(other);
                } else {
                    border.push((corners[side], corners[(side + 1) % 3], other, face));
                }
            }
        }
        // A face is reached from several sides: the borders to faces that went later are none.
        border.retain(|&(_, _, other, _)| !self.faces[other].is_gone);
        let first = self.faces.len();
        let starts: BTreeMap<usize, usize> =
            border.iter().enumerate().map(|(i, &(from, ..))| (from, first + i)).collect();
        let ends: BTreeMap<usize, usize> =
            border.iter().enumerate().map(|(i, &(_, to, ..))| (to, first + i)).collect();
        for (i, &(from, to, other, face)) in border.iter().enumerate() {
            let own = first + i;
            let (next, last) = (starts.get(&to).copied(), ends.get(&from).copied());
            self.add([from, to, apex], [other, next.unwrap_or(own), last.unwrap_or(own)]);
            let back = self.faces[other].beyond.iter_mut().find(|beyond| **beyond == face);
            if let Some(back) = back {
                *back = own;
            }
        }
        let mut points: Vec<usize> =
            gone.iter().flat_map(|&face| std::mem::take(&mut self.faces[face].outside)).collect();
        points.retain(|&point| point != apex);
        self.assign(points, first);
    }

    /// Tetrahedra from one point to each face.
    fn volume(&self) -> f64 {
        let center = self.points[self.faces[0].corners[0]];
        let of = |face: &Face| {
            let [a, b, c] = face.corners.map(|corner| self.points[corner] - center);
            a.dot(b.cross(c)) / 6.0
        };
        self.faces.iter().filter(|face| !face.is_gone).map(of).sum::<f64>().max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cube() -> Vec<DVec3> {
        let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
        (0..8).map(corner).collect()
    }

    #[test]
    fn solids_by_hand() {
        assert!((hull_volume(&cube()) - 1.0).abs() < 1e-9);
        let mut more = cube();
        more.extend(cube().iter().map(|&corner| DVec3::splat(0.25) + corner * 0.5));
        more.extend(cube().iter().map(|&corner| corner * DVec3::new(1.0, 1.0, 0.5)));
        assert!((hull_volume(&more) - 1.0).abs() < 1e-9);
        let octahedron: Vec<DVec3> = DVec3::AXES.iter().flat_map(|&axis| [axis * 3.0, -axis * 3.0]).collect();
        assert!((hull_volume(&octahedron) - 36.0).abs() < 1e-7);
        assert!(hull_volume(&cube().iter().map(|&c| c * 1e30).collect::<Vec<_>>()) > 0.99e90);
    }

    #[test]
    fn flat_things_have_none() {
        let flat: Vec<DVec3> = cube().iter().map(|&corner| corner * DVec3::new(1.0, 0.0, 3.0)).collect();
        let line: Vec<DVec3> = (0..9).map(|i| DVec3::ONE * f64::from(i)).collect();
        for points in [flat, line, vec![DVec3::ONE; 5], cube()[..3].to_vec(), Vec::new()] {
            assert!(hull_volume(&points) < 1e-9);
        }
    }

    #[test]
    fn a_ball_of_many_points() {
        // Fibonacci's lattice on a sphere.
        let points: Vec<DVec3> = (0..20_000)
            .map(|i| {
                let y = 1.0 - 2.0 * (f64::from(i) + 0.5) / 20_000.0;
                let (sin, cos) = libm::sincos(2.399_963_229_728_653 * f64::from(i));
                DVec3::new(cos, 0.0, sin) * (1.0 - y * y).sqrt() + DVec3::Y * y
            })
            .collect();
        let volume = hull_volume(&points);
        assert!((volume - 4.0 / 3.0 * std::f64::consts::PI).abs() < 2e-3, "{volume}");
    }

    /// The faces of a hull by definition: three points with all others on one side.
    fn oracle(points: &[DVec3]) -> f64 {
        let n = points.len();
        let mut volume = 0.0;
        for a in 0..n {
            for b in 0..n {
                for c in 0..n {
                    if a < b && a < c && b != c {
                        let normal = (points[b] - points[a]).cross(points[c] - points[a]);
                        if points.iter().all(|&p| (p - points[a]).dot(normal) <= 1e-12) {
                            volume += points[a].dot(points[b].cross(points[c])) / 6.0;
                        }
                    }
                }
            }
        }
        volume
    }

    proptest! {
        #[test]
        fn as_by_definition(points in prop::collection::vec([-1.0f64..1.0, -1.0..1.0, -1.0..1.0], 4..24)) {
            let points: Vec<DVec3> = points.into_iter().map(DVec3::from_array).collect();
            prop_assert!((hull_volume(&points) - oracle(&points)).abs() < 1e-6);
        }

        // Many points in one plane and on one line: the faces of a hull are no triangles then.
        #[test]
        fn points_on_a_lattice(points in prop::collection::vec([0u8..4, 0u8..4, 0u8..4], 4..60)) {
            let lattice: Vec<DVec3> =
                points.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
            // Shaken a little, the volume is nearly the same and the hull is made of triangles.
            let shaken: Vec<DVec3> = lattice.iter().enumerate().map(|(i, &p)| {
                let (sin, cos) = libm::sincos(i as f64);
                p + DVec3::new(sin, cos, sin * cos) * 1e-5
            }).collect();
            prop_assert!((hull_volume(&lattice) - oracle(&shaken)).abs() < 1e-2, "{} {}", hull_volume(&lattice), oracle(&shaken));
        }
    }
}
