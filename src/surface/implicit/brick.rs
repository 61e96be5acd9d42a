//! An octree whose leaves hold four voxels in each direction: the sparse blocks along the branches.

use super::super::SurfaceError;
use super::field::Field;
use crate::Bounds;
use crate::parallel;
use glam::{IVec3, Vec3};

/// How many sides of a block away a finer primitive makes blocks finer. From 1.74 on, blocks that touch differ by one
/// level at most, or one of them is empty.
const GRADING: f32 = 1.8;
/// Half the diagonal of the unit cube.
const HALF_DIAGONAL: f32 = 0.866_026;

/// Four voxels in each direction, near the surface.
#[derive(Debug, Clone)]
pub(super) struct Brick {
    /// In finest voxels from the octree's corner.
    pub(super) corner: IVec3,
    /// Its voxels are 2 to the power of this finest voxels long.
    pub(super) level: u8,
    /// Bit `x + 4y + 16z` says that the middle of that voxel is inside.
    pub(super) inside: u64,
    /// Where in [`Bricks::near`] its primitives are.
    near: [u32; 2],
    /// The field less 1 in the middle of each voxel.
    pub(super) values: [f32; 64],
}

/// What is found at a place of the size of a block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Place {
    /// A block of that size.
    Same(u32),
    /// A larger one.
    Larger(u32),
    /// Smaller ones.
    Smaller,
    /// All inside, or all outside.
    Empty(bool),
}

#[derive(Debug, Clone, Copy)]
enum Node {
    /// The first of eight children.
    Inner(u32),
    Brick(u32),
    Empty(bool),
}

/// All blocks, the large ones first.
#[derive(Debug)]
pub(super) struct Bricks {
    nodes: Vec<Node>,
    pub(super) bricks: Vec<Brick>,
    near: Vec<u32>,
    origin: Vec3,
    voxel: f32,
    /// The level at which one block would hold everything.
    top: u8,
}

/// What one look at a cube says.
enum Look {
    Empty(bool),
    /// Too coarse: the primitives that matter in its parts.
    Split(Vec<u32>),
    Brick(Vec<u32>, [f32; 64]),
}

impl Bricks {
    /// The blocks that the surface passes, with voxels of at least `voxel` metres, and twice that as often as `levels`
    /// says of the primitives near. At most `most` blocks.
    ///
    /// A cube is empty if bounds of the field say so, one voxel beyond its borders too.
    pub(super) fn new(field: &Field, levels: &[u8], voxel: f32, most: usize) -> Result<Self, SurfaceError> {
        let bounds = field.segments.iter().fold(Bounds::EMPTY, |bounds, segment| {
            let reach = field.reach(segment);
            segment
                .ends()
                .into_iter()
                .fold(bounds, |bounds, end| bounds.union(Bounds::around(end, Vec3::splat(reach + voxel))))
        });
        let side = bounds.size().max_element();
        let top = (0..30).find(|&top| voxel * (4u32 << top) as f32 >= side).unwrap_or(29);
        let origin = bounds.min;
        let mut all = Self {
            nodes: vec![Node::Empty(false)],
            bricks: Vec::new(),
            near: Vec::new(),
            origin,
            voxel,
            top,
        };
        // Cubes of one size: each one's node and corner, and where its parent's primitives are.
        let mut cubes = vec![(0u32, IVec3::ZERO, 0usize)];
        let mut lists = vec![(0..field.segments.len() as u32).collect::<Vec<_>>()];
        for level in (0..=top).rev() {
            let looks = parallel::map(cubes.len(), |i| {
                let (_, corner, list) = cubes[i];
                all.look(field, levels, level, corner, &lists[list])
            });
            let (mut parts, mut near) = (Vec::new(), Vec::new());
            for ((node, corner, _), look) in std::mem::take(&mut cubes).into_iter().zip(looks) {
                all.nodes[node as usize] = match look {
                    Look::Empty(inside) => Node::Empty(inside),
                    Look::Brick(list, values) => {
                        let start = all.near.len() as u32;
                        all.near.extend(list);
                        let inside = (0..64).filter(|&i| values[i] > 0.0).fold(0, |bits, i| bits | 1 << i);
                        let near = [start, all.near.len() as u32];
                        all.bricks.push(Brick { corner, level, inside, near, values });
                        Node::Brick(all.bricks.len() as u32 - 1)
                    }
                    Look::Split(list) => {
                        let first = all.nodes.len() as u32;
                        let half = 2 << level;
                        for i in 0..8 {
                            let offset = IVec3::new(i & 1, i >> 1 & 1, i >> 2) * half;
                            parts.push((first + i as u32, corner + offset, near.len()));
                            all.nodes.push(Node::Empty(false));
                        }
                        near.push(list);
                        Node::Inner(first)
                    }
                };
            }
            // Each cube that is split holds a block or more.
            if all.bricks.len() + near.len() > most || all.near.len() > u32::MAX as usize / 2 {
                return Err(SurfaceError::TooManyBlocks { voxel, most });
            }
            (cubes, lists) = (parts, near);
        }
        Ok(all)
    }

    fn look(&self, field: &Field, levels: &[u8], level: u8, corner: IVec3, list: &[u32]) -> Look {
        let step = self.step(level);
        let side = 4.0 * step;
        let start = self.place(corner);
        let middle = start + 0.5 * side;
        // A ball around the cube and one voxel more on each side.
        let reach = HALF_DIAGONAL * 1.5 * side;
        let (mut split, mut keep, mut felt) = (false, Vec::new(), Vec::new());
        let (mut sum, mut branch) = (0.0f32, (u32::MAX, 0.0f32));
        for &number in list {
            let segment = &field.segments[number as usize];
            let (least, most) = field.range(segment, middle, reach);
            if least > 1.0 {
                return Look::Empty(true);
            }
            if most > 0.0 {
                felt.push(number);
                if branch.0 != segment.branch {
                    sum += branch.1 * branch.1;
                    branch = (segment.branch, 0.0);
                }
                branch.1 = branch.1.max(most);
            }
            let finer = levels[number as usize] < level
                && segment.distance(middle) < field.reach(segment) + (GRADING + HALF_DIAGONAL) * side;
            if finer || most > 0.0 {
                keep.push(number);
            }
            split |= finer;
        }
        if sum + branch.1 * branch.1 < 1.0 {
            return Look::Empty(false);
        }
        if split {
            return Look::Split(keep);
        }
        let values = field.sample(&felt, start + 0.5 * step, step);
        Look::Brick(felt, values)
    }

    /// The side of a voxel, metres.
    pub(super) fn step(&self, level: u8) -> f32 {
        self.voxel * (1u32 << level) as f32
    }

    fn place(&self, corner: IVec3) -> Vec3 {
        self.origin + corner.as_vec3() * self.voxel
    }

    /// The middle of a block's voxel, metres.
    pub(super) fn middle(&self, brick: &Brick, cell: u32) -> Vec3 {
        let cell = IVec3::new(cell as i32 & 3, cell as i32 >> 2 & 3, cell as i32 >> 4);
        self.place(brick.corner) + (cell.as_vec3() + 0.5) * self.step(brick.level)
    }

    /// The primitives felt in a block or within one voxel of it.
    pub(super) fn near(&self, brick: &Brick) -> &[u32] {
        &self.near[brick.near[0] as usize..brick.near[1] as usize]
    }

    /// What is at a corner that blocks of that level can have.
    pub(super) fn find(&self, corner: IVec3, level: u8) -> Place {
        let most = 4i64 << self.top;
        if corner.to_array().iter().any(|&x| x < 0 || i64::from(x) >= most) {
            return Place::Empty(false);
        }
        let (mut node, mut at) = (self.nodes[0], self.top);
        loop {
            match node {
                Node::Empty(inside) => return Place::Empty(inside),
                Node::Brick(brick) if at == level => return Place::Same(brick),
                Node::Brick(brick) => return Place::Larger(brick),
                Node::Inner(_) if at == level => return Place::Smaller,
                Node::Inner(first) => {
                    at -= 1;
                    let bits = (corner >> i32::from(at + 2)) & 1;
                    node = self.nodes[first as usize + (bits.x | bits.y << 1 | bits.z << 2) as usize];
                }
            }
        }
    }
}
