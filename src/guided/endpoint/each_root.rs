//! Endpoints for several trees in one graph: the same for each root.

use super::volume::choose_spread;
use super::{Count, EndpointError, EndpointPolicy, StageView};
use crate::nearest::nearest;
use crate::parameter::ParameterError;
use crate::shape::Shape;
use glam::{DVec3, Vec3};

/// A trunk's top above each root: the reachable node nearest to the point at this height above it,
/// in metres.
///
/// Straighter trunks, which stand from the beginning: [`PoissonYao::with_leader`](crate::guided::PoissonYao::with_leader).
/// A node that is nearest for two roots counts once. O((n + m) log n) for m roots.
///
/// ```
/// use treesynth::glam::Vec3;
/// use treesynth::guided::{AboveEachRoot, AroundEachRoot, Bend, PoissonYao, Stage, TreeSynth};
/// use treesynth::shape::{Cuboid, Sphere};
///
/// let region = Cuboid::new(Vec3::new(-4.0, 0.0, -2.0), Vec3::new(4.0, 5.0, 2.0));
/// let crown = Sphere::new(Vec3::Y * 3.0, 1.5);
/// let trees = TreeSynth::new(PoissonYao::new(region).with_nodes(10_000).with_roots([-2.0, 2.0].map(|x| Vec3::X * x)))
///     .stage(Stage::new(Bend::none(), AboveEachRoot::new(3.0)))
///     .stage(Stage::new(Bend::piecewise(1.0, 0.0, 1), AroundEachRoot::new(crown, 30)))
///     .synthesize_all(1)?;
/// assert!(trees.iter().all(|tree| tree.tips().count() > 20));
/// # Ok::<(), treesynth::SynthesisError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct AboveEachRoot {
    height: f32,
}

impl AboveEachRoot {
    /// Height above each root, metres, finite and above 0.
    pub fn new(height: f32) -> Self {
        Self { height }
    }
}

impl EndpointPolicy for AboveEachRoot {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        let candidates = view.candidates(|_, _| true);
        let graph = view.graph();
        if candidates.is_empty() {
            let wanted = graph.roots().len();
            return Err(EndpointError::TooFew { wanted, available: 0, place: "off the tree and reachable" });
        }
        let places: Vec<DVec3> = candidates.iter().map(|&node| graph.position(node).as_dvec3()).collect();
        let top = |&root: &u32| (graph.position(root) + Vec3::Y * self.height).as_dvec3();
        let tops: Vec<DVec3> = graph.roots().iter().map(top).collect();
        let mut found: Vec<u32> =
            nearest(&places, &tops).into_iter().map(|place| candidates[place as usize]).collect();
        found.sort_unstable();
        found.dedup();
        Ok(found)
    }

    fn check(&self) -> Result<(), ParameterError> {
        let fits = self.height > 0.0 && self.height.is_finite();
        ParameterError::unless(fits, "AboveEachRoot.height", self.height, "finite and above 0 m")
    }
}

/// Endpoints in a crown of each root's own: a shape that is moved to the root, its places Poisson-disc.
///
/// Endpoints in the crowns of several roots belong to the nearest root, so neighbours share the
/// room between them. The search decides which tree reaches an endpoint: the one whose path costs
/// least. O(n m) for m roots.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct AroundEachRoot<S> {
    shape: S,
    count: Count,
}

crate::recipe::mapped!(AroundEachRoot { shape; count });

impl<S: Shape> AroundEachRoot<S> {
    /// `count` endpoints for each root, in `shape`, which is given as for a root at the origin.
    pub fn new(shape: S, count: impl Into<Count>) -> Self {
        Self { shape, count: count.into() }
    }
}

impl<S: Shape> EndpointPolicy for AroundEachRoot<S> {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        let graph = view.graph();
        let roots: Vec<Vec3> = graph.roots().iter().map(|&root| graph.position(root)).collect();
        let bounds = self.shape.bounds();
        let owner = |place: Vec3| {
            let mut best = (f32::INFINITY, None);
            for (number, &root) in roots.iter().enumerate() {
                let away = root.distance_squared(place);
                if away < best.0 && bounds.contains(place - root) && self.shape.contains(place - root) {
                    best = (away, Some(number));
                }
            }
            best.1
        };
        let mut own: Vec<Vec<u32>> = vec![Vec::new(); roots.len()];
        for node in view.candidates(|_, _| true) {
            if let Some(owner) = owner(graph.position(node)) {
                own[owner].push(node);
            }
        }
        let mut endpoints = Vec::new();
        for candidates in own {
            let count = self.count.of(candidates.len(), "off the tree, in a root's shape and reachable")?;
            endpoints.extend(choose_spread(candidates, count, view));
        }
        Ok(endpoints)
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.count.check("AroundEachRoot.count")?;
        self.shape.check()
    }
}
