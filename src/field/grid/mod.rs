//! Fields that a simulation has computed: vectors on a grid.

mod vtk;

use std::sync::Arc;

use glam::Vec3;

use super::{VectorField, check_position};
use crate::ParameterError;

/// Most samples of a grid: 3.2 GB of memory.
const MOST_SAMPLES: usize = 1 << 28;
/// Largest component of a sample, so that no sum of products overflows.
const LARGEST: f32 = 1e18;

/// Vectors on a regular grid, trilinear in between: the wind or the light of a simulation.
///
/// Sample (i, j, k) lies at `origin + spacing * (i, j, k)`; samples are in the order of x, then y, then z:
/// number `i + nx * (j + ny * k)`. An axis may have a single sample; the field is then constant along it. Up is +Y, as everywhere in this crate.
///
/// Outside of the grid the field is that of the nearest point of the grid, or zero after
/// [`with_zero_outside`](Self::with_zero_outside); zero pulls nowhere, and
/// [`FollowField`](crate::guided::FollowField) then keeps the direction of the node before.
///
/// Unlike the other fields it is checked where it is made, and [`check`](VectorField::check) has nothing left
/// to say. [`read_vtk`](Self::read_vtk) reads files, [`write_vtk`](Self::write_vtk) writes them. Cloning
/// shares the samples. Memory: 12 bytes per sample; [`at`](VectorField::at) takes O(1).
///
/// ```
/// use treesynth::{VectorField, field::GridField, glam::Vec3};
///
/// // Two samples along x, one along y and z.
/// let wind = GridField::new(Vec3::ZERO, Vec3::ONE, [2, 1, 1], vec![Vec3::X, Vec3::X + Vec3::Y])?;
/// assert_eq!(wind.at(Vec3::new(0.25, 7.0, -3.0)), Vec3::new(1.0, 0.25, 0.0));
/// # Ok::<(), treesynth::field::GridFieldError>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct GridField {
    origin: Vec3,
    spacing: Vec3,
    dimensions: [usize; 3],
    samples: Arc<[Vec3]>,
    zero_outside: bool,
}

crate::recipe::readable!(GridField { zero_outside: bool });

/// Error of making a field from a grid.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GridFieldError {
    /// Origin, spacing or dimensions out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The number of samples is not that of the dimensions.
    #[error("the grid has {expected} samples, but {count} are given")]
    Count {
        /// The product of the dimensions.
        expected: usize,
        /// Number of vectors given.
        count: usize,
    },
    /// A sample that is NaN, infinite or too large.
    #[error("sample {index} is {sample}, but must be finite and at most 1e18 in each component")]
    Sample {
        /// The number of the sample, from 0.
        index: usize,
        /// Its value.
        sample: Vec3,
    },
    /// A line of a file is not what it has to be.
    #[error("line {line}: {message}")]
    Line {
        /// The line, from 1.
        line: usize,
        /// Description of the fault.
        message: String,
    },
    /// The binary part of a file is not what it has to be.
    #[error("byte {byte}: {message}")]
    Byte {
        /// The byte, from 0.
        byte: u64,
        /// Description of the fault.
        message: String,
    },
    /// The reader or the writer refused.
    #[error("{0}")]
    Io(#[from] std::io::Error),
}

impl GridField {
    /// Samples in the order x, y, z on a grid of `dimensions`; `origin` and `spacing` in metres.
    ///
    /// # Errors
    /// An origin beyond 1e6 m, a spacing not within 1e-6 to 1e6 m, dimensions of 0 or more than 2²⁸ samples in all;
    /// another number of samples than the dimensions say; samples that are not finite or beyond 1e18.
    pub fn new(
        origin: Vec3,
        spacing: Vec3,
        dimensions: [usize; 3],
        samples: Vec<Vec3>,
    ) -> Result<Self, GridFieldError> {
        let expected = check(origin, spacing, dimensions)?;
        if samples.len() != expected {
            return Err(GridFieldError::Count { expected, count: samples.len() });
        }
        if let Some(index) = samples.iter().position(|&sample| !is_usable(sample)) {
            return Err(GridFieldError::Sample { index, sample: samples[index] });
        }
        Ok(Self { origin, spacing, dimensions, samples: samples.into(), zero_outside: false })
    }

    /// Another field, taken at the points of a grid: cheap to ask where the other is dear, and ready to be
    /// [written](Self::write_vtk).
    ///
    /// # Errors
    /// As of [`new`](Self::new), and what the field's own check says.
    pub fn sampled(
        field: &impl VectorField,
        origin: Vec3,
        spacing: Vec3,
        dimensions: [usize; 3],
    ) -> Result<Self, GridFieldError> {
        field.check()?;
        let count = check(origin, spacing, dimensions)?;
        let [nx, ny, _] = dimensions;
        let place = |n: usize| Vec3::new((n % nx) as f32, (n / nx % ny) as f32, (n / nx / ny) as f32);
        let samples = (0..count).map(|n| field.at(origin + spacing * place(n))).collect();
        Self::new(origin, spacing, dimensions, samples)
    }

    /// Zero outside of the grid, instead of what the nearest point of the grid has.
    pub fn with_zero_outside(mut self) -> Self {
        self.zero_outside = true;
        self
    }

    /// Position of sample (0, 0, 0), metres.
    pub fn origin(&self) -> Vec3 {
        self.origin
    }

    /// Distance between neighbouring samples along each axis, metres.
    pub fn spacing(&self) -> Vec3 {
        self.spacing
    }

    /// Samples along x, y and z.
    pub fn dimensions(&self) -> [usize; 3] {
        self.dimensions
    }

    /// All samples, in the order of x, then y, then z.
    pub fn samples(&self) -> &[Vec3] {
        &self.samples
    }
}

/// The number of samples.
fn check(origin: Vec3, spacing: Vec3, dimensions: [usize; 3]) -> Result<usize, ParameterError> {
    check_position("GridField.origin", origin)?;
    let holds = spacing.to_array().iter().all(|step| (1e-6..=1e6).contains(step));
    ParameterError::unless(holds, "GridField.spacing", spacing, "from 1e-6 to 1e6 metres on every axis")?;
    let count = dimensions.iter().try_fold(1_usize, |product, &n| product.checked_mul(n));
    count.filter(|count| (1..=MOST_SAMPLES).contains(count)).ok_or_else(|| {
        let value = format!("{dimensions:?}");
        ParameterError::new(
            "GridField.dimensions",
            value,
            "at least 1 along each axis, and at most 2^28 in all",
        )
    })
}

fn is_usable(sample: Vec3) -> bool {
    sample.abs().cmple(Vec3::splat(LARGEST)).all()
}

impl VectorField for GridField {
    fn at(&self, point: Vec3) -> Vec3 {
        let local = (point - self.origin) / self.spacing;
        if local.is_nan() {
            return Vec3::ZERO;
        }
        let last = Vec3::from_array(self.dimensions.map(|n| (n - 1) as f32));
        let inside = local.clamp(Vec3::ZERO, last);
        if self.zero_outside {
            // Along an axis of one sample nothing is outside.
            let out = |axis: usize| self.dimensions[axis] > 1 && (local[axis] - inside[axis]).abs() > 1e-4;
            if (0..3).any(out) {
                return Vec3::ZERO;
            }
        }
        // The low corner of the cell, and the share of the way to the high one.
        let low: [usize; 3] =
            std::array::from_fn(|axis| (inside[axis] as usize).min(self.dimensions[axis].saturating_sub(2)));
        let share: [f32; 3] = std::array::from_fn(|axis| inside[axis] - low[axis] as f32);
        let [nx, ny, _] = self.dimensions;
        let sample = |x: usize, y: usize, z: usize| {
            let [x, y, z] = [low[0] + x, low[1] + y, low[2] + z];
            self.samples[x + nx * (y + ny * z)]
        };
        let step = self.dimensions.map(|n| usize::from(n > 1));
        let along_x = |y, z| sample(0, y, z).lerp(sample(step[0], y, z), share[0]);
        let along_y = |z| along_x(0, z).lerp(along_x(step[1], z), share[1]);
        along_y(0).lerp(along_y(step[2]), share[2])
    }
}

#[cfg(test)]
mod tests;
