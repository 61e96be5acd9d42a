//! One tree alone.

use super::environment::Environment;
use super::forest::{Forest, ForestError};
use super::habit::Habit;
use super::shadow::ShadowPropagation;
use super::terrain::Terrain;
use super::tree::{NodeId, Tree};
use crate::ParameterError;
use crate::observer::{Observer, Silent};
use crate::shape::Shape;
use crate::skeleton::Skeleton;
use glam::Vec3;

/// One tree that grows season by season: a [`Forest`] of one, at the origin. Its seeds do not sprout.
///
/// ```
/// use treesynth::Metrics;
/// use treesynth::self_organizing::{Habit, SelfOrganizing, ShadowPropagation};
///
/// let mut tree = SelfOrganizing::new(ShadowPropagation::default(), Habit::default(), 1);
/// tree.grow(12)?;
/// let skeleton = tree.skeleton()?;
/// assert!(Metrics::of(&skeleton).height > 0.3);
/// // Each node knows the season in which it appeared.
/// assert_eq!(skeleton.stages().iter().max(), Some(&12));
/// # Ok::<(), treesynth::self_organizing::ForestError>(())
/// ```
#[must_use]
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(bound(deserialize = "E: serde::Deserialize<'de>")))]
pub struct SelfOrganizing<E: Environment = ShadowPropagation> {
    forest: Forest<E>,
}

impl<E: Environment> SelfOrganizing<E> {
    /// A bud at the origin.
    pub fn new(environment: E, habit: Habit, seed: u64) -> Self {
        Self { forest: Forest::new(environment, habit, seed).with_most_trees(1) }
    }

    /// Nodes stay inside of `shape` from now on, as well as inside of envelopes added before.
    pub fn with_envelope(mut self, shape: impl Shape + 'static) -> Self {
        self.forest = self.forest.with_envelope(shape);
        self
    }

    /// Nodes stay outside of `shape` from now on; see [`Forest::with_obstacle`].
    pub fn with_obstacle(mut self, shape: impl Shape + 'static) -> Self {
        self.forest = self.forest.with_obstacle(shape);
        self
    }

    /// Sets the ground; see [`Forest::with_terrain`].
    pub fn with_terrain(mut self, terrain: impl Terrain + 'static) -> Self {
        self.forest = self.forest.with_terrain(terrain);
        self
    }

    /// Sets the most metamers; see [`Forest::with_most_metamers`].
    pub fn with_most_metamers(mut self, metamers: usize) -> Self {
        self.forest = self.forest.with_most_metamers(metamers);
        self
    }

    /// Sets in how many parts the shoots of a season grow; see [`Forest::with_parts`].
    pub fn with_parts(mut self, parts: u32) -> Self {
        self.forest = self.forest.with_parts(parts);
        self
    }

    /// One season.
    ///
    /// # Errors
    /// Options out of range, no room at the origin, and the limit. The tree is then as it was.
    pub fn step(&mut self) -> Result<(), ForestError> {
        self.grow(1)
    }

    /// Number of seasons.
    ///
    /// # Errors
    /// As [`step`](Self::step); seasons finished before the error are kept.
    pub fn grow(&mut self, seasons: u32) -> Result<(), ForestError> {
        self.grow_observed(seasons, &Silent)
    }

    /// As [`grow`](Self::grow), telling `observer` how far it is and stopping when told to.
    ///
    /// # Errors
    /// As `grow`, and [`ForestError::Cancelled`].
    pub fn grow_observed(&mut self, seasons: u32, observer: &dyn Observer) -> Result<(), ForestError> {
        if self.forest.season() == 0 && self.forest.trees().is_empty() {
            self.forest.plant(Vec3::ZERO)?;
        }
        self.forest.grow_observed(seasons, observer)
    }

    /// The tree after so many more seasons; this one stays as it is.
    ///
    /// # Errors
    /// As [`grow`](Self::grow).
    pub fn ahead(&self, seasons: u32) -> Result<Self, ForestError>
    where
        E: Clone,
    {
        let mut tree = self.clone();
        tree.grow(seasons)?;
        Ok(tree)
    }

    /// Cuts off the metamer below `node` and all above it. A bud takes its place, and the branch may grow again; see
    /// [`Forest::cut`].
    ///
    /// # Errors
    /// A node that does not stand, or the foot.
    pub fn cut(&mut self, node: NodeId) -> Result<(), ParameterError> {
        self.forest.cut(0, node)
    }

    /// Cuts off all metamers whose ends lie outside of `keep`, and all above them; see [`Forest::prune`].
    ///
    /// # Errors
    /// Options of the shape out of range.
    pub fn prune(&mut self, keep: &dyn Shape) -> Result<usize, ParameterError> {
        self.forest.prune(keep)
    }

    /// The tree; `None` before it was ever grown, and once it has died.
    pub fn tree(&self) -> Option<&Tree> {
        self.forest.trees().first()
    }

    /// The tree as a skeleton with the radii of [`Width`](super::Width), its stages the seasons in which nodes
    /// appeared; a root alone if there is no tree.
    ///
    /// # Errors
    /// Radii beyond `f32`.
    pub fn skeleton(&self) -> Result<Skeleton, ForestError> {
        match self.tree() {
            Some(tree) => self.forest.skeleton(tree),
            None => Ok(Skeleton::new(vec![Vec3::ZERO], vec![None])?),
        }
    }

    /// The tree on the way from `before` to now; see [`Forest::skeletons_since`].
    ///
    /// # Errors
    /// `part` not in [0, 1].
    pub fn skeleton_since(&self, before: &Self, part: f32) -> Result<Skeleton, ForestError> {
        let mut trees = self.forest.skeletons_since(&before.forest, part)?;
        trees.pop().map_or_else(|| Ok(Skeleton::new(vec![Vec3::ZERO], vec![None])?), Ok)
    }

    /// The species, to be changed between seasons.
    pub fn habit_mut(&mut self) -> &mut Habit {
        &mut self.forest.habits_mut()[0]
    }

    /// The environment as the latest season left it.
    pub fn environment(&self) -> &E {
        self.forest.environment()
    }

    /// Changes the environment between seasons; see [`Forest::environment_mut`].
    pub fn environment_mut<T>(&mut self, change: impl FnOnce(&mut E) -> T) -> T {
        self.forest.environment_mut(change)
    }

    /// Greatest number of metamers; set by [`with_most_metamers`](Self::with_most_metamers).
    pub fn most_metamers(&self) -> usize {
        self.forest.most_metamers()
    }

    /// Number of parts of a season; set by [`with_parts`](Self::with_parts).
    pub fn parts(&self) -> u32 {
        self.forest.parts()
    }

    /// Seasons so far.
    pub fn season(&self) -> u16 {
        self.forest.season()
    }

    /// Metamers so far.
    pub fn metamers(&self) -> usize {
        self.forest.metamers()
    }
}
