//! The implicit field: skeletal primitives, joined along branches and blended between them.

#![allow(clippy::inline_always, reason = "a call in a loop over 64 voxels keeps it from being vectorized")]

use crate::Skeleton;
use crate::surface::SurfaceError;
use glam::Vec3;

/// Farther out or thicker than this, in metres, products of coordinates leave the range of 32-bit floats.
const FARTHEST: f32 = 1e9;

/// A straight part of a branch, from one node to the next: a cone with a ball at each end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    from: Vec3,
    way: Vec3,
    /// One over the square of the length, or 0 where there is none.
    inverse: f32,
    radius: f32,
    /// By how much the radius grows along the way.
    growth: f32,
    pub(super) branch: u32,
}

impl Segment {
    pub(super) fn ends(&self) -> [Vec3; 2] {
        [self.from, self.from + self.way]
    }

    /// How far along the way the nearest point of the axis is, 0 to 1, and the distance from it.
    #[inline(always)]
    fn nearest(&self, offset: Vec3) -> (f32, Vec3) {
        let t = (offset.dot(self.way) * self.inverse).clamp(0.0, 1.0);
        (t, offset - self.way * t)
    }

    /// The largest radius on it, metres.
    pub(super) fn thickest(&self) -> f32 {
        self.radius + self.growth.max(0.0)
    }

    /// The smallest radius on it, metres.
    pub(super) fn thinnest(&self) -> f32 {
        self.radius + self.growth.min(0.0)
    }
}

/// The field of a whole tree: each primitive's value is 1 on its surface, more inside, and falls to 0 where the
/// distance from its axis exceeds its radius by the blend width, which is a share of that radius.
#[derive(Debug, Clone)]
pub(super) struct Field {
    /// Those of a branch one after another.
    pub(super) segments: Vec<Segment>,
    /// The blend width as a share of the radius.
    blend: f32,
}

impl Field {
    /// The primitives of a skeleton's internodes, all at least `least` metres thick.
    ///
    /// Radii are interpolated along a branch; its first internode has its own radius all along, not its bearer's.
    pub(super) fn new(skeleton: &Skeleton, least: f32, blend: f32) -> Self {
        let radius = |node: u32| skeleton.radii()[node as usize].max(least);
        let position = |node: u32| skeleton.positions()[node as usize];
        let mut segments = Vec::with_capacity(skeleton.len());
        let mut add = |from: u32, to: u32, start: f32, branch: usize| {
            let way = position(to) - position(from);
            let square = way.length_squared();
            // A way too short for its square, or the square's inverse, to be told from zero is none.
            let sound = square > 1e-30;
            segments.push(Segment {
                from: position(from),
                way: if sound { way } else { Vec3::ZERO },
                inverse: if sound { 1.0 / square } else { 0.0 },
                radius: if sound { start } else { start.max(radius(to)) },
                growth: if sound { radius(to) - start } else { 0.0 },
                branch: branch as u32,
            });
        };
        if skeleton.segments() == 0 {
            add(0, 0, radius(0), 0);
        }
        for (number, branch) in skeleton.branches().iter().enumerate() {
            for (i, pair) in branch.nodes().windows(2).enumerate() {
                let start = if i == 0 && pair[0] != 0 { pair[1] } else { pair[0] };
                add(pair[0], pair[1], radius(start), number);
            }
        }
        Self { segments, blend }
    }

    /// How far from its axis a primitive is felt, metres.
    pub(super) fn reach(&self, segment: &Segment) -> f32 {
        segment.thickest() * (1.0 + self.blend)
    }

    /// A primitive's value from the distance in radii.
    #[inline(always)]
    fn value_at(&self, radii: f32) -> f32 {
        1.0 + (1.0 - radii) / self.blend
    }

    /// The least and the greatest value that a primitive may have within `reach` metres of a point.
    pub(super) fn range(&self, segment: &Segment, point: Vec3, reach: f32) -> (f32, f32) {
        let (t, away) = segment.nearest(point - segment.from);
        let (radius, distance) = (segment.radius + t * segment.growth, away.length());
        // The nearest point of the axis moves by no more than the point.
        let change = segment.growth.abs() * segment.inverse.sqrt() * reach;
        let thick = (radius + change).min(segment.thickest());
        let thin = (radius - change).max(segment.thinnest());
        (self.value_at((distance + reach) / thin), self.value_at((distance - reach).max(0.0) / thick))
    }

    /// The field less 1 at 4 · 4 · 4 points, of the segments named: entry `x + 4y + 16z` is that of the point so many
    /// steps of `step` metres along x, y and z from `start`.
    pub(super) fn sample(&self, near: &[u32], start: Vec3, step: f32) -> [f32; 64] {
        let (mut sum, mut best, mut any) = ([0.0f32; 64], [f32::NEG_INFINITY; 64], [f32::NEG_INFINITY; 64]);
        let mut branch = u32::MAX;
        let mut blend = |best: &mut [f32; 64]| {
            for i in 0..64 {
                let value = best[i].max(0.0);
                sum[i] += value * value;
                any[i] = any[i].max(best[i]);
            }
            *best = [f32::NEG_INFINITY; 64];
        };
        for &number in near {
            let segment = self.segments[number as usize];
            if branch != segment.branch && branch != u32::MAX {
                blend(&mut best);
            }
            branch = segment.branch;
            for z in 0..4 {
                for y in 0..4 {
                    let row = start + Vec3::new(0.0, y as f32, z as f32) * step;
                    for x in 0..4 {
                        let point = Vec3::new(row.x + x as f32 * step, row.y, row.z);
                        let (t, away) = segment.nearest(point - segment.from);
                        let radii = away.length() / (segment.radius + t * segment.growth);
                        let cell = &mut best[16 * z + 4 * y + x];
                        *cell = cell.max(self.value_at(radii));
                    }
                }
            }
        }
        blend(&mut best);
        std::array::from_fn(|i| level(sum[i], any[i]))
    }

    /// The field's value less 1 at a point, and its gradient a metre; of the segments named.
    pub(super) fn gradient(&self, near: &[u32], point: Vec3) -> (f32, Vec3) {
        // Of the whole field, and of the branch at hand.
        let (mut sum, mut slope, mut any) = (0.0, Vec3::ZERO, (f32::NEG_INFINITY, Vec3::ZERO));
        let mut best = any;
        let mut blend = |best: (f32, Vec3)| {
            let value = best.0.max(0.0);
            sum += value * value;
            slope += best.1 * value;
            if best.0 > any.0 {
                any = best;
            }
        };
        let mut branch = u32::MAX;
        for &number in near {
            let segment = &self.segments[number as usize];
            if branch != segment.branch && branch != u32::MAX {
                blend(best);
                best.0 = f32::NEG_INFINITY;
            }
            branch = segment.branch;
            let (t, away) = segment.nearest(point - segment.from);
            let radius = segment.radius + t * segment.growth;
            let distance = away.length();
            let value = self.value_at(distance / radius);
            if value > best.0 {
                let between = t > 0.0 && t < 1.0;
                let growth = if between { segment.growth * segment.inverse } else { 0.0 };
                let radial = away / distance.max(f32::MIN_POSITIVE);
                best = (value, (segment.way * (growth * distance / radius) - radial) / (radius * self.blend));
            }
        }
        blend(best);
        let value = level(sum, any.0);
        (value, if any.0 > 0.0 { slope / sum.sqrt() } else { any.1 })
    }
}

/// The blended value less 1: the root of the sum of squares (Ricci 1973), so that the fillet between two surfaces
/// at right angles is round. Where nothing is felt, it falls on.
#[inline(always)]
fn level(sum: f32, any: f32) -> f32 {
    if any > 0.0 { sum.sqrt() - 1.0 } else { any - 1.0 }
}

/// The greatest coordinate of anything felt, metres, if all of it can be computed with.
pub(super) fn extent(skeleton: &Skeleton, blend: f32) -> Result<f32, SurfaceError> {
    let mut most = 0.0f32;
    for (node, (&position, &radius)) in skeleton.positions().iter().zip(skeleton.radii()).enumerate() {
        let reach = position.abs().max_element() + radius * (1.0 + blend);
        if reach > FARTHEST {
            return Err(SurfaceError::TooFar { node, position, radius });
        }
        most = most.max(reach);
    }
    Ok(most)
}
