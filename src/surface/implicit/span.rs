//! Parts of a ray in which it may meet something.

use glam::Vec3;

/// More than what rounding may change in a distance, as a share of the coordinates.
const ROUNDING: f32 = 8.0 * f32::EPSILON;
/// A sine below which two lines count as parallel, its square.
const PARALLEL: f32 = 1e-4;

/// The points `origin + way * t` for t from 0 to `length`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Passage {
    pub(crate) origin: Vec3,
    pub(crate) way: Vec3,
    pub(crate) length: f32,
}

/// The first and the last t of what may be met.
pub(crate) type Span = (f32, f32);

impl Passage {
    /// The part of it that is within `reach` of the line `from + axis * s`, s from 0 to 1, or a little beyond
    /// that. `inverse` is one over the axis' square, or 0 for a point.
    pub(crate) fn near(&self, from: Vec3, axis: Vec3, inverse: f32, reach: f32) -> Option<Span> {
        let rounding = self.origin.abs().max_element() + from.abs().max_element() + axis.abs().max_element();
        let reach = 1.01 * reach + ROUNDING * rounding;
        let offset = self.origin - from;
        let (start, change) = (offset.dot(axis) * inverse, self.way.dot(axis) * inverse);
        // Across the axis.
        let (across, aside) = (offset - axis * start, self.way - axis * change);
        let square = aside.length_squared();
        let (mut low, mut high) = (0.0, self.length);
        if square > PARALLEL * self.way.length_squared() {
            let middle = -across.dot(aside) / square;
            let rest = reach * reach - (across + aside * middle).length_squared();
            if rest < 0.0 {
                return None;
            }
            let half = (rest / square).sqrt();
            (low, high) = (f32::max(low, middle - half), f32::min(high, middle + half));
        } else if across.length() > reach + square.sqrt() * self.length {
            return None;
        }
        // Along the axis, at whose ends there are balls.
        let beyond = reach * inverse.sqrt();
        if change == 0.0 {
            if start < -beyond || start > 1.0 + beyond {
                return None;
            }
        } else {
            let ends = [(-beyond - start) / change, (1.0 + beyond - start) / change];
            (low, high) = (low.max(ends[0].min(ends[1])), high.min(ends[0].max(ends[1])));
        }
        (low <= high).then_some((low, high))
    }
}

/// The span from the first to the last place of some spans.
pub(crate) fn hull(spans: impl Iterator<Item = Option<Span>>) -> Option<Span> {
    spans.flatten().reduce(|all, next| (all.0.min(next.0), all.1.max(next.1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn place(range: f32) -> impl Strategy<Value = Vec3> {
        [-range..range, -range..range, -range..range].prop_map(Vec3::from_array)
    }

    proptest! {
        #[test]
        fn nothing_near_is_left_out(
            (origin, way, from, axis) in (place(2.0), place(1.0), place(2.0), place(1.0)),
            is_point: bool,
            is_parallel: bool,
            (reach, length) in (0.001f32..1.0, 0.01f32..4.0),
        ) {
            let axis = if is_point { Vec3::ZERO } else { axis };
            let inverse = if is_point { 0.0 } else { 1.0 / axis.length_squared() };
            let way = if is_parallel && !is_point { axis * 0.9 + way * 1e-3 } else { way };
            let passage = Passage { origin, way: way.normalize(), length };
            let span = passage.near(from, axis, inverse, reach);
            for i in 0..=200 {
                // The last place would lie an ulp beyond the end.
                let t = (length * i as f32 / 200.0).min(length);
                let offset = origin + passage.way * t - from;
                let s = (offset.dot(axis) * inverse).clamp(0.0, 1.0);
                let is_near = (offset - axis * s).length() <= reach;
                let is_within = span.is_some_and(|(low, high)| low <= t && t <= high);
                prop_assert!(!is_near || is_within, "{t} not in {span:?}");
            }
            if let Some((low, high)) = span {
                prop_assert!(0.0 <= low && high <= length);
            }
        }
    }

    #[test]
    fn what_is_far_is_left_out() {
        let across = Passage { origin: Vec3::new(-5.0, 0.5, 0.0), way: Vec3::X, length: 10.0 };
        let (low, high) = across.near(Vec3::ZERO, Vec3::Y, 1.0, 0.1).expect("met");
        assert!((4.89..4.9).contains(&low) && (5.1..5.11).contains(&high), "{low} {high}");
        assert_eq!(across.near(Vec3::Z, Vec3::Y, 1.0, 0.1), None);
        assert_eq!(across.near(Vec3::Y, Vec3::Y, 1.0, 0.1), None);
        assert_eq!(Passage { length: 4.0, ..across }.near(Vec3::ZERO, Vec3::Y, 1.0, 0.1), None);
    }
}
