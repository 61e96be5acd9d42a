//! The point at which the surface crosses an edge between two voxels.

use super::brick::{Brick, Bricks, Place, STEPS, voxel};
use super::solid::Part;
use glam::Vec3;

/// Vertices keep this share of an edge's length from its ends, so that triangles have an area.
const MARGIN: f32 = 1.0 / 32.0;
/// Greatest distance of a vertex from the surface, as a share of its edge.
const OFF: f32 = 0.01;

/// A block whose vertices are wanted.
pub(super) struct Crossings<'a, P> {
    bricks: &'a Bricks<P>,
    number: u32,
    brick: &'a Brick,
    beside: [Place; 6],
    values: [f32; 64],
}

impl<'a, P: Part> Crossings<'a, P> {
    pub(super) fn new(bricks: &'a Bricks<P>, number: u32) -> Self {
        let brick = &bricks.leaves[number as usize];
        Self { bricks, number, brick, beside: bricks.beside(brick), values: bricks.sample(number as usize) }
    }

    /// The point at which the surface crosses the edge from a voxel to its neighbour, its normal there, and
    /// the part of the solid that counts there.
    pub(super) fn vertex(&self, direction: usize, cell: u32) -> (Vec3, Vec3, &'a P) {
        let beyond = voxel(cell) + STEPS[direction];
        let own = Place::Same(self.number);
        let place = if (beyond.x | beyond.y | beyond.z) & !3 == 0 { own } else { self.beside[direction] };
        // Edges that are crossed have a voxel at each end.
        let (number, beyond) = self.bricks.holder(self.brick, place, beyond).unwrap_or((self.number, cell));
        let other = &self.bricks.leaves[number as usize];
        let from = self.bricks.middle(self.brick, cell);
        let way = self.bricks.middle(other, beyond) - from;
        // The larger one's cube holds the smaller one's middle; not the other way round.
        let larger = if other.level > self.brick.level { number } else { self.number };
        let part = &self.bricks.parts[larger as usize];
        let start = self.values[cell as usize];
        let starts_inside = start > 0.0;
        let end = if number == self.number { self.values[beyond as usize] } else { part.value(from + way) };
        let (mut low, mut high) = (MARGIN, 1.0 - MARGIN);
        let mut t = (start / (start - end)).clamp(low, high);
        let mut tries = 0;
        loop {
            let point = from + way * t;
            let (value, slope) = part.gradient(point);
            let along = slope.dot(way);
            if value.abs() <= OFF * way.length() * slope.length() || tries == 5 || high - low < OFF {
                let outward = if starts_inside { way } else { -way };
                return (point, (-slope).normalize_or(outward.normalize_or(Vec3::Y)), part);
            }
            if (value > 0.0) == starts_inside {
                low = t;
            } else {
                high = t;
            }
            let newton = t - value / along;
            t = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            tries += 1;
        }
    }
}
