//! Marching cubes on the octree's dual: the cubes' corners are the middles of voxels of whatever size.

use super::brick::{Brick, Bricks, Place};
use super::case::{CASES, EDGES};
use super::field::Field;
use crate::parallel;
use crate::surface::Mesh;
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
    edges: [u64; 6],
}

impl Crossed {
    fn vertex(&self, direction: usize, cell: u32) -> u32 {
        let before = self.edges[..direction].iter().map(|edges| edges.count_ones()).sum::<u32>();
        self.first + before + (self.edges[direction] & ((1 << cell) - 1)).count_ones()
    }
}

/// A block with one voxel more on each side.
struct Surroundings<'a> {
    bricks: &'a Bricks,
    brick: &'a Brick,
    number: u32,
    /// What is in each of 3 · 3 · 3 places; the block itself in the middle.
    places: [Place; 27],
}

impl<'a> Surroundings<'a> {
    fn new(bricks: &'a Bricks, number: u32) -> Self {
        let brick = &bricks.bricks[number as usize];
        let places = std::array::from_fn(|i| match i as i32 {
            13 => Place::Same(number),
            i => {
                let offset = IVec3::new(i % 3, i / 3 % 3, i / 9) - 1;
                bricks.find(brick.corner + (offset << i32::from(brick.level + 2)), brick.level)
            }
        });
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
        match self.place(cell) {
            Place::Same(number) => Some((number, bits(cell & 3))),
            Place::Larger(number) => {
                let brick = &self.bricks.bricks[number as usize];
                let corner = self.brick.corner + (cell << i32::from(self.brick.level));
                Some((number, bits((corner - brick.corner) >> i32::from(brick.level))))
            }
            Place::Smaller | Place::Empty(_) => None,
        }
    }

    fn is_inside(&self, cell: IVec3) -> bool {
        match (self.place(cell), self.holder(cell)) {
            (_, Some((number, cell))) => self.bricks.bricks[number as usize].inside >> cell & 1 == 1,
            (place, None) => place == Place::Empty(true),
        }
    }

    /// Which edges of this block's the surface crosses.
    fn crossed(&self) -> [u64; 6] {
        let mut edges = [0u64; 6];
        for cell in 0..64 {
            let at = IVec3::new(cell & 3, cell >> 2 & 3, cell >> 4);
            for (direction, step) in STEPS.into_iter().enumerate() {
                let own = match self.place(at + step) {
                    Place::Same(_) => direction < 3,
                    Place::Larger(_) => true,
                    Place::Smaller | Place::Empty(_) => false,
                };
                let inside = self.brick.inside >> cell & 1 == 1;
                if own && inside != self.is_inside(at + step) {
                    edges[direction] |= 1 << cell;
                }
            }
        }
        edges
    }

    /// Where the surface crosses the edge from a voxel to its neighbour, and its normal there.
    fn vertex(&self, field: &Field, direction: usize, cell: u32) -> Option<(Vec3, Vec3)> {
        let at = IVec3::new(cell as i32 & 3, cell as i32 >> 2 & 3, cell as i32 >> 4);
        let (other, beyond) = self.holder(at + STEPS[direction])?;
        let other = &self.bricks.bricks[other as usize];
        let from = self.bricks.middle(self.brick, cell);
        let way = self.bricks.middle(other, beyond) - from;
        let near = self.bricks.near(self.brick);
        // The way from where the field is lower than 1 to where it is not, in parts of the edge.
        let ends = [self.brick.values[cell as usize], other.values[beyond as usize]];
        let (mut low, mut high) = (MARGIN, 1.0 - MARGIN);
        let mut t = (ends[0] / (ends[0] - ends[1])).clamp(low, high);
        let mut last = 0;
        loop {
            let point = from + way * t;
            let (value, slope) = field.gradient(near, point);
            let along = slope.dot(way);
            if value.abs() <= OFF * way.length() * slope.length() || last == 4 || high - low < OFF {
                let outward = if ends[0] > 0.0 { way } else { -way };
                return Some((point, (-slope).normalize_or(outward.normalize_or(Vec3::Y))));
            }
            if (value > 0.0) == (ends[0] > 0.0) {
                low = t
            } else {
                high = t
            }
            let newton = t - value / along;
            t = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            last += 1;
        }
    }

    /// The triangles around those of the block's voxels' corners that are its own: not a smaller block's, nor one's of
    /// its size that comes before.
    fn triangles(&self, crossed: &[Crossed], indices: &mut Vec<u32>) {
        let mut inside = [false; 216];
        for (i, inside) in inside.iter_mut().enumerate() {
            let i = i as i32;
            *inside = self.is_inside(IVec3::new(i % 6, i / 6 % 6, i / 36) - 1);
        }
        for corner in 0..125 {
            let at = IVec3::new(corner % 5, corner / 5 % 5, corner / 25);
            let cell =
                |i: u8| at - IVec3::new(i32::from(!i & 1), i32::from(!i >> 1 & 1), i32::from(!i >> 2 & 1));
            let case = (0..8).fold(0, |case, i| {
                let cell = cell(i) + 1;
                case | usize::from(inside[(cell.x + 6 * cell.y + 36 * cell.z) as usize]) << i
            });
            let theirs = |i| match self.place(cell(i)) {
                Place::Same(number) => number < self.number,
                Place::Smaller => true,
                _ => false,
            };
            if case == 0 || case == 255 || (0..8).any(theirs) {
                continue;
            }
            for triangle in &CASES[case] {
                let corners = triangle.map(|edge| {
                    let [low, high] = EDGES[edge as usize].map(|end| cell(end));
                    self.find(crossed, edge as usize / 4, low, high)
                });
                // Where one voxel is several corners of the cube, edges are one and the same.
                if let [Some(a), Some(b), Some(c)] = corners
                    && a != b
                    && b != c
                    && c != a
                {
                    indices.extend([a, b, c]);
                }
            }
        }
    }

    /// The vertex on the edge between two voxels.
    fn find(&self, crossed: &[Crossed], axis: usize, low: IVec3, high: IVec3) -> Option<u32> {
        let (first, second) = (self.holder(low)?, self.holder(high)?);
        let level = |holder: (u32, u32)| self.bricks.bricks[holder.0 as usize].level;
        let ((brick, cell), direction) =
            if level(first) <= level(second) { (first, axis) } else { (second, axis + 3) };
        Some(crossed[brick as usize].vertex(direction, cell))
    }
}

const STEPS: [IVec3; 6] = [IVec3::X, IVec3::Y, IVec3::Z, IVec3::NEG_X, IVec3::NEG_Y, IVec3::NEG_Z];

/// The surface of a field between the voxels of its blocks.
pub(super) fn march(field: &Field, bricks: &Bricks) -> Mesh {
    let count = bricks.bricks.len();
    let mut mesh = Mesh::default();
    let mut crossed = Vec::with_capacity(count);
    in_groups(
        count,
        |number, (found, vertices): &mut (Vec<[u64; 6]>, Vec<(Vec3, Vec3)>)| {
            let around = Surroundings::new(bricks, number);
            let edges = around.crossed();
            found.push(edges);
            for (direction, mut left) in edges.into_iter().enumerate() {
                while left != 0 {
                    vertices.extend(around.vertex(field, direction, left.trailing_zeros()));
                    left &= left - 1;
                }
            }
        },
        |(found, vertices)| {
            let mut first = mesh.positions.len() as u32;
            crossed.extend(found.into_iter().map(|edges| {
                let here = Crossed { first, edges };
                first += edges.iter().map(|edges| edges.count_ones()).sum::<u32>();
                here
            }));
            mesh.positions.extend(vertices.iter().map(|vertex| vertex.0));
            mesh.normals.extend(vertices.iter().map(|vertex| vertex.1));
        },
    );
    // Closed surfaces have two triangles a vertex, less four a body and plus four a handle.
    mesh.indices.reserve_exact(6 * mesh.positions.len());
    in_groups(
        count,
        |number, indices: &mut Vec<u32>| Surroundings::new(bricks, number).triangles(&crossed, indices),
        |indices| mesh.indices.extend(indices),
    );
    mesh
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
