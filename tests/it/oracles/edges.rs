//! Edges (section 3.1.1) against a search through all pairs.

use crate::sample::{built, cases, plot};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use treesynth::glam::{DVec3, Vec3};
use treesynth::guided::{
    Edges, GradedYao, Graph, Lattice, NearSurface, PointCloud, PoissonYao, SizingField, SizingFn,
};
use treesynth::random::{Purpose, unit};
use treesynth::shape::{Ellipsoid, HalfEllipsoid, ShapeRecipe, Sphere};

/// Division of the directions around a node.
#[derive(Clone, Copy, Debug)]
enum Sectors {
    /// The octants, by the signs of the coordinates; zero counts as positive.
    Octants,
    /// Equal wedges of the plane, anticlockwise from +X.
    Wedges(usize),
    /// The nearest of this number of directions along a spiral of golden angles.
    Spiral(usize),
}

impl Sectors {
    fn of_edges(edges: Edges) -> Self {
        match edges {
            Edges::Yao(8) => Self::Octants,
            Edges::Yao(count) => Self::Spiral(count),
            Edges::PlanarYao(count) => Self::Wedges(count),
            _ => unreachable!("not a Yao graph"),
        }
    }

    fn count(self) -> usize {
        match self {
            Self::Octants => 8,
            Self::Wedges(count) | Self::Spiral(count) => count,
        }
    }

    /// The sector, and whether the direction is clear of its border.
    fn of(self, d: DVec3) -> (usize, bool) {
        match self {
            Self::Octants => {
                (usize::from(d.x < 0.0) + 2 * usize::from(d.y < 0.0) + 4 * usize::from(d.z < 0.0), true)
            }
            Self::Wedges(count) => {
                let turn = d.y.atan2(d.x).rem_euclid(TAU) / TAU * count as f64;
                // Exactly on a border of 45° is clear.
                let exact = count == 8 && (d.x == 0.0 || d.y == 0.0 || d.x.abs() == d.y.abs());
                if exact {
                    return ((turn.round() as usize) % 8, true);
                }
                (turn as usize % count, (turn - turn.round()).abs() > 1e-5)
            }
            Self::Spiral(count) => {
                let mut cosines: Vec<(f64, usize)> = (0..count)
                    .map(|i| {
                        let height = 1.0 - (2 * i + 1) as f64 / count as f64;
                        let turn = PI * (3.0 - 5f64.sqrt()) * i as f64;
                        let across = (1.0 - height * height).sqrt();
                        let axis = DVec3::new(across * turn.cos(), height, across * turn.sin());
                        (axis.dot(d.normalize()), i)
                    })
                    .collect();
                cosines.sort_by(|a, b| b.0.total_cmp(&a.0));
                (cosines[0].1, cosines[0].0 - cosines[1].0 > 1e-5)
            }
        }
    }
}

/// Edges of up to three spacings for up to 8 sectors; for more, as far as a sector holds as many nodes.
fn reach_of(sectors: usize, flat: bool) -> f64 {
    let share = (sectors as f64 / 8.0).max(1.0);
    3.0 * if flat { share.sqrt() } else { share.cbrt() }
}

/// In a cloud: twice as far as the eighth nearest point.
fn reach_in_cloud(points: &[Vec3], from: u32) -> f64 {
    let at = points[from as usize].as_dvec3();
    let mut distances: Vec<f64> = points.iter().map(|point| point.as_dvec3().distance(at)).collect();
    distances.sort_by(f64::total_cmp);
    distances.get(8).map_or(f64::INFINITY, |eighth| 2.0 * eighth)
}

/// In every sector of every node the edge leads to the nearest node within reach, and there are no other edges. Where a
/// node is so near to a border that rounding may decide, the sectors on both sides are left out; so are nodes at the very
/// end of the reach.
fn assert_yao(graph: &Graph, sectors: Sectors, reach: impl Fn(u32) -> f64) {
    let nodes = graph.nodes() as u32;
    let at = |node: u32| graph.position(node).as_dvec3();
    let mut checked = 0;
    for from in 0..nodes {
        // (squared distance, node), and the distance up to which it is clear who is nearest.
        let mut nearest = vec![(f64::INFINITY, u32::MAX); sectors.count()];
        let mut unclear = f64::INFINITY;
        for to in (0..nodes).filter(|&to| to != from) {
            let d = at(to) - at(from);
            let (sector, clear) = sectors.of(d);
            if !clear {
                unclear = unclear.min(d.length_squared());
            } else if (d.length_squared(), to) < nearest[sector] {
                nearest[sector] = (d.length_squared(), to);
            }
        }
        let mut edges = vec![None; sectors.count()];
        for &to in graph.neighbours(from) {
            let (sector, clear) = sectors.of(at(to) - at(from));
            if clear {
                assert_eq!(edges[sector].replace(to), None, "two edges of {from} in sector {sector}");
            }
        }
        let reach = reach(from).powi(2);
        for (sector, &(distance, expected)) in nearest.iter().enumerate() {
            if unclear <= distance || (distance / reach - 1.0).abs() < 1e-5 {
                continue;
            }
            if distance > reach {
                assert_eq!(edges[sector], None, "{from} reaches farther than {}", reach.sqrt());
                checked += usize::from(expected != u32::MAX);
                continue;
            }
            let Some(found) = edges[sector] else {
                assert_eq!(expected, u32::MAX, "node {from} has no edge in sector {sector} of {sectors:?}");
                continue;
            };
            // In single precision two distances may be the same that are not quite.
            let of_found = at(found).distance_squared(at(from));
            assert!(of_found <= distance * 1.000_001, "{from} -> {found}, but {expected} is nearer");
            assert!(of_found != distance || found == expected, "ties go by index: {found}, {expected}");
            checked += 1;
        }
    }
    assert!(checked > nodes as usize, "almost everything was left out");
}

/// The so many nearest nodes, ties by index.
fn assert_nearest(graph: &Graph, count: usize, ties: bool) {
    let nodes = graph.nodes() as u32;
    let squared =
        |a: u32, b: u32| graph.position(a).as_dvec3().distance_squared(graph.position(b).as_dvec3());
    for from in 0..nodes {
        let mut others: Vec<u32> = (0..nodes).filter(|&to| to != from).collect();
        others.sort_by(|&a, &b| squared(from, a).total_cmp(&squared(from, b)).then(a.cmp(&b)));
        others.truncate(count);
        let found = graph.neighbours(from);
        assert_eq!(found.len(), others.len(), "node {from}");
        let mut by_distance = found.to_vec();
        by_distance.sort_by(|&a, &b| squared(from, a).total_cmp(&squared(from, b)).then(a.cmp(&b)));
        for (&found, &expected) in by_distance.iter().zip(&others) {
            let (found_at, expected_at) = (squared(from, found), squared(from, expected));
            assert!(found_at <= expected_at * 1.000_001, "{from} -> {found} instead of {expected}");
            assert!(!ties || found == expected, "node {from}: {by_distance:?} instead of {others:?}");
        }
    }
}

/// Points in a box, more of them in one corner.
fn cloud(count: u64, seed: u64, flat: bool) -> Vec<Vec3> {
    let draw = |i, axis| unit(seed, axis, Purpose::CUSTOM, i);
    (0..count)
        .map(|i| {
            let p = Vec3::new(draw(i, 0), draw(i, 1), draw(i, 2)) * 4.0 - 1.0;
            let p = if i % 3 == 0 { p * p * p.abs() * 0.1 } else { p };
            if flat { p.with_z(0.0) } else { p }
        })
        .collect()
}

proptest! {
    #![proptest_config(cases(8))]

    #[test]
    fn poisson_yao_edges(seed: u64, nodes in 50usize..900, which in 0usize..3) {
        let builder = match which {
            0 => PoissonYao::new(ShapeRecipe::from(plot(4.0, 4.0))),
            1 => PoissonYao::new(HalfEllipsoid::new(Vec3::ZERO, Vec3::new(3.0, 1.0, 2.0)).into()),
            _ => PoissonYao::new(plot(1.0, 9.0).into()),
        };
        for (builder, sectors) in [
            (builder.clone().with_nodes(nodes), Sectors::Octants),
            (builder.with_nodes(nodes).planar(), Sectors::Wedges(8)),
        ] {
            let spacing = f64::from(builder.spacing().expect("sound options"));
            assert_yao(&built(&builder, seed), sectors, |_| 3.0 * spacing);
        }
    }

    #[test]
    fn other_sector_counts(seed: u64, nodes in 50usize..500, sectors in prop::sample::select(vec![3, 6, 12, 26])) {
        let builder = PoissonYao::new(plot(4.0, 4.0)).with_nodes(nodes).with_sectors(sectors);
        for (builder, flat) in [(builder.clone(), false), (builder.planar(), true)] {
            let reach = reach_of(sectors, flat) * f64::from(builder.spacing().expect("sound options"));
            let divided = if flat { Sectors::Wedges(sectors) } else { Sectors::Spiral(sectors) };
            assert_yao(&built(&builder, seed), divided, |_| reach);
        }
    }

    #[test]
    fn clouds(seed: u64, count in 2u64..500, sectors in prop::sample::select(vec![6, 8, 12]), k in 1usize..12) {
        for edges in [Edges::Yao(sectors), Edges::PlanarYao(sectors)] {
            let flat = matches!(edges, Edges::PlanarYao(_));
            let points = cloud(count, seed, flat);
            let graph = built(&PointCloud::new(points.clone(), edges), 0);
            prop_assert_eq!(graph.positions(), &points[..]);
            if count > 30 {
                assert_yao(&graph, Sectors::of_edges(edges), |from| reach_in_cloud(&points, from));
            }
            if count > 30 {
                let unbounded = PointCloud::new(points.clone(), edges).with_reach(f32::INFINITY);
                assert_yao(&built(&unbounded, 0), Sectors::of_edges(edges), |_| f64::INFINITY);
            }
            assert_nearest(&built(&PointCloud::new(points, Edges::Nearest(k)), 0), k, false);
        }
    }

    #[test]
    fn lattices(seed: u64, jitter in 0.05f32..0.99, sectors in prop::sample::select(vec![6, 8, 12])) {
        let lattice = |edges| {
            let region = Ellipsoid::new(Vec3::Y * 0.7, Vec3::new(2.0, 1.5, 1.0));
            built(&Lattice::new(region, 0.3).with_jitter(jitter).with_edges(edges), seed)
        };
        for edges in [Edges::Yao(sectors), Edges::PlanarYao(sectors)] {
            let reach = 0.3 * reach_of(sectors, matches!(edges, Edges::PlanarYao(_)));
            assert_yao(&lattice(edges), Sectors::of_edges(edges), |_| reach);
        }
        assert_nearest(&lattice(Edges::Nearest(7)), 7, false);
    }
}

/// Spacings from a tenth to ten times another: few cells hold most of the nodes, or none has a suitable size.
#[test]
fn graphs_of_varying_spacing() {
    let crown = Sphere::new(Vec3::Y * 3.0, 1.5);
    let graded = |sizing: Arc<dyn SizingField>| GradedYao::new(plot(6.0, 6.0), sizing);
    let near = |ratio| graded(Arc::new(NearSurface::new(crown, 1.0, ratio, 1.0)));
    let point = SizingFn::new(|p: Vec3| 0.01 + 0.13 * p.distance(Vec3::splat(1.5)));
    for (builder, sectors) in [
        (near(8.0), 8),
        (near(0.1), 8),
        (near(8.0), 12),
        (graded(Arc::new(point)), 8),
        (graded(Arc::new(point)), 20),
    ] {
        let builder = builder.with_nodes(2500).with_grading(0.14).with_sectors(sectors);
        let spacing = builder.spacing().expect("a sound region");
        let (low, high) = spacing.extremes();
        assert!(high > 1.5 * low, "{low} to {high}");
        let graph = built(&builder, 1);
        let reach = |from: u32| reach_of(sectors, false) * f64::from(spacing.at(graph.position(from)));
        assert_yao(&graph, Sectors::of_edges(Edges::Yao(sectors)), reach);
    }
}

/// Without jitter everything ties, and everything lies on the borders of sectors.
#[test]
fn a_lattice_without_jitter() {
    let lattice = |edges| built(&Lattice::new(plot(3.0, 3.0), 0.5).with_jitter(0.0).with_edges(edges), 1);
    let cubic = lattice(Edges::Yao(8));
    assert_eq!(cubic.nodes(), 7 * 7 * 7);
    assert_yao(&cubic, Sectors::Octants, |_| 1.5);
    let square = lattice(Edges::PlanarYao(8));
    assert_eq!(square.nodes(), 7 * 7);
    assert_yao(&square, Sectors::Wedges(8), |_| 1.5);
}

#[test]
fn nearest_nodes_of_a_lattice_tie_by_index() {
    for count in [3, 6, 7, 18, 26] {
        let builder = Lattice::new(plot(3.0, 3.0), 0.5).with_jitter(0.0).with_edges(Edges::Nearest(count));
        assert_nearest(&built(&builder, 1), count, true);
    }
}

/// "Each node moved at random within its cell" by at most its share of it; all cells of the region filled.
#[test]
fn lattice_nodes_stay_in_their_cells() {
    let spacing = 0.25;
    for (jitter, seed) in [(0.0, 1), (0.5, 2), (0.95, 3)] {
        let graph = built(&Lattice::new(plot(4.0, 4.0), spacing).with_jitter(jitter), seed);
        let mut filled = std::collections::BTreeSet::new();
        for &node in graph.positions() {
            let cell = (node / spacing).round();
            let moved = (node / spacing - cell).abs().max_element();
            assert!(moved <= jitter * 0.5 + 1e-4, "{node} is {moved} cells off");
            assert!(filled.insert(cell.as_ivec3().to_array()), "two nodes in cell {cell}");
        }
        let inner = |c: &[i32; 3]| c[0].abs() < 8 && c[2].abs() < 8 && c[1] > 0 && c[1] < 16;
        assert_eq!(filled.iter().filter(|cell| inner(cell)).count(), 15 * 15 * 15);
        assert_eq!(graph.position(graph.root()), Vec3::ZERO);
    }
}

#[test]
fn the_root_of_a_cloud_is_the_point_nearest_to_it() {
    for seed in 0..20 {
        let points = cloud(300, seed, false);
        let place = Vec3::new(0.3, -0.2, seed as f32 * 0.1);
        let graph = built(&PointCloud::new(points.clone(), Edges::Nearest(4)).with_root(place), 0);
        let root = graph.position(graph.root()).distance(place);
        assert!(points.iter().all(|p| p.distance(place) >= root));
    }
}
