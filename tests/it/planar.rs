//! Graphs whose edges never cross, and the trees in them.

use proptest::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;
use treesynth::glam::{DVec2, Vec3};
use treesynth::guided::{Graph, PoissonDelaunay, PoissonYao};
use treesynth::presets::{self, TYPICAL_NODES};
use treesynth::shape::{Cuboid, Cylinder, Difference, Ellipsoid, Sphere};
use treesynth::{GraphBuilder, Shape, Silent, Skeleton, testing};

/// Twice the area of a triangle in the plane z = 0, positive if its corners turn left. Differences of 32-bit numbers are
/// exact in 64 bits, and so is all but the last bit of the products.
fn turn(a: Vec3, b: Vec3, c: Vec3) -> f64 {
    let at = |p: Vec3| DVec2::new(p.x.into(), p.y.into());
    (at(b) - at(a)).perp_dot(at(c) - at(a))
}

/// Pairs of segments that share no end and have a point in common.
fn crossings(positions: &[Vec3], segments: &[(usize, usize)]) -> usize {
    let longest = segments.iter().map(|&(a, b)| positions[a].distance(positions[b])).fold(1e-9, f32::max);
    let cell = |p: Vec3| ((p.x / longest).floor() as i32, (p.y / longest).floor() as i32);
    let mut cells: BTreeMap<(i32, i32), Vec<usize>> = BTreeMap::new();
    for (number, &(a, _)) in segments.iter().enumerate() {
        cells.entry(cell(positions[a])).or_default().push(number);
    }
    // Both segments begin within two longest ones of each other.
    let beside = |(x, y): (i32, i32)| (-2..=2).flat_map(move |dx| (-2..=2).map(move |dy| (x + dx, y + dy)));
    let mut count = 0;
    for (number, &(a, b)) in segments.iter().enumerate() {
        for other in beside(cell(positions[a])).filter_map(|cell| cells.get(&cell)).flatten() {
            let (c, d) = segments[*other];
            if *other >= number || [c, d].contains(&a) || [c, d].contains(&b) {
                continue;
            }
            let [a, b, c, d] = [a, b, c, d].map(|node| positions[node]);
            let apart = |p: f64, q: f64| (p > 0.0 && q > 0.0) || (p < 0.0 && q < 0.0);
            let misses = apart(turn(a, b, c), turn(a, b, d)) || apart(turn(c, d, a), turn(c, d, b));
            let beyond = a.min(b).cmpgt(c.max(d)).any() || c.min(d).cmpgt(a.max(b)).any();
            count += usize::from(!misses && !beyond);
        }
    }
    count
}

fn edges(graph: &Graph) -> Vec<(usize, usize)> {
    let from = |node: u32| {
        graph.neighbours(node).iter().map(move |&to| (node.min(to) as usize, node.max(to) as usize))
    };
    let mut edges: Vec<_> = (0..graph.nodes() as u32).flat_map(from).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

fn crossings_of(graph: &Graph) -> usize {
    crossings(graph.positions(), &edges(graph))
}

fn crossings_in(tree: &Skeleton) -> usize {
    crossings(tree.positions(), &tree.edges().collect::<Vec<_>>())
}

fn square() -> Cuboid {
    Cuboid::new(Vec3::new(-5.0, 0.0, -1.0), Vec3::new(5.0, 10.0, 1.0))
}

#[test]
fn crossings_are_found() {
    let cross =
        [Vec3::ZERO, Vec3::new(2.0, 2.0, 0.0), Vec3::Y * 2.0, Vec3::X * 2.0, Vec3::new(1.0, 1.0, 0.0)];
    assert_eq!(crossings(&cross, &[(0, 1), (2, 3)]), 1);
    assert_eq!(crossings(&cross, &[(0, 2), (1, 3)]), 0);
    assert_eq!(crossings(&cross, &[(0, 1), (1, 2)]), 0, "they share an end");
    assert_eq!(crossings(&cross, &[(0, 1), (2, 4)]), 1, "one ends on the other");
    assert_eq!(crossings(&cross, &[(0, 4), (1, 3)]), 0);
    // The Yao graph is not planar.
    let yao = PoissonYao::new(square()).with_nodes(1_000).planar().build(1, &Silent).expect("a graph");
    let count = crossings_of(&yao);
    println!("crossings of the Yao graph: {count} among {} edges", edges(&yao).len());
    assert!(count > 30, "{count}");
}

#[test]
fn no_edges_cross() {
    let round = Ellipsoid::new(Vec3::Y * 5.0, Vec3::new(5.0, 5.1, 1.0));
    let ring = Difference::new(Cylinder::new(Vec3::Y * -0.1, 4.0, 12.0), Sphere::new(Vec3::Y * 5.0, 2.0));
    let regions: [(&str, Arc<dyn Shape>); 3] =
        [("square", Arc::new(square())), ("round", Arc::new(round)), ("ring", Arc::new(ring))];
    let mut longest = Vec::new();
    for seed in 1..=20 {
        for (name, region) in &regions {
            let builder = PoissonDelaunay::new(region.clone()).with_nodes(1_500);
            let graph = builder.build(seed, &Silent).expect("a graph");
            let spacing = builder.spacing().expect("in range");
            assert_eq!(crossings_of(&graph), 0, "{name}, seed {seed}");
            let lengths =
                edges(&graph).into_iter().map(|(a, b)| graph.positions()[a].distance(graph.positions()[b]));
            let lengths: Vec<f32> = lengths.map(|length| length / spacing).collect();
            assert!(lengths.iter().all(|&length| length <= 4.0));
            if *name == "square" {
                longest.extend(lengths);
            }
            assert!(
                graph.hops_from_root().iter().all(|&hops| hops < u32::MAX),
                "{name}, seed {seed}: not connected"
            );
            assert!((1_350..1_650).contains(&graph.nodes()) || *name == "ring", "{name}: {}", graph.nodes());
        }
    }
    longest.sort_by(f32::total_cmp);
    let at = |share: f64| longest[(share * (longest.len() - 1) as f64) as usize];
    println!(
        "edges in spacings: median {}, 99% {}, 99.9% {}, longest {}",
        at(0.5),
        at(0.99),
        at(0.999),
        at(1.0)
    );
}

/// Delaunay's definition: two nodes are linked if some circle through both and a third holds no
/// other.
#[test]
fn the_triangulation_is_delaunays() {
    for seed in 1..=10 {
        let builder = PoissonDelaunay::new(square()).with_nodes(60);
        let graph = builder.build(seed, &Silent).expect("a graph");
        let spacing = builder.spacing().expect("in range");
        let at = |node: usize| DVec2::new(graph.positions()[node].x.into(), graph.positions()[node].y.into());
        let nodes = graph.nodes();
        let mut linked = Vec::new();
        for a in 0..nodes {
            for b in a + 1..nodes {
                for c in b + 1..nodes {
                    let (u, v) = (at(b) - at(a), at(c) - at(a));
                    let center = DVec2::new(
                        v.y * u.length_squared() - u.y * v.length_squared(),
                        u.x * v.length_squared() - v.x * u.length_squared(),
                    ) / (2.0 * u.perp_dot(v));
                    let radius = center.length();
                    if (0..nodes).all(|d| [a, b, c].contains(&d) || at(d).distance(at(a) + center) > radius) {
                        linked.extend([(a, b), (a, c), (b, c)]);
                    }
                }
            }
        }
        linked.sort_unstable();
        linked.dedup();
        linked.retain(|&(a, b)| graph.positions()[a].distance(graph.positions()[b]) <= 4.0 * spacing);
        assert_eq!(edges(&graph), linked, "seed {seed}");
    }
}

/// "Guarantees of no loops or self-intersections" (section 1).
#[test]
fn planar_trees_do_not_cross_themselves() {
    for preset in presets::guided().filter(|preset| preset.planar) {
        for seed in 1..=20 {
            let tree = preset.synth(TYPICAL_NODES).synthesize(seed).expect("a tree");
            assert_eq!(crossings_in(&tree), 0, "{}, seed {seed}", preset.name);
        }
    }
}

#[test]
fn few_nodes() {
    for nodes in 2..30 {
        let graph = PoissonDelaunay::new(square()).with_nodes(nodes).build(3, &Silent).expect("a graph");
        assert!(graph.hops_from_root().iter().all(|&hops| hops < u32::MAX), "{nodes} nodes");
    }
}

#[test]
fn wrong_options_are_named() {
    let error =
        |builder: PoissonDelaunay<Cuboid>| builder.build(1, &Silent).expect_err("out of range").to_string();
    let builder = || PoissonDelaunay::new(square());
    assert!(error(builder().with_nodes(1)).starts_with("PoissonDelaunay.nodes is 1"));
    assert!(error(builder().with_spacing(f32::NAN)).starts_with("PoissonDelaunay.spacing is NaN"));
    for root in [Vec3::Z * 0.5, Vec3::NAN, Vec3::X * 6.0] {
        assert!(error(builder().with_root(root)).starts_with("PoissonDelaunay.root is"));
    }
}

proptest! {
    #![proptest_config(crate::sample::cases(48))]

    #[test]
    fn any_region_has_a_sound_planar_graph(region in testing::regions(), seed: u64, nodes in 2usize..600) {
        let builder = PoissonDelaunay::new(region).with_nodes(nodes);
        testing::check_builder(&builder, seed)?;
        prop_assert_eq!(crossings_of(&builder.build(seed, &Silent).expect("held")), 0);
    }
}
