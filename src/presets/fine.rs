//! Beyond the paper: trees whose twigs grow on finer and finer graphs around the tree so far.

use super::clothed::{finished, leader, twigs};
use super::look::{ASH, LINDEN, OAK};
use super::{Preset, Site, TYPICAL_NODES, degrees};
use crate::guided::{Bend, GraphBuilder, Recipe, Refinement, StageRecipe};
use crate::shape::{Ellipsoid, HalfEllipsoid, Shell};
use glam::Vec3;

pub(super) const PRESETS: &[Preset] = &[
    Preset::new("fine-ash", 0, "The ash of figure 6 (c), refined twice.", |nodes| {
        let site = Site::new(12.0, 12.5, nodes);
        let crown = Ellipsoid::new(Vec3::Y * 6.8, Vec3::new(3.2, 3.0, 3.2));
        let rule = Bend::random(degrees(30.0), degrees(120.0), 0.0, 1);
        fine(site, 0.36, 9.0, site.crown(rule, crown, 70, 3.2))
    })
    .like(ASH),
    Preset::new("fine-elm", 0, "The elm of figure 7, refined twice.", |nodes| {
        let site = Site::new(14.0, 11.5, nodes);
        let crown = HalfEllipsoid::new(Vec3::Y * 4.0, Vec3::new(4.8, 5.5, 4.8));
        fine(site, 0.45, 1.8, site.crown(Bend::from_axis(degrees(16.0)), crown, 50, 1.2))
    }),
    Preset::new("fine-oak", 0, "The oak of figure 20, refined twice.", |nodes| {
        let site = Site::new(14.0, 11.5, nodes);
        let base = Vec3::Y * 4.4;
        let dome = HalfEllipsoid::new(base, Vec3::new(4.6, 5.0, 4.6));
        let shell = Shell::new(dome, 0.35).about(base);
        fine(site, 0.6, 3.2, site.crown(Bend::constant(degrees(2.0)), shell, 70, 2.0))
    })
    .like(OAK),
    Preset::new("fine-linden", 0, "Branches at 60° as in figure 6 (b), refined twice.", |nodes| {
        let site = Site::new(11.0, 12.5, nodes);
        let crown = Ellipsoid::new(Vec3::Y * 6.6, Vec3::new(2.6, 3.6, 2.6));
        let rule = Bend::piecewise(degrees(60.0), 0.0, 1);
        fine(site, 0.36, 9.6, site.crown(rule, crown, 80, 2.4))
    })
    .like(LINDEN),
];

/// A quarter of the nodes for the limbs.
const COARSE: usize = 4;

/// Trunk and limbs on a quarter of the nodes, then twigs at a half and at a quarter of that spacing.
fn fine(site: Site, trunk: f32, height: f32, limbs: StageRecipe) -> Recipe {
    let coarse = Site { nodes: site.nodes / COARSE, ..site }.graph().with_leader(leader(height));
    // An error here is one of `check`, which synthesis reports.
    let spacing = coarse.check().and_then(|()| coarse.spacing()).unwrap_or(f32::NAN);
    // Metres do not depend on the nodes.
    let hop = Site { nodes: TYPICAL_NODES / COARSE, ..site }.graph().spacing().unwrap_or(f32::NAN) * 1.27;
    let finer = |stage: StageRecipe, share: f32| {
        stage.with_refinement(Refinement::new(site.region(), spacing * share).with_reach(8))
    };
    let synth = Recipe::new(coarse)
        .stage(limbs)
        .stage(finer(twigs(4, hop * 2.0, 0.45), 0.5))
        .stage(finer(twigs(4, hop, 0.28), 0.25))
        .stage(twigs(3, hop * 0.75, 0.5));
    finished(synth, trunk)
}
