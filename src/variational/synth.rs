//! The optimization: section 4, levels within refinements.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::draft::Draft;
use super::energy::{Soft, Wish};
use super::graft::Graft;
use super::guidance::GuidanceShape;
use super::level::Level;
use super::model::{Model, Nodes, Terms, Weights};
use super::update::descend;
use crate::nearest::nearest_few;
use crate::observer::{Cancelled, Observer, Silent, Work, report};
use crate::radius::{RadiusError, RadiusModel, Variational};
use crate::{ParameterError, Skeleton, SkeletonError};

/// Grows the tree that fills a [`GuidanceShape`] at the least cost.
///
/// The cost is `F = F_I + λF_E + μF_P` (equation 4), all in the unit of `F_I`, metres to the power of 1 + β: λ, given as a plain
/// number, is multiplied by D^β, where D is the foot's diameter by equation 2, and [`F_P`](super::penalty) counts in wood. A
/// tree twice as large therefore has the same form.
///
/// Cost: O(n log n) a round, see [`with_rounds`](Self::with_rounds); 100,000 shape nodes take less than 300 MB.
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
    shape: GuidanceShape,
    root: Vec3,
    levels: Vec<Level>,
    alpha: f32,
    beta: f32,
    lambda: f32,
    mu: f32,
    outside: f32,
    rounds: u32,
    least_cluster: usize,
    prune_order: u32,
    refinements: u32,
    radius: Option<Arc<dyn RadiusModel>>,
}

impl std::fmt::Debug for VariationalSynth {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("VariationalSynth")
            .field("shape_nodes", &self.shape.len())
            .field("root", &self.root)
            .field("levels", &self.levels)
            .finish_non_exhaustive()
    }
}

/// A finished tree, and how it came about.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Growth {
    /// The tree: the branch nodes, then the shape nodes in their order. Its stages are the levels.
    pub skeleton: Skeleton,
    /// Number of branch nodes, the root included.
    pub branch_nodes: usize,
    /// What was asked of each branch node's internode.
    pub wishes: Vec<Wish>,
    /// The energy after every step. The last steps, from [`StepKind::Twigs`] on, start from the tree of least energy of all
    /// refinements, which need not be the last one's.
    pub trace: Vec<Step>,
    /// The step of the trace whose tree this is: the last.
    pub best: usize,
}

/// The energy after one step of the optimization: a point of figure 10.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Step {
    /// What was done.
    pub kind: StepKind,
    /// F, metres to the power of 1 + β.
    pub total: f64,
    /// `F_I`, metres to the power of 1 + β.
    pub structure: f64,
    /// `F_E`, metres, to the branch nodes on which the shape nodes hang. After an update others may be nearer.
    pub guidance: f64,
    /// `F_P`, metres to the power of 1 + β.
    pub penalty: f64,
    /// What wood outside of the shape costs, see [`VariationalSynth::with_outside_price`]; metres to the power of 1 + β.
    pub outside: f64,
    /// Branch nodes, the root included.
    pub branch_nodes: usize,
}

/// What a step of the optimization did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum StepKind {
    /// Built axes of a level, and partitioned the shape among them.
    Initialization {
        /// The level, from 0.
        level: usize,
    },
    /// Moved all nodes. Within a level, F never rises.
    Update {
        /// The level, from 0.
        level: usize,
    },
    /// Hung each shape node on the nearest branch node. Within a level, F never rises.
    Partition {
        /// The level, from 0.
        level: usize,
    },
    /// Took out internodes that had shrunk to less than a tenth of the length asked for. Within a level, F never rises.
    Contraction {
        /// The level, from 0.
        level: usize,
    },
    /// Hung subtrees on other branch nodes, where that saves. Within a level, F never rises.
    Rehanging {
        /// The level, from 0.
        level: usize,
    },
    /// Hung shape nodes on internodes nearby, and gathered what was too many for a node on twigs.
    Twigs,
    /// Pruned the nodes of low order, and partitioned the shape among the others.
    Refinement {
        /// The highest order that was pruned.
        order: u32,
    },
}

/// Why there is no tree.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VariationalError {
    /// An option is out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The radius model failed.
    #[error("the radii: {0}")]
    Radius(#[from] RadiusError),
    /// What was found is no tree.
    #[error("the tree: {0}")]
    Skeleton(#[from] SkeletonError),
    /// The observer cancelled the work.
    #[error("cancelled by the observer")]
    Cancelled,
}

impl From<Cancelled> for VariationalError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl Growth {
    /// The branch nodes without the shape nodes: what fills the shape.
    ///
    /// # Errors
    /// None; the type is that of [`Skeleton::new`].
    pub fn structure(&self) -> Result<Skeleton, SkeletonError> {
        let tree = &self.skeleton;
        let parents = (0..self.branch_nodes).map(|node| tree.parent(node).map(|parent| parent as u32));
        Skeleton::new(tree.positions()[..self.branch_nodes].to_vec(), parents.collect())?
            .with_radii(tree.radii()[..self.branch_nodes].to_vec())?
            .with_stages(tree.stages()[..self.branch_nodes].to_vec())
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

    /// Sets how often at most a level is updated and partitioned, in [1, 1000]; 6 by default, our
    /// choice: most levels end before, when the energy falls by less than a thousandth or not at all.
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

    /// Sets how often the topology is refined at most, up to 1000, and the order up to which branches are pruned, in
    /// [1, 1000]; 3 times and 3 by default. It ends before when twice in a row the
    /// energy has not fallen below the least so far.
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

    /// Whether all options are in range. O(n log n) for n shape nodes.
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

    /// The tree of `seed`.
    ///
    /// # Errors
    /// Options out of range, and radii that cannot be had.
    pub fn synthesize(&self, seed: u64) -> Result<Skeleton, VariationalError> {
        Ok(self.grow(seed, &Silent)?.skeleton)
    }

    /// As [`synthesize`](Self::synthesize), watched, with the trace of the energy.
    ///
    /// # Errors
    /// As [`synthesize`](Self::synthesize), and when the observer cancels.
    pub fn grow(&self, seed: u64, observer: &dyn Observer) -> Result<Growth, VariationalError> {
        self.run(seed, observer, None)
    }

    /// As [`grow`](Self::grow); `visit` gets every step of the trace with the tree at that step, figure 11's trees among
    /// them: its branch nodes, then the shape nodes, with stages and radii. Each costs as much as a copy of the tree.
    ///
    /// ```
    /// use treesynth::variational::{StepKind, by_name};
    ///
    /// let oak = by_name("variational-14-oak").expect("a preset of this name").synth(200)?;
    /// let mut first_levels = Vec::new();
    /// oak.follow(1, &treesynth::Silent, &mut |step, tree| {
    ///     if step.kind == (StepKind::Initialization { level: 0 }) {
    ///         first_levels.push(tree);
    ///     }
    /// })?;
    /// assert!(!first_levels.is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`grow`](Self::grow).
    pub fn follow(
        &self,
        seed: u64,
        observer: &dyn Observer,
        visit: &mut dyn FnMut(&Step, Skeleton),
    ) -> Result<Growth, VariationalError> {
        self.run(seed, observer, Some(visit))
    }

    fn run<'v>(
        &self,
        seed: u64,
        observer: &dyn Observer,
        visit: Option<&'v mut Visit<'v>>,
    ) -> Result<Growth, VariationalError> {
        self.check()?;
        let (nodes, weights, soft) = self.scales();
        let root = self.root.as_dvec3();
        let mut run = Run {
            synth: self,
            nodes,
            weights,
            soft,
            seed,
            draft: Draft::new(root, self.shape.len()),
            trace: Vec::new(),
            observer,
            done: 0,
            visit,
            failed: None,
        };
        let mut least = run.levels()?;
        let mut best = run.draft.clone();
        let mut in_vain = 0;
        for _ in 0..self.refinements {
            run.refine();
            let found = run.levels()?;
            in_vain += 1;
            if found < least {
                (least, in_vain) = (found, 0);
                best = run.draft.clone();
            }
            if in_vain == PATIENCE {
                break;
            }
        }
        run.draft = best;
        run.twigs();
        if let Some(error) = run.failed {
            return Err(error);
        }
        let growth = self.finish(run.draft, run.trace)?;
        report(observer, Work::Optimization, 1.0)?;
        Ok(growth)
    }

    /// The shape nodes, weights and softness in the units of the shape.
    fn scales(&self) -> (Nodes, Weights, Soft) {
        let (alpha, beta) = (f64::from(self.alpha), f64::from(self.beta));
        let places: Vec<DVec3> = self.shape.positions().iter().map(|position| position.as_dvec3()).collect();
        let diameters: Vec<f64> = self.shape.diameters().iter().map(|&d| f64::from(d)).collect();
        let largest = diameters.iter().copied().fold(0.0, f64::max);
        let sum: f64 = diameters.iter().sum();
        let flows: Vec<f64> = diameters.iter().map(|&d| libm::pow(d / largest, alpha)).collect();
        let unit = libm::pow(largest, beta);
        let foot = unit * libm::pow(flows.iter().sum(), beta / alpha);
        let root = self.root.as_dvec3();
        let size = places.iter().map(|place| place.distance(root)).fold(0.0, f64::max);
        let weights = Weights {
            power: beta / alpha,
            lambda: f64::from(self.lambda) * foot,
            mu: f64::from(self.mu),
            outside: f64::from(self.outside),
            margin: if self.outside > 0.0 { MARGIN * spacing(&places) } else { 0.0 },
        };
        let nodes = Nodes {
            costs: diameters.iter().map(|&d| libm::pow(d, beta)).collect(),
            shares: diameters.iter().map(|&d| d / sum).collect(),
            places,
            flows,
            unit,
        };
        (nodes, weights, Soft { length: 1e-4 * size, deviation: 0.05, turn: 0.2 })
    }

    /// How far the farthest shape node is from the root, metres.
    fn size(&self) -> f32 {
        let away = |place: &Vec3| place.distance(self.root);
        self.shape.positions().iter().map(away).fold(f32::MIN_POSITIVE, f32::max)
    }

    fn finish(&self, draft: Draft, trace: Vec<Step>) -> Result<Growth, VariationalError> {
        let best = trace.len().saturating_sub(1);
        let branch_nodes = draft.len();
        let mut positions: Vec<Vec3> = draft.positions.iter().map(|position| position.as_vec3()).collect();
        positions[0] = self.root;
        positions.extend_from_slice(self.shape.positions());
        let mut parents: Vec<Option<u32>> = draft.parents.into_iter().map(Some).collect();
        parents[0] = None;
        parents.extend(draft.owners.iter().copied().map(Some));
        let mut stages = draft.stages;
        for &owner in &draft.owners {
            stages.push(stages[owner as usize] + 1);
        }
        let skeleton = Skeleton::new(positions, parents)?.with_stages(stages)?;
        let radii = match &self.radius {
            Some(radius) => radius.radii(&skeleton)?,
            None => Variational::default().with_trunk_diameter(self.size() / SLENDERNESS).radii(&skeleton)?,
        };
        let skeleton = skeleton.with_radii(radii)?;
        Ok(Growth { skeleton, branch_nodes, wishes: draft.wishes, trace, best })
    }
}

/// What is shown every step with its tree.
type Visit<'v> = dyn FnMut(&Step, Skeleton) + 'v;

/// One optimization under way.
struct Run<'a, 'v> {
    synth: &'a VariationalSynth,
    nodes: Nodes,
    weights: Weights,
    soft: Soft,
    seed: u64,
    draft: Draft,
    trace: Vec<Step>,
    observer: &'a dyn Observer,
    /// Levels, over all refinements.
    done: u32,
    visit: Option<&'a mut Visit<'v>>,
    /// Why a tree could not be shown.
    failed: Option<VariationalError>,
}

impl Run<'_, '_> {
    fn terms(&self, draft: &Draft) -> Terms {
        Model::new(draft, &self.nodes, self.weights).terms(&draft.positions, Soft::NONE, None)
    }

    /// Notes where the draft stands; returns F.
    fn note(&mut self, kind: StepKind, terms: Terms) -> f64 {
        let Terms { structure, guidance, penalty, outside } = terms;
        let total = terms.total(&self.weights);
        let branch_nodes = self.draft.len();
        let step = Step { kind, total, structure, guidance, penalty, outside, branch_nodes };
        self.trace.push(step);
        if let Some(visit) = &mut self.visit {
            match self.synth.finish(self.draft.clone(), Vec::new()) {
                Ok(growth) => visit(&step, growth.skeleton),
                Err(error) => self.failed = Some(error),
            }
        }
        total
    }

    /// The inner loop over all levels (section 4.2); returns F.
    fn levels(&mut self) -> Result<f64, Cancelled> {
        let synth = self.synth;
        let mut total = f64::INFINITY;
        for level in 0..synth.levels.len() {
            let all = synth.levels.len() as u32 * (1 + synth.refinements);
            report(self.observer, Work::Optimization, (self.done as f32 / all as f32).min(0.999))?;
            self.done += 1;
            self.draft.initialize(
                &synth.levels,
                level as u16,
                synth.least_cluster,
                &self.nodes.places,
                self.seed,
            );
            self.draft.partition(&self.nodes.places);
            let terms = self.terms(&self.draft);
            total = self.note(StepKind::Initialization { level }, terms);
            total = self.settle(level, total);
            self.draft.feed_laterals(&self.nodes.places);
            self.draft.drop_idle();
            let mut next = self.draft.clone();
            next.contract(usize::MAX / 2);
            total = self.accept(StepKind::Contraction { level }, next, total).unwrap_or(total);
            let mut graft = Graft::new(&self.draft, &self.nodes, self.weights, &synth.levels);
            if graft.rehang() {
                total = self.accept(StepKind::Rehanging { level }, graft.finish(), total).unwrap_or(total);
                total = self.update(StepKind::Update { level }, total).unwrap_or(total);
            }
        }
        Ok(total)
    }

    /// Twigs for what is left, and a last update.
    fn twigs(&mut self) {
        let mut graft = Graft::new(&self.draft, &self.nodes, self.weights, &self.synth.levels);
        graft.grow_twigs();
        self.draft = graft.finish();
        let terms = self.terms(&self.draft);
        let mut total = self.note(StepKind::Twigs, terms);
        let level = self.synth.levels.len() - 1;
        total = self.update(StepKind::Update { level }, total).unwrap_or(total);
        let mut next = self.draft.clone();
        next.contract(super::graft::MOST);
        total = self.accept(StepKind::Contraction { level }, next, total).unwrap_or(total);
        for _ in 0..LAST {
            let mut graft =
                Graft::new(&self.draft, &self.nodes, self.weights, &self.synth.levels).with_twigs();
            if !graft.rehang() {
                break;
            }
            let Some(found) = self.accept(StepKind::Rehanging { level }, graft.finish(), total) else {
                break;
            };
            total = self.update(StepKind::Update { level }, found).unwrap_or(found);
        }
    }

    /// Moves all nodes to where the energy is less.
    fn update(&mut self, kind: StepKind, total: f64) -> Option<f64> {
        let mut next = self.draft.clone();
        let model = Model::new(&self.draft, &self.nodes, self.weights);
        descend(&model, &self.weights, &mut next.positions, self.soft, STEPS, 1e-4);
        self.accept(kind, next, total)
    }

    /// Updates and partitions, as long as the energy falls; returns F.
    fn settle(&mut self, level: usize, mut total: f64) -> f64 {
        for _ in 0..self.synth.rounds {
            let before = total;
            for kind in [StepKind::Update { level }, StepKind::Partition { level }] {
                let mut next = self.draft.clone();
                if let StepKind::Update { .. } = kind {
                    let model = Model::new(&self.draft, &self.nodes, self.weights);
                    descend(&model, &self.weights, &mut next.positions, self.soft, STEPS, 1e-4);
                } else {
                    next.partition(&self.nodes.places);
                }
                let Some(found) = self.accept(kind, next, total) else { return total };
                total = found;
            }
            if before - total < 1e-3 * before {
                break;
            }
        }
        total
    }

    /// Takes `next` if it costs no more than `total`: rounding off the kinks, and moving loads among branches, may cost
    /// more than they save.
    fn accept(&mut self, kind: StepKind, next: Draft, total: f64) -> Option<f64> {
        let terms = self.terms(&next);
        (terms.total(&self.weights) <= total).then(|| {
            self.draft = next;
            self.note(kind, terms)
        })
    }

    fn refine(&mut self) {
        let order = self.synth.prune_order;
        self.draft.prune(order, &self.nodes.places);
        let terms = self.terms(&self.draft);
        self.note(StepKind::Refinement { order }, terms);
    }
}

/// How many times a tree is as high as its trunk base is wide, if nothing else is asked for: trees in the open have
/// between 20 and 60.
const SLENDERNESS: f32 = 36.0;

/// How many times as far from a shape node as these are from each other the outside begins.
const MARGIN: f64 = 1.5;

/// The median distance of a shape node from its nearest neighbour.
fn spacing(places: &[DVec3]) -> f64 {
    let neighbors = nearest_few(places, places, 2);
    let mut apart: Vec<f64> = (0..places.len())
        .map(|i| neighbors[i].iter().map(|&j| places[j as usize].distance(places[i])).fold(0.0, f64::max))
        .collect();
    apart.sort_by(f64::total_cmp);
    apart[apart.len() / 2]
}

/// Quasi-Newton steps of one update, at most.
const STEPS: u32 = 20;

/// Times that subtrees are hung elsewhere and all nodes moved, at most, once there are twigs.
const LAST: u32 = 4;

/// Refinements in a row that may bring nothing: local minima go up and down (section 6, figure 10).
const PATIENCE: u32 = 2;
