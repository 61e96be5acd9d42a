//! Many trees that share one environment.

use super::environment::Environment;
use super::habit::Habit;
use super::room::Room;
use super::shadow::ShadowPropagation;
use super::terrain::Terrain;
use super::tree::Tree;
use super::width::Width;
use crate::observer::{Cancelled, Observer, Silent, Work};
use crate::radius::{RadiusError, RadiusModel};
use crate::shape::{LARGEST, Shape};
use crate::skeleton::{Skeleton, SkeletonError};
use crate::{ParameterError, parallel};
use glam::Vec3;
use std::sync::Arc;

/// The most metamers and trees unless said otherwise.
const MOST_METAMERS: usize = 10_000_000;
const MOST_TREES: usize = 10_000;
/// The most parts of a season.
const MOST_PARTS: u32 = 64;
/// Trees that grow season by season and compete in one [`Environment`].
///
/// In a season the trees take four turns, by the remainder of their numbers; under an environment that surveys buds
/// it is one for all. In each turn all buds of its trees look at the environment as it is, then vigor is shared out,
/// branches are shed and shoots grow, tree by tree on all threads, and then the environment is told what changed. So
/// neighbours do not all grow into the same gap, and the number of threads does not matter. Every random draw is
/// keyed by (seed, tree, node). [`with_parts`](Self::with_parts) does the same for the shoots of one tree.
///
/// With serde a forest is written with its environment's options and all trees, at any moment, and goes on bit for bit
/// when read back; what could not have grown is refused. Envelopes, obstacles and terrain are not written, but what
/// tells them from others is: add the same again, in the same order, or growth is refused.
///
/// Memory: 40 bytes a metamer, on the way about 16 more for those of the trees being worked on. Time: O(n) a season
/// for n metamers, and what the environment takes.
///
/// ```
/// use treesynth::glam::Vec3;
/// use treesynth::self_organizing::{Forest, Habit, ShadowPropagation};
///
/// let mut forest = Forest::new(ShadowPropagation::default(), Habit::default(), 1);
/// forest.plant(Vec3::new(-0.4, 0.0, 0.0))?;
/// forest.plant(Vec3::new(0.4, 0.0, 0.0))?;
/// forest.grow(10)?;
/// assert_eq!(forest.trees().len(), 2);
/// let ahead = forest.ahead(5)?;
/// assert!(ahead.metamers() > forest.metamers() && forest.season() == 10);
/// # Ok::<(), treesynth::self_organizing::ForestError>(())
/// ```
#[must_use]
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "super::saved::Saved<E>"))]
#[cfg_attr(feature = "serde", serde(bound(deserialize = "E: serde::Deserialize<'de>")))]
pub struct Forest<E: Environment = ShadowPropagation> {
    pub(super) environment: E,
    #[cfg_attr(feature = "serde", serde(serialize_with = "super::saved::write_room"))]
    pub(super) room: Room,
    pub(super) habits: Vec<Habit>,
    pub(super) trees: Vec<Tree>,
    pub(super) seed: u64,
    pub(super) season: u16,
    /// Turn of the trees that grow next, in [0, TURNS).
    pub(super) turn: u32,
    pub(super) next_tree: u32,
    pub(super) most_metamers: usize,
    pub(super) most_trees: usize,
    /// In how many parts the shoots of a season grow.
    pub(super) parts: u32,
    /// The shade of each [class](Tree::class) that the environment has been told of.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) told: Vec<f32>,
}

crate::recipe::readable!(@[E: Environment] Forest<E> { most_metamers: usize, most_trees: usize, parts: u32 });

/// Why a season did not come to pass.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ForestError {
    /// An option is out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The next turn of the season would have led beyond the limit of metamers. All that has grown until then is
    /// kept; with a higher limit, growth goes on from there.
    #[error(
        "season {season} would bring the forest to {metamers} metamers, but the limit is {limit}; what has grown until \
         then is kept; with_most_metamers raises the limit"
    )]
    Limit {
        /// The season, from 1.
        season: u16,
        /// The metamers there would be, before shedding.
        metamers: u64,
        /// The most there may be.
        limit: usize,
    },
    /// A tree has as many nodes, or the forest as many seasons, as can be numbered.
    #[error("{what} can be numbered up to {most} only")]
    Numbers {
        /// Name of the quantity that is over its limit.
        what: &'static str,
        /// The highest number.
        most: u32,
    },
    /// The observer cancelled the work. What has grown is kept; growth may go on from there, and a season that was
    /// broken off between two turns is finished first.
    #[error("cancelled by the observer")]
    Cancelled,
    /// The radii of a tree could not be worked out.
    #[error("the radii: {0}")]
    Radius(#[from] RadiusError),
    /// A tree is no skeleton.
    #[error("the tree: {0}")]
    Skeleton(#[from] SkeletonError),
}

/// Result of `change` on an environment that no node stands in meanwhile.
fn emptied<E: Environment, T>(
    environment: &mut E,
    trees: &[Tree],
    told: &[f32],
    change: impl FnOnce(&mut E) -> T,
) -> T {
    let nodes = |class: usize| -> Vec<Vec3> {
        trees.iter().filter(|tree| tree.class() == class).flat_map(Tree::positions).collect()
    };
    for (class, &shade) in told.iter().enumerate() {
        environment.update_shaded(shade, &[], &nodes(class));
    }
    let result = change(environment);
    for (class, &shade) in told.iter().enumerate() {
        environment.update_shaded(shade, &nodes(class), &[]);
    }
    result
}

impl From<Cancelled> for ForestError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl<E: Environment> Forest<E> {
    /// No trees yet. At most 10 million metamers and 10,000 trees.
    pub fn new(environment: E, habit: Habit, seed: u64) -> Self {
        Self {
            environment,
            room: Room::default(),
            habits: vec![habit],
            trees: Vec::new(),
            seed,
            season: 0,
            turn: 0,
            next_tree: 0,
            most_metamers: MOST_METAMERS,
            most_trees: MOST_TREES,
            parts: 1,
            told: Vec::new(),
        }
    }

    /// Adds another species and returns its number for [`plant_as`](Self::plant_as); that of `new` is 0.
    pub fn add_habit(&mut self, habit: Habit) -> usize {
        self.habits.push(habit);
        self.habits.len() - 1
    }

    /// The species, to be changed between seasons.
    pub fn habits_mut(&mut self) -> &mut [Habit] {
        &mut self.habits
    }

    /// The species.
    pub fn habits(&self) -> &[Habit] {
        &self.habits
    }

    /// Nodes stay inside of `shape` from now on, as well as inside of envelopes added before.
    pub fn with_envelope(mut self, shape: impl Shape + 'static) -> Self {
        self.room.envelopes.push(Arc::new(shape));
        self
    }

    /// Nodes stay outside of `shape` from now on. Metamers are looked at in four places each, so one can slip through
    /// a shape that is thinner than a quarter of it. Under [`ShadowPropagation`] an obstacle also casts shade.
    pub fn with_obstacle(mut self, shape: impl Shape + 'static) -> Self {
        self.room.obstacles.push(Arc::new(shape));
        self.obstruct();
        self
    }

    /// Sets the ground: trees stand on it, wherever they are planted or sown, and nothing grows below it. Under
    /// [`ShadowPropagation`] hills cast shade.
    pub fn with_terrain(mut self, terrain: impl Terrain + 'static) -> Self {
        self.room.terrain = Some(Arc::new(terrain));
        self.obstruct();
        self
    }

    /// Tells the environment what stands in the way of light; what has grown is told anew.
    fn obstruct(&mut self) {
        let Self { environment, room, trees, told, .. } = self;
        emptied(environment, trees, told, |environment| {
            environment.obstruct(&room.obstacles, room.terrain.as_ref());
        });
    }

    /// Changes the environment between seasons, as in [`SpaceColonization::add_markers`], and returns what `change` does. All
    /// nodes are taken out of it before and put in again after, so whatever changes, it knows of what stands. O(n) for
    /// n metamers, and what the environment takes for them.
    ///
    /// ```
    /// use treesynth::glam::Vec3;
    /// use treesynth::self_organizing::{Forest, Habit, SpaceColonization};
    /// use treesynth::shape::Sphere;
    ///
    /// let crown = |y: f32| Sphere::new(Vec3::Y * y, 0.3);
    /// let space = SpaceColonization::in_shape(&crown(0.3), 2000, 1)?;
    /// let mut forest = Forest::new(space, Habit::default().with_optimal_weight(0.5), 1);
    /// forest.plant(Vec3::ZERO)?;
    /// forest.grow(10)?;
    /// let top = |forest: &Forest<_>| forest.trees()[0].positions().map(|node| node.y).fold(0.0, f32::max);
    /// let before = top(&forest);
    /// forest.environment_mut(|space| space.add_shape(&crown(0.8), 2000, 2))?;
    /// forest.grow(10)?;
    /// assert!(before < 0.5 && top(&forest) > 0.7);
    /// # Ok::<(), treesynth::self_organizing::ForestError>(())
    /// ```
    ///
    /// [`SpaceColonization::add_markers`]: super::SpaceColonization::add_markers
    pub fn environment_mut<T>(&mut self, change: impl FnOnce(&mut E) -> T) -> T {
        let Self { environment, room, trees, told, .. } = self;
        emptied(environment, trees, told, |environment| {
            let result = change(environment);
            if !room.obstacles.is_empty() || room.terrain.is_some() {
                environment.obstruct(&room.obstacles, room.terrain.as_ref());
            }
            result
        })
    }

    /// Sets the most metamers, at most 2³¹; 10 million by default. A turn that would lead beyond is not begun.
    pub fn with_most_metamers(mut self, metamers: usize) -> Self {
        self.most_metamers = metamers;
        self
    }

    /// Sets the most trees; 10,000 by default. When there are so many, seeds do not sprout.
    pub fn with_most_trees(mut self, trees: usize) -> Self {
        self.most_trees = trees;
        self
    }

    /// Sets in how many parts the shoots of a season grow, in [1, 64]; 1 by default. The buds that have stood longest
    /// come first, and those of the next part turn from the shadows of all that has grown before. The original goes
    /// bud after bud: more parts come nearer to it, fewer are faster. May change between seasons.
    ///
    /// One tree of the default habit, 20 seasons, has 17,000 metamers on the average with one part, 20,700 with
    /// three, and 22,500 by the original's rules.
    pub fn with_parts(mut self, parts: u32) -> Self {
        self.parts = parts;
        self
    }

    /// Plants a tree of the first species at `foot`, metres, or on the terrain above or below it; returns its number.
    ///
    /// # Errors
    /// No room there: outside of the environment or an envelope, in an obstacle, not finite; or too many trees.
    pub fn plant(&mut self, foot: Vec3) -> Result<u32, ForestError> {
        self.plant_as(foot, 0)
    }

    /// As [`plant`](Self::plant), of another species.
    ///
    /// # Errors
    /// As `plant`, and a species that does not exist.
    pub fn plant_as(&mut self, foot: Vec3, habit: usize) -> Result<u32, ForestError> {
        self.check()?;
        ParameterError::unless(
            habit < self.habits.len(),
            "habit",
            habit,
            "the number of one of the species",
        )?;
        let foot = self.room.grounded(foot);
        let range =
            "where the environment, envelopes, obstacles and terrain leave room, within a million metres";
        ParameterError::unless(self.has_room(foot), "foot", foot, range)?;
        let trees = self.trees.len();
        ParameterError::unless(trees < self.most_trees, "Forest.trees", trees, "below the most trees")?;
        let next = self.next_tree;
        ParameterError::unless(next < u32::MAX, "Forest.next_tree", next, "below 4294967295")?;
        self.tell_shades();
        self.root(foot, habit as u32, 0);
        let shade = self.told[2 * habit];
        self.environment.update_shaded(shade, &[foot], &[]);
        if let Err(error) = self.environment.check() {
            // The environment cannot reach it.
            self.environment.update_shaded(shade, &[], &[foot]);
            self.trees.pop();
            self.next_tree = next;
            return Err(error.into());
        }
        Ok(next)
    }

    pub(super) fn has_room(&self, foot: Vec3) -> bool {
        foot.abs().max_element() <= LARGEST && self.environment.contains(foot) && self.room.holds(foot)
    }

    pub(super) fn root(&mut self, foot: Vec3, habit: u32, generation: u16) {
        let season = self.season_of(self.next_tree);
        self.trees.push(Tree::new(foot, self.next_tree, habit, generation, season));
        self.next_tree += 1;
    }

    /// Checks that all options are in range. Growth asks this before each season.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.room.check()?;
        self.environment.check()?;
        let most = self.most_metamers;
        ParameterError::unless(most <= 1 << 31, "Forest.most_metamers", most, "at most 2^31")?;
        let (parts, range) = (self.parts, "1 to 64");
        ParameterError::unless((1..=MOST_PARTS).contains(&parts), "Forest.parts", parts, range)?;
        self.habits.iter().try_for_each(Habit::check)
    }

    /// One season.
    ///
    /// # Errors
    /// Options out of range, and the limits.
    pub fn step(&mut self) -> Result<(), ForestError> {
        self.grow_observed(1, &Silent)
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
        for index in 0..seasons {
            self.pass(Work::Season { index, of: seasons }, observer)?;
        }
        Ok(())
    }

    /// The forest after so many more seasons; this one stays as it is.
    ///
    /// # Errors
    /// As [`grow`](Self::grow).
    pub fn ahead(&self, seasons: u32) -> Result<Self, ForestError>
    where
        E: Clone,
    {
        let mut forest = self.clone();
        forest.grow(seasons)?;
        Ok(forest)
    }

    /// The trees that stand, by ascending number.
    pub fn trees(&self) -> &[Tree] {
        &self.trees
    }

    /// The environment as the latest season left it.
    pub fn environment(&self) -> &E {
        &self.environment
    }

    /// Seasons so far.
    pub fn season(&self) -> u16 {
        self.season
    }

    /// The metamers of all trees.
    pub fn metamers(&self) -> usize {
        self.trees.iter().map(Tree::metamers).sum()
    }

    /// A tree as a skeleton with the radii of [`Width`], its stages the seasons in which nodes appeared.
    ///
    /// # Errors
    /// Radii beyond `f32`.
    pub fn skeleton(&self, tree: &Tree) -> Result<Skeleton, ForestError> {
        let habit = self.habits.get(tree.habit()).unwrap_or(&self.habits[0]);
        let skeleton = tree.skeleton()?;
        let radii = Width::new(tree, habit).radii(&skeleton)?;
        Ok(skeleton.with_radii(radii)?)
    }

    /// The skeletons of all trees, on all threads.
    ///
    /// # Errors
    /// As [`skeleton`](Self::skeleton).
    pub fn skeletons(&self) -> Result<Vec<Skeleton>, ForestError> {
        parallel::map(self.trees.len(), |tree| self.skeleton(&self.trees[tree])).into_iter().collect()
    }
}
