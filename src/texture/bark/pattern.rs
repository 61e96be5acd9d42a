//! Parts that all kinds of bark share.

use super::cells::Dashes;
use super::lanes::{Quad, mix, smooth};
use super::noise::{Fractal, Seed};
use glam::Vec4;

/// Linear red, green and blue of four pixels.
pub(super) type Color = [Vec4; 3];

/// From one colour to another.
#[inline]
pub(super) fn blend(a: Color, b: Color, t: Vec4) -> Color {
    [mix(a[0], b[0], t), mix(a[1], b[1], t), mix(a[2], b[2], t)]
}

/// A colour darkened or lightened.
#[inline]
pub(super) fn shade(color: Color, factor: Vec4) -> Color {
    let factor = factor.max(Vec4::ZERO);
    color.map(|channel| channel * factor)
}

/// Height, colour and roughness at four places of a bark.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spot {
    /// 0 (deepest) to 1; what is beyond is cut off.
    pub(super) height: Vec4,
    pub(super) color: Color,
    /// 0 (a mirror) to 1.
    pub(super) roughness: Vec4,
}

/// A kind of bark: its surface over the tile [0, 1) squared, which it must continue on all sides. x
/// runs around the branch, y along it.
pub(super) trait Pattern: Sync {
    /// The fields that are asked for at the pixels themselves, as [`Quad::plain`] has them.
    fn plain(&self) -> Vec<&Fractal>;

    /// The surface at four pixels.
    fn at(&self, quad: &Quad<'_>) -> Spot;
}

/// Parameters of a pattern.
#[derive(Debug, Clone, Copy)]
pub(super) struct Recipe {
    pub(super) seed: Seed,
    /// 0 to 1.
    pub(super) age: f32,
    /// Cells per tile beyond which noise is finer than pixels can show.
    pub(super) finest: u32,
    /// Colours of the outer surface, of hollows, and of special parts: lenticels, fresh flakes,
    /// patches.
    pub(super) outer: Color,
    pub(super) inner: Color,
    pub(super) accent: Color,
}

impl Recipe {
    pub(super) fn noise(&self, salt: u32, columns: u32, rows: u32) -> Fractal {
        Fractal::single(self.seed, salt, (columns, rows))
    }

    pub(super) fn fractal(&self, salt: u32, columns: u32, rows: u32, octaves: u32) -> Fractal {
        Fractal::new(self.seed, salt, (columns, rows), octaves, self.finest)
    }

    /// From `young` to `old` by age.
    pub(super) fn aged(&self, young: f32, old: f32) -> f32 {
        young + (old - young) * self.age
    }

    /// 0 up to the age `low`, 1 from `high` on.
    pub(super) fn ripe(&self, low: f32, high: f32) -> f32 {
        smooth(low, high, Vec4::splat(self.age)).x
    }
}

/// The smooth skin of young wood, under which the bark of old wood grows: faint wrinkles around the branch, lenticels.
#[derive(Debug)]
pub(super) struct Skin {
    /// Share of the old bark; at 1 nothing else is computed.
    old: f32,
    outer: Color,
    blotches: Fractal,
    wrinkles: Fractal,
    dots: Dashes,
}

impl Skin {
    /// The skin where the bark is old by a part of `old`.
    pub(super) fn new(recipe: &Recipe, old: f32) -> Self {
        Self {
            old,
            outer: recipe.outer,
            blotches: recipe.fractal(900, 4, 3, 4),
            wrinkles: recipe.noise(910, 5, 42),
            dots: Dashes::new(recipe.seed, 920, (16, 22), 0.45, [[0.06, 0.22], [0.05, 0.11]]),
        }
    }

    /// A pattern's plain fields, and the skin's behind them.
    pub(super) fn behind<'a>(&'a self, mut fields: Vec<&'a Fractal>) -> Vec<&'a Fractal> {
        if self.old < 1.0 {
            fields.extend([&self.blotches, &self.wrinkles]);
        }
        fields
    }

    /// The skin as age has changed it: old bark alone where the bark is old. `first` is the number
    /// of the skin's first field. The skin's heights are about 0.8.
    #[inline]
    pub(super) fn under(&self, quad: &Quad<'_>, first: usize, old: Spot) -> Spot {
        if self.old >= 1.0 {
            return old;
        }
        let [blotch, wrinkle] = quad.plain_from(first);
        let dot = self.dots.at(quad.x, quad.y);
        let color = shade(self.outer, 1.0 + 0.28 * blotch + 0.07 * wrinkle);
        let color = blend(color, shade(self.outer, Vec4::splat(1.5)), 0.75 * dot);
        let crease = smooth(0.35, 0.8, wrinkle);
        let height = 0.78 + 0.05 * blotch - 0.06 * crease + 0.16 * dot;
        let part = Vec4::splat(self.old);
        Spot {
            height: mix(height, old.height, part),
            color: blend(color, old.color, part),
            roughness: mix(0.7 + 0.1 * blotch, old.roughness, part),
        }
    }
}
