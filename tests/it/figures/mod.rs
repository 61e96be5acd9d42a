//! The feature that each figure of the paper shows, as a number on the preset's tree.
//!
//! Each number is taken on the preset and on a tree of another rule on the way to the same endpoints in the same
//! graph, of another policy, or of the figure's other presets. There it must fall on the other side of the limit: what
//! is held is what the rule or the policy does, not what any tree looks like. `cargo test --test it figures -- --nocapture` prints the numbers.

mod all;
mod comparison;
mod rotation;
mod variety;
mod volume;

use std::sync::{Arc, OnceLock};
use treesynth::field::{Helix, Rotation, SphericalMeridians, VectorField};
use treesynth::glam::Vec3;
use treesynth::guided::*;
use treesynth::math::{UP, angle_between, atan2, ln};
use treesynth::presets::{self, Found, Preset, TYPICAL_NODES};
use treesynth::shape::{Cuboid, HalfEllipsoid, Shell};
use treesynth::{GuidingRule, Metrics, Shape, Silent, Skeleton};

/// Nodes of most graphs here: the figures' shapes show, and a tree takes a tenth of a second.
const NODES: usize = 20_000;

/// A tree in its graph, and how it came about.
struct Tree {
    graph: Arc<Graph>,
    seed: u64,
    stages: Vec<Stage>,
    growth: Growth,
}

fn preset(name: &str) -> &'static Preset {
    presets::by_name(name).and_then(Found::guided).unwrap_or_else(|error| panic!("{error}"))
}

/// Some stages on a graph that is there already: the builder is not asked.
fn pipeline(stages: &[Stage]) -> TreeSynth {
    let builder = PoissonYao::new(Cuboid::centered(Vec3::ZERO, Vec3::ONE));
    stages.iter().fold(TreeSynth::new(builder), |synth, stage| synth.stage(stage.clone()))
}

/// The first stages of a preset.
fn stages(name: &str, stages: usize) -> Vec<Stage> {
    let synth = preset(name).synth(NODES);
    synth.stages()[..stages].to_vec()
}

/// The graph of figures 6, 15, 18 and 19 in full.
fn typical() -> Arc<Graph> {
    static GRAPH: OnceLock<Arc<Graph>> = OnceLock::new();
    let build = || {
        let synth = preset("figure-06a").synth(TYPICAL_NODES);
        Arc::new(synth.build_graph(1, &Silent).unwrap())
    };
    GRAPH.get_or_init(build).clone()
}

/// The endpoints of another tree.
struct Same(Vec<u32>);

impl EndpointPolicy for Same {
    fn select(&self, _: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        Ok(self.0.clone())
    }
}

impl Tree {
    /// The whole tree of a preset.
    fn of(name: &str, nodes: usize, seed: u64) -> Self {
        Self::partial(name, nodes, seed, preset(name).synth(nodes).stages().len())
    }

    /// Its first stages.
    fn partial(name: &str, nodes: usize, seed: u64, count: usize) -> Self {
        let synth = preset(name).synth(nodes).first_stages(count);
        Self::with(Arc::new(synth.build_graph(seed, &Silent).unwrap()), seed, &synth)
    }

    /// With the default radii, which matter to few.
    fn grow(graph: Arc<Graph>, seed: u64, stages: &[Stage]) -> Self {
        Self::with(graph, seed, &pipeline(stages))
    }

    fn with(graph: Arc<Graph>, seed: u64, synth: &TreeSynth) -> Self {
        let growth = synth.grow(&mut Search::new(&graph), seed, &Silent).unwrap();
        Self { graph, seed, stages: synth.stages().to_vec(), growth }
    }

    fn synth(&self) -> TreeSynth {
        pipeline(&self.stages)
    }

    /// The tree of another preset with as many stages, in the same graph.
    fn as_preset(&self, name: &str) -> Self {
        Self::grow(self.graph.clone(), self.seed, &stages(name, self.stages.len()))
    }

    /// The tree up to stage `at`, with another rule there on the way to the same endpoints.
    fn ruled(&self, at: usize, rule: impl GuidingRule + 'static) -> Self {
        let mut stages = self.stages[..at].to_vec();
        stages.push(Stage::new(rule, Same(self.growth.endpoints[at].clone())));
        Self::grow(self.graph.clone(), self.seed, &stages)
    }

    /// The whole tree with another stage at `at`.
    fn staged(&self, at: usize, stage: Stage) -> Self {
        let mut stages = self.stages.clone();
        stages[at] = stage;
        Self::grow(self.graph.clone(), self.seed, &stages)
    }

    /// The tree after some of its stages.
    fn after(&self, stages: usize) -> Self {
        Self::grow(self.graph.clone(), self.seed, &self.stages[..stages])
    }

    fn skeleton(&self) -> &Skeleton {
        &self.growth.skeleton
    }

    fn positions(&self) -> &[Vec3] {
        self.skeleton().positions()
    }

    /// The paths of a stage, from the tree before it to each endpoint.
    fn paths(&self, stage: usize) -> Vec<Path> {
        let mut places = vec![usize::MAX; self.graph.nodes()];
        for (place, &node) in self.growth.nodes.iter().enumerate() {
            places[node as usize] = place;
        }
        let endpoints = self.growth.endpoints[stage].iter();
        endpoints
            .map(|&node| self.path(places[node as usize], stage))
            .filter(|path| path.0.len() > 1)
            .collect()
    }

    /// Degrees between the first two hops of each path of a stage and the way on which its source is reached.
    fn forks(&self, stage: usize) -> Vec<f32> {
        let (tree, positions) = (self.skeleton(), self.positions());
        let children = tree.children();
        let fork = |first: usize| {
            let next = children.of(first).first().map_or(first, |&node| node as usize);
            let source = tree.parent(first)?;
            let bearer = tree.parent(tree.parent(source)?)?;
            let (off, on) = (positions[next] - positions[source], positions[source] - positions[bearer]);
            Some(angle_between(off, on).to_degrees())
        };
        let stages = tree.stages();
        let starts = |&(node, parent): &(usize, usize)| {
            usize::from(stages[node]) == stage && usize::from(stages[parent]) < stage
        };
        tree.edges().filter(starts).filter_map(|(node, _)| fork(node)).collect()
    }

    fn path(&self, end: usize, stage: usize) -> Path {
        let mut node = end;
        let mut path = vec![self.positions()[node]];
        while usize::from(self.skeleton().stages()[node]) == stage
            && let Some(parent) = self.skeleton().parent(node)
        {
            node = parent;
            path.push(self.positions()[node]);
        }
        path.reverse();
        Path(path)
    }

    /// Middle and direction of the internodes of some stages.
    fn internodes(&self, stages: std::ops::Range<u16>) -> Vec<(Vec3, Vec3)> {
        let (positions, of) = (self.positions(), self.skeleton().stages());
        let internodes = self.skeleton().edges().filter(|&(node, _)| stages.contains(&of[node]));
        internodes
            .map(|(node, parent)| {
                (
                    (positions[node] + positions[parent]) * 0.5,
                    (positions[node] - positions[parent]).normalize(),
                )
            })
            .collect()
    }

    fn width_over_height(&self) -> f32 {
        (treesynth::metrics::crown_width(self.skeleton()) / treesynth::metrics::height(self.skeleton()))
            as f32
    }
}

/// A path from its source to its endpoint.
struct Path(Vec<Vec3>);

impl Path {
    fn start(&self) -> Vec3 {
        self.0[0]
    }

    fn end(&self) -> Vec3 {
        self.0[self.0.len() - 1]
    }

    fn hops(&self) -> usize {
        self.0.len() - 1
    }

    /// Degrees between up and the chord from one node to another.
    fn tilt_between(&self, from: usize, to: usize) -> f32 {
        tilt(self.0[to] - self.0[from])
    }

    fn tilt(&self) -> f32 {
        self.tilt_between(0, self.hops())
    }

    /// The tilt of the first hops, as many as there are.
    fn tilt_at_start(&self, hops: usize) -> f32 {
        self.tilt_between(0, hops.min(self.hops()))
    }

    /// The tilt of the last hops.
    fn tilt_at_end(&self, hops: usize) -> f32 {
        self.tilt_between(self.hops().saturating_sub(hops), self.hops())
    }

    fn length(&self) -> f32 {
        self.0.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
    }

    fn tortuosity(&self) -> f32 {
        self.length() / self.start().distance(self.end())
    }
}

/// Degrees between up and a direction: 0 upwards, 90 level, more than that downwards.
fn tilt(direction: Vec3) -> f32 {
    angle_between(direction, UP).to_degrees()
}

fn mean(numbers: impl IntoIterator<Item = f32>) -> f32 {
    let (count, sum) = numbers.into_iter().fold((0, 0.0), |(count, sum), number| (count + 1, sum + number));
    sum / count as f32
}

/// The number that a share of the numbers is below.
fn quantile(numbers: impl IntoIterator<Item = f32>, share: f32) -> f32 {
    let mut numbers: Vec<f32> = numbers.into_iter().collect();
    numbers.sort_by(f32::total_cmp);
    numbers[(share * (numbers.len() - 1) as f32) as usize]
}

fn deviation(numbers: &[f32]) -> f32 {
    let middle = mean(numbers.iter().copied());
    mean(numbers.iter().map(|number| (number - middle) * (number - middle))).sqrt()
}

fn most<T>(items: &[T], of: impl Fn(&T) -> f32) -> f32 {
    items.iter().map(of).fold(f32::MIN, f32::max)
}

fn least<T>(items: &[T], of: impl Fn(&T) -> f32) -> f32 {
    items.iter().map(of).fold(f32::MAX, f32::min)
}

/// Pearson's.
fn correlation(pairs: &[(f32, f32)]) -> f32 {
    let (x, y) = (mean(pairs.iter().map(|pair| pair.0)), mean(pairs.iter().map(|pair| pair.1)));
    let product = mean(pairs.iter().map(|pair| (pair.0 - x) * (pair.1 - y)));
    let xs: Vec<f32> = pairs.iter().map(|pair| pair.0).collect();
    let ys: Vec<f32> = pairs.iter().map(|pair| pair.1).collect();
    product / (deviation(&xs) * deviation(&ys))
}

fn share<T>(items: &[T], holds: impl Fn(&T) -> bool) -> f32 {
    items.iter().filter(|item| holds(item)).count() as f32 / items.len() as f32
}

/// All of some trees' paths.
fn paths(trees: &[Tree], stage: usize) -> Vec<Path> {
    trees.iter().flat_map(|tree| tree.paths(stage)).collect()
}

fn each(trees: &[Tree], f: impl Fn(&Tree) -> Tree) -> Vec<Tree> {
    trees.iter().map(f).collect()
}

/// Two trees.
fn grown(name: &str, nodes: usize, stages: usize) -> Vec<Tree> {
    several(2, name, nodes, stages)
}

/// As many as make what is measured hold on any of them: most numbers are means over some dozens of paths.
fn several(trees: u64, name: &str, nodes: usize, stages: usize) -> Vec<Tree> {
    (1..=trees).map(|seed| Tree::partial(name, nodes, seed, stages)).collect()
}

/// Measured numbers and the limits between them, in ascending order.
#[track_caller]
fn ascending(what: &str, numbers: &[f32]) {
    println!("{what}: {numbers:.3?}");
    assert!(numbers.windows(2).all(|pair| pair[0] < pair[1]), "{what}, in ascending order: {numbers:.3?}");
}

fn degrees(angle: f32) -> f32 {
    angle.to_radians()
}

/// Stems that pass upwards through a height: the nodes above it.
fn stems(tree: &Tree, height: f32) -> Vec<usize> {
    let y = |node: usize| tree.positions()[node].y;
    let rising = tree.skeleton().edges().filter(|&(node, parent)| {
        tree.skeleton().stages()[node] == 0 && y(parent) < height && y(node) >= height
    });
    rising.map(|(node, _)| node).collect()
}
