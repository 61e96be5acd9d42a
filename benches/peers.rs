//! Each part of the work beside a crate that does the like, in the same run, one thread.

mod measure;

use fast_poisson::Poisson3D;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use measure::{SEED, Samples, count, number, print_table};
use petgraph::algo::dijkstra;
use petgraph::csr::Csr;
use petgraph::graph::{DiGraph, NodeIndex};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use treesynth::glam::Vec3;
use treesynth::guided::{
    Bend, Edge, Edges, EndpointError, Graph, GraphBuilder, PoissonYao, Search, Stage, StageView, Step,
    TreeSynth,
};
use treesynth::math::Rotation;
use treesynth::presets::TYPICAL_NODES;
use treesynth::shape::Cuboid;
use treesynth::{EndpointPolicy, GuidingRule, Progress, Silent, WeightFn, Work};

/// The box of the preset that the other benches grow, metres.
const BOX: Vec3 = Vec3::new(12.0, 11.5, 12.0);
/// Neighbours asked of the k-d tree: enough to have one in each octant, most of the time.
const NEIGHBOURS: NonZeroUsize = NonZeroUsize::new(32).expect("not zero");

/// Places nodes only: breaks off where the edges begin.
fn nodes_only(progress: Progress) -> ControlFlow<()> {
    if progress.work == Work::Edges { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

/// [`Bend::constant`], written outside of the crate.
struct OwnBend(Rotation);

impl GuidingRule for OwnBend {
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        let axis = Vec3::Y.cross(step.edge);
        let length = axis.length();
        if length < 1e-5 { step.vector } else { self.0.about(axis / length, step.vector) }
    }
}

/// [`Guided`](treesynth::guided::Guided), written outside of the crate.
struct OwnGuided;

impl WeightFn for OwnGuided {
    fn weight(&self, edge: &Edge) -> f32 {
        edge.length * (1.0 - edge.direction.dot(edge.vector)).max(0.0)
    }
}

/// Has the search go to its end, and then takes one endpoint.
struct AfterAll;

impl EndpointPolicy for AfterAll {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        Ok(vec![view.graph().nodes() as u32 - 1])
    }

    fn needs_search(&self) -> bool {
        true
    }
}

fn main() {
    measure::single_thread();
    let mut criterion = measure::criterion();
    let half = BOX * 0.5;
    let region = Cuboid::new(Vec3::new(-half.x, 0.0, -half.z), Vec3::new(half.x, BOX.y, half.z));
    let builder = PoissonYao::new(region).with_nodes(measure::size(TYPICAL_NODES, 10_000));
    let graph = builder.build(SEED, &Silent).expect("a graph in a box");
    let mut samples = Samples::default();
    let mut group = measure::group(&mut criterion, "peers");

    // Nodes.
    let spacing = builder.spacing().expect("a box has a spacing");
    let darts =
        Poisson3D::new().with_dimensions(BOX.to_array().map(f64::from), f64::from(spacing)).with_seed(SEED);
    let mut theirs = None;
    group.bench_function("nodes/treesynth", |bencher| {
        samples.time(bencher, "nodes", || builder.build(SEED, &nodes_only));
    });
    group.bench_function("nodes/fast_poisson", |bencher| {
        samples.time(bencher, "fast_poisson", || theirs.insert(darts.generate()).len());
    });

    // Edges.
    // With the reach of the graph's own edges; without one, the local reach is asked of a k-d tree first.
    let cloud = treesynth::guided::PointCloud::new(graph.positions().to_vec(), Edges::Yao(8));
    let cloud = cloud.with_reach(3.0 * spacing);
    let points: Vec<[f32; 3]> = graph.positions().iter().map(Vec3::to_array).collect();
    let kd_tree = ImmutableKdTree::<f32, 3>::new_from_slice(&points);
    group.bench_function("edges/treesynth", |bencher| {
        samples.time(bencher, "edges", || cloud.build(SEED, &Silent));
    });
    group.bench_function("edges/kiddo", |bencher| {
        samples.time(bencher, "kiddo", || {
            neighbour_sum(&ImmutableKdTree::<f32, 3>::new_from_slice(&points), &points)
        });
    });
    group.bench_function("edges/kiddo, tree built", |bencher| {
        samples.time(bencher, "kiddo, tree built", || neighbour_sum(&kd_tree, &points));
    });

    // One search.
    let synth =
        TreeSynth::new(builder.clone()).stage(Stage::new(Bend::constant(5f32.to_radians()), AfterAll));
    let mut search = Search::new(&graph);
    synth.grow(&mut search, SEED, &Silent).expect("a path");
    let frozen = freeze(&graph, &search);
    let csr = Csr::<(), f32>::from_sorted_edges(&frozen).expect("sorted edges");
    let digraph = DiGraph::<(), f32>::from_edges(&frozen);
    let largest = compare(&search, &csr);
    let root = graph.root();
    group.bench_function("search/treesynth", |bencher| {
        samples.time(bencher, "search", || synth.grow(&mut search, SEED, &Silent));
    });
    let own = TreeSynth::new(builder.clone())
        .stage(Stage::new(OwnBend(Rotation::new(5f32.to_radians())), AfterAll).with_weight(OwnGuided));
    let ours = synth.grow(&mut search, SEED, &Silent).expect("a path");
    assert_eq!(
        own.grow(&mut search, SEED, &Silent).expect("a path"),
        ours,
        "the same strategies, the same tree"
    );
    group.bench_function("search/own rule and weight", |bencher| {
        samples.time(bencher, "own", || own.grow(&mut search, SEED, &Silent));
    });
    group.bench_function("search/petgraph Csr", |bencher| {
        samples.time(bencher, "petgraph Csr", || dijkstra(&csr, root, None, |edge| *edge.weight()));
    });
    group.bench_function("search/petgraph DiGraph", |bencher| {
        let root = NodeIndex::new(root as usize);
        samples.time(bencher, "petgraph DiGraph", || dijkstra(&digraph, root, None, |edge| *edge.weight()));
    });

    // The whole tree.
    let typical = measure::tree(measure::size(TYPICAL_NODES, 10_000));
    group.bench_function("tree/treesynth", |bencher| {
        samples.time(bencher, "tree", || typical.synthesize(SEED));
    });
    let standing = typical.build_graph(SEED, &Silent).expect("the preset has a graph");
    let mut search = Search::new(&standing);
    group.bench_function("stages/treesynth", |bencher| {
        samples.time(bencher, "stages", || typical.grow(&mut search, SEED, &Silent));
    });
    group.bench_function("stages/petgraph Csr", |bencher| {
        samples.time(bencher, "five searches", || {
            (0..5).map(|_| dijkstra(&csr, root, None, |edge| *edge.weight()).len()).sum::<usize>()
        });
    });
    group.bench_function("tree/assembled", |bencher| {
        samples.time(bencher, "assembled", || assembled(&darts, 5));
    });
    group.finish();
    criterion.final_summary();

    print(&samples, &graph, spacing, theirs.map_or(0, |nodes| nodes.len()), largest);
}

/// Both tables: `theirs` nodes of the peer's, costs that differ by `largest` at most.
fn print(samples: &Samples, graph: &Graph, spacing: f32, theirs: usize, largest: f32) {
    if theirs > 0 {
        print_table(
            &format!("Nodes in a box of {BOX} m, at least {spacing:.4} m apart:"),
            &["", "nodes", "nodes / peer's"],
            &[
                vec!["PoissonYao".into(), count(graph.nodes()), number(graph.nodes() as f64 / theirs as f64)],
                vec!["fast_poisson".into(), count(theirs), String::new()],
            ],
        );
    }
    let ours = graph.nodes();
    let rows = [
        ("nodes", "nodes", "fast_poisson", None),
        ("nodes, each", "nodes", "fast_poisson", Some([ours, theirs])),
        ("edges; 32 nearest with tree", "edges", "kiddo", None),
        ("edges; 32 nearest, tree built", "edges", "kiddo, tree built", None),
        ("one search; Dijkstra on frozen weights", "search", "petgraph Csr", None),
        ("one search; Dijkstra on frozen weights", "search", "petgraph DiGraph", None),
        ("one search; rule and weight of one's own", "search", "own", None),
        ("five stages, endpoints included; five searches", "stages", "five searches", None),
        ("whole tree; assembled from all three", "tree", "assembled", None),
    ];
    let rows: Vec<Vec<String>> = rows
        .into_iter()
        .filter_map(|(what, ours, peer, parts)| {
            let (mine, other) = (samples.median(ours)?, samples.median(peer)?);
            let (mine, other, unit) = match parts.map(|parts| parts.map(|part| part as f64 / 1e6)) {
                Some([ours, theirs]) => (mine / ours, other / theirs, "ns"),
                None => (mine, other, "ms"),
            };
            Some(vec![
                what.to_owned(),
                peer.to_owned(),
                format!("{} {unit}", number(mine)),
                format!("{} {unit}", number(other)),
                number(mine / other),
            ])
        })
        .collect();
    print_table(
        &format!(
            "{} nodes, {} edges, one thread, medians. Costs of the searches differ by {largest:.1e} at most.",
            count(graph.nodes()),
            count(graph.edges())
        ),
        &["work", "peer", "treesynth", "peer's", "ours / peer's"],
        &rows,
    );
}

/// The `NEIGHBOURS` nearest of every point; what is summed up only keeps the work from being left out.
fn neighbour_sum(tree: &ImmutableKdTree<f32, 3>, points: &[[f32; 3]]) -> u64 {
    points
        .iter()
        .flat_map(|point| tree.nearest_n::<SquaredEuclidean>(point, NEIGHBOURS))
        .map(|neighbour| neighbour.item)
        .sum()
}

/// The least time of a tree from `fast_poisson`, `kiddo` and `petgraph`: nodes, for each the
/// nearest in every octant among [`NEIGHBOURS`], and full searches on weights that stay as they
/// are. Paths are not even read.
fn assembled(darts: &Poisson3D, searches: usize) -> f32 {
    let points: Vec<[f32; 3]> = darts.generate().into_iter().map(|p| p.map(|x| x as f32)).collect();
    let tree = ImmutableKdTree::<f32, 3>::new_from_slice(&points);
    let mut edges: Vec<(u32, u32, f32)> = Vec::with_capacity(points.len() * 8);
    for (point, from) in points.iter().zip(0u32..) {
        let mut open = [true; 8];
        let near = tree.nearest_n::<SquaredEuclidean>(point, NEIGHBOURS);
        for neighbour in near.into_iter().filter(|near| near.item != u64::from(from)) {
            let way = Vec3::from(points[neighbour.item as usize]) - Vec3::from(*point);
            let octant = way.cmplt(Vec3::ZERO).bitmask() as usize;
            if std::mem::take(&mut open[octant]) {
                edges.push((from, neighbour.item as u32, way.length() - way.y));
            }
        }
    }
    edges.sort_unstable_by_key(|&(from, to, _)| (from, to));
    let graph = Csr::<(), f32>::from_sorted_edges(&edges).expect("sorted edges");
    (0..searches)
        .map(|root| dijkstra(&graph, root as u32, None, |edge| edge.weight().max(0.0)).len() as f32)
        .sum()
}

/// All edges with the weights that the finished search gave them, sorted.
fn freeze(graph: &Graph, search: &Search<'_>) -> Vec<(u32, u32, f32)> {
    let mut edges = Vec::with_capacity(graph.edges());
    // After the search its path is on the tree, which keeps the vectors.
    for from in (0..graph.nodes() as u32).filter(|&node| search.is_settled(node)) {
        let vector = search.vector(from).expect("settled");
        for &to in graph.neighbours(from) {
            let edge = graph.position(to) - graph.position(from);
            let length = edge.length();
            edges.push((from, to, length * (1.0 - (edge / length).dot(vector)).max(0.0)));
        }
    }
    edges.sort_unstable_by_key(|&(from, to, _)| (from, to));
    edges
}

/// The largest difference between the costs of both searches, relative to the peer's; stops the bench if they
/// did not do the same work. The path that has joined the tree costs nothing any more and is left out.
fn compare(search: &Search<'_>, csr: &Csr<(), f32>) -> f32 {
    let costs = dijkstra(csr, search.graph().root(), None, |edge| *edge.weight());
    let nodes = search.graph().nodes() as u32;
    let settled = (0..nodes).filter(|&node| search.is_settled(node)).count();
    assert_eq!(settled, costs.len(), "both searches reach the same nodes");
    let largest = costs
        .iter()
        .filter(|&(&node, _)| !search.is_on_tree(node))
        .filter_map(|(&node, &cost)| Some((search.cost(node)? - cost).abs() / cost.max(f32::MIN_POSITIVE)))
        .fold(0.0, f32::max);
    assert!(largest < 1e-4, "both searches find the same costs, but they differ by {largest}");
    largest
}
