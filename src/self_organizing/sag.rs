//! Limbs that bend under their own load.

use super::environment::Environment;
use super::habit::{Habit, within};
use super::season::Setting;
use super::tree::Tree;
use crate::math::Rotation;
use crate::{ParameterError, math};
use glam::Vec3;
use std::f32::consts::PI;

/// Metres per second squared.
const GRAVITY: f32 = 9.81;
/// The most that a metamer turns in a season, radians: beyond, the formula of small angles does not hold.
const MOST: f32 = 0.5;
/// After so many rounds in which some metamer had no room, the tree does not bend that season.
const ROUNDS: usize = 16;

/// Bending of limbs under their own load as they grow.
///
/// A metamer is a beam of round wood. In the course of a season what it bears becomes heavier, and its bending moment
/// grows by ΔM; it turns by `ΔM · length / (E · I)`, with I = π r⁴ / 4 and the radius r that it has by then. The wood that
/// it lays on next season is set in that shape, so that what has once bent stays bent, and a limb that has thickened bends
/// less. That is the model of M. Fournier, H. Baillères and B. Chanson 1994, "Tree biomechanics: growth, cumulative prestresses, and
/// reorientations", without reaction wood: branches of order 1 and higher sag, trunks stay as they have grown.
///
/// A limb that comes to lie on the ground, on an obstacle or at the edge of an envelope bends no further in that
/// season.
///
/// Fresh wood has a modulus of 5 to 10 gigapascals and weighs some 900 kg/m³. With those alone limbs of a few metres hardly
/// sag: real ones also bear leaves, fruit, snow and ice, and creep under them. A lower modulus stands for all of it.
///
/// Time: O(n) a season for n metamers, and what the environment takes for nodes that move to other cells.
///
/// ```
/// use treesynth::self_organizing::{Habit, Sag};
///
/// let apple = Habit::default().with_sag(Sag::default().with_modulus(1e8));
/// assert!(apple.check().is_ok());
/// assert!(apple.with_sag(Sag::default().with_modulus(0.0)).check().is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
#[must_use]
pub struct Sag {
    pub(super) modulus: f32,
    pub(super) density: f32,
}

crate::recipe::readable!(Sag { modulus: f32, density: f32 });

impl Default for Sag {
    /// 1 gigapascal, 900 kg/m³.
    fn default() -> Self {
        Self { modulus: 1e9, density: 900.0 }
    }
}

impl Sag {
    /// Sets the modulus of elasticity, pascals, in [1e3, 1e15]; 1e9 by default. Half of it bends limbs about twice as far.
    pub fn with_modulus(mut self, pascals: f32) -> Self {
        self.modulus = pascals;
        self
    }

    /// Sets the density of the wood with all that it bears, kilograms a cubic metre, in [0, 1e5]; 900 by default.
    pub fn with_density(mut self, kilograms: f32) -> Self {
        self.density = kilograms;
        self
    }

    pub(super) fn check(self) -> Result<(), ParameterError> {
        within("Sag.modulus", self.modulus, 1e3, 1e15)?;
        within("Sag.density", self.density, 0.0, 1e5)
    }
}

impl Tree {
    /// The bending moment at the lower end of each metamer, newton metres; none of the foot.
    pub(super) fn moments(&self, habit: &Habit, sag: Sag) -> Vec<Vec3> {
        let area = Areas::new(habit);
        // Of each node's metamer and all above it: the weight, and its first moment about the node below, and above.
        let mut weights = vec![0.0f32; self.nodes.len()];
        let mut firsts = vec![Vec3::ZERO; self.nodes.len()];
        for node in (1..self.nodes.len()).rev() {
            let data = &self.nodes[node];
            let parent = data.parent as usize;
            let along = data.position - self.nodes[parent].position;
            let own = sag.density * GRAVITY * area.of(data.count) * along.length();
            let above = weights[node];
            weights[node] += own;
            firsts[node] += along * (above + 0.5 * own);
            weights[parent] += weights[node];
            let first = firsts[node];
            firsts[parent] += first;
        }
        firsts.into_iter().map(|first| first.cross(Vec3::NEG_Y)).collect()
    }

    /// Bends what is not the trunk by what its moments have grown by since they were `before`, those of metamers that have
    /// appeared since being none. Returns from where to where nodes have moved.
    pub(super) fn sag<E: Environment>(
        &mut self,
        before: &[Vec3],
        sag: Sag,
        setting: &Setting<'_, E>,
    ) -> Vec<(Vec3, Vec3)> {
        let mut turns = self.moments(setting.habit, sag);
        let area = Areas::new(setting.habit);
        for (node, turn) in turns.iter_mut().enumerate() {
            let data = &self.nodes[node];
            let length = data.position.distance(self.nodes[data.parent as usize].position);
            // π r⁴ / 4 of the area π r².
            let inertia = area.of(data.count) * area.of(data.count) / (4.0 * PI);
            let grown = *turn - before.get(node).copied().unwrap_or_default();
            *turn = grown * (length / (sag.modulus * inertia));
            if data.order == 0 || !turn.is_finite() {
                *turn = Vec3::ZERO;
            }
            *turn = turn.clamp_length_max(MOST);
        }
        let places = self.bent(&mut turns, setting);
        let mut moved = Vec::new();
        for (data, place) in self.nodes.iter_mut().zip(places) {
            if data.position != place {
                moved.push((data.position, place));
                data.position = place;
            }
        }
        moved
    }

    /// The places of all nodes once each metamer has turned by its vector and by those of all metamers below it. Where
    /// there is no room the metamers that lead there do not turn.
    fn bent<E: Environment>(&self, turns: &mut [Vec3], setting: &Setting<'_, E>) -> Vec<Vec3> {
        let &Setting { environment, room, .. } = setting;
        let mut places: Vec<Vec3> = self.positions().collect();
        let mut totals = vec![Vec3::ZERO; turns.len()];
        // Each round holds at least one metamer more.
        for _ in 0..ROUNDS {
            let mut has_room = true;
            for node in 1..turns.len() {
                let data = &self.nodes[node];
                let parent = data.parent as usize;
                totals[node] = (totals[parent] + turns[node]).clamp_length_max(MOST);
                let below = self.nodes[parent].position;
                let (turn, angle) = (totals[node], totals[node].length());
                // Nodes that are not turned stay as they are to the last bit.
                if angle <= 0.0 && places[parent] == below {
                    places[node] = data.position;
                    continue;
                }
                let straight = data.position - below;
                let mut along = straight;
                if angle > 0.0 {
                    along = Rotation::new(angle).about(turn / angle, straight);
                    // It hangs down, and swings no further.
                    if along.with_y(0.0).dot(straight.with_y(0.0)) < 0.0 && along.y < 0.0 {
                        along = Vec3::NEG_Y * straight.length();
                    }
                }
                places[node] = places[parent] + along;
                if !(environment.contains(places[node]) && room.is_open(places[parent], places[node])) {
                    has_room = false;
                    let mut held = node;
                    while held > 0 {
                        turns[held] = Vec3::ZERO;
                        held = self.nodes[held].parent as usize;
                    }
                }
            }
            if has_room {
                return places;
            }
        }
        self.positions().collect()
    }
}

/// Cross-sections by the number of buds borne.
struct Areas {
    tip: f32,
    exponent: f32,
    /// Most counts are small and come often.
    small: [f32; 64],
}

impl Areas {
    fn new(habit: &Habit) -> Self {
        let tip = PI * habit.tip_radius * habit.tip_radius;
        let mut areas = Self { tip, exponent: 2.0 / habit.width_exponent, small: [0.0; 64] };
        areas.small = std::array::from_fn(|count| areas.worked_out(count as u32));
        areas
    }

    fn worked_out(&self, count: u32) -> f32 {
        self.tip * math::powf(count as f32, self.exponent)
    }

    /// Square metres.
    fn of(&self, count: u32) -> f32 {
        self.small.get(count as usize).copied().unwrap_or_else(|| self.worked_out(count))
    }
}
