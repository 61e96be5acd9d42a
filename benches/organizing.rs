//! Self-organizing growth: the two cases of the original program, with its defaults.
//!
//! The program halves the exponent of the shadow's fall with depth, which its text does not say; so do these cases.

mod measure;

use measure::{Samples, count, number, print_table};
use treesynth::glam::Vec3;
use treesynth::self_organizing::{Forest, Habit, ShadowPropagation};

/// Name, trees along a side, seasons; metamers and milliseconds of the original on a machine like this one; goal.
const CASES: [(&str, usize, u32, usize, f64, f64); 2] =
    [("one tree", 1, 20, 23_234, 30.0, 10.0), ("25 trees", 5, 21, 184_276, 519.0, 175.0)];

/// The trees stand in the middles of the squares of a lattice over 3.2 m by 3.2 m.
fn grown(side: usize, seasons: u32, seed: u64) -> Forest {
    let light = ShadowPropagation::default().with_falloff(1.5f32.sqrt());
    let mut forest = Forest::new(light, Habit::default(), seed);
    let at = |i: usize| 3.2 * ((i as f32 + 0.5) / side as f32 - 0.5);
    for i in 0..side * side {
        forest.plant(Vec3::new(at(i / side), 0.0, at(i % side))).expect("there is room");
    }
    forest.grow(seasons).expect("no limit is near");
    forest
}

fn main() {
    measure::single_thread();
    let mut criterion = measure::criterion();
    let mut samples = Samples::default();
    let seasons = |full: u32| measure::size(full as usize, 6) as u32;
    let mut group = measure::group(&mut criterion, "organizing");
    for (name, side, full, ..) in CASES {
        group.bench_function(name, |bencher| {
            samples.time(bencher, name, || grown(side, seasons(full), measure::SEED));
        });
    }
    #[cfg(feature = "parallel")]
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("a pool of two threads");
    #[cfg(feature = "parallel")]
    group.bench_function("25 trees, two threads", |bencher| {
        let (name, side, full, ..) = CASES[1];
        let name = format!("{name}, two threads");
        samples.time(bencher, &name, || pool.install(|| grown(side, seasons(full), measure::SEED)));
    });
    group.finish();
    criterion.final_summary();

    let rows = CASES.iter().filter_map(|&(name, side, full, metamers, original, goal)| {
        let time = samples.median(name)?;
        // Trees of one seed differ much, stands do not.
        let seeds = if side == 1 { 8 } else { 1 };
        let ours: usize = (1..=seeds).map(|seed| grown(side, seasons(full), seed).metamers()).sum();
        let ours = ours / seeds as usize;
        let one = grown(side, seasons(full), measure::SEED).metamers();
        let each = |time: f64, metamers: usize| time * 1e6 / metamers as f64;
        let two = samples.median(&format!("{name}, two threads"));
        Some(vec![
            name.to_owned(),
            count(ours),
            count(metamers),
            number(time),
            number(goal),
            number(original),
            number(each(time, one)),
            number(each(original, metamers)),
            two.map_or_else(String::new, |two| number(time / two)),
        ])
    });
    print_table(
        "Growth alone, one thread, beside the original in C++ as measured on a 2-core x86-64 machine.",
        &[
            "case",
            "metamers, mean",
            "original's",
            "ms",
            "goal, ms",
            "original, ms",
            "ns a metamer",
            "original's",
            "two threads faster by",
        ],
        &rows.collect::<Vec<_>>(),
    );
}
