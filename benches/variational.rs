//! Trees in shapes: table 2 of the paper, and how cost grows with the shape nodes; one thread.

mod measure;

use measure::{Samples, count, number, print_table};
use treesynth::Silent;
use treesynth::presets;
use treesynth::variational::VariationalSynth;

/// Preset, shape nodes, branches, and the seconds of the paper's 3.4 GHz i7-2600.
const TABLE_2: [(&str, usize, usize, f64); 3] = [
    ("variational-12-left", 3500, 5741, 33.5),
    ("variational-12-centre", 4144, 6845, 37.4),
    ("variational-12-right", 1792, 2565, 12.6),
];
const NODES: [usize; 4] = [3_000, 10_000, 30_000, 100_000];

fn synth(preset: &str, nodes: usize) -> VariationalSynth {
    presets::by_name(preset).unwrap().variational().unwrap().synth(nodes).expect("a shape")
}

fn main() {
    measure::single_thread();
    let mut criterion = measure::criterion();
    let mut samples = Samples::default();
    let mut group = measure::group(&mut criterion, "variational");
    let mut branches = Vec::new();
    for (preset, nodes, ..) in TABLE_2 {
        let synth = synth(preset, measure::size(nodes, 300));
        group.bench_function(preset, |bencher| samples.time(bencher, preset, || synth.grow(1, &Silent)));
        branches.push(synth.synthesize(1).expect("a tree").segments());
    }
    let sizes = if measure::is_test() { &NODES[..1] } else { &NODES[..] };
    for &nodes in sizes {
        let synth = synth("variational-14-oak", nodes);
        let name = nodes.to_string();
        group.bench_function(&name, |bencher| samples.time(bencher, &name, || synth.grow(1, &Silent)));
    }
    group.finish();
    criterion.final_summary();

    let rows: Vec<Vec<String>> = TABLE_2
        .iter()
        .zip(branches)
        .filter_map(|(&(preset, nodes, theirs, seconds), branches)| {
            let time = samples.median(preset)?;
            Some(vec![
                preset.to_owned(),
                count(nodes),
                count(branches),
                number(branches as f64 / theirs as f64),
                number(time),
                format!("{:.4}", time / (1e3 * seconds)),
            ])
        })
        .collect();
    let head = ["table 2", "shape nodes", "branches", "/ paper's", "ms", "/ paper's"];
    print_table("Trees of figure 12, one thread, medians; the paper's on a 3.4 GHz i7-2600:", &head, &rows);
    let rows: Vec<Vec<String>> = sizes
        .iter()
        .filter_map(|&nodes| {
            let time = samples.median(&nodes.to_string())?;
            Some(vec![count(nodes), number(time), number(time * 1e3 / nodes as f64)])
        })
        .collect();
    print_table(
        "Growth of cost, preset variational-14-oak:",
        &["shape nodes", "ms", "µs a shape node"],
        &rows,
    );
}
