//! One tree as a flat array of nodes, and one season of it.

use super::environment::{Bud, Environment};
use super::habit::{Habit, Phyllotaxis};
use super::room::Room;
use super::vigor::Supply;
use crate::math::{self, UP};
use crate::random::{Purpose, unit};
use crate::skeleton::{Skeleton, SkeletonError};
use glam::Vec3;

/// In place of a child: a bud that lives.
pub(super) const BUD: u32 = u32::MAX;
/// In place of a child: nothing, for good. It was shed or had no room.
pub(super) const DEAD: u32 = u32::MAX - 1;
/// In place of a node's new index: it falls.
const FALLS: u32 = u32::MAX;

/// The upper end of a metamer, with a main bud or child at its end and a lateral one at its side. Node 0 is the foot,
/// which has no metamer and no lateral.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub(super) struct Node {
    pub(super) position: Vec3,
    /// A smaller index than the node's own; the foot's is 0.
    pub(super) parent: u32,
    /// Main and lateral: a node, [`BUD`] or [`DEAD`].
    pub(super) children: [u32; 2],
    /// The most buds, living or dead, that it ever carried: its width.
    pub(super) count: u32,
    /// The same since it was last cut above: what it must pay for, lest it be shed.
    pub(super) load: u32,
    /// Its number in the order of appearance, for random draws.
    pub(super) number: u32,
    /// The season in which it appeared.
    pub(super) born: u16,
}

/// Where a bud is and in which direction it points, as [`Environment::prepare`] gets it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Site {
    /// Metres.
    pub position: Vec3,
    /// A unit vector.
    pub direction: Vec3,
}

/// A tree as it stands. Its nodes are those of its [skeleton](Self::skeleton), in the same order.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "super::saved::SavedTree"))]
pub struct Tree {
    pub(super) nodes: Vec<Node>,
    /// Of the forest's trees; random draws are keyed by it.
    pub(super) number: u32,
    /// Of the forest's habits.
    pub(super) habit: u32,
    pub(super) generation: u16,
    pub(super) next_number: u32,
    pub(super) vigor: f32,
}

/// A bud that will grow.
#[derive(Debug, Clone, Copy)]
struct Shoot {
    node: u32,
    lateral: bool,
    vigor: f32,
    /// The bud's place in the environment's list.
    index: u32,
}

/// What a season will do to a tree.
#[derive(Debug, Default)]
pub(super) struct Plan {
    /// If there are to be parts, by node, main before lateral: those that have stood longest first.
    shoots: Vec<Shoot>,
    /// The lowest nodes of what will be shed, ascending.
    shed: Vec<u32>,
    vigor: f32,
    /// Metamers that will appear, unless there is no room for them.
    pub(super) metamers: u64,
}

/// Which of the equal parts of a season's shoots.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    pub(super) index: u32,
    pub(super) of: u32,
}

/// Where and when a tree grows.
#[derive(Debug)]
pub(super) struct Setting<'a, E> {
    pub(super) environment: &'a E,
    pub(super) room: &'a Room,
    pub(super) habit: &'a Habit,
    pub(super) seed: u64,
    pub(super) season: u16,
}

/// What a season did to a tree.
#[derive(Debug, Default)]
pub(super) struct Change {
    pub(super) appeared: Vec<Vec3>,
    pub(super) fallen: Vec<Vec3>,
}

impl Tree {
    pub(super) fn new(foot: Vec3, number: u32, habit: u32, generation: u16, season: u16) -> Self {
        let children = [BUD, DEAD];
        let foot = Node { position: foot, parent: 0, children, count: 1, load: 1, number: 0, born: season };
        Self { nodes: vec![foot], number, habit, generation, next_number: 1, vigor: 0.0 }
    }

    /// Its number, from 0 in the order of planting; no other tree of the forest ever has it.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// Which of the forest's habits it has.
    pub fn habit(&self) -> usize {
        self.habit as usize
    }

    /// 0 if it was planted, one more than its parent's if it was sown.
    pub fn generation(&self) -> u16 {
        self.generation
    }

    /// Where it stands, metres.
    pub fn foot(&self) -> Vec3 {
        self.nodes[0].position
    }

    /// The season in which it was planted or sown.
    pub fn born(&self) -> u16 {
        self.nodes[0].born
    }

    /// Its metamers: one less than nodes.
    pub fn metamers(&self) -> usize {
        self.nodes.len() - 1
    }

    /// The vigor of its root in the latest season.
    pub fn vigor(&self) -> f32 {
        self.vigor
    }

    /// Where its nodes are, metres; the foot first, each parent before its children.
    pub fn positions(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        self.nodes.iter().map(|node| node.position)
    }

    /// The most buds, living or dead, that each node ever carried: 2 for a fresh metamer. Widths and leaves
    /// depend on it.
    pub fn child_counts(&self) -> impl ExactSizeIterator<Item = u32> + '_ {
        self.nodes.iter().map(|node| node.count)
    }

    /// Whether the metamer below each node bears leaves, by the text's rule: it begins at least `least_hops` nodes
    /// from the foot, and no branch that goes on from there carries `most_children` buds or more. The foot bears none.
    pub fn leafy(&self, most_children: u32, least_hops: u32) -> Vec<bool> {
        let (mut hops, mut dominant) = (vec![0; self.nodes.len()], vec![0; self.nodes.len()]);
        for (node, data) in self.nodes.iter().enumerate().skip(1) {
            let parent = data.parent as usize;
            hops[node] = hops[parent] + 1;
            dominant[parent] = data.count.max(dominant[parent]);
        }
        let bears = |node: &Node| {
            let parent = node.parent as usize;
            hops[parent] >= least_hops && dominant[parent] < most_children
        };
        let above = self.nodes.iter().skip(1).map(bears);
        std::iter::once(false).chain(above).collect()
    }

    /// The living buds of each node, main and lateral.
    pub fn buds(&self) -> impl ExactSizeIterator<Item = [bool; 2]> + '_ {
        self.nodes.iter().map(|node| node.children.map(|child| child == BUD))
    }

    /// The branching as a skeleton without radii: `stages` are the seasons in which the nodes appeared, `hops` their
    /// distance from the foot in nodes, which the text calls order. O(n).
    ///
    /// # Errors
    /// None that is known of; what the skeleton's constructors say.
    pub fn skeleton(&self) -> Result<Skeleton, SkeletonError> {
        let parents = self.nodes.iter().enumerate().map(|(i, node)| (i > 0).then_some(node.parent)).collect();
        let mut hops = vec![0; self.nodes.len()];
        for (node, data) in self.nodes.iter().enumerate().skip(1) {
            hops[node] = hops[data.parent as usize] + 1;
        }
        Skeleton::new(self.positions().collect(), parents)?
            .with_stages(self.nodes.iter().map(|node| node.born).collect())?
            .with_hops(hops)
    }

    /// The direction of the metamer below `node`; up at the foot.
    pub(super) fn direction(&self, node: u32) -> Vec3 {
        let Node { position, parent, .. } = self.nodes[node as usize];
        (position - self.nodes[parent as usize].position).normalize_or(UP)
    }

    pub(super) fn lateral_direction(&self, node: u32, habit: &Habit, seed: u64) -> Vec3 {
        let direction = self.direction(node);
        let number = u64::from(self.nodes[node as usize].number);
        let draw = |i: u64| unit(seed, self.number, Purpose::LATERAL, 2 * number + i);
        let (azimuth, cos) = match habit.phyllotaxis {
            Phyllotaxis::Scattered => {
                let least = math::cos(habit.lateral_angle);
                (draw(0) * std::f32::consts::TAU, least + (1.0 - least) * draw(1))
            }
            Phyllotaxis::Spiral { divergence } => {
                let turns = f64::from(divergence) * number as f64 / std::f64::consts::TAU;
                ((turns.fract() * std::f64::consts::TAU) as f32, math::cos(habit.lateral_angle))
            }
        };
        let (across, along) = direction.any_orthonormal_pair();
        let (s, c) = math::sin_cos(azimuth);
        let sideways = (1.0 - cos * cos).max(0.0).sqrt();
        ((across * c + along * s) * sideways + direction * cos).normalize_or(direction)
    }

    /// All living buds, main before lateral, in the order in which [`plan`](Self::plan) numbers them.
    pub(super) fn sites(&self, habit: &Habit, seed: u64) -> Vec<Site> {
        let mut sites = Vec::new();
        for (node, data) in self.nodes.iter().enumerate() {
            if data.children[0] == BUD {
                sites.push(Site { position: data.position, direction: self.direction(node as u32) });
            }
            if data.children[1] == BUD {
                let direction = self.lateral_direction(node as u32, habit, seed);
                sites.push(Site { position: data.position, direction });
            }
        }
        sites
    }

    /// Steps 1, 2 and 4 as decisions; `first` is the index of the tree's first bud in the environment's list.
    pub(super) fn plan<E: Environment>(&self, setting: &Setting<'_, E>, first: u32, parts: u32) -> Plan {
        let &Setting { environment, habit, seed, season, .. } = setting;
        let mut supply = Supply::default();
        let firsts = if environment.surveys() { self.first_buds(first) } else { Vec::new() };
        let index = |node: usize, side: usize| {
            let after_main = side == 1 && self.nodes[node].children[0] == BUD;
            firsts.get(node).map_or(0, |first| first + u32::from(after_main))
        };
        supply.sense(self, environment.is_positional(), |node, side| {
            let index = index(node, side);
            let bud = Bud { tree: self, habit, seed, node: node as u32, lateral: side == 1, index };
            environment.light(&bud).max(0.0)
        });
        let mut plan = Plan { vigor: habit.vigor_multiplier * supply.light[0], ..Plan::default() };
        supply.share(self, habit.vigor_model, plan.vigor, &mut |node, side, vigor| {
            if vigor >= 1.0 {
                plan.metamers += u64::from(vigor as u32);
                let index = index(node, side);
                plan.shoots.push(Shoot { node: node as u32, lateral: side == 1, vigor, index });
            }
        });
        plan.shoots.shrink_to_fit();
        if parts > 1 {
            // The priority model goes from axis to axis.
            plan.shoots.sort_unstable_by_key(|shoot| (shoot.node, shoot.lateral));
        }
        self.shed(habit, season, &supply.vigor, &mut plan.shed);
        plan
    }

    /// The index of each node's first bud in the environment's list.
    fn first_buds(&self, first: u32) -> Vec<u32> {
        let before = self.buds().scan(first, |next, buds| {
            let first = *next;
            *next += buds.map(u32::from).iter().sum::<u32>();
            Some(first)
        });
        before.collect()
    }

    /// Step 4: which metamers have too little vigor for their width.
    fn shed(&self, habit: &Habit, season: u16, vigor: &[f32], shed: &mut Vec<u32>) {
        let Some(shedding) = habit.shedding else { return };
        let exponent = shedding.exponent / habit.width_exponent;
        let need = |count: u32| shedding.multiplier * math::powf(count as f32, exponent);
        // Most counts are small and come often.
        let mut needs = [f32::NAN; 256];
        for (node, data) in self.nodes.iter().enumerate().skip(1) {
            if season - data.born >= shedding.grace {
                let need = match needs.get_mut(data.load as usize) {
                    Some(known) if known.is_nan() => {
                        *known = need(data.load);
                        *known
                    }
                    Some(known) => *known,
                    None => need(data.load),
                };
                if vigor[node] < need {
                    shed.push(node as u32);
                }
            }
        }
    }

    /// Does one part of what was planned: sheds in the first, counts in the last.
    pub(super) fn carry_out<E: Environment>(
        &mut self,
        part: Part,
        plan: &mut Plan,
        setting: &Setting<'_, E>,
    ) -> Change {
        let mut change = Change::default();
        if part.index == 0 {
            self.vigor = plan.vigor;
            if let Some(places) = self.fell(&plan.shed, DEAD, &mut change.fallen) {
                plan.shoots.retain_mut(|shoot| {
                    shoot.node = places[shoot.node as usize];
                    shoot.node != FALLS
                });
            }
            // A tree takes no more memory than it needs, and no more than it has where there may not be room for it
            // all.
            self.nodes.reserve_exact((plan.metamers as usize).min(self.nodes.len() + 1024));
        }
        let place = |index: u32| index as usize * plan.shoots.len() / part.of as usize;
        for &shoot in &plan.shoots[place(part.index)..place(part.index + 1)] {
            self.sprout(shoot, setting, &mut change.appeared);
        }
        if part.index + 1 == part.of {
            plan.shoots = Vec::new();
            self.count();
        }
        change
    }

    /// Step 3: a shoot, as far as there is room. A bud without room for one metamer dies.
    fn sprout<E: Environment>(&mut self, shoot: Shoot, setting: &Setting<'_, E>, appeared: &mut Vec<Vec3>) {
        let &Setting { environment, room, habit, seed, season } = setting;
        let Shoot { node: origin, lateral, vigor, index } = shoot;
        let bud = Bud { tree: self, habit, seed, node: origin, lateral, index };
        let (mut direction, optimal) = (bud.direction(), environment.direction(&bud));
        let metamers = vigor as u32;
        let length = habit.length * vigor / metamers as f32;
        let (mut node, mut side) = (origin as usize, usize::from(lateral));
        for _ in 0..metamers {
            direction = habit.turned(direction, optimal);
            let start = self.nodes[node].position;
            let position = start + direction * length;
            if !(environment.contains(position) && room.is_open(start, position)) {
                break;
            }
            let new = self.nodes.len();
            self.nodes[node].children[side] = new as u32;
            let parent = node as u32;
            let number = self.next_number;
            let children = [BUD; 2];
            self.nodes.push(Node { position, parent, children, count: 2, load: 2, number, born: season });
            self.next_number += 1;
            appeared.push(position);
            (node, side) = (new, 0);
        }
        if node == origin as usize {
            self.nodes[node].children[side] = DEAD;
        }
    }

    /// Removes the metamers of `lowest`, ascending, and all above them; what is left where they were is `stump`.
    /// Returns the new place of each node, if any has moved.
    fn fell(&mut self, lowest: &[u32], stump: u32, fallen: &mut Vec<Vec3>) -> Option<Vec<u32>> {
        let first = *lowest.first()? as usize;
        let mut places: Vec<u32> = (0..self.nodes.len() as u32).collect();
        let mut lowest = lowest.iter().peekable();
        let mut kept = first;
        for old in first..self.nodes.len() {
            let node = self.nodes[old];
            let falls = lowest.next_if(|&&lowest| lowest as usize == old).is_some();
            if falls || places[node.parent as usize] == FALLS {
                places[old] = FALLS;
                fallen.push(node.position);
            } else {
                places[old] = kept as u32;
                self.nodes[kept] = Node { parent: places[node.parent as usize], ..node };
                kept += 1;
            }
        }
        self.nodes.truncate(kept);
        for child in self.nodes.iter_mut().flat_map(|node| &mut node.children) {
            if *child < DEAD {
                *child = places[*child as usize];
                if *child == FALLS {
                    *child = stump;
                }
            }
        }
        Some(places)
    }

    /// Step 5: the most buds each node ever carried.
    fn count(&mut self) {
        for node in (0..self.nodes.len()).rev() {
            let load = self.nodes[node].load.max(self.load_above(node));
            self.nodes[node].load = load;
            self.nodes[node].count = self.nodes[node].count.max(load);
        }
    }

    fn load_above(&self, node: usize) -> u32 {
        let of = |child: u32| if child < DEAD { self.nodes[child as usize].load } else { 1 };
        let [main, lateral] = self.nodes[node].children;
        if node == 0 { of(main) } else { of(main).saturating_add(of(lateral)) }
    }

    /// Cuts off the metamer below `node` and all above it; a bud takes its place. Returns what fell.
    pub(super) fn cut(&mut self, node: u32) -> Vec<Vec3> {
        let mut below = self.nodes[node as usize].parent as usize;
        let mut fallen = Vec::new();
        self.fell(&[node], BUD, &mut fallen);
        loop {
            self.nodes[below].load = self.load_above(below);
            if below == 0 {
                return fallen;
            }
            below = self.nodes[below].parent as usize;
        }
    }

    /// Whether it has given up: its trunk was shed, or it has not sprouted within the period of grace.
    pub(super) fn is_dead(&self, habit: &Habit, season: u16) -> bool {
        let grace = habit.shedding.map_or(u16::MAX, |shedding| shedding.grace);
        match self.nodes[0].children[0] {
            BUD => self.next_number == 1 && season - self.born() > grace,
            child => child == DEAD,
        }
    }
}
