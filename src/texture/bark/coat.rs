//! Coats on bark: snow, moss, lichen.

use super::cells::Cells;
use super::lanes::{Quad, mix, smooth};
use super::noise::{Fractal, Seed};
use super::pattern::{Pattern, Recipe, Spot, blend, shade};
use super::{Bark, BarkSet, bake, linear};
use crate::ParameterError;
use crate::texture::TextureError;
use glam::Vec4;

/// Kinds of coats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum CoatKind {
    Snow,
    Moss,
    Lichen,
}

/// A tile of snow, moss or lichen, as images that continue into themselves on all sides; a
/// [`Mask`](crate::surface::Mask) says where it lies.
///
/// The guarantees of [`Bark`] for edges, normals, the mean colour and bits hold here too.
///
/// ```
/// use treesynth::texture::Coat;
///
/// let moss = Coat::moss().with_resolution(64).bake()?;
/// assert_eq!(moss.textures.base_color().unwrap().width(), 64);
/// # Ok::<(), treesynth::texture::TextureError>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct Coat {
    kind: CoatKind,
    size: f32,
    depth: f32,
    color: [u8; 3],
    palette: [[u8; 3]; 3],
    seed: u64,
    resolution: u32,
}

impl Coat {
    /// White, with soft hollows. A tile of 0.5 m.
    pub fn snow() -> Self {
        let palette = [[244, 247, 250], [222, 232, 244], [255, 255, 255]];
        Self::of(CoatKind::Snow, (0.5, 0.02), [240, 244, 248], palette)
    }

    /// Cushions of green, brown between them. A tile of 0.3 m.
    pub fn moss() -> Self {
        let palette = [[104, 122, 48], [40, 44, 20], [146, 158, 70]];
        Self::of(CoatKind::Moss, (0.3, 0.02), [82, 98, 42], palette)
    }

    /// Crusts of pale grey-green with darker cups. A tile of 0.3 m.
    pub fn lichen() -> Self {
        let palette = [[172, 180, 158], [104, 108, 92], [196, 188, 112]];
        Self::of(CoatKind::Lichen, (0.3, 0.003), [158, 166, 144], palette)
    }

    fn of(kind: CoatKind, (size, depth): (f32, f32), color: [u8; 3], palette: [[u8; 3]; 3]) -> Self {
        Self { kind, size, depth, color, palette, seed: 0, resolution: 256 }
    }

    /// The mean colour, sRGB.
    pub fn with_color(mut self, srgb: [u8; 3]) -> Self {
        self.color = srgb;
        self
    }

    /// Another seed gives another piece; default 0.
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Pixels per side, a power of two from 16 to 8192; default 256.
    pub fn with_resolution(mut self, pixels: u32) -> Self {
        self.resolution = pixels;
        self
    }

    /// Makes the images.
    ///
    /// # Errors
    /// A resolution out of its range.
    pub fn bake(&self) -> Result<BarkSet, TextureError> {
        let pixels = self.resolution;
        let holds = pixels.is_power_of_two() && (16..=8192).contains(&pixels);
        ParameterError::unless(holds, "Coat.resolution", pixels, "a power of two from 16 to 8192")?;
        let bark = Bark::beech()
            .with_size(self.size)
            .with_depth(self.depth)
            .with_age(1.0)
            .with_color(self.color)
            .with_resolution(pixels);
        let [outer, inner, accent] = self.palette.map(|srgb| linear(srgb).map(Vec4::splat));
        let finest = (pixels / 2).max(8);
        let recipe = Recipe { seed: Seed(self.seed), age: 1.0, finest, outer, inner, accent };
        match self.kind {
            CoatKind::Snow => bake::bake(&bark, &Snow::new(recipe)),
            CoatKind::Moss => bake::bake(&bark, &Moss::new(recipe)),
            CoatKind::Lichen => bake::bake(&bark, &Lichen::new(recipe)),
        }
    }
}

/// Soft heaps.
#[derive(Debug)]
struct Snow {
    recipe: Recipe,
    heaps: Fractal,
    grains: Fractal,
}

impl Snow {
    fn new(recipe: Recipe) -> Self {
        Self { recipe, heaps: recipe.fractal(1, 5, 5, 4), grains: recipe.fractal(10, 90, 90, 2) }
    }
}

impl Pattern for Snow {
    fn plain(&self) -> Vec<&Fractal> {
        vec![&self.heaps, &self.grains]
    }

    #[inline]
    fn at(&self, quad: &Quad<'_>) -> Spot {
        let [heap, grain] = quad.plain();
        let Recipe { outer, inner, accent, .. } = self.recipe;
        let color = blend(inner, outer, smooth(-0.6, 0.3, heap));
        Spot {
            height: 0.5 + 0.45 * heap + 0.04 * grain,
            color: blend(color, accent, smooth(0.2, 0.6, grain)),
            roughness: 0.62 - 0.2 * smooth(0.3, 0.6, grain),
        }
    }
}

/// Cushions of shoots.
#[derive(Debug)]
struct Moss {
    recipe: Recipe,
    sway: Fractal,
    cushions: Cells,
    shoots: Cells,
    fine: Fractal,
}

impl Moss {
    fn new(recipe: Recipe) -> Self {
        Self {
            recipe,
            sway: recipe.fractal(1, 8, 8, 3),
            cushions: Cells::new(recipe.seed, 10, (12, 12), 0.95, false),
            shoots: Cells::new(recipe.seed, 20, (56, 56), 1.0, false),
            fine: recipe.fractal(30, 60, 60, 3),
        }
    }
}

impl Pattern for Moss {
    fn plain(&self) -> Vec<&Fractal> {
        vec![&self.sway, &self.fine]
    }

    #[inline]
    fn at(&self, quad: &Quad<'_>) -> Spot {
        let [sway, fine] = quad.plain();
        let (u, v) = (quad.x + 0.02 * sway, quad.y - 0.02 * sway);
        let (cushion, shoot) = (self.cushions.at(u, v), self.shoots.at(u + 0.004 * fine, v));
        let dome = (cushion.border * 22.0).min(Vec4::ONE);
        let dome = dome * (2.0 - dome);
        let tip = smooth(0.0, 0.009, shoot.border);
        let height = 0.08 + 0.52 * dome + 0.22 * tip * (0.4 + 0.6 * shoot.value) + 0.14 * sway + 0.06 * fine;
        let Recipe { outer, inner, accent, .. } = self.recipe;
        let green = blend(outer, accent, smooth(0.45, 1.0, shoot.value + 0.5 * sway));
        let green = shade(green, 0.75 + 0.5 * shoot.value + 0.3 * fine + 0.25 * (cushion.value - 0.5));
        Spot {
            height,
            color: blend(inner, green, smooth(0.05, 0.75, height) * (0.45 + 0.55 * tip)),
            roughness: Vec4::splat(0.96),
        }
    }
}

/// Crusts that have met, with cups.
#[derive(Debug)]
struct Lichen {
    recipe: Recipe,
    sway: Fractal,
    crusts: Cells,
    warts: Cells,
    fine: Fractal,
}

impl Lichen {
    fn new(recipe: Recipe) -> Self {
        Self {
            recipe,
            sway: recipe.fractal(1, 12, 12, 4),
            crusts: Cells::new(recipe.seed, 10, (8, 8), 1.0, false),
            warts: Cells::new(recipe.seed, 20, (44, 44), 1.0, false),
            fine: recipe.fractal(30, 70, 70, 2),
        }
    }
}

impl Pattern for Lichen {
    fn plain(&self) -> Vec<&Fractal> {
        vec![&self.sway, &self.fine]
    }

    #[inline]
    fn at(&self, quad: &Quad<'_>) -> Spot {
        let [sway, fine] = quad.plain();
        let crust = self.crusts.at(quad.x + 0.05 * sway, quad.y - 0.05 * sway);
        let wart = self.warts.at(quad.x + 0.01 * sway, quad.y + 0.01 * fine);
        // Rims are lobed and pale, middles full of cups.
        let rim = 1.0 - smooth(0.004, 0.022, crust.border);
        let gap = 1.0 - smooth(0.0, 0.005, crust.border + 0.001 * fine);
        let lump = smooth(0.0, 0.006, wart.border);
        let cup = smooth(0.72, 0.8, wart.value) * smooth(0.004, 0.008, wart.border) * (1.0 - rim);
        let Recipe { outer, inner, accent, .. } = self.recipe;
        let own = blend(outer, accent, 0.55 * smooth(0.84, 0.9, crust.value));
        let color = shade(own, 0.86 + 0.14 * rim + 0.1 * lump + 0.12 * fine + 0.2 * sway);
        let color = blend(color, inner, 0.8 * cup);
        Spot {
            height: mix(0.35 + 0.35 * lump + 0.2 * rim + 0.1 * fine - 0.2 * cup, Vec4::splat(0.05), gap),
            color: blend(color, shade(inner, Vec4::splat(0.6)), 0.85 * gap),
            roughness: Vec4::splat(0.9),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math;

    #[test]
    fn coats_continue_and_have_the_mean_asked_for() {
        for coat in [Coat::snow(), Coat::moss(), Coat::lichen()] {
            for seed in 0..3 {
                let set = coat.clone().with_seed(seed).with_resolution(128).bake().expect("in range");
                let image = set.textures.base_color().expect("colours");
                for (mean, wanted) in image.mean_color().into_iter().zip(coat.color) {
                    assert!((math::srgb(mean) * 255.0 - f32::from(wanted)).abs() < 2.0, "{mean} in {coat:?}");
                }
                let differs = |row: u32| -> u32 {
                    let channels = |x: u32| {
                        let (a, b) = (image.pixel(x, row), image.pixel(x, row + 127));
                        (0..3).map(|i| u32::from(a[i].abs_diff(b[i]))).sum::<u32>()
                    };
                    (0..128).map(channels).sum()
                };
                let inside = (1..128).map(differs).max().expect("rows");
                assert!(differs(0) <= inside + inside / 8, "a seam in {coat:?}");
            }
        }
        assert!(Coat::moss().with_resolution(100).bake().is_err());
    }
}
