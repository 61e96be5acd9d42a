//! Trees and stands that organize themselves: what a habit, a wind, a wall or neighbours make of a bud.

use super::{Season, degrees, look};
use crate::Skeleton;
use crate::foliage::{Foliage, FoliageError, Leaves};
use crate::self_organizing::{
    Axis, Forest, ForestError, Habit, Offspring, Phyllotaxis, ShadowPropagation, Tree, VigorModel,
};
use crate::shape::{Bounds, Cuboid, Sphere, Union};
use glam::Vec3;

/// A tree or a stand of [`self_organizing`](crate::self_organizing).
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Stand {
    /// Its name, e.g. `stand-weeping`.
    pub name: &'static str,
    /// One line that says what is seen.
    pub caption: &'static str,
    /// The seed of its picture.
    pub seed: u64,
    /// Seasons it grows for.
    pub seasons: u32,
    plant: fn(u64) -> Result<Forest, ForestError>,
}

impl Stand {
    /// The stand as it is planted, with no season passed.
    ///
    /// # Errors
    /// None for the presets of this module.
    pub fn plant(&self, seed: u64) -> Result<Forest, ForestError> {
        (self.plant)(seed)
    }

    /// The stand after its seasons.
    ///
    /// # Errors
    /// None that is known of for the presets of this module.
    pub fn grow(&self, seed: u64) -> Result<Forest, ForestError> {
        let mut forest = self.plant(seed)?;
        forest.grow(self.seasons)?;
        Ok(forest)
    }

    /// The leaves of all its trees; `None` in winter. [`leaves`](Self::leaves) puts them where the text's rule has them.
    pub fn foliage(&self, season: Season) -> Option<Foliage> {
        look::HORNBEAM.foliage(season)
    }

    /// The leaves of one of its trees: where the text's rule ([`Tree::leafy`]) has them, on metamers that begin at
    /// least four nodes from the foot and carry fewer than 30 buds. None in winter.
    ///
    /// # Errors
    /// As [`Foliage::place`](crate::foliage::Foliage::place): a skeleton without radii, say.
    pub fn leaves(
        &self,
        tree: &Tree,
        skeleton: &Skeleton,
        season: Season,
    ) -> Result<Option<Leaves>, FoliageError> {
        let Some(foliage) = self.foliage(season) else { return Ok(None) };
        let (mut leaves, leafy) = (foliage.place(skeleton, self.seed)?, tree.leafy(30, 4));
        leaves.instances.retain(|leaf| leafy.get(leaf.node as usize) == Some(&true));
        Ok(Some(leaves))
    }
}

/// All presets of [`self_organizing`](crate::self_organizing).
pub fn stands() -> impl Iterator<Item = &'static Stand> {
    STANDS.iter()
}

/// The length of a metamer and the width of a cell, metres: five times the original's, so that 20 seasons make some
/// 8 m.
const LENGTH: f32 = 0.1;

/// Each lateral 137.5° around from the one before.
const GOLDEN: Phyllotaxis = Phyllotaxis::Spiral { divergence: 2.4 };

const STANDS: &[Stand] = &[
    stand("stand-excurrent", "Apical control 0.55: a leader above all.", 14, |seed| {
        alone(seed, apical(0.55))
    }),
    stand("stand-between", "Apical control 0.52: a crown of many leaders.", 15, |seed| {
        alone(seed, apical(0.52))
    }),
    stand("stand-decurrent", "Apical control 0.46: the leader is soon lost.", 16, |seed| {
        alone(seed, apical(0.46))
    }),
    stand("stand-weeping", "Shoots are drawn down, once the trunk stands.", 17, |seed| {
        alone(seed, apical(0.52).with_tropism(Vec3::NEG_Y, 0.28).with_optimal_weight(0.12))
    }),
    stand("stand-wind", "A steady wind from the left.", 17, |seed| {
        alone(seed, apical(0.52).with_tropism(Vec3::X, 0.12))
    }),
    stand("stand-shrub", "Laterals win from the ground on.", 11, |seed| {
        let habit =
            apical(0.4).with_lateral_angle(degrees(75.0)).with_length(0.04).with_vigor_multiplier(2.5);
        let habit = habit.with_tip_radius(0.0012);
        let mut forest = Forest::new(light(6.0, 5.0).with_cell(0.04), habit, seed);
        forest.plant(Vec3::ZERO)?;
        Ok(forest)
    }),
    stand("stand-topiary", "Two balls on a stem, filled out.", 20, |seed| {
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
    stand("stand-priority", "The priority model: a leader, and limbs by rank of their light.", 16, |seed| {
        let model = VigorModel::Priority { first: 3.0, last: 1.0, part: 0.3 };
        alone(seed, apical(0.5).with_vigor_model(model))
    }),
    stand(
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
    stand(
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
    stand("stand-spreading", "Limbs that leave the trunk at sixty degrees and keep to it.", 17, |seed| {
        let limbs = Axis::default().with_angle(degrees(60.0)).with_optimal_weight(0.03);
        alone(seed, apical(0.5).with_phyllotaxis(GOLDEN).with_axes([Axis::default(), limbs]))
    }),
    stand("stand-slope", "Four generations on a slope of one in two.", 22, |seed| {
        let offspring =
            Offspring::default().with_maturity(6).with_interval(4).with_distance(0.7).with_seeds(0.5);
        let habit = apical(0.5).with_offspring(offspring);
        let mut forest = Forest::new(light(24.0, 14.0), habit, seed).with_terrain(|x: f32, _: f32| 0.5 * x);
        forest.plant(Vec3::ZERO)?;
        Ok(forest)
    }),
    stand("stand-wall", "A wall half a metre to the left.", 17, |seed| {
        let mut forest = Forest::new(light(16.0, 14.0), apical(0.5), seed).with_obstacle(WALL);
        forest.plant(Vec3::ZERO)?;
        Ok(forest)
    }),
    stand("stand-shyness", "Nine of one age keep their crowns apart.", 16, |seed| {
        let mut forest = Forest::new(light(16.0, 14.0), apical(0.52), seed);
        for i in 0..9 {
            forest.plant(Vec3::new((i % 3) as f32 * 3.5 - 3.5, 0.0, (i / 3) as f32 * 3.5 - 3.5))?;
        }
        Ok(forest)
    }),
    stand("stand-generations", "Four generations from one seed.", 27, |seed| {
        let offspring =
            Offspring::default().with_maturity(6).with_interval(4).with_distance(0.7).with_seeds(0.5);
        let mut forest = Forest::new(light(30.0, 16.0), apical(0.5).with_offspring(offspring), seed);
        forest.plant(Vec3::ZERO)?;
        Ok(forest)
    }),
];

/// Wall beside the tree of `stand-wall`.
pub const WALL: Cuboid = Cuboid::new(Vec3::new(-1.0, 0.0, -6.0), Vec3::new(-0.6, 12.0, 6.0));

const fn stand(
    name: &'static str,
    caption: &'static str,
    seasons: u32,
    plant: fn(u64) -> Result<Forest, ForestError>,
) -> Stand {
    Stand { name, caption, seed: 1, seasons, plant }
}

fn light(width: f32, height: f32) -> ShadowPropagation {
    let half = width * 0.5;
    let bounds = Bounds::new(Vec3::new(-half, 0.0, -half), Vec3::new(half, height, half));
    ShadowPropagation::new(bounds).with_cell(LENGTH)
}

fn apical(control: f32) -> Habit {
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
