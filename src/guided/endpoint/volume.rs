//! Early endpoints: in a volume (section 3.2.2).

use super::{Count, EndpointError, EndpointPolicy, StageView, choose_uniform};
use crate::math::{cbrt, powf};
use crate::nearest::nearest;
use crate::parameter::ParameterError;
use crate::shape::{Bounds, Shape};
use glam::{DVec3, IVec3, Vec3};
use smallvec::SmallVec;

/// A single endpoint, the reachable node nearest to a point: "for this shape, we dedicate the first iteration to
/// the trunk, with a single endpoint".
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct NearestTo {
    point: Vec3,
}

impl NearestTo {
    /// The node nearest to `point`, metres.
    pub fn new(point: Vec3) -> Self {
        Self { point }
    }
}

impl EndpointPolicy for NearestTo {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        let off_tree = |node| !view.search().is_on_tree(node) && view.is_reachable(node);
        let nearest = view.graph().nearest_where(self.point, off_tree);
        nearest.map(|node| vec![node]).ok_or(EndpointError::TooFew {
            wanted: 1,
            available: 0,
            place: "off the tree and reachable",
        })
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(self.point.is_finite(), "NearestTo.point", self.point, "finite, in metres")
    }
}

/// For each of some points the reachable node nearest to it: shape nodes of a
/// [`GuidanceShape`](crate::variational::GuidanceShape), places of a scan.
///
/// A node that is nearest to several points counts once, and so may be fewer endpoints than points; the denser the graph,
/// the nearer they are. O((n + m) log n) for m points.
///
/// ```
/// use treesynth::glam::Vec3;
/// use treesynth::guided::{Bend, NearestTo, NearestToEach, PoissonYao, Stage, TreeSynth};
/// use treesynth::shape::{Cuboid, HalfEllipsoid};
/// use treesynth::variational::GuidanceShape;
///
/// let crown = HalfEllipsoid::new(Vec3::Y * 2.0, Vec3::new(2.0, 3.0, 2.0));
/// let shape = GuidanceShape::on_surface(&crown, 150, 1)?;
/// let region = Cuboid::new(Vec3::new(-2.5, 0.0, -2.5), Vec3::new(2.5, 5.5, 2.5));
/// let tree = TreeSynth::new(PoissonYao::new(region).with_nodes(10_000))
///     .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 3.5)))
///     .stage(Stage::new(Bend::constant(0.05), NearestToEach::new(shape.positions())))
///     .synthesize(1)?;
/// assert!(tree.tips().count() > 100);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct NearestToEach {
    points: Vec<Vec3>,
}

impl NearestToEach {
    /// The nodes nearest to `points`, metres; at least one.
    pub fn new(points: impl Into<Vec<Vec3>>) -> Self {
        Self { points: points.into() }
    }
}

impl EndpointPolicy for NearestToEach {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        let candidates = view.candidates(|_, _| true);
        if candidates.is_empty() {
            let (wanted, place) = (self.points.len(), "off the tree and reachable");
            return Err(EndpointError::TooFew { wanted, available: 0, place });
        }
        let places: Vec<DVec3> =
            candidates.iter().map(|&node| view.graph().position(node).as_dvec3()).collect();
        let points: Vec<DVec3> = self.points.iter().map(|point| point.as_dvec3()).collect();
        let mut found: Vec<u32> =
            nearest(&places, &points).into_iter().map(|place| candidates[place as usize]).collect();
        found.sort_unstable();
        found.dedup();
        Ok(found)
    }

    fn check(&self) -> Result<(), ParameterError> {
        let count = self.points.len();
        ParameterError::unless(count > 0, "NearestToEach.points", count, "at least one point")?;
        self.points.iter().enumerate().try_for_each(|(number, point)| {
            let name = format!("NearestToEach.points[{number}]");
            ParameterError::unless(point.is_finite(), &name, point, "finite, in metres")
        })
    }
}

/// Endpoints among the nodes in a shape: "our practice has been to use a Poisson disc distribution within a
/// bounding volume approximating the tree crown".
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct InShape<S> {
    shape: S,
    count: Count,
    /// Else drawn independently.
    poisson_disc: bool,
}

impl<S> InShape<S> {
    /// Shape in which endpoints lie.
    pub fn shape(&self) -> &S {
        &self.shape
    }

    /// Number of endpoints.
    pub fn count(&self) -> Count {
        self.count
    }
}

crate::recipe::mapped!(InShape { shape; count, poisson_disc });

impl<S: Shape> InShape<S> {
    /// Endpoints about as far apart as `count` of them can be: Poisson-disc, the radius found by going through smaller
    /// and smaller ones. If the shape or the tree changes in one place, the choice changes around there.
    pub fn poisson_disc(shape: S, count: impl Into<Count>) -> Self {
        Self { shape, count: count.into(), poisson_disc: true }
    }

    /// Endpoints drawn independently, all nodes equally likely.
    pub fn uniform(shape: S, count: impl Into<Count>) -> Self {
        Self { shape, count: count.into(), poisson_disc: false }
    }
}

impl<S: Shape> EndpointPolicy for InShape<S> {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        let candidates = view.candidates(|_, position| self.shape.contains(position));
        let place = "off the tree, in the shape and reachable";
        if !self.poisson_disc {
            return self.count.choose(candidates, view, place);
        }
        let count = self.count.of(candidates.len(), place)?;
        Ok(choose_spread(candidates, count, view))
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.count.check("InShape.count")?;
        self.shape.check()
    }
}

/// Radii per octave, and octaves each way from 1 m.
const RADII: i32 = 16;
const OCTAVES: i32 = 128;

/// Darts in the order of the numbers that candidates draw, each kept if no kept one is within a radius: of a row of radii,
/// 4.4% apart, the largest that lets `count` be kept, found by bisection.
///
/// Numbers belong to nodes and radii are the same for all trees, so with other candidates here the choice elsewhere
/// mostly stays, but for the last few darts; a radius made to measure would change with every candidate. At the next
/// radius of the row most darts stick where they stuck before. (Darts with smaller and smaller radii, after `McCool` and
/// Fiume 1992, are not stable: the first few hang on each other all over the shape.)
pub(super) fn choose_spread(candidates: Vec<u32>, count: usize, view: &StageView<'_>) -> Vec<u32> {
    let positions = view.graph().positions();
    let at = |node: u32| positions[node as usize];
    let darts = choose_uniform(candidates, usize::MAX, view);
    let bounds = Bounds::of(darts.iter().map(|&node| at(node)));
    let extent = bounds.size().length() * 1.01;
    let mut best = darts[..count].to_vec();
    // From no distance, at which all are kept, to an infinite one.
    let (mut feasible, mut too_far) = (-OCTAVES * RADII, OCTAVES * RADII);
    while too_far - feasible > 1 {
        let middle = i32::midpoint(feasible, too_far);
        let radius = powf(2.0, middle as f32 / RADII as f32);
        // Nothing is farther apart than that, and one is kept at least.
        let kept =
            if radius > extent && count > 1 { Vec::new() } else { throw(&darts, count, radius, bounds, at) };
        if kept.len() == count {
            (feasible, best) = (middle, kept);
        } else {
            too_far = middle;
        }
    }
    best
}

/// The first `count` darts that are a radius apart from all before them; fewer if there are not so many.
fn throw(darts: &[u32], count: usize, radius: f32, bounds: Bounds, at: impl Fn(u32) -> Vec3) -> Vec<u32> {
    let mut discs = Discs::new(bounds, radius, count);
    let free = darts.iter().copied().filter(|&node| {
        let is_free = discs.is_free(at(node));
        if is_free {
            discs.insert(at(node));
        }
        is_free
    });
    free.take(count).collect()
}

/// Places in cells at least a radius wide, so that only adjacent ones matter, and not many more than there are places.
struct Discs {
    bounds: Bounds,
    radius: f32,
    side: f32,
    dims: IVec3,
    cells: Vec<SmallVec<[Vec3; 2]>>,
}

impl Discs {
    fn new(bounds: Bounds, radius: f32, count: usize) -> Self {
        let size = bounds.size();
        let side =
            radius.max(size.max_element() / (2.0 * cbrt(count as f32)).max(1.0)).max(f32::MIN_POSITIVE);
        let dims = ((size / side).floor() + Vec3::ONE).as_ivec3();
        let cells = vec![SmallVec::new(); dims.element_product() as usize];
        Self { bounds, radius, side, dims, cells }
    }

    fn cell_of(&self, place: Vec3) -> IVec3 {
        ((place - self.bounds.min) / self.side).floor().as_ivec3().min(self.dims - 1)
    }

    fn cell(&self, cell: IVec3) -> usize {
        ((cell.z * self.dims.y + cell.y) * self.dims.x + cell.x) as usize
    }

    fn insert(&mut self, place: Vec3) {
        let cell = self.cell(self.cell_of(place));
        self.cells[cell].push(place);
    }

    /// `true` if no place lies within the radius.
    fn is_free(&self, place: Vec3) -> bool {
        let cell = self.cell_of(place);
        let (low, high) = ((cell - 1).max(IVec3::ZERO), (cell + 1).min(self.dims - 1));
        let near = |other: &Vec3| other.distance_squared(place) < self.radius * self.radius;
        (low.z..=high.z).all(|z| {
            (low.y..=high.y).all(|y| {
                let row = self.cell(IVec3::new(low.x, y, z))..=self.cell(IVec3::new(high.x, y, z));
                self.cells[row].iter().all(|cell| !cell.iter().any(near))
            })
        })
    }
}
