//! Poisson-disc nodes in a plane with the edges of their Delaunay triangulation: a graph whose edges never cross.

use super::tiles::Discs;
use super::{Graph, GraphBuilder, GraphError, PoissonYao};
use crate::observer::{Observer, Work, report};
use crate::parameter::ParameterError;
use crate::shape::Shape;
use delaunator::{EMPTY, Point, triangulate};
use glam::Vec3;

/// Longest edge, in spacings. Twice the radius of the discs in the region that may be empty.
const REACH: f32 = 4.0;

/// A planar graph in the plane z = 0 of a region: trees in it cannot cross themselves.
///
/// The Yao graph of [`PoissonYao::planar`] is not planar: it has three crossings for every four edges, and two
/// least-cost paths may use edges that cross. Here nodes are linked as in their Delaunay triangulation, in both directions, about six
/// edges per node. Nodes are those of a planar `PoissonYao` with the same options.
///
/// Edges longer than 4 spacings, which would run along the region's sides, are left out. In a convex region the
/// graph is connected all the same: no disc of two spacings around a point of the region is empty, so the shortest links that
/// connect all nodes are shorter than that, and these are edges of the triangulation.
///
/// The turn of three points to the left or right is decided exactly. O(n log n); the arrays take
/// some 230 bytes per node at the peak.
///
/// ```
/// use treesynth::{Silent, guided::{GraphBuilder, PoissonDelaunay}, shape::Cuboid, glam::Vec3};
///
/// let region = Cuboid::new(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0));
/// let graph = PoissonDelaunay::new(region).with_nodes(1_000).build(42, &Silent)?;
/// assert!(graph.edges() < 6 * graph.nodes());
/// assert_eq!(graph.position(graph.root()), Vec3::ZERO);
/// # Ok::<(), treesynth::guided::GraphError>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct PoissonDelaunay<S> {
    /// Tells the spacing.
    nodes: PoissonYao<S>,
    root: Vec3,
}

crate::recipe::readable!(@[S] PoissonDelaunay<S> { root: Vec3 });

impl<A> PoissonDelaunay<A> {
    /// The same in another region.
    pub(crate) fn map<B>(self, region: impl FnOnce(A) -> B) -> PoissonDelaunay<B> {
        PoissonDelaunay { nodes: self.nodes.map(region), root: self.root }
    }
}

impl<S: Shape> PoissonDelaunay<S> {
    /// 3,750 nodes in the plane z = 0 of `region`, root at the origin.
    pub fn new(region: S) -> Self {
        Self { nodes: PoissonYao::new(region).planar().with_nodes(3_750), root: Vec3::ZERO }
    }

    /// Number of nodes, within a few percent; in [2, 200000000]. The spacing follows from the region's area.
    pub fn with_nodes(mut self, nodes: usize) -> Self {
        self.nodes = self.nodes.with_nodes(nodes);
        self
    }

    /// The least distance between two nodes, metres, above 0 and coarse enough for at most 2e8 nodes.
    pub fn with_spacing(mut self, spacing: f32) -> Self {
        self.nodes = self.nodes.with_spacing(spacing);
        self
    }

    /// Position of the root, metres; in the plane z = 0 of the region.
    pub fn with_root(mut self, root: Vec3) -> Self {
        self.root = root;
        self
    }

    /// Number of nodes from [`with_nodes`](Self::with_nodes); `None` if the spacing was given.
    pub fn nodes(&self) -> Option<usize> {
        self.nodes.nodes()
    }

    /// Region in which nodes lie.
    pub fn region(&self) -> &S {
        self.nodes.region()
    }

    /// The spacing in metres, given or from the number of nodes and the region's area.
    ///
    /// # Errors
    /// When an option is out of range or the region is empty.
    pub fn spacing(&self) -> Result<f32, ParameterError> {
        self.nodes.spacing().map_err(|mut error| {
            error.parameter = error.parameter.replace("PoissonYao", "PoissonDelaunay");
            error
        })
    }
}

impl<S: Shape> GraphBuilder for PoissonDelaunay<S> {
    fn build(&self, seed: u64, observer: &dyn Observer) -> Result<Graph, GraphError> {
        self.check()?;
        let spacing = self.spacing()?;
        if !self.nodes.region().contains(self.root) {
            return Err(ParameterError::new("PoissonDelaunay.root", self.root, "inside of the region").into());
        }
        let fixed = [self.root];
        let discs = Discs { region: self.nodes.region(), fixed: &fixed, spacing, planar: true };
        let positions = discs.place(seed, observer)?;
        report(observer, Work::Edges, 0.0)?;
        let edges = delaunay(&positions, REACH * spacing);
        let graph = Graph::new(positions, &edges, 0)?;
        report(observer, Work::Edges, 1.0)?;
        Ok(graph)
    }

    fn check(&self) -> Result<(), ParameterError> {
        let root = self.root;
        ParameterError::unless(
            root.is_finite() && root.z == 0.0,
            "PoissonDelaunay.root",
            root,
            "finite, and in the plane z = 0",
        )?;
        self.spacing().map(drop)
    }
}

/// The edges of the triangulation in both directions, none longer than `longest`.
fn delaunay(positions: &[Vec3], longest: f32) -> Vec<(u32, u32)> {
    let points: Vec<Point> = positions.iter().map(|p| Point { x: p.x.into(), y: p.y.into() }).collect();
    let found = triangulate(&points);
    let mut edges = Vec::with_capacity(found.triangles.len() * 2);
    let mut link = |from: usize, to: usize| {
        if positions[from].distance_squared(positions[to]) <= longest * longest {
            edges.extend([(from as u32, to as u32), (to as u32, from as u32)]);
        }
    };
    if found.is_empty() {
        // All on one line, in its order.
        found.hull.windows(2).for_each(|pair| link(pair[0], pair[1]));
    }
    for (half, &twin) in found.halfedges.iter().enumerate() {
        if twin == EMPTY || half < twin {
            link(found.triangles[half], found.triangles[delaunator::next_halfedge(half)]);
        }
    }
    edges
}
