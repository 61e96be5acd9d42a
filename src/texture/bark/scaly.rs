//! Spruce, sycamore, apple: thin scales.

use super::cells::{Cell, Cells};
use super::lanes::{Quad, mix, smooth};
use super::noise::Fractal;
use super::pattern::{Pattern, Recipe, Skin, Spot, blend, shade};
use glam::Vec4;

/// Thin scales of uneven size that overlap, fast at their upper edges and lifted at their lower ones.
#[derive(Debug)]
pub(super) struct Scales {
    recipe: Recipe,
    skin: Skin,
    sway: Fractal,
    other: Fractal,
    large: Cells,
    small: Cells,
    rough: Fractal,
    fine: Fractal,
}

impl Scales {
    pub(super) fn new(recipe: Recipe) -> Self {
        Self {
            recipe,
            skin: Skin::new(&recipe, recipe.ripe(0.0, 0.55)),
            sway: recipe.fractal(1, 13, 9, 3),
            other: recipe.fractal(5, 13, 9, 3),
            large: Cells::new(recipe.seed, 10, (12, 8), 0.95, true),
            small: Cells::new(recipe.seed, 20, (25, 16), 0.95, true),
            rough: recipe.fractal(30, 5, 4, 3),
            fine: recipe.fractal(40, 80, 60, 3),
        }
    }
}

impl Pattern for Scales {
    fn plain(&self) -> Vec<&Fractal> {
        self.skin.behind(vec![&self.sway, &self.other, &self.rough, &self.fine])
    }

    #[inline]
    fn at(&self, quad: &Quad<'_>) -> Spot {
        let (x, y) = (quad.x, quad.y);
        let [sway, other, rough, fine] = quad.plain();
        // Moved by about half a scale: no border is straight.
        let (u, v) = (x + 0.024 * sway + 0.0012 * fine, y + 0.032 * other + 0.0012 * fine);
        let (large, small) = (self.large.at(u, v), self.small.at(u, v));
        // Large scales break into small ones here and there.
        let broken = smooth(0.42, 0.58, large.value + 0.4 * rough);
        let scale = |cell: &Cell, size: f32| {
            let gap = 0.0055 * size;
            let open = smooth(0.15, 0.55, cell.edge + 0.25 * rough);
            let down = (cell.offset[1] * (-8.0 / size)).clamp(Vec4::NEG_ONE, Vec4::ONE);
            let edge = smooth(0.0, gap, cell.border + 0.0012 * fine);
            // The border below a scale is the deepest.
            let deep = open * (0.55 + 0.45 * smooth(-0.3, 0.6, down));
            let body = 0.5 + 0.46 * (cell.value - 0.5) + 0.26 * down * open;
            (body - (0.25 + 0.35 * deep) * (1.0 - edge) * (0.25 + 0.75 * open), (1.0 - edge) * deep)
        };
        let (a, b) = (scale(&large, 1.5), scale(&small, 0.8));
        let (height, gap) = (mix(a.0, b.0, broken), mix(a.1, b.1, broken));
        let value = mix(large.value, small.value, broken);
        let Recipe { outer, inner, accent, .. } = self.recipe;
        // The bark under a fallen scale is fresh.
        let fresh = 1.0 - smooth(0.10, 0.34, value + 0.30 * rough + 0.1 * sway);
        let top = blend(outer, accent, 0.8 * fresh);
        let top = shade(top, 1.0 + 0.42 * (value - 0.5) + 0.20 * fine + 0.14 * rough + 0.16 * sway);
        let old = Spot {
            height: 0.08 + 0.86 * height + 0.07 * fine + 0.05 * sway,
            color: blend(top, shade(inner, 1.0 + 0.4 * fine), gap.clamp(Vec4::ZERO, Vec4::ONE)),
            roughness: 0.84 + 0.10 * gap,
        };
        self.skin.under(quad, 4, old)
    }
}
