//! Plane and eucalyptus: bark that falls off in patches or in ribbons and leaves a smooth skin of many colours.

use super::cells::Cells;
use super::lanes::{Quad, smooth};
use super::noise::Fractal;
use super::pattern::{Pattern, Recipe, Spot, blend, shade};
use glam::Vec4;

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
            layers: [layer(10, 6, 4), layer(20, 7, 5), layer(30, 6, 4), layer(40, 8, 5)],
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
        let khaki = blend(outer, inner, Vec4::splat(0.55));
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

/// Ribbons: streaks along the trunk, each bared in another year.
#[derive(Debug)]
pub(super) struct Ribbons {
    recipe: Recipe,
    sway: Fractal,
    layers: [Fractal; 3],
    streaks: Fractal,
    blotches: Fractal,
    fine: Fractal,
    shreds: Fractal,
}

impl Ribbons {
    pub(super) fn new(recipe: Recipe) -> Self {
        let layer = |salt, columns, rows| recipe.fractal(salt, columns, rows, 3);
        Self {
            recipe,
            sway: recipe.fractal(1, 5, 2, 2),
            layers: [layer(10, 7, 1), layer(20, 8, 2), layer(30, 6, 1)],
            streaks: recipe.fractal(40, 40, 3, 3),
            blotches: recipe.fractal(50, 5, 5, 3),
            fine: recipe.fractal(60, 90, 40, 3),
            shreds: layer(70, 9, 1),
        }
    }
}

impl Pattern for Ribbons {
    fn plain(&self) -> Vec<&Fractal> {
        vec![&self.sway, &self.streaks, &self.blotches, &self.fine]
    }

    #[inline]
    fn at(&self, quad: &Quad<'_>) -> Spot {
        let (x, y) = (quad.x, quad.y);
        let [sway, streak, blotch, fine] = quad.plain();
        let (u, v) = (x + 0.016 * sway + 0.003 * blotch, y);
        let Recipe { outer, inner, accent, age, .. } = self.recipe;
        let tan = blend(accent, inner, Vec4::splat(0.45));
        let colors = [blend(accent, outer, Vec4::splat(0.5)), outer, tan];
        let mut color = shade(accent, 1.0 + 0.05 * streak + 0.05 * blotch);
        let (mut height, mut roughness, mut rim) = (Vec4::splat(0.3), Vec4::splat(0.6), Vec4::ZERO);
        for (i, (layer, own)) in self.layers.iter().zip(colors).enumerate() {
            let level = layer.at(u, v) + 0.05 * streak + 0.012 * fine;
            let limit = [-0.12, 0.10, 0.30][i];
            // The latest skin has a sharp edge; older ones fade into each other.
            let there = smooth(-0.01, [0.20, 0.10, 0.03][i], level - limit);
            color = blend(color, shade(own, 1.0 + 0.08 * streak + 0.05 * blotch), there);
            height += 0.07 * there;
            let edge = 1.0 - smooth(0.0, 0.03, (level - limit).abs());
            rim = rim.max(edge * if i == 2 { 0.8 } else { 0.15 });
        }
        // Ribbons that hang on, brown and fibrous.
        let shred = self.shreds.at(u, v) + 0.16 * streak + 0.06 * fine;
        let held = smooth(0.0, 0.05, shred - 0.62 + 0.22 * age);
        color = blend(color, shade(inner, 1.0 + 0.35 * streak + 0.2 * fine), held * 0.85);
        height += 0.35 * held + 0.08 * streak * held;
        roughness += 0.3 * held;
        let color = shade(color, 1.0 - 0.30 * rim + 0.04 * fine);
        Spot { height: height + 0.04 * streak + 0.05 * blotch + 0.02 * fine, color, roughness }
    }
}
