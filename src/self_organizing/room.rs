//! Room for nodes: obstacles, envelope and ground, besides what the environment says.

use super::terrain::Terrain;
use crate::ParameterError;
use crate::random::{Purpose, unit};
use crate::shape::Shape;
use glam::Vec3;
use std::sync::Arc;

/// Envelopes, obstacles and the ground.
#[derive(Clone, Default)]
pub(super) struct Room {
    pub(super) envelopes: Vec<Arc<dyn Shape>>,
    pub(super) obstacles: Vec<Arc<dyn Shape>>,
    pub(super) terrain: Option<Arc<dyn Terrain>>,
    /// State of the forest when it was written, if it was read.
    pub(super) wanted: Marks,
}

/// Fingerprint of a room's shapes, for files.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub(super) struct Marks {
    envelopes: Vec<u64>,
    obstacles: Vec<u64>,
    pub(super) terrain: Option<u64>,
}

impl std::fmt::Debug for Room {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (envelopes, obstacles) = (self.envelopes.len(), self.obstacles.len());
        let mut all = f.debug_struct("Room");
        all.field("envelopes", &envelopes).field("obstacles", &obstacles);
        all.field("terrain", &self.terrain.is_some()).field("wanted", &self.wanted).finish()
    }
}

impl Room {
    pub(super) fn holds(&self, point: Vec3) -> bool {
        let inside = |shape: &Arc<dyn Shape>| shape.contains(point);
        let above = |ground: &Arc<dyn Terrain>| point.y >= ground.height(point.x, point.z);
        self.envelopes.iter().all(inside)
            && !self.obstacles.iter().any(inside)
            && self.terrain.as_ref().is_none_or(above)
    }

    /// `true` if a metamer may go from `start` to `end`: its end and three points on the way are looked at.
    pub(super) fn is_open(&self, start: Vec3, end: Vec3) -> bool {
        if self.envelopes.is_empty() && self.obstacles.is_empty() && self.terrain.is_none() {
            return true;
        }
        [1.0, 0.25, 0.5, 0.75].into_iter().all(|way| self.holds(start.lerp(end, way)))
    }

    /// `point` on the ground, if there is any.
    pub(super) fn grounded(&self, point: Vec3) -> Vec3 {
        self.terrain.as_ref().map_or(point, |ground| point.with_y(ground.height(point.x, point.z)))
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        self.envelopes.iter().chain(&self.obstacles).try_for_each(Shape::check)?;
        self.terrain.as_ref().map_or(Ok(()), |terrain| terrain.check())?;
        let (wanted, Room { envelopes, obstacles, .. }) = (&self.wanted, self);
        complete("Forest.envelopes", envelopes, &wanted.envelopes)?;
        complete("Forest.obstacles", obstacles, &wanted.obstacles)?;
        let has = self.terrain.as_ref().map(mark_of_terrain);
        let holds = wanted.terrain.is_none() || has == wanted.terrain;
        let value = if has.is_some() { "another" } else { "none" };
        ParameterError::unless(holds, "Forest.terrain", value, "the one that the forest was written with")
    }

    /// Options of writing it.
    #[cfg(feature = "serde")]
    pub(super) fn marks(&self) -> Marks {
        let all = |shapes: &[Arc<dyn Shape>]| shapes.iter().map(mark).collect();
        Marks {
            envelopes: all(&self.envelopes),
            obstacles: all(&self.obstacles),
            terrain: self.terrain.as_ref().map(mark_of_terrain),
        }
    }
}

/// Checks that the shapes are those of the marks, perhaps with more after them.
fn complete(name: &str, shapes: &[Arc<dyn Shape>], wanted: &[u64]) -> Result<(), ParameterError> {
    let holds = shapes.len() >= wanted.len()
        && shapes.iter().zip(wanted).all(|(shape, &wanted)| mark(shape) == wanted);
    if holds {
        return Ok(());
    }
    let range = format!("the {} that the forest was written with, in the same order", wanted.len());
    Err(ParameterError::new(name, format_args!("{} shapes", shapes.len()), range))
}

fn draw(i: u64) -> f32 {
    unit(0, 0, Purpose::MARKERS, i)
}

/// FNV-1a.
fn hash(words: impl Iterator<Item = u32>) -> u64 {
    let bytes = words.flat_map(u32::to_le_bytes);
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// From the bounds of a shape and from what it says of a few points in them.
fn mark(shape: &Arc<dyn Shape>) -> u64 {
    let bounds = shape.bounds();
    let inside = |i: u64| {
        let place = Vec3::new(draw(3 * i), draw(3 * i + 1), draw(3 * i + 2));
        u32::from(shape.contains(bounds.min + bounds.size() * place))
    };
    let ends = bounds.min.to_array().into_iter().chain(bounds.max.to_array()).map(f32::to_bits);
    hash(ends.chain((0..64).map(inside)))
}

/// From the heights at a few points within a hundred metres.
fn mark_of_terrain(terrain: &Arc<dyn Terrain>) -> u64 {
    let place = |i: u64| 200.0 * draw(i) - 100.0;
    hash((0..64).map(|i| terrain.height(place(2 * i), place(2 * i + 1)).to_bits()))
}
