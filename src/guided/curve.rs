//! Smooth curves through points.

use glam::Vec3;

/// The centripetal Catmull-Rom curve from `p[1]` to `p[2]`, by Barry and Goldman's pyramid.
pub(super) fn centripetal(p: [Vec3; 4], t: f32) -> Vec3 {
    let mut knots = [0.0f32; 4];
    for i in 1..4 {
        knots[i] = knots[i - 1] + p[i - 1].distance(p[i]).sqrt().max(1e-12);
    }
    let at = knots[1] + (knots[2] - knots[1]) * t;
    let mix = |a: Vec3, b: Vec3, i: usize, j: usize| a.lerp(b, (at - knots[i]) / (knots[j] - knots[i]));
    let [a, b, c] = [mix(p[0], p[1], 0, 1), mix(p[1], p[2], 1, 2), mix(p[2], p[3], 2, 3)];
    let (d, e) = (mix(a, b, 0, 2), mix(b, c, 1, 3));
    mix(d, e, 1, 2)
}

/// The uniform Catmull-Rom curve from `p[1]` to `p[2]` (Catmull and Rom 1974).
pub(super) fn catmull_rom(p: [Vec3; 4], t: f32) -> Vec3 {
    let [a, b, c, d] = p;
    (b * 2.0
        + (c - a) * t
        + (a * 2.0 - b * 5.0 + c * 4.0 - d) * (t * t)
        + (b * 3.0 - a - c * 3.0 + d) * (t * t * t))
        * 0.5
}

/// A line from point to point.
#[derive(Debug, Clone)]
pub(super) struct Line {
    pub(super) points: Vec<Vec3>,
    /// Metres from its base, ascending.
    pub(super) ways: Vec<f32>,
}

impl Line {
    /// Of at least one point.
    pub(super) fn new(points: Vec<Vec3>) -> Self {
        let mut ways = vec![0.0];
        for pair in points.windows(2) {
            ways.push(ways[ways.len() - 1] + pair[0].distance(pair[1]));
        }
        Self { points, ways }
    }

    pub(super) fn length(&self) -> f32 {
        self.ways[self.ways.len() - 1]
    }

    /// Point at a share of its length.
    pub(super) fn at(&self, share: f32) -> Vec3 {
        match self.points[..] {
            [alone] => return alone,
            [from, to] => return from + (to - from) * share,
            _ => {}
        }
        let way = share * self.length();
        let after = self.ways.partition_point(|&other| other < way).clamp(1, self.ways.len() - 1);
        let (from, to) = (self.ways[after - 1], self.ways[after]);
        let t = if to > from { ((way - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 };
        self.points[after - 1].lerp(self.points[after], t)
    }

    /// Metres from a point to the nearest of the line; at least two points.
    pub(super) fn distance(&self, point: Vec3) -> f32 {
        let to = |pair: &[Vec3]| {
            let way = pair[1] - pair[0];
            let share = (point - pair[0]).dot(way) / way.length_squared().max(f32::MIN_POSITIVE);
            point.distance(pair[0] + way * share.clamp(0.0, 1.0))
        };
        self.points.windows(2).map(to).fold(f32::INFINITY, f32::min)
    }
}
