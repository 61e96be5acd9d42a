//! Cuts: metamers that fall from a tree, and shoots that sprout in their place.

use super::habit::within;
use super::season::FALLS;
use super::tree::{BUD, DEAD, DORMANT, Node, NodeId, Tree, is_node};
use crate::ParameterError;
use glam::Vec3;

/// Sprouting near a cut: the bud at the stump, and dormant and living buds below it, the nearest first. They grow in
/// the next season even in the shade, as from stored sugar. What bears them is not shed for as many seasons as the
/// habit's grace; after that they must live on their light.
///
/// Each gets a vigor of one for each bud that the part cut off carried, and at most [`with_vigor`](Self::with_vigor).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
#[must_use]
pub struct Regrowth {
    pub(super) buds: u8,
    pub(super) reach: u16,
    pub(super) vigor: f32,
}

crate::recipe::readable!(Regrowth { buds: u8, reach: u16, vigor: f32 });

impl Default for Regrowth {
    /// 3 buds, not more than 8 nodes below the cut, of a vigor of 4 at most.
    fn default() -> Self {
        Self { buds: 3, reach: 8, vigor: 4.0 }
    }
}

impl Regrowth {
    /// Sets how many buds sprout at a cut, in [1, 16]; 3 by default.
    pub fn with_buds(mut self, buds: u8) -> Self {
        self.buds = buds;
        self
    }

    /// Sets how many nodes below the cut they may stand, at most 1000; 8 by default.
    pub fn with_reach(mut self, nodes: u16) -> Self {
        self.reach = nodes;
        self
    }

    /// Sets the most vigor of each, in [0, 1e3]; 4 by default. Below 1 none sprouts.
    pub fn with_vigor(mut self, vigor: f32) -> Self {
        self.vigor = vigor;
        self
    }

    pub(super) fn check(self) -> Result<(), ParameterError> {
        let (buds, reach) = (self.buds, self.reach);
        ParameterError::unless((1..=16).contains(&buds), "Regrowth.buds", buds, "1 to 16 buds")?;
        ParameterError::unless(reach <= 1000, "Regrowth.reach", reach, "at most 1000 nodes")?;
        within("Regrowth.vigor", self.vigor, 0.0, 1e3)
    }
}

/// A bud that a cut has woken.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub(super) struct Release {
    pub(super) node: NodeId,
    pub(super) lateral: bool,
    pub(super) vigor: f32,
    /// The latest season when the cut was made.
    pub(super) since: u16,
}

impl Tree {
    /// Removes the metamers of `lowest`, ascending, and all above them; what is left where they were is `stump`, but
    /// on the foot nothing. Returns the new place of each node, if any has moved.
    pub(super) fn fell(&mut self, lowest: &[u32], stump: u32, fallen: &mut Vec<Vec3>) -> Option<Vec<u32>> {
        let first = *lowest.first()? as usize;
        let mut places: Vec<u32> = (0..self.nodes.len() as u32).collect();
        let mut lowest = lowest.iter().peekable();
        let mut kept = first;
        for old in first..self.nodes.len() {
            let node = self.nodes[old];
            let falls = lowest.next_if(|&&lowest| lowest as usize == old).is_some();
            if falls || places[node.parent as usize] == FALLS {
                places[old] = FALLS;
                fallen.push(node.position);
            } else {
                places[old] = kept as u32;
                self.nodes[kept] = Node { parent: places[node.parent as usize], ..node };
                kept += 1;
            }
        }
        self.nodes.truncate(kept);
        for child in self.nodes.iter_mut().flat_map(|node| &mut node.children) {
            if is_node(*child) {
                *child = places[*child as usize];
                if *child == FALLS {
                    *child = stump;
                }
            }
        }
        if self.nodes[0].children[0] == DORMANT {
            self.nodes[0].children[0] = DEAD;
        }
        Some(places)
    }

    /// Cuts off the metamers below the nodes of these indices, ascending, and all above them; buds take their places
    /// and others wake, unless the tree is dead. Returns what fell. O(n).
    pub(super) fn cut(&mut self, lowest: &[u32], regrowth: Option<Regrowth>, season: u16) -> Vec<Vec3> {
        // The stump of each cut, by index now and by identity for later, and the buds it has lost.
        let mut stumps = Vec::new();
        let mut falls = vec![false; self.nodes.len()];
        let mut next = lowest.iter().peekable();
        for (node, data) in self.nodes.iter().enumerate() {
            let parent = data.parent as usize;
            let above_cut = node > 0 && falls[parent];
            let is_lowest = next.next_if(|&&lowest| lowest as usize == node).is_some();
            falls[node] = above_cut || is_lowest;
            if is_lowest && !above_cut {
                let side = usize::from(self.nodes[parent].children[0] as usize != node);
                stumps.push((NodeId(self.nodes[parent].number), side, data.load));
            }
        }
        let mut fallen = Vec::new();
        let dead = self.died.is_some();
        self.fell(lowest, if dead { DEAD } else { BUD }, &mut fallen);
        // From the stumps down, branches carry less.
        let mut lighter = vec![false; self.nodes.len()];
        for &(stump, ..) in &stumps {
            lighter[self.index_of(stump).unwrap_or_default()] = true;
        }
        for node in (0..self.nodes.len()).rev() {
            if lighter[node] {
                self.nodes[node].load = self.load_above(node);
                lighter[self.nodes[node].parent as usize] = true;
            }
        }
        if let Some(regrowth) = regrowth.filter(|_| !dead) {
            for (stump, side, lost) in stumps {
                self.wake((self.index_of(stump).unwrap_or_default(), side), lost, regrowth, season);
            }
        }
        if self.nodes.len() == 1 {
            (self.bare_since, self.vigor) = (season, 0.0);
        }
        fallen
    }

    /// Wakes the bud of a stump and the nearest buds below.
    fn wake(&mut self, (stump, side): (usize, usize), lost: u32, regrowth: Regrowth, since: u16) {
        let mut woken = vec![(stump, side)];
        let mut node = stump;
        for _ in 0..=regrowth.reach {
            if woken.len() >= usize::from(regrowth.buds) || node == 0 {
                break;
            }
            if matches!(self.nodes[node].children[1], BUD | DORMANT) && (node, 1) != (stump, side) {
                self.nodes[node].children[1] = BUD;
                woken.push((node, 1));
            }
            node = self.nodes[node].parent as usize;
        }
        let vigor = (lost as f32).min(regrowth.vigor);
        let release = |(node, side): (usize, usize)| Release {
            node: NodeId(self.nodes[node].number),
            lateral: side == 1,
            vigor,
            since,
        };
        let releases: Vec<Release> = woken.into_iter().map(release).collect();
        self.releases.extend(releases);
    }
}
