//! Marching cubes on the octree's dual: the cubes' corners are the middles of voxels of whatever size.

use super::brick::{Brick, Bricks, Place};
use super::case::{CASES, Case, EDGES};
use super::collapse::{Patch, Vertex};
use super::crossed::{Crossed, bits};
use super::solid::Part;
use super::vertex::Crossings;
use crate::observer::{Cancelled, Watch};
use crate::parallel;
use crate::surface::{Mesh, SurfaceError};
use glam::{IVec3, Vec3};
use std::ops::Range;

/// Blocks that one thread takes at a time, and how many of these are held before they are joined.
const GROUP: usize = 64;
const HELD: usize = 256;
/// The same where vertices go: at the borders between patches they stay.
pub(super) const PATCH: usize = 2048;
const PATCHES: usize = 64;

/// Treatment of the triangles of marching cubes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Finish {
    /// Nothing.
    Plain,
    /// Their vertices get the solid's colours.
    Colored,
    /// They become longer, their sides off the surface by up to this number of voxels.
    Longer(f32),
}

/// A block with one voxel more on each side.
struct Surroundings<'a, P> {
    bricks: &'a Bricks<P>,
    brick: &'a Brick,
    /// Contents of 3 · 3 · 3 places; the block itself in the middle.
    places: [Place; 27],
    /// Bits say which of these are blocks of the same size that come before this one, or smaller, or not of the same size.
    earlier: u32,
    smaller: u32,
    unlike: u32,
}

impl<'a, P: Part> Surroundings<'a, P> {
    fn new(bricks: &'a Bricks<P>, number: u32) -> Self {
        let brick = &bricks.leaves[number as usize];
        let places = bricks.around(brick);
        let among = |is: fn(&Place, u32) -> bool| {
            (0..).zip(&places).fold(0, |bits, (i, place)| bits | u32::from(is(place, number)) << i)
        };
        let earlier = among(|place, number| matches!(place, Place::Same(other) if *other < number));
        let smaller = among(|place, _| *place == Place::Smaller);
        let unlike = among(|place, _| !matches!(place, Place::Same(_)));
        Self { bricks, brick, places, earlier, smaller, unlike }
    }

    /// Block that holds a voxel, -1 to 4 in each direction.
    fn place(&self, cell: IVec3) -> Place {
        let block: IVec3 = (cell + 4) >> 2;
        self.places[(block.x + 3 * block.y + 9 * block.z) as usize]
    }

    /// The block and the voxel that holds this one; none where there is no block of this size or larger.
    fn holder(&self, cell: IVec3) -> Option<(u32, u32)> {
        self.bricks.holder(self.brick, self.place(cell), cell)
    }

    /// The triangles around those of the block's voxels' corners that are its own: not a smaller block's, nor one's of
    /// its size that comes before.
    fn triangles(&self, cases: &[Case], crossed: &[Crossed], triangles: &mut Vec<[u32; 3]>) {
        let rows = self.rows();
        let beside_smaller = self.smaller != 0;
        for (y, z) in (0..25).map(|row| (row % 5, row / 5)) {
            let row = y + 6 * z;
            let four = [0, 1, 6, 7].map(|offset| rows[row + offset]);
            let any = four[0] | four[1] | four[2] | four[3];
            let all = four[0] & four[1] & four[2] & four[3];
            let active = (any | any >> 1) & !(all & all >> 1) & 0x1f;
            for x in bits(if beside_smaller { 0x1f } else { u64::from(active) }) {
                let touched = TOUCHED[x as usize + 5 * y + 25 * z];
                if touched & self.earlier != 0 {
                    continue;
                }
                let corners = four.into_iter().zip([0, 2, 4, 6]);
                let case = corners.fold(0, |case, (row, shift)| case | usize::from(row >> x & 3) << shift);
                if touched & self.unlike != 0 {
                    let at = IVec3::new(x as i32, y as i32, z as i32);
                    self.triangles_between_sizes(at, touched, case, cases, crossed, triangles);
                    continue;
                }
                let mut found = [0; 12];
                let first = x as usize + 6 * row;
                for edge in bits(u64::from(cases[case].crossed)) {
                    let (place, cell) = VOXELS[first + LOWER[edge as usize]];
                    if let Place::Same(number) = self.places[usize::from(place)] {
                        let axis = edge as usize / 4;
                        found[edge as usize] = crossed[number as usize].vertex(axis, u32::from(cell));
                    }
                }
                triangles.extend(cases[case].triangles.iter().map(|t| t.map(|edge| found[edge as usize])));
            }
        }
    }

    /// The triangles around one corner that touches no smaller block's voxel.
    fn triangles_between_sizes(
        &self,
        at: IVec3,
        touched: u32,
        mut case: usize,
        cases: &[Case],
        crossed: &[Crossed],
        triangles: &mut Vec<[u32; 3]>,
    ) {
        let back = |i: u8| IVec3::new(i32::from(i & 1), i32::from(i >> 1 & 1), i32::from(i >> 2)) - 1;
        let cell = |i: u8| at + back(i);
        if touched & self.smaller != 0 {
            for i in (0..8).filter(|&i| self.place(cell(i)) == Place::Smaller) {
                let at = self.brick.corner + (at << i32::from(self.brick.level)) + back(i);
                match self.bricks.find(at, 0) {
                    Place::Empty(inside) => case |= usize::from(inside) << i,
                    _ => return,
                }
            }
        }
        let mut found = [None; 12];
        for edge in bits(u64::from(cases[case].crossed)) {
            let [low, high] = EDGES[edge as usize];
            found[edge as usize] = self.find(crossed, edge as usize / 4, cell(low), cell(high));
        }
        for triangle in &cases[case].triangles {
            // If one voxel is several corners of the cube, some edges coincide.
            if let [Some(a), Some(b), Some(c)] = triangle.map(|edge| found[edge as usize])
                && a != b
                && b != c
                && c != a
            {
                triangles.push([a, b, c]);
            }
        }
    }

    /// Voxels that are inside, this block's and one more on each side: a bit each along x, rows along y, then z.
    fn rows(&self) -> [u8; 36] {
        let mut rows = [0; 36];
        for (i, place) in self.places.iter().enumerate() {
            let (x, y, z) = (i % 3, i / 3 % 3, i / 9);
            let range = |block: usize| [0..1, 1..5, 5..6][block].clone();
            let mut inside = |rows_of: &dyn Fn(usize, usize) -> u64| {
                for (z, y) in range(z).flat_map(|z| range(y).map(move |y| (z, y))) {
                    let row = rows_of(y, z) & 0xf;
                    rows[y + 6 * z] |= [row >> 3, row << 1, (row & 1) << 5][x] as u8;
                }
            };
            match *place {
                Place::Empty(false) | Place::Smaller => (),
                Place::Empty(true) => inside(&|_, _| 0xf),
                Place::Same(number) => {
                    let bits = self.bricks.leaves[number as usize].inside;
                    if bits != 0 {
                        inside(&|y, z| bits >> (4 * ((y + 3) & 3) + 16 * ((z + 3) & 3)));
                    }
                }
                Place::Larger(number) => {
                    let bits = self.bricks.leaves[number as usize].inside;
                    if bits != 0 {
                        inside(&|y, z| {
                            (0..4).fold(0, |row, i| {
                                let cell = IVec3::new(4 * x as i32 - 4 + i, y as i32 - 1, z as i32 - 1);
                                let held = self.bricks.holder(self.brick, *place, cell);
                                row | held.map_or(0, |(_, cell)| bits >> cell & 1) << i
                            })
                        });
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

/// The place and the cell there of each of 6 · 6 · 6 voxels.
const VOXELS: [(u8, u8); 216] = {
    let mut voxels = [(0, 0); 216];
    let mut i = 0;
    while i < 216 {
        let [x, y, z] = [i as u8 % 6 + 3, i as u8 / 6 % 6 + 3, i as u8 / 36 + 3];
        voxels[i] = (x / 4 + 3 * (y / 4) + 9 * (z / 4), x % 4 + 4 * (y % 4) + 16 * (z % 4));
        i += 1;
    }
    voxels
};

/// For each of 5 · 5 · 5 corners, the places, of 27, that hold the eight voxels around it.
const TOUCHED: [u32; 125] = {
    let mut touched = [0; 125];
    let mut i = 0;
    while i < 125 * 8 {
        let (corner, voxel) = (i / 8, i % 8);
        let first = corner % 5 + 6 * (corner / 5 % 5) + 36 * (corner / 25);
        touched[corner] |= 1 << VOXELS[first + (voxel & 1) + 6 * (voxel >> 1 & 1) + 36 * (voxel >> 2)].0;
        i += 1;
    }
    touched
};

/// Offset, in 6 · 6 · 6 voxels, of the lower end of each of a cube's edges from the cube's first.
const LOWER: [usize; 12] = {
    let mut lower = [0; 12];
    let mut edge = 0;
    while edge < 12 {
        let corner = EDGES[edge][0] as usize;
        lower[edge] = (corner & 1) + 6 * (corner >> 1 & 1) + 36 * (corner >> 2);
        edge += 1;
    }
    lower
};

/// The surface between the voxels of blocks.
pub(super) fn march<P: Part>(
    mut bricks: Bricks<P>,
    finish: Finish,
    watch: &Watch<'_>,
) -> Result<Mesh, SurfaceError> {
    let count = bricks.leaves.len();
    let mut crossed = parallel::map(count, |number| {
        // A block's edges are soon found beside its vertices.
        if number % 64 == 0 {
            watch.steps(1);
        }
        Crossed::new(&bricks, &bricks.leaves[number])
    });
    watch.pass(0)?;
    let vertices = crossed.iter().map(|crossed| crossed.count() as usize).sum();
    if vertices > u32::MAX as usize {
        return Err(SurfaceError::TooLarge { vertices, most: u32::MAX as usize });
    }
    let mut first = 0;
    for crossed in &mut crossed {
        crossed.start_at(first);
        first += crossed.count();
    }
    if let Finish::Longer(error) = finish {
        return Ok(longer(&bricks, &crossed, vertices, error, watch)?);
    }
    let mut mesh = Mesh::default();
    mesh.positions.reserve_exact(vertices);
    mesh.normals.reserve_exact(vertices);
    let colored = finish == Finish::Colored;
    mesh.colors.reserve_exact(if colored { vertices } else { 0 });
    in_groups(
        count,
        (GROUP, HELD),
        |blocks| {
            let mut part = Mesh::default();
            each_vertex(&bricks, &crossed, blocks, watch, |_, position, normal, solid| {
                part.positions.push(position);
                part.normals.push(normal);
                part.colors.extend(colored.then(|| solid.color(position)));
            });
            part
        },
        |part| {
            mesh.positions.extend(part.positions);
            mesh.normals.extend(part.normals);
            mesh.colors.extend(part.colors);
        },
    );
    watch.pass(0)?;
    // Memory that the triangles do not need is freed before they are made.
    bricks.parts = Vec::new();
    // Closed surfaces have two triangles per vertex, less four per body and plus four per handle, of which
    // there are few.
    mesh.indices.reserve_exact(6 * vertices + vertices / 32);
    let triangles = |blocks| triangles(&bricks, &crossed, blocks, watch);
    in_groups(count, (GROUP, HELD), triangles, |part| mesh.indices.extend(part.into_flattened()));
    watch.pass(0)?;
    Ok(mesh)
}

/// The surface with longer triangles.
fn longer<P: Part>(
    bricks: &Bricks<P>,
    crossed: &[Crossed],
    vertices: usize,
    error: f32,
    watch: &Watch<'_>,
) -> Result<Mesh, Cancelled> {
    let mut mesh = Mesh::default();
    // The vertices that are left, 64 in each word.
    let mut left = vec![0u64; vertices.div_ceil(64)];
    in_groups(
        bricks.leaves.len(),
        (PATCH, PATCHES),
        |blocks| {
            let first = crossed[blocks.start].first();
            let mut vertices = Vec::new();
            each_vertex(bricks, crossed, blocks.clone(), watch, |brick, position, normal, _| {
                vertices.push(Vertex::new(position, normal, error * bricks.step(brick.level)));
            });
            let mut triangles = triangles(bricks, crossed, blocks, watch);
            if !watch.goes_on() {
                return (Vec::new(), Vec::new());
            }
            // Vertices of other patches are those beyond all, before or after.
            triangles.as_flattened_mut().iter_mut().for_each(|vertex| *vertex = vertex.wrapping_sub(first));
            let mut patch = Patch::new(vertices, triangles);
            patch.collapse(watch);
            let (vertices, triangles) = patch.rest();
            let indices: Vec<_> = triangles.flatten().map(|vertex| vertex.wrapping_add(first)).collect();
            (vertices.map(|(number, vertex)| (first + number, vertex)).collect::<Vec<_>>(), indices)
        },
        |(vertices, indices)| {
            for (number, vertex) in vertices {
                left[number as usize / 64] |= 1 << (number % 64);
                push(&mut mesh.positions, vertex.position);
                push(&mut mesh.normals, vertex.normal);
            }
            for index in indices {
                push(&mut mesh.indices, index);
            }
        },
    );
    watch.pass(0)?;
    let mut count = 0;
    let before = left.iter().map(|word| {
        count += word.count_ones();
        count - word.count_ones()
    });
    let before: Vec<u32> = before.collect();
    let mut parts: Vec<_> = mesh.indices.chunks_mut(1 << 16).collect();
    parallel::each_mut(&mut parts, |_, indices| {
        for index in &mut **indices {
            let (word, bit) = (*index as usize / 64, *index % 64);
            *index = before[word] + (left[word] & ((1 << bit) - 1)).count_ones();
        }
    });
    mesh.positions.shrink_to_fit();
    mesh.normals.shrink_to_fit();
    mesh.indices.shrink_to_fit();
    Ok(mesh)
}

/// Adds to what may become most of the memory: room for an eighth more is enough each time.
fn push<T>(all: &mut Vec<T>, one: T) {
    if all.len() == all.capacity() {
        all.reserve_exact(all.len() / 8 + 1024);
    }
    all.push(one);
}

/// The vertices of some blocks, with their normals and what counts there.
fn each_vertex<P: Part>(
    bricks: &Bricks<P>,
    crossed: &[Crossed],
    blocks: Range<usize>,
    watch: &Watch<'_>,
    mut add: impl FnMut(&Brick, Vec3, Vec3, &P),
) {
    for number in blocks.filter(|&number| crossed[number].count() > 0) {
        if !watch.steps(1) {
            return;
        }
        let crossings = Crossings::new(bricks, number as u32);
        for (direction, cell) in crossed[number].edges() {
            let (position, normal, part) = crossings.vertex(direction, cell);
            add(&bricks.leaves[number], position, normal, part);
        }
    }
}

/// The triangles of some blocks.
fn triangles<P: Part>(
    bricks: &Bricks<P>,
    crossed: &[Crossed],
    blocks: Range<usize>,
    watch: &Watch<'_>,
) -> Vec<[u32; 3]> {
    let cases = &CASES[..];
    let mut triangles = Vec::new();
    for number in blocks {
        // Eight of them take the time of a block's vertices.
        if number % 8 == 0 && !watch.steps(1) {
            break;
        }
        Surroundings::new(bricks, number as u32).triangles(cases, crossed, &mut triangles);
    }
    triangles
}

/// Has threads make parts of `group` blocks each, and joins the parts in the blocks' order, `held` at a time,
/// while the next are made.
fn in_groups<T: Send>(
    count: usize,
    (group, held): (usize, usize),
    make: impl Fn(Range<usize>) -> T + Sync + Send,
    mut join: impl FnMut(T) + Send,
) {
    let mut made = Vec::new();
    for start in (0..count).step_by(group * held) {
        let groups = (count - start).div_ceil(group).min(held);
        let next = || {
            parallel::map(groups, |i| {
                let first = start + i * group;
                make(first..(first + group).min(count))
            })
        };
        (made, ()) = parallel::join(next, || made.into_iter().for_each(&mut join));
    }
    made.into_iter().for_each(join);
}
