//! Time lapse: a forest between two of its seasons.

use super::environment::Environment;
use super::forest::{Forest, ForestError};
use super::tree::Tree;
use super::width::Width;
use crate::radius::RadiusModel;
use crate::skeleton::Skeleton;
use crate::{ParameterError, parallel};
use glam::Vec3;

/// A node as one of the two forests has it.
#[derive(Debug, Clone, Copy)]
struct Known {
    number: u32,
    parent: u32,
    position: Vec3,
    /// From the parent.
    along: Vec3,
    radius: f32,
    order: u16,
    born: u16,
}

impl<E: Environment> Forest<E> {
    /// All trees on the way from `before`, this forest some seasons ago, to now; by their numbers, those that have died
    /// meanwhile too. `part` is 0 then and 1 now. For films in which nothing jumps: shoots grow out of their buds, wood
    /// thickens, limbs sag, and what falls draws back. Nodes are told by their [identities](Tree::ids), so between 0 and 1
    /// the skeletons of all parts have the same nodes in the same order. O(n), on all threads.
    ///
    /// ```
    /// use treesynth::glam::Vec3;
    /// use treesynth::self_organizing::{Forest, Habit, ShadowPropagation};
    ///
    /// let mut forest = Forest::new(ShadowPropagation::default(), Habit::default(), 1);
    /// forest.plant(Vec3::ZERO)?;
    /// forest.grow(6)?;
    /// let before = forest.clone();
    /// forest.step()?;
    /// for frame in 0..=24 {
    ///     let trees = forest.skeletons_since(&before, frame as f32 / 24.0)?;
    ///     assert_eq!(trees.len(), 1);
    /// }
    /// # Ok::<(), treesynth::self_organizing::ForestError>(())
    /// ```
    ///
    /// # Errors
    /// `part` not in [0, 1]; and as [`skeleton`](Self::skeleton).
    pub fn skeletons_since(&self, before: &Self, part: f32) -> Result<Vec<Skeleton>, ForestError> {
        ParameterError::unless((0.0..=1.0).contains(&part), "part", part, "in [0, 1]")?;
        if part <= 0.0 {
            return before.skeletons();
        }
        if part >= 1.0 {
            return self.skeletons();
        }
        let mut pairs: Vec<(Option<&Tree>, Option<&Tree>)> = Vec::new();
        let (mut old, mut new) = (before.trees().iter().peekable(), self.trees().iter().peekable());
        while let Some(next) = [old.peek(), new.peek()].into_iter().flatten().map(|tree| tree.number()).min()
        {
            let is_next = |tree: &&Tree| tree.number() == next;
            pairs.push((old.next_if(is_next), new.next_if(is_next)));
        }
        let between = |pair: usize| {
            let (old, new) = pairs[pair];
            let known =
                |forest: &Self, tree: Option<&Tree>| tree.map_or(Ok(Vec::new()), |tree| forest.known(tree));
            join(&known(before, old)?, &known(self, new)?, part)
        };
        parallel::map(pairs.len(), between).into_iter().collect()
    }

    fn known(&self, tree: &Tree) -> Result<Vec<Known>, ForestError> {
        let habit = self.habits.get(tree.habit()).unwrap_or(&self.habits[0]);
        let skeleton = tree.skeleton()?;
        let radii = Width::new(tree, habit).radii(&skeleton)?;
        let one = |(node, radius): (usize, f32)| {
            let (data, orders) = (&tree.nodes[node], skeleton.orders());
            let parent = &tree.nodes[data.parent as usize];
            let along = data.position - parent.position;
            let (number, parent) = (data.number, parent.number);
            Known {
                number,
                parent,
                position: data.position,
                along,
                radius,
                order: orders[node],
                born: data.born,
            }
        };
        Ok(radii.into_iter().enumerate().map(one).collect())
    }
}

/// The nodes of both, by their numbers, which ascend.
fn join(old: &[Known], new: &[Known], part: f32) -> Result<Skeleton, ForestError> {
    let (mut olds, mut news) = (old.iter().peekable(), new.iter().peekable());
    let mut numbers = Vec::with_capacity(old.len().max(new.len()));
    let (mut places, mut parents, mut radii): (Vec<Vec3>, Vec<Option<u32>>, Vec<f32>) = Default::default();
    let (mut orders, mut stages) = (Vec::new(), Vec::new());
    while let Some(next) = [olds.peek(), news.peek()].into_iter().flatten().map(|node| node.number).min() {
        let is_next = |node: &&Known| node.number == next;
        let (was, is) = (olds.next_if(is_next), news.next_if(is_next));
        let Some(node) = is.or(was) else { break };
        // A parent has a lower number, so it has come already.
        let parent = (!numbers.is_empty()).then(|| numbers.binary_search(&node.parent).unwrap_or_default());
        let from = parent.map_or(node.position, |parent: usize| places[parent]);
        let (place, radius) = match (was, is) {
            (Some(was), Some(is)) => {
                (was.position.lerp(is.position, part), was.radius + (is.radius - was.radius) * part)
            }
            (None, Some(is)) => (from + is.along * part, is.radius * part),
            _ => (from + node.along * (1.0 - part), node.radius * (1.0 - part)),
        };
        numbers.push(next);
        places.push(place);
        radii.push(parent.map_or(radius, |parent| radius.min(radii[parent])));
        parents.push(parent.map(|parent| parent as u32));
        orders.push(node.order);
        stages.push(node.born);
    }
    Ok(Skeleton::new(places, parents)?.with_stages(stages)?.with_orders(orders)?.with_radii(radii)?)
}
