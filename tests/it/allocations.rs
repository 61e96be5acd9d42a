//! A tree that grows in the memory of the one before it asks for hardly any of its own.

use allocation_counter::measure;
use treesynth::guided::Search;
use treesynth::{Silent, presets};

/// Some forty a stage, most of them of lists that double as they grow, nearly whatever the number of nodes.
#[test]
fn a_second_tree_allocates_a_handful() {
    for nodes in [5_000, 20_000, 80_000] {
        let synth = presets::by_name("figure-18").expect("a preset").guided().unwrap().synth(nodes);
        let graph = synth.build_graph(1, &Silent).unwrap();
        let mut search = Search::new(&graph);
        let mut grow = |seed| measure(|| drop(synth.grow(&mut search, seed, &Silent).unwrap())).count_total;
        let (first, again, other) = (grow(1), grow(1), grow(2));
        println!("{nodes} nodes: {first} allocations, {again} for the same tree again, {other} for another");
        assert!(again < 400 && again < first, "{again} allocations for the same tree, {first} for the first");
        assert!(other < 400, "{other} allocations for another tree");
    }
}
