//! Site of a figure's tree, and the length of a hop there.

use super::{TYPICAL_NODES, bark, fork};
use crate::guided::{Bend, Count, HopSurface, InShape, PoissonYao, Recipe, StageRecipe};
use crate::shape::{Cuboid, ShapeRecipe};
use glam::Vec3;

/// A box on the ground, metres, to be filled with about this number of nodes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Site {
    pub(super) width: f32,
    pub(super) height: f32,
    pub(super) nodes: usize,
}

/// Metres of path of an edge, in spacings.
const EDGE: f32 = 1.27;

impl Site {
    pub(super) fn new(width: f32, height: f32, nodes: usize) -> Self {
        Self { width, height, nodes }
    }

    pub(super) fn region(self) -> Cuboid {
        let half = self.width * 0.5;
        Cuboid::new(Vec3::new(-half, 0.0, -half), Vec3::new(half, self.height, half))
    }

    pub(super) fn graph(self) -> PoissonYao<Cuboid> {
        PoissonYao::new(self.region()).with_nodes(self.nodes)
    }

    /// The spacing of a typical graph here, metres.
    pub(super) fn spacing(self) -> f32 {
        // The region is sound, so there is no error.
        Self { nodes: TYPICAL_NODES, ..self }.graph().spacing().unwrap_or(f32::NAN)
    }

    /// Metres of a hop in a typical graph: the figures' angles and surfaces are counted in these.
    pub(super) fn hop(self) -> f32 {
        self.spacing() * EDGE
    }

    pub(super) fn by_length(self, rule: Bend) -> Bend {
        rule.with_hop_length(self.hop())
    }

    /// At most `count` endpoints `hops` hops off the tree, in the outermost 60% of that surface.
    pub(super) fn surface(self, hops: u32, count: usize) -> HopSurface {
        HopSurface::new(hops, Count::UpTo(count)).with_hop_length(self.hop())
    }

    /// No stages yet; radii for a trunk of this diameter in metres.
    pub(super) fn tree(self, trunk: f32) -> Recipe {
        Recipe::new(self.graph()).with_radius(bark(trunk))
    }

    /// Branches to endpoints spread in a crown.
    pub(super) fn limbs(self, rule: Bend, crown: impl Into<ShapeRecipe>, count: usize) -> StageRecipe {
        StageRecipe::new(
            self.by_length(rule),
            InShape::<ShapeRecipe>::poisson_disc(crown.into(), Count::UpTo(count)),
        )
    }

    /// Twigs to endpoints on a surface.
    pub(super) fn twigs(self, hops: u32, count: usize) -> StageRecipe {
        StageRecipe::new(fork(), self.surface(hops, count))
    }

    pub(super) fn outer_twigs(self, hops: u32, count: usize, outermost: f32) -> StageRecipe {
        StageRecipe::new(fork(), self.surface(hops, count).with_outermost(outermost))
    }
}
