//! Colours of the bark along a tree: old on the trunk, young on the twigs, weathered where it is dead.

use super::specimen::Specimen;
use crate::math;

/// Height of the dark base of a trunk, in its diameters.
const FOOT: f32 = 3.0;

/// Wood where it has just broken, and after years in the weather, sRGB.
pub(super) const FRESH: [f32; 3] = [204.0, 172.0, 124.0];
pub(super) const WEATHERED: [f32; 3] = [150.0, 144.0, 134.0];

/// The linear colours that one tree's bark is mixed of.
pub(super) struct BarkColors<'a> {
    specimen: &'a Specimen,
    trunk: [f32; 3],
    limbs: [f32; 3],
    twigs: [f32; 3],
    foot: [f32; 3],
    gray: [f32; 3],
    wood: [f32; 3],
    years_dead: f32,
}

impl<'a> BarkColors<'a> {
    pub(super) fn new(specimen: &'a Specimen) -> Self {
        let (bark, numbers) = (&specimen.species.bark, &specimen.numbers);
        let [trunk, limbs, twigs] = [bark.trunk, bark.limbs, bark.twigs].map(linear);
        // Old trunks are rough and dark at the base.
        let foot = if bark.foot.iter().any(|&channel| channel > 0.0) { linear(bark.foot) } else { trunk };
        // Dead bark fades; wood is yellow when it breaks, and gray after years.
        let years_dead = numbers.dead.unwrap_or(0.0);
        let gray = linear(WEATHERED);
        let wood = mix(linear(FRESH), gray, (years_dead / 6.0).min(1.0));
        let wood = if numbers.dead.is_none() && numbers.damage <= 0.0 { gray } else { wood };
        Self { specimen, trunk, limbs, twigs, foot, gray, wood, years_dead }
    }

    /// Around a node's internode, by its radius, at a height above the ground.
    pub(super) fn at(&self, node: usize, height: f32) -> [f32; 3] {
        let Specimen { skeleton, numbers, bare, .. } = self.specimen;
        // Roots wear the bark of the trunk's base.
        let node = if node < skeleton.len() { node } else { 0 };
        let (half, radius) = (0.5 * numbers.dbh, skeleton.radii()[node]);
        let old = smooth((radius / half - 0.45) / 0.35);
        let low = 1.0 - smooth(height / (FOOT * numbers.dbh).max(0.01));
        let low = low * smooth((numbers.dbh - 0.08) / 0.2);
        let trunk = mix(self.trunk, self.foot, low);
        let young = 1.0 - smooth((radius - 0.004) / (0.1 * half).clamp(0.004, 0.02));
        let bark = mix(mix(self.limbs, trunk, old), self.twigs, young);
        let faded = mix(bark, self.gray, 0.45 * (self.years_dead / 15.0).min(1.0));
        mix(faded, self.wood, bare.get(node).copied().unwrap_or(0.0))
    }
}

/// 0 at 0 and below, 1 at 1 and above, smooth between.
fn smooth(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn mix(a: [f32; 3], b: [f32; 3], t: f32) -> [f32; 3] {
    [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * t)
}

/// From sRGB channels of 0 to 255.
pub(super) fn linear(encoded: [f32; 3]) -> [f32; 3] {
    encoded.map(|channel| math::linear(channel / 255.0))
}
