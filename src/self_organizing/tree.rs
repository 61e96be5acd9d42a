//! One tree as a flat array of nodes.

use super::cut::Release;
use super::habit::Habit;
use super::phyllotaxis::Phyllotaxis;
use crate::math::{self, UP};
use crate::random::{Purpose, unit};
use crate::skeleton::{Skeleton, SkeletonError};
use glam::Vec3;

/// In place of a child: a bud that lives.
pub(super) const BUD: u32 = u32::MAX;
/// In place of a child: nothing, for good.
pub(super) const DEAD: u32 = u32::MAX - 1;
/// In place of a child: a dormant bud. It gets neither light nor vigor until a cut nearby wakes it.
pub(super) const DORMANT: u32 = u32::MAX - 2;

/// In place of a main child: a shoot has ended in a flower there.
pub(super) const FLOWER: u32 = u32::MAX - 3;

/// `true` if a child is a node, and neither a bud nor nothing.
#[inline]
pub(super) fn is_node(child: u32) -> bool {
    child < FLOWER
}

/// The upper end of a metamer, with a main bud or child at its end and a lateral one at its side. Node 0 is the foot,
/// which has no metamer and no lateral.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub(super) struct Node {
    pub(super) position: Vec3,
    /// A smaller index than the node's own; the foot's is 0.
    pub(super) parent: u32,
    /// Main and lateral: a node, [`BUD`], [`DORMANT`], [`DEAD`] or [`FLOWER`].
    pub(super) children: [u32; 2],
    /// The most buds, living or dead, that it ever carried: its width.
    pub(super) count: u32,
    /// The same since it was last cut above: what it must pay for, lest it be shed.
    pub(super) load: u32,
    /// Its number in the order of appearance, for random draws and as its identity. Ascends with the index.
    pub(super) number: u32,
    /// The season in which it appeared.
    pub(super) born: u16,
    /// Azimuth of its lateral around the axis, in 256ths of a turn from the first vector of
    /// [`Vec3::any_orthonormal_pair`] to the second; not used if laterals are scattered.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) azimuth: u8,
    /// The branch order: 0 on the trunk. Follows from the children, and is not written.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) order: u8,
}

/// The identity of a node of one [`Tree`]: its number in the order of appearance. It stays the same for as long as
/// the node stands, whatever falls or grows, and is never given again; the foot's is 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NodeId(pub u32);

/// Position and direction of a bud, as [`Environment::prepare`](super::Environment::prepare) gets it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Site {
    /// Metres.
    pub position: Vec3,
    /// A unit vector.
    pub direction: Vec3,
}

/// A tree as it stands. Its nodes are those of its [skeleton](Self::skeleton), in the same order.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "super::saved::SavedTree"))]
pub struct Tree {
    pub(super) nodes: Vec<Node>,
    /// Of the forest's trees; random draws are keyed by it.
    pub(super) number: u32,
    /// Of the forest's habits.
    pub(super) habit: u32,
    pub(super) generation: u16,
    pub(super) next_number: u32,
    pub(super) vigor: f32,
    /// The season since when it has had no metamers.
    pub(super) bare_since: u16,
    /// Buds that a cut has woken, to sprout in the tree's next season.
    pub(super) releases: Vec<Release>,
    /// The season in which it died, if it is a snag.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub(super) died: Option<u16>,
}

impl Tree {
    pub(super) fn new(foot: Vec3, number: u32, habit: u32, generation: u16, season: u16) -> Self {
        let children = [BUD, DEAD];
        let foot = Node {
            position: foot,
            parent: 0,
            children,
            count: 1,
            load: 1,
            number: 0,
            born: season,
            azimuth: 0,
            order: 0,
        };
        let (bare_since, releases) = (season, Vec::new());
        Self {
            nodes: vec![foot],
            number,
            habit,
            generation,
            next_number: 1,
            vigor: 0.0,
            bare_since,
            releases,
            died: None,
        }
    }

    /// Its number, from 0 in the order of planting; no other tree of the forest ever has it.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// Number of its habit among the forest's.
    pub fn habit(&self) -> usize {
        self.habit as usize
    }

    /// 0 if it was planted, one more than its parent's if it was sown.
    pub fn generation(&self) -> u16 {
        self.generation
    }

    /// Its place, metres.
    pub fn foot(&self) -> Vec3 {
        self.nodes[0].position
    }

    /// The season in which it was planted or sown.
    pub fn born(&self) -> u16 {
        self.nodes[0].born
    }

    /// Its metamers: one less than nodes.
    pub fn metamers(&self) -> usize {
        self.nodes.len() - 1
    }

    /// The vigor of its root in the latest season.
    pub fn vigor(&self) -> f32 {
        self.vigor
    }

    /// The identities of its nodes, ascending, in the order of [`positions`](Self::positions).
    pub fn ids(&self) -> impl ExactSizeIterator<Item = NodeId> + '_ {
        self.nodes.iter().map(|node| NodeId(node.number))
    }

    /// The index of a node among [`positions`](Self::positions) and in the skeleton, if it stands. O(log n).
    pub fn index_of(&self, node: NodeId) -> Option<usize> {
        self.nodes.binary_search_by_key(&node.0, |node| node.number).ok()
    }

    /// Positions of its nodes, metres; the base first, each parent before its children.
    pub fn positions(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        self.nodes.iter().map(|node| node.position)
    }

    /// The most buds, living or dead, that each node ever carried: 2 for a fresh metamer. Widths and leaves
    /// depend on it.
    pub fn child_counts(&self) -> impl ExactSizeIterator<Item = u32> + '_ {
        self.nodes.iter().map(|node| node.count)
    }

    /// For each node, `true` if the metamer below it bears leaves, by the text's rule: it begins at least `least_hops` nodes
    /// from the foot, and no branch that goes on from there carries `most_children` buds or more. The foot bears none, and
    /// neither does a dead tree.
    pub fn leafy(&self, most_children: u32, least_hops: u32) -> Vec<bool> {
        let (mut hops, mut dominant) = (vec![0; self.nodes.len()], vec![0; self.nodes.len()]);
        for (node, data) in self.nodes.iter().enumerate().skip(1) {
            let parent = data.parent as usize;
            hops[node] = hops[parent] + 1;
            dominant[parent] = data.count.max(dominant[parent]);
        }
        let bears = |node: &Node| {
            let parent = node.parent as usize;
            self.died.is_none() && hops[parent] >= least_hops && dominant[parent] < most_children
        };
        let above = self.nodes.iter().skip(1).map(bears);
        std::iter::once(false).chain(above).collect()
    }

    /// The living buds of each node, main and lateral.
    pub fn buds(&self) -> impl ExactSizeIterator<Item = [bool; 2]> + '_ {
        self.nodes.iter().map(|node| node.children.map(|child| child == BUD))
    }

    /// The dormant buds of each node, main and lateral: the reserve that sprouts near cuts.
    pub fn dormant_buds(&self) -> impl ExactSizeIterator<Item = [bool; 2]> + '_ {
        self.nodes.iter().map(|node| node.children.map(|child| child == DORMANT))
    }

    /// The branching as a skeleton without radii: `stages` are the seasons in which the nodes appeared, `hops` their
    /// distance from the foot in nodes, which the text calls order. An axis goes on where its main bud grew: `orders`
    /// are those of the tree. O(n).
    ///
    /// # Errors
    /// None that is known of; what the skeleton's constructors say.
    pub fn skeleton(&self) -> Result<Skeleton, SkeletonError> {
        let parents = self.nodes.iter().enumerate().map(|(i, node)| (i > 0).then_some(node.parent)).collect();
        let (mut hops, mut orders) = (vec![0; self.nodes.len()], vec![0u16; self.nodes.len()]);
        for (node, data) in self.nodes.iter().enumerate().skip(1) {
            let parent = data.parent as usize;
            hops[node] = hops[parent] + 1;
            orders[node] = orders[parent].saturating_add(u16::from(self.branches_off(node)));
        }
        Skeleton::new(self.positions().collect(), parents)?
            .with_stages(self.nodes.iter().map(|node| node.born).collect())?
            .with_hops(hops)?
            .with_orders(orders)
    }

    /// The direction of the metamer below `node`; up at the foot.
    pub(super) fn direction(&self, node: u32) -> Vec3 {
        let Node { position, parent, .. } = self.nodes[node as usize];
        (position - self.nodes[parent as usize].position).normalize_or(UP)
    }

    /// Direction of the lateral of `node`.
    pub(super) fn lateral_direction(&self, node: u32, habit: &Habit, seed: u64) -> Vec3 {
        let direction = self.direction(node);
        let Node { number, azimuth, .. } = self.nodes[node as usize];
        let angle = habit.angle_of(self.nodes[node as usize].order_of(1));
        let draw = |i: u64| unit(seed, self.number, Purpose::LATERAL, 2 * u64::from(number) + i);
        let (azimuth, cos) = match habit.phyllotaxis {
            Phyllotaxis::Scattered => {
                let least = math::cos(angle);
                (draw(0) * std::f32::consts::TAU, least + (1.0 - least) * draw(1))
            }
            _ => (f32::from(azimuth) * (std::f32::consts::TAU / 256.0), math::cos(angle)),
        };
        let (across, along) = direction.any_orthonormal_pair();
        let (s, c) = math::sin_cos(azimuth);
        let sideways = (1.0 - cos * cos).max(0.0).sqrt();
        ((across * c + along * s) * sideways + direction * cos).normalize_or(direction)
    }

    /// Works out the order of each node from its children. O(n).
    #[cfg(feature = "serde")]
    pub(super) fn number_orders(&mut self) {
        for node in 1..self.nodes.len() {
            let parent = self.nodes[self.nodes[node].parent as usize].order;
            self.nodes[node].order = parent.saturating_add(u8::from(self.branches_off(node)));
        }
    }

    /// `true` if `node`, which is not the foot, begins another axis than its parent's.
    fn branches_off(&self, node: usize) -> bool {
        let parent = &self.nodes[self.nodes[node].parent as usize];
        parent.children[0] as usize != node && parent.children[0] != FLOWER
    }
}

impl Node {
    /// `true` if a bud of it lives or sleeps.
    #[cfg(feature = "serde")]
    pub(super) fn has_buds(&self) -> bool {
        self.children.iter().any(|&child| matches!(child, BUD | DORMANT))
    }

    /// The order of the main (0) or lateral (1) child or bud. Where a shoot has ended in a flower, the lateral takes
    /// over the axis.
    pub(super) fn order_of(&self, side: usize) -> u8 {
        self.order.saturating_add(u8::from(side == 1 && self.children[0] != FLOWER))
    }
}
