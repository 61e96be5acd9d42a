//! Beyond the paper: trees on graphs of varying spacing, fine where the twigs are.

use super::{Preset, bark, degrees, fork, limbs, region, trunk};
use crate::guided::{Bend, Count, GradedYao, HopSurface, NearSurface, Stage, TreeSynth};
use crate::shape::{Ellipsoid, HalfEllipsoid};
use glam::Vec3;

pub(super) const PRESETS: &[Preset] = &[
    Preset::new("graded-ash", 0, "The ash of figure 6 (c), finest at the crown's surface.", |nodes| {
        let crown = Ellipsoid::new(Vec3::Y * 6.8, Vec3::new(3.2, 3.0, 3.2));
        let rule = Bend::random(degrees(30.0), degrees(120.0), 0.0, 1);
        graded(12.0, 12.5, nodes, 0.36, crown, &[trunk(8.4), limbs(rule, crown, 70)])
    }),
    Preset::new("graded-elm", 0, "The elm of figure 7, finest at the crown's surface.", |nodes| {
        let (base, radii) = (Vec3::Y * 4.0, Vec3::new(4.8, 5.5, 4.8));
        let limbs = limbs(Bend::from_axis(degrees(25.0)), HalfEllipsoid::new(base, radii), 50);
        // All of an ellipsoid, for the flat side of a half one has no twigs to be fine for.
        graded(14.0, 11.5, nodes, 0.45, Ellipsoid::new(base, radii), &[limbs])
    }),
];

/// Three times as fine at the crown's surface as 2.5 m off it.
fn graded(width: f32, height: f32, nodes: usize, trunk: f32, crown: Ellipsoid, first: &[Stage]) -> TreeSynth {
    let sizing = NearSurface::new(crown, 1.0, 3.0, 2.5);
    // Four hops of a coarse graph would lead out of the region.
    let hops = if nodes < 20_000 { 2 } else { 4 };
    let twigs =
        |hops, count| Stage::new(fork(), HopSurface::new(hops, Count::UpTo(count)).with_outermost(0.7));
    first
        .iter()
        .cloned()
        .fold(
            TreeSynth::new(GradedYao::new(region(width, height), sizing).with_nodes(nodes)),
            TreeSynth::stage,
        )
        .stage(twigs(hops, 600))
        .stage(twigs(hops, 2500))
        .stage(twigs(hops.min(3), 4000))
        .with_radius(bark(trunk))
}
