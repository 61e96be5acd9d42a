//! A crown swept from a silhouette: Wang and others 2014, section 5, "Sketching guidance shape", and figure 6.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::{Bounds, Outline, Shape};
use crate::{ParameterError, math};

/// The crown that a silhouette is the front view of, and perhaps another the side view.
///
/// At every height the silhouette goes from some x to another; around the middle of the two lies a cross
/// profile, a closed curve that reaches them both. Swept from the bottom of the silhouette to its top, the
/// profiles are the crown's surface. If the silhouette has several pieces at a height, each has a profile of
/// its own. Without a side view the crown is as deep as it is wide, in the plane z = 0; with one it reaches
/// the side view's ends.
///
/// Profiles are circles, stretched to the silhouettes, until they are [edited](Self::with_profiles). Heights
/// are those of the front view; parts of a side view above or below it do not count.
///
/// ```
/// use treesynth::{Shape, glam::{Vec2, Vec3}, shape::{CrossProfile, Outline, Sketch}};
///
/// let flame = Outline::smooth([(0.0, 2.0), (2.5, 4.0), (1.0, 8.0), (0.0, 12.0), (-1.5, 7.0), (-2.0, 4.0)].map(Vec2::from));
/// let crown = Sketch::new(flame);
/// assert!(crown.check().is_ok() && crown.contains(Vec3::new(0.0, 4.0, 2.0)));
///
/// // Nothing grows behind the crown's middle in its upper half.
/// let lopsided = CrossProfile::new([1.0, 1.0, 1.0, 1.0, 1.0, 0.1, 0.1, 0.1]);
/// let crown = crown.with_profiles([CrossProfile::ROUND, lopsided, lopsided]);
/// assert!(!crown.contains(Vec3::new(0.0, 8.0, -0.8)) && crown.contains(Vec3::new(0.0, 8.0, 0.8)));
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct Sketch {
    front: Outline,
    side: Option<Outline>,
    profiles: Vec<CrossProfile>,
    bounds: Bounds,
}

/// A closed curve around the middle of a crown: cubic Bézier curves in polar coordinates through eight radii.
///
/// Radii are shares of the way to the silhouettes: 1 reaches the front view's ends at 0 and 180°, the side view's at 90°
/// and 270°, and in between the ellipse through all four.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossProfile {
    radii: [f32; 8],
}

impl Default for CrossProfile {
    fn default() -> Self {
        Self::ROUND
    }
}

impl CrossProfile {
    /// A circle, or an ellipse where width and depth differ.
    pub const ROUND: Self = Self { radii: [1.0; 8] };

    /// The radii at 0, 45, 90, ..., 315°, from +X over +Z; in [0, 10], not all 0.
    pub const fn new(radii: [f32; 8]) -> Self {
        Self { radii }
    }

    /// The radii at 0, 45, 90, ..., 315°.
    pub const fn radii(&self) -> [f32; 8] {
        self.radii
    }

    /// The four controls of the Bézier curve from one radius to the next: Catmull and Rom's, so that there is no kink.
    fn controls(&self, first: usize) -> [f32; 4] {
        let at = |i: usize| self.radii[(first + i) % 8];
        let (before, from, to, after) = (at(7), at(0), at(1), at(2));
        [from, from + (to - before) / 6.0, to - (after - from) / 6.0, to]
    }

    /// The radius at an angle, radians; at least 0.
    pub fn radius(&self, angle: f32) -> f32 {
        let turns = angle / TAU;
        let part = (turns - turns.floor()) * 8.0;
        let first = (part as usize).min(7);
        let (t, s) = (part - first as f32, 1.0 - (part - first as f32));
        let [a, b, c, d] = self.controls(first);
        (a * s * s * s + b * 3.0 * s * s * t + c * 3.0 * s * t * t + d * t * t * t).max(0.0)
    }

    /// No radius is larger.
    fn most(&self) -> f32 {
        (0..8).flat_map(|first| self.controls(first)).fold(0.0, f32::max)
    }

    fn check(&self, name: &str) -> Result<(), ParameterError> {
        let holds = self.radii.iter().all(|radius| (0.0..=10.0).contains(radius));
        let holds = holds && self.radii.iter().any(|&radius| radius > 0.0);
        ParameterError::unless(holds, name, self.radii, "radii in [0, 10], not all 0")
    }
}

impl Sketch {
    /// A crown as deep as wide; the silhouette as it stands, in metres.
    pub fn new(front: Outline) -> Self {
        Self { front, side: None, profiles: vec![CrossProfile::ROUND], bounds: Bounds::EMPTY }.bounded()
    }

    /// Adds the silhouette seen from the side: its x is the crown's z.
    pub fn with_side(mut self, side: Outline) -> Self {
        self.side = Some(side);
        self.bounded()
    }

    /// Sets the cross profiles, 1 to 1000, the first at the bottom of the front view and the last at its top,
    /// the others evenly between; in between radii change linearly. One round profile by default.
    pub fn with_profiles(mut self, profiles: impl Into<Vec<CrossProfile>>) -> Self {
        self.profiles = profiles.into();
        self.bounded()
    }

    /// The silhouette from the front.
    pub fn front(&self) -> &Outline {
        &self.front
    }

    /// The silhouette from the side, if there is one.
    pub fn side(&self) -> Option<&Outline> {
        self.side.as_ref()
    }

    /// The cross profiles, from the bottom to the top.
    pub fn profiles(&self) -> &[CrossProfile] {
        &self.profiles
    }

    /// `true` if a point lies in the profile at the height `y`; `offset` is its position relative to the
    /// middle, in shares of the silhouettes' reach.
    fn profile_holds(&self, y: f32, offset: Vec2) -> bool {
        let square = offset.length_squared();
        if self.profiles.iter().all(|profile| *profile == CrossProfile::ROUND) {
            return square <= 1.0;
        }
        let angle = math::atan2(offset.y, offset.x);
        let (low, high) = (self.front.min().y, self.front.max().y);
        let last = self.profiles.len().saturating_sub(1);
        let place = (y - low) / (high - low) * last as f32;
        let first = (place as usize).min(last);
        let radius = |i: usize| self.profiles.get(i.min(last)).map_or(0.0, |profile| profile.radius(angle));
        let reach = radius(first) + (radius(first + 1) - radius(first)) * (place - first as f32);
        square <= reach * reach
    }

    /// Updates the bounds.
    fn bounded(mut self) -> Self {
        let most = self.most();
        let (low, high) = (self.front.min(), self.front.max());
        let across = overhang(&self.front, most);
        let (near, far) = match &self.side {
            None => (-0.5 * (high.x - low.x) * most, 0.5 * (high.x - low.x) * most),
            Some(side) => (side.min().x - overhang(side, most), side.max().x + overhang(side, most)),
        };
        self.bounds =
            Bounds::new(Vec3::new(low.x - across, low.y, near), Vec3::new(high.x + across, high.y, far));
        self
    }

    fn most(&self) -> f32 {
        self.profiles.iter().map(CrossProfile::most).fold(0.0, f32::max)
    }
}

/// Distance by which the ends of a silhouette's box move outward if radii go up to `most`.
fn overhang(outline: &Outline, most: f32) -> f32 {
    0.5 * (outline.max().x - outline.min().x) * (most - 1.0).max(0.0)
}

impl Shape for Sketch {
    fn contains(&self, point: Vec3) -> bool {
        if !self.bounds.contains(point) {
            return false;
        }
        let share = |at: f32, (from, to): (f32, f32)| (2.0 * at - from - to) / (to - from);
        self.front.spans(point.y).into_iter().any(|across| match &self.side {
            None => {
                let depth = 2.0 * point.z / (across.1 - across.0);
                self.profile_holds(point.y, Vec2::new(share(point.x, across), depth))
            }
            Some(side) => side.spans(point.y).into_iter().any(|along| {
                self.profile_holds(point.y, Vec2::new(share(point.x, across), share(point.z, along)))
            }),
        })
    }

    fn bounds(&self) -> Bounds {
        self.bounds
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.front.check()?;
        let count = self.profiles.len();
        ParameterError::unless((1..=1000).contains(&count), "Sketch.profiles", count, "from 1 to 1000")?;
        for (number, profile) in self.profiles.iter().enumerate() {
            profile.check(&format!("Sketch.profiles[{number}]"))?;
        }
        let Some(side) = &self.side else { return Ok(()) };
        side.check()?;
        let (low, high) = (self.front.min().y, self.front.max().y);
        let holds = side.min().y < high && side.max().y > low;
        let range = format!("partly between the heights of the front view, {low} and {high} metres");
        ParameterError::unless(holds, "Sketch.side", (side.min().y, side.max().y), &range)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, stream};
    use crate::shape::Ellipsoid;

    fn ellipse(center: Vec2, half: Vec2) -> Outline {
        let corners: Vec<Vec2> = (0..200)
            .map(|i| {
                let (sin, cos) = math::sin_cos(TAU * i as f32 / 200.0);
                center + Vec2::new(cos, sin) * half
            })
            .collect();
        Outline::new(corners)
    }

    /// Ellipses from the front and from the side are an ellipsoid.
    #[test]
    fn two_ellipses_are_an_ellipsoid() {
        let sketch = Sketch::new(ellipse(Vec2::new(1.0, 5.0), Vec2::new(2.0, 3.0)))
            .with_side(ellipse(Vec2::new(-1.0, 5.0), Vec2::new(1.0, 3.0)));
        let exact = Ellipsoid::new(Vec3::new(1.0, 5.0, -1.0), Vec3::new(2.0, 3.0, 1.0));
        assert_eq!(sketch.check(), Ok(()));
        assert!((sketch.volume() / exact.volume() - 1.0).abs() < 0.01);
        let mut random = stream(1, 0, Purpose::CUSTOM, 0);
        let differ = (0..2000)
            .filter(|_| {
                let point = crate::shape::Cuboid::from(exact.bounds()).sample(&mut random).expect("a box");
                sketch.contains(point) != exact.contains(point)
            })
            .count();
        assert!(differ < 10, "{differ} of 2000 points");
        let round = Sketch::new(ellipse(Vec2::Y * 5.0, Vec2::new(2.0, 3.0)));
        assert!(round.contains(Vec3::new(0.0, 5.0, 1.99)) && !round.contains(Vec3::new(1.5, 5.0, 1.5)));
    }

    #[test]
    fn profiles_pass_their_radii_without_kinks() {
        let profile = CrossProfile::new([1.0, 0.5, 2.0, 1.0, 0.2, 1.0, 1.5, 0.7]);
        for (i, radius) in profile.radii().into_iter().enumerate() {
            let at = (TAU / 8.0) * i as f32;
            assert!((profile.radius(at) - radius).abs() < 1e-4);
            let slope = |from: f32| (profile.radius(from + 1e-3) - profile.radius(from)) / 1e-3;
            assert!((slope(at) - slope(at - 1e-3)).abs() < 0.03, "{} {}", slope(at), slope(at - 1e-3));
        }
        let most = (0..1000).map(|i| profile.radius(TAU * i as f32 / 1000.0)).fold(0.0, f32::max);
        assert!(most <= profile.most() && profile.most() < 1.2 * most);
        assert!((CrossProfile::ROUND.radius(1.234) - 1.0).abs() < 1e-6);
    }

    /// An edit at the top changes nothing at the base, and the bounds hold what sticks out.
    #[test]
    fn edited_profiles_make_a_crown_uneven() {
        let plain = Sketch::new(ellipse(Vec2::Y * 5.0, Vec2::new(2.0, 3.0)));
        let wide = CrossProfile::new([1.0, 1.0, 3.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
        let edited = plain.clone().with_profiles([CrossProfile::ROUND, CrossProfile::ROUND, wide]);
        let mut random = stream(2, 0, Purpose::CUSTOM, 0);
        let around = crate::shape::Cuboid::from(edited.bounds().grown(2.0));
        for _ in 0..5000 {
            let point = around.sample(&mut random).expect("a box");
            assert!(!edited.contains(point) || edited.bounds().contains(point));
            // 45° to either side of +Z.
            let ahead = point.z > point.x.abs() && point.y > 5.0;
            assert!(ahead || edited.contains(point) == plain.contains(point), "{point}");
        }
        let ahead = Vec3::new(0.0, 6.5, 2.2);
        assert!(edited.contains(ahead) && !plain.contains(ahead));
    }

    /// Two lobes side by side are two crowns at that height, not one over the gap.
    #[test]
    fn lobes_stay_apart() {
        let u = [
            (-3.0, 0.0),
            (3.0, 0.0),
            (3.0, 4.0),
            (1.0, 4.0),
            (1.0, 1.0),
            (-1.0, 1.0),
            (-1.0, 4.0),
            (-3.0, 4.0),
        ];
        let sketch = Sketch::new(Outline::new(u.map(Vec2::from)));
        assert!(sketch.contains(Vec3::new(2.0, 3.0, 0.9)) && sketch.contains(Vec3::new(-2.0, 3.0, -0.9)));
        assert!(!sketch.contains(Vec3::new(0.0, 3.0, 0.0)) && !sketch.contains(Vec3::new(2.0, 3.0, 1.1)));
        assert!(sketch.contains(Vec3::new(0.0, 0.5, 2.5)), "as deep as wide below");
    }

    #[test]
    fn what_is_wrong_is_named() {
        let good = || ellipse(Vec2::Y * 5.0, Vec2::new(2.0, 3.0));
        let named = |sketch: Sketch| sketch.check().map_err(|error| error.parameter);
        let crossed = Outline::new([(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)].map(Vec2::from));
        assert_eq!(named(Sketch::new(crossed.clone())), Err("Outline.contours[0]".into()));
        assert_eq!(named(Sketch::new(good()).with_side(crossed)), Err("Outline.contours[0]".into()));
        let above = ellipse(Vec2::Y * 50.0, Vec2::ONE);
        assert_eq!(named(Sketch::new(good()).with_side(above)), Err("Sketch.side".into()));
        assert_eq!(named(Sketch::new(good()).with_profiles([])), Err("Sketch.profiles".into()));
        for bad in [[0.0; 8], [f32::NAN; 8], [-1.0; 8], [11.0; 8]] {
            let sketch = Sketch::new(good()).with_profiles([CrossProfile::ROUND, CrossProfile::new(bad)]);
            assert_eq!(sketch.check().map_err(|error| error.parameter), Err("Sketch.profiles[1]".into()));
            assert!(!sketch.contains(Vec3::NAN));
        }
    }
}
