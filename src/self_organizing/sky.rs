//! The sky behind obstacles: how much of it each place sees, and where.

use crate::shape::{Bounds, Shape};
use crate::{math, parallel};
use glam::{IVec3, Vec3};
use std::sync::Arc;

/// About the most cells of the field.
const MOST_CELLS: f32 = (1 << 18) as f32;
/// Share of the sky that can be seen from the cells of a box.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sky {
    low: Vec3,
    cell: f32,
    size: IVec3,
    /// The part of the sky's light that gets through, in [0, 1], and the mean direction from which it comes, times that
    /// part.
    cells: Vec<(f32, Vec3)>,
}

impl Sky {
    /// Of a box `bounds` in light from these directions, unit vectors above the horizon with weights that add up to 1, as fine as `cell` metres if there is memory for it. O(cells · directions), and as many calls of
    /// `contains` as cells, times four.
    ///
    /// Each direction is followed from the top down, layer by layer: what gets through a cell is what gets through
    /// the place above it in that direction. Places are interpolated, so some light leaks through walls that are one cell
    /// thick: up to a third of what they should hold back.
    pub(super) fn new(
        bounds: Bounds,
        cell: f32,
        obstacles: &[Arc<dyn Shape>],
        directions: &[(Vec3, f32)],
    ) -> Self {
        let extent = bounds.size().max(Vec3::splat(cell));
        let cell = cell
            .max(math::cbrt(extent.x) * math::cbrt(extent.y) * math::cbrt(extent.z) / math::cbrt(MOST_CELLS));
        let size = (extent / cell).ceil().as_ivec3().max(IVec3::ONE);
        let mut sky = Self { low: bounds.min, cell, size, cells: Vec::new() };
        let layers = parallel::map(size.y as usize, |y| sky.blocked(y as i32, obstacles));
        let through = parallel::map(directions.len(), |i| sky.follow(directions[i].0, &layers));
        let count = size.to_array().iter().map(|&cells| cells as usize).product();
        let mut cells = vec![(0.0, Vec3::ZERO); count];
        for ((direction, weight), through) in directions.iter().zip(&through) {
            for (cell, &part) in cells.iter_mut().zip(through) {
                cell.0 += weight * f32::from(part) / 255.0;
                cell.1 += *direction * (weight * f32::from(part) / 255.0);
            }
        }
        sky.cells = cells;
        sky
    }

    /// Cells of a layer that obstacles fill, if only in part.
    fn blocked(&self, y: i32, obstacles: &[Arc<dyn Shape>]) -> Vec<bool> {
        // Four points a cell, at different heights and places on each axis: thin walls and roofs are not missed.
        let points =
            [[0.125, 0.625, 0.375], [0.375, 0.125, 0.875], [0.625, 0.875, 0.125], [0.875, 0.375, 0.625]];
        let mut blocked = vec![false; (self.size.x * self.size.z) as usize];
        let layer = self.low.y + y as f32 * self.cell;
        for shape in obstacles {
            let bounds = shape.bounds();
            if bounds.max.y < layer || bounds.min.y > layer + self.cell {
                continue;
            }
            for (place, blocked) in blocked.iter_mut().enumerate() {
                let (x, z) = (place as i32 % self.size.x, place as i32 / self.size.x);
                let corner = IVec3::new(x, y, z).as_vec3();
                let filled = |point: &[f32; 3]| {
                    shape.contains(self.low + (corner + Vec3::from_array(*point)) * self.cell)
                };
                *blocked = *blocked || points.iter().any(filled);
            }
        }
        blocked
    }

    /// Share of the light from `direction` that gets to each cell, in 255ths.
    fn follow(&self, direction: Vec3, layers: &[Vec<bool>]) -> Vec<u8> {
        let (columns, rows) = (self.size.x as usize, self.size.z as usize);
        let mut through = vec![255u8; columns * rows * layers.len()];
        // One layer up is so many cells aside; obstacles are looked for at each cell on the way.
        let aside = direction / direction.y;
        let steps = aside.x.abs().max(aside.z.abs()).ceil().max(1.0);
        for y in (0..layers.len().saturating_sub(1)).rev() {
            let (below, above) = through.split_at_mut((y + 1) * columns * rows);
            let below = &mut below[y * columns * rows..];
            let above = &above[..columns * rows];
            let at = |x: f32, z: f32, values: &dyn Fn(usize) -> f32| {
                let (x0, z0) = (x.floor(), z.floor());
                let (a, b) = (x - x0, z - z0);
                let one = |x: i32, z: i32| {
                    let inside = x >= 0 && z >= 0 && x < self.size.x && z < self.size.z;
                    if inside { values((z * self.size.x + x) as usize) } else { 1.0 }
                };
                let (x, z) = (x0 as i32, z0 as i32);
                let row = |z: i32| one(x, z) * (1.0 - a) + one(x + 1, z) * a;
                row(z) * (1.0 - b) + row(z + 1) * b
            };
            let clear = |layer: &Vec<bool>, place: usize| if layer[place] { 0.0 } else { 1.0 };
            for z in 0..rows {
                for x in 0..columns {
                    let mut part = 1.0f32;
                    for step in 1..=steps as u32 {
                        let way = step as f32 / steps;
                        let layer = if way < 0.5 { &layers[y] } else { &layers[y + 1] };
                        let (x, z) = (x as f32 + aside.x * way, z as f32 + aside.z * way);
                        part = part.min(at(x, z, &|place| clear(layer, place)));
                    }
                    if part > 0.0 {
                        let (x, z) = (x as f32 + aside.x, z as f32 + aside.z);
                        part *= at(x, z, &|place| f32::from(above[place]) / 255.0);
                    }
                    below[z * columns + x] = (part * 255.0 + 0.5) as u8;
                }
            }
        }
        through
    }

    /// The part of the sky's light at `point`, in [0, 1], and the mean direction from which it comes, times that part.
    /// Beside the box it is as on its edge, above it all is open.
    pub(super) fn at(&self, point: Vec3) -> (f32, Vec3) {
        let place = (point - self.low) / self.cell - 0.5;
        if place.y > (self.size.y - 1) as f32 {
            return (1.0, Vec3::Y);
        }
        let place = place.clamp(Vec3::ZERO, (self.size - 1).as_vec3());
        let base = place.as_ivec3().min(self.size - 2).max(IVec3::ZERO);
        let part = place - base.as_vec3();
        let (mut open, mut toward) = (0.0, Vec3::ZERO);
        for corner in 0..8 {
            let step = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
            let side = |axis: usize| if step[axis] == 1 { part[axis] } else { 1.0 - part[axis] };
            let weight = side(0) * side(1) * side(2);
            let cell = (base + step).min(self.size - 1);
            let (o, t) = self.cells[((cell.y * self.size.z + cell.z) * self.size.x + cell.x) as usize];
            open += weight * o;
            toward += t * weight;
        }
        (open, toward)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::self_organizing::daylight::Daylight;
    use crate::shape::Cuboid;

    fn sky(obstacles: &[Arc<dyn Shape>]) -> Sky {
        let bounds = Bounds::new(Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 3.0, 2.0));
        Sky::new(bounds, 0.05, obstacles, &Daylight::overcast())
    }

    #[test]
    fn an_empty_box_sees_all_of_the_sky() {
        let (open, toward) = sky(&[]).at(Vec3::new(0.3, 0.2, -0.7));
        assert!((open - 1.0).abs() < 1e-3 && toward.normalize().y > 0.999, "{open} {toward}");
    }

    #[test]
    fn it_is_dark_under_a_roof_and_half_dark_beside_a_wall() {
        let roof = Cuboid::new(Vec3::new(-9.0, 1.0, -9.0), Vec3::new(9.0, 1.02, 9.0));
        let under = sky(&[Arc::new(roof)]);
        assert!(under.at(Vec3::Y * 0.3).0 < 0.01);
        assert!(under.at(Vec3::Y * 1.3).0 > 0.99);
        let wall = Cuboid::new(Vec3::new(-0.3, 0.0, -9.0), Vec3::new(-0.28, 9.0, 9.0));
        let (open, toward) = sky(&[Arc::new(wall)]).at(Vec3::new(-0.2, 0.3, 0.0));
        assert!((0.3..0.75).contains(&open) && toward.x > 0.1, "{open} {toward}");
    }

    #[test]
    fn light_comes_through_a_hole_from_where_the_hole_is() {
        let mut roof: Vec<Arc<dyn Shape>> = Vec::new();
        // A hole of 0.4 m around x = 0.5.
        for (low, high) in [
            (Vec3::new(-9.0, 1.0, -9.0), Vec3::new(0.3, 1.1, 9.0)),
            (Vec3::new(0.7, 1.0, -9.0), Vec3::new(9.0, 1.1, 9.0)),
            (Vec3::new(0.3, 1.0, -9.0), Vec3::new(0.7, 1.1, -0.2)),
            (Vec3::new(0.3, 1.0, 0.2), Vec3::new(0.7, 1.1, 9.0)),
        ] {
            roof.push(Arc::new(Cuboid::new(low, high)));
        }
        let (open, toward) = sky(&roof).at(Vec3::new(0.0, 0.2, 0.0));
        assert!(open > 0.005 && open < 0.3, "{open}");
        let toward = toward.normalize();
        assert!(toward.x > 0.2 && toward.z.abs() < 0.1, "{toward}");
    }
}
