//! Shapes made of shapes. Each takes anything that is a [`Shape`], `Box<dyn Shape>` and `&S` included.

use glam::Vec3;
use rand::RngExt;

use super::{Bounds, Shape, TRIES, check_position, lattice_volume, unit_cube};
use crate::ParameterError;

/// Union of two shapes.
///
/// [`volume`](Shape::volume) is that of both less an estimate of what they share.
///
/// ```
/// use treesynth::{Shape, glam::Vec3, shape::{Ellipsoid, Union}};
///
/// let pad = |x, y| Ellipsoid::new(Vec3::new(x, y, 0.0), Vec3::new(0.3, 0.1, 0.3));
/// let bonsai = Union::new(Union::new(pad(0.2, 0.2), pad(-0.2, 0.35)), pad(0.0, 0.5));
/// assert!(bonsai.contains(Vec3::new(0.0, 0.55, 0.0)) && !bonsai.contains(Vec3::ZERO));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Union<A, B> {
    first: A,
    second: B,
}

crate::recipe::mapped!(Union { first, second; });

impl<A, B> Union<A, B> {
    /// All of both shapes.
    pub const fn new(first: A, second: B) -> Self {
        Self { first, second }
    }
}

impl<A: Shape, B: Shape> Shape for Union<A, B> {
    fn contains(&self, point: Vec3) -> bool {
        self.first.contains(point) || self.second.contains(point)
    }

    fn bounds(&self) -> Bounds {
        self.first.bounds().union(self.second.bounds())
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.first.check()?;
        self.second.check()
    }

    fn volume(&self) -> f32 {
        let both = self.first.volume() + self.second.volume();
        (both - shared_volume(&self.first, &self.second)).max(0.0)
    }

    fn sample(&self, random: &mut dyn rand::Rng) -> Option<Vec3> {
        // From the two boxes rather than the one around both, which is mostly empty if they are far apart.
        // A point in both boxes comes up twice as often, hence is taken half of the time.
        let (first, second) = (self.first.bounds(), self.second.bounds());
        let usable = |bounds: Bounds| !bounds.is_empty() && bounds.is_finite();
        let share = match (usable(first), usable(second)) {
            (true, true) => first.volume() / (first.volume() + second.volume()),
            (true, false) => 1.0,
            (false, true) => 0.0,
            (false, false) => return None,
        };
        let share = if share.is_nan() { 0.5 } else { share };
        let accepted = |point: Vec3, coin: f32| {
            let twice = first.contains(point) && second.contains(point);
            (!twice || share >= 1.0 || share <= 0.0 || coin < 0.5) && self.contains(point)
        };
        (0..TRIES).find_map(|_| {
            let bounds = if random.random::<f32>() < share { first } else { second };
            let point = bounds.at(unit_cube(random));
            accepted(point, random.random()).then_some(point)
        })
    }
}

/// Intersection of two shapes.
///
/// It may be empty, which is not an error; [`sample`](Shape::sample) then finds nothing.
///
/// ```
/// use treesynth::{Shape, glam::Vec3, shape::{Cuboid, Intersection, Sphere}};
///
/// let ball = Sphere::new(Vec3::ZERO, 1.0);
/// let above_ground = Cuboid::new(Vec3::new(-9.0, 0.0, -9.0), Vec3::splat(9.0));
/// let half = Intersection::new(ball, above_ground);
/// assert_eq!(half.bounds().min.y, 0.0);
/// assert!((half.volume() / ball.volume() - 0.5).abs() < 0.01);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Intersection<A, B> {
    first: A,
    second: B,
}

crate::recipe::mapped!(Intersection { first, second; });

impl<A, B> Intersection<A, B> {
    /// Intersection of both shapes.
    pub const fn new(first: A, second: B) -> Self {
        Self { first, second }
    }
}

impl<A: Shape, B: Shape> Shape for Intersection<A, B> {
    fn contains(&self, point: Vec3) -> bool {
        self.first.contains(point) && self.second.contains(point)
    }

    fn bounds(&self) -> Bounds {
        self.first.bounds().intersection(self.second.bounds())
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.first.check()?;
        self.second.check()
    }

    fn volume(&self) -> f32 {
        shared_volume(&self.first, &self.second)
    }
}

/// Difference of two shapes: room for a power line or a neighbour's house.
///
/// The surface of what is taken away goes with it. It may be empty, which is not an error;
/// [`sample`](Shape::sample) then finds nothing. [`volume`](Shape::volume) is that of the first less an
/// estimate of what they share.
///
/// ```
/// use treesynth::{Shape, glam::Vec3, shape::{Cuboid, Difference, Sphere}};
///
/// let crown = Sphere::new(Vec3::new(0.0, 4.0, 0.0), 3.0);
/// let street = Cuboid::new(Vec3::new(1.0, 0.0, -50.0), Vec3::new(9.0, 9.0, 50.0));
/// let pruned = Difference::new(crown, street);
/// assert!(crown.contains(Vec3::new(2.0, 4.0, 0.0)) && !pruned.contains(Vec3::new(2.0, 4.0, 0.0)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Difference<A, B> {
    kept: A,
    removed: B,
}

crate::recipe::mapped!(Difference { kept, removed; });

impl<A, B> Difference<A, B> {
    /// All of `kept` that is not in `removed`.
    pub const fn new(kept: A, removed: B) -> Self {
        Self { kept, removed }
    }
}

impl<A: Shape, B: Shape> Shape for Difference<A, B> {
    fn contains(&self, point: Vec3) -> bool {
        self.kept.contains(point) && !self.removed.contains(point)
    }

    fn bounds(&self) -> Bounds {
        self.kept.bounds()
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.kept.check()?;
        self.removed.check()
    }

    fn volume(&self) -> f32 {
        (self.kept.volume() - shared_volume(&self.kept, &self.removed)).max(0.0)
    }
}

/// A shape moved elsewhere.
///
/// ```
/// use std::sync::Arc;
/// use treesynth::{Shape, glam::Vec3, shape::{Cone, Translated}};
///
/// let crown: Arc<dyn Shape> = Arc::new(Cone::new(Vec3::ZERO, 1.0, 3.0));
/// let raised = Translated::new(Arc::clone(&crown), Vec3::Y * 2.0);
/// assert!(raised.contains(Vec3::Y * 4.5) && !raised.contains(Vec3::Y));
/// assert_eq!(raised.volume(), crown.volume());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Translated<S> {
    shape: S,
    offset: Vec3,
}

crate::recipe::mapped!(Translated { shape; offset });

impl<S> Translated<S> {
    /// `shape` moved by `offset`, metres, at most 1e6 along each axis.
    pub const fn new(shape: S, offset: Vec3) -> Self {
        Self { shape, offset }
    }
}

impl<S: Shape> Shape for Translated<S> {
    fn contains(&self, point: Vec3) -> bool {
        // Adding and subtracting the offset do not round alike, hence the bounds.
        self.bounds().contains(point) && self.shape.contains(point - self.offset)
    }

    fn bounds(&self) -> Bounds {
        self.shape.bounds().translated(self.offset)
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.shape.check()?;
        check_position("Translated.offset", self.offset)
    }

    fn volume(&self) -> f32 {
        self.shape.volume()
    }

    fn sample(&self, random: &mut dyn rand::Rng) -> Option<Vec3> {
        // Rounding may push a point of the surface out; a few tries find one further in.
        for _ in 0..64 {
            let point = self.shape.sample(random)? + self.offset;
            if self.contains(point) {
                return Some(point);
            }
        }
        None
    }

    fn surface_area(&self) -> Option<f32> {
        self.shape.surface_area()
    }

    fn sample_surface(&self, random: &mut dyn rand::Rng) -> Option<Vec3> {
        Some(self.shape.sample_surface(random)? + self.offset)
    }
}

fn shared_volume(first: &impl Shape, second: &impl Shape) -> f32 {
    let bounds = first.bounds().intersection(second.bounds());
    lattice_volume(bounds, |point| first.contains(point) && second.contains(point))
}
