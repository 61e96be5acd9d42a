//! Graphs over points of the user's and over a lattice.

use super::sectors::Sectors;
use super::yao::{Adjacency, Reach, reach_of, yao};
use super::{Graph, GraphBuilder, GraphError, check_nodes};
use crate::observer::{Observer, Work, report};
use crate::parallel;
use crate::parameter::ParameterError;
use crate::random::{Purpose, unit};
use crate::shape::Shape;
use glam::Vec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use std::num::NonZeroUsize;

/// Neighbours that a node's edges lead to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum Edges {
    /// The nearest node in each of this number of sectors, in [3, 64], within reach; see
    /// [`PoissonYao::with_sectors`].
    ///
    /// [`PoissonYao::with_sectors`]: super::PoissonYao::with_sectors
    Yao(usize),
    /// The nearest node in each of this number of equal wedges of the plane z = 0, in [3, 64].
    PlanarYao(usize),
    /// This number of nearest nodes, in [1, 64]. Unlike sectors they may all lie on one side, so that clusters of nodes
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

    /// `positions` must be finite. The reach of edges in sectors is given, or follows from the nodes around.
    fn link(
        self,
        positions: Vec<Vec3>,
        root: u32,
        reach: Option<f32>,
        observer: &dyn Observer,
    ) -> Result<Graph, GraphError> {
        check_distinct(&positions)?;
        let in_sectors = |sectors: Sectors| {
            let local = if reach.is_some() { Vec::new() } else { reaches(&positions) };
            yao(&positions, &sectors, reach.map_or(Reach::Each(&local), Reach::Same), observer)
        };
        let Adjacency { starts, targets } = match self {
            Self::Yao(count) => in_sectors(Sectors::new(count, false))?,
            Self::PlanarYao(count) => in_sectors(Sectors::new(count, true))?,
            Self::Nearest(count) => nearest(&positions, count, observer)?,
        };
        let graph = Graph::from_parts(positions, starts, targets, root);
        // Nodes nearer to each other than a square can tell are each other's nearest, so this finds them all.
        (0..graph.nodes() as u32).try_for_each(|from| {
            graph.neighbours(from).iter().try_for_each(|&to| graph.check_length(from, to))
        })?;
        Ok(graph)
    }
}

/// No two nodes in one place. O(n log n), where a search for neighbours could take n².
fn check_distinct(positions: &[Vec3]) -> Result<(), GraphError> {
    // Plus zero, to make -0 and 0 one place.
    let key = |node: u32| (positions[node as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(|&node| (key(node), node));
    let twice = order.windows(2).find(|pair| key(pair[0]) == key(pair[1]));
    twice.map_or(Ok(()), |pair| {
        let position = positions[pair[0] as usize];
        Err(GraphError::Coincident { from: pair[0], to: pair[1], position })
    })
}

/// Nodes that say how densely a place is filled, and how much farther edges reach than the last of them: in a
/// Poisson-disc distribution of spacing r edges of inner nodes then reach 2.8 r, those of nodes on a face 3.6 r.
const NEAREST: usize = 8;
const FARTHER: f32 = 2.0;

/// The reach of each node's edges, from the nodes around it.
fn reaches(positions: &[Vec3]) -> Vec<f32> {
    if positions.len() <= NEAREST {
        return vec![f32::INFINITY; positions.len()];
    }
    let points: Vec<[f32; 3]> = positions.iter().map(Vec3::to_array).collect();
    let tree = ImmutableKdTree::new_from_slice(&points);
    // One more for the node itself.
    let wanted = NonZeroUsize::new(NEAREST + 1).unwrap_or(NonZeroUsize::MIN);
    parallel::map(points.len(), |node| {
        let last = tree.nearest_n::<SquaredEuclidean>(&points[node], wanted).last().map(|n| n.distance);
        last.map_or(f32::INFINITY, |distance| FARTHER * distance.sqrt())
    })
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
/// else is said. An edge in a sector is at most twice as long as its start's distance to its eighth nearest point,
/// unless [`with_reach`](Self::with_reach) says otherwise; parts of the cloud that are farther apart stay
/// unconnected, and [`Graph::unreachable`] counts what the root does not reach. O(n log n).
///
/// ```
/// use treesynth::{Silent, glam::Vec3, guided::{Edges, GraphBuilder, PointCloud}};
///
/// let points = (0..1000).map(|i| Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32));
/// let graph = PointCloud::new(points.collect(), Edges::Yao(8)).build(0, &Silent)?;
/// assert_eq!(graph.root(), 0);
/// # Ok::<(), treesynth::guided::GraphError>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct PointCloud {
    points: Vec<Vec3>,
    edges: Edges,
    root: Vec3,
    #[cfg_attr(feature = "serde", serde(default, with = "crate::parameter::maybe_infinite_or_none"))]
    reach: Option<f32>,
}

crate::recipe::readable!(PointCloud { root: Vec3, reach: Option<f32> });

impl PointCloud {
    /// A graph over `points`, metres, that must be finite and distinct.
    pub fn new(points: Vec<Vec3>, edges: Edges) -> Self {
        Self { points, edges, root: Vec3::ZERO, reach: None }
    }

    /// The root is the point nearest to this, metres.
    pub fn with_root(mut self, root: Vec3) -> Self {
        self.root = root;
        self
    }

    /// The longest edge in a sector, metres, above 0; infinite for none: then the nearest point of a sector that
    /// looks out of the cloud may be on its far side. [`Edges::Nearest`] knows no reach.
    pub fn with_reach(mut self, reach: f32) -> Self {
        self.reach = Some(reach);
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
        self.edges.link(self.points.clone(), root.map_or(0, |(node, _)| node), self.reach, observer)
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.edges.check("PointCloud.edges")?;
        let reach = self.reach.unwrap_or(1.0);
        ParameterError::unless(reach > 0.0, "PointCloud.reach", reach, "above 0 m")?;
        ParameterError::unless(self.root.is_finite(), "PointCloud.root", self.root, "finite")
    }
}

/// A cubic lattice in a region, each node moved at random within its cell.
///
/// Section 3.1.1 warns of it: "the resulting lattice artifacts are apparent even if the node positions are
/// jittered". It is here to be compared with. The root is the node nearest to the origin, moved there.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Lattice<S> {
    region: S,
    spacing: f32,
    jitter: f32,
    edges: Edges,
}

crate::recipe::readable!(@[S] Lattice<S> { jitter: f32, edges: Edges });

crate::recipe::mapped!(Lattice { region; spacing, jitter, edges });

impl<S: Shape> Lattice<S> {
    /// Nodes `spacing` metres apart in `region`, with eight sectors and a jitter of 0.5.
    pub fn new(region: S, spacing: f32) -> Self {
        Self { region, spacing, jitter: 0.5, edges: Edges::Yao(8) }
    }

    /// Greatest move of a node along each axis, as a share of the half cell, in [0, 1).
    pub fn with_jitter(mut self, jitter: f32) -> Self {
        self.jitter = jitter;
        self
    }

    /// Neighbours of each node. With [`Edges::PlanarYao`] only the layer z = 0 is filled, and not moved off it.
    pub fn with_edges(mut self, edges: Edges) -> Self {
        self.edges = edges;
        self
    }
}

impl<S: Shape> GraphBuilder for Lattice<S> {
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
        let (Edges::Yao(count) | Edges::PlanarYao(count) | Edges::Nearest(count)) = self.edges;
        let reach = reach_of(count, flat) * self.spacing;
        self.edges.link(positions, root as u32, Some(reach), observer)
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
