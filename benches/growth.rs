//! Trees over the years: the structure once, then the skeleton at an age, beside a plain copy of its arrays.

mod measure;

use measure::{Samples, count, number, print_table};
use treesynth::Skeleton;
use treesynth::growth::{Architecture, Growth, Timeline};

/// The goal for the skeleton of the cottonwood at 27 years, milliseconds.
const GOAL: f64 = 150.0;
const AGES: [f32; 4] = [10.0, 20.0, 26.6, 27.0];

fn cottonwood() -> Growth {
    Growth::new(Architecture::cottonwood(), measure::SEED).expect("a species in range")
}

/// The work that every way to make a skeleton has in common: its arrays filled and checked once.
fn copy(skeleton: &Skeleton) -> Skeleton {
    let parents = (0..skeleton.len()).map(|node| skeleton.parent(node).map(|parent| parent as u32)).collect();
    let copy = Skeleton::new(skeleton.positions().to_vec(), parents).expect("a copy");
    let copy = copy.with_radii(skeleton.radii().to_vec()).expect("a copy");
    let copy = copy.with_stages(skeleton.stages().to_vec()).expect("a copy");
    copy.with_orders(skeleton.orders().to_vec())
        .expect("a copy")
        .with_hops(skeleton.hops().to_vec())
        .expect("a copy")
}

fn main() {
    measure::single_thread();
    let mut criterion = measure::criterion();
    let mut samples = Samples::default();
    let growth = cottonwood();
    let ages = if measure::is_test() { &AGES[..1] } else { &AGES[..] };
    let mut group = measure::group(&mut criterion, "growth");
    group.bench_function("structure", |bencher| samples.time(bencher, "structure", cottonwood));
    for age in ages {
        let name = format!("at {age}");
        group.bench_function(&name, |bencher| {
            samples.time(bencher, &name, || growth.at(*age).expect("an age in range"));
        });
        let stand = growth.at(*age).expect("an age in range");
        let name = format!("copy {age}");
        group.bench_function(&name, |bencher| samples.time(bencher, &name, || copy(&stand.skeleton)));
        let timeline = Timeline::new(stand.skeleton, *age).expect("an age in range");
        let name = format!("timeline {age}");
        group.bench_function(&name, |bencher| {
            samples.time(bencher, &name, || timeline.at(0.9 * age).expect("an age in range"));
        });
    }
    group.finish();
    criterion.final_summary();

    let rows = ages.iter().filter_map(|age| {
        let time = samples.median(&format!("at {age}"))?;
        let stand = growth.at(*age).expect("an age in range");
        let optional = |name: String| samples.median(&name).map_or_else(String::new, number);
        Some(vec![
            format!("{age}"),
            count(stand.skeleton.segments()),
            count(stand.leaves.len()),
            number(time),
            number(GOAL),
            number(time * 1e6 / stand.skeleton.segments() as f64),
            optional(format!("copy {age}")),
            optional(format!("timeline {age}")),
        ])
    });
    let title = format!(
        "Eastern cottonwood of 27 years, one thread. The structure, once for all ages: {} ms, {} branches, {} nodes.",
        samples.median("structure").map_or_else(String::new, number),
        count(growth.branches()),
        count(growth.nodes()),
    );
    print_table(
        &title,
        &[
            "age",
            "internodes",
            "leaves",
            "ms",
            "goal, ms",
            "ns per internode",
            "copy of the skeleton, ms",
            "timeline at nine tenths, ms",
        ],
        &rows.collect::<Vec<_>>(),
    );
}
