//! Pine and plane: bark that comes off in plates.

use super::cells::Cells;
use super::lanes::{Quad, floor, fraction, smooth};
use super::noise::Fractal;
use super::pattern::{Pattern, Recipe, Skin, Spot, blend, shade};
use glam::Vec4;

/// Large plates of many flakes, with dark fissures between them.
#[derive(Debug)]
pub(super) struct Pine {
    recipe: Recipe,
    skin: Skin,
    sway: Fractal,
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
            sway: recipe.fractal(1, 6, 5, 3),
            plates: Cells::new(recipe.seed, 10, (7, 4), 0.9, true),
            parts: Cells::new(recipe.seed, 20, (13, 9), 0.9, false),
            flakes: recipe.fractal(30, 9, 6, 3),
            fine: recipe.fractal(40, 70, 60, 3),
        }
    }
}

impl Pattern for Pine {
    fn plain(&self) -> Vec<&Fractal> {
        self.skin.behind(vec![&self.sway, &self.flakes, &self.fine])
    }

    #[inline]
    fn at(&self, quad: &Quad<'_>) -> Spot {
        let (x, y) = (quad.x, quad.y);
        let [sway, flakes, fine] = quad.plain();
        let (u, v) = (x + 0.030 * sway + 0.010 * flakes, y + 0.04 * sway - 0.012 * flakes + 0.002 * fine);
        let plate = self.plates.at(u, v);
        let part = self.parts.at(u, v);
        let wide = self.recipe.aged(0.006, 0.0125) * (1.0 + 0.6 * sway);
        let side = smooth(0.0, 1.5, (plate.border + 0.004 * flakes + 0.0015 * fine) / wide);
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
        let top = blend(outer, accent, smooth(0.1, 1.0, piece) * 0.75);
        let top = shade(top, (0.72 + 0.38 * lip) * (1.0 + 0.30 * fine + 0.22 * (piece - 0.5) + 0.15 * sway));
        let light = side * (1.0 - 0.5 * split);
        let old = Spot {
            height: 0.06 + 0.86 * height,
            color: blend(shade(inner, 1.0 + 0.5 * fine), top, smooth(0.05, 1.0, light)),
            roughness: 0.97 - 0.15 * side,
        };
        self.skin.under(quad, 3, old)
    }
}

/// Patches: each is the place where a plate fell off in another year.
#[derive(Debug)]
pub(super) struct Plane {
    recipe: Recipe,
    sway: Fractal,
    layers: [Fractal; 4],
    fine: Fractal,
    specks: Cells,
}

impl Plane {
    pub(super) fn new(recipe: Recipe) -> Self {
        let layer = |salt, columns, rows| recipe.fractal(salt, columns, rows, 3);
        Self {
            recipe,
            sway: recipe.fractal(1, 7, 6, 3),
            layers: [layer(10, 5, 4), layer(20, 4, 4), layer(30, 5, 3), layer(40, 6, 5)],
            fine: recipe.fractal(50, 60, 50, 3),
            specks: Cells::new(recipe.seed, 60, (40, 40), 1.0, false),
        }
    }
}

impl Pattern for Plane {
    fn plain(&self) -> Vec<&Fractal> {
        vec![&self.sway, &self.fine]
    }

    #[inline]
    fn at(&self, quad: &Quad<'_>) -> Spot {
        let (x, y) = (quad.x, quad.y);
        let age = self.recipe.age;
        let [sway, fine] = quad.plain();
        let (u, v) = (x + 0.022 * sway, y - 0.028 * sway);
        let Recipe { outer, inner, accent, .. } = self.recipe;
        // From the freshest, which is the deepest, to what has not fallen for years.
        let olive = blend(accent, outer, Vec4::splat(0.62));
        let khaki = blend(accent, inner, Vec4::splat(0.42));
        let colors = [olive, outer, khaki, inner];
        let mut color = shade(accent, 1.0 + 0.05 * fine);
        let (mut height, mut roughness, mut rim) = (Vec4::splat(0.18), Vec4::splat(0.62), Vec4::ZERO);
        for (i, (layer, own)) in self.layers.iter().zip(colors).enumerate() {
            let level = layer.at(u, v) + 0.035 * fine;
            let limit = [-0.22, -0.02, 0.12, 0.36 - 0.22 * age][i];
            let there = smooth(-0.008, 0.014, level - limit);
            let tone = 1.0 + (0.05 + 0.05 * i as f32) * fine + 0.10 * sway;
            color = blend(color, shade(own, tone), there);
            height += there * [0.14, 0.15, 0.16, 0.22][i];
            roughness += there * 0.06;
            let edge = 1.0 - smooth(0.0, 0.05, (level - limit + 0.008).abs());
            rim = rim.max(edge * (1.0 - there * 0.5));
        }
        let speck = self.specks.at(x, y);
        let [right, up] = speck.offset;
        let distance = (right * right + up * up).sqrt();
        let dot = (1.0 - smooth(0.001, 0.0028, distance)) * smooth(0.7, 0.75, speck.value);
        let color = shade(color, (1.0 - 0.28 * rim) * (1.0 - 0.35 * dot));
        Spot { height: height + 0.03 * fine + 0.05 * sway, color, roughness }
    }
}
