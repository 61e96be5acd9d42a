//! Fewer and longer triangles: vertices go where the surface is straight.

use crate::observer::Watch;
use glam::Vec3;

/// The most triangles around a vertex.
const MOST_AROUND: usize = 16;
/// Rounds in which all vertices are tried, as long as any go.
const ROUNDS: usize = 3;
/// A triangle is at least as high, on its longest side, as this share of that side.
const SLIMMEST: f32 = 1.0 / 32.0;
/// A triangle's normal and its vertices' have at least this cosine.
const FACING: f32 = 0.5;

/// A part of a closed mesh, in which vertices are moved onto neighbours, so that the triangles between are gone.
///
/// A vertex goes only if all triangles around it and around that neighbour are here, and its own have all their corners
/// here; so other parts of the mesh need not know. The mesh stays closed and a manifold, for the two share no neighbours but
/// those across the side between them (the link condition of Dey and others 1999).
#[derive(Debug)]
pub(super) struct Patch {
    vertices: Vec<Vertex>,
    /// The triangles. Vertices from `vertices.len()` on are elsewhere; triangles that are gone have one
    /// vertex thrice.
    triangles: Vec<[u32; 3]>,
    /// The corner at the same vertex before each: `4 * triangle + i`.
    before: Vec<u32>,
}

/// A vertex of a [`Patch`].
#[derive(Debug, Clone)]
pub(super) struct Vertex {
    pub(super) position: Vec3,
    pub(super) normal: Vec3,
    /// Greatest distance of sides from the surface here, metres.
    error: f32,
    /// The last corner here.
    last: u32,
    kind: Kind,
    /// `true` if it is still to be tried whether the vertex may go.
    waits: bool,
}

/// Fate of a vertex. It does not change as others go.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Unknown,
    Gone,
    /// Has triangles elsewhere.
    Fixed,
    /// Others may be moved onto it.
    Stays,
    Free,
}

/// The triangles around a vertex: the corners there, and the vertices that follow in each.
struct Star {
    count: usize,
    corners: [u32; MOST_AROUND],
    ahead: [u32; MOST_AROUND],
    behind: [u32; MOST_AROUND],
}

/// No corner.
const NONE: u32 = u32::MAX;

impl Vertex {
    pub(super) fn new(position: Vec3, normal: Vec3, error: f32) -> Self {
        Self { position, normal, error, last: NONE, kind: Kind::Unknown, waits: true }
    }

    /// Greatest distance of a side from a surface that is smooth between its ends: the distance of a cubic
    /// curve that is perpendicular to the normals there.
    fn off(&self, other: &Self) -> f32 {
        let way = other.position - self.position;
        (way.dot(self.normal).abs() + way.dot(other.normal).abs()) * (4.0 / 27.0)
    }
}

impl Patch {
    /// Vertices and triangles; these may have vertices beyond the last, which are elsewhere.
    pub(super) fn new(mut vertices: Vec<Vertex>, triangles: Vec<[u32; 3]>) -> Self {
        let mut before = vec![NONE; 4 * triangles.len()];
        for (number, triangle) in triangles.iter().enumerate() {
            for (corner, &vertex) in (4 * number..).zip(triangle) {
                if let Some(vertex) = vertices.get_mut(vertex as usize) {
                    before[corner] = std::mem::replace(&mut vertex.last, corner as u32);
                }
            }
        }
        Self { vertices, triangles, before }
    }

    /// Drops what vertices may go.
    pub(super) fn collapse(&mut self, watch: &Watch<'_>) {
        for _ in 0..ROUNDS {
            let mut any = false;
            for vertex in 0..self.vertices.len() {
                // 64 vertices take the time of a block's vertices.
                if vertex % 64 == 0 && !watch.steps(1) {
                    return;
                }
                let Vertex { waits, kind, .. } = &mut self.vertices[vertex];
                if std::mem::take(waits) && matches!(kind, Kind::Unknown | Kind::Free) {
                    any |= self.drop(vertex as u32);
                }
            }
            if !any {
                break;
            }
        }
    }

    /// The vertices that are left, by their former numbers, and the triangles of these.
    pub(super) fn rest(self) -> (impl Iterator<Item = (u32, Vertex)>, impl Iterator<Item = [u32; 3]>) {
        let vertices = (0..).zip(self.vertices).filter(|(_, vertex)| vertex.kind != Kind::Gone);
        (vertices, self.triangles.into_iter().filter(|[a, b, _]| a != b))
    }

    /// None if there are too many triangles. Forgets those that are gone.
    fn star(&mut self, vertex: u32) -> Option<Star> {
        let mut star = Star {
            count: 0,
            corners: [NONE; MOST_AROUND],
            ahead: [NONE; MOST_AROUND],
            behind: [NONE; MOST_AROUND],
        };
        let mut corner = self.vertices[vertex as usize].last;
        let mut after = NONE;
        while corner != NONE {
            let triangle = self.triangles[corner as usize / 4];
            let before = self.before[corner as usize];
            if triangle[0] == triangle[1] {
                match after {
                    NONE => self.vertices[vertex as usize].last = before,
                    after => self.before[after as usize] = before,
                }
            } else {
                // Corners that are taken in turn are not foreseen.
                let [a, b] = [[1, 2], [2, 0], [0, 1], [0, 0]][corner as usize % 4].map(|i| triangle[i]);
                *star.corners.get_mut(star.count)? = corner;
                (star.ahead[star.count], star.behind[star.count]) = (a, b);
                star.count += 1;
                after = corner;
            }
            corner = before;
        }
        Some(star)
    }

    /// Fate of a vertex with that star.
    fn kind(&mut self, number: u32, star: &Star) -> Kind {
        if self.vertices[number as usize].kind == Kind::Unknown {
            let mut ahead = star.ahead[..star.count].iter();
            self.vertices[number as usize].kind = match star.is_closed() {
                true if ahead.all(|&a| (a as usize) < self.vertices.len()) => Kind::Free,
                true => Kind::Stays,
                false => Kind::Fixed,
            };
        }
        self.vertices[number as usize].kind
    }

    /// Moves a vertex onto the neighbour towards which the surface is straightest, if it may.
    fn drop(&mut self, number: u32) -> bool {
        let Some(star) = self.star(number) else { return false };
        if self.kind(number, &star) != Kind::Free {
            return false;
        }
        let vertex = &self.vertices[number as usize];
        // The best two.
        let mut ways = [(vertex.error, NONE); 2];
        for [_, a, _] in star.around() {
            let other = &self.vertices[a as usize];
            let off = vertex.off(other);
            if other.kind == Kind::Fixed || off >= ways[1].0 {
            } else if off < ways[0].0 {
                ways = [(off, a), ways[0]];
            } else {
                ways[1] = (off, a);
            }
        }
        for (_, onto) in ways {
            if onto != NONE && self.may_go(number, &star, onto) {
                self.go(number, &star, onto);
                return true;
            }
        }
        false
    }

    fn may_go(&mut self, number: u32, star: &Star, onto: u32) -> bool {
        if !self.is_near(number, star, onto) {
            return false;
        }
        let Some(other) = self.star(onto) else { return false };
        let sum = star.count + other.count;
        // With three triangles each they are a tetrahedron's.
        if sum > MOST_AROUND + 4 || sum == 6 || self.kind(onto, &other) == Kind::Fixed {
            return false;
        }
        star.shared(&other) == 2
    }

    /// `true` if the triangles around a vertex are still good and near the surface when it is moved onto
    /// another.
    fn is_near(&self, number: u32, star: &Star, onto: u32) -> bool {
        let [from, to] = [number, onto].map(|vertex| &self.vertices[vertex as usize]);
        let mut nearest = f32::INFINITY;
        // To this neighbour there is a side already.
        let beyond = star.around().find(|&[_, a, _]| a == onto).map(|[_, _, b]| b);
        for [_, a, b] in star.around() {
            if a == onto || b == onto {
                continue;
            }
            let [p, q] = [a, b].map(|vertex| &self.vertices[vertex as usize]);
            let (ahead, back) = (p.position - to.position, q.position - to.position);
            let normal = ahead.cross(back);
            let square = normal.length_squared();
            let side = p.position.distance_squared(q.position);
            let longest = ahead.length_squared().max(back.length_squared()).max(side);
            if square <= SLIMMEST * SLIMMEST * longest * longest {
                return false;
            }
            let area = square.sqrt();
            if [p, q, to].iter().any(|vertex| vertex.normal.dot(normal) < FACING * area)
                || (to.off(p) > to.error.min(p.error) && Some(a) != beyond)
            {
                return false;
            }
            nearest = nearest.min((from.position - to.position).dot(normal).abs() / area);
        }
        nearest <= from.error
    }

    fn go(&mut self, number: u32, star: &Star, onto: u32) {
        for [corner, a, b] in star.around() {
            let triangle = &mut self.triangles[corner as usize / 4];
            if a == onto || b == onto {
                *triangle = [0; 3];
            } else {
                triangle[corner as usize % 4] = onto;
                let last = &mut self.vertices[onto as usize].last;
                self.before[corner as usize] = std::mem::replace(last, corner);
            }
            self.vertices[a as usize].waits = true;
        }
        self.vertices[number as usize].kind = Kind::Gone;
    }
}

impl Star {
    /// Corner, and the vertices that follow.
    fn around(&self) -> impl Iterator<Item = [u32; 3]> {
        (0..self.count).map(|i| [self.corners[i], self.ahead[i], self.behind[i]])
    }

    /// Number of neighbours that are neighbours of the other vertex too.
    fn shared(&self, other: &Self) -> usize {
        self.ahead[..self.count].iter().map(|&a| holds(&other.ahead, other.count, a)).sum()
    }

    /// `true` if triangles go all around.
    fn is_closed(&self) -> bool {
        self.ahead[..self.count].iter().map(|&a| holds(&self.behind, self.count, a)).sum::<usize>()
            == self.count
    }
}

/// Number of times that `vertex` is among the first `count`. The loop goes over all entries, which takes less
/// time than to stop.
fn holds(vertices: &[u32; MOST_AROUND], count: usize, vertex: u32) -> usize {
    let mut found = 0;
    for (i, &other) in (0..).zip(vertices) {
        found += u32::from(other == vertex && i < count as u32);
    }
    found as usize
}
