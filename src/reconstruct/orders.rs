//! The child in which an axis goes on at each fork.

use crate::{Skeleton, math};

/// Radii of the limb from a fork, on either side, between which directions are taken, and metres for the farther at least: nearer
/// to a fork, a ring is of several limbs, and its middle in none.
const NEAR: f32 = 1.5;
const FAR: f32 = 10.0;
const LEAST: f32 = 0.1;
/// Weights of straightness (a cosine) and of the logarithm of the length borne. Logistic regression on
/// forks of ten species of the bench.
const STRAIGHT: f32 = 6.4;
const BORNE: f32 = 0.17;

/// Branch orders: at a fork the axis goes on in the child that leads on straightest, and a little in the one that bears more. O(n d) for
/// forks with d nodes within reach.
pub(super) fn orders(skeleton: &Skeleton) -> Vec<u16> {
    let positions = skeleton.positions();
    let mut borne = vec![LEAST; skeleton.len()];
    for (node, parent) in skeleton.edges().rev() {
        borne[parent] += borne[node] + positions[node].distance(positions[parent]);
    }
    let children = skeleton.children();
    let mut heir: Vec<Option<u32>> = vec![None; skeleton.len()];
    for fork in (0..skeleton.len()).rev() {
        let own = children.of(fork);
        if own.len() < 2 {
            heir[fork] = own.first().copied();
            continue;
        }
        let from = positions[fork];
        let radius = skeleton.radii()[fork];
        let [near, far] = [NEAR * radius, (FAR * radius).max(LEAST)];
        // Places on one side of the fork, near to it and far from it.
        let along = |first: usize, next: &dyn Fn(usize) -> Option<usize>| {
            let (mut node, mut start) = (first, None);
            loop {
                let away = positions[node].distance(from);
                if away >= near && start.is_none() {
                    start = Some(node);
                }
                let Some(next) = next(node).filter(|_| away < far) else { break };
                node = next;
            }
            let start = start.filter(|&start| start != node).map_or(from, |start| positions[start]);
            (positions[node] - start).normalize_or_zero()
        };
        let way = -along(fork, &|node| skeleton.parent(node));
        let score = |child: u32| {
            let straight = along(child as usize, &|node| heir[node].map(|next| next as usize)).dot(way);
            STRAIGHT * straight + BORNE * math::ln(borne[child as usize])
        };
        heir[fork] = own.iter().copied().max_by(|&a, &b| score(a).total_cmp(&score(b)).then(b.cmp(&a)));
    }
    let mut orders = vec![0_u16; skeleton.len()];
    for (node, parent) in skeleton.edges() {
        orders[node] = orders[parent].saturating_add(u16::from(heir[parent] != Some(node as u32)));
    }
    orders
}
