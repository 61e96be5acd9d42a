//! Step 2: light becomes vigor and is shared out from the root to the buds.

use super::habit::within;
use super::tree::{BUD, Tree, is_node};
use crate::ParameterError;

/// Model by which vigor is shared among buds.
///
/// ```
/// use treesynth::self_organizing::{Habit, VigorModel};
///
/// // A leader above all; at 0.46 it is soon lost.
/// let spruce = Habit::default().with_vigor_model(VigorModel::BorchertHonda { apical_control: 0.55 });
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[non_exhaustive]
pub enum VigorModel {
    /// The extended Borchert-Honda model, step 2 of the text: at each fork, the main axis gets λ · its light and the
    /// lateral (1 - λ) · its light, scaled so that nothing is lost.
    BorchertHonda {
        /// λ, in (0, 1): above 0.5 main axes win (excurrent trees), below it laterals do (decurrent ones).
        apical_control: f32,
    },
    /// The priority model of Pałubicki et al. 2009: the vigor of a whole axis is shared among its terminal and its
    /// laterals by light times a weight. The terminal is first, the laterals follow by the mean light of their
    /// buds; the weight falls linearly from `first` to `last` over the leading part of them, and stays there.
    Priority {
        /// The weight of the terminal, in (0, 1e3].
        first: f32,
        /// The weight of what comes last, in (0, 1e3].
        last: f32,
        /// The part of the axis's buds and branches over which the weight falls, in [0, 1].
        part: f32,
    },
}

impl Default for VigorModel {
    /// The original's: Borchert-Honda with apical control 0.5.
    fn default() -> Self {
        Self::BorchertHonda { apical_control: 0.5 }
    }
}

impl VigorModel {
    pub(super) fn check(self) -> Result<(), ParameterError> {
        let positive = |name: &str, weight: f32| {
            ParameterError::unless(weight > 0.0 && weight <= 1e3, name, weight, "above 0, at most 1000")
        };
        match self {
            Self::BorchertHonda { apical_control: value } => {
                let (name, range) = ("VigorModel::BorchertHonda.apical_control", "above 0, below 1");
                ParameterError::unless(value > 0.0 && value < 1.0, name, value, range)
            }
            Self::Priority { first, last, part } => {
                positive("VigorModel::Priority.first", first)?;
                positive("VigorModel::Priority.last", last)?;
                within("VigorModel::Priority.part", part, 0.0, 1.0)
            }
        }
    }
}

/// Light and vigor of a tree's nodes and buds, for one season.
#[derive(Debug, Default)]
pub(super) struct Supply {
    /// Share of each node's buds and of all above it.
    pub(super) light: Vec<f32>,
    /// Shares of the main and the lateral bud of each node; zero where there is none.
    pub(super) buds: Vec<[f32; 2]>,
    /// The vigor of each node's metamer; the foot's is the root's.
    pub(super) vigor: Vec<f32>,
}

impl Supply {
    /// Step 1: the light of each bud, summed from the tips to the foot. `once` says that both buds of a node get the
    /// same. O(n).
    pub(super) fn sense(&mut self, tree: &Tree, once: bool, light: impl Fn(usize, usize) -> f32) {
        self.light.resize(tree.nodes.len(), 0.0);
        self.buds.resize(tree.nodes.len(), [0.0; 2]);
        for (node, data) in tree.nodes.iter().enumerate().rev() {
            let buds = match data.children.map(|child| child == BUD) {
                [true, true] if once => [light(node, 0); 2],
                [main, lateral] => {
                    [if main { light(node, 0) } else { 0.0 }, if lateral { light(node, 1) } else { 0.0 }]
                }
            };
            self.buds[node] = buds;
            self.light[node] += buds[0] + buds[1];
            if node > 0 {
                self.light[data.parent as usize] += self.light[node];
            }
        }
    }

    /// Light and vigor that the main (0) or lateral (1) child or bud of `node` has.
    pub(super) fn light_of(&self, tree: &Tree, node: usize, side: usize) -> f32 {
        match tree.nodes[node].children[side] {
            BUD => self.buds[node][side],
            child if is_node(child) => self.light[child as usize],
            _ => 0.0,
        }
    }

    /// Shares out the root's vigor. Calls `sprout` with each bud (node, side) and its vigor. O(n), and O(n log n) in
    /// the priority model.
    pub(super) fn share(
        &mut self,
        tree: &Tree,
        model: VigorModel,
        root: f32,
        sprout: &mut impl FnMut(usize, usize, f32),
    ) {
        self.vigor.resize(tree.nodes.len(), 0.0);
        self.vigor[0] = root;
        match model {
            VigorModel::BorchertHonda { apical_control } => self.share_by_forks(tree, apical_control, sprout),
            VigorModel::Priority { first, last, part } => {
                self.share_by_axes(tree, [first, last, part], sprout);
            }
        }
    }

    fn give(
        &mut self,
        tree: &Tree,
        node: usize,
        side: usize,
        vigor: f32,
        sprout: &mut impl FnMut(usize, usize, f32),
    ) {
        match tree.nodes[node].children[side] {
            BUD => sprout(node, side, vigor),
            child if is_node(child) => self.vigor[child as usize] = vigor,
            _ => {}
        }
    }

    fn share_by_forks(
        &mut self,
        tree: &Tree,
        apical_control: f32,
        sprout: &mut impl FnMut(usize, usize, f32),
    ) {
        for node in 0..tree.nodes.len() {
            let main = apical_control * self.light_of(tree, node, 0);
            let lateral = (1.0 - apical_control) * self.light_of(tree, node, 1);
            let all = main + lateral;
            let vigor = self.vigor[node];
            if all > 0.0 && vigor > 0.0 {
                let multiplier = vigor / all;
                self.give(tree, node, 0, main * multiplier, sprout);
                self.give(tree, node, 1, lateral * multiplier, sprout);
            }
        }
    }

    fn share_by_axes(&mut self, tree: &Tree, weights: [f32; 3], sprout: &mut impl FnMut(usize, usize, f32)) {
        let [first, last, part] = weights;
        let counts = bud_counts(tree);
        // Light, mean light of its buds, node and side of all that an axis feeds; the terminal last, then by rank.
        let mut axis: Vec<(f32, f32, usize, usize)> = Vec::new();
        for base in 0..tree.nodes.len() {
            let parent = tree.nodes[base].parent as usize;
            if base > 0 && tree.nodes[parent].children[0] as usize == base {
                continue;
            }
            axis.clear();
            let mut node = base;
            loop {
                let light = self.light_of(tree, node, 1);
                if light > 0.0 {
                    let count = match tree.nodes[node].children[1] {
                        BUD => 1,
                        child => counts[child as usize],
                    };
                    axis.push((light, light / count as f32, node, 1));
                }
                match tree.nodes[node].children[0] {
                    BUD => {
                        let light = self.buds[node][0];
                        axis.push((light, f32::INFINITY, node, 0));
                        break;
                    }
                    child if is_node(child) => node = child as usize,
                    _ => break,
                }
            }
            axis.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.2.cmp(&b.2)));
            let fall = (part * axis.len() as f32).max(1.0);
            let weight = |rank: usize| first + (last - first) * (rank as f32 / fall).min(1.0);
            let all: f32 = axis.iter().enumerate().map(|(rank, entry)| entry.0 * weight(rank)).sum();
            let vigor = self.vigor[base];
            if !(all > 0.0 && vigor > 0.0) {
                continue;
            }
            let multiplier = vigor / all;
            // From the tip down, what each metamer of the axis hands on is summed.
            let mut shares: Vec<(usize, usize, f32)> = axis
                .iter()
                .enumerate()
                .map(|(rank, entry)| (entry.2, entry.3, entry.0 * weight(rank) * multiplier))
                .collect();
            shares.sort_by_key(|share| (std::cmp::Reverse(share.0), share.1));
            let mut above = 0.0;
            let mut next = shares.iter().peekable();
            loop {
                while let Some(&(_, side, share)) = next.next_if(|share| share.0 == node) {
                    above += share;
                    self.give(tree, node, side, share, sprout);
                }
                if node == base {
                    break;
                }
                self.vigor[node] = above;
                node = tree.nodes[node].parent as usize;
            }
        }
    }
}

/// The living buds of each node and of all above it.
fn bud_counts(tree: &Tree) -> Vec<u32> {
    let mut counts = vec![0; tree.nodes.len()];
    for (node, data) in tree.nodes.iter().enumerate().rev() {
        counts[node] += data.children.iter().filter(|&&child| child == BUD).count() as u32;
        if node > 0 {
            counts[data.parent as usize] += counts[node];
        }
    }
    counts
}
