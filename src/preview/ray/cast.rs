//! Queries of the renderer to a solid: first hits, sunlight, passages.

use super::octree::Octree;
use super::walk::{Beam, Entry, Ray};
use crate::math;
use crate::surface::solid::{Part, Solid};
use glam::{Vec2, Vec3};
use std::ops::ControlFlow;

/// Half the angle under which the sun is seen, as a slope; as wide as that of the shadows of meshes.
const SUN_SLOPE: f32 = 0.01;
/// Off the surface by this part of a pixel, so that it does not shade itself.
const BIAS: f32 = 0.05;

/// Point at which the eye meets a surface.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Hit {
    pub(in super::super) point: Vec3,
    pub(in super::super) normal: Vec3,
    pub(in super::super) color: Vec3,
}

/// Rays from a place to the sun: `count` of the `of` that make the whole sun, from `first` on, all
/// turned about the sun's middle.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Sunbeams {
    pub(in super::super) first: usize,
    pub(in super::super) count: usize,
    pub(in super::super) of: usize,
    /// In whole turns.
    pub(in super::super) turn: f32,
}

impl Sunbeams {
    /// All `of` rays to the sun, for a place of the picture: neighbours turn theirs differently.
    pub(in super::super) fn all(of: usize, column: usize, row: usize) -> Self {
        // Interleaved gradient noise (Jimenez 2014): differs most where places are nearest.
        let fract = |x: f32| x - x.floor();
        let turn = fract(52.982_918 * fract(0.067_110_56 * column as f32 + 0.005_837_15 * row as f32));
        Self { first: 0, count: of, of, turn }
    }

    /// One of them.
    pub(in super::super) fn one(self, index: usize) -> Self {
        // A step that is prime to every square up to 64, so that nearby samples look at distant parts of the sun.
        Self { first: index * 37 % self.of, count: 1, ..self }
    }

    /// Places on the unit disc (Vogel's spiral).
    fn places(self) -> impl Iterator<Item = Vec2> {
        (self.first..self.first + self.count).map(move |i| {
            let (sin, cos) = math::sin_cos(i as f32 * 2.399_963_2 + self.turn * std::f32::consts::TAU);
            Vec2::new(cos, sin) * ((i as f32 + 0.5) / self.of as f32).sqrt()
        })
    }
}

/// Sunlight that is left.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Sunlight {
    /// The part of the sun that is seen, 0 to 1.
    pub(in super::super) seen: f32,
    /// The half width of the shadow's edge, pixels.
    pub(in super::super) softness: f32,
}

/// Says what a ray meets first.
pub(in super::super) type Look<'a> = dyn Fn(&Ray) -> Option<Hit> + 'a;

/// A solid that rays are cast at.
pub(in super::super) trait Cast: Sync {
    /// Has those of the beams in `block` drawn, by their numbers, that may meet something, with a function that says what
    /// a ray of that beam meets first.
    fn look(&self, block: &Beam, beams: &[Beam], draw: &mut dyn FnMut(usize, &Look<'_>));

    /// The part of the sun in the direction `sun` that is seen from a point of a surface.
    fn sunlight(&self, point: Vec3, normal: Vec3, sun: Vec3, beams: Sunbeams) -> Sunlight;

    /// Points where a ray enters and leaves the solid, and the normals there.
    fn passages(&self, ray: &Ray) -> Vec<(Vec3, Vec3)>;

    /// `true` if more memory was needed than was allowed: all answers may be wrong then.
    fn is_full(&self) -> bool;
}

impl<S: Solid> Cast for Octree<'_, S> {
    fn look(&self, block: &Beam, beams: &[Beam], draw: &mut dyn FnMut(usize, &Look<'_>)) {
        let mirror = block.ray.mirror();
        let (all, mut wide, mut near) = (self.whole(), Vec::new(), Vec::new());
        self.gather(all[0], block, mirror, 0.5, &mut wide);
        if wide.is_empty() {
            return;
        }
        for (number, beam) in beams.iter().enumerate() {
            near.clear();
            let own = beam.ray.mirror();
            // A beam that does not go as its block does visits cubes in another order.
            for &entry in if own == mirror { &wide[..] } else { &all[..] } {
                self.gather(entry, beam, own, 0.0, &mut near);
            }
            if !near.is_empty() {
                draw(number, &|ray| self.hit(if ray.mirror() == own { &near } else { &all }, ray));
            }
        }
    }

    fn sunlight(&self, point: Vec3, normal: Vec3, sun: Vec3, beams: Sunbeams) -> Sunlight {
        let pixel = self.pixel(point);
        let origin = point + normal * (BIAS * pixel);
        let (right, up) = sun.any_orthonormal_pair();
        let (mut blocked, mut distance) = (0, 0.0);
        for place in beams.places() {
            let way = (sun + (right * place.x + up * place.y) * SUN_SLOPE).normalize();
            self.crossings(&self.whole(), &Ray { origin, way, from: 0.0, to: f32::MAX }, |crossing| {
                blocked += 1;
                distance += crossing.t;
                ControlFlow::Break(())
            });
        }
        let seen = 1.0 - blocked as f32 / beams.count as f32;
        let softness = distance / blocked.max(1) as f32 * SUN_SLOPE / pixel;
        Sunlight { seen, softness }
    }

    fn passages(&self, ray: &Ray) -> Vec<(Vec3, Vec3)> {
        let mut passages = Vec::new();
        self.crossings(&self.whole(), ray, |crossing| {
            passages.push(crossing.place(ray));
            ControlFlow::Continue(())
        });
        passages
    }

    fn is_full(&self) -> bool {
        Octree::is_full(self) || self.is_crowded()
    }
}

impl<S: Solid> Octree<'_, S> {
    /// First thing that a ray through these cubes meets.
    pub(super) fn hit<'o>(&'o self, among: &[Entry<'o, S::Part>], ray: &'o Ray) -> Option<Hit> {
        let mut hit = None;
        self.crossings(among, ray, |crossing| {
            let (point, normal) = crossing.place(ray);
            // Within a solid it is dark.
            let color = crossing.leaf.map_or([0.0; 3], |(leaf, _)| leaf.part.color(point));
            hit = Some(Hit { point, normal, color: color.into() });
            ControlFlow::Break(())
        });
        hit
    }
}
