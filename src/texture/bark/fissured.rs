//! Oak and ash: ridges along the branch, and what separates them.

use super::cells::Cells;
use super::noise::{Fractal, Noise, fraction, mix, smooth};
use super::pattern::{Pattern, Recipe, Skin, Spot, blend, shade};

/// Long ridges that split and join, broken crosswise.
#[derive(Debug)]
pub(super) struct Oak {
    recipe: Recipe,
    skin: Skin,
    sway: Noise,
    waver: Noise,
    ridges: Cells,
    breaks: Cells,
    rough: Fractal,
    fine: Fractal,
}

impl Oak {
    pub(super) fn new(recipe: Recipe) -> Self {
        Self {
            recipe,
            skin: Skin::new(&recipe),
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
    #[inline]
    fn at(&self, x: f32, y: f32) -> Spot {
        let age = self.recipe.age;
        let (sway, waver) = (self.sway.at(x, y), self.waver.at(x, y));
        let (rough, fine) = (self.rough.at(x, y), self.fine.at(x, y));
        let u = x + 0.026 * sway + 0.0085 * waver + 0.004 * rough + 0.0022 * fine;
        let v = y + 0.03 * waver + 0.02 * rough;
        let ridge = self.ridges.at(u, v);
        // Some fissures are deep, some hardly begun: there ridges join. Those across the branch are the shallowest.
        let open = smooth(0.10, 0.5, ridge.edge + 0.3 * rough) * (1.0 - 0.65 * ridge.across);
        let wide = mix(0.007, 0.0155, age) * (1.0 + 0.3 * sway) * mix(0.5, 1.0, open);
        let side = smooth(0.0, 1.45, (ridge.border + 0.0030 * rough + 0.0014 * fine) / wide);
        let round = (ridge.border * 34.0).min(1.0);
        let crown = 0.60 + 0.40 * round * (2.0 - round);
        let depth = mix(0.38, 1.0, open);
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
            roughness: mix(0.97, 0.86, side),
        };
        self.skin.under(&self.recipe, (x, y), old, smooth(0.0, 0.5, age))
    }
}

/// A net of ridges with diamonds between them.
#[derive(Debug)]
pub(super) struct Ash {
    recipe: Recipe,
    skin: Skin,
    sway: Noise,
    other: Noise,
    waver: Noise,
    rough: Fractal,
    fine: Fractal,
}

impl Ash {
    pub(super) fn new(recipe: Recipe) -> Self {
        Self {
            recipe,
            skin: Skin::new(&recipe),
            sway: recipe.noise(1, 6, 4),
            other: recipe.noise(2, 6, 4),
            waver: recipe.noise(3, 22, 12),
            rough: recipe.fractal(30, 24, 7, 3),
            fine: recipe.fractal(40, 100, 24, 3),
        }
    }
}

impl Pattern for Ash {
    #[inline]
    fn at(&self, x: f32, y: f32) -> Spot {
        let age = self.recipe.age;
        let (sway, other, waver) = (self.sway.at(x, y), self.other.at(x, y), self.waver.at(x, y));
        let (rough, fine) = (self.rough.at(x, y), self.fine.at(x, y));
        // Two families of slanting ridges; whole numbers of them fit the tile both ways.
        let bend = 0.13 * waver + 0.05 * rough;
        let rising = fraction(11.0 * x + 4.0 * y + 0.45 * sway + bend);
        let falling = fraction(11.0 * x - 4.0 * y + 0.45 * other - bend);
        let away = |part: f32| (part - 0.5).abs();
        let half = mix(0.32, 0.215, age) + 0.055 * waver + 0.03 * rough + 0.02 * fine;
        let ridge = |part: f32, strong: f32| {
            1.0 - smooth(half * 0.35, half * 1.45, away(part) + 0.05 * (1.0 - strong))
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
        let floor = shade(blend(inner, outer, 0.10), 1.0 + 0.7 * fine + 0.4 * rough);
        let old = Spot {
            height: 0.08 + 0.82 * height,
            color: blend(floor, top, smooth(0.05, 0.95, height)),
            roughness: mix(0.96, 0.84, ridge),
        };
        self.skin.under(&self.recipe, (x, y), old, smooth(0.05, 0.6, age))
    }
}
