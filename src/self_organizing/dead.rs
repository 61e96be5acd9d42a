//! Dead wood: trees that die on their feet, break from the twigs to the trunk, and fall.

use super::habit::{Habit, within};
use super::tree::{BUD, DEAD, DORMANT, Tree};
use crate::ParameterError;
use crate::math;
use glam::Vec3;

/// Number of seasons for which a dead tree stands as a snag, and its shade meanwhile.
///
/// A tree dies when its root has too little vigor for its trunk ([`Shedding`](super::Shedding)), of old age
/// ([`Stature::with_lifespan`](super::Stature::with_lifespan)), or by [`Forest::kill`](super::Forest::kill). A habit without
/// dead wood takes it away at once. With it the tree stands for [`with_seasons`](Self::with_seasons) n more: k seasons after
/// its death it has lost every metamer thinner than k/n of the foot of its trunk, and all above it. So twigs fall first,
/// then branches, limbs and the top of the trunk, and in season n what is left falls and goes. That thin wood goes first and
/// snags break from the top down is the order of Maser et al. 1979, "Dead and down woody material"; that the limit rises in
/// a line is ours.
///
/// [`Tree::died`](super::Tree::died) tells which trees are dead. They have no buds, bear no leaves and no seeds.
///
/// ```
/// use treesynth::glam::Vec3;
/// use treesynth::self_organizing::{DeadWood, Forest, Habit, ShadowPropagation};
///
/// let habit = Habit::default().with_dead_wood(DeadWood::default().with_seasons(6));
/// let mut forest = Forest::new(ShadowPropagation::default(), habit, 1);
/// let tree = forest.plant(Vec3::ZERO)?;
/// forest.grow(10)?;
/// forest.kill(tree)?;
/// let whole = forest.metamers();
/// forest.grow(3)?;
/// assert_eq!(forest.trees()[0].died(), Some(10));
/// assert!(forest.metamers() < whole / 2);
/// forest.grow(3)?;
/// assert!(forest.trees().is_empty());
/// # Ok::<(), treesynth::self_organizing::ForestError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
#[must_use]
pub struct DeadWood {
    pub(super) seasons: u16,
    pub(super) shade: f32,
}

crate::recipe::readable!(DeadWood { seasons: u16, shade: f32 });

impl Default for DeadWood {
    /// 10 seasons, a fifth of the shade of the living.
    fn default() -> Self {
        Self { seasons: 10, shade: 0.2 }
    }
}

impl DeadWood {
    /// Sets the seasons from a tree's death to its fall, at least 1; 10 by default.
    pub fn with_seasons(mut self, seasons: u16) -> Self {
        self.seasons = seasons;
        self
    }

    /// Sets the shade of a dead metamer as a part of a living one's, in [0, 1]; 0.2 by default, for it has no leaves.
    pub fn with_shade(mut self, part: f32) -> Self {
        self.shade = part;
        self
    }

    pub(super) fn check(self) -> Result<(), ParameterError> {
        let seasons = self.seasons;
        ParameterError::unless(seasons > 0, "DeadWood.seasons", seasons, "at least 1 season")?;
        within("DeadWood.shade", self.shade, 0.0, 1.0)
    }
}

impl Tree {
    /// The season in which it has died, if it is a snag; see [`DeadWood`].
    pub fn died(&self) -> Option<u16> {
        self.died
    }

    /// Number of what casts the same shade: the living and the dead of each habit.
    pub(super) fn class(&self) -> usize {
        2 * self.habit() + usize::from(self.died.is_some())
    }

    /// Dies on its feet. Returns its nodes, which cast the shade of dead wood from now on. O(n).
    pub(super) fn die(&mut self, season: u16) -> Vec<Vec3> {
        self.died = Some(season);
        self.vigor = 0.0;
        self.releases = Vec::new();
        for child in self.nodes.iter_mut().flat_map(|node| &mut node.children) {
            if matches!(*child, BUD | DORMANT) {
                *child = DEAD;
            }
        }
        self.positions().collect()
    }

    /// The metamers of a snag that break in this season.
    pub(super) fn break_down(&self, habit: &Habit, died: u16, season: u16) -> Vec<u32> {
        let seasons = habit.dead_wood.map_or(1, |dead| dead.seasons);
        let since = season.saturating_sub(died);
        let Some(trunk) = self.nodes.get(1).filter(|_| since > 0) else { return Vec::new() };
        if since >= seasons {
            return vec![1];
        }
        let part = f32::from(since) / f32::from(seasons);
        let least = trunk.count as f32 * math::powf(part, habit.width_exponent);
        let thin = self.nodes.iter().enumerate().skip(2).filter(|(_, node)| (node.count as f32) < least);
        thin.map(|(node, _)| node as u32).collect()
    }
}
