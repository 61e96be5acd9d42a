//! The watertight surface of a tree: milliseconds on one thread and on two, beside a plain copy of the mesh, and memory's
//! main part.

mod measure;

use measure::{PRESET, SEED, Samples, count, number, print_table};
use rayon::ThreadPoolBuilder;
use treesynth::surface::Implicit;

/// Nodes of the graph: as many as give about 17,000 segments.
const NODES: usize = 1_000_000;
/// What is wanted of 21,000 segments on two threads, milliseconds. Time grows with the segments.
const GOAL: f64 = 5000.0;
const GOAL_SEGMENTS: f64 = 21_000.0;

fn main() {
    let mut criterion = measure::criterion();
    let pools = [1, 2].map(|threads| {
        ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started")
    });
    let tree = measure::tree(measure::size(NODES, 10_000)).synthesize(SEED).expect("the preset grows");
    let tree = tree.relaxed(0.5, 3).expect("sound options");
    let thinnest = tree.radii().iter().copied().fold(f32::INFINITY, f32::min);
    let surface = Implicit::default().with_voxel(thinnest);
    let cases = [
        ("a voxel a radius", surface.clone()),
        ("0.87 voxels a radius", surface.with_detail(0.87)),
        ("finest voxel twice as large", Implicit::default().with_voxel(2.0 * thinnest)),
    ];
    let mut samples = Samples::default();
    let mut group = measure::group(&mut criterion, "implicit");
    let mut rows = Vec::new();
    for (name, surface) in &cases {
        let mesh = surface.mesh(&tree).expect("a surface");
        let (vertices, triangles) = (mesh.positions.len(), mesh.triangles().len());
        group.bench_function(format!("{name}/copy"), |bencher| {
            samples.time(bencher, &format!("{name}/copy"), || mesh.clone());
        });
        drop(mesh);
        for (pool, threads) in pools.iter().zip(1..) {
            group.bench_function(format!("{name}/{threads}"), |bencher| {
                let work = || pool.install(|| surface.mesh(&tree));
                samples.time(bencher, &format!("{name}/{threads}"), work);
            });
        }
        let median = |what: &str| samples.median(&format!("{name}/{what}"));
        if let (Some(copy), Some(one), Some(two)) = (median("copy"), median("1"), median("2")) {
            let scale = GOAL_SEGMENTS / tree.segments() as f64;
            rows.push(vec![
                (*name).to_owned(),
                number(copy),
                number(one),
                number(two),
                number(two * scale / GOAL),
                count(vertices),
                number((24 * vertices + 12 * triangles) as f64 / 1e6),
                number(vertices as f64 / two / 1e3),
            ]);
        }
    }
    group.finish();
    criterion.final_summary();
    print_table(
        &format!("Preset {PRESET}, {} segments, medians:", count(tree.segments())),
        &[
            "",
            "copy, ms",
            "one thread, ms",
            "two, ms",
            "two for 21,000 / goal",
            "vertices",
            "mesh, MB",
            "million vertices a second",
        ],
        &rows,
    );
}
