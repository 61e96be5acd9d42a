//! Late endpoints: on a surface extrapolated from the tree so far (section 3.2.3).

use super::{Count, EndpointError, EndpointPolicy, StageView};
use crate::parameter::ParameterError;
use crate::random::{Purpose, unit};
use glam::Vec3;
use std::cmp::Reverse;

/// Endpoints among the nodes exactly k hops from the tree, of which the outermost fraction t is kept.
///
/// "We use the heuristic that trees grow outwards from the root, and hence order the surface nodes by the number
/// of edges from the root; we then take the subset of the surface consisting of its outermost fraction, for some
/// proportion t" (figures 11 and 12). Nodes of equal hops are ordered by their distance from the root.
///
/// O(n log n).
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct HopSurface {
    surface: Surface,
    count: Count,
}

crate::recipe::readable!(in surface: HopSurface {
    outermost: f32, random_weights: f32, hop_length: Option<f32>,
});

impl HopSurface {
    /// Edges from the tree to its endpoints.
    pub fn hops(&self) -> u32 {
        self.surface.hops
    }

    /// Number of endpoints.
    pub fn count(&self) -> Count {
        self.count
    }

    /// The side set by [`only`](Self::only).
    pub fn side(&self) -> Option<Side> {
        self.surface.side
    }
}

/// Options for drawing endpoints from the nodes around the tree.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub(super) struct Surface {
    pub(super) hops: u32,
    pub(super) outermost: f32,
    pub(super) random_weights: f32,
    pub(super) side: Option<Side>,
    /// Metres of a hop, where hops are counted by path length.
    pub(super) hop_length: Option<f32>,
}

/// Distance of a node from the nearest source, in hops.
#[derive(Clone, Copy)]
struct Distance {
    whole: f32,
    /// Of the last edge alone.
    last: f32,
}

/// On which side of the source of its path an endpoint may be.
///
/// ```
/// use treesynth::guided::{HopSurface, Side};
///
/// // Twigs that hang.
/// let endpoints = HopSurface::new(4, 300).only(Side::Lower);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum Side {
    /// Only lower than the source: branches hang (figure 13).
    Lower,
    /// Only higher than the source: "a pronounced upward trend" (figure 17 (d)).
    Higher,
}

impl HopSurface {
    /// `count` endpoints exactly `hops` edges, in [1, 1000], from the tree. t is 0.6: "we consider this to strike
    /// a good balance and have used it for most of our examples".
    pub fn new(hops: u32, count: impl Into<Count>) -> Self {
        Self { surface: Surface::new(hops, 0.6), count: count.into() }
    }

    /// The fraction t of the surface's nodes that is kept, the outermost, in (0, 1]. 1 covers "the entire tree
    /// with small twigs".
    pub fn with_outermost(mut self, fraction: f32) -> Self {
        self.surface.outermost = fraction;
        self
    }

    /// Graph distance with random weights instead of hops: each edge counts 1 ± `randomness` times as much, in [0, 1),
    /// and the surface holds the nodes that are k away, to half an edge. 0 counts hops.
    pub fn with_random_weights(mut self, randomness: f32) -> Self {
        self.surface.random_weights = randomness;
        self
    }

    /// Counts hops by metres of path along edges: k hops are k times `metres`, finite and above 0, and the surface holds
    /// the nodes that are as far from the tree, to half a hop. Twigs then are as long on graphs of any spacing; by
    /// edges, as in the paper, they are as long as the graph is coarse. Where all edges are longer than k hops, the
    /// surface holds the ends of the shortest.
    pub fn with_hop_length(mut self, metres: f32) -> Self {
        self.surface.hop_length = Some(metres);
        self
    }

    /// Only endpoints lower, or only endpoints higher, than the source their path starts from.
    pub fn only(mut self, side: Side) -> Self {
        self.surface.side = Some(side);
        self
    }
}

impl Surface {
    pub(super) fn new(hops: u32, outermost: f32) -> Self {
        Self { hops, outermost, random_weights: 0.0, side: None, hop_length: None }
    }

    /// Distance of each node, in hops, from the nearest of `sources`, and that of the last edge on the way, the longest of equal
    /// ways; infinite from beyond `limit` on.
    ///
    /// All nodes up to a bound go on, then the bound rises by about half an edge: without a queue, and in an order in which
    /// one node lies near the next in memory, as it does among the sources. A node to which a shorter way is found later goes
    /// on once more, which is rare.
    fn distances(&self, sources: &[u32], limit: f32, view: &StageView<'_>) -> Vec<Distance> {
        let graph = view.graph();
        let mut distances = vec![Distance { whole: f32::INFINITY, last: 0.0 }; graph.nodes()];
        for &source in sources {
            distances[source as usize].whole = 0.0;
        }
        let mut waiting = sources.to_vec();
        waiting.sort_unstable();
        let mut is_waiting = vec![false; graph.nodes()];
        let mut later = Vec::new();
        let (mut bound, mut sum, mut edges) = (0.0, 0.0, 0usize);
        while !waiting.is_empty() {
            let (before, mut next) = (edges, f32::INFINITY);
            for node in waiting.drain(..) {
                let here = distances[node as usize].whole;
                if here > bound {
                    next = next.min(here);
                    later.push(node);
                    continue;
                }
                is_waiting[node as usize] = false;
                for &to in graph.neighbours(node) {
                    if distances[to as usize].whole <= here {
                        continue;
                    }
                    let last = self.weight(node, to, view);
                    (sum, edges) = (sum + last, edges + 1);
                    let way = Distance { whole: here + last, last };
                    let known = &mut distances[to as usize];
                    if way.whole < known.whole {
                        *known = way;
                        // From beyond the limit nothing goes on.
                        if way.whole < limit && !std::mem::replace(&mut is_waiting[to as usize], true) {
                            later.push(to);
                        }
                    } else if way.whole <= known.whole {
                        known.last = known.last.max(way.last);
                    }
                }
            }
            std::mem::swap(&mut waiting, &mut later);
            if edges == before {
                bound = next + 0.5 * sum / edges.max(1) as f32;
            }
        }
        distances
    }

    /// The length of an edge in hops.
    fn weight(&self, from: u32, to: u32, view: &StageView<'_>) -> f32 {
        let hops = self
            .hop_length
            .map_or(1.0, |hop| view.graph().position(from).distance(view.graph().position(to)) / hop);
        if self.random_weights == 0.0 {
            return hops;
        }
        let edge = u64::from(from) << 32 | u64::from(to);
        let draw = unit(view.seed(), view.stage() as u32, Purpose::EDGE_WEIGHT, edge);
        hops * (1.0 + self.random_weights * (2.0 * draw - 1.0))
    }

    /// The surface: nodes k hops from the tree, ascending.
    fn surface(&self, view: &StageView<'_>) -> Vec<u32> {
        let (graph, search) = (view.graph(), view.search());
        if self.random_weights > 0.0 || self.hop_length.is_some() {
            let k = self.hops as f32;
            // Half a hop to each side; less where edges are shorter, so that the surface stays one node thick.
            let is_on_surface = |distance: &Distance| {
                let half = distance.last.min(1.0) * 0.5;
                distance.whole - half <= k && distance.whole + half > k
            };
            let distances = self.distances(search.tree(), k, view);
            let nodes = |filter: &dyn Fn(&Distance) -> bool| -> Vec<u32> {
                (0..).zip(&distances).filter(|(_, distance)| filter(distance)).map(|(node, _)| node).collect()
            };
            let surface = nodes(&is_on_surface);
            if !surface.is_empty() {
                return surface;
            }
            // All edges are longer than that: the ends of the shortest.
            let off_tree = |distance: &&Distance| distance.whole > 0.0;
            let nearest = distances
                .iter()
                .filter(off_tree)
                .map(|distance| distance.whole)
                .fold(f32::INFINITY, f32::min);
            return nodes(&|distance| distance.whole > 0.0 && distance.whole <= 1.2 * nearest);
        }
        let mut seen: Vec<bool> = (0..graph.nodes() as u32).map(|node| search.is_on_tree(node)).collect();
        let mut ring = search.tree().to_vec();
        for _ in 0..self.hops {
            let mut next = Vec::new();
            for &node in &ring {
                for &to in graph.neighbours(node) {
                    if !std::mem::replace(&mut seen[to as usize], true) {
                        next.push(to);
                    }
                }
            }
            ring = next;
        }
        ring.sort_unstable();
        ring
    }

    /// The surface's outermost fraction.
    fn outer_surface(&self, view: &StageView<'_>) -> Vec<u32> {
        let graph = view.graph();
        let mut surface = self.surface(view);
        surface.retain(|&node| !view.search().is_on_tree(node) && view.is_reachable(node));
        if self.outermost >= 1.0 {
            return surface;
        }
        let roots: Vec<Vec3> = graph.roots().iter().map(|&root| graph.position(root)).collect();
        let away = |node: u32| {
            let position = graph.position(node);
            roots.iter().map(|root| root.distance_squared(position)).fold(f32::INFINITY, f32::min)
        };
        let kept = (surface.len() as f32 * self.outermost).ceil() as usize;
        // Bits of floats that are not negative are in the floats' order.
        let mut ranked: Vec<(Reverse<u32>, Reverse<u32>, u32)> = if self.random_weights > 0.0 {
            let distance = self.distances(graph.roots(), f32::INFINITY, view);
            let rank = |node: u32| Reverse(distance[node as usize].whole.to_bits());
            surface.into_iter().map(|node| (rank(node), Reverse(away(node).to_bits()), node)).collect()
        } else {
            let hops = graph.hops_from_root();
            let rank = |node: u32| Reverse(hops[node as usize]);
            surface.into_iter().map(|node| (rank(node), Reverse(away(node).to_bits()), node)).collect()
        };
        if kept < ranked.len() {
            ranked.select_nth_unstable(kept);
            ranked.truncate(kept);
        }
        ranked.into_iter().map(|(_, _, node)| node).collect()
    }

    /// Part of the surface from which endpoints are drawn.
    pub(super) fn candidates(&self, view: &StageView<'_>) -> Vec<u32> {
        let mut surface = self.outer_surface(view);
        if let Some(side) = self.side {
            let height = |node: u32| view.graph().position(node).y;
            surface.retain(|&node| {
                view.search().source(node).is_some_and(|source| match side {
                    Side::Lower => height(node) < height(source),
                    Side::Higher => height(node) > height(source),
                })
            });
        }
        surface
    }
}

impl EndpointPolicy for HopSurface {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        let surface = self.surface.candidates(view);
        self.count.choose(surface, view, "on the surface that HopSurface.hops, outermost and only leave")
    }

    fn needs_search(&self) -> bool {
        self.surface.side.is_some()
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.count.check("HopSurface.count")?;
        self.surface.check()
    }
}

impl Surface {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(
            (1..=1000).contains(&self.hops),
            "HopSurface.hops",
            self.hops,
            "in [1, 1000]",
        )?;
        let hop = self.hop_length.unwrap_or(1.0);
        let fits = hop > 0.0 && hop.is_finite();
        ParameterError::unless(fits, "HopSurface.hop_length", hop, "finite and above 0 m")?;
        ParameterError::unless(
            self.outermost > 0.0 && self.outermost <= 1.0,
            "HopSurface.outermost",
            self.outermost,
            "in (0, 1]",
        )?;
        ParameterError::unless(
            (0.0..1.0).contains(&self.random_weights),
            "HopSurface.random_weights",
            self.random_weights,
            "in [0, 1)",
        )
    }
}
