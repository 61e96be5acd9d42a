//! The typical tree, step by step: 150,000 nodes, five stages, about 6500 endpoints, one thread.

mod measure;

use measure::{PRESET, SEED, Samples, count, number, print_table};
use treesynth::Silent;
use treesynth::guided::Search;
use treesynth::presets::TYPICAL_NODES;

const WHOLE: &str = "whole tree";
const STANDING: &str = "on a standing graph";
const REUSED: &str = "on a standing graph, search reused";

/// Goals for the whole tree and for a tree on a standing graph, milliseconds.
const GOALS: [f64; 2] = [1000.0, 250.0];
/// The paper's measurement (section 4, one CPU of 2.8 GHz): the whole, its graph, its paths;
/// milliseconds.
const PAPER: [f64; 3] = [9500.0, 6000.0, 2000.0];

fn main() {
    measure::single_thread();
    let mut criterion = measure::criterion();
    let synth = measure::tree(measure::size(TYPICAL_NODES, 10_000));
    let graph = synth.build_graph(SEED, &Silent).expect("the preset has a graph");
    let mut search = Search::new(&graph);
    let growth = synth.grow(&mut search, SEED, &Silent).expect("the preset grows");
    let mut samples = Samples::default();

    let mut group = measure::group(&mut criterion, "pipeline");
    group.bench_function(WHOLE, |bencher| {
        samples.steps(bencher, WHOLE, |clock| synth.synthesize_observed(SEED, clock));
    });
    group.bench_function(STANDING, |bencher| {
        samples.time(bencher, STANDING, || synth.synthesize_on(&graph, SEED));
    });
    group.bench_function(REUSED, |bencher| {
        samples.steps(bencher, REUSED, |clock| synth.grow(&mut search, SEED, clock));
    });
    group.finish();
    criterion.final_summary();

    let endpoints: Vec<String> = growth.endpoints.iter().map(|stage| stage.len().to_string()).collect();
    let title = format!(
        "Preset {PRESET}, one thread: {} nodes, {} edges, {} endpoints ({}), {} segments. Medians.",
        count(graph.nodes()),
        count(graph.edges()),
        count(growth.endpoints.iter().map(Vec::len).sum()),
        endpoints.join(" + "),
        count(growth.skeleton.segments()),
    );
    print_steps(&samples, &title, graph.nodes(), growth.endpoints.len());
    print_goals(&samples);
}

/// Each step of the whole tree, its part of the whole, and the same step on a standing graph.
fn print_steps(samples: &Samples, title: &str, nodes: usize, stages: usize) {
    let mut steps = vec!["nodes".to_owned(), "edges".to_owned()];
    steps.extend((1..=stages).map(|stage| format!("stage {stage}")));
    steps.push("radii".to_owned());
    let Some(whole) = samples.median(WHOLE) else { return };
    let mut rows: Vec<Vec<String>> = steps
        .iter()
        .filter_map(|step| {
            let time = samples.median(&format!("{WHOLE}/{step}"))?;
            let reused = samples.median(&format!("{REUSED}/{step}"));
            Some(row(step, time, whole, nodes, reused))
        })
        .collect();
    rows.push(row("whole", whole, whole, nodes, samples.median(REUSED)));
    print_table(title, &["step", "ms", "share", "ns per node", "ms, search reused"], &rows);
}

fn row(step: &str, time: f64, whole: f64, nodes: usize, reused: Option<f64>) -> Vec<String> {
    vec![
        step.to_owned(),
        number(time),
        format!("{:.0}%", 100.0 * time / whole),
        number(time * 1e6 / nodes as f64),
        reused.map_or_else(String::new, number),
    ]
}

/// The sums beside what is wanted of them and what the paper needed.
fn print_goals(samples: &Samples) {
    let [whole_goal, standing_goal] = GOALS.map(Some);
    let [paper_whole, paper_graph, paper_paths] = PAPER.map(Some);
    let sums = [
        ("whole tree", WHOLE.to_owned(), whole_goal, paper_whole),
        ("graph: nodes and edges", format!("{WHOLE}/graph"), None, paper_graph),
        ("paths: all stages", format!("{WHOLE}/stages"), None, paper_paths),
        ("tree on a standing graph (synthesize_on)", STANDING.to_owned(), standing_goal, None),
        ("the same with a reused Search (grow)", REUSED.to_owned(), standing_goal, None),
    ];
    let rows: Vec<Vec<String>> = sums
        .into_iter()
        .filter_map(|(what, name, goal, paper)| {
            let time = samples.median(&name)?;
            let text = |value: Option<f64>, text: fn(f64) -> String| value.map_or_else(String::new, text);
            Some(vec![
                what.to_owned(),
                number(time),
                text(goal, |goal| format!("< {goal:.0}")),
                text(goal.map(|goal| time / goal), number),
                text(paper, |paper| format!("{paper:.0}")),
                text(paper.map(|paper| time / paper), |ratio| format!("{ratio:.3}")),
            ])
        })
        .collect();
    print_table(
        "Beside the goals, and the paper's figures on a CPU of 2.8 GHz (2015):",
        &["", "ms", "goal, ms", "ms / goal", "paper, ms", "ms / paper"],
        &rows,
    );
}
