//! Poisson-disc nodes (section 3.1.1): apart, but with no room left, the root among them, as many as asked for.

use crate::sample::{Near, built, cases, plot};
use proptest::prelude::*;
use treesynth::Shape;
use treesynth::glam::Vec3;
use treesynth::guided::{Graph, PoissonYao};
use treesynth::random::{Purpose, unit};
use treesynth::shape::{
    Cone, Cuboid, Cylinder, HalfEllipsoid, Intersection, ShapeRecipe, Shell, Sphere, Union,
};

/// A region, and the radius of a ball around a point that certainly lies in it.
pub(super) struct Region {
    pub(super) shape: Box<dyn Shape>,
    pub(super) room: fn(Vec3) -> f32,
}

fn room_in_box(p: Vec3, min: Vec3, max: Vec3) -> f32 {
    (p - min).min(max - p).min_element()
}

/// In coordinates scaled to the unit ball a ball of radius R reaches at most R over the least radius farther.
fn room_in_half_ellipsoid(p: Vec3, base: Vec3, radii: Vec3) -> f32 {
    let inside = (1.0 - ((p - base) / radii).length()) * radii.min_element();
    inside.min(p.y - base.y)
}

const WIDE: Vec3 = Vec3::new(5.0, 2.5, 4.0);

pub(super) fn regions() -> Vec<Region> {
    let region = |shape: Box<dyn Shape>, room| Region { shape, room };
    vec![
        region(Box::new(plot(6.0, 6.0)), |p| {
            room_in_box(p, Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 6.0, 3.0))
        }),
        region(Box::new(Sphere::new(Vec3::Y, 3.0)), |p| 3.0 - p.distance(Vec3::Y)),
        region(Box::new(Cylinder::new(Vec3::NEG_Y, 1.5, 7.0)), |p| {
            (1.5 - Vec3::new(p.x, 0.0, p.z).length()).min(p.y + 1.0).min(6.0 - p.y)
        }),
        region(Box::new(HalfEllipsoid::new(Vec3::ZERO, WIDE)), |p| {
            room_in_half_ellipsoid(p, Vec3::ZERO, WIDE)
        }),
        // A slab in which only balls about the middle have room.
        region(Box::new(Cuboid::new(Vec3::new(-8.0, -0.5, -8.0), Vec3::new(8.0, 0.5, 8.0))), |p| {
            room_in_box(p, Vec3::new(-8.0, -0.5, -8.0), Vec3::new(8.0, 0.5, 8.0))
        }),
        // A rod.
        region(Box::new(Cuboid::new(Vec3::new(-0.4, -0.4, -30.0), Vec3::new(0.4, 0.4, 30.0))), |p| {
            room_in_box(p, Vec3::new(-0.4, -0.4, -30.0), Vec3::new(0.4, 0.4, 30.0))
        }),
        // Two parts that no node of one is near to the other.
        region(
            Box::new(Union::new(Sphere::new(Vec3::ZERO, 1.5), Sphere::new(Vec3::new(7.0, 3.0, 0.0), 1.5))),
            |p| 1.5 - p.length().min(p.distance(Vec3::new(7.0, 3.0, 0.0))),
        ),
        // Two boxes that touch in a corner only, and not at the origin.
        region(
            Box::new(Union::new(
                Cuboid::new(Vec3::splat(-2.0), Vec3::splat(0.5)),
                Cuboid::new(Vec3::splat(0.5), Vec3::splat(2.5)),
            )),
            |p| {
                let one = room_in_box(p, Vec3::splat(-2.0), Vec3::splat(0.5));
                one.max(room_in_box(p, Vec3::splat(0.5), Vec3::splat(2.5)))
            },
        ),
        // A hollow ball, open nowhere.
        region(Box::new(Shell::new(Sphere::new(Vec3::X * 2.0, 3.0), 0.5)), |p| {
            let out = p.distance(Vec3::X * 2.0);
            (3.0 - out).min(out - 1.5)
        }),
        region(Box::new(Intersection::new(Sphere::new(Vec3::ZERO, 3.0), plot(20.0, 20.0))), |p| {
            (3.0 - p.length()).min(p.y)
        }),
    ]
}

/// A root in every region.
pub(super) fn root(region: &Region) -> Vec3 {
    [Vec3::ZERO, Vec3::X].into_iter().find(|&p| region.shape.contains(p)).unwrap_or(Vec3::NEG_X * 0.5)
}

fn assert_apart(graph: &Graph, r: f32) {
    let near = Near::new(graph.positions(), r);
    for (node, &position) in (0..).zip(graph.positions()) {
        let distance = near.distance(position, Some(node));
        let is_root = if node == graph.root() { ", the root" } else { "" };
        assert!(distance >= f64::from(r) * 0.99999, "node {node} at {position}{is_root}: {distance} < {r}");
    }
}

pub(super) fn assert_root(graph: &Graph, root: Vec3) {
    let at_root: Vec<_> = graph.positions().iter().filter(|&&p| p == root).collect();
    assert_eq!(at_root.len(), 1, "one node at the root");
    assert_eq!(graph.position(graph.root()), root);
}

/// Tries `count` random places in the bounds; returns how many had room for a ball.
fn assert_full(graph: &Graph, region: &Region, r: f32, planar: bool, seed: u64, count: u64) -> usize {
    let near = Near::new(graph.positions(), 2.0 * r);
    let bounds = region.shape.bounds();
    let mut tried = 0;
    for i in 0..count {
        let draw = |axis| unit(seed, axis, Purpose::CUSTOM, i);
        let place = bounds.at(Vec3::new(draw(0), draw(1), draw(2)));
        let place = if planar { place.with_z(0.0) } else { place };
        // A little smaller than 2r does not count as empty for rounding.
        if (region.room)(place) > 2.0 * r * 1.00001 {
            let distance = near.distance(place, None);
            assert!(distance <= f64::from(r) * 2.00002, "empty around {place}: {distance}, r is {r}");
            tried += 1;
        }
    }
    tried
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn discs_are_apart_and_leave_no_room(
        seed: u64, which in 0usize..10, nodes in 200usize..6000, planar: bool,
    ) {
        let region = &regions()[which];
        let root = root(region);
        let shape = regions().swap_remove(which).shape;
        let builder = PoissonYao::new(shape).with_nodes(nodes).with_root(root);
        let builder = if planar { builder.planar() } else { builder };
        let (graph, r) = (built(&builder, seed), builder.spacing().expect("a sound region"));
        prop_assert!(graph.positions().iter().all(|&p| region.shape.contains(p)));
        prop_assert!(!planar || graph.positions().iter().all(|p| p.z == 0.0));
        assert_root(&graph, root);
        assert_apart(&graph, r);
        assert_full(&graph, region, r, planar, seed, 4000);
    }

    /// Roots anywhere: next to a border of what is worked on at a time, on a face, in a corner.
    #[test]
    fn roots_keep_their_distance(
        seed: u64, at in prop::array::uniform3(0f32..=1.0), face in 0usize..4, planar: bool,
    ) {
        let region = plot(6.0, 6.0);
        let mut at = Vec3::from_array(at);
        if face < 3 {
            at[face] = at[face].round();
        }
        let root = region.bounds().at(at);
        let root = if planar { root.with_z(0.0) } else { root };
        let builder = PoissonYao::new(region).with_nodes(2000).with_root(root);
        let builder = if planar { builder.planar() } else { builder };
        let graph = built(&builder, seed);
        assert_root(&graph, root);
        assert_apart(&graph, builder.spacing().expect("a sound region"));
    }
}

/// Every region once with enough tries that places with room are found in all of them.
#[test]
fn no_ball_of_twice_the_spacing_is_empty() {
    for (which, region) in regions().into_iter().enumerate() {
        let root = root(&region);
        for (planar, spacing) in [(false, 0.18), (false, 0.12), (true, 0.06)] {
            let shape = regions().swap_remove(which).shape;
            let builder = PoissonYao::new(shape).with_spacing(spacing).with_root(root);
            let graph = built(&if planar { builder.planar() } else { builder }, 3);
            assert_apart(&graph, spacing);
            let tried = assert_full(&graph, &region, spacing, planar, 5, 60_000);
            assert!(tried > 200, "region {which}: only {tried} places have room");
        }
    }
}

/// Long and far: many cells along one axis, and coordinates with few bits left for what is small.
#[test]
fn discs_are_apart_where_coordinates_are_large() {
    let far = Vec3::new(1000.0, 0.0, -2000.0);
    for (min, max, r) in [
        (Vec3::ZERO, Vec3::new(20_000.0, 2.0, 2.0), 1.0),
        (Vec3::ZERO, Vec3::new(2.0, 2.0, 30_000.0), 1.0),
        (far, far + 2.0, 0.1),
        (Vec3::new(90_000.0, 0.0, 0.0), Vec3::new(90_010.0, 10.0, 10.0), 0.5),
    ] {
        let builder = PoissonYao::new(Cuboid::new(min, max)).with_spacing(r).with_root(min);
        let graph = built(&builder, 1);
        assert_root(&graph, min);
        assert_apart(&graph, r);
    }
}

/// "About so many nodes, within a few percent."
#[test]
fn as_many_nodes_as_asked_for() {
    for nodes in [5_000, 12_000, 40_000] {
        let tall = HalfEllipsoid::new(Vec3::ZERO, Vec3::new(2.0, 6.0, 2.0));
        let shapes: [(&str, ShapeRecipe); 6] = [
            ("box", plot(6.0, 6.0).into()),
            ("slender box", plot(3.0, 9.0).into()),
            ("sphere", Sphere::new(Vec3::Y, 2.0).into()),
            ("half-ellipsoid", HalfEllipsoid::new(Vec3::ZERO, Vec3::new(3.0, 4.0, 3.0)).into()),
            ("tall half-ellipsoid", tall.into()),
            ("cone", Cone::new(Vec3::ZERO, 2.0, 5.0).into()),
        ];
        for (name, shape) in shapes {
            let builder = PoissonYao::new(shape);
            for builder in [builder.clone(), builder.planar()] {
                let found = built(&builder.with_nodes(nodes), 2).nodes();
                let off = found as f64 / nodes as f64 - 1.0;
                assert!(off.abs() <= 0.05, "{name}: {found} nodes for {nodes}, {:.1}% off", off * 100.0);
            }
        }
    }
}
