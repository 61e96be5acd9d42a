//! Poisson-disc nodes with Yao edges: the paper's graph.

use super::roots::{check_apart, check_roots, place_leaders};
use super::sectors::Sectors;
use super::tiles::Discs;
use super::yao::{Adjacency, Reach, reach_of, yao};
use super::{Carried, Graph, GraphBuilder, GraphError, Leader, around_tree};
use crate::observer::Observer;
use crate::parameter::ParameterError;
use crate::shape::Shape;
use crate::skeleton::Skeleton;
use glam::Vec3;

/// The graph of section 3.1.1: nodes in a Poisson-disc distribution, edges to the nearest node in each sector.
///
/// No two nodes are nearer than the spacing r, and no ball of radius 2r inside the region is empty. The second
/// promise is kept by construction, not by chance: see `Tile::sweep` in `tiles.rs`. The root is a node; in 2D
/// ([`planar`](Self::planar)) all nodes lie in the plane z = 0 of the region.
///
/// Cost: O(n log n) time, about 75 bytes per node at the peak. With the feature `parallel` tiles of the
/// region are filled on several threads, in phases, and the result is the same to the bit.
///
/// ```
/// use treesynth::{Silent, guided::{GraphBuilder, PoissonYao}, shape::Cuboid, glam::Vec3};
///
/// let region = Cuboid::new(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0));
/// let graph = PoissonYao::new(region).with_nodes(5_000).build(42, &Silent)?;
/// assert!((4_500..5_500).contains(&graph.nodes()));
/// assert_eq!(graph.position(graph.root()), Vec3::ZERO);
/// # Ok::<(), treesynth::guided::GraphError>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct PoissonYao<S> {
    region: S,
    size: Size,
    planar: bool,
    sectors: usize,
    /// Those asked for; none for one at the origin, or at the base of the leader or of each tree.
    roots: Option<Vec<Vec3>>,
    /// One per root; the last one for all that follow.
    #[cfg_attr(feature = "serde", serde(default))]
    leaders: Vec<Leader>,
    #[cfg_attr(feature = "serde", serde(default))]
    trees: Vec<Skeleton>,
}

impl<S> PoissonYao<S> {
    /// Roots from [`with_roots`](Self::with_roots), if it was called.
    pub fn roots(&self) -> Option<&[Vec3]> {
        self.roots.as_deref()
    }

    /// Leaders from [`with_leaders`](Self::with_leaders).
    pub fn leaders(&self) -> &[Leader] {
        &self.leaders
    }

    /// Trees from each [`with_tree`](Self::with_tree).
    pub fn trees(&self) -> &[Skeleton] {
        &self.trees
    }

    /// Number of nodes from [`with_nodes`](Self::with_nodes); `None` if the spacing was given.
    pub fn nodes(&self) -> Option<usize> {
        if let Size::Nodes(nodes) = self.size { Some(nodes) } else { None }
    }
}

crate::recipe::readable!(@[S] PoissonYao<S> { sectors: usize });

crate::recipe::mapped!(PoissonYao { region; size, planar, sectors, roots, leaders, trees });

#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
enum Size {
    Nodes(usize),
    Spacing(f32),
}

/// Nodes in a cube of side r, far from its border; and what a face of the region adds, in layers of r.
const DENSITY: [f32; 2] = [0.6687, 0.762];
const FACE: f32 = 0.444;
/// Nodes and tiles are kept well within 32-bit indices and a machine's memory.
const MAX_NODES: f32 = 2e8;
const MAX_TILES: f32 = 4e6;
/// Edges are numbered in 32 bits.
const MAX_EDGES: f32 = 4e9;

impl<S: Shape> PoissonYao<S> {
    /// 150,000 nodes (section 4: "a typical result was created in a graph of 150,000 nodes") in `region`,
    /// 8 sectors, root at the origin.
    pub fn new(region: S) -> Self {
        Self {
            region,
            size: Size::Nodes(150_000),
            planar: false,
            sectors: 8,
            roots: None,
            leaders: Vec::new(),
            trees: Vec::new(),
        }
    }

    /// Number of nodes, within a few percent; in [2, 200000000]. The spacing follows from the
    /// region's volume.
    pub fn with_nodes(mut self, nodes: usize) -> Self {
        self.size = Size::Nodes(nodes);
        self
    }

    /// The least distance between two nodes, metres, above 0 and coarse enough for at most 2e8 nodes: "the branch feature size and the minimum branch tip
    /// spacing".
    pub fn with_spacing(mut self, spacing: f32) -> Self {
        self.size = Size::Spacing(spacing);
        self
    }

    /// All nodes in the plane z = 0 of the region, and sectors that divide that plane.
    pub fn planar(mut self) -> Self {
        self.planar = true;
        self
    }

    /// The number of sectors, in [3, 64]. In 3D, 8 are the octants; other counts are the regions
    /// nearest to each of that number of evenly spread directions; in 2D they are equal wedges.
    /// Fewer than 6 in 3D may leave nodes [unreachable](Graph::unreachable).
    pub fn with_sectors(mut self, sectors: usize) -> Self {
        self.sectors = sectors;
        self
    }

    /// Position of the root, metres; it must lie in the region.
    pub fn with_root(self, root: Vec3) -> Self {
        self.with_roots([root])
    }

    /// Positions of several trees' roots, metres: points of the region at least the spacing apart.
    /// [`TreeSynth::synthesize_all`](crate::TreeSynth::synthesize_all) grows a tree from each.
    pub fn with_roots(mut self, roots: impl Into<Vec<Vec3>>) -> Self {
        self.roots = Some(roots.into());
        self
    }

    /// A trunk that stands from the beginning, smooth and as straight as it says, another for each seed; stages begin with
    /// the limbs. Its base is the root. With [`with_root`](Self::with_root) or [`with_roots`](Self::with_roots) each
    /// root has such a trunk, which strays in a way of its own: the leader is moved there.
    pub fn with_leader(self, leader: Leader) -> Self {
        self.with_leaders([leader])
    }

    /// A leader for each root, in their order; the last one for all roots that follow. See
    /// [`with_leader`](Self::with_leader). Without `with_roots`, each leader's base is a root.
    pub fn with_leaders(mut self, leaders: impl Into<Vec<Leader>>) -> Self {
        self.leaders = leaders.into();
        self
    }

    /// A tree that stands from the beginning, whatever made it: one's own drawing, limbs of another method. Its root is
    /// a root of the graph and lies in the region; its nodes are nodes of the graph, longer internodes are divided.
    /// Radii that it has are the least that its branches have in the end. Call it again for more trees; they come after
    /// the roots of [`with_roots`](Self::with_roots).
    pub fn with_tree(mut self, tree: Skeleton) -> Self {
        self.trees.push(tree);
        self
    }

    /// Region in which nodes lie.
    pub fn region(&self) -> &S {
        &self.region
    }

    /// Each leader at its root.
    fn placed_leaders(&self) -> Vec<Leader> {
        place_leaders(&self.leaders, self.roots.as_deref())
    }

    /// Starting points of trees, those of [`with_tree`](Self::with_tree) last.
    fn all_roots(&self) -> Vec<Vec3> {
        let mut roots = match &self.roots {
            Some(roots) => roots.clone(),
            None => self.leaders.iter().map(Leader::base).collect(),
        };
        roots.extend(self.trees.iter().map(|tree| tree.positions()[0]));
        if roots.is_empty() && self.roots.is_none() {
            roots.push(Vec3::ZERO);
        }
        roots
    }

    /// Trees that stand in the graph from the beginning.
    fn planted(&self, spacing: f32, seed: u64) -> Result<Option<Carried>, GraphError> {
        if self.leaders.is_empty() && self.trees.is_empty() {
            return Ok(None);
        }
        let mut carried = Carried::default();
        for (number, leader) in (0..).zip(&self.placed_leaders()) {
            carried.add_skeleton(&leader.numbered(seed, number, spacing)?, spacing);
        }
        if self.leaders.is_empty() {
            self.roots.iter().flatten().for_each(|&root| carried.add_root(root));
        }
        self.trees.iter().for_each(|tree| carried.add_skeleton(tree, spacing));
        Ok(Some(carried))
    }

    /// The spacing in metres, given or from the number of nodes and the region's volume (area, if planar).
    ///
    /// # Errors
    /// When an option is out of range or the region is empty.
    pub fn spacing(&self) -> Result<f32, ParameterError> {
        self.region.check()?;
        let bounds = self.region.bounds();
        let size = bounds.size();
        let r = match self.size {
            Size::Spacing(r) => {
                let fits = r > 0.0 && r <= Graph::MAX_COORDINATE;
                ParameterError::unless(fits, "PoissonYao.spacing", r, "above 0 m and at most 1e9 m")?;
                r
            }
            Size::Nodes(nodes) => {
                ParameterError::unless(
                    (2..=MAX_NODES as usize).contains(&nodes),
                    "PoissonYao.nodes",
                    nodes,
                    "in [2, 200000000]",
                )?;
                let measure = self.measure();
                ParameterError::unless(
                    measure > 0.0 && measure.is_finite(),
                    "PoissonYao.region",
                    measure,
                    "a shape whose volume (in 2D: area at z = 0) is above 0 and finite",
                )?;
                self.spacing_for(nodes as f32, measure)
            }
        };
        let measure = self.measure();
        let nodes = self.nodes_at(r, measure);
        ParameterError::unless(
            nodes <= MAX_NODES,
            "PoissonYao.spacing",
            r,
            "coarse enough for at most 200000000 nodes in the region",
        )?;
        let cells = size / r;
        let box_nodes = if self.planar { cells.x * cells.y } else { cells.element_product() };
        let tiles = box_nodes / if self.planar { 512.0 } else { 780.0 };
        ParameterError::unless(
            tiles <= MAX_TILES
                && cells.max_element() <= 1e6
                && r > bounds.min.abs().max(bounds.max.abs()).max_element() * 1e-6,
            "PoissonYao.spacing",
            r,
            "coarser: at most 3e9 discs in the region's bounds, and above a millionth of their coordinates",
        )?;
        Ok(r)
    }

    /// Nodes at a spacing, by `density (s + FACE)^d`, with s the side, in spacings, of a cube of the region's measure.
    fn nodes_at(&self, spacing: f32, measure: f32) -> f32 {
        let side = self.root_of(measure) / spacing + FACE;
        if self.planar { DENSITY[1] * side * side } else { DENSITY[0] * side * side * side }
    }

    /// The other way around.
    fn spacing_for(&self, nodes: f32, measure: f32) -> f32 {
        let side = self.root_of(nodes / DENSITY[usize::from(self.planar)]) - FACE;
        self.root_of(measure) / side.max(0.5)
    }

    fn root_of(&self, x: f32) -> f32 {
        if self.planar { x.sqrt() } else { crate::math::cbrt(x) }
    }

    /// The region's volume, or its area if planar.
    fn measure(&self) -> f32 {
        if self.planar { self.area() } else { self.region.volume() }
    }

    /// Area of the region's cut with z = 0, by a lattice of 512 x 512.
    fn area(&self) -> f32 {
        let bounds = self.region.bounds();
        let step = bounds.size() / 512.0;
        let inside = (0..512 * 512)
            .filter(|i| {
                let p = bounds.min + step * Vec3::new((i % 512) as f32 + 0.5, (i / 512) as f32 + 0.5, 0.0);
                self.region.contains(p.with_z(0.0))
            })
            .count();
        inside as f32 * step.x * step.y
    }
}

impl<S: Shape> GraphBuilder for PoissonYao<S> {
    fn build(&self, seed: u64, observer: &dyn Observer) -> Result<Graph, GraphError> {
        self.check()?;
        let spacing = self.spacing()?;
        let sectors = Sectors::new(self.sectors, self.planar);
        let reach = reach_of(self.sectors, self.planar) * spacing;
        let planted = self.planted(spacing, seed)?;
        let roots = self.all_roots();
        if let Some(&root) = roots.iter().find(|&&root| !self.region.contains(root)) {
            return Err(GraphError::RootOutside { root });
        }
        if let Some(planted) = planted {
            return around_tree(&self.region, &planted, spacing, reach, &sectors, seed, observer);
        }
        let discs = Discs { region: &self.region, fixed: &roots, spacing, planar: self.planar };
        let positions = discs.place(seed, observer)?;
        let Adjacency { starts, targets } = yao(&positions, &sectors, Reach::Same(reach), observer)?;
        let graph = Graph::from_parts(positions, starts, targets, 0);
        graph.with_roots((0..roots.len() as u32).collect())
    }

    fn check(&self) -> Result<(), ParameterError> {
        Sectors::check("PoissonYao.sectors", self.sectors)?;
        self.leaders.iter().try_for_each(Leader::check)?;
        let roots = self.all_roots();
        check_roots(&roots, "PoissonYao")?;
        for &root in &roots {
            let fits = !self.planar || root.z == 0.0;
            ParameterError::unless(fits, "PoissonYao.root", root, "in the plane z = 0 of a planar graph")?;
        }
        let far = |tree: &&Skeleton| {
            tree.positions().iter().any(|position| position.abs().max_element() > Graph::MAX_COORDINATE)
        };
        let far = self.trees.iter().find(far).map_or(0, Skeleton::len);
        ParameterError::unless(far == 0, "PoissonYao.trees", far, "nodes within 1e9 metres of 0")?;
        let spacing = self.spacing()?;
        check_apart(&roots, "PoissonYao.roots", |_| spacing)?;
        let measure = self.measure();
        let edges = self.nodes_at(spacing, measure) * self.sectors as f32;
        ParameterError::unless(
            edges < MAX_EDGES,
            "PoissonYao.sectors",
            self.sectors,
            "few enough for at most 4000000000 edges",
        )
    }
}
