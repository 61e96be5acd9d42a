//! Trees that compete for space: a crown of markers, strokes of a brush.

use super::organized::LENGTH;
use super::stand::Stand;
use crate::self_organizing::{Forest, ForestError, Habit, SpaceColonization, VigorModel};
use crate::shape::{Brush, HalfEllipsoid, Shape, Union};
use glam::Vec3;
use std::f32::consts::FRAC_PI_4;

/// The presets of [`self_organizing`](crate::self_organizing) whose buds compete for [space](SpaceColonization).
pub fn spaces() -> impl Iterator<Item = &'static Stand<SpaceColonization>> {
    SPACES.iter()
}

const SPACES: &[Stand<SpaceColonization>] = &[
    Stand::new("space-crown", "Half an egg of markers on a stem, grown full.", 20, |seed| {
        let crown = HalfEllipsoid::new(Vec3::Y * 1.2, Vec3::new(2.0, 3.2, 2.0));
        let stem = Brush::new(vec![Vec3::ZERO, Vec3::Y * 1.6], 0.25);
        colony(&Union::new(stem, crown), seed)
    }),
    Stand::new(
        "space-brush",
        "Three strokes of a brush, the later ones painted while it grows.",
        36,
        |seed| colony(&strokes()[0], seed),
    )
    .tended(|forest| {
        let next = match forest.season() {
            9 => 1,
            18 => 2,
            _ => return Ok(()),
        };
        let stroke = &strokes()[next];
        forest.environment_mut(|space| space.add_shape(stroke, count(stroke), next as u64))?;
        Ok(())
    }),
];

/// Markers per cubic metre.
const DENSITY: f32 = 150.0;

fn count(shape: &dyn Shape) -> usize {
    (DENSITY * shape.volume()) as usize
}

/// A tree at the origin that grows into `shape`.
fn colony(shape: &dyn Shape, seed: u64) -> Result<Forest<SpaceColonization>, ForestError> {
    let space = SpaceColonization::in_shape(shape, count(shape), seed)?;
    let space = space.with_occupancy(2.0 * LENGTH).with_perception(6.0 * LENGTH, FRAC_PI_4);
    let habit = Habit::default()
        .with_length(LENGTH)
        .with_tip_radius(0.0025)
        .with_optimal_weight(0.5)
        .with_vigor_model(VigorModel::BorchertHonda { apical_control: 0.52 });
    let mut forest = Forest::new(space, habit, seed);
    forest.plant(Vec3::ZERO)?;
    Ok(forest)
}

/// Strokes of the brush of `space-brush`: a stem that bends over to the right, a limb to the left,
/// one upwards.
pub fn strokes() -> [Brush; 3] {
    let points: [&[[f32; 3]]; 3] = [
        &[[0.0, 0.0, 0.0], [0.0, 1.2, 0.0], [0.5, 2.2, 0.1], [1.6, 2.7, 0.3], [2.6, 2.5, 0.3]],
        &[[0.1, 1.4, 0.0], [-0.7, 2.1, -0.2], [-1.8, 2.4, -0.4], [-2.5, 3.0, -0.4]],
        &[[0.5, 2.2, 0.1], [0.5, 3.2, 0.0], [0.1, 4.2, 0.0]],
    ];
    points.map(|points| Brush::new(points.iter().map(|&point| Vec3::from_array(point)).collect(), 0.4))
}
