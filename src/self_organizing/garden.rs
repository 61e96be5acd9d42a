//! A gardener's work between seasons: cuts, prunes, removes.

use super::environment::Environment;
use super::forest::Forest;
use super::pass::tell;
use super::season::Change;
use super::tree::{NodeId, Tree};
use crate::shape::Shape;
use crate::{ParameterError, parallel};

impl<E: Environment> Forest<E> {
    /// Cuts a branch off: the metamer below `node` of the tree of this number, and all above it. A bud takes its
    /// place, others wake ([`Regrowth`](super::Regrowth)), and the branch may grow again. What is left keeps its
    /// width, but shedding asks of it the vigor for what it still carries.
    ///
    /// A cut moves nodes to other indices; [identities](Tree::ids) stay, so a list of them may be cut one by one in
    /// any order, what has fallen already being refused.
    ///
    /// # Errors
    /// No tree of this number; a node that does not stand, or the foot.
    pub fn cut(&mut self, tree: u32, node: NodeId) -> Result<(), ParameterError> {
        let place = self.place_of(tree)?;
        let index = self.trees[place].index_of(node).unwrap_or_default();
        ParameterError::unless(index > 0, "node", node, "a node of the tree that stands above its foot")?;
        self.tell_shades();
        let season = self.season_of(self.trees[place].number);
        let tree = &mut self.trees[place];
        let regrowth = self.habits[tree.habit as usize].regrowth;
        let fallen = tree.cut(&[index as u32], regrowth, season);
        self.environment.update_shaded(self.told[tree.class()], &[], &fallen);
        Ok(())
    }

    /// Cuts off all metamers whose ends lie outside of `keep`, and all above them, from all trees; as so many
    /// [cuts](Self::cut). Returns how many have fallen. On all threads; O(n) for n metamers, and what the environment
    /// takes.
    ///
    /// # Errors
    /// Options of the shape out of range.
    pub fn prune(&mut self, keep: &dyn Shape) -> Result<usize, ParameterError> {
        keep.check()?;
        self.tell_shades();
        let seasons: Vec<u16> = self.trees.iter().map(|tree| self.season_of(tree.number)).collect();
        let habits = &self.habits;
        let changes = parallel::each_mut(&mut self.trees, |place, tree| {
            let outside = |node: &usize| !keep.contains(tree.nodes[*node].position);
            let lowest: Vec<u32> = (1..tree.nodes.len()).filter(outside).map(|node| node as u32).collect();
            let regrowth = habits[tree.habit as usize].regrowth;
            let fallen =
                if lowest.is_empty() { Vec::new() } else { tree.cut(&lowest, regrowth, seasons[place]) };
            (tree.class(), Change { fallen, ..Change::default() })
        });
        let fallen = changes.iter().map(|(_, change)| change.fallen.len()).sum();
        tell(&mut self.environment, &self.told, changes);
        Ok(fallen)
    }

    /// Takes a tree out, root and all. Returns how many metamers it had. Numbers of others stay.
    ///
    /// # Errors
    /// No tree of this number.
    pub fn remove(&mut self, tree: u32) -> Result<usize, ParameterError> {
        let place = self.place_of(tree)?;
        self.tell_shades();
        let tree = self.trees.remove(place);
        let fallen: Vec<_> = tree.positions().collect();
        self.environment.update_shaded(self.told[tree.class()], &[], &fallen);
        Ok(tree.metamers())
    }

    /// Ends a tree's life, as ring-barking does. If its habit has [dead wood](super::DeadWood) it stands as a snag from now
    /// on, otherwise, and if it has no metamers, it goes as if [removed](Self::remove). Nothing happens to a snag.
    ///
    /// # Errors
    /// No tree of this number.
    pub fn kill(&mut self, tree: u32) -> Result<(), ParameterError> {
        let place = self.place_of(tree)?;
        let standing = &mut self.trees[place];
        if standing.died.is_some() {
            return Ok(());
        }
        if self.habits[standing.habit()].dead_wood.is_none() || standing.metamers() == 0 {
            return self.remove(tree).map(|_| ());
        }
        self.tell_shades();
        let season = self.season_of(self.trees[place].number);
        let tree = &mut self.trees[place];
        let class = tree.class();
        let change = Change { died: tree.die(season), ..Change::default() };
        tell(&mut self.environment, &self.told, vec![(class, change)]);
        Ok(())
    }

    fn place_of(&self, tree: u32) -> Result<usize, ParameterError> {
        let place = self.trees.binary_search_by_key(&tree, Tree::number);
        place.map_err(|_| ParameterError::new("tree", tree, "the number of a tree that stands"))
    }
}
