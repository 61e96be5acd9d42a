//! Assets of an oak in leaf: cards, budgets, levels and impostors, one thread.

mod measure;

use measure::{SEED, Samples, count, number, print_table};
use treesynth::asset::{AssetBuilder, Impostor, LeafImages, Likeness};
use treesynth::presets::{self, Season};

const LEAF: &str = "leaf images, 4 of 128 x 128";
const SMALL: &str = "asset of 10,000 triangles";
const LARGE: &str = "asset of 100,000 triangles";
const LEVELS: &str = "three levels from 20,000";
const FAR: &str = "billboards, 512 x 512";
const AROUND: &str = "octahedral, 8 x 8 views, 1024 x 1024";

fn main() {
    measure::single_thread();
    let mut criterion = measure::criterion();
    let preset = presets::by_name("fine-oak").expect("a preset").guided().unwrap();
    let tree = preset.synth(measure::size(40_000, 5_000)).synthesize(SEED).expect("the preset grows");
    let tree = tree.relaxed(0.5, 3).expect("sound options");
    let foliage = preset.foliage(Season::Summer).expect("in leaf");
    let builder = AssetBuilder::default().with_bark(preset.bark()).with_foliage(foliage.clone());
    let within = |triangles| builder.clone().with_triangles(triangles).build(&tree, SEED).expect("an asset");
    let dense = within(None);
    let levels = |most| builder.clone().with_triangles(Some(most)).levels(&tree, SEED, &[1.0, 0.3, 0.08]);
    let around = Impostor::default().with_texture_size(1024);

    let mut samples = Samples::default();
    let mut group = measure::group(&mut criterion, "asset");
    group.bench_function(LEAF, |bencher| {
        samples.time(bencher, LEAF, || LeafImages::of(foliage.leaf(), 4, 128, SEED));
    });
    group.bench_function(SMALL, |bencher| samples.time(bencher, SMALL, || within(Some(10_000))));
    group.bench_function(LARGE, |bencher| samples.time(bencher, LARGE, || within(Some(100_000))));
    group.bench_function(LEVELS, |bencher| samples.time(bencher, LEVELS, || levels(20_000)));
    group.bench_function(FAR, |bencher| {
        samples.time(bencher, FAR, || Impostor::default().billboards(&dense.parts()));
    });
    group.bench_function(AROUND, |bencher| {
        samples.time(bencher, AROUND, || around.octahedral(&dense.parts()));
    });
    group.finish();
    criterion.final_summary();

    let title = format!(
        "fine-oak, one thread: {} segments, {} leaves, {} triangles in all. Medians.",
        count(tree.segments()),
        count(dense.leaves()),
        count(dense.triangles()),
    );
    let rows: Vec<Vec<String>> = [LEAF, SMALL, LARGE, LEVELS, FAR, AROUND]
        .iter()
        .filter_map(|name| Some(vec![(*name).to_owned(), number(samples.median(name)?)]))
        .collect();
    print_table(&title, &["", "ms"], &rows);
    let height = dense.bark().bounds().map_or(1.0, |bounds| bounds.size().y);
    let far = Impostor::default().billboards(&dense.parts()).expect("an impostor");
    let rows: Vec<Vec<String>> = levels(10_000)
        .expect("levels")
        .iter()
        .chain([&far])
        .filter_map(|level| {
            let pixels = level.pixels(height).clamp(32.0, 1024.0) as u32;
            let like = Likeness::of(&level.parts(), &dense.parts(), pixels).ok()?;
            let percent = format!("{:+.1}%", 100.0 * like.cover);
            let (color, ssim) = (format!("{:.2}", like.color), format!("{:.3}", like.ssim));
            Some(vec![count(level.triangles()), pixels.to_string(), percent, color, ssim])
        })
        .collect();
    print_table(
        "Levels of fine-oak beside the dense model",
        &["triangles", "pixels high", "cover", "Lab", "SSIM"],
        &rows,
    );
}
