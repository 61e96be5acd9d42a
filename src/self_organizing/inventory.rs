//! The trees of a landscape's tile, measured.

use super::environment::Environment;
use super::forest::{Forest, ForestError};
use super::landscape::Landscape;
use crate::metrics::Metrics;
use crate::parallel;
use glam::{DVec3, IVec2};

/// One tree of an inventory: what it is, where it stands and how large it is.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct TreeRecord {
    /// The tile that it belongs to.
    pub tile: IVec2,
    /// Its number, [unique](super::Tree::number) within the tile.
    pub number: u32,
    /// Its species, as [`Landscape::habits`] counts them.
    pub species: usize,
    /// Place of its foot in the landscape, metres.
    pub place: DVec3,
    /// Seasons that it has grown for.
    pub age: u16,
    /// Whether it is dead and stands.
    pub is_dead: bool,
    /// Its metamers.
    pub metamers: usize,
    /// Its measures.
    pub metrics: Metrics,
}

impl<E: Environment> Landscape<E> {
    /// Measures the trees that are a tile's [own](Self::own), by ascending number, on all threads. Seeds that have not sprouted are left
    /// out. O(n log n) in the nodes of each tree.
    ///
    /// ```
    /// use treesynth::glam::IVec2;
    /// use treesynth::self_organizing::{Habit, Landscape, ShadowPropagation};
    ///
    /// let light = |bounds| ShadowPropagation::new(bounds).with_cell(0.1);
    /// let landscape = Landscape::new(light, Habit::default().with_length(0.1), 1).with_tile(2).with_margin(1);
    /// let tile = IVec2::new(5, 0);
    /// let trees = landscape.inventory(tile, &landscape.grow(tile, 6)?)?;
    /// assert!(trees.iter().all(|tree| tree.metrics.height > 0.3 && tree.place.x >= 20.0));
    /// # Ok::<(), treesynth::self_organizing::ForestError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Forest::skeleton`].
    pub fn inventory(&self, tile: IVec2, forest: &Forest<E>) -> Result<Vec<TreeRecord>, ForestError> {
        let own: Vec<_> = self.own(forest).filter(|tree| tree.metamers() > 0).collect();
        let origin = self.origin(tile);
        let record = |index: usize| {
            let tree = own[index];
            let metrics = Metrics::of(&forest.skeleton(tree)?);
            let age = tree.died().unwrap_or(forest.season()).saturating_sub(tree.born());
            Ok(TreeRecord {
                tile,
                number: tree.number(),
                species: tree.habit(),
                place: origin + tree.foot().as_dvec3(),
                age,
                is_dead: tree.died().is_some(),
                metamers: tree.metamers(),
                metrics,
            })
        };
        parallel::map(own.len(), record).into_iter().collect()
    }
}
