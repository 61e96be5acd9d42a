//! Rings of nodes at one distance along their paths, each with the ring it follows: Verroust and Lazarus 2000, "Extracting skeletal
//! curves from 3D scattered data"; Xu, Gossett and Chen 2007, "Knowledge and heuristic-based modeling of laser-scanned trees".

use glam::Vec3;

use super::net::Sets;
use super::nodes::Nodes;
use crate::guided::Search;

/// A ring of nodes.
#[derive(Debug, Clone)]
pub(super) struct Ring {
    pub(super) parent: Option<u32>,
    pub(super) nodes: Vec<u32>,
    pub(super) center: Vec3,
    /// Root mean square distance of the nodes from the center, metres.
    pub(super) spread: f32,
}

/// The rings of the nodes that paths lead to, parents first. The first are the bases, without nodes.
pub(super) fn rings(
    nodes: &Nodes,
    search: &Search<'_>,
    edges: &[(u32, u32)],
    bases: &[Vec3],
    step: f32,
) -> Vec<Ring> {
    let count = nodes.len();
    let bins: Vec<u32> = (0..count as u32)
        .map(|node| if search.is_settled(node) { (search.path_length(node) / step) as u32 } else { u32::MAX })
        .collect();
    let mut sets = Sets::new(count);
    let same = |a: u32, b: u32| bins[a as usize] == bins[b as usize] && bins[a as usize] != u32::MAX;
    for &(a, b) in edges {
        if same(a, b) {
            sets.join(a, b);
        }
    }
    let is_node = |node: &u32| (*node as usize) < count;
    for node in 0..count as u32 {
        if let Some(parent) = search.parent(node).filter(is_node)
            && same(node, parent)
        {
            sets.join(node, parent);
        }
    }
    // Parts by bin, then by number; the node of each that is nearest to the base decides which part it
    // follows.
    let mut parts: Vec<(u32, u32, u32)> = (0..count as u32)
        .filter(|&node| bins[node as usize] != u32::MAX)
        .map(|node| (bins[node as usize], sets.of(node), node))
        .collect();
    parts.sort_unstable();
    let of_base = |&center: &Vec3| Ring { parent: None, nodes: Vec::new(), center, spread: 0.0 };
    let mut rings: Vec<Ring> = bases.iter().map(of_base).collect();
    // Roots follow the nodes.
    let mut ring_of = vec![0_u32; count];
    ring_of.extend(0..bases.len() as u32);
    for bin in parts.chunk_by(|a, b| a.0 == b.0) {
        let mut found: Vec<(u32, Vec<u32>)> = Vec::new();
        for part in bin.chunk_by(|a, b| a.1 == b.1) {
            let members: Vec<u32> = part.iter().map(|part| part.2).collect();
            let first = members
                .iter()
                .copied()
                .min_by(|&a, &b| search.path_length(a).total_cmp(&search.path_length(b)).then(a.cmp(&b)));
            let before = first.and_then(|first| search.parent(first));
            found.push((before.map_or(0, |before| ring_of[before as usize]), members));
        }
        found.sort_by_key(|part| part.0);
        for siblings in found.chunk_by(|a, b| a.0 == b.0) {
            for group in together(nodes, &rings, siblings) {
                let number = rings.len() as u32;
                for &node in &group {
                    ring_of[node as usize] = number;
                }
                let (center, spread) = middle(nodes, &group);
                rings.push(Ring { parent: Some(siblings[0].0), nodes: group, center, spread });
            }
        }
    }
    rings
}

fn middle(nodes: &Nodes, members: &[u32]) -> (Vec3, f32) {
    let places = || members.iter().map(|&node| nodes.positions[node as usize]);
    let center = places().sum::<Vec3>() / members.len() as f32;
    let squares: f32 = places().map(|place| place.distance_squared(center)).sum();
    (center, (squares / members.len() as f32).sqrt())
}

/// Parts that follow one ring, put together where they lie within it: a limb seen in stripes is one limb.
fn together(nodes: &Nodes, rings: &[Ring], siblings: &[(u32, Vec<u32>)]) -> Vec<Vec<u32>> {
    let lone = || siblings.iter().map(|sibling| sibling.1.clone()).collect();
    if siblings.len() == 1 {
        return lone();
    }
    let ring = &rings[siblings[0].0 as usize];
    let up = ring.parent.map_or(Vec3::Y, |parent| ring.center - rings[parent as usize].center);
    let up = up.try_normalize().unwrap_or(Vec3::Y);
    // The width of all of them together, for a base without nodes.
    let width = if ring.nodes.is_empty() { 10.0 } else { ring.spread.max(nodes.side) };
    let mut within: Vec<u32> = Vec::new();
    let mut apart = Vec::new();
    for (_, members) in siblings {
        let from = middle(nodes, members).0 - ring.center;
        let across = (from - up * from.dot(up)).length();
        if across < width {
            within.extend(members);
        } else {
            apart.push(members.clone());
        }
    }
    if !within.is_empty() {
        within.sort_unstable();
        apart.insert(0, within);
    }
    apart
}
