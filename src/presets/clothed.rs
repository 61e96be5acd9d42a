//! Parts that trees beyond the paper share: straight trunks, limbs with twigs, radii that hold a
//! branch up.

use super::{Site, degrees};
use crate::guided::{
    Apart, Bend, ForkAngle, Guided, Leader, LimbSurface, Recipe, Shedding, StageRecipe, Within,
};
use crate::radius::{PipeModel, Stout, Taper};
use crate::shape::{Cylinder, ShapeRecipe};
use glam::Vec3;

/// Twigs `metres` off the branches, one for every `spacing` metres of each; they leave their parent branch at 50°.
pub(super) fn twigs(hops: u32, metres: f32, spacing: f32) -> StageRecipe {
    let rule = ForkAngle::new(degrees(50.0), Bend::none()).with_spread(degrees(12.0));
    let endpoints = LimbSurface::new(hops, spacing)
        .with_hop_length(metres / hops as f32)
        .with_bare_base(0.2)
        .with_least_order(1);
    StageRecipe::new(rule, endpoints).with_weight(Apart::new(Guided, 0.5))
}

/// A trunk of this height in metres.
pub(super) fn leader(height: f32) -> Leader {
    Leader::new(Vec3::ZERO, Vec3::Y * height)
}

/// Sheds bare whips, and makes the rest thick enough for its length.
pub(super) fn finished(synth: Recipe, trunk: f32) -> Recipe {
    let pipes = PipeModel::default().with_exponent(2.4).with_trunk_diameter(trunk);
    synth
        .with_shedding(Shedding::new().with_bare_end(0.9))
        .with_radius(Stout::new(Taper::new(pipes), 1.0 / 80.0))
}

impl Site {
    /// Limbs by a rule of hops in the typical graph here, to endpoints in a crown; none leaves the trunk below `bole`
    /// metres.
    pub(super) fn crown(
        self,
        rule: Bend,
        crown: impl Into<ShapeRecipe>,
        count: usize,
        bole: f32,
    ) -> StageRecipe {
        let clear = Cylinder::new(Vec3::ZERO, self.width, bole);
        self.limbs(rule, crown, count).with_weight(Within::obstacle(Apart::new(Guided, 0.25), clear))
    }
}
