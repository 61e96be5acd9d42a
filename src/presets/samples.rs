//! Figures 1 and 4: results of the method, and its steps.

use super::look::{ASH, LINDEN, POPLAR};
use super::{Preset, Site, degrees, rotation, trunk, variety};
use crate::guided::{Bend, Recipe};
use crate::shape::Ellipsoid;
use glam::Vec3;

/// "Sample tree models synthesized using our method": three species of later figures, grown from other seeds.
pub(super) const SAMPLES: &[Preset] = &[
    Preset::new("figure-01a", 1, "A sample tree: the elm of figure 7.", rotation::elm).seed(101),
    Preset::new("figure-01b", 1, "A sample tree: the ash of figure 6 (c).", rotation::ash)
        .seed(102)
        .like(ASH),
    Preset::new("figure-01c", 1, "A sample tree: the cottonwood of figure 17 (d).", variety::cottonwood)
        .seed(103)
        .like(POPLAR),
];

pub(super) const ITERATIONS: &[Preset] = &[Preset::new(
    "figure-04",
    4,
    "Four iterations: a trunk, limbs in a crown, branches, twigs.",
    four_iterations,
)
.like(LINDEN)];

fn four_iterations(nodes: usize) -> Recipe {
    let crown = Ellipsoid::new(Vec3::Y * 6.6, Vec3::new(3.4, 3.1, 3.4));
    let site = Site::new(12.5, 12.0, nodes);
    site.tree(0.4)
        .stage(trunk(8.2))
        .stage(site.limbs(Bend::piecewise(degrees(45.0), degrees(1.0), 1), crown, 50))
        .stage(site.twigs(3, 450))
        .stage(site.twigs(2, 3000))
}
