//! The most heap that a whole tree has in use, counted by the allocator, step by step, in bytes per node; and
//! of a skin.
//!
//! Apart from the other benches, for the counting allocator grows blocks by copying them and fills zeroed ones
//! by hand: its times are no use, and its peak is what an allocator needs that can do no better.

mod measure;

use measure::{PRESET, SEED, count, label, number, print_table};
use peak_alloc::PeakAlloc;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use treesynth::growth::{Architecture, Growth};
use treesynth::guided::{Search, SynthesisError, TreeSynth};
use treesynth::surface::{Polygonizer, blob::Skin};
use treesynth::{Observer, Progress, Work};

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

/// Goal, bytes per node.
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
    /// Memory of the finished graph.
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

/// The skin of the cottonwood at 26.6 years and polygons of it, in MB: what it holds, and the most while it is made.
fn poplar() -> Vec<Vec<String>> {
    let age = if measure::is_test() { 5.6 } else { 26.6 };
    let growth = Growth::new(Architecture::cottonwood(), SEED).expect("a species in range");
    let skeleton = growth.at(age).expect("an age in range").skeleton;
    let mut rows = Vec::new();
    let mut note = |name: String, before: usize| {
        let [held, peak] =
            [HEAP.current_usage(), HEAP.peak_usage()].map(|bytes| bytes.saturating_sub(before));
        rows.push(vec![name, number(held as f64 / 1e6), number(peak as f64 / 1e6)]);
        HEAP.reset_peak_usage();
    };
    HEAP.reset_peak_usage();
    let before = HEAP.current_usage();
    let tree = Skin::default().with_age(age + 1.0).blob_tree(&skeleton).expect("a skin");
    note(format!("BlobTree of {} primitives", count(tree.primitives())), before);
    for detail in if measure::is_test() { [64.0, 128.0] } else { [1024.0, 8192.0] } {
        let before = HEAP.current_usage();
        let voxel = tree.bounds().size().max_element() / detail;
        let surface = Polygonizer::default().with_voxel(voxel).with_detail(1.0).with_most_blocks(20_000_000);
        let mesh = surface.mesh(&tree).expect("a surface");
        note(format!("polygons, {detail} voxels per side: {} vertices", count(mesh.positions.len())), before);
    }
    rows
}

fn main() {
    measure::single_thread();
    print_table("The cottonwood at 26.6 years:", &["", "held, MB", "peak, MB"], &poplar());
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
        &format!("Preset {PRESET}, one thread: the most heap in use, bytes per node."),
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
