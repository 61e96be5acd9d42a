//! Forests read back from files: nothing is believed that could not have grown.

use super::cut::Release;
use super::environment::Environment;
use super::forest::Forest;
use super::habit::Habit;
use super::pass::TURNS;
use super::room::{Marks, Room};
use super::tree::{DEAD, FLOWER, Node, Tree, is_node};
use crate::ParameterError;
use crate::shape::LARGEST;
use glam::Vec3;

/// Form of a [`Forest`] in files; its trees may be in a form of their own.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Saved<E, T = Tree> {
    pub(super) environment: E,
    pub(super) habits: Vec<Habit>,
    pub(super) trees: Vec<T>,
    pub(super) seed: u64,
    pub(super) season: u16,
    pub(super) turn: u32,
    pub(super) next_tree: u32,
    pub(super) most_metamers: usize,
    pub(super) most_trees: usize,
    /// Files from before there were parts do not have it.
    #[serde(default = "one")]
    pub(super) parts: u32,
    /// Files from before shapes were marked do not have it.
    #[serde(default)]
    pub(super) room: Marks,
}

/// Writes what tells a room from others.
pub(super) fn write_room<S: serde::Serializer>(room: &Room, serializer: S) -> Result<S::Ok, S::Error> {
    serde::Serialize::serialize(&room.marks(), serializer)
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
            room,
        } = saved;
        ParameterError::unless(!habits.is_empty(), "habits", 0, "at least 1")?;
        let turns = if environment.surveys() { 1 } else { TURNS };
        ParameterError::unless(turn < turns, "turn", turn, "below the turns of a season")?;
        ParameterError::unless(
            season < u16::MAX || turn == 0,
            "season",
            season,
            "below 65535 in mid-season",
        )?;
        // Shapes are checked for once growth goes on.
        let wanted = room;
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
            told: Vec::new(),
        };
        forest.check()?;
        let on_terrain = wanted.terrain.is_some();
        forest.room.wanted = wanted;
        // In mid-season the trees of the turns that are over are in the next one already.
        let now = season + u16::from(turn > 0);
        let mut last = None;
        for tree in &forest.trees {
            let (number, habit) = (tree.number(), tree.habit());
            let holds = Some(number) > last && number < next_tree;
            ParameterError::unless(holds, "number", number, "ascending, below next_tree")?;
            ParameterError::unless(habit < forest.habits.len(), "habit", habit, "the number of a species")?;
            let most = if number % turns < turn { now } else { season };
            let born = tree.nodes.iter().map(|node| node.born).max().unwrap_or_default();
            ParameterError::unless(born <= most, "born", born, "at most the season")?;
            let bare = tree.bare_since;
            ParameterError::unless(bare <= most, "bare_since", bare, "at most the season")?;
            let died = tree.died.unwrap_or_default();
            ParameterError::unless(died <= most, "died", died, "at most the season")?;
            // With a terrain the bottom of a box is not the ground.
            let is_outside = |&node: &Vec3| !on_terrain && !forest.environment.contains(node);
            let outside = tree.positions().find(is_outside);
            ParameterError::unless(outside.is_none(), "position", outside, "inside of the environment")?;
            last = Some(number);
        }
        forest.tell_shades();
        for (class, &shade) in forest.told.iter().enumerate() {
            let of_it = forest.trees.iter().filter(|tree| tree.class() == class);
            let standing: Vec<Vec3> = of_it.flat_map(Tree::positions).collect();
            forest.environment.update_shaded(shade, &standing, &[]);
        }
        Ok(forest)
    }
}

/// Form of a [`Tree`] in files.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SavedTree {
    pub(super) nodes: Vec<Node>,
    pub(super) number: u32,
    pub(super) habit: u32,
    pub(super) generation: u16,
    pub(super) next_number: u32,
    pub(super) vigor: f32,
    /// Files from before there was regrowth do not have these.
    pub(super) bare_since: Option<u16>,
    #[serde(default)]
    pub(super) releases: Vec<Release>,
    /// Files from before there was dead wood, and living trees, do not have it.
    #[serde(default)]
    pub(super) died: Option<u16>,
}

impl TryFrom<SavedTree> for Tree {
    type Error = ParameterError;

    fn try_from(saved: SavedTree) -> Result<Self, ParameterError> {
        let SavedTree { nodes, number, habit, generation, next_number, vigor, bare_since, releases, died } =
            saved;
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
            let [main, lateral] = node.children;
            ParameterError::unless(lateral != FLOWER, "children", lateral, "a flower on main axes only")?;
            for child in [main, lateral].into_iter().filter(|&child| is_node(child)) {
                let borne_here = nodes.get(child as usize).is_some_and(|child| child.parent as usize == i);
                let holds = child as usize > i && borne_here;
                ParameterError::unless(holds, "children", child, "a later node that names this its parent")?;
                borne += 1;
            }
            ParameterError::unless(node.number < next_number, "number", node.number, "below next_number")?;
            let bearer = &nodes[parent];
            let holds = i == 0 || bearer.number < node.number && nodes[i - 1].number < node.number;
            ParameterError::unless(holds, "number", node.number, "above that of the node before")?;
            // No branch is wider than what bears it, and none has more to pay for than its width.
            let holds = (1..=node.count).contains(&node.load)
                && (i == 0 || node.count <= bearer.count && node.load <= bearer.load);
            ParameterError::unless(holds, "count", node.count, "at least its load, at most its parent's")?;
            let holds = i == 0 || bearer.born <= node.born;
            ParameterError::unless(holds, "born", node.born, "not before its parent")?;
        }
        ParameterError::unless(vigor >= 0.0 && vigor.is_finite(), "vigor", vigor, "finite, at least 0")?;
        let others = nodes.len() - 1;
        ParameterError::unless(borne == others, "children", borne, "one mention of each node but the foot")?;
        for release in &releases {
            let (vigor, since) = (release.vigor, release.since);
            ParameterError::unless(since < u16::MAX, "releases", since, "a season below 65535")?;
            ParameterError::unless((0.0..=1e3).contains(&vigor), "releases", vigor, "a vigor in [0, 1000]")?;
        }
        let lives = vigor > 0.0 || !releases.is_empty() || nodes.iter().any(Node::has_buds);
        let dead_since =
            died.filter(|&died| lives || died < nodes.iter().map(|node| node.born).fold(0, u16::max));
        let range = "not before its youngest node, without vigor or buds";
        ParameterError::unless(dead_since.is_none(), "died", dead_since, range)?;
        let bare_since = bare_since.unwrap_or(nodes[0].born);
        let mut tree =
            Self { nodes, number, habit, generation, next_number, vigor, bare_since, releases, died };
        tree.number_orders();
        Ok(tree)
    }
}
