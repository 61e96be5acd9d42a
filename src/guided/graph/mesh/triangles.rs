//! The mesh as the graph needs it: welded, without slivers, with what lies beside each side.

use glam::Vec3;

/// Not a triangle: beyond a side lies nothing, or more than one triangle.
pub(super) const NONE: u32 = u32::MAX;

#[derive(Debug)]
pub(super) struct Triangles {
    corners: Vec<[Vec3; 3]>,
    /// Names of the corners, one per place.
    names: Vec<[u32; 3]>,
    normals: Vec<Vec3>,
    /// Beyond the sides from corner 0 to 1, 1 to 2 and 2 to 0.
    beside: Vec<[u32; 3]>,
    /// The number of each in the mesh.
    numbers: Vec<u32>,
    /// The area of the triangles up to each.
    areas: Vec<f64>,
}

impl Triangles {
    /// `positions` are finite, and `triangles` name them.
    pub(super) fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let welded = weld(positions);
        let mut all = Self {
            corners: Vec::new(),
            names: Vec::new(),
            normals: Vec::new(),
            beside: Vec::new(),
            numbers: Vec::new(),
            areas: Vec::new(),
        };
        let mut area = 0.0;
        for (number, triangle) in (0..).zip(triangles) {
            let corners = triangle.map(|corner| positions[corner as usize]);
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            let doubled = (b - a).cross(c - a);
            let Some(normal) = doubled.try_normalize() else { continue };
            area += doubled.length() * 0.5;
            all.corners.push(corners);
            all.names.push(triangle.map(|corner| welded[corner as usize]));
            all.normals.push(normal.as_vec3());
            all.numbers.push(number);
            all.areas.push(area);
        }
        all.link();
        all
    }

    fn link(&mut self) {
        self.beside = vec![[NONE; 3]; self.corners.len()];
        let mut sides: Vec<([u32; 2], u32, usize)> = Vec::with_capacity(3 * self.corners.len());
        for (triangle, names) in (0..).zip(&self.names) {
            for side in 0..3 {
                let (from, to) = (names[side], names[(side + 1) % 3]);
                sides.push(([from.min(to), from.max(to)], triangle, side));
            }
        }
        sides.sort_unstable();
        for same in sides.chunk_by(|a, b| a.0 == b.0) {
            if let [(_, one, side_one), (_, two, side_two)] = *same {
                self.beside[one as usize][side_one] = two;
                self.beside[two as usize][side_two] = one;
            }
        }
    }

    /// Square metres.
    pub(super) fn area(&self) -> f32 {
        self.areas.last().map_or(0.0, |&area| area as f32)
    }

    /// Largest coordinate by value, metres.
    pub(super) fn extent(&self) -> f32 {
        self.corners.as_flattened().iter().map(|p| p.abs().max_element()).fold(0.0, f32::max)
    }

    pub(super) fn normal(&self, triangle: u32) -> Vec3 {
        self.normals[triangle as usize]
    }

    /// Its number in the mesh.
    pub(super) fn number(&self, triangle: u32) -> u32 {
        self.numbers[triangle as usize]
    }

    /// The inverse of [`number`](Self::number).
    pub(super) fn place_of(&self, number: u32) -> u32 {
        self.numbers.partition_point(|&other| other < number) as u32
    }

    pub(super) fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.corners[triangle as usize]
    }

    pub(super) fn beside(&self, triangle: u32, side: usize) -> u32 {
        self.beside[triangle as usize][side]
    }

    /// The side of `triangle` beyond which `other` lies.
    pub(super) fn side_to(&self, triangle: u32, other: u32) -> Option<usize> {
        self.beside[triangle as usize].iter().position(|&beside| beside == other)
    }

    /// A triangle by a share of the area in [0, 1).
    pub(super) fn by_area(&self, share: f64) -> u32 {
        let area = share * self.areas.last().copied().unwrap_or_default();
        (self.areas.partition_point(|&sum| sum <= area)).min(self.areas.len() - 1) as u32
    }

    /// The point of the surface nearest to `point`, the first of equally near triangles. O(t).
    pub(super) fn nearest(&self, point: Vec3) -> Option<(u32, Vec3)> {
        let mut best = (f32::INFINITY, None);
        for (triangle, &corners) in (0..).zip(&self.corners) {
            let nearest = nearest_in(corners, point);
            let distance = nearest.distance_squared(point);
            if distance < best.0 {
                best = (distance, Some((triangle, nearest)));
            }
        }
        best.1
    }
}

/// The first vertex in the place of each. O(n log n).
fn weld(positions: &[Vec3]) -> Vec<u32> {
    // Plus zero, to make -0 and 0 one place.
    let key = |vertex: u32| (positions[vertex as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(|&vertex| (key(vertex), vertex));
    let mut names = vec![0; positions.len()];
    let mut first = 0;
    for (i, &vertex) in order.iter().enumerate() {
        if i == 0 || key(first) != key(vertex) {
            first = vertex;
        }
        names[vertex as usize] = first;
    }
    names
}

/// The point of a triangle nearest to `p` (Ericson 2004, "Real-Time Collision Detection", section 5.1.5).
pub(super) fn nearest_in([a, b, c]: [Vec3; 3], p: Vec3) -> Vec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let sum = va + vb + vc;
    a + ab * (vb / sum) + ac * (vc / sum)
}
