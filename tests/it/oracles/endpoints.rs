//! Ends of branches (sections 3.2.2 and 3.2.3), against plain breadth-first searches.

use crate::sample::{cases, cube_graph, degrees, hops, plot};
use proptest::prelude::*;
use std::collections::BTreeSet;
use treesynth::glam::Vec3;
use treesynth::guided::{
    Bend, Count, Graph, HopSurface, InShape, NearestTo, PoissonYao, Search, Side, Stage, TreeSynth,
};
use treesynth::shape::Ellipsoid;
use treesynth::{EndpointPolicy, Shape, Silent};

const CROWN: Ellipsoid = Ellipsoid::new(Vec3::new(0.0, 3.6, 0.0), Vec3::new(2.0, 1.6, 2.0));

/// Choice of a policy as third stage of a tree.
struct Choice {
    /// The tree it saw.
    tree: Vec<u32>,
    chosen: Vec<u32>,
    /// The node of that tree each path starts from.
    sources: Vec<u32>,
}

fn choose(graph: &Graph, seed: u64, policy: impl EndpointPolicy + 'static) -> Choice {
    let fork = || Bend::piecewise(degrees(50.0), 0.0, 1);
    let synth = TreeSynth::new(PoissonYao::new(plot(6.0, 6.0)))
        .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 4.0)))
        .stage(Stage::new(fork(), InShape::uniform(CROWN, 6)))
        .stage(Stage::new(fork(), policy));
    let mut search = Search::new(graph);
    for stage in 0..2 {
        synth.grow_stage(&mut search, stage, seed, &Silent).expect("endpoints enough");
    }
    let tree = search.tree().to_vec();
    let was_on_tree: BTreeSet<u32> = tree.iter().copied().collect();
    let chosen = synth.grow_stage(&mut search, 2, seed, &Silent).expect("endpoints enough");
    let source = |&node: &u32| {
        let mut node = node;
        while !was_on_tree.contains(&node) {
            node = search.parent(node).expect("a path to the tree");
        }
        node
    };
    let sources = chosen.iter().map(source).collect();
    let distinct: BTreeSet<u32> = chosen.iter().copied().collect();
    assert_eq!(distinct.len(), chosen.len(), "an endpoint twice");
    assert!(chosen.iter().all(|node| !was_on_tree.contains(node)), "an endpoint on the tree");
    assert!(chosen.iter().all(|&node| search.is_on_tree(node)), "an endpoint did not join");
    Choice { tree, chosen, sources }
}

/// Nodes exactly k hops from the tree.
fn surface(graph: &Graph, tree: &[u32], k: u32) -> BTreeSet<u32> {
    (0..).zip(hops(graph, tree)).filter(|&(_, hops)| hops == Some(k)).map(|(node, _)| node).collect()
}

fn heights(graph: &Graph, choice: &Choice) -> Vec<(f32, f32)> {
    let y = |&node: &u32| graph.position(node).y;
    choice.chosen.iter().map(y).zip(choice.sources.iter().map(y)).collect()
}

/// The least distance between two of the nodes.
fn gap(graph: &Graph, nodes: &[u32]) -> f32 {
    let at = |i: usize| graph.position(nodes[i]);
    let pairs = (0..nodes.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    pairs.map(|(i, j)| at(i).distance(at(j))).fold(f32::INFINITY, f32::min)
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn the_surface_is_k_hops_off(seed: u64, k in 1u32..5, nodes in 800usize..3000) {
        let graph = cube_graph(nodes, seed);
        let all = choose(&graph, seed, HopSurface::new(k, Count::UpTo(usize::MAX)).with_outermost(1.0));
        let expected = surface(&graph, &all.tree, k);
        prop_assert_eq!(&all.chosen.iter().copied().collect::<BTreeSet<_>>(), &expected);
        // This number of them, or a share, rounded up.
        let ten = choose(&graph, seed, HopSurface::new(k, 10).with_outermost(1.0));
        prop_assert!(ten.chosen.len() == 10 && ten.chosen.iter().all(|node| expected.contains(node)));
        let fifth = choose(&graph, seed, HopSurface::new(k, Count::Share(0.2)).with_outermost(1.0));
        prop_assert_eq!(fifth.chosen.len(), expected.len().div_ceil(5));
    }

    /// Each candidate by a draw of its own: what is chosen of a part of the surface is chosen of all of it.
    #[test]
    fn each_candidate_is_drawn_alone(seed: u64, share in 0.05f32..0.95) {
        let graph = cube_graph(2000, seed);
        let each = |outermost| {
            let choice = choose(&graph, seed, HopSurface::new(2, Count::Each(share)).with_outermost(outermost));
            choice.chosen.into_iter().collect::<BTreeSet<u32>>()
        };
        let all = choose(&graph, seed, HopSurface::new(2, Count::UpTo(usize::MAX)).with_outermost(1.0));
        let outer = choose(&graph, seed, HopSurface::new(2, Count::UpTo(usize::MAX)).with_outermost(0.5));
        let (of_all, of_outer) = (each(1.0), each(0.5));
        let outer: BTreeSet<u32> = outer.chosen.into_iter().collect();
        prop_assert!(!of_outer.is_empty());
        prop_assert!(of_all.intersection(&outer).all(|node| of_outer.contains(node)));
        prop_assert!(of_outer.len() == 1 || of_outer.is_subset(&of_all));
        let wanted = all.chosen.len() as f32 * share;
        let spread = (wanted * (1.0 - share)).sqrt();
        prop_assert!((of_all.len() as f32 - wanted).abs() <= 5.0 * spread + 1.0, "{} of {wanted}", of_all.len());
    }

    /// The surface by metres of path: distances by relaxing every edge until nothing changes.
    #[test]
    fn the_surface_is_metres_off(seed: u64, k in 1u32..4, hop in 0.05f32..0.4, nodes in 300usize..900) {
        let graph = cube_graph(nodes, seed);
        let policy = HopSurface::new(k, Count::UpTo(usize::MAX)).with_outermost(1.0).with_hop_length(hop);
        let choice = choose(&graph, seed, policy);
        let mut known = vec![(f32::INFINITY, 0.0f32); graph.nodes()];
        choice.tree.iter().for_each(|&node| known[node as usize].0 = 0.0);
        let mut has_changed = true;
        while std::mem::take(&mut has_changed) {
            for from in 0..graph.nodes() as u32 {
                for &to in graph.neighbours(from) {
                    let last = graph.position(from).distance(graph.position(to)) / hop;
                    let way = (known[from as usize].0 + last, last);
                    let best = &mut known[to as usize];
                    if way.0 < best.0 || way.0 == best.0 && way.1 > best.1 {
                        (*best, has_changed) = (way, true);
                    }
                }
            }
        }
        let k = k as f32;
        let is_on = |&(whole, last): &(f32, f32)| {
            let half = last.min(1.0) * 0.5;
            whole - half <= k && whole + half > k
        };
        let surface: BTreeSet<u32> = (0..).zip(&known).filter(|(_, way)| is_on(way)).map(|(node, _)| node).collect();
        if !surface.is_empty() {
            prop_assert_eq!(choice.chosen.into_iter().collect::<BTreeSet<u32>>(), surface);
        }
    }

    /// "We order the surface nodes by the number of edges from the root; we then take [...] its outermost fraction."
    #[test]
    fn the_outermost_fraction_is_kept(seed: u64, k in 1u32..4, t in 0.05f32..1.0) {
        let graph = cube_graph(1500, seed);
        let choice = choose(&graph, seed, HopSurface::new(k, Count::UpTo(usize::MAX)).with_outermost(t));
        let surface = surface(&graph, &choice.tree, k);
        let kept: BTreeSet<u32> = choice.chosen.iter().copied().collect();
        prop_assert!(kept.is_subset(&surface));
        prop_assert!((kept.len() as f32 - surface.len() as f32 * t).abs() <= 1.0);
        let from_root = hops(&graph, &[graph.root()]);
        let outer = kept.iter().map(|&node| from_root[node as usize]).min();
        let inner = surface.difference(&kept).map(|&node| from_root[node as usize]).max();
        prop_assert!(inner.is_none_or(|inner| Some(inner) <= outer), "{inner:?} left out, {outer:?} kept");
    }

    #[test]
    fn one_side_only(seed: u64, k in 1u32..4) {
        let graph = cube_graph(1500, seed);
        let surface_of = |choice: &Choice| surface(&graph, &choice.tree, k);
        let policy = || HopSurface::new(k, Count::UpTo(usize::MAX)).with_outermost(1.0);
        let lower = choose(&graph, seed, policy().only(Side::Lower));
        let higher = choose(&graph, seed, policy().only(Side::Higher));
        prop_assert!(heights(&graph, &lower).iter().all(|(end, source)| end < source));
        prop_assert!(heights(&graph, &higher).iter().all(|(end, source)| end > source));
        // Both sides together are the surface, but for nodes that are exactly as high as a node of the tree.
        let both: BTreeSet<u32> = lower.chosen.iter().chain(&higher.chosen).copied().collect();
        prop_assert_eq!(lower.chosen.len() + higher.chosen.len(), both.len());
        let surface = surface_of(&lower);
        prop_assert!(both.is_subset(&surface));
        let height = |node: u32| graph.position(node).y.to_bits();
        let level = |node: &u32| lower.tree.iter().any(|&other| height(other) == height(*node));
        prop_assert!(surface.difference(&both).all(level));
    }

    /// "Graph distance with random weights rather than strictly counting edges": edges count 1 ± ρ.
    #[test]
    fn random_weights_blur_the_surface(seed: u64, k in 2u32..5, rho in 0.05f32..0.6) {
        let graph = cube_graph(2500, seed);
        let policy = HopSurface::new(k, Count::UpTo(usize::MAX)).with_outermost(1.0).with_random_weights(rho);
        let choice = choose(&graph, seed, policy);
        let off_tree = hops(&graph, &choice.tree);
        let (least, most) = ((k as f32 - 0.5) / (1.0 + rho), (k as f32 + 0.5) / (1.0 - rho));
        for &node in &choice.chosen {
            let hops = off_tree[node as usize].expect("reachable") as f32;
            prop_assert!(hops > least - 1e-3 && hops < most + 1e-3, "{hops} hops for {k} ± {rho}");
        }
        let strict = surface(&graph, &choice.tree, k);
        let blurred = choice.chosen.iter().filter(|node| !strict.contains(node)).count();
        prop_assert!(rho < 0.3 || blurred > 0, "nothing but the plain surface");
    }

    #[test]
    fn endpoints_lie_in_their_shape(seed: u64, count in 1usize..60, spread: bool) {
        let graph = cube_graph(2500, seed);
        let shape = Ellipsoid::new(Vec3::new(0.5, 3.0, 0.0), Vec3::new(1.8, 1.2, 1.4));
        let policy = |count: Count| {
            if spread { InShape::poisson_disc(shape, count) } else { InShape::uniform(shape, count) }
        };
        let choice = choose(&graph, seed, policy(Count::Exactly(count)));
        prop_assert_eq!(choice.chosen.len(), count);
        prop_assert!(choice.chosen.iter().all(|&node| shape.contains(graph.position(node))));
        // All there are, when that many are asked for.
        let all = choose(&graph, seed, policy(Count::UpTo(usize::MAX)));
        let free = |&node: &u32| shape.contains(graph.position(node)) && !all.tree.contains(&node);
        prop_assert_eq!(all.chosen.len(), (0..graph.nodes() as u32).filter(free).count());
    }

    #[test]
    fn the_nearest_node_off_the_tree(seed: u64, at in prop::array::uniform3(-4f32..4.0)) {
        let graph = cube_graph(700, seed);
        let point = Vec3::from_array(at) + Vec3::Y * 3.0;
        let choice = choose(&graph, seed, NearestTo::new(point));
        prop_assert_eq!(choice.chosen.len(), 1);
        let on_tree: BTreeSet<u32> = choice.tree.iter().copied().collect();
        let distance = graph.position(choice.chosen[0]).distance(point);
        for node in (0..graph.nodes() as u32).filter(|node| !on_tree.contains(node)) {
            prop_assert!(graph.position(node).distance(point) >= distance);
        }
    }
}

#[test]
fn poisson_disc_endpoints_are_farther_apart_than_uniform_ones() {
    for count in [5, 20, 80] {
        let (mut spread, mut uniform) = (0.0, 0.0);
        for seed in 0..6 {
            let graph = cube_graph(4000, seed);
            let gap = |policy: InShape<Ellipsoid>| gap(&graph, &choose(&graph, seed, policy).chosen);
            let discs = gap(InShape::poisson_disc(CROWN, count));
            // Random sequential packing of so many balls in the crown, on the safe side.
            let packed = (CROWN.volume() / count as f32).cbrt();
            assert!(discs > 0.6 * packed, "{discs} for {count} in {} m³", CROWN.volume());
            spread += discs;
            uniform += gap(InShape::uniform(CROWN, count));
        }
        assert!(spread > 1.5 * uniform, "{count}: {spread} and {uniform}");
    }
}

/// No seed, stage or policy chooses the same nodes as another.
#[test]
fn choices_depend_on_the_seed() {
    let graph = cube_graph(2500, 1);
    let pick =
        |seed| choose(&graph, seed, HopSurface::new(2, 12)).chosen.into_iter().collect::<BTreeSet<u32>>();
    assert_eq!(pick(1), pick(1));
    assert_ne!(pick(1), pick(2));
}
