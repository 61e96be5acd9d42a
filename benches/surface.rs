//! The surface of a tree at 8 sides: milliseconds, and vertices per second.

mod measure;

use measure::{PRESET, SEED, Samples, count, number, print_table};
use rayon::ThreadPoolBuilder;
use treesynth::surface::{Capsules, Levels, Tubes};

/// Nodes of the graph: four times the typical number, for about 16,000 segments.
const NODES: usize = 600_000;
/// Goal for `GOAL_SEGMENTS` segments at 8 sides, milliseconds. Time grows with the segments.
const GOAL: f64 = 15.0;
const GOAL_SEGMENTS: f64 = 21_000.0;
/// The row that is measured on two threads too.
const TWO: &str = "levels, two threads";

fn main() {
    measure::single_thread();
    let two = ThreadPoolBuilder::new().num_threads(2).build().expect("threads can be started");
    let mut criterion = measure::criterion();
    let tree = measure::tree(measure::size(NODES, 10_000)).synthesize(SEED).expect("the preset grows");
    let tree = tree.relaxed(0.5, 3).expect("sound options");
    let eight = Tubes::default().with_sides(8).with_least_sides(8);
    let plain = eight.clone().with_turn(7.0).with_collars(false).with_root_flare(0.0);
    let cases = [
        ("one ring per node", plain.clone()),
        ("one ring per node, collars", plain.with_collars(true)),
        ("a ring every 20°, collars, root flare", eight.clone()),
        ("the same with wind weights", eight.with_wind(true)),
        ("default: 12 to 4 sides", Tubes::default()),
    ];
    let mut samples = Samples::default();
    let mut group = measure::group(&mut criterion, "surface");
    group.sample_size(30);
    let mesh = cases[0].1.mesh(&tree).expect("a surface");
    group.bench_function("copy", |bencher| samples.time(bencher, "copy", || mesh.clone()));
    let mut sizes = Vec::new();
    for (name, tubes) in &cases {
        let mesh = tubes.mesh(&tree).expect("a surface");
        sizes.push((mesh.positions.len(), mesh.triangles().len()));
        drop(mesh);
        group.bench_function(*name, |bencher| samples.time(bencher, name, || tubes.mesh(&tree)));
    }
    let levels = Levels::default();
    group.bench_function("levels", |bencher| samples.time(bencher, "levels", || levels.of(&tree)));
    group.bench_function(TWO, |bencher| {
        samples.time(bencher, TWO, || two.install(|| levels.of(&tree)));
    });
    group.bench_function("capsules", |bencher| {
        samples.time(bencher, "capsules", || Capsules::default().of(&tree));
    });
    group.finish();
    criterion.final_summary();

    let scale = GOAL_SEGMENTS / tree.segments() as f64;
    let mut rows = Vec::new();
    let names =
        ["copy"].into_iter().chain(cases.iter().map(|(name, _)| *name)).chain(["levels", TWO, "capsules"]);
    // The copy is one of the first mesh.
    let sizes = sizes.first().into_iter().chain(&sizes).map(Some).chain([None; 3]);
    for (name, size) in names.zip(sizes) {
        let Some(time) = samples.median(name) else { continue };
        let mut row = vec![name.to_owned(), number(time), number(time * scale), number(time * scale / GOAL)];
        row.extend(match size {
            Some(&(vertices, triangles)) => {
                [count(vertices), count(triangles), number(vertices as f64 / time / 1e3)]
            }
            None => [const { String::new() }; 3],
        });
        rows.push(row);
    }
    print_table(
        &format!(
            "Preset {PRESET}, {} segments, one thread but where it is said, medians:",
            count(tree.segments())
        ),
        &["", "ms", "ms for 21,000", "... / goal", "vertices", "triangles", "million vertices per second"],
        &rows,
    );
}
