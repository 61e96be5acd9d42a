//! A tree in a blended skin, cast ray by ray: seconds on two threads, beside the rasterizer on a mesh of it, and a film.

mod measure;

use measure::{PRESET, SEED, Samples, count, number, print_table};
use rayon::ThreadPoolBuilder;
use treesynth::preview::{Preview, RayCaster};
use treesynth::surface::{Implicit, Tubes};
use treesynth::{Silent, Skeleton};

/// Nodes of the graph: as many as give about 17,000 segments before they are divided.
const NODES: usize = 1_000_000;
/// Primitives that each internode becomes.
const PIECES: usize = 9;
/// The paper's times on a Pentium IV, seconds: one picture, and what is wanted of each here.
const PAPER: f64 = 430.0;
const GOAL: f64 = 15.0;
/// Pictures of a film, and what is wanted of it, seconds.
const FRAMES: usize = 27;
const FILM_GOAL: f64 = 240.0;

/// Each internode as so many short ones, on the straight line between its ends.
fn divided(tree: &Skeleton, pieces: usize) -> Skeleton {
    let (mut positions, mut parents) = (vec![tree.positions()[0]], vec![None]);
    let mut radii = vec![tree.radii()[0]];
    for node in 1..tree.len() {
        let parent = tree.parent(node).expect("only the root has none");
        let [from, to] = [parent, node].map(|end| tree.positions()[end]);
        let first = positions.len() as u32;
        for piece in 1..=pieces {
            let end = (parent * pieces) as u32;
            parents.push(Some(if piece == 1 { end } else { first + piece as u32 - 2 }));
            positions.push(from.lerp(to, piece as f32 / pieces as f32));
            radii.push(tree.radii()[node]);
        }
    }
    let divided = Skeleton::new(positions, parents).expect("a tree as before");
    divided.with_radii(radii).expect("radii as before")
}

fn main() {
    let mut criterion = measure::criterion();
    let two = ThreadPoolBuilder::new().num_threads(2).build().expect("threads can be started");
    let tree = measure::tree(measure::size(NODES, 10_000)).synthesize(SEED).expect("the preset grows");
    let tree = divided(&tree.relaxed(0.5, 3).expect("sound options"), PIECES);
    let (surface, size) = (Implicit::default(), measure::size(768, 32) as u32);
    let preview = Preview::default().with_size(size, size);
    let film = preview.clone().with_size(measure::size(480, 20) as u32, measure::size(640, 20) as u32);
    let cases = [
        ("768 x 768", preview.clone()),
        ("768 x 768, one sample per pixel", preview.clone().with_supersampling(1)),
        ("480 x 640", film),
    ];
    let mut samples = Samples::default();
    let mut group = measure::group(&mut criterion, "ray");
    group.bench_function("mesh", |bencher| {
        let mesh = Tubes::default().mesh(&tree).expect("a surface");
        samples.time(bencher, "mesh", || two.install(|| preview.draw(&mesh)));
    });
    for (name, preview) in &cases {
        let caster = RayCaster::new(preview.clone());
        group.bench_function(*name, |bencher| {
            let draw = || two.install(|| caster.draw_implicit(&surface, &tree, &[], &Silent));
            samples.time(bencher, name, draw);
        });
    }
    group.finish();
    criterion.final_summary();
    let mut rows = Vec::new();
    if let Some(mesh) = samples.median("mesh") {
        rows.push(vec!["tubes, rasterized".to_owned(), number(mesh / 1e3), String::new(), String::new()]);
    }
    for (name, _) in &cases {
        if let Some(time) = samples.median(name) {
            let seconds = time / 1e3;
            let paper = number(seconds / PAPER);
            rows.push(vec![(*name).to_owned(), number(seconds), number(seconds / GOAL), paper]);
        }
    }
    if let Some(frame) = samples.median("480 x 640") {
        let seconds = frame * FRAMES as f64 / 1e3;
        rows.push(vec![
            format!("{FRAMES} of these"),
            number(seconds),
            number(seconds / FILM_GOAL),
            String::new(),
        ]);
    }
    print_table(
        &format!("Preset {PRESET}, {} primitives, two threads, medians:", count(tree.segments())),
        &["", "seconds", "of the goal", "of the paper's"],
        &rows,
    );
}
