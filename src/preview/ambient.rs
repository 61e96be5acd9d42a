//! Share of the sky that is seen from a place.
//!
//! The triangles become a fog in a coarse grid: a body of surface A hides A/4 on average over all directions
//! (Cauchy), so a cell of volume V that holds it lets `exp(-A/4V · s)` through on a way of length s. The light of a
//! few directions sweeps down through the grid.

use super::ray::{Cast, Ray};
use crate::math;
use crate::parallel;
use crate::shape::Bounds;
use glam::Vec3;
use std::f32::consts::TAU;

/// Cells along the longest side.
const CELLS: f32 = 48.0;
/// Rays per cell's side that look for a solid's surface.
const RAYS: f32 = 2.0;
/// Directions light comes from: how many around the vertical, and the tangent of their angle to it.
const DIRECTIONS: [(usize, f32); 3] = [(1, 0.0), (6, 0.7), (9, 1.7)];

pub(super) struct Ambient {
    low: Vec3,
    cell: f32,
    /// Cells in x, y and z.
    size: [usize; 3],
    /// First the surface in each cell, square metres; then the part of the sky seen from it.
    cells: Vec<f32>,
}

impl Ambient {
    pub(super) fn new(bounds: Bounds) -> Self {
        let cell = (bounds.size().max_element() / CELLS).max(1e-6);
        let border = Vec3::new(6.0, 1.0, 6.0);
        let low = bounds.min - border * cell;
        let size =
            ((bounds.size() / cell).ceil() + 2.0 * border + 1.0).to_array().map(|cells| cells as usize);
        Self { low, cell, size, cells: vec![0.0; size[0] * size[1] * size[2]] }
    }

    /// Cell and the way into it, in cells, for eight neighbours' weights.
    #[inline]
    fn place(&self, point: Vec3) -> (usize, Vec3) {
        let at = ((point - self.low) / self.cell - 0.5).to_array();
        let axis = |i: usize| {
            let cell = at[i].clamp(0.0, self.size[i] as f32 - 2.0).floor();
            (cell as usize, (at[i] - cell).clamp(0.0, 1.0))
        };
        let ((x, dx), (y, dy), (z, dz)) = (axis(0), axis(1), axis(2));
        ((y * self.size[2] + z) * self.size[0] + x, Vec3::new(dx, dy, dz))
    }

    #[inline]
    fn neighbours(&self, first: usize, within: Vec3) -> [(usize, f32); 8] {
        let steps = [1, self.size[0] * self.size[2], self.size[0]];
        std::array::from_fn(|i| {
            let mut index = first;
            let mut weight = 1.0;
            for axis in 0..3 {
                let farther = i >> axis & 1 == 1;
                index += if farther { steps[axis] } else { 0 };
                weight *= if farther { within[axis] } else { 1.0 - within[axis] };
            }
            (index, weight)
        })
    }

    /// Adds a `share` of a triangle; two-sided ones hide twice as much, for they have a surface on either side.
    #[inline]
    pub(super) fn add(&mut self, [a, b, c]: [Vec3; 3], two_sided: bool, share: f32) {
        let area = share * (b - a).cross(c - a).length() * if two_sided { 1.0 } else { 0.5 };
        self.add_area((a + b + c) / 3.0, area);
    }

    #[inline]
    fn add_area(&mut self, point: Vec3, area: f32) {
        let (first, within) = self.place(point);
        for (index, weight) in self.neighbours(first, within) {
            self.cells[index] += area * weight;
        }
    }

    /// Adds the surface of a solid, as a bundle of rays along each axis finds it: a ray that passes a surface
    /// with the normal n stands for 1/(|nx| + |ny| + |nz|) of the square between it and its neighbours, so that on
    /// average every surface counts once.
    pub(super) fn add_solid(&mut self, solid: &dyn Cast, bounds: Bounds) {
        let spacing = self.cell / RAYS;
        let low = bounds.min;
        for along in 0..3 {
            let across = [(along + 1) % 3, (along + 2) % 3];
            let count = across.map(|axis| (bounds.size()[axis] / spacing).ceil().max(1.0) as usize);
            let way = Vec3::AXES[along];
            let passages = parallel::map(count[0] * count[1], |i| {
                // Anywhere in its square, by the golden section's relative in the plane (Roberts 2018).
                let jitter = [i as f32 * 0.754_877_7, i as f32 * 0.569_840_3].map(|x| x - x.floor());
                let mut origin = low;
                origin[across[0]] += ((i % count[0]) as f32 + jitter[0]) * spacing;
                origin[across[1]] += ((i / count[0]) as f32 + jitter[1]) * spacing;
                solid.passages(&Ray { origin, way, from: -f32::MAX, to: f32::MAX })
            });
            for (point, normal) in passages.into_iter().flatten() {
                self.add_area(point, spacing * spacing / normal.abs().element_sum());
            }
        }
    }

    /// All surface that has been added, square metres.
    #[cfg(test)]
    pub(super) fn surface(&self) -> f32 {
        self.cells.iter().sum()
    }

    /// To be called once, when everything is in: lets the light down.
    pub(super) fn finish(&mut self) {
        let layer = self.size[0] * self.size[2];
        let per_metre = 0.25 / (self.cell * self.cell * self.cell);
        let fog: Vec<f32> = self.cells.iter().map(|area| area * per_metre * self.cell).collect();
        let mut seen = vec![0.0; self.cells.len()];
        let mut above = vec![1.0; layer];
        let mut here = vec![1.0; layer];
        let mut total = 0.0;
        for (around, tilt) in DIRECTIONS {
            let length = (1.0 + tilt * tilt).sqrt();
            // Half a cell of fog before the middle of the cell, half after it.
            let through: Vec<f32> = fog.iter().map(|fog| math::exp(-0.5 * length * fog)).collect();
            let weight = 1.0 / length;
            for direction in 0..around {
                let (sin, cos) = math::sin_cos((direction as f32 + 0.5) * TAU / around as f32);
                total += weight;
                above.fill(1.0);
                for y in (0..self.size[1]).rev() {
                    for z in 0..self.size[2] {
                        for x in 0..self.size[0] {
                            let i = z * self.size[0] + x;
                            let through = through[y * layer + i];
                            let light =
                                self.shifted(&above, x as f32 + tilt * cos, z as f32 + tilt * sin) * through;
                            seen[y * layer + i] += weight * light;
                            here[i] = light * through;
                        }
                    }
                    std::mem::swap(&mut above, &mut here);
                }
            }
        }
        self.cells = seen;
        self.cells.iter_mut().for_each(|seen| *seen /= total);
    }

    /// A layer between its cells; full light outside.
    fn shifted(&self, layer: &[f32], x: f32, z: f32) -> f32 {
        let (column, row) = (x.floor(), z.floor());
        let (fx, fz) = (x - column, z - row);
        let at = |column: f32, row: f32| {
            let inside =
                column >= 0.0 && row >= 0.0 && column < self.size[0] as f32 && row < self.size[2] as f32;
            if inside { layer[row as usize * self.size[0] + column as usize] } else { 1.0 }
        };
        let near = at(column, row) * (1.0 - fx) + at(column + 1.0, row) * fx;
        let far = at(column, row + 1.0) * (1.0 - fx) + at(column + 1.0, row + 1.0) * fx;
        near * (1.0 - fz) + far * fz
    }

    /// The part of the sky that is seen from a point of a surface, were the surface itself not in the way; 0 to 1.
    #[inline]
    pub(super) fn light(&self, point: Vec3, normal: Vec3) -> f32 {
        let (first, within) = self.place(point + normal * (0.7 * self.cell));
        self.neighbours(first, within).into_iter().map(|(index, weight)| self.cells[index] * weight).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn under_a_roof_it_is_darker() {
        let bounds = Bounds { min: Vec3::new(-2.0, 0.0, -2.0), max: Vec3::new(2.0, 3.0, 2.0) };
        let mut ambient = Ambient::new(bounds);
        for i in 0..1600 {
            let corner = Vec3::new((i % 40) as f32 * 0.1 - 2.0, 2.5, (i / 40) as f32 * 0.1 - 2.0);
            ambient.add([corner, corner + Vec3::Z * 0.1, corner + Vec3::X * 0.1], true, 1.0);
        }
        ambient.finish();
        let light = |y: f32| ambient.light(Vec3::new(0.0, y, 0.0), Vec3::Y);
        assert!(light(0.0) < 0.9 && light(2.9) > 0.95, "{} {}", light(0.0), light(2.9));
        assert!(light(1e9) > 0.95 && light(-1e9) < 0.9);
    }
}
