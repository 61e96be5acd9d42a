//! Marching cubes on the octree's dual: the cubes' corners are the middles of voxels of whatever size.

use super::brick::{Brick, Bricks, Place, STEPS, voxel};
use super::case::{CASES, EDGES};
use super::solid::Part;
use crate::parallel;
use crate::surface::{Mesh, SurfaceError};
use glam::{IVec3, Vec3};

/// Blocks that one thread takes at a time, and how many of these are held before they are joined.
const GROUP: usize = 64;
const HELD: usize = 256;
/// Vertices keep this share of an edge's length from its ends, so that triangles have an area.
const MARGIN: f32 = 1.0 / 32.0;
/// A vertex may be so many parts of its edge off the surface.
const OFF: f32 = 0.01;

/// The edges from a block's voxels to their neighbours that the surface crosses, for each direction: x, y, z, then
/// back along them. An edge between two sizes belongs to the smaller voxel, others to the one that comes first.
#[derive(Debug, Clone, Copy)]
struct Crossed {
    first: u32,
    /// How many are of the directions before.
    before: [u16; 6],
    edges: [u64; 6],
}

impl Crossed {
    fn vertex(&self, direction: usize, cell: u32) -> u32 {
        let before = u32::from(self.before[direction]);
        self.first + before + (self.edges[direction] & ((1 << cell) - 1)).count_ones()
    }
}

/// A block with one voxel more on each side.
struct Surroundings<'a, P> {
    bricks: &'a Bricks<P>,
    brick: &'a Brick,
    number: u32,
    /// What is in each of 3 · 3 · 3 places; the block itself in the middle.
    places: [Place; 27],
}

impl<'a, P: Part> Surroundings<'a, P> {
    fn new(bricks: &'a Bricks<P>, number: u32) -> Self {
        let brick = &bricks.leaves[number as usize];
        let places = bricks.around(brick.corner, brick.level);
        Self { bricks, brick, number, places }
    }

    /// What a voxel is in, -1 to 4 in each direction.
    fn place(&self, cell: IVec3) -> Place {
        let block: IVec3 = (cell + 4) >> 2;
        self.places[(block.x + 3 * block.y + 9 * block.z) as usize]
    }

    /// The block and the voxel that holds this one; none where there is no block of this size or larger.
    fn holder(&self, cell: IVec3) -> Option<(u32, u32)> {
        let bits = |cell: IVec3| (cell.x | cell.y << 2 | cell.z << 4) as u32;
        if (cell.x | cell.y | cell.z) & !3 == 0 {
            return Some((self.number, bits(cell)));
        }
        match self.place(cell) {
            Place::Same(number) => Some((number, bits(cell & 3))),
            Place::Larger(number) => {
                let brick = &self.bricks.leaves[number as usize];
                let corner = self.brick.corner + (cell << i32::from(self.brick.level));
                Some((number, bits((corner - brick.corner) >> i32::from(brick.level))))
            }
            Place::Smaller | Place::Empty(_) => None,
        }
    }

    fn is_inside(&self, cell: IVec3) -> bool {
        match self.holder(cell) {
            Some((number, cell)) => self.bricks.leaves[number as usize].inside >> cell & 1 == 1,
            None => self.place(cell) == Place::Empty(true),
        }
    }

    /// Which edges of this block's the surface crosses.
    fn crossed(&self) -> [u64; 6] {
        let inside = self.brick.inside;
        std::array::from_fn(|direction| {
            let (axis, back) = (direction % 3, direction > 2);
            let (shift, first) = (1 << (2 * axis), FIRST[axis]);
            // Between the block's own voxels.
            let within = if back { 0 } else { (inside ^ inside >> shift) & !(first << (3 * shift)) };
            let border = if back { first } else { first << (3 * shift) };
            let owned = match self.places[(13 + STEPS[direction].dot(IVec3::new(1, 3, 9))) as usize] {
                Place::Same(_) => !back,
                Place::Larger(_) => true,
                Place::Smaller | Place::Empty(_) => false,
            };
            let across = |cell: u32| {
                owned && self.is_inside(voxel(cell) + STEPS[direction]) != (inside >> cell & 1 == 1)
            };
            bits(border).filter(|&cell| across(cell)).fold(within, |edges, cell| edges | 1 << cell)
        })
    }

    /// Where the surface crosses the edge from a voxel to its neighbour, its normal there, and what counts there.
    fn vertex(&self, values: &[f32; 64], direction: usize, cell: u32) -> Option<(Vec3, Vec3, &'a P)> {
        let (number, beyond) = self.holder(voxel(cell) + STEPS[direction])?;
        let other = &self.bricks.leaves[number as usize];
        let from = self.bricks.middle(self.brick, cell);
        let way = self.bricks.middle(other, beyond) - from;
        // The larger one's cube holds the smaller one's middle; not the other way round.
        let larger = if other.level > self.brick.level { number } else { self.number };
        let part = &self.bricks.parts[larger as usize];
        let starts_inside = values[cell as usize] > 0.0;
        let (mut low, mut high) = (MARGIN, 1.0 - MARGIN);
        let start = values[cell as usize];
        let end = if number == self.number { values[beyond as usize] } else { part.value(from + way) };
        let mut t = (start / (start - end)).clamp(low, high);
        let mut tries = 0;
        loop {
            let point = from + way * t;
            let (value, slope) = part.gradient(point);
            let along = slope.dot(way);
            if value.abs() <= OFF * way.length() * slope.length() || tries == 5 || high - low < OFF {
                let outward = if starts_inside { way } else { -way };
                return Some((point, (-slope).normalize_or(outward.normalize_or(Vec3::Y)), part));
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

    /// The triangles around those of the block's voxels' corners that are its own: not a smaller block's, nor one's of
    /// its size that comes before.
    fn triangles(&self, crossed: &[Crossed], indices: &mut Vec<u32>) {
        let rows = self.rows();
        let beside_smaller = self.places.contains(&Place::Smaller);
        for row in 0..25 {
            let row = row % 5 + 6 * (row / 5);
            let (any, all) = [1, 6, 7]
                .iter()
                .fold((rows[row], rows[row]), |(any, all), i| (any | rows[row + i], all & rows[row + i]));
            if !beside_smaller && (any == 0 || all == FULL) {
                continue;
            }
            for x in 0..5 {
                let corners = [0, 1, 6, 7].into_iter().zip([0, 2, 4, 6]);
                let case = corners.fold(0, |case, (offset, shift)| {
                    case | usize::from(rows[row + offset] >> x & 3) << shift
                });
                if beside_smaller || !matches!(case, 0 | 255) {
                    self.triangles_around(
                        IVec3::new(x, row as i32 % 6, row as i32 / 6),
                        case,
                        crossed,
                        indices,
                    );
                }
            }
        }
    }

    /// The triangles around one corner, if they are the block's own.
    fn triangles_around(&self, at: IVec3, mut case: usize, crossed: &[Crossed], indices: &mut Vec<u32>) {
        let back = |i: u8| IVec3::new(i32::from(i & 1), i32::from(i >> 1 & 1), i32::from(i >> 2)) - 1;
        let cell = |i: u8| at + back(i);
        if at.cmpeq(IVec3::ZERO).any() || at.cmpeq(IVec3::splat(4)).any() {
            for i in 0..8 {
                let theirs = match self.place(cell(i)) {
                    Place::Same(number) => number < self.number,
                    Place::Smaller => {
                        let at = self.brick.corner + (at << i32::from(self.brick.level)) + back(i);
                        let leaf = self.bricks.find(at, 0);
                        case |= usize::from(leaf == Place::Empty(true)) << i;
                        !matches!(leaf, Place::Empty(_))
                    }
                    _ => false,
                };
                if theirs {
                    return;
                }
            }
        }
        let mut found = [None; 12];
        for (edge, found) in found.iter_mut().enumerate() {
            let [low, high] = EDGES[edge];
            if (case >> low ^ case >> high) & 1 == 1 {
                *found = self.find(crossed, edge / 4, cell(low), cell(high));
            }
        }
        for triangle in &CASES[case] {
            // Where one voxel is several corners of the cube, edges are one and the same.
            if let [Some(a), Some(b), Some(c)] = triangle.map(|edge| found[edge as usize])
                && a != b
                && b != c
                && c != a
            {
                indices.extend([a, b, c]);
            }
        }
    }

    /// Which voxels are inside, this block's and one more on each side: a bit each along x, rows along y, then z.
    fn rows(&self) -> [u8; 36] {
        let mut rows = [0; 36];
        for row in 0..16 {
            rows[7 + row % 4 + 6 * (row / 4)] = ((self.brick.inside >> (4 * row) & 0xf) << 1) as u8;
        }
        for (i, place) in self.places.iter().enumerate() {
            if i == 13 || matches!(place, Place::Empty(false) | Place::Smaller) {
                continue;
            }
            let range = |block: usize| [-1..0, 0..4, 4..5][block].clone();
            for z in range(i / 9) {
                for y in range(i / 3 % 3) {
                    let row = &mut rows[(y + 1 + 6 * (z + 1)) as usize];
                    for x in range(i % 3) {
                        *row |= u8::from(self.is_inside(IVec3::new(x, y, z))) << (x + 1);
                    }
                }
            }
        }
        rows
    }

    /// The vertex on the edge between two voxels.
    fn find(&self, crossed: &[Crossed], axis: usize, low: IVec3, high: IVec3) -> Option<u32> {
        let (first, second) = (self.holder(low)?, self.holder(high)?);
        let level = |holder: (u32, u32)| self.bricks.leaves[holder.0 as usize].level;
        let ((brick, cell), direction) =
            if level(first) <= level(second) { (first, axis) } else { (second, axis + 3) };
        Some(crossed[brick as usize].vertex(direction, cell))
    }
}

/// A row of six voxels that are all inside.
const FULL: u8 = 0x3f;
/// The voxels on a block's lower side along x, y, z.
const FIRST: [u64; 3] = [0x1111_1111_1111_1111, 0x000f_000f_000f_000f, 0xffff];

/// The places of the bits that are set.
fn bits(mut left: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let bit = (left != 0).then(|| left.trailing_zeros());
        left &= left.wrapping_sub(1);
        bit
    })
}

/// The surface between the voxels of blocks, with the solid's colours if they are wanted.
pub(super) fn march<P: Part>(mut bricks: Bricks<P>, colored: bool) -> Result<Mesh, SurfaceError> {
    let count = bricks.leaves.len();
    let edges = parallel::map(count, |number| Surroundings::new(&bricks, number as u32).crossed());
    let vertices = edges.iter().flatten().map(|edges| edges.count_ones() as usize).sum();
    if vertices > u32::MAX as usize {
        return Err(SurfaceError::TooLarge { vertices });
    }
    let mut first = 0;
    let crossed: Vec<_> = edges
        .into_iter()
        .map(|edges| {
            let mut here = Crossed { first, before: [0; 6], edges };
            for (edges, before) in edges.iter().zip(&mut here.before) {
                *before = (first - here.first) as u16;
                first += edges.count_ones();
            }
            here
        })
        .collect();
    let mut mesh = Mesh::default();
    mesh.positions.reserve_exact(vertices);
    mesh.normals.reserve_exact(vertices);
    mesh.colors.reserve_exact(if colored { vertices } else { 0 });
    in_groups(
        count,
        |number, part: &mut Mesh| {
            let edges = crossed[number as usize].edges;
            if edges == [0; 6] {
                return;
            }
            let around = Surroundings::new(&bricks, number);
            let values = bricks.sample(number as usize);
            for (direction, edges) in edges.into_iter().enumerate() {
                for cell in bits(edges) {
                    if let Some((position, normal, solid)) = around.vertex(&values, direction, cell) {
                        part.positions.push(position);
                        part.normals.push(normal);
                        part.colors.extend(colored.then(|| solid.color(position)));
                    }
                }
            }
        },
        |part| {
            mesh.positions.extend(part.positions);
            mesh.normals.extend(part.normals);
            mesh.colors.extend(part.colors);
        },
    );
    // What triangles do not need goes before they come.
    bricks.parts = Vec::new();
    // Closed surfaces have two triangles a vertex, less four a body and plus four a handle, of which there are few.
    mesh.indices.reserve_exact(6 * vertices + vertices / 32);
    in_groups(
        count,
        |number, indices: &mut Vec<u32>| Surroundings::new(&bricks, number).triangles(&crossed, indices),
        |indices| mesh.indices.extend(indices),
    );
    Ok(mesh)
}

/// Has threads make parts of some blocks each, and joins the parts in the blocks' order before they are too many.
fn in_groups<T: Default + Send>(
    count: usize,
    add: impl Fn(u32, &mut T) + Sync + Send,
    mut join: impl FnMut(T),
) {
    for start in (0..count).step_by(GROUP * HELD) {
        let groups = (count - start).div_ceil(GROUP).min(HELD);
        let parts = parallel::map(groups, |group| {
            let mut part = T::default();
            let first = start + group * GROUP;
            (first..(first + GROUP).min(count)).for_each(|number| add(number as u32, &mut part));
            part
        });
        parts.into_iter().for_each(&mut join);
    }
}
