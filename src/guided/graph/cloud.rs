//! Graphs over points of the user's and over a lattice.

use super::sectors::Sectors;
use super::yao::{Adjacency, yao};
use super::{Graph, GraphBuilder, GraphError, check_nodes};
use crate::observer::{Observer, Work, report};
use crate::parallel;
use crate::parameter::ParameterError;
use crate::random::{Purpose, unit};
use crate::shape::Shape;
use glam::Vec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use std::num::NonZeroUsize;
use std::sync::Arc;

/// Which nodes edges lead to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Edges {
    /// The nearest node in each of so many sectors, in [3, 64]; see [`PoissonYao::with_sectors`].
    ///
    /// [`PoissonYao::with_sectors`]: super::PoissonYao::with_sectors
    Yao(usize),
    /// The nearest node in each of so many equal wedges of the plane z = 0, in [3, 64].
    PlanarYao(usize),
    /// So many nearest nodes, in [1, 64]. Unlike sectors they may all lie on one side, so that clusters of nodes
    /// stay unconnected.
    Nearest(usize),
}

impl Edges {
    fn check(self, parameter: &str) -> Result<(), ParameterError> {
        match self {
            Self::Yao(count) | Self::PlanarYao(count) => Sectors::check(parameter, count),
            Self::Nearest(count) => {
                ParameterError::unless((1..=64).contains(&count), parameter, count, "in [1, 64]")
            }
        }
    }

    /// Edges are numbered in 32 bits.
    fn check_count(self, nodes: usize) -> Result<(), GraphError> {
        let (Self::Yao(count) | Self::PlanarYao(count) | Self::Nearest(count)) = self;
        let count = nodes.saturating_mul(count);
        if count > u32::MAX as usize { Err(GraphError::TooLarge { count }) } else { Ok(()) }
    }

    /// `positions` must be finite.
    fn link(self, positions: Vec<Vec3>, root: u32, observer: &dyn Observer) -> Result<Graph, GraphError> {
        let Adjacency { starts, targets } = match self {
            Self::Yao(count) => yao(&positions, &Sectors::new(count, false), None, observer)?,
            Self::PlanarYao(count) => yao(&positions, &Sectors::new(count, true), None, observer)?,
            Self::Nearest(count) => nearest(&positions, count, observer)?,
        };
        let graph = Graph::from_parts(positions, starts, targets, root);
        // Nodes in one place are each other's nearest, so this finds them all.
        (0..graph.nodes() as u32).try_for_each(|from| {
            graph.neighbours(from).iter().try_for_each(|&to| graph.check_length(from, to))
        })?;
        Ok(graph)
    }
}

/// The `count` nearest nodes of each, by a k-d tree; ties to the lower number.
fn nearest(positions: &[Vec3], count: usize, observer: &dyn Observer) -> Result<Adjacency, GraphError> {
    report(observer, Work::Edges, 0.0)?;
    let points: Vec<[f32; 3]> = positions.iter().map(Vec3::to_array).collect();
    let tree = ImmutableKdTree::new_from_slice(&points);
    // One more for the node itself.
    let wanted = NonZeroUsize::new(count + 1).unwrap_or(NonZeroUsize::MIN);
    let lists = parallel::map(points.len(), |node| {
        let farthest =
            tree.nearest_n::<SquaredEuclidean>(&points[node], wanted).last().map_or(0.0, |n| n.distance);
        // All that are as near as the last: how many tie with it cannot be known before.
        let mut found: Vec<(f32, u32)> = tree
            .within_unsorted::<SquaredEuclidean>(&points[node], farthest * 1.000_001 + f32::MIN_POSITIVE)
            .into_iter()
            .map(|neighbour| (neighbour.distance, neighbour.item as u32))
            .filter(|&(_, other)| other as usize != node)
            .collect();
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.truncate(count);
        found
    });
    let mut all = Adjacency { starts: vec![0], targets: Vec::new() };
    for list in lists {
        all.targets.extend(list.into_iter().map(|(_, other)| other));
        all.starts.push(all.targets.len() as u32);
    }
    report(observer, Work::Edges, 1.0)?;
    Ok(all)
}

/// A graph over points you bring, e.g. from a scan.
///
/// Nodes keep the numbers of the points. The root is the point nearest to a position, the origin if nothing
/// else is said. O(n log n).
///
/// ```
/// use treesynth::{Silent, glam::Vec3, guided::{Edges, GraphBuilder, PointCloud}};
///
/// let points = (0..1000).map(|i| Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32));
/// let graph = PointCloud::new(points.collect(), Edges::Yao(8)).build(0, &Silent)?;
/// assert_eq!(graph.root(), 0);
/// # Ok::<(), treesynth::guided::GraphError>(())
/// ```
#[derive(Debug, Clone)]
pub struct PointCloud {
    points: Vec<Vec3>,
    edges: Edges,
    root: Vec3,
}

impl PointCloud {
    /// A graph over `points`, metres, that must be finite and distinct.
    pub fn new(points: Vec<Vec3>, edges: Edges) -> Self {
        Self { points, edges, root: Vec3::ZERO }
    }

    /// The root is the point nearest to this, metres.
    pub fn with_root(mut self, root: Vec3) -> Self {
        self.root = root;
        self
    }
}

impl GraphBuilder for PointCloud {
    fn build(&self, _seed: u64, observer: &dyn Observer) -> Result<Graph, GraphError> {
        self.check()?;
        check_nodes(&self.points, 0)?;
        self.edges.check_count(self.points.len())?;
        let distance = |&(_, point): &(u32, &Vec3)| point.distance_squared(self.root);
        let root = (0..).zip(&self.points).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        self.edges.link(self.points.clone(), root.map_or(0, |(node, _)| node), observer)
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.edges.check("PointCloud.edges")?;
        ParameterError::unless(self.root.is_finite(), "PointCloud.root", self.root, "finite")
    }
}

/// A cubic lattice in a region, each node moved at random within its cell.
///
/// Section 3.1.1 warns of it: "the resulting lattice artifacts are apparent even if the node positions are
/// jittered". It is here to be compared with. The root is the node nearest to the origin, moved there.
#[derive(Clone)]
pub struct Lattice {
    region: Arc<dyn Shape>,
    spacing: f32,
    jitter: f32,
    edges: Edges,
}

impl std::fmt::Debug for Lattice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Lattice")
            .field("spacing", &self.spacing)
            .field("jitter", &self.jitter)
            .field("edges", &self.edges)
            .finish_non_exhaustive()
    }
}

impl Lattice {
    /// Nodes `spacing` metres apart in `region`, with eight sectors and a jitter of 0.5.
    pub fn new(region: impl Shape + 'static, spacing: f32) -> Self {
        Self { region: Arc::new(region), spacing, jitter: 0.5, edges: Edges::Yao(8) }
    }

    /// How far a node may be moved along each axis, as a share of the half cell, in [0, 1).
    pub fn with_jitter(mut self, jitter: f32) -> Self {
        self.jitter = jitter;
        self
    }

    /// Which nodes edges lead to. With [`Edges::PlanarYao`] only the layer z = 0 is filled, and not moved off it.
    pub fn with_edges(mut self, edges: Edges) -> Self {
        self.edges = edges;
        self
    }
}

impl GraphBuilder for Lattice {
    fn build(&self, seed: u64, observer: &dyn Observer) -> Result<Graph, GraphError> {
        self.check()?;
        report(observer, Work::Nodes, 0.0)?;
        let bounds = self.region.bounds();
        let first = (bounds.min / self.spacing).floor().as_ivec3();
        let last = (bounds.max / self.spacing).ceil().as_ivec3();
        let flat = matches!(self.edges, Edges::PlanarYao(_));
        let mut positions = Vec::new();
        let mut index = 0;
        for z in if flat { 0..=0 } else { first.z..=last.z } {
            for y in first.y..=last.y {
                for x in first.x..=last.x {
                    let shift = |axis| (unit(seed, axis, Purpose::NODES, index) - 0.5) * self.jitter;
                    let shift = Vec3::new(shift(0), shift(1), if flat { 0.0 } else { shift(2) });
                    index += 1;
                    let node = (Vec3::new(x as f32, y as f32, z as f32) + shift) * self.spacing;
                    if self.region.contains(node) {
                        positions.push(node);
                    }
                }
            }
        }
        report(observer, Work::Nodes, 1.0)?;
        let distance = |&(_, p): &(usize, &Vec3)| p.length_squared();
        let root = positions.iter().enumerate().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let root = root.map(|(node, _)| node).ok_or(GraphError::Empty)?;
        self.edges.check_count(positions.len())?;
        positions[root] = Vec3::ZERO;
        self.edges.link(positions, root as u32, observer)
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.region.check()?;
        self.edges.check("Lattice.edges")?;
        ParameterError::unless(
            (0.0..1.0).contains(&self.jitter),
            "Lattice.jitter",
            self.jitter,
            "in [0, 1)",
        )?;
        let bounds = self.region.bounds();
        let counts = bounds.size() / self.spacing;
        let farthest = bounds.min.abs().max(bounds.max.abs()).max_element() / self.spacing;
        ParameterError::unless(
            self.spacing > 0.0
                && self.spacing.is_finite()
                && (counts + 2.0).element_product() <= 1e8
                && farthest <= 1e6,
            "Lattice.spacing",
            self.spacing,
            "above 0 m and coarse enough for at most 1e8 nodes in the region's bounds",
        )
    }
}
