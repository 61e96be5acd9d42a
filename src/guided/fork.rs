//! The tree at the places where new branches leave it.

use crate::math::{UP, parallel_transport, perpendicular};
use crate::skeleton::{Skeleton, SkeletonError};
use glam::Vec3;

/// The parent branch at a node of the tree, as a rule or a weight sees it at the beginning of a stage.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Fork {
    /// Unit vector along the parent branch towards its tip: the chord over three nodes each way, since single edges
    /// of the graph are crooked. Up where the tree is its root alone.
    pub direction: Vec3,
    /// Unit vector perpendicular to it, carried along the branch without twist.
    pub normal: Vec3,
    /// Order of the parent branch: 0 for the trunk.
    pub order: u16,
    /// Metres along the tree from its root.
    pub from_root: f32,
    /// Metres along the parent branch from its base.
    pub from_base: f32,
    /// Metres along the parent branch to its tip.
    pub to_tip: f32,
    /// Tips that the node bears; at least 1.
    pub tips: u32,
    /// Radius of the branch here over that of the trunk's base, by the pipe model with exponent 2 (da Vinci's rule):
    /// the root of the share of the tips, in (0, 1].
    pub thickness: f32,
    /// The parent branch's number among those of its tree, each after its own parent; 0 for the trunk. Only within one
    /// stage.
    pub branch: u32,
    /// The tree's number among the graph's [roots](super::Graph::roots).
    pub tree: u32,
}

/// Nodes each way that a direction is taken over.
const CHORD: usize = 3;

impl Fork {
    /// A trunk of this direction (any length but zero), at its root; the fields can be set, to try a rule with.
    pub fn new(direction: Vec3) -> Self {
        let direction = direction.normalize_or(UP);
        Self {
            direction,
            normal: perpendicular(direction),
            order: 0,
            from_root: 0.0,
            from_base: 0.0,
            to_tip: 0.0,
            tips: 1,
            thickness: 1.0,
            branch: 0,
            tree: 0,
        }
    }

    /// All nodes of a tree.
    pub(super) fn all(tree: &Skeleton, number: u32) -> Vec<Self> {
        let mut forks = vec![Self { tree: number, ..Self::new(UP) }; tree.len()];
        for (node, parent) in tree.edges() {
            let way = tree.positions()[node].distance(tree.positions()[parent]);
            forks[node].from_root = forks[parent].from_root + way;
            forks[node].order = tree.orders()[node];
        }
        let mut tips = vec![0u32; tree.len()];
        for (node, parent) in tree.edges().rev() {
            tips[node] = tips[node].max(1);
            tips[parent] += tips[node];
        }
        let most = tips[0].max(1) as f32;
        for (fork, tips) in forks.iter_mut().zip(tips) {
            fork.tips = tips.max(1);
            fork.thickness = (fork.tips as f32 / most).sqrt();
        }
        for (number, branch) in (0u32..).zip(tree.branches().iter()) {
            let nodes = branch.nodes();
            let at = |i: usize| tree.positions()[nodes[i] as usize];
            let own = usize::from(branch.order() > 0);
            let base = forks[nodes[0] as usize];
            let tip = forks[nodes[nodes.len() - 1] as usize].from_root;
            let (mut direction, mut normal) = (base.direction, base.normal);
            for i in 0..nodes.len() {
                let chord = at((i + CHORD).min(nodes.len() - 1)) - at(i.saturating_sub(CHORD));
                let next = chord.normalize_or(direction);
                normal = parallel_transport(direction, next, normal);
                direction = next;
                if i >= own {
                    let fork = &mut forks[nodes[i] as usize];
                    (fork.direction, fork.normal, fork.branch) = (direction, normal, number);
                    fork.from_base = fork.from_root - base.from_root;
                    fork.to_tip = tip - fork.from_root;
                }
            }
        }
        forks
    }
}

/// Positions, parents, stages, hops and least radii of trees that share a graph, one after the other in any order.
pub(super) struct Parts<'a> {
    pub(super) positions: Vec<Vec3>,
    /// Indexed by place; a root's is none.
    pub(super) parents: Vec<Option<u32>>,
    pub(super) stages: Vec<u16>,
    pub(super) hops: Vec<u32>,
    /// Empty where none are given.
    pub(super) radii: &'a [f32],
}

impl Parts<'_> {
    /// Each tree, with the place of each of its nodes.
    pub(super) fn skeletons(&self) -> Result<Vec<(Skeleton, Vec<usize>)>, SkeletonError> {
        let mut trees: Vec<Vec<usize>> = Vec::new();
        let mut owner: Vec<(u32, u32)> = Vec::with_capacity(self.parents.len());
        for (place, parent) in self.parents.iter().enumerate() {
            let tree = match parent {
                Some(parent) => owner[*parent as usize].0 as usize,
                None => trees.len(),
            };
            if tree == trees.len() {
                trees.push(Vec::new());
            }
            owner.push((tree as u32, trees[tree].len() as u32));
            trees[tree].push(place);
        }
        let skeleton = |places: Vec<usize>| {
            let parent = |&place: &usize| self.parents[place].map(|parent| owner[parent as usize].1);
            let positions = places.iter().map(|&place| self.positions[place]).collect();
            let mut tree = Skeleton::new(positions, places.iter().map(parent).collect())?
                .with_stages(places.iter().map(|&place| self.stages[place]).collect())?
                .with_hops(places.iter().map(|&place| self.hops[place]).collect())?;
            if !self.radii.is_empty() {
                let radius = |&place: &usize| self.radii.get(place).copied().unwrap_or(0.0);
                tree = tree.with_radii(places.iter().map(radius).collect())?;
            }
            Ok((tree, places))
        };
        trees.into_iter().map(skeleton).collect()
    }
}
