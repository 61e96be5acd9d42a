//! Primitives that bend: pieces of a smooth axis, which go over into each other without a crease.
//!
//! The planes across both ends turn into one another along the piece, so each point has one place of the
//! axis. Two pieces that share an end share its plane, its direction, its radius and its taper there, and the
//! fields of both have one gradient in it. An end that is shared is flat: nothing of the piece is felt beyond its
//! plane, where a ball would stand out from a neighbour that tapers.

use super::field::FieldFunction;
use super::primitive::Range;
use crate::Bounds;
use crate::surface::implicit::span::{Passage, Span};
use glam::Vec3;

/// Where the planes across both ends come nearer than this share of the chord within reach of the field, it
/// bends too sharply.
const NARROWEST: f32 = 0.5;
/// The steepest slope of the radius.
const STEEPEST: f32 = 0.5;
/// How far beyond a flat end a piece is felt, over its chord: so far that no point is beyond both of two that meet.
const OVERLAP: f32 = 1e-3;
/// Times a coordinate: more than what rounding may change in the distance of two points.
const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// Ends of a piece: directions of its axis, slopes of its radius.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course {
    pub(super) directions: [Vec3; 2],
    pub(super) slopes: [f32; 2],
    /// `true` where another piece goes on.
    pub(super) is_flat: [bool; 2],
}

/// A cubic Hermite curve with a radius, in metres from its start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bend {
    way: Vec3,
    /// The directions at both ends, as long as the way.
    tangents: [Vec3; 2],
    radii: [f32; 2],
    /// The radius' changes at both ends, over the length of the way.
    rises: [f32; 2],
    /// The squares of the length times how far beyond its start and its end it is felt; without end where an end
    /// is round.
    beyond: [f32; 2],
    /// The farthest that it leaves its chord.
    sag: f32,
    /// Bound of the slope of the distance in radii, times the radius.
    slope: f32,
}

impl Bend {
    /// `None` where it would bend, taper or turn too sharply within `reach` radii of it.
    pub(super) fn new(way: Vec3, course: &Course, radii: [f32; 2], reach: f32) -> Option<Self> {
        let &Course { directions, slopes, is_flat } = course;
        let length = way.length();
        if !(length > 1e-9 && length.is_finite()) || slopes.iter().any(|slope| slope.abs() > STEEPEST) {
            return None;
        }
        let along = way / length;
        // A little more than the angles.
        let leans = directions.map(|direction| (direction - along).length() * 1.05);
        let thick = radii[0].max(radii[1]);
        let across = (directions[1] - directions[0]).length();
        // How near to each other the planes come on the inner side, over the chord.
        let least = directions[0].dot(along).min(directions[1].dot(along));
        let narrow = least - across * (reach * thick / length + 0.15);
        if !(narrow >= NARROWEST && leans[0] + leans[1] < 1.0) {
            return None;
        }
        // The axis is not quite square to the planes between the ends: it is where it is an arc.
        let skew = (0.5 * (directions[0] + directions[1]) - along).length() * 2.0 + 0.5 * across * across;
        let taper = slopes[0].abs().max(slopes[1].abs()).max((radii[1] - radii[0]).abs() / length) * 1.5;
        let stretch = 1.15 / narrow;
        let (shear, change) = (stretch * skew, stretch * taper * reach);
        let slope = (1.0 + (shear + change) * (shear + change)).sqrt() + skew * (shear + change);
        Some(Self {
            way,
            tangents: directions.map(|direction| direction * length),
            radii,
            // So much that the radius keeps between both.
            rises: slopes.map(|slope| {
                let change = radii[1] - radii[0];
                (slope * length).clamp(change.min(0.0) * 3.0, change.max(0.0) * 3.0)
            }),
            beyond: is_flat.map(|is_flat| if is_flat { OVERLAP * length * length } else { f32::INFINITY }),
            sag: length * (leans[0] + leans[1]) * 0.15,
            slope: slope * 1.01,
        })
    }

    /// `true` if a point is beyond a flat end by more than so many metres.
    #[inline]
    fn is_beyond(&self, offset: Vec3, metres: f32) -> bool {
        let ([first, last], [before, after]) = (self.tangents, self.beyond);
        let most = metres * first.length();
        offset.dot(first) < -before - most || (self.way - offset).dot(last) < -after - most
    }

    /// Place along it of a point, 0 to 1, and the change of that, per metre; none where it is beyond a flat end.
    #[inline]
    fn place(&self, offset: Vec3) -> (f32, Vec3) {
        let [first, last] = self.tangents;
        let (before, after) = (offset.dot(first), (self.way - offset).dot(last));
        if before < -self.beyond[0] || after < -self.beyond[1] {
            return (f32::NAN, Vec3::ZERO);
        }
        if before <= 0.0 {
            // Beyond both planes no field reaches.
            return (0.0, Vec3::ZERO);
        }
        if after <= 0.0 {
            return (1.0, Vec3::ZERO);
        }
        let inverse = 1.0 / (before + after);
        (before * inverse, (first * after + last * before) * (inverse * inverse))
    }

    /// The axis there, and its change along it.
    #[inline]
    fn axis(&self, t: f32) -> (Vec3, Vec3) {
        let ([first, last], back) = (self.tangents, 1.0 - t);
        let point = self.way * (t * t * (3.0 - 2.0 * t)) + first * (t * back * back) - last * (t * t * back);
        let change =
            self.way * (6.0 * t * back) + first * (back * (1.0 - 3.0 * t)) + last * (t * (3.0 * t - 2.0));
        (point, change)
    }

    /// The radius there, and its change along it.
    #[inline]
    fn radius(&self, t: f32) -> (f32, f32) {
        let ([start, end], [first, last], back) = (self.radii, self.rises, 1.0 - t);
        let radius = start + (end - start) * (t * t * (3.0 - 2.0 * t)) + first * (t * back * back)
            - last * (t * t * back);
        let change = (end - start) * (6.0 * t * back)
            + first * (back * (1.0 - 3.0 * t))
            + last * (t * (3.0 * t - 2.0));
        (radius, change)
    }

    /// The radius at a share of its length.
    pub(super) fn radius_at(&self, t: f32) -> f32 {
        self.radius(t).0
    }

    /// Place at a share of its length, and the courses of what is before and after it.
    pub(super) fn halves(&self, t: f32) -> (Vec3, [Course; 2]) {
        let ((place, change), (_, rise)) = (self.axis(t), self.radius(t));
        let (length, through) = (self.way.length(), change.length().max(f32::MIN_POSITIVE));
        let (direction, slope) = (change / through, rise / through);
        let [first, last] = self.tangents.map(|tangent| tangent / length);
        let [start, end] = self.rises.map(|rise| rise / length);
        let [before, after] = self.beyond.map(f32::is_finite);
        let course = |directions, slopes, is_flat| Course { directions, slopes, is_flat };
        let below = course([first, direction], [start, slope], [before, true]);
        (place, [below, course([direction, last], [slope, end], [true, after])])
    }

    /// The distance of a point from the axis in radii there.
    #[inline]
    pub(super) fn distance(&self, offset: Vec3) -> f32 {
        let t = self.place(offset).0;
        if t.is_nan() {
            return f32::INFINITY;
        }
        (offset - self.axis(t).0).length() / self.radius(t).0
    }

    /// The same, and its gradient.
    #[inline]
    pub(super) fn gradient(&self, offset: Vec3) -> (f32, Vec3) {
        let (t, change) = self.place(offset);
        if t.is_nan() {
            return (f32::INFINITY, Vec3::ZERO);
        }
        let ((axis, along), (radius, rise)) = (self.axis(t), self.radius(t));
        let away = offset - axis;
        let distance = away.length();
        let out = away / distance.max(f32::MIN_POSITIVE);
        let share = distance / radius;
        (share, (out - change * (out.dot(along) + share * rise)) / radius)
    }
    fn thickest(&self) -> f32 {
        self.radii[0].max(self.radii[1])
    }

    fn thinnest(&self) -> f32 {
        self.radii[0].min(self.radii[1])
    }

    /// A box around all that is within so many radii of it, where it begins at a point.
    pub(super) fn bounds(&self, from: Vec3, reach: f32) -> Bounds {
        let at = |end: Vec3, radius: f32| {
            let rounding = ROUNDING * (end.abs().max_element() + self.way.abs().max_element());
            Bounds::around(end, Vec3::splat(radius * reach * 1.0001 + self.sag + rounding))
        };
        at(from, self.thickest()).union(at(from + self.way, self.thickest()))
    }

    /// Part of a passage within so many radii of it, where it begins at a point.
    #[cfg_attr(not(feature = "preview"), allow(dead_code, reason = "only rays ask"))]
    pub(super) fn span(&self, from: Vec3, passage: &Passage, reach: f32) -> Option<Span> {
        let inverse = 1.0 / self.way.length_squared();
        passage.near(from, self.way, inverse, self.thickest() * reach + self.sag)
    }

    /// Bounds of a field of this bend within `reach` metres of a point, and the least radius there.
    #[inline]
    pub(super) fn range(&self, field: FieldFunction, offset: Vec3, reach: f32) -> (Range, f32) {
        let (thinnest, thickest) = (self.thinnest() * 0.9999, self.thickest() * 1.0001);
        let along = (offset.dot(self.way) / self.way.length_squared()).clamp(0.0, 1.0);
        let beside = (offset - self.way * along).length();
        let felt = field.reach();
        let nearest = (beside - self.sag - reach).max(0.0) / thickest;
        if nearest >= felt || self.is_beyond(offset, reach) {
            return (Range::NOTHING, thinnest);
        }
        // Within reach of the field, and beyond a flat end in the piece that follows, the distance in radii changes by no more than its slope.
        let (here, change) = (self.distance(offset), self.slope * reach / thinnest);
        let near = if here < felt { nearest.max(here - change) } else { nearest };
        let far = here + change;
        let slack = |x: f32, by: f32| {
            if x <= field.plateau() { 1.0 } else { (field.value(x) + by).clamp(0.0, 1.0) }
        };
        let (least, most) = (slack(far, -1e-5), slack(near, 1e-5));
        let slope = field.steepest(near, far) * self.slope / thinnest;
        (Range { least, most, slope }, thinnest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn place(range: f32) -> impl Strategy<Value = Vec3> {
        [-range..range, -range..range, -range..range].prop_map(Vec3::from_array)
    }

    proptest! {
        /// Slopes are those of the values, and neither leaves its bounds.
        #[test]
        fn a_bend_keeps_its_bounds(
            way in place(1.0),
            leans in [place(0.5), place(0.5)],
            radii in [0.02f32..0.5, 0.02f32..0.5],
            slopes in [-0.3f32..0.3, -0.3f32..0.3],
            offsets in proptest::collection::vec(place(1.5), 40),
            size in 0.01f32..0.2,
        ) {
            let length = way.length();
            prop_assume!(length > 0.05);
            let field = FieldFunction::Smooth { width: 0.7 };
            let directions = leans.map(|lean| (way / length + lean).normalize());
            let change = (radii[1] - radii[0]) / length;
            let slopes = slopes.map(|slope| slope.abs().min(3.0 * change.abs()).copysign(change));
            let course = Course { directions, slopes, is_flat: [false; 2] };
            let Some(bend) = Bend::new(way, &course, radii, field.reach()) else { return Ok(()) };
            for &offset in &offsets {
                let (distance, gradient) = bend.gradient(offset);
                prop_assert_eq!(distance.to_bits(), bend.distance(offset).to_bits());
                if distance < field.reach() {
                    let step = 1e-3 * length;
                    for axis in Vec3::AXES {
                        let [after, before] =
                            [step, -step].map(|step| bend.distance(offset + axis * step));
                        let slope = (after - before) / (2.0 * step);
                        let off = (slope - gradient.dot(axis)).abs() * bend.thinnest();
                        let is_at_the_axis = distance * bend.thinnest() < 4.0 * step;
                        let [first, last] = [bend.place(offset - axis * step).0, bend.place(offset + axis * step).0];
                        let is_at_an_end = [first, last].iter().any(|t| *t <= 0.0 || *t >= 1.0);
                        prop_assert!(off < 0.02 || is_at_the_axis || is_at_an_end, "{off} at {offset}");
                    }
                    prop_assert!(gradient.length() * bend.thinnest() <= bend.slope, "{}", gradient.length());
                }
                let (range, thin) = bend.range(field, offset, size);
                let bounds = bend.bounds(Vec3::ZERO, field.reach());
                let span = Passage { origin: offset, way: Vec3::X, length: size };
                let span = bend.span(Vec3::ZERO, &span, field.reach());
                for other in &offsets {
                    let near = offset + *other * (size / 2.6);
                    let value = field.value(bend.distance(near));
                    prop_assert!(range.least <= value && value <= range.most, "{value} {range:?}");
                    prop_assert!(thin <= bend.thinnest());
                    prop_assert!(value == 0.0 || bounds.contains(near));
                    let on = offset + Vec3::X * (size * (other.x / 3.0 + 0.5));
                    let felt = field.value(bend.distance(on)) > 0.0;
                    let t = size * (other.x / 3.0 + 0.5);
                    prop_assert!(!felt || span.is_some_and(|(low, high)| low <= t && t <= high));
                }
            }
        }
    }
}
