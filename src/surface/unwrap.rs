//! Texture coordinates for meshes that have none: along branches and around them.

use super::internodes::Internodes;
use super::{Mesh, SurfaceError};
use crate::math::{UP, atan2, parallel_transport, perpendicular};
use crate::{ParameterError, Skeleton, parallel};
use glam::{DVec2, Vec2, Vec3, Vec4};
use std::f32::consts::{PI, TAU};

/// As [`Tubes`](super::Tubes) have it.
const HANDEDNESS: f32 = -1.0;
/// Factor by which a branch gets thinner along one section; the next section begins at the next fork.
const THINNER: f32 = 1.6;
/// A triangle that faces along its branch by more than this cosine gets no coordinates around the branch.
const END: f32 = 0.75;
/// Nor does one that comes nearer to the axis than this, or goes farther off it, in radii.
const NEAREST: f32 = 0.45;
const FARTHEST: f32 = 2.0;
/// Nor does one whose tile is stretched by more than the first, or whose number of texels is off by a factor
/// of more than the second.
const MOST_STRETCHED: f64 = 4.0;
const UNEVEN: f64 = 9.0;
/// The least radius, in the thickest.
const THINNEST: f32 = 1e-3;
/// Vertices of one task.
const CHUNK: usize = 4096;
/// No vertex.
const NONE: u32 = u32::MAX;

/// Gives a mesh around a skeleton texture coordinates and tangents, so that what [`Implicit`](super::Implicit),
/// [`Polygonizer`](super::Polygonizer) or a [`Skin`](super::blob::Skin) has made can wear bark.
///
/// u runs around the branch next to each triangle, v along it, in tiles: a whole number of them around, as
/// wide as [`with_tile`](Self::with_tile) says but for the rounding, and as long as wide everywhere. A branch
/// that tapers has several sections, each with its own number, which change at forks; so nine tenths of the
/// surface have 0.75 to 1.75 times as many tiles per metre as is asked for, down to wood one tile around,
/// whose tile shrinks with it. No triangle stretches its tile by more than a factor of four. Triangles that
/// would, that face along their branch (tips, axils) or are far off it (broad fillets) wear the tile as seen
/// from the nearest of the six directions, up, down and sideways.
///
/// Vertices are doubled where coordinates are not continuous, so that no triangle spans a jump: along one
/// line of each branch, around the base of each branch, and between sections. The line along a branch is not
/// a visible seam, since the number of tiles around is whole; the others are visible, as with tubes.
/// Positions stay, and so do triangles and their order; the mesh stays closed by its positions, but no longer
/// by its indices.
///
/// O(vertices · log nodes); 24 bytes more per vertex, and about 5% more vertices.
///
/// ```
/// use treesynth::surface::{Implicit, Unwrap};
/// use treesynth::{Skeleton, glam::Vec3};
///
/// let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)])?.with_radii(vec![0.1, 0.1])?;
/// let mut mesh = Implicit::default().with_detail(4.0).mesh(&pole)?;
/// Unwrap::default().wrap(&mut mesh, &pole)?;
/// assert_eq!(mesh.uvs.len(), mesh.positions.len());
/// mesh.check()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct Unwrap {
    tile: f32,
    least: f32,
}

impl Default for Unwrap {
    /// Tiles of 0.25 m.
    fn default() -> Self {
        Self { tile: 0.25, least: 0.0 }
    }
}

impl Unwrap {
    /// The side of a tile, metres, 1e-4 to 1e4; default 0.25.
    pub fn with_tile(mut self, side: f32) -> Self {
        self.tile = side;
        self
    }

    /// The radius that wood has at the least in the mesh, metres, though the skeleton's is less, 0 to 1e4: a
    /// [voxel](super::Implicit::with_voxel) times the detail; default 0.
    pub fn with_least_radius(mut self, radius: f32) -> Self {
        self.least = radius;
        self
    }

    /// Gives the mesh texture coordinates and tangents in place of what it had. A skeleton that is only a root gives those seen from
    /// six directions. With the feature `parallel`, on rayon's threads.
    ///
    /// # Errors
    /// An option out of its range; arrays that do not fit together; radii that are all zero; more vertices than 32-bit indices can
    /// name.
    pub fn wrap(&self, mesh: &mut Mesh, skeleton: &Skeleton) -> Result<(), SurfaceError> {
        ParameterError::unless((1e-4..=1e4).contains(&self.tile), "Unwrap.tile", self.tile, "1e-4 to 1e4 m")?;
        let holds = (0.0..=1e4).contains(&self.least);
        ParameterError::unless(holds, "Unwrap.least_radius", self.least, "0 to 1e4 m")?;
        if let Err(error) = mesh.check_arrays() {
            return Err(ParameterError::new("Unwrap.mesh", error, "a sound mesh".to_owned()).into());
        }
        let course = Course::of(skeleton, self)?;
        let parents: Vec<u32> =
            (0..skeleton.len()).map(|node| skeleton.parent(node).unwrap_or(0) as u32).collect();
        let internodes = Internodes::new(skeleton.positions(), &parents, skeleton.radii());
        let chunks: Vec<&[Vec3]> = mesh.positions.chunks(CHUNK).collect();
        let nearest = |position: &Vec3| internodes.nearest(*position);
        let nodes =
            parallel::map(chunks.len(), |i| chunks[i].iter().map(nearest).collect::<Vec<_>>()).concat();
        let count = mesh.triangles().len();
        let indices = &mesh.indices;
        let parts = parallel::map(count.div_ceil(CHUNK), |i| {
            let triangles = indices[3 * i * CHUNK..(3 * (i + 1) * CHUNK).min(indices.len())].chunks_exact(3);
            let of = |corners: &[u32]| course.triangle(mesh, &nodes, [corners[0], corners[1], corners[2]]);
            triangles.map(of).collect::<Vec<_>>()
        });
        let mut copies = Copies::new(mesh.positions.len());
        let mut indices = Vec::with_capacity(mesh.indices.len());
        for (corners, worn) in mesh.triangles().zip(parts.iter().flatten()) {
            for (corner, &(uv, tangent)) in corners.into_iter().zip(worn) {
                indices.push(copies.of(corner, uv, tangent));
            }
        }
        if copies.vertices.len() >= NONE as usize {
            let (vertices, most) = (copies.vertices.len(), u32::MAX as usize);
            return Err(SurfaceError::TooLarge { vertices, most });
        }
        let (tangents, uvs) = (copies.tangents, copies.uvs);
        *mesh = Mesh { tangents, uvs, indices, ..mesh.gathered(&copies.vertices) };
        Ok(())
    }
}

/// New vertices: for each old one those that differ in texture coordinates or tangents.
struct Copies {
    /// The latest of each old vertex, and the one before each.
    latest: Vec<u32>,
    before: Vec<u32>,
    vertices: Vec<u32>,
    uvs: Vec<Vec2>,
    tangents: Vec<Vec4>,
}

impl Copies {
    fn new(count: usize) -> Self {
        Self {
            latest: vec![NONE; count],
            before: Vec::new(),
            vertices: Vec::new(),
            uvs: Vec::new(),
            tangents: Vec::new(),
        }
    }

    fn of(&mut self, vertex: u32, uv: Vec2, tangent: Vec4) -> u32 {
        let mut at = self.latest[vertex as usize];
        while at != NONE {
            if self.uvs[at as usize] == uv && self.tangents[at as usize].w.to_bits() == tangent.w.to_bits() {
                return at;
            }
            at = self.before[at as usize];
        }
        self.before.push(self.latest[vertex as usize]);
        self.latest[vertex as usize] = self.vertices.len() as u32;
        self.vertices.push(vertex);
        self.uvs.push(uv);
        self.tangents.push(tangent);
        self.vertices.len() as u32 - 1
    }
}

/// A place on a branch.
#[derive(Debug, Clone, Copy)]
struct Spot {
    /// Around it, radians, -π to π.
    angle: f32,
    /// Place along it, in radians of its own circumference.
    along: f32,
    /// Off the axis, in radii.
    off: f32,
    /// The direction around it, and the one along it.
    around: Vec3,
    tangent: Vec3,
}

/// The branches of a skeleton, in a form in which points can be placed on them.
#[derive(Debug)]
struct Course {
    nodes: Vec<Knot>,
    /// The branch of each node's internode, and where it is in `nodes`.
    branches: Vec<u32>,
    places: Vec<u32>,
    /// The start in `nodes` of each branch's nodes, and the end of the last's.
    starts: Vec<u32>,
    tile: f32,
}

#[derive(Debug, Clone, Copy)]
struct Knot {
    position: Vec3,
    tangent: Vec3,
    normal: Vec3,
    radius: f32,
    /// Radians of circumference from the branch's base.
    along: f32,
    /// Tiles around the section that the internode before is in.
    tiles: f32,
}

impl Course {
    fn of(skeleton: &Skeleton, options: &Unwrap) -> Result<Self, SurfaceError> {
        let thickest = super::axis::thickest(skeleton)?;
        let least = options.least.max(thickest * THINNEST);
        let mut children = vec![0u32; skeleton.len()];
        skeleton.edges().for_each(|(_, parent)| children[parent] += 1);
        let mut course = Self {
            nodes: Vec::with_capacity(skeleton.len() * 2),
            branches: vec![0; skeleton.len()],
            places: vec![0; skeleton.len()],
            starts: vec![0],
            tile: options.tile,
        };
        let position = |node: u32| skeleton.positions()[node as usize];
        for (number, branch) in skeleton.branches().iter().enumerate() {
            let nodes = branch.nodes();
            let radius = |i: usize| {
                // A lateral begins with its own radius.
                let node = if i == 0 && number > 0 && nodes.len() > 1 { nodes[1] } else { nodes[i] };
                skeleton.radii()[node as usize].max(least)
            };
            let way = |i: usize| (position(nodes[i]) - position(nodes[i - 1])).try_normalize();
            let first = course.nodes.len();
            let (mut along, mut normal, mut last) = (0.0, Vec3::ZERO, UP);
            let mut sections = vec![0; nodes.len()];
            let mut begun = 0;
            for i in 0..nodes.len() {
                let before = (i > 0).then(|| way(i)).flatten();
                let after = (i + 1 < nodes.len()).then(|| way(i + 1)).flatten();
                let tangent = match (before, after) {
                    (Some(before), Some(after)) => (before + after).normalize_or(before),
                    (Some(one), None) | (None, Some(one)) => one,
                    (None, None) => last,
                };
                normal =
                    if i == 0 { perpendicular(tangent) } else { parallel_transport(last, tangent, normal) };
                last = tangent;
                if i > 0 {
                    let length = position(nodes[i]).distance(position(nodes[i - 1]));
                    along += length / (0.5 * (radius(i) + radius(i - 1)));
                    course.branches[nodes[i] as usize] = number as u32;
                    course.places[nodes[i] as usize] = course.nodes.len() as u32;
                }
                sections[i] = begun;
                if children[nodes[i] as usize] > 1 && radius(i) * THINNER < radius(begun) {
                    begun = i;
                }
                let knot = Knot {
                    position: position(nodes[i]),
                    tangent,
                    normal,
                    radius: radius(i),
                    along,
                    tiles: 1.0,
                };
                course.nodes.push(knot);
            }
            // Each section has the tiles of its mean radius.
            // Up to each node the wood's half surface, and that times its radius: a section's mean radius is that of its surface.
            let mut sums = vec![[0.0f64; 2]; nodes.len()];
            for i in 1..nodes.len() {
                let length = f64::from(position(nodes[i]).distance(position(nodes[i - 1])));
                let mean = 0.5 * f64::from(radius(i) + radius(i - 1));
                sums[i] = [sums[i - 1][0] + mean * length, sums[i - 1][1] + mean * mean * length];
            }
            let mut end = nodes.len() - 1;
            for i in (0..nodes.len()).rev() {
                if sections[i] != sections[end] {
                    end = i;
                }
                let [surface, times] = [0, 1].map(|k| sums[end][k] - sums[sections[i]][k]);
                let mean = if surface > 0.0 { (times / surface) as f32 } else { radius(end) };
                course.nodes[first + i].tiles = (TAU * mean / options.tile).round().max(1.0);
            }
            course.starts.push(course.nodes.len() as u32);
        }
        Ok(course)
    }

    /// Texture coordinates and tangents at a triangle's corners.
    fn triangle(&self, mesh: &Mesh, nodes: &[u32], corners: [u32; 3]) -> [(Vec2, Vec4); 3] {
        let points = corners.map(|corner| mesh.positions[corner as usize]);
        let normals = corners.map(|corner| mesh.normals[corner as usize]);
        let own = corners.map(|corner| nodes[corner as usize]);
        let section = |node: u32| {
            let place = self.places[node as usize] as usize;
            (self.branches[node as usize], self.nodes[place].tiles.to_bits())
        };
        // The branch, and the section of it, that two corners agree about; or that of the first.
        let mut chosen = own[0];
        if section(own[1]) == section(own[2]) {
            chosen = own[1];
        }
        let (branch, knot) =
            (self.branches[chosen as usize], self.nodes[self.places[chosen as usize] as usize]);
        let facing = (points[1] - points[0]).cross(points[2] - points[0]).normalize_or(normals[0]);
        let spots: [Option<Spot>; 3] = std::array::from_fn(|i| {
            let hint = if self.branches[own[i] as usize] == branch { own[i] } else { chosen };
            self.spot(branch, self.places[hint as usize] as usize, points[i])
        });
        let [Some(a), Some(b), Some(c)] = spots else {
            return self.seen_from_aside(&knot, facing, points, normals);
        };
        let spots = [a, b, c];
        let is_around =
            |spot: &Spot| facing.dot(spot.tangent).abs() < END && spot.off > NEAREST && spot.off < FARTHEST;
        let mut angles = spots.map(|spot| spot.angle);
        let (low, high) =
            (angles.iter().copied().fold(PI, f32::min), angles.iter().copied().fold(-PI, f32::max));
        if high - low > PI {
            angles.iter_mut().filter(|angle| **angle < 0.0).for_each(|angle| *angle += TAU);
        }
        let spread =
            angles.iter().copied().fold(f32::MIN, f32::max) - angles.iter().copied().fold(f32::MAX, f32::min);
        if !spots.iter().all(is_around) || spread > 0.75 * PI {
            return self.seen_from_aside(&knot, facing, points, normals);
        }
        let scale = knot.tiles / TAU;
        let uvs = std::array::from_fn(|i| Vec2::new(angles[i], spots[i].along) * scale);
        // At sharp bends of an axis, places along it may be far apart or out of order.
        let wanted = f64::from(scale / knot.radius);
        let is_even = densities(points, uvs).is_none_or(|[most, least]| {
            most < MOST_STRETCHED * least
                && most * least < UNEVEN * wanted * wanted
                && most * least * UNEVEN > wanted * wanted
        });
        if !is_even {
            return self.seen_from_aside(&knot, facing, points, normals);
        }
        std::array::from_fn(|i| (uvs[i], across(spots[i].around, normals[i]).extend(HANDEDNESS)))
    }

    /// The tile as seen from the direction that a triangle faces most.
    fn seen_from_aside(
        &self,
        knot: &Knot,
        facing: Vec3,
        points: [Vec3; 3],
        normals: [Vec3; 3],
    ) -> [(Vec2, Vec4); 3] {
        let size = facing.abs();
        let [right, up] = if size.y >= size.x.max(size.z) {
            [Vec3::X, Vec3::Z]
        } else if size.x >= size.z {
            [Vec3::Z, Vec3::Y]
        } else {
            [Vec3::X, Vec3::Y]
        };
        // Texels are as large as on the branch there, but by steps, so that neighbours agree.
        let circumference = TAU * knot.radius;
        let mut scale = 1.0 / self.tile;
        while scale * circumference < 0.75 {
            scale *= 2.0;
        }
        std::array::from_fn(|i| {
            let tangent = across(right, normals[i]);
            // As in glTF: normal times tangent times the sign is against v.
            let sign = if facing.cross(right).dot(up) > 0.0 { -1.0 } else { 1.0 };
            (Vec2::new(points[i].dot(right), points[i].dot(up)) * scale, tangent.extend(sign))
        })
    }

    /// The place of a point on a branch, searched from the internode before the knot `hint` on; nothing for a
    /// point on the axis.
    fn spot(&self, branch: u32, hint: usize, point: Vec3) -> Option<Spot> {
        let (first, end) = (self.starts[branch as usize] as usize, self.starts[branch as usize + 1] as usize);
        if end - first < 2 {
            return None;
        }
        let mut at = hint.clamp(first + 1, end - 1);
        // Past the plane at a knot the next internode begins.
        let beyond = |knot: usize| (point - self.nodes[knot].position).dot(self.nodes[knot].tangent);
        let from = at;
        while at + 1 < end && at < from + 8 && beyond(at) > 0.0 {
            at += 1;
        }
        if at == from {
            while at > first + 1 && at + 8 > from && beyond(at - 1) < 0.0 {
                at -= 1;
            }
        }
        let (low, high) = (&self.nodes[at - 1], &self.nodes[at]);
        let (below, above) = (beyond(at - 1), -beyond(at));
        let total = below + above;
        // Beyond a branch's ends it goes on straight.
        let part = if total > 1e-12 { below / total } else { 0.5 };
        let inside = part.clamp(0.0, 1.0);
        let center = low.position.lerp(high.position, part);
        let tangent = low.tangent.lerp(high.tangent, inside).normalize_or(low.tangent);
        let normal = low.normal.lerp(high.normal, inside);
        let normal = (normal - tangent * normal.dot(tangent)).try_normalize()?;
        let binormal = tangent.cross(normal);
        let out = point - center;
        let (x, y) = (out.dot(normal), out.dot(binormal));
        let distance = (x * x + y * y).sqrt();
        let radius = low.radius + (high.radius - low.radius) * inside;
        if distance <= 0.0 {
            return None;
        }
        let around = (binormal * x - normal * y) / distance;
        let along = low.along + (high.along - low.along) * part;
        Some(Spot { angle: atan2(y, x), along, off: distance / radius, around, tangent })
    }
}

/// Tiles per metre in the directions in which a triangle has most and least of them; nothing for one that is
/// hardly wide.
fn densities(points: [Vec3; 3], uvs: [Vec2; 3]) -> Option<[f64; 2]> {
    let [a, b, c] = points.map(Vec3::as_dvec3);
    let [p, q, r] = uvs.map(Vec2::as_dvec2);
    let (along, beside) = (b - a, c - a);
    let width = along.length();
    let x = along / width;
    let to = DVec2::new(beside.dot(x), (beside - x * beside.dot(x)).length());
    if !(to.y > 1e-3 * width && width > 1e-3 * to.length()) {
        return None;
    }
    // The columns of the map from the plane to the tile, and its singular values.
    let first = (q - p) / width;
    let second = ((r - p) - first * to.x) / to.y;
    let (e, f, g) = (first.length_squared(), first.dot(second), second.length_squared());
    let (middle, half) = (0.5 * (e + g), (0.25 * (e - g) * (e - g) + f * f).sqrt());
    Some([(middle + half).sqrt(), (middle - half).max(0.0).sqrt()])
}

/// The unit vector across a normal that is nearest to a direction.
fn across(direction: Vec3, normal: Vec3) -> Vec3 {
    (direction - normal * direction.dot(normal)).try_normalize().unwrap_or_else(|| perpendicular(normal))
}

#[cfg(test)]
mod tests;
