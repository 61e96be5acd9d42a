//! Endpoints of laterals after an example, and a weight that keeps their paths to their order.

use super::axis::{Axis, frame};
use super::learn::{Crown, Lateral, Model};
use crate::guided::endpoint::{EndpointError, EndpointPolicy, StageView};
use crate::guided::weight::{Edge, WeightFn};
use crate::math::sin_cos;
use crate::nearest::nearest;
use crate::random::{Purpose, stream};
use glam::{DVec3, Vec3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f32::consts::TAU;
use std::sync::Arc;

/// The laterals of all branches of one order, and their tips as endpoints: each branch takes those of a branch of about its length in
/// the example, and scales them to its own.
#[derive(Debug, Clone)]
pub(super) struct LateralsLike {
    /// The example's branches of that order, the shortest first.
    pub(super) models: Arc<Vec<Model>>,
    pub(super) order: u16,
    /// Laterals for one of the model's.
    pub(super) rate: f32,
    /// Lengths for those of the model's.
    pub(super) stretch: Vec3,
    pub(super) crown: Crown,
    /// `true` if the example's trunk bears its limbs to all sides; if false, each keeps its own.
    pub(super) round: bool,
}

/// A lateral to be: the place of its base on its parent branch, and the way from there to its tip, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Planned {
    pub(super) place: usize,
    pub(super) way: Vec3,
}

/// Largest ratio between the lengths of a branch and of its model, either way; and the number of
/// models on each side that it is drawn from.
const LIKE: f32 = 1.25;
const MODELS: usize = 6;
/// Share of the trunk, at most, that a limb strays from its place, up and down: few limbs stay about where they are.
const WIDEST_GAP: f32 = 0.1;
/// Laterals up and down the trunk that a limb takes its form from.
const NEIGHBOURS: f32 = 1.5;
/// The golden angle: limbs of a trunk in turn lie in gaps of those before.
const GOLDEN_ANGLE: f32 = 2.399_963;
/// For a lateral that would leave the crown: largest share of the way to the crown's end by which
/// it ends short of it; least share of its length that is left before that; and steps of the search
/// for the crown's end.
const BACK: f32 = 0.15;
const LEAST: f32 = 0.3;
const STEPS: usize = 8;

impl LateralsLike {
    fn model(&self, length: f32, random: &mut ChaCha8Rng) -> Option<&Model> {
        let last = self.models.len().checked_sub(1)?;
        let at = self.models.partition_point(|model| model.length < length).min(last);
        let nearer = at > 0 && length - self.models[at - 1].length < self.models[at].length - length;
        let at = at - usize::from(nearer);
        let is_like = |model: &Model| model.length <= length * LIKE && model.length >= length / LIKE;
        let low = (at.saturating_sub(MODELS)..at).find(|&i| is_like(&self.models[i])).unwrap_or(at);
        let high = (at + 1..=(at + MODELS).min(last)).rev().find(|&i| is_like(&self.models[i])).unwrap_or(at);
        self.models.get(random.random_range(low..=high))
    }

    /// Laterals of one branch.
    pub(super) fn of_branch(&self, axis: &Axis, random: &mut ChaCha8Rng) -> Vec<Planned> {
        let model = self.model(axis.length(), random);
        model.map_or_else(Vec::new, |model| self.like_model(model, axis, random))
    }

    /// Laterals of one branch after the model nearest in length that has any.
    pub(super) fn of_bearer(&self, axis: &Axis, random: &mut ChaCha8Rng) -> Vec<Planned> {
        let away = |model: &&Model| (model.length - axis.length()).abs();
        let bearers = self.models.iter().filter(|model| !model.laterals.is_empty());
        let model = bearers.min_by(|a, b| away(a).total_cmp(&away(b)));
        model.map_or_else(Vec::new, |model| self.like_model(model, axis, random))
    }

    fn like_model(&self, model: &Model, axis: &Axis, random: &mut ChaCha8Rng) -> Vec<Planned> {
        let mut planned = Vec::new();
        let scale = (axis.length() / model.length.max(1e-6)).clamp(0.5, 2.0);
        let gap = 1.0 / model.laterals.len().max(1) as f32;
        let gap = if self.order == 0 { gap.min(WIDEST_GAP) } else { gap };
        let mirrored = if random.random::<bool>() { 1.0 } else { -1.0 };
        let mut azimuth = random.random::<f32>() * TAU;
        // Limbs of the trunk change places with near ones.
        let mut forms: Vec<(f32, usize)> =
            (0..model.laterals.len()).map(|i| (i as f32 + NEIGHBOURS * random.random::<f32>(), i)).collect();
        forms.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (number, lateral) in model.laterals.iter().enumerate() {
            let copies = self.rate.floor() as u32 + u32::from(random.random::<f32>() < self.rate.fract());
            for copy in 0..copies {
                let mut jitter = || 2.0 * random.random::<f32>() - 1.0;
                let stray = if copy == 0 { 0.5 } else { 1.0 };
                let share = (lateral.share + gap * stray * jitter()).clamp(0.0, 0.99);
                let place = axis.place(share.max(lateral.share.min(0.02)));
                let way = if self.order == 0 {
                    azimuth += GOLDEN_ANGLE;
                    let turn = azimuth + 0.4 * jitter();
                    self.of_trunk(
                        model.laterals[if self.round { forms[number].1 } else { number }].chord,
                        turn,
                        random,
                    )
                } else {
                    let [along, up, side] = frame(axis.direction(place));
                    let Lateral { chord, .. } = lateral;
                    // The same side in turn with the other.
                    along * chord.x
                        + up * (chord.y * if copy == 0 { 1.0 } else { -1.0 })
                        + side * (chord.z * mirrored)
                };
                let vary = 1.0 + 0.1 * (2.0 * random.random::<f32>() - 1.0);
                let mut way = way * self.stretch * (scale * vary);
                let base = axis.line.points[place];
                if !self.crown.contains(base + way) {
                    // To where the crown ends, or a little less far.
                    let (mut inside, mut outside) = (0.0, 1.0);
                    for _ in 0..STEPS {
                        let middle = (inside + outside) * 0.5;
                        let fits = self.crown.contains(base + way * middle);
                        (inside, outside) = if fits { (middle, outside) } else { (inside, middle) };
                    }
                    way *= inside.max(LEAST) * (1.0 - BACK * random.random::<f32>());
                }
                planned.push(Planned { place, way });
            }
        }
        planned
    }

    /// A limb has the form of a near one, and a side of its own.
    fn of_trunk(&self, chord: Vec3, turn: f32, random: &mut ChaCha8Rng) -> Vec3 {
        let out = chord.with_y(0.0);
        if self.round {
            let (sin, cos) = sin_cos(turn);
            return Vec3::new(cos, 0.0, sin) * out.length() + Vec3::Y * chord.y;
        }
        let (sin, cos) = sin_cos(0.35 * (2.0 * random.random::<f32>() - 1.0));
        Vec3::new(out.x * cos - out.z * sin, chord.y, out.x * sin + out.z * cos)
    }
}

impl EndpointPolicy for LateralsLike {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        let trees = view.search().skeletons().map_err(|error| EndpointError::Other(error.to_string()))?;
        let mut targets = Vec::new();
        for (tree, _) in trees {
            for (number, branch) in (0u64..).zip(tree.branches().iter()) {
                if branch.order() == self.order {
                    let mut random = stream(view.seed(), view.stage() as u32, Purpose::ENDPOINTS, number);
                    let axis = Axis::of(&tree, &branch);
                    let planned = self.of_branch(&axis, &mut random);
                    targets
                        .extend(planned.iter().map(|lateral| axis.line.points[lateral.place] + lateral.way));
                }
            }
        }
        let candidates = view.candidates(|_, _| true);
        if candidates.is_empty() || targets.is_empty() {
            // A stage without laterals adds nothing: the root is on the tree.
            return Ok(vec![view.graph().root()]);
        }
        let place = |node: &u32| view.graph().position(*node).as_dvec3();
        let places: Vec<DVec3> = candidates.iter().map(place).collect();
        let targets: Vec<DVec3> = targets.into_iter().map(Vec3::as_dvec3).collect();
        let mut found: Vec<u32> =
            nearest(&places, &targets).into_iter().map(|place| candidates[place as usize]).collect();
        found.sort_unstable();
        found.dedup();
        Ok(found)
    }
}

/// The paper's weight, and a price for leaving the tree from a branch of another order, its clear base or its tip, and for
/// running beside it.
#[derive(Debug, Clone, Copy)]
pub(super) struct FromOrder {
    pub(super) order: u16,
    /// Metres of a branch, from its base, that bear nothing.
    pub(super) clear: f32,
    /// Cost of a wrong base, as of metres across the guiding vector.
    pub(super) price: f32,
}

impl WeightFn for FromOrder {
    fn weight(&self, edge: &Edge<'_>) -> f32 {
        // Small deviations cost less than in the paper, large ones more: paths keep to their angle.
        let guided = edge.length * edge.deviation() * edge.deviation();
        if edge.hops == 0 {
            let fork = edge.fork();
            let wrong = fork.order != self.order || fork.to_tip <= 0.0 || fork.from_base < self.clear;
            return guided + if wrong { self.price } else { 0.0 };
        }
        guided + if edge.is_beside_tree() { 0.5 * edge.length } else { 0.0 }
    }
}

/// `true` if limbs of a trunk point to all sides: no direction has most of them, nor any two that are
/// opposite.
pub(super) fn is_round(trunk: &Model) -> bool {
    let mut sums = [0.0f32; 4];
    let mut all = 0.0;
    for Lateral { chord, .. } in &trunk.laterals {
        let out = chord.with_y(0.0);
        let length = out.length();
        if length > 0.0 {
            let (cos, sin) = (out.x / length, out.z / length);
            all += length;
            sums[0] += cos * length;
            sums[1] += sin * length;
            sums[2] += (cos * cos - sin * sin) * length;
            sums[3] += 2.0 * sin * cos * length;
        }
    }
    let one = (sums[0] * sums[0] + sums[1] * sums[1]).sqrt();
    let two = (sums[2] * sums[2] + sums[3] * sums[3]).sqrt();
    one <= 0.4 * all && two <= 0.5 * all
}
