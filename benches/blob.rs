//! `BlobTree`s: building one of more than 150,000 primitives, and evaluations of its field with and without the
//! hierarchy, one thread.

mod measure;

use measure::{PRESET, SEED, Samples, count, number, print_table};
use treesynth::Bounds;
use treesynth::glam::Vec3;
use treesynth::surface::blob::Skin;

/// Nodes of the graph, and the greatest turn of the skin: as many cones as wanted.
const NODES: usize = 1_000_000;
const TURN: f32 = 0.015;
/// Goal of building, milliseconds.
const GOAL: f64 = 1000.0;
/// Points evaluated at once.
const POINTS: usize = 4096;
/// Without the hierarchy.
const FEW: usize = 4;

/// Numbers from -1 to 1 that look random.
fn jitter(i: usize) -> Vec3 {
    let unit = |n: usize| ((i * 3 + n) as u32).wrapping_mul(2_654_435_761) as f32 / u32::MAX as f32;
    Vec3::new(unit(0), unit(1), unit(2)) * 2.0 - 1.0
}

fn main() {
    let mut criterion = measure::criterion();
    measure::single_thread();
    let tree = measure::tree(measure::size(NODES, 10_000)).synthesize(SEED).expect("the preset grows");
    let tree = tree.relaxed(0.5, 3).expect("sound options");
    let skin = Skin::default().with_turn(TURN);
    let blob = skin.blob_tree(&tree).expect("a skin");
    // Within two radii of nodes here and there: where pictures are.
    let nodes = tree.len();
    let place = |i: usize| {
        let node = i * 7919 % nodes;
        (tree.positions()[node] + jitter(i) * 2.0 * tree.radii()[node], tree.radii()[node])
    };
    let points: Vec<Vec3> = (0..POINTS).map(|i| place(i).0).collect();
    let mut samples = Samples::default();
    let mut group = measure::group(&mut criterion, "blob");
    group.bench_function("build", |bencher| samples.time(bencher, "build", || skin.blob_tree(&tree)));
    group.bench_function("value", |bencher| {
        samples.time(bencher, "value", || points.iter().map(|&point| blob.value(point)).sum::<f32>());
    });
    group.bench_function("gradient", |bencher| {
        samples.time(bencher, "gradient", || points.iter().map(|&point| blob.gradient(point).0).sum::<f32>());
    });
    // A part for 64 points within a cube, as polygonizers and ray casters have them; finding it, and using it.
    let cubes: Vec<Bounds> = (0..POINTS / 64)
        .map(|i| {
            let (middle, radius) = place(i);
            Bounds::around(middle, Vec3::splat(0.5 * radius))
        })
        .collect();
    group.bench_function("parts", |bencher| {
        samples.time(bencher, "parts", || cubes.iter().map(|&cube| blob.part(cube).len()).sum::<usize>());
    });
    let parts: Vec<_> = cubes.iter().map(|&cube| blob.part(cube)).collect();
    let within = |cube: &Bounds, i: usize| cube.at(jitter(i) * 0.5 + 0.5);
    group.bench_function("in parts", |bencher| {
        samples.time(bencher, "in parts", || {
            let cubes = parts.iter().zip(&cubes);
            cubes.map(|(part, cube)| (0..64).map(|i| part.value(within(cube, i))).sum::<f32>()).sum::<f32>()
        });
    });
    // Every step at every point.
    let whole = blob.part(blob.bounds());
    group.bench_function("without", |bencher| {
        let work = || points[..FEW].iter().map(|&point| whole.value(point)).sum::<f32>();
        samples.time(bencher, "without", work);
    });
    group.finish();
    criterion.final_summary();
    let Some(build) = samples.median("build") else { return };
    println!(
        "\nPreset {PRESET}, {} segments: {} primitives, {} operators, built in {} ms, {} of the goal.",
        count(tree.segments()),
        count(blob.primitives()),
        count(blob.operators()),
        number(build),
        number(build / GOAL),
    );
    let slow = samples.median("without").map(|time| time * 1e6 / FEW as f64);
    let row = |name: &str, what: &str, each: usize| {
        let nanoseconds = samples.median(what)? * 1e6 / each as f64;
        let faster = slow.map_or_else(String::new, |slow| number(slow / nanoseconds));
        Some(vec![name.to_owned(), number(nanoseconds), number(1e3 / nanoseconds), faster])
    };
    let rows: Vec<_> = [
        row("value, without the hierarchy", "without", FEW),
        row("value", "value", POINTS),
        row("value and gradient", "gradient", POINTS),
        row("value, in a part", "in parts", POINTS),
        row("finding a part", "parts", POINTS / 64),
    ]
    .into_iter()
    .flatten()
    .collect();
    print_table("Field evaluations:", &["", "ns", "million a second", "times as fast"], &rows);
}
