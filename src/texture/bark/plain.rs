//! Beech, cedar and palm: a smooth skin, fibres, and rings.

use super::cells::{Cells, Dashes};
use super::lanes::{Quad, floor, fraction, indices, mix, smooth};
use super::noise::{Fractal, Seed};
use super::pattern::{Pattern, Recipe, Spot, blend, shade};
use glam::Vec4;

/// Smooth all its life: blotches of grey, faint wrinkles around the branch.
#[derive(Debug)]
pub(super) struct Beech {
    recipe: Recipe,
    blotches: Fractal,
    lichen: Fractal,
    wrinkles: Fractal,
    folds: Fractal,
    dots: Dashes,
    fine: Fractal,
}

impl Beech {
    pub(super) fn new(recipe: Recipe) -> Self {
        Self {
            recipe,
            blotches: recipe.fractal(1, 4, 5, 4),
            lichen: recipe.fractal(10, 6, 6, 4),
            wrinkles: recipe.fractal(20, 5, 34, 3),
            folds: recipe.noise(30, 3, 8),
            dots: Dashes::new(recipe.seed, 40, (24, 40), 0.20, [[0.06, 0.2], [0.06, 0.14]]),
            fine: recipe.fractal(50, 80, 80, 3),
        }
    }
}

impl Pattern for Beech {
    fn plain(&self) -> Vec<&Fractal> {
        vec![&self.blotches, &self.lichen, &self.folds, &self.fine]
    }

    #[inline]
    fn at(&self, quad: &Quad<'_>) -> Spot {
        let (x, y) = (quad.x, quad.y);
        let [blotch, lichen, fold, fine] = quad.plain();
        let wrinkle = self.wrinkles.at(x, y + 0.006 * blotch);
        let dot = self.dots.at(x, y);
        let Recipe { outer, inner, accent, .. } = self.recipe;
        let crease = smooth(0.28, 0.55, wrinkle)
            * smooth(-0.1, 0.35, fold + 0.3 * blotch)
            * self.recipe.aged(0.35, 1.0);
        let mut color = shade(outer, 1.0 + 0.16 * blotch + 0.05 * wrinkle + 0.05 * fine);
        color = blend(color, inner, 0.45 * smooth(0.02, 0.42, blotch + 0.25 * lichen + 0.06 * fine));
        color = blend(
            color,
            accent,
            0.55 * smooth(0.16, 0.40, lichen + 0.10 * fine) * self.recipe.aged(0.5, 1.0),
        );
        color = blend(color, shade(inner, Vec4::splat(0.6)), 0.42 * crease + 0.4 * dot);
        Spot {
            height: 0.62 + 0.08 * fold + 0.05 * blotch - 0.30 * crease + 0.05 * fine + 0.14 * dot,
            color,
            roughness: 0.66 + 0.1 * lichen + 0.08 * fine,
        }
    }
}

/// Long strips of fibres.
#[derive(Debug)]
pub(super) struct Cedar {
    recipe: Recipe,
    sway: Fractal,
    waver: Fractal,
    strips: Cells,
    shreds: Cells,
    fibres: Fractal,
    threads: Fractal,
    blotches: Fractal,
}

impl Cedar {
    pub(super) fn new(recipe: Recipe) -> Self {
        Self {
            recipe,
            sway: recipe.noise(1, 4, 2),
            waver: recipe.noise(2, 14, 4),
            strips: Cells::new(recipe.seed, 10, (16, 2), 0.9, true),
            shreds: Cells::new(recipe.seed, 20, (38, 4), 0.95, true),
            fibres: recipe.fractal(30, 70, 5, 3),
            threads: recipe.noise(40, 200, 9),
            blotches: recipe.fractal(50, 5, 3, 3),
        }
    }
}

impl Pattern for Cedar {
    fn plain(&self) -> Vec<&Fractal> {
        vec![&self.sway, &self.waver, &self.blotches]
    }

    #[inline]
    fn at(&self, quad: &Quad<'_>) -> Spot {
        let (x, y) = (quad.x, quad.y);
        let [sway, waver, blotch] = quad.plain();
        let u = x + 0.026 * sway + 0.007 * waver;
        let v = y + 0.05 * waver;
        let (strip, shred) = (self.strips.at(u, v), self.shreds.at(u, v));
        let (fibre, thread) = (self.fibres.at(u, y), self.threads.at(u, y));
        let gap = self.recipe.aged(0.003, 0.0085);
        // Fibres tear along themselves, not across.
        let side = smooth(
            0.0,
            1.3,
            (strip.border + 0.0022 * fibre) / (gap * (1.0 - strip.across).max(Vec4::splat(0.05))),
        );
        let side = mix(side, Vec4::ONE, 0.6 * smooth(0.55, 0.9, strip.edge));
        let torn = smooth(0.0, 0.004, shred.border + 0.001 * fibre);
        let torn = mix(torn, Vec4::ONE, smooth(0.1, 0.6, shred.across));
        // Strips lift along one side, and lie over the next one.
        let turn = Vec4::select(strip.value.cmpgt(Vec4::splat(0.5)), Vec4::ONE, Vec4::NEG_ONE);
        let tilt = (strip.offset[0] * 15.0 * turn).clamp(Vec4::NEG_ONE, Vec4::ONE);
        let height = side * (0.52 + 0.16 * tilt + 0.16 * (shred.value - 0.5) + 0.12 * torn)
            + (0.20 * fibre + 0.08 * thread) * (0.4 + 0.6 * side);
        let Recipe { outer, inner, accent, .. } = self.recipe;
        let top = blend(outer, accent, smooth(0.2, 0.8, shred.value + 0.5 * blotch));
        let tone = 1.0 + 0.42 * fibre + 0.16 * thread + 0.3 * (strip.value - 0.5) + 0.2 * blotch;
        let light = smooth(-0.05, 0.66, height) * (0.75 + 0.25 * torn);
        let old = Vec4::splat(self.recipe.ripe(-0.3, 0.5));
        Spot {
            height: mix(0.6 + 0.1 * fibre, 0.10 + 0.82 * height, old),
            color: blend(inner, shade(top, tone), mix(Vec4::ONE, light, old)),
            roughness: 0.95 - 0.10 * side,
        }
    }
}

/// Rings: each is the scar of a leaf.
#[derive(Debug)]
pub(super) struct Palm {
    recipe: Recipe,
    rings: u32,
    sway: Fractal,
    spacing: Vec<f32>,
    tones: Vec<f32>,
    fibres: Fractal,
    cracks: Cells,
    blotches: Fractal,
}

impl Palm {
    pub(super) fn new(recipe: Recipe) -> Self {
        let rings = 9u32;
        let draw = |salt| (0..rings as usize).map(|i| Seed::unit(recipe.seed, salt, i)).collect();
        Self {
            recipe,
            rings,
            sway: recipe.noise(1, 3, 9),
            spacing: draw(70),
            tones: draw(71),
            fibres: recipe.fractal(10, 60, 14, 3),
            cracks: Cells::new(recipe.seed, 20, (26, 5), 0.95, true),
            blotches: recipe.fractal(40, 5, 4, 4),
        }
    }

    /// The tone of the ring at a height in rings, and how far up it is, 0 to 1: rings begin up to a third of their height late.
    #[inline]
    fn ring(&self, height: Vec4) -> (Vec4, Vec4) {
        let count = self.rings as f32;
        // Heights begin below zero; whole tiles do not matter.
        let lattice = floor(height + 64.0 * count);
        let above = height - (lattice - 64.0 * count);
        let here = indices(lattice).map(|i| i % self.rings as usize);
        let around = |table: &[f32], step: usize| {
            Vec4::from_array(here.map(|i| table[(i + self.rings as usize + step - 1) % self.rings as usize]))
        };
        let [below, start, next] = [0, 1, 2].map(|step| 0.36 * around(&self.spacing, step));
        let begun = above.cmpge(start);
        let up = Vec4::select(
            begun,
            (above - start) / (1.0 + next - start),
            (above + 1.0 - below) / (1.0 + start - below),
        );
        (Vec4::select(begun, around(&self.tones, 1), around(&self.tones, 0)), up)
    }
}

impl Pattern for Palm {
    fn plain(&self) -> Vec<&Fractal> {
        vec![&self.sway, &self.fibres, &self.blotches]
    }

    #[inline]
    fn at(&self, quad: &Quad<'_>) -> Spot {
        let (x, y) = (quad.x, quad.y);
        let [sway, fibre, blotch] = quad.plain();
        let (tone, up) = self.ring(self.rings as f32 * y + 0.13 * sway + 0.02 * fibre + 0.05 * blotch);
        // v grows up the branch: the scar's sharp lip is its upper edge, a groove follows.
        let lip = smooth(0.55, 0.84, up) * (1.0 - smooth(0.90, 1.0, up));
        let groove = smooth(0.90, 0.99, up + 0.02 * fibre) + (1.0 - smooth(0.0, 0.09, up + 0.03 * fibre));
        let crack = self.cracks.at(x + 0.008 * fibre, y + 0.02 * blotch);
        let split = (1.0 - smooth(0.0008, 0.005, crack.border))
            * (1.0 - crack.across)
            * smooth(0.35, 0.6, crack.edge)
            * self.recipe.aged(0.25, 1.0);
        let height = 0.50 + 0.10 * up + 0.34 * lip - 0.42 * groove - 0.26 * split
            + 0.10 * fibre
            + 0.10 * (tone - 0.5)
            + 0.05 * blotch;
        let Recipe { outer, inner, accent, .. } = self.recipe;
        let color = shade(outer, 1.0 + 0.26 * fibre + 0.22 * blotch + 0.35 * (tone - 0.5));
        let color = blend(color, accent, 0.65 * lip + 0.18 * fraction(tone * 7.0) * (1.0 - lip));
        let dark = ((0.55 + 0.25 * tone + 0.4 * fibre) * groove + 0.7 * split).clamp(Vec4::ZERO, Vec4::ONE);
        Spot { height, color: blend(color, inner, dark), roughness: 0.88 + 0.06 * fibre }
    }
}
