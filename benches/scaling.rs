//! The whole tree and its steps from 10,000 to 1,000,000 nodes, one thread.

mod measure;

use criterion::BenchmarkId;
use measure::{Clock, PRESET, SEED, Samples, count, number, print_table};
use treesynth::guided::{Search, SynthesisError, TreeSynth};

const NODES: [usize; 5] = [10_000, 30_000, 100_000, 300_000, 1_000_000];

/// As [`TreeSynth::synthesize`], but says how many nodes the graph had.
fn synthesize(synth: &TreeSynth, clock: &Clock) -> Result<usize, SynthesisError> {
    let graph = synth.build_graph(SEED, clock)?;
    synth.grow(&mut Search::new(&graph), SEED, clock)?;
    Ok(graph.nodes())
}

fn main() {
    measure::single_thread();
    let mut criterion = measure::criterion();
    let mut samples = Samples::default();
    let sizes = if measure::is_test() { &NODES[..2] } else { &NODES[..] };
    let mut found = vec![0; sizes.len()];
    for (nodes, found) in sizes.iter().zip(&mut found) {
        let synth = measure::tree(*nodes);
        let mut group = measure::group(&mut criterion, "scaling");
        group.bench_function(BenchmarkId::new("whole tree", nodes), |bencher| {
            samples.steps(bencher, &nodes.to_string(), |clock| {
                *found = synthesize(&synth, clock).expect("the preset grows");
            });
        });
        group.finish();
    }
    criterion.final_summary();

    let head = ["nodes", "whole tree, ms", "whole tree", "nodes", "edges", "stages", "radii"];
    let table = |unit: &str, per: fn(f64) -> f64| {
        let rows: Vec<Vec<String>> = sizes
            .iter()
            .zip(&found)
            .filter_map(|(asked, &nodes)| {
                let mut row = vec![count(nodes), number(samples.median(&asked.to_string())?)];
                for step in ["", "/nodes", "/edges", "/stages", "/radii"] {
                    let time = samples.median(&format!("{asked}{step}"))?;
                    row.push(number(time * 1e6 / per(nodes as f64)));
                }
                Some(row)
            })
            .collect();
        print_table(&format!("Preset {PRESET}, one thread, medians: ns / {unit}."), &head, &rows);
    };
    table("n, for n nodes", |n| n);
    table("(n log2 n), for n nodes", |n| n * n.log2());
}
