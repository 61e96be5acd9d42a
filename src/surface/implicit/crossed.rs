//! The edges between voxels that the surface crosses, and the vertices' numbers on them.

use super::brick::{Brick, Bricks, Place, STEPS, voxel};
use super::solid::Part;

/// The edges from a block's voxels to their neighbours that the surface crosses, for each direction: x, y, z, then
/// back along them. An edge between two sizes belongs to the smaller voxel, others to the one that comes first.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossed {
    ahead: [u64; 3],
    /// The first vertex.
    first: u32,
    /// For each direction, the number of vertices of the directions before it.
    before: [u8; 6],
    /// Back from the block's side alone: bit i is the i-th voxel of that side.
    back: [u16; 3],
}

/// The voxels on a block's lower side along x, y, z.
const FIRST: [u64; 3] = [0x1111_1111_1111_1111, 0x000f_000f_000f_000f, 0xffff];

impl Crossed {
    /// A block's, numbered from 0 on.
    pub(super) fn new<P: Part>(bricks: &Bricks<P>, brick: &Brick) -> Self {
        let inside = brick.inside;
        let beside = bricks.beside(brick);
        // Voxels on one side whose neighbours beyond are inside, if the edges there are the block's.
        let across = |direction: usize, side: u64| match beside[direction] {
            Place::Same(number) if direction < 3 => {
                Some((bricks.leaves[number as usize].inside & FIRST[direction]) << (3 << (2 * direction)))
            }
            Place::Larger(number) => {
                let larger = &bricks.leaves[number as usize];
                let is_inside = |&cell: &u32| {
                    let beyond = voxel(cell) + STEPS[direction];
                    let cell = bricks.holder(brick, beside[direction], beyond).map_or(0, |(_, cell)| cell);
                    larger.inside >> cell & 1 == 1
                };
                Some(bits(side).filter(is_inside).fold(0, |cells, cell| cells | 1 << cell))
            }
            _ => None,
        };
        let ahead = std::array::from_fn(|axis| {
            let shift = 1 << (2 * axis);
            let last = FIRST[axis] << (3 * shift);
            let within = (inside ^ inside >> shift) & !last;
            within | across(axis, last).map_or(0, |across| (inside & last) ^ across)
        });
        let back = std::array::from_fn(|axis| {
            let side = FIRST[axis];
            let edges = across(axis + 3, side).map_or(0, |across| (inside & side) ^ across);
            bits(edges).fold(0, |edges, cell| edges | 1 << on_side(axis, cell))
        });
        let mut crossed = Self { ahead, first: 0, before: [0; 6], back };
        for direction in 0..5 {
            crossed.before[direction + 1] = crossed.before[direction] + crossed.of(direction) as u8;
        }
        crossed
    }

    /// Number of the block's vertices.
    pub(super) fn count(&self) -> u32 {
        u32::from(self.before[5]) + self.of(5)
    }

    /// The first of its vertices.
    pub(super) fn first(&self) -> u32 {
        self.first
    }

    /// Sets the number of the block's first vertex.
    pub(super) fn start_at(&mut self, first: u32) {
        self.first = first;
    }

    /// The vertex on the edge that the surface crosses from a voxel in a direction.
    #[inline]
    pub(super) fn vertex(&self, direction: usize, cell: u32) -> u32 {
        let before = match direction {
            0..3 => (self.ahead[direction] & ((1 << cell) - 1)).count_ones(),
            _ => (self.back[direction - 3] & ((1 << on_side(direction - 3, cell)) - 1)).count_ones(),
        };
        self.first + u32::from(self.before[direction]) + before
    }

    /// The edges in the vertices' order: direction and voxel.
    pub(super) fn edges(&self) -> impl Iterator<Item = (usize, u32)> {
        let ahead = (0..3).flat_map(|axis| bits(self.ahead[axis]).map(move |cell| (axis, cell)));
        let back = (0..3).flat_map(move |axis| {
            let side = bits(FIRST[axis]);
            side.filter(move |&cell| self.back[axis] >> on_side(axis, cell) & 1 == 1)
                .map(move |cell| (axis + 3, cell))
        });
        ahead.chain(back)
    }

    fn of(&self, direction: usize) -> u32 {
        match direction {
            0..3 => self.ahead[direction].count_ones(),
            _ => self.back[direction - 3].count_ones(),
        }
    }
}

/// The number of a voxel among those on a block's lower side.
fn on_side(axis: usize, cell: u32) -> u32 {
    match axis {
        0 => cell >> 2,
        1 => cell & 3 | cell >> 2 & 0xc,
        _ => cell,
    }
}

/// The places of the bits that are set.
pub(super) fn bits(mut left: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let bit = (left != 0).then(|| left.trailing_zeros());
        left &= left.wrapping_sub(1);
        bit
    })
}
