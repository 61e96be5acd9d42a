//! Nodes of varying spacing: each apart by the smaller of both spacings, no room left for twice its own.

use super::nodes::{Region, assert_root, regions, root};
use crate::sample::{built, cases, plot};
use proptest::prelude::*;
use treesynth::glam::{DVec3, Vec3};
use treesynth::guided::{GradedYao, Graph, NearSurface, PoissonYao, SizingField, SizingFn, Spacing};
use treesynth::random::{Purpose, unit};
use treesynth::shape::{Cuboid, HalfEllipsoid, ShapeRecipe, Sphere};
use treesynth::{GraphBuilder, Shape};

/// Sizing fields of every kind: even, with a jump, a ramp, a point, a surface from either side, a ripple.
fn sizing(which: usize, low: f32, high: f32) -> Box<dyn SizingField> {
    let ball = Sphere::new(Vec3::new(0.5, 1.0, -0.2), 0.8);
    match which {
        0 => Box::new(SizingFn::new(move |_| low)),
        1 => Box::new(SizingFn::new(move |p| if ball.contains(p) { low } else { high })),
        2 => Box::new(SizingFn::new(move |p| (low + 0.1 * p.y.abs()).min(high))),
        3 => Box::new(SizingFn::new(move |p| low + p.distance(Vec3::splat(0.3)) * 5.0)),
        4 => Box::new(NearSurface::new(ball, low, high, 0.7)),
        5 => Box::new(NearSurface::new(ball, high, low, 0.7)),
        _ => Box::new(SizingFn::new(move |p| {
            low + (high - low) * (0.5 + 0.5 * (p.x * 3.0).sin() * (p.z * 2.0).cos())
        })),
    }
}

/// Two nodes are apart by the smaller spacing: one hit a pair, found in the order along the longest axis.
fn assert_apart(graph: &Graph, spacing: &Spacing) {
    let mut nodes: Vec<Vec3> = graph.positions().to_vec();
    let (low, high) = nodes.iter().fold((Vec3::MAX, Vec3::MIN), |(low, high), &p| (low.min(p), high.max(p)));
    let axis = (high - low).max_position();
    nodes.sort_by(|p, q| p[axis].total_cmp(&q[axis]));
    for (i, &p) in nodes.iter().enumerate() {
        let r = spacing.at(p);
        for &q in nodes[i + 1..].iter().take_while(|q| q[axis] - p[axis] < r) {
            let (least, found) = (r.min(spacing.at(q)), p.as_dvec3().distance(q.as_dvec3()));
            assert!(found >= f64::from(least) * 0.99999, "{p} and {q} are {found} apart, not {least}");
        }
    }
}

/// Of random places with room for a ball of twice their spacing, half of them near a node; returns how many there were.
fn assert_full(graph: &Graph, region: &Region, spacing: &Spacing, seed: u64, count: u64) -> usize {
    let bounds = region.shape.bounds();
    let nodes: Vec<DVec3> = graph.positions().iter().map(|p| p.as_dvec3()).collect();
    let mut tried = 0;
    for i in 0..count {
        let draw = |axis| unit(seed, axis, Purpose::CUSTOM, i);
        let place = if i % 2 == 0 {
            bounds.at(Vec3::new(draw(0), draw(1), draw(2)))
        } else {
            // Places are dense where nodes are.
            let node = graph.positions()[(draw(3) * nodes.len() as f32) as usize];
            node + (Vec3::new(draw(0), draw(1), draw(2)) - 0.5) * 4.0 * spacing.at(node)
        };
        let r = spacing.at(place);
        if (region.room)(place) > 2.0 * r * 1.00001 {
            let reach = (f64::from(r) * 2.00002).powi(2);
            let found = nodes.iter().any(|node| node.distance_squared(place.as_dvec3()) <= reach);
            assert!(found, "empty around {place}, r is {r}");
            tried += 1;
        }
    }
    tried
}

/// The spacing changes by at most the grading along each axis.
fn assert_graded(spacing: &Spacing, bounds: treesynth::Bounds, grading: f32) {
    for i in 0..2000 {
        let draw = |axis| unit(4, axis, Purpose::CUSTOM, i);
        let place = bounds.at(Vec3::new(draw(0), draw(1), draw(2)));
        for axis in Vec3::AXES {
            let way = draw(3) * bounds.size().dot(axis) * 0.5;
            let change = (spacing.at(place + axis * way) - spacing.at(place)).abs();
            assert!(change <= grading * way + 1e-5 * spacing.at(place), "{change} along {way} at {place}");
        }
    }
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn discs_are_apart_and_leave_no_room(
        seed: u64, which in 0usize..10, field in 0usize..7, low in 0.15f32..0.4, ratio in 1f32..8.0,
        grading in 0.01f32..=0.14,
    ) {
        let region = &regions()[which];
        let shape = regions().swap_remove(which).shape;
        let builder = GradedYao::new(shape, sizing(field, low, low * ratio))
            .with_grading(grading)
            .with_root(root(region));
        let graph = built(&builder, seed);
        let spacing = builder.spacing().expect("a sound region");
        prop_assert!(graph.positions().iter().all(|&p| region.shape.contains(p)));
        assert_root(&graph, root(region));
        assert_graded(&spacing, region.shape.bounds(), grading);
        assert_apart(&graph, &spacing);
        assert_full(&graph, region, &spacing, seed, 1000);
    }
}

/// Every region and field once, fine enough that many places have room.
#[test]
fn no_ball_of_twice_its_spacing_is_empty() {
    for (which, region) in regions().into_iter().enumerate() {
        let mut tried = 0;
        for field in 0..7 {
            let shape = regions().swap_remove(which).shape;
            let builder = GradedYao::new(shape, sizing(field, 0.08, 0.4))
                .with_grading(0.14)
                .with_nodes(4000)
                .with_root(root(&region));
            let (graph, spacing) = (built(&builder, 3), builder.spacing().expect("a sound region"));
            assert_apart(&graph, &spacing);
            tried += assert_full(&graph, &region, &spacing, 5, 2000);
        }
        assert!(tried > 500, "region {which}: only {tried} places have room");
    }
}

#[test]
fn what_the_field_says_is_kept_where_it_is_gradual() {
    let (low, high) = (0.1, 0.3);
    for (field, exact) in [(0, true), (2, false)] {
        let builder = GradedYao::new(plot(6.0, 6.0), sizing(field, low, high)).with_grading(0.125);
        let spacing = builder.spacing().expect("a sound region");
        for i in 0..1000 {
            let draw = |axis| unit(1, axis, Purpose::CUSTOM, i);
            let place = plot(6.0, 6.0).bounds().at(Vec3::new(draw(0), draw(1), draw(2)));
            let off = (spacing.at(place) - sizing(field, low, high).at(place)).abs();
            // Linear between the lattice's points: only the ramp's end is rounded off.
            assert!(off <= if exact { 1e-6 } else { 0.01 }, "{off} at {place}");
        }
    }
    // A jump becomes a ramp from the last point of the lattice before it, and the smaller side stays as it is.
    let jump = SizingFn::new(|p: Vec3| if p.x < 0.0 { 0.1 } else { 1.0 });
    let spacing = GradedYao::new(plot(6.0, 6.0), jump).with_grading(0.1).spacing().expect("a sound region");
    let at = |x: f32| spacing.at(Vec3::new(x, 2.0, 1.0));
    assert_eq!(at(-1.0), 0.1);
    assert!((at(2.0) - at(1.0) - 0.1).abs() < 1e-4, "{} {}", at(1.0), at(2.0));
    assert!((at(1.0) - 0.2).abs() < 0.03, "{}", at(1.0));
}

/// As many nodes as of one spacing, and as many as asked for.
#[test]
fn as_many_nodes_as_asked_for() {
    let dome = HalfEllipsoid::new(Vec3::ZERO, Vec3::new(3.0, 4.0, 3.0));
    for nodes in [3000, 20_000] {
        for field in 0..7 {
            for builder in [
                GradedYao::new(ShapeRecipe::from(plot(6.0, 6.0)), sizing(field, 0.5, 2.0)),
                GradedYao::new(dome.into(), sizing(field, 0.5, 2.0)),
            ] {
                let found = built(&builder.with_nodes(nodes), 2).nodes();
                let off = found as f64 / nodes as f64 - 1.0;
                // Around the point r changes everywhere as fast as it may.
                let most = if field == 3 { 0.2 } else { 0.12 };
                assert!(
                    off.abs() <= most,
                    "field {field}: {found} nodes for {nodes}, {:.1}% off",
                    off * 100.0
                );
            }
        }
    }
    let even = GradedYao::new(plot(6.0, 6.0), sizing(0, 0.15, 1.0));
    let other = PoissonYao::new(plot(6.0, 6.0)).with_spacing(0.15);
    let ratio = built(&even, 1).nodes() as f64 / built(&other, 1).nodes() as f64;
    assert!((0.95..1.05).contains(&ratio), "{ratio}");
}

/// A single node, long and thin regions, and coordinates with few bits left.
#[test]
fn extremes() {
    let huge = GradedYao::new(plot(2.0, 2.0), SizingFn::new(|_| 1e30));
    assert_eq!(built(&huge, 1).nodes(), 1);
    let far = Vec3::new(1000.0, 0.0, -2000.0);
    for (min, max, r) in [
        (Vec3::ZERO, Vec3::new(20_000.0, 2.0, 2.0), 1.0),
        (Vec3::ZERO, Vec3::new(30.0, 0.3, 30.0), 0.5),
        (far, far + 2.0, 0.1),
    ] {
        let sizing = SizingFn::new(move |p: Vec3| r * (1.0 + (p.x - min.x).min(2.0)));
        let builder = GradedYao::new(Cuboid::new(min, max), sizing).with_root(min);
        builder.check().expect("sound options");
        let graph = built(&builder, 1);
        assert_root(&graph, min);
        assert_apart(&graph, &builder.spacing().expect("a sound region"));
        assert!(graph.nodes() > 200, "{}", graph.nodes());
    }
}
