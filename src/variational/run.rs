//! The optimization: section 4, levels within refinements.

use glam::{DVec3, Vec3};

use super::draft::Draft;
use super::energy::Soft;
use super::graft::Graft;
use super::growth::{Growth, Step, StepKind, VariationalError};
use super::model::{Model, Nodes, Terms, Weights};
use super::synth::VariationalSynth;
use super::update::descend;
use crate::Skeleton;
use crate::nearest::nearest_few;
use crate::observer::{Cancelled, Observer, Silent, Work, report};
use crate::radius::{RadiusModel, Variational};

impl VariationalSynth {
    /// The tree of `seed`.
    ///
    /// # Errors
    /// Options out of range, and radii that the model cannot give.
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
    /// use treesynth::{presets, variational::StepKind};
    ///
    /// let oak = presets::by_name("variational-14-oak")?.variational()?.synth(200)?;
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
        let base = unit * libm::pow(flows.iter().sum(), beta / alpha);
        let root = self.root.as_dvec3();
        let size = places.iter().map(|place| place.distance(root)).fold(0.0, f64::max);
        let weights = Weights {
            power: beta / alpha,
            lambda: f64::from(self.lambda) * base,
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

    /// Distance of the farthest shape node from the root, metres.
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

/// Callback that sees every step with its tree.
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
    /// Error by which a tree could not be shown.
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

/// Default ratio of a tree's height to the diameter of its trunk base: trees in the open have between 20 and
/// 60.
const SLENDERNESS: f32 = 36.0;

/// Distance from the shape nodes at which the outside begins, in units of their median distance from each
/// other.
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
