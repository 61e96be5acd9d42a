//! Figures 5 to 8: rotation of guiding vectors.

use super::look::{ASH, CHESTNUT, HAZEL, LINDEN, MAPLE, POPLAR};
use super::{Preset, Site, degrees, trunk};
use crate::field::{FieldRecipe, Helix, Rotation, SphericalMeridians};
use crate::guided::{Bend, Count, FollowField, InShape, Recipe, StageRecipe};
use crate::shape::{Ellipsoid, HalfEllipsoid, Shell};
use glam::Vec3;

pub(super) const PRESETS: &[Preset] = &[
    Preset::new("figure-05-left", 5, "α = 4° at every hop: branches arch over.", |nodes| {
        shrub(nodes, Bend::constant(degrees(4.0)))
    })
    .partial(1)
    .like(HAZEL),
    Preset::new(
        "figure-05-right",
        5,
        "α1 = 6°, α2 = -6°, h0 = 20: out and down, then up again.",
        |nodes| shrub(nodes, Bend::piecewise(degrees(6.0), degrees(-6.0), 20)),
    )
    .partial(1)
    .like(HAZEL),
    Preset::new("figure-06a", 6, "α = 10°: branches curve strongly downward.", |nodes| {
        round_tree(nodes, Bend::constant(degrees(10.0)))
    })
    .partial(2)
    .like(LINDEN),
    Preset::new(
        "figure-06b",
        6,
        "α1 = 60°, α2 = 0, h0 = 1: a fixed upward angle, then straight.",
        |nodes| round_tree(nodes, Bend::piecewise(degrees(60.0), 0.0, 1)),
    )
    .partial(2)
    .like(MAPLE),
    Preset::new("figure-06c", 6, "α1 random in 30° to 120° for each trunk node, α2 = 0, h0 = 1.", ash)
        .partial(2)
        .like(ASH),
    Preset::new("figure-06d", 6, "α1 = 15°, α2 = -5°, h0 = 5: out, then bending up.", |nodes| {
        round_tree(nodes, Bend::piecewise(degrees(15.0), degrees(-5.0), 5))
    })
    .partial(2)
    .like(CHESTNUT),
    Preset::new("figure-07", 7, "Equation 2 with θ = 25°: an elm.", elm).partial(1),
    Preset::new("figure-08a", 8, "A helical field: branches wind about the axis.", |nodes| {
        field_tree(nodes, 0.0, Helix::with_angle(Vec3::ZERO, degrees(40.0)))
    })
    .like(HAZEL),
    Preset::new(
        "figure-08b",
        8,
        "A rotation about a horizontal axis: everything sweeps to one side.",
        |nodes| field_tree(nodes, 1.5, Rotation::new(Vec3::new(7.0, 0.0, 0.0), Vec3::NEG_Z)),
    )
    .like(POPLAR),
    Preset::new("figure-08c", 8, "Upward along spheres: out, around and in again.", |nodes| {
        field_tree(nodes, 0.0, SphericalMeridians::new(Vec3::Y * 5.0))
    }),
];

/// Many endpoints in the first iteration: no trunk.
fn shrub(nodes: usize, first: Bend) -> Recipe {
    let site = Site::new(15.0, 11.0, nodes);
    let crown = Shell::new(HalfEllipsoid::new(Vec3::Y * 3.0, Vec3::new(5.0, 6.0, 5.0)), 0.6);
    site.tree(0.45)
        .stage(site.limbs(first, crown, 40))
        .stage(site.twigs(3, 300))
        .stage(site.twigs(2, 1500))
        .stage(site.twigs(2, 4000))
}

/// Figure 6: one trunk, a round crown, five iterations; only the second's rule differs.
fn round_tree(nodes: usize, second: Bend) -> Recipe {
    let site = Site::new(12.0, 12.5, nodes);
    let crown = Ellipsoid::new(Vec3::Y * 6.8, Vec3::new(3.2, 3.0, 3.2));
    site.tree(0.36)
        .stage(trunk(8.4))
        .stage(site.limbs(second, crown, 90))
        .stage(site.twigs(2, 500))
        .stage(site.twigs(2, 2000))
        .stage(site.twigs(1, 3500))
}

/// The ash of figure 6 (c) and of all of figure 15.
pub(super) fn ash(nodes: usize) -> Recipe {
    round_tree(nodes, Bend::random(degrees(30.0), degrees(120.0), 0.0, 1))
}

pub(super) fn elm(nodes: usize) -> Recipe {
    let site = Site::new(14.0, 11.5, nodes);
    let crown = HalfEllipsoid::new(Vec3::Y * 4.0, Vec3::new(4.8, 5.5, 4.8));
    site.tree(0.45)
        .stage(site.limbs(Bend::from_axis(degrees(25.0)), crown, 60))
        .stage(site.twigs(3, 400))
        .stage(site.twigs(2, 1800))
        .stage(site.twigs(2, 4000))
}

/// All four iterations follow the field. The crown's centre is `aside` metres off the root.
fn field_tree(nodes: usize, aside: f32, field: impl Into<FieldRecipe>) -> Recipe {
    let crown = Ellipsoid::new(Vec3::new(aside, 5.8, 0.0), Vec3::new(3.8, 3.6, 3.8));
    let rule: FollowField<FieldRecipe> = FollowField::new(field.into());
    let site = Site::new(13.0, 11.5, nodes);
    site.tree(0.4)
        .stage(StageRecipe::new(rule.clone(), InShape::poisson_disc(crown, Count::UpTo(45))))
        .stage(StageRecipe::new(rule.clone(), site.surface(3, 400)))
        .stage(StageRecipe::new(rule.clone(), site.surface(2, 1500)))
        .stage(StageRecipe::new(rule, site.surface(2, 4000)))
}
