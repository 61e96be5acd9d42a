//! Polygons cut into triangles, by ears.
//!
//! Two rules make this more than a fan, and more than what crates for ear cutting do. No corner is left out,
//! not even one in the middle of a straight side: a neighbouring polygon may meet it there, and the surface
//! would gape. And no corner is added or moved, since vertices are shared. Every polygon of n corners
//! therefore becomes n - 2 triangles of its own corners.

use std::collections::VecDeque;

use glam::{DVec2, DVec3};

/// Tests of a corner against an ear that a polygon may take: about a second, enough for some 50,000 corners that turn inward.
const MOST_TESTS: u64 = 500_000_000;

/// The triangles of the polygon with these corners, each three numbers of corners; in its plane if it has one. False if it
/// takes too long.
///
/// O(n) for convex polygons; for others each ear is tested against the corners that turn inward beside it.
#[must_use]
pub(super) fn triangulate(corners: &[DVec3], mut triangle: impl FnMut([usize; 3])) -> bool {
    let count = corners.len();
    if count <= 3 {
        if count == 3 {
            triangle([0, 1, 2]);
        }
        return true;
    }
    // The same cuts wherever the polygon begins and whichever way it runs, so that the two sides of a sheet, and of a wall
    // between two solids, match.
    let least = (0..count).min_by(|&a, &b| order(corners[a], corners[b])).unwrap_or(0);
    let backwards = order(corners[(least + count - 1) % count], corners[(least + 1) % count]).is_lt();
    let from_least = |i: usize| (least + if backwards { count - i } else { i }) % count;
    let mut triangle = |t: [usize; 3]| {
        let [a, b, c] = t.map(from_least);
        triangle(if backwards { [a, c, b] } else { [a, b, c] });
    };
    let corners: Vec<DVec3> = (0..count).map(|i| corners[from_least(i)]).collect();
    let flat = flattened(&corners);
    if is_convex(&flat) {
        halve(0, count - 1, &mut triangle);
        true
    } else {
        Ears::new(&flat).cut(&mut triangle)
    }
}

fn order(a: DVec3, b: DVec3) -> std::cmp::Ordering {
    // Plus zero, to make -0 and 0 one place.
    let [a, b] = [a + DVec3::ZERO, b + DVec3::ZERO];
    a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
}

/// The corners seen along the axis that the polygon's normal is nearest to, so that it runs counter-clockwise. Leaving out an
/// axis keeps corners on a line exactly on a line.
fn flattened(corners: &[DVec3]) -> Vec<DVec2> {
    let origin = corners[0];
    let mut normal = DVec3::ZERO;
    for pair in corners.windows(2) {
        normal += (pair[0] - origin).cross(pair[1] - origin);
    }
    let size = normal.abs();
    let along = if size.x >= size.y.max(size.z) { 0 } else { 1 + usize::from(size.z > size.y) };
    let (u, v) = ((along + 1) % 3, (along + 2) % 3);
    let (u, v) = if normal[along] < 0.0 { (v, u) } else { (u, v) };
    corners.iter().map(|corner| DVec2::new(corner[u] - origin[u], corner[v] - origin[v])).collect()
}

/// Twice the area of a triangle, positive if it runs counter-clockwise.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// `true` if all corners turn left and the polygon goes around once.
fn is_convex(flat: &[DVec2]) -> bool {
    let count = flat.len();
    let at = |i: usize| flat[i % count];
    let mut returns = 0;
    for i in 0..count {
        if turn(at(i), at(i + 1), at(i + 2)) <= 0.0 {
            return false;
        }
        let runs = |i: usize| at(i + 1).to_array() > at(i).to_array();
        returns += u32::from(runs(i) != runs(i + 1));
    }
    returns <= 2
}

/// A convex polygon's corners `first` to `last`: a triangle on their chord with the corner in the middle, and on. Unlike a
/// fan it has few long thin triangles. A square is cut from its first corner.
fn halve(first: usize, last: usize, triangle: &mut impl FnMut([usize; 3])) {
    if last - first < 2 {
        return;
    }
    let middle = (first + last).div_ceil(2);
    halve(first, middle, triangle);
    triangle([first, middle, last]);
    halve(middle, last, triangle);
}

/// A polygon from which ears are cut.
struct Ears<'a> {
    flat: &'a [DVec2],
    next: Vec<usize>,
    previous: Vec<usize>,
    /// Corners that do not turn left, and so might lie in an ear, by their x; those that were cut off since too.
    inward: Vec<usize>,
    gone: Vec<bool>,
    tests: u64,
}

impl<'a> Ears<'a> {
    fn new(flat: &'a [DVec2]) -> Self {
        let count = flat.len();
        let next = (0..count).map(|i| (i + 1) % count).collect();
        let previous = (0..count).map(|i| (i + count - 1) % count).collect();
        let mut ears = Self { flat, next, previous, inward: Vec::new(), gone: vec![false; count], tests: 0 };
        ears.inward = (0..count).filter(|&i| ears.turn_at(i) <= 0.0).collect();
        ears.inward.sort_by(|&i, &j| flat[i].x.total_cmp(&flat[j].x));
        ears
    }

    fn turn_at(&self, i: usize) -> f64 {
        turn(self.flat[self.previous[i]], self.flat[i], self.flat[self.next[i]])
    }

    /// `true` if the triangle at corner `i` can be cut off: it has an area, and no other corner in it or on
    /// its cut.
    fn is_ear(&mut self, i: usize) -> bool {
        if self.turn_at(i) <= 0.0 {
            return false;
        }
        let flat = self.flat;
        let [a, b, c] = [self.previous[i], i, self.next[i]].map(|corner| flat[corner]);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let start = self.inward.partition_point(|&other| flat[other].x < low.x);
        for &other in &self.inward[start..] {
            let p = flat[other];
            self.tests += 1;
            if p.x > high.x {
                break;
            }
            if self.gone[other] || p.y < low.y || p.y > high.y || p == a || p == b || p == c {
                continue;
            }
            if turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0 {
                return false;
            }
        }
        true
    }

    fn cut(mut self, triangle: &mut impl FnMut([usize; 3])) -> bool {
        let mut left = self.flat.len();
        let mut waiting: VecDeque<usize> = (0..left).collect();
        // `true` if an ear was cut since all corners were tried; and a corner that is left.
        let (mut progress, mut any) = (false, 0);
        while left > 3 {
            self.tests += 1;
            if self.tests > MOST_TESTS {
                return false;
            }
            let at = match waiting.pop_front() {
                Some(at) if self.gone[at] || !self.is_ear(at) => continue,
                Some(at) => at,
                None if progress => {
                    progress = false;
                    self.tests += left as u64;
                    waiting.extend(self.ring(any));
                    continue;
                }
                // Rounding, or a polygon that crosses itself: cut any corner that turns left, or any at all.
                None => {
                    self.tests += left as u64;
                    self.ring(any).find(|&at| self.turn_at(at) > 0.0).unwrap_or(any)
                }
            };
            let [before, after] = [self.previous[at], self.next[at]];
            triangle([before, at, after]);
            (self.next[before], self.previous[after]) = (after, before);
            self.gone[at] = true;
            (progress, any) = (true, after);
            left -= 1;
            if left.is_multiple_of(256) {
                let gone = &self.gone;
                self.inward.retain(|&corner| !gone[corner]);
                self.tests += self.inward.len() as u64;
            }
            // In turn, so that no corner is the tip of many ears.
            waiting.extend([before, after]);
        }
        triangle([self.previous[any], any, self.next[any]]);
        true
    }

    /// The corners that are left, from one of them on.
    fn ring(&self, from: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(from), move |&at| Some(self.next[at]).filter(|&next| next != from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, stream};
    use rand::RngExt;

    /// Triangles of a polygon that starts at any of its corners, runs either way and lies in any plane: they must have the
    /// polygon's area in all, none be without one, and each side of the polygon belong to one triangle.
    fn check(flat: &[(f64, f64)], area: f64) {
        let planes: [fn(f64, f64) -> DVec3; 4] = [
            |x, y| DVec3::new(x, y, 0.5),
            |x, y| DVec3::new(-0.25, x, y),
            |x, y| DVec3::new(x, x + 2.0 * y, y),
            |x, y| DVec3::new(3.0 * x - y, y, x),
        ];
        for plane in planes {
            let stretch = (plane(1.0, 0.0) - plane(0.0, 0.0)).cross(plane(0.0, 1.0) - plane(0.0, 0.0));
            let mut corners: Vec<DVec3> = flat.iter().map(|&(x, y)| plane(x, y)).collect();
            for _ in 0..2 {
                for _ in 0..corners.len() {
                    corners.rotate_left(1);
                    let (mut sum, mut sides) = (DVec3::ZERO, vec![0; corners.len()]);
                    let mut count = 0;
                    assert!(triangulate(&corners, |t| {
                        let [a, b, c] = t.map(|corner| corners[corner]);
                        let part = 0.5 * (b - a).cross(c - a);
                        assert!(part.length() > 0.0, "{t:?} of {flat:?}");
                        assert!(sum.dot(part) >= 0.0, "{t:?} of {flat:?} is turned");
                        sum += part;
                        count += 1;
                        for (from, to) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                            sides[from] += usize::from(to == (from + 1) % corners.len());
                        }
                    }));
                    assert_eq!(count, corners.len() - 2);
                    assert!(sides.iter().all(|&side| side == 1), "{flat:?}");
                    assert!((sum.length() / stretch.length() - area).abs() < 1e-9, "{} {area}", sum.length());
                }
                corners.reverse();
            }
        }
    }

    #[test]
    fn concave_polygons_keep_their_area() {
        check(&[(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)], 5.0);
        check(&[(0.0, 0.0), (2.0, 1.0), (0.0, 2.0), (0.5, 1.0)], 1.5);
        // A plus sign, a square, a comb, and a square wound around a channel.
        let plus =
            [(1, 0), (2, 0), (2, 1), (3, 1), (3, 2), (2, 2), (2, 3), (1, 3), (1, 2), (0, 2), (0, 1), (1, 1)];
        check(&plus.map(|(x, y)| (f64::from(x), f64::from(y))), 5.0);
        check(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], 1.0);
        let teeth = (0..9).flat_map(|i| [(f64::from(i), 0.0), (f64::from(i) + 0.5, 4.0)]);
        let comb: Vec<_> = teeth.chain([(9.0, 0.0), (9.0, 5.0), (0.0, 5.0)]).collect();
        check(&comb, 45.0 - 18.0);
    }

    /// Neighbours may end at a corner in the middle of a straight side.
    #[test]
    fn corners_on_straight_sides_stay() {
        check(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0), (0.0, 3.0)], 4.5);
        check(
            &[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0), (0.0, 2.0), (0.0, 1.0)],
            4.0,
        );
        check(
            &[(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (1.0, 3.0), (0.0, 3.0)],
            5.0,
        );
    }

    #[test]
    fn stars_of_any_shape_keep_their_area() {
        for seed in 0..300 {
            let mut random = stream(seed, 0, Purpose::CUSTOM, 0);
            let count = random.random_range(4..40);
            let corners: Vec<(f64, f64)> = (0..count)
                .map(|i| {
                    let radius = random.random_range(0.1..1.0_f64);
                    let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(count));
                    (radius * cos, radius * sin)
                })
                .collect();
            let next = |i: usize| corners[(i + 1) % corners.len()];
            let area: f64 =
                corners.iter().enumerate().map(|(i, a)| 0.5 * (a.0 * next(i).1 - next(i).0 * a.1)).sum();
            check(&corners, area);
        }
    }

    #[test]
    fn any_corners_end_in_time() {
        let mut random = stream(1, 0, Purpose::CUSTOM, 0);
        for count in [4, 5, 50, 3000] {
            let corners: Vec<DVec3> =
                (0..count).map(|_| DVec3::new(random.random(), random.random(), random.random())).collect();
            let mut triangles = 0;
            assert!(triangulate(&corners, |_| triangles += 1));
            assert_eq!(triangles, count - 2);
            assert!(triangulate(&vec![DVec3::ONE; count], |_| ()));
        }
        // A large polygon with every second corner inward.
        let teeth = (0..30_000).map(|i| DVec3::new(f64::from(i), f64::from(i % 2), 0.0));
        let saw: Vec<DVec3> =
            teeth.chain([DVec3::new(29_999.0, 9.0, 0.0), DVec3::new(0.0, 9.0, 0.0)]).collect();
        let mut area = 0.0;
        assert!(triangulate(&saw, |t| {
            let [a, b, c] = t.map(|corner| saw[corner]);
            area += 0.5 * (b - a).cross(c - a).length();
        }));
        let exact = 29_999.0 * 8.5;
        assert!((area / exact - 1.0).abs() < 1e-6, "{area}");
    }
}
