//! Moves that change what hangs on what: subtrees that save wood elsewhere, twigs for bundles of shape nodes.

use glam::DVec3;

use super::draft::{Draft, Lists};
use super::energy::Wish;
use super::level::Level;
use super::model::{Nodes, Weights};
use super::term::angle;
use crate::nearest::nearest_few;

/// Children and shape nodes of a node, together, beyond which some are gathered on twigs.
pub(super) const MOST: usize = 4;

/// Branch nodes a subtree may look at for a better place; those of large subtrees are mostly its own.
const NEIGHBORS: [usize; 2] = [10, 64];
/// Subtrees of this part of all shape nodes are large.
const LARGE: f64 = 0.01;
/// A move must save this part of `F_I`; the moves end when none does.
const LEAST_SAVING: f64 = 1e-5;
/// The same for a move that takes a lateral from the stem, so that the stem keeps most of its N nodes.
const LEAST_OF_STEM: f64 = 5e-4;
/// Sweeps over all nodes, at most.
const SWEEPS: usize = 6;
/// A shape node goes to an internode nearby if that saves this part of its own cost.
const LEAST_SHARE: f64 = 0.02;

/// A draft with its children and flows at hand, whose nodes may come in any order.
pub(super) struct Graft<'a> {
    nodes: &'a Nodes,
    weights: Weights,
    levels: &'a [Level],
    draft: Draft,
    children: Vec<Vec<u32>>,
    carried: Vec<Vec<u32>>,
    flows: Vec<f64>,
    /// d^β of each node's internode.
    thick: Vec<f64>,
    gone: Vec<bool>,
    powers: Powers,
    /// `true` once all twigs are there, so that shape nodes stay on their branch nodes.
    has_twigs: bool,
}

/// Number of straight lines by which an internode's d^β as a function of its flow is drawn. A hundred thousand powers would
/// take most of the time of a sweep.
struct Powers {
    power: f64,
    less: Vec<f64>,
    more: Vec<f64>,
}

impl Powers {
    const PLACES: usize = 256;

    fn new(power: f64) -> Self {
        let at = |i: usize| i as f64 / Self::PLACES as f64;
        let table = |of: &dyn Fn(f64) -> f64| (0..=Self::PLACES).map(|i| of(at(i))).collect();
        Self {
            power,
            less: table(&|x| 1.0 - libm::pow(1.0 - x, power)),
            more: table(&|x| libm::pow(1.0 + x, power) - 1.0),
        }
    }

    fn between(table: &[f64], x: f64) -> f64 {
        let place = x.clamp(0.0, 1.0) * Self::PLACES as f64;
        let below = (place as usize).min(Self::PLACES - 1);
        table[below] + (table[below + 1] - table[below]) * (place - below as f64)
    }

    /// 1 - (1 - x)^p.
    fn less(&self, x: f64) -> f64 {
        Self::between(&self.less, x)
    }

    /// (1 + x)^p - 1.
    fn more(&self, x: f64) -> f64 {
        if x <= 1.0 { Self::between(&self.more, x) } else { libm::pow(1.0 + x, self.power) - 1.0 }
    }
}

/// Child of a node: a branch node, or a shape node.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Item {
    Branch(u32),
    Tip(u32),
}

impl<'a> Graft<'a> {
    pub(super) fn new(draft: &Draft, nodes: &'a Nodes, weights: Weights, levels: &'a [Level]) -> Self {
        let count = draft.len();
        let mut children = vec![Vec::new(); count];
        for node in 1..count {
            children[draft.parents[node] as usize].push(node as u32);
        }
        let lists = Lists::new(count, &draft.owners);
        let carried: Vec<Vec<u32>> = (0..count).map(|node| lists.of(node).to_vec()).collect();
        let mut flows = vec![0.0; count];
        for (&owner, flow) in draft.owners.iter().zip(&nodes.flows) {
            flows[owner as usize] += flow;
        }
        for node in (1..count).rev() {
            flows[draft.parents[node] as usize] += flows[node];
        }
        let mut graft = Self {
            nodes,
            weights,
            levels,
            draft: draft.clone(),
            children,
            carried,
            flows,
            thick: Vec::new(),
            gone: vec![false; count],
            powers: Powers::new(weights.power),
            has_twigs: false,
        };
        graft.thick = graft.flows.iter().map(|&flow| graft.thick(flow)).collect();
        graft
    }

    fn thick(&self, flow: f64) -> f64 {
        if flow > 0.0 { self.nodes.unit * libm::pow(flow, self.weights.power) } else { 0.0 }
    }

    fn at(&self, node: u32) -> DVec3 {
        self.draft.positions[node as usize]
    }

    fn parent(&self, node: u32) -> u32 {
        self.draft.parents[node as usize]
    }

    fn length(&self, node: u32) -> f64 {
        self.at(node).distance(self.at(self.parent(node)))
    }

    /// θ of what branches off at a node.
    fn angle_at(&self, node: u32) -> f64 {
        let level = usize::from(self.draft.stages[node as usize]).min(self.levels.len() - 1);
        f64::from(self.levels[level].angle())
    }

    /// Hangs subtrees on nearby nodes where that saves wood and strain, until no such move saves more than
    /// [`LEAST_SAVING`] of the wood. Returns whether there was any.
    ///
    /// O(n k h) per sweep for k neighbours and trees h nodes deep.
    pub(super) fn rehang(&mut self) -> bool {
        let wood: f64 =
            (1..self.draft.len() as u32).map(|node| self.thick[node as usize] * self.length(node)).sum();
        let large: Vec<u32> = (1..self.draft.len() as u32)
            .filter(|&node| self.flows[node as usize] > LARGE * self.flows[0])
            .collect();
        let places: Vec<DVec3> = large.iter().map(|&node| self.at(node)).collect();
        let mut neighbors = nearest_few(&self.draft.positions, &self.draft.positions, NEIGHBORS[0]);
        for (node, more) in large.into_iter().zip(nearest_few(&self.draft.positions, &places, NEIGHBORS[1])) {
            neighbors[node as usize] = more;
        }
        let mut marks: Vec<(u32, f64)> = vec![(0, 0.0); self.draft.len()];
        let (mut any, mut turn) = (false, 0);
        for _ in 0..SWEEPS {
            let mut moved = false;
            for node in 1..self.draft.len() as u32 {
                turn += 1;
                let best = self.better_place(node, &neighbors[node as usize], turn, &mut marks);
                let of_stem = self.draft.stages[self.parent(node) as usize] == 0;
                let least = if of_stem { LEAST_OF_STEM } else { LEAST_SAVING };
                if let Some((place, gain)) = best.filter(|&(_, gain)| gain > least * wood) {
                    debug_assert!(gain.is_finite());
                    self.move_to(node, place);
                    moved = true;
                }
            }
            any |= moved;
            if !moved {
                break;
            }
        }
        any
    }

    /// `true` if a subtree may be moved to another parent. The stem stays, whorls of its laterals stay, and
    /// no node may lose the last thing that it carries.
    fn is_free(&self, node: u32) -> bool {
        let parent = self.parent(node) as usize;
        let left = self.children[parent].len() + self.carried[parent].len() - 1;
        match (self.draft.stages[node as usize], self.draft.stages[parent]) {
            (0, _) => false,
            (_, 0) => self.levels[0].laterals() == 1,
            _ => left > 0,
        }
    }

    /// The neighbour on which a subtree costs least, and how much less than where it is.
    ///
    /// `marks` has for each ancestor, where it is of this `turn`, what the internodes up to it save without the node's flow.
    fn better_place(
        &self,
        node: u32,
        neighbors: &[u32],
        turn: u32,
        marks: &mut [(u32, f64)],
    ) -> Option<(u32, f64)> {
        if self.gone[node as usize] || !self.is_free(node) {
            return None;
        }
        let flow = self.flows[node as usize];
        let (old, thick) = (self.parent(node), self.thick[node as usize]);
        // The cost that the internodes below each ancestor save.
        let (mut saved, mut below) = (0.0, old);
        marks[below as usize] = (turn, 0.0);
        while below != 0 {
            let through = self.flows[below as usize];
            saved += self.length(below) * self.thick[below as usize] * self.powers.less(flow / through);
            below = self.parent(below);
            marks[below as usize] = (turn, saved);
        }
        let here = thick * self.length(node);
        let strain = self.strain(node, old, self.draft.wishes[node as usize].length, thick);
        let mut best = None;
        for &place in neighbors {
            let closed = self.draft.stages[place as usize] == 0 || self.gone[place as usize];
            let bears = self.children[place as usize].len()
                + if self.has_twigs { self.carried[place as usize].len() } else { 1 };
            if place == old || place == node || closed || bears >= MOST {
                continue;
            }
            let length = self.at(place).distance(self.at(node));
            let mut gain = here - thick * length;
            if gain + saved <= 0.0 || length <= 0.0 {
                continue;
            }
            let mut below = place;
            let meets = loop {
                if below == node {
                    break None;
                }
                let (of, saved) = marks[below as usize];
                if of == turn {
                    break Some(saved);
                }
                let through = self.flows[below as usize];
                gain -= self.length(below) * self.thick[below as usize] * self.powers.more(flow / through);
                below = self.parent(below);
            };
            let Some(saved) = meets else { continue };
            gain += saved + self.weights.mu * (strain - self.strain(node, place, length, thick));
            if best.is_none_or(|(_, most)| gain > most) {
                best = Some((place, gain));
            }
        }
        best
    }

    /// Share of `F_P` at the base of a subtree that hangs on `place`, with that wish for its length.
    fn strain(&self, node: u32, place: u32, wished: f64, thick: f64) -> f64 {
        let way = self.at(node).distance(self.at(place));
        let mut sum = thick * (way - wished).abs();
        let before = self.at(self.parent(place));
        if let Some(wanted) = self.draft.wishes[node as usize].angle.filter(|_| place != 0) {
            let found = angle(before, self.at(place), self.at(node)).value;
            sum += thick * wished * (found - wanted).abs();
        }
        for &child in &self.children[node as usize] {
            let wish = self.draft.wishes[child as usize];
            if let Some(wanted) = wish.angle {
                let found = angle(self.at(place), self.at(node), self.at(child)).value;
                sum += self.thick[child as usize] * wish.length * (found - wanted).abs();
            }
        }
        sum
    }

    fn add_flow(&mut self, mut node: u32, flow: f64) {
        loop {
            self.flows[node as usize] += flow;
            self.thick[node as usize] = self.thick(self.flows[node as usize]);
            if node == 0 {
                break;
            }
            node = self.parent(node);
        }
    }

    fn move_to(&mut self, node: u32, place: u32) {
        let (old, flow) = (self.parent(node), self.flows[node as usize]);
        self.children[old as usize].retain(|&child| child != node);
        self.add_flow(old, -flow);
        self.draft.parents[node as usize] = place;
        self.children[place as usize].push(node);
        self.add_flow(place, flow);
        let angle = self.draft.wishes[node as usize].angle.unwrap_or_default();
        let mut wish = Wish::new(self.length(node));
        wish.angle = Some(if angle > 0.0 { angle } else { self.angle_at(place) });
        self.draft.wishes[node as usize] = wish;
        // A stem's node without its lateral is none.
        if self.draft.stages[old as usize] == 0 && old != 0 {
            self.dissolve(old);
        }
    }

    /// Takes out a node of the stem that bears nothing but the stem, or nothing at all.
    fn dissolve(&mut self, node: u32) {
        let below = self.parent(node);
        match self.children[node as usize][..] {
            [] => {
                self.gone[node as usize] = true;
                self.children[below as usize].retain(|&child| child != node);
            }
            [next] if self.draft.stages[next as usize] == 0 => {
                self.gone[node as usize] = true;
                let mut wish = self.draft.wishes[node as usize];
                wish.length += self.draft.wishes[next as usize].length;
                self.draft.wishes[next as usize] = wish;
                self.draft.parents[next as usize] = below;
                let slot = self.children[below as usize].iter().position(|&child| child == node);
                if let Some(slot) = slot {
                    self.children[below as usize][slot] = next;
                }
            }
            _ => {}
        }
    }

    /// Hangs shape nodes on internodes nearby, then gathers pairs on twigs: where that saves, and where a node carries
    /// more than [`MOST`]. O(n m²) for m per node.
    pub(super) fn grow_twigs(&mut self) {
        for tip in 0..self.draft.owners.len() as u32 {
            self.hang_beside(tip);
        }
        for node in 0..self.draft.len() as u32 {
            if !self.gone[node as usize] {
                self.gather(node);
            }
        }
        self.has_twigs = true;
    }

    /// Says that there will be no more twigs, see [`grow_twigs`](Self::grow_twigs).
    pub(super) fn with_twigs(mut self) -> Self {
        self.has_twigs = true;
        self
    }

    /// Cost of a shape node per metre that it hangs off.
    fn pull(&self, tip: u32) -> f64 {
        let tip = tip as usize;
        self.nodes.costs[tip] + self.weights.lambda * self.nodes.shares[tip]
    }

    /// Moves a shape node from the end of an internode to a new node in it, if it is nearer to that.
    fn hang_beside(&mut self, tip: u32) {
        let owner = self.draft.owners[tip as usize];
        let alone = self.children[owner as usize].len() + self.carried[owner as usize].len() < 2;
        if owner == 0 || alone {
            return;
        }
        let (place, pull) = (self.nodes.places[tip as usize], self.pull(tip));
        let (own, away) = (self.nodes.flows[tip as usize], self.at(owner).distance(place));
        let mut best: Option<(f64, u32, f64, DVec3)> = None;
        for node in std::iter::once(owner).chain(self.children[owner as usize].iter().copied()) {
            if self.draft.stages[node as usize] == 0 {
                continue;
            }
            let (from, way) = (self.at(self.parent(node)), self.at(node) - self.at(self.parent(node)));
            let share = (place - from).dot(way) / way.length_squared().max(f64::MIN_POSITIVE);
            if !(0.1..=0.9).contains(&share) {
                continue;
            }
            let beside = from + way * share;
            let through = self.flows[node as usize];
            let along = if node == owner {
                (1.0 - share) * self.thick[node as usize] * self.powers.less(own / through)
            } else {
                -share * self.thick[node as usize] * self.powers.more(own / through)
            };
            let gain = pull * (away - beside.distance(place)) + along * way.length();
            if gain > LEAST_SHARE * pull * away && best.is_none_or(|(most, ..)| gain > most) {
                best = Some((gain, node, share, beside));
            }
        }
        let Some((_, node, share, beside)) = best else { return };
        self.carried[owner as usize].retain(|&other| other != tip);
        let between = self.insert(node, share, beside);
        self.carried[between as usize].push(tip);
        self.draft.owners[tip as usize] = between;
        let thicker = if node == owner { self.flows[node as usize] } else { self.flows[node as usize] + own };
        self.set_flow(between, thicker);
        if node == owner {
            self.set_flow(node, self.flows[node as usize] - own);
        }
    }

    fn set_flow(&mut self, node: u32, flow: f64) {
        self.flows[node as usize] = flow;
        self.thick[node as usize] = self.thick(flow);
    }

    fn push(&mut self, position: DVec3, parent: u32, stage: u16, wish: Wish) -> u32 {
        self.draft.push(position, parent as usize, stage, wish);
        self.children.push(Vec::new());
        self.carried.push(Vec::new());
        self.flows.push(0.0);
        self.thick.push(0.0);
        self.gone.push(false);
        self.draft.len() as u32 - 1
    }

    /// A new node in the internode to `node`, of which `share` lies below it. The targets of the internode
    /// pass to its lower part, and the upper goes straight on.
    fn insert(&mut self, node: u32, share: f64, position: DVec3) -> u32 {
        let (parent, mut wish) = (self.parent(node), self.draft.wishes[node as usize]);
        let whole = wish.length;
        wish.length = whole * share;
        let between = self.push(position, parent, self.draft.stages[node as usize], wish);
        self.draft.wishes[node as usize] = Wish::new(whole * (1.0 - share)).with_angle(0.0);
        self.draft.parents[node as usize] = between;
        for child in &mut self.children[parent as usize] {
            if *child == node {
                *child = between;
            }
        }
        self.children[between as usize].push(node);
        between
    }

    fn gather(&mut self, node: u32) {
        let is_stem = self.draft.stages[node as usize] == 0;
        let tips = self.carried[node as usize].iter().map(|&tip| Item::Tip(tip));
        let mut items: Vec<Item> = tips.collect();
        // Laterals of the stem stay where they are.
        if !is_stem {
            items.extend(self.children[node as usize].iter().map(|&child| Item::Branch(child)));
        }
        while items.len() > 1 {
            let all = self.children[node as usize].len() + self.carried[node as usize].len();
            let forced = all > MOST;
            let mut best: Option<(f64, usize, usize, DVec3)> = None;
            for second in 1..items.len() {
                for first in 0..second {
                    let both = [items[first], items[second]];
                    // Branches keep their bases unless there are too many.
                    if !forced && both.iter().any(|item| matches!(item, Item::Branch(_))) {
                        continue;
                    }
                    let (gain, place) = self.gain(node, both);
                    if best.is_none_or(|(most, ..)| gain > most) {
                        best = Some((gain, first, second, place));
                    }
                }
            }
            let Some((_, first, second, place)) = best.filter(|&(gain, ..)| forced || gain > 0.0) else {
                break;
            };
            let both = [items[first], items[second]];
            items.remove(second);
            items.remove(first);
            items.push(Item::Branch(self.twig(node, both, place)));
        }
    }

    /// Position of an item, its flow, and its cost per metre.
    fn item(&self, item: Item) -> (DVec3, f64, f64) {
        match item {
            Item::Branch(node) => {
                let flow = self.flows[node as usize];
                (self.at(node), flow, self.thick[node as usize])
            }
            Item::Tip(tip) => {
                (self.nodes.places[tip as usize], self.nodes.flows[tip as usize], self.pull(tip))
            }
        }
    }

    /// The cost that two items of a node save if they share a twig, and the twig's end, found by Weiszfeld's
    /// steps from the best of some places on the way to the middle of both.
    fn gain(&self, node: u32, both: [Item; 2]) -> (f64, DVec3) {
        let from = self.at(node);
        let [(a, flow_a, pull_a), (b, flow_b, pull_b)] = both.map(|item| self.item(item));
        let thick = self.thick(flow_a + flow_b);
        let wanted = self.angle_at(node);
        let before = self.at(self.parent(node));
        let cost = |place: DVec3| {
            let lean = if node == 0 { 0.0 } else { (angle(before, from, place).value - wanted).abs() };
            thick * place.distance(from) * (1.0 + self.weights.mu * lean)
                + pull_a * place.distance(a)
                + pull_b * place.distance(b)
        };
        let middle = (a * pull_a + b * pull_b) / (pull_a + pull_b);
        let mut best = (f64::INFINITY, middle);
        for share in [0.25, 0.5, 0.75] {
            let place = from.lerp(middle, share);
            let found = cost(place);
            if found < best.0 {
                best = (found, place);
            }
        }
        for _ in 0..2 {
            let stiff = |pull: f64, to: DVec3| pull / best.1.distance(to).max(1e-9);
            let [f, s, t] = [stiff(thick, from), stiff(pull_a, a), stiff(pull_b, b)];
            let place = (from * f + a * s + b * t) / (f + s + t);
            let found = cost(place);
            if found >= best.0 {
                break;
            }
            best = (found, place);
        }
        (pull_a * from.distance(a) + pull_b * from.distance(b) - best.0, best.1)
    }

    fn twig(&mut self, node: u32, both: [Item; 2], place: DVec3) -> u32 {
        let length = place.distance(self.at(node)).max(1e-9);
        let wish = Wish::new(length).with_angle(self.angle_at(node));
        let twig = self.push(place, node, self.draft.stages[node as usize].saturating_add(1), wish);
        self.children[node as usize].push(twig);
        let flow = both.iter().map(|&item| self.item(item).1).sum();
        self.set_flow(twig, flow);
        for item in both {
            match item {
                Item::Branch(child) => {
                    let before = self.length(child).max(1e-9);
                    self.children[node as usize].retain(|&other| other != child);
                    self.children[twig as usize].push(child);
                    self.draft.parents[child as usize] = twig;
                    let after = self.length(child).max(1e-3 * before);
                    self.draft.wishes[child as usize].length *= after / before;
                }
                Item::Tip(tip) => {
                    self.carried[node as usize].retain(|&other| other != tip);
                    self.carried[twig as usize].push(tip);
                    self.draft.owners[tip as usize] = twig;
                }
            }
        }
        twig
    }

    /// The draft, parents before children again; turns against nodes that are no longer at hand are dropped.
    pub(super) fn finish(self) -> Draft {
        let mut names = vec![u32::MAX; self.draft.len()];
        let mut made = Draft::new(self.draft.positions[0], 0);
        let mut order = vec![0u32];
        names[0] = 0;
        let mut next = 0;
        while next < order.len() {
            let node = order[next];
            next += 1;
            for &child in &self.children[node as usize] {
                let (parent, stage) = (names[node as usize], self.draft.stages[child as usize]);
                let wish = self.draft.wishes[child as usize];
                let name = made.push(self.at(child), parent as usize, stage, wish);
                names[child as usize] = name as u32;
                order.push(child);
            }
        }
        for node in 1..made.len() {
            let parent = made.parents[node];
            made.wishes[node].turn = made.wishes[node].turn.and_then(|(mate, turn)| {
                let mate = names[mate as usize];
                let holds = mate != u32::MAX
                    && parent > 0
                    && mate > 0
                    && mate != parent
                    && made.parents[mate as usize] == made.parents[parent as usize];
                holds.then_some((mate, turn))
            });
        }
        made.owners = self.draft.owners.iter().map(|&owner| names[owner as usize]).collect();
        made
    }
}
