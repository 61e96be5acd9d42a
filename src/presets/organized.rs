//! Trees and stands that organize themselves: what a habit, a wind, a wall or neighbours make of a bud.

use super::{Season, degrees, look};
use crate::Skeleton;
use crate::foliage::{FoliageError, Leaves};
use crate::self_organizing::{Forest, ForestError, Habit, Offspring, ShadowPropagation, Tree, VigorModel};
use crate::shape::{Bounds, Cuboid, Sphere, Union};
use glam::Vec3;

/// A tree or a stand of [`self_organizing`](crate::self_organizing).
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Stand {
    /// Its name, e.g. `stand-weeping`.
    pub name: &'static str,
    /// What it shows.
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
        let Some(foliage) = look::HORNBEAM.foliage(season) else { return Ok(None) };
        let (mut leaves, leafy) = (foliage.place(skeleton, self.seed)?, tree.leafy(30, 4));
        leaves.instances.retain(|leaf| leafy.get(leaf.node as usize) == Some(&true));
        Ok(Some(leaves))
    }
}

/// All presets of [`self_organizing`](crate::self_organizing).
pub fn stands() -> impl Iterator<Item = &'static Stand> {
    STANDS.iter()
}

/// The stand of this name.
pub fn stand_by_name(name: &str) -> Option<&'static Stand> {
    stands().find(|stand| stand.name == name)
}

/// The length of a metamer and the width of a cell, metres: five times the original's, so that 20 seasons make some
/// 8 m.
const LENGTH: f32 = 0.1;

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

/// What the tree of `stand-wall` stands beside.
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
