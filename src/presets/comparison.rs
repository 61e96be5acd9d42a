//! Figures 18 to 20: trees of earlier methods, made with this one.

use super::look::{LINDEN, MAPLE, OAK};
use super::{Preset, Site, degrees, trunk};
use crate::guided::{Bend, Recipe};
use crate::shape::{Cuboid, HalfEllipsoid, Shell};
use glam::Vec3;

pub(super) const PRESETS: &[Preset] = &[
    Preset::new(
        "figure-18",
        18,
        "After a tree by particle tracing: straight branches in all directions.",
        particles,
    )
    .like(MAPLE),
    Preset::new(
        "figure-19",
        19,
        "After a self-organizing tree: branches that bend up slightly.",
        self_organizing,
    )
    .like(LINDEN),
    Preset::new("figure-20", 20, "After the oak of iterated graphs: a crown in a shell.", oak).like(OAK),
];

/// "Second-iteration endpoints in a cubic volume, α1 a random value in the range (30°, 120°), h0 = 1 and α2 = 0; in
/// the remaining iterations (3-5), α1 = 30°, α2 = 0 and h0 = 1."
fn particles(nodes: usize) -> Recipe {
    let site = Site::new(12.0, 12.5, nodes);
    let cube = Cuboid::centered(Vec3::Y * 6.6, Vec3::splat(5.8));
    site.tree(0.4)
        .stage(trunk(8.2))
        .stage(site.limbs(Bend::random(degrees(30.0), degrees(120.0), 0.0, 1), cube, 130))
        .stage(site.twigs(2, 700))
        .stage(site.twigs(2, 2200))
        .stage(site.twigs(1, 3500))
}

/// "A half-ellipsoid as the bounding volume, and branches that slightly bend up, akin to figure 6 (d)."
fn self_organizing(nodes: usize) -> Recipe {
    let site = Site::new(12.0, 12.5, nodes);
    let crown = HalfEllipsoid::new(Vec3::Y * 5.4, Vec3::new(3.3, 4.7, 3.3));
    site.tree(0.36)
        .stage(trunk(8.4))
        .stage(site.limbs(Bend::piecewise(degrees(15.0), degrees(-5.0), 5), crown, 110))
        .stage(site.twigs(2, 600))
        .stage(site.twigs(2, 2200))
        .stage(site.twigs(1, 3500))
}

/// "A half-ellipsoid shell for the second-iteration endpoints, and a small rotation angle."
fn oak(nodes: usize) -> Recipe {
    let site = Site::new(14.0, 11.0, nodes);
    let base = Vec3::Y * 4.4;
    let dome = HalfEllipsoid::new(base, Vec3::new(4.6, 5.0, 4.6));
    site.tree(0.6)
        .stage(trunk(3.2))
        .stage(site.limbs(Bend::constant(degrees(3.0)), Shell::new(dome, 0.35).about(base), 90))
        .stage(site.twigs(3, 500))
        .stage(site.twigs(2, 2200))
        .stage(site.twigs(1, 3500))
}
