//! Sets of bark images of 1024 x 1024 pixels, one thread; and a trunk that wears one.

mod measure;

use measure::{Samples, number, print_table};
use treesynth::Skeleton;
use treesynth::glam::Vec3;
use treesynth::preview::Preview;
use treesynth::surface::{Material, Part, Tubes};
use treesynth::texture::{Bark, BarkKind};

const PLAIN: &str = "preview of a trunk, 900 x 900";
const WORN: &str = "the same with oak of 1024 x 1024";
/// Goal for a set, milliseconds.
const GOAL: f64 = 300.0;

fn main() {
    measure::single_thread();
    let mut criterion = measure::criterion();
    let mut samples = Samples::default();
    let mut group = measure::group(&mut criterion, "texture");
    let pixels = measure::size(1024, 256) as u32;
    let names: Vec<String> = BarkKind::ALL.iter().map(|kind| format!("bark, {kind:?}")).collect();
    for (kind, name) in BarkKind::ALL.into_iter().zip(&names) {
        let bark = Bark::of_kind(kind).with_resolution(pixels);
        group.bench_function(name, |bencher| samples.time(bencher, name, || bark.bake()));
    }
    let skeleton = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)])
        .and_then(|pole| pole.with_radii(vec![0.3, 0.25]))
        .expect("a pole is a skeleton");
    let mesh = Tubes::default().with_sides(64).with_tile(0.5).mesh(&skeleton).expect("radii are set");
    let oak = Bark::oak().with_resolution(pixels).bake().expect("options are in range");
    let part = Part::new(&mesh).with_material(Material::white());
    let preview = Preview::default();
    group.bench_function(PLAIN, |bencher| {
        samples.time(bencher, PLAIN, || preview.draw_parts(&[part]));
    });
    let worn = part.with_textures(&oak.textures);
    group.bench_function(WORN, |bencher| samples.time(bencher, WORN, || preview.draw_parts(&[worn])));
    group.finish();
    criterion.final_summary();

    let row = |name: &str, goal: String| Some(vec![name.to_owned(), number(samples.median(name)?), goal]);
    let sets = names.iter().filter_map(|name| row(name, number(GOAL)));
    let drawn = [PLAIN, WORN].into_iter().filter_map(|name| row(name, String::new()));
    let rows: Vec<Vec<String>> = sets.chain(drawn).collect();
    print_table(&format!("{pixels} x {pixels} pixels, one thread. Medians."), &["", "ms", "wanted"], &rows);
}
