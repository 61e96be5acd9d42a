//! Gain by a second thread (feature `parallel`): the typical tree, trees refined between stages,
//! and ten trees on one graph. Each in the same run on one thread and on two.

mod measure;

use measure::{SEED, Samples, count, number, print_table};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use rayon::{ThreadPool, ThreadPoolBuilder};
use treesynth::Silent;
use treesynth::glam::Vec3;
use treesynth::guided::{
    Bend, Count, Graph, HopSurface, InShape, NearestTo, PoissonYao, Refinement, Search, Stage, TreeSynth,
};
use treesynth::presets::TYPICAL_NODES;
use treesynth::shape::{Cuboid, Ellipsoid};

/// Trees that share a graph.
const TREES: u64 = 10;

fn main() {
    let mut criterion = measure::criterion();
    let pools = [1, 2].map(|threads| {
        ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started")
    });
    let typical = measure::tree(measure::size(TYPICAL_NODES, 10_000));
    let graph = typical.build_graph(SEED, &Silent).expect("the preset has a graph");
    let refined = [1, 2, 3].map(refined);
    let halvings = measure::size(3, 1);
    let mut samples = Samples::default();
    let mut rows: Vec<(String, String)> = Vec::new();

    let mut group = measure::group(&mut criterion, "threads");
    for (pool, threads) in pools.iter().zip(1..) {
        group.bench_function(format!("typical tree/{threads}"), |bencher| {
            samples.steps(bencher, &format!("typical/{threads}"), |clock| {
                pool.install(|| typical.synthesize_observed(SEED, clock))
            });
        });
        group.bench_function(format!("{TREES} trees on one graph/{threads}"), |bencher| {
            samples.time(bencher, &format!("ten/{threads}"), || pool.install(|| trees(&typical, &graph)));
        });
        for (synth, halvings) in refined[..halvings].iter().zip(1..) {
            group.bench_function(format!("{halvings} halvings/{threads}"), |bencher| {
                samples.time(bencher, &format!("{halvings}/{threads}"), || {
                    pool.install(|| synth.synthesize(SEED))
                });
            });
        }
    }
    group.finish();
    criterion.final_summary();

    for (what, name) in [("nodes", "/nodes"), ("edges", "/edges"), ("stages", "/stages"), ("whole", "")] {
        rows.push((format!("typical tree, {}: {what}", count(graph.nodes())), format!("typical/_{name}")));
    }
    rows.push((format!("{TREES} typical trees on one graph"), "ten/_".to_owned()));
    for (synth, halvings) in refined[..halvings].iter().zip(1..) {
        rows.push((refined_title(synth, &pools[1], halvings), format!("{halvings}/_")));
    }
    let rows: Vec<Vec<String>> = rows
        .into_iter()
        .filter_map(|(what, name)| {
            let [one, two] = ["1", "2"].map(|threads| samples.median(&name.replace('_', threads)));
            let (one, two) = (one?, two?);
            Some(vec![what, number(one), number(two), number(one / two)])
        })
        .collect();
    print_table("Medians.", &["", "one thread, ms", "two threads, ms", "one / two"], &rows);
}

/// Every tree has its own seed; a thread goes on in the memory of its last tree.
fn trees(synth: &TreeSynth, graph: &Graph) -> usize {
    (0..TREES)
        .into_par_iter()
        .map_init(
            || Search::new(graph),
            |search, seed| synth.grow(search, seed, &Silent).map(|tree| tree.nodes.len()),
        )
        .map(|nodes| nodes.expect("the preset grows"))
        .sum()
}

/// A tree of 10 m on a graph of 3% of that, then refined to a half of it, a quarter and an eighth.
fn refined(halvings: u8) -> TreeSynth {
    let region = Cuboid::new(Vec3::new(-5.0, 0.0, -5.0), Vec3::new(5.0, 10.0, 5.0));
    let crown = Ellipsoid::new(Vec3::Y * 6.0, Vec3::new(3.2, 3.2, 3.2));
    let fork = || Bend::piecewise(30f32.to_radians(), 0.0, 1);
    let start = TreeSynth::new(PoissonYao::new(region).with_spacing(0.3))
        .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 7.0)))
        .stage(Stage::new(
            Bend::piecewise(60f32.to_radians(), 0.0, 1),
            InShape::poisson_disc(crown, Count::UpTo(70)),
        ));
    (1..=halvings).zip([500, 2500, 12_000]).fold(start, |synth, (halving, endpoints)| {
        let refinement = Refinement::new(region, 0.3 / f32::from(1u8 << halving)).with_reach(6);
        let surface = HopSurface::new(4, Count::UpTo(endpoints)).with_outermost(0.7);
        synth.stage(Stage::new(fork(), surface).with_refinement(refinement))
    })
}

/// Says how large the tree is.
fn refined_title(synth: &TreeSynth, pool: &ThreadPool, halvings: usize) -> String {
    let coarse = synth.build_graph(SEED, &Silent).expect("a graph in a box");
    let growth =
        pool.install(|| synth.grow(&mut Search::new(&coarse), SEED, &Silent)).expect("a refined tree");
    let nodes = growth.graph.map_or(0, |graph| graph.nodes());
    let segments = growth.skeleton.segments();
    format!("{halvings} halvings: {} nodes, {} segments", count(nodes), count(segments))
}
