//! An orthographic rasterizer: what a leaf, a twig or a tree looks like from far away, as colour, cover,
//! normal, depth and the number of layers of leaves, one entry per pixel.

use super::skin::Skin;
use crate::math;
use crate::observer::Watch;
use crate::shape::Bounds;
use crate::surface::{Instance, Mesh};
use glam::{Mat3, Vec2, Vec3, Vec4};
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
    /// The number of what was drawn there, in the order of drawing.
    pub(super) drawn: u32,
    pub(super) color: [f32; 3],
    /// Normal in the view's frame.
    pub(super) normal: Vec3,
    /// Layers of all that lies behind this point, the nearest included.
    pub(super) layers: f32,
}

/// Knowledge that is asked for at each point of a picture; the less, the faster.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wanted {
    /// There is something.
    Cover,
    /// The nearest surface.
    Surface,
    /// The nearest surface and the layers behind it.
    Layers,
}

/// A picture in the making.
#[derive(Debug)]
pub(super) struct Raster {
    view: View,
    wanted: Wanted,
    width: usize,
    height: usize,
    /// Points along each side of a pixel.
    samples: usize,
    /// What has been drawn so far.
    drawn: u32,
    all: Vec<Sample>,
    /// For each point the distance of the nearest surface from the view's centre toward the viewer, metres; minus
    /// infinity where there is nothing, infinity where no other is asked for. Three more, since four are read at a time.
    depths: Vec<f32>,
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

/// Points of a picture: 36 bytes each.
const MOST_POINTS: usize = 1 << 24;

/// Points about a copy that are tried, at the most, to find out whether it is hidden.
const MOST_TRIED: usize = 1024;
/// Width of triangles in points up to which all points of their boxes are tried.
const NARROW: usize = 8;

/// The columns from `left` up to `right` between which a triangle lies in the row at height `y`, rather one more on either
/// side.
fn span(corners: [Vec2; 3], y: f32, left: usize, right: usize) -> (usize, usize) {
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for i in 0..3 {
        let (from, to) = (corners[i], corners[(i + 1) % 3]);
        let rise = to.y - from.y;
        if rise.abs() > 0.0 && from.y.min(to.y) <= y && y <= from.y.max(to.y) {
            let x = from.x + (to.x - from.x) * ((y - from.y) / rise);
            (low, high) = (low.min(x), high.max(x));
        }
    }
    // Negative numbers become 0, and what is not in the triangle an empty span.
    (((low - 1.5) as usize).max(left), ((high + 1.5) as usize).min(right))
}

impl Raster {
    /// A picture of `width` x `height` pixels with `samples` x `samples` points in each, or fewer where that
    /// would be more than [`MOST_POINTS`].
    pub(super) fn new(view: View, [width, height]: [usize; 2], samples: usize, wanted: Wanted) -> Self {
        let fits = |samples: &usize| width * height * samples * samples <= MOST_POINTS;
        let samples = (1..=samples).rev().find(fits).unwrap_or(1);
        let nothing = Sample { drawn: 0, color: [0.0; 3], normal: Vec3::ZERO, layers: 0.0 };
        let points = width * height * samples * samples;
        Self {
            view,
            wanted,
            width,
            height,
            samples,
            drawn: 0,
            all: vec![nothing; points],
            depths: vec![f32::NEG_INFINITY; points + 3],
        }
    }

    /// Adds what is drawn, a step for 20 triangles. O(triangles + points that they cover).
    pub(super) fn draw(&mut self, drawn: &Drawn<'_>, watch: &Watch<'_>) {
        let matrix = self.view.matrix();
        let size = Vec2::new((self.width * self.samples) as f32, (self.height * self.samples) as f32);
        let scale = size / (2.0 * self.view.half);
        let mut corners = Vec::with_capacity(drawn.mesh.positions.len());
        let ball = Bounds::of(drawn.mesh.positions.iter().copied());
        let (middle, radius) = (ball.center(), 0.5 * ball.size().length());
        for copy in &*drawn.copies {
            if !watch.steps(1 + drawn.mesh.indices.len() / 64) {
                return;
            }
            let turned = matrix * copy.rotation_matrix();
            let scaled = turned * copy.scale;
            let offset = matrix * (copy.position - self.view.center);
            let (at, radius) = (scaled * middle + offset, 1.001 * radius * copy.scale.abs());
            let flat = Vec2::new(at.x, -at.y) * scale + size * 0.5;
            if self.hides(flat, radius * scale, at.z + radius) {
                continue;
            }
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
        self.drawn += 1;
    }

    /// `true` if what lies this far about a point of the picture, and is at most this near, is hidden for sure.
    fn hides(&self, at: Vec2, about: Vec2, nearest: f32) -> bool {
        if self.wanted == Wanted::Layers {
            return false;
        }
        let (columns, rows) = (self.width * self.samples, self.height * self.samples);
        let (low, high) = (at - about, at + about + 1.0);
        let (left, right) = (low.x as usize, (high.x as usize).min(columns));
        let (top, bottom) = (low.y as usize, (high.y as usize).min(rows));
        let is_small = right.saturating_sub(left) * bottom.saturating_sub(top) <= MOST_TRIED;
        is_small
            && (top..bottom).all(|row| {
                let depths = &self.depths[row * columns..][left.min(right)..right];
                depths.iter().all(|depth| *depth >= nearest)
            })
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
        let first = |low: f32| (-math::floor(0.5 - low)) as usize;
        let (left, right) = (first(low.x), ((high.x + 0.5) as usize).min(columns));
        let (top, bottom) = (first(low.y), ((high.y + 0.5) as usize).min(rows));
        if left >= right || top >= bottom {
            return;
        }
        let mut texture = None;
        let inverse = 1.0 / area;
        // Four points of a row at a time.
        for row in top..bottom {
            let y = row as f32 + 0.5;
            let [ay, by, cy] = [a, b, c].map(|corner| corner.at.y - y);
            let (left, right) =
                if right - left > NARROW { span([a.at, b.at, c.at], y, left, right) } else { (left, right) };
            for start in (left..right).step_by(4) {
                let x = Vec4::splat(start as f32) + Vec4::new(0.5, 1.5, 2.5, 3.5);
                let [ax, bx, cx] = [a, b, c].map(|corner| Vec4::splat(corner.at.x) - x);
                let u = (bx * cy - by * cx) * inverse;
                let v = (cx * ay - cy * ax) * inverse;
                let w = 1.0 - u - v;
                let inside = u.cmpge(Vec4::ZERO) & v.cmpge(Vec4::ZERO) & w.cmpge(Vec4::ZERO);
                let depths = a.depth * u + b.depth * v + c.depth * w;
                let at = row * columns + start;
                let is_nearer = depths.cmpgt(Vec4::from_slice(&self.depths[at..]));
                let asked = if self.wanted == Wanted::Layers { inside } else { inside & is_nearer };
                let mut lanes = asked.bitmask() & ((1 << (right - start).min(4)) - 1);
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    let (u, v, w) = (u[lane], v[lane], w[lane]);
                    let place = drawn.skin.map(|skin| {
                        let on = texture.get_or_insert_with(|| skin.on(drawn.mesh, triangle, area.abs()));
                        (&*on, on.place(u, v, w))
                    });
                    if place.as_ref().is_some_and(|(on, place)| on.is_hole(place)) {
                        continue;
                    }
                    if self.wanted == Wanted::Cover {
                        self.depths[at + lane] = f32::INFINITY;
                        continue;
                    }
                    let sample = &mut self.all[at + lane];
                    sample.layers += drawn.layers;
                    if !is_nearer.test(lane) {
                        continue;
                    }
                    self.depths[at + lane] = depths[lane];
                    sample.drawn = self.drawn;
                    // Most triangles of a dense model hide no point: only those that do need normals.
                    let [of_a, of_b, of_c] =
                        triangle.map(|corner| turned * drawn.mesh.normals[corner as usize]);
                    let mut normal = of_a * u + of_b * v + of_c * w;
                    sample.color = tint;
                    if !drawn.mesh.colors.is_empty() {
                        let [a, b, c] = triangle.map(|corner| drawn.mesh.colors[corner as usize]);
                        for i in 0..3 {
                            sample.color[i] *= a[i] * u + b[i] * v + c[i] * w;
                        }
                    }
                    if let Some((on, place)) = &place {
                        let texel = on.texel(place);
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
    }

    /// The means over each pixel, of what `shade` makes of the colours.
    pub(super) fn finish(&self, shade: impl Fn(&Sample) -> [f32; 3]) -> Baked {
        let mut pixels = vec![Pixel::default(); self.width * self.height];
        let columns = self.width * self.samples;
        let share = 1.0 / (self.samples * self.samples) as f32;
        let points = self.all.iter().zip(&self.depths).enumerate();
        for (i, (sample, &depth)) in points.filter(|(_, (_, depth))| **depth > f32::NEG_INFINITY) {
            let (row, column) = (i / columns / self.samples, i % columns / self.samples);
            let pixel = &mut pixels[row * self.width + column];
            let color = shade(sample);
            (0..3).for_each(|i| pixel.color[i] += color[i] * share);
            pixel.cover += share;
            pixel.normal += sample.normal;
            pixel.depth += depth * share;
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
