//! Regions in which a tree may grow.
//!
//! A [`Shape`] says which points it holds. The simple ones are [`Cuboid`], [`Sphere`], [`Ellipsoid`],
//! [`HalfEllipsoid`], [`Cone`] and [`Cylinder`]; [`Shell`] keeps the rind of another, [`Union`],
//! [`Intersection`], [`Difference`] and [`Translated`] put others together; [`TriangleMesh`] is a model of
//! triangles, [`Sketch`] a crown swept from a silhouette, [`Extrusion`] an [`Outline`] with a depth.
//! Implement [`Shape`] for a shape that is missing.
//!
//! Planar trees use the same shapes: a planar shape is the slice z = 0 of a spatial one.
//!
//! Constructors accept anything; [`Shape::check`] says what is wrong, once, where synthesis starts. Lengths
//! are from [`SMALLEST`] to [`LARGEST`], coordinates at most [`LARGEST`] from 0. The points of a shape that
//! fails its check are unspecified, but using it neither panics nor hangs, and samples are still finite
//! points of it.

mod bounds;
mod brush;
mod combine;
mod cone;
mod cuboid;
#[cfg(feature = "import")]
mod drawing;
mod ellipsoid;
mod mesh;
mod outline;
mod recipe;
mod shell;
mod sketch;
#[cfg(test)]
mod tests;
mod up;

pub use bounds::Bounds;
pub use brush::Brush;
pub use combine::{Difference, Intersection, Translated, Union};
pub use cone::{Cone, Cylinder};
pub use cuboid::Cuboid;
#[cfg(feature = "import")]
pub(crate) use drawing::path_lines;
pub use ellipsoid::{Ellipsoid, HalfEllipsoid, Sphere};
pub use mesh::{Flaws, TriangleMesh, TriangleMeshError};
#[cfg(feature = "import")]
pub use mesh::{Import, MeshFormat};
pub use outline::{Extrusion, Outline};
pub use recipe::ShapeRecipe;
pub use shell::Shell;
pub use sketch::{CrossProfile, Sketch};
pub use up::UpAxis;
pub(crate) use up::check_numbers;

use std::sync::Arc;

use glam::Vec3;
use rand::RngExt;

use crate::ParameterError;

/// The smallest length that the shapes of this module accept: a micrometre.
pub const SMALLEST: f32 = 1e-6;

/// The largest length, and the largest coordinate to either side of 0, that the shapes of this module
/// accept: a thousand kilometres.
///
/// `f32` has 24 bits: coordinates near this limit are 6 cm apart. Within a kilometre of the origin they are
/// at most 0.06 mm apart, and that is where trees should grow.
pub const LARGEST: f32 = 1e6;

/// Number of points that [`Shape::sample`] tries before it calls a shape empty.
const TRIES: u32 = 1 << 16;

/// The lattice of [`Shape::volume`] has this many cells on each axis.
const CELLS: u16 = 48;

/// Position of each point of that lattice in its cell: a Kronecker sequence with these steps.
///
/// Powers of 1/g, where g⁴ = g + 1: Roberts 2018, "The unreasonable effectiveness of quasirandom sequences",
/// for three dimensions.
const STEPS: [f64; 3] = [0.819_172_513_396_164_5, 0.671_043_606_703_789_3, 0.549_700_477_901_970_3];

/// A region of space: which points are in it, and a box around it.
///
/// # The contract
///
/// - `contains` gives the same answer for the same point, always. If not, the same seed no longer gives the
///   same tree.
/// - `contains` is false for points with NaN or infinities. If not, they end up in positions, which
///   [`Skeleton`](crate::Skeleton) refuses.
/// - `bounds` encloses every point that `contains` accepts. If not, what sticks out does not exist for
///   `sample`, `volume` and whoever fills the shape with points: crowns come out cut off flat. Bounds wider
///   than needed are correct, but cost time, and `sample` may miss a shape that fills less than a
///   ten-thousandth of its bounds.
/// - `check` refuses parameters that break the above. It is called once, where synthesis starts, not before
///   every use, so no method panics or hangs on a shape that would fail it.
///
/// The other methods have defaults that follow from the first two, and that an implementation replaces when
/// it knows better.
///
/// # A shape of your own
///
/// ```
/// use treesynth::{Bounds, Shape, glam::Vec3, random};
///
/// /// A ring lying on the ground: a hedge around a lawn.
/// struct Ring {
///     radius: f32,
///     thickness: f32,
/// }
///
/// impl Shape for Ring {
///     fn contains(&self, point: Vec3) -> bool {
///         let outwards = (point.x * point.x + point.z * point.z).sqrt() - self.radius;
///         outwards * outwards + point.y * point.y <= self.thickness * self.thickness
///     }
///
///     fn bounds(&self) -> Bounds {
///         let reach = self.radius + self.thickness;
///         Bounds::around(Vec3::ZERO, Vec3::new(reach, self.thickness, reach))
///     }
/// }
///
/// let hedge = Ring { radius: 5.0, thickness: 0.5 };
/// let mut random = random::stream(1, 0, random::Purpose::CUSTOM, 0);
/// let inside = hedge.sample(&mut random).expect("a ring is not empty");
/// assert!(hedge.contains(inside) && hedge.bounds().contains(inside));
/// // Pappus: the volume is π thickness² times 2π radius.
/// assert!((hedge.volume() - 24.67).abs() < 0.5);
/// ```
pub trait Shape: Send + Sync {
    /// `true` if `point` (metres) lies in the shape.
    ///
    /// The shapes of this module are closed sets, their surface belongs to them, up to the rounding of `f32`;
    /// [`Shell`] and [`Difference`] lack the surface of what is taken away. O(1) for each simple shape in a
    /// combination.
    fn contains(&self, point: Vec3) -> bool;

    /// A box that encloses every point of the shape; [empty](Bounds::is_empty) if it has none.
    fn bounds(&self) -> Bounds;

    /// Checks that the parameters make sense.
    ///
    /// # Errors
    /// The first parameter out of its range, named `Type.field`.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }

    /// Volume in cubic metres; 0 if the bounds are empty or not finite.
    ///
    /// The default asks `contains` for one point in each of 48³ cells of the bounds and is a few percent off
    /// for compact shapes, more for thin ones. It is the same on every call. Only the numbers of points that
    /// are computed from it depend on it: wrong volumes give wrong densities.
    fn volume(&self) -> f32 {
        lattice_volume(self.bounds(), |point| self.contains(point))
    }

    /// `true` if a point of the shape may lie in `bounds`. The default is `true`.
    ///
    /// `false` for a box without a point of the shape saves the search there; `false` for a box with one
    /// leaves a hole in a graph.
    fn touches(&self, bounds: Bounds) -> bool {
        let _ = bounds;
        true
    }

    /// A point of the shape, each part of it as likely as its volume; `None` if none was found.
    ///
    /// The default draws from the bounds until `contains` agrees, at most 65,536 times: expected cost
    /// `bounds().volume() / volume()` calls. After `None` do not ask again: the shape is empty, or so thin
    /// that it might as well be.
    ///
    /// An implementation that returns points outside the shape has branches grow out of it; one that favours
    /// a part has them crowd there.
    fn sample(&self, random: &mut dyn rand::Rng) -> Option<Vec3> {
        let bounds = self.bounds();
        if bounds.is_empty() || !bounds.is_finite() {
            return None;
        }
        draw(TRIES, |point| self.contains(point), || bounds.at(unit_cube(random)))
    }

    /// The area of the surface in square metres, of a shape that can [sample](Self::sample_surface) it. `None` by
    /// default: who needs the surface then looks for it with `contains`.
    fn surface_area(&self) -> Option<f32> {
        None
    }

    /// A point of the surface, each part of it as likely as its area; `None` where
    /// [`surface_area`](Self::surface_area) is.
    fn sample_surface(&self, random: &mut dyn rand::Rng) -> Option<Vec3> {
        let _ = random;
        None
    }
}

macro_rules! forward {
    ($($pointer:ty),*) => {$(
        impl<T: Shape + ?Sized> Shape for $pointer {
            fn contains(&self, point: Vec3) -> bool {
                (**self).contains(point)
            }

            fn bounds(&self) -> Bounds {
                (**self).bounds()
            }

            fn check(&self) -> Result<(), ParameterError> {
                (**self).check()
            }

            fn touches(&self, bounds: Bounds) -> bool {
                (**self).touches(bounds)
            }
            fn volume(&self) -> f32 {
                (**self).volume()
            }

            fn sample(&self, random: &mut dyn rand::Rng) -> Option<Vec3> {
                (**self).sample(random)
            }

            fn surface_area(&self) -> Option<f32> {
                (**self).surface_area()
            }

            fn sample_surface(&self, random: &mut dyn rand::Rng) -> Option<Vec3> {
                (**self).sample_surface(random)
            }
        }
    )*};
}

forward!(&T, Box<T>, Arc<T>);

/// The first of at most `tries` points that is contained.
fn draw(tries: u32, contains: impl Fn(Vec3) -> bool, mut point: impl FnMut() -> Vec3) -> Option<Vec3> {
    (0..tries).map(|_| point()).find(|&point| contains(point))
}

/// A few tries, for points that are outside only if rounding put them there.
fn draw_inside(shape: &impl Shape, point: impl FnMut() -> Vec3) -> Option<Vec3> {
    draw(64, |point| shape.contains(point), point)
}

/// Uniform in [0, 1)³.
fn unit_cube(random: &mut dyn rand::Rng) -> Vec3 {
    Vec3::new(random.random(), random.random(), random.random())
}

/// Volume of what `contains` accepts within `bounds`.
fn lattice_volume(bounds: Bounds, contains: impl Fn(Vec3) -> bool) -> f32 {
    if bounds.is_empty() || !bounds.is_finite() {
        return 0.0;
    }
    let (mut hits, mut number) = (0_u32, 0_u32);
    lattice(bounds, CELLS, |point| {
        hits += u32::from(contains(point));
        number += 1;
    });
    // Bounds of a shape that fails its check may be so large that their volume overflows.
    if hits == 0 { 0.0 } else { bounds.volume() * (hits as f32 / number as f32) }
}

/// One point in each cell of a lattice in `bounds`, not always in the cell's middle, so that faces parallel to the axes
/// do not line up with the lattice.
fn lattice(bounds: Bounds, cells: u16, mut see: impl FnMut(Vec3)) {
    let mut number = 0_u32;
    for x in 0..cells {
        for y in 0..cells {
            for z in 0..cells {
                let within = STEPS.map(|step| (f64::from(number) * step).fract() as f32);
                let cell = Vec3::new(f32::from(x), f32::from(y), f32::from(z));
                see(bounds.at((cell + Vec3::from_array(within)) / f32::from(cells)));
                number += 1;
            }
        }
    }
}

fn check_position(parameter: &str, position: Vec3) -> Result<(), ParameterError> {
    ParameterError::unless(
        position.abs().cmple(Vec3::splat(LARGEST)).all(),
        parameter,
        position,
        "from -1e6 to 1e6 metres on every axis",
    )
}

fn check_length(parameter: &str, length: f32) -> Result<(), ParameterError> {
    ParameterError::unless(
        (SMALLEST..=LARGEST).contains(&length),
        parameter,
        length,
        "from 1e-6 to 1e6 metres",
    )
}

/// Place and wanted height.
fn check_fit(name: &str, base: f32, height: f32) -> Result<(), ParameterError> {
    let holds = base.abs() <= LARGEST;
    ParameterError::unless(holds, &format!("{name}.base"), base, "from -1e6 to 1e6 metres")?;
    check_length(&format!("{name}.height"), height)
}

fn check_lengths(parameter: &str, lengths: Vec3) -> Result<(), ParameterError> {
    let smallest = Vec3::splat(SMALLEST).cmple(lengths).all();
    ParameterError::unless(
        smallest && lengths.cmple(Vec3::splat(LARGEST)).all(),
        parameter,
        lengths,
        "from 1e-6 to 1e6 metres on every axis",
    )
}
