//! Sun and sky on a surface.

use super::ambient::Ambient;
use super::ray::{Cast, Sunbeams, Sunlight};
use super::shadow::ShadowMap;
use crate::shape::Bounds;
use glam::Vec3;

/// Light of the sun on a surface that faces it, linear red, green, blue.
const SUN: Vec3 = Vec3::new(2.5, 2.3, 2.02);
/// Light of the open sky on a surface that faces up.
const SKY: Vec3 = Vec3::new(0.78, 0.9, 1.1);
/// The part of the sunlight on the back of a leaf that comes through it.
const TRANSMITTED: f32 = 0.5;
/// Light from the ground on a surface that faces down.
const GROUND: Vec3 = Vec3::new(0.5, 0.47, 0.43);

/// Rays from a leaf to the sun.
const LEAF_BEAMS: usize = 4;

/// The parts of sun and sky that are seen from a place, 0 to 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    sun: f32,
    sky: f32,
}

/// The light on a place, without the shadows of solids.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lit {
    /// From sky and ground.
    pub(super) sky: Vec3,
    /// From the sun, were no solid in the way.
    pub(super) sun: Vec3,
    /// What a solid leaves of that.
    pub(super) light: Sunlight,
}

pub(super) struct Light<'a> {
    sun: Vec3,
    shadow: ShadowMap,
    ambient: Ambient,
    /// What casts shadows without triangles.
    solid: Option<&'a dyn Cast>,
}

impl<'a> Light<'a> {
    /// Light from the direction `sun`, a unit vector, for what is in `bounds`.
    pub(super) fn new(sun: Vec3, bounds: Bounds) -> Self {
        Self { sun, shadow: ShadowMap::new(sun, bounds), ambient: Ambient::new(bounds), solid: None }
    }

    /// Adds a solid: its shadows are found by rays to the sun if it `shades`, and it hides the sky.
    pub(super) fn add_solid(&mut self, solid: &'a dyn Cast, bounds: Bounds, shades: bool) {
        self.solid = Some(solid).filter(|_| shades);
        self.ambient.add_solid(solid, bounds);
    }

    /// Adds a triangle that may stand in the light.
    #[inline]
    pub(super) fn add(&mut self, corners: [Vec3; 3], two_sided: bool) {
        self.shadow.add(corners, two_sided);
        self.ambient.add(corners, two_sided);
    }

    /// To be called once, when everything is in.
    pub(super) fn finish(&mut self) {
        self.shadow.finish();
        self.ambient.finish();
    }

    /// The light that falls on a point of a surface, or comes through it from behind if it is `thin`. A solid is asked by
    /// so many `beams` whether it lets it through.
    pub(super) fn on(&self, point: Vec3, normal: Vec3, thin: bool, beams: Sunbeams) -> Vec3 {
        let Lit { sky, sun, light } = self.lit(point, normal, thin, beams);
        sky + sun * light.seen
    }

    /// The same in parts.
    pub(super) fn lit(&self, point: Vec3, normal: Vec3, thin: bool, beams: Sunbeams) -> Lit {
        let (mut light, mut sun) = (Sunlight { seen: 1.0, softness: 0.0 }, 0.0);
        let facing = normal.dot(self.sun);
        if facing > 0.0 || thin {
            let normal = if facing > 0.0 { normal } else { -normal };
            sun = self.shadow.light(point, normal);
            if let Some(solid) = self.solid.filter(|_| sun > 0.0) {
                light = solid.sunlight(point, normal, self.sun, beams);
            }
        }
        let sky = self.falling(Seen { sun: 0.0, sky: self.ambient.light(point, normal) }, normal, thin);
        Lit { sky, sun: self.falling(Seen { sun, sky: 0.0 }, normal, thin), light }
    }

    /// What a whole leaf sees, from its middle.
    pub(super) fn seen(&self, middle: Vec3) -> Seen {
        let mut sun = self.shadow.light(middle, self.sun);
        if let Some(solid) = self.solid.filter(|_| sun > 0.0) {
            sun *= solid.sunlight(middle, self.sun, self.sun, Sunbeams::all(LEAF_BEAMS, 0, 0)).seen;
        }
        Seen { sun, sky: self.ambient.light(middle, Vec3::ZERO) }
    }

    /// The light on a surface that sees so much of sun and sky.
    pub(super) fn falling(&self, seen: Seen, normal: Vec3, thin: bool) -> Vec3 {
        let facing = normal.dot(self.sun);
        let slope = if facing > 0.0 || !thin { facing.max(0.0) } else { -facing * TRANSMITTED };
        // Among leaves light goes on from one to the next.
        let sky = if thin { seen.sky.sqrt() } else { seen.sky };
        SUN * (slope * seen.sun) + GROUND.lerp(SKY, 0.5 + 0.5 * normal.y) * sky
    }

    /// What is left of the light on level ground, each channel 0 to 1; that of the sun apart only if there is a solid.
    pub(super) fn on_ground(&self, point: Vec3, beams: Sunbeams) -> Lit {
        let full = SUN * self.sun.y.max(0.0) + SKY;
        let Lit { sky, sun, light } = self.lit(point, Vec3::Y, false, beams);
        let part = |light: Vec3| (light / full).clamp(Vec3::ZERO, Vec3::ONE);
        if self.solid.is_none() {
            return Lit { sky: part(sky + sun), sun: Vec3::ZERO, light };
        }
        Lit { sky: part(sky), sun: part(sun), light }
    }
}
