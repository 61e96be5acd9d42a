//! Graphs on surfaces of triangles.

use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use treesynth::field::Uniform;
use treesynth::glam::Vec3;
use treesynth::guided::{FollowField, Graph, InShape, PoissonSurface, Stage, SurfaceNodes, TreeSynth};
use treesynth::shape::{Cuboid, TriangleMesh};
use treesynth::{GraphBuilder, Silent, testing};

type Mesh = (Vec<Vec3>, Vec<[u32; 3]>);

/// A grid of squares on the unit square, put in space.
fn sheet(n: u32, put: impl Fn(f32, f32) -> Vec3) -> Mesh {
    let at = |i: u32, j: u32| put(i as f32 / n as f32, j as f32 / n as f32);
    let positions = (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j))).map(|(i, j)| at(i, j)).collect();
    let corner = |i, j| j * (n + 1) + i;
    let squares = (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
    let triangles = squares.flat_map(|(i, j)| {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    (positions, triangles.collect())
}

fn joined(meshes: impl IntoIterator<Item = Mesh>) -> Mesh {
    let mut all: Mesh = (Vec::new(), Vec::new());
    for (positions, triangles) in meshes {
        let first = all.0.len() as u32;
        all.0.extend(positions);
        all.1.extend(triangles.into_iter().map(|corners| corners.map(|corner| corner + first)));
    }
    all
}

/// A box without its bottom, its corner at the origin; faces look outward.
fn wall(size: Vec3, n: u32) -> Mesh {
    let Vec3 { x, y, z } = size;
    joined([
        sheet(n, |u, v| Vec3::new(u * x, v * y, z)),
        sheet(n, |u, v| Vec3::new((1.0 - u) * x, v * y, 0.0)),
        sheet(n, |u, v| Vec3::new(x, v * y, (1.0 - u) * z)),
        sheet(n, |u, v| Vec3::new(0.0, v * y, u * z)),
        sheet(n, |u, v| Vec3::new(u * x, y, (1.0 - v) * z)),
    ])
}

/// Hills; and a sphere.
fn hills() -> Mesh {
    sheet(20, |u, v| Vec3::new(4.0 * u, (7.0 * u).sin() * (5.0 * v).cos() * 0.4, 4.0 * (1.0 - v)))
}

fn sphere() -> Mesh {
    let (long, lat) = (std::f32::consts::TAU, std::f32::consts::PI);
    sheet(24, |u, v| {
        let ring = (lat * v).sin();
        // The seam's vertices in one place each, and the poles' too.
        let turn = if u == 1.0 { 0.0 } else { long * u };
        let ring = if v == 0.0 || v == 1.0 { 0.0 } else { ring };
        Vec3::new(ring * turn.sin(), -(lat * v).cos(), ring * turn.cos())
    })
}

fn builder(mesh: &Mesh) -> PoissonSurface {
    PoissonSurface::new(mesh.0.clone(), mesh.1.clone())
}

/// Distance from a point to the whole mesh, triangle by triangle, by another way than the builder's: the nearest point of
/// a plane if it is inside, or of a side.
fn distance(mesh: &Mesh, point: Vec3) -> f32 {
    let on = |[a, b, c]: [Vec3; 3]| {
        let normal = (b - a).cross(c - a);
        let foot = point - normal * (point - a).dot(normal) / normal.length_squared();
        let inside = |p: Vec3, q: Vec3| (q - p).cross(foot - p).dot(normal) >= 0.0;
        let side = |p: Vec3, q: Vec3| {
            let share = ((point - p).dot(q - p) / (q - p).length_squared()).clamp(0.0, 1.0);
            point.distance(p + (q - p) * share)
        };
        if inside(a, b) && inside(b, c) && inside(c, a) {
            point.distance(foot)
        } else {
            side(a, b).min(side(b, c)).min(side(c, a))
        }
    };
    let corners = mesh.1.iter().map(|triangle| triangle.map(|corner| mesh.0[corner as usize]));
    corners.filter(|&[a, b, c]| (b - a).cross(c - a) != Vec3::ZERO).map(on).fold(f32::INFINITY, f32::min)
}

fn edges(graph: &Graph) -> impl Iterator<Item = (usize, usize)> {
    (0..graph.nodes() as u32)
        .flat_map(move |from| graph.neighbours(from).iter().map(move |&to| (from as usize, to as usize)))
}

/// Checks the guarantees of the builder; gives the nodes.
fn held(mesh: &Mesh, spacing: f32, seed: u64) -> (Graph, SurfaceNodes) {
    let builder = builder(mesh).with_spacing(spacing);
    let graph = builder.build(seed, &Silent).expect("a graph");
    let nodes = builder.nodes(seed, &Silent).expect("nodes");
    assert_eq!(graph.positions(), nodes.positions);
    for (node, &position) in nodes.positions.iter().enumerate() {
        let triangle = mesh.1[nodes.triangles[node] as usize].map(|corner| mesh.0[corner as usize]);
        let off = distance(&(triangle.to_vec(), vec![[0, 1, 2]]), position);
        assert!(off < 1e-5, "node {node} is {off} m off its triangle");
        let [a, b, c] = triangle;
        assert!((b - a).cross(c - a).normalize().dot(nodes.normals[node]) > 0.9999);
        for other in 0..node {
            let near = nodes.positions[other].distance(position) < spacing * 0.9999;
            assert!(!near || nodes.normals[other].dot(nodes.normals[node]) <= -0.5, "{other} and {node}");
        }
    }
    for (from, to) in edges(&graph) {
        let (a, b) = (nodes.positions[from], nodes.positions[to]);
        assert!(a.distance(b) <= 3.0 * spacing);
        for step in 1..8 {
            let off = distance(mesh, a.lerp(b, step as f32 / 8.0));
            assert!(off <= 0.501 * spacing, "edge {a} - {b} is {off} m off the surface");
        }
        assert!(graph.neighbours(to as u32).contains(&(from as u32)), "both ways");
    }
    (graph, nodes)
}

#[test]
fn nodes_and_edges_lie_on_the_surface() {
    for seed in 1..=3 {
        for (name, mesh) in
            [("hills", hills()), ("sphere", sphere()), ("wall", wall(Vec3::new(3.0, 2.0, 0.3), 6))]
        {
            let (graph, _) = held(&mesh, 0.15, seed);
            let reached = graph.hops_from_root().iter().filter(|&&hops| hops < u32::MAX).count();
            assert_eq!(reached, graph.nodes(), "{name}, seed {seed}: not connected");
        }
    }
}

/// No point of the surface is farther than 1.5 spacings from a node: what room darts have missed.
#[test]
fn nodes_leave_no_gaps() {
    let mesh = hills();
    let mut worst = 0.0f32;
    for seed in 1..=10 {
        let nodes = builder(&mesh).with_spacing(0.1).nodes(seed, &Silent).expect("nodes");
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        for _ in 0..2_000 {
            let [a, b, c] =
                mesh.1[random.random_range(0..mesh.1.len())].map(|corner| mesh.0[corner as usize]);
            let (u, v) = (random.random::<f32>(), random.random::<f32>());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let point = a + (b - a) * u + (c - a) * v;
            let near = nodes.positions.iter().map(|node| node.distance(point)).fold(f32::INFINITY, f32::min);
            worst = worst.max(near / 0.1);
        }
    }
    println!("farthest point from a node, in spacings: {worst}");
    assert!(worst < 1.5, "{worst}");
}

#[test]
fn so_many_nodes() {
    for (mesh, count) in [(hills(), 3_000), (sphere(), 500), (wall(Vec3::new(3.0, 2.0, 0.3), 2), 8_000)] {
        let graph = builder(&mesh).with_nodes(count).build(1, &Silent).expect("a graph");
        let share = graph.nodes() as f32 / count as f32;
        assert!((0.9..1.1).contains(&share), "{} for {count}", graph.nodes());
    }
}

/// Two sheets a thousandth of a spacing apart, back to back, without a rim; and with one.
#[test]
fn no_edge_tunnels_through_a_thin_wall() {
    let front = || sheet(4, |u, v| Vec3::new(2.0 * u, 2.0 * v, 1e-4));
    let back = || sheet(4, |u, v| Vec3::new(2.0 * (1.0 - u), 2.0 * v, 0.0));
    for seed in 1..=5 {
        let graph =
            builder(&joined([front(), back()])).with_spacing(0.1).with_root(Vec3::Z).build(seed, &Silent);
        let graph = graph.expect("a graph");
        let side = |node: usize| graph.positions()[node].z > 5e-5;
        assert!(edges(&graph).all(|(from, to)| side(from) == side(to)), "seed {seed}");
        let reached = |node: usize| graph.hops_from_root()[node] < u32::MAX;
        assert!(
            (0..graph.nodes()).all(|node| reached(node) == side(node)),
            "all of the front, nothing of the back"
        );
        assert!((0..graph.nodes()).any(|node| !side(node)));
    }
    // A wall a tenth of a spacing thick with a rim: the way to the back is around it.
    let thin = wall(Vec3::new(2.0, 2.0, 0.01), 3);
    for seed in 1..=5 {
        let (graph, nodes) = held(&thin, 0.1, seed);
        for (from, to) in
            edges(&graph).filter(|&(from, to)| nodes.normals[from].dot(nodes.normals[to]) < -0.5)
        {
            let rim = |p: Vec3| (2.0 - p.y).min(p.x).min(2.0 - p.x).min(p.y);
            let (a, b) = (nodes.positions[from], nodes.positions[to]);
            assert!(rim(a) + rim(b) <= 1.5 * a.distance(b), "{a} - {b} leads through the wall");
        }
    }
}

/// A gap narrower than a spacing is not bridged, and a surface in two pieces says so by what is not reached.
#[test]
fn no_edge_bridges_a_gap() {
    let left = sheet(3, |u, v| Vec3::new(u, v, 0.0));
    let right = sheet(3, |u, v| Vec3::new(1.02 + u, v, 0.0));
    let graph = builder(&joined([left, right])).with_spacing(0.1).build(1, &Silent).expect("a graph");
    let side = |node: usize| graph.positions()[node].x > 1.01;
    assert!(edges(&graph).all(|(from, to)| side(from) == side(to)));
    for (node, &hops) in graph.hops_from_root().iter().enumerate() {
        assert_eq!(hops == u32::MAX, side(node));
    }
}

#[test]
fn the_root_is_the_nearest_point_of_the_surface() {
    let mesh = wall(Vec3::new(3.0, 2.0, 0.3), 6);
    let graph = builder(&mesh).with_nodes(500).with_root(Vec3::new(1.234, 0.5, 2.0)).build(1, &Silent);
    let graph = graph.expect("a graph");
    assert!(graph.position(graph.root()).abs_diff_eq(Vec3::new(1.234, 0.5, 0.3), 1e-5));
}

#[test]
fn a_tree_climbs() {
    let mesh = wall(Vec3::new(3.0, 2.0, 0.3), 2);
    let top = Cuboid::new(Vec3::new(-1.0, 1.5, -1.0), Vec3::new(4.0, 3.0, 1.0));
    let synth = TreeSynth::new(builder(&mesh).with_nodes(4_000).with_root(Vec3::new(1.5, 0.0, 0.3)))
        .stage(Stage::new(FollowField::new(Uniform::new(Vec3::Y)), InShape::poisson_disc(top, 30)));
    let tree = synth.synthesize(1).expect("a tree");
    testing::check_skeleton(&tree).expect("a tree");
    assert!(tree.positions().iter().all(|&p| distance(&mesh, p) < 1e-5));
    assert!(tree.positions().iter().any(|p| p.z < 0.01), "over the top and down the back");
}

#[test]
fn a_solid_has_a_surface() {
    let closed = joined([wall(Vec3::ONE, 2), sheet(2, |u, v| Vec3::new(u, 0.0, v))]);
    let solid = TriangleMesh::new(&closed.0, &closed.1).expect("a cube");
    let graph = PoissonSurface::of(&solid).with_spacing(0.1).build(1, &Silent).expect("a graph");
    assert!(graph.positions().iter().all(|&p| distance(&closed, p) < 1e-5));
    assert!(graph.hops_from_root().iter().all(|&hops| hops < u32::MAX));
}

#[test]
fn wrong_options_are_named() {
    let error = |builder: PoissonSurface| builder.build(1, &Silent).expect_err("out of range").to_string();
    let mesh = hills();
    for (wrong, name) in [
        (builder(&mesh).with_nodes(0), "PoissonSurface.nodes is 0"),
        (builder(&mesh).with_spacing(0.0), "PoissonSurface.spacing is 0.0"),
        (builder(&mesh).with_spacing(1e-5), "PoissonSurface.spacing is"),
        (builder(&mesh).with_spacing(f32::NAN), "PoissonSurface.spacing is NaN"),
        (builder(&mesh).with_tolerance(0.0), "PoissonSurface.tolerance is 0.0"),
        (builder(&mesh).with_tolerance(f32::NAN), "PoissonSurface.tolerance is NaN"),
        (builder(&mesh).with_root(Vec3::INFINITY), "PoissonSurface.root is"),
        (PoissonSurface::new(Vec::new(), Vec::new()), "PoissonSurface.triangles is 0.0"),
        (PoissonSurface::new(vec![Vec3::ZERO; 3], vec![[0, 1, 2]]), "PoissonSurface.triangles is 0.0"),
        (PoissonSurface::new(vec![Vec3::ZERO; 3], vec![[0, 1, 3]]), "PoissonSurface.triangles is 3"),
        (PoissonSurface::new(vec![Vec3::NAN; 3], vec![[0, 1, 2]]), "PoissonSurface.positions is"),
        (PoissonSurface::new(vec![Vec3::splat(2e6); 3], vec![[0, 1, 2]]), "PoissonSurface.positions is"),
    ] {
        let message = error(wrong);
        assert!(message.starts_with(name), "{message}, not {name}");
    }
}

proptest! {
    #![proptest_config(crate::sample::cases(48))]

    /// Any triangles at all: a sound graph with its nodes on them, or an error, never a panic.
    #[test]
    fn any_triangles(
        corners in proptest::collection::vec(proptest::array::uniform3(-2f32..2.0), 3..12),
        triangles in proptest::collection::vec(proptest::array::uniform3(0u32..12), 1..30),
        seed: u64,
        nodes in 1usize..300,
    ) {
        let corners: Vec<Vec3> = corners.into_iter().map(Vec3::from_array).collect();
        let mesh = (corners, triangles);
        let builder = builder(&mesh).with_nodes(nodes);
        if builder.check().is_ok() {
            let graph = builder.build(seed, &Silent).expect("in range");
            prop_assert!(graph.positions().iter().all(|&p| distance(&mesh, p) < 1e-4));
            prop_assert_eq!(builder.build(seed, &Silent).expect("in range"), graph);
        }
    }

    /// The same on a box of any size, with the calls that users have.
    #[test]
    fn any_wall(x in 0.05f32..3.0, y in 0.05f32..3.0, z in 0.001f32..3.0, seed: u64, nodes in 2usize..400) {
        let mesh = wall(Vec3::new(x, y, z), 2);
        let builder = builder(&mesh).with_nodes(nodes);
        let graph = builder.build(seed, &Silent).expect("in range");
        prop_assert!(graph.positions().iter().all(|&p| distance(&mesh, p) < 1e-5));
        let spacing = builder.spacing().expect("in range");
        for (from, to) in edges(&graph) {
            let middle = (graph.positions()[from] + graph.positions()[to]) * 0.5;
            prop_assert!(distance(&mesh, middle) <= 0.501 * spacing);
        }
    }
}
