//! Points that a scanner has measured: read, written, thinned.

mod file;
mod frame;
#[cfg(feature = "lidar")]
mod lidar;
#[cfg(test)]
mod tests;

pub use file::PlyEncoding;
pub use frame::Frame;

use std::io;

use glam::{DVec3, Vec3};

use crate::ParameterError;
use crate::shape::{Bounds, LARGEST};

/// Points in metres and +Y up, and the offset that was taken off their coordinates in the file.
///
/// Memory: 12 bytes per point.
///
/// ```
/// use treesynth::{cloud::Cloud, glam::Vec3};
///
/// let cloud = Cloud::new(vec![Vec3::ZERO, Vec3::Y * 1.02, Vec3::Y * 1.05])?;
/// assert_eq!(cloud.thinned(0.1)?.len(), 2);
/// # Ok::<(), treesynth::cloud::CloudError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Cloud {
    points: Vec<Vec3>,
    offset: DVec3,
}

/// Error of making, reading or writing a cloud.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CloudError {
    /// The reader or writer failed.
    #[error("reading or writing failed: {0}")]
    Io(#[from] io::Error),
    /// An option out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A point that is not finite, or too far off.
    #[error(
        "point {point} is at {position}, but must be finite and at most 1e6 m from 0 on every axis; Cloud::from_places takes the offset of a survey off"
    )]
    Position {
        /// The point, from 0.
        point: usize,
        /// Position, metres.
        position: Vec3,
    },
    /// A file that cannot be read.
    #[error("{format}, {place}: {problem}")]
    File {
        /// The format's name.
        format: &'static str,
        /// The line or byte.
        place: String,
        /// Description of what was found and what is required.
        problem: String,
    },
}

impl Cloud {
    /// Points in metres and +Y up; there may be none. Numbers of `f32` are 0.06 mm apart at 1 km from 0, and 3 cm at
    /// 500 km: coordinates of a survey go through [`from_places`](Self::from_places), which takes their offset off.
    ///
    /// # Errors
    /// A point that is not finite, or more than 1e6 m from 0 on an axis.
    pub fn new(points: Vec<Vec3>) -> Result<Self, CloudError> {
        let within = |position: &Vec3| position.abs().cmple(Vec3::splat(LARGEST)).all();
        if let Some(point) = points.iter().position(|position| !within(position)) {
            return Err(CloudError::Position { point, position: points[point] });
        }
        Ok(Self { points, offset: DVec3::ZERO })
    }

    /// Points as they stand in a file or an array of measurements.
    ///
    /// # Errors
    /// A frame out of range; a point that is not finite, or too far from the offset.
    pub fn from_places(frame: &Frame, places: &[DVec3]) -> Result<Self, CloudError> {
        frame.check()?;
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &place in places {
            (low, high) = (low.min(place), high.max(place));
        }
        let offset = frame.offset_of(low, high);
        let offset = offset.map_err(|problem| file::fault("points", "all", problem))?;
        let mut points = Vec::with_capacity(places.len());
        for (point, &place) in places.iter().enumerate() {
            let place = frame.local(place, offset);
            points.push(
                place.map_err(|problem| file::fault("points", format_args!("point {point}"), problem))?,
            );
        }
        Ok(Self { points, offset })
    }

    /// The points, metres, +Y up.
    pub fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// The points themselves.
    pub fn into_points(self) -> Vec<Vec3> {
        self.points
    }

    /// Offset that was taken off the file's coordinates, in its axes and unit;
    /// [`Frame::with_offset`] adds it again.
    pub fn offset(&self) -> DVec3 {
        self.offset
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// `true` if there are no points.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The box around the points; `None` without any. O(n).
    pub fn bounds(&self) -> Option<Bounds> {
        let first = *self.points.first()?;
        let (min, max) = self.points.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p)));
        Some(Bounds { min, max })
    }

    /// One point of each cube of a side, metres, 1e-4 to 1e3: the first. They keep their order. O(n log n).
    ///
    /// # Errors
    /// A side out of range.
    pub fn thinned(&self, side: f32) -> Result<Self, CloudError> {
        ParameterError::unless(
            (1e-4..=1e3).contains(&side),
            "side of a thinned cloud's cubes",
            side,
            "1e-4 to 1e3 m",
        )?;
        let points = first_of_cubes(&self.points, side).into_iter().map(|point| self.points[point as usize]);
        Ok(Self { points: points.collect(), offset: self.offset })
    }
}

/// The cube of a point, as one number: 42 bits per axis, enough for 1e6 m in steps of 1e-6 m.
pub(crate) fn cube(point: Vec3, side: f32) -> u128 {
    let [x, y, z] =
        (point.as_dvec3() / f64::from(side)).floor().to_array().map(|at| (at as i64 + (1 << 41)) as u128);
    (x << 84) | (y << 42) | z
}

/// The first point of each cube, ascending.
pub(crate) fn first_of_cubes(points: &[Vec3], side: f32) -> Vec<u32> {
    let mut keys: Vec<(u128, u32)> = (0..).zip(points).map(|(i, &point)| (cube(point, side), i)).collect();
    keys.sort_unstable();
    keys.dedup_by_key(|(cube, _)| *cube);
    let mut kept: Vec<u32> = keys.into_iter().map(|(_, point)| point).collect();
    kept.sort_unstable();
    kept
}
