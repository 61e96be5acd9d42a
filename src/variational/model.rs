//! The whole energy of a draft: equation 4 on branch nodes and the shape nodes they carry.

use glam::DVec3;

use super::draft::{Draft, Lists};
use super::energy::{Soft, Wish, deviations};
use crate::nearest::nearest;
use crate::parallel;

/// The exponents and weights of the energy, in the units of the shape.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weights {
    /// β over α: the power of a flow d^α that gives d^β.
    pub(super) power: f64,
    pub(super) lambda: f64,
    pub(super) mu: f64,
    /// Price of wood outside of the shape, over that inside.
    pub(super) outside: f64,
    /// Distance from every shape node beyond which a point is outside, metres.
    pub(super) margin: f64,
}

/// The shape nodes in double precision.
pub(super) struct Nodes {
    pub(super) places: Vec<DVec3>,
    /// d^α, where d is in units of the largest diameter.
    pub(super) flows: Vec<f64>,
    /// d^β, in metres to the power of β.
    pub(super) costs: Vec<f64>,
    /// d / Σ d.
    pub(super) shares: Vec<f64>,
    /// d^β of a flow of 1.
    pub(super) unit: f64,
}

/// The three terms of equation 4, before they are weighted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Terms {
    pub(super) structure: f64,
    pub(super) guidance: f64,
    pub(super) penalty: f64,
    /// Weighted already.
    pub(super) outside: f64,
}

impl Terms {
    pub(super) fn total(&self, weights: &Weights) -> f64 {
        self.structure + weights.lambda * self.guidance + weights.mu * self.penalty + self.outside
    }
}

/// The square of the sine below which a turn fades, see [`Soft::turn`].
const TURN: f64 = 0.04;

/// Branch nodes that one task looks after.
const CHUNK: usize = 1024;

/// The energy of a draft whose topology and partition stand, as a function of its nodes' positions.
pub(super) struct Model<'a> {
    nodes: &'a Nodes,
    weights: Weights,
    parents: &'a [u32],
    wishes: &'a [Wish],
    carried: Lists,
    /// d^β of each branch node's internode.
    pub(super) thick: Vec<f64>,
    /// The nearest shape node of each branch node, then of the middle of each internode; empty if the outside
    /// costs nothing.
    anchors: Vec<DVec3>,
}

impl<'a> Model<'a> {
    pub(super) fn new(draft: &'a Draft, nodes: &'a Nodes, weights: Weights) -> Self {
        let mut flows = vec![0.0; draft.len()];
        for (&owner, flow) in draft.owners.iter().zip(&nodes.flows) {
            flows[owner as usize] += flow;
        }
        for node in (1..draft.len()).rev() {
            flows[draft.parents[node] as usize] += flows[node];
        }
        let mut anchors = Vec::new();
        if weights.outside > 0.0 {
            let middle =
                |node: usize| draft.positions[node].midpoint(draft.positions[draft.parents[node] as usize]);
            let mut asked = draft.positions.clone();
            asked.extend((0..draft.len()).map(middle));
            let found = nearest(&nodes.places, &asked);
            anchors = found.into_iter().map(|place| nodes.places[place as usize]).collect();
        }
        let thick = |&flow: &f64| if flow > 0.0 { nodes.unit * libm::pow(flow, weights.power) } else { 0.0 };
        Self {
            nodes,
            weights,
            parents: &draft.parents,
            wishes: &draft.wishes,
            carried: Lists::new(draft.len(), &draft.owners),
            thick: flows.iter().map(thick).collect(),
            anchors,
        }
    }

    /// The terms; with `gradient`, the slope of their weighted sum as well, zero at the root, which stays.
    pub(super) fn terms(&self, positions: &[DVec3], soft: Soft, gradient: Option<&mut Vec<DVec3>>) -> Terms {
        let square = soft.length * soft.length;
        let carried = |chunk: usize| {
            let nodes = chunk * CHUNK..((chunk + 1) * CHUNK).min(positions.len());
            let (mut structure, mut guidance) = (0.0, 0.0);
            let pulls = nodes.map(|node| {
                let mut pull = DVec3::ZERO;
                for &item in self.carried.of(node) {
                    let item = item as usize;
                    let way = positions[node] - self.nodes.places[item];
                    let length = (way.length_squared() + square).sqrt();
                    let (cost, share) = (self.nodes.costs[item], self.nodes.shares[item]);
                    structure += cost * length;
                    guidance += share * length;
                    if length > 0.0 {
                        pull += way * ((cost + self.weights.lambda * share) / length);
                    }
                }
                pull
            });
            let pulls: Vec<DVec3> = pulls.collect();
            (structure, guidance, pulls)
        };
        let mut terms = Terms { structure: 0.0, guidance: 0.0, penalty: 0.0, outside: 0.0 };
        let mut slope: Vec<DVec3> = Vec::with_capacity(positions.len());
        for (structure, guidance, pulls) in parallel::map(positions.len().div_ceil(CHUNK), carried) {
            terms.structure += structure;
            terms.guidance += guidance;
            slope.extend(pulls);
        }
        for node in 1..positions.len() {
            let parent = self.parents[node] as usize;
            let way = positions[node] - positions[parent];
            let length = (way.length_squared() + square).sqrt();
            terms.structure += self.thick[node] * length;
            if length > 0.0 {
                let pull = way * (self.thick[node] / length);
                slope[node] += pull;
                slope[parent] -= pull;
            }
        }
        let mu = self.weights.mu;
        let add = |node: usize, by: DVec3| slope[node] += by * mu;
        terms.penalty = deviations(positions, self.parents, self.wishes, &self.thick, soft, add);
        terms.outside = self.outside(positions, &mut slope);
        if let Some(gradient) = gradient {
            slope[0] = DVec3::ZERO;
            *gradient = slope;
        }
        terms
    }

    /// Cost, in wood, of the distance of branch nodes and the middles of internodes from the shape; adds its
    /// gradient to `slope`. The trunk up to the first branch node does not count.
    fn outside(&self, positions: &[DVec3], slope: &mut [DVec3]) -> f64 {
        let mut sum = 0.0;
        let count = if self.anchors.is_empty() { 0 } else { positions.len() };
        for node in 1..count {
            let parent = self.parents[node] as usize;
            let weight = self.weights.outside * self.thick[node];
            let mut add = |place: DVec3, anchor: DVec3, shares: [f64; 2]| {
                let way = place - anchor;
                let beyond = way.length() - self.weights.margin;
                if beyond > 0.0 {
                    sum += weight * beyond;
                    let pull = way.normalize_or_zero() * weight;
                    slope[node] += pull * shares[0];
                    slope[parent] += pull * shares[1];
                }
            };
            add(positions[node], self.anchors[node], [1.0, 0.0]);
            if parent > 0 {
                let middle = positions[node].midpoint(positions[parent]);
                add(middle, self.anchors[count + node], [0.5, 0.5]);
            }
        }
        sum
    }

    /// Solves for the step of all branch nodes that Weiszfeld's method would make for `slope`: each length in the energy
    /// is taken for a spring as stiff as its pull over its length. The springs form a tree, so that one pass to the root
    /// and one back solve it exactly. O(n).
    pub(super) fn spring_step(&self, positions: &[DVec3], soft: Soft, slope: &[DVec3]) -> Vec<DVec3> {
        let count = positions.len();
        let stiff = |pull: f64, way: DVec3| pull / (way.length_squared() + soft.length * soft.length).sqrt();
        let mut own: Vec<f64> = (0..count)
            .map(|node| {
                let carried = self.carried.of(node).iter().map(|&item| item as usize);
                let pull =
                    |item: usize| self.nodes.costs[item] + self.weights.lambda * self.nodes.shares[item];
                carried.map(|item| stiff(pull(item), positions[node] - self.nodes.places[item])).sum()
            })
            .collect();
        let mut to_parent = vec![0.0; count];
        for node in 1..count {
            let parent = self.parents[node] as usize;
            let way = positions[node] - positions[parent];
            // The target of an internode resists too, over about the target length.
            let wished = self.wishes[node].length.min(way.length()).max(soft.length);
            let spring = stiff(self.thick[node], way)
                + self.weights.mu * self.thick[node] / (4.0 * soft.deviation * wished);
            to_parent[node] += spring;
            // A turn resists by its distance from the axis, be it ever so small.
            let Some((mate, _)) = self.wishes[node].turn.filter(|_| parent > 0) else { continue };
            let before = positions[self.parents[parent] as usize];
            let axis = (positions[parent] - before).normalize_or_zero();
            let stiff =
                self.weights.mu * self.thick[node] * self.wishes[node].length / (4.0 * soft.deviation);
            for (turned, way) in [(node, way), (mate as usize, positions[mate as usize] - before)] {
                let aside = (way - axis * way.dot(axis)).length_squared() + TURN * way.length_squared();
                to_parent[turned] += stiff / (aside + soft.length * soft.length);
            }
        }
        for node in 1..count {
            own[node] += to_parent[node];
        }
        let mut right = slope.to_vec();
        for node in (1..count).rev() {
            let parent = self.parents[node] as usize;
            own[node] = own[node].max(f64::MIN_POSITIVE);
            let share = to_parent[node] / own[node];
            own[parent] += to_parent[node] * (1.0 - share);
            let passed = right[node] * share;
            right[parent] += passed;
        }
        let mut step = vec![DVec3::ZERO; count];
        for node in 1..count {
            step[node] = (right[node] + step[self.parents[node] as usize] * to_parent[node]) / own[node];
        }
        step
    }
}
