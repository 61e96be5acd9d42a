//! An octree whose leaves hold four voxels in each direction: the sparse blocks along the surface.

use super::solid::{Coverage, Part, Solid};
use crate::Bounds;
use crate::parallel;
use crate::surface::SurfaceError;
use glam::{IVec3, Vec3};

/// By so many voxels a block's cube is larger on each side: it holds the middles of all voxels that share a face with it and
/// are not larger, rounding included. It lies within that of a block of twice the size.
const MARGIN: f32 = 0.53;

/// The directions of a voxel's faces.
pub(super) const STEPS: [IVec3; 6] = [IVec3::X, IVec3::Y, IVec3::Z, IVec3::NEG_X, IVec3::NEG_Y, IVec3::NEG_Z];

/// Four voxels in each direction, near the surface.
#[derive(Debug, Clone)]
pub(super) struct Brick {
    /// In finest voxels from the octree's corner.
    pub(super) corner: IVec3,
    /// Its voxels are 2 to the power of this finest voxels long.
    pub(super) level: u8,
    /// Bit `x + 4y + 16z` says that the middle of that voxel is inside.
    pub(super) inside: u64,
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
pub(super) struct Bricks<P> {
    nodes: Vec<Node>,
    pub(super) leaves: Vec<Brick>,
    /// What counts in each block or within half a voxel of it.
    pub(super) parts: Vec<P>,
    origin: Vec3,
    voxel: f32,
    /// The level at which one block would hold everything.
    top: u8,
}

/// A cube of the octree still to be looked at.
struct Cube {
    node: u32,
    corner: IVec3,
    level: u8,
    /// Which part has all that counts here.
    of: usize,
}

/// What one look at a cube says.
enum Look<P> {
    Empty(bool),
    /// Smaller voxels are needed.
    Split(P),
    Brick(P),
}

impl<P: Part> Bricks<P> {
    /// The blocks that the surface may pass, at most `most`. A voxel's side is `voxel` metres times the greatest power of
    /// two that does not exceed the [detail](Part::detail) in its block, or half of that next to smaller ones: blocks that
    /// touch differ by one level at most, or one of them is empty.
    pub(super) fn new(solid: &impl Solid<Part = P>, voxel: f32, most: usize) -> Result<Self, SurfaceError> {
        // The voxels at the octree's border, at most a quarter of its side long, have their middles outside.
        let bounds = solid.bounds();
        let least = bounds.size().max_element() * (4.0 / 3.0);
        let top = (0..28).find(|&top| voxel * (4u32 << top) as f32 >= least).unwrap_or(28);
        let origin = bounds.center() - Vec3::splat(voxel * (2u32 << top) as f32);
        let mut all = Self {
            nodes: vec![Node::Empty(false)],
            leaves: Vec::new(),
            parts: Vec::new(),
            origin,
            voxel,
            top,
        };
        if bounds.is_empty() {
            return Ok(all);
        }
        let root = Cube { node: 0, corner: IVec3::ZERO, level: top, of: 0 };
        let mut parts = Vec::new();
        let mut fresh = all.grow(solid, most, vec![root], &[], &mut parts)?;
        let mut sampled = 0;
        loop {
            let large = if fresh.is_empty() {
                all.sample_from(sampled, &parts);
                sampled = parts.len();
                let clashing = all.clashing(&parts);
                if clashing.is_empty() {
                    break;
                }
                clashing
            } else {
                all.larger_than(&mut fresh)
            };
            let (mut cubes, mut of) = (Vec::new(), Vec::new());
            for number in large {
                let Brick { node, corner, level, .. } = all.leaves[number as usize];
                all.split(node, corner, level, of.len(), &mut cubes);
                of.extend(parts[number as usize].take());
                fresh.push((corner, level));
            }
            fresh.extend(all.grow(solid, most, cubes, &of, &mut parts)?);
        }
        // Those that were split have no part any more.
        let mut kept = parts.iter();
        all.leaves.retain(|_| kept.next().is_some_and(Option::is_some));
        all.parts = parts.into_iter().flatten().collect();
        for (brick, number) in all.leaves.iter().zip(0..) {
            all.nodes[brick.node as usize] = Node::Brick(number);
        }
        Ok(all)
    }

    /// Which blocks are too large beside cubes that were split; of these, keeps those that have such.
    fn larger_than(&self, split: &mut Vec<(IVec3, u8)>) -> Vec<u32> {
        let large = parallel::map(split.len(), |i| {
            let (corner, level) = split[i];
            let found = self.around(corner, level).into_iter().filter_map(|place| match place {
                Place::Larger(brick) => Some(brick),
                _ => None,
            });
            found.collect::<Vec<_>>()
        });
        // Once split, they may still be too large.
        let mut found = large.iter();
        split.retain(|_| found.next().is_some_and(|large| !large.is_empty()));
        let mut large = large.concat();
        large.sort_unstable();
        large.dedup();
        large
    }

    /// Which blocks have a voxel inside beside a smaller place without blocks that is outside, or the other way round: the
    /// surface passes between the voxel's middle and that place.
    fn clashing(&self, parts: &[Option<P>]) -> Vec<u32> {
        let clashes = parallel::map(self.leaves.len(), |number| {
            let brick = &self.leaves[number];
            let size = 4 << i32::from(brick.level);
            parts[number].is_some()
                && brick.level > 0
                && STEPS.into_iter().any(|step| {
                    self.find(brick.corner + step * size, brick.level) == Place::Smaller
                        && (0..64).any(|cell| self.clashes(brick, cell, step))
                })
        });
        (0..).zip(clashes).filter_map(|(number, clashes)| clashes.then_some(number)).collect()
    }

    /// Whether a voxel of a block touches, in that direction, a smaller place that is empty, but not as itself.
    fn clashes(&self, brick: &Brick, cell: u32, step: IVec3) -> bool {
        let beyond = voxel(cell) + step;
        // Half a voxel is a quarter of the smaller place.
        let corner = brick.corner + (beyond << i32::from(brick.level));
        beyond.to_array().iter().any(|&x| !(0..4).contains(&x))
            && self.find(corner, 0) == Place::Empty(brick.inside >> cell & 1 == 0)
    }

    /// Finds out which voxels of the later blocks are inside.
    fn sample_from(&mut self, first: usize, parts: &[Option<P>]) {
        let inside = parallel::map(self.leaves.len() - first, |i| {
            let (brick, part) = (&self.leaves[first + i], &parts[first + i]);
            let values = part.as_ref().map_or([0.0; 64], |part| self.values(brick, part));
            (0..64).filter(|&i| values[i] > 0.0).fold(0, |bits, i| bits | 1 << i)
        });
        for (brick, inside) in self.leaves[first..].iter_mut().zip(inside) {
            brick.inside = inside;
        }
    }

    /// Splits cubes until they are empty or fine enough; returns those that were split.
    fn grow(
        &mut self,
        solid: &impl Solid<Part = P>,
        most: usize,
        mut cubes: Vec<Cube>,
        of: &[P],
        parts: &mut Vec<Option<P>>,
    ) -> Result<Vec<(IVec3, u8)>, SurfaceError> {
        let mut inner = Vec::new();
        let mut held: Vec<P>;
        let mut of = of;
        while !cubes.is_empty() {
            let looks = parallel::map(cubes.len(), |i| self.look(solid, &cubes[i], of.get(cubes[i].of)));
            let (mut next, mut split) = (Vec::new(), Vec::new());
            for (Cube { node, corner, level, .. }, look) in cubes.into_iter().zip(looks) {
                match look {
                    Look::Empty(inside) => self.nodes[node as usize] = Node::Empty(inside),
                    Look::Brick(part) => {
                        self.nodes[node as usize] = Node::Brick(self.leaves.len() as u32);
                        self.leaves.push(Brick { corner, level, inside: 0, node });
                        parts.push(Some(part));
                    }
                    Look::Split(part) => {
                        self.split(node, corner, level, split.len(), &mut next);
                        split.push(part);
                        inner.push((corner, level));
                    }
                }
            }
            // What is split holds a block or more.
            if self.leaves.len() + split.len() > most {
                return Err(SurfaceError::TooManyBlocks { voxel: self.voxel, most });
            }
            (cubes, held) = (next, split);
            of = &held;
        }
        Ok(inner)
    }

    fn split(&mut self, node: u32, corner: IVec3, level: u8, of: usize, cubes: &mut Vec<Cube>) {
        let first = self.nodes.len() as u32;
        self.nodes[node as usize] = Node::Inner(first);
        for i in 0..8 {
            let corner = corner + (IVec3::new(i & 1, i >> 1 & 1, i >> 2) << i32::from(level + 1));
            cubes.push(Cube { node: first + i as u32, corner, level: level - 1, of });
            self.nodes.push(Node::Empty(false));
        }
    }

    fn look(&self, solid: &impl Solid<Part = P>, cube: &Cube, of: Option<&P>) -> Look<P> {
        let step = self.step(cube.level);
        let corner = self.place(cube.corner);
        let bounds = Bounds::new(corner, corner + 4.0 * step).grown(MARGIN * step);
        let part = match solid.part(of, bounds) {
            Coverage::Outside => return Look::Empty(false),
            Coverage::Inside => return Look::Empty(true),
            Coverage::Crossed(part) => part,
        };
        // Nowhere in the cube is the value farther from that in its middle.
        let value = part.value(bounds.center());
        if value.abs() > part.lipschitz() * bounds.size().length() * 0.5 {
            return Look::Empty(value > 0.0);
        }
        if cube.level > 0 && step > part.detail() { Look::Split(part) } else { Look::Brick(part) }
    }

    /// What is in each of the 3 · 3 · 3 places around a cube, itself in the middle.
    pub(super) fn around(&self, corner: IVec3, level: u8) -> [Place; 27] {
        let offset = |i: usize| IVec3::new(i as i32 % 3, i as i32 / 3 % 3, i as i32 / 9);
        if level == self.top {
            let beside = |i| self.find(corner + ((offset(i) - 1) << i32::from(level + 2)), level);
            return std::array::from_fn(beside);
        }
        // They lie in eight cubes of twice the size.
        let first: IVec3 = (corner >> i32::from(level + 2)) - 1;
        let parents: [Found; 8] = std::array::from_fn(|i| {
            let offset = IVec3::new(i as i32 & 1, i as i32 >> 1 & 1, i as i32 >> 2);
            self.reach(((first >> 1) + offset) << i32::from(level + 3), level + 1)
        });
        std::array::from_fn(|i| {
            let place: IVec3 = (first & 1) + offset(i);
            let (parent, child): (IVec3, IVec3) = (place >> 1, place & 1);
            let child = (child.x | child.y << 1 | child.z << 2) as usize;
            match parents[(parent.x | parent.y << 1 | parent.z << 2) as usize] {
                Found { node: Node::Inner(first), level: at } if at == level + 1 => {
                    place_of(Found { node: self.nodes[first as usize + child], level }, level)
                }
                found => place_of(found, level),
            }
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
        self.place(brick.corner) + (voxel(cell).as_vec3() + 0.5) * self.step(brick.level)
    }

    /// The value in the middle of each voxel of a block.
    pub(super) fn sample(&self, number: usize) -> [f32; 64] {
        self.values(&self.leaves[number], &self.parts[number])
    }

    fn values(&self, brick: &Brick, part: &P) -> [f32; 64] {
        part.sample(self.middle(brick, 0), self.step(brick.level))
    }

    /// What is at a corner that blocks of that level can have.
    pub(super) fn find(&self, corner: IVec3, level: u8) -> Place {
        place_of(self.reach(corner, level), level)
    }

    /// The node at a corner that cubes of that level can have, or the larger leaf there.
    fn reach(&self, corner: IVec3, level: u8) -> Found {
        let outside = corner.to_array().into_iter().fold(0, |outside, x| outside | x >> (self.top + 2));
        if outside != 0 {
            return Found { node: Node::Empty(false), level };
        }
        let mut found = Found { node: self.nodes[0], level: self.top };
        while let Node::Inner(first) = found.node
            && found.level > level
        {
            found.level -= 1;
            let bits = (corner >> i32::from(found.level + 2)) & 1;
            found.node = self.nodes[first as usize + (bits.x | bits.y << 1 | bits.z << 2) as usize];
        }
        found
    }
}

/// A node of the octree and its level.
#[derive(Debug, Clone, Copy)]
struct Found {
    node: Node,
    level: u8,
}

fn place_of(found: Found, level: u8) -> Place {
    match found.node {
        Node::Empty(inside) => Place::Empty(inside),
        Node::Brick(brick) if found.level == level => Place::Same(brick),
        Node::Brick(brick) => Place::Larger(brick),
        Node::Inner(_) => Place::Smaller,
    }
}

/// Where in its block a voxel is.
pub(super) fn voxel(cell: u32) -> IVec3 {
    (IVec3::splat(cell as i32) >> IVec3::new(0, 2, 4)) & 3
}
