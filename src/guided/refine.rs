//! A stage on a finer graph, which exists only around the tree so far.
//!
//! Section 4 of the paper calls the memory of one fine graph "likely the largest limitation" and section 5 wants "a
//! hierarchical or variable-resolution graph". Here memory grows with the tree, not with the space.

use super::graph::{Carried, Graph, GraphError, Sectors, around_tree};
use super::search::Search;
use crate::observer::Observer;
use crate::parameter::ParameterError;
use crate::random::{Purpose, derive};
use crate::shape::{Bounds, Shape};
use crate::skeleton::Skeleton;
use glam::{IVec3, Vec3};
use std::sync::Arc;

/// Has a stage run on a finer graph of its own, and the stages after it too, until one refines again.
///
/// The tree so far is relaxed a little, carried over along a smooth curve (Catmull-Rom) and divided anew at the finer
/// spacing: its nodes are fixed nodes of the new graph and its internodes edges. Around it, within a reach of some
/// hops and inside a region, new nodes are placed as in [`PoissonYao`](super::PoissonYao), linked to the nearest
/// node in each octant within three spacings; in the plane z = 0 if all nodes of the graph before lie in it. Policies and rules see the same traits as ever; lengths of hops
/// shrink with the spacing.
///
/// Memory: about 100 bytes per node of the new graph. Time: as for a graph and a search of that many nodes.
///
/// ```
/// use treesynth::glam::Vec3;
/// use treesynth::guided::{Bend, HopSurface, NearestTo, PoissonYao, Refinement, Stage, TreeSynth};
/// use treesynth::shape::Cuboid;
///
/// let region = Cuboid::new(Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 5.0, 2.0));
/// let twigs = Stage::new(Bend::piecewise(0.5, 0.0, 1), HopSurface::new(4, 100));
/// let tree = TreeSynth::new(PoissonYao::new(region).with_spacing(0.3))
///     .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 3.0)))
///     .stage(twigs.with_refinement(Refinement::new(region, 0.15)))
///     .synthesize(1)?;
/// assert!(tree.tips().count() > 50);
/// # Ok::<(), treesynth::SynthesisError>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Refinement<S> {
    region: S,
    spacing: f32,
    reach: u32,
    relaxation: Option<u32>,
}

impl<S> Refinement<S> {
    /// All but the region, to be printed.
    pub(super) fn numbers(&self) -> Refinement<()> {
        let Self { spacing, reach, relaxation, .. } = *self;
        Refinement { region: (), spacing, reach, relaxation }
    }
}

crate::recipe::readable!(@[S] Refinement<S> { reach: u32, relaxation: Option<u32> });

crate::recipe::mapped!(Refinement { region; spacing, reach, relaxation });

/// Metres of way a hop makes good, in spacings; edges of the Yao graph are 1.25 spacings long on average.
const HOP: f32 = 1.3;
/// The longest edge of the finer graph, in spacings: no edge leaps from one limb's surroundings to another's.
const LONGEST: f32 = 3.0;
/// Usual number of the tree's nodes in a cube as wide as the spacing, at most; and the number of
/// pairs beyond it that takes half a minute.
const CROWD: u64 = 64;
const MAX_PAIRS: u64 = 200_000_000;
/// Voxels of the reach, in spacings, and the most of them.
const VOXEL: f32 = 2.0;
const MAX_VOXELS: f32 = 2e9;
/// The most parts of a tree and nodes around it.
const MAX_PARTS: f32 = 2e7;
const MAX_NODES: f32 = 2e8;
/// Passes of relaxation for a tree of earlier stages.
const RELAXATION: u32 = 2;
/// Nodes in a cube of the spacing.
const DENSITY: f32 = 0.67;

impl<S: Shape> Refinement<S> {
    /// A graph of nodes `spacing` metres apart, in what of `region` lies within 6 hops of the tree; the tree's kinks
    /// relaxed in two passes. The region holds the root. Half the spacing of the graph before is a good step; a
    /// wider one than before is allowed and makes the graph coarser. At most 2e7 parts of the tree and 2e8 nodes.
    pub fn new(region: S, spacing: f32) -> Self {
        Self { region, spacing, reach: 6, relaxation: None }
    }

    /// The reach in hops of the finer graph, in [1, 24]: those of the stage's endpoint surface and a margin of two
    /// or so, for paths to bend in.
    pub fn with_reach(mut self, hops: u32) -> Self {
        self.reach = hops;
        self
    }

    /// Passes of [`Skeleton::relaxed`](crate::Skeleton::relaxed), half way each, at most 1000. 2 for the tree of
    /// earlier stages; none for a tree that is given to [`AroundTree`](super::AroundTree), whose nodes stay.
    pub fn with_relaxation(mut self, passes: u32) -> Self {
        self.relaxation = Some(passes);
        self
    }

    /// The same with any region, whatever its type.
    pub(super) fn shared(self) -> Refinement<Arc<dyn Shape>>
    where
        S: 'static,
    {
        self.map(|region| Arc::new(region) as Arc<dyn Shape>)
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        self.region.check()?;
        let fits = self.spacing > 0.0 && self.spacing.is_finite();
        ParameterError::unless(fits, "Refinement.spacing", self.spacing, "finite and above 0 m")?;
        ParameterError::unless(
            (1..=24).contains(&self.reach),
            "Refinement.reach",
            self.reach,
            "in [1, 24] hops",
        )?;
        let passes = self.relaxation.unwrap_or(RELAXATION);
        ParameterError::unless(passes <= 1000, "Refinement.relaxation", passes, "at most 1000 passes")
    }

    /// Puts the trees of `search` on a finer graph. Returns the new node of each place of the old trees.
    pub(super) fn apply(
        &self,
        search: &mut Search<'_>,
        stage: usize,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<Vec<u32>, GraphError> {
        let vectors: Vec<Vec3> = search.source_vectors();
        let passes = self.relaxation.unwrap_or(RELAXATION);
        let (mut carried, mut places) = (Carried::default(), vec![0; vectors.len()]);
        for (tree, old) in search.skeletons().map_err(other)? {
            let tree = tree.relaxed(0.5, passes).map_err(other)?;
            self.check_length(&tree)?;
            let vectors: Vec<Vec3> = old.iter().map(|&place| vectors[place]).collect();
            let first = carried.places.len();
            carried.add_tree(&tree, &vectors, self.spacing);
            for (old, &new) in old.into_iter().zip(&carried.places[first..]) {
                places[old] = new;
            }
        }
        let seed = derive(seed, stage as u32, Purpose::NODES);
        // A tree in the plane stays in it.
        let planar = search.graph().positions().iter().all(|position| position.z == 0.0);
        let graph = self.surround(&carried, planar, seed, observer)?;
        search.adopt(graph, &carried.tree);
        Ok(places)
    }

    /// A tree of another method's, divided anew.
    pub(super) fn carry(&self, tree: &Skeleton) -> Result<Carried, GraphError> {
        let relaxed = tree.relaxed(0.5, self.relaxation.unwrap_or(0)).map_err(other)?;
        self.check_length(&relaxed)?;
        let mut carried = Carried::default();
        carried.add_skeleton(&relaxed, self.spacing);
        Ok(carried)
    }

    fn check_length(&self, tree: &Skeleton) -> Result<(), ParameterError> {
        let length: f32 = tree.edges().map(|(a, b)| tree.positions()[a].distance(tree.positions()[b])).sum();
        ParameterError::unless(
            length / self.spacing <= MAX_PARTS,
            "Refinement.spacing",
            self.spacing,
            "coarse enough to divide the tree into at most 20000000 parts",
        )
    }

    /// Refuses trees where thousands of branches meet: each node there has thousands of
    /// neighbours, and edges would take minutes. O(n log n).
    fn check_crowds(&self, nodes: &[Vec3]) -> Result<(), ParameterError> {
        let low = Bounds::of(nodes.iter().copied()).min;
        let key = |node: &Vec3| {
            let [x, y, z] = ((node - low) / self.spacing).to_array().map(|cell| cell as u64 & 0x1f_ffff);
            x | y << 21 | z << 42
        };
        let mut cells: Vec<u64> = nodes.iter().map(key).collect();
        cells.sort_unstable();
        let pairs = |cell: &[u64]| cell.len() as u64 * (cell.len() as u64).saturating_sub(CROWD);
        let pairs: u64 = cells.chunk_by(|a, b| a == b).map(pairs).sum();
        ParameterError::unless(
            pairs <= MAX_PAIRS,
            "Refinement.spacing",
            self.spacing,
            "so fine that no cube of that side holds thousands of the tree's nodes, as where ten thousands of branches meet",
        )
    }

    /// The finer graph around trees that have been divided.
    pub(super) fn surround(
        &self,
        carried: &Carried,
        planar: bool,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<Graph, GraphError> {
        for root in carried.roots() {
            ParameterError::unless(
                self.region.contains(root),
                "Refinement.region",
                self.region.bounds(),
                "a shape that holds the root of each tree",
            )?;
        }
        let reach = Reach::new(
            &self.region,
            &carried.positions,
            self.spacing,
            self.reach as f32 * HOP * self.spacing,
        )?;
        ParameterError::unless(
            reach.volume() * DENSITY <= MAX_NODES * self.spacing * self.spacing * self.spacing,
            "Refinement.spacing",
            self.spacing,
            "coarse enough for at most 200000000 nodes within reach of the tree",
        )?;
        self.check_crowds(&carried.positions)?;
        let (sectors, longest) = (Sectors::new(8, planar), LONGEST * self.spacing);
        around_tree(&reach, carried, self.spacing, longest, &sectors, seed, observer)
    }
}

fn other(error: impl std::fmt::Display) -> GraphError {
    GraphError::Other(error.to_string())
}

/// Part of a region that lies near some nodes, to the precision of voxels.
struct Reach<'a> {
    region: &'a dyn Shape,
    origin: Vec3,
    side: f32,
    dims: IVec3,
    /// One bit per voxel.
    voxels: Vec<u64>,
    count: usize,
}

impl<'a> Reach<'a> {
    fn new(
        region: &'a dyn Shape,
        nodes: &[Vec3],
        spacing: f32,
        distance: f32,
    ) -> Result<Self, ParameterError> {
        let side = VOXEL * spacing;
        let bounds = Bounds::of(nodes.iter().copied()).grown(distance + side);
        let cells = (bounds.size() / side).ceil() + Vec3::ONE;
        ParameterError::unless(
            cells.element_product() <= MAX_VOXELS && cells.max_element() <= 1e5,
            "Refinement.spacing",
            spacing,
            "coarse enough for at most 16 billion discs in the box around the tree",
        )?;
        let dims = cells.as_ivec3();
        let mut reach = Self {
            region,
            origin: bounds.min,
            side,
            dims,
            voxels: vec![0; (cells.element_product() as usize).div_ceil(64) + 1],
            count: 0,
        };
        let around = (distance / side).ceil() as i32;
        let offsets: Vec<IVec3> = cube(-IVec3::splat(around), IVec3::splat(around))
            .filter(|offset| offset.as_vec3().length() * side <= distance)
            .collect();
        for &node in nodes {
            let center = reach.voxel(node);
            for &offset in &offsets {
                reach.mark(center + offset);
            }
        }
        Ok(reach)
    }

    fn voxel(&self, point: Vec3) -> IVec3 {
        ((point - self.origin) / self.side).floor().as_ivec3()
    }

    fn index(&self, voxel: IVec3) -> Option<usize> {
        let inside = voxel.cmpge(IVec3::ZERO).all() && voxel.cmplt(self.dims).all();
        inside.then(|| {
            let [x, y, z] = voxel.to_array().map(|i| i as usize);
            (z * self.dims.y as usize + y) * self.dims.x as usize + x
        })
    }

    fn mark(&mut self, voxel: IVec3) {
        if let Some(index) = self.index(voxel) {
            let bit = 1 << (index % 64);
            self.count += usize::from(self.voxels[index / 64] & bit == 0);
            self.voxels[index / 64] |= bit;
        }
    }

    fn holds(&self, voxel: IVec3) -> bool {
        self.index(voxel).is_some_and(|index| self.voxels[index / 64] >> (index % 64) & 1 == 1)
    }
}

impl Shape for Reach<'_> {
    fn contains(&self, point: Vec3) -> bool {
        self.holds(self.voxel(point)) && self.region.contains(point)
    }

    fn bounds(&self) -> Bounds {
        Bounds::new(self.origin, self.origin + self.dims.as_vec3() * self.side)
    }

    fn volume(&self) -> f32 {
        self.count as f32 * self.side * self.side * self.side
    }

    fn touches(&self, bounds: Bounds) -> bool {
        let low = self.voxel(bounds.min).max(IVec3::ZERO);
        let high = self.voxel(bounds.max).min(self.dims - 1);
        self.region.touches(bounds) && cube(low, high).any(|voxel| self.holds(voxel))
    }
}

/// All cells from `low` to `high`, both included.
fn cube(low: IVec3, high: IVec3) -> impl Iterator<Item = IVec3> {
    (low.z..=high.z).flat_map(move |z| {
        (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| IVec3::new(x, y, z)))
    })
}
