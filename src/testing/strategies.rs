//! Random regions, graphs and skeletons.

use crate::guided::{Edges, GradedYao, Graph, GraphBuilder, Lattice, NearSurface, PointCloud, PoissonYao};
use crate::observer::Silent;
use crate::shape::{
    Bounds, Cone, Cuboid, Cylinder, Difference, Ellipsoid, HalfEllipsoid, Intersection, Shape, Shell, Sphere,
    Union,
};
use crate::skeleton::Skeleton;
use glam::Vec3;
use proptest::prelude::*;
use std::sync::Arc;

/// A random shape; prints what it is.
#[derive(Clone)]
pub struct Region {
    shape: Arc<dyn Shape>,
    description: String,
}

impl Region {
    fn new(shape: impl Shape + std::fmt::Debug + 'static) -> Self {
        Self { description: format!("{shape:?}"), shape: Arc::new(shape) }
    }
}

impl std::fmt::Debug for Region {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.description)
    }
}

impl Shape for Region {
    fn contains(&self, point: Vec3) -> bool {
        self.shape.contains(point)
    }
    fn bounds(&self) -> Bounds {
        self.shape.bounds()
    }
    fn volume(&self) -> f32 {
        self.shape.volume()
    }
    fn sample(&self, random: &mut dyn Rng) -> Option<Vec3> {
        self.shape.sample(random)
    }
}

/// Regions that hold the origin and have a diameter of 1 to 8 m: every shape of the crate, on the ground or
/// around the origin, and combinations of them.
pub fn regions() -> impl Strategy<Value = Region> {
    let lengths = (0.5f32..4.0, 0.5f32..4.0, 0.5f32..4.0);
    (0..9, lengths).prop_map(|(kind, (x, y, z))| {
        let size = Vec3::new(x, y, z);
        match kind {
            0 => Region::new(Cuboid::new(Vec3::new(-x, 0.0, -z), Vec3::new(x, 2.0 * y, z))),
            1 => Region::new(Sphere::new(Vec3::Y * y, y)),
            2 => Region::new(Ellipsoid::new(Vec3::ZERO, size)),
            3 => Region::new(HalfEllipsoid::new(Vec3::ZERO, size)),
            4 => Region::new(Cone::new(Vec3::ZERO, x, y)),
            5 => Region::new(Cylinder::new(Vec3::ZERO, x, y)),
            6 => Region::new(Union::new(
                Cylinder::new(Vec3::ZERO, x * 0.3, y),
                Ellipsoid::new(Vec3::Y * y, Vec3::new(x, y * 0.4, z)),
            )),
            7 => Region::new(Intersection::new(
                Sphere::new(Vec3::ZERO, x.max(y)),
                Cuboid::centered(Vec3::ZERO, size * 1.5),
            )),
            _ => Region::new(Union::new(
                Sphere::new(Vec3::ZERO, 0.5),
                Difference::new(
                    Shell::new(Cuboid::centered(Vec3::ZERO, size * 2.0), 0.4),
                    Sphere::new(size, x.min(y) * 0.5),
                ),
            )),
        }
    })
}

/// Graphs of 2 to about 600 nodes by every builder of the crate: Poisson-disc in space and in the plane, with 3
/// to 26 sectors and of one spacing or more, jittered lattices, and clouds of points with Yao or nearest edges.
pub fn graphs() -> impl Strategy<Value = Graph> {
    let sectors = prop_oneof![3 => Just(8usize), 1 => 3..26usize];
    (regions(), 0..6, any::<u64>(), sectors, 2..600usize).prop_filter_map(
        "a graph with edges",
        |(region, kind, seed, sectors, nodes)| {
            let spacing = crate::math::cbrt(region.volume() / nodes as f32).max(0.1);
            let builder: Box<dyn GraphBuilder> = match kind {
                0 | 1 => Box::new(PoissonYao::new(region).with_nodes(nodes).with_sectors(sectors)),
                2 => Box::new(PoissonYao::new(region).with_nodes(nodes).with_sectors(sectors).planar()),
                3 => {
                    let sizing = NearSurface::new(region.clone(), 1.0, 3.0, 4.0 * spacing);
                    Box::new(GradedYao::new(region, sizing).with_nodes(nodes).with_sectors(sectors))
                }
                4 => Box::new(Lattice::new(region, spacing).with_edges(Edges::Yao(sectors))),
                _ => {
                    let mut random = crate::random::stream(seed, 0, crate::random::Purpose::CUSTOM, 0);
                    let points = (0..nodes).filter_map(|_| region.sample(&mut random)).collect();
                    let edges = if seed % 2 == 0 { Edges::Yao(sectors) } else { Edges::Nearest(sectors) };
                    Box::new(PointCloud::new(points, edges))
                }
            };
            builder.build(seed, &Silent).ok().filter(|graph| graph.edges() > 0)
        },
    )
}

/// Skeletons of 1 to `nodes` nodes: any parents, positions within 10 m, radii that never grow towards the tips,
/// up to three stages.
pub fn skeletons(nodes: usize) -> impl Strategy<Value = Skeleton> {
    let node = (any::<prop::sample::Index>(), -10f32..10.0, -10f32..10.0, -10f32..10.0, 0f32..1.0, 0u16..3);
    prop::collection::vec(node, 1..=nodes.max(1)).prop_filter_map("a skeleton", |nodes| {
        let positions = nodes.iter().map(|&(_, x, y, z, ..)| Vec3::new(x, y, z)).collect();
        let parents: Vec<Option<u32>> =
            nodes.iter().enumerate().map(|(i, node)| (i > 0).then(|| node.0.index(i) as u32)).collect();
        let (mut radii, mut stages, mut hops) = (Vec::new(), Vec::new(), Vec::new());
        for (node, parent) in nodes.iter().zip(&parents) {
            match parent.map(|parent| parent as usize) {
                None => {
                    radii.push(0.5);
                    stages.push(0);
                    hops.push(0);
                }
                Some(parent) => {
                    radii.push(radii[parent] * (0.5 + 0.5 * node.4));
                    stages.push(node.5.max(stages[parent]));
                    hops.push(if node.5 > stages[parent] { 1 } else { hops[parent] + 1 });
                }
            }
        }
        let skeleton = Skeleton::new(positions, parents).ok()?;
        skeleton.with_radii(radii).ok()?.with_stages(stages).ok()?.with_hops(hops).ok()
    })
}
