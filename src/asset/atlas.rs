//! Baked pictures side by side in one image: colours bled under the edge, normals, light from behind.

use super::AssetError;
use super::bake::{Baked, Pixel};
use crate::observer::Watch;
use crate::texture::{Image, Textures, Tones};
use glam::Vec3;

/// Empty pixels about what is drawn in a cell, at full size.
pub(super) const PADDING: usize = 4;
/// Share of the light from behind that one layer of leaves lets through; each further layer lets through the
/// same share.
const THROUGH: f32 = 0.45;
/// Colour of the light that passes a leaf, relative to that of the light it reflects: yellower, brighter.
const GLOW: [f32; 3] = [1.35, 1.5, 0.7];
/// Pixels with less cover are holes.
pub(super) const CUTOFF: f32 = 0.5;

/// Cells of one size, in columns and rows that are powers of two.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    pub(super) cell: usize,
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// `true` if there is a normal map.
    pub(super) normals: bool,
}

impl Grid {
    /// A grid of at least `cells` cells, each with sides of `cell` pixels; about as wide as high.
    pub(super) fn of(cells: usize, cell: usize) -> Self {
        let (mut columns, mut rows) = (1, 1);
        while columns * rows < cells {
            if columns > rows { rows *= 2 } else { columns *= 2 }
        }
        Self { cell, columns, rows, normals: true }
    }

    /// The corner of what is drawn in a cell, and its size, in texture coordinates.
    pub(super) fn inner(&self, cell: usize) -> ([f32; 2], [f32; 2]) {
        let (width, height) = ((self.columns * self.cell) as f32, (self.rows * self.cell) as f32);
        let (x, y) = (
            (cell % self.columns * self.cell + PADDING) as f32,
            (cell / self.columns * self.cell + PADDING) as f32,
        );
        let side = (self.cell - 2 * PADDING) as f32;
        ([x / width, y / height], [side / width, side / height])
    }
}

/// An atlas of pictures, each of the inner size of a cell, their colours multiplied by `gain`. Cells have at
/// least two pixels per side. Takes one step per 32 pixels.
pub(super) fn textures(
    grid: Grid,
    cells: &[Baked],
    gain: [f32; 3],
    cutoff: Option<f32>,
    watch: &Watch<'_>,
) -> Result<Textures, AssetError> {
    let Grid { cell, columns, rows, normals: has_normals } = grid;
    let (width, height) = (columns * cell, rows * cell);
    let tones = Tones::new();
    let mut color = vec![0; width * height * 4];
    let mut normal = if has_normals { [128u8, 128, 255].repeat(width * height) } else { Vec::new() };
    // Light from behind is soft: half as many pixels each way are enough.
    let (wide, high) = (width / 2, height / 2);
    let mut glow = vec![0.0f32; wide * high * 3];
    for (number, baked) in cells.iter().enumerate() {
        watch.pass(cell * cell / 32)?;
        let filled = bled(&framed(baked, cell), cell);
        let (left, top) = (number % columns * cell, number / columns * cell);
        for (i, pixel) in filled.iter().enumerate() {
            let at = (top + i / cell) * width + left + i % cell;
            let (row, column) = (top + i / cell, left + i % cell);
            let behind = (row / 2 * wide + column / 2) * 3;
            let through = through(pixel.layers);
            for channel in 0..3 {
                let tone = pixel.color[channel] * gain[channel];
                color[at * 4 + channel] = tones.of(tone);
                glow[behind + channel] += 0.25 * tone * GLOW[channel] * through;
                if has_normals {
                    normal[at * 3 + channel] = (pixel.normal[channel] * 127.5 + 128.0) as u8;
                }
            }
            color[at * 4 + 3] = (pixel.cover * 255.0 + 0.5) as u8;
        }
    }
    watch.pass(width * height / 32)?;
    let transmission = glow.into_iter().map(|channel| tones.of(channel)).collect();
    let (width, height) = (width as u32, height as u32);
    let mut textures = Textures::default()
        .with_base_color(Image::new(width, height, 4, color)?)
        .with_transmission(Image::new(wide as u32, high as u32, 3, transmission)?);
    if has_normals {
        textures = textures.with_normal(Image::new(width, height, 3, normal)?);
    }
    Ok(match cutoff {
        Some(cutoff) => textures.with_alpha_cutoff(cutoff),
        None => textures,
    })
}

/// Light that passes `layers` layers of leaves, relative to one leaf.
fn through(layers: f32) -> f32 {
    THROUGH.sqrt() * crate::math::powf(THROUGH, (layers - 1.0).max(0.0))
}

/// The picture in the middle of a cell.
fn framed(baked: &Baked, cell: usize) -> Vec<Pixel> {
    let (left, top) = ((cell - baked.width) / 2, (cell - baked.height) / 2);
    let mut pixels = vec![Pixel::default(); cell * cell];
    for (row, line) in baked.pixels.chunks_exact(baked.width).enumerate() {
        let at = (top + row) * cell + left;
        pixels[at..at + baked.width].copy_from_slice(line);
    }
    pixels
}

/// The picture with colours, normals and layers wherever there are none, from what is near: smaller and smaller pictures of
/// what there is, then back (Gortler et al. 1996, "The Lumigraph", push and pull). `side` is a power of two.
pub(super) fn bled(pixels: &[Pixel], side: usize) -> Vec<Pixel> {
    if side == 1 {
        let mut one = pixels.to_vec();
        if one[0].cover == 0.0 {
            one[0].normal = Vec3::Z;
        }
        return one;
    }
    let half = side / 2;
    let mut small = vec![Pixel::default(); half * half];
    for (i, pixel) in small.iter_mut().enumerate() {
        let (x, y) = (i % half * 2, i / half * 2);
        let four =
            [y * side + x, y * side + x + 1, (y + 1) * side + x, (y + 1) * side + x + 1].map(|i| pixels[i]);
        let sum: f32 = four.iter().map(|pixel| pixel.cover).sum();
        if sum > 0.0 {
            for other in &four {
                let share = other.cover / sum;
                (0..3).for_each(|i| pixel.color[i] += other.color[i] * share);
                pixel.normal += other.normal * share;
                pixel.layers += other.layers * share;
            }
            pixel.normal = pixel.normal.normalize_or(Vec3::Z);
            pixel.cover = sum.min(1.0);
        }
    }
    let small = bled(&small, half);
    pixels
        .iter()
        .enumerate()
        .map(|(i, pixel)| {
            if pixel.cover > 0.0 {
                return *pixel;
            }
            let near = small[i / side / 2 * half + i % side / 2];
            Pixel { cover: 0.0, ..near }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_reach_every_empty_pixel() {
        for at in [0, 37, 255] {
            let mut pixels = vec![Pixel::default(); 256];
            pixels[at] =
                Pixel { color: [0.1, 0.5, 0.2], cover: 0.3, normal: Vec3::X, depth: 0.0, layers: 2.0 };
            let filled = bled(&pixels, 16);
            for (i, pixel) in filled.iter().enumerate() {
                assert_eq!((pixel.color, pixel.normal), ([0.1, 0.5, 0.2], Vec3::X));
                assert_eq!(pixel.cover > 0.0, i == at);
            }
        }
    }

    #[test]
    fn cells_lie_at_powers_of_two_and_are_padded() {
        for cells in 1..40 {
            let grid = Grid::of(cells, 64);
            assert!(grid.columns * grid.rows >= cells && grid.columns * grid.rows < 2 * cells.max(1));
            assert!(grid.columns.is_power_of_two() && grid.rows.is_power_of_two());
            for cell in 0..cells {
                let ([u, v], [across, down]) = grid.inner(cell);
                let (width, height) = ((grid.columns * 64) as f32, (grid.rows * 64) as f32);
                assert_eq!((u * width) as usize % 64, PADDING);
                assert_eq!((v * height) as usize % 64, PADDING);
                assert!(u + across < 1.0 && v + down < 1.0);
            }
        }
    }
}
