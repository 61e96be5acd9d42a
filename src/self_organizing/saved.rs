//! Forests read back from files: nothing is believed that could not have grown.

use super::environment::Environment;
use super::forest::{Forest, TURNS};
use super::habit::Habit;
use super::room::Room;
use super::tree::{BUD, DEAD, Node, Tree};
use crate::ParameterError;
use crate::shape::LARGEST;
use glam::Vec3;

/// What [`Forest`] writes.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Saved<E> {
    environment: E,
    habits: Vec<Habit>,
    trees: Vec<Tree>,
    seed: u64,
    season: u16,
    turn: u32,
    next_tree: u32,
    most_metamers: usize,
    most_trees: usize,
    /// Files from before there were parts do not have it.
    #[serde(default = "one")]
    parts: u32,
}

fn one() -> u32 {
    1
}

impl<E: Environment> TryFrom<Saved<E>> for Forest<E> {
    type Error = ParameterError;

    fn try_from(saved: Saved<E>) -> Result<Self, ParameterError> {
        let Saved {
            environment,
            habits,
            trees,
            seed,
            season,
            turn,
            next_tree,
            most_metamers,
            most_trees,
            parts,
        } = saved;
        ParameterError::unless(!habits.is_empty(), "habits", 0, "at least 1")?;
        ParameterError::unless(turn < TURNS, "turn", turn, "below 4")?;
        let room = Room::default();
        let mut forest = Self {
            environment,
            room,
            habits,
            trees,
            seed,
            season,
            turn,
            next_tree,
            most_metamers,
            most_trees,
            parts,
        };
        forest.check()?;
        let mut last = None;
        for tree in &forest.trees {
            let (number, habit) = (tree.number(), tree.habit());
            let holds = Some(number) > last && number < next_tree;
            ParameterError::unless(holds, "number", number, "ascending, below next_tree")?;
            ParameterError::unless(habit < forest.habits.len(), "habit", habit, "the number of a species")?;
            let born = tree.nodes.iter().map(|node| node.born).max().unwrap_or_default();
            ParameterError::unless(born <= season, "born", born, "at most the season")?;
            last = Some(number);
        }
        let standing: Vec<Vec3> = forest.trees.iter().flat_map(Tree::positions).collect();
        forest.environment.update(&standing, &[]);
        Ok(forest)
    }
}

/// What [`Tree`] writes.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SavedTree {
    nodes: Vec<Node>,
    number: u32,
    habit: u32,
    generation: u16,
    next_number: u32,
    vigor: f32,
}

impl TryFrom<SavedTree> for Tree {
    type Error = ParameterError;

    fn try_from(saved: SavedTree) -> Result<Self, ParameterError> {
        let SavedTree { nodes, number, habit, generation, next_number, vigor } = saved;
        ParameterError::unless(!nodes.is_empty(), "nodes", 0, "at least 1")?;
        let mut borne = 0;
        for (i, node) in nodes.iter().enumerate() {
            let place = node.position;
            let holds = place.abs().max_element() <= LARGEST && place.is_finite();
            ParameterError::unless(holds, "position", place, "finite, within a million metres")?;
            let parent = node.parent as usize;
            let holds = if i == 0 {
                parent == 0 && node.children[1] == DEAD
            } else {
                parent < i && nodes[parent].children.contains(&(i as u32))
            };
            ParameterError::unless(holds, "parent", parent, "before the node, and the one that bears it")?;
            for child in node.children.into_iter().filter(|&child| child != BUD && child != DEAD) {
                let borne_here = nodes.get(child as usize).is_some_and(|child| child.parent as usize == i);
                let holds = child as usize > i && borne_here;
                ParameterError::unless(holds, "children", child, "a later node that names this its parent")?;
                borne += 1;
            }
            ParameterError::unless(node.number < next_number, "number", node.number, "below next_number")?;
        }
        let others = nodes.len() - 1;
        ParameterError::unless(borne == others, "children", borne, "one mention of each node but the foot")?;
        Ok(Self { nodes, number, habit, generation, next_number, vigor })
    }
}
