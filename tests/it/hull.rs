//! Edges are local: hops from the root grow as distance does, and crowns are as round as their volumes.

use treesynth::glam::Vec3;
use treesynth::guided::{Edges, GradedYao, Graph, GraphBuilder, NearSurface, PointCloud, PoissonYao};
use treesynth::shape::{Cuboid, Sphere};
use treesynth::{Silent, Skeleton, presets};

/// (start, length) of every edge.
fn edges(graph: &Graph) -> impl Iterator<Item = (u32, f32)> {
    let from = |node: u32| graph.neighbours(node).iter().map(move |&to| (node, to));
    let length = |(a, b): (u32, u32)| (a, graph.position(a).distance(graph.position(b)));
    (0..graph.nodes() as u32).flat_map(from).map(length)
}

fn region() -> Cuboid {
    Cuboid::new(Vec3::new(-6.0, 0.0, -6.0), Vec3::new(6.0, 12.5, 6.0))
}

#[test]
fn no_edge_crosses_the_hull() {
    for (nodes, sectors, reach) in [(20_000, 8, 3.0), (5_000, 6, 3.0), (20_000, 27, 4.5), (150_000, 8, 3.0)] {
        let builder = PoissonYao::new(region()).with_nodes(nodes).with_sectors(sectors);
        let (graph, spacing) = (builder.build(1, &Silent).unwrap(), builder.spacing().unwrap());
        assert_eq!(graph.unreachable(), 0);
        let longest = edges(&graph).map(|(_, length)| length).fold(0.0, f32::max) / spacing;
        assert!((0.9 * reach..=reach * 1.0001).contains(&longest), "{nodes}, {sectors}: {longest}");
    }
    let plane = Cuboid::new(Vec3::new(-5.0, 0.0, -1.0), Vec3::new(5.0, 10.0, 1.0));
    let builder = PoissonYao::new(plane).with_nodes(3_000).planar();
    let (graph, spacing) = (builder.build(1, &Silent).unwrap(), builder.spacing().unwrap());
    assert!(edges(&graph).all(|(_, length)| length <= 3.0 * spacing * 1.0001));
    assert_eq!(graph.unreachable(), 0);
}

#[test]
fn graded_edges_keep_to_the_spacing_where_they_start() {
    for seed in 0..4 {
        let sizing = NearSurface::new(Sphere::new(Vec3::Y * 6.0, 3.0), 0.1, 0.6, 2.5);
        let builder = GradedYao::new(region(), sizing).with_nodes(30_000);
        let (graph, spacing) = (builder.build(seed, &Silent).unwrap(), builder.spacing().unwrap());
        for (node, length) in edges(&graph) {
            assert!(length <= 3.0 * spacing.at(graph.position(node)) * 1.0001, "{length}");
        }
        assert_eq!(graph.unreachable(), 0);
    }
}

#[test]
fn clouds_say_what_they_do_not_reach() {
    let two: Vec<Vec3> = (0..2_000)
        .map(|i| {
            let place = Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100 % 10) as f32);
            place + Vec3::X * if i < 1_000 { 0.0 } else { 100.0 }
        })
        .collect();
    let cloud = PointCloud::new(two.clone(), Edges::Yao(8));
    let graph = cloud.clone().build(0, &Silent).unwrap();
    assert!(edges(&graph).all(|(_, length)| length < 10.0));
    assert_eq!(graph.unreachable(), 1_000);
    let bridged = cloud.with_reach(f32::INFINITY).build(0, &Silent).unwrap();
    assert_eq!(bridged.unreachable(), 0);
    // Equal points are refused at once, however many there are.
    let start = std::time::Instant::now();
    for edges in [Edges::Yao(8), Edges::Nearest(16)] {
        let heap = PointCloud::new(vec![Vec3::ONE; 50_000], edges);
        assert!(heap.build(0, &Silent).unwrap_err().to_string().contains("no length"));
    }
    assert!(start.elapsed().as_secs() < 10);
}

/// The share of nodes that are among the outermost third both by hops and by distance.
fn agreement(graph: &Graph) -> f32 {
    let (root, hops) = (graph.position(graph.root()), graph.hops_from_root());
    let mut nodes: Vec<usize> = (0..graph.nodes()).collect();
    let third = nodes.len() / 3;
    let away = |node: usize| graph.positions()[node].distance(root);
    nodes.sort_unstable_by(|&a, &b| away(b).total_cmp(&away(a)));
    let mut outer = vec![false; nodes.len()];
    nodes[..third].iter().for_each(|&node| outer[node] = true);
    // As `HopSurface` orders them.
    nodes.sort_by(|&a, &b| hops[b].cmp(&hops[a]).then(away(b).total_cmp(&away(a))));
    nodes[..third].iter().filter(|&&node| outer[node]).count() as f32 / third as f32
}

#[test]
fn hops_are_in_the_order_of_distances() {
    for seed in 1..=3 {
        let graph = PoissonYao::new(region()).build(seed, &Silent).unwrap();
        let agreement = agreement(&graph);
        assert!(agreement >= 0.98, "seed {seed}: {agreement}");
        // "The path from top to bottom is barely 50 edges long."
        let top = graph.nearest(Vec3::Y * 12.5);
        assert!((45..=60).contains(&graph.hops_from_root()[top as usize]));
    }
}

fn width(tree: &Skeleton, direction: Vec3) -> f32 {
    let along = || tree.positions().iter().map(|position| position.dot(direction));
    along().fold(f32::MIN, f32::max) - along().fold(f32::MAX, f32::min)
}

/// Seen from above, the diagonal over the axes, on the mean of seeds.
#[test]
fn crowns_in_round_volumes_are_round() {
    let diagonals = [Vec3::new(1.0, 0.0, 1.0), Vec3::new(1.0, 0.0, -1.0)].map(Vec3::normalize);
    for name in ["figure-06a", "figure-06b", "figure-12-t03", "figure-12-t06"] {
        let synth = presets::by_name(name).unwrap().guided().unwrap().synth(60_000);
        let mean: f32 = (1..=20)
            .map(|seed| {
                let tree = synth.synthesize(seed).unwrap();
                let [a, b] = diagonals.map(|direction| width(&tree, direction));
                (a + b) / (width(&tree, Vec3::X) + width(&tree, Vec3::Z))
            })
            .sum::<f32>()
            / 20.0;
        assert!((0.97..=1.03).contains(&mean), "{name}: {mean}");
    }
}
