//! What each figure of the paper shows, as a number on the preset's tree.
//!
//! Each number is taken on the preset and on a tree of another rule on the way to the same endpoints in the same
//! graph, of another policy, or of the figure's other presets. There it must fall on the other side of the limit: what
//! is held is what the rule or the policy does, not what any tree looks like. `cargo test --test it figures -- --nocapture` prints the numbers.

use std::sync::{Arc, OnceLock};
use treesynth::field::{Helix, Rotation, SphericalMeridians, VectorField};
use treesynth::glam::Vec3;
use treesynth::guided::*;
use treesynth::math::{UP, angle_between, atan2, ln};
use treesynth::presets::{self, Preset, TYPICAL_NODES};
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
    presets::by_name(name).unwrap_or_else(|| panic!("no preset {name}"))
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

fn grown(name: &str, nodes: usize, stages: usize) -> Vec<Tree> {
    [1, 2].map(|seed| Tree::partial(name, nodes, seed, stages)).into()
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

/// What passes upwards through a height: the nodes above it.
fn stems(tree: &Tree, height: f32) -> Vec<usize> {
    let y = |node: usize| tree.positions()[node].y;
    let rising = tree.skeleton().edges().filter(|&(node, parent)| {
        tree.skeleton().stages()[node] == 0 && y(parent) < height && y(node) >= height
    });
    rising.map(|(node, _)| node).collect()
}

/// Share of the tree's nodes within a spacing of the region's sides and top.
fn share_at_border(tree: &Tree, planar: bool) -> f32 {
    let (graph, everywhere) = (&tree.graph, tree.graph.positions());
    let (low, high) =
        everywhere.iter().fold((Vec3::MAX, Vec3::MIN), |(low, high), &p| (low.min(p), high.max(p)));
    let edges = (0..graph.nodes() as u32).flat_map(|from| {
        graph.neighbours(from).iter().map(move |&to| graph.position(from).distance(graph.position(to)))
    });
    let spacing = edges.fold(f32::MAX, f32::min);
    share(tree.positions(), |&p| {
        let near = (p - low).min(high - p);
        near.x < spacing || high.y - p.y < spacing || (!planar && near.z < spacing)
    })
}

/// Half the crookedness of a 3D graph's paths is in its edges: 1.15 is as straight as they come.
const STRAIGHT: f32 = 1.2;

#[test]
fn figure_02() {
    let paths = |name| -> Vec<Path> {
        (1..=4).flat_map(|seed| Tree::of(name, TYPICAL_NODES, seed).paths(0)).collect()
    };
    // Area between path and chord over the chord squared, positive above it; tilt of the first quarter.
    let bulge = |path: &Path| {
        let (start, chord) = (path.start(), path.end() - path.start());
        let doubled: f32 = path.0.windows(2).map(|pair| (pair[0] - start).cross(pair[1] - start).z).sum();
        -doubled * 0.5 / chord.length_squared()
    };
    let first = |path: &Path| path.tilt_between(0, path.hops() / 4);
    let (unguided, guided) = (paths("figure-02-unguided"), paths("figure-02-guided"));
    ascending("crooked, but straight", &[-0.05, least(&unguided, bulge), most(&unguided, bulge), 0.04]);
    ascending("over", &[0.06, least(&guided, bulge)]); // 0.08
    ascending("upwards at first", &[most(&guided, first), 20.0, least(&unguided, first)]); // 15, 27
}

#[test]
fn figure_03() {
    // Cosine between the vectors of neighbours, in the less coherent stage.
    let coherence = |tree: &Tree| {
        let mut search = Search::new(&tree.graph);
        let mut of_stage = |stage| {
            tree.synth().grow_stage(&mut search, stage, tree.seed, &Silent).unwrap();
            mean((0..tree.graph.nodes() as u32).flat_map(|node| {
                let vector = search.vector(node);
                let others = tree.graph.neighbours(node).iter().filter_map(|&to| search.vector(to));
                others.filter_map(|other| Some(vector?.dot(other))).collect::<Vec<_>>()
            }))
        };
        (0..tree.stages.len()).map(&mut of_stage).fold(1.0, f32::min)
    };
    let trees: Vec<Tree> = (1..=6).map(|seed| Tree::of("figure-03", TYPICAL_NODES, seed)).collect();
    for tree in &trees {
        assert_eq!(tree.growth.endpoints.iter().map(Vec::len).collect::<Vec<_>>(), [8, 45]);
        let jitter = tree.ruled(0, Jitter::new(Bend::constant(degrees(4.0)), degrees(120.0)));
        ascending("coherence", &[coherence(&jitter), 0.3, 0.9, coherence(tree)]); // 0.14, 0.96
    }
    let forks = |trees: &[Tree]| mean(trees.iter().flat_map(|tree| tree.forks(1)));
    let none = each(&trees, |tree| tree.ruled(1, Bend::none()));
    ascending("forks of the second iteration", &[forks(&none), 22.0, 24.0, forks(&trees)]);
}

#[test]
fn figure_05() {
    // On paths of more than 20 hops: how the tilt changes up to there, and after that.
    let left = Tree::partial("figure-05-left", TYPICAL_NODES, 1, 1);
    let right = left.as_preset("figure-05-right");
    let none = left.ruled(0, Bend::none());
    let turn = |tree: &Tree, from: usize, to: usize| {
        let at = |path: &Path, hop: usize| path.tilt_between(hop - 4, hop);
        let paths = tree.paths(0).into_iter().filter(|path| path.hops() >= 28);
        mean(paths.map(|path| at(&path, to.min(path.hops())) - at(&path, from)))
    };
    let [first, last] =
        [(5, 20), (20, usize::MAX)].map(|(from, to)| [&none, &left, &right].map(|tree| turn(tree, from, to)));
    ascending("out and down", &[first[0], 5.0, 10.0, first[1], 20.0, first[2]]); // 0, 14, 29
    ascending("then up again, straight, or on down", &[last[2], -5.0, last[0], 10.0, last[1]]); // -9, 2, 23
}

#[test]
fn figure_06() {
    let trees = ["figure-06a", "figure-06b", "figure-06c", "figure-06d"]
        .map(|name| Tree::grow(typical(), 1, &stages(name, 2)));
    let [a, b, c, d] = trees.each_ref().map(|tree| tree.paths(1));
    // All limbs; and the course of those of at least 12 hops.
    let spread = |paths: &[Path]| deviation(&paths.iter().map(Path::tilt).collect::<Vec<_>>());
    let tortuosity = |paths: &[Path]| mean(paths.iter().map(Path::tortuosity));
    let course = |paths: &[Path]| {
        let long: Vec<&Path> = paths.iter().filter(|path| path.hops() >= 12).collect();
        [(0, 5), (4, 8)]
            .map(|(from, to)| mean(long.iter().map(|path| path.tilt_between(from, to))))
            .into_iter()
            .chain([mean(long.iter().map(|path| path.tilt_at_end(5)))])
            .collect::<Vec<_>>()
    };
    let (a_course, b_course, d_course) = (course(&a), course(&b), course(&d));
    let drooping = |paths: &[Path]| share(paths, |path| path.tilt_at_end(4) > 90.0);
    ascending("a: curved downward, all the way", &[20.0, a_course[0], a_course[1], 90.0, a_course[2]]);
    ascending("a: drooping tips", &[drooping(&b), 0.1, 0.35, drooping(&a)]); // 0.03, 0.49
    ascending("b: at about 60°", &[50.0, mean(b.iter().map(Path::tilt)), 70.0]);
    ascending("b: straight", &[1.0, tortuosity(&b), STRAIGHT, tortuosity(&a)]); // 1.15, 1.27
    ascending("b: straight", &[-10.0, b_course[2] - b_course[0], 10.0]); // 6; in (a) 71
    ascending("c: in different directions", &[spread(&b), 13.0, 16.0, spread(&c)]); // 10, 18
    ascending("c: straight", &[1.0, tortuosity(&c), STRAIGHT]); // 1.17
    ascending("d: out", &[d_course[0] + 10.0, d_course[1]]); // 46 to 64
    ascending("d: then up", &[d_course[2] + 10.0, d_course[1]]); // 64 to 45, in (b) 63 to 62
}

#[test]
fn figure_07() {
    let trees = grown("figure-07", 60_000, 4);
    // How far paths turn away from up, by the angle of their ends to the axis.
    let turns = |trees: &[Tree]| {
        let turns: Vec<(f32, f32)> = paths(trees, 0)
            .iter()
            .map(|path| (path.tilt(), path.tilt_at_end(5) - path.tilt_at_start(5)))
            .collect();
        [(0.0, 20.0), (20.0, 35.0), (35.0, 90.0)].map(|(low, high)| {
            mean(turns.iter().filter(|turn| (low..high).contains(&turn.0)).map(|turn| turn.1))
        })
    };
    let right = turns(&trees);
    ascending("the more, the farther out", &[5.0, right[0], 30.0, right[1], 65.0, right[2]]); // 11, 45, 85
    // A constant angle that bends the outer branches as far bends the inner ones twice as far.
    let constant = turns(&each(&trees, |tree| tree.ruled(0, Bend::constant(degrees(9.0))))); // 20, 51, 75
    ascending("straight inside", &[right[0] / right[2], 0.19, 0.23, constant[0] / constant[2]]); // 0.13, 0.27
    let upright = Tree::of("figure-06b", 60_000, 1);
    ascending("wide", &[upright.width_over_height(), 1.0, trees[0].width_over_height()]);
}

#[test]
fn figure_08() {
    let a = grown("figure-08a", 40_000, 2);
    let [b, c] = ["figure-08b", "figure-08c"].map(|name| each(&a, |tree| tree.as_preset(name)));
    // Degrees that a path winds about the axis.
    let winding = |path: &Path| -> f32 {
        let turn = |a: Vec3, b: Vec3| atan2(a.cross(b).y, a.dot(b)).to_degrees();
        path.0.windows(2).map(|pair| turn(pair[0].with_y(0.0), pair[1].with_y(0.0))).sum()
    };
    let left_handed = Helix::with_angle(Vec3::ZERO, -degrees(40.0));
    let left_handed = each(&a, |tree| tree.ruled(0, FollowField::new(left_handed)));
    ascending("a: winding", &[most(&paths(&left_handed, 0), winding), 0.0, least(&paths(&a, 0), winding)]);
    let turn = |trees: &[Tree]| mean(paths(trees, 0).iter().map(winding));
    ascending("a: a turn", &[turn(&b), 30.0, 270.0, turn(&a)]); // -12, 377
    ascending("a: rising", &[0.99, share(&paths(&a, 0), |path| path.end().y > path.start().y)]);

    let internodes = |trees: &[Tree], stage| -> Vec<(Vec3, Vec3)> {
        trees.iter().flat_map(|tree| tree.internodes(stage..stage + 1)).collect()
    };
    let to_x = |trees: &[Tree]| mean(internodes(trees, 1).iter().map(|(_, direction)| direction.x));
    let mirrored = Rotation::new(Vec3::new(-7.0, 0.0, 0.0), Vec3::Z);
    let mirrored = each(&b, |tree| tree.ruled(1, FollowField::new(mirrored)));
    // The endpoints of the first iteration are all around: what sweeps is the second. -0.45, -0.04, 0.40
    ascending("b: to one side", &[to_x(&mirrored), -0.3, to_x(&a), 0.3, to_x(&b)]);

    let onion = SphericalMeridians::new(Vec3::Y * 5.0);
    let along = |trees: &[Tree], stage| {
        mean(internodes(trees, stage).iter().map(|&(middle, direction)| onion.at(middle).dot(direction)))
    };
    ascending("c: up along spheres", &[along(&a, 0), along(&b, 0), 0.7, 0.75, along(&c, 0)]); // 0.50, 0.63, 0.81
    ascending("c: up along spheres", &[along(&a, 1), along(&b, 1), 0.5, 0.65, along(&c, 1)]); // 0.37, 0.37, 0.76
}

#[test]
fn figure_09() {
    // Mean distance from the axis, in the top quarter for the middle.
    let narrowing = |tree: &Tree| {
        let top = tree.positions().iter().map(|p| p.y).fold(0.0, f32::max);
        let across = |low: f32, high: f32| {
            let layer = tree.positions().iter().filter(|p| (low * top..=high * top).contains(&p.y));
            mean(layer.map(|p| p.with_y(0.0).length()))
        };
        across(0.75, 1.0) / across(0.35, 0.55)
    };
    let cone = grown("figure-09-cone", 40_000, 4);
    let [half, boxed] =
        ["figure-09-half-ellipsoid", "figure-09-box"].map(|name| each(&cone, |tree| tree.as_preset(name)));
    let [cone, half, boxed] = [&cone, &half, &boxed].map(|trees| mean(trees.iter().map(narrowing)));
    ascending("narrow, round and wide at the top", &[cone, 0.6, half, 0.82, boxed, 1.1]); // 0.5, 0.73, 0.91
}

#[test]
fn figure_10() {
    let tall = Tree::of("figure-10-tall", 40_000, 1);
    let wide = tall.as_preset("figure-10-wide");
    ascending("whole trees", &[tall.width_over_height(), 0.75, 0.95, wide.width_over_height()]); // 0.66, 1.03
    let (tall, wide) = (tall.after(2), wide.after(2));
    ascending("two iterations", &[tall.width_over_height(), 0.5, 0.8, wide.width_over_height()]); // 0.40, 0.90
}

#[test]
fn figure_12() {
    // The part of trunk and limbs nearer to the root: the share of its nodes that bear something.
    let clothed = |tree: &Tree| {
        let skeleton = tree.skeleton();
        let frame = skeleton.stages().iter().filter(|&&stage| stage < 2).count();
        let mut bears = vec![false; frame];
        for (_, parent) in skeleton.edges().filter(|&(node, parent)| node >= frame && parent < frame) {
            bears[parent] = true;
        }
        let mut nodes: Vec<usize> = (0..frame).collect();
        nodes.sort_by(|&a, &b| tree.positions()[a].length().total_cmp(&tree.positions()[b].length()));
        share(&nodes[..frame / 2], |&node| bears[node])
    };
    let away = |tree: &Tree| mean(tree.internodes(2..5).iter().map(|(middle, _)| middle.length()));
    let t03 = grown("figure-12-t03", 40_000, 5);
    let [t06, t10] = ["figure-12-t06", "figure-12-t10"].map(|name| each(&t03, |tree| tree.as_preset(name)));
    let all = |of: &dyn Fn(&Tree) -> f32| [&t10, &t06, &t03].map(|trees| mean(trees.iter().map(of)));
    let ([t10, t06, t03], [near, middle, far]) = (all(&clothed), all(&away));
    ascending("inner parts with twigs", &[t03, 0.06, t06, 0.5, t10]); // 0.01, 0.24, 0.76
    ascending("distance of twigs from the root, m", &[near, 7.5, middle, 8.9, far]); // 6.6, 8.6, 9.4
}

#[test]
fn figure_13() {
    let lower = |tree: &Tree, stage| share(&tree.paths(stage), |path| path.end().y < path.start().y);
    let tips = |tree: &Tree| mean(tree.paths(2).iter().map(|path| path.tilt_at_end(3)));
    for tree in grown("figure-13", 60_000, 5) {
        assert!((2..5).all(|stage| lower(&tree, stage) >= 1.0), "all endpoints lower than their sources");
        let surface = HopSurface::new(5, Count::UpTo(350)).with_outermost(0.8);
        let anywhere = tree.staged(2, Stage::new(Bend::piecewise(degrees(120.0), degrees(6.0), 1), surface));
        ascending("lower without the policy", &[lower(&anywhere, 2), 0.8]); // 0.68
        let upright = tree.ruled(2, Bend::piecewise(degrees(30.0), 0.0, 1));
        ascending("hanging tips", &[tips(&upright), 110.0, tips(&anywhere), 124.0, tips(&tree)]); // 100, 117, 131
    }
}

#[test]
fn figure_14() {
    let first = Tree::of("figure-14-1000", TYPICAL_NODES, 1);
    let trees = ["figure-14-1000", "figure-14-2000", "figure-14-4000"].map(|name| first.as_preset(name));
    let [one, two, four] = trees.each_ref().map(|tree| {
        let mut endpoints = tree.growth.endpoints.concat();
        endpoints.sort_unstable();
        endpoints.dedup();
        endpoints.len() as f32
    });
    ascending("endpoints", &[900.0, one, 1100.0, 1800.0, two, 2200.0, 3600.0, four, 4400.0]);
    // Endpoints on the way to other endpoints are no tips.
    let [one, two, four] = trees.each_ref().map(|tree| tree.skeleton().tips().count() as f32);
    ascending("tips", &[650.0, one, 1000.0, 1300.0, two, 1800.0, 2400.0, four]); // 747, 1423, 2599
}

#[test]
fn figure_15() {
    let ashes: Vec<Tree> = presets::all()
        .filter(|preset| preset.figure == 15)
        .map(|preset| Tree::of(preset.name, 40_000, preset.seed))
        .collect();
    assert_eq!(ashes.len(), 6);
    // Six trees: cells of 60 cm that limbs pass through, in the same crown.
    let cells = |tree: &Tree| {
        let limbs = (0..tree.positions().len()).filter(|&node| tree.skeleton().stages()[node] == 1);
        let mut cells: Vec<_> =
            limbs.map(|node| (tree.positions()[node] / 0.6).floor().as_ivec3().to_array()).collect();
        cells.sort_unstable();
        cells.dedup();
        cells
    };
    let cells: Vec<_> = ashes.iter().map(cells).collect();
    for (number, a) in cells.iter().enumerate() {
        for b in &cells[..number] {
            let both = share(a, |cell| b.binary_search(cell).is_ok());
            ascending("limbs in common", &[both, 0.65]); // 0.35 to 0.55
        }
    }
    // One species: logarithms of what one would measure first, and their distance from the six trees' mean.
    let measures = |tree: &Tree| {
        let metrics = Metrics::of(tree.skeleton());
        let limbs = f64::from(mean(tree.paths(1).iter().map(Path::tilt)));
        [metrics.height, metrics.crown_width, metrics.tips as f64, metrics.total_length, limbs]
            .map(|measure| ln(measure as f32))
    };
    let of_ashes: Vec<[f32; 5]> = ashes.iter().map(measures).collect();
    let species: [f32; 5] = std::array::from_fn(|i| mean(of_ashes.iter().map(|measures| measures[i])));
    let away = |measures: &[f32; 5]| {
        mean(measures.iter().zip(species).map(|(measure, mean)| (measure - mean) * (measure - mean))).sqrt()
    };
    let others = ["figure-06a", "figure-10-tall", "figure-12-t06", "figure-17e", "figure-17i", "figure-18"]
        .map(|name| measures(&Tree::of(name, 40_000, 1)));
    ascending("one species", &[most(&of_ashes, away), 0.08, least(&others, away)]); // 0.06, 0.10
}

#[test]
fn figure_16() {
    let trees = ["figure-16-15", "figure-16-09", "figure-16-05", "figure-16-03"]
        .map(|name| Tree::of(name, 60_000, 1));
    let metrics = trees.each_ref().map(|tree| Metrics::of(tree.skeleton()));
    let [a, b, c, d] = metrics.each_ref().map(|metrics| metrics.crown_width as f32);
    ascending("widths", &[a + 1.0, b]);
    ascending("widths", &[b + 1.0, c]);
    ascending("widths", &[c + 1.0, d]); // 8.3, 9.9, 11.8, 14.0
    let [a, b, c, d] = metrics.each_ref().map(|metrics| metrics.height as f32);
    ascending("heights", &[d + 0.4, c + 0.2, b, b + 1.2, a]); // 12.3, 9.5, 8.1, 7.3
    let lengths = metrics.map(|metrics| metrics.total_length as f32);
    ascending("as dense", &[lengths[3], lengths[0] * 1.35]); // 2760 to 3290 m
    // With the first tree's θ the branches of the last would end 33° steeper.
    let ends = |tree: &Tree| mean(tree.paths(0).iter().map(|path| path.tilt_at_end(4)));
    let [a, b, c, d] = trees.each_ref().map(ends);
    ascending("ends more level", &[a + 8.0, b, b + 10.0, c, c + 8.0, d]); // 39, 55, 79, 100
    ascending("by the rule", &[ends(&trees[3].ruled(0, Bend::from_axis(degrees(14.0)))), 80.0, d]); // 66, 100
}

#[test]
fn figure_17a() {
    let tree = Tree::of("figure-17a", 100_000, 1);
    let dome = HalfEllipsoid::new(Vec3::Y * 5.6, Vec3::new(3.6, 4.0, 3.6));
    let rule = || Bend::piecewise(degrees(6.0), degrees(-4.0), 12);
    let many = tree.staged(0, Stage::new(rule(), InShape::poisson_disc(dome, 60)));
    let limbs = |tree: &Tree| stems(tree, 5.0).len() as f32;
    ascending("distinct limbs", &[limbs(&tree), 10.0, 30.0, limbs(&many)]); // 9, 44
    // Variation of the number of tips in cells of a metre.
    let clustering = |tree: &Tree| {
        let corner = dome.bounds().min;
        let mut counts = vec![0.0; 8 * 4 * 8];
        let tips = tree.skeleton().tips().map(|tip| tree.positions()[tip]).filter(|&tip| dome.contains(tip));
        for tip in tips {
            let cell = (tip - corner).as_ivec3();
            counts[((cell.x * 4 + cell.y.min(3)) * 8 + cell.z) as usize] += 1.0;
        }
        let inside = |cell: u32| {
            let (x, y, z) = (cell / 32, cell / 8 % 4, cell % 8);
            dome.contains(corner + Vec3::new(x as f32, y as f32, z as f32) + 0.5)
        };
        let counts: Vec<f32> =
            (0..8 * 4 * 8).filter(|&cell| inside(cell)).map(|cell| counts[cell as usize]).collect();
        deviation(&counts) / mean(counts.iter().copied())
    };
    ascending("clusters", &[clustering(&many), 0.45, clustering(&tree)]); // 0.40, 0.49
}

#[test]
fn figure_17b() {
    let tree = Tree::partial("figure-17b", 100_000, 1, 2);
    let [droop, rise] = [(8.0, 8.0, 3), (30.0, -10.0, 3)]
        .map(|(first, rest, hops)| Bend::piecewise(degrees(first), degrees(rest), hops));
    let swapped = tree.ruled(1, ByHeight::new(5.8, rise, droop));
    // How limbs of more than 6 hops turn, below and above.
    let turns = |tree: &Tree| {
        let (low, high): (Vec<Path>, Vec<Path>) =
            tree.paths(1).into_iter().filter(|path| path.hops() > 6).partition(|path| path.start().y < 5.8);
        [low, high].map(|paths| mean(paths.iter().map(|path| path.tilt_at_end(4) - path.tilt_between(1, 4))))
    };
    let ([low, high], [other_low, other_high]) = (turns(&tree), turns(&swapped));
    ascending("drooping below", &[other_low, 0.0, 20.0, low]); // -22, 34
    ascending("rising above", &[high, -8.0, 20.0, other_high]); // -17, 45
}

#[test]
fn figure_17c() {
    for tree in grown("figure-17c", 40_000, 3) {
        let tilt = |tree: &Tree| mean(tree.paths(1).iter().map(Path::tilt));
        let forks = tree.ruled(1, Bend::piecewise(degrees(30.0), 0.0, 1));
        ascending("level", &[tilt(&forks), 60.0, 70.0, tilt(&tree), 100.0]); // 42, 78
        ascending("spindly", &[tree.width_over_height(), 0.45]); // 0.4
        ascending("short, m", &[mean(tree.paths(1).iter().map(Path::length)), 1.8]); // 1.3
        ascending("dead", &[tree.skeleton().tips().count() as f32, 370.0]);
    }
}

#[test]
fn figure_17d() {
    let tree = Tree::of("figure-17d", 60_000, 1);
    let higher = |tree: &Tree, stage| share(&tree.paths(stage), |path| path.end().y > path.start().y);
    assert!((1..4).all(|stage| higher(&tree, stage) >= 1.0), "all endpoints higher than their sources");
    let surface = HopSurface::new(4, Count::UpTo(500)).with_outermost(0.5);
    let anywhere = tree.staged(2, Stage::new(Bend::piecewise(degrees(30.0), 0.0, 1), surface));
    ascending("higher without the policy", &[higher(&anywhere, 2), 0.985]); // 0.97
    ascending("broad", &[1.1, tree.width_over_height()]); // 1.27
}

#[test]
fn figure_17e_and_i() {
    for name in ["figure-17e", "figure-17i"] {
        let trees = [1, 2].map(|seed| Tree::partial(name, TYPICAL_NODES, seed, 2));
        // Pearson's correlation of the source's height and the limb's tilt.
        let steepening = |trees: &[Tree]| {
            let limbs: Vec<_> = paths(trees, 1).iter().map(|path| (path.start().y, path.tilt())).collect();
            correlation(&limbs)
        };
        let fixed = each(&trees, |tree| tree.ruled(1, Bend::piecewise(degrees(60.0), 0.0, 1)));
        // 17e: -0.65 and 0.0. 17i: -0.6 and -0.1.
        ascending("steeper with height", &[steepening(&trees), -0.5, -0.3, steepening(&fixed)]);
    }
}

#[test]
fn figure_17f_g_h() {
    let trees = |name| [1, 2].map(|seed| Tree::partial(name, 40_000, seed, 1));
    let shoots = |trees: &[Tree], height| -> Vec<usize> {
        trees.iter().map(|tree| stems(tree, height).len()).collect()
    };
    for name in ["figure-17f", "figure-17h"] {
        let trees = trees(name);
        let fewest = |height| least(&shoots(&trees, height), |&count| count as f32);
        ascending("shoots at half a metre", &[6.0, fewest(0.5)]); // 9, 24
        ascending("shoots at two metres", &[30.0, fewest(2.0)]); // 45, 53
        // And none of them is a trunk: its share of the cross-section.
        let tree = Tree::of(name, 40_000, 1);
        let radii = tree.skeleton().radii();
        let areas: Vec<f32> = stems(&tree, 1.0).into_iter().map(|node| radii[node] * radii[node]).collect();
        ascending("the thickest", &[most(&areas, |&area| area) / areas.iter().sum::<f32>(), 0.3]); // 0.15
    }
    assert_eq!(shoots(&trees("figure-17c"), 2.0), [1, 1], "a trunk");
    let birches = trees("figure-17g");
    for height in [2.5, 4.0, 6.0] {
        assert_eq!(shoots(&birches, height), [2, 2], "two trunks at {height} m");
    }
    assert_eq!(shoots(&birches, 0.5), [1, 1], "that come from one");
}

#[test]
fn figure_17j() {
    let thickness = |name| {
        let tree = Tree::of(name, 40_000, 1);
        let mut radii = tree.skeleton().radii().to_vec();
        radii.sort_by(f32::total_cmp);
        (radii[radii.len() / 2] / radii[radii.len() - 1], tree)
    };
    let (right, tree) = thickness("figure-17j");
    assert_eq!(tree.stages.len(), 2, "two iterations");
    ascending("few tips", &[tree.skeleton().tips().count() as f32, 1000.0]);
    for name in ["figure-07", "figure-17a", "figure-17f"] {
        let (other, tree) = thickness(name);
        ascending("no small twigs", &[other, 0.036, 0.042, right]); // 0.030, 0.048
        ascending("many tips", &[1500.0, tree.skeleton().tips().count() as f32]);
    }
}

#[test]
fn figure_18() {
    let tree = Tree::grow(typical(), 1, &stages("figure-18", 2));
    let fixed = tree.ruled(1, Bend::piecewise(degrees(60.0), 0.0, 1));
    let curved = tree.ruled(1, Bend::random(degrees(30.0), degrees(120.0), degrees(6.0), 1));
    let spread = |tree: &Tree| deviation(&tree.paths(1).iter().map(Path::tilt).collect::<Vec<_>>());
    ascending("many directions", &[spread(&fixed), 13.0, 16.0, spread(&tree)]); // 11, 18
    let tortuosity = |tree: &Tree| mean(tree.paths(1).iter().map(Path::tortuosity));
    ascending("straight", &[1.0, tortuosity(&tree), 1.19, tortuosity(&curved)]); // 1.16, 1.22
}

#[test]
fn figure_19() {
    let tree = Tree::grow(typical(), 1, &stages("figure-19", 2));
    // How limbs of at least 12 hops turn from hop 5 to their ends.
    let turn = |tree: &Tree| {
        let long = tree.paths(1).into_iter().filter(|path| path.hops() >= 12);
        mean(long.map(|path| path.tilt_at_end(5) - path.tilt_between(3, 7)))
    };
    let [straight, down] =
        [0.0, 5.0].map(|rest| tree.ruled(1, Bend::piecewise(degrees(15.0), degrees(rest), 5)));
    ascending("slightly up", &[-35.0, turn(&tree), -10.0, 0.0, turn(&straight), 20.0, turn(&down)]); // -19, 11, 36
}

#[test]
fn figure_20() {
    let base = Vec3::Y * 4.4;
    let dome = HalfEllipsoid::new(base, Vec3::new(4.6, 5.0, 4.6));
    let shell = Shell::new(dome, 0.35).about(base);
    let tree = Tree::partial("figure-20", 40_000, 1, 2);
    let filled = tree.staged(1, Stage::new(Bend::constant(degrees(3.0)), InShape::poisson_disc(dome, 90)));
    let inside = |tree: &Tree| share(&tree.paths(1), |path| shell.contains(path.end()));
    ascending("endpoints in the shell", &[inside(&filled), 0.85, 0.999, inside(&tree)]); // 0.76, 1
    let bent = tree.ruled(1, Bend::constant(degrees(12.0)));
    let ends = |tree: &Tree| mean(tree.paths(1).iter().map(|path| path.tilt_at_end(4)));
    ascending("slightly bent", &[ends(&tree), 55.0, 65.0, ends(&bent)]); // 42, 79
}

/// No crown is cut off flat by the region's sides or its top, all taper, and a trunk is bare.
///
/// k hops of a coarse graph are a longer way than k hops of the paper's, so a tree that reaches the border is grown
/// again in finer ones: all keep off it at 60,000 nodes, but for figures 13 and 17 (d), which take 150,000.
#[test]
fn all_presets() {
    for preset in presets::all().filter(|preset| preset.figure != 15) {
        let name = preset.name;
        let tree = [NODES, 60_000, TYPICAL_NODES]
            .iter()
            .map(|&nodes| Tree::of(name, nodes, preset.seed))
            .find(|tree| share_at_border(tree, preset.planar) <= 0.01)
            .unwrap_or_else(|| panic!("{name} reaches the border"));
        let radii = tree.skeleton().radii();
        let tips: Vec<f32> = tree.skeleton().tips().map(|tip| radii[tip] / radii[0]).collect();
        ascending(&format!("{name}: tips for the foot"), &[most(&tips, |&tip| tip), 0.35]);
        let has_trunk = tree.growth.endpoints[0].len() == 1 && !preset.planar;
        // Twigs all over the trunk are what t = 1 shows.
        if has_trunk && name != "figure-12-t10" {
            let low = 0.2 * tree.positions().iter().map(|p| p.y).fold(0.0, f32::max);
            assert_eq!(stems(&tree, low).len(), 1, "{name}");
            let others =
                tree.positions().iter().zip(tree.skeleton().stages()).filter(|&(_, &stage)| stage > 0);
            let others: Vec<&Vec3> = others.map(|(position, _)| position).collect();
            // The crown of 17 (c) begins there.
            let limit = if name == "figure-17c" { 0.08 } else { 0.02 };
            ascending(&format!("{name}: branches low down"), &[share(&others, |p| p.y < low), limit]);
        }
    }
}
