//! The graph in which trees are least-cost paths (section 3.1.1).

mod bvh;
mod cloud;
mod delaunay;
mod graded;
mod leader;
mod leaf;
mod local;
mod mesh;
mod octree;
mod once;
mod planted;
mod poisson;
mod roots;
mod scalars;
mod sectors;
mod sizing;
mod spacing;
mod tiles;
mod yao;

pub use cloud::{Edges, Lattice, PointCloud};
pub use delaunay::PoissonDelaunay;
pub use graded::GradedYao;
pub use leader::Leader;
pub(super) use local::around_tree;
pub use mesh::{PoissonSurface, SurfaceNodes};
pub(super) use planted::{Carried, Planted};
pub use poisson::PoissonYao;
pub(super) use sectors::Sectors;
pub use sizing::{NearSurface, SizingField, SizingFn};
pub use spacing::Spacing;

use crate::observer::{Cancelled, Observer};
use crate::parameter::ParameterError;
use glam::Vec3;
use std::sync::{Arc, OnceLock};

/// Makes the graph that a tree grows in.
///
/// # Contract
/// - The same builder and seed give the same graph, bit for bit, on every thread. If not, trees are not
///   reproducible.
/// - The root's edges lead, directly or over other nodes, to wherever a tree may grow; what they do not reach,
///   no branch reaches.
/// - [`check`](Self::check) refuses what `build` could not handle; it is called once, before anything is built.
///
/// [`Graph::new`] makes sure of the rest: finite positions, edges that lead from one node to another.
///
/// ```
/// use treesynth::{Observer, glam::Vec3, guided::{Graph, GraphBuilder, GraphError}};
///
/// /// Nodes on a vertical line, each linked to its neighbours.
/// struct Pole { nodes: u32 }
///
/// impl GraphBuilder for Pole {
///     fn build(&self, _seed: u64, _: &dyn Observer) -> Result<Graph, GraphError> {
///         let positions = (0..self.nodes).map(|i| Vec3::Y * i as f32).collect();
///         let edges: Vec<_> = (1..self.nodes).flat_map(|i| [(i - 1, i), (i, i - 1)]).collect();
///         Graph::new(positions, &edges, 0)
///     }
/// }
/// assert_eq!(Pole { nodes: 5 }.build(0, &treesynth::Silent)?.edges(), 8);
/// # Ok::<(), GraphError>(())
/// ```
pub trait GraphBuilder: Send + Sync {
    /// Builds the graph. Long work reports to `observer` and ends with [`GraphError::Cancelled`] when told to.
    ///
    /// # Errors
    /// Whatever keeps the graph from being built.
    fn build(&self, seed: u64, observer: &dyn Observer) -> Result<Graph, GraphError>;

    /// Checks that the options are in range.
    ///
    /// # Errors
    /// The first option that is not.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

macro_rules! forward {
    ($($pointer:ty),*) => {$(
        impl<T: GraphBuilder + ?Sized> GraphBuilder for $pointer {
            fn build(&self, seed: u64, observer: &dyn Observer) -> Result<Graph, GraphError> {
                (**self).build(seed, observer)
            }
            fn check(&self) -> Result<(), ParameterError> {
                (**self).check()
            }
        }
    )*};
}
forward!(&T, Box<T>, Arc<T>);

/// A directed graph in space, with a root or several.
///
/// Nodes are numbered from 0. Out-edges of a node lie side by side in one flat array. Memory: 16 bytes per
/// node and 4 bytes per edge, 4 more bytes per node once [`hops_from_root`](Self::hops_from_root) was asked
/// for.
#[derive(Debug, Clone)]
pub struct Graph {
    positions: Vec<Vec3>,
    /// Node `i` has the edges `targets[starts[i]..starts[i + 1]]`.
    starts: Vec<u32>,
    targets: Vec<u32>,
    /// At least one.
    roots: Vec<u32>,
    hops_from_root: OnceLock<Vec<u32>>,
    /// The trees that stages begin with, if not the roots alone.
    planted: Option<Arc<Planted>>,
}

/// Equal nodes, edges and roots; what has been asked for already does not matter.
impl PartialEq for Graph {
    fn eq(&self, other: &Self) -> bool {
        let parts = |graph: &Self| (graph.positions.len(), graph.targets.len());
        parts(self) == parts(other)
            && self.roots == other.roots
            && self.starts == other.starts
            && self.targets == other.targets
            && self.positions == other.positions
            && self.planted == other.planted
    }
}

/// Error of building a graph.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GraphError {
    /// An option is out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// No nodes.
    #[error("a graph has at least one node, this has none")]
    Empty,
    /// More nodes or edges than 32-bit indices can name.
    #[error("a graph has at most {} nodes and edges, this has {count}", u32::MAX)]
    TooLarge {
        /// Number present.
        count: usize,
    },
    /// The root is not a node.
    #[error("the root is node {root}, but there are {nodes} nodes")]
    Root {
        /// The root named.
        root: u32,
        /// The number of nodes.
        nodes: usize,
    },
    /// The root lies outside of the region that the nodes are placed in.
    #[error("PoissonYao.root is {root}, outside of the region; with_root moves it")]
    RootOutside {
        /// Wanted position of the root, metres.
        root: Vec3,
    },
    /// NaN or an infinity in a position.
    #[error("node {node} has the position {position}, but positions must be finite and within ±{limit} m", limit = Graph::MAX_COORDINATE)]
    Position {
        /// The node.
        node: usize,
        /// Its position, metres.
        position: Vec3,
    },
    /// An edge to or from a node that does not exist.
    #[error("edge {from} -> {to} leads to a node that does not exist: there are {nodes} nodes")]
    Dangling {
        /// First node of the edge.
        from: u32,
        /// Last node of the edge.
        to: u32,
        /// The number of nodes.
        nodes: usize,
    },
    /// An edge from a node to itself.
    #[error("edge {node} -> {node} leads back to its own node")]
    SelfEdge {
        /// The node.
        node: u32,
    },
    /// The same edge twice.
    #[error("edge {from} -> {to} is there twice")]
    Duplicate {
        /// First node of the edge.
        from: u32,
        /// Last node of the edge.
        to: u32,
    },
    /// An edge without length has no direction.
    #[error("edge {from} -> {to} has no length: both nodes are at {position}")]
    Coincident {
        /// First node of the edge.
        from: u32,
        /// Last node of the edge.
        to: u32,
        /// Position of both nodes.
        position: Vec3,
    },
    /// The observer cancelled the work.
    #[error("cancelled by the observer")]
    Cancelled,
    /// For builders outside of this crate: anything else.
    #[error("{0}")]
    Other(String),
}

impl From<Cancelled> for GraphError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl Graph {
    /// The largest coordinate of a node by value, metres: squares of distances stay finite.
    pub const MAX_COORDINATE: f32 = 1e9;

    /// A graph of your own: positions in metres, directed edges `(from, to)` in any order, and the root's number.
    ///
    /// O(n + m log m) for n nodes and m edges.
    ///
    /// # Errors
    /// No nodes; positions that are not finite; edges that dangle, repeat, lead back to their own node or have
    /// no length.
    pub fn new(positions: Vec<Vec3>, edges: &[(u32, u32)], root: u32) -> Result<Self, GraphError> {
        let nodes = positions.len();
        check_nodes(&positions, root)?;
        if edges.len() > u32::MAX as usize {
            return Err(GraphError::TooLarge { count: edges.len() });
        }
        let mut sorted = edges.to_vec();
        sorted.sort_unstable();
        let mut starts = vec![0; nodes + 1];
        for (i, &(from, to)) in sorted.iter().enumerate() {
            if from as usize >= nodes || to as usize >= nodes {
                return Err(GraphError::Dangling { from, to, nodes });
            }
            if from == to {
                return Err(GraphError::SelfEdge { node: from });
            }
            if i > 0 && sorted[i - 1] == (from, to) {
                return Err(GraphError::Duplicate { from, to });
            }
            starts[from as usize + 1] += 1;
        }
        for node in 0..nodes {
            starts[node + 1] += starts[node];
        }
        let targets = sorted.iter().map(|&(_, to)| to).collect();
        let graph = Self::from_parts(positions, starts, targets, root);
        sorted.iter().try_for_each(|&(from, to)| graph.check_length(from, to))?;
        Ok(graph)
    }

    /// The length, not the positions: two that differ by less than a square can hold give no direction either.
    fn check_length(&self, from: u32, to: u32) -> Result<(), GraphError> {
        let position = self.position(from);
        if self.position(to).distance_squared(position) < f32::MIN_POSITIVE {
            return Err(GraphError::Coincident { from, to, position });
        }
        Ok(())
    }

    /// For builders that make valid parts by construction.
    fn from_parts(positions: Vec<Vec3>, starts: Vec<u32>, targets: Vec<u32>, root: u32) -> Self {
        Self { positions, starts, targets, roots: vec![root], hops_from_root: OnceLock::new(), planted: None }
    }

    /// The same graph with several roots: a tree grows from each, and all compete for the nodes.
    ///
    /// # Errors
    /// No root, one that is not a node, or one named twice.
    pub fn with_roots(mut self, roots: Vec<u32>) -> Result<Self, GraphError> {
        let nodes = self.nodes();
        if let Some(&root) = roots.iter().find(|&&root| root as usize >= nodes) {
            return Err(GraphError::Root { root, nodes });
        }
        let mut sorted = roots.clone();
        sorted.sort_unstable();
        if let Some(&[root, _]) =
            sorted.windows(2).filter_map(|pair| pair.first_chunk()).find(|[a, b]| a == b)
        {
            return Err(GraphError::Other(format!("node {root} is named twice among the roots")));
        }
        if roots.is_empty() {
            return Err(GraphError::Other("a graph has at least one root, this has none".to_owned()));
        }
        self.roots = roots;
        self.hops_from_root = OnceLock::new();
        Ok(self)
    }

    /// The same graph with trees in it, whose nodes are the first of the graph's; their roots are its roots.
    pub(super) fn with_planted(mut self, tree: Planted) -> Self {
        let is_root = |&(node, parent): &(u32, u32)| node == parent;
        self.roots =
            (0u32..).zip(tree.parents.iter().copied()).filter(is_root).map(|(node, _)| node).collect();
        self.hops_from_root = OnceLock::new();
        self.planted = Some(Arc::new(tree));
        self
    }

    /// The trees in it.
    pub(super) fn planted(&self) -> Option<&Arc<Planted>> {
        self.planted.as_ref()
    }

    /// Number of nodes; at least 1.
    pub fn nodes(&self) -> usize {
        self.positions.len()
    }

    /// Number of directed edges.
    pub fn edges(&self) -> usize {
        self.targets.len()
    }

    /// The node where the tree starts; of several the first.
    pub fn root(&self) -> u32 {
        self.roots[0]
    }

    /// The nodes where trees start, at least one.
    pub fn roots(&self) -> &[u32] {
        &self.roots
    }

    /// Positions of all nodes, metres.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Position of `node`, metres.
    ///
    /// # Panics
    /// When there is no such node.
    #[inline]
    pub fn position(&self, node: u32) -> Vec3 {
        self.positions[node as usize]
    }

    /// The nodes that edges lead to from `node`.
    ///
    /// # Panics
    /// When there is no such node.
    #[inline]
    pub fn neighbours(&self, node: u32) -> &[u32] {
        &self.targets[self.starts[node as usize] as usize..self.starts[node as usize + 1] as usize]
    }

    /// The node nearest to `point`, the lower number in a tie. O(n).
    pub fn nearest(&self, point: Vec3) -> u32 {
        self.nearest_where(point, |_| true).unwrap_or(self.root())
    }

    /// The node nearest to `point` among those that `filter` lets through.
    pub(crate) fn nearest_where(&self, point: Vec3, filter: impl Fn(u32) -> bool) -> Option<u32> {
        let mut best = (f32::INFINITY, None);
        for (node, position) in (0u32..).zip(&self.positions) {
            let distance = position.distance_squared(point);
            if distance < best.0 && filter(node) {
                best = (distance, Some(node));
            }
        }
        best.1
    }

    /// The number of nodes that no path from a root leads to. O(n + m) at the first call on a graph.
    pub fn unreachable(&self) -> usize {
        self.hops_from_root().iter().filter(|&&hops| hops == u32::MAX).count()
    }

    /// Least number of edges to each node from the nearest root; `u32::MAX` where no path leads.
    ///
    /// O(n + m) at the first call on a graph, O(1) after that.
    pub fn hops_from_root(&self) -> &[u32] {
        self.hops_from_root.get_or_init(|| {
            let mut hops = vec![u32::MAX; self.nodes()];
            let mut ring = self.roots.clone();
            for &root in &ring {
                hops[root as usize] = 0;
            }
            let mut next = Vec::new();
            let mut count = 0;
            while !ring.is_empty() {
                count += 1;
                for &node in &ring {
                    for &to in self.neighbours(node) {
                        if hops[to as usize] == u32::MAX {
                            hops[to as usize] = count;
                            next.push(to);
                        }
                    }
                }
                std::mem::swap(&mut ring, &mut next);
                next.clear();
            }
            hops
        })
    }
}

fn check_nodes(positions: &[Vec3], root: u32) -> Result<(), GraphError> {
    let nodes = positions.len();
    if nodes == 0 {
        return Err(GraphError::Empty);
    }
    if nodes >= u32::MAX as usize {
        return Err(GraphError::TooLarge { count: nodes });
    }
    if root as usize >= nodes {
        return Err(GraphError::Root { root, nodes });
    }
    for (node, &position) in positions.iter().enumerate() {
        let fits = !position.is_nan() && position.abs().max_element() <= Graph::MAX_COORDINATE;
        if !fits {
            return Err(GraphError::Position { node, position });
        }
    }
    Ok(())
}
