//! Likeness of two models of a tree.

use super::AssetError;
use super::bake::{Baked, Drawn, Raster, Sample, View, Wanted};
use super::skin::Skin;
use crate::math;
use crate::observer::Watch;
use crate::shape::Bounds;
use crate::surface::Part;
use crate::texture::{Image, Textures, Tones};
use crate::{ParameterError, parallel};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Points along each side of a pixel of a picture that is measured: four in all, as renderers have them.
pub(super) const SAMPLES: usize = 2;
/// Pictures in which a tree is lower than this, pixels, are drawn several times.
const LARGE: f32 = 120.0;
/// The greatest number of times.
const TIMES: f32 = 9.0;
/// Direction of the light, as the viewer sees it.
const LIGHT: Vec3 = Vec3::new(0.36, 0.73, 0.58);
/// Light from everywhere, and from there.
const AMBIENT: f32 = 0.35;
const DIRECT: f32 = 0.65;

/// Difference of a model from another, as a mean over views from all around.
///
/// Both are drawn at the same size, without perspective or shadows, in the same light.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Likeness {
    /// The area that the model hides relative to that of the other, less 1: 0.03 is 3% more.
    pub cover: f32,
    /// Distance between the mean colours, in CIE Lab of 1976 (D65): 2 is what an untrained eye sees side by
    /// side.
    pub color: f32,
    /// Structural similarity of the pictures' lightness on white, within the smallest box about the tree; 1 is the same (Wang et al. 2004).
    pub ssim: f32,
}

impl Likeness {
    /// Compares `model` with `full` from four sides, in pictures in which `full` is `pixels` pixels high, 8
    /// to 2048; small pictures are drawn up to nine times, each offset by part of a pixel from the others.
    ///
    /// # Errors
    /// A height out of range; parts that cannot be drawn; nothing to be seen.
    pub fn of(model: &[Part<'_>], full: &[Part<'_>], pixels: u32) -> Result<Self, AssetError> {
        ParameterError::unless((8..=2048).contains(&pixels), "Likeness.pixels", pixels, "8 to 2048")?;
        let frame = Frame::of(full, pixels as usize)?;
        check(model)?;
        let [ours, theirs] = [skins(model), skins(full)];
        let times = frame.times();
        let each = parallel::map(4 * times, |i| {
            let yaw = (i / times) as f32 / 4.0 * TAU + 0.3;
            let view = frame.view_beside(yaw, 0.12, i % times);
            let [ours, theirs] = [(model, &ours), (full, &theirs)].map(|(parts, skins)| {
                draw(
                    &drawn(parts, skins),
                    view,
                    [frame.width, frame.height],
                    SAMPLES,
                    Wanted::Surface,
                    &Watch::silent(),
                )
                .finish(lit)
            });
            (Tally::of(&ours), Tally::of(&theirs), ssim(&ours, &theirs))
        });
        let mut sums = [Tally::default(); 2];
        let mut similarity = 0.0;
        for (ours, theirs, ssim) in &each {
            sums[0].add(ours);
            sums[1].add(theirs);
            similarity += ssim / each.len() as f32;
        }
        let [ours, theirs] = sums;
        if theirs.cover == 0.0 {
            return Err(AssetError::Nothing);
        }
        let [a, b] = [ours, theirs].map(|tally| Vec3::from(lab(tally.color())));
        Ok(Self { cover: (ours.cover / theirs.cover) as f32 - 1.0, color: a.distance(b), ssim: similarity })
    }
}

/// A picture of a model without perspective, on white, lit from the upper right: turned by `yaw` about the vertical and seen
/// from `lift` above the horizon, radians; the model is `pixels` high, 8 to 4096, as seen from the side.
///
/// Textures are drawn in the size in which a renderer would take them; holes are cut out. No shadows: a quick look. See
/// [`preview`](https://docs.rs/treesynth/latest/treesynth/preview/) for pictures.
///
/// # Errors
/// A height out of range; parts that cannot be drawn; nothing to be seen.
pub fn portrait(parts: &[Part<'_>], yaw: f32, lift: f32, pixels: u32) -> Result<Image, AssetError> {
    ParameterError::unless((8..=4096).contains(&pixels), "portrait.pixels", pixels, "8 to 4096")?;
    ParameterError::unless(yaw.is_finite() && lift.is_finite(), "portrait.yaw, lift", (yaw, lift), "finite")?;
    let frame = Frame::of(parts, pixels as usize)?;
    let skins = skins(parts);
    let view = frame.view(yaw, lift);
    let baked =
        draw(&drawn(parts, &skins), view, [frame.width, frame.height], 3, Wanted::Surface, &Watch::silent())
            .finish(lit);
    let tones = Tones::new();
    let bytes = baked
        .pixels
        .iter()
        .flat_map(|pixel| pixel.color.map(|channel| tones.of(channel * pixel.cover + 1.0 - pixel.cover)));
    Ok(Image::new(frame.width as u32, frame.height as u32, 3, bytes.collect())?)
}

/// The colour of a sample in the light of all pictures that are compared.
pub(super) fn lit(sample: &Sample) -> [f32; 3] {
    let light = AMBIENT + DIRECT * sample.normal.dot(LIGHT).max(0.0);
    sample.color.map(|channel| channel * light)
}

fn check(parts: &[Part<'_>]) -> Result<(), AssetError> {
    parts.iter().try_for_each(Part::check)
}

/// The images of a part that can wear them.
fn worn<'a>(part: &Part<'a>) -> Option<&'a Textures> {
    part.textures().filter(|_| !part.mesh().uvs.is_empty())
}

/// The skins of the parts that wear images.
pub(super) fn skins(parts: &[Part<'_>]) -> Vec<Option<Skin>> {
    let mut skins: Vec<Option<Skin>> = Vec::new();
    for (i, part) in parts.iter().enumerate() {
        let same = |other: &Part<'_>| match (worn(other), worn(part)) {
            (Some(a), Some(b)) => std::ptr::eq(a, b),
            _ => false,
        };
        let is_new = !parts[..i].iter().any(same);
        skins.push(worn(part).filter(|_| is_new).map(Skin::new));
    }
    skins
}

/// Look of each part. Parts that share textures share the first one's skin.
pub(super) fn drawn<'a>(parts: &[Part<'a>], skins: &'a [Option<Skin>]) -> Vec<Drawn<'a>> {
    let skin = |i: usize| {
        let worn = worn(&parts[i])?;
        (0..=i)
            .find(|&j| {
                skins[j].is_some() && parts[j].textures().is_some_and(|other| std::ptr::eq(other, worn))
            })
            .and_then(|j| skins[j].as_ref())
    };
    parts
        .iter()
        .enumerate()
        .map(|(i, part)| Drawn {
            mesh: part.mesh(),
            copies: part.placed(),
            color: part.material().color(),
            double_sided: part.material().is_double_sided(),
            skin: skin(i),
            layers: if part.material().is_double_sided() { 1.0 } else { 4.0 },
        })
        .collect()
}

pub(super) fn draw(
    drawn: &[Drawn<'_>],
    view: View,
    size: [usize; 2],
    samples: usize,
    wanted: Wanted,
    watch: &Watch<'_>,
) -> Raster {
    let mut raster = Raster::new(view, size, samples, wanted);
    for drawn in drawn {
        raster.draw(drawn, watch);
    }
    raster
}

/// The corners of all triangles of all copies.
fn points<'a>(parts: &'a [Part<'_>]) -> impl Iterator<Item = Vec3> + 'a {
    parts.iter().flat_map(|part| {
        part.placed().into_owned().into_iter().flat_map(move |copy| {
            let matrix = copy.matrix();
            part.mesh()
                .indices
                .iter()
                .map(move |&i| matrix * part.mesh().positions[i as usize] + copy.position)
        })
    })
}

/// The box about all copies; `None` if there are none. O(vertices of all copies).
pub(super) fn bounds(parts: &[Part<'_>]) -> Option<Bounds> {
    let bounds = Bounds::of(points(parts));
    (!bounds.is_empty() && bounds.size().is_finite()).then_some(bounds)
}

/// Distance of the nearest thing from a point, metres.
pub(super) fn reach(parts: &[Part<'_>], from: Vec3) -> f32 {
    points(parts).map(|point| point.distance_squared(from)).fold(0.0, f32::max).sqrt()
}

/// A picture that has room for a model from all sides.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    center: Vec3,
    /// Size of the model, metres.
    size: Vec3,
    pixel: f32,
    half: Vec2,
    pub(super) width: usize,
    pub(super) height: usize,
}

impl Frame {
    /// A frame in which the model is about `pixels` pixels high.
    pub(super) fn of(parts: &[Part<'_>], pixels: usize) -> Result<Self, AssetError> {
        check(parts)?;
        let bounds = bounds(parts).ok_or(AssetError::Nothing)?;
        Ok(Self::about(bounds.center(), bounds.size(), pixels))
    }

    fn about(center: Vec3, size: Vec3, pixels: usize) -> Self {
        let across = Vec2::new(size.x, size.z).length();
        let tall = size.y.max(across * 0.05).max(1e-6);
        let pixel = tall / pixels as f32;
        let count = |metres: f32| (1.06 * metres / pixel).ceil().clamp(8.0, 8192.0) as usize;
        let (width, height) = (count(across), count(tall + 0.12 * across));
        let half = Vec2::new(width as f32, height as f32) * (0.5 * pixel);
        Self { center, size, pixel, half, width, height }
    }

    /// The frame of the same model in pictures in which it is `pixels` pixels high.
    pub(super) fn at(&self, pixels: usize) -> Self {
        Self::about(self.center, self.size, pixels)
    }

    /// Small pictures are drawn several times, for they have few points.
    pub(super) fn times(&self) -> usize {
        let smaller = LARGE / self.pixels();
        (smaller * smaller).clamp(1.0, TIMES) as usize
    }

    /// The view of one of these times: moved by a part of a pixel, evenly spread (Roberts 2018, "The
    /// Unreasonable Effectiveness of Quasirandom Sequences"); not moved the first time.
    pub(super) fn view_beside(&self, yaw: f32, lift: f32, number: usize) -> View {
        let mut view = self.view(yaw, lift);
        let part = |step: f32| self.pixel * ((number as f32 * step + 0.5).fract() - 0.5);
        view.center += view.right * part(0.754_877_7) + view.up * part(0.569_840_3);
        view
    }

    /// The side of a pixel, metres.
    pub(super) fn pixel(&self) -> f32 {
        self.pixel
    }

    /// Height of the model, pixels.
    pub(super) fn pixels(&self) -> f32 {
        self.size.y / self.pixel
    }

    pub(super) fn view(&self, yaw: f32, lift: f32) -> View {
        View::around(self.center, self.half, yaw, lift)
    }
}

/// Covered share, and its colours.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Tally {
    pub(super) cover: f64,
    colors: [f64; 3],
}

impl Tally {
    pub(super) fn of(baked: &Baked) -> Self {
        let mut tally = Self::default();
        for pixel in &baked.pixels {
            tally.cover += f64::from(pixel.cover);
            (0..3).for_each(|i| tally.colors[i] += f64::from(pixel.color[i] * pixel.cover));
        }
        tally
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.cover += other.cover;
        (0..3).for_each(|i| self.colors[i] += other.colors[i]);
    }

    /// The mean colour of what is covered, linear.
    pub(super) fn color(&self) -> [f32; 3] {
        self.colors.map(|channel| (channel / self.cover.max(1e-9)) as f32)
    }
}

/// CIE Lab of 1976 of a linear colour of sRGB's primaries, white D65.
pub(super) fn lab([r, g, b]: [f32; 3]) -> [f32; 3] {
    let x = (0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505;
    let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let z = (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089;
    let [x, y, z] = [x, y, z].map(|t| if t > 0.008_856 { math::cbrt(t) } else { 7.787 * t + 16.0 / 116.0 });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Structural similarity of two pictures' encoded grey on white, in windows of 8 x 8 pixels, four apart, that
/// are not empty.
fn ssim(a: &Baked, b: &Baked) -> f32 {
    let tones = Tones::new();
    let grey = |baked: &Baked| -> Vec<f64> {
        let grey = baked.pixels.iter().map(|pixel| {
            let [r, g, b] = pixel.color;
            let light = (0.2126 * r + 0.7152 * g + 0.0722 * b) * pixel.cover + 1.0 - pixel.cover;
            f64::from(tones.of(light)) / 255.0
        });
        grey.collect()
    };
    let (ours, theirs) = (grey(a), grey(b));
    let (mut sum, mut count) = (0.0, 0u32);
    for top in (0..a.height.saturating_sub(7)).step_by(4) {
        for left in (0..a.width.saturating_sub(7)).step_by(4) {
            let places = || (0..64).map(|i| (top + i / 8) * a.width + left + i % 8);
            if places().all(|at| a.pixels[at].cover == 0.0 && b.pixels[at].cover == 0.0) {
                continue;
            }
            let mean = |of: &dyn Fn(usize) -> f64| places().map(of).sum::<f64>() / 64.0;
            let (mx, my) = (mean(&|i| ours[i]), mean(&|i| theirs[i]));
            let vx = mean(&|i| (ours[i] - mx) * (ours[i] - mx));
            let vy = mean(&|i| (theirs[i] - my) * (theirs[i] - my));
            let both = mean(&|i| (ours[i] - mx) * (theirs[i] - my));
            let (c1, c2) = (0.0001, 0.0009);
            sum += (2.0 * mx * my + c1) * (2.0 * both + c2) / ((mx * mx + my * my + c1) * (vx + vy + c2));
            count += 1;
        }
    }
    if count > 0 { (sum / f64::from(count)) as f32 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{Mesh, Transform};

    #[test]
    fn parts_are_drawn_where_they_are_placed() {
        let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2]);
        let (near, far) = (Part::new(&mesh), Part::new(&mesh).with_transform(Transform::at(Vec3::X * 3.0)));
        let placed = bounds(&[near, far]).expect("triangles");
        assert_eq!((placed.min, placed.max), (Vec3::ZERO, Vec3::new(4.0, 1.0, 0.0)));
        // Half of one triangle's box is covered, and an eighth of the box of both.
        let share = |parts: &[Part<'_>]| {
            let image = portrait(parts, 0.0, 0.0, 64).expect("in range");
            let (all, seen) =
                (image.width() * image.height(), image.bytes().chunks_exact(3).filter(|p| p[0] < 200));
            seen.count() as f32 / all as f32
        };
        assert!(share(&[near, far]) > 0.0 && share(&[near, far]) < 0.6 * share(&[near]));
    }
}
