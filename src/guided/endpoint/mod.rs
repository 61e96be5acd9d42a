//! Policies that choose the nodes to which branches grow (sections 3.2.2 to 3.2.4).

mod each_root;
mod limb;
mod surface;
mod volume;

pub use each_root::{AboveEachRoot, AroundEachRoot};
pub use limb::LimbSurface;
pub use surface::{HopSurface, Side};
pub use volume::{InShape, NearestTo, NearestToEach};

use super::graph::Graph;
use super::search::Search;
use crate::parameter::ParameterError;
use crate::random::{Purpose, derive, stream};
use glam::Vec3;
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// Chooses the endpoints of a stage: the paths to them become branches.
///
/// # Contract
/// - Endpoints are nodes of the graph; any other ends the synthesis with [`SearchError::UnknownEndpoint`]. One that
///   no path leads to ends it with [`SearchError::Unreachable`]; [`StageView::is_reachable`] tells them apart.
///   One that is named twice or is on the tree already is allowed and adds nothing.
/// - A policy that looks at costs, paths or sources says so in [`needs_search`](Self::needs_search). If it
///   does not, it is asked before the search, and sees none.
/// - The same view gives the same endpoints: randomness comes from [`StageView::stream`].
///
/// [`SearchError::UnknownEndpoint`]: super::SearchError::UnknownEndpoint
/// [`SearchError::Unreachable`]: super::SearchError::Unreachable
///
/// ```
/// use treesynth::{EndpointPolicy, guided::{EndpointError, StageView}};
///
/// /// Every node that costs at most so much to reach.
/// struct Affordable { cost: f32 }
///
/// impl EndpointPolicy for Affordable {
///     fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
///         let affordable = |&node: &u32| view.search().cost(node).is_some_and(|cost| cost <= self.cost);
///         Ok((0..view.graph().nodes() as u32).filter(affordable).collect())
///     }
///     fn needs_search(&self) -> bool {
///         true
///     }
/// }
/// ```
pub trait EndpointPolicy: Send + Sync {
    /// The endpoints of the stage.
    ///
    /// # Errors
    /// When there are not enough candidates, or for a reason of your own.
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError>;

    /// `true` if the choice depends on the stage's search. If false, the search stops once all
    /// endpoints are settled, which is faster and finds the same paths.
    fn needs_search(&self) -> bool {
        false
    }

    /// Checks that the options are in range; called once, before synthesis starts.
    ///
    /// # Errors
    /// The first option that is not.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

macro_rules! forward {
    ($($pointer:ty),*) => {$(
        impl<T: EndpointPolicy + ?Sized> EndpointPolicy for $pointer {
            fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
                (**self).select(view)
            }
            fn needs_search(&self) -> bool {
                (**self).needs_search()
            }
            fn check(&self) -> Result<(), ParameterError> {
                (**self).check()
            }
        }
    )*};
}
forward!(&T, Box<T>, Arc<T>);

/// Error of choosing endpoints.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EndpointError {
    /// Fewer candidates than endpoints wanted.
    #[error("{wanted} endpoints are wanted, but only {available} candidate nodes are {place}")]
    TooFew {
        /// Number wanted.
        wanted: usize,
        /// Number present.
        available: usize,
        /// Description of the candidates, e.g. "off the tree, in the shape and reachable".
        place: &'static str,
    },
    /// For policies outside of this crate: anything else.
    #[error("{0}")]
    Other(String),
}

/// Number of endpoints (section 3.2.4).
///
/// ```
/// use treesynth::guided::{Count, HopSurface};
///
/// // On a coarse graph there may be fewer candidates than 5,000.
/// let endpoints = HopSurface::new(2, Count::UpTo(5_000));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum Count {
    /// Exactly this number; an error if there are fewer candidates.
    Exactly(usize),
    /// This number, or all candidates if they are fewer; at least one.
    UpTo(usize),
    /// This share of the candidates, in (0, 1], rounded up.
    Share(f32),
    /// Each candidate with this probability, in (0, 1], whatever becomes of the others; at least one. About as many as
    /// [`Share`](Self::Share), but after an [edit](super::Regrowth) in one place all choices elsewhere stay. For
    /// endpoints at distances from each other, as of [`InShape::poisson_disc`], the same as `Share`.
    Each(f32),
}

impl From<usize> for Count {
    fn from(count: usize) -> Self {
        Self::Exactly(count)
    }
}

impl Count {
    fn check(self, parameter: &str) -> Result<(), ParameterError> {
        match self {
            Self::Exactly(count) | Self::UpTo(count) => {
                ParameterError::unless(count > 0, parameter, count, "at least 1")
            }
            Self::Share(share) | Self::Each(share) => {
                ParameterError::unless(share > 0.0 && share <= 1.0, parameter, share, "a share in (0, 1]")
            }
        }
    }

    fn of(self, available: usize, place: &'static str) -> Result<usize, EndpointError> {
        let wanted = match self {
            Self::Exactly(count) => count,
            Self::UpTo(count) => count.min(available).max(1),
            Self::Share(share) | Self::Each(share) => ((available as f32 * share).ceil() as usize).max(1),
        };
        if wanted <= available { Ok(wanted) } else { Err(EndpointError::TooFew { wanted, available, place }) }
    }

    /// This count of the candidates, all equally likely: those that draw the lowest numbers,
    /// whatever their order.
    fn choose(
        self,
        mut candidates: Vec<u32>,
        view: &StageView<'_>,
        place: &'static str,
    ) -> Result<Vec<u32>, EndpointError> {
        let mut count = self.of(candidates.len(), place)?;
        if let Self::Each(share) = self {
            let key = draws(view);
            let below = (f64::from(share) * 2.0f64.powi(64)) as u64;
            let first = candidates.iter().copied().min_by_key(|&node| draw(key, node));
            candidates.retain(|&node| Some(node) == first || draw(key, node).0 <= below);
            count = candidates.len();
        }
        Ok(choose_uniform(candidates, count, view))
    }
}

/// View that a policy has: the graph, the tree so far, and the search if there was one.
#[derive(Debug, Clone, Copy)]
pub struct StageView<'a> {
    pub(super) search: &'a Search<'a>,
    pub(super) stage: usize,
    pub(super) seed: u64,
}

impl<'a> StageView<'a> {
    /// View that a policy would have now, to try one with.
    pub fn new(search: &'a Search<'a>, stage: usize, seed: u64) -> Self {
        Self { search, stage, seed }
    }

    /// The tree so far, and this stage's costs and paths if the policy [needs](EndpointPolicy::needs_search) them.
    pub fn search(&self) -> &'a Search<'a> {
        self.search
    }

    /// The graph.
    pub fn graph(&self) -> &'a Graph {
        self.search.graph()
    }

    /// The stage, from 0.
    pub fn stage(&self) -> usize {
        self.stage
    }

    /// The seed of the tree.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The random stream of this stage's endpoints.
    pub fn stream(&self) -> ChaCha8Rng {
        stream(self.seed, self.stage as u32, Purpose::ENDPOINTS, 0)
    }

    /// `true` if a path leads to `node`: as far as edges go before the search, for certain after it.
    pub fn is_reachable(&self, node: u32) -> bool {
        if self.search.is_complete() {
            self.search.is_settled(node)
        } else {
            self.graph().hops_from_root()[node as usize] != u32::MAX
        }
    }

    /// The reachable nodes off the tree that `filter` lets through, ascending. O(n).
    pub fn candidates(&self, filter: impl Fn(u32, Vec3) -> bool) -> Vec<u32> {
        (0..)
            .zip(self.graph().positions())
            .filter(|&(node, &position)| {
                !self.search.is_on_tree(node) && filter(node, position) && self.is_reachable(node)
            })
            .map(|(node, _)| node)
            .collect()
    }
}

/// `count` of the candidates, all choices equally likely: those that draw the lowest numbers. A node's number is its own,
/// so that with other candidates here the choice elsewhere stays.
fn choose_uniform(candidates: Vec<u32>, count: usize, view: &StageView<'_>) -> Vec<u32> {
    let key = draws(view);
    let mut drawn: Vec<(u64, u32)> = candidates.into_iter().map(|node| draw(key, node)).collect();
    if count < drawn.len() {
        drawn.select_nth_unstable(count);
        drawn.truncate(count);
    }
    drawn.sort_unstable();
    drawn.into_iter().map(|(_, node)| node).collect()
}

/// Key of the numbers that a stage's candidates draw.
fn draws(view: &StageView<'_>) -> u64 {
    derive(view.seed, view.stage as u32, Purpose::ENDPOINTS)
}

/// A candidate's number, and the candidate.
fn draw(key: u64, node: u32) -> (u64, u32) {
    (derive(key, node, Purpose::ENDPOINTS), node)
}
