//! A graph around a tree.

use super::sectors::Sectors;
use super::tiles::Discs;
use super::yao::{Adjacency, Reach, yao};
use super::{Carried, Graph, GraphError};
use crate::observer::Observer;
use crate::shape::Shape;
use glam::Vec3;

/// Poisson-disc nodes in `region` around the nodes of trees, which come first and keep their order; the nearest node
/// in each sector within `longest` metres; and the trees' own edges. The trees are planted in it.
pub(in crate::guided) fn around_tree(
    region: &dyn Shape,
    carried: &Carried,
    spacing: f32,
    longest: f32,
    sectors: &Sectors,
    seed: u64,
    observer: &dyn Observer,
) -> Result<Graph, GraphError> {
    let tree = &carried.positions;
    let positions =
        Discs { region, fixed: tree, spacing, planar: sectors.are_planar() }.place(seed, observer)?;
    let near = yao(&positions, sectors, Reach::Same(longest), observer)?;
    with_trees(positions, &near, carried)
}

/// Nodes and edges to near ones, and the edges of the trees whose nodes are the first; those are planted.
pub(super) fn with_trees(
    positions: Vec<Vec3>,
    near: &Adjacency,
    carried: &Carried,
) -> Result<Graph, GraphError> {
    let mut children: Vec<(u32, u32)> =
        (0u32..).zip(&carried.tree.parents).map(|(child, &parent)| (parent, child)).collect();
    children.retain(|(parent, child)| parent != child);
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
    let graph = Graph::from_parts(positions, starts, targets, 0).with_planted(carried.tree.clone());
    // Only nodes of the tree can lie in one place.
    (0..carried.positions.len() as u32).try_for_each(|from| {
        graph.neighbours(from).iter().try_for_each(|&to| graph.check_length(from, to))
    })?;
    Ok(graph)
}
