//! The ground.

use crate::ParameterError;
use crate::shape::{Bounds, LARGEST, Shape};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// The ground of a forest: how high it lies above each point of the plane y = 0.
///
/// Any function of x and z is one:
///
/// ```
/// use treesynth::glam::Vec3;
/// use treesynth::self_organizing::{Forest, Habit, ShadowPropagation};
///
/// let slope = |x: f32, _z: f32| 0.5 * x;
/// let mut forest = Forest::new(ShadowPropagation::default(), Habit::default(), 1).with_terrain(slope);
/// forest.plant(Vec3::new(1.0, 0.0, 0.0))?;
/// assert_eq!(forest.trees()[0].foot(), Vec3::new(1.0, 0.5, 0.0));
/// # Ok::<(), treesynth::self_organizing::ForestError>(())
/// ```
///
/// # Contract
/// The same height for the same point, always. Where it is not finite nothing is planted and nothing grows.
pub trait Terrain: Send + Sync {
    /// The height at (x, z), all in metres.
    fn height(&self, x: f32, z: f32) -> f32;

    /// Checks that the options are in range.
    ///
    /// # Errors
    /// The first that is not.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

impl<F: Fn(f32, f32) -> f32 + Send + Sync> Terrain for F {
    fn height(&self, x: f32, z: f32) -> f32 {
        self(x, z)
    }
}

/// Heights on a square lattice, interpolated between; beyond its edge as on the edge.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Heightmap {
    corner: Vec2,
    spacing: f32,
    columns: u32,
    heights: Vec<f32>,
}

impl Heightmap {
    /// `heights` in metres, row by row: `columns` of them along x from `corner` (x and z, metres) on, `spacing` metres
    /// apart, then the next row in z. At least one row of one, all full, finite and within a million metres.
    pub fn new(corner: Vec2, spacing: f32, columns: u32, heights: Vec<f32>) -> Self {
        Self { corner, spacing, columns, heights }
    }

    fn at(&self, column: usize, row: usize) -> f32 {
        self.heights.get(row * self.columns as usize + column).copied().unwrap_or(f32::NAN)
    }
}

impl Terrain for Heightmap {
    fn height(&self, x: f32, z: f32) -> f32 {
        let rows = self.heights.len() / self.columns.max(1) as usize;
        let most = Vec2::new(self.columns.saturating_sub(1) as f32, rows.saturating_sub(1) as f32);
        let place = ((Vec2::new(x, z) - self.corner) / self.spacing).clamp(Vec2::ZERO, most);
        let (column, row) = (place.x as usize, place.y as usize);
        let (next, below) = ((column + 1).min(most.x as usize), (row + 1).min(most.y as usize));
        let (a, b) = (place.x - column as f32, place.y - row as f32);
        let along = |row: usize| self.at(column, row) * (1.0 - a) + self.at(next, row) * a;
        along(row) * (1.0 - b) + along(below) * b
    }

    fn check(&self) -> Result<(), ParameterError> {
        let (columns, spacing) = (self.columns as usize, self.spacing);
        let holds = self.corner.abs().max_element() <= LARGEST;
        ParameterError::unless(holds, "Heightmap.corner", self.corner, "within a million metres")?;
        let holds = (1e-6..=LARGEST).contains(&spacing);
        ParameterError::unless(holds, "Heightmap.spacing", spacing, "in [1e-6, 1e6] metres")?;
        let holds = columns > 0 && !self.heights.is_empty() && self.heights.len().is_multiple_of(columns);
        ParameterError::unless(holds, "Heightmap.columns", columns, "a part of the number of heights")?;
        let wrong = self.heights.iter().find(|height| height.is_nan() || height.abs() > LARGEST);
        ParameterError::unless(wrong.is_none(), "Heightmap.heights", wrong, "finite, within a million metres")
    }
}

/// Ground below a terrain, as an obstacle.
pub(super) struct Below(pub(super) Arc<dyn Terrain>);

impl Shape for Below {
    fn contains(&self, point: Vec3) -> bool {
        point.is_finite() && point.y < self.0.height(point.x, point.z)
    }

    fn bounds(&self) -> Bounds {
        Bounds::around(Vec3::ZERO, Vec3::splat(LARGEST))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heightmap_goes_through_its_heights_and_straight_between() {
        let map = Heightmap::new(Vec2::new(-1.0, 2.0), 2.0, 3, vec![0.0, 1.0, 4.0, 2.0, 3.0, 6.0]);
        assert!(map.check().is_ok());
        assert!((map.height(-1.0, 2.0) - 0.0).abs() < 1e-6);
        assert!((map.height(3.0, 4.0) - 6.0).abs() < 1e-6);
        assert!((map.height(0.0, 3.0) - 1.5).abs() < 1e-6);
        // Beyond the edge it is flat.
        assert!((map.height(-9.0, -9.0) - 0.0).abs() < 1e-6);
        assert!((map.height(9.0, 9.0) - 6.0).abs() < 1e-6);
        assert!(Heightmap::new(Vec2::ZERO, 1.0, 2, vec![0.0; 3]).check().is_err());
        assert!(Heightmap::new(Vec2::ZERO, 1.0, 1, vec![f32::NAN]).check().is_err());
        assert!(Heightmap::new(Vec2::ZERO, 0.0, 1, vec![0.0]).check().is_err());
        assert!(Heightmap::new(Vec2::ZERO, 1.0, 0, vec![]).check().is_err());
    }
}
