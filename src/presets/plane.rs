//! Figures 2 and 3: the method in the plane.

use super::{Preset, bark, degrees};
use crate::guided::{
    Bend, Count, Guided, InShape, Length, NearestTo, PoissonDelaunay, Recipe, StageRecipe, WeightRecipe,
};
use crate::shape::Cuboid;
use glam::Vec3;

pub(super) const PRESETS: &[Preset] = &[
    Preset::new(
        "figure-02-unguided",
        2,
        "One path by plain length: crooked, and straight towards its end.",
        |nodes| path(nodes, Length),
    )
    .planar(),
    Preset::new(
        "figure-02-guided",
        2,
        "The same with guiding vectors: upwards at first, then over.",
        |nodes| path(nodes, Guided),
    )
    .planar(),
    Preset::new("figure-03", 3, "Two iterations in the plane, with the guiding vectors.", two_iterations)
        .partial(1)
        .planar(),
];

/// The plane x in [-5, 5], y in [0, 10] metres, and no edges that cross. A fortieth of the nodes of a solid graph is as
/// fine as figure 3.
fn plane(nodes: usize) -> PoissonDelaunay<Cuboid> {
    let region = Cuboid::new(Vec3::new(-5.0, 0.0, -1.0), Vec3::new(5.0, 10.0, 1.0));
    PoissonDelaunay::new(region).with_nodes((nodes / 40).max(400))
}

fn path(nodes: usize, weight: impl Into<WeightRecipe>) -> Recipe {
    let to = NearestTo::new(Vec3::new(4.0, 6.5, 0.0));
    Recipe::new(plane(nodes))
        .stage(StageRecipe::new(Bend::constant(degrees(2.0)), to).with_weight(weight))
        .with_radius(bark(0.1))
}

fn two_iterations(nodes: usize) -> Recipe {
    let crown = Cuboid::new(Vec3::new(-4.0, 5.0, -1.0), Vec3::new(4.0, 9.0, 1.0));
    let around = Cuboid::new(Vec3::new(-4.6, 3.0, -1.0), Vec3::new(4.6, 9.6, 1.0));
    Recipe::new(plane(nodes))
        .stage(StageRecipe::new(Bend::constant(degrees(4.0)), InShape::poisson_disc(crown, Count::UpTo(8))))
        .stage(StageRecipe::new(
            Bend::piecewise(degrees(30.0), 0.0, 1),
            InShape::poisson_disc(around, Count::UpTo(45)),
        ))
        .with_radius(bark(0.25))
}
