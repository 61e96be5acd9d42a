//! Poisson-disc nodes of varying spacing with Yao edges.

use super::local::with_trees;
use super::octree::Octree;
use super::once::Once;
use super::roots::{check_apart, check_roots, place_leaders};
use super::sectors::Sectors;
use super::sizing::SizingField;
use super::spacing::{Samples, Spacing};
use super::yao::{Reach, reach_of, yao};
use super::{Carried, Graph, GraphBuilder, GraphError, Leader};
use crate::observer::Observer;
use crate::parameter::ParameterError;
use crate::shape::Shape;
use glam::Vec3;
use std::sync::Arc;

/// The graph of [`PoissonYao`](super::PoissonYao) with a spacing r that varies: fine where a [`SizingField`] says so,
/// coarse elsewhere.
///
/// r is the largest function that is nowhere above the sizing field and changes by at most the *grading* along each
/// axis, metre for metre, both on a lattice of about two points per node; [`spacing`](Self::spacing) tells
/// it. Two nodes p and q are at least min(r(p), r(q)) apart, and no ball of radius 2 r(c) around a point c
/// inside the region is empty, by construction: see `Tile::sweep` in `leaf.rs`. Edges lead to the nearest
/// node in each sector, exactly, if it lies within 3 r(p) of their start p (for more than 8 sectors as far as
/// in [`PoissonYao`](super::PoissonYao)). The root is a node.
///
/// Cost: as for as many nodes of one spacing, about twice as long where r changes as fast as it may; 8 more
/// bytes per node for r, and up to 64 while edges are found. With the feature `parallel` tiles are filled on
/// several threads, and the result is the same to the bit.
///
/// ```
/// use treesynth::{Silent, glam::Vec3, shape::{Cuboid, Sphere}};
/// use treesynth::guided::{GradedYao, GraphBuilder, NearSurface};
///
/// // 0.1 m at the surface of a crown, 0.4 m far from it.
/// let region = Cuboid::new(Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 6.0, 3.0));
/// let sizing = NearSurface::new(Sphere::new(Vec3::Y * 3.5, 1.5), 0.1, 0.4, 2.0);
/// let builder = GradedYao::new(region, sizing);
/// let graph = builder.build(42, &Silent)?;
/// let spacing = builder.spacing()?;
/// for node in 0..graph.nodes() as u32 {
///     for &near in graph.neighbours(node) {
///         let (p, q) = (graph.position(node), graph.position(near));
///         assert!(p.distance(q) >= 0.9999 * spacing.at(p).min(spacing.at(q)));
///     }
/// }
/// # Ok::<(), treesynth::guided::GraphError>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct GradedYao<S, F> {
    region: S,
    sizing: F,
    nodes: Option<usize>,
    grading: f32,
    sectors: usize,
    /// Those asked for; none for one at the origin or at the base of each leader.
    roots: Option<Vec<Vec3>>,
    /// One per root; the last one for all that follow.
    #[cfg_attr(feature = "serde", serde(default))]
    leaders: Vec<Leader>,
    #[cfg_attr(feature = "serde", serde(skip))]
    spacing: Once<Result<Arc<Spacing>, ParameterError>>,
}

impl<S, F> GradedYao<S, F> {
    /// Roots from [`with_roots`](Self::with_roots), if it was called.
    pub fn roots(&self) -> Option<&[Vec3]> {
        self.roots.as_deref()
    }

    /// Leaders from [`with_leaders`](Self::with_leaders).
    pub fn leaders(&self) -> &[Leader] {
        &self.leaders
    }
}

crate::recipe::readable!(@[S, F] GradedYao<S, F> { nodes: Option<usize>, grading: f32, sectors: usize });

crate::recipe::mapped!(GradedYao { region, sizing; nodes, grading, sectors, roots, leaders, spacing });

/// The limits of `PoissonYao`: on nodes, on discs in the region's bounds, on edges.
const MAX_NODES: f32 = 2e8;
const MAX_DISCS: f32 = 3e9;
const MAX_EDGES: f32 = 4e9;
/// Steeper ones would let a tile have many more cells than nodes: see `Octree::grow`.
const MAX_GRADING: f32 = 0.14;
/// Points of the lattice: the fewest, the most, and how many per node.
const POINTS: [f32; 2] = [32_768.0, 4e6];
const POINTS_A_NODE: f32 = 2.0;
/// Length of a leader's internodes, in spacings.
const PART: f32 = 1.2;

impl<S: Shape, F: SizingField> GradedYao<S, F> {
    /// Nodes in `region`, as far apart as `sizing` says, in metres; grading 0.125, so that r doubles within 8 r;
    /// 8 sectors, root at the origin.
    pub fn new(region: S, sizing: F) -> Self {
        Self {
            region,
            sizing,
            nodes: None,
            grading: 0.125,
            sectors: 8,
            roots: None,
            leaders: Vec::new(),
            spacing: Once::default(),
        }
    }

    /// Number of nodes, within an eighth, or a fifth too few where r changes everywhere as fast as
    /// it may; in [2, 200000000]. The sizes are all multiplied by one factor; what they are in
    /// metres no longer matters.
    pub fn with_nodes(mut self, nodes: usize) -> Self {
        self.nodes = Some(nodes);
        self.spacing = Once::default();
        self
    }

    /// Greatest change of r along each axis, metres per metre; in [0.001, 0.14].
    pub fn with_grading(mut self, grading: f32) -> Self {
        self.grading = grading;
        self.spacing = Once::default();
        self
    }

    /// The number of sectors, in [3, 64]; see [`PoissonYao::with_sectors`](super::PoissonYao::with_sectors).
    pub fn with_sectors(mut self, sectors: usize) -> Self {
        self.sectors = sectors;
        self.spacing = Once::default();
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

    /// A trunk that stands from the beginning; see [`PoissonYao::with_leader`](super::PoissonYao::with_leader). Its
    /// nodes are as far apart as the spacing there says.
    pub fn with_leader(self, leader: Leader) -> Self {
        self.with_leaders([leader])
    }

    /// A leader for each root; see [`PoissonYao::with_leaders`](super::PoissonYao::with_leaders).
    pub fn with_leaders(mut self, leaders: impl Into<Vec<Leader>>) -> Self {
        self.leaders = leaders.into();
        self
    }

    /// Starting points of trees.
    fn all_roots(&self) -> Vec<Vec3> {
        match &self.roots {
            Some(roots) => roots.clone(),
            None if self.leaders.is_empty() => vec![Vec3::ZERO],
            None => self.leaders.iter().map(Leader::base).collect(),
        }
    }

    /// The leaders, divided as finely as the spacing is where they stand.
    fn planted(&self, spacing: &Spacing, seed: u64) -> Result<Carried, GraphError> {
        let mut carried = Carried::default();
        for (number, leader) in (0..).zip(&place_leaders(&self.leaders, self.roots.as_deref())) {
            let trunk = leader.graded(seed, number, |place| PART * spacing.at(place))?;
            // Its nodes are as far apart already as they should be.
            carried.add_skeleton(&trunk, f32::INFINITY);
        }
        Ok(carried)
    }

    /// The spacing r of nodes at each place. The first call asks the sizing field; more are free.
    ///
    /// # Errors
    /// When an option is out of range or the region is empty.
    pub fn spacing(&self) -> Result<Arc<Spacing>, ParameterError> {
        self.spacing.get_or_init(|| self.work_out().map(Arc::new)).clone()
    }

    fn work_out(&self) -> Result<Spacing, ParameterError> {
        self.region.check()?;
        self.sizing.check()?;
        ParameterError::unless(
            (0.001..=MAX_GRADING).contains(&self.grading),
            "GradedYao.grading",
            self.grading,
            "in [0.001, 0.14]",
        )?;
        ParameterError::unless(
            self.nodes.is_none_or(|nodes| (2..=MAX_NODES as usize).contains(&nodes)),
            "GradedYao.nodes",
            self.nodes.unwrap_or_default(),
            "in [2, 200000000]",
        )?;
        let bounds = self.region.bounds();
        ParameterError::unless(
            bounds.is_finite() && bounds.volume() > 1e-30 && bounds.volume() < 1e30,
            "GradedYao.region",
            bounds,
            "a shape whose bounds have a volume from 1e-30 to 1e30 m³",
        )?;
        // A coarse lattice tells how many nodes there will be, and that how fine the lattice should be.
        let few = Samples::new(&self.region, &self.sizing, POINTS[0])?;
        let scale = self.nodes.map(|nodes| few.scale_for(nodes as f32, self.grading, 1.0, 100));
        let nodes = few.nodes(&few.spacing(scale.unwrap_or(1.0), self.grading));
        let points = (nodes * POINTS_A_NODE).clamp(POINTS[0], POINTS[1]);
        let samples =
            if points > POINTS[0] { Samples::new(&self.region, &self.sizing, points)? } else { few };
        let scale = match (self.nodes, scale) {
            (Some(nodes), Some(guess)) => samples.scale_for(nodes as f32, self.grading, guess, 3),
            _ => 1.0,
        };
        let spacing = samples.spacing(scale, self.grading);
        let (nodes, least) = (samples.nodes(&spacing), spacing.extremes().0);
        let fits = nodes <= MAX_NODES
            && nodes * self.sectors as f32 <= MAX_EDGES
            && samples.discs_in_bounds(&spacing) <= MAX_DISCS
            && least > bounds.min.abs().max(bounds.max.abs()).max_element() * 1e-6
            && least * 1e6 >= bounds.size().max_element();
        ParameterError::unless(
            fits,
            "GradedYao.sizing",
            format_args!("{least} m at least, for {nodes} nodes"),
            "coarse enough for at most 200000000 nodes, 4000000000 edges and 3e9 discs in the region's bounds, and \
             above a millionth of their coordinates",
        )?;
        Ok(spacing)
    }
}

impl<S: Shape, F: SizingField> GraphBuilder for GradedYao<S, F> {
    fn build(&self, seed: u64, observer: &dyn Observer) -> Result<Graph, GraphError> {
        self.check()?;
        let spacing = self.spacing()?;
        let planted = self.planted(&spacing, seed)?;
        let roots = self.all_roots();
        let fixed = if planted.positions.is_empty() { &roots } else { &planted.positions };
        let positions = Octree::new(&self.region, &spacing).nodes(fixed, seed, observer)?;
        let reach = reach_of(self.sectors, false);
        let reaches: Vec<f32> = positions.iter().map(|&position| reach * spacing.at(position)).collect();
        let near = yao(&positions, &Sectors::new(self.sectors, false), Reach::Each(&reaches), observer)?;
        if !planted.positions.is_empty() {
            return with_trees(positions, &near, &planted);
        }
        let graph = Graph::from_parts(positions, near.starts, near.targets, 0);
        graph.with_roots((0..roots.len() as u32).collect())
    }

    fn check(&self) -> Result<(), ParameterError> {
        Sectors::check("GradedYao.sectors", self.sectors)?;
        self.leaders.iter().try_for_each(Leader::check)?;
        let roots = self.all_roots();
        check_roots(&roots, "GradedYao")?;
        let spacing = self.spacing()?;
        check_apart(&roots, "GradedYao.roots", |root| spacing.at(root))?;
        roots.iter().try_for_each(|&root| {
            ParameterError::unless(
                self.region.contains(root),
                "GradedYao.root",
                root,
                "a point of the region",
            )
        })
    }
}
