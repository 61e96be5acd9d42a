//! Numbers on a lattice over a box, linear in between.

use crate::shape::Bounds;
use glam::{IVec3, Vec3};
use smallvec::SmallVec;

/// A continuous function of position; beyond the box it is what it is at the nearest place in it.
#[derive(Debug, Clone)]
pub(super) struct Scalars {
    pub(super) origin: Vec3,
    pub(super) step: Vec3,
    /// 1 / step.
    per_step: Vec3,
    /// Points along each axis, at least 2.
    pub(super) dims: IVec3,
    /// One per point; x runs fastest.
    pub(super) values: Vec<f32>,
}

impl Scalars {
    pub(super) fn new(origin: Vec3, step: Vec3, dims: IVec3, values: Vec<f32>) -> Self {
        Self { origin, step, per_step: step.recip(), dims, values }
    }

    /// At a finite point. O(1).
    #[inline]
    pub(super) fn at(&self, point: Vec3) -> f32 {
        let place = ((point - self.origin) * self.per_step).clamp(Vec3::ZERO, (self.dims - 1).as_vec3());
        let cell = place.as_ivec3().min(self.dims - 2);
        let t = place - cell.as_vec3();
        let (row, layer) = (self.dims.x as usize, (self.dims.x * self.dims.y) as usize);
        let first = cell.z as usize * layer + cell.y as usize * row + cell.x as usize;
        let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let along_x = |i: usize| lerp(self.values[i], self.values[i + 1], t.x);
        let along_y = |i: usize| lerp(along_x(i), along_x(i + row), t.y);
        lerp(along_y(first), along_y(first + layer), t.z)
    }

    /// The least and the largest value in a box: where the function is linear along each axis, at the corners.
    pub(super) fn range(&self, bounds: Bounds) -> (f32, f32) {
        let planes = |axis: usize| -> SmallVec<[f32; 32]> {
            let place = |x: f32| (x - self.origin[axis]) * self.per_step[axis];
            let first = (place(bounds.min[axis]).floor() as i32 + 1).max(0);
            let last = (place(bounds.max[axis]).ceil() as i32 - 1).min(self.dims[axis] - 1);
            let inside = (first..=last).map(|i| self.origin[axis] + i as f32 * self.step[axis]);
            [bounds.min[axis], bounds.max[axis]].into_iter().chain(inside).collect()
        };
        let [x, y, z] = [0, 1, 2].map(planes);
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for &z in &z {
            for &y in &y {
                for &x in &x {
                    let value = self.at(Vec3::new(x, y, z));
                    (low, high) = (low.min(value), high.max(value));
                }
            }
        }
        (low, high)
    }

    /// The least and the largest value anywhere.
    pub(super) fn extremes(&self) -> (f32, f32) {
        self.values
            .iter()
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)))
    }

    /// Lowers what is more than `grading` times the way along the axes above another value: what is left is
    /// the largest function below the old one that changes at most so fast. One pass there and one back along each axis are exact.
    pub(super) fn limit(&mut self, grading: f32) {
        let rise = self.step * grading;
        let (nx, layer) = (self.dims.x as usize, (self.dims.x * self.dims.y) as usize);
        for row in self.values.chunks_exact_mut(nx) {
            for i in 1..nx {
                row[i] = row[i].min(row[i - 1] + rise.x);
            }
            for i in (1..nx).rev() {
                row[i - 1] = row[i - 1].min(row[i] + rise.x);
            }
        }
        for values in self.values.chunks_exact_mut(layer) {
            limit_rows(values, nx, rise.y);
        }
        limit_rows(&mut self.values, layer, rise.z);
    }
}

/// The same for all numbers of a row with those of the rows beside it.
fn limit_rows(values: &mut [f32], row: usize, rise: f32) {
    let lower = |to: &mut [f32], from: &[f32]| {
        for (to, from) in to.iter_mut().zip(from) {
            *to = to.min(from + rise);
        }
    };
    let rows = values.len() / row;
    for i in 1..rows {
        let (before, after) = values.split_at_mut(i * row);
        lower(&mut after[..row], &before[(i - 1) * row..]);
    }
    for i in (1..rows).rev() {
        let (before, after) = values.split_at_mut(i * row);
        lower(&mut before[(i - 1) * row..], &after[..row]);
    }
}
