//! Beyond the paper: trees on graphs of varying spacing, fine where the twigs are.

use super::clothed::{finished, leader, twigs};
use super::{Preset, Site, degrees};
use crate::guided::{Bend, GradedYao, NearSurface, Recipe, StageRecipe};
use crate::shape::{Ellipsoid, HalfEllipsoid};
use glam::Vec3;

pub(super) const PRESETS: &[Preset] = &[
    Preset::new("graded-ash", 0, "The ash of figure 6 (c), finest at the crown's surface.", |nodes| {
        let site = Site::new(12.0, 12.5, nodes);
        let crown = Ellipsoid::new(Vec3::Y * 6.8, Vec3::new(3.2, 3.0, 3.2));
        let rule = Bend::random(degrees(30.0), degrees(120.0), 0.0, 1);
        graded(site, 0.36, 9.0, crown, site.crown(rule, crown, 70, 3.2))
    }),
    Preset::new("graded-elm", 0, "The elm of figure 7, finest at the crown's surface.", |nodes| {
        let site = Site::new(14.0, 11.5, nodes);
        let (base, radii) = (Vec3::Y * 4.0, Vec3::new(4.8, 5.5, 4.8));
        let limbs = site.crown(Bend::from_axis(degrees(25.0)), HalfEllipsoid::new(base, radii), 50, 1.2);
        // All of an ellipsoid, for the flat side of a half one has no twigs to be fine for.
        graded(site, 0.45, 1.8, Ellipsoid::new(base, radii), limbs)
    }),
];

/// Three times as fine at the crown's surface as 2.5 m off it.
fn graded(site: Site, trunk: f32, height: f32, crown: Ellipsoid, limbs: StageRecipe) -> Recipe {
    let sizing = NearSurface::new(crown, 1.0, 3.0, 2.5);
    let graph = GradedYao::new(site.region(), sizing).with_nodes(site.nodes).with_leader(leader(height));
    let synth = Recipe::new(graph)
        .stage(limbs)
        .stage(twigs(4, 0.7, 0.45))
        .stage(twigs(4, 0.5, 0.28))
        .stage(twigs(3, 0.35, 0.5));
    finished(synth, trunk)
}
