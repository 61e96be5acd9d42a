//! One layer of a shadow: what a node adds to the cells so many layers below it.

use glam::{IVec3, Vec3};

/// Cells are added to in groups of so many, which processors do at once.
pub(super) const LANES: usize = 8;

/// Light that comes in at a lower angle falls no farther aside than so many cells for each cell down.
const STEEPEST: f32 = 2.0;
/// Half the width of one direction's shadow for each cell down.
const SPREAD: f32 = 0.5;

/// Neighbours in x.
pub(super) type Group = [u16; LANES];

/// Cells that a shadow adds to, so many cells below what casts it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Slice {
    /// The first cell in x and z, from the one below the caster.
    pub(super) x: i32,
    pub(super) z: i32,
    /// Number of rows in z.
    pub(super) count: usize,
    pub(super) rows: Rows,
}

/// Values of the rows of a slice, zeros at their ends.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Rows {
    /// A pyramid's: all alike.
    Same(Vec<Group>),
    Each(Vec<Vec<Group>>),
}

impl Slice {
    /// The slice q cells down of a pyramid of shadow, `power` in each cell.
    pub(super) fn of_pyramid(q: u32, power: u16) -> Self {
        let width = 2 * q as usize + 1;
        let group = |x: usize| std::array::from_fn(|i| if x + i < width { power } else { 0 });
        let row = (0..width).step_by(LANES).map(group).collect();
        Self { x: -(q as i32), z: -(q as i32), count: width, rows: Rows::Same(row) }
    }

    /// The slice q cells down of a shadow from light of these directions. Each throws a square, half as wide as that of the
    /// pyramid and as far aside as it comes in slantwise; together they are as dark as the pyramid, but no cell is darker than
    /// its middle: where many directions meet, in the tropics, up to 7% is cut off.
    pub(super) fn leaning(q: u32, light: &[(Vec3, f32)], power: impl Fn(f32) -> u16) -> Self {
        let reach = reach(q);
        let width = (2 * reach + 1) as usize;
        let depth = q as f32;
        let half = SPREAD * depth + 0.5;
        let dark = (2.0 * depth + 1.0) * (2.0 * depth + 1.0) / (4.0 * half * half);
        // The part of each cell on an axis that lies in a span.
        let covered = |middle: f32, cell: usize| {
            let place = (cell as i32 - reach) as f32;
            ((place + 0.5).min(middle + half) - (place - 0.5).max(middle - half)).max(0.0)
        };
        let mut parts = vec![0.0f32; width * width];
        for (direction, weight) in light {
            let slant = Vec3::new(direction.x, 0.0, direction.z) / direction.y.max(1e-3);
            let away = -slant.clamp_length_max(STEEPEST) * depth;
            let across: Vec<f32> = (0..width).map(|x| covered(away.x, x)).collect();
            for (z, row) in parts.chunks_exact_mut(width).enumerate() {
                let along = covered(away.z, z) * weight * dark;
                if along > 0.0 {
                    row.iter_mut().zip(&across).for_each(|(part, across)| *part += along * across);
                }
            }
        }
        let powers: Vec<u16> = parts.iter().map(|&part| power(part.min(1.0))).collect();
        let (mut low, mut high) = (IVec3::splat(reach), IVec3::splat(reach));
        for (place, _) in powers.iter().enumerate().filter(|(_, power)| **power > 0) {
            let cell = IVec3::new((place % width) as i32, reach, (place / width) as i32);
            (low, high) = (low.min(cell), high.max(cell));
        }
        let row = |z: i32| -> Vec<Group> {
            let at = |x: i32| if x <= high.x { powers[z as usize * width + x as usize] } else { 0 };
            (low.x..=high.x).step_by(LANES).map(|x| std::array::from_fn(|i| at(x + i as i32))).collect()
        };
        let rows: Vec<Vec<Group>> = (low.z..=high.z).map(row).collect();
        Self { x: low.x - reach, z: low.z - reach, count: rows.len(), rows: Rows::Each(rows) }
    }

    pub(super) fn cells(&self) -> usize {
        match &self.rows {
            Rows::Same(_) => self.count * self.count,
            Rows::Each(rows) => rows.iter().map(Vec::len).sum::<usize>() * LANES,
        }
    }

    /// The value right below the caster.
    pub(super) fn middle(&self) -> u16 {
        let x = -self.x as usize;
        match &self.rows {
            Rows::Same(row) => row[x / LANES][x % LANES],
            Rows::Each(rows) => rows[-self.z as usize][x / LANES][x % LANES],
        }
    }
}

/// The most cells aside that a leaning shadow falls in so many cells down.
pub(super) fn reach(q: u32) -> i32 {
    ((STEEPEST + SPREAD) * q as f32).ceil() as i32 + 1
}
