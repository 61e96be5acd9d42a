//! Early endpoints: in a volume (section 3.2.2).

use super::{Count, EndpointError, EndpointPolicy, StageView, choose_uniform};
use crate::nearest::nearest;
use crate::parameter::ParameterError;
use crate::shape::Shape;
use glam::{DVec3, Vec3};
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use smallvec::SmallVec;

/// A single endpoint, the reachable node nearest to a point: "for this shape, we dedicate the first iteration to
/// the trunk, with a single endpoint".
#[derive(Debug, Clone, Copy, PartialEq)]
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
pub struct InShape<S> {
    shape: S,
    count: Count,
    spread: bool,
}

impl<S: Shape> InShape<S> {
    /// Endpoints as far apart as `count` of them can be: Poisson-disc, the radius found by bisection.
    pub fn poisson_disc(shape: S, count: impl Into<Count>) -> Self {
        Self { shape, count: count.into(), spread: true }
    }

    /// Endpoints drawn independently, all nodes equally likely.
    pub fn uniform(shape: S, count: impl Into<Count>) -> Self {
        Self { shape, count: count.into(), spread: false }
    }
}

impl<S: Shape> EndpointPolicy for InShape<S> {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        let candidates = view.candidates(|_, position| self.shape.contains(position));
        let count = self.count.of(candidates.len(), "off the tree, in the shape and reachable")?;
        Ok(if self.spread {
            choose_spread(candidates, count, view.graph().positions(), &mut view.stream())
        } else {
            choose_uniform(candidates, count, view)
        })
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.count.check("InShape.count")?;
        self.shape.check()
    }
}

/// Darts in random order, each kept if no kept one is within a radius; the largest radius that lets `count` be
/// kept, to a part in a thousand.
fn choose_spread(
    mut candidates: Vec<u32>,
    count: usize,
    positions: &[Vec3],
    random: &mut ChaCha8Rng,
) -> Vec<u32> {
    candidates.shuffle(random);
    let at = |node: u32| positions[node as usize];
    let (min, max) = candidates.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), &node| {
        (min.min(at(node)), max.max(at(node)))
    });
    let mut best: Vec<u32> = candidates[..count].to_vec();
    let (mut feasible, mut too_far) = (0.0f32, (max - min).length() * 1.01);
    while too_far - feasible > 1e-3 * too_far {
        let radius = (feasible + too_far) * 0.5;
        match darts(&candidates, count, radius, (min, max), at) {
            Some(kept) => (feasible, best) = (radius, kept),
            None => too_far = radius,
        }
        if too_far < 1e-6 * (max - min).length() {
            break; // All candidates are wanted.
        }
    }
    best
}

/// The first `count` candidates that are `radius` apart from all before them, if there are so many.
fn darts(
    candidates: &[u32],
    count: usize,
    radius: f32,
    (min, max): (Vec3, Vec3),
    at: impl Fn(u32) -> Vec3,
) -> Option<Vec<u32>> {
    // At least the radius, so that only adjacent cells matter, and not many more cells than endpoints.
    let size = max - min;
    let side = radius.max(size.max_element() / (2.0 * crate::math::cbrt(count as f32)).max(1.0));
    let dims = ((size / side).floor() + Vec3::ONE).as_ivec3();
    let cell_of = |p: Vec3| ((p - min) / side).floor().as_ivec3().min(dims - 1);
    let index = |c: glam::IVec3| ((c.z * dims.y + c.y) * dims.x + c.x) as usize;
    let mut cells: Vec<SmallVec<[u32; 2]>> = vec![SmallVec::new(); dims.element_product() as usize];
    let mut kept = Vec::with_capacity(count);
    for &node in candidates {
        let (position, cell) = (at(node), cell_of(at(node)));
        let (low, high) = ((cell - 1).max(glam::IVec3::ZERO), (cell + 1).min(dims - 1));
        let crowded = (low.z..=high.z).any(|z| {
            (low.y..=high.y).any(|y| {
                (low.x..=high.x).any(|x| {
                    let near = |&other: &u32| at(other).distance_squared(position) < radius * radius;
                    cells[index(glam::IVec3::new(x, y, z))].iter().any(near)
                })
            })
        });
        if !crowded {
            kept.push(node);
            if kept.len() == count {
                return Some(kept);
            }
            cells[index(cell)].push(node);
        }
    }
    None
}
