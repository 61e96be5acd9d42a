//! Growth of the octree: cubes are split until they are empty or fine enough.

use super::brick::{Brick, Bricks, Node, Packed, octant};
use super::solid::{CROWD, Coverage, Part, Solid};
use crate::Bounds;
use crate::observer::{Cancelled, Watch};
use crate::parallel;
use glam::{IVec3, Vec3};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Voxels by which a block's cube is larger on each side: it holds the middles of all voxels that share a face with it and
/// are not larger, rounding included. It lies within that of a block of twice the size.
const MARGIN: f32 = 0.53;

/// Cubes are split level by level until there are this many; from there on each is split on its own, down to
/// its blocks, so that the part that counts in a cube is at hand when its children are examined.
const MANY: usize = 512;
/// Cubes that one thread takes at a time.
const GROUP: usize = 8;
/// Cubes that are split at most: this number per block, and this number besides. The rest of what
/// is thin beside what is thick is empty, but only the finest cubes show it.
const SPLIT_PER_BLOCK: usize = 8;
const SPLIT: usize = 100_000;

/// Lattice of the voxels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    pub(super) origin: Vec3,
    /// The side of the finest, metres.
    pub(super) voxel: f32,
    /// The least number of them in the detail of a place.
    pub(super) per_detail: f32,
}

/// A cube of the octree still to be looked at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cube {
    pub(super) node: u32,
    pub(super) corner: IVec3,
    pub(super) level: u8,
    /// Part that has all that counts here.
    pub(super) of: usize,
}

/// Growth below some cubes. Nodes, blocks and parts are numbered from 0 on.
struct Grown<P> {
    nodes: Vec<Packed>,
    leaves: Vec<Brick>,
    parts: Vec<P>,
    /// Extra blocks counted for blocks in which many primitives are felt.
    crowd: usize,
    /// Results for the cubes' own nodes.
    roots: Vec<(u32, Packed)>,
    /// Cubes that were split.
    split: Vec<(IVec3, u8)>,
    /// Cubes not yet looked at, and what counts there.
    rest: Vec<Cube>,
    of: Vec<P>,
}

/// The solid and the limits with which cubes are examined.
struct Setting<'a, S> {
    solid: &'a S,
    /// `true` if a cube's descendants are examined together with it.
    deep: bool,
    watch: &'a Watch<'a>,
    count: &'a Count,
}

/// Totals over all threads, so that any of them notices when they exceed the limits.
struct Count {
    /// The greatest number of blocks, and how many there are.
    most: usize,
    blocks: AtomicUsize,
    /// Cubes that were split.
    split: AtomicUsize,
}

impl Count {
    fn is_full(&self) -> bool {
        let most_split = self.most.saturating_mul(SPLIT_PER_BLOCK).saturating_add(SPLIT);
        self.blocks.load(Ordering::Relaxed) > self.most || self.split.load(Ordering::Relaxed) > most_split
    }
}

/// Result of one look at a cube.
enum Look<P> {
    Empty(bool),
    /// Smaller voxels are needed.
    Split(P),
    Brick(P),
}

impl<P: Part> Bricks<P> {
    /// Splits cubes until they are empty or fine enough; returns those that were split, or nothing if that
    /// makes more than `most` blocks in all, or splits many more cubes than that.
    pub(super) fn grow(
        &mut self,
        solid: &impl Solid<Part = P>,
        most: usize,
        mut cubes: Vec<Cube>,
        mut of: Vec<P>,
        parts: &mut Vec<Option<P>>,
        watch: &Watch<'_>,
    ) -> Result<Option<Vec<(IVec3, u8)>>, Cancelled> {
        let mut split = Vec::new();
        let count = Count {
            most,
            blocks: AtomicUsize::new(self.leaves.len() + self.crowd),
            split: AtomicUsize::new(self.nodes.len() / 8),
        };
        while !cubes.is_empty() {
            let deep = cubes.len() >= MANY;
            let grown = parallel::map(cubes.len().div_ceil(GROUP), |group| {
                let mut grown = Grown::default();
                for cube in &cubes[group * GROUP..cubes.len().min((group + 1) * GROUP)] {
                    if !count.is_full() && watch.goes_on() {
                        let setting = Setting { solid, deep, watch, count: &count };
                        let root = self.grid.below(&setting, cube, of.get(cube.of), &mut grown);
                        grown.roots.push((cube.node, root));
                    }
                }
                grown
            });
            (cubes, of) = (Vec::new(), Vec::new());
            watch.pass(0)?;
            if count.is_full() {
                return Ok(None);
            }
            for grown in grown {
                let (nodes, leaves) = (self.nodes.len() as u32, self.leaves.len() as u32);
                let moved = |node: Packed| match node.node() {
                    Node::Inner(first) => Node::Inner(first + nodes).into(),
                    Node::Brick(number) => Node::Brick(number + leaves).into(),
                    Node::Empty(_) => node,
                };
                if self.nodes.len() + grown.nodes.len() >= Packed::MOST {
                    return Ok(None);
                }
                self.nodes.extend(grown.nodes.into_iter().map(moved));
                for (node, root) in grown.roots {
                    self.nodes[node as usize] = moved(root);
                }
                let moved = |cube: Cube| Cube { node: cube.node + nodes, of: cube.of + of.len(), ..cube };
                cubes.extend(grown.rest.into_iter().map(moved));
                of.extend(grown.of);
                self.crowd += grown.crowd;
                self.leaves.extend(grown.leaves);
                parts.extend(grown.parts.into_iter().map(Some));
                split.extend(grown.split);
            }
        }
        Ok(Some(split))
    }
}

impl Grid {
    /// The side of a voxel, metres.
    pub(super) fn step(&self, level: u8) -> f32 {
        self.voxel * (1u32 << level) as f32
    }

    pub(super) fn place(&self, corner: IVec3) -> Vec3 {
        self.origin + corner.as_vec3() * self.voxel
    }

    /// Looks at a cube and, if it goes deep, at what is below it.
    fn below<P: Part>(
        &self,
        setting: &Setting<'_, impl Solid<Part = P>>,
        cube: &Cube,
        of: Option<&P>,
        grown: &mut Grown<P>,
    ) -> Packed {
        let &Cube { corner, level, .. } = cube;
        if !setting.watch.steps(1) || setting.count.is_full() {
            return Node::Empty(false).into();
        }
        let node = match self.look(setting.solid, cube, of) {
            Look::Empty(inside) => Node::Empty(inside),
            Look::Brick(part) => {
                let crowd = part.count() / CROWD;
                grown.crowd += crowd;
                setting.count.blocks.fetch_add(1 + crowd, Ordering::Relaxed);
                grown.leaves.push(Brick { corner, level, inside: 0 });
                grown.parts.push(part);
                Node::Brick(grown.leaves.len() as u32 - 1)
            }
            Look::Split(part) => {
                let first = grown.nodes.len() as u32;
                grown.nodes.extend([Packed::from(Node::Empty(false)); 8]);
                grown.split.push((corner, level));
                setting.count.split.fetch_add(1, Ordering::Relaxed);
                let children = cube.children(first, grown.of.len());
                if setting.deep {
                    for cube in children {
                        let node = self.below(setting, &cube, Some(&part), grown);
                        grown.nodes[cube.node as usize] = node;
                    }
                } else {
                    grown.rest.extend(children);
                    grown.of.push(part);
                }
                Node::Inner(first)
            }
        };
        node.into()
    }

    fn look<P: Part>(&self, solid: &impl Solid<Part = P>, cube: &Cube, of: Option<&P>) -> Look<P> {
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
        if cube.level > 0 && step * self.per_detail > part.detail() {
            Look::Split(part)
        } else {
            Look::Brick(part)
        }
    }
}

impl Cube {
    /// Its eight children, whose nodes are those from `first` on.
    pub(super) fn children(self, first: u32, of: usize) -> [Self; 8] {
        let level = self.level - 1;
        std::array::from_fn(|i| {
            let corner = self.corner + (octant(i as u32) << i32::from(self.level + 1));
            Self { node: first + i as u32, corner, level, of }
        })
    }
}

impl<P> Default for Grown<P> {
    fn default() -> Self {
        Self {
            nodes: Vec::new(),
            leaves: Vec::new(),
            parts: Vec::new(),
            crowd: 0,
            roots: Vec::new(),
            split: Vec::new(),
            rest: Vec::new(),
            of: Vec::new(),
        }
    }
}
