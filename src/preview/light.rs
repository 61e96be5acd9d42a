//! Sun and sky on a surface.

use super::ambient::Ambient;
use super::ray::{Cast, Sunbeams, Sunlight};
use super::shadow::ShadowMap;
use super::wear::Cut;
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

/// Greatest factor by which relief is brighter in the sun than the surface without it.
const STEEPEST: f32 = 5.0;
/// The part of the light that wood and leaves mirror head-on.
const MIRRORED: f32 = 0.04;

/// Rays from a leaf to the sun.
const LEAF_BEAMS: usize = 4;

/// The parts of sun and sky that are seen from a place, 0 to 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    sun: f32,
    sky: f32,
}

impl Seen {
    /// Light from the sky, relative to all of it: in a crown it goes on from leaf to leaf and from leaf to wood.
    fn sky_and_bounced(self) -> f32 {
        self.sky.sqrt()
    }
}

/// The light on a place, without the shadows of solids.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lit {
    /// From sky and ground.
    pub(super) sky: Vec3,
    /// From the sun, were no solid in the way.
    pub(super) sun: Vec3,
    /// Part of it that a solid leaves.
    pub(super) light: Sunlight,
}

/// Look of a place of a surface by its images.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surface {
    /// The normal with relief, on the side that is seen.
    pub(super) normal: Vec3,
    pub(super) color: Vec3,
    /// The colour of light from behind, if that has an image of its own.
    pub(super) transmitted: Option<Vec3>,
    /// 0 to 1: how open it is to the sky.
    pub(super) occlusion: f32,
    /// Roughness, and where the camera is; `None` for what does not shine.
    pub(super) gloss: Option<(f32, Vec3)>,
}

pub(super) struct Light<'a> {
    sun: Vec3,
    shadow: ShadowMap,
    ambient: Ambient,
    /// Solid that casts shadows without triangles.
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

    /// Adds a triangle that may stand in the light, and may have holes.
    #[inline]
    pub(super) fn add(&mut self, corners: [Vec3; 3], two_sided: bool, cut: Option<Cut<'_>>) {
        self.shadow.add(corners, two_sided, cut);
        self.ambient.add(corners, two_sided, cut.map_or(1.0, |cut| cut.share));
    }

    /// To be called once, when everything is in.
    pub(super) fn finish(&mut self) {
        self.shadow.finish();
        self.ambient.finish();
    }

    /// The light that falls on a point of a surface, or comes through it from behind if it is `thin`. A solid is asked by
    /// these `beams` whether it lets it through.
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

    /// View of a whole leaf, from its middle.
    pub(super) fn seen(&self, middle: Vec3) -> Seen {
        let mut sun = self.shadow.light(middle, self.sun);
        if let Some(solid) = self.solid.filter(|_| sun > 0.0) {
            sun *= solid.sunlight(middle, self.sun, self.sun, Sunbeams::all(LEAF_BEAMS, 0, 0)).seen;
        }
        Seen { sun, sky: self.ambient.light(middle, Vec3::ZERO) }
    }

    /// The light on a surface that sees this part of sun and sky.
    pub(super) fn falling(&self, seen: Seen, normal: Vec3, thin: bool) -> Vec3 {
        let facing = normal.dot(self.sun);
        let slope = if facing > 0.0 || !thin { facing.max(0.0) } else { -facing * TRANSMITTED };
        let sky = seen.sky_and_bounced();
        SUN * (slope * seen.sun) + GROUND.lerp(SKY, 0.5 + 0.5 * normal.y) * sky
    }

    /// The colour of what an image is laid on, at a point whose normal without the image is `facing`; the side that is
    /// seen.
    pub(super) fn shaded(
        &self,
        point: Vec3,
        facing: Vec3,
        thin: bool,
        surface: &Surface,
        beams: Sunbeams,
    ) -> Vec3 {
        let mut sun = 0.0;
        if facing.dot(self.sun) > 0.0 || thin {
            let facing = if facing.dot(self.sun) > 0.0 { facing } else { -facing };
            sun = self.shadow.light(point, facing);
            if let Some(solid) = self.solid.filter(|_| sun > 0.0) {
                sun *= solid.sunlight(point, facing, self.sun, beams).seen;
            }
        }
        self.falling_on(Seen { sun, sky: self.ambient.light(point, facing) }, facing, thin, surface)
    }

    /// The same for a place that sees this part of sun and sky.
    pub(super) fn falling_on(&self, seen: Seen, facing: Vec3, thin: bool, surface: &Surface) -> Vec3 {
        let Surface { normal, color, occlusion, .. } = *surface;
        // Relief does not see a sun that the surface itself turns away from.
        let flat = facing.dot(self.sun);
        let slope = normal.dot(self.sun).min(STEEPEST * flat);
        let from_behind = normal.dot(-self.sun).min(-STEEPEST * flat).max(0.0);
        let sun = SUN * seen.sun;
        let direct = match (slope > 0.0, thin, surface.transmitted) {
            (true, _, _) => color * sun * slope,
            (false, _, Some(transmitted)) => transmitted * sun * from_behind,
            (false, true, None) => color * sun * (from_behind * TRANSMITTED),
            (false, false, None) => Vec3::ZERO,
        };
        let sky = seen.sky_and_bounced();
        let sky = GROUND.lerp(SKY, 0.5 + 0.5 * normal.y) * (sky * occlusion);
        direct + color * sky + sun * self.gloss(surface) * slope.max(0.0)
    }

    /// Sunlight that is mirrored towards the camera (Trowbridge and Reitz 1975; Kelemen and
    /// Szirmay-Kalos 2001), as a part of what a white surface would scatter.
    fn gloss(&self, surface: &Surface) -> f32 {
        let Some((roughness, towards)) = surface.gloss else { return 0.0 };
        let half = (self.sun + towards).normalize_or(surface.normal);
        let spread = (roughness * roughness).clamp(0.02, 1.0);
        let squared = spread * spread;
        let across = surface.normal.dot(half).max(0.0);
        let way = self.sun.dot(half).max(0.2);
        let falloff = across * across * (squared - 1.0) + 1.0;
        MIRRORED * squared / (falloff * falloff * 4.0 * way * way)
    }

    /// Light that is left on level ground, each channel 0 to 1; the sun's is kept apart only if there is a solid.
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
