//! Pine: plates of many flakes.

use super::cells::Cells;
use super::lanes::{Quad, floor, fraction, mix, smooth};
use super::noise::Fractal;
use super::pattern::{Pattern, Recipe, Skin, Spot, blend, shade};
use glam::Vec4;

/// Large plates of many flakes, with dark fissures between them.
#[derive(Debug)]
pub(super) struct Pine {
    recipe: Recipe,
    skin: Skin,
    sway: Fractal,
    other: Fractal,
    plates: Cells,
    parts: Cells,
    flakes: Fractal,
    fine: Fractal,
}

impl Pine {
    pub(super) fn new(recipe: Recipe) -> Self {
        Self {
            recipe,
            skin: Skin::new(&recipe, recipe.ripe(0.0, 0.45)),
            sway: recipe.fractal(1, 7, 5, 3),
            other: recipe.fractal(5, 7, 5, 3),
            plates: Cells::new(recipe.seed, 10, (8, 4), 0.95, true),
            parts: Cells::new(recipe.seed, 20, (13, 9), 0.9, false),
            flakes: recipe.fractal(30, 9, 6, 3),
            fine: recipe.fractal(40, 70, 60, 3),
        }
    }
}

impl Pattern for Pine {
    fn plain(&self) -> Vec<&Fractal> {
        self.skin.behind(vec![&self.sway, &self.other, &self.flakes, &self.fine])
    }

    #[inline]
    fn at(&self, quad: &Quad<'_>) -> Spot {
        let (x, y) = (quad.x, quad.y);
        let [sway, other, flakes, fine] = quad.plain();
        // Moved by a third of a plate and by its flakes: no fissure is straight.
        let (u, v) = (x + 0.040 * sway + 0.010 * flakes, y + 0.075 * other - 0.020 * flakes + 0.002 * fine);
        let plate = self.plates.at(u, v);
        let part = self.parts.at(u, v);
        // Fissures along the trunk are the widest; where they have hardly begun, plates hang together.
        let open = smooth(0.05, 0.55, plate.edge + 0.3 * other) * (1.0 - 0.45 * plate.across);
        let wide = self.recipe.aged(0.006, 0.0145) * (0.25 + 0.75 * open) * (1.0 + 0.5 * sway);
        let side = smooth(0.0, 1.5, (plate.border + 0.004 * flakes + 0.0015 * fine) / wide);
        let side = mix(Vec4::ONE, side, 0.3 + 0.7 * open);
        let split = (1.0 - smooth(0.0, 0.007, part.border + 0.0015 * fine))
            * smooth(0.5, 0.75, part.edge + 0.3 * flakes);
        // Flakes lie on each other like the lines of a map; the outermost is in the middle of a plate.
        let dome = (plate.border * 16.0).min(Vec4::ONE);
        let layer = 2.3 * flakes + 1.3 * dome + 0.12 * fine + 6.0 * plate.value + 16.0;
        let number = floor(layer);
        let step = layer - number;
        let lip = smooth(0.0, 0.13, step);
        let piece = fraction(number * 0.618_034 + plate.value * 5.7 + 0.31 * part.value);
        let terrace = (number - 16.0 - 6.0 * plate.value + lip) / 3.4;
        let mut height =
            side * (0.55 + 0.34 * terrace.clamp(Vec4::splat(-0.6), Vec4::splat(1.2))) + 0.05 * fine * side;
        height -= 0.16 * split * side;
        let Recipe { outer, inner, accent, .. } = self.recipe;
        let top = blend(outer, accent, smooth(0.3, 1.0, piece) * 0.8);
        let top = shade(top, (0.72 + 0.38 * lip) * (1.0 + 0.30 * fine + 0.22 * (piece - 0.5) + 0.15 * sway));
        let light = side * (1.0 - 0.5 * split);
        let old = Spot {
            height: 0.06 + 0.86 * height,
            color: blend(shade(inner, 1.0 + 0.5 * fine), top, smooth(0.05, 1.0, light)),
            roughness: 0.97 - 0.15 * side,
        };
        self.skin.under(quad, 4, old)
    }
}
