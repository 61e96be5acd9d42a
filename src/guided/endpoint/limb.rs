//! Endpoints along each branch.

use super::surface::Surface;
use super::{EndpointError, EndpointPolicy, Side, StageView};
use crate::parameter::ParameterError;
use crate::random::{Purpose, derive};

/// Endpoints allotted branch by branch: each branch bears one every few metres (the spacing), so
/// that every branch is clothed, the inner and the thin ones too.
///
/// Candidates are the nodes k hops from the tree, as in [`HopSurface`](super::HopSurface); each
/// belongs to the branch where its least-cost path leaves the tree. Each branch is divided into
/// equal parts, and in each part one candidate is drawn.
///
/// O(n log n).
///
/// ```
/// use treesynth::glam::Vec3;
/// use treesynth::guided::{Bend, InShape, LimbSurface, NearestTo, PoissonYao, Stage, TreeSynth};
/// use treesynth::shape::{Cuboid, Ellipsoid};
///
/// let region = Cuboid::new(Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 6.0, 3.0));
/// let crown = Ellipsoid::new(Vec3::Y * 3.8, Vec3::new(1.8, 1.8, 1.8));
/// let tree = TreeSynth::new(PoissonYao::new(region).with_nodes(20_000))
///     .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 4.5)))
///     .stage(Stage::new(Bend::piecewise(1.0, 0.0, 1), InShape::poisson_disc(crown, 20)))
///     .stage(Stage::new(Bend::piecewise(0.7, 0.0, 1), LimbSurface::new(2, 0.3)))
///     .synthesize(7)?;
/// // Nearly every limb bears twigs: where no free node is near, none can.
/// let children = tree.children();
/// let bears = |limb: &treesynth::skeleton::Branch<'_>| {
///     limb.nodes()[1..].iter().any(|&node| children.of(node as usize).len() > 1)
/// };
/// let branches = tree.branches();
/// let limbs: Vec<_> = branches.iter().filter(|limb| limb.order() == 1).collect();
/// assert!(limbs.iter().filter(|limb| bears(limb)).count() * 2 > limbs.len());
/// # Ok::<(), treesynth::SynthesisError>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct LimbSurface {
    surface: Surface,
    spacing: f32,
    bare_base: f32,
    least_order: u16,
}

crate::recipe::readable!(in surface: LimbSurface { hop_length: Option<f32>, outermost: f32 });

crate::recipe::readable!(LimbSurface { bare_base: f32, least_order: u16 });

impl LimbSurface {
    /// One endpoint, `hops` edges off the tree, for every `spacing` metres of each branch, the trunk included; at least
    /// one per branch where there are candidates. Finite and above 0.
    pub fn new(hops: u32, spacing: f32) -> Self {
        Self { surface: Surface::new(hops, 1.0), spacing, bare_base: 0.0, least_order: 0 }
    }

    /// The share of each branch's length, from its base, that bears nothing, in [0, 1).
    pub fn with_bare_base(mut self, share: f32) -> Self {
        self.bare_base = share;
        self
    }

    /// Only branches of this order (0 is the trunk) and higher ones bear endpoints; 0 by default.
    pub fn with_least_order(mut self, order: u16) -> Self {
        self.least_order = order;
        self
    }

    /// Hops by metres of path; see [`HopSurface::with_hop_length`](super::HopSurface::with_hop_length).
    pub fn with_hop_length(mut self, metres: f32) -> Self {
        self.surface.hop_length = Some(metres);
        self
    }

    /// The outermost fraction of the surface alone; see [`HopSurface::with_outermost`](super::HopSurface::with_outermost). All of it by default.
    pub fn with_outermost(mut self, fraction: f32) -> Self {
        self.surface.outermost = fraction;
        self
    }

    /// Only endpoints lower, or only endpoints higher, than the source their path starts from.
    pub fn only(mut self, side: Side) -> Self {
        self.surface.side = Some(side);
        self
    }
}

impl EndpointPolicy for LimbSurface {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        let search = view.search();
        let key = derive(view.seed(), view.stage() as u32, Purpose::ENDPOINTS);
        let mut candidates: Vec<(u32, u32, u32, u64, u32)> = Vec::new();
        for node in self.surface.candidates(view) {
            let Some(fork) = search.source(node).and_then(|source| search.fork(source)) else { continue };
            let length = fork.from_base + fork.to_tip;
            let bare = length * self.bare_base;
            if fork.from_base < bare || fork.order < self.least_order {
                continue;
            }
            let parts = ((length - bare) / self.spacing).round().max(1.0);
            let share = if length > bare { (fork.from_base - bare) / (length - bare) } else { 0.0 };
            let part = (share * parts).min(parts - 1.0) as u32;
            candidates.push((fork.tree, fork.branch, part, derive(key, node, Purpose::ENDPOINTS), node));
        }
        candidates.sort_unstable();
        candidates.dedup_by_key(|&mut (tree, branch, part, ..)| (tree, branch, part));
        if candidates.is_empty() {
            let place =
                "on the surface that LimbSurface.hops, outermost, bare_base, least_order and only leave";
            return Err(EndpointError::TooFew { wanted: 1, available: 0, place });
        }
        Ok(candidates.into_iter().map(|(.., node)| node).collect())
    }

    fn needs_search(&self) -> bool {
        true
    }

    fn check(&self) -> Result<(), ParameterError> {
        let fits = self.spacing > 0.0 && self.spacing.is_finite();
        ParameterError::unless(fits, "LimbSurface.spacing", self.spacing, "finite and above 0 m")?;
        ParameterError::unless(
            (0.0..1.0).contains(&self.bare_base),
            "LimbSurface.bare_base",
            self.bare_base,
            "a share in [0, 1)",
        )?;
        self.surface.check()
    }
}
