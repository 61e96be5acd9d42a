//! Edges are local: hops from the root grow as distance does, and crowns are as round as their volumes.

use treesynth::glam::Vec3;
use treesynth::guided::{Graph, GraphBuilder, PoissonYao};
use treesynth::shape::Cuboid;
use treesynth::{Silent, presets};

fn longest_edge(graph: &Graph) -> f32 {
    let from = |node: u32| graph.neighbours(node).iter().map(move |&to| (node, to));
    let length = |(a, b): (u32, u32)| graph.position(a).distance(graph.position(b));
    (0..graph.nodes() as u32).flat_map(from).map(length).fold(0.0, f32::max)
}

/// The share of nodes that are among the outermost third both by hops and by distance.
fn agreement(graph: &Graph) -> f32 {
    let root = graph.position(graph.root());
    let hops = graph.hops_from_root();
    let mut nodes: Vec<usize> = (0..graph.nodes()).collect();
    let third = nodes.len() / 3;
    let away = |node: usize| graph.positions()[node].distance(root);
    nodes.sort_unstable_by(|&a, &b| away(b).total_cmp(&away(a)));
    let mut outer = vec![false; nodes.len()];
    nodes[..third].iter().for_each(|&node| outer[node] = true);
    nodes.sort_by_key(|&node| std::cmp::Reverse(hops[node]));
    let both = nodes[..third].iter().filter(|&&node| outer[node]).count();
    both as f32 / third as f32
}

#[test]
fn probe() {
    let region = Cuboid::new(Vec3::new(-6.0, 0.0, -6.0), Vec3::new(6.0, 12.5, 6.0));
    for nodes in [20_000, 150_000] {
        let builder = PoissonYao::new(region).with_nodes(nodes);
        let start = std::time::Instant::now();
        let graph = builder.build(1, &Silent).unwrap();
        let spacing = builder.spacing().unwrap();
        println!(
            "{nodes}: {:?} longest {} agree {} unreach {} maxhops {}",
            start.elapsed(),
            longest_edge(&graph) / spacing,
            agreement(&graph),
            graph.unreachable(),
            graph.hops_from_root().iter().max().unwrap()
        );
    }
    for name in ["figure-06a", "figure-06b", "figure-06c", "figure-12-t03", "figure-12-t06"] {
        let tree = presets::by_name(name).unwrap().synth(150_000).synthesize(1).unwrap();
        let p = tree.positions();
        let width = |d: Vec3| {
            p.iter().map(|p| p.dot(d)).fold(f32::MIN, f32::max)
                - p.iter().map(|p| p.dot(d)).fold(f32::MAX, f32::min)
        };
        let axis = (width(Vec3::X) + width(Vec3::Z)) * 0.5;
        let d = Vec3::new(1.0, 0.0, 1.0).normalize();
        let e = Vec3::new(1.0, 0.0, -1.0).normalize();
        println!("{name} {}", (width(d) + width(e)) * 0.5 / axis);
    }
}
