//! Trees and stands that organize themselves: the effects of habit, wind, walls and neighbours.

use super::stand::Stand;
use super::{degrees, hedge, topiary};
use crate::random::{Purpose, unit};
use crate::self_organizing::{
    Axis, Daylight, DeadWood, Forest, ForestError, Habit, Offspring, Phyllotaxis, Regrowth, Sag,
    ShadowPropagation, Shedding, VigorModel,
};
use crate::shape::{Bounds, Cuboid, Cylinder, Intersection, Sphere, Union};
use glam::Vec3;

/// All presets of [`self_organizing`](crate::self_organizing) whose buds compete for light.
pub fn stands() -> impl Iterator<Item = &'static Stand> {
    STANDS.iter()
}

/// The length of a metamer and the width of a cell, metres: five times the original's, so that 20 seasons make some
/// 8 m.
pub(super) const LENGTH: f32 = 0.1;

/// Each lateral 137.5° around from the one before.
pub(super) const GOLDEN: Phyllotaxis = Phyllotaxis::Spiral { divergence: 2.4 };

const STANDS: &[Stand] = &[
    Stand::new("stand-excurrent", "Apical control 0.55: a leader above all.", 14, |seed| {
        alone(seed, apical(0.55))
    }),
    Stand::new("stand-between", "Apical control 0.52: a crown of many leaders.", 15, |seed| {
        alone(seed, apical(0.52))
    }),
    Stand::new("stand-decurrent", "Apical control 0.46: the leader is soon lost.", 16, |seed| {
        alone(seed, apical(0.46))
    }),
    Stand::new("stand-weeping", "Shoots are drawn down, once the trunk stands.", 17, |seed| {
        alone(seed, apical(0.52).with_tropism(Vec3::NEG_Y, 0.28).with_optimal_weight(0.12))
    }),
    Stand::new("stand-wind", "A steady wind from the left.", 17, |seed| {
        alone(seed, apical(0.52).with_tropism(Vec3::X, 0.12))
    }),
    Stand::new("stand-shrub", "Laterals win from the ground on.", 11, |seed| {
        let habit =
            apical(0.4).with_lateral_angle(degrees(75.0)).with_length(0.04).with_vigor_multiplier(2.5);
        let habit = habit.with_tip_radius(0.0012);
        let mut forest = Forest::new(light(6.0, 5.0).with_cell(0.04), habit, seed);
        forest.plant(Vec3::ZERO)?;
        Ok(forest)
    }),
    Stand::new("stand-topiary", "Two balls on a stem, filled out.", 20, |seed| {
        let ball = |y: f32, radius: f32| Sphere::new(Vec3::Y * y, radius);
        let stem = Cuboid::new(Vec3::new(-0.2, -0.1, -0.2), Vec3::new(0.2, 3.4, 0.2));
        let shape = Union::new(Union::new(stem, ball(1.5, 0.8)), ball(3.1, 0.6));
        let habit = apical(0.5)
            .with_length(0.03)
            .with_lateral_angle(degrees(70.0))
            .with_vigor_multiplier(2.5)
            .with_shedding(None);
        let light = light(4.0, 5.0).with_cell(0.03);
        let mut forest = Forest::new(light, habit.with_tip_radius(0.0015), seed).with_envelope(shape);
        forest.plant(Vec3::ZERO)?;
        Ok(forest)
    }),
    Stand::new(
        "stand-priority",
        "The priority model: a leader, and limbs by rank of their light.",
        16,
        |seed| {
            let model = VigorModel::Priority { first: 3.0, last: 1.0, part: 0.3 };
            alone(seed, apical(0.5).with_vigor_model(model))
        },
    ),
    Stand::new(
        "stand-spruce",
        "Level limbs near the end of each year's shoot, on a trunk that goes on.",
        18,
        |seed| {
            let trunk = Axis::default().with_laterals(0.5, 1.0).with_longest(5.0).with_up_weight(0.3);
            let limbs = Axis::default()
                .with_angle(degrees(75.0))
                .with_level_weight(0.4)
                .with_optimal_weight(0.02)
                .with_laterals(0.4, 1.0)
                .with_longest(3.0);
            let twigs = limbs.with_angle(degrees(50.0)).with_longest(2.0);
            let habit = apical(0.56).with_phyllotaxis(GOLDEN).with_axes([trunk, limbs, twigs]);
            alone(seed, habit)
        },
    ),
    Stand::new(
        "stand-spray",
        "Laterals in two rows on level axes: flat sprays, storey above storey.",
        12,
        |seed| {
            let trunk = Axis::default().with_optimal_weight(0.15);
            let limbs = Axis::default()
                .with_angle(degrees(50.0))
                .with_level_weight(0.25)
                .with_optimal_weight(0.04)
                .with_longest(5.0);
            let rows = Phyllotaxis::Spiral { divergence: std::f32::consts::PI };
            alone(seed, apical(0.52).with_phyllotaxis(rows).with_axes([trunk, limbs]))
        },
    ),
    Stand::new(
        "stand-spreading",
        "Limbs that leave the trunk at sixty degrees and keep to it.",
        17,
        |seed| {
            let limbs = Axis::default().with_angle(degrees(60.0)).with_optimal_weight(0.03);
            alone(seed, apical(0.5).with_phyllotaxis(GOLDEN).with_axes([Axis::default(), limbs]))
        },
    ),
    Stand::new(
        "stand-bowed",
        "Limbs that rise at thirty degrees, and bow under their load with age.",
        18,
        |seed| {
            let limbs = Axis::default().with_angle(degrees(30.0)).with_optimal_weight(0.03);
            let habit = apical(0.53).with_phyllotaxis(GOLDEN).with_axes([Axis::default(), limbs]);
            alone(seed, habit.with_sag(Sag::default().with_modulus(7e8)))
        },
    ),
    Stand::new("stand-slope", "Four generations on a slope of one in two.", 22, |seed| {
        let offspring =
            Offspring::default().with_maturity(6).with_interval(4).with_distance(0.7).with_seeds(0.5);
        let habit = apical(0.5).with_offspring(offspring);
        let mut forest = Forest::new(light(24.0, 14.0), habit, seed).with_terrain(slope);
        forest.plant(Vec3::ZERO)?;
        Ok(forest)
    })
    .on(slope),
    Stand::new(
        "stand-sun",
        "A lane from north to south, at fifty degrees north: the crown leans to the sun.",
        16,
        |seed| {
            let light = light(16.0, 14.0).with_daylight(Daylight::at_latitude(degrees(50.0)));
            let mut forest = Forest::new(light, apical(0.5), seed);
            for side in [-1.0f32, 1.0] {
                let (near, far) = (Vec3::new(side * 1.5, 0.0, -9.0), Vec3::new(side * 9.0, 8.0, 9.0));
                forest = forest.with_obstacle(Cuboid::new(near.min(far), near.max(far)));
            }
            forest.plant(Vec3::ZERO)?;
            Ok(forest)
        },
    ),
    Stand::new("stand-hedge", "Twenty in a row, trimmed every year.", 30, hedge::plant).tended(hedge::trim),
    Stand::new("stand-peacock", "A box clipped to a peacock, every year.", 24, topiary::plant)
        .tended(topiary::trim),
    Stand::new("stand-pollard", "Cut back to a head at two metres, every sixth year.", 33, |seed| {
        let habit = apical(0.5).with_regrowth(Regrowth::default().with_buds(8).with_reach(10));
        alone(seed, habit)
    })
    .tended(|forest| {
        // Two years of regrowth are in the last picture.
        let head = Cuboid::new(Vec3::new(-4.0, -0.1, -4.0), Vec3::new(4.0, 2.0, 4.0));
        if forest.season() >= 7 && forest.season() % 6 == 1 {
            forest.prune(&Intersection::new(head, Cylinder::new(Vec3::NEG_Y, 0.45, 9.0)))?;
        }
        Ok(())
    }),
    Stand::new("stand-wall", "A wall half a metre to the left.", 17, |seed| {
        let mut forest = Forest::new(light(16.0, 14.0), apical(0.5), seed).with_obstacle(WALL);
        forest.plant(Vec3::ZERO)?;
        Ok(forest)
    }),
    Stand::new("stand-shyness", "Nine of one age keep their crowns apart.", 16, |seed| {
        let mut forest = Forest::new(light(16.0, 14.0), apical(0.52), seed);
        for i in 0..9 {
            forest.plant(Vec3::new((i % 3) as f32 * 3.5 - 3.5, 0.0, (i / 3) as f32 * 3.5 - 3.5))?;
        }
        Ok(forest)
    }),
    Stand::new("stand-thinning", "Too many of one age: some win, the dead stand as snags.", 18, |seed| {
        let habit = apical(0.53)
            .with_shedding(Shedding::self_thinning())
            .with_dead_wood(DeadWood::default().with_seasons(8));
        let mut forest = Forest::new(light(16.0, 14.0), habit, seed);
        for i in 0..196u32 {
            let aside = |axis: u32| 0.6 * (unit(seed, axis, Purpose::PLANTS, i.into()) - 0.5);
            let place = Vec3::new((i % 14) as f32 + aside(0), 0.0, (i / 14) as f32 + aside(1));
            forest.plant((place - Vec3::new(6.5, 0.0, 6.5)) * 0.9)?;
        }
        Ok(forest)
    }),
    Stand::new("stand-generations", "Four generations from one seed.", 27, |seed| {
        let offspring =
            Offspring::default().with_maturity(6).with_interval(4).with_distance(0.7).with_seeds(0.5);
        let mut forest = Forest::new(light(30.0, 16.0), apical(0.5).with_offspring(offspring), seed);
        forest.plant(Vec3::ZERO)?;
        Ok(forest)
    }),
];

/// Wall beside the tree of `stand-wall`.
pub const WALL: Cuboid = Cuboid::new(Vec3::new(-1.0, 0.0, -6.0), Vec3::new(-0.6, 12.0, 6.0));

/// Ground of one in two.
fn slope(x: f32, _z: f32) -> f32 {
    0.5 * x
}

pub(super) fn light(width: f32, height: f32) -> ShadowPropagation {
    let half = width * 0.5;
    let bounds = Bounds::new(Vec3::new(-half, 0.0, -half), Vec3::new(half, height, half));
    ShadowPropagation::new(bounds).with_cell(LENGTH)
}

pub(super) fn apical(control: f32) -> Habit {
    Habit::default()
        .with_vigor_model(VigorModel::BorchertHonda { apical_control: control })
        .with_length(LENGTH)
        .with_tip_radius(0.0025)
}

/// One tree in the open.
fn alone(seed: u64, habit: Habit) -> Result<Forest, ForestError> {
    let mut forest = Forest::new(light(20.0, 18.0), habit, seed);
    forest.plant(Vec3::ZERO)?;
    Ok(forest)
}
