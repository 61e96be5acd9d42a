//! Parts that several tests need: graphs, strategies of a test's own, and a plain search for near
//! points.

use proptest::test_runner::Config;
use treesynth::glam::{DVec3, IVec3, Vec3};
use treesynth::guided::{Edge, EndpointError, Graph, GraphBuilder, PoissonYao, StageView};
use treesynth::shape::Cuboid;
use treesynth::{EndpointPolicy, Silent, WeightFn};

/// This number of cases per property, and no files beside the sources.
pub(crate) fn cases(count: u32) -> Config {
    Config { cases: count, failure_persistence: None, ..Config::default() }
}

pub(crate) const fn degrees(angle: f32) -> f32 {
    angle.to_radians()
}

/// A box on the ground around the origin.
pub(crate) fn plot(width: f32, height: f32) -> Cuboid {
    let half = width * 0.5;
    Cuboid::new(Vec3::new(-half, 0.0, -half), Vec3::new(half, height, half))
}

/// About so many nodes in a cube of 6 m, the root at the origin.
pub(crate) fn cube_graph(nodes: usize, seed: u64) -> Graph {
    built(&PoissonYao::new(plot(6.0, 6.0)).with_nodes(nodes), seed)
}

pub(crate) fn built(builder: &dyn GraphBuilder, seed: u64) -> Graph {
    builder.build(seed, &Silent).expect("a sound builder")
}

/// Chooses nothing, after a search to its end: costs and vectors of all nodes stay to be read.
pub(crate) struct Nothing;

impl EndpointPolicy for Nothing {
    fn select(&self, _: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        Ok(Vec::new())
    }
    fn needs_search(&self) -> bool {
        true
    }
}

/// Another policy's endpoints, but only after a search to its end.
pub(crate) struct AfterSearch<P>(pub(crate) P);

impl<P: EndpointPolicy> EndpointPolicy for AfterSearch<P> {
    fn select(&self, view: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        assert!(view.search().is_complete());
        self.0.select(view)
    }
    fn needs_search(&self) -> bool {
        true
    }
}

/// These nodes.
#[derive(Clone)]
pub(crate) struct Named(pub(crate) Vec<u32>);

impl EndpointPolicy for Named {
    fn select(&self, _: &StageView<'_>) -> Result<Vec<u32>, EndpointError> {
        Ok(self.0.clone())
    }
}

/// A weight that is none of the crate's: the square of the length, dearer uphill.
pub(crate) struct Uphill;

/// The same on plain vectors.
pub(crate) fn uphill(start: Vec3, end: Vec3, _: Vec3) -> f32 {
    start.distance_squared(end) * if end.y > start.y { 3.0 } else { 1.0 }
}

impl WeightFn for Uphill {
    fn weight(&self, edge: &Edge) -> f32 {
        uphill(edge.start, edge.end, edge.vector)
    }
}

/// Turns `v` by `angle` radians about the unit vector `axis` by taking it apart along and across it.
pub(crate) fn turned(v: DVec3, axis: DVec3, angle: f64) -> DVec3 {
    let along = axis * v.dot(axis);
    let across = v - along;
    along + across * angle.cos() + axis.cross(across) * angle.sin()
}

/// Points sorted into cells, to find which are near a place.
pub(crate) struct Near<'a> {
    points: &'a [Vec3],
    min: DVec3,
    side: f64,
    dims: IVec3,
    cells: Vec<Vec<u32>>,
}

impl<'a> Near<'a> {
    /// `reach` is the largest distance that will be asked for.
    pub(crate) fn new(points: &'a [Vec3], reach: f32) -> Self {
        let (min, max) = points
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), &p| (min.min(p), max.max(p)));
        let (min, max, side) = (min.as_dvec3(), max.as_dvec3(), f64::from(reach) * 1.001);
        let dims = ((max - min) / side).as_ivec3() + 1;
        let mut near = Self { points, min, side, dims, cells: Vec::new() };
        near.cells.resize(dims.to_array().iter().map(|&n| n as usize).product(), Vec::new());
        for (i, &point) in points.iter().enumerate() {
            let cell = near.index(near.cell(point)).expect("in the box around all");
            near.cells[cell].push(i as u32);
        }
        near
    }

    fn cell(&self, p: Vec3) -> IVec3 {
        ((p.as_dvec3() - self.min) / self.side).floor().as_ivec3()
    }

    fn index(&self, c: IVec3) -> Option<usize> {
        let inside = c.cmpge(IVec3::ZERO).all() && c.cmplt(self.dims).all();
        inside.then(|| {
            (c.z as usize * self.dims.y as usize + c.y as usize) * self.dims.x as usize + c.x as usize
        })
    }

    /// Distance from `place` to the nearest point that is not `but`, among those in reach.
    pub(crate) fn distance(&self, place: Vec3, but: Option<u32>) -> f64 {
        let mut best = f64::INFINITY;
        for i in 0..27 {
            let cell = self.cell(place) + IVec3::new(i % 3, i / 3 % 3, i / 9) - 1;
            for &point in self.index(cell).map_or(&[][..], |index| &self.cells[index]) {
                if Some(point) != but {
                    let distance = self.points[point as usize].as_dvec3().distance(place.as_dvec3());
                    best = best.min(distance);
                }
            }
        }
        best
    }
}

/// The least number of edges from any of `sources` to each node, by the book.
pub(crate) fn hops(graph: &Graph, sources: &[u32]) -> Vec<Option<u32>> {
    let mut hops = vec![None; graph.nodes()];
    let mut queue = std::collections::VecDeque::new();
    for &source in sources {
        hops[source as usize] = Some(0);
        queue.push_back((source, 0));
    }
    while let Some((node, count)) = queue.pop_front() {
        for &to in graph.neighbours(node) {
            if hops[to as usize].is_none() {
                hops[to as usize] = Some(count + 1);
                queue.push_back((to, count + 1));
            }
        }
    }
    hops
}

/// FNV-1a, 64 bits.
pub(crate) fn fnv1a(bytes: impl IntoIterator<Item = u8>) -> u64 {
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}
