//! Self-organizing growth: the two cases of the original program, with its defaults.
//!
//! Beside them what else a forest may have: the sun, sag, the priority model, space instead of light; a pruned stand;
//! a landscape by tiles; a hectare.
//!
//! The program halves the exponent of the shadow's fall with depth, which its text does not say; so do these cases.

mod measure;

use measure::{Samples, count, number, print_table};
use treesynth::glam::{IVec2, Vec3};
use treesynth::self_organizing::{
    Daylight, Environment, Forest, Habit, Landscape, Sag, ShadowPropagation, SpaceColonization, Tree,
    VigorModel,
};
use treesynth::shape::Cuboid;
use treesynth::{Bounds, Shape};

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
    planted(ShadowPropagation::default().with_falloff(1.5f32.sqrt()), Habit::default(), case, seed)
}

fn grown_in<E: Environment>(environment: E, habit: Habit, case: &Case) -> Forest<E> {
    planted(environment, habit, case, measure::SEED)
}

fn planted<E: Environment>(environment: E, habit: Habit, case: &Case, seed: u64) -> Forest<E> {
    let (side, seasons) = (case.side, measure::size(case.seasons as usize, 6) as u32);
    let mut forest = Forest::new(environment, habit, seed).with_parts(case.parts);
    let at = |i: usize| 3.2 * ((i as f32 + 0.5) / side as f32 - 0.5);
    for i in 0..side * side {
        forest.plant(Vec3::new(at(i / side), 0.0, at(i % side))).expect("there is room");
    }
    forest.grow(seasons).expect("no limit is near");
    forest
}

/// The 25 trees with something that is not so by default.
fn plus(light: ShadowPropagation, habit: Habit) -> Forest {
    grown_in(light, habit, &MANY)
}

/// The same box and seasons, with markers instead of light: 100 in the cube of the perception distance.
fn colony() -> Forest<SpaceColonization> {
    let room = Cuboid::new(Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 1.2, 2.0));
    let markers = (100.0 / (0.12f32 * 0.12 * 0.12) * room.volume() * 0.1) as usize;
    let space =
        SpaceColonization::in_shape(&room, measure::size(markers, 20_000), measure::SEED).expect("a box");
    grown_in(space, Habit::default().with_optimal_weight(0.5), &MANY)
}

/// A hectare: 500 trees of metamers of 0.1 m until there are ten million.
fn hectare() -> Forest {
    let bounds = Bounds::new(Vec3::new(-50.0, 0.0, -50.0), Vec3::new(50.0, 16.0, 50.0));
    let light = ShadowPropagation::new(bounds).with_cell(0.1);
    let mut forest = Forest::new(light, Habit::default().with_length(0.1), 1).with_most_metamers(30_000_000);
    for i in 0..500u16 {
        let (row, column) = (i / 22, i % 22);
        let aside = f32::from(row % 2) * 1.5;
        let foot = Vec3::new(f32::from(column) * 4.4 - 46.0 + aside, 0.0, f32::from(row) * 4.2 - 46.0);
        forest.plant(foot).expect("there is room");
    }
    let most = measure::size(10_000_000, 100_000);
    while forest.metamers() < most {
        forest.step().expect("no limit is near");
    }
    forest
}

/// 576 trees on a landscape of 48 m by 48 m: tiles of so many cells, one after the other, with margins of two.
fn by_tiles(cells: u32) -> usize {
    let light = |bounds| ShadowPropagation::new(bounds).with_cell(0.1);
    let landscape =
        Landscape::new(light, Habit::default().with_length(0.1), 1).with_tile(cells).with_margin(2);
    let along = 24 / cells as i32;
    let tiles = (0..along * along).map(|tile| IVec2::new(tile % along, tile / along));
    let seasons = measure::size(16, 4) as u32;
    let grown = tiles.map(|tile| landscape.grow(tile, seasons).expect("no limit is near"));
    grown.map(|forest| landscape.own(&forest).map(Tree::metamers).sum::<usize>()).sum()
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
    let light = || ShadowPropagation::default().with_falloff(1.5f32.sqrt());
    let priority = VigorModel::Priority { first: 3.0, last: 1.0, part: 0.3 };
    let others: [(&str, &dyn Fn() -> usize); 4] = [
        ("the sun", &|| {
            plus(light().with_daylight(Daylight::at_latitude(50f32.to_radians())), Habit::default())
                .metamers()
        }),
        ("sag", &|| plus(light(), Habit::default().with_sag(Sag::default().with_modulus(7e8))).metamers()),
        ("priority", &|| plus(light(), Habit::default().with_vigor_model(priority)).metamers()),
        ("space", &|| colony().metamers()),
    ];
    for (name, grow) in &others {
        group.bench_function(*name, |bencher| samples.time(bencher, name, grow));
    }
    group.finish();
    criterion.final_summary();
    // The upper half of a stand of some 200,000 metamers is cut away.
    let stand = grown(&MANY, measure::SEED);
    let nodes = stand.trees().iter().flat_map(|tree| tree.positions().map(|node| node.y));
    let mut heights: Vec<f32> = nodes.collect();
    heights.sort_by(f32::total_cmp);
    let keep = Cuboid::new(Vec3::splat(-9.0), Vec3::new(9.0, heights[heights.len() / 2], 9.0));
    let mut stands = vec![stand.clone(); 5];
    samples.repeat(stands.len(), "prune", || {
        let mut stand = stands.pop()?;
        stand.prune(&keep).expect("a sound box");
        Some(stand)
    });
    samples.repeat(1, "landscape, one tile", || by_tiles(24));
    samples.repeat(1, "landscape, nine tiles", || by_tiles(8));
    #[cfg(feature = "parallel")]
    samples.repeat(1, "hectare", || pool.install(hectare));
    let base = samples.median(MANY.name);
    let beside = others.iter().filter_map(|(name, grow)| {
        let (time, metamers) = (samples.median(name)?, grow());
        let each = time * 1e6 / metamers as f64;
        let times = base.map_or_else(String::new, |base| number(time / base));
        Some(vec![(*name).to_owned(), count(metamers), number(time), number(each), times])
    });
    let more: [(&str, &dyn Fn() -> usize); 4] = [
        ("prune", &|| stand.metamers() / 2),
        ("landscape, one tile", &|| by_tiles(24)),
        ("landscape, nine tiles", &|| by_tiles(8)),
        ("hectare", &|| 10_000_000),
    ];
    let more = more.into_iter().filter_map(|(name, grow)| {
        let (time, metamers) = (samples.median(name)?, grow());
        let each = time * 1e6 / metamers as f64;
        Some(vec![name.to_owned(), count(metamers), number(time), number(each), String::new()])
    });
    print_table(
        "The 25 trees with something else; the upper half of theirs pruned; 576 trees on a landscape; 500 on a hectare, two threads.",
        &["case", "metamers", "ms", "ns per metamer", "times as long as the 25 trees"],
        &beside.chain(more).collect::<Vec<_>>(),
    );

    print_cases(&samples);
}

/// The cases of the original program, beside what it took.
fn print_cases(samples: &Samples) {
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
            "ns per metamer",
            "original's",
            "two threads faster by",
        ],
        &rows.collect::<Vec<_>>(),
    );
}
