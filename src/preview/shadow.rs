//! Shadow maps: visibility from the sun.
//!
//! Solid triangles go into a depth map (Williams 1978, filtered over a disc that widens with the distance of what
//! casts the shadow, as a sun with an extent makes it); thin ones, of which the map would catch only some, into
//! slices of coverage that add up from the sun on (deep opacity maps, Yuksel and Keyser 2008) and blur on the way.

use super::raster;
use super::wear::Cut;
use crate::math;
use crate::shape::Bounds;
use glam::{Vec2, Vec3};

/// Side of the depth map, texels.
const SIDE: usize = 1536;
/// Side of the slices, texels.
const THIN_SIDE: usize = 768;
/// Triangles lower than this many texels go into the slices.
const THIN: f32 = 2.0;
/// The same for leaves: their triangles lie side by side, so that what one misses the next one meets.
const THIN_LEAF: f32 = 0.5;
/// Slices from the sun to the far end of the scene.
const SLICES: usize = 8;
/// Taps of the filter, on a spiral.
const TAPS: usize = 16;
/// Radius in which the filter looks for what casts a shadow, texels.
const SEARCH: f32 = 6.0;
/// Half the angle under which the sun is seen, as a slope; the true one, 0.0047, is doubled for softness.
const SUN_SLOPE: f32 = 0.01;

pub(super) struct ShadowMap {
    right: Vec3,
    up: Vec3,
    sun: Vec3,
    /// Column, row and nearness of the map's corner nearest the sun, and texels per metre.
    corner: Vec3,
    scale: f32,
    depth: Vec<f32>,
    /// Coverage between the sun and the start of each slice, and beyond the last.
    thin: Vec<f32>,
    slice: f32,
    taps: [Vec2; TAPS],
}

impl ShadowMap {
    /// A map of the sun in the direction `sun`, a unit vector, for what is in `bounds`.
    pub(super) fn new(sun: Vec3, bounds: Bounds) -> Self {
        let (right, up) = sun.any_orthonormal_pair();
        let seen = Bounds::of(bounds.corners().map(|p| Vec3::new(p.dot(right), p.dot(up), p.dot(sun))));
        let extent = seen.size().truncate().max_element().max(1e-6);
        // Two texels of border, so that no filter reads beyond.
        let scale = (SIDE as f32 - 8.0) / extent;
        let border = 4.0 / scale;
        Self {
            right,
            up,
            sun,
            corner: Vec3::new(seen.min.x - border, seen.min.y - border, seen.max.z),
            scale,
            depth: vec![f32::NEG_INFINITY; SIDE * SIDE],
            thin: vec![0.0; THIN_SIDE * THIN_SIDE * (SLICES + 1)],
            slice: (seen.size().z / SLICES as f32).max(1e-6),
            taps: spiral(),
        }
    }

    /// Column and row in the depth map, and nearness to the sun in metres.
    #[inline]
    fn project(&self, p: Vec3) -> Vec3 {
        let x = (p.dot(self.right) - self.corner.x) * self.scale;
        let y = (p.dot(self.up) - self.corner.y) * self.scale;
        Vec3::new(x, y, p.dot(self.sun))
    }

    /// Adds a triangle, if it faces the sun or is seen from both sides. It may have holes.
    #[inline]
    pub(super) fn add(&mut self, corners: [Vec3; 3], two_sided: bool, cut: Option<Cut<'_>>) {
        let facing = (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(self.sun);
        if !(facing > 0.0 || two_sided) {
            return;
        }
        let corners = corners.map(|corner| self.project(corner));
        match cut {
            None => self.put(corners, two_sided, |_, _| true),
            Some(cut) => {
                let cutout = cut.on(corners, false);
                self.put(corners, two_sided, |x, y| cutout.is_there(x, y));
            }
        }
    }

    /// Adds a triangle where it `is_there`, by column and row of the depth map.
    #[inline]
    fn put(&mut self, corners: [Vec3; 3], two_sided: bool, is_there: impl Fn(f32, f32) -> bool) {
        if !raster::is_thin(corners, if two_sided { THIN_LEAF } else { THIN }) {
            let depth = &mut self.depth;
            raster::fill(corners, SIDE, 0..SIDE, |x, y, nearness| {
                if !is_there(x as f32 + 0.5, y as f32 + 0.5) {
                    return;
                }
                let texel = &mut depth[y * SIDE + x];
                *texel = texel.max(nearness);
            });
            return;
        }
        let ratio = THIN_SIDE as f32 / SIDE as f32;
        let high = Vec2::splat(SIDE as f32 - 2.0);
        let (near, slice) = (self.corner.z, self.slice);
        let thin = &mut self.thin;
        raster::strew(corners, Vec2::splat(2.0), high, |place, area| {
            if !is_there(place.x, place.y) {
                return;
            }
            let index = ((near - place.z) / slice).clamp(0.0, SLICES as f32 - 1.0) as usize;
            let layer = &mut thin[(index + 1) * THIN_SIDE * THIN_SIDE..][..THIN_SIDE * THIN_SIDE];
            let (x, y) = (place.x * ratio - 0.5, place.y * ratio - 0.5);
            let (column, row) = (x as usize, y as usize);
            let (fx, fy) = (x - column as f32, y - row as f32);
            let area = area * ratio * ratio;
            let at = row * THIN_SIDE + column;
            layer[at] += area * (1.0 - fx) * (1.0 - fy);
            layer[at + 1] += area * fx * (1.0 - fy);
            layer[at + THIN_SIDE] += area * (1.0 - fx) * fy;
            layer[at + THIN_SIDE + 1] += area * fx * fy;
        });
    }

    /// To be called once, when everything is in: adds up the slices from the sun on.
    pub(super) fn finish(&mut self) {
        let mut blurred = vec![0.0; THIN_SIDE * THIN_SIDE];
        for index in 1..=SLICES {
            let (before, rest) = self.thin.split_at_mut(index * THIN_SIDE * THIN_SIDE);
            let before = &before[(index - 1) * THIN_SIDE * THIN_SIDE..];
            blur(before, &mut blurred);
            for (texel, before) in rest.iter_mut().zip(&blurred) {
                *texel += before;
            }
        }
    }

    /// Share of the sun that is seen from a point of a surface, 0 to 1.
    pub(super) fn light(&self, point: Vec3, normal: Vec3) -> f32 {
        let texel = 1.0 / self.scale;
        // Off the surface by its slope to the sun, so that it does not shade itself.
        let slope = 1.0 - normal.dot(self.sun).clamp(0.0, 1.0);
        let at = self.project(point + normal * (texel * (1.0 + 1.5 * slope)));
        let last = SIDE as f32 - 4.0;
        if !(at.x >= 3.0 && at.y >= 3.0 && at.x <= last && at.y <= last) {
            return 1.0;
        }
        let solid = self.solid(at, texel);
        if solid > 0.0 { solid * self.through_thin(at) } else { 0.0 }
    }

    fn solid(&self, at: Vec3, texel: f32) -> f32 {
        let bias = texel;
        let (mut blockers, mut distance) = (0.0, 0.0);
        for tap in &self.taps {
            let place = (at.truncate() + *tap * SEARCH).clamp(Vec2::ZERO, Vec2::splat(SIDE as f32 - 1.0));
            let seen = self.depth[place.y as usize * SIDE + place.x as usize];
            if seen > at.z + bias {
                blockers += 1.0;
                distance += seen - at.z;
            }
        }
        if blockers == 0.0 {
            return 1.0;
        }
        let penumbra = distance / blockers * SUN_SLOPE * self.scale;
        let radius = penumbra.clamp(1.2, 12.0);
        let lit: f32 = self.taps.iter().map(|tap| self.lit(at, *tap * radius, bias)).sum();
        lit / TAPS as f32
    }

    /// Share of the four texels around a place that see the sun, weighted by their nearness.
    #[inline]
    fn lit(&self, at: Vec3, offset: Vec2, bias: f32) -> f32 {
        let place = (at.truncate() + offset - 0.5).clamp(Vec2::ZERO, Vec2::splat(SIDE as f32 - 2.5));
        let (column, row) = (place.x as usize, place.y as usize);
        let (fx, fy) = (place.x - column as f32, place.y - row as f32);
        let index = row * SIDE + column;
        let lit = |index: usize| if self.depth[index] > at.z + bias { 0.0 } else { 1.0 };
        let upper = lit(index) * (1.0 - fx) + lit(index + 1) * fx;
        let lower = lit(index + SIDE) * (1.0 - fx) + lit(index + SIDE + 1) * fx;
        upper * (1.0 - fy) + lower * fy
    }

    fn through_thin(&self, at: Vec3) -> f32 {
        let ratio = THIN_SIDE as f32 / SIDE as f32;
        // Half a slice towards the sun: a twig does not shade itself.
        let depth = ((self.corner.z - at.z) / self.slice - 0.5).clamp(0.0, SLICES as f32 - 1e-3);
        let (x, y) = (at.x * ratio - 0.5, at.y * ratio - 0.5);
        let (column, row, index) = (x as usize, y as usize, depth as usize);
        let (fx, fy, fz) = (x - column as f32, y - row as f32, depth - index as f32);
        let layer = |index: usize| {
            let texels = &self.thin[index * THIN_SIDE * THIN_SIDE + row * THIN_SIDE + column..];
            let upper = texels[0] * (1.0 - fx) + texels[1] * fx;
            let lower = texels[THIN_SIDE] * (1.0 - fx) + texels[THIN_SIDE + 1] * fx;
            upper * (1.0 - fy) + lower * fy
        };
        math::exp(-(layer(index) * (1.0 - fz) + layer(index + 1) * fz))
    }
}

/// Places spread evenly over the unit disc (Vogel's spiral).
fn spiral() -> [Vec2; TAPS] {
    std::array::from_fn(|i| {
        let (sin, cos) = math::sin_cos(i as f32 * 2.399_963_2);
        Vec2::new(cos, sin) * ((i as f32 + 0.5) / TAPS as f32).sqrt()
    })
}

/// A blur over 3 by 3 texels; the border stays as it is, which is empty.
fn blur(from: &[f32], to: &mut [f32]) {
    for row in 1..THIN_SIDE - 1 {
        let line = |row: usize| &from[row * THIN_SIDE..(row + 1) * THIN_SIDE];
        let (above, here, below) = (line(row - 1), line(row), line(row + 1));
        let down = |x: usize| above[x] + 2.0 * here[x] + below[x];
        let target = &mut to[row * THIN_SIDE..(row + 1) * THIN_SIDE];
        for (x, texel) in target.iter_mut().enumerate().take(THIN_SIDE - 1).skip(1) {
            *texel = (down(x - 1) + 2.0 * down(x) + down(x + 1)) / 16.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Bounds = Bounds { min: Vec3::new(-2.0, 0.0, -2.0), max: Vec3::new(2.0, 4.0, 2.0) };

    fn map_with(half_width: f32) -> ShadowMap {
        let mut map = ShadowMap::new(Vec3::Y, BOX);
        let corner = |x: f32, z: f32| Vec3::new(x * half_width, 3.0, z);
        map.add([corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0)], false, None);
        map.add([corner(-1.0, -1.0), corner(1.0, 1.0), corner(1.0, -1.0)], false, None);
        map.finish();
        map
    }

    #[test]
    fn a_board_casts_a_shadow() {
        let map = map_with(0.5);
        assert!(map.light(Vec3::new(0.1, 0.0, 0.1), Vec3::Y) < 1e-3);
        assert!(map.light(Vec3::new(0.1, 3.0, 0.1), Vec3::Y) > 0.999, "not on itself");
        assert!(map.light(Vec3::new(1.5, 0.0, 0.1), Vec3::Y) > 0.999);
        assert!(map.light(Vec3::new(500.0, 0.0, 0.1), Vec3::Y) > 0.999);
    }

    #[test]
    fn a_wire_casts_a_faint_one() {
        let map = map_with(0.0005);
        let light = map.light(Vec3::new(0.0, 0.0, 0.1), Vec3::Y);
        assert!(light > 0.7 && light < 0.99, "{light}");
        assert!(map.light(Vec3::new(0.2, 0.0, 0.1), Vec3::Y) > 0.999);
    }
}
