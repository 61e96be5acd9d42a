//! Images in ever smaller sizes, whose holes stay as large.

use super::Image;
use super::tone::Tones;
use crate::math;

/// The share of an image's pixels whose alpha, times `scale`, is not below `cutoff`; 1 for an image
/// without alpha.
///
/// ```
/// use treesynth::texture::alpha_coverage;
/// use treesynth::texture::Image;
///
/// let half = Image::new(2, 1, 4, vec![9, 9, 9, 255, 9, 9, 9, 100])?;
/// assert_eq!((alpha_coverage(&half, 0.5, 1.0), alpha_coverage(&half, 0.5, 2.0)), (0.5, 1.0));
/// # Ok::<(), treesynth::texture::TextureError>(())
/// ```
pub fn alpha_coverage(image: &Image, cutoff: f32, scale: f32) -> f32 {
    if !image.has_alpha() {
        return 1.0;
    }
    let covered =
        image.bytes().chunks_exact(4).filter(|pixel| f32::from(pixel[3]) * scale >= cutoff * 255.0).count();
    covered as f32 / (image.width() * image.height()) as f32
}

/// The image in ever smaller sizes, each half as wide and high as the one before, down to 1 x 1; itself first. For colours
/// in sRGB: they are averaged as light.
///
/// With a cutoff the alpha of each size is scaled so that the share that is shown stays that of the image (Castaño 2010, "Computing
/// Alpha Mipmaps"): on 16 points per pixel, between four pixels each, as renderers see it. It cannot be kept
/// where less than a pixel would be left. O(pixels).
pub fn mips(image: &Image, cutoff: Option<f32>) -> Vec<Image> {
    let linear: Vec<f32> = (0..256).map(|tone| math::linear(tone as f32 / 255.0)).collect();
    let tones = Tones::new();
    let has_alpha = image.has_alpha();
    let mut all = halvings(image, |texels, out| {
        // Clear texels have colours too: they are bled from those beside them.
        for i in 0..3.min(out.len()) {
            let weight = |texel: &[u8]| if has_alpha { f32::from(texel[3]) + 0.5 } else { 1.0 };
            let sum: f32 = texels.iter().map(|texel| weight(texel)).sum();
            let mean: f32 = texels.iter().map(|texel| weight(texel) * linear[usize::from(texel[i])]).sum();
            out[i] = tones.of(mean / sum);
        }
        if has_alpha {
            let sum: u32 = texels.iter().map(|texel| u32::from(texel[3])).sum();
            out[3] = (sum as f32 / texels.len() as f32 + 0.5) as u8;
        }
    });
    if let Some(cutoff) = cutoff.filter(|_| has_alpha) {
        let wanted = shown(&alphas(image), image.width(), image.height(), cutoff);
        for small in &mut all[1..] {
            *small = keeping_coverage(small, cutoff, wanted);
        }
    }
    all
}

/// The same of numbers that are not colours: plain means of all channels.
#[cfg(feature = "preview")]
pub(crate) fn plain_mips(image: &Image) -> Vec<Image> {
    halvings(image, |texels, out| {
        for (i, out) in out.iter_mut().enumerate() {
            let sum: u32 = texels.iter().map(|texel| u32::from(texel[i])).sum();
            *out = ((sum + 2) / 4) as u8;
        }
    })
}

/// The same of normals in tangent space; they stay of length 1.
pub(crate) fn normal_mips(image: &Image) -> Vec<Image> {
    halvings(image, |texels, out| {
        let sum = |i: usize| texels.iter().map(|texel| f32::from(texel[i]) - 127.5).sum::<f32>();
        let normal = glam::Vec3::new(sum(0), sum(1), sum(2)).normalize_or(glam::Vec3::Z);
        out.copy_from_slice(&normal.to_array().map(|channel| (channel * 127.5 + 128.0) as u8));
    })
}

/// The most that alpha is multiplied or divided by.
const SCALE: f32 = 20.0;
/// Halvings of that range, as a power.
const STEPS: u32 = 11;
/// Points along each side of a texel at which cover is measured; a power of two.
const POINTS: u32 = 4;

/// The share of an image that a renderer shows, which asks the mean of the four texels about each point and not the nearest:
/// a texel alone among clear ones hides 0.6 of itself. `alpha` is in 0 to 255 by texels, rows one by one.
fn shown(alpha: &[u8], width: u32, height: u32, cutoff: f32) -> f32 {
    // Points are at odd multiples of 1 / (2 · POINTS) of a texel, so that weights are whole numbers.
    let whole = 2 * POINTS;
    let least = (cutoff * 255.0 * (whole * whole) as f32).ceil().max(0.0) as u32;
    let at = |x: u32, y: u32| u32::from(alpha[(y * width + x) as usize]);
    let mut count = 0u64;
    for y in 0..height {
        let below = if y + 1 < height { y + 1 } else { 0 };
        for x in 0..width {
            let beside = if x + 1 < width { x + 1 } else { 0 };
            let four = [at(x, y), at(beside, y), at(x, below), at(beside, below)];
            let (most, fewest) = (four.iter().max(), four.iter().min());
            if most.is_some_and(|most| most * whole * whole < least) {
                continue;
            }
            if fewest.is_some_and(|fewest| fewest * whole * whole >= least) {
                count += u64::from(POINTS * POINTS);
                continue;
            }
            for j in 0..POINTS {
                let down = 2 * j + 1;
                let left = four[0] * (whole - down) + four[2] * down;
                let right = four[1] * (whole - down) + four[3] * down;
                let across = |i: &u32| left * (whole - 2 * i - 1) + right * (2 * i + 1) >= least;
                count += (0..POINTS).filter(across).count() as u64;
            }
        }
    }
    count as f32 / (u64::from(width) * u64::from(height) * u64::from(POINTS * POINTS)) as f32
}

/// The alpha channel.
fn alphas(image: &Image) -> Vec<u8> {
    image.bytes().chunks_exact(4).map(|pixel| pixel[3]).collect()
}

/// The image with its alpha scaled so that about the share `wanted` is [shown].
fn keeping_coverage(image: &Image, cutoff: f32, wanted: f32) -> Image {
    let (width, height, own) = (image.width(), image.height(), alphas(image));
    let scaled = |scale: f32| -> Vec<u8> {
        own.iter().map(|alpha| (f32::from(*alpha) * scale + 0.5).min(255.0) as u8).collect()
    };
    let off = |scale: f32| shown(&scaled(scale), width, height, cutoff) - wanted;
    let (mut low, mut high) = (1.0 / SCALE, SCALE);
    for _ in 0..STEPS {
        let middle = (low * high).sqrt();
        if off(middle) < 0.0 { low = middle } else { high = middle }
    }
    let scale = if off(high).abs() <= off(low).abs() { high } else { low };
    let mut bytes = image.bytes().to_vec();
    for (pixel, alpha) in bytes.chunks_exact_mut(4).zip(scaled(scale)) {
        pixel[3] = alpha;
    }
    Image::new(width, height, 4, bytes).unwrap_or_else(|_| image.clone())
}

/// The image, and each half of the one before, a pixel `of` the up to four that it stands for.
fn halvings(image: &Image, of: impl Fn(&[&[u8]], &mut [u8])) -> Vec<Image> {
    let mut all = vec![image.clone()];
    let channels = usize::from(image.channels());
    loop {
        let last = &all[all.len() - 1];
        if last.width().max(last.height()) == 1 {
            return all;
        }
        let (width, height) = ((last.width() / 2).max(1), (last.height() / 2).max(1));
        let (across, down) = (last.width() / width, last.height() / height);
        let mut bytes = vec![0; width as usize * height as usize * channels];
        for (i, out) in bytes.chunks_exact_mut(channels).enumerate() {
            let (x, y) = (i as u32 % width * across, i as u32 / width * down);
            let texel = |i: u32| last.pixel(x + i % 2 * (across - 1), y + i / 2 * (down - 1));
            of(&[texel(0), texel(1), texel(2), texel(3)], out);
        }
        match Image::new(width, height, image.channels(), bytes) {
            Ok(half) => all.push(half),
            Err(_) => return all,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, unit};

    /// Discs of all sizes, soft at the rim, as leaves in an image.
    fn leafy(size: u32, discs: u64) -> Image {
        let mut bytes = vec![0; (size * size * 4) as usize];
        for disc in 0..discs {
            let draw = |stage| unit(3, stage, Purpose::CUSTOM, disc);
            let (x, y, r) = (draw(0) * size as f32, draw(1) * size as f32, 2.0 + draw(2) * 6.0);
            for (i, pixel) in bytes.chunks_exact_mut(4).enumerate() {
                let (dx, dy) = ((i as u32 % size) as f32 + 0.5 - x, (i as u32 / size) as f32 + 0.5 - y);
                let cover = (r - (dx * dx + dy * dy).sqrt() + 0.5).clamp(0.0, 1.0);
                pixel[3] = pixel[3].max((cover * 255.0) as u8);
                pixel[..3].copy_from_slice(&[60, 110, 40]);
            }
        }
        Image::new(size, size, 4, bytes).expect("sizes are right")
    }

    #[test]
    fn alpha_keeps_its_coverage_in_every_size() {
        for discs in [5, 20, 80, 200] {
            let image = leafy(128, discs);
            for cutoff in [0.3, 0.5, 0.7] {
                let share = |image: &Image| shown(&alphas(image), image.width(), image.height(), cutoff);
                let wanted = share(&image);
                for small in mips(&image, Some(cutoff)) {
                    let pixels = (small.width() * small.height()) as f32;
                    let off = (share(&small) - wanted).abs();
                    // Half a pixel is as near as it gets; alpha is in 256 steps.
                    assert!(
                        off <= 0.01 + 1.0 / pixels,
                        "{discs} discs, {cutoff}: {off} off at {pixels} pixels"
                    );
                }
            }
        }
    }

    #[test]
    fn without_care_coverage_is_lost() {
        let image = leafy(128, 20);
        let (wanted, small) = (alpha_coverage(&image, 0.5, 1.0), &mips(&image, None)[5]);
        assert!((alpha_coverage(small, 0.5, 1.0) - wanted).abs() > 0.1, "the test above would show nothing");
    }

    #[test]
    fn sizes_go_down_to_one_pixel_and_colors_stay() {
        let sizes: Vec<_> =
            mips(&leafy(16, 4), Some(0.5)).iter().map(|image| (image.width(), image.height())).collect();
        assert_eq!(sizes, [(16, 16), (8, 8), (4, 4), (2, 2), (1, 1)]);
        let flat = Image::new(8, 2, 3, [60, 110, 40].repeat(16)).expect("sizes are right");
        let all = mips(&flat, None);
        assert_eq!(all.len(), 4);
        assert!(all.iter().all(|image| image.pixel(0, 0) == [60, 110, 40]));
    }
}
