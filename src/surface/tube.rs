//! Generalized cylinders along the branches.

use super::mesh::has_area;
use super::{Mesh, SurfaceError};
use crate::math::{self, UP, parallel_transport, perpendicular};
use crate::{ParameterError, Skeleton};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Farther out than this, in metres, products of coordinates leave the range of 32-bit floats.
const FARTHEST: f32 = 1e9;
/// Shorter or thinner than this, in metres, the products that make an area vanish in 32-bit floats.
const FINEST: f32 = 1e-9;
/// Times a coordinate: what 32-bit floats can still tell apart there, with two bits to spare.
const RESOLUTION: f32 = 4.0 * f32::EPSILON;
/// Cosine of the sharpest turn a tube follows, 120°; at a sharper one it ends and another begins.
const SHARPEST_TURN: f32 = -0.5;
/// Steepest taper that tilts a normal: a cone this flat is a disc.
const STEEPEST_TAPER: f32 = 1e3;

/// A tube along every branch: one ring of vertices a node, frames without twist, smooth normals, a closed tip.
///
/// What it guarantees: triangles face outward and have an area; normals are of unit length; the same skeleton
/// gives the same bits; the radius at a node is the skeleton's. What it does not: a branch is stuck into the one
/// that bears it and not blended with it, so the surfaces cross there; and where a branch bends more tightly than
/// it is thick, its own rings may cross.
///
/// The trunk's first ring is level, so that a leaning trunk does not gape at the ground. Any other branch's first ring sits at the node it springs from, inside the bearing branch, with the radius
/// of the branch's own first internode. Internodes shorter than floats can tell (4·2⁻²³ of the coordinates, or 1 nm) are
/// passed over, and a radius smaller than that makes a single vertex in place of a ring. Where a branch turns
/// back by more than 120° the tube ends and another begins.
///
/// Texture coordinates: u goes once around, v counts circumferences along the branch, so that a square of bark
/// stays about square on limbs and twigs alike.
///
/// O(nodes · sides) time and memory: 32 bytes a vertex, 24 bytes a quad.
///
/// ```
/// use treesynth::{Skeleton, glam::Vec3, surface::Tubes};
///
/// let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)])?.with_radii(vec![0.1, 0.1])?;
/// let mesh = Tubes::default().with_sides(8).mesh(&pole)?;
/// assert_eq!(mesh.triangles().len(), 8 * 2 + 8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Tubes {
    sides: u32,
    least_sides: u32,
    closed_base: bool,
}

impl Default for Tubes {
    /// 12 sides on the thickest branch, 4 on the thinnest, open at the base.
    fn default() -> Self {
        Self { sides: 12, least_sides: 4, closed_base: false }
    }
}

impl Tubes {
    /// Sides of the thickest branch, 3 to 1024; default 12.
    ///
    /// A branch whose thickest internode has the radius r gets `sides·√(r / r_max)` of them, rounded up, so that
    /// the edges of limbs and twigs look about equally fine.
    pub fn with_sides(mut self, sides: u32) -> Self {
        self.sides = sides;
        self
    }

    /// Sides of the thinnest branches, 3 to 1024; default 4. Larger than [`sides`](Self::with_sides) means the
    /// same as equal.
    pub fn with_least_sides(mut self, sides: u32) -> Self {
        self.least_sides = sides;
        self
    }

    /// Whether tubes get a flat cap where they start, so that each is a closed body; default false, since the
    /// base of the trunk is in the ground and the others' are inside the branch that bears them.
    pub fn with_closed_base(mut self, closed: bool) -> Self {
        self.closed_base = closed;
        self
    }

    /// The tubes of all branches as one mesh. A skeleton that is only a root, or whose internodes all have no
    /// length, gives an empty mesh.
    ///
    /// # Errors
    /// An option out of range; radii that are all zero though there are internodes; more vertices than 32-bit
    /// indices can name; a node more than a million kilometres out or thick.
    pub fn mesh(&self, skeleton: &Skeleton) -> Result<Mesh, SurfaceError> {
        self.check()?;
        if skeleton.segments() == 0 {
            return Ok(Mesh::default());
        }
        let thickest = thickest(skeleton)?;
        let branches = skeleton.branches();
        let trunk_second =
            branches.iter().next().and_then(|trunk| trunk.nodes().get(1).copied()).unwrap_or(0);
        let radius_of = |node: u32| skeleton.radii()[node as usize];
        // The trunk has a foot of its own; any other branch starts with the radius of its first internode.
        let first_radius = |nodes: &[u32]| match radius_of(nodes[0]) {
            foot if nodes[0] == 0 && nodes[1] == trunk_second && foot > 0.0 => foot,
            _ => radius_of(nodes[1]),
        };
        let sides_of = |nodes: &[u32]| {
            let radius = nodes[1..].iter().map(|&node| radius_of(node)).fold(first_radius(nodes), f32::max);
            let sides = (self.sides as f32 * (radius / thickest).sqrt()).ceil() as u32;
            sides.max(self.least_sides).min(self.sides)
        };

        let vertices =
            branches.iter().map(|b| b.nodes().len() * (sides_of(b.nodes()) as usize + 1) + 1).sum();
        if vertices > u32::MAX as usize {
            return Err(SurfaceError::TooLarge { vertices });
        }
        let mut weaver = Weaver::new(self, vertices);
        for (number, branch) in branches.iter().enumerate() {
            let nodes = branch.nodes();
            weaver.stands = number == 0;
            weaver.set_sides(sides_of(nodes));
            weaver.start(skeleton.positions()[nodes[0] as usize], first_radius(nodes))?;
            for &node in &nodes[1..] {
                weaver.go_on(skeleton.positions()[node as usize], radius_of(node))?;
            }
            weaver.finish()?;
        }
        Ok(weaver.mesh)
    }

    fn check(&self) -> Result<(), ParameterError> {
        let range = "3 to 1024";
        let holds = |sides: u32| (3..=1024).contains(&sides);
        ParameterError::unless(holds(self.sides), "Tubes.sides", self.sides, range)?;
        ParameterError::unless(holds(self.least_sides), "Tubes.least_sides", self.least_sides, range)
    }
}

/// The largest radius; refuses what floats cannot compute with.
fn thickest(skeleton: &Skeleton) -> Result<f32, SurfaceError> {
    let mut thickest = 0.0f32;
    for (node, (&position, &radius)) in skeleton.positions().iter().zip(skeleton.radii()).enumerate() {
        if position.abs().max_element() > FARTHEST || radius > FARTHEST {
            return Err(SurfaceError::TooFar { node, position, radius });
        }
        thickest = thickest.max(radius);
    }
    if thickest > 0.0 { Ok(thickest) } else { Err(SurfaceError::NoRadii { nodes: skeleton.len() }) }
}

/// Where a ring goes.
#[derive(Debug, Clone, Copy)]
struct Station {
    position: Vec3,
    radius: f32,
}

/// A ring in the mesh, or the single vertex it has shrunk to.
#[derive(Debug, Clone, Copy)]
enum Ring {
    Circle(u32),
    Point(u32),
}

/// Takes the stations of one tube after another and weaves rings and triangles of them.
struct Weaver {
    mesh: Mesh,
    closed_base: bool,
    /// Whether this is the trunk, whose foot is level with the ground.
    stands: bool,
    /// Cosine, sine and u of each vertex of a ring, the first repeated at the end.
    circle: Vec<(f32, f32, f32)>,
    stations: Vec<Station>,
    /// The unit directions from each station to the next.
    directions: Vec<Vec3>,
    lengths: Vec<f32>,
    /// How far along the branch we are, in circumferences.
    along: f32,
}

impl Weaver {
    fn new(options: &Tubes, vertices: usize) -> Self {
        let mut mesh = Mesh::default();
        mesh.positions.reserve(vertices);
        mesh.normals.reserve(vertices);
        mesh.uvs.reserve(vertices);
        mesh.indices.reserve(vertices.saturating_mul(6));
        Self {
            mesh,
            closed_base: options.closed_base,
            stands: false,
            circle: Vec::new(),
            stations: Vec::new(),
            directions: Vec::new(),
            lengths: Vec::new(),
            along: 0.0,
        }
    }

    fn sides(&self) -> u32 {
        self.circle.len() as u32 - 1
    }

    fn set_sides(&mut self, sides: u32) {
        if self.circle.len() == sides as usize + 1 {
            return;
        }
        self.circle.clear();
        for k in 0..sides {
            let u = k as f32 / sides as f32;
            let (sin, cos) = math::sin_cos(u * TAU);
            self.circle.push((cos, sin, u));
        }
        self.circle.push((self.circle[0].0, self.circle[0].1, 1.0));
    }

    fn start(&mut self, position: Vec3, radius: f32) -> Result<(), SurfaceError> {
        self.finish()?;
        self.along = 0.0;
        self.stations.push(Station { position, radius: visible(position, radius) });
        Ok(())
    }

    fn go_on(&mut self, position: Vec3, radius: f32) -> Result<(), SurfaceError> {
        let Some(&last) = self.stations.last() else { return Ok(()) };
        let way = position - last.position;
        let length = way.length();
        if length <= finest(position).max(finest(last.position)) {
            return Ok(());
        }
        let direction = way / length;
        if self.directions.last().is_some_and(|before| before.dot(direction) < SHARPEST_TURN) {
            self.finish()?;
            self.stations.push(last);
        }
        self.stations.push(Station { position, radius: visible(position, radius) });
        self.directions.push(direction);
        self.lengths.push(length);
        Ok(())
    }

    /// Weaves the stations gathered so far.
    fn finish(&mut self) -> Result<(), SurfaceError> {
        if self.directions.is_empty() || self.stations.iter().all(|station| station.radius == 0.0) {
            self.clear();
            return Ok(());
        }
        let needed = (self.stations.len() + 1) * self.circle.len() + 2;
        let vertices = self.mesh.positions.len() + needed;
        if vertices > u32::MAX as usize {
            return Err(SurfaceError::TooLarge { vertices });
        }
        let mut tangent = self.directions[0];
        let mut normal = perpendicular(tangent);
        let mut before = None;
        for i in 0..self.stations.len() {
            let turned = self.tangent(i);
            normal = parallel_transport(tangent, turned, normal);
            tangent = turned;
            if i > 0 {
                self.along += self.circumferences(i);
            }
            let ring = self.ring(i, tangent, normal);
            match before {
                None => self.base(ring, tangent),
                Some(before) => self.join(before, ring),
            }
            before = Some(ring);
        }
        if let Some(ring @ Ring::Circle(_)) = before {
            let last = self.stations[self.stations.len() - 1];
            self.along += 0.25;
            let apex =
                self.vertex(last.position + tangent * last.radius, tangent, Vec2::new(0.5, self.along));
            self.join(ring, Ring::Point(apex));
        }
        self.clear();
        Ok(())
    }

    fn clear(&mut self) {
        self.stations.clear();
        self.directions.clear();
        self.lengths.clear();
    }

    fn tangent(&self, i: usize) -> Vec3 {
        let last = self.directions.len() - 1;
        let (before, after) = (self.directions[i.saturating_sub(1).min(last)], self.directions[i.min(last)]);
        // A trunk that leans up to 60° still stands on the ground with its whole foot.
        if i == 0 && self.stands && after.dot(UP) > 0.5 {
            return UP;
        }
        (before + after).normalize_or(before)
    }

    /// Length of the internode that ends at station `i` in circumferences.
    fn circumferences(&self, i: usize) -> f32 {
        let radius = 0.5 * (self.stations[i - 1].radius + self.stations[i].radius);
        if radius > 0.0 { self.lengths[i - 1] / (TAU * radius) } else { 0.0 }
    }

    /// How fast the radius grows along the branch, metres a metre.
    fn taper(&self, i: usize) -> f32 {
        let (from, to) = (i.saturating_sub(1), (i + 1).min(self.stations.len() - 1));
        let length: f32 = self.lengths[from..to].iter().sum();
        let taper = (self.stations[to].radius - self.stations[from].radius) / length;
        taper.clamp(-STEEPEST_TAPER, STEEPEST_TAPER)
    }

    fn ring(&mut self, i: usize, tangent: Vec3, normal: Vec3) -> Ring {
        let Station { position, radius } = self.stations[i];
        if radius == 0.0 {
            let outward = if i == 0 { -tangent } else { tangent };
            return Ring::Point(self.vertex(position, outward, Vec2::new(0.5, self.along)));
        }
        let first = self.mesh.positions.len() as u32;
        let binormal = tangent.cross(normal);
        // The normal of a cone leans against its taper; the same for the whole ring.
        let taper = self.taper(i);
        let lean = 1.0 / (1.0 + taper * taper).sqrt();
        let axial = tangent * (-taper * lean);
        for &(cos, sin, u) in &self.circle {
            let radial = normal * cos + binormal * sin;
            self.mesh.positions.push(position + radial * radius);
            self.mesh.normals.push(radial * lean + axial);
            self.mesh.uvs.push(Vec2::new(u, self.along));
        }
        Ring::Circle(first)
    }

    fn vertex(&mut self, position: Vec3, normal: Vec3, uv: Vec2) -> u32 {
        let index = self.mesh.positions.len() as u32;
        self.mesh.positions.push(position);
        self.mesh.normals.push(normal);
        self.mesh.uvs.push(uv);
        index
    }

    /// The flat cap of a tube that starts with a circle; its vertices are its own, for the edge is sharp.
    fn base(&mut self, ring: Ring, tangent: Vec3) {
        let (true, Ring::Circle(first)) = (self.closed_base, ring) else { return };
        let center = self.vertex(self.stations[0].position, -tangent, Vec2::new(0.5, self.along));
        let copy = center + 1;
        for k in 0..=self.sides() {
            let rim = (first + k) as usize;
            self.vertex(self.mesh.positions[rim], -tangent, self.mesh.uvs[rim]);
        }
        for k in copy..copy + self.sides() {
            self.triangle(center, k + 1, k);
        }
    }

    fn join(&mut self, from: Ring, to: Ring) {
        for k in 0..self.sides() {
            match (from, to) {
                (Ring::Circle(a), Ring::Circle(b)) => {
                    self.triangle(a + k, a + k + 1, b + k + 1);
                    self.triangle(a + k, b + k + 1, b + k);
                }
                (Ring::Circle(a), Ring::Point(b)) => self.triangle(a + k, a + k + 1, b),
                (Ring::Point(a), Ring::Circle(b)) => self.triangle(a, b + k + 1, b + k),
                (Ring::Point(_), Ring::Point(_)) => return,
            }
        }
    }

    /// A triangle, unless rounding has left it without area; then its edges coincide and no gap is left.
    #[inline]
    fn triangle(&mut self, a: u32, b: u32, c: u32) {
        if has_area([a, b, c].map(|index| self.mesh.positions[index as usize])) {
            self.mesh.indices.extend_from_slice(&[a, b, c]);
        }
    }
}

/// The smallest length that can be told from zero at `position`, metres.
fn finest(position: Vec3) -> f32 {
    (position.abs().max_element() * RESOLUTION).max(FINEST)
}

/// The radius, or zero where it is too small to be told from zero.
fn visible(position: Vec3, radius: f32) -> f32 {
    if radius > finest(position) { radius } else { 0.0 }
}

#[cfg(test)]
mod tests;
