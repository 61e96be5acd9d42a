//! Forests in few bytes.
//!
//! `treesynth forest 1` and a line feed; eight bytes, little-endian, the length of the text that follows: all but the
//! nodes, as JSON. Then the nodes, tree by tree, in columns of their own. Numbers are LEB128: seven bits a byte, low ones
//! first, the highest bit set on all bytes but the last.
//!
//! | column | of each node |
//! |---|---|
//! | position | three `f32`, little-endian |
//! | parent | how many nodes before it; 0 at the foot |
//! | kind | 5 · main + lateral, each 0 for a node, 1 for a bud, 2 dormant, 3 dead, 4 a flower; and 128 if it is a lateral itself |
//! | number | by how much more than 1 above the one before |
//! | count | as it is |
//! | load | count less load |
//! | born | seasons after its parent; at the foot, since season 0 |
//! | azimuth | a byte |

use super::cut::Release;
use super::environment::Environment;
use super::forest::Forest;
use super::saved::{Saved, SavedTree};
use super::tree::{BUD, DEAD, DORMANT, FLOWER, Node, Tree, is_node};
use crate::ParameterError;
use glam::Vec3;
use std::io::{self, BufReader, BufWriter, Read, Write};

const MAGIC: &[u8] = b"treesynth forest 1\n";
/// In place of a child that is yet to come.
const TO_COME: u32 = 0;

/// Why some bytes are not a forest.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadForestError {
    /// The reader failed, or ended too early.
    #[error("reading failed: {0}")]
    Io(#[from] io::Error),
    /// They are something else, or damaged.
    #[error("not a forest: {0}")]
    Syntax(String),
    /// A forest that could not have grown.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

fn damaged(what: &str) -> ReadForestError {
    ReadForestError::Syntax(what.to_owned())
}

/// A tree but for its nodes.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct TreeHead {
    nodes: usize,
    number: u32,
    habit: u32,
    generation: u16,
    next_number: u32,
    vigor: f32,
    bare_since: u16,
    releases: Vec<Release>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    died: Option<u16>,
}

impl<E: Environment + serde::Serialize> Forest<E> {
    /// Writes the forest in about 20 bytes a metamer, less than a sixth of what JSON takes, at any moment; read back by
    /// [`read_compact`](Self::read_compact) it goes on bit for bit. As in JSON, envelopes, obstacles and terrain are not
    /// written, but what tells them from others is.
    ///
    /// ```
    /// use treesynth::glam::Vec3;
    /// use treesynth::self_organizing::{Forest, Habit, ShadowPropagation};
    ///
    /// let mut forest = Forest::new(ShadowPropagation::default(), Habit::default(), 1);
    /// forest.plant(Vec3::ZERO)?;
    /// forest.grow(12)?;
    /// let mut bytes = Vec::new();
    /// forest.write_compact(&mut bytes)?;
    /// let read: Forest = Forest::read_compact(&bytes[..])?;
    /// assert_eq!(read.trees(), forest.trees());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Whatever the writer returns.
    pub fn write_compact(&self, writer: impl Write) -> io::Result<()> {
        let head = serde_json::to_vec(&Saved::of(self)).map_err(io::Error::from)?;
        let mut writer = BufWriter::new(writer);
        writer.write_all(MAGIC)?;
        writer.write_all(&(head.len() as u64).to_le_bytes())?;
        writer.write_all(&head)?;
        self.trees.iter().try_for_each(|tree| write_nodes(&tree.nodes, &mut writer))?;
        writer.flush()
    }
}

impl<E: Environment + serde::de::DeserializeOwned> Forest<E> {
    /// Reads what [`write_compact`](Self::write_compact) has written. Memory is taken as bytes come, not by what they say.
    ///
    /// # Errors
    /// The reader's; bytes that are no forest, or one that could not have grown.
    pub fn read_compact(reader: impl Read) -> Result<Self, ReadForestError> {
        let mut reader = BufReader::new(reader);
        let mut magic = [0; MAGIC.len()];
        reader.read_exact(&mut magic)?;
        if magic != MAGIC {
            return Err(damaged("it does not begin as one"));
        }
        let mut length = [0; 8];
        reader.read_exact(&mut length)?;
        let length = u64::from_le_bytes(length);
        let mut head = Vec::new();
        reader.by_ref().take(length).read_to_end(&mut head)?;
        if head.len() as u64 != length {
            return Err(damaged("it ends in its head"));
        }
        let mut head: Saved<E, TreeHead> =
            serde_json::from_slice(&head).map_err(|error| ReadForestError::Syntax(error.to_string()))?;
        let trees = std::mem::take(&mut head.trees).into_iter().map(|tree| {
            let nodes = read_nodes(tree.nodes, &mut reader)?;
            Ok(Tree::try_from(tree.with(nodes))?)
        });
        let trees = trees.collect::<Result<Vec<Tree>, ReadForestError>>()?;
        Ok(Self::try_from(head.with_trees(trees))?)
    }
}

impl<'a, E: Environment> Saved<&'a E, TreeHead> {
    /// All of a forest but its nodes.
    fn of(forest: &'a Forest<E>) -> Self {
        Self {
            environment: &forest.environment,
            habits: forest.habits.clone(),
            trees: forest.trees.iter().map(TreeHead::of).collect(),
            seed: forest.seed,
            season: forest.season,
            turn: forest.turn,
            next_tree: forest.next_tree,
            most_metamers: forest.most_metamers,
            most_trees: forest.most_trees,
            parts: forest.parts,
            room: forest.room.marks(),
        }
    }
}

impl<E, T> Saved<E, T> {
    /// Puts these trees in the place of its own.
    fn with_trees<U>(self, trees: Vec<U>) -> Saved<E, U> {
        let Self { environment, habits, seed, season, turn, next_tree, most_metamers, .. } = self;
        let (most_trees, parts, room) = (self.most_trees, self.parts, self.room);
        Saved {
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
        }
    }
}

impl TreeHead {
    fn of(tree: &Tree) -> Self {
        Self {
            nodes: tree.nodes.len(),
            number: tree.number,
            habit: tree.habit,
            generation: tree.generation,
            next_number: tree.next_number,
            vigor: tree.vigor,
            bare_since: tree.bare_since,
            releases: tree.releases.clone(),
            died: tree.died,
        }
    }

    fn with(self, nodes: Vec<Node>) -> SavedTree {
        SavedTree {
            nodes,
            number: self.number,
            habit: self.habit,
            generation: self.generation,
            next_number: self.next_number,
            vigor: self.vigor,
            bare_since: Some(self.bare_since),
            releases: self.releases,
            died: self.died,
        }
    }
}

fn write_number(mut number: u32, writer: &mut impl Write) -> io::Result<()> {
    while number > 127 {
        writer.write_all(&[number as u8 | 128])?;
        number >>= 7;
    }
    writer.write_all(&[number as u8])
}

fn read_byte(reader: &mut impl Read) -> io::Result<u8> {
    let mut byte = [0];
    reader.read_exact(&mut byte)?;
    Ok(byte[0])
}

fn read_number(reader: &mut impl Read) -> Result<u32, ReadForestError> {
    let mut number = 0u64;
    for place in 0..5 {
        let byte = read_byte(reader)?;
        number |= u64::from(byte & 127) << (7 * place);
        if byte < 128 {
            return u32::try_from(number).map_err(|_| damaged("a number is too large"));
        }
    }
    Err(damaged("a number is too long"))
}

/// Kind of a child, in a byte.
fn kind(child: u32) -> u8 {
    match child {
        BUD => 1,
        DORMANT => 2,
        DEAD => 3,
        FLOWER => 4,
        _ => 0,
    }
}

fn write_nodes(nodes: &[Node], writer: &mut impl Write) -> io::Result<()> {
    for node in nodes {
        for axis in node.position.to_array() {
            writer.write_all(&axis.to_le_bytes())?;
        }
    }
    for (i, node) in nodes.iter().enumerate() {
        write_number(i as u32 - node.parent, writer)?;
    }
    for (i, node) in nodes.iter().enumerate() {
        let is_lateral = i > 0 && nodes[node.parent as usize].children[0] as usize != i;
        let [main, lateral] = node.children.map(kind);
        writer.write_all(&[5 * main + lateral + if is_lateral { 128 } else { 0 }])?;
    }
    let mut before = None;
    for node in nodes {
        let least = before.map_or(0, |before: u32| before.saturating_add(1));
        write_number(node.number.wrapping_sub(least), writer)?;
        before = Some(node.number);
    }
    nodes.iter().try_for_each(|node| write_number(node.count, writer))?;
    nodes.iter().try_for_each(|node| write_number(node.count - node.load, writer))?;
    for (i, node) in nodes.iter().enumerate() {
        let since = if i > 0 { nodes[node.parent as usize].born } else { 0 };
        write_number(u32::from(node.born - since), writer)?;
    }
    nodes.iter().try_for_each(|node| writer.write_all(&[node.azimuth]))
}

fn read_nodes(count: usize, reader: &mut impl Read) -> Result<Vec<Node>, ReadForestError> {
    let mut nodes: Vec<Node> = Vec::new();
    for _ in 0..count {
        let mut position = [0.0; 3];
        for axis in &mut position {
            let mut bytes = [0; 4];
            reader.read_exact(&mut bytes)?;
            *axis = f32::from_le_bytes(bytes);
        }
        nodes.push(Node {
            position: Vec3::from_array(position),
            parent: 0,
            children: [TO_COME; 2],
            count: 0,
            load: 0,
            number: 0,
            born: 0,
            azimuth: 0,
            order: 0,
        });
    }
    for (i, node) in nodes.iter_mut().enumerate() {
        let back = read_number(reader)?;
        let parent = (i as u32).checked_sub(back).filter(|_| (back == 0) == (i == 0));
        node.parent = parent.ok_or_else(|| damaged("a parent is not before its child"))?;
    }
    for i in 0..count {
        let byte = read_byte(reader)?;
        let kinds = byte & 127;
        for (side, kind) in [kinds / 5, kinds % 5].into_iter().enumerate() {
            nodes[i].children[side] = match kind {
                0 => TO_COME,
                1 => BUD,
                2 => DORMANT,
                3 => DEAD,
                4 => FLOWER,
                _ => return Err(damaged("a kind of bud is unknown")),
            };
        }
        if i > 0 {
            let parent = nodes[i].parent as usize;
            let place = &mut nodes[parent].children[usize::from(byte >= 128)];
            if !is_node(*place) || *place != TO_COME {
                return Err(damaged("two nodes in one place"));
            }
            *place = i as u32;
        }
    }
    let mut before = None;
    for node in &mut nodes {
        let least = before.map_or(Some(0), |before: u32| before.checked_add(1));
        let number = least.and_then(|least| least.checked_add(read_number(reader).ok()?));
        node.number = number.ok_or_else(|| damaged("a node's number is too large"))?;
        before = Some(node.number);
    }
    for node in &mut nodes {
        node.count = read_number(reader)?;
    }
    for node in &mut nodes {
        let less = read_number(reader)?;
        node.load = node.count.checked_sub(less).ok_or_else(|| damaged("a load is below nothing"))?;
    }
    for i in 0..count {
        let since = if i > 0 { nodes[nodes[i].parent as usize].born } else { 0 };
        let born =
            read_number(reader)?.checked_add(u32::from(since)).and_then(|born| u16::try_from(born).ok());
        nodes[i].born = born.ok_or_else(|| damaged("a season is too late"))?;
    }
    for node in &mut nodes {
        node.azimuth = read_byte(reader)?;
    }
    Ok(nodes)
}
