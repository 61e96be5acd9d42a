//! Leaves placed, written and drawn: about 100,000 of them on a tree of about 21,000 segments, one thread.

mod measure;

use measure::{PRESET, SEED, Samples, count, number, print_table};
use treesynth::export::{GlbOptions, Instancing, write_glb_parts};
use treesynth::foliage::{Foliage, Leaf};
use treesynth::presets::TYPICAL_NODES;
use treesynth::preview::Preview;
use treesynth::surface::{Material, Part, Tubes};

const PLACED: &str = "leaves placed";
const WRITTEN: &str = "GLB written to memory";
const COPIED: &str = "as many bytes copied";
const DRAWN: &str = "preview of 900 x 900";
const DRAWN_BY_TWO: &str = "preview of 900 x 900, two threads";

/// Goals, milliseconds.
const GOALS: [(&str, f64); 4] = [(PLACED, 10.0), (WRITTEN, 30.0), (DRAWN, 1000.0), (DRAWN_BY_TWO, 1000.0)];

fn main() {
    measure::single_thread();
    let mut criterion = measure::criterion();
    let tree =
        measure::tree(measure::size(TYPICAL_NODES, 10_000)).synthesize(SEED).expect("the preset grows");
    let foliage = Foliage::new(Leaf::ovate().with_petiole(0.2)).with_spacing(0.017);
    let leaves = foliage.place(&tree, SEED).expect("the options are sound");
    let bark = Tubes::default().with_sides(8).with_least_sides(8).mesh(&tree).expect("radii are set");
    let parts = [Part::new(&bark).with_material(Material::bark()), leaves.part()];
    let options = GlbOptions::default().with_instancing(Instancing::Extension);
    let write = |glb: &mut Vec<u8>| {
        glb.clear();
        write_glb_parts(&parts, &options, glb).expect("memory takes everything");
    };
    let mut glb = Vec::new();
    write(&mut glb);
    let preview = Preview::default();

    let mut samples = Samples::default();
    let mut group = measure::group(&mut criterion, "foliage");
    group.bench_function(PLACED, |bencher| {
        samples.time(bencher, PLACED, || foliage.place(&tree, SEED));
    });
    let mut target = Vec::with_capacity(glb.len());
    group.bench_function(WRITTEN, |bencher| samples.time(bencher, WRITTEN, || write(&mut target)));
    group.bench_function(COPIED, |bencher| {
        samples.time(bencher, COPIED, || target.copy_from_slice(&glb));
    });
    group.bench_function(DRAWN, |bencher| samples.time(bencher, DRAWN, || preview.draw_parts(&parts)));
    let two = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads can be started");
    group.bench_function(DRAWN_BY_TWO, |bencher| {
        samples.time(bencher, DRAWN_BY_TWO, || two.install(|| preview.draw_parts(&parts)));
    });
    group.finish();
    criterion.final_summary();

    let title = format!(
        "Preset {PRESET}, one thread: {} segments, {} triangles of bark, {} leaves of {} triangles, {} bytes. Medians.",
        count(tree.segments()),
        count(bark.triangles().len()),
        count(leaves.instances.len()),
        leaves.leaf.mesh().triangles().len(),
        count(glb.len()),
    );
    let rows: Vec<Vec<String>> = [PLACED, WRITTEN, COPIED, DRAWN, DRAWN_BY_TWO]
        .iter()
        .filter_map(|name| {
            let goal = GOALS.iter().find(|(named, _)| named == name);
            let goal = goal.map_or_else(String::new, |(_, goal)| number(*goal));
            Some(vec![(*name).to_owned(), number(samples.median(name)?), goal])
        })
        .collect();
    print_table(&title, &["", "ms", "wanted"], &rows);
}
