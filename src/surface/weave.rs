//! Rings of vertices, and the triangles between them.

use super::attach::DOME_SIDES;
use super::axis::{Axis, Station};
use super::circle::{Circle, Circles};
use super::collar::{self, Curves};
use super::lanes::{LANES, Lanes};
use super::mesh::has_area;
use super::plan::{MOST_SECTIONS, Plan, blends};
use super::sway::Bend;
use super::swung::Swung;
use super::{Mesh, Sway, Tubes, Wind};
use crate::math::perpendicular;
use crate::observer::{Cancelled, Watch};
use glam::{Vec2, Vec3, Vec4};
use std::f32::consts::{FRAC_1_SQRT_2, TAU};

/// The last component of every tangent: the texture's v runs along the branch, glTF's bitangent against v.
const HANDEDNESS: f32 = -1.0;
/// The least radius for which texels are kept square, as a part of the branch's first.
const THINNEST: f32 = 1.0 / 64.0;
/// Factor by which a branch is thinner than at the start of its present section when the next one
/// begins, at the next fork.
const THINNER: f32 = 1.6;

impl Plan {
    /// The mesh, a step for 16 vertices of a ring.
    pub(super) fn weave_watched(&self, options: &Tubes, watch: &Watch<'_>) -> Result<Mesh, Cancelled> {
        let mesh = self.weave_all(options, watch, |_, _| {});
        watch.pass(0)?;
        Ok(mesh)
    }

    /// Calls `woven` after each axis with that axis and the mesh up to there.
    #[cfg(test)]
    pub(super) fn weave_each(&self, options: &Tubes, woven: impl FnMut(&Axis, &Mesh)) -> Mesh {
        self.weave_all(options, &Watch::silent(), woven)
    }

    fn weave_all(&self, options: &Tubes, watch: &Watch<'_>, mut woven: impl FnMut(&Axis, &Mesh)) -> Mesh {
        let mut mesh = Mesh::default();
        // Rings are made in fours.
        let vertices = self.vertices + LANES;
        mesh.positions.reserve(vertices);
        mesh.normals.reserve(vertices);
        mesh.tangents.reserve(vertices);
        mesh.uvs.reserve(vertices);
        if self.sway.is_some() {
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
            sections: Vec::new(),
            curves: Vec::new(),
            round: Round::default(),
            bends: Vec::new(),
            feet: Vec::new(),
            blower: None,
            watch,
        };
        let mut forks = vec![false; if options.even_texels { self.axes.stations.len() } else { 0 }];
        if options.even_texels {
            self.axes
                .all
                .iter()
                .filter_map(|axis| axis.bearing)
                .for_each(|(_, station)| forks[station] = true);
        }
        let mut swung = self.sway.as_ref().map(|sway| Swung::new(sway, &self.axes));
        for (number, axis) in self.axes.all.iter().enumerate() {
            weaver.line = &self.axes.stations[axis.stations.clone()];
            weaver.circle = circles.of(axis.sides);
            let first = axis.base;
            weaver.tiles = (TAU * first.radius.max(weaver.line[0].radius) / options.tile).round().max(1.0);
            if options.even_texels {
                weaver.divide(&forks[axis.stations.clone()]);
            }
            weaver.step = weaver.tiles / axis.sides as f32;
            weaver.run(0);
            collar::curves(&self.axes, &circles, axis, &mut weaver.curves);
            if let Some(swung) = &mut swung {
                swung.swing(number);
                weaver.bends = swung.bends[axis.stations.clone()].to_vec();
                weaver.feet = swung.feet(&circles, axis, &weaver.curves, &weaver.bends[0]);
                weaver.blower = Some((swung.sway, axis.branch));
            }
            weaver.weave();
            if !watch.goes_on() {
                break;
            }
            woven(axis, &weaver.mesh);
        }
        weaver.mesh
    }
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
            // Place of the last point, which is filled in below.
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
    /// Changes of the number of tiles around, the last one first: the ring, and the number from
    /// there on.
    sections: Vec<(usize, f32)>,
    /// Its collar; none if there is none.
    curves: Vec<Curves>,
    /// The points of one ring of it.
    round: Round,
    /// Bends of its level rings; none if not wanted.
    bends: Vec<Bend>,
    /// For each foot of its collar the moments from the parent branch's triangles, less those of
    /// its first level ring, and the parent branch's node.
    feet: Vec<([Vec3; 3], u32)>,
    blower: Option<(&'a Sway, usize)>,
    watch: &'a Watch<'a>,
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
                let t = blend as f32 / (blends + 1) as f32;
                let ring = self.collar(t);
                self.go_on(&mut before, ring, 0, Some(t));
            }
        }
        for i in 0..self.line.len() {
            if !self.watch.steps(self.circle.corners.len().div_ceil(16)) {
                return;
            }
            let ring = self.level(i);
            self.go_on(&mut before, ring, i, None);
            if let Some((_, tiles)) = self.sections.pop_if(|(ring, _)| *ring == i) {
                (self.tiles, self.step) = (tiles, tiles / self.sides() as f32);
                self.run(i);
                // The same ring once more, with other texture coordinates.
                before = Some(self.level(i));
                self.blow(i, None);
            }
        }
        if let Some(ring @ Ring::Circle(_)) = before {
            self.tip(ring);
        }
    }

    /// Divides the axis into sections at its forks, each with the tiles of its mean radius; the first one's are set.
    fn divide(&mut self, forks: &[bool]) {
        self.sections.clear();
        let mut starts = vec![0];
        for (i, station) in self.line.iter().enumerate() {
            let begun = self.line[starts[starts.len() - 1]].radius;
            if forks[i]
                && station.radius > 0.0
                && station.radius * THINNER < begun
                && starts.len() < MOST_SECTIONS
            {
                starts.push(i);
            }
        }
        let end = |k: usize| starts.get(k + 1).copied().unwrap_or(self.line.len() - 1);
        let tiles = |k: usize| {
            let [from, to] = [starts[k], end(k)].map(|i| self.line[i].radius);
            // A tip of no thickness does not count.
            let mean = (from * to.max(0.4 * from)).sqrt();
            (TAU * mean / self.options.tile).round().max(1.0)
        };
        let mut last = tiles(0);
        self.tiles = last;
        for (k, &start) in starts.iter().enumerate().skip(1) {
            let own = tiles(k);
            if own < last {
                self.sections.push((start, own));
                last = own;
            }
        }
        self.sections.reverse();
    }

    /// Works out how v runs along the axis from a ring on; up to there it stays.
    fn run(&mut self, from: usize) {
        let mut v = if from == 0 { self.line[0].along / self.options.tile } else { self.course[from] };
        self.course.truncate(from);
        if from > 0 {
            self.course.push(v);
        }
        for (i, station) in self.line.iter().enumerate().skip(self.course.len()) {
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

    /// Growth of v per metre where the axis has this radius.
    fn pace(&self, radius: f32) -> f32 {
        if !self.options.square_tiles {
            return 1.0 / self.options.tile;
        }
        // A tip of no thickness has texels as small as those of the thinnest wood that can be told from it.
        let least = self.line[0].radius.max(self.options.tile / TAU) * THINNEST;
        self.tiles / (TAU * radius.max(least))
    }

    /// Joins a ring to the one before. It bends as a level ring does; at a part of the collar, as its feet do besides.
    fn go_on(&mut self, before: &mut Option<Ring>, ring: Ring, level: usize, part: Option<f32>) {
        self.blow(level, part);
        match *before {
            None => self.base(ring),
            Some(before) => self.join(before, ring),
        }
        *before = Some(ring);
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
        // The line where the collar leaves its parent branch's facets is not seen as long as it
        // still has the parent branch's normals.
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
        self.blow(self.line.len() - 1, None);
    }

    /// The texture coordinate v this far beyond the last ring, metres.
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
        if self.blower.is_some() {
            let rim = first..center as usize;
            let part = 1.0 / self.sides() as f32;
            let mean = |level: usize| {
                self.mesh.wind[rim.clone()][1..].iter().map(|wind| wind.moments[level] * part).sum()
            };
            let middle = Wind { moments: [0, 1, 2].map(mean), ..self.mesh.wind[first] };
            self.mesh.wind.push(middle);
            self.mesh.wind.extend_from_within(rim);
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

    /// Gives the latest vertices their wind.
    fn blow(&mut self, level: usize, part: Option<f32>) {
        let Some((sway, branch)) = self.blower else { return };
        let bend = self.bends[level];
        let node = sway.node_at(branch, self.line[level].at);
        // The feet's share fades smoothly.
        let fade = part.map_or(0.0, |part| (1.0 - part) * (1.0 - part));
        let Mesh { positions, wind, .. } = &mut self.mesh;
        for (i, &position) in positions[wind.len()..].iter().enumerate() {
            let mut vertex = sway.wind_of(branch as u32, node, bend.moments_of(position));
            if fade > 0.0 {
                let (more, bearing) = self.feet[i % (self.circle.corners.len() - 1)];
                vertex.moments = std::array::from_fn(|level| vertex.moments[level] + more[level] * fade);
                vertex.node = if fade < 1.0 { node } else { bearing };
            }
            wind.push(vertex);
        }
    }
}
