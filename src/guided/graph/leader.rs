//! A trunk along a line.

use crate::guided::curve::{Line, centripetal};
use crate::math::{perpendicular, powf, sin};
use crate::parameter::ParameterError;
use crate::random::{Purpose, stream};
use crate::skeleton::Skeleton;
use glam::Vec3;
use rand::RngExt;
use std::f32::consts::PI;

/// A smooth trunk from its base to its top, as straight or as wayward as is wanted: the one path of a tree on which a
/// graph's irregularity would plainly be seen.
///
/// It strays from the straight line, or from a curve [through points](Self::with_points), by a sum of slow waves, other
/// ones for each seed, and by as much as its *waywardness* says: the farthest distance from the line over the distance
/// between its ends.
///
/// ```
/// use treesynth::{glam::Vec3, guided::Leader};
///
/// let trunk = Leader::new(Vec3::ZERO, Vec3::Y * 8.0).with_waywardness(0.05).skeleton(1, 0.2)?;
/// let farthest = trunk.positions().iter().map(|p| p.with_y(0.0).length()).fold(0.0, f32::max);
/// assert!((farthest / 8.0 - 0.05).abs() < 0.01);
/// # Ok::<(), treesynth::ParameterError>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Leader {
    base: Vec3,
    top: Vec3,
    waywardness: f32,
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Vec::is_empty"))]
    points: Vec<Vec3>,
}

crate::recipe::readable!(Leader { waywardness: f32 });
crate::recipe::readable!(&Leader { points: [Vec3] });

/// Waves of one, two, ... half turns from base to top, and how fast higher ones get smaller.
const WAVES: usize = 5;
const FALL: f32 = 1.6;
/// The most nodes.
const MAX_NODES: f32 = 1e6;
/// The most points that it goes through, and straight parts from one to the next.
const MAX_POINTS: usize = 1000;
const PARTS: usize = 32;

impl Leader {
    /// From `base` to `top`, metres, with a waywardness of 0.02.
    pub fn new(base: Vec3, top: Vec3) -> Self {
        Self { base, top, waywardness: 0.02, points: Vec::new() }
    }

    /// At most 1,000 points, metres, that the line it strays from goes through between base and top, in their order, as a
    /// smooth curve: a trunk that leans and rises again, one that turns aside at its top. None makes a straight line.
    ///
    /// ```
    /// use treesynth::{glam::Vec3, guided::Leader};
    ///
    /// let bow = Leader::new(Vec3::ZERO, Vec3::Y * 4.0).with_points([Vec3::new(0.5, 2.0, 0.0)]).with_waywardness(0.0);
    /// let widest = bow.skeleton(1, 0.1)?.positions().iter().map(|place| place.x).fold(0.0, f32::max);
    /// assert!((0.5..0.52).contains(&widest));
    /// # Ok::<(), treesynth::ParameterError>(())
    /// ```
    pub fn with_points(mut self, points: impl Into<Vec<Vec3>>) -> Self {
        self.points = points.into();
        self
    }

    /// The farthest distance from its line over the distance between its ends, in [0, 0.5]: 0 is ruler-straight, 0.02 a forest
    /// tree, 0.1 gnarled. From a curve [through points](Self::with_points) it is at most that.
    pub fn with_waywardness(mut self, waywardness: f32) -> Self {
        self.waywardness = waywardness;
        self
    }

    /// Checks that the options are in range.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(self.base.is_finite(), "Leader.base", self.base, "finite, in metres")?;
        let length = self.base.distance(self.top);
        let fits = length > 1e-6 && length <= 1e6;
        ParameterError::unless(fits, "Leader.top", self.top, "1e-6 to 1e6 m from the base")?;
        let fits = (0.0..=0.5).contains(&self.waywardness);
        ParameterError::unless(fits, "Leader.waywardness", self.waywardness, "in [0, 0.5]")?;
        let count = self.points.len();
        ParameterError::unless(count <= MAX_POINTS, "Leader.points", count, "at most 1000 points")?;
        self.points.iter().enumerate().try_for_each(|(number, &point)| {
            let fits = self.base.distance(point) <= 1e6;
            ParameterError::unless(
                fits,
                &format!("Leader.points[{number}]"),
                point,
                "within 1e6 m of the base",
            )
        })
    }

    /// Starting point, metres.
    pub fn base(&self) -> Vec3 {
        self.base
    }

    /// The same leader from another base.
    pub(super) fn at(&self, base: Vec3) -> Self {
        let points = self.points.iter().map(|point| base + (point - self.base)).collect();
        Self { base, top: base + (self.top - self.base), points, waywardness: self.waywardness }
    }

    /// The trunk of a seed, with nodes about `spacing` metres apart. O(nodes + points).
    ///
    /// # Errors
    /// An option out of range, or a spacing that makes for more than a million nodes.
    pub fn skeleton(&self, seed: u64, spacing: f32) -> Result<Skeleton, ParameterError> {
        self.numbered(seed, 0, spacing)
    }

    /// The trunk of a seed and a number: those of other numbers stray otherwise.
    pub(super) fn numbered(&self, seed: u64, number: u64, spacing: f32) -> Result<Skeleton, ParameterError> {
        self.check()?;
        let parts = (self.line().length() / spacing).ceil().max(1.0);
        let fits = spacing > 0.0 && parts <= MAX_NODES;
        ParameterError::unless(fits, "Leader.spacing", spacing, "above 0 m, for at most 1000000 nodes")?;
        self.through(seed, number, &(0..=parts as u32).map(|i| i as f32 / parts).collect::<Vec<_>>())
    }

    /// As [`numbered`](Self::numbered), with nodes as far apart as a function of the place says, which is above 0 m.
    pub(super) fn graded(
        &self,
        seed: u64,
        number: u64,
        spacing: impl Fn(Vec3) -> f32,
    ) -> Result<Skeleton, ParameterError> {
        self.check()?;
        let line = self.line();
        let (length, mut at, mut places) = (line.length(), 0.0, vec![0.0]);
        while at < 1.0 {
            let step = spacing(line.at(at));
            let fits = step > 0.0 && length / step <= MAX_NODES;
            ParameterError::unless(fits, "Leader.spacing", step, "above 0 m, for at most 1000000 nodes")?;
            at += step / length;
            places.push(at);
        }
        for place in &mut places {
            *place /= at;
        }
        self.through(seed, number, &places)
    }

    /// The trunk through these shares of its length, ascending from 0 to 1.
    fn through(&self, seed: u64, number: u64, places: &[f32]) -> Result<Skeleton, ParameterError> {
        let (way, length) = (self.top - self.base, self.base.distance(self.top));
        let mut random = stream(seed, 0, Purpose::LEADER, number);
        let axes = [perpendicular(way / length), (way / length).cross(perpendicular(way / length))];
        let waves: Vec<Vec3> = (1..=WAVES)
            .map(|wave| {
                let [a, b] = [0, 1].map(|_| 2.0 * random.random::<f32>() - 1.0);
                (axes[0] * a + axes[1] * b) * powf(wave as f32, -FALL)
            })
            .collect();
        // The base grows straight out of the ground, so the waves swell from nothing over its first quarter.
        let stray = |t: f32| {
            let sum: Vec3 = (1u8..).zip(&waves).map(|(n, &wave)| wave * sin(PI * f32::from(n) * t)).sum();
            let swell = (4.0 * t).min(1.0);
            sum * (swell * swell * (3.0 - 2.0 * swell))
        };
        // Measured on the finest trunk, so that one of any spacing strays alike.
        let farthest = (0..=256).map(|i| stray(i as f32 / 256.0).length()).fold(0.0, f32::max);
        let scale = if farthest > 0.0 { self.waywardness * length / farthest } else { 0.0 };
        let line = self.line();
        let positions = places.iter().map(|&t| line.at(t) + stray(t) * scale).collect();
        let parents = (0..places.len() as u32).map(|node| node.checked_sub(1)).collect();
        Skeleton::new(positions, parents)
            .map_err(|error| ParameterError::new("Leader.top", self.top, error.to_string()))
    }

    /// The line that it strays from.
    pub(in crate::guided) fn line(&self) -> Line {
        if self.points.is_empty() {
            return Line::new(vec![self.base, self.top]);
        }
        // Points that lie on one another have no curve between them.
        let all = self.points.iter().chain([&self.top]);
        let least = 1e-6 * all.map(|point| point.distance(self.base)).fold(0.0, f32::max);
        let mut given = vec![self.base];
        given.extend(&self.points);
        given.dedup_by(|point, before| point.distance(*before) <= least);
        while given.len() > 1 && given[given.len() - 1].distance(self.top) <= least {
            given.pop();
        }
        given.push(self.top);
        let last = given.len() - 1;
        let mut points = vec![self.base];
        for i in 0..last {
            let (from, to) = (given[i], given[i + 1]);
            let before = if i > 0 { given[i - 1] } else { from * 2.0 - to };
            let after = if i + 2 <= last { given[i + 2] } else { to * 2.0 - from };
            points.extend(
                (1..=PARTS).map(|part| centripetal([before, from, to, after], part as f32 / PARTS as f32)),
            );
        }
        Line::new(points)
    }
}
