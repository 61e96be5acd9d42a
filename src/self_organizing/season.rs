//! One season of one tree: steps 1 to 5 of the text.

use super::environment::{Bud, Environment};
use super::habit::Habit;
use super::room::Room;
use super::tree::{BUD, DEAD, DORMANT, FLOWER, Node, Site, Tree, is_node};
use super::vigor::Supply;
use crate::math;
use glam::Vec3;

/// In place of a node's new index: it falls.
pub(super) const FALLS: u32 = u32::MAX;

/// A bud that will grow.
#[derive(Debug, Clone, Copy)]
struct Shoot {
    node: u32,
    lateral: bool,
    /// The branch order of the shoot.
    order: u8,
    vigor: f32,
    /// The bud's place in the environment's list.
    index: u32,
}

/// Plan of a season for a tree.
#[derive(Debug, Default)]
pub(super) struct Plan {
    /// If there are to be parts, by node, main before lateral: those that have stood longest first.
    shoots: Vec<Shoot>,
    /// The lowest nodes of what will be shed, ascending.
    shed: Vec<u32>,
    vigor: f32,
    /// `true` if the tree dies and stays standing.
    dies: bool,
    /// The moments of what stands before shoots grow, if it sags.
    moments: Vec<Vec3>,
    /// Metamers that will appear, unless there is no room for them.
    pub(super) metamers: u64,
}

/// Number among the equal parts of a season's shoots.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    pub(super) index: u32,
    pub(super) of: u32,
}

/// Place and time of a tree's growth.
#[derive(Debug)]
pub(super) struct Setting<'a, E> {
    pub(super) environment: &'a E,
    pub(super) room: &'a Room,
    pub(super) habit: &'a Habit,
    pub(super) seed: u64,
    pub(super) season: u16,
}

/// Result of a season for a tree.
#[derive(Debug, Default)]
pub(super) struct Change {
    pub(super) appeared: Vec<Vec3>,
    pub(super) fallen: Vec<Vec3>,
    /// From where to where nodes have moved, those that have appeared included.
    pub(super) moved: Vec<(Vec3, Vec3)>,
    /// Nodes that stood before and are dead wood from now on.
    pub(super) died: Vec<Vec3>,
}

impl Tree {
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
        if let Some(died) = self.died {
            return Plan { shed: self.break_down(habit, died, season), ..Plan::default() };
        }
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
        let age = season.saturating_sub(self.born());
        let strength = habit.stature.map_or(1.0, |stature| stature.strength(age));
        let vigor = habit.vigor_multiplier * supply.light[0] * strength;
        // Nothing grows if sums of light leave the range of numbers.
        let mut plan = Plan { vigor: if vigor.is_finite() { vigor } else { 0.0 }, ..Plan::default() };
        supply.share(self, habit.vigor_model, plan.vigor, &mut |node, side, vigor| {
            if vigor >= 1.0 {
                let (order, lateral) = (self.nodes[node].order_of(side), side == 1);
                plan.shoots.push(Shoot {
                    node: node as u32,
                    lateral,
                    order,
                    vigor,
                    index: index(node, side),
                });
            }
        });
        self.release(season, &mut plan.shoots, strength, index);
        self.measure(habit, age, &mut plan);
        plan.shoots.shrink_to_fit();
        if parts > 1 || !self.releases.is_empty() {
            // The priority model goes from axis to axis, and what a cut has woken comes last.
            plan.shoots.sort_unstable_by_key(|shoot| (shoot.node, shoot.lateral));
        }
        if let Some(light) = environment.upkeep() {
            self.pay(habit.vigor_multiplier * light * strength, &mut supply.vigor);
        }
        self.shed(habit, season, &supply.vigor, &mut plan.shed);
        if habit.dead_wood.is_some() && plan.shed.first() == Some(&1) {
            return Plan { dies: true, ..Plan::default() };
        }
        plan
    }

    /// Gives the buds that a cut has woken the vigor they were promised.
    fn release(
        &self,
        season: u16,
        shoots: &mut Vec<Shoot>,
        strength: f32,
        index: impl Fn(usize, usize) -> u32,
    ) {
        if self.releases.is_empty() {
            return;
        }
        let mut promised: Vec<(usize, usize, f32)> = Vec::new();
        for release in &self.releases {
            let (Some(node), side) = (self.index_of(release.node), usize::from(release.lateral)) else {
                continue;
            };
            if self.nodes[node].children[side] == BUD && release.since + 1 == season {
                promised.push((node, side, release.vigor * strength));
            }
        }
        promised.sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(b.2.total_cmp(&a.2)));
        promised.dedup_by_key(|promise| (promise.0, promise.1));
        for shoot in shoots.iter_mut() {
            let place = (shoot.node as usize, usize::from(shoot.lateral));
            if let Ok(found) = promised.binary_search_by_key(&place, |promise| (promise.0, promise.1)) {
                shoot.vigor = shoot.vigor.max(promised[found].2);
                promised.remove(found);
            }
        }
        for (node, side, vigor) in promised {
            if vigor >= 1.0 {
                let order = self.nodes[node].order_of(side);
                let index = index(node, side);
                shoots.push(Shoot { node: node as u32, lateral: side == 1, order, vigor, index });
            }
        }
    }

    /// Takes from the shoots what their axes and the tree's stature do not allow, and counts their metamers.
    fn measure(&self, habit: &Habit, age: u16, plan: &mut Plan) {
        if !habit.axes.is_empty() {
            for shoot in &mut plan.shoots {
                if let Some(axis) = habit.axis(shoot.order) {
                    shoot.vigor = (shoot.vigor * axis.vigor).min(axis.longest);
                }
            }
        }
        if let Some(stature) = habit.stature {
            let top = self.foot().y + stature.height_at(age);
            let most = |shoot: &Shoot| {
                let room = top - self.nodes[shoot.node as usize].position.y;
                (room / (habit.length * shoot.vigor)).max(0.0)
            };
            let factor = plan.shoots.iter().map(most).fold(1.0, f32::min);
            for shoot in &mut plan.shoots {
                shoot.vigor *= factor;
            }
        }
        if habit.stature.is_some() || !habit.axes.is_empty() {
            plan.shoots.retain(|shoot| shoot.vigor >= 1.0);
        }
        let metamers: u64 = plan.shoots.iter().map(|shoot| u64::from(shoot.vigor as u32)).sum();
        plan.metamers = metamers.saturating_mul(u64::from(habit.phyllotaxis.nodes()));
    }

    /// Vigor that each metamer pays for itself if each living bud above it brings `each`.
    fn pay(&self, each: f32, vigor: &mut [f32]) {
        vigor.fill(0.0);
        for (node, data) in self.nodes.iter().enumerate().rev() {
            let buds = data.children.iter().filter(|&&child| child == BUD).count();
            vigor[node] += each * buds as f32;
            if node > 0 {
                vigor[data.parent as usize] += vigor[node];
            }
        }
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
        if habit.axes.iter().any(|axis| axis.lifespan.is_some()) {
            let falls = |node: &Node| {
                let parent = &self.nodes[node.parent as usize];
                let lifespan = habit.axis(node.order).and_then(|axis| axis.lifespan);
                node.order > parent.order && lifespan.is_some_and(|lifespan| season - node.born >= lifespan)
            };
            let old = self.nodes.iter().enumerate().skip(1).filter(|(_, node)| falls(node));
            shed.extend(old.map(|(node, _)| node as u32));
        }
        let old = shed.len();
        self.starve(habit, season, vigor, shed);
        if old > 0 {
            shed.sort_unstable();
            shed.dedup();
        }
        if !self.releases.is_empty() && !shed.is_empty() {
            // Metamers that bear buds which a cut has woken stay.
            let mut bears = vec![false; self.nodes.len()];
            for release in &self.releases {
                bears[self.index_of(release.node).unwrap_or_default()] = true;
            }
            for node in (1..self.nodes.len()).rev() {
                let parent = self.nodes[node].parent as usize;
                bears[parent] |= bears[node];
            }
            shed.retain(|&node| !bears[node as usize]);
        }
    }

    /// Metamers with too little vigor for their width.
    fn starve(&self, habit: &Habit, season: u16, vigor: &[f32], shed: &mut Vec<u32>) {
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
        // Dead wood is stiff.
        let sag = setting.habit.sag.filter(|_| self.died.is_none() && !plan.dies);
        if part.index == 0 {
            self.vigor = plan.vigor;
            if plan.dies {
                change.died = self.die(setting.season);
            }
            let grace = setting.habit.shedding.map_or(1, |shedding| shedding.grace);
            self.releases.retain(|release| setting.season.saturating_sub(release.since) <= grace);
            let stump = if self.died.is_some() { DEAD } else { DORMANT };
            if let Some(places) = self.fell(&plan.shed, stump, &mut change.fallen) {
                plan.shoots.retain_mut(|shoot| {
                    shoot.node = places[shoot.node as usize];
                    shoot.node != FALLS
                });
            }
            if let Some(sag) = sag {
                plan.moments = self.moments(setting.habit, sag);
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
            if let Some(sag) = sag {
                change.moved = self.sag(&std::mem::take(&mut plan.moments), sag, setting);
            }
        }
        change
    }

    /// Step 3: a shoot, as far as there is room. A bud without room for one metamer waits for another season.
    fn sprout<E: Environment>(&mut self, shoot: Shoot, setting: &Setting<'_, E>, appeared: &mut Vec<Vec3>) {
        let &Setting { environment, room, habit, seed, season } = setting;
        let Shoot { node: origin, lateral, order, vigor, index } = shoot;
        let bud = Bud { tree: self, habit, seed, node: origin, lateral, index };
        let (mut direction, optimal) = (bud.direction(), environment.direction(&bud));
        let metamers = vigor as u32;
        let length = habit.length * vigor / metamers as f32;
        let (axis, places) = (habit.axis(order), habit.phyllotaxis.nodes());
        let (mut node, mut side) = (origin as usize, usize::from(lateral));
        // The azimuth of a lateral follows from that of the node before on the same axis.
        let mut before = (origin > 0 && order == self.nodes[node].order && !lateral)
            .then(|| (direction, self.nodes[node].azimuth));
        'shoot: for metamer in 0..metamers {
            direction = habit.turned(direction, optimal, order);
            let lives = axis.is_none_or(|axis| axis.lives(metamer, metamers));
            let children = [BUD, if lives { BUD } else { DORMANT }];
            for place in 0..places {
                let start = self.nodes[node].position;
                let position = start + direction * (length * habit.phyllotaxis.part(place));
                if !(environment.admits(start, position) && room.is_open(start, position)) {
                    break 'shoot;
                }
                let first = self.number as u8;
                let azimuth = habit.phyllotaxis.azimuth(place, direction, before, first);
                before = Some((direction, azimuth));
                let new = self.nodes.len();
                self.nodes[node].children[side] = new as u32;
                let (parent, number) = (node as u32, self.next_number);
                let (count, load, born) = (2, 2, season);
                self.nodes.push(Node {
                    position,
                    parent,
                    children,
                    count,
                    load,
                    number,
                    born,
                    azimuth,
                    order,
                });
                self.next_number += 1;
                appeared.push(position);
                (node, side) = (new, 0);
            }
        }
        let has_grown = node != origin as usize;
        if has_grown && axis.is_some_and(|axis| axis.flowers) {
            self.nodes[node].children = [FLOWER, BUD];
        }
    }

    /// Step 5: the most buds each node ever carried.
    fn count(&mut self) {
        for node in (0..self.nodes.len()).rev() {
            let load = self.nodes[node].load.max(self.load_above(node));
            self.nodes[node].load = load;
            self.nodes[node].count = self.nodes[node].count.max(load);
        }
    }

    pub(super) fn load_above(&self, node: usize) -> u32 {
        let of = |child: u32| if is_node(child) { self.nodes[child as usize].load } else { 1 };
        let [main, lateral] = self.nodes[node].children;
        if node == 0 { of(main) } else { of(main).saturating_add(of(lateral)) }
    }

    /// `true` if nothing is left of it: its trunk was shed or has broken, or it has starved without metamers beyond the
    /// period of grace. A seed that has vigor but no room waits.
    pub(super) fn is_gone(&self, habit: &Habit, season: u16) -> bool {
        let grace = habit.shedding.map_or(u16::MAX, |shedding| shedding.grace);
        match self.nodes[0].children[0] {
            BUD => self.vigor < 1.0 && season.saturating_sub(self.bare_since) > grace,
            child => !is_node(child),
        }
    }
}
