//! Wanted spacing of nodes, as a function of position.

use super::once::Once;
use super::scalars::Scalars;
use crate::parallel;
use crate::parameter::ParameterError;
use crate::shape::Shape;
use glam::{IVec3, Vec3};
use std::sync::Arc;

/// The spacing of nodes that is wanted at each place; see [`GradedYao`](super::GradedYao).
///
/// It may jump: the graph makes it gradual, and never coarser than it was. It is asked on a lattice, so what it says
/// of a place smaller than a lattice's cell may be missed.
///
/// # Contract
/// - `at` gives the same answer for the same point, always. If not, the same seed no longer gives the same graph.
/// - `at` is finite and above 0 at every point in the bounds of the graph's region, whether the region holds that
///   point or not. If not, building the graph fails, with an error that names the point.
/// - [`check`](Self::check) refuses parameters that break the above; it is called before `at`.
///
/// ```
/// use treesynth::{ParameterError, Silent, glam::Vec3, shape::Cuboid};
/// use treesynth::guided::{GradedYao, GraphBuilder, SizingField};
///
/// /// The higher, the finer.
/// struct Finer { below: f32, above: f32, height: f32 }
///
/// impl SizingField for Finer {
///     fn at(&self, point: Vec3) -> f32 {
///         self.below + (self.above - self.below) * (point.y / self.height).clamp(0.0, 1.0)
///     }
///     fn check(&self) -> Result<(), ParameterError> {
///         ParameterError::unless(self.above > 0.0 && self.below > 0.0, "Finer.above", self.above, "above 0 m")
///     }
/// }
///
/// let region = Cuboid::new(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 4.0, 1.0));
/// let sizing = Finer { below: 0.3, above: 0.1, height: 4.0 };
/// let graph = GradedYao::new(region, sizing).build(1, &Silent)?;
/// let upper = graph.positions().iter().filter(|p| p.y > 2.0).count();
/// assert!(upper > 2 * (graph.nodes() - upper));
/// # Ok::<(), treesynth::guided::GraphError>(())
/// ```
pub trait SizingField: Send + Sync {
    /// The spacing at `point`, metres, unless the graph is asked for a number of nodes: then only ratios count.
    fn at(&self, point: Vec3) -> f32;

    /// Checks that the parameters make sense.
    ///
    /// # Errors
    /// The first parameter out of its range, named `Type.field`.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

macro_rules! forward {
    ($($pointer:ty),*) => {$(
        impl<T: SizingField + ?Sized> SizingField for $pointer {
            fn at(&self, point: Vec3) -> f32 {
                (**self).at(point)
            }
            fn check(&self) -> Result<(), ParameterError> {
                (**self).check()
            }
        }
    )*};
}
forward!(&T, Box<T>, Arc<T>);

/// A closure as a sizing field.
///
/// ```
/// use treesynth::{Shape, glam::Vec3, guided::{SizingField, SizingFn}, shape::Sphere};
///
/// let crown = Sphere::new(Vec3::Y * 5.0, 2.0);
/// let fine_crown = SizingFn::new(move |point| if crown.contains(point) { 0.1 } else { 0.3 });
/// assert_eq!(fine_crown.at(Vec3::ZERO), 0.3);
/// ```
#[derive(Clone, Copy)]
pub struct SizingFn<F> {
    function: F,
}

impl<F: Fn(Vec3) -> f32 + Send + Sync> SizingFn<F> {
    /// The spacing that is `function` of the point (metres).
    pub const fn new(function: F) -> Self {
        Self { function }
    }
}

impl<F> std::fmt::Debug for SizingFn<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SizingFn").finish_non_exhaustive()
    }
}

impl<F: Fn(Vec3) -> f32 + Send + Sync> SizingField for SizingFn<F> {
    fn at(&self, point: Vec3) -> f32 {
        (self.function)(point)
    }
}

/// One spacing at the surface of a shape, another far from it, in proportion to the distance in between.
///
/// A [`Shape`] only tells which points it holds, so its surface is looked for: along the lines of a lattice that reaches
/// `distance` metres beyond the shape's bounds, with 64 cells along each axis. The points found there are passed on from
/// place to place, and distances are to the nearest, linear between the places: right to within a cell. Parts thinner
/// than a cell may be missed. The search takes place once, at the first use, and calls `contains` about 300,000 times.
///
/// ```
/// use treesynth::{glam::Vec3, guided::{NearSurface, SizingField}, shape::Sphere};
///
/// let sizing = NearSurface::new(Sphere::new(Vec3::ZERO, 2.0), 0.1, 0.3, 1.0);
/// let distances = [2.0, 2.5, 1.5, 3.0, 9.0, 0.0];
/// let spacing = distances.map(|x| sizing.at(Vec3::X * x));
/// for (spacing, expected) in spacing.into_iter().zip([0.1, 0.2, 0.2, 0.3, 0.3, 0.3]) {
///     assert!((spacing - expected).abs() < 0.01);
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct NearSurface<S> {
    shape: S,
    at_surface: f32,
    away: f32,
    distance: f32,
    /// Distances from the surface, negative inside; `None` without one.
    #[cfg_attr(feature = "serde", serde(skip))]
    distances: Once<Option<Arc<Scalars>>>,
}

crate::recipe::mapped!(NearSurface { shape; at_surface, away, distance, distances });

/// Cells of the lattice along each axis.
const CELLS: i32 = 64;

impl<S: Shape> NearSurface<S> {
    /// Nodes `at_surface` metres apart at the surface of `shape`, `away` metres apart where it is `distance` metres
    /// off, within or without; all above 0. Either spacing may be the larger one.
    pub fn new(shape: S, at_surface: f32, away: f32, distance: f32) -> Self {
        Self { shape, at_surface, away, distance, distances: Once::default() }
    }

    fn distances(&self) -> Option<&Scalars> {
        self.distances.get_or_init(|| signed_distances(&self.shape, self.distance).map(Arc::new)).as_deref()
    }
}

impl<S: Shape> SizingField for NearSurface<S> {
    fn at(&self, point: Vec3) -> f32 {
        let Some(distances) = self.distances() else { return self.away };
        let share = (distances.at(point).abs() / self.distance).min(1.0);
        self.at_surface + (self.away - self.at_surface) * share
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.shape.check()?;
        for (parameter, value) in [
            ("NearSurface.at_surface", self.at_surface),
            ("NearSurface.away", self.away),
            ("NearSurface.distance", self.distance),
        ] {
            ParameterError::unless(
                value > 0.0 && value.is_finite(),
                parameter,
                value,
                "finite and above 0 m",
            )?;
        }
        let bounds = self.shape.bounds();
        ParameterError::unless(
            self.distances().is_some(),
            "NearSurface.shape",
            bounds,
            "a shape that is thicker than a 64th of its finite bounds",
        )
    }
}

/// Distances from the surface of `shape` on a lattice that reaches `beyond` metres beyond its bounds.
fn signed_distances(shape: &dyn Shape, beyond: f32) -> Option<Scalars> {
    let bounds = shape.bounds().grown(beyond);
    let step = bounds.size() / CELLS as f32;
    if shape.bounds().is_empty() || !step.is_finite() || step.min_element() <= 0.0 {
        return None;
    }
    let dim = CELLS + 1;
    let place = |i: i32| IVec3::new(i % dim, i / dim % dim, i / dim / dim);
    let at = |place: IVec3| bounds.min + place.as_vec3() * step;
    let layer = dim * dim;
    let inside: Vec<bool> = parallel::map(dim as usize, |z| {
        (0..layer).map(|i| shape.contains(at(place(z as i32 * layer + i)))).collect::<Vec<_>>()
    })
    .concat();
    let mut nearest = vec![Vec3::INFINITY; inside.len()];
    let offer = |nearest: &mut Vec<Vec3>, to: usize, point: Vec3| {
        let here = at(place(to as i32));
        if point.distance_squared(here) < nearest[to].distance_squared(here) {
            nearest[to] = point;
        }
    };
    for from in 0..inside.len() {
        for (axis, stride) in [(0, 1), (1, dim), (2, layer)] {
            let to = from + stride as usize;
            if place(from as i32)[axis] + 1 == dim || inside[from] == inside[to] {
                continue;
            }
            let (mut near, mut far) = (at(place(from as i32)), at(place(to as i32)));
            for _ in 0..10 {
                let middle = (near + far) * 0.5;
                if shape.contains(middle) == inside[from] {
                    near = middle;
                } else {
                    far = middle;
                }
            }
            offer(&mut nearest, from, near);
            offer(&mut nearest, to, near);
        }
    }
    // Each place learns the nearest point from the 13 neighbours before it, then from the 13 after it (Danielsson
    // 1980, "Euclidean distance mapping").
    let before: Vec<IVec3> = (0..13).map(|i| IVec3::new(i % 3, i / 3 % 3, i / 9) - 1).collect();
    let mut learn = |to: usize, sign: i32| {
        let centre = place(to as i32);
        let (here, mut best) = (at(centre), nearest[to]);
        for &offset in &before {
            let from = centre + offset * sign;
            if from.cmpge(IVec3::ZERO).all() && from.cmplt(IVec3::splat(dim)).all() {
                let point = nearest[(from.z * layer + from.y * dim + from.x) as usize];
                if point.distance_squared(here) < best.distance_squared(here) {
                    best = point;
                }
            }
        }
        nearest[to] = best;
    };
    (0..inside.len()).for_each(|to| learn(to, 1));
    (0..inside.len()).rev().for_each(|to| learn(to, -1));
    let distance = |(to, point): (usize, &Vec3)| {
        let distance = point.distance(at(place(to as i32)));
        if inside[to] { -distance } else { distance }
    };
    let values: Vec<f32> = nearest.iter().enumerate().map(distance).collect();
    values[0].is_finite().then(|| Scalars::new(bounds.min, step, IVec3::splat(dim), values))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, unit};
    use crate::shape::{Cuboid, Sphere};

    /// Against the distance by hand, at random places in and around the shape.
    fn holds(shape: impl Shape + 'static, distance: impl Fn(Vec3) -> f32) {
        let bounds = shape.bounds();
        let around = bounds.grown(bounds.size().max_element());
        // As far as that the spacing is 1 + distance.
        let beyond = around.size().length();
        let sizing = NearSurface::new(shape, 1.0, 1.0 + beyond, beyond);
        let cell = ((bounds.size() + 2.0 * beyond) / CELLS as f32).max_element();
        for i in 0..20_000 {
            let draw = |axis| unit(1, axis, Purpose::CUSTOM, i);
            let place = around.at(Vec3::new(draw(0), draw(1), draw(2)));
            let off = sizing.at(place) - 1.0 - distance(place);
            assert!(off.abs() < cell, "{place}: {off}, a cell has {cell}");
        }
    }

    #[test]
    fn distances_are_those_to_the_surface() {
        holds(Sphere::new(Vec3::Y, 2.0), |p| (p.distance(Vec3::Y) - 2.0).abs());
        let (min, max) = (Vec3::new(-1.0, 0.0, -3.0), Vec3::new(1.0, 4.0, 3.0));
        holds(Cuboid::new(min, max), |p| {
            let outside = p.clamp(min, max).distance(p);
            if outside > 0.0 { outside } else { (p - min).min(max - p).min_element() }
        });
    }
}
