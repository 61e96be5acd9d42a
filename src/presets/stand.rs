//! A preset of self-organizing trees: how it is planted, how it is tended.

use super::{Season, look};
use crate::Skeleton;
use crate::foliage::{Foliage, FoliageError, Leaves};
use crate::self_organizing::{Environment, Forest, ForestError, ShadowPropagation, Tree};
use crate::shape::Bounds;
use crate::surface::Mesh;
use glam::Vec3;
use std::fmt;

/// A tree or a stand of [`self_organizing`](crate::self_organizing), in light or in space.
#[non_exhaustive]
pub struct Stand<E: Environment + 'static = ShadowPropagation> {
    /// Its name, e.g. `stand-weeping`.
    pub name: &'static str,
    /// One line that says what is seen.
    pub caption: &'static str,
    /// The seed of its picture.
    pub seed: u64,
    /// Seasons it grows for.
    pub seasons: u32,
    plant: fn(u64) -> Result<Forest<E>, ForestError>,
    tend: fn(&mut Forest<E>) -> Result<(), ForestError>,
    ground: Option<fn(f32, f32) -> f32>,
}

impl<E: Environment> Clone for Stand<E> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<E: Environment> Copy for Stand<E> {}

impl<E: Environment> fmt::Debug for Stand<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stand").field("name", &self.name).field("seed", &self.seed).finish_non_exhaustive()
    }
}

/// Squares along a side of a stand's ground.
const SQUARES: u32 = 24;

impl<E: Environment> Stand<E> {
    pub(super) const fn new(
        name: &'static str,
        caption: &'static str,
        seasons: u32,
        plant: fn(u64) -> Result<Forest<E>, ForestError>,
    ) -> Self {
        Self { name, caption, seed: 1, seasons, plant, tend: |_| Ok(()), ground: None }
    }

    /// With what a gardener does after each season.
    pub(super) const fn tended(self, tend: fn(&mut Forest<E>) -> Result<(), ForestError>) -> Self {
        Self { tend, ..self }
    }

    /// On this ground.
    pub(super) const fn on(self, ground: fn(f32, f32) -> f32) -> Self {
        Self { ground: Some(ground), ..self }
    }

    /// The stand as it is planted, with no season passed.
    ///
    /// # Errors
    /// None for the presets of this module.
    pub fn plant(&self, seed: u64) -> Result<Forest<E>, ForestError> {
        (self.plant)(seed)
    }

    /// The stand after its seasons.
    ///
    /// # Errors
    /// None that is known of for the presets of this module.
    pub fn grow(&self, seed: u64) -> Result<Forest<E>, ForestError> {
        let mut forest = self.plant(seed)?;
        for _ in 0..self.seasons {
            forest.step()?;
            self.tend(&mut forest)?;
        }
        Ok(forest)
    }

    /// The gardener's work after the season that has just passed: a hedge is trimmed, a brush
    /// paints on. Nothing for most.
    ///
    /// # Errors
    /// None for the presets of this module.
    pub fn tend(&self, forest: &mut Forest<E>) -> Result<(), ForestError> {
        (self.tend)(forest)
    }

    /// The ground below `bounds` as a mesh, where it is not the level y = 0: a block whose top is the ground.
    pub fn ground(&self, bounds: Bounds) -> Option<Mesh> {
        self.ground.map(|height| block(height, bounds))
    }

    /// The leaves of all its trees; `None` in winter. [`leaves`](Self::leaves) puts them where the text's rule has them.
    pub fn foliage(&self, season: Season) -> Option<Foliage> {
        look::HORNBEAM.foliage(season)
    }

    /// The leaves of one of its trees: where the text's rule ([`Tree::leafy`]) has them, on metamers that begin at
    /// least four nodes from the trunk base and carry fewer than 30 buds. None in winter.
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

fn block(height: fn(f32, f32) -> f32, bounds: Bounds) -> Mesh {
    let half = 0.55 * bounds.size().with_y(0.0).max_element().max(1.0);
    let (middle, step) = (bounds.center(), 2.0 * half / SQUARES as f32);
    let at = |x: f32, z: f32| Vec3::new(x, height(x, z), z);
    let (mut positions, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..=SQUARES {
        for column in 0..=SQUARES {
            let x = middle.x - half + column as f32 * step;
            let z = middle.z - half + row as f32 * step;
            let (along, across) = (at(x + 0.1, z) - at(x - 0.1, z), at(x, z + 0.1) - at(x, z - 0.1));
            positions.push(at(x, z));
            normals.push(across.cross(along).normalize_or(Vec3::Y));
            if row < SQUARES && column < SQUARES {
                let first = row * (SQUARES + 1) + column;
                let below = first + SQUARES + 1;
                indices.extend([first, below, first + 1, first + 1, below, below + 1]);
            }
        }
    }
    // Walls around it, down to below its lowest point.
    let low = positions.iter().map(|place| place.y).fold(f32::INFINITY, f32::min) - 0.05 * half;
    let place = |column: u32, row: u32| (row * (SQUARES + 1) + column) as usize;
    let ends = (0..SQUARES).flat_map(|i| {
        let last = SQUARES - i;
        [
            [place(i, 0), place(i + 1, 0)],
            [place(SQUARES, i), place(SQUARES, i + 1)],
            [place(last, SQUARES), place(last - 1, SQUARES)],
            [place(0, last), place(0, last - 1)],
        ]
    });
    for [one, other] in ends {
        let (a, b) = (positions[one], positions[other]);
        let outwards = (b - a).cross(Vec3::NEG_Y).normalize_or(Vec3::X);
        let first = positions.len() as u32;
        positions.extend([a, b, b.with_y(low), a.with_y(low)]);
        normals.extend([outwards; 4]);
        indices.extend([first, first + 1, first + 2, first, first + 2, first + 3]);
    }
    Mesh::new(positions, normals, indices)
}
