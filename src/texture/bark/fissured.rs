//! Oak and ash: ridges along the branch, and what separates them.

use super::cells::Cells;
use super::lanes::{Quad, fraction, smooth, smooth_between};
use super::noise::Fractal;
use super::pattern::{Pattern, Recipe, Skin, Spot, blend, shade};
use glam::Vec4;

/// Long ridges that split and join, broken crosswise.
#[derive(Debug)]
pub(super) struct Oak {
    recipe: Recipe,
    skin: Skin,
    sway: Fractal,
    waver: Fractal,
    ridges: Cells,
    breaks: Cells,
    rough: Fractal,
    fine: Fractal,
}

impl Oak {
    pub(super) fn new(recipe: Recipe) -> Self {
        Self {
            recipe,
            skin: Skin::new(&recipe, recipe.ripe(0.0, 0.5)),
            sway: recipe.noise(1, 5, 3),
            waver: recipe.noise(2, 15, 8),
            ridges: Cells::new(recipe.seed, 10, (17, 4), 0.85, true),
            breaks: Cells::new(recipe.seed, 20, (22, 19), 0.9, false),
            rough: recipe.fractal(30, 22, 11, 3),
            fine: recipe.fractal(40, 90, 45, 3),
        }
    }
}

impl Pattern for Oak {
    fn plain(&self) -> Vec<&Fractal> {
        self.skin.behind(vec![&self.sway, &self.waver, &self.rough, &self.fine])
    }

    #[inline]
    fn at(&self, quad: &Quad<'_>) -> Spot {
        let (x, y) = (quad.x, quad.y);
        let [sway, waver, rough, fine] = quad.plain();
        let u = x + 0.026 * sway + 0.0095 * waver + 0.007 * rough + 0.0022 * fine;
        let v = y + 0.03 * waver + 0.03 * rough;
        let ridge = self.ridges.at(u, v);
        // Some fissures are deep, some hardly begun: there ridges join. Those across the branch are the shallowest.
        let open = smooth(0.10, 0.5, ridge.edge + 0.3 * rough) * (1.0 - 0.65 * ridge.across);
        let wide = self.recipe.aged(0.007, 0.0155) * (1.0 + 0.3 * sway) * (0.5 + 0.5 * open);
        let side = smooth(0.0, 1.45, (ridge.border + 0.0030 * rough + 0.0014 * fine) / wide);
        let round = (ridge.border * 34.0).min(Vec4::ONE);
        let crown = 0.60 + 0.40 * round * (2.0 - round);
        let depth = 0.38 + 0.62 * open;
        let mut height = crown * (1.0 - depth * (1.0 - side));
        // Breaks across the ridges.
        let crack = self.breaks.at(u + 0.016 * rough, v + 0.010 * fine);
        let broken = (1.0 - smooth(0.0004, 0.0068, crack.border + 0.002 * fine))
            * crack.across
            * smooth(0.30, 0.65, crack.edge + 0.3 * rough);
        height -= 0.30 * broken * side;
        height += (0.13 * rough + 0.11 * fine) * (0.35 + 0.65 * side) + 0.12 * (crack.value - 0.5) * side;
        let Recipe { outer, inner, accent, .. } = self.recipe;
        let light = smooth(0.0, 0.86, height + 0.06 * fine);
        let top = blend(outer, accent, smooth(0.0, 0.7, rough + 0.5 * sway) * 0.5 * side);
        let top = shade(top, 1.0 + 0.42 * fine + 0.30 * (crack.value - 0.5) + 0.2 * rough);
        let old = Spot {
            height: 0.06 + 0.84 * height,
            color: blend(shade(inner, 1.0 + 0.5 * fine), top, light),
            roughness: 0.97 - 0.11 * side,
        };
        self.skin.under(quad, 4, old)
    }
}

/// A net of ridges with diamonds between them.
#[derive(Debug)]
pub(super) struct Ash {
    recipe: Recipe,
    skin: Skin,
    sway: Fractal,
    other: Fractal,
    waver: Fractal,
    rough: Fractal,
    fine: Fractal,
}

impl Ash {
    pub(super) fn new(recipe: Recipe) -> Self {
        Self {
            recipe,
            skin: Skin::new(&recipe, recipe.ripe(0.05, 0.6)),
            sway: recipe.fractal(1, 5, 3, 2),
            other: recipe.fractal(4, 5, 3, 2),
            waver: recipe.noise(3, 22, 12),
            rough: recipe.fractal(30, 24, 7, 3),
            fine: recipe.fractal(40, 100, 24, 3),
        }
    }
}

impl Pattern for Ash {
    fn plain(&self) -> Vec<&Fractal> {
        self.skin.behind(vec![&self.sway, &self.other, &self.waver, &self.rough, &self.fine])
    }

    #[inline]
    fn at(&self, quad: &Quad<'_>) -> Spot {
        let (x, y) = (quad.x, quad.y);
        let [sway, other, waver, rough, fine] = quad.plain();
        // Two families of slanting ridges; whole numbers of them fit the tile both ways.
        let bend = 0.10 * waver + 0.07 * rough;
        let rising = fraction(11.0 * x + 3.0 * y + 0.85 * sway + bend);
        let falling = fraction(11.0 * x - 3.0 * y + 0.85 * other - bend);
        let away = |part: Vec4| (part - 0.5).abs();
        let half = self.recipe.aged(0.34, 0.235) + 0.06 * waver + 0.05 * rough + 0.025 * fine;
        let ridge = |part: Vec4, strong: Vec4| {
            1.0 - smooth_between(half * 0.35, half * 1.45, away(part) + 0.05 * (1.0 - strong))
        };
        let (a, b) = (ridge(rising, 0.5 + sway), ridge(falling, 0.5 + other));
        // A soft union: where ridges cross they are no higher.
        let ridge = a + b - a * b;
        // Ridges are furrowed along themselves.
        let furrow = smooth(0.15, 0.6, fine.abs() + 0.3 * rough);
        let height = 0.86 * ridge + 0.12 * rough + (0.07 + 0.05 * ridge) * fine - 0.10 * furrow * ridge;
        let Recipe { outer, inner, accent, .. } = self.recipe;
        let top = blend(outer, accent, smooth(0.0, 0.8, rough + 0.6 * sway) * 0.6);
        let top = shade(top, 1.0 + 0.34 * fine + 0.14 * waver - 0.2 * furrow);
        let floor = shade(blend(inner, outer, Vec4::splat(0.16)), 1.0 + 0.7 * fine + 0.4 * rough);
        let old = Spot {
            height: 0.08 + 0.82 * height,
            color: blend(floor, top, smooth(0.05, 0.95, height)),
            roughness: 0.96 - 0.12 * ridge,
        };
        self.skin.under(quad, 5, old)
    }
}
