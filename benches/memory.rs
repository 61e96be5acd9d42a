//! The most heap that a whole tree has in use, counted by the allocator, step by step, in bytes a node.
//!
//! Apart from the other benches, for the counting allocator grows blocks by copying them and fills zeroed ones
//! by hand: its times are no use, and its peak is what an allocator needs that can do no better.

mod measure;

use measure::{PRESET, SEED, count, label, number, print_table};
use peak_alloc::PeakAlloc;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use treesynth::guided::{Search, SynthesisError, TreeSynth};
use treesynth::{Observer, Progress, Work};

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

/// What is wanted, bytes a node.
const GOAL: f64 = 100.0;

/// Notes the peak of each step, bytes above what was in use before.
struct Gauge {
    before: usize,
    steps: Mutex<Vec<(Work, usize)>>,
}

impl Observer for Gauge {
    fn report(&self, progress: Progress) -> ControlFlow<()> {
        if progress.fraction >= 1.0 {
            let peak = HEAP.peak_usage().saturating_sub(self.before);
            self.steps.lock().unwrap_or_else(PoisonError::into_inner).push((progress.work, peak));
            HEAP.reset_peak_usage();
        }
        ControlFlow::Continue(())
    }
}

/// Bytes that one whole tree takes.
#[derive(Default)]
struct Usage {
    nodes: usize,
    /// The most in use while nodes are placed, edges are found, paths are searched, radii are worked out.
    peaks: [usize; 4],
    /// What the finished graph holds.
    graph: usize,
}

fn measure_one(synth: &TreeSynth) -> Result<Usage, SynthesisError> {
    let gauge = Gauge { before: HEAP.current_usage(), steps: Mutex::new(Vec::with_capacity(16)) };
    HEAP.reset_peak_usage();
    let graph = synth.build_graph(SEED, &gauge)?;
    let mut usage = Usage {
        nodes: graph.nodes(),
        graph: HEAP.current_usage().saturating_sub(gauge.before),
        ..Usage::default()
    };
    synth.grow(&mut Search::new(&graph), SEED, &gauge)?;
    for (work, peak) in gauge.steps.into_inner().unwrap_or_else(PoisonError::into_inner) {
        let step = match work {
            Work::Nodes => 0,
            Work::Edges => 1,
            Work::Stage { .. } => 2,
            _ => 3,
        };
        usage.peaks[step] = usage.peaks[step].max(peak);
    }
    Ok(usage)
}

fn main() {
    measure::single_thread();
    let sizes: &[usize] = if measure::is_test() { &[10_000] } else { &[150_000, 1_000_000] };
    let rows: Vec<Vec<String>> = sizes
        .iter()
        .map(|&nodes| {
            let usage = measure_one(&measure::tree(nodes)).expect("the preset grows");
            let a_node = |bytes: usize| bytes as f64 / usage.nodes as f64;
            let peak = usage.peaks.into_iter().max().unwrap_or_default();
            let mut row = vec![count(usage.nodes), number(peak as f64 / 1e6), number(a_node(peak))];
            row.push(format!("< {GOAL:.0}"));
            row.push(number(a_node(peak) / GOAL));
            row.extend(usage.peaks.map(|peak| number(a_node(peak))));
            row.push(number(a_node(usage.graph)));
            row
        })
        .collect();
    let steps = [Work::Nodes, Work::Edges].map(label);
    print_table(
        &format!("Preset {PRESET}, one thread: the most heap in use, bytes a node."),
        &[
            "nodes",
            "peak, MB",
            "peak",
            "goal",
            "peak / goal",
            &steps[0],
            &steps[1],
            "stages",
            "radii",
            "graph alone",
        ],
        &rows,
    );
}
