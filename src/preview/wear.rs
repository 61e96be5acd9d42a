//! The images that a part wears, at every size at which they may be seen.

use crate::math;
use crate::texture::{self, Image, Textures};
use glam::{Vec2, Vec3, Vec4, Vec4Swizzles};
use std::f32::consts::LOG2_E;

/// Most samples along the longer side of a pixel's footprint.
const MOST_TAPS: f32 = 8.0;
/// Places per side of the grid that measures the covered part of a triangle.
const SHARE_GRID: usize = 12;

/// Logarithm to the base 2, of at least 1e-12.
fn log2(x: f32) -> f32 {
    math::ln(x.max(1e-12)) * LOG2_E
}

/// A place in an image and what a pixel covers of it: how it changes to the next pixel on the right and below.
#[derive(Debug, Clone, Copy)]
pub(super) struct Footprint {
    pub(super) uv: Vec2,
    pub(super) right: Vec2,
    pub(super) below: Vec2,
}

/// An image and its halves, quarters and so on (Williams 1983).
#[derive(Debug)]
struct Map<'a> {
    base: &'a Image,
    smaller: Vec<Image>,
    /// `true` if colours are sRGB.
    is_color: bool,
}

impl<'a> Map<'a> {
    fn new(base: &'a Image, is_color: bool, cutoff: Option<f32>) -> Self {
        let all = if is_color { texture::mips(base, cutoff) } else { texture::plain_mips(base) };
        Self { base, smaller: all.into_iter().skip(1).collect(), is_color }
    }

    fn level(&self, level: usize) -> &Image {
        level.checked_sub(1).map_or(self.base, |level| &self.smaller[level.min(self.smaller.len() - 1)])
    }

    /// Between four texels of one level; linear, alpha last.
    #[inline]
    fn bilinear(&self, level: usize, uv: Vec2, tables: &Tables) -> Vec4 {
        let image = self.level(level);
        let (bytes, near) = (image.bytes(), Near::new(image, uv));
        let table = if self.is_color { &tables.linear } else { &tables.plain };
        let has_alpha = image.has_alpha();
        let texel = |at: usize| {
            let value = |channel: usize| table[usize::from(bytes[at + channel])];
            let alpha = if has_alpha { f32::from(bytes[at + 3]) / 255.0 } else { 1.0 };
            Vec4::new(value(0), value(1), value(2), alpha)
        };
        let [a, b, c, d] = near.starts;
        let above = texel(a).lerp(texel(b), near.across);
        let below = texel(c).lerp(texel(d), near.across);
        above.lerp(below, near.down)
    }

    /// The last channel of [`bilinear`](Self::bilinear), of an image that has it.
    #[inline]
    fn alpha(&self, level: usize, uv: Vec2) -> f32 {
        let image = self.level(level);
        let (bytes, near) = (image.bytes(), Near::new(image, uv));
        let [a, b, c, d] = near.starts.map(|at| f32::from(bytes[at + 3]) / 255.0);
        let between = |a: f32, b: f32, part: f32| a * (1.0 - part) + b * part;
        between(between(a, b, near.across), between(c, d, near.across), near.down)
    }

    /// The level this many halvings from the image, and the fraction of the way to the next one.
    #[inline]
    fn levels(&self, halvings: f32) -> (usize, f32) {
        let halvings = halvings.clamp(0.0, self.smaller.len() as f32);
        (halvings as usize, halvings - (halvings as usize) as f32)
    }

    /// Between two levels, this many halvings from the image itself.
    fn trilinear(&self, halvings: f32, uv: Vec2, tables: &Tables) -> Vec4 {
        let (level, part) = self.levels(halvings);
        let near = self.bilinear(level, uv, tables);
        if part > 0.0 { near.lerp(self.bilinear(level + 1, uv, tables), part) } else { near }
    }

    /// The mean over a footprint: several samples along its longer side, each as wide as the shorter one.
    fn sample(&self, at: &Footprint, tables: &Tables) -> Vec4 {
        let size = Vec2::new(self.base.width() as f32, self.base.height() as f32);
        let (right, below) = ((at.right * size).length(), (at.below * size).length());
        let (long, short, way) =
            if right > below { (right, below, at.right) } else { (below, right, at.below) };
        if !(long > 0.0 && long.is_finite()) {
            return self.trilinear(0.0, at.uv, tables);
        }
        let taps = (long / short.max(1.0)).ceil().clamp(1.0, MOST_TAPS);
        let halvings = log2(short.max(long / taps));
        let mut sum = Vec4::ZERO;
        for tap in 0..taps as usize {
            let part = (tap as f32 + 0.5) / taps - 0.5;
            sum += self.trilinear(halvings, at.uv + way * part, tables);
        }
        sum / taps
    }
}

/// The four texels about a place of an image that repeats: where they begin among its bytes, the upper two first.
#[derive(Debug, Clone, Copy)]
struct Near {
    starts: [usize; 4],
    /// Fraction of the way from the left ones to the right ones, and from the upper to the lower.
    across: f32,
    down: f32,
}

impl Near {
    #[inline]
    fn new(image: &Image, uv: Vec2) -> Self {
        let place = |u: f32, side: u32| {
            let at = (u - math::floor(u)) * side as f32 + side as f32 - 0.5;
            // From the last texel of the tile before to the last one of this: no division is needed.
            let whole = at as u32;
            let here = if whole >= side { whole - side } else { whole }.min(side - 1);
            let next = if here + 1 == side { 0 } else { here + 1 };
            (here as usize, next as usize, at - whole as f32)
        };
        let ((left, right, across), (upper, lower, down)) =
            (place(uv.x, image.width()), place(uv.y, image.height()));
        let (width, channels) = (image.width() as usize, usize::from(image.channels()));
        let [upper, lower] = [upper, lower].map(|row| row * width);
        let starts = [upper + left, upper + right, lower + left, lower + right].map(|at| at * channels);
        Self { starts, across, down }
    }
}

/// Values of an image's bytes, as light and as they are.
#[derive(Debug)]
struct Tables {
    linear: Vec<f32>,
    plain: Vec<f32>,
}

impl Tables {
    fn new() -> Self {
        let part = |i: u16| f32::from(i) / 255.0;
        Self {
            linear: (0..256).map(|i| math::linear(part(i))).collect(),
            plain: (0..256).map(part).collect(),
        }
    }
}

/// The images of one material, ready to be drawn.
#[derive(Debug)]
pub(super) struct Wear<'a> {
    tables: Tables,
    color: Option<Map<'a>>,
    normal: Option<Map<'a>>,
    occlusion_roughness: Option<Map<'a>>,
    transmission: Option<Map<'a>>,
    /// Alpha below which nothing is drawn; only with an image that has alpha.
    cutoff: Option<f32>,
}

impl<'a> Wear<'a> {
    pub(super) fn new(textures: &'a Textures) -> Self {
        let cutoff = textures.alpha_cutoff().filter(|_| textures.is_masked());
        let map =
            |image: Option<&'a Image>, is_color, cutoff| image.map(|image| Map::new(image, is_color, cutoff));
        Self {
            color: map(textures.base_color(), true, cutoff),
            normal: map(textures.normal(), false, None),
            occlusion_roughness: map(textures.occlusion_roughness_metallic(), false, None),
            transmission: map(textures.transmission(), true, None),
            cutoff,
            tables: Tables::new(),
        }
    }

    /// The colour, linear; white if there is no image of it.
    pub(super) fn color(&self, at: &Footprint) -> Vec3 {
        self.color.as_ref().map_or(Vec3::ONE, |map| map.sample(at, &self.tables).xyz())
    }

    /// The normal in tangent space, up the image as +Y; not normalized.
    pub(super) fn normal(&self, at: &Footprint) -> Option<Vec3> {
        let normal = self.normal.as_ref()?.sample(at, &self.tables).xyz() * 2.0 - 1.0;
        Some(normal)
    }

    /// Occlusion and roughness.
    pub(super) fn occlusion_roughness(&self, at: &Footprint) -> Option<(f32, f32)> {
        let texel = self.occlusion_roughness.as_ref()?.sample(at, &self.tables);
        Some((texel.x, texel.y))
    }

    /// The colour of light from behind.
    pub(super) fn transmission(&self, at: &Footprint) -> Option<Vec3> {
        Some(self.transmission.as_ref()?.sample(at, &self.tables).xyz())
    }

    pub(super) fn is_masked(&self) -> bool {
        self.cutoff.is_some()
    }

    /// `true` if there is something at a place, seen at this many halvings.
    fn is_there(&self, uv: Vec2, halvings: f32) -> bool {
        let (Some(map), Some(cutoff)) = (&self.color, self.cutoff) else { return true };
        let (level, part) = map.levels(halvings);
        let near = map.alpha(level, uv);
        let alpha = if part > 0.0 { near * (1.0 - part) + map.alpha(level + 1, uv) * part } else { near };
        alpha >= cutoff
    }

    /// The part of a triangle that is not cut out.
    pub(super) fn share(&self, uvs: [Vec2; 3]) -> f32 {
        let Some(map) = &self.color else { return 1.0 };
        let extent = uvs[0].max(uvs[1]).max(uvs[2]) - uvs[0].min(uvs[1]).min(uvs[2]);
        let texels = extent * Vec2::new(map.base.width() as f32, map.base.height() as f32);
        let halvings = log2(texels.max_element() / (2 * SHARE_GRID) as f32);
        let (mut there, mut all) = (0.0, 0.0);
        for i in 0..SHARE_GRID {
            for j in 0..SHARE_GRID - i {
                let part = |i: usize| (i as f32 + 0.333) / SHARE_GRID as f32;
                let (a, b) = (part(i), part(j));
                let uv = uvs[0] * (1.0 - a - b) + uvs[1] * a + uvs[2] * b;
                all += 1.0;
                there += if self.is_there(uv, halvings) { 1.0 } else { 0.0 };
            }
        }
        there / all
    }
}

/// A triangle with holes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cut<'a> {
    pub(super) wear: &'a Wear<'a>,
    pub(super) uvs: [Vec2; 3],
    /// The part of it that is there.
    pub(super) share: f32,
}

impl<'a> Cut<'a> {
    /// The triangle where it is seen: columns, rows, and nearness, which counts only in perspective.
    pub(super) fn on(&self, places: [Vec3; 3], perspective: bool) -> Cutout<'a> {
        let Self { wear, uvs, .. } = *self;
        let flat = Flat { places, uvs, perspective };
        let texels =
            wear.color.as_ref().map_or(1.0, |map| map.base.width() as f32 * map.base.height() as f32);
        let area = (uvs[1] - uvs[0]).perp_dot(uvs[2] - uvs[0]).abs() * texels;
        let seen = super::raster::double_area(places).abs();
        Cutout { wear, flat, halvings: 0.5 * log2(area / seen.max(1e-9)) }
    }
}

/// A triangle with holes, where it is seen.
pub(super) struct Cutout<'a> {
    wear: &'a Wear<'a>,
    flat: Flat,
    halvings: f32,
}

impl Cutout<'_> {
    /// `true` if there is something at a column and row.
    #[inline]
    pub(super) fn is_there(&self, x: f32, y: f32) -> bool {
        self.flat.uv(x, y, true).is_none_or(|uv| self.wear.is_there(uv, self.halvings))
    }
}

/// Texture coordinates over a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Flat {
    pub(super) places: [Vec3; 3],
    pub(super) uvs: [Vec2; 3],
    pub(super) perspective: bool,
}

impl Flat {
    /// The weights of the corners at a place of the picture; within the triangle only, if so asked.
    fn weights(&self, x: f32, y: f32, within: bool) -> Option<Vec3> {
        let places = self.places;
        let place = Vec3::new(x, y, 0.0);
        let whole = super::raster::double_area(places);
        let share = |a: Vec3, b: Vec3| super::raster::double_area([a, b, place]) / whole;
        let (second, third) = (share(places[2], places[0]), share(places[0], places[1]));
        let mut weights = Vec3::new(1.0 - second - third, second, third);
        if within {
            weights = weights.max(Vec3::ZERO);
        }
        if self.perspective {
            weights *= Vec3::new(places[0].z, places[1].z, places[2].z);
        }
        let sum = weights.element_sum();
        (sum > 0.0 && sum.is_finite()).then(|| weights / sum)
    }

    fn uv(&self, x: f32, y: f32, within: bool) -> Option<Vec2> {
        let weights = self.weights(x, y, within)?;
        Some(self.uvs[0] * weights.x + self.uvs[1] * weights.y + self.uvs[2] * weights.z)
    }

    /// Area that a pixel of some samples covers.
    pub(super) fn footprint(&self, x: f32, y: f32, samples: f32) -> Footprint {
        let middle = Footprint { uv: self.uvs.iter().sum::<Vec2>() / 3.0, ..self.whole() };
        let Some(uv) = self.uv(x, y, true) else { return middle };
        let step = |x: f32, y: f32| self.uv(x, y, false);
        match (step(x, y), step(x + samples, y), step(x, y + samples)) {
            (Some(here), Some(right), Some(below)) => {
                Footprint { uv, right: right - here, below: below - here }
            }
            _ => Footprint { uv, ..middle },
        }
    }

    /// The triangle as a whole: about as wide as its edges.
    pub(super) fn whole(&self) -> Footprint {
        let [a, b, c] = self.uvs;
        Footprint { uv: (a + b + c) / 3.0, right: 0.5 * (b - a), below: 0.5 * (c - a) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checks(side: u32) -> Image {
        let texel = |i: u32| {
            let is_there = (i % side / 4 + i / side / 4).is_multiple_of(3);
            [200, 100, 50, if is_there { 255 } else { 0 }]
        };
        Image::new(side, side, 4, (0..side * side).flat_map(texel).collect()).expect("sizes are right")
    }

    #[test]
    fn coverage_is_kept_in_every_mip() {
        let image = checks(128);
        let map = Map::new(&image, true, Some(0.5));
        let whole = texture::alpha_coverage(&image, 0.5, 1.0);
        assert_eq!(map.smaller.len(), 7);
        for smaller in &map.smaller[..4] {
            let kept = texture::alpha_coverage(smaller, 0.5, 1.0);
            assert!((kept - whole).abs() < 0.1, "{kept} of {whole} at {} pixels", smaller.width());
        }
    }

    #[test]
    fn mips_keep_the_light() {
        let image = Image::new(2, 1, 3, vec![255, 255, 255, 0, 0, 0]).expect("sizes are right");
        let map = Map::new(&image, true, None);
        assert_eq!(map.smaller[0].bytes(), [188; 3], "half of the light is 188 in sRGB");
    }

    #[test]
    fn alpha_is_the_fourth_channel() {
        let (image, tables) = (checks(16), Tables::new());
        let map = Map::new(&image, true, Some(0.5));
        for i in 0..500_u32 {
            let uv = Vec2::new((i * 37 % 400) as f32 / 97.0 - 2.0, (i * 91 % 300) as f32 / 61.0 - 3.0);
            for level in 0..=map.smaller.len() {
                assert!((map.bilinear(level, uv, &tables).w - map.alpha(level, uv)).abs() < 1e-6);
            }
            assert_eq!(math::floor(uv.x).to_bits(), (uv.x.floor() + 0.0).to_bits());
        }
        for odd in [f32::NAN, f32::INFINITY, 1e30, -1e30] {
            assert!(map.alpha(0, Vec2::splat(odd)).is_finite() || odd.is_nan() || odd.is_infinite());
        }
    }

    #[test]
    fn a_tile_repeats() {
        let image = checks(16);
        let (map, tables) = (Map::new(&image, true, None), Tables::new());
        for uv in [Vec2::new(0.3, 0.7), Vec2::new(0.99, 0.01)] {
            let far = uv + Vec2::new(3.0, -2.0);
            assert!(map.bilinear(0, uv, &tables).abs_diff_eq(map.bilinear(0, far, &tables), 1e-4));
        }
    }
}
