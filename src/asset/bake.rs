//! An orthographic rasterizer: what a leaf, a twig or a tree looks like from far away, as colour, cover,
//! normal, depth and the number of layers of leaves, one entry per pixel.

use super::skin::Skin;
use crate::math;
use crate::observer::Watch;
use crate::surface::{Instance, Mesh};
use glam::{Mat3, Vec2, Vec3};
use std::borrow::Cow;

/// Axes of the view: it looks along -`toward`, which is `right` x `up`; all three of length 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    pub(super) right: Vec3,
    pub(super) up: Vec3,
    pub(super) toward: Vec3,
    /// Point in the middle of the picture.
    pub(super) center: Vec3,
    /// Half of the picture's width and height, metres.
    pub(super) half: Vec2,
}

impl View {
    /// Level with the ground, turned about the vertical, then lifted to look down; radians.
    pub(super) fn around(center: Vec3, half: Vec2, yaw: f32, lift: f32) -> Self {
        let (sin, cos) = math::sin_cos(yaw);
        let (rise, level) = math::sin_cos(lift);
        let (right, away) = (Vec3::new(cos, 0.0, -sin), Vec3::new(sin, 0.0, cos));
        let toward = away * level + Vec3::Y * rise;
        Self { right, up: toward.cross(right), toward, center, half }
    }

    /// Matrix from the world to right, up, and toward the viewer.
    fn matrix(&self) -> Mat3 {
        Mat3::from_cols(self.right, self.up, self.toward).transpose()
    }
}

/// Copies of a mesh of one colour, to be drawn.
#[derive(Debug, Clone)]
pub(super) struct Drawn<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) copies: Cow<'a, [Instance]>,
    pub(super) color: [f32; 3],
    pub(super) double_sided: bool,
    pub(super) skin: Option<&'a Skin>,
    /// Number of leaves that one triangle is as opaque as.
    pub(super) layers: f32,
}

/// The nearest surface at one point of the picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Toward the viewer, metres from the view's centre; minus infinity where there is nothing.
    pub(super) depth: f32,
    pub(super) color: [f32; 3],
    /// Normal in the view's frame.
    pub(super) normal: Vec3,
    /// Layers of all that lies behind this point, the nearest included.
    pub(super) layers: f32,
}

/// A picture in the making.
#[derive(Debug)]
pub(super) struct Raster {
    view: View,
    width: usize,
    height: usize,
    /// Points along each side of a pixel.
    samples: usize,
    all: Vec<Sample>,
}

/// A finished picture; rows from the top.
#[derive(Debug, Clone)]
pub(super) struct Baked {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) pixels: Vec<Pixel>,
}

impl Baked {
    /// The picture with its cover multiplied.
    pub(super) fn thickened(&self, thicker: f32) -> Self {
        let mut baked = self.clone();
        baked.pixels.iter_mut().for_each(|pixel| pixel.cover = (pixel.cover * thicker).min(1.0));
        baked
    }
}

/// The means over what covers a pixel.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Pixel {
    pub(super) color: [f32; 3],
    /// Covered share of the pixel, 0 to 1.
    pub(super) cover: f32,
    /// Normal of length 1, in the view's frame; zero where there is nothing.
    pub(super) normal: Vec3,
    pub(super) depth: f32,
    pub(super) layers: f32,
}

/// A corner in samples from the upper left, and its depth.
#[derive(Debug, Clone, Copy)]
struct Corner {
    at: Vec2,
    depth: f32,
}

/// Points of a picture: 32 bytes each.
const MOST_POINTS: usize = 1 << 24;

impl Raster {
    /// A picture of `width` x `height` pixels with `samples` x `samples` points in each, or fewer where that
    /// would be more than [`MOST_POINTS`].
    pub(super) fn new(view: View, width: usize, height: usize, samples: usize) -> Self {
        let fits = |samples: &usize| width * height * samples * samples <= MOST_POINTS;
        let samples = (1..=samples).rev().find(fits).unwrap_or(1);
        let nothing = Sample { depth: f32::NEG_INFINITY, color: [0.0; 3], normal: Vec3::ZERO, layers: 0.0 };
        Self { view, width, height, samples, all: vec![nothing; width * height * samples * samples] }
    }

    /// Adds what is drawn, a step for 20 triangles. O(triangles + points that they cover).
    pub(super) fn draw(&mut self, drawn: &Drawn<'_>, watch: &Watch<'_>) {
        let matrix = self.view.matrix();
        let size = Vec2::new((self.width * self.samples) as f32, (self.height * self.samples) as f32);
        let scale = size / (2.0 * self.view.half);
        let mut corners = Vec::with_capacity(drawn.mesh.positions.len());
        for copy in &*drawn.copies {
            if !watch.steps(1 + drawn.mesh.indices.len() / 64) {
                return;
            }
            let turned = matrix * copy.rotation_matrix();
            let scaled = turned * copy.scale;
            let offset = matrix * (copy.position - self.view.center);
            corners.clear();
            corners.extend(drawn.mesh.positions.iter().map(|&position| {
                let seen = scaled * position + offset;
                let at = Vec2::new(seen.x, -seen.y) * scale + size * 0.5;
                Corner { at, depth: seen.z }
            }));
            let tint = [0, 1, 2].map(|i| drawn.color[i] * copy.tint[i]);
            for triangle in drawn.mesh.triangles() {
                self.triangle(drawn, &corners, triangle, tint, turned);
            }
        }
    }

    fn triangle(
        &mut self,
        drawn: &Drawn<'_>,
        all: &[Corner],
        triangle: [u32; 3],
        tint: [f32; 3],
        turned: Mat3,
    ) {
        let [a, b, c] = triangle.map(|corner| all[corner as usize]);
        // Twice the area; rows count downward, so that what faces the viewer is negative.
        let area = (b.at - a.at).perp_dot(c.at - a.at);
        let is_back = area > 0.0;
        if area == 0.0 || !area.is_finite() || is_back && !drawn.double_sided {
            return;
        }
        let (columns, rows) = (self.width * self.samples, self.height * self.samples);
        let (low, high) = (a.at.min(b.at).min(c.at), a.at.max(b.at).max(c.at));
        // The points of the picture are in the middles of unit squares.
        let first = |low: f32| (low - 0.5).ceil().max(0.0) as usize;
        let end = |high: f32, count: usize| ((high + 0.5).floor().max(0.0) as usize).min(count);
        let (left, right) = (first(low.x), end(high.x, columns));
        let (top, bottom) = (first(low.y), end(high.y, rows));
        if left >= right || top >= bottom {
            return;
        }
        let texture = drawn.skin.map(|skin| skin.on(drawn.mesh, triangle, area.abs()));
        let inverse = 1.0 / area;
        for row in top..bottom {
            for column in left..right {
                let point = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
                let u = (b.at - point).perp_dot(c.at - point) * inverse;
                let v = (c.at - point).perp_dot(a.at - point) * inverse;
                let w = 1.0 - u - v;
                if u < 0.0 || v < 0.0 || w < 0.0 {
                    continue;
                }
                let texel = match &texture {
                    Some(texture) => match texture.at(u, v, w) {
                        Some(texel) => Some(texel),
                        None => continue,
                    },
                    None => None,
                };
                let sample = &mut self.all[row * columns + column];
                sample.layers += drawn.layers;
                let depth = a.depth * u + b.depth * v + c.depth * w;
                if depth <= sample.depth {
                    continue;
                }
                sample.depth = depth;
                // Most triangles of a dense model hide no point: only those that do need normals.
                let [of_a, of_b, of_c] = triangle.map(|corner| turned * drawn.mesh.normals[corner as usize]);
                let mut normal = of_a * u + of_b * v + of_c * w;
                sample.color = tint;
                if !drawn.mesh.colors.is_empty() {
                    let [a, b, c] = triangle.map(|corner| drawn.mesh.colors[corner as usize]);
                    for i in 0..3 {
                        sample.color[i] *= a[i] * u + b[i] * v + c[i] * w;
                    }
                }
                if let Some(texel) = texel {
                    for i in 0..3 {
                        sample.color[i] *= texel.color[i];
                    }
                    if let Some(tangent) = texel.tangent {
                        let across = turned * tangent.truncate();
                        let up = normal.cross(across) * tangent.w;
                        normal = across * texel.normal.x + up * texel.normal.y + normal * texel.normal.z;
                    }
                }
                sample.normal = if is_back { -normal } else { normal }.normalize_or_zero();
            }
        }
    }

    /// The means over each pixel, of what `shade` makes of the colours.
    pub(super) fn finish(&self, shade: impl Fn(&Sample) -> [f32; 3]) -> Baked {
        let mut pixels = vec![Pixel::default(); self.width * self.height];
        let columns = self.width * self.samples;
        let share = 1.0 / (self.samples * self.samples) as f32;
        for (i, sample) in self.all.iter().enumerate().filter(|(_, sample)| sample.depth.is_finite()) {
            let (row, column) = (i / columns / self.samples, i % columns / self.samples);
            let pixel = &mut pixels[row * self.width + column];
            let color = shade(sample);
            (0..3).for_each(|i| pixel.color[i] += color[i] * share);
            pixel.cover += share;
            pixel.normal += sample.normal;
            pixel.depth += sample.depth * share;
            pixel.layers += sample.layers * share;
        }
        for pixel in pixels.iter_mut().filter(|pixel| pixel.cover > 0.0) {
            let whole = 1.0 / pixel.cover;
            pixel.color = pixel.color.map(|channel| channel * whole);
            pixel.depth *= whole;
            pixel.layers *= whole;
            pixel.normal = pixel.normal.normalize_or(Vec3::Z);
            pixel.cover = pixel.cover.min(1.0);
        }
        Baked { width: self.width, height: self.height, pixels }
    }
}
