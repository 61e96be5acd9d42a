//! Solids between the triangles: lines of sight where there is something to be seen.

use super::{Frame, NOTHING, SOLID, Strip};
use crate::preview::light::Lit;
use crate::preview::ray::{Beam, Hit, Look, Sunbeams, Sunlight};
use glam::Vec3;

/// Side of the blocks of pixels that are looked at as a whole first.
const BLOCK: usize = 8;
/// Half the diagonal of a square, as a part of its side, and a little more.
const HALF_DIAGONAL: f32 = 0.71;
/// The samples of a pixel are taken for one surface if their normals' cosines are at least this.
const FLAT: f32 = 0.985;
/// And their colours differ by less than this in each channel.
const PLAIN: f32 = 0.02;

impl Frame<'_> {
    /// Casts rays through every sample of a strip that may show the solid, and keeps what is nearer than the triangles.
    pub(super) fn cast(&self, strip: &mut Strip) {
        let Some(solid) = self.solid else { return };
        let n = self.samples;
        let (width, height) = (self.columns / n, strip.rows / n);
        strip.seen.clear();
        strip.seen.resize(strip.facets.len(), Glimpse::default());
        for top in (0..height).step_by(BLOCK) {
            for left in (0..width).step_by(BLOCK) {
                let block = self.beam(strip, (left, top), BLOCK);
                let rows = top..(top + BLOCK).min(height);
                let columns = left..(left + BLOCK).min(width);
                let pixels: Vec<_> =
                    rows.flat_map(|row| columns.clone().map(move |column| (column, row))).collect();
                let beams: Vec<_> = pixels.iter().map(|&pixel| self.beam(strip, pixel, 1)).collect();
                solid.look(&block, &beams, &mut |number, hit| self.cast_pixel(hit, strip, pixels[number]));
            }
        }
    }

    /// View through a square of pixels.
    fn beam(&self, strip: &Strip, (left, top): (usize, usize), side: usize) -> Beam {
        let middle = |first: usize| (first * self.samples) as f32 + 0.5 * (side * self.samples) as f32;
        let ray = self.view.ray(middle(left), strip.top as f32 + middle(top));
        let [radius, spread] = self.view.sample_size();
        let half = HALF_DIAGONAL * (side * self.samples) as f32;
        Beam { ray, radius: half * radius, spread: half * spread }
    }

    /// First every other sample; where these show one smooth surface, the rest is as they are.
    fn cast_pixel(&self, hit: &Look<'_>, strip: &mut Strip, (column, row): (usize, usize)) {
        let n = self.samples;
        let beams = Sunbeams::all(n * n, column, strip.top / n + row);
        let sample = |strip: &mut Strip, index: usize| {
            let (x, y) = (column * n + index % n, row * n + index / n);
            let at = y * self.columns + x;
            let (place_x, place_y) = (x as f32 + 0.5, (y + strip.top) as f32 + 0.5);
            let mut ray = self.view.ray(place_x, place_y);
            if strip.facets[at] != NOTHING {
                ray.to = (self.view.position(place_x, place_y, strip.solid[at]) - ray.origin).dot(ray.way);
            }
            let hit = hit(&ray)?;
            let Lit { sky, sun, light } = self.light.lit(hit.point, hit.normal, false, beams.one(index));
            let Hit { point, normal, color } = hit;
            let glimpse = Glimpse { sky: color * sky, sun: color * sun, light, point, normal };
            strip.set(at, self.view.nearness(point), glimpse);
            Some((hit, glimpse))
        };
        let mut found: [Option<(Hit, Glimpse)>; 64] = [None; 64];
        let (mut hits, mut tries) = (0, 0);
        for index in (0..n * n).step_by(2) {
            found[index] = sample(strip, index);
            hits += usize::from(found[index].is_some());
            tries += 1;
        }
        let smooth = hits == tries && hits > 1 && {
            let all = || found.iter().flatten().map(|(hit, _)| hit);
            let first = found[0].map(|(hit, _)| hit);
            first.is_some_and(|first| all().all(|hit| is_alike(&first, hit)))
        };
        if !smooth {
            for index in (1..n * n).step_by(2) {
                sample(strip, index);
            }
            return;
        }
        // The rest gets what is seen on either side.
        for index in (1..n * n).step_by(2) {
            let ((before, a), (_, b)) = match (found[index - 1], found.get(index + 1).copied().flatten()) {
                (Some(before), Some(after)) => (before, after),
                (Some(before), None) => (before, before),
                _ => continue,
            };
            let at = (row * n + index / n) * self.columns + column * n + index % n;
            let nearness = self.view.nearness(before.point);
            if nearness > strip.solid[at] {
                strip.set(at, nearness, a.between(&b));
            }
        }
    }
}

/// `true` if two hits of a pixel lie on one smooth piece of surface.
fn is_alike(a: &Hit, b: &Hit) -> bool {
    // A step in depth is a step off the plane through either.
    let (way, apart) = (b.point - a.point, a.point.distance(b.point));
    a.normal.dot(b.normal) > FLAT
        && way.dot(a.normal).abs().max(way.dot(b.normal).abs()) < 0.2 * apart.max(f32::MIN_POSITIVE)
        && (a.color - b.color).abs().max_element() < PLAIN
}

/// View of the solid by a sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Glimpse {
    /// The light that comes from it without the sun, and what a whole sun adds.
    pub(super) sky: Vec3,
    pub(super) sun: Vec3,
    pub(super) light: Sunlight,
    pub(super) point: Vec3,
    pub(super) normal: Vec3,
}

impl Default for Glimpse {
    fn default() -> Self {
        let light = Sunlight { seen: 1.0, softness: 0.0 };
        Self { sky: Vec3::ZERO, sun: Vec3::ZERO, light, point: Vec3::ZERO, normal: Vec3::Y }
    }
}

impl Glimpse {
    /// Halfway to another on the same surface.
    fn between(&self, other: &Self) -> Self {
        let light = Sunlight {
            seen: 0.5 * (self.light.seen + other.light.seen),
            softness: self.light.softness.max(other.light.softness),
        };
        Self { sky: 0.5 * (self.sky + other.sky), sun: 0.5 * (self.sun + other.sun), light, ..*self }
    }
}

impl Strip {
    fn set(&mut self, at: usize, nearness: f32, glimpse: Glimpse) {
        self.solid[at] = nearness;
        self.facets[at] = SOLID;
        self.seen[at] = glimpse;
    }
}

/// The sunlight of a pixel's samples.
#[derive(Default)]
pub(super) struct Sun {
    pub(super) color: Vec3,
    seen: f32,
    weight: f32,
    softness: f32,
    pub(super) first: Glimpse,
}

impl Sun {
    pub(super) fn add(&mut self, seen: &Glimpse) {
        let weight = seen.sun.element_sum();
        if weight > 0.0 {
            if self.weight == 0.0 {
                self.first = *seen;
            }
            self.color += seen.sun;
            self.weight += weight;
            self.seen += weight * seen.light.seen;
            self.softness = self.softness.max(seen.light.softness);
        }
    }

    pub(super) fn light(&self) -> Sunlight {
        let seen = if self.weight > 0.0 { self.seen / self.weight } else { 1.0 };
        Sunlight { seen, softness: self.softness }
    }
}
