//! Birch and cherry: skins with lenticels around the branch, that come off in rolls.

use super::cells::{Cells, Dashes};
use super::lanes::{Quad, mix, smooth};
use super::noise::Fractal;
use super::pattern::{Pattern, Recipe, Spot, blend, shade};
use glam::Vec4;

/// White, with dark lenticels; bursts into black diamonds when old.
#[derive(Debug)]
pub(super) struct Birch {
    recipe: Recipe,
    bands: Fractal,
    streaks: Fractal,
    lenticels: Dashes,
    short: Dashes,
    rolls: Dashes,
    scars: Fractal,
    diamonds: Cells,
    cracks: Cells,
    fine: Fractal,
}

impl Birch {
    pub(super) fn new(recipe: Recipe) -> Self {
        let seed = recipe.seed;
        Self {
            recipe,
            bands: recipe.noise(1, 3, 26),
            streaks: recipe.fractal(2, 9, 80, 3),
            lenticels: Dashes::new(seed, 10, (9, 80), 0.26, [[0.10, 0.75], [0.07, 0.17]]),
            short: Dashes::new(seed, 20, (30, 130), 0.20, [[0.10, 0.42], [0.08, 0.18]]),
            rolls: Dashes::new(seed, 30, (4, 17), 0.45, [[0.25, 0.85], [0.05, 0.16]]),
            scars: recipe.fractal(40, 9, 7, 4),
            diamonds: Cells::new(seed, 70, (5, 4), 0.7, true),
            cracks: Cells::new(seed, 50, (52, 17), 0.9, false),
            fine: recipe.fractal(60, 110, 140, 3),
        }
    }

    /// Degree to which the bark has burst: 0 beside the diamonds, 1 within.
    #[inline]
    fn burst(&self, x: Vec4, y: Vec4, [scar, fine]: [Vec4; 2]) -> Vec4 {
        let diamond = self.diamonds.at(x + 0.014 * scar, y + 0.012 * scar);
        let [right, up] = diamond.offset.map(Vec4::abs);
        // Number and size of the bursts grow with age; each is taller than wide, with drawn-out
        // ends along the branch.
        let own = diamond.value + self.recipe.aged(-0.75, 0.0);
        let size = (own - 0.22).max(Vec4::splat(1e-3));
        let inside =
            1.0 - right / (0.085 * size) - (up / (0.135 * size)).sqrt() * 0.5 - 0.5 * up / (0.135 * size);
        let diamond = smooth(-0.06, 0.16, inside + 0.55 * scar + 0.30 * fine);
        Vec4::select(own.cmpgt(Vec4::splat(0.3)), diamond, Vec4::ZERO)
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
        let wave = y + 0.002 * scar + 0.0006 * fine;
        let lenticel = self.lenticels.at(x, wave).max(self.short.at(x, wave) * smooth(-0.2, 0.3, band));
        let roll = self.rolls.at(x + 0.025 * streak, y + 0.005 * scar + 0.0025 * fine);
        let Recipe { outer, inner, accent, .. } = self.recipe;
        let white = shade(outer, 1.0 + 0.07 * streak + 0.06 * band + 0.03 * fine + 0.05 * scar);
        // Under a roll the skin is fresh.
        let fresh = smooth(0.1, 1.0, roll) * (0.75 + 0.5 * streak);
        let mut color = blend(white, accent, 0.42 * fresh + 0.16 * smooth(0.2, 0.8, band));
        // A thin dark line where the paper has come off.
        let lifted = smooth(0.0, 0.25, roll) * (1.0 - smooth(0.3, 0.6, roll));
        color = blend(color, inner, 0.16 * lifted);
        color = blend(color, inner, 0.85 * smooth(0.15, 0.6, lenticel));
        let mut height = 0.72 + 0.03 * streak + 0.02 * fine - 0.13 * roll + 0.16 * lifted + 0.14 * lenticel;
        let mut roughness = 0.55 + 0.05 * fine + 0.3 * lenticel;
        let rough = self.burst(x, y, [scar, fine]);
        if rough.cmpgt(Vec4::ZERO).any() {
            let crack = self.cracks.at(x + 0.006 * scar, y + 0.006 * fine);
            let side = smooth(0.0005, 0.006, crack.border + 0.001 * fine);
            let ridge = blend(
                inner,
                shade(outer, Vec4::splat(0.40)),
                0.40 * side * smooth(0.2, 0.9, crack.value) + 0.10 * fine,
            );
            color = blend(color, blend(shade(inner, Vec4::splat(0.6)), ridge, side), rough);
            height = mix(height, 0.15 + 0.45 * side + 0.3 * crack.value + 0.1 * fine, rough);
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
            bands: recipe.noise(1, 2, 9),
            streaks: recipe.fractal(2, 4, 60, 3),
            lenticels: Dashes::new(seed, 10, (6, 17), 0.72, [[0.20, 0.9], [0.11, 0.24]]),
            short: Dashes::new(seed, 20, (17, 56), 0.22, [[0.15, 0.5], [0.14, 0.28]]),
            rolls: Dashes::new(seed, 30, (2, 7), 0.6, [[0.3, 0.9], [0.10, 0.30]]),
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
        let gathered = smooth(-0.30, 0.05, band);
        let lenticel = self.lenticels.at(x, wave) * gathered;
        let lenticel = lenticel.max(self.short.at(x, wave) * smooth(0.0, 0.3, band));
        let roll =
            self.rolls.at(x + 0.05 * streak, y + 0.012 * blotch + 0.004 * fine) * self.recipe.ripe(0.2, 0.7);
        let Recipe { outer, inner, accent, .. } = self.recipe;
        let base = shade(outer, 1.0 + 0.20 * streak + 0.16 * band + 0.15 * blotch);
        let mut color = blend(base, inner, 0.55 * smooth(0.15, 0.65, streak + 0.6 * blotch));
        // Grey where the outermost skin still holds.
        let gray = shade(blend(accent, base, Vec4::splat(0.35)), Vec4::splat(0.8));
        color = blend(color, gray, 0.28 * smooth(0.0, 0.5, blotch - 0.4 * streak));
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
