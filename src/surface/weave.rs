//! Rings of vertices, and the triangles between them.

use super::attach::DOME_SIDES;
use super::axis::{Axes, Axis, Station};
use super::circle::{Circle, Circles};
use super::collar::{self, Curves};
use super::lanes::{LANES, Lanes};
use super::mesh::has_area;
use super::{Mesh, Tubes, Wind};
use crate::math::perpendicular;
use glam::{Vec2, Vec3, Vec4};
use std::f32::consts::{FRAC_1_SQRT_2, TAU};

/// The last component of every tangent: the texture's v runs along the branch, glTF's bitangent against v.
const HANDEDNESS: f32 = -1.0;
/// By so much do the phases of successive branches differ, so that any number of them is spread evenly.
const GOLDEN_RATIO: f64 = 0.618_033_988_749_895;
/// The least radius for which texels are kept square, as a part of the branch's first.
const THINNEST: f32 = 1.0 / 64.0;

/// All that is known before the first vertex.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) axes: Axes,
    /// At most so many vertices and triangles will be made.
    pub(super) vertices: usize,
    pub(super) triangles: usize,
}

impl Plan {
    pub(super) fn new(mut axes: Axes, options: &Tubes) -> Self {
        axes.attach(options);
        let (mut vertices, mut triangles) = (0, 0);
        for axis in &axes.all {
            let sides = axis.sides as usize;
            let blended = if axis.has_collar { blends(axis.sides) as usize + 1 } else { 0 };
            let rings = blended + axis.stations.len() + usize::from(axis.sides >= DOME_SIDES);
            vertices += rings * (sides + 1) + 1;
            triangles += (rings - 1) * 2 * sides + sides;
            if options.closed_base {
                vertices += sides + 2;
                triangles += sides;
            }
        }
        Self { axes, vertices, triangles }
    }

    pub(super) fn weave(&self, options: &Tubes) -> Mesh {
        self.weave_each(options, |_, _| {})
    }

    /// Calls `woven` after each axis with that axis and the mesh up to there.
    pub(super) fn weave_each(&self, options: &Tubes, mut woven: impl FnMut(&Axis, &Mesh)) -> Mesh {
        let mut mesh = Mesh::default();
        // Rings are made in fours.
        let vertices = self.vertices + LANES;
        mesh.positions.reserve(vertices);
        mesh.normals.reserve(vertices);
        mesh.tangents.reserve(vertices);
        mesh.uvs.reserve(vertices);
        if options.wind {
            mesh.wind.reserve(self.vertices);
        }
        mesh.indices.reserve(self.triangles * 3);
        let circles = Circles::new(self.axes.all.iter().map(|axis| axis.sides));
        let none = Circle::default();
        let mut weaver = Weaver {
            options,
            mesh,
            circle: &none,
            tiles: 1.0,
            step: 1.0,
            line: &[],
            course: Vec::new(),
            curves: Vec::new(),
            round: Round::default(),
            wind: None,
            foot: self.axes.all.first().map_or(1.0, |trunk| trunk.base.radius),
        };
        for axis in &self.axes.all {
            weaver.line = &self.axes.stations[axis.stations.clone()];
            weaver.circle = circles.of(axis.sides);
            let first = axis.base;
            weaver.tiles = (TAU * first.radius.max(weaver.line[0].radius) / options.tile).round().max(1.0);
            weaver.step = weaver.tiles / axis.sides as f32;
            weaver.run();
            collar::curves(&self.axes, &circles, axis, &mut weaver.curves);
            weaver.wind = options.wind.then_some(Wind {
                pivot: first.position,
                level: f32::from(axis.order),
                phase: (axis.branch as f64 * GOLDEN_RATIO).fract() as f32,
                stiffness: 1.0,
            });
            weaver.weave();
            woven(axis, &weaver.mesh);
        }
        weaver.mesh
    }
}

/// Rings of a collar between its foot and its end.
fn blends(sides: u32) -> u32 {
    (sides / 3).clamp(1, 4)
}

/// A ring in the mesh, or the single vertex it has shrunk to.
#[derive(Debug, Clone, Copy)]
enum Ring {
    Circle(u32),
    Point(u32),
}

/// The points of a ring with the last before the first and the first after the last, their coordinates apart.
#[derive(Debug, Default)]
struct Round([Vec<f32>; 3]);

impl Round {
    fn fill(&mut self, points: impl Iterator<Item = Lanes>, sides: usize) {
        for column in &mut self.0 {
            column.clear();
            // Where the last point comes.
            column.push(0.0);
        }
        let [x, y, z] = &mut self.0;
        for points in points {
            x.extend_from_slice(&points.x.to_array());
            y.extend_from_slice(&points.y.to_array());
            z.extend_from_slice(&points.z.to_array());
        }
        for column in &mut self.0 {
            column[0] = column[sides];
            column.push(0.0);
            column[sides + 1] = column[1];
        }
    }

    /// The points before some four neighbours, these, and those after them.
    fn around(&self, first: usize) -> [Lanes; 3] {
        [0, 1, 2].map(|offset| {
            let [x, y, z] = self.0.each_ref().map(|column| Vec4::from_slice(&column[first + offset..]));
            Lanes { x, y, z }
        })
    }
}

/// Weaves one axis after another.
struct Weaver<'a> {
    options: &'a Tubes,
    mesh: Mesh,
    circle: &'a Circle,
    /// Textures around a ring.
    tiles: f32,
    /// That over the sides.
    step: f32,
    /// The level rings of the present axis.
    line: &'a [Station],
    /// The texture coordinate v of each of them.
    course: Vec<f32>,
    /// Its collar; none if there is none.
    curves: Vec<Curves>,
    /// The points of one ring of it.
    round: Round,
    /// The weights of its vertices, if they are wanted.
    wind: Option<Wind>,
    /// The radius that is stiffest, metres.
    foot: f32,
}

impl Weaver<'_> {
    fn sides(&self) -> u32 {
        self.circle.corners.len() as u32 - 1
    }

    fn weave(&mut self) {
        let mut before = None;
        if !self.curves.is_empty() {
            let blends = blends(self.sides());
            for blend in 0..=blends {
                let ring = self.collar(blend as f32 / (blends + 1) as f32);
                self.go_on(&mut before, ring, self.line[0].radius);
            }
        }
        for i in 0..self.line.len() {
            let ring = self.level(i);
            self.go_on(&mut before, ring, self.line[i].radius);
        }
        if let Some(ring @ Ring::Circle(_)) = before {
            self.tip(ring);
        }
    }

    /// Works out how v runs along the axis.
    fn run(&mut self) {
        let mut v = self.line[0].along / self.options.tile;
        self.course.clear();
        for (i, station) in self.line.iter().enumerate() {
            if let Some(before) = i.checked_sub(1).map(|i| self.line[i]) {
                let way = station.along - before.along;
                v = if self.options.square_tiles {
                    v + way * self.pace(0.5 * (before.radius + station.radius))
                } else {
                    station.along / self.options.tile
                };
            }
            self.course.push(v);
        }
    }

    /// How much v grows a metre where the axis is so thick.
    fn pace(&self, radius: f32) -> f32 {
        if !self.options.square_tiles {
            return 1.0 / self.options.tile;
        }
        // A tip of no thickness has texels as small as those of the thinnest wood that can be told from it.
        let least = self.line[0].radius.max(self.options.tile / TAU) * THINNEST;
        self.tiles / (TAU * radius.max(least))
    }

    fn go_on(&mut self, before: &mut Option<Ring>, ring: Ring, radius: f32) {
        match *before {
            None => self.base(ring),
            Some(before) => self.join(before, ring),
        }
        *before = Some(ring);
        self.blow(radius);
    }

    fn level(&mut self, i: usize) -> Ring {
        let station = self.line[i];
        if station.radius == 0.0 {
            let outward = if i == 0 { -station.tangent } else { station.tangent };
            return self.point(station.position, outward, station.normal, self.course[i]);
        }
        // The normal of a cone leans against its taper; the same for the whole ring.
        let taper = station.taper;
        let lean = 1.0 / (1.0 + taper * taper).sqrt();
        self.ring(&station, self.course[i], lean, -taper * lean)
    }

    /// A level ring whose normals have this part away from the axis and this part along it.
    fn ring(&mut self, station: &Station, v: f32, outward: f32, along: f32) -> Ring {
        let Station { position, radius, tangent, normal, .. } = *station;
        let v = Vec4::splat(v);
        let axial = Lanes::splat(tangent * along);
        let [position, normal, binormal] = [position, normal, tangent.cross(normal)].map(Lanes::splat);
        let first = self.mesh.positions.len();
        for &[cos, sin] in &self.circle.fours {
            let radial = normal * cos + binormal * sin;
            let outer = position + radial * Vec4::splat(radius);
            let outward = radial * Vec4::splat(outward) + axial;
            self.four(first, outer, outward, binormal * cos - normal * sin, v);
        }
        self.close(first)
    }

    /// The ring at the part `t` of the collar's curves.
    fn collar(&mut self, t: f32) -> Ring {
        let sides = self.sides() as usize;
        // Where the collar comes out of the bearer's facets is not seen as long as it still has the bearer's normals.
        let share = t * t;
        self.round.fill(self.curves.iter().map(|curves| curves.point(t)), sides);
        let first = self.mesh.positions.len();
        for i in 0..self.curves.len() {
            let curves = &self.curves[i];
            let [before, here, after] = self.round.around(i * LANES);
            let around = after - before;
            let bearing = curves.normal(t);
            let curved = around.cross(curves.direction(t)).normalize_or(|| bearing);
            let normal =
                bearing.lerp(curved, share).normalize_or(|| curved.normalize_or(|| Lanes::splat(Vec3::Y)));
            let across = (around - normal * around.dot(normal))
                .normalize_or(|| Lanes::of(normal.to_array().map(perpendicular)));
            let rest = curves.rim() - here;
            let rest = rest.dot(rest).sqrt();
            let v = if self.options.square_tiles {
                Vec4::splat(self.course[0]) - rest * Vec4::splat(self.pace(self.line[0].radius))
            } else {
                (Vec4::splat(self.line[0].along) - rest) / Vec4::splat(self.options.tile)
            };
            self.four(first, here, normal, across, v);
        }
        self.close(first)
    }

    /// Adds the next four vertices to the ring that begins with the vertex `first`.
    #[inline]
    fn four(&mut self, first: usize, positions: Lanes, normals: Lanes, tangents: Lanes, v: Vec4) {
        let (step, mesh) = (self.step, &mut self.mesh);
        let corner = mesh.positions.len() - first;
        mesh.positions.extend_from_slice(&positions.to_array());
        mesh.normals.extend_from_slice(&normals.to_array());
        mesh.tangents.extend_from_slice(&tangents.to_array().map(|tangent| tangent.extend(HANDEDNESS)));
        let uv = |lane| Vec2::new((corner + lane) as f32 * step, v[lane]);
        mesh.uvs.extend_from_slice(&[uv(0), uv(1), uv(2), uv(3)]);
    }

    /// Ends the ring that begins with the vertex `first`: what filled up its last four goes, and the first corner comes
    /// a second time.
    fn close(&mut self, first: usize) -> Ring {
        let sides = self.sides() as usize;
        let Mesh { positions, normals, tangents, uvs, .. } = &mut self.mesh;
        positions.truncate(first + sides);
        normals.truncate(first + sides);
        tangents.truncate(first + sides);
        uvs.truncate(first + sides);
        positions.push(positions[first]);
        normals.push(normals[first]);
        tangents.push(tangents[first]);
        uvs.push(Vec2::new(sides as f32 * self.step, uvs[first].y));
        Ring::Circle(first as u32)
    }

    fn point(&mut self, position: Vec3, normal: Vec3, tangent: Vec3, v: f32) -> Ring {
        let uv = Vec2::new(0.5 * self.tiles, v);
        Ring::Point(self.vertex(position, normal, tangent.extend(HANDEDNESS), uv))
    }

    fn vertex(&mut self, position: Vec3, normal: Vec3, tangent: Vec4, uv: Vec2) -> u32 {
        let index = self.mesh.positions.len() as u32;
        self.mesh.positions.push(position);
        self.mesh.normals.push(normal);
        self.mesh.tangents.push(tangent);
        self.mesh.uvs.push(uv);
        index
    }

    /// The round cap of a tube that ends with a circle.
    fn tip(&mut self, mut ring: Ring) {
        let last = self.line[self.line.len() - 1];
        let height = |part: f32| last.radius * part;
        if self.sides() >= DOME_SIDES {
            let middle = Station {
                position: last.position + last.tangent * height(FRAC_1_SQRT_2),
                radius: height(FRAC_1_SQRT_2),
                along: last.along + height(FRAC_1_SQRT_2),
                ..last
            };
            let v = self.beyond(&last, height(FRAC_1_SQRT_2));
            let dome = self.ring(&middle, v, FRAC_1_SQRT_2, FRAC_1_SQRT_2);
            self.join(ring, dome);
            ring = dome;
        }
        let apex = last.position + last.tangent * last.radius;
        let v = self.beyond(&last, last.radius);
        let apex = self.point(apex, last.tangent, last.normal, v);
        self.join(ring, apex);
        self.blow(last.radius);
    }

    /// The texture coordinate v so far beyond the last ring, metres.
    fn beyond(&self, last: &Station, way: f32) -> f32 {
        if self.options.square_tiles {
            self.course[self.course.len() - 1] + way * self.pace(last.radius)
        } else {
            (last.along + way) / self.options.tile
        }
    }

    /// The flat cap of a tube that starts with a circle; its vertices are its own, for the edge is sharp.
    fn base(&mut self, ring: Ring) {
        let (true, Ring::Circle(first)) = (self.options.closed_base, ring) else { return };
        let first = first as usize;
        let Station { tangent, normal, .. } = self.line[0];
        let binormal = tangent.cross(normal);
        let rim = &self.mesh.positions[first..];
        let middle = rim[1..].iter().sum::<Vec3>() / self.sides() as f32;
        let center = self.mesh.positions.len() as u32;
        for i in 0..=self.circle.corners.len() {
            let position = if i == 0 { middle } else { self.mesh.positions[first + i - 1] };
            let offset = (position - middle) / self.options.tile;
            let uv = Vec2::new(offset.dot(normal), offset.dot(binormal));
            self.vertex(position, -tangent, normal.extend(-HANDEDNESS), uv);
        }
        for k in center + 1..=center + self.sides() {
            self.triangle(center, k + 1, k);
        }
    }

    fn join(&mut self, from: Ring, to: Ring) {
        let sides = self.sides();
        match (from, to) {
            (Ring::Circle(a), Ring::Circle(b)) => {
                let Mesh { positions, indices, .. } = &mut self.mesh;
                let ring = |first: u32| &positions[first as usize..][..=sides as usize];
                let quads = ring(a).windows(2).zip(ring(b).windows(2));
                for (k, (below, above)) in (0..sides).zip(quads) {
                    let triangles = [[a + k, a + k + 1, b + k + 1], [a + k, b + k + 1, b + k]];
                    let first = has_area([below[0], below[1], above[1]]);
                    let second = has_area([below[0], above[1], above[0]]);
                    // Rounding leaves a triangle without area where its edges coincide, and then no gap.
                    match [first, second] {
                        [true, true] => indices.extend_from_slice(triangles.as_flattened()),
                        [true, false] => indices.extend_from_slice(&triangles[0]),
                        [false, true] => indices.extend_from_slice(&triangles[1]),
                        [false, false] => {}
                    }
                }
            }
            (Ring::Circle(a), Ring::Point(b)) => (0..sides).for_each(|k| self.triangle(a + k, a + k + 1, b)),
            (Ring::Point(a), Ring::Circle(b)) => {
                (0..sides).for_each(|k| self.triangle(a, b + k + 1, b + k));
            }
            (Ring::Point(_), Ring::Point(_)) => {}
        }
    }

    /// A triangle, unless rounding has left it without area; then its edges coincide and no gap is left.
    #[inline]
    fn triangle(&mut self, a: u32, b: u32, c: u32) {
        if has_area([a, b, c].map(|index| self.mesh.positions[index as usize])) {
            self.mesh.indices.extend_from_slice(&[a, b, c]);
        }
    }

    /// Gives the vertices of the latest ring their weights.
    fn blow(&mut self, radius: f32) {
        if let Some(wind) = self.wind {
            let stiffness = (radius / self.foot).min(1.0);
            self.mesh.wind.resize(self.mesh.positions.len(), Wind { stiffness, ..wind });
        }
    }
}
