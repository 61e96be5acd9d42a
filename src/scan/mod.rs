//! A laser scanner that is simulated: clouds whose truth is known point by point.

mod bvh;
#[cfg(test)]
mod tests;

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};
use rand::RngExt;

use self::bvh::{Bvh, Ray};
use crate::cloud::{Cloud, CloudError};
use crate::math;
use crate::random::{Purpose, stream};
use crate::surface::{MeshError, Part};
use crate::{ParameterError, parallel};

/// Rays of a beam: one in the middle, six around it at two thirds of its radius, so that each stands for an equal area.
const RAYS: usize = 7;
const RING: f32 = 2.0 / 3.0;
/// Beams of one place.
const MOST_BEAMS: f64 = 4e9;
/// Triangles, copies multiplied out.
const MOST_TRIANGLES: u64 = 1 << 28;

/// A terrestrial laser scanner on one or several stands, and what it measures of a scene.
///
/// From each place, beams go out in equal steps of azimuth and elevation wherever something of the scene may
/// be. A beam widens with its range; seven rays stand for its cross-section. Rays that meet surfaces closer
/// together than the [separation](Self::with_separation) make one echo, at the mean of their ranges: at edges
/// this lies between both surfaces, a mixed pixel (Hebert and Krotkov 1992, "3D measurements from imaging
/// laser radars: how good are they?"). Surfaces behind the first echo are hidden, but for later
/// [echoes](Self::with_echoes). The range has Gaussian noise.
///
/// Same scene, options and seed: same bits, at any number of threads. O(t log t + b log t) for t triangles
/// and b beams; some 130 bytes per triangle, copies multiplied out.
///
/// ```
/// use treesynth::{Skeleton, glam::Vec3, scan::Scanner, surface::{Part, Tubes}};
///
/// let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y * 2.0], vec![None, Some(0)])?.with_radii(vec![0.1, 0.1])?;
/// let mesh = Tubes::default().with_wind(true).mesh(&pole)?;
/// let scanner = Scanner::new(vec![Vec3::new(5.0, 1.5, 0.0)]).with_step(0.01);
/// let scan = scanner.scan(&[Part::new(&mesh)], 1)?;
/// assert!(scan.cloud.len() > 50 && scan.truth.iter().all(|truth| truth.part == 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct Scanner {
    places: Vec<Vec3>,
    step: f32,
    exit: f32,
    divergence: f32,
    noise: f32,
    separation: f32,
    echoes: usize,
    range: f32,
    ground: Option<f32>,
}

/// The measurement of a scanner: points, and the truth about each.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Scan {
    /// The points, those of the first place first.
    pub cloud: Cloud,
    /// The surface that each point lies on.
    pub truth: Vec<Truth>,
}

/// The surface that a point lies on; at an edge the one that most of the beam has met.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Truth {
    /// The part's number, or [`Truth::GROUND`].
    pub part: u32,
    /// The node of the skeleton: for bark with [wind](crate::surface::Tubes::with_wind) the one that moves
    /// it, for a leaf the one that bears it; 0 if the mesh has no such data.
    pub node: u32,
    /// The number of the place it was seen from.
    pub place: u32,
    /// The share of the beam that has met anything within the echo.
    pub share: f32,
    /// `true` if the rays of the echo have met different parts or nodes.
    pub is_mixed: bool,
}

impl Truth {
    /// The part of points on the ground.
    pub const GROUND: u32 = u32::MAX;
}

/// Error of scanning a scene.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScanError {
    /// An option out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A mesh whose arrays do not fit together.
    #[error("the mesh is not sound: {0}")]
    Mesh(#[from] MeshError),
    /// Points beyond what a cloud holds.
    #[error(transparent)]
    Cloud(#[from] CloudError),
    /// More triangles than fit.
    #[error("the scene has {triangles} triangles, copies multiplied out, but may have {MOST_TRIANGLES}")]
    TooLarge {
        /// The triangles.
        triangles: u64,
    },
}

impl Scanner {
    /// A scanner on stands at `places`, metres: steps of 0.0006 rad (0.034°), a beam of 3 mm that widens by 0.0003 rad, noise of
    /// 2 mm, echoes 5 cm apart, the first echo of each beam, 100 m far, no ground. These are those of common phase-shift scanners.
    pub fn new(places: Vec<Vec3>) -> Self {
        Self {
            places,
            step: 0.0006,
            exit: 0.003,
            divergence: 0.0003,
            noise: 0.002,
            separation: 0.05,
            echoes: 1,
            range: 100.0,
            ground: None,
        }
    }

    /// A scanner at this number of `places` on a circle about `center`, from +X on, `distance` metres away.
    pub fn around(center: Vec3, distance: f32, places: usize) -> Self {
        let place = |i: usize| {
            let (sin, cos) = math::sin_cos(TAU * i as f32 / places.max(1) as f32);
            center + Vec3::new(cos, 0.0, sin) * distance
        };
        Self::new((0..places).map(place).collect())
    }

    /// Radians from one beam to the next, 1e-5 to 0.1.
    pub fn with_step(mut self, radians: f32) -> Self {
        self.step = radians;
        self
    }

    /// Diameter of the beam where it leaves the scanner, 0 to 0.1 m, and its divergence, 0 to 0.1 rad (the
    /// full angle).
    pub fn with_beam(mut self, exit: f32, divergence: f32) -> Self {
        (self.exit, self.divergence) = (exit, divergence);
        self
    }

    /// Standard deviation of a range, 0 to 1 m.
    pub fn with_noise(mut self, metres: f32) -> Self {
        self.noise = metres;
        self
    }

    /// Surfaces closer to each other along a beam make one echo, 0 to 10 m.
    pub fn with_separation(mut self, metres: f32) -> Self {
        self.separation = metres;
        self
    }

    /// The echoes of a beam that are kept, nearest first, 1 to 7.
    pub fn with_echoes(mut self, echoes: usize) -> Self {
        self.echoes = echoes;
        self
    }

    /// Range of the scanner, 0.1 to 10,000 m.
    pub fn with_range(mut self, metres: f32) -> Self {
        self.range = metres;
        self
    }

    /// Level ground at this height, metres; seen as far as the scene is wide.
    pub fn with_ground(mut self, height: f32) -> Self {
        self.ground = Some(height);
        self
    }

    fn check(&self) -> Result<(), ParameterError> {
        let count = self.places.len();
        ParameterError::unless(
            (1..=10_000).contains(&count),
            "number of Scanner.places",
            count,
            "1 to 10,000",
        )?;
        for &place in &self.places {
            let fits = place.abs().cmple(Vec3::splat(1e5)).all();
            ParameterError::unless(fits, "Scanner.places", place, "within 1e5 m of 0 on every axis")?;
        }
        ParameterError::unless(
            (1e-5..=0.1).contains(&self.step),
            "Scanner.step",
            self.step,
            "1e-5 to 0.1 rad",
        )?;
        ParameterError::unless((0.0..=0.1).contains(&self.exit), "Scanner.exit", self.exit, "0 to 0.1 m")?;
        ParameterError::unless(
            (0.0..=0.1).contains(&self.divergence),
            "Scanner.divergence",
            self.divergence,
            "0 to 0.1 rad",
        )?;
        ParameterError::unless((0.0..=1.0).contains(&self.noise), "Scanner.noise", self.noise, "0 to 1 m")?;
        ParameterError::unless(
            (0.0..=10.0).contains(&self.separation),
            "Scanner.separation",
            self.separation,
            "0 to 10 m",
        )?;
        ParameterError::unless((1..=RAYS).contains(&self.echoes), "Scanner.echoes", self.echoes, "1 to 7")?;
        ParameterError::unless(
            (0.1..=1e4).contains(&self.range),
            "Scanner.range",
            self.range,
            "0.1 to 10,000 m",
        )?;
        let ground = self.ground.unwrap_or(0.0);
        ParameterError::unless(ground.abs() <= 1e5, "Scanner.ground", ground, "within 1e5 m of 0")
    }

    /// Scans the parts where they stand. Without a triangle the cloud is empty, ground or not.
    ///
    /// # Errors
    /// Options out of range; parts that are not sound, or lie beyond 1e5 m; more than 4e9 beams from a place; more than 2²⁸ triangles.
    pub fn scan(&self, parts: &[Part<'_>], seed: u64) -> Result<Scan, ScanError> {
        self.check()?;
        let scene = Scene::new(parts, self.ground)?;
        let mut points = Vec::new();
        let mut truth = Vec::new();
        for (number, &place) in (0_u32..).zip(&self.places) {
            let Some(window) = Window::new(&scene, place, self.step) else { continue };
            let beams = window.columns as f64 * window.rows as f64;
            let range = "steps wide enough for at most 4e9 beams a place";
            ParameterError::unless(beams <= MOST_BEAMS, "Scanner.step", self.step, range)?;
            let column = |column: usize| self.column(&scene, &window, number, column, seed);
            for (position, seen) in parallel::map(window.columns, column).into_iter().flatten() {
                points.push(position);
                truth.push(seen);
            }
        }
        Ok(Scan { cloud: Cloud::new(points)?, truth })
    }

    /// The beams of one azimuth, upwards.
    fn column(
        &self,
        scene: &Scene,
        window: &Window,
        place: u32,
        column: usize,
        seed: u64,
    ) -> Vec<(Vec3, Truth)> {
        let mut random = stream(seed, place, Purpose::SCAN, column as u64);
        let start = self.places[place as usize];
        let (sin, cos) = math::sin_cos(window.azimuth + column as f32 * self.step);
        let (mut seen, mut near) = (Vec::new(), Vec::new());
        let reach = self.range.min((scene.high - start).abs().max((scene.low - start).abs()).length() + 1.0);
        // Rays of a beam stay within this of the one in its middle.
        let radius = 0.5 * (self.exit + self.divergence * reach) * 1.01 + 1e-5 * reach;
        for row in 0..window.rows {
            let (high, flat) = math::sin_cos(window.elevation + row as f32 * self.step);
            let direction = Vec3::new(cos * flat, high, sin * flat);
            let across = [Vec3::new(-sin, 0.0, cos), Vec3::new(-cos * high, flat, -sin * high)];
            let mut hits = [(0.0_f32, u32::MAX); RAYS];
            let mut count = 0;
            let middle = Ray { start, direction, reach };
            scene.bvh.around(&middle, radius, &mut near);
            if near.is_empty() && scene.ground.is_none() {
                continue;
            }
            for (i, spot) in SPOTS.iter().enumerate() {
                let aside = across[0] * spot.x + across[1] * spot.y;
                let ray = Ray {
                    start: start + aside * (0.5 * self.exit),
                    direction: (direction + aside * (0.5 * self.divergence)).normalize_or(direction),
                    reach,
                };
                if let Some(hit) = scene.first(&ray, &near) {
                    hits[count] = hit;
                    count += 1;
                }
                // Without a width all rays are one.
                if i == 0 && self.exit == 0.0 && self.divergence == 0.0 {
                    hits = [hits[0]; RAYS];
                    count *= RAYS;
                    break;
                }
            }
            let hits = &mut hits[..count];
            hits.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let separation = self.separation;
            for echo in hits.chunk_by(|a, b| b.0 - a.0 <= separation).take(self.echoes) {
                let mean = echo.iter().map(|hit| hit.0).sum::<f32>() / echo.len() as f32;
                let range = mean + self.noise * gauss(&mut random);
                seen.push((start + direction * range, scene.truth(echo, place)));
            }
        }
        seen
    }
}

/// Positions of the rays in the beam's cross-section, in its radii.
const SPOTS: [Vec2; RAYS] = [
    Vec2::ZERO,
    Vec2::new(RING, 0.0),
    Vec2::new(0.5 * RING, 0.866_025_4 * RING),
    Vec2::new(-0.5 * RING, 0.866_025_4 * RING),
    Vec2::new(-RING, 0.0),
    Vec2::new(-0.5 * RING, -0.866_025_4 * RING),
    Vec2::new(0.5 * RING, -0.866_025_4 * RING),
];

/// Box and Muller 1958.
fn gauss(random: &mut impl rand::Rng) -> f32 {
    let (a, b) = (random.random::<f32>(), random.random::<f32>());
    (-2.0 * math::ln(1.0 - a)).sqrt() * math::cos(TAU * b)
}

/// All triangles, and what each is of.
struct Scene {
    bvh: Bvh,
    /// Part and node of each triangle.
    owners: Vec<(u32, u32)>,
    ground: Option<f32>,
    /// The corners of the box around all of it.
    low: Vec3,
    high: Vec3,
}

impl Scene {
    fn new(parts: &[Part<'_>], ground: Option<f32>) -> Result<Self, ScanError> {
        parts.iter().try_for_each(Part::check::<ScanError>)?;
        let triangles = parts.iter().map(Part::triangles).sum();
        if triangles > MOST_TRIANGLES {
            return Err(ScanError::TooLarge { triangles });
        }
        let mut corners = Vec::with_capacity(triangles as usize);
        let mut owners = Vec::with_capacity(triangles as usize);
        for (number, part) in (0_u32..).zip(parts) {
            let mesh = part.mesh();
            let is_copied = part.instances().is_some();
            for copy in part.placed().iter() {
                let matrix = copy.matrix();
                for triangle in mesh.triangles() {
                    corners.push(triangle.map(|i| matrix * mesh.positions[i as usize] + copy.position));
                    let own = mesh.wind.get(triangle[0] as usize).map_or(0, |wind| wind.node);
                    owners.push((number, if is_copied { copy.node } else { own }));
                }
            }
        }
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for &corner in corners.as_flattened() {
            (low, high) = (low.min(corner), high.max(corner));
        }
        if !corners.is_empty() {
            let fits = low.abs().max(high.abs()).max_element() <= 1e5;
            ParameterError::unless(
                fits,
                "bounds of the scene",
                (low, high),
                "within 1e5 m of 0 on every axis",
            )?;
        }
        if let Some(ground) = ground.filter(|_| !corners.is_empty()) {
            low.y = low.y.min(ground);
        }
        Ok(Self { bvh: Bvh::new(&corners), owners, ground, low, high })
    }

    /// Distance at which the ray first meets the ground or one of these triangles, and the number of the
    /// triangle; `u32::MAX` for the ground.
    fn first(&self, ray: &Ray, near: &[u32]) -> Option<(f32, u32)> {
        let hit = self.bvh.first_of(ray, near);
        let ground = self.ground.and_then(|ground| {
            let distance = (ground - ray.start.y) / ray.direction.y;
            let place = ray.start + ray.direction * distance;
            let inside = place.x >= self.low.x
                && place.x <= self.high.x
                && place.z >= self.low.z
                && place.z <= self.high.z;
            (distance > 0.0 && distance <= ray.reach && inside).then_some((distance, u32::MAX))
        });
        match (hit, ground) {
            (Some(hit), Some(ground)) => Some(if hit.0 <= ground.0 { hit } else { ground }),
            (hit, ground) => hit.or(ground),
        }
    }

    fn truth(&self, echo: &[(f32, u32)], place: u32) -> Truth {
        let owner = |&(_, triangle): &(f32, u32)| {
            self.owners.get(triangle as usize).copied().unwrap_or((Truth::GROUND, 0))
        };
        let count = |wanted: (u32, u32)| echo.iter().filter(|hit| owner(hit) == wanted).count();
        let mut best = (0, (Truth::GROUND, 0));
        for hit in echo {
            let own = owner(hit);
            let seen = count(own);
            if seen > best.0 {
                best = (seen, own);
            }
        }
        let (part, node) = best.1;
        let share = echo.len() as f32 / RAYS as f32;
        Truth { part, node, place, share, is_mixed: best.0 < echo.len() }
    }
}

/// The azimuths and elevations in which something of the scene may be.
struct Window {
    azimuth: f32,
    elevation: f32,
    columns: usize,
    rows: usize,
}

impl Window {
    /// `None` where there is nothing to be seen.
    fn new(scene: &Scene, place: Vec3, step: f32) -> Option<Self> {
        if scene.low.x > scene.high.x {
            return None;
        }
        // A beam is less than 0.1 m and a tenth of its range wide.
        let margin = 0.1;
        let (low, high) = (scene.low - place - margin, scene.high - place + margin);
        let corners = [low.x, high.x].map(|x| [low.z, high.z].map(|z| Vec2::new(x, z)));
        let corners: &[Vec2] = corners.as_flattened();
        let is_within = low.x <= 0.0 && high.x >= 0.0 && low.z <= 0.0 && high.z >= 0.0;
        let (azimuth, width) = if is_within {
            (-PI, TAU)
        } else {
            // All corners are within a half turn of the middle.
            let middle = Vec2::new(low.x + high.x, low.z + high.z);
            let toward = math::atan2(middle.y, middle.x);
            let mut spread = (0.0_f32, 0.0_f32);
            for corner in corners {
                let mut turn = math::atan2(corner.y, corner.x) - toward;
                turn -= TAU * (turn / TAU).round();
                spread = (spread.0.min(turn), spread.1.max(turn));
            }
            (toward + spread.0, spread.1 - spread.0)
        };
        // The nearest and farthest of the box on the ground plan.
        let nearest = Vec2::new(low.x.max(-high.x).max(0.0), low.z.max(-high.z).max(0.0)).length();
        let farthest = corners.iter().map(|corner| corner.length()).fold(0.0, f32::max);
        let angles = [low.y, high.y].map(|y| [nearest, farthest].map(|flat| math::atan2(y, flat)));
        let lowest = angles[0][0].min(angles[0][1]);
        let highest = angles[1][0].max(angles[1][1]);
        let columns = (width / step).ceil() as usize + usize::from(!is_within);
        let rows = ((highest - lowest) / step).ceil() as usize + 1;
        Some(Self { azimuth, elevation: lowest, columns, rows })
    }
}
