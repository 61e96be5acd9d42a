//! Self-organizing growth: the two cases of the original program, with its defaults.
//!
//! The program halves the exponent of the shadow's fall with depth, which its text does not say; so do these cases.

mod measure;

use measure::{Samples, count, number, print_table};
use treesynth::glam::Vec3;
use treesynth::self_organizing::{Forest, Habit, ShadowPropagation};

struct Case {
    name: &'static str,
    /// Trees along a side.
    side: usize,
    seasons: u32,
    parts: u32,
    /// Metamers and milliseconds of the original on a machine like this one.
    metamers: usize,
    original: f64,
    /// Milliseconds.
    goal: f64,
}

const ONE: Case =
    Case { name: "one tree", side: 1, seasons: 20, parts: 1, metamers: 23_234, original: 30.0, goal: 10.0 };
const MANY: Case = Case {
    name: "25 trees",
    side: 5,
    seasons: 21,
    parts: 1,
    metamers: 184_276,
    original: 519.0,
    goal: 175.0,
};
const CASES: [Case; 4] = [
    ONE,
    Case { name: "one tree, 3 parts", parts: 3, ..ONE },
    MANY,
    Case { name: "25 trees, 3 parts", parts: 3, ..MANY },
];

/// The trees stand in the middles of the squares of a lattice over 3.2 m by 3.2 m.
fn grown(case: &Case, seed: u64) -> Forest {
    let (side, seasons) = (case.side, measure::size(case.seasons as usize, 6) as u32);
    let light = ShadowPropagation::default().with_falloff(1.5f32.sqrt());
    let mut forest = Forest::new(light, Habit::default(), seed).with_parts(case.parts);
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
    let mut group = measure::group(&mut criterion, "organizing");
    for case in &CASES {
        group.bench_function(case.name, |bencher| {
            samples.time(bencher, case.name, || grown(case, measure::SEED));
        });
    }
    #[cfg(feature = "parallel")]
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("a pool of two threads");
    #[cfg(feature = "parallel")]
    group.bench_function("25 trees, two threads", |bencher| {
        let name = format!("{}, two threads", MANY.name);
        samples.time(bencher, &name, || pool.install(|| grown(&MANY, measure::SEED)));
    });
    group.finish();
    criterion.final_summary();

    let rows = CASES.iter().filter_map(|case| {
        let &Case { name, metamers, original, goal, .. } = case;
        let time = samples.median(name)?;
        // Trees of one seed differ much, stands do not.
        let seeds = if case.side == 1 { 32 } else { 1 };
        let ours: usize = (1..=seeds).map(|seed| grown(case, seed).metamers()).sum();
        let ours = ours / seeds as usize;
        let one = grown(case, measure::SEED).metamers();
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
