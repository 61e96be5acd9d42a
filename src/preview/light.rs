//! Sun and sky on a surface.

use super::ambient::Ambient;
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

/// The parts of sun and sky that are seen from a place, 0 to 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    sun: f32,
    sky: f32,
}

pub(super) struct Light {
    sun: Vec3,
    shadow: ShadowMap,
    ambient: Ambient,
}

impl Light {
    /// Light from the direction `sun`, a unit vector, for what is in `bounds`.
    pub(super) fn new(sun: Vec3, bounds: Bounds) -> Self {
        Self { sun, shadow: ShadowMap::new(sun, bounds), ambient: Ambient::new(bounds) }
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

    /// The light that falls on a point of a surface, or comes through it from behind if it is `thin`.
    pub(super) fn on(&self, point: Vec3, normal: Vec3, thin: bool) -> Vec3 {
        let facing = normal.dot(self.sun);
        let sun = if facing > 0.0 || thin {
            self.shadow.light(point, if facing > 0.0 { normal } else { -normal })
        } else {
            0.0
        };
        self.falling(Seen { sun, sky: self.ambient.light(point, normal) }, normal, thin)
    }

    /// What a whole leaf sees, from its middle.
    pub(super) fn seen(&self, middle: Vec3) -> Seen {
        Seen { sun: self.shadow.light(middle, self.sun), sky: self.ambient.light(middle, Vec3::ZERO) }
    }

    /// The light on a surface that sees so much of sun and sky.
    pub(super) fn falling(&self, seen: Seen, normal: Vec3, thin: bool) -> Vec3 {
        let facing = normal.dot(self.sun);
        let slope = if facing > 0.0 || !thin { facing.max(0.0) } else { -facing * TRANSMITTED };
        // Among leaves light goes on from one to the next.
        let sky = if thin { seen.sky.sqrt() } else { seen.sky };
        SUN * (slope * seen.sun) + GROUND.lerp(SKY, 0.5 + 0.5 * normal.y) * sky
    }

    /// What is left of the light on level ground, each channel 0 to 1.
    pub(super) fn on_ground(&self, point: Vec3) -> Vec3 {
        let full = SUN * self.sun.y.max(0.0) + SKY;
        (self.on(point, Vec3::Y, false) / full).clamp(Vec3::ZERO, Vec3::ONE)
    }
}
