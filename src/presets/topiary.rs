//! A bird of box on its pedestal, and how it is kept.

use super::degrees;
use super::organized::{apical, light};
use crate::self_organizing::{Forest, ForestError, Regrowth, Shedding};
use crate::shape::{Bounds, Shape};
use glam::Vec3;

/// The length of a metamer and the width of a cell, metres: a box has short ones.
const LENGTH: f32 = 0.05;
/// The season in which the bird is first trimmed.
const FIRST: u16 = 3;

/// A peacock that looks to the left, on a round pedestal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Peacock;

/// Its rounded parts: two ends and a radius at each, metres, from the breast to the end of the train.
const PARTS: [(Vec3, f32, Vec3, f32); 5] = [
    (Vec3::new(-0.25, 1.45, 0.0), 0.45, Vec3::new(0.3, 1.4, 0.0), 0.42),
    (Vec3::new(-0.45, 1.6, 0.0), 0.32, Vec3::new(-0.72, 2.25, 0.0), 0.17),
    (Vec3::new(-0.75, 2.35, 0.0), 0.24, Vec3::new(-0.78, 2.38, 0.0), 0.24),
    (Vec3::new(-0.9, 2.35, 0.0), 0.14, Vec3::new(-1.2, 2.27, 0.0), 0.07),
    (Vec3::new(0.4, 1.45, 0.0), 0.4, Vec3::new(1.7, 1.75, 0.0), 0.3),
];
/// Radius of the pedestal at the ground and at its top, and its height.
const PEDESTAL: [f32; 3] = [0.75, 0.55, 1.0];

impl Shape for Peacock {
    fn contains(&self, point: Vec3) -> bool {
        let [base, top, height] = PEDESTAL;
        let wide = base + (top - base) * (point.y / height).clamp(0.0, 1.0);
        let in_pedestal = point.y <= height && point.with_y(0.0).length() <= wide;
        let in_part = |&(from, first, to, last): &(Vec3, f32, Vec3, f32)| {
            let along = to - from;
            let way = ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            point.distance(from + along * way) <= first + (last - first) * way
        };
        point.is_finite() && (in_pedestal || PARTS.iter().any(in_part))
    }

    fn bounds(&self) -> Bounds {
        Bounds::new(Vec3::new(-1.3, -0.1, -0.8), Vec3::new(2.1, 2.7, 0.8))
    }
}

pub(super) fn plant(seed: u64) -> Result<Forest, ForestError> {
    // Light that comes in from all sides: shadows of one cell's depth.
    let light = light(6.0, 4.0).with_cell(LENGTH).with_height(1).with_falloff(1.3);
    let habit = apical(0.45)
        .with_length(LENGTH)
        .with_tip_radius(0.0012)
        .with_lateral_angle(degrees(80.0))
        .with_shedding(Shedding::default().with_multiplier(0.15))
        .with_regrowth(Regrowth::default().with_buds(3));
    let mut forest = Forest::new(light, habit, seed);
    forest.plant(Vec3::ZERO)?;
    Ok(forest)
}

pub(super) fn trim(forest: &mut Forest) -> Result<(), ForestError> {
    if forest.season() >= FIRST {
        forest.prune(&Peacock)?;
    }
    Ok(())
}
