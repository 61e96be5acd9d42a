//! Winding number of a closed surface around a point, exact and at once.
//!
//! A lattice of cells, each with the triangles that reach into it and the winding number at a point of its own. From that
//! point to another in the cell the number changes by one at each triangle that is crossed on the way, so long as the surface
//! has no border. Unlike a hierarchy of boxes or balls it does not mind triangles that are long and thin: a cell
//! holds the pieces within it and nothing else.

use glam::{DVec3, Vec3};

use crate::shape::Bounds;

/// Cells for each triangle, and in all at most.
const CELLS_EACH: f32 = 4.0;
const MOST_CELLS: f32 = 2_000_000.0;

/// Cells along an axis.
const MOST_ALONG: f32 = 400.0;

/// Greatest mean number of cells that a triangle reaches into, and an allowance on top for all triangles
/// together; if they are exceeded, the lattice is made of fewer cells.
const REACH: usize = 64;
const REACH_MORE: usize = 1 << 20;

/// Position of a cell's own point; not in the middle, where faces of models lie.
const WITHIN: DVec3 = DVec3::new(0.487_13, 0.527_31, 0.511_97);

/// A lattice over a closed surface.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cells {
    low: DVec3,
    /// Sides of a cell.
    sides: DVec3,
    counts: [usize; 3],
    /// Index in `reaching` of the first triangle of each cell, and the end.
    starts: Vec<u32>,
    reaching: Vec<u32>,
    /// The winding number at the point of each cell.
    numbers: Vec<i32>,
}

impl Cells {
    /// The cells of triangles without a border, all within `bounds`. O(n) for triangles of like size.
    pub(super) fn new(triangles: &[[Vec3; 3]], bounds: Bounds) -> Self {
        let mut wanted = (triangles.len() as f32 * CELLS_EACH).clamp(8.0, MOST_CELLS);
        loop {
            let mut cells = Self::empty(bounds, wanted);
            if cells.fill(triangles, REACH * triangles.len() + REACH_MORE) || cells.numbers.len() == 1 {
                cells.number(triangles);
                return cells;
            }
            wanted *= 0.3;
        }
    }

    fn empty(bounds: Bounds, wanted: f32) -> Self {
        // A little more on all sides, so that nothing lies on the lattice's border.
        let margin = f64::from(bounds.size().max_element()) * 1e-4;
        let low = bounds.min.as_dvec3() - margin;
        let size = bounds.max.as_dvec3() + margin - low;
        let long = size.max_element();
        // As many cells of equal sides as fit, where the box is not too flat for it.
        let (mut fewest, mut most) = (long / f64::from(MOST_ALONG), long);
        let along = |side: f64| (size / side).ceil().clamp(DVec3::ONE, DVec3::splat(MOST_ALONG.into()));
        for _ in 0..40 {
            let side = 0.5 * (fewest + most);
            let along = along(side);
            if along.x * along.y * along.z > f64::from(wanted) { fewest = side } else { most = side }
        }
        let along = along(most);
        let counts = along.to_array().map(|count| count as usize);
        let total = counts[0] * counts[1] * counts[2];
        Self {
            low,
            sides: size / along,
            counts,
            starts: Vec::new(),
            reaching: Vec::new(),
            numbers: vec![0; total],
        }
    }

    /// Finds the triangles of each cell; false if there are more than `most` in all.
    fn fill(&mut self, triangles: &[[Vec3; 3]], most: usize) -> bool {
        let mut starts = vec![0; self.numbers.len() + 1];
        let mut reached = 0;
        for corners in triangles {
            self.reach(corners, |cell| {
                starts[cell as usize + 1] += 1;
                reached += 1;
            });
            if reached > most.min(u32::MAX as usize) {
                return false;
            }
        }
        for cell in 0..self.numbers.len() {
            starts[cell + 1] += starts[cell];
        }
        let (mut next, mut reaching) = (starts.clone(), vec![0; reached]);
        for (number, corners) in (0..).zip(triangles) {
            self.reach(corners, |cell| {
                let place = &mut next[cell as usize];
                reaching[*place as usize] = number;
                *place += 1;
            });
        }
        (self.starts, self.reaching) = (starts, reaching);
        true
    }

    /// The cells that a triangle reaches into: cut into layers along x, those into rows along y.
    fn reach(&self, corners: &[Vec3; 3], mut see: impl FnMut(u32)) {
        let mut whole = Polygon::default();
        for corner in corners {
            whole.push((corner.as_dvec3() - self.low) / self.sides);
        }
        let layers = whole.range(0, self.counts[0]);
        for x in layers {
            let layer = whole.between(0, x);
            for y in layer.range(1, self.counts[1]) {
                let row = layer.between(1, y);
                row.range(2, self.counts[2]).for_each(|z| see(self.cell([x, y, z]) as u32));
            }
        }
    }

    fn cell(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    fn point(&self, [x, y, z]: [usize; 3]) -> DVec3 {
        self.low + (DVec3::new(x as f64, y as f64, z as f64) + WITHIN) * self.sides
    }

    /// Works out the winding number at each cell's point: from outside along each row.
    fn number(&mut self, triangles: &[[Vec3; 3]]) {
        for z in 0..self.counts[2] {
            for y in 0..self.counts[1] {
                let (mut number, mut from) = (0, self.point([0, y, z]).with_x(self.low.x));
                for x in 0..self.counts[0] {
                    let point = self.point([x, y, z]);
                    let border = point.with_x(self.low.x + (x + 1) as f64 * self.sides.x);
                    let cell = self.cell([x, y, z]);
                    for corners in self.at(cell, triangles) {
                        number += change(corners, 0, from, point);
                    }
                    self.numbers[cell] = number;
                    for corners in self.at(cell, triangles) {
                        number += change(corners, 0, point, border);
                    }
                    from = border;
                }
            }
        }
    }

    fn at<'a>(&'a self, cell: usize, triangles: &'a [[Vec3; 3]]) -> impl Iterator<Item = &'a [Vec3; 3]> {
        let reaching = self.starts[cell] as usize..self.starts[cell + 1] as usize;
        self.reaching[reaching].iter().map(|&number| &triangles[number as usize])
    }

    /// The winding number at a point; 0 outside of the lattice, and for a point that is not finite. O(1) but where many
    /// triangles come near.
    pub(super) fn winding(&self, triangles: &[[Vec3; 3]], point: Vec3) -> i32 {
        let place = (point.as_dvec3() - self.low) / self.sides;
        let mut at = [0; 3];
        for axis in 0..3 {
            if !(0.0..self.counts[axis] as f64).contains(&place[axis]) {
                return 0;
            }
            at[axis] = (place[axis] as usize).min(self.counts[axis] - 1);
        }
        let cell = self.cell(at);
        let own = self.point(at);
        let point = point.as_dvec3();
        let turns = [own, own.with_z(point.z), own.with_z(point.z).with_y(point.y), point];
        let mut number = self.numbers[cell];
        for corners in self.at(cell, triangles) {
            for (axis, way) in [2, 1, 0].into_iter().zip(turns.windows(2)) {
                number += change(corners, axis, way[0], way[1]);
            }
        }
        number
    }
}

/// Change of the winding number at a triangle on the way between two points that differ along one axis alone.
///
/// If the way meets a side that triangles share, it crosses exactly one of them, since both apply the same
/// test to the side; and of two ways that meet in a point, exactly one crosses a triangle there.
fn change(corners: &[Vec3; 3], axis: usize, from: DVec3, to: DVec3) -> i32 {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let (at_u, at_v) = (from[u], from[v]);
    let mut around = 0;
    for side in 0..3 {
        let (a, b) = (corners[side], corners[(side + 1) % 3]);
        let (a_above, b_above) = (f64::from(a[v]) > at_v, f64::from(b[v]) > at_v);
        if a_above != b_above {
            let (low, high) = if b_above { (a, b) } else { (b, a) };
            let (low_u, low_v) = (f64::from(low[u]), f64::from(low[v]));
            let (run, rise) = (f64::from(high[u]) - low_u, f64::from(high[v]) - low_v);
            if run * (at_v - low_v) - rise * (at_u - low_u) > 0.0 {
                around += if b_above { 1 } else { -1 };
            }
        }
    }
    if around == 0 {
        return 0;
    }
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let normal = (b - a).cross(c - a);
    let ahead = |point: DVec3| normal.dot(point - a) > 0.0;
    let (before, after) = (ahead(from), ahead(to));
    // Out through the front one turn less, in through it one more.
    i32::from(before) - i32::from(after)
}

/// A convex polygon in space, of a triangle cut four times at most.
#[derive(Clone, Copy, Default)]
struct Polygon {
    corners: [DVec3; 8],
    count: usize,
}

/// Overhang that a piece may have through rounding, as a share of a cell's side.
const LEEWAY: f64 = 1e-6;

impl Polygon {
    fn push(&mut self, corner: DVec3) {
        if let Some(free) = self.corners.get_mut(self.count) {
            *free = corner;
            self.count += 1;
        }
    }

    /// The layers that it reaches into.
    fn range(&self, axis: usize, layers: usize) -> std::ops::Range<usize> {
        if self.count == 0 {
            return 0..0;
        }
        let places = self.corners[..self.count].iter().map(|corner| corner[axis]);
        let (low, high) = places.fold((f64::MAX, f64::MIN), |(low, high), at| (low.min(at), high.max(at)));
        let last = layers - 1;
        let at = |place: f64| (place.max(0.0) as usize).min(last);
        at(low - LEEWAY)..at(high + LEEWAY) + 1
    }

    /// The piece within a layer.
    fn between(&self, axis: usize, layer: usize) -> Self {
        let (low, high) = (layer as f64 - LEEWAY, (layer + 1) as f64 + LEEWAY);
        self.cut(axis, low, 1.0).cut(axis, high, -1.0)
    }

    /// The piece on one side of a plane.
    fn cut(&self, axis: usize, at: f64, sign: f64) -> Self {
        let mut piece = Self::default();
        for i in 0..self.count {
            let (a, b) = (self.corners[i], self.corners[(i + 1) % self.count]);
            let (from, to) = ((a[axis] - at) * sign, (b[axis] - at) * sign);
            if from >= 0.0 {
                piece.push(a);
            }
            if (from >= 0.0) != (to >= 0.0) {
                piece.push(a + (b - a) * (from / (from - to)));
            }
        }
        piece
    }
}

#[cfg(test)]
mod tests {
    use super::super::winding::Winding;
    use super::*;
    use crate::random::{Purpose, stream};
    use rand::RngExt;

    /// Tetrahedra in any places, over one another, some inside out: what the plain sum of solid angles gives.
    #[test]
    fn equals_the_sum_of_solid_angles() {
        for seed in 0..60 {
            let mut random = stream(seed, 0, Purpose::CUSTOM, 0);
            let mut point = |size: f32| Vec3::new(random.random(), random.random(), random.random()) * size;
            let mut triangles = Vec::new();
            let thin = if seed % 2 == 0 { Vec3::ONE } else { Vec3::new(1.0, 0.001, 0.03) };
            for _ in 0..=seed {
                let at = point(2.0);
                let [a, b, c, d] = [(); 4].map(|()| (at + point(1.0)) * thin);
                triangles.extend([[a, b, c], [a, c, d], [a, d, b], [b, d, c]]);
            }
            let bounds = Bounds::of(triangles.iter().flatten().copied());
            let cells = Cells::new(&triangles, bounds);
            let winding = Winding::new(triangles.clone());
            for _ in 0..200 {
                let place = bounds.grown(0.1).at(point(1.0));
                let exact: f32 = winding.exact(place);
                if (exact - exact.round()).abs() < 0.02 {
                    assert_eq!(
                        cells.winding(&triangles, place),
                        exact.round() as i32,
                        "seed {seed}, {place}: {exact}"
                    );
                }
            }
        }
    }

    /// Points whose ways run through corners and sides.
    #[test]
    fn ways_through_corners_count_once() {
        let at = |x: i32, y: i32, z: i32| Vec3::new(x as f32, y as f32, z as f32);
        let tips = [at(2, 0, 0), at(-2, 0, 0), at(0, 2, 0), at(0, -2, 0), at(0, 0, 2), at(0, 0, -2)];
        let mut triangles = Vec::new();
        for (x, y, z) in
            [(0, 2, 4), (0, 4, 3), (0, 3, 5), (0, 5, 2), (1, 4, 2), (1, 3, 4), (1, 5, 3), (1, 2, 5)]
        {
            triangles.push([tips[x], tips[y], tips[z]]);
        }
        let cells = Cells::new(&triangles, Bounds::of(tips));
        for x in -8..9 {
            for y in -8..9 {
                for z in -8..9 {
                    let point = at(x, y, z) * 0.25;
                    let sum = point.abs().element_sum();
                    if (sum - 2.0).abs() > 1e-3 {
                        assert_eq!(cells.winding(&triangles, point), i32::from(sum < 2.0), "{point}");
                    }
                }
            }
        }
    }
}
