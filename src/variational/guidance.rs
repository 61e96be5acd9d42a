//! The guidance shape C = {U, Q, D}: section 3.3 and "Generation of shape sample nodes" in section 5.

use std::f32::consts::TAU;

use glam::Vec3;
use rand::RngExt;

use super::thinning::spread;
use crate::math::sin_cos;
use crate::random::{Purpose, stream, unit};
use crate::{Bounds, ParameterError, Shape};

/// Shape that a tree fills: shape nodes, each a small sphere, that become its tips.
///
/// ```
/// use treesynth::{glam::Vec3, shape::HalfEllipsoid, variational::GuidanceShape};
///
/// let crown = HalfEllipsoid::new(Vec3::Y * 3.0, Vec3::new(3.0, 5.0, 3.0));
/// let shape = GuidanceShape::on_surface(&crown, 400, 1)?.joined(&GuidanceShape::in_volume(&crown, 600, 1)?);
/// assert_eq!(shape.len(), 1000);
/// # Ok::<(), treesynth::ParameterError>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct GuidanceShape {
    positions: Vec<Vec3>,
    diameters: Vec<f32>,
}

/// More would not fit the numbers and the memory of today's machines.
const MOST: usize = 20_000_000;

/// Candidates per wanted shape node, from which those far apart are taken.
const CANDIDATES: usize = 5;

impl GuidanceShape {
    /// Shape nodes of your own: `positions` (metres), each `diameter` metres across.
    ///
    /// Checks nothing; [`check`](Self::check) does, where synthesis starts.
    pub fn from_points(positions: impl Into<Vec<Vec3>>, diameter: f32) -> Self {
        let positions = positions.into();
        let diameters = vec![diameter; positions.len()];
        Self { positions, diameters }
    }

    /// A diameter (metres, finite and above 0) for every shape node instead of one for all.
    pub fn with_diameters(mut self, diameters: Vec<f32>) -> Self {
        self.diameters = diameters;
        self
    }

    /// `count` shape nodes, from 2 to 20,000,000, spread evenly in `shape`.
    ///
    /// Poisson-disc: draws five random points per node and keeps those far apart. The area A of a node is
    /// that of a square as far across as the nodes are apart, `(volume / count)^(2/3)`, and its diameter `2
    /// sqrt(A / 2π)`. O(n log n).
    ///
    /// # Errors
    /// A shape that fails its check or holds nothing, or a count out of range.
    pub fn in_volume(shape: &dyn Shape, count: usize, seed: u64) -> Result<Self, ParameterError> {
        check_count(shape, count)?;
        let mut random = stream(seed, 0, Purpose::SHAPE_NODES, 0);
        let points: Option<Vec<Vec3>> = (0..CANDIDATES * count).map(|_| shape.sample(&mut random)).collect();
        let points = points.ok_or_else(|| empty(shape))?;
        let apart = f64::from(crate::math::cbrt(shape.volume() / count as f32));
        Self::spread(&points, count, apart, apart * apart)
    }

    /// `count` shape nodes, from 2 to 20,000,000, spread evenly near the surface of `shape`: as
    /// [`on_jittered_surface`](Self::on_jittered_surface) with a jitter of [`JITTER`](Self::JITTER).
    ///
    /// # Errors
    /// As there.
    pub fn on_surface(shape: &dyn Shape, count: usize, seed: u64) -> Result<Self, ParameterError> {
        Self::on_jittered_surface(shape, count, Self::JITTER, seed)
    }

    /// The jitter of [`on_surface`](Self::on_surface), our choice by eye: crowns keep their form but not a smooth edge.
    pub const JITTER: f32 = 0.8;

    /// `count` shape nodes, from 2 to 20,000,000, spread evenly on the surface of `shape`, then moved off it by up to about
    /// `jitter` times their distance from each other, in [0, 4]: half of that each for itself, half together with its
    /// neighbours. With 0 all are on the surface.
    ///
    /// From a shape that can [sample](Shape::sample_surface) its surface, as meshes can, five points per node
    /// are drawn. With others, random lines meet a surface evenly (Crofton), and the number of hits gives its
    /// area, so that only [`contains`](Shape::contains) is needed. Lines may pass unnoticed through parts
    /// thinner than a 200th of the bounds. Out of five places per node those far apart are kept; A is the
    /// area over the count, the diameter `2 sqrt(A / 2π)`. O(n log n), and without surface samples about 2000
    /// calls of `contains` per node.
    ///
    /// # Errors
    /// A shape that fails its check or of which no surface is found, or a count or a jitter out of range.
    pub fn on_jittered_surface(
        shape: &dyn Shape,
        count: usize,
        jitter: f32,
        seed: u64,
    ) -> Result<Self, ParameterError> {
        let holds = (0.0..=4.0).contains(&jitter);
        ParameterError::unless(holds, "GuidanceShape.jitter", jitter, "in [0, 4]")?;
        check_count(shape, count)?;
        if let Some(area) = shape.surface_area() {
            let mut random = stream(seed, 0, Purpose::SHAPE_NODES, 0);
            let points: Option<Vec<Vec3>> =
                (0..CANDIDATES * count).map(|_| shape.sample_surface(&mut random)).collect();
            let area = f64::from(area) / count as f64;
            return Ok(Self::spread(&points.ok_or_else(|| empty(shape))?, count, area.sqrt(), area)?
                .jittered(jitter * area.sqrt() as f32, seed));
        }
        let bounds = shape.bounds();
        let (center, radius) = (bounds.center(), bounds.size().length() * 0.51);
        let mut points = Vec::new();
        let mut lines = 0_u32;
        while points.len() < CANDIDATES * count {
            // A shape that fewer lines meet is too thin to be covered evenly.
            if lines as usize >= 4096 && points.len() < lines as usize / 64 {
                return Err(empty(shape));
            }
            let mut random = stream(seed, 0, Purpose::SHAPE_NODES, 1 + u64::from(lines));
            let draw = [(); 4].map(|()| random.random::<f32>());
            let (sin, cos) = sin_cos(TAU * draw[0]);
            let height = 2.0 * draw[1] - 1.0;
            let level = (1.0 - height * height).max(0.0).sqrt();
            let along = Vec3::new(level * cos, height, level * sin).normalize_or(Vec3::Y);
            let (sin, cos) = sin_cos(TAU * draw[2]);
            let (x, y) = along.any_orthonormal_pair();
            let start = center + (x * cos + y * sin) * (radius * draw[3].sqrt());
            cross(shape, start - along * radius, along * (2.0 * radius), &mut points);
            lines += 1;
        }
        // A line through a disc of the bounds' radius meets an area A on average A / (2π r²) times.
        let met = points.len() as f64 / f64::from(lines);
        let area = met * f64::from(TAU) * f64::from(radius * radius) / count as f64;
        Ok(Self::spread(&points, count, area.sqrt(), area)?.jittered(jitter * area.sqrt() as f32, seed))
    }

    /// Shape nodes with an area of `area` square metres each, about `apart` metres from each other.
    fn spread(points: &[Vec3], count: usize, apart: f64, area: f64) -> Result<Self, ParameterError> {
        let taken = spread(points, count, apart.max(1e-6));
        let diameter = 2.0 * (area / f64::from(TAU)).sqrt();
        let shape =
            Self::from_points(taken.into_iter().map(|i| points[i]).collect::<Vec<_>>(), diameter as f32);
        shape.check()?;
        Ok(shape)
    }

    /// Moves each node by up to half of `by` metres on each axis for itself, and as far with its neighbours.
    fn jittered(mut self, by: f32, seed: u64) -> Self {
        if by > 0.0 {
            for (number, position) in (0_u64..).zip(&mut self.positions) {
                let own = [0, 1, 2].map(|axis| unit(seed, JITTERED, Purpose::SHAPE_NODES, 3 * number + axis));
                let shared = smooth_noise(*position / (CLUMP * by), seed);
                *position += (Vec3::from_array(own) - 0.5 + shared) * by;
            }
        }
        self
    }

    /// The shape nodes of both.
    pub fn joined(mut self, other: &Self) -> Self {
        self.positions.extend_from_slice(&other.positions);
        self.diameters.extend_from_slice(&other.diameters);
        self
    }

    /// Number of shape nodes.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// `true` if there are no shape nodes.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Q, the positions, metres.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// D, the diameters, metres.
    pub fn diameters(&self) -> &[f32] {
        &self.diameters
    }

    /// The box around all positions.
    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.positions.iter().copied())
    }

    /// Checks that a tree can be made of this: two shape nodes or more, no two in one place, finite positions
    /// within 1e6 metres of 0, one finite diameter above 0 each. O(n log n).
    ///
    /// # Errors
    /// The first of these that does not hold.
    pub fn check(&self) -> Result<(), ParameterError> {
        let count = self.len();
        ParameterError::unless(
            (2..=MOST).contains(&count),
            "GuidanceShape.positions",
            count,
            "from 2 to 20,000,000 nodes",
        )?;
        let given = self.diameters.len();
        ParameterError::unless(given == count, "GuidanceShape.diameters", given, "one per shape node")?;
        for (node, (position, &diameter)) in self.positions.iter().zip(&self.diameters).enumerate() {
            let holds = position.abs().cmple(Vec3::splat(1e6)).all();
            let name = format!("GuidanceShape.positions[{node}]");
            ParameterError::unless(holds, &name, position, "from -1e6 to 1e6 metres on every axis")?;
            let holds = (1e-6..=1e6).contains(&diameter);
            let name = format!("GuidanceShape.diameters[{node}]");
            ParameterError::unless(holds, &name, diameter, "from 1e-6 to 1e6 metres")?;
        }
        let mut order: Vec<usize> = (0..count).collect();
        let key = |node: usize| self.positions[node].to_array().map(|x| (x + 0.0).to_bits());
        order.sort_by_key(|&node| (key(node), node));
        match order.windows(2).find(|pair| key(pair[0]) == key(pair[1])) {
            None => Ok(()),
            Some(pair) => Err(ParameterError::new(
                format!("GuidanceShape.positions[{}]", pair[1]),
                format_args!("{:?}", self.positions[pair[1]]),
                format!("in another place than node {}", pair[0]),
            )),
        }
    }
}

/// The stages of the streams of jitter: each node's own, and what it shares with its neighbours.
const JITTERED: u32 = 1;
const SHARED: u32 = 2;
/// Distance of places that move independently, in units of the jitter.
const CLUMP: f32 = 6.0;

/// Random vectors on a lattice of side 1, linear in between: -0.5 to 0.5 on each axis.
fn smooth_noise(place: Vec3, seed: u64) -> Vec3 {
    let cell = place.floor();
    let part = place - cell;
    let mut sum = Vec3::ZERO;
    for corner in 0..8_u32 {
        let offset = Vec3::new((corner & 1) as f32, (corner >> 1 & 1) as f32, (corner >> 2) as f32);
        let share = offset * part + (Vec3::ONE - offset) * (Vec3::ONE - part);
        let lattice = cell + offset;
        // 20 bits per axis: what is a million cells apart may repeat.
        let index = lattice
            .to_array()
            .into_iter()
            .fold(0_u64, |index, at| index << 20 | (at as i64 as u64 & 0xf_ffff));
        let draws = [0, 1, 2].map(|axis| unit(seed, SHARED + axis, Purpose::SHAPE_NODES, index));
        sum += (Vec3::from_array(draws) - 0.5) * share.element_product();
    }
    sum
}

fn check_count(shape: &dyn Shape, count: usize) -> Result<(), ParameterError> {
    shape.check()?;
    ParameterError::unless(
        (2..=MOST).contains(&count),
        "GuidanceShape.count",
        count,
        "from 2 to 20,000,000 shape nodes",
    )?;
    let bounds = shape.bounds();
    if bounds.is_empty() || !bounds.is_finite() { Err(empty(shape)) } else { Ok(()) }
}

fn empty(shape: &dyn Shape) -> ParameterError {
    let bounds = shape.bounds();
    ParameterError::new("GuidanceShape.shape", format_args!("{bounds:?}"), "a shape that holds points")
}

/// Adds where the way from `start` enters or leaves `shape`.
fn cross(shape: &dyn Shape, start: Vec3, way: Vec3, points: &mut Vec<Vec3>) {
    const STEPS: u32 = 256;
    let at = |share: f32| start + way * share;
    let mut inside = false;
    for step in 1..=STEPS {
        let (mut low, mut high) = ((step - 1) as f32 / STEPS as f32, step as f32 / STEPS as f32);
        if shape.contains(at(high)) == inside {
            continue;
        }
        for _ in 0..16 {
            let middle = 0.5 * (low + high);
            if shape.contains(at(middle)) == inside { low = middle } else { high = middle }
        }
        points.push(at(if inside { low } else { high }));
        inside = !inside;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Cuboid, Sphere};
    use std::f32::consts::PI;

    #[test]
    fn a_sphere_is_covered_evenly() -> Result<(), ParameterError> {
        let sphere = Sphere::new(Vec3::Y * 5.0, 2.0);
        let shape = GuidanceShape::on_jittered_surface(&sphere, 800, 0.0, 1)?;
        assert_eq!(shape.len(), 800);
        for &position in shape.positions() {
            assert!(sphere.contains(position) && (position.distance(Vec3::Y * 5.0) - 2.0).abs() < 1e-3);
        }
        let exact = 2.0 * (4.0 * PI * 4.0 / 800.0 / TAU).sqrt();
        assert!((shape.diameters()[0] / exact - 1.0).abs() < 0.02, "{} {exact}", shape.diameters()[0]);
        let upper = shape.positions().iter().filter(|position| position.y > 6.0).count();
        assert!((180..=220).contains(&upper), "a quarter of the surface holds {upper} of 800");
        Ok(())
    }

    /// No crown looks cut out: nodes are off the surface, though not far, and neighbours go together.
    #[test]
    fn jitter_moves_nodes_off_the_surface() -> Result<(), ParameterError> {
        let sphere = Sphere::new(Vec3::Y * 5.0, 2.0);
        let apart = (4.0 * PI * 4.0 / 800.0_f32).sqrt();
        for seed in 1..=4 {
            let shape = GuidanceShape::on_surface(&sphere, 800, seed)?;
            let off = |position: &Vec3| position.distance(Vec3::Y * 5.0) - 2.0;
            let offs: Vec<f32> = shape.positions().iter().map(off).collect();
            let most = offs.iter().fold(0.0_f32, |most, off| most.max(off.abs()));
            let near = offs.iter().filter(|off| off.abs() < 0.02 * apart).count();
            assert!(most < 2.0 * GuidanceShape::JITTER * apart && near < 80, "{most} {near}");
            assert_ne!(shape, GuidanceShape::on_surface(&sphere, 800, seed + 4)?);
        }
        let named = |jitter| {
            let shape = GuidanceShape::on_jittered_surface(&sphere, 10, jitter, 1);
            shape.map_err(|error| error.parameter).err()
        };
        for bad in [-0.1, 4.1, f32::NAN] {
            assert_eq!(named(bad), Some("GuidanceShape.jitter".into()));
        }
        Ok(())
    }

    #[test]
    fn a_box_is_filled_evenly() -> Result<(), ParameterError> {
        let cube = Cuboid::centered(Vec3::ZERO, Vec3::splat(2.0));
        let shape = GuidanceShape::in_volume(&cube, 1000, 1)?;
        assert!(shape.positions().iter().all(|&position| cube.contains(position)));
        let octant = shape.positions().iter().filter(|position| position.cmpgt(Vec3::ZERO).all()).count();
        assert!((110..=140).contains(&octant), "an eighth holds {octant} of 1000");
        assert_eq!(shape, GuidanceShape::in_volume(&cube, 1000, 1)?);
        assert_ne!(shape, GuidanceShape::in_volume(&cube, 1000, 2)?);
        Ok(())
    }

    #[test]
    fn what_is_wrong_is_named() {
        let sphere = Sphere::new(Vec3::ZERO, 1.0);
        let named =
            |shape: Result<GuidanceShape, ParameterError>| shape.map_err(|error| error.parameter).err();
        for count in [0, 1, MOST + 1, usize::MAX] {
            assert_eq!(
                named(GuidanceShape::in_volume(&sphere, count, 1)),
                Some("GuidanceShape.count".into())
            );
            assert_eq!(
                named(GuidanceShape::on_surface(&sphere, count, 1)),
                Some("GuidanceShape.count".into())
            );
        }
        let flat = Sphere::new(Vec3::ZERO, -1.0);
        assert_eq!(named(GuidanceShape::in_volume(&flat, 10, 1)), Some("Sphere.radius".into()));
        let nothing = crate::shape::Difference::new(sphere, Sphere::new(Vec3::ZERO, 2.0));
        assert_eq!(named(GuidanceShape::in_volume(&nothing, 10, 1)), Some("GuidanceShape.shape".into()));
        assert_eq!(named(GuidanceShape::on_surface(&nothing, 10, 1)), Some("GuidanceShape.shape".into()));
        let check = |points: &[Vec3], diameter| {
            GuidanceShape::from_points(points, diameter).check().map_err(|error| error.parameter)
        };
        assert_eq!(check(&[Vec3::ONE], 1.0), Err("GuidanceShape.positions".into()));
        assert_eq!(check(&[Vec3::ONE, Vec3::NAN], 1.0), Err("GuidanceShape.positions[1]".into()));
        assert_eq!(check(&[Vec3::ONE, Vec3::X, Vec3::ONE], 1.0), Err("GuidanceShape.positions[2]".into()));
        assert_eq!(check(&[Vec3::ONE, Vec3::X], 0.0), Err("GuidanceShape.diameters[0]".into()));
        let short = GuidanceShape::from_points([Vec3::ONE, Vec3::X], 1.0).with_diameters(vec![1.0]);
        assert_eq!(named(short.check().map(|()| short)), Some("GuidanceShape.diameters".into()));
    }
}
