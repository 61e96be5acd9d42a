//! A hedge, and how it is trimmed.

use super::degrees;
use super::organized::{apical, light};
use crate::self_organizing::{Forest, ForestError};
use crate::shape::{Bounds, Shape};
use glam::Vec3;

/// Half of its length, metres, half of its width at the ground and at its top, and its height.
const SIZE: [f32; 4] = [5.0, 0.6, 0.3, 1.5];

/// Walls lean in, so that light comes to the base.
struct Trimmed;

impl Shape for Trimmed {
    fn contains(&self, point: Vec3) -> bool {
        let [length, base, top, height] = SIZE;
        let half = base + (top - base) * (point.y / height).clamp(0.0, 1.0);
        point.is_finite() && point.y <= height && point.x.abs() <= length && point.z.abs() <= half
    }

    fn bounds(&self) -> Bounds {
        let [length, base, _, height] = SIZE;
        Bounds::new(Vec3::new(-length, -1.0, -base), Vec3::new(length, height, base))
    }
}

pub(super) fn plant(seed: u64) -> Result<Forest, ForestError> {
    // Light that comes in from both sides: shadows of one cell's depth.
    let light = light(12.0, 3.0).with_height(1).with_falloff(1.3);
    let mut forest = Forest::new(light, apical(0.4).with_lateral_angle(degrees(80.0)), seed);
    for i in 0..20u8 {
        forest.plant(Vec3::new(0.5 * f32::from(i) - 4.75, 0.0, 0.0))?;
    }
    Ok(forest)
}

pub(super) fn trim(forest: &mut Forest) -> Result<(), ForestError> {
    forest.prune(&Trimmed)?;
    Ok(())
}
