//! The implicit field: skeletal primitives, joined along branches and blended between them.

#![allow(clippy::inline_always, reason = "a call in a loop over 64 voxels keeps it from being vectorized")]

use super::solid::{Coverage, Part, Solid};
use super::span::{Passage, Span, hull};
use crate::surface::SurfaceError;
use crate::{Bounds, Skeleton, surface::Material};
use glam::Vec3;
use smallvec::SmallVec;

/// Farther out or thicker than this, in metres, products of coordinates leave the range of 32-bit floats.
const FARTHEST: f32 = 1e9;

/// Bound on the rounding error of sums of values.
const SLACK: f32 = 1e-5;

/// A straight part of a branch, from one node to the next: a cone with a ball at each end.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Segment {
    from: Vec3,
    way: Vec3,
    /// One over the square of the length, or 0 where there is none.
    inverse: f32,
    radius: f32,
    /// Growth of the radius along the way.
    growth: f32,
    pub(super) branch: u32,
}

impl Segment {
    pub(super) fn ends(&self) -> [Vec3; 2] {
        [self.from, self.from + self.way]
    }

    /// Place of the nearest point along the axis, 0 to 1, and the vector from it.
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
pub(crate) struct Field {
    /// The segments, those of a branch one after another.
    pub(super) segments: Vec<Segment>,
    /// The blend width as a share of the radius.
    blend: f32,
    /// The least number of voxels per radius.
    detail: f32,
    /// Greatest rounding error of a point's position in 32-bit floats, metres.
    slack: f32,
    /// Position of the primitives' origin: 0 unless the tree is drawn far from the origin.
    origin: Vec3,
}

/// The primitives of a field that are felt in a cube.
#[derive(Debug, Clone)]
pub(crate) struct Felt<'a> {
    field: &'a Field,
    /// Numbers of the segments, in rising order.
    near: SmallVec<[u32; 4]>,
    detail: f32,
    lipschitz: f32,
}

impl Field {
    /// The primitives of a skeleton's internodes, all at least `least` metres thick.
    ///
    /// Radii are interpolated along a branch; its first internode has its own radius all along, not its
    /// parent branch's.
    pub(super) fn new(
        skeleton: &Skeleton,
        least: f32,
        blend: f32,
        detail: f32,
    ) -> Result<Self, SurfaceError> {
        let slack = extent(skeleton, blend)? * 4.0 * f32::EPSILON;
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
        Ok(Self { segments, blend, detail, slack, origin: Vec3::ZERO })
    }

    /// The same tree, its own origin elsewhere.
    #[cfg_attr(not(feature = "preview"), allow(dead_code, reason = "only rays ask"))]
    pub(crate) fn moved_to(mut self, origin: Vec3) -> Self {
        self.origin = origin;
        self
    }

    /// A primitive's value from the distance in radii.
    #[inline(always)]
    fn value_at(&self, radii: f32) -> f32 {
        1.0 + (1.0 - radii) / self.blend
    }

    /// The least and the greatest value that a primitive may have in a box of that middle and half size.
    fn range(&self, segment: &Segment, middle: Vec3, half: Vec3) -> (f32, f32) {
        let (t, away) = segment.nearest(middle - segment.from);
        let (radius, distance) = (segment.radius + t * segment.growth, away.length());
        // The axis lies behind the plane through its nearest point, across the way to the middle.
        let least = distance - half.dot(away.abs()) / distance.max(f32::MIN_POSITIVE);
        let most = (away.abs() + half).length();
        // The nearest point of the axis moves by no more than the point.
        let change = segment.growth.abs() * segment.inverse.sqrt() * half.length();
        let thick = (radius + change).min(segment.thickest());
        let thin = (radius - change).max(segment.thinnest());
        (self.value_at(most / thin), self.value_at(least.max(0.0) / thick))
    }

    /// Primitives, of those named, that count in a cube.
    fn felt(&self, among: impl Iterator<Item = u32>, cube: Bounds) -> Coverage<Felt<'_>> {
        let (middle, half) = (cube.center(), cube.size() * 0.5 + Vec3::splat(self.slack));
        let mut near = SmallVec::new();
        let (mut thinnest, mut steepest) = (f32::INFINITY, 0.0f32);
        // Squares of each branch's greatest value, and how many branches there are.
        let (mut sum, mut branches) = (0.0, 0);
        let mut branch = (u32::MAX, 0.0f32);
        for number in among {
            let segment = &self.segments[number as usize];
            let (least, most) = self.range(segment, middle, half);
            if least > 1.0 + SLACK {
                return Coverage::Inside;
            }
            if most > 0.0 {
                near.push(number);
                if branch.0 != segment.branch {
                    sum += branch.1 * branch.1;
                    branches += 1;
                    branch = (segment.branch, 0.0);
                }
                branch.1 = branch.1.max(most);
                thinnest = thinnest.min(segment.thinnest());
                // Nowhere is it steeper than where it ends.
                let growth = segment.growth * segment.inverse.sqrt() * (1.0 + self.blend);
                steepest = steepest.max((1.0 + growth * growth).sqrt() / segment.thinnest());
            }
        }
        if sum + branch.1 * branch.1 < 1.0 - SLACK {
            return Coverage::Outside;
        }
        let lipschitz = steepest * (branches as f32).sqrt() / self.blend;
        Coverage::Crossed(Felt { field: self, near, detail: thinnest / self.detail, lipschitz })
    }
}

impl<'a> Solid for &'a Field {
    type Part = Felt<'a>;

    fn bounds(&self) -> Bounds {
        let bounds = self.segments.iter().fold(Bounds::EMPTY, |bounds, segment| {
            let reach = Vec3::splat(segment.thickest() * (1.0 + self.blend) + self.slack);
            segment.ends().into_iter().fold(bounds, |bounds, end| bounds.union(Bounds::around(end, reach)))
        });
        bounds.translated(self.origin)
    }

    fn part(&self, of: Option<&Felt<'a>>, cube: Bounds) -> Coverage<Felt<'a>> {
        let cube = Bounds::new(cube.min - self.origin, cube.max - self.origin);
        match of {
            Some(part) => self.felt(part.near.iter().copied(), cube),
            None => self.felt(0..self.segments.len() as u32, cube),
        }
    }
}

impl Part for Felt<'_> {
    fn value(&self, point: Vec3) -> f32 {
        let point = point - self.field.origin;
        let (mut sum, mut best, mut branch) = (0.0, 0.0f32, u32::MAX);
        for &number in &self.near {
            let segment = &self.field.segments[number as usize];
            if branch != segment.branch {
                sum += best * best;
                (best, branch) = (0.0, segment.branch);
            }
            let (t, away) = segment.nearest(point - segment.from);
            best = best.max(self.field.value_at(away.length() / (segment.radius + t * segment.growth)));
        }
        level(sum + best * best)
    }

    fn gradient(&self, point: Vec3) -> (f32, Vec3) {
        let point = point - self.field.origin;
        // Sums over the whole field, and over the current branch.
        let (mut sum, mut slope) = (0.0, Vec3::ZERO);
        let (mut best, mut branch) = ((0.0, Vec3::ZERO), u32::MAX);
        for &number in &self.near {
            let segment = &self.field.segments[number as usize];
            if branch != segment.branch {
                sum += best.0 * best.0;
                slope += best.1 * best.0;
                (best.0, branch) = (0.0, segment.branch);
            }
            let (t, away) = segment.nearest(point - segment.from);
            let radius = segment.radius + t * segment.growth;
            let distance = away.length();
            let value = self.field.value_at(distance / radius);
            if value > best.0 {
                let between = t > 0.0 && t < 1.0;
                let growth = if between { segment.growth * segment.inverse } else { 0.0 };
                let radial = away / distance.max(f32::MIN_POSITIVE);
                let ahead = segment.way * (growth * distance / radius);
                best = (value, (ahead - radial) / (radius * self.field.blend));
            }
        }
        sum += best.0 * best.0;
        slope += best.1 * best.0;
        (level(sum), if sum > 0.0 { slope / sum.sqrt() } else { Vec3::ZERO })
    }

    fn sample(&self, start: Vec3, step: f32) -> [f32; 64] {
        let start = start - self.field.origin;
        let (mut sum, mut best) = ([0.0f32; 64], [0.0f32; 64]);
        let mut branch = u32::MAX;
        for &number in &self.near {
            let segment = self.field.segments[number as usize];
            if branch != segment.branch {
                for i in 0..64 {
                    sum[i] += best[i] * best[i];
                }
                (best, branch) = ([0.0; 64], segment.branch);
            }
            for z in 0..4 {
                for y in 0..4 {
                    let row = start + Vec3::new(0.0, y as f32, z as f32) * step;
                    for x in 0..4 {
                        let point = Vec3::new(row.x + x as f32 * step, row.y, row.z);
                        let (t, away) = segment.nearest(point - segment.from);
                        let radii = away.length() / (segment.radius + t * segment.growth);
                        let cell = &mut best[16 * z + 4 * y + x];
                        *cell = cell.max(self.field.value_at(radii));
                    }
                }
            }
        }
        std::array::from_fn(|i| level(sum[i] + best[i] * best[i]))
    }

    fn span(&self, passage: &Passage) -> Option<Span> {
        let passage = &Passage { origin: passage.origin - self.field.origin, ..*passage };
        hull(self.near.iter().map(|&number| {
            let segment = &self.field.segments[number as usize];
            let reach = segment.thickest() * (1.0 + self.field.blend);
            passage.near(segment.from, segment.way, segment.inverse, reach)
        }))
    }

    fn color(&self, _: Vec3) -> [f32; 3] {
        Material::bark().color()
    }

    fn detail(&self) -> f32 {
        self.detail
    }

    fn count(&self) -> usize {
        self.near.len()
    }

    fn lipschitz(&self) -> f32 {
        self.lipschitz
    }
}

/// The blended value less 1: the root of the sum of squares (Ricci 1973), so that the fillet between two surfaces
/// at right angles is round.
#[inline(always)]
fn level(sum: f32) -> f32 {
    sum.sqrt() - 1.0
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
