//! A painted stroke.

use glam::Vec3;

use super::{Bounds, Shape, check_length, check_position};
use crate::ParameterError;

/// All points within a radius of a line through points: what a round brush paints, for limbs, hedges and crowns that are
/// drawn by hand.
///
/// ```
/// use treesynth::{Shape, glam::Vec3, shape::Brush};
///
/// let stroke = Brush::new(vec![Vec3::ZERO, Vec3::Y * 2.0, Vec3::new(1.0, 3.0, 0.0)], 0.25);
/// assert!(stroke.contains(Vec3::new(0.2, 1.0, 0.0)) && stroke.contains(Vec3::new(0.5, 2.5, 0.2)));
/// assert!(!stroke.contains(Vec3::new(0.3, 1.0, 0.0)));
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Brush {
    points: Vec<Vec3>,
    radius: f32,
}

impl Brush {
    /// Through `points`, metres, at least one, at most 1e6 from 0 on each axis; `radius` metres thick.
    pub const fn new(points: Vec<Vec3>, radius: f32) -> Self {
        Self { points, radius }
    }

    /// The points it goes through.
    pub fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// Half of its thickness, metres.
    pub const fn radius(&self) -> f32 {
        self.radius
    }
}

impl Shape for Brush {
    fn contains(&self, point: Vec3) -> bool {
        let near = |from: Vec3, to: Vec3| {
            let along = to - from;
            let way =
                ((point - from).dot(along) / along.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
            point.distance_squared(from + along * way) <= self.radius * self.radius
        };
        point.is_finite()
            && (self.points.windows(2).any(|ends| near(ends[0], ends[1]))
                || self.points.first().is_some_and(|&only| near(only, only)))
    }

    fn bounds(&self) -> Bounds {
        let bounds = Bounds::of(self.points.iter().copied());
        if bounds.is_empty() {
            bounds
        } else {
            Bounds::new(bounds.min - self.radius, bounds.max + self.radius)
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(!self.points.is_empty(), "Brush.points", 0, "at least 1 point")?;
        self.points.iter().try_for_each(|&point| check_position("Brush.points", point))?;
        check_length("Brush.radius", self.radius)
    }
}
