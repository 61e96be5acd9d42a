//! The axis-aligned box around something.

use glam::Vec3;

/// An axis-aligned box as a plain value, metres: what a [`Shape`](super::Shape) lies within.
///
/// A closed set: its faces belong to it. A box with a `min` above its `max` on some axis holds nothing, and
/// neither does one with NaN in it. As a region for a tree to grow in, use [`Cuboid`](super::Cuboid).
///
/// ```
/// use treesynth::{Bounds, glam::Vec3};
///
/// let crown = Bounds::new(Vec3::new(-2.0, 1.0, -2.0), Vec3::new(2.0, 6.0, 2.0));
/// assert_eq!(crown.size(), Vec3::new(4.0, 5.0, 4.0));
/// assert!(crown.contains(crown.center()));
/// ```
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Bounds {
    /// The corner with the smallest coordinates, metres.
    pub min: Vec3,
    /// The corner with the largest coordinates, metres.
    pub max: Vec3,
}

impl Bounds {
    /// The box of nothing; the neutral element of [`union`](Self::union).
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The box between two corners, metres. Any values are allowed; they are not put in order.
    pub const fn new(min: Vec3, max: Vec3) -> Self {
        Self { min, max }
    }

    /// The box `half_size` metres to each side of `center`.
    pub fn around(center: Vec3, half_size: Vec3) -> Self {
        Self { min: center - half_size, max: center + half_size }
    }

    /// The smallest box that holds all `points`; [`EMPTY`](Self::EMPTY) if there are none. O(n).
    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Self {
        points
            .into_iter()
            .fold(Self::EMPTY, |bounds, point| Self::new(bounds.min.min(point), bounds.max.max(point)))
    }

    /// The eight corners, those of `min.z` first.
    pub fn corners(self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let side = |axis: usize| if i >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            Vec3::new(side(0), side(1), side(2))
        })
    }

    /// `true` if no point lies in the box: `min` above `max` on some axis, or NaN.
    pub fn is_empty(self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// `true` if both corners are free of NaN and infinities.
    pub fn is_finite(self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }

    /// Width, height and depth in metres; zero along an axis where `min` is above `max`.
    pub fn size(self) -> Vec3 {
        (self.max - self.min).max(Vec3::ZERO)
    }

    /// The middle, metres. Not meaningful, but no panic either, for a box that is empty or not finite.
    pub fn center(self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Volume in cubic metres; 0 for an empty box and for a flat one, however large, and never NaN.
    pub fn volume(self) -> f32 {
        if self.is_empty() || self.min.cmpeq(self.max).any() {
            return 0.0;
        }
        // In `f64` no product of `f32`s overflows or underflows on the way.
        let side = |axis: usize| f64::from(self.max[axis]) - f64::from(self.min[axis]);
        (side(0) * side(1) * side(2)) as f32
    }

    /// `true` if `point` (metres) lies in the box or on its surface; `false` for NaN and infinities.
    pub fn contains(self, point: Vec3) -> bool {
        point.is_finite() && self.min.cmple(point).all() && point.cmple(self.max).all()
    }

    /// `true` if all of `other` lies in this box; an empty box lies in every box.
    pub fn encloses(self, other: Self) -> bool {
        other.is_empty() || (self.min.cmple(other.min).all() && other.max.cmple(self.max).all())
    }

    /// The smallest box that holds both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Intersection; [empty](Self::is_empty) if nothing lies in both.
    pub fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// The box moved by `offset` metres.
    pub fn translated(self, offset: Vec3) -> Self {
        Self { min: self.min + offset, max: self.max + offset }
    }

    /// The box with every face moved outwards by `margin` metres; inwards if negative, which may empty it.
    pub fn grown(self, margin: f32) -> Self {
        Self { min: self.min - Vec3::splat(margin), max: self.max + Vec3::splat(margin) }
    }

    /// The point at a fraction of the way from `min` to `max` on each axis; in the box for fractions in
    /// [0, 1], rounding included.
    pub fn at(self, fraction: Vec3) -> Vec3 {
        let point = self.min * (Vec3::ONE - fraction) + self.max * fraction;
        point.max(self.min).min(self.max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Bounds = Bounds::new(Vec3::ZERO, Vec3::ONE);

    #[test]
    fn empty_is_neutral_and_holds_nothing() {
        assert!(Bounds::EMPTY.is_empty() && !Bounds::EMPTY.is_finite());
        assert_eq!(Bounds::EMPTY.union(UNIT), UNIT);
        assert_eq!(Bounds::EMPTY.size(), Vec3::ZERO);
        assert_eq!(Bounds::EMPTY.volume().to_bits(), 0);
        assert!(!Bounds::EMPTY.contains(Vec3::ZERO));
        assert_eq!(Bounds::of([]), Bounds::EMPTY);
        assert!(UNIT.encloses(Bounds::EMPTY));
    }

    #[test]
    fn nan_is_in_no_box_and_fills_none() {
        assert!(!UNIT.contains(Vec3::new(0.5, f32::NAN, 0.5)));
        let all = Bounds::new(Vec3::NEG_INFINITY, Vec3::INFINITY);
        assert!(all.contains(Vec3::MAX) && !all.contains(Vec3::INFINITY) && all.encloses(all));
        let broken = Bounds::new(Vec3::NAN, Vec3::ONE);
        assert!(broken.is_empty() && !broken.is_finite() && !broken.contains(Vec3::ONE));
        assert_eq!(broken.volume().to_bits(), 0);
    }

    #[test]
    fn combinations() {
        let moved = UNIT.translated(Vec3::splat(0.5));
        assert_eq!(UNIT.union(moved), Bounds::new(Vec3::ZERO, Vec3::splat(1.5)));
        assert_eq!(UNIT.intersection(moved), Bounds::new(Vec3::splat(0.5), Vec3::ONE));
        assert!(UNIT.intersection(UNIT.translated(Vec3::X * 2.0)).is_empty());
        assert_eq!(Bounds::of([Vec3::ONE, Vec3::ZERO]), UNIT);
        assert_eq!(Bounds::around(Vec3::splat(0.5), Vec3::splat(0.5)), UNIT);
        assert!(UNIT.grown(0.1).encloses(UNIT) && !UNIT.encloses(UNIT.grown(0.1)));
        assert!(UNIT.grown(-0.6).is_empty());
        assert_eq!(UNIT.at(Vec3::new(0.0, 0.5, 1.0)), Vec3::new(0.0, 0.5, 1.0));
    }

    #[test]
    fn center_and_fraction_do_not_overflow() {
        let huge = Bounds::new(Vec3::splat(f32::MIN), Vec3::MAX);
        assert_eq!(huge.center(), Vec3::ZERO);
        assert!(huge.contains(huge.at(Vec3::splat(0.999_999))));
        let flat = Bounds::new(huge.min.with_y(0.0), huge.max.with_y(0.0));
        assert_eq!(flat.volume().to_bits(), 0, "not infinity times zero");
        let needle = Bounds::new(Vec3::ZERO, Vec3::new(1e-38, 1e-10, f32::MAX));
        assert!(needle.volume() > 0.0, "no underflow on the way");
    }
}
