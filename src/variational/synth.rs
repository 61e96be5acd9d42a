//! The options of the optimization.

use std::sync::Arc;

use glam::Vec3;

use super::guidance::GuidanceShape;
use super::level::Level;
use crate::ParameterError;
use crate::radius::RadiusModel;

/// Grows the tree that fills a [`GuidanceShape`] at the least cost.
///
/// The cost is `F = F_I + λF_E + μF_P` (equation 4), all in the unit of `F_I`, metres to the power of 1 + β:
/// λ, given as a plain number, is multiplied by D^β, where D is the diameter of the trunk base by equation 2,
/// and [`F_P`](super::penalty) counts in wood. A tree twice as large therefore has the same form.
///
/// Cost: O(n log n) per round, see [`with_rounds`](Self::with_rounds); 100,000 shape nodes take less than 300
/// MB.
///
/// ```
/// use treesynth::{glam::Vec3, shape::HalfEllipsoid};
/// use treesynth::variational::{GuidanceShape, Level, VariationalSynth};
///
/// let crown = HalfEllipsoid::new(Vec3::Y * 3.0, Vec3::new(3.0, 5.0, 3.0));
/// let shape = GuidanceShape::in_volume(&crown, 400, 1)?;
/// let levels = [Level::default().with_apical_control(1.0), Level::default()];
/// let tree = VariationalSynth::new(shape).with_levels(levels).synthesize(1)?;
/// assert_eq!(tree.tips().count(), 400, "each shape node is a tip");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Clone)]
pub struct VariationalSynth {
    pub(super) shape: GuidanceShape,
    pub(super) root: Vec3,
    pub(super) levels: Vec<Level>,
    pub(super) alpha: f32,
    pub(super) beta: f32,
    pub(super) lambda: f32,
    pub(super) mu: f32,
    pub(super) outside: f32,
    pub(super) rounds: u32,
    pub(super) least_cluster: usize,
    pub(super) prune_order: u32,
    pub(super) refinements: u32,
    pub(super) radius: Option<Arc<dyn RadiusModel>>,
}

impl VariationalSynth {
    /// α and β, from [`with_exponents`](Self::with_exponents).
    pub fn exponents(&self) -> (f32, f32) {
        (self.alpha, self.beta)
    }

    /// λ and μ, from [`with_weights`](Self::with_weights).
    pub fn weights(&self) -> (f32, f32) {
        (self.lambda, self.mu)
    }

    /// The price of wood outside of the shape; set by [`with_outside_price`](Self::with_outside_price).
    pub fn outside_price(&self) -> f32 {
        self.outside
    }

    /// The order that [`with_refinements`](Self::with_refinements) sets.
    pub fn prune_order(&self) -> u32 {
        self.prune_order
    }

    /// The radius model; set by [`with_radius`](Self::with_radius).
    pub fn radius(&self) -> Option<&dyn RadiusModel> {
        self.radius.as_deref()
    }
}

crate::recipe::readable!(VariationalSynth {
    root: Vec3,
    rounds: u32,
    least_cluster: usize,
    refinements: u32,
});

impl std::fmt::Debug for VariationalSynth {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("VariationalSynth")
            .field("shape_nodes", &self.shape.len())
            .field("root", &self.root)
            .field("levels", &self.levels)
            .finish_non_exhaustive()
    }
}

impl VariationalSynth {
    /// A tree in `shape`, its root at the origin, of three default [`Level`]s.
    pub fn new(shape: GuidanceShape) -> Self {
        Self {
            shape,
            root: Vec3::ZERO,
            levels: vec![Level::default(); 3],
            alpha: 2.5,
            beta: 2.0,
            lambda: 1.0,
            mu: 0.2,
            outside: 0.0,
            rounds: 6,
            least_cluster: 3,
            prune_order: 3,
            refinements: 3,
            radius: None,
        }
    }

    /// Puts the root elsewhere, metres: under the shape, beside or inside of it, at most a hundred times the shape's size
    /// away.
    pub fn with_root(mut self, root: Vec3) -> Self {
        self.root = root;
        self
    }

    /// Sets R = {R0, R1, ...} from the trunk outwards, 1 to 16 levels; the paper has 2 or 3, at most 6.
    pub fn with_levels(mut self, levels: impl Into<Vec<Level>>) -> Self {
        self.levels = levels.into();
        self
    }

    /// Sets α of equation 2, above β and at most 10, and β of equation 6, in (0, 6]; 2.5, the middle of the paper's range
    /// for α, and 2, the volume of wood, by default. With α at or below β branches would save nothing by merging.
    pub fn with_exponents(mut self, alpha: f32, beta: f32) -> Self {
        (self.alpha, self.beta) = (alpha, beta);
        self
    }

    /// Sets λ, the weight of the shape (`F_E`), and μ, that of the botanical parameters (`F_P`), both in [0, 1000]; 1 and 0.2
    /// by default, our choice by eye: the more μ, the more regular the tree and the less it minds its wood.
    pub fn with_weights(mut self, lambda: f32, mu: f32) -> Self {
        (self.lambda, self.mu) = (lambda, mu);
        self
    }

    /// Sets the price of wood outside of the shape over that inside, in [0, 1000]; 0 by default, which suits crowns without
    /// gaps. A branch node, or the middle of an internode, that is farther from every shape node than one and a half times
    /// their distance from each other costs that many times its wood for each metre. The trunk up to its first branch node is free.
    pub fn with_outside_price(mut self, price: f32) -> Self {
        self.outside = price;
        self
    }

    /// Sets the most times that a level is updated and partitioned, in [1, 1000]; 6 by default, our
    /// choice: most levels end before, when the energy falls by less than a thousandth or not at
    /// all.
    pub fn with_rounds(mut self, rounds: u32) -> Self {
        self.rounds = rounds;
        self
    }

    /// Sets how many shape nodes a branch node must carry for an axis of the next level to be built on it, at least 2;
    /// 3 by default.
    pub fn with_least_cluster(mut self, shape_nodes: usize) -> Self {
        self.least_cluster = shape_nodes;
        self
    }

    /// Sets the most times that the topology is refined, up to 1000, and the order up to which
    /// branches are pruned, in [1, 1000]; 3 times and 3 by default. It ends before when twice in a
    /// row the energy has not fallen below the least so far.
    pub fn with_refinements(mut self, times: u32, prune_order: u32) -> Self {
        (self.refinements, self.prune_order) = (times, prune_order);
        self
    }

    /// Sets the thickness of the finished tree; by default equation 2 on equal tips, the trunk base a 36th of the tree's size
    /// across. The energy's diameters are always those of the shape nodes.
    pub fn with_radius(mut self, radius: impl RadiusModel + 'static) -> Self {
        self.radius = Some(Arc::new(radius));
        self
    }

    /// The shape to fill.
    pub fn shape(&self) -> &GuidanceShape {
        &self.shape
    }

    /// The levels, from the trunk outwards.
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// Checks that all options are in range. O(n log n) for n shape nodes.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.shape.check()?;
        let count = self.levels.len();
        ParameterError::unless(
            (1..=16).contains(&count),
            "VariationalSynth.levels",
            count,
            "from 1 to 16 levels",
        )?;
        self.levels.iter().try_for_each(Level::check)?;
        ParameterError::unless(
            self.beta > 0.0 && self.beta <= 6.0,
            "VariationalSynth.beta",
            self.beta,
            "above 0, at most 6",
        )?;
        let holds = self.alpha > self.beta && self.alpha <= 10.0;
        let above = format!("above beta = {}, at most 10", self.beta);
        ParameterError::unless(holds, "VariationalSynth.alpha", self.alpha, &above)?;
        for (name, weight) in [
            ("VariationalSynth.lambda", self.lambda),
            ("VariationalSynth.mu", self.mu),
            ("VariationalSynth.outside_price", self.outside),
        ] {
            ParameterError::unless((0.0..=1000.0).contains(&weight), name, weight, "in [0, 1000]")?;
        }
        let whole = |name: &str, value: u32, least: u32| {
            ParameterError::unless(
                (least..=1000).contains(&value),
                name,
                value,
                &format!("in [{least}, 1000]"),
            )
        };
        whole("VariationalSynth.rounds", self.rounds, 1)?;
        whole("VariationalSynth.prune_order", self.prune_order, 1)?;
        whole("VariationalSynth.refinements", self.refinements, 0)?;
        let least = self.least_cluster;
        ParameterError::unless(
            least >= 2,
            "VariationalSynth.least_cluster",
            least,
            "at least 2 shape nodes",
        )?;
        let bounds = self.shape.bounds();
        let away = self.root.distance(self.root.clamp(bounds.min, bounds.max));
        ParameterError::unless(
            away <= 100.0 * bounds.size().length(),
            "VariationalSynth.root",
            self.root,
            "at most 100 times the shape's size away from it",
        )?;
        self.radius.as_ref().map_or(Ok(()), RadiusModel::check)
    }
}
