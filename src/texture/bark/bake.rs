//! From a pattern to images.

use super::lanes::{Quad, bytes};
use super::noise::Lines;
use super::pattern::Pattern;
use super::{Bark, BarkSet};
use crate::parallel;
use crate::texture::Tones;
use crate::texture::{Image, TextureError, Textures};
use glam::Vec4;

/// Cells per side of the coarse grid that tells hollows from tops.
const COARSE: usize = 64;
/// Darkening of a hollow as deep as the tile's whole depth, as a share of the light of the sky.
const SHADING: f32 = 1.1;
/// Rounds in which the mean colour is brought to what was asked for; more than one only where colours are cut off at white.
const ROUNDS: usize = 6;

/// One row of a bark before it is cut into bytes.
struct Row {
    /// With the last pixel's before the first, and the first's behind the last.
    heights: Vec<f32>,
    /// Red, then green, then blue.
    colors: [Vec<f32>; 3],
    roughness: Vec<u8>,
}

impl Row {
    fn new(pattern: &impl Pattern, lines: &Lines<'_>, y: f32, side: usize) -> Self {
        let lines = lines.at(y);
        let mut heights = vec![0.0; side + 2];
        let mut colors = [(); 3].map(|()| vec![0.0; side]);
        let mut roughness = Vec::with_capacity(side);
        for (i, quad) in Quad::all(side, y, &lines).enumerate() {
            let spot = pattern.at(&quad);
            spot.height.clamp(Vec4::ZERO, Vec4::ONE).write_to_slice(&mut heights[4 * i + 1..]);
            for (line, channel) in colors.iter_mut().zip(spot.color) {
                channel.write_to_slice(&mut line[4 * i..]);
            }
            roughness.extend(bytes(spot.roughness));
        }
        (heights[0], heights[side + 1]) = (heights[side], heights[1]);
        Self { heights, colors, roughness }
    }

    fn heights(&self) -> &[f32] {
        &self.heights[1..self.heights.len() - 1]
    }
}

/// The pixels of a bark with this pattern.
pub(super) fn bake(bark: &Bark, pattern: &impl Pattern) -> Result<BarkSet, TextureError> {
    let side = bark.resolution as usize;
    let scale = 1.0 / side as f32;
    let lines = Lines::new(&pattern.plain(), side);
    let mut rows = parallel::map(side, |y| Row::new(pattern, &lines, (y as f32 + 0.5) * scale, side));
    let gains = balance(&mut rows, bark.linear_color(), bark.spread);
    let tones = Tones::new();
    let depth = bark.relief();
    // A slope is metres over metres, from the neighbours on both sides.
    let steep = depth * side as f32 / (2.0 * bark.size);
    let coarse = Coarse::new(&rows);
    let places: Vec<Between> = (0..side).map(|x| coarse.between(x, side)).collect();
    let shading = SHADING * 3.0 * bark.hollows();
    let lines = parallel::map(side, |y| {
        let (above, here, below) = (&rows[(y + side - 1) % side], &rows[y], &rows[(y + 1) % side]);
        let middles = coarse.line(&coarse.between(y, side));
        let mut line = Line::with_capacity(side);
        for first in (0..side).step_by(4) {
            let at = |row: &Row, step: usize| Vec4::from_slice(&row.heights[first + step..]);
            let height = at(here, 1);
            // Up the image is against v.
            let dx = steep * (at(here, 0) - at(here, 2));
            let dy = steep * (at(below, 1) - at(above, 1));
            let half = 0.5 / (dx * dx + dy * dy + 1.0).sqrt();
            line.normal.extend(interleaved([
                bytes(0.5 + dx * half),
                bytes(0.5 + dy * half),
                bytes(0.5 + half),
            ]));
            let color = [0, 1, 2].map(|channel| {
                tones.of_four(Vec4::from_slice(&here.colors[channel][first..]) * gains[channel])
            });
            line.color.extend(interleaved(color));
            let middle = Vec4::from_array(std::array::from_fn(|i| places[first + i].of(&middles)));
            let open = 1.0 / (1.0 + shading * (middle - height).max(Vec4::ZERO));
            let roughness = std::array::from_fn(|i| here.roughness[first + i]);
            line.occlusion.extend(interleaved([bytes(open), roughness, [0; 4]]));
            line.height.extend(bytes(height));
        }
        line
    });
    let mut all = Line::with_capacity(side * side);
    for line in lines {
        all.color.extend_from_slice(&line.color);
        all.normal.extend_from_slice(&line.normal);
        all.occlusion.extend_from_slice(&line.occlusion);
        all.height.extend_from_slice(&line.height);
    }
    let image = |channels, bytes| Image::new(bark.resolution, bark.resolution, channels, bytes);
    let textures = Textures::default()
        .with_base_color(image(3, all.color)?)
        .with_normal(image(3, all.normal)?)
        .with_occlusion_roughness_metallic(image(3, all.occlusion)?);
    Ok(BarkSet { textures, height: image(1, all.height)?, size: bark.size, depth })
}

/// The bytes of the four maps.
struct Line {
    color: Vec<u8>,
    normal: Vec<u8>,
    occlusion: Vec<u8>,
    height: Vec<u8>,
}

impl Line {
    fn with_capacity(pixels: usize) -> Self {
        let of = |channels| Vec::with_capacity(pixels * channels);
        Self { color: of(3), normal: of(3), occlusion: of(3), height: of(1) }
    }
}

/// Three channels of four pixels, pixel by pixel.
#[inline]
fn interleaved([r, g, b]: [[u8; 4]; 3]) -> [u8; 12] {
    [r[0], g[0], b[0], r[1], g[1], b[1], r[2], g[2], b[2], r[3], g[3], b[3]]
}

/// The mean of `of` over a channel of all rows; summed row by row in lanes, so that threads do not
/// matter.
fn mean(rows: &[Row], channel: usize, of: impl Fn(Vec4) -> Vec4 + Sync + Send) -> f32 {
    let sums = parallel::map(rows.len(), |y| {
        let quads = rows[y].colors[channel].chunks_exact(4);
        let sum = quads.fold(Vec4::ZERO, |sum, quad| sum + of(Vec4::from_slice(quad)));
        sum.to_array().into_iter().map(f64::from).sum::<f64>()
    });
    (sums.into_iter().sum::<f64>() / (rows.len() * rows.len()) as f64) as f32
}

/// Spreads colours about their mean, and returns what they are to be multiplied by for the mean that is wanted.
fn balance(rows: &mut [Row], wanted: [f32; 3], spread: f32) -> [f32; 3] {
    let mut gains = [1.0f32; 3];
    for (channel, gain) in gains.iter_mut().enumerate() {
        if (spread - 1.0).abs() > 0.0 {
            let middle = mean(rows, channel, |value| value);
            parallel::each_mut(rows, |_, row| {
                for value in &mut row.colors[channel] {
                    *value = (middle + spread * (*value - middle)).max(0.0);
                }
            });
        }
        let most =
            rows.iter().flat_map(|row| &row.colors[channel]).fold(0.0f32, |most, &value| most.max(value));
        for _ in 0..ROUNDS {
            let now = mean(rows, channel, |value| (value * *gain).min(Vec4::ONE));
            let factor = wanted[channel] / now.max(1e-9);
            *gain *= factor;
            if (factor - 1.0).abs() < 1e-4 || most * *gain <= 1.0 {
                break;
            }
        }
    }
    gains
}

/// Mean heights of squares of pixels, blurred.
struct Coarse {
    side: usize,
    heights: Vec<f32>,
}

/// The two cells of the coarse grid between which a pixel lies, and the fraction of the way.
struct Between {
    before: usize,
    behind: usize,
    way: f32,
}

impl Between {
    #[inline]
    fn of(&self, line: &[f32]) -> f32 {
        line[self.before] + (line[self.behind] - line[self.before]) * self.way
    }
}

impl Coarse {
    fn new(rows: &[Row]) -> Self {
        let side = rows.len().min(COARSE);
        let block = rows.len() / side;
        let means = parallel::map(side, |y| {
            let mut sums = vec![0.0f32; side];
            for row in &rows[y * block..(y + 1) * block] {
                for (sum, heights) in sums.iter_mut().zip(row.heights().chunks_exact(block)) {
                    *sum += heights.iter().sum::<f32>();
                }
            }
            sums.into_iter().map(|sum| sum / (block * block) as f32).collect::<Vec<_>>()
        });
        let blur = |x: usize, y: usize| {
            let around = |i: usize, step: usize| (i + side + step - 1) % side;
            let mut sum = 0.0;
            for (i, weight) in [1.0, 2.0, 1.0].into_iter().enumerate() {
                let line = &means[around(y, i)];
                sum += weight * (line[around(x, 0)] + 2.0 * line[x] + line[around(x, 2)]);
            }
            sum / 16.0
        };
        let heights = (0..side * side).map(|i| blur(i % side, i / side)).collect();
        Self { side, heights }
    }

    /// Place of a pixel between the grid's cells, along either axis, for `pixels` per side.
    fn between(&self, pixel: usize, pixels: usize) -> Between {
        let at = (pixel as f32 + 0.5) * self.side as f32 / pixels as f32 + self.side as f32 - 0.5;
        let whole = at as usize;
        Between { before: whole % self.side, behind: (whole + 1) % self.side, way: at - whole as f32 }
    }

    /// The heights along a row of pixels.
    fn line(&self, row: &Between) -> Vec<f32> {
        let side = self.side;
        let (upper, lower) =
            (&self.heights[row.before * side..][..side], &self.heights[row.behind * side..][..side]);
        upper.iter().zip(lower).map(|(upper, lower)| upper + (lower - upper) * row.way).collect()
    }
}
