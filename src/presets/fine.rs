//! Beyond the paper: trees whose twigs grow on finer and finer graphs around the tree so far.

use super::look::{ASH, LINDEN, OAK};
use super::{Preset, bark, degrees, fork, graph, limbs, region, trunk};
use crate::guided::{
    Bend, Count, GraphBuilder, HopSurface, InShape, PoissonYao, Refinement, Stage, TreeSynth,
};
use crate::shape::{Ellipsoid, HalfEllipsoid, Shell};
use glam::Vec3;

pub(super) const PRESETS: &[Preset] = &[
    Preset::new("fine-ash", 0, "The ash of figure 6 (c), refined twice.", |nodes| {
        let crown = Ellipsoid::new(Vec3::Y * 6.8, Vec3::new(3.2, 3.0, 3.2));
        let rule = Bend::random(degrees(30.0), degrees(120.0), 0.0, 1);
        fine(12.0, 12.5, nodes, 0.36, &[trunk(8.4), limbs(rule, crown, 70)])
    })
    .like(ASH),
    Preset::new("fine-elm", 0, "The elm of figure 7, refined twice.", |nodes| {
        let crown = HalfEllipsoid::new(Vec3::Y * 4.0, Vec3::new(4.8, 5.5, 4.8));
        fine(14.0, 11.5, nodes, 0.45, &[limbs(Bend::from_axis(degrees(25.0)), crown, 50)])
    }),
    Preset::new("fine-oak", 0, "The oak of figure 20, refined twice.", |nodes| {
        let base = Vec3::Y * 4.4;
        let dome = HalfEllipsoid::new(base, Vec3::new(4.6, 5.0, 4.6));
        let shell = Shell::new(dome, 0.35).about(base);
        let limbs = Stage::new(Bend::constant(degrees(3.0)), InShape::poisson_disc(shell, Count::UpTo(70)));
        fine(14.0, 11.5, nodes, 0.6, &[trunk(3.2), limbs])
    })
    .like(OAK),
    Preset::new("fine-linden", 0, "Branches at 60° as in figure 6 (b), refined twice.", |nodes| {
        let crown = Ellipsoid::new(Vec3::Y * 6.6, Vec3::new(2.6, 3.6, 2.6));
        let rule = Bend::piecewise(degrees(60.0), 0.0, 1);
        fine(11.0, 12.5, nodes, 0.36, &[trunk(9.0), limbs(rule, crown, 80)])
    })
    .like(LINDEN),
];

/// Trunk and limbs on a quarter of the nodes, then twigs at a half and at a quarter of that spacing.
fn fine(width: f32, height: f32, nodes: usize, trunk: f32, first: &[Stage]) -> TreeSynth {
    let coarse: PoissonYao = graph(width, height, (nodes / 4).max(200));
    // An error here is one of `check`, which synthesis reports.
    let spacing = coarse.check().and_then(|()| coarse.spacing()).unwrap_or(f32::NAN);
    let twigs = |share: f32, count| {
        let endpoints = HopSurface::new(4, Count::UpTo(count)).with_outermost(0.7);
        Stage::new(fork(), endpoints).with_refinement(Refinement::new(region(width, height), spacing * share))
    };
    first
        .iter()
        .cloned()
        .fold(TreeSynth::new(coarse), TreeSynth::stage)
        .stage(twigs(0.5, 600))
        .stage(twigs(0.25, 3000))
        .stage(Stage::new(fork(), HopSurface::new(3, Count::UpTo(4000)).with_outermost(0.7)))
        .with_radius(bark(trunk))
}
