//! Points spread evenly by leaving out those that are too near to others.

use glam::{DVec3, Vec3};

/// Points already taken, in lists by a hash of their cell.
struct Grid {
    heads: Vec<u32>,
    next: Vec<u32>,
    side: f64,
}

const NONE: u32 = u32::MAX;

impl Grid {
    fn new(points: usize, side: f64) -> Self {
        Self { heads: vec![NONE; (2 * points).next_power_of_two()], next: vec![NONE; points], side }
    }

    fn cell(&self, p: Vec3) -> [i64; 3] {
        (p.as_dvec3() / self.side).to_array().map(|x| x.floor() as i64)
    }

    /// Teschner and others 2003, "Optimized spatial hashing for collision detection of deformable objects".
    fn slot(&self, cell: [i64; 3]) -> usize {
        let [x, y, z] = cell;
        let hash = x.wrapping_mul(73_856_093) ^ y.wrapping_mul(19_349_663) ^ z.wrapping_mul(83_492_791);
        hash as usize & (self.heads.len() - 1)
    }

    fn insert(&mut self, points: &[Vec3], point: usize) {
        let slot = self.slot(self.cell(points[point]));
        self.next[point] = std::mem::replace(&mut self.heads[slot], point as u32);
    }

    /// `true` if no point taken so far is closer than a cell's side.
    fn is_free(&self, points: &[Vec3], place: Vec3) -> bool {
        let [x, y, z] = self.cell(place);
        (0..27).all(|i| {
            let mut point = self.heads[self.slot([x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1])];
            while point != NONE {
                let away: DVec3 = points[point as usize].as_dvec3() - place.as_dvec3();
                if away.length_squared() < self.side * self.side {
                    return false;
                }
                point = self.next[point as usize];
            }
            true
        })
    }
}

/// The numbers of `count` of the `points`, ascending, as far apart as taking them in their order allows: those at least
/// `distance` apart first, then, as long as they do not suffice, with ever smaller distances.
///
/// O(n log n) expected, O(n) memory; 4.5 times as many points as wanted are enough for an even spread.
pub(super) fn spread(points: &[Vec3], count: usize, distance: f64) -> Vec<usize> {
    let mut taken = vec![false; points.len()];
    let mut left = count.min(points.len());
    let mut side = distance;
    // 64 times 0.9 is less than a hundredth: what is nearer than that is taken as it comes.
    for _ in 0..64 {
        let mut grid = Grid::new(points.len(), side);
        (0..points.len()).filter(|&point| taken[point]).for_each(|point| grid.insert(points, point));
        for point in 0..points.len() {
            if left > 0 && !taken[point] && grid.is_free(points, points[point]) {
                grid.insert(points, point);
                taken[point] = true;
                left -= 1;
            }
        }
        if left == 0 {
            break;
        }
        side *= 0.9;
    }
    for taken in taken.iter_mut().filter(|taken| !**taken).take(left) {
        *taken = true;
    }
    (0..points.len()).filter(|&point| taken[point]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, unit};

    fn random_points(count: u64) -> Vec<Vec3> {
        let coordinate = |i| unit(3, 0, Purpose::CUSTOM, i);
        (0..count)
            .map(|i| Vec3::new(coordinate(3 * i), coordinate(3 * i + 1), coordinate(3 * i + 2)))
            .collect()
    }

    #[test]
    fn spread_points_keep_their_distance() {
        let points = random_points(4_000);
        let least = |numbers: &[usize]| {
            let pairs =
                numbers.iter().flat_map(|&a| numbers.iter().filter(move |&&b| b > a).map(move |&b| (a, b)));
            pairs.map(|(a, b)| points[a].distance(points[b])).fold(f32::MAX, f32::min)
        };
        let found = spread(&points, 500, 0.12);
        assert_eq!(found.len(), 500);
        // 500 balls of that diameter fill a quarter of the cube; 500 random points come within a tenth of it.
        let first: Vec<usize> = (0..500).collect();
        assert!(least(&found) > 0.09 && least(&first) < 0.03, "{} {}", least(&found), least(&first));
    }

    #[test]
    fn points_in_one_place_are_taken_as_they_come() {
        let points = vec![Vec3::ONE; 10];
        assert_eq!(spread(&points, 4, 1.0), [0, 1, 2, 3]);
        assert_eq!(spread(&points, 20, 1.0).len(), 10);
    }
}
