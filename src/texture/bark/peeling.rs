//! Birch and cherry: skins with lenticels around the branch, that come off in rolls.

use super::cells::{Cells, Dashes};
use super::lanes::{Quad, mix, smooth};
use super::noise::Fractal;
use super::pattern::{Pattern, Recipe, Spot, blend, shade};
use glam::Vec4;

/// White, with dark lenticels; black and cracked in places when old.
#[derive(Debug)]
pub(super) struct Birch {
    recipe: Recipe,
    bands: Fractal,
    streaks: Fractal,
    lenticels: Dashes,
    short: Dashes,
    rolls: Dashes,
    scars: Fractal,
    cracks: Cells,
    fine: Fractal,
}

impl Birch {
    pub(super) fn new(recipe: Recipe) -> Self {
        let seed = recipe.seed;
        Self {
            recipe,
            bands: recipe.noise(1, 2, 16),
            streaks: recipe.fractal(2, 6, 50, 3),
            lenticels: Dashes::new(seed, 10, (5, 44), 0.34, [[0.10, 0.75], [0.07, 0.17]]),
            short: Dashes::new(seed, 20, (16, 70), 0.22, [[0.10, 0.42], [0.08, 0.16]]),
            rolls: Dashes::new(seed, 30, (2, 9), 0.55, [[0.25, 0.85], [0.06, 0.22]]),
            scars: recipe.fractal(40, 4, 4, 4),
            cracks: Cells::new(seed, 50, (22, 9), 0.9, true),
            fine: recipe.fractal(60, 60, 80, 3),
        }
    }
}

impl Pattern for Birch {
    fn plain(&self) -> Vec<&Fractal> {
        vec![&self.bands, &self.streaks, &self.fine, &self.scars]
    }

    #[inline]
    fn at(&self, quad: &Quad<'_>) -> Spot {
        let (x, y) = (quad.x, quad.y);
        let [band, streak, fine, scar] = quad.plain();
        let wave = y + 0.004 * scar + 0.0012 * fine;
        let lenticel = self.lenticels.at(x, wave).max(self.short.at(x, wave) * smooth(-0.2, 0.3, band));
        let roll = self.rolls.at(x + 0.05 * streak, y + 0.010 * scar + 0.005 * fine);
        let Recipe { outer, inner, accent, .. } = self.recipe;
        let white = shade(outer, 1.0 + 0.05 * streak + 0.04 * band + 0.03 * fine);
        // Under a roll the skin is fresh.
        let fresh = smooth(0.1, 1.0, roll) * (0.75 + 0.5 * streak);
        let mut color = blend(white, accent, 0.42 * fresh + 0.16 * smooth(0.2, 0.8, band));
        // A thin dark line where the paper has come off.
        let lifted = smooth(0.0, 0.25, roll) * (1.0 - smooth(0.3, 0.6, roll));
        color = blend(color, inner, 0.16 * lifted);
        color = blend(color, inner, 0.92 * smooth(0.15, 0.6, lenticel));
        let mut height = 0.72 + 0.03 * streak + 0.02 * fine - 0.13 * roll + 0.16 * lifted + 0.14 * lenticel;
        let mut roughness = 0.55 + 0.05 * fine + 0.3 * lenticel;
        // Old bark is black and cracked, in tall patches.
        let rough = smooth(0.0, 0.13, scar + 0.10 * fine - self.recipe.aged(0.85, 0.20));
        if rough.cmpgt(Vec4::ZERO).any() {
            let crack = self.cracks.at(x + 0.01 * scar, y + 0.01 * fine);
            let side = smooth(0.001, 0.011, crack.border + 0.002 * fine);
            let grey =
                blend(inner, shade(outer, Vec4::splat(0.42)), 0.45 * smooth(0.3, 1.0, side) + 0.15 * fine);
            color = blend(color, blend(shade(inner, Vec4::splat(0.6)), grey, side), rough);
            height = mix(height, 0.25 + 0.62 * side + 0.1 * fine, rough);
            roughness = mix(roughness, Vec4::splat(0.95), rough);
        }
        Spot { height, color, roughness }
    }
}

/// Red-brown and glossy, with bands of large lenticels.
#[derive(Debug)]
pub(super) struct Cherry {
    recipe: Recipe,
    bands: Fractal,
    streaks: Fractal,
    lenticels: Dashes,
    short: Dashes,
    rolls: Dashes,
    blotches: Fractal,
    cracks: Cells,
    fine: Fractal,
}

impl Cherry {
    pub(super) fn new(recipe: Recipe) -> Self {
        let seed = recipe.seed;
        Self {
            recipe,
            bands: recipe.noise(1, 2, 12),
            streaks: recipe.fractal(2, 4, 60, 3),
            lenticels: Dashes::new(seed, 10, (5, 22), 0.75, [[0.15, 0.85], [0.09, 0.22]]),
            short: Dashes::new(seed, 20, (14, 50), 0.35, [[0.12, 0.45], [0.12, 0.24]]),
            rolls: Dashes::new(seed, 30, (2, 7), 0.6, [[0.3, 0.9], [0.08, 0.25]]),
            blotches: recipe.fractal(40, 3, 4, 4),
            cracks: Cells::new(seed, 50, (16, 10), 0.9, true),
            fine: recipe.fractal(60, 50, 110, 3),
        }
    }
}

impl Pattern for Cherry {
    fn plain(&self) -> Vec<&Fractal> {
        vec![&self.bands, &self.streaks, &self.fine, &self.blotches]
    }

    #[inline]
    fn at(&self, quad: &Quad<'_>) -> Spot {
        let (x, y) = (quad.x, quad.y);
        let [band, streak, fine, blotch] = quad.plain();
        let wave = y + 0.005 * blotch + 0.0015 * fine;
        let gathered = smooth(-0.25, 0.25, band);
        let lenticel = self.lenticels.at(x, wave) * (0.25 + 0.75 * gathered);
        let lenticel = lenticel.max(self.short.at(x, wave) * smooth(0.0, 0.3, band));
        let roll =
            self.rolls.at(x + 0.05 * streak, y + 0.012 * blotch + 0.004 * fine) * self.recipe.ripe(0.2, 0.7);
        let Recipe { outer, inner, accent, .. } = self.recipe;
        let base = shade(outer, 1.0 + 0.20 * streak + 0.16 * band + 0.15 * blotch);
        let mut color = blend(base, inner, 0.55 * smooth(0.15, 0.65, streak + 0.6 * blotch));
        let lifted = smooth(0.0, 0.2, roll) * (1.0 - smooth(0.25, 0.6, roll));
        color = blend(color, shade(outer, Vec4::splat(1.5)), 0.35 * smooth(0.1, 0.9, roll));
        color = blend(color, inner, 0.25 * lifted);
        // A lenticel is corky, with a dark line around and along it.
        let core = smooth(0.35, 0.75, lenticel);
        color = blend(color, inner, 0.7 * smooth(0.05, 0.3, lenticel));
        color = blend(color, shade(accent, 1.0 + 0.35 * fine), core);
        let mut height = 0.50 + 0.04 * streak + 0.015 * fine + 0.26 * lenticel - 0.10 * roll + 0.15 * lifted;
        let mut roughness = 0.34 + 0.06 * streak + 0.5 * smooth(0.2, 0.6, lenticel) + 0.2 * roll;
        let rough = smooth(0.0, 0.2, blotch + 0.10 * fine - self.recipe.aged(1.1, 0.34));
        if rough.cmpgt(Vec4::ZERO).any() {
            let crack = self.cracks.at(x + 0.01 * blotch, y + 0.01 * fine);
            let side = smooth(0.001, 0.012, crack.border + 0.002 * fine);
            color = blend(
                color,
                blend(shade(inner, Vec4::splat(0.5)), shade(inner, 1.2 + 0.5 * fine), side),
                rough,
            );
            height = mix(height, 0.2 + 0.6 * side + 0.1 * fine, rough);
            roughness = mix(roughness, Vec4::splat(0.9), rough);
        }
        Spot { height, color, roughness: roughness.max(Vec4::splat(0.05)) }
    }
}
