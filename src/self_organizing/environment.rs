//! The environment that buds compete in, for light or for space.

use super::habit::Habit;
use super::terrain::Terrain;
use super::tree::{Site, Tree};
use crate::ParameterError;
use crate::shape::Shape;
use glam::Vec3;
use std::sync::Arc;

/// Says how much light, space or whatever else trees live on each bud gets, and in which direction there is more.
///
/// All trees of a [`Forest`](super::Forest) share one environment; that is how they compete.
///
/// # Contract
/// - [`update`](Self::update) is told of every node that appears and of every one that falls, each once, in any
///   order. What the environment answers depends on its own options and on the nodes that stand, not on how they
///   came to stand. If not, a forest that is read back from a file goes on differently, because it is told of all
///   standing nodes at once, and regrowth after a cut sees ghosts.
/// - [`light`](Self::light) is finite and at least zero. NaN and negative numbers count as zero; where sums
///   of light leave the range of `f32`, nothing grows.
/// - [`direction`](Self::direction) is a unit vector, or zero where none is better. Nothing breaks if it is
///   longer, but then it weighs more than the habit says.
/// - Both are asked from several threads, and must not depend on the order. If they do, equal seeds no longer give
///   equal trees.
///
/// # An environment of your own
/// ```
/// use treesynth::glam::Vec3;
/// use treesynth::self_organizing::{Bud, Environment, Habit, SelfOrganizing};
///
/// /// A lamp: light falls with the square of the distance.
/// struct Lamp {
///     position: Vec3,
///     brightness: f32,
/// }
///
/// impl Environment for Lamp {
///     fn light(&self, bud: &Bud<'_>) -> f32 {
///         self.brightness / (1.0 + bud.position().distance_squared(self.position))
///     }
///
///     fn direction(&self, bud: &Bud<'_>) -> Vec3 {
///         (self.position - bud.position()).normalize_or_zero()
///     }
/// }
///
/// let lamp = Lamp { position: Vec3::new(1.0, 1.0, 0.0), brightness: 4.0 };
/// let mut tree = SelfOrganizing::new(lamp, Habit::default().with_optimal_weight(0.4), 7);
/// tree.grow(6)?;
/// let leaning: f32 = tree.skeleton()?.positions().iter().map(|p| p.x).sum();
/// assert!(leaning > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Environment: Send + Sync {
    /// Share of a bud, in units of the environment's own; a habit's vigor multiplier turns it into vigor.
    fn light(&self, bud: &Bud<'_>) -> f32;

    /// In which direction the bud had better grow.
    fn direction(&self, bud: &Bud<'_>) -> Vec3;

    /// `true` if [`light`](Self::light) depends on where a bud is and on nothing else of it, so that it need be asked
    /// once only for both buds of a node. By default it may depend on anything. If this lies, a lateral bud gets the
    /// light of the main one.
    fn is_positional(&self) -> bool {
        false
    }

    /// Nodes have appeared and fallen. The default does not care.
    fn update(&mut self, appeared: &[Vec3], fallen: &[Vec3]) {
        let _ = (appeared, fallen);
    }

    /// Shade that each node of a species casts, as a multiple of the environment's own measure; 1 by default. When
    /// the answer for a species changes, its nodes are taken out and put in again.
    fn shade_of(&self, habit: &Habit) -> f32 {
        let _ = habit;
        1.0
    }

    /// As [`update`](Self::update), of nodes that all cast this much [shade](Self::shade_of). The default forgets the
    /// shade. This is what a forest calls.
    fn update_shaded(&mut self, shade: f32, appeared: &[Vec3], fallen: &[Vec3]) {
        let _ = shade;
        self.update(appeared, fallen);
    }

    /// Nodes that all cast this much [shade](Self::shade_of) have moved, each `from` one place `to` another. By default
    /// they appear there and fall here.
    fn update_moved(&mut self, shade: f32, from: &[Vec3], to: &[Vec3]) {
        self.update_shaded(shade, to, from);
    }

    /// Takes all that stands in the way of light, obstacles and terrain, each time there are others. The
    /// default does not care; nodes keep out of them in any case.
    fn obstruct(&mut self, obstacles: &[Arc<dyn Shape>], terrain: Option<&Arc<dyn Terrain>>) {
        let _ = (obstacles, terrain);
    }

    /// The light of a living bud that counts when branches are shed; `None`, the default, for what it gets this
    /// season. An environment in which buds that have taken their space get no more says `Some`.
    fn upkeep(&self) -> Option<f32> {
        None
    }

    /// `true` if [`prepare`](Self::prepare) wants to see all buds at the start of each season. The default does
    /// not, which saves listing them.
    fn surveys(&self) -> bool {
        false
    }

    /// A season begins with these buds, if the environment [`surveys`](Self::surveys) them. [`Bud::index`] is a bud's
    /// place in this list until the next season.
    fn prepare(&mut self, buds: &[Site]) {
        let _ = buds;
    }

    /// `true` if a node may stand at `point`; by default anywhere. Growth ends where it may not.
    fn contains(&self, point: Vec3) -> bool {
        let _ = point;
        true
    }

    /// `true` if a metamer may grow from `start` to `end`; by default if the environment [contains](Self::contains) its
    /// end. A bud that may not grow waits for another season.
    fn admits(&self, start: Vec3, end: Vec3) -> bool {
        let _ = start;
        self.contains(end)
    }

    /// Checks that the options are in range.
    ///
    /// # Errors
    /// The first that is not.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

impl<T: Environment + ?Sized> Environment for Box<T> {
    fn light(&self, bud: &Bud<'_>) -> f32 {
        (**self).light(bud)
    }

    fn direction(&self, bud: &Bud<'_>) -> Vec3 {
        (**self).direction(bud)
    }

    fn is_positional(&self) -> bool {
        (**self).is_positional()
    }

    fn update(&mut self, appeared: &[Vec3], fallen: &[Vec3]) {
        (**self).update(appeared, fallen);
    }

    fn shade_of(&self, habit: &Habit) -> f32 {
        (**self).shade_of(habit)
    }

    fn update_shaded(&mut self, shade: f32, appeared: &[Vec3], fallen: &[Vec3]) {
        (**self).update_shaded(shade, appeared, fallen);
    }

    fn update_moved(&mut self, shade: f32, from: &[Vec3], to: &[Vec3]) {
        (**self).update_moved(shade, from, to);
    }

    fn obstruct(&mut self, obstacles: &[Arc<dyn Shape>], terrain: Option<&Arc<dyn Terrain>>) {
        (**self).obstruct(obstacles, terrain);
    }

    fn upkeep(&self) -> Option<f32> {
        (**self).upkeep()
    }

    fn admits(&self, start: Vec3, end: Vec3) -> bool {
        (**self).admits(start, end)
    }

    fn surveys(&self) -> bool {
        (**self).surveys()
    }

    fn prepare(&mut self, buds: &[Site]) {
        (**self).prepare(buds);
    }

    fn contains(&self, point: Vec3) -> bool {
        (**self).contains(point)
    }

    fn check(&self) -> Result<(), ParameterError> {
        (**self).check()
    }
}

/// A bud as the environment sees it. Its direction is worked out when asked for.
#[derive(Debug, Clone, Copy)]
pub struct Bud<'a> {
    pub(super) tree: &'a Tree,
    pub(super) habit: &'a Habit,
    pub(super) seed: u64,
    pub(super) node: u32,
    pub(super) lateral: bool,
    pub(super) index: u32,
}

impl Bud<'_> {
    /// Position of the bud, metres.
    pub fn position(&self) -> Vec3 {
        self.tree.nodes[self.node as usize].position
    }

    /// Its direction, a unit vector.
    pub fn direction(&self) -> Vec3 {
        if self.lateral {
            self.tree.lateral_direction(self.node, self.habit, self.seed)
        } else {
            self.tree.direction(self.node)
        }
    }

    /// The species it belongs to.
    pub fn habit(&self) -> &Habit {
        self.habit
    }

    /// The branch order of the shoot it would make: 0 on the trunk.
    pub fn order(&self) -> u8 {
        self.tree.nodes[self.node as usize].order_of(usize::from(self.lateral))
    }

    /// `true` if it stands at the side of its metamer, not at its end.
    pub fn is_lateral(&self) -> bool {
        self.lateral
    }

    /// Its place in the list that [`Environment::prepare`] got; 0 if the environment does not survey.
    pub fn index(&self) -> usize {
        self.index as usize
    }
}
