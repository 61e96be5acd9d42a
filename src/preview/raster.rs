//! Triangles and the samples they cover.
//!
//! A triangle is three corners of (column, row, nearness) in samples; a sample sits in the middle
//! of its cell. A triangle narrower than a sample would be hit here and missed there, and a twig
//! would break into dots. Such a triangle is *thin*: it is not sampled but strewn along its longest
//! edge, with the area it has. The part of that area on top of other thin ones is counted on a
//! finer grid of points.

use glam::{Vec2, Vec3, Vec3Swizzles};
use std::ops::Range;

/// A longer edge, in samples, comes from a triangle that all but touches the camera; it is left out.
const LONGEST: f32 = 1e7;

/// Twice the area a triangle has in samples; negative if it is seen counter-clockwise, since rows go down.
#[inline]
pub(super) fn double_area([a, b, c]: [Vec3; 3]) -> f32 {
    (b - a).xy().perp_dot((c - a).xy())
}

/// `true` if a triangle's height over its longest edge is less than `width` samples.
#[inline]
pub(super) fn is_thin(corners: [Vec3; 3], width: f32) -> bool {
    let [a, b, c] = corners.map(Vec3::xy);
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    let area = double_area(corners);
    area * area < longest * width * width
}

/// The first and last row a triangle's corners lie in, widened by `margin`; not cut off.
#[inline]
pub(super) fn rows([a, b, c]: [Vec3; 3], margin: f32) -> (f32, f32) {
    ((a.y.min(b.y).min(c.y) - margin).floor(), (a.y.max(b.y).max(c.y) + margin).floor())
}

/// Calls `put(column, row, nearness)` for every sample in a triangle, of either orientation, that lies in the
/// first `columns` columns and in `rows`. Neighbours that share an edge leave no gap.
#[inline]
pub(super) fn fill(
    corners: [Vec3; 3],
    columns: usize,
    rows: Range<usize>,
    mut put: impl FnMut(usize, usize, f32),
) {
    let double = double_area(corners);
    if !(double != 0.0 && double.is_finite()) {
        return;
    }
    let [a, b, c] = if double > 0.0 { corners } else { [corners[0], corners[2], corners[1]] };
    let [low, high] = [a.min(b).min(c), a.max(b).max(c)];
    let first = (low.y - 0.5).ceil().max(rows.start as f32) as usize;
    let end = ((high.y - 0.5).floor() + 1.0).clamp(0.0, rows.end as f32) as usize;
    // Most of what is thinner than a sample lies between all of them.
    let between = (low.x - 0.5).ceil() > (high.x - 0.5).floor();
    if first >= end || between || high.x < 0.0 || low.x > columns as f32 {
        return;
    }
    let (ab, ac) = (b - a, c - a);
    let inverse = 1.0 / double.abs();
    let slope_x = (ab.z * ac.y - ac.z * ab.y) * inverse;
    let slope_y = (ac.z * ab.x - ab.z * ac.x) * inverse;
    let edges = [Edge::new(a, b), Edge::new(b, c), Edge::new(c, a)];
    for row in first..end {
        let y = row as f32 + 0.5;
        let (mut left, mut right) = (low.x, high.x);
        for edge in &edges {
            let x = edge.x + (y - edge.y) * edge.slope;
            match edge.side {
                Side::Left => left = left.max(x),
                Side::Right => right = right.min(x),
                Side::Level => {}
            }
        }
        let start = (left - 0.5).ceil().max(0.0) as usize;
        let stop = ((right - 0.5).floor() + 1.0).clamp(0.0, columns as f32) as usize;
        for column in start..stop {
            let nearness = a.z + slope_x * (column as f32 + 0.5 - a.x) + slope_y * (y - a.y);
            put(column, row, nearness.max(low.z).min(high.z));
        }
    }
}

enum Side {
    Left,
    Right,
    Level,
}

/// An edge as x over y, worked out from the same end whichever triangle it belongs to.
struct Edge {
    x: f32,
    y: f32,
    slope: f32,
    side: Side,
}

impl Edge {
    #[inline]
    fn new(from: Vec3, to: Vec3) -> Self {
        let side = if to.y > from.y {
            Side::Right
        } else if to.y < from.y {
            Side::Left
        } else {
            Side::Level
        };
        let (low, high) = if (from.y, from.x) < (to.y, to.x) { (from, to) } else { (to, from) };
        let rise = high.y - low.y;
        let slope = if rise > 0.0 { (high.x - low.x) / rise } else { 0.0 };
        Self { x: low.x, y: low.y, slope, side }
    }
}

/// Strews a thin triangle over `put(place, area)` at steps of about a sample, where place is (column, row,
/// nearness) and the areas, in cells of a sample, add up to the triangle's. Places outside of `low` to `high` are
/// left out.
#[inline]
pub(super) fn strew(corners: [Vec3; 3], low: Vec2, high: Vec2, mut put: impl FnMut(Vec3, f32)) {
    let [a, b, c] = corners;
    let squared = |a: Vec3, b: Vec3| (b - a).xy().length_squared();
    let (mut from, mut to, mut third) = (a, b, c);
    if squared(b, c) > squared(from, to) {
        (from, to, third) = (b, c, a);
    }
    if squared(c, a) > squared(from, to) {
        (from, to, third) = (c, a, b);
    }
    let area = 0.5 * double_area(corners).abs();
    let way = to - from;
    let length = way.xy().length();
    if !(length < LONGEST && area > 0.0) {
        return;
    }
    // The middle line of a triangle of even width: a third of the height off the edge.
    let foot = if length > 0.0 { (third - from).xy().dot(way.xy()) / (length * length) } else { 0.0 };
    let from = from + (third - (from + way * foot)) / 3.0;
    let steps = length.ceil().max(1.0);
    let (start, stop) = within(from, way, low, high);
    let first = (start * steps - 0.5).ceil().max(0.0) as usize;
    let end = ((stop * steps - 0.5).floor() + 1.0).clamp(0.0, steps) as usize;
    for step in first..end {
        put(from + way * ((step as f32 + 0.5) / steps), area / steps);
    }
}

/// The part of the way that lies between two corners of a rectangle.
#[inline]
fn within(from: Vec3, way: Vec3, low: Vec2, high: Vec2) -> (f32, f32) {
    let (mut start, mut stop) = (0.0f32, 1.0f32);
    for axis in 0..2 {
        if way[axis].abs() > 1e-6 {
            let (a, b) = ((low[axis] - from[axis]) / way[axis], (high[axis] - from[axis]) / way[axis]);
            start = start.max(a.min(b));
            stop = stop.min(a.max(b));
        } else if from[axis] < low[axis] || from[axis] > high[axis] {
            return (1.0, 0.0);
        }
    }
    (start, stop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn covered(corners: [Vec3; 3]) -> Vec<(usize, usize, f32)> {
        let mut samples = Vec::new();
        fill(corners, 40, 0..30, |x, y, z| samples.push((x, y, z)));
        samples
    }

    #[test]
    fn nearness_is_linear() {
        let at = |x: f32, y: f32| Vec3::new(x, y, 0.25 * x - 0.5 * y + 3.0);
        let samples = covered([at(2.0, 3.0), at(30.0, 8.0), at(10.0, 28.0)]);
        assert!(samples.len() > 250);
        for (x, y, z) in samples {
            let place = (x as f32 + 0.5, y as f32 + 0.5);
            assert!((z - (0.25 * place.0 - 0.5 * place.1 + 3.0)).abs() < 1e-4);
        }
    }

    #[test]
    fn strewing_keeps_the_area() {
        let corners = [Vec3::new(3.0, 2.0, 1.0), Vec3::new(33.0, 20.0, 2.0), Vec3::new(33.4, 20.2, 2.0)];
        let mut total = 0.0;
        strew(corners, Vec2::ZERO, Vec2::new(40.0, 30.0), |place, area| {
            assert!(place.z > 0.9 && place.z < 2.1);
            total += area;
        });
        assert!((total - 0.5 * double_area(corners).abs()).abs() < 1e-4);
        strew(corners, Vec2::new(0.0, 25.0), Vec2::new(40.0, 30.0), |_, _| panic!("above the rectangle"));
    }

    proptest! {
        #[test]
        fn neighbours_leave_no_gap(
            c in prop::array::uniform8(-5.0f32..45.0),
        ) {
            let [a, b, p, q] = [(0, 1), (2, 3), (4, 5), (6, 7)].map(|(i, j)| Vec3::new(c[i], c[j], 0.0));
            // Two triangles on the two sides of a common edge.
            let one_side = double_area([a, b, p]) * double_area([a, b, q]) > 0.0;
            let q = if one_side { a + b - q } else { q };
            let (mut one, other) = (covered([a, b, p]), covered([b, a, q]));
            one.extend(other);
            let inside = |x: f32, y: f32, t: [Vec3; 3]| {
                let point = Vec3::new(x, y, 0.0);
                let s = double_area(t).signum();
                (0..3).all(|i| double_area([t[i], t[(i + 1) % 3], point]) * s >= 0.0)
            };
            for y in 0..30 {
                for x in 0..40 {
                    let (px, py) = (x as f32 + 0.5, y as f32 + 0.5);
                    let edge_distance = double_area([a, b, Vec3::new(px, py, 0.0)]).abs() / a.distance(b);
                    if edge_distance < 0.01 && (inside(px, py, [a, b, p]) || inside(px, py, [b, a, q])) {
                        let others = [a.distance(p), b.distance(p), a.distance(q), b.distance(q)];
                        if others.iter().all(|&d| d > 1.0) && inside_well(px, py, a, b) {
                            prop_assert!(one.iter().any(|s| (s.0, s.1) == (x, y)));
                        }
                    }
                }
            }
        }

        #[test]
        fn nothing_is_put_outside(c in prop::array::uniform9(prop::num::f32::ANY), d in prop::array::uniform9(-1e3f32..1e3)) {
            for c in [c, d] {
                let corners = [0, 3, 6].map(|i| Vec3::new(c[i], c[i + 1], c[i + 2]));
                fill(corners, 40, 10..30, |x, y, _| assert!(x < 40 && (10..30).contains(&y)));
            }
            let corners = [0, 3, 6].map(|i| Vec3::new(d[i], d[i + 1], d[i + 2]));
            let (low, high) = (Vec2::ZERO, Vec2::new(40.0, 30.0));
            strew(corners, low, high, |place, area| {
                assert!(area > 0.0 && place.xy().cmpge(low - 1.0).all() && place.xy().cmple(high + 1.0).all());
            });
        }
    }

    /// `true` if a place is beside the middle part of an edge.
    fn inside_well(x: f32, y: f32, a: Vec3, b: Vec3) -> bool {
        let t = (Vec2::new(x, y) - a.xy()).dot((b - a).xy()) / (b - a).xy().length_squared();
        (0.1..=0.9).contains(&t)
    }
}
