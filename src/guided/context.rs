//! View that rules and weights have of the search around them.

use super::fork::Fork;
use super::search::Search;
use glam::Vec3;

/// The search that asks, or what a user has made up to try a rule with.
#[derive(Debug, Clone, Copy)]
pub(super) enum Context<'a> {
    Search(&'a Search<'a>),
    /// Node 0 is the source, node 1 one edge further on; everything lies behind one fork.
    Alone {
        start: Vec3,
        end: Vec3,
        root: Vec3,
        fork: Fork,
    },
}

impl Context<'_> {
    pub(super) fn position(&self, node: u32) -> Vec3 {
        match *self {
            Self::Search(search) => search.graph().position(node),
            Self::Alone { start, end, .. } => [start, end][node as usize],
        }
    }

    /// Of a node of the tree.
    pub(super) fn fork(&self, source: u32) -> Fork {
        match *self {
            Self::Search(search) => search.fork(source).unwrap_or_else(|| Fork::new(Vec3::Y)),
            Self::Alone { fork, .. } => fork,
        }
    }

    /// The number of the tree that a node is on.
    pub(super) fn tree(&self, source: u32) -> u32 {
        match *self {
            Self::Search(search) => search.tree_of(source).unwrap_or(0),
            Self::Alone { fork, .. } => fork.tree,
        }
    }

    /// Root of the tree that a node is on.
    pub(super) fn root(&self, source: u32) -> Vec3 {
        match *self {
            Self::Search(search) => {
                let graph = search.graph();
                let tree = search.tree_of(source).map_or(0, |tree| tree as usize);
                graph.position(graph.roots()[tree])
            }
            Self::Alone { root, .. } => root,
        }
    }

    /// `true` if an edge leads from `node` to the tree.
    pub(super) fn is_beside_tree(&self, node: u32) -> bool {
        match *self {
            Self::Search(search) => {
                search.asked_beside.get_or_init(|| ());
                search.graph().neighbours(node).iter().any(|&to| search.is_on_tree(to))
            }
            Self::Alone { .. } => node == 0,
        }
    }

    pub(super) fn parent(&self, node: u32) -> Option<u32> {
        match *self {
            Self::Search(search) => search.parent(node),
            Self::Alone { .. } => node.checked_sub(1),
        }
    }
}
