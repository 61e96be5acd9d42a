//! From a pattern to images.

use super::pattern::{Color, Pattern};
use super::{Bark, BarkSet};
use crate::parallel;
use crate::texture::Tones;
use crate::texture::{Image, TextureError, Textures};

/// Cells a side of the coarse grid by which hollows are told from tops.
const COARSE: usize = 64;
/// How much of the light of the sky is missing in a hollow as deep as the tile's whole depth.
const SHADING: f32 = 1.1;
/// Rounds in which the mean colour is brought to what was asked for; more than one only where colours are cut off at white.
const ROUNDS: usize = 6;

/// One row of a bark before it is cut into bytes.
struct Row {
    heights: Vec<f32>,
    colors: Vec<Color>,
    roughness: Vec<u8>,
}

/// The pixels of a bark with this pattern.
pub(super) fn bake(bark: &Bark, pattern: &impl Pattern) -> Result<BarkSet, TextureError> {
    let side = bark.resolution as usize;
    let scale = 1.0 / side as f32;
    let mut rows = parallel::map(side, |y| {
        let mut row = Row {
            heights: Vec::with_capacity(side),
            colors: Vec::with_capacity(side),
            roughness: Vec::with_capacity(side),
        };
        let y = (y as f32 + 0.5) * scale;
        for x in 0..side {
            let spot = pattern.at((x as f32 + 0.5) * scale, y);
            row.heights.push(spot.height.clamp(0.0, 1.0));
            row.colors.push(spot.color);
            row.roughness.push(byte(spot.roughness));
        }
        row
    });
    let gains = balance(&mut rows, bark.linear_color(), bark.spread);
    let tones = Tones::new();
    let depth = bark.relief();
    let coarse = Coarse::new(&rows);
    let lines = parallel::map(side, |y| {
        let heights = |y: usize| &rows[y].heights[..];
        let (above, here, below) = (heights((y + side - 1) % side), heights(y), heights((y + 1) % side));
        // A slope is metres over metres, from the neighbours on both sides.
        let steep = depth * side as f32 / (2.0 * bark.size);
        let mut line = Line::with_capacity(side);
        for x in 0..side {
            let right = here[if x + 1 == side { 0 } else { x + 1 }];
            let left = here[if x == 0 { side - 1 } else { x - 1 }];
            // Up the image is against v.
            let (dx, dy) = (steep * (left - right), steep * (below[x] - above[x]));
            let length = 1.0 / (dx * dx + dy * dy + 1.0).sqrt();
            line.normal.extend([dx, dy, 1.0].map(|part| byte(0.5 + 0.5 * part * length)));
            let color = rows[y].colors[x];
            line.color.extend([0, 1, 2].map(|channel| tones.of(color[channel] * gains[channel])));
            let below_mean = (coarse.at(x, y, side) - here[x]).max(0.0);
            let open = 1.0 / (1.0 + SHADING * below_mean * 3.0 * bark.hollows());
            line.occlusion.extend([byte(open), rows[y].roughness[x], 0]);
            line.height.push(byte(here[x]));
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

/// A number from 0 to 1 in 8 bits.
#[inline]
fn byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// The mean of a number over all colours, a channel; summed row by row, so that threads do not matter.
fn mean(rows: &[Row], of: impl Fn(f32, usize) -> f32 + Sync + Send) -> [f64; 3] {
    let sums = parallel::map(rows.len(), |y| {
        let mut sum = [0.0f64; 3];
        for color in &rows[y].colors {
            for channel in 0..3 {
                sum[channel] += f64::from(of(color[channel], channel));
            }
        }
        sum
    });
    let pixels = (rows.len() * rows.len()) as f64;
    let mut total = [0.0; 3];
    for sum in sums {
        for channel in 0..3 {
            total[channel] += sum[channel] / pixels;
        }
    }
    total
}

/// Spreads colours about their mean, and returns what they are to be multiplied by for the mean that is wanted.
fn balance(rows: &mut [Row], wanted: Color, spread: f32) -> Color {
    if (spread - 1.0).abs() > 0.0 {
        let middle = mean(rows, |value, _| value).map(|mean| mean as f32);
        parallel::each_mut(rows, |_, row| {
            for color in &mut row.colors {
                for (value, middle) in color.iter_mut().zip(middle) {
                    *value = (middle + spread * (*value - middle)).max(0.0);
                }
            }
        });
    }
    let mut gains = [1.0f32; 3];
    for _ in 0..ROUNDS {
        let now = mean(rows, |value, channel| (value * gains[channel]).min(1.0));
        let mut off = 0.0f32;
        for channel in 0..3 {
            let factor = (f64::from(wanted[channel]) / now[channel].max(1e-9)) as f32;
            gains[channel] *= factor;
            off = off.max((factor - 1.0).abs());
        }
        if off < 1e-4 || !rows.iter().flat_map(|row| &row.colors).any(|color| is_cut(color, gains)) {
            break;
        }
    }
    gains
}

fn is_cut(color: &Color, gains: Color) -> bool {
    color.iter().zip(gains).any(|(value, gain)| value * gain > 1.0)
}

/// Mean heights of squares of pixels, blurred.
struct Coarse {
    side: usize,
    heights: Vec<f32>,
}

impl Coarse {
    fn new(rows: &[Row]) -> Self {
        let side = rows.len().min(COARSE);
        let block = rows.len() / side;
        let means = parallel::map(side, |y| {
            let mut sums = vec![0.0f32; side];
            for row in &rows[y * block..(y + 1) * block] {
                for (sum, heights) in sums.iter_mut().zip(row.heights.chunks_exact(block)) {
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

    /// The blurred height at a pixel of `pixels` a side.
    #[inline]
    fn at(&self, x: usize, y: usize, pixels: usize) -> f32 {
        let side = self.side;
        let place = |i: usize| {
            let at = (i as f32 + 0.5) * side as f32 / pixels as f32 + side as f32 - 0.5;
            let whole = at as usize;
            (whole % side, (whole + 1) % side, at - whole as f32)
        };
        let ((left, right, dx), (upper, lower, dy)) = (place(x), place(y));
        let line = |row: usize| {
            let line = &self.heights[row * side..][..side];
            line[left] + (line[right] - line[left]) * dx
        };
        let (upper, lower) = (line(upper), line(lower));
        upper + (lower - upper) * dy
    }
}
