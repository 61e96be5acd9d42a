//! A graph around a tree.

use super::sectors::Sectors;
use super::tiles::Discs;
use super::yao::yao;
use super::{Graph, GraphError};
use crate::observer::Observer;
use crate::shape::Shape;
use glam::Vec3;

/// Poisson-disc nodes in `region` around the nodes of a tree, which come first and keep their order; the nearest node
/// in each octant within `longest` metres; and the tree's own edges. The root is node 0, its own parent.
pub(in crate::guided) fn around_tree(
    region: &dyn Shape,
    tree: &[Vec3],
    parents: &[u32],
    spacing: f32,
    longest: f32,
    seed: u64,
    observer: &dyn Observer,
) -> Result<Graph, GraphError> {
    let positions = Discs { region, fixed: tree, spacing, planar: false }.place(seed, observer)?;
    let near = yao(&positions, &Sectors::Octants, Some(longest), observer)?;
    let mut children: Vec<(u32, u32)> =
        (1u32..).zip(&parents[1..]).map(|(child, &parent)| (parent, child)).collect();
    children.sort_unstable();
    let mut starts = vec![0];
    let mut targets = Vec::with_capacity(near.targets.len() + children.len());
    let mut next = children.as_slice();
    for node in 0..positions.len() {
        let found = &near.targets[near.starts[node] as usize..near.starts[node + 1] as usize];
        targets.extend_from_slice(found);
        while let Some((&(_, child), rest)) =
            next.split_first().filter(|((parent, _), _)| *parent as usize == node)
        {
            if !found.contains(&child) {
                targets.push(child);
            }
            next = rest;
        }
        starts.push(targets.len() as u32);
    }
    let graph = Graph::from_parts(positions, starts, targets, 0);
    // Only nodes of the tree can lie in one place.
    (0..tree.len() as u32).try_for_each(|from| {
        graph.neighbours(from).iter().try_for_each(|&to| graph.check_length(from, to))
    })?;
    Ok(graph)
}
