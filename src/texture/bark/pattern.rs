//! What all kinds of bark have in common.

use super::cells::Dashes;
use super::noise::{Fractal, Noise, Seed, mix, smooth};

/// Linear red, green and blue.
pub(super) type Color = [f32; 3];

/// From one colour to another.
#[inline]
pub(super) fn blend(a: Color, b: Color, t: f32) -> Color {
    [mix(a[0], b[0], t), mix(a[1], b[1], t), mix(a[2], b[2], t)]
}

/// A colour darkened or lightened.
#[inline]
pub(super) fn shade(color: Color, factor: f32) -> Color {
    color.map(|channel| channel * factor.max(0.0))
}

/// What is at one place of a bark.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spot {
    /// 0 (deepest) to 1; what is beyond is cut off.
    pub(super) height: f32,
    pub(super) color: Color,
    /// 0 (a mirror) to 1.
    pub(super) roughness: f32,
}

/// A kind of bark: what is where in the tile [0, 1) squared, which it must continue on all sides. x runs around the
/// branch, y along it.
pub(super) trait Pattern: Sync {
    fn at(&self, x: f32, y: f32) -> Spot;
}

/// What a pattern is made with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Recipe {
    pub(super) seed: Seed,
    /// 0 to 1.
    pub(super) age: f32,
    /// Cells a tile beyond which noise is finer than pixels can show.
    pub(super) finest: u32,
    /// The outer surface, what is deep, and what is special: lenticels, fresh flakes, patches.
    pub(super) outer: Color,
    pub(super) inner: Color,
    pub(super) accent: Color,
}

impl Recipe {
    pub(super) fn noise(&self, salt: u32, columns: u32, rows: u32) -> Noise {
        Noise::new(self.seed, salt, columns, rows)
    }

    pub(super) fn fractal(&self, salt: u32, columns: u32, rows: u32, octaves: u32) -> Fractal {
        Fractal::new(self.seed, salt, (columns, rows), octaves, self.finest)
    }
}

/// The smooth skin of young wood, under which the bark of old wood grows: faint wrinkles around the branch, lenticels.
#[derive(Debug)]
pub(super) struct Skin {
    blotches: Fractal,
    wrinkles: Noise,
    dots: Dashes,
}

impl Skin {
    pub(super) fn new(recipe: &Recipe) -> Self {
        Self {
            blotches: recipe.fractal(900, 4, 3, 4),
            wrinkles: recipe.noise(910, 5, 42),
            dots: Dashes::new(recipe.seed, 920, (16, 22), 0.45, [[0.06, 0.22], [0.05, 0.11]]),
        }
    }

    /// Heights are about 0.8.
    #[inline]
    pub(super) fn at(&self, recipe: &Recipe, x: f32, y: f32) -> Spot {
        let (blotch, wrinkle) = (self.blotches.at(x, y), self.wrinkles.at(x, y));
        let dot = self.dots.at(x, y);
        let color = shade(recipe.outer, 1.0 + 0.28 * blotch + 0.07 * wrinkle);
        let color = blend(color, shade(recipe.outer, 1.5), 0.75 * dot);
        let crease = smooth(0.35, 0.8, wrinkle);
        Spot {
            height: 0.78 + 0.05 * blotch - 0.06 * crease + 0.16 * dot,
            color,
            roughness: 0.7 + 0.1 * blotch,
        }
    }

    /// What age has made of the skin: all of it where `age` is 1.
    #[inline]
    pub(super) fn under(&self, recipe: &Recipe, (x, y): (f32, f32), old: Spot, age: f32) -> Spot {
        if age >= 1.0 {
            return old;
        }
        let young = self.at(recipe, x, y);
        Spot {
            height: mix(young.height, old.height, age),
            color: blend(young.color, old.color, age),
            roughness: mix(young.roughness, old.roughness, age),
        }
    }
}
