//! More trees of the kind of an example (section 5).

mod axis;
mod laterals;
mod learn;
mod radii;
mod redraw;

pub use learn::{OrderTraits, TrunkTraits};

use super::graph::PoissonYao;
use super::refine::Refinement;
use super::rule::{Bend, ForkAngle};
use super::synth::{Stage, SynthesisError, TreeSynth};
use crate::math::{Rotation, UP, cbrt};
use crate::metrics::crown_width;
use crate::parameter::ParameterError;
use crate::radius::{PipeModel, RadiusModel};
use crate::random::{Purpose, derive, stream};
use crate::shape::{Cuboid, LARGEST};
use crate::skeleton::Skeleton;
use glam::Vec3;
use laterals::{FromOrder, LateralsLike, is_round};
use learn::{Crown, Model, models, traits};
use radii::LikeExample;
use rand::RngExt;
use redraw::Redraw;
use std::f32::consts::TAU;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Traits of a tree, measured on a skeleton, and a [`TreeSynth`] that grows more of its kind.
///
/// Measured are, order by order, how branches are spaced along their parent branches, the angles at which they leave, how
/// they bend, how long they are and where they end; the trunk's length, form, waywardness, clear bole and diameter; the
/// crown's extent at each height; and thickness by the share of tips that a branch bears.
///
/// The synthesizer has one stage per order. Its endpoints are laterals of the example's branches of like length, scaled
/// to the branch that bears them, at other places and to other sides for each seed; its rule is a
/// [`ForkAngle`] with the measured angle and spread, then a [`Bend`]. The graph's irregularity changes angles, lengths and
/// numbers: [`grow`](Self::grow) draws the branches anew and adds those that the graph had no room for, and
/// [`tuned`](Self::tuned) grows trees, measures them in the same way and corrects for the rest.
///
/// The trunk is taken to stand: limbs change places around the vertical through its base, and their angles are to it; where they
/// point to all sides, [`grow`](Self::grow) turns each tree about it as a whole. After a tree that lies, others lie the same way,
/// but their limbs are not turned around the trunk.
///
/// Endpoints are drawn as from a sample, so what the example never does does not happen: one tree says little about
/// its kind.
///
/// ```
/// use treesynth::{Metrics, guided::Example, presets};
///
/// let oak = presets::by_name("fine-oak").expect("a preset").guided().unwrap().synth(8_000).synthesize(1)?;
/// let example = Example::of(&oak)?;
/// assert!(example.orders()[1].angle > 0.3 && example.trunk().diameter > 0.1);
///
/// let [one, other] = [example.grow(8_000, 1)?, example.grow(8_000, 2)?];
/// assert_ne!(one, other);
/// let [height, grown] = [&oak, &one].map(|tree| Metrics::of(tree).height);
/// assert!((grown / height - 1.0).abs() < 0.2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone)]
pub struct Example {
    base: Vec3,
    trunk: TrunkTraits,
    orders: Vec<OrderTraits>,
    models: Vec<Arc<Vec<Model>>>,
    crown: Crown,
    width: f32,
    internode: f32,
    radius: Option<LikeExample>,
    redraw: Redraw,
    round: bool,
    tuning: Tuning,
}

/// Correction for the graph.
#[derive(Debug, Clone, PartialEq)]
struct Tuning {
    /// Indexed by the laterals' order, from 1.
    rates: Vec<f32>,
    stretches: Vec<f32>,
    /// Of crown and limbs.
    wide: f32,
    high: f32,
}

impl Tuning {
    /// Of at least one.
    fn mean(all: &[Self]) -> Self {
        let mean = |of: &dyn Fn(&Self) -> f32| all.iter().map(of).sum::<f32>() / all.len() as f32;
        let each = |of: &dyn Fn(&Self) -> &Vec<f32>| {
            (0..of(&all[0]).len()).map(|i| mean(&|one| of(one)[i])).collect()
        };
        Self {
            rates: each(&|one| &one.rates),
            stretches: each(&|one| &one.stretches),
            wide: mean(&|one| one.wide),
            high: mean(&|one| one.high),
        }
    }
}

/// Branches of higher orders are not grown.
const ORDERS: usize = 8;
/// Nodes that a graph may have.
const NODES: RangeInclusive<usize> = 2..=200_000_000;
/// Mean length of the graph's edges, in spacings.
const EDGE: f32 = 1.25;
/// Nodes in a cube of the spacing.
const DENSITY: f32 = 0.67;
/// Spacings in a lateral of common length, so that it can have a direction of its own.
const FINE: f32 = 4.0;
/// Spacings in a lateral of common length, so that it can be a path at all.
const COARSE: f32 = 2.0;
/// No number or length is corrected beyond these.
const LEAST: f32 = 0.4;
const MOST: f32 = 3.0;
/// Times that laterals are added, at most, to have an order's number.
const ROUNDS: u64 = 16;
/// Share of the measured difference that the first correction takes; later ones take less.
const DAMPING: f32 = 0.7;

impl Example {
    /// Measures a tree. Its thickness is taken over if it has any. O(n log n).
    ///
    /// # Errors
    /// A tree without branches besides its trunk, with a trunk that is not 1 mm to 1e6 m long, or with a node more than 1e6 m from its
    /// root.
    pub fn of(skeleton: &Skeleton) -> Result<Self, ParameterError> {
        let branches = skeleton.branches().len();
        ParameterError::unless(branches > 1, "Example.skeleton", branches, "a tree of at least 2 branches")?;
        let (base, positions) = (skeleton.positions()[0], skeleton.positions());
        let far = positions.iter().map(|&place| (place - base).abs().max_element()).fold(0.0, f32::max);
        if far > LARGEST {
            let value = format_args!("a tree of which a node is {far} m from its root");
            return Err(ParameterError::new("Example.skeleton", value, "one within 1e6 m of its root"));
        }
        let mut models = models(skeleton);
        let orders = traits(skeleton, &models);
        let trunk = TrunkTraits::of(skeleton, &models);
        let tall = trunk.chord.length();
        if !(tall > 1e-3 && tall <= 1e6) {
            let value = format_args!("a tree with a trunk of {tall} m");
            return Err(ParameterError::new("Example.skeleton", value, "one with a trunk of 1e-3 to 1e6 m"));
        }
        let redraw = Redraw::of(skeleton, &models);
        models.truncate(ORDERS);
        let length: f32 = orders.iter().map(|order| order.length * order.count as f32).sum();
        let (laterals, limbs) = (models.len() - 1, models[0][0].laterals.len());
        Ok(Self {
            base,
            trunk,
            round: is_round(&models[0][0]),
            models: models.into_iter().map(Arc::new).collect(),
            crown: Crown::of(skeleton, limbs),
            width: crown_width(skeleton) as f32,
            internode: length / skeleton.segments() as f32,
            radius: LikeExample::new(skeleton),
            redraw,
            orders,
            tuning: Tuning {
                rates: vec![1.0; laterals],
                stretches: vec![1.0; laterals],
                wide: 1.0,
                high: 1.0,
            },
        })
    }

    /// Traits of the branches of each order, the trunk first.
    pub fn orders(&self) -> &[OrderTraits] {
        &self.orders
    }

    /// Traits of the trunk.
    pub fn trunk(&self) -> TrunkTraits {
        self.trunk
    }

    /// Grows `trials` trees, one after the other, on graphs of about `nodes` nodes, and after each
    /// corrects numbers, lengths and angles of each order, and the crown's width and height, by
    /// what is measured on it. 8 trials are a good number; the correction is for that many nodes.
    /// Takes as long as growing the `trials` trees.
    ///
    /// # Errors
    /// As [`TreeSynth::synthesize`].
    pub fn tuned(mut self, nodes: usize, trials: u32) -> Result<Self, SynthesisError> {
        let mut later = Vec::new();
        for trial in 0..trials {
            let seed = derive(u64::from(trial), 0, Purpose::ENDPOINTS);
            let damping = DAMPING / (1.0 + 0.15 * trial as f32);
            // Rates are corrected by what branches bear of themselves.
            self.correct(&self.grown(nodes, seed, 1)?, damping);
            if trial >= trials / 2 {
                later.push(self.tuning.clone());
            }
        }
        // One tree is off by chance; corrections after several are so by less.
        if !later.is_empty() {
            self.tuning = Tuning::mean(&later);
        }
        Ok(self)
    }

    fn correct(&mut self, grown: &Skeleton, damping: f32) {
        let models = models(grown);
        let measured = traits(grown, &models);
        let towards = |value: &mut f32, wanted: f32, found: f32| {
            let ratio = (wanted / found.max(1e-6)).clamp(0.4, 2.5);
            *value = (*value * crate::math::powf(ratio, damping)).clamp(LEAST, MOST);
        };
        for order in 1..self.models.len() {
            let (wanted, before) = (self.orders[order], self.orders[order - 1]);
            let Some(found) = measured.get(order).filter(|found| found.count > 0) else {
                self.tuning.rates[order - 1] = (self.tuning.rates[order - 1] * 1.5).min(5.0);
                continue;
            };
            // Per branch of the order before, which is corrected too.
            let ratio = |own: usize, parents: usize| own as f32 / parents.max(1) as f32;
            let [wanted_rate, found_rate] =
                [ratio(wanted.count, before.count), ratio(found.count, measured[order - 1].count)];
            towards(&mut self.tuning.rates[order - 1], wanted_rate, found_rate);
            let stretch = &mut self.tuning.stretches[order - 1];
            towards(stretch, wanted.length, found.length);
            *stretch = stretch.min(1.6);
        }
        let crown = Crown::of(grown, 0);
        towards(&mut self.tuning.wide, self.width, crown_width(grown) as f32);
        towards(&mut self.tuning.high, self.crown.high, crown.high);
        self.tuning.wide = self.tuning.wide.clamp(0.7, 1.4);
        self.tuning.high = self.tuning.high.clamp(0.7, 1.4);
    }

    /// Grows a tree of the kind on a graph of about `nodes` nodes, as [`synth`](Self::synth) does, and draws its branches
    /// anew, from the same places to the same tips: with internodes as long as the example's, as straight, and at first
    /// angles drawn from its own. A graph's nodes stand off each other, so that its paths cannot leave at 20°, and paths merge:
    /// laterals that a branch of such a length has in the example are added where they lack, then more of them, until each order has
    /// the example's number of branches within 10%.
    ///
    /// # Errors
    /// As [`TreeSynth::synthesize`].
    pub fn grow(&self, nodes: usize, seed: u64) -> Result<Skeleton, SynthesisError> {
        self.grown(nodes, seed, ROUNDS)
    }

    fn grown(&self, nodes: usize, seed: u64, rounds: u64) -> Result<Skeleton, SynthesisError> {
        let laterals: Vec<_> = (1..self.models.len()).map(|order| self.laterals(order)).collect();
        let tree = self.pipeline(nodes, COARSE).synthesize(seed)?;
        let mut tree = self.redraw.apply(&tree, &laterals, seed, rounds)?;
        if self.round {
            // Their trunks lean and turn aside alike.
            let turn = Rotation::new(stream(seed, 0, Purpose::AZIMUTH, 0).random::<f32>() * TAU);
            let turned = |&place: &Vec3| self.base + turn.about(UP, place - self.base);
            let positions = tree.positions().iter().map(turned).collect();
            tree = tree.with_positions(positions)?;
        }
        let radii = self.radius().radii(&tree)?;
        Ok(tree.with_radii(radii)?)
    }

    fn radius(&self) -> Arc<dyn RadiusModel> {
        match &self.radius {
            Some(radius) => Arc::new(radius.clone()),
            None => Arc::new(PipeModel::default()),
        }
    }

    /// Laterals of some order, from 1.
    fn laterals(&self, order: usize) -> LateralsLike {
        let tuning = &self.tuning;
        let stretch = Vec3::splat(tuning.stretches[order - 1]);
        let wide = if order == 1 { Vec3::new(tuning.wide, 1.0, tuning.wide) } else { Vec3::ONE };
        LateralsLike {
            models: self.models[order - 1].clone(),
            order: order as u16 - 1,
            rate: tuning.rates[order - 1],
            stretch: stretch * wide,
            crown: self.crown.scaled(tuning.wide, tuning.high),
            round: self.round,
        }
    }

    /// A synthesizer of more such trees on graphs of about `nodes` nodes in [2, 200000000]; a stage whose branches are too
    /// short for that has a finer graph around the tree.
    pub fn synth(&self, nodes: usize) -> TreeSynth {
        self.pipeline(nodes, 0.0)
    }

    /// Stages for the orders whose common branch is at least `coarse` spacings long.
    fn pipeline(&self, nodes: usize, coarse: f32) -> TreeSynth {
        let crown = self.crown.scaled(self.tuning.wide, self.tuning.high);
        let half = crown.widest().max(0.05 * crown.high) * 1.1;
        let (low, high) = ((crown.low * 1.05).min(0.0), crown.high * 1.1);
        let region = Cuboid::new(
            self.base + Vec3::new(-half, low - 1e-3 * high, -half),
            self.base + Vec3::new(half, high, half),
        );
        let volume = 4.0 * half * half * (high - low);
        let finest = |volume: f32, nodes: f32| cbrt(DENSITY * volume / nodes.max(2.0));
        let mut spacing = finest(volume, nodes as f32).max(self.internode / EDGE);
        let tuning = &self.tuning;
        let graph = PoissonYao::new(region).with_leader(self.trunk.leader(self.base, tuning.high));
        // A number out of range is refused by the graph.
        let graph =
            if NODES.contains(&nodes) { graph.with_spacing(spacing) } else { graph.with_nodes(nodes) };
        let mut synth = TreeSynth::new(graph);
        let mut length = self.orders[0].length;
        for order in 1..self.models.len() {
            let own = self.orders[order];
            let [mean, spread] = self.redraw.chords[order - 1];
            let angle = mean.clamp(0.02, 3.1);
            // A uniform distribution has a standard deviation of its half width over √3.
            let rule = ForkAngle::new(angle, Bend::constant(own.bend.clamp(-1.5, 1.5)).with_hop_length(1.0))
                .with_spread((spread * 3f32.sqrt()).min(1.2));
            // The clear bole, less a tenth that leaves the first limb room to be elsewhere.
            let clear = if order == 1 { 0.9 * self.trunk.clear_bole } else { 0.0 };
            let weight = FromOrder { order: order as u16 - 1, clear, price: own.length };
            let mut stage = Stage::new(rule, self.laterals(order)).with_weight(weight);
            let models = &self.models[order];
            let at = |share: f32| models[(share * (models.len() - 1) as f32) as usize].length;
            let reach = 1.2 * at(0.95) + 2.0 * spacing;
            // Volume within reach of the tree so far.
            let around = (length * std::f32::consts::PI * reach * reach).min(volume);
            let wanted = (at(0.4) / FINE).max(self.internode / EDGE).max(finest(around, 1.5 * nodes as f32));
            if wanted < 0.75 * spacing {
                spacing = wanted;
                let hops = (reach / (1.3 * spacing)).ceil().clamp(3.0, 24.0) as u32;
                stage = stage.with_refinement(Refinement::new(region, spacing).with_reach(hops));
            }
            if order > 1 && at(0.5) < coarse * spacing {
                break;
            }
            length += own.length * own.count as f32;
            synth = synth.stage(stage);
        }
        synth.with_radius(self.radius())
    }
}
