//! An octree whose leaves hold four voxels in each direction: the sparse blocks along the branches.

use super::field::Field;
use crate::Bounds;
use crate::parallel;
use crate::surface::SurfaceError;
use glam::{IVec3, Vec3};

/// A ball around a block that holds it and the middles of all voxels that share a face with it, in voxels, as long as these
/// are at most twice as large. A block's ball lies within that of a block of twice the size around it.
const BALL: f32 = 3.5;

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
    node: u32,
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

/// All blocks.
#[derive(Debug)]
pub(super) struct Bricks {
    nodes: Vec<Node>,
    pub(super) leaves: Vec<Brick>,
    near: Vec<u32>,
    origin: Vec3,
    voxel: f32,
    /// The level at which one block would hold everything.
    top: u8,
}

/// A part of the octree still to be looked at.
struct Cube {
    node: u32,
    corner: IVec3,
    level: u8,
    /// Which list has all primitives that may be felt here.
    list: usize,
}

/// What one look at a cube says.
enum Look {
    Empty(bool),
    /// The primitives felt; some of them need smaller voxels.
    Split(Vec<u32>),
    Brick(Vec<u32>),
}

impl Bricks {
    /// The blocks that the surface passes, at most `most`. A voxel's side is `voxel` metres times 2 to the power of the
    /// least of `levels` of all primitives felt in its block, or half of that next to smaller ones: blocks that touch
    /// differ by one level at most, or one of them is empty.
    pub(super) fn new(field: &Field, levels: &[u8], voxel: f32, most: usize) -> Result<Self, SurfaceError> {
        // The largest voxels' middles at the octree's border are outside.
        let margin = voxel * (1u32 << levels.iter().copied().max().unwrap_or_default()) as f32;
        let bounds = field.segments.iter().fold(Bounds::EMPTY, |bounds, segment| {
            let reach = Vec3::splat(field.reach(segment) + margin);
            segment.ends().into_iter().fold(bounds, |bounds, end| bounds.union(Bounds::around(end, reach)))
        });
        let side = bounds.size().max_element();
        let top = (0..28).find(|&top| voxel * (4u32 << top) as f32 >= side).unwrap_or(28);
        let (nodes, origin) = (vec![Node::Empty(false)], bounds.min);
        let mut all = Self { nodes, leaves: Vec::new(), near: Vec::new(), origin, voxel, top };
        let root = Cube { node: 0, corner: IVec3::ZERO, level: top, list: 0 };
        let mut fresh =
            all.grow(field, levels, most, vec![root], vec![(0..levels.len() as u32).collect()])?;
        while !fresh.is_empty() {
            let large = parallel::map(fresh.len(), |i| {
                let (corner, level) = fresh[i];
                let found = all.around(corner, level).into_iter().filter_map(|place| match place {
                    Place::Larger(brick) => Some(brick),
                    _ => None,
                });
                found.collect::<Vec<_>>()
            });
            // Once split, they may still be too large.
            let mut found = large.iter();
            fresh.retain(|_| found.next().is_some_and(|large| !large.is_empty()));
            let mut large = large.concat();
            large.sort_unstable();
            large.dedup();
            let (mut cubes, mut lists) = (Vec::new(), Vec::new());
            for number in large {
                let brick = all.leaves[number as usize].clone();
                lists.push(all.near(&brick).to_vec());
                all.split(brick.node, brick.corner, brick.level, lists.len() - 1, &mut cubes);
                fresh.push((brick.corner, brick.level));
            }
            fresh.extend(all.grow(field, levels, most, cubes, lists)?);
        }
        // Those that were split are none any more.
        let nodes = &mut all.nodes;
        all.leaves.retain(|brick| matches!(nodes[brick.node as usize], Node::Brick(_)));
        for (brick, number) in all.leaves.iter().zip(0..) {
            nodes[brick.node as usize] = Node::Brick(number);
        }
        let inside = parallel::map(all.leaves.len(), |number| {
            let brick = &all.leaves[number];
            let values = all.sample(field, brick);
            (0..64).filter(|&i| values[i] > 0.0).fold(0, |bits, i| bits | 1 << i)
        });
        for (brick, inside) in all.leaves.iter_mut().zip(inside) {
            brick.inside = inside;
        }
        Ok(all)
    }

    /// Splits cubes until they are empty or fine enough; returns those that were split.
    fn grow(
        &mut self,
        field: &Field,
        levels: &[u8],
        most: usize,
        mut cubes: Vec<Cube>,
        mut lists: Vec<Vec<u32>>,
    ) -> Result<Vec<(IVec3, u8)>, SurfaceError> {
        let mut inner = Vec::new();
        while !cubes.is_empty() {
            let looks =
                parallel::map(cubes.len(), |i| self.look(field, levels, &cubes[i], &lists[cubes[i].list]));
            let (mut parts, mut near) = (Vec::new(), Vec::new());
            for (Cube { node, corner, level, .. }, look) in cubes.into_iter().zip(looks) {
                match look {
                    Look::Empty(inside) => self.nodes[node as usize] = Node::Empty(inside),
                    Look::Brick(list) => {
                        let start = self.near.len() as u32;
                        self.near.extend(list);
                        let near = [start, self.near.len() as u32];
                        self.nodes[node as usize] = Node::Brick(self.leaves.len() as u32);
                        self.leaves.push(Brick { corner, level, inside: 0, near, node });
                    }
                    Look::Split(list) => {
                        near.push(list);
                        self.split(node, corner, level, near.len() - 1, &mut parts);
                        inner.push((corner, level));
                    }
                }
            }
            // What is split holds a block or more.
            if self.leaves.len() + near.len() > most || self.near.len() > u32::MAX as usize / 2 {
                return Err(SurfaceError::TooManyBlocks { voxel: self.voxel, most });
            }
            (cubes, lists) = (parts, near);
        }
        Ok(inner)
    }

    fn split(&mut self, node: u32, corner: IVec3, level: u8, list: usize, parts: &mut Vec<Cube>) {
        let first = self.nodes.len() as u32;
        self.nodes[node as usize] = Node::Inner(first);
        for i in 0..8 {
            let corner = corner + (IVec3::new(i & 1, i >> 1 & 1, i >> 2) << i32::from(level + 1));
            parts.push(Cube { node: first + i as u32, corner, level: level - 1, list });
            self.nodes.push(Node::Empty(false));
        }
    }

    fn look(&self, field: &Field, levels: &[u8], cube: &Cube, list: &[u32]) -> Look {
        let step = self.step(cube.level);
        let middle = self.place(cube.corner) + 2.0 * step;
        let (mut split, mut felt) = (false, Vec::new());
        let (mut sum, mut branch) = (0.0, (u32::MAX, 0.0f32));
        for &number in list {
            let segment = &field.segments[number as usize];
            let (least, most) = field.range(segment, middle, BALL * step);
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
                split |= levels[number as usize] < cube.level;
            }
        }
        match () {
            () if sum + branch.1 * branch.1 < 1.0 => Look::Empty(false),
            () if split => Look::Split(felt),
            () => Look::Brick(felt),
        }
    }

    /// What is in each of the 3 · 3 · 3 places around a cube, itself in the middle.
    pub(super) fn around(&self, corner: IVec3, level: u8) -> [Place; 27] {
        std::array::from_fn(|i| {
            let offset = IVec3::new(i as i32 % 3, i as i32 / 3 % 3, i as i32 / 9) - 1;
            self.find(corner + (offset << i32::from(level + 2)), level)
        })
    }

    /// The side of a voxel, metres.
    pub(super) fn step(&self, level: u8) -> f32 {
        self.voxel * (1u32 << level) as f32
    }

    pub(super) fn place(&self, corner: IVec3) -> Vec3 {
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

    /// The field less 1 in the middle of each voxel of a block.
    pub(super) fn sample(&self, field: &Field, brick: &Brick) -> [f32; 64] {
        field.sample(self.near(brick), self.middle(brick, 0), self.step(brick.level))
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
