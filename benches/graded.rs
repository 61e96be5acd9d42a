//! Graphs of varying spacing beside one of a single spacing and as many nodes, one thread, in time per node.

mod measure;

use measure::{SEED, Samples, count, number, print_table};
use treesynth::Shape;
use treesynth::glam::Vec3;
use treesynth::guided::{GradedYao, GraphBuilder, NearSurface, PoissonYao, SizingFn};
use treesynth::presets::TYPICAL_NODES;
use treesynth::shape::{Cuboid, Ellipsoid};

fn main() {
    measure::single_thread();
    let mut criterion = measure::criterion();
    let nodes = measure::size(TYPICAL_NODES, 10_000);
    let region = Cuboid::new(Vec3::new(-6.0, 0.0, -6.0), Vec3::new(6.0, 11.5, 6.0));
    let crown = Ellipsoid::new(Vec3::Y * 6.0, Vec3::splat(3.5));
    let near = |ratio, distance| {
        GradedYao::new(region, NearSurface::new(crown, 1.0, ratio, distance)).with_nodes(nodes)
    };
    let jump = SizingFn::new(move |p| if crown.contains(p) { 1.0 } else { 8.0 });
    let builders: [(&str, Box<dyn GraphBuilder>); 5] = [
        ("one spacing, PoissonYao", Box::new(PoissonYao::new(region).with_nodes(nodes))),
        (
            "one spacing, GradedYao",
            Box::new(GradedYao::new(region, SizingFn::new(|_| 1.0)).with_nodes(nodes)),
        ),
        ("twice as fine at a surface", Box::new(near(2.0, 1.0))),
        ("five times as fine at a surface", Box::new(near(5.0, 3.0))),
        ("eight times as fine inside a crown", Box::new(GradedYao::new(region, jump).with_nodes(nodes))),
    ];
    let mut samples = Samples::default();
    let mut found = [0; 5];
    let mut group = measure::group(&mut criterion, "graded");
    for ((name, builder), found) in builders.iter().zip(&mut found) {
        group.bench_function(*name, |bencher| {
            samples.steps(bencher, name, |clock| {
                *found = builder.build(SEED, clock).expect("a graph in a box").nodes();
            });
        });
    }
    group.finish();
    criterion.final_summary();

    let per_node = |name: &str, step: &str, nodes: usize| {
        Some(samples.median(&format!("{name}{step}"))? * 1e6 / nodes as f64)
    };
    let uniform = per_node(builders[0].0, "", found[0]);
    let rows: Vec<Vec<String>> = builders
        .iter()
        .zip(found)
        .filter_map(|((name, _), nodes)| {
            let whole = per_node(name, "", nodes)?;
            let steps = [per_node(name, "/nodes", nodes)?, per_node(name, "/edges", nodes)?, whole];
            let mut row = vec![(*name).to_owned(), count(nodes)];
            row.extend(steps.map(number));
            row.push(number(whole / uniform?));
            Some(row)
        })
        .collect();
    let head = ["spacing", "nodes", "nodes, ns", "edges, ns", "whole, ns", "/ PoissonYao"];
    print_table("Graphs, one thread, medians; ns per node, without working out the spacing:", &head, &rows);
}
