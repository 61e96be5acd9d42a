//! An octree whose leaves hold four voxels in each direction: the sparse blocks along the surface.

use super::Voxels;
use super::grow::{Cube, Grid};
use super::solid::{Part, Solid};
use crate::observer::{Cancelled, Watch};
use crate::parallel;
use crate::surface::SurfaceError;
use glam::{IVec3, Vec3};

/// Cubes that one thread takes at a time.
const GROUP: usize = 1024;

/// The directions of a voxel's faces.
pub(super) const STEPS: [IVec3; 6] = [IVec3::X, IVec3::Y, IVec3::Z, IVec3::NEG_X, IVec3::NEG_Y, IVec3::NEG_Z];

/// Four voxels in each direction, near the surface.
#[derive(Debug, Clone)]
pub(super) struct Brick {
    /// Position of its corner, in finest voxels from the octree's corner.
    pub(super) corner: IVec3,
    /// Its voxels are 2 to the power of this finest voxels long.
    pub(super) level: u8,
    /// Bit `x + 4y + 16z` says that the middle of that voxel is inside.
    pub(super) inside: u64,
}

/// Contents of a place of the size of a block.
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

/// State at a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Node {
    /// The first of eight children.
    Inner(u32),
    Brick(u32),
    Empty(bool),
}

/// A [`Node`] in four bytes: there are several for each block.
#[derive(Debug, Clone, Copy)]
pub(super) struct Packed(u32);

impl Packed {
    /// There are fewer nodes than this.
    pub(super) const MOST: usize = 1 << 30;

    pub(super) fn node(self) -> Node {
        match self.0 & 3 {
            0 => Node::Inner(self.0 >> 2),
            1 => Node::Brick(self.0 >> 2),
            kind => Node::Empty(kind == 3),
        }
    }
}

impl From<Node> for Packed {
    fn from(node: Node) -> Self {
        Self(match node {
            Node::Inner(first) => first << 2,
            Node::Brick(number) => number << 2 | 1,
            Node::Empty(inside) => 2 | u32::from(inside),
        })
    }
}

/// All blocks, along a curve that fills space: those of one cube of the octree follow each other.
#[derive(Debug)]
pub(super) struct Bricks<P> {
    pub(super) nodes: Vec<Packed>,
    pub(super) leaves: Vec<Brick>,
    /// Parts that count in each block or within half a voxel of it.
    pub(super) parts: Vec<P>,
    pub(super) grid: Grid,
    /// Extra blocks counted for blocks in which many primitives are felt, see [`CROWD`](super::solid::CROWD).
    pub(super) crowd: usize,
    /// The level at which one block would hold everything.
    top: u8,
}

/// A node of the octree and its level.
#[derive(Debug, Clone, Copy)]
struct Found {
    node: Node,
    level: u8,
}

/// The way from the octree's root to a cube, from which others near it are soon found.
struct Path {
    corner: IVec3,
    level: u8,
    /// The first child of the cube's ancestor of each level.
    firsts: [u32; 32],
}

impl<P: Part> Bricks<P> {
    /// The blocks that the surface may pass, at most [`most_blocks`](Voxels::most_blocks). A voxel's side is
    /// that of the finest times a power of two: the greatest of which [`per_detail`](Voxels::per_detail)
    /// voxels do not exceed the [detail](Part::detail) in its block, or half of that next to smaller ones.
    /// Blocks that touch differ by one level at most, or one of them is empty.
    pub(super) fn new(
        solid: &impl Solid<Part = P>,
        voxels: &Voxels,
        watch: &Watch<'_>,
    ) -> Result<Self, SurfaceError> {
        let Voxels { side: voxel, per_detail, most_blocks: most } = *voxels;
        // The voxels at the octree's border, at most a quarter of its side long, have their middles outside.
        let bounds = solid.bounds();
        let least = bounds.size().max_element() * (4.0 / 3.0);
        let top = (0..28).find(|&top| voxel * (4u32 << top) as f32 >= least).unwrap_or(28);
        let origin = bounds.center() - Vec3::splat(voxel * (2u32 << top) as f32);
        let mut all = Self {
            nodes: vec![Node::Empty(false).into()],
            leaves: Vec::new(),
            parts: Vec::new(),
            grid: Grid { origin, voxel, per_detail },
            crowd: 0,
            top,
        };
        if bounds.is_empty() {
            return Ok(all);
        }
        let root = Cube { node: 0, corner: IVec3::ZERO, level: top, of: 0 };
        let too_many = SurfaceError::TooManyBlocks { voxel, most };
        // Blocks that were split have no part any more.
        let (mut parts, mut gone) = (Vec::new(), 0);
        let mut fresh =
            all.grow(solid, most, vec![root], Vec::new(), &mut parts, watch)?.ok_or(too_many.clone())?;
        let mut sampled = 0;
        loop {
            let large = if fresh.is_empty() {
                all.sample_from(sampled, &parts, watch)?;
                sampled = parts.len();
                let clashing = all.clashing(&parts, watch)?;
                if clashing.is_empty() {
                    break;
                }
                clashing
            } else {
                all.larger_than(&mut fresh, watch)?
            };
            gone += large.len();
            let (mut cubes, mut of) = (Vec::new(), Vec::new());
            for number in large {
                let Brick { corner, level, .. } = all.leaves[number as usize];
                all.split(corner, level, of.len(), &mut cubes);
                of.extend(parts[number as usize].take());
                fresh.push((corner, level));
            }
            let grown = all.grow(solid, most + gone, cubes, of, &mut parts, watch)?;
            fresh.extend(grown.ok_or(too_many.clone())?);
        }
        all.put_in_order(parts);
        Ok(all)
    }

    /// Puts eight cubes in a block's place.
    fn split(&mut self, corner: IVec3, level: u8, of: usize, cubes: &mut Vec<Cube>) {
        let mut node = 0;
        let mut at = self.top;
        while let Node::Inner(first) = self.nodes[node].node() {
            at -= 1;
            node = (first + child(corner, at)) as usize;
        }
        let first = self.nodes.len() as u32;
        self.nodes[node] = Node::Inner(first).into();
        self.nodes.extend([Packed::from(Node::Empty(false)); 8]);
        cubes.extend(Cube { node: 0, corner, level, of }.children(first, of));
    }

    /// Numbers blocks along a curve that fills space, however they were found, and leaves out those that were split.
    fn put_in_order(&mut self, mut parts: Vec<Option<P>>) {
        let count = parts.iter().flatten().count();
        let mut leaves = Vec::with_capacity(count);
        self.parts.reserve_exact(count);
        let mut waiting = vec![0];
        while let Some(node) = waiting.pop() {
            match self.nodes[node as usize].node() {
                Node::Inner(first) => waiting.extend((first..first + 8).rev()),
                Node::Brick(number) => {
                    self.nodes[node as usize] = Node::Brick(leaves.len() as u32).into();
                    leaves.push(self.leaves[number as usize].clone());
                    self.parts.extend(parts[number as usize].take());
                }
                Node::Empty(_) => (),
            }
        }
        self.leaves = leaves;
        self.nodes.shrink_to_fit();
    }

    /// Finds the blocks that are too large beside cubes that were split. Keeps in `split` those cubes that
    /// have such a block beside them.
    fn larger_than(&self, split: &mut Vec<(IVec3, u8)>, watch: &Watch<'_>) -> Result<Vec<u32>, Cancelled> {
        let groups = split.len().div_ceil(GROUP);
        let large = parallel::map(groups, |group| {
            let mut found = (Vec::new(), Vec::new());
            if !watch.steps(GROUP / 8) {
                return found;
            }
            for &(corner, level) in &split[group * GROUP..split.len().min((group + 1) * GROUP)] {
                let before = found.0.len();
                if level < self.top {
                    found.0.extend(self.parents(&self.path(corner, level)).iter().filter_map(|parent| {
                        match parent.node {
                            Node::Brick(brick) => Some(brick),
                            _ => None,
                        }
                    }));
                }
                // Once split, they may still be too large.
                if found.0.len() > before {
                    found.1.push((corner, level));
                }
            }
            found
        });
        let (large, kept): (Vec<_>, Vec<_>) = large.into_iter().unzip();
        *split = kept.concat();
        let mut large = large.concat();
        large.sort_unstable();
        large.dedup();
        watch.pass(0)?;
        Ok(large)
    }

    /// Finds the blocks that have a voxel inside beside a smaller place without blocks that is outside, or
    /// the other way round: the surface passes between the voxel's middle and that place.
    fn clashing(&self, parts: &[Option<P>], watch: &Watch<'_>) -> Result<Vec<u32>, Cancelled> {
        let clashes = parallel::map(self.leaves.len(), |number| {
            let brick = &self.leaves[number];
            (number % 64 != 0 || watch.steps(8))
                && parts[number].is_some()
                && brick.level > 0
                && self.beside(brick).into_iter().zip(STEPS).any(|(place, step)| {
                    place == Place::Smaller && (0..64).any(|cell| self.clashes(brick, cell, step))
                })
        });
        watch.pass(0)?;
        Ok((0..).zip(clashes).filter_map(|(number, clashes)| clashes.then_some(number)).collect())
    }

    /// `true` if a voxel of a block touches, in the direction `step`, a smaller place without blocks that is
    /// on the other side of the surface.
    fn clashes(&self, brick: &Brick, cell: u32, step: IVec3) -> bool {
        let beyond = voxel(cell) + step;
        // Half a voxel is a quarter of the smaller place.
        let corner = brick.corner + (beyond << i32::from(brick.level));
        beyond.to_array().iter().any(|&x| !(0..4).contains(&x))
            && self.find(corner, 0) == Place::Empty(brick.inside >> cell & 1 == 0)
    }

    /// Finds out which voxels of the later blocks are inside.
    fn sample_from(&mut self, first: usize, parts: &[Option<P>], watch: &Watch<'_>) -> Result<(), Cancelled> {
        let inside = parallel::map(self.leaves.len() - first, |i| {
            if !watch.steps(16) {
                return 0;
            }
            let (brick, part) = (&self.leaves[first + i], &parts[first + i]);
            let values = part.as_ref().map_or([0.0; 64], |part| self.values(brick, part));
            (0..64).fold(0, |bits, i| bits | u64::from(values[i] > 0.0) << i)
        });
        for (brick, inside) in self.leaves[first..].iter_mut().zip(inside) {
            brick.inside = inside;
        }
        watch.pass(0)
    }

    fn path(&self, corner: IVec3, level: u8) -> Path {
        let mut path = Path { corner, level, firsts: [0; 32] };
        let (mut node, mut at) = (self.nodes[0], self.top);
        while at > level
            && let Node::Inner(first) = node.node()
        {
            path.firsts[usize::from(at)] = first;
            at -= 1;
            node = self.nodes[(first + child(corner, at)) as usize];
        }
        path
    }

    /// The eight cubes of twice the size, or what larger holds them, in which the 3 · 3 · 3 places around a cube lie.
    fn parents(&self, path: &Path) -> [Found; 8] {
        let level = i32::from(path.level);
        let first: IVec3 = ((path.corner >> (level + 2)) - 1) >> 1;
        std::array::from_fn(|i| self.near(path, (first + octant(i as u32)) << (level + 3), path.level + 1))
    }

    /// Contents of the 3 · 3 · 3 places around a block, itself in the middle.
    pub(super) fn around(&self, brick: &Brick) -> [Place; 27] {
        let (corner, level) = (brick.corner, brick.level);
        let mut places = [Place::Empty(false); 27];
        places[13] = self.find(corner, level);
        if level == self.top {
            return places;
        }
        let parents = self.parents(&self.path(corner, level));
        let odd = ((corner >> i32::from(level + 2)) - 1) & 1;
        let [x, y, z] = odd.to_array().map(|odd| odd as usize);
        for (i, place) in places.iter_mut().enumerate() {
            let [x, y, z] = [x + i % 3, y + i / 3 % 3, z + i / 9];
            let found = parents[x >> 1 | y & 2 | (z & 2) << 1];
            let child = (x & 1 | (y & 1) << 1 | (z & 1) << 2) as u32;
            *place = match found.node {
                Node::Inner(first) => {
                    place_of(Found { node: self.nodes[(first + child) as usize].node(), level }, level)
                }
                _ => place_of(found, level),
            };
        }
        places
    }

    /// Neighbour at each of a block's faces.
    pub(super) fn beside(&self, brick: &Brick) -> [Place; 6] {
        let (corner, level) = (brick.corner, brick.level);
        if level == self.top {
            return [Place::Empty(false); 6];
        }
        let path = self.path(corner, level);
        STEPS.map(|step| place_of(self.near(&path, corner + step * (4 << level), level), level))
    }

    /// The side of a voxel, metres.
    pub(super) fn step(&self, level: u8) -> f32 {
        self.grid.step(level)
    }

    #[cfg(test)]
    pub(super) fn place(&self, corner: IVec3) -> Vec3 {
        self.grid.place(corner)
    }

    /// The middle of a block's voxel, metres.
    pub(super) fn middle(&self, brick: &Brick, cell: u32) -> Vec3 {
        self.grid.place(brick.corner) + (voxel(cell).as_vec3() + 0.5) * self.step(brick.level)
    }

    /// The value in the middle of each voxel of a block.
    pub(super) fn sample(&self, number: usize) -> [f32; 64] {
        self.values(&self.leaves[number], &self.parts[number])
    }

    fn values(&self, brick: &Brick, part: &P) -> [f32; 64] {
        part.sample(self.middle(brick, 0), self.step(brick.level))
    }

    /// The block and its voxel that is in a place beside or around another block, whose voxels may be counted on into the
    /// place; none where blocks are smaller or missing.
    pub(super) fn holder(&self, brick: &Brick, place: Place, cell: IVec3) -> Option<(u32, u32)> {
        let bits = |cell: IVec3| (cell.x | cell.y << 2 | cell.z << 4) as u32;
        match place {
            Place::Same(number) => Some((number, bits(cell & 3))),
            Place::Larger(number) => {
                let larger = &self.leaves[number as usize];
                let corner = brick.corner + (cell << i32::from(brick.level));
                Some((number, bits((corner - larger.corner) >> i32::from(larger.level))))
            }
            Place::Smaller | Place::Empty(_) => None,
        }
    }

    /// State at a corner that blocks of that level can have.
    pub(super) fn find(&self, corner: IVec3, level: u8) -> Place {
        let outside = corner.to_array().into_iter().fold(0, |outside, x| outside | x >> (self.top + 2));
        if outside != 0 {
            return Place::Empty(false);
        }
        place_of(self.down(Found { node: self.nodes[0].node(), level: self.top }, corner, level), level)
    }

    /// The node near a cube at a corner that cubes of that level can have, or the larger leaf there.
    fn near(&self, path: &Path, corner: IVec3, level: u8) -> Found {
        let differ = corner ^ path.corner;
        // Both are in one cube of this level.
        let bits = (differ.x | differ.y | differ.z | 1) as u32;
        let common = (30 - bits.leading_zeros() as i32).max(i32::from(path.level) + 1);
        if common > i32::from(self.top) {
            return Found { node: Node::Empty(false), level };
        }
        let node = Node::Inner(path.firsts[common as usize]);
        self.down(Found { node, level: common as u8 }, corner, level)
    }

    fn down(&self, mut found: Found, corner: IVec3, level: u8) -> Found {
        while let Node::Inner(first) = found.node
            && found.level > level
        {
            found.level -= 1;
            found.node = self.nodes[(first + child(corner, found.level)) as usize].node();
        }
        found
    }
}

fn place_of(found: Found, level: u8) -> Place {
    match found.node {
        Node::Empty(inside) => Place::Empty(inside),
        Node::Brick(brick) if found.level == level => Place::Same(brick),
        Node::Brick(brick) => Place::Larger(brick),
        Node::Inner(_) => Place::Smaller,
    }
}

/// Number of the child, of eight, that has a corner, if they are of that level.
fn child(corner: IVec3, level: u8) -> u32 {
    let bits = (corner >> i32::from(level + 2)) & 1;
    (bits.x | bits.y << 1 | bits.z << 2) as u32
}

/// Place of one among eight cubes.
pub(super) fn octant(i: u32) -> IVec3 {
    IVec3::new(i as i32 & 1, i as i32 >> 1 & 1, i as i32 >> 2)
}

/// Place of a voxel in its block.
pub(super) fn voxel(cell: u32) -> IVec3 {
    (IVec3::splat(cell as i32) >> IVec3::new(0, 2, 4)) & 3
}
