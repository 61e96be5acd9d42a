//! Poisson-disc nodes on triangles, by throwing darts.

use super::super::GraphError;
use super::triangles::{NONE, Triangles};
use super::walk::Place;
use crate::observer::{Observer, Work, report};
use crate::random::{Purpose, stream};
use glam::{IVec3, Vec3};
use rand::RngExt;

/// Darts for each node that there is room for: what room is left has an area of about a hundredth of a disc.
const DARTS: f32 = 60.0;
/// Nodes lie on one side of the surface if the cosine between their normals is above this.
const ONE_SIDE: f32 = -0.5;
/// Darts between two reports.
const REPORT_EVERY: usize = 1 << 16;

/// Points by the cube that they lie in: chains in a table of hashes.
pub(super) struct Cells {
    side: f32,
    /// The latest point of each chain, and the one before each point; [`NONE`] ends it.
    heads: Vec<u32>,
    before: Vec<u32>,
    cubes: Vec<IVec3>,
}

impl Cells {
    /// Cubes of this side, for about this number of points.
    pub(super) fn new(side: f32, points: usize) -> Self {
        let heads = vec![NONE; (2 * points).next_power_of_two()];
        Self { side, heads, before: Vec::new(), cubes: Vec::new() }
    }

    fn cube(&self, point: Vec3) -> IVec3 {
        (point / self.side).floor().as_ivec3()
    }

    fn chain(&self, cube: IVec3) -> usize {
        let [x, y, z] = cube.to_array().map(|n| u64::from(n.cast_unsigned()));
        let mixed = x.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ y.wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
        let mixed = (mixed ^ z.wrapping_mul(0x1656_67b1_9e37_79f9)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (mixed >> 32) as usize & (self.heads.len() - 1)
    }

    /// Adds a point; the first is number 0, the next 1.
    pub(super) fn insert(&mut self, point: Vec3) {
        let cube = self.cube(point);
        let chain = self.chain(cube);
        self.before.push(std::mem::replace(&mut self.heads[chain], self.cubes.len() as u32));
        self.cubes.push(cube);
    }

    /// The numbers of the points in the cube of `point` and in those around it: all within a side of it, and others.
    pub(super) fn around(&self, point: Vec3) -> impl Iterator<Item = u32> {
        let middle = self.cube(point);
        AROUND.iter().flat_map(move |&step| {
            let cube = middle + step;
            let mut next = self.heads[self.chain(cube)];
            std::iter::from_fn(move || {
                while next != NONE {
                    let point = next;
                    next = self.before[point as usize];
                    if self.cubes[point as usize] == cube {
                        return Some(point);
                    }
                }
                None
            })
        })
    }
}

/// A cube and those around it, the nearest first: most that is in the way is found soon.
const AROUND: [IVec3; 27] = {
    let mut cubes = [IVec3::ZERO; 27];
    let (mut filled, mut distance) = (0, 0);
    while distance <= 3 {
        let mut i = 0;
        while i < 27 {
            let (x, y, z) = (i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
            if x * x + y * y + z * z == distance {
                cubes[filled] = IVec3::new(x, y, z);
                filled += 1;
            }
            i += 1;
        }
        distance += 1;
    }
    cubes
};

/// The point nearest to `root`, then whatever darts find room.
pub(super) fn darts(
    surface: &Triangles,
    spacing: f32,
    root: Vec3,
    seed: u64,
    observer: &dyn Observer,
) -> Result<Vec<Place>, GraphError> {
    report(observer, Work::Nodes, 0.0)?;
    let (triangle, position) = surface.nearest(root).ok_or(GraphError::Empty)?;
    let mut places = vec![Place { position, triangle }];
    let room = super::DENSITY * surface.area() / (spacing * spacing);
    let mut cells = Cells::new(spacing, room as usize + 1);
    cells.insert(position);
    let mut random = stream(seed, 0, Purpose::NODES, 0);
    let count = (DARTS * room).ceil() as usize;
    for dart in 0..count {
        if dart % REPORT_EVERY == 0 {
            report(observer, Work::Nodes, dart as f32 / count as f32)?;
        }
        let triangle = surface.by_area(random.random());
        let [a, b, c] = surface.corners(triangle);
        // Osada and others 2002, "Shape distributions", equation 1.
        let (share, across) = (random.random::<f32>().sqrt(), random.random::<f32>());
        let position = a * (1.0 - share) + b * (share * (1.0 - across)) + c * (share * across);
        let normal = surface.normal(triangle);
        let crowded = cells.around(position).any(|other| {
            let other = places[other as usize];
            other.position.distance_squared(position) < spacing * spacing
                && surface.normal(other.triangle).dot(normal) > ONE_SIDE
        });
        // Two nodes in one place, on both sides of a sheet without thickness, could not be linked.
        if !crowded && cells.around(position).all(|other| places[other as usize].position != position) {
            cells.insert(position);
            places.push(Place { position, triangle });
        }
    }
    report(observer, Work::Nodes, 1.0)?;
    Ok(places)
}
