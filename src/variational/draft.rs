//! A tree in the making: branch nodes, what is asked of them, and the shape nodes they carry.

use glam::DVec3;

use super::energy::Wish;
use super::level::Level;
use crate::math::sin_cos;
use crate::nearest::nearest;
use crate::random::{Purpose, unit};

/// Branch nodes come parents before children, the root first; every shape node hangs on one of them.
#[derive(Debug, Clone)]
pub(super) struct Draft {
    pub(super) positions: Vec<DVec3>,
    /// The root's is 0.
    pub(super) parents: Vec<u32>,
    /// The level in which each node was made, one more for branches than for their parent axis.
    pub(super) stages: Vec<u16>,
    pub(super) wishes: Vec<Wish>,
    /// For each shape node the branch node it hangs on.
    pub(super) owners: Vec<u32>,
}

/// Items in lists, by the number of the list each belongs to.
pub(super) struct Lists {
    pub(super) starts: Vec<u32>,
    pub(super) items: Vec<u32>,
}

impl Lists {
    /// Ascending within each list. O(n).
    pub(super) fn new(lists: usize, of: &[u32]) -> Self {
        let mut starts = vec![0; lists + 1];
        for &list in of {
            starts[list as usize + 1] += 1;
        }
        (0..lists).for_each(|list| starts[list + 1] += starts[list]);
        let mut next = starts.clone();
        let mut items = vec![0; of.len()];
        for (item, &list) in (0_u32..).zip(of) {
            items[next[list as usize] as usize] = item;
            next[list as usize] += 1;
        }
        Self { starts, items }
    }

    pub(super) fn of(&self, list: usize) -> &[u32] {
        &self.items[self.starts[list] as usize..self.starts[list + 1] as usize]
    }
}

impl Draft {
    /// A root with all shape nodes.
    pub(super) fn new(root: DVec3, shape_nodes: usize) -> Self {
        Self {
            positions: vec![root],
            parents: vec![0],
            stages: vec![0],
            wishes: vec![Wish::new(1.0)],
            owners: vec![0; shape_nodes],
        }
    }

    pub(super) fn len(&self) -> usize {
        self.positions.len()
    }

    pub(super) fn push(&mut self, position: DVec3, parent: usize, stage: u16, wish: Wish) -> usize {
        self.positions.push(position);
        self.parents.push(parent as u32);
        self.stages.push(stage);
        self.wishes.push(wish);
        self.len() - 1
    }

    /// `true` if a node may carry shape nodes and axes of later levels. The stem's nodes may not: they bear
    /// their n laterals and nothing else.
    pub(super) fn is_open(&self, node: usize) -> bool {
        self.stages[node] > 0
    }

    /// "Structure initialization" (section 4.2): on every open branch node of an earlier stage with at least `least` shape
    /// nodes an axis of level `stage`, towards the middle of these. The first level is the trunk's.
    pub(super) fn initialize(
        &mut self,
        levels: &[Level],
        stage: u16,
        least: usize,
        places: &[DVec3],
        seed: u64,
    ) {
        let before = self.len();
        let clusters = Lists::new(before, &self.owners);
        let mut bears = vec![false; before];
        let mut goes_on = vec![false; before];
        for node in 1..before {
            let parent = self.parents[node] as usize;
            bears[parent] = true;
            goes_on[parent] |= self.stages[node] == self.stages[parent];
        }
        let suits = |node: usize| {
            if stage == 0 {
                !bears[0]
            } else {
                self.is_open(node) && self.stages[node] <= stage && clusters.of(node).len() >= least
            }
        };
        let bases: Vec<usize> = (0..before).filter(|&node| suits(node)).collect();
        for base in bases {
            let cluster: Vec<DVec3> = clusters.of(base).iter().map(|&i| places[i as usize]).collect();
            let azimuth = std::f32::consts::TAU * unit(seed, u32::from(stage), Purpose::AZIMUTH, base as u64);
            // From the end of an axis it goes straight on; elsewhere it stands at that axis's angle.
            let lean = if goes_on[base] { levels[usize::from(self.stages[base])].angle() } else { 0.0 };
            self.axis(base, lean, &levels[usize::from(stage)], stage, &cluster, azimuth);
        }
    }

    /// One axis and its branches: figure 4.
    fn axis(&mut self, base: usize, lean: f32, level: &Level, stage: u16, cluster: &[DVec3], azimuth: f32) {
        let from = self.positions[base];
        let incoming = (from - self.positions[self.parents[base] as usize]).normalize_or(DVec3::Y);
        let middle = cluster.iter().map(|&place| place - from).sum::<DVec3>();
        let along = middle.normalize_or(incoming);
        let (low, high) = cluster
            .iter()
            .map(|&place| (place - from).dot(along))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), reach| (low.min(reach), high.max(reach)));
        let end = f64::from(level.apical_control()) * high.max(1e-3 * middle.length() / cluster.len() as f64);
        // Below the shape the axis is bare, but at most half of it.
        let start = low.clamp(0.0, 0.5 * end);
        // No more branches than shape nodes.
        let laterals = (level.laterals() as usize).min(cluster.len() - 1).max(1);
        let metamers = (cluster.len() / (1 + laterals)).clamp(1, level.metamers() as usize);
        let step = (end - start) / metamers as f64;
        if step <= 0.0 {
            return;
        }
        let (x, y) = along.any_orthonormal_pair();
        let (sin_angle, cos_angle) = sin_cos(level.angle());
        let mut node = base;
        let mut mates: Vec<usize> = Vec::new();
        for metamer in 0..metamers {
            let length = if metamer == 0 { start + step } else { step };
            let lean = if metamer == 0 { lean } else { 0.0 };
            let wish = Wish::new(length).with_angle(f64::from(lean));
            node = self.push(from + along * (start + step * (metamer + 1) as f64), node, stage, wish);
            let parent = node;
            let mut here = Vec::with_capacity(laterals);
            for lateral in 0..laterals {
                let around = std::f32::consts::TAU * lateral as f32 / laterals as f32;
                let (sin, cos) = sin_cos(azimuth + level.turn() * metamer as f32 + around);
                let side = x * f64::from(cos) + y * f64::from(sin);
                let leans = along * f64::from(cos_angle) + side * f64::from(sin_angle);
                let direction = if laterals == 1 && metamer + 1 == metamers { along } else { leans };
                let reach = LATERAL * reach(cluster, self.positions[parent], direction).unwrap_or(step);
                // A lone lateral at the axis's end is what the axis goes on as.
                let goes_on = laterals == 1 && metamer + 1 == metamers;
                let angle = if goes_on { 0.0 } else { level.angle() };
                let mut wish = Wish::new(reach).with_angle(f64::from(angle));
                if let Some(&mate) = mates.get(lateral).filter(|_| !goes_on) {
                    wish = wish.with_turn(mate as u32, f64::from(level.turn()));
                }
                let place = self.positions[parent] + direction * reach;
                here.push(self.push(place, parent, stage + 1, wish));
            }
            mates = here;
        }
    }

    /// Hangs every shape node on the open branch node nearest to it (section 4.2, "Shape partition").
    pub(super) fn partition(&mut self, places: &[DVec3]) {
        let open: Vec<u32> = (0..self.len() as u32).filter(|&node| self.is_open(node as usize)).collect();
        if open.is_empty() {
            self.owners = nearest(&self.positions, places);
            return;
        }
        let positions: Vec<DVec3> = open.iter().map(|&node| self.positions[node as usize]).collect();
        self.owners = nearest(&positions, places).into_iter().map(|i| open[i as usize]).collect();
    }

    /// Laterals of the stem that carry nothing get the shape node nearest to them, where others of their node
    /// carry something; otherwise a whorl would have gaps. Takes shape nodes only from nodes that have more
    /// than one.
    pub(super) fn feed_laterals(&mut self, places: &[DVec3]) {
        let orders = self.orders();
        let is_lateral =
            |node: usize| self.stages[node] == 1 && self.stages[self.parents[node] as usize] == 0;
        let mut fed = vec![false; self.len()];
        for node in (1..self.len()).filter(|&node| is_lateral(node) && orders[node] > 0) {
            fed[self.parents[node] as usize] = true;
        }
        let hungry: Vec<usize> = (1..self.len())
            .filter(|&node| is_lateral(node) && orders[node] == 0 && fed[self.parents[node] as usize])
            .collect();
        let mut carries = vec![0_u32; self.len()];
        self.owners.iter().for_each(|&owner| carries[owner as usize] += 1);
        for node in hungry {
            let from = self.positions[node];
            let free = (0..places.len()).filter(|&tip| carries[self.owners[tip] as usize] > 1);
            let nearest = free.min_by(|&a, &b| {
                places[a].distance_squared(from).total_cmp(&places[b].distance_squared(from))
            });
            if let Some(tip) = nearest {
                carries[self.owners[tip] as usize] -= 1;
                carries[node] += 1;
                self.owners[tip] = node as u32;
            }
        }
    }

    /// Takes away the nodes that carry no shape node, not even through others.
    pub(super) fn drop_idle(&mut self) {
        let orders = self.orders();
        self.keep(|node| orders[node] > 0);
    }

    /// "Topology refinement" (section 4.3): takes away the nodes of at most `order`, and hangs what they carried on the
    /// nearest of what is left. The stem and its laterals stay.
    pub(super) fn prune(&mut self, order: u32, places: &[DVec3]) {
        let orders = self.orders();
        let stays: Vec<bool> = (0..self.len())
            .map(|node| {
                orders[node] > order || self.stages[node].min(self.stages[self.parents[node] as usize]) == 0
            })
            .collect();
        self.keep(|node| stays[node]);
        self.partition(places);
    }

    /// "The order of a given node to be the maximal steps connecting shape nodes": 1 where all that it carries are
    /// shape nodes, 0 where it carries none.
    pub(super) fn orders(&self) -> Vec<u32> {
        let mut orders = vec![0; self.len()];
        self.owners.iter().for_each(|&owner| orders[owner as usize] = 1);
        for node in (1..self.len()).rev() {
            if orders[node] > 0 {
                let parent = self.parents[node] as usize;
                orders[parent] = orders[parent].max(orders[node] + 1);
            }
        }
        orders
    }

    /// Takes out the internodes that have shrunk to less than a tenth of the length asked for; all that
    /// sprang from them then springs from their parent node, unless that is on the stem or would bear more
    /// than `most`. Nodes of the stem that bear nothing go as well.
    pub(super) fn contract(&mut self, most: usize) {
        let mut bears = vec![0_usize; self.len()];
        self.owners.iter().for_each(|&owner| bears[owner as usize] += 1);
        self.parents.iter().skip(1).for_each(|&parent| bears[parent as usize] += 1);
        let mut has_lateral = vec![false; self.len()];
        (1..self.len()).for_each(|node| has_lateral[self.parents[node] as usize] |= self.is_open(node));
        let mut holds = vec![true; self.len()];
        for node in (1..self.len()).rev() {
            let parent = self.parents[node] as usize;
            let length = self.positions[node].distance(self.positions[parent]);
            let is_bare = !self.is_open(node) && !has_lateral[node] && bears[node] <= 1;
            let is_short = length < 0.1 * self.wishes[node].length;
            let fits = self.is_open(parent) && bears[parent] + bears[node] <= most + 1;
            if (is_bare && parent > 0) || (is_short && fits) {
                holds[node] = false;
                bears[parent] = bears[parent] + bears[node] - 1;
            } else if is_short && length > 0.0 {
                self.wishes[node].length = length;
            }
        }
        // The internode that goes on from a bare node is as long as both were to be.
        for node in 1..self.len() {
            let below = self.parents[node] as usize;
            if !holds[below] && !self.is_open(below) && !has_lateral[below] {
                self.wishes[node].length += self.wishes[below].length;
            }
        }
        self.keep(|node| holds[node]);
    }

    /// Keeps the root and the nodes that `holds` names; what hangs on others falls to the nearest kept node below.
    fn keep(&mut self, holds: impl Fn(usize) -> bool) {
        let mut names = vec![0_u32; self.len()];
        let mut kept = Self::new(self.positions[0], 0);
        let mut wishes = self.wishes.clone();
        for node in 1..self.len() {
            let below = self.parents[node] as usize;
            let parent = names[below];
            names[node] = parent;
            // An internode that went straight on from a removed node takes that node's place, and its angle.
            if below > 0 && !holds(below) && self.stages[below] == self.stages[node] {
                (wishes[node].angle, wishes[node].turn) = (wishes[below].angle, wishes[below].turn);
            }
            if holds(node) {
                let mut wish = wishes[node];
                wish.turn =
                    wish.turn.map(|(mate, turn)| (names[mate as usize], turn)).filter(|&(mate, _)| {
                        parent > 0
                            && mate > 0
                            && mate != parent
                            && kept.parents[mate as usize] == kept.parents[parent as usize]
                    });
                names[node] =
                    kept.push(self.positions[node], parent as usize, self.stages[node], wish) as u32;
            }
        }
        kept.owners = self.owners.iter().map(|&owner| names[owner as usize]).collect();
        *self = kept;
    }
}

/// Mean distance of the places ahead, within 60° of `direction`; `None` if there are none.
fn reach(places: &[DVec3], from: DVec3, direction: DVec3) -> Option<f64> {
    let mut count = 0_u32;
    let mut sum = 0.0;
    for &place in places {
        let way = place - from;
        let ahead = way.dot(direction);
        if ahead > 0.0 && ahead * ahead > 0.25 * way.length_squared() {
            count += 1;
            sum += ahead;
        }
    }
    (count > 0).then(|| sum / f64::from(count))
}

/// Place of a lateral's first fork, on the way to the middle of the shape nodes ahead of it.
const LATERAL: f64 = 0.4;
