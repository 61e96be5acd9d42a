//! A finished search brought up to date after its tree or its weights have changed in places.
//!
//! Ramalingam and Reps 1996, "An Incremental Algorithm for a Generalization of the Shortest-Path Problem", with one more
//! thing to see to: a node's vector is fixed when the node is settled, from its path, so where a path changes, all that
//! hangs on it is searched anew, even if its cost stays. The result is that of a search from nothing, to the
//! bit.

use super::fork::Fork;
use super::graph::Graph;
use super::run::Terms;
use super::search::{Guide, NO_VECTOR, NONE, Search, SearchError};
use crate::shape::Bounds;
use glam::Vec3;
use std::cmp::Ordering;
use std::mem::take;
use std::sync::OnceLock;

/// The nodes from which edges lead to each node.
#[derive(Debug, Clone)]
pub(super) struct Origins {
    starts: Vec<u32>,
    nodes: Vec<u32>,
    /// Length of the longest edge, metres.
    longest: f32,
}

impl Origins {
    pub(super) fn of(graph: &Graph) -> Self {
        let nodes = graph.nodes() as u32;
        let mut starts = vec![0u32; graph.nodes() + 1];
        let ends = || (0..nodes).flat_map(|from| graph.neighbours(from).iter().map(move |&to| (from, to)));
        ends().for_each(|(_, to)| starts[to as usize + 1] += 1);
        for node in 0..graph.nodes() {
            starts[node + 1] += starts[node];
        }
        let mut next = starts.clone();
        let mut origins = vec![0; graph.edges()];
        for (from, to) in ends() {
            origins[next[to as usize] as usize] = from;
            next[to as usize] += 1;
        }
        let length = |(from, to)| graph.position(from).distance(graph.position(to));
        Self { starts, nodes: origins, longest: ends().map(length).fold(0.0, f32::max) }
    }

    fn of_node(&self, node: u32) -> &[u32] {
        &self.nodes[self.starts[node as usize] as usize..self.starts[node as usize + 1] as usize]
    }
}

/// A node of the tree, as it comes into a stage.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) node: u32,
    pub(super) parent: u32,
    pub(super) stage: u16,
    pub(super) guide: Guide,
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        let numbers = |entry: &Self| (entry.node, entry.parent, entry.stage, entry.guide.hops);
        numbers(self) == numbers(other)
            && self.guide.length.to_bits() == other.guide.length.to_bits()
            && is_same(self.guide.vector, other.guide.vector)
    }
}

fn is_same(a: Vec3, b: Vec3) -> bool {
    a.to_array().map(f32::to_bits) == b.to_array().map(f32::to_bits)
}

/// Quantities that rules and weights have asked for in a stage; their results depend on them.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Asked {
    forks: bool,
    beside: bool,
}

impl Asked {
    pub(super) fn by(search: &Search<'_>) -> Self {
        Self { forks: search.forks.get().is_some(), beside: search.asked_beside.get().is_some() }
    }
}

impl Search<'_> {
    /// Takes these trees instead of those it has; costs and paths off them stay.
    pub(super) fn install(&mut self, entries: &[Entry]) {
        self.forgotten = false;
        for &node in &self.tree {
            self.place[node as usize] = NONE;
            self.on_tree[node as usize / 64] = 0;
        }
        self.tree.clear();
        self.stages.clear();
        self.owners.clear();
        for entry in entries {
            self.parents[entry.node as usize] = entry.parent;
            self.guides[entry.node as usize] = entry.guide;
            self.join(entry.node, entry.stage);
        }
    }

    /// The trees as they are.
    pub(super) fn entries(&self) -> Vec<Entry> {
        let entry = |(&node, &stage): (&u32, &u16)| {
            let guide = Guide { source: node, ..self.guides[node as usize] };
            Entry { node, parent: self.parents[node as usize], stage, guide }
        };
        self.tree.iter().zip(&self.stages).map(entry).collect()
    }

    /// Brings a search that went to its end up to date with other trees, and with rules and weights that differ in
    /// boxes. The number of nodes searched anew; `None` if a search from nothing is better: then nothing is sound but
    /// the trees.
    pub(super) fn repair(
        &mut self,
        entries: &[Entry],
        boxes: &[Bounds],
        asked: &mut Asked,
        origins: &Origins,
        terms: &Terms<'_>,
    ) -> Result<Option<usize>, SearchError> {
        let graph = self.graph.clone();
        self.forgotten = false;
        let state = vec![State::Valid; graph.nodes()];
        let (list, stack) = (Vec::new(), Vec::new());
        let mut repair = Repair {
            search: self,
            graph: &graph,
            origins,
            terms,
            state,
            list,
            stack,
            is_clear: true,
            anew: 0,
        };
        repair.change(entries, boxes, *asked)?;
        repair.go_on()?;
        let (is_clear, anew) = (repair.is_clear, repair.anew);
        self.queue.clear();
        let now = Asked::by(self);
        *asked = Asked { forks: asked.forks | now.forks, beside: asked.beside | now.beside };
        Ok(is_clear.then_some(anew))
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// As the search before left it.
    Valid,
    /// To be searched anew.
    Open,
    /// Settled anew.
    Done,
}

struct Repair<'a, 'g> {
    search: &'a mut Search<'g>,
    graph: &'a Graph,
    origins: &'a Origins,
    terms: &'a Terms<'a>,
    state: Vec<State>,
    /// Opened, and not yet offered any way.
    list: Vec<u32>,
    /// Opened or changed, and what hangs on it not yet seen to.
    stack: Vec<u32>,
    /// `true` while a search from nothing would have taken the same ways for certain, and this is
    /// faster.
    is_clear: bool,
    anew: usize,
}

impl Repair<'_, '_> {
    /// Puts the new trees in place and opens all whose way or vector may differ.
    fn change(&mut self, entries: &[Entry], boxes: &[Bounds], asked: Asked) -> Result<(), SearchError> {
        let search = &mut *self.search;
        let old: Vec<u32> = search.tree.clone();
        let old_forks: Option<Vec<Fork>> = asked.forks.then(|| {
            old.iter().map(|&node| search.fork(node).unwrap_or_else(|| Fork::new(Vec3::Y))).collect()
        });
        // Place, parent and vector of each node of the new trees before.
        let before: Vec<(Option<usize>, u32, Vec3)> = entries
            .iter()
            .map(|entry| {
                let node = entry.node as usize;
                (search.place(entry.node), search.parents[node], search.guides[node].vector)
            })
            .collect();
        search.install(entries);
        search.forks = OnceLock::new();
        let mut moved: Vec<u32> = Vec::new();
        for &node in old.iter().filter(|&&node| search.place[node as usize] == NONE) {
            moved.push(node);
        }
        let mut changed = vec![false; entries.len()];
        for (place, (entry, &(was, parent, vector))) in entries.iter().zip(&before).enumerate() {
            let now = search.source_vector(entry.node, self.terms)?;
            let fork_differs = || {
                let forks = old_forks.as_ref()?;
                Some(search.fork(entry.node)? != *forks.get(was?)?)
            };
            let above = search.parent(entry.node).and_then(|parent| search.place(parent));
            changed[place] = was.is_none()
                || parent != entry.parent
                || !is_same(vector, now)
                || above.is_some_and(|above| changed[above])
                || fork_differs().unwrap_or(false);
            search.guides[entry.node as usize].vector = now;
            if was.is_none() {
                moved.push(entry.node);
            }
        }
        let changed: Vec<u32> = entries
            .iter()
            .zip(changed)
            .filter(|&(_, changed)| changed)
            .map(|(entry, _)| entry.node)
            .collect();
        for &node in &moved {
            self.open(node);
        }
        self.stack.extend_from_slice(&changed);
        self.open_hanging();
        if asked.beside {
            for &node in &moved {
                for &beside in self.origins.of_node(node) {
                    self.open(beside);
                }
            }
        }
        if !boxes.is_empty() {
            self.open_edges_in(boxes);
        }
        self.open_hanging();
        self.offer_to_list()?;
        changed.iter().try_for_each(|&source| self.relax(source))
    }

    /// Nodes that an edge leads to which touches a box.
    fn open_edges_in(&mut self, boxes: &[Bounds]) {
        let graph = self.graph;
        let meets = |a: Vec3, b: Vec3| {
            let (low, high) = (a.min(b), a.max(b));
            boxes.iter().any(|bounds| low.cmple(bounds.max).all() && high.cmpge(bounds.min).all())
        };
        // No edge is longer, whatever its ends round to.
        let longest = self.origins.longest * 1.01;
        let near: Vec<Bounds> = boxes.iter().map(|bounds| bounds.grown(longest)).collect();
        for from in 0..graph.nodes() as u32 {
            let start = graph.position(from);
            if !near.iter().any(|bounds| bounds.contains(start)) {
                continue;
            }
            for &to in graph.neighbours(from) {
                if meets(start, graph.position(to)) {
                    self.open(to);
                }
            }
        }
    }

    /// A node off the trees loses its way.
    fn open(&mut self, node: u32) {
        let here = node as usize;
        if self.search.place[here] != NONE || self.state[here] == State::Open {
            return;
        }
        // Nodes of equal cost that hang on each other: their order is the search's affair.
        self.is_clear &= self.state[here] != State::Done;
        self.lose(node);
        self.stack.push(node);
    }

    fn lose(&mut self, node: u32) {
        let here = node as usize;
        self.state[here] = State::Open;
        (self.search.costs[here], self.search.parents[here]) = (f32::INFINITY, NONE);
        self.search.guides[here].vector = NO_VECTOR;
        self.list.push(node);
        self.anew += 1;
        // Much more would not be faster than a search from nothing.
        self.is_clear &= self.anew <= self.graph.nodes() / 3;
    }

    /// Nodes that hang on opened nodes and changed sources lose their way too.
    fn open_hanging(&mut self) {
        while self.is_clear
            && let Some(node) = self.stack.pop()
        {
            for &to in self.graph.neighbours(node) {
                if self.search.parents[to as usize] == node && self.search.place[to as usize] == NONE {
                    match self.state[to as usize] {
                        // Offered a way from here that is no more.
                        State::Open => self.lose(to),
                        _ => self.open(to),
                    }
                }
            }
        }
    }

    /// `true` if cost and vector of a node are final.
    fn is_final(&self, node: u32) -> bool {
        self.state[node as usize] != State::Open && self.search.is_settled(node)
    }

    /// The best ways to opened nodes from those that are final.
    fn offer_to_list(&mut self) -> Result<(), SearchError> {
        for node in take(&mut self.list) {
            if !self.is_clear {
                return Ok(());
            }
            let end = [(node, self.graph.position(node))];
            for &from in self.origins.of_node(node) {
                let cost = self.search.costs[from as usize];
                if !self.is_final(from) || cost > self.search.costs[node as usize] {
                    continue;
                }
                let mut weight = [0.0];
                self.search.weigh(self.graph, from, &end, &mut weight, self.terms)?;
                let through = cost + weight[0] + 0.0;
                if self.is_better(from, node, through) {
                    self.search.costs[node as usize] = through;
                    self.search.parents[node as usize] = from;
                }
            }
            let cost = self.search.costs[node as usize];
            if cost < f32::INFINITY {
                self.search.queue.push(cost, node);
            }
        }
        Ok(())
    }

    /// `true` if a search from nothing takes this way rather than the known one: it is cheaper, or
    /// costs the same and its start is settled first.
    fn is_better(&mut self, from: u32, to: u32, through: f32) -> bool {
        let (known, before) = (self.search.costs[to as usize], self.search.parents[to as usize]);
        // Neither is NaN, and no cost is -0.
        match through.total_cmp(&known) {
            Ordering::Less => return true,
            Ordering::Equal if through < f32::INFINITY && before != from => {}
            _ => return false,
        }
        let cost = |node: u32| self.search.costs[node as usize];
        match cost(from).total_cmp(&cost(before)) {
            Ordering::Less => return true,
            Ordering::Equal => {}
            Ordering::Greater => return false,
        }
        // Nodes of one cost that come from lower ones are in the queue together, and leave it by number.
        let from_below =
            |node: u32| self.search.is_on_tree(node) || cost(self.search.parents[node as usize]) < cost(node);
        self.is_clear &= from_below(from) && from_below(before);
        from < before
    }

    fn go_on(&mut self) -> Result<(), SearchError> {
        while self.is_clear
            && let Some((cost, node)) = self.search.queue.pop(|_, _| true)
        {
            let here = node as usize;
            if self.state[here] != State::Open || cost.to_bits() != self.search.costs[here].to_bits() {
                continue;
            }
            self.state[here] = State::Done;
            self.search.guides[here] = self.search.guide(self.graph, node, self.terms)?;
            self.relax(node)?;
        }
        Ok(())
    }

    /// Offers ways from a final node.
    fn relax(&mut self, node: u32) -> Result<(), SearchError> {
        const STAR: usize = 8;
        let cost = self.search.costs[node as usize];
        let mut ends = [(0, Vec3::ZERO); STAR];
        let mut weights = [0.0; STAR];
        for neighbours in self.graph.neighbours(node).chunks(STAR) {
            let mut open = 0;
            for &to in neighbours {
                ends[open] = (to, self.graph.position(to));
                let is_on_tree = self.search.place[to as usize] != NONE;
                open += usize::from(!is_on_tree && self.search.costs[to as usize] >= cost);
            }
            self.search.weigh(self.graph, node, &ends[..open], &mut weights[..open], self.terms)?;
            for (&(to, _), &weight) in ends[..open].iter().zip(&weights) {
                let through = cost + weight + 0.0;
                if !self.is_better(node, to, through) {
                    continue;
                }
                let was_final = self.state[to as usize] != State::Open;
                if was_final {
                    self.open(to);
                    self.open_hanging();
                    // The rest of the list is what hung on it.
                    self.list.retain(|&opened| opened != to);
                }
                self.search.costs[to as usize] = through;
                self.search.parents[to as usize] = node;
                self.search.queue.push(through, to);
                self.offer_to_list()?;
                if !self.is_clear {
                    return Ok(());
                }
            }
        }
        Ok(())
    }
}
