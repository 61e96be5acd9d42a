//! A region as whole cells.

use crate::shape::{Bounds, Shape};
use glam::{IVec3, Vec3};

/// Cells along the longest side.
const CELLS: f32 = 64.0;

/// The cells of a grid that lie in a shape with all of their corners: the shape from inside.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub(super) struct Region {
    low: Vec3,
    cell: f32,
    size: IVec3,
    /// Row after row along x, how many cells are outside, inside, outside and so on.
    runs: Vec<u32>,
    /// A bit a cell; follows from the runs.
    #[cfg_attr(feature = "serde", serde(skip))]
    inside: Vec<u64>,
}

impl Region {
    pub(super) fn new(shape: &dyn Shape) -> Self {
        let bounds: Bounds = shape.bounds();
        let cell = (bounds.size().max_element() / CELLS).max(1e-6);
        let size = (bounds.size() / cell).ceil().as_ivec3().max(IVec3::ONE);
        let corners = size + 1;
        let corner = |x: i32, y: i32, z: i32| bounds.min + IVec3::new(x, y, z).as_vec3() * cell;
        let mut holds = Vec::with_capacity(corners.to_array().iter().map(|&n| n as usize).product());
        for z in 0..corners.z {
            for y in 0..corners.y {
                holds.extend((0..corners.x).map(|x| shape.contains(corner(x, y, z))));
            }
        }
        let at = |x: i32, y: i32, z: i32| holds[((z * corners.y + y) * corners.x + x) as usize];
        let mut region = Self { low: bounds.min, cell, size, runs: Vec::new(), inside: Vec::new() };
        let (mut last, mut run) = (false, 0);
        for place in 0..region.count() as i32 {
            let (x, y, z) = (place % size.x, place / size.x % size.y, place / size.x / size.y);
            let all = [0, 1]
                .into_iter()
                .all(|dz| [0, 1].into_iter().all(|dy| at(x, y + dy, z + dz) && at(x + 1, y + dy, z + dz)));
            if all != last {
                region.runs.push(run);
                (last, run) = (all, 0);
            }
            run += 1;
        }
        region.runs.push(run);
        region.unpack();
        region
    }

    fn count(&self) -> u64 {
        self.size.to_array().iter().map(|&cells| cells.max(0) as u64).product()
    }

    /// Works out the bits from the runs; those of a file may be wrong.
    pub(super) fn unpack(&mut self) {
        let count = self.count().min(1 << 24) as usize;
        self.inside = vec![0; count.div_ceil(64)];
        let mut place = 0usize;
        for (i, &run) in self.runs.iter().enumerate() {
            let end = place.saturating_add(run as usize).min(count);
            if i % 2 == 1 {
                for cell in place..end {
                    self.inside[cell / 64] |= 1 << (cell % 64);
                }
            }
            place = end;
        }
    }

    /// `true` if a file may hold it.
    pub(super) fn is_sound(&self) -> bool {
        let sizes = self.size.min_element() >= 1 && self.size.max_element() <= CELLS as i32 + 1;
        let all: u64 = self.runs.iter().map(|&run| u64::from(run)).sum();
        sizes && all == self.count() && self.low.is_finite() && self.cell >= 1e-6 && self.cell.is_finite()
    }

    #[inline]
    pub(super) fn contains(&self, point: Vec3) -> bool {
        let place = (point - self.low) / self.cell;
        let inside = place.cmpge(Vec3::ZERO).all() && place.cmplt(self.size.as_vec3()).all();
        inside && {
            let cell = place.as_ivec3();
            let place = ((cell.z * self.size.y + cell.y) * self.size.x + cell.x) as usize;
            self.inside.get(place / 64).is_some_and(|word| word >> (place % 64) & 1 == 1)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Sphere;

    #[test]
    fn a_region_lies_in_its_shape_and_fills_most_of_it() {
        let ball = Sphere::new(Vec3::new(3.0, 1.0, -2.0), 1.5);
        let region = Region::new(&ball);
        assert!(region.is_sound());
        let (mut inside, mut of) = (0, 0);
        for i in 0..100_000u64 {
            let draw = |axis| crate::random::unit(1, 0, crate::random::Purpose::CUSTOM, 3 * i + axis);
            let point = Vec3::new(3.0, 1.0, -2.0) + (Vec3::new(draw(0), draw(1), draw(2)) * 2.0 - 1.0) * 1.5;
            assert!(ball.contains(point) || !region.contains(point));
            of += u32::from(ball.contains(point));
            inside += u32::from(region.contains(point));
        }
        assert!(f64::from(inside) > 0.9 * f64::from(of), "{inside} of {of}");
    }
}
