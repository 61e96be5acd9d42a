//! Rivers of a valley: the least-cost tree from its outlet up to every point, in a graph whose edges only climb.

use super::planar;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use treesynth::field::{FieldFn, GridField};
use treesynth::glam::{Vec2, Vec3};
use treesynth::guided::{
    Count, Edge, FollowField, Graph, GraphBuilder, GraphError, InShape, PoissonDelaunay, Search, Stage,
    TreeSynth,
};
use treesynth::math::{exp, ln};
use treesynth::preview::{Camera, Picture, Preview};
use treesynth::random::{Purpose, unit};
use treesynth::shape::Cuboid;
use treesynth::surface::{Material, Mesh, Part, Tubes};
use treesynth::{Observer, Silent, Skeleton, WeightFn};

type Failure = Box<dyn std::error::Error>;

/// Half the side of the land, metres.
const HALF: f32 = 5_000.0;
/// Water runs down by at least so much from node to node, metres.
const FALL: f32 = 0.02;

/// Hills on a plain that falls to the outlet, in the middle of the lower side, with a ridge along the other sides; metres.
/// `y` is north.
fn height(seed: u64, place: Vec2) -> f32 {
    let within = Vec2::new(HALF - place.x.abs(), HALF - place.y.abs()).min_element();
    let ridge =
        (1.0 - within / 1_500.0).clamp(0.0, 1.0) * ((place - Vec2::NEG_Y * HALF).length() / 2_000.0).min(1.0);
    let mut sum = 0.04 * (place.y + HALF) + 0.02 * place.x.abs() + 300.0 * ridge * ridge;
    let (mut wave, mut amplitude) = (3_600.0, 240.0);
    for octave in 0..6 {
        sum += amplitude * noise(seed, octave, place / wave);
        (wave, amplitude) = (wave * 0.5, amplitude * 0.48);
    }
    sum
}

/// Smooth noise in [-1, 1] (Perlin 1985, with values instead of gradients).
fn noise(seed: u64, octave: u32, place: Vec2) -> f32 {
    let (low, share) = (place.floor(), place - place.floor());
    let at = |x: f32, y: f32| {
        let [x, y] = [low.x + x, low.y + y].map(|n| (n as i32 as u32) as u64);
        unit(seed, octave, Purpose::CUSTOM, x << 32 | y) * 2.0 - 1.0
    };
    let smooth = share * share * (Vec2::splat(3.0) - share * 2.0);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    mix(mix(at(0.0, 0.0), at(1.0, 0.0), smooth.x), mix(at(0.0, 1.0), at(1.0, 1.0), smooth.x), smooth.y)
}

/// The way up at every point of the land, on a grid, as a terrain model would have it.
fn uphill(seed: u64) -> Result<GridField, Failure> {
    let step = 100.0;
    let slope = move |point: Vec3| {
        let at = |x: f32, z: f32| height(seed, Vec2::new(x, -z));
        let (x, z) = (point.x, point.z);
        Vec3::new(at(x + step, z) - at(x - step, z), 0.0, at(x, z + step) - at(x, z - step)) / (2.0 * step)
    };
    let count = (2.0 * HALF / step) as usize + 1;
    let origin = Vec3::new(-HALF, 0.0, -HALF);
    Ok(GridField::sampled(&FieldFn::new(slope), origin, Vec3::splat(step), [count, 1, count])?)
}

/// Nodes on the land, edges that climb. Hollows are filled up to where they overflow (Barnes, Lehman and Mulla
/// 2014, "Priority-flood"), so that water reaches the outlet from everywhere.
struct Land {
    nodes: usize,
}

impl Land {
    fn flat(&self, seed: u64, observer: &dyn Observer) -> Result<Graph, GraphError> {
        let square = Cuboid::new(Vec3::new(-HALF, -HALF, -1.0), Vec3::new(HALF, HALF, 1.0));
        let outlet = Vec3::new(0.0, -HALF, 0.0);
        PoissonDelaunay::new(square).with_nodes(self.nodes).with_root(outlet).build(seed, observer)
    }
}

fn flooded(flat: &Graph, seed: u64) -> Vec<f32> {
    let mut heights: Vec<f32> = flat.positions().iter().map(|p| height(seed, p.truncate())).collect();
    let lowest = heights.iter().copied().fold(f32::INFINITY, f32::min);
    // Above 0, where the bits of numbers are in their order.
    for height in &mut heights {
        *height += 10.0 - lowest;
    }
    heights[flat.root() as usize] = 1.0;
    let mut seen = vec![false; heights.len()];
    let mut shore = BinaryHeap::from([Reverse((heights[flat.root() as usize].to_bits(), flat.root()))]);
    seen[flat.root() as usize] = true;
    while let Some(Reverse((level, node))) = shore.pop() {
        for &to in flat.neighbours(node) {
            if !std::mem::replace(&mut seen[to as usize], true) {
                let height = heights[to as usize].max(f32::from_bits(level) + FALL);
                heights[to as usize] = height;
                shore.push(Reverse((height.to_bits(), to)));
            }
        }
    }
    heights
}

impl GraphBuilder for Land {
    fn build(&self, seed: u64, observer: &dyn Observer) -> Result<Graph, GraphError> {
        let flat = self.flat(seed, observer)?;
        let heights = flooded(&flat, seed);
        let climbs = |from: u32| {
            let higher = |to: &&u32| heights[**to as usize] > heights[from as usize];
            flat.neighbours(from).iter().filter(higher).map(|&to| (from, to)).collect::<Vec<_>>()
        };
        let edges: Vec<(u32, u32)> = (0..flat.nodes() as u32).flat_map(climbs).collect();
        let positions =
            flat.positions().iter().zip(&heights).map(|(p, &height)| Vec3::new(p.x, height, -p.y));
        Graph::new(positions.collect(), &edges, flat.root())
    }
}

/// Cheap straight up the slope, and a little for every metre. How hard the ground is varies from edge to edge by a factor
/// with a log-normal tail: ways around what is hard make streams longer than straight.
struct Ground;

impl WeightFn for Ground {
    fn weight(&self, edge: &Edge) -> f32 {
        let ends = u64::from(edge.from) << 32 | u64::from(edge.to);
        let draw = unit(edge.seed, 7, Purpose::CUSTOM, ends).clamp(1e-4, 1.0 - 1e-4);
        // Near to normal: the logistic distribution's quantile.
        let hardness = exp(0.9 * ln(draw / (1.0 - draw)));
        edge.length * (0.25 + edge.deviation()) * hardness
    }
}

/// The drainage of all the land, and the graph it lies in: first the streams that lead to points spread over the land, then the
/// ways of all other water to these.
pub(crate) fn rivers(nodes: usize, seed: u64) -> Result<(Skeleton, Graph), Failure> {
    let rule = || -> Result<_, Failure> { Ok(FollowField::new(uphill(seed)?)) };
    let all = Cuboid::new(Vec3::new(-2.0 * HALF, -1.0, -2.0 * HALF), Vec3::splat(2.0 * HALF));
    let stage = |count| -> Result<_, Failure> {
        Ok(Stage::new(rule()?, InShape::poisson_disc(all, count)).with_weight(Ground))
    };
    let synth = TreeSynth::new(Land { nodes })
        .stage(stage(Count::UpTo((nodes / 120).max(4)))?)
        .stage(Stage::new(rule()?, InShape::uniform(all, Count::Share(1.0))).with_weight(Ground));
    let graph = synth.build_graph(seed, &Silent)?;
    let growth = synth.grow(&mut Search::new(&graph), seed, &Silent)?;
    Ok((growth.skeleton, graph))
}

/// Of each node, what drains through it: nodes (each stands for the same area), and the length of the longest stream above it, metres.
pub(crate) fn drainage(tree: &Skeleton) -> (Vec<f32>, Vec<f32>) {
    let (mut areas, mut lengths) = (vec![1.0; tree.len()], vec![0.0f32; tree.len()]);
    for (node, parent) in tree.edges().rev() {
        areas[parent] += areas[node];
        let step = (tree.positions()[node] - tree.positions()[parent]).with_y(0.0).length();
        lengths[parent] = lengths[parent].max(lengths[node] + step);
    }
    (areas, lengths)
}

/// Hack's exponent: length grows with the area drained to this power (Hack 1957). A line through the mean logarithms of
/// classes of area, each twice as large as the one before, from 16 nodes to an eighth of all.
pub(crate) fn hack(tree: &Skeleton) -> f32 {
    let (areas, lengths) = drainage(tree);
    let mut points = Vec::new();
    let mut low = 16.0;
    while low * 2.0 <= tree.len() as f32 / 8.0 {
        let class = || (0..tree.len()).filter(|&node| (low..2.0 * low).contains(&areas[node]));
        let count = class().count() as f32;
        if count > 0.0 {
            let mean = |of: &Vec<f32>| class().map(|node| ln(of[node])).sum::<f32>() / count;
            points.push((mean(&areas), mean(&lengths)));
        }
        low *= 2.0;
    }
    let count = points.len() as f32;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.0 / count, y + point.1 / count));
    let both: f32 = points.iter().map(|point| (point.0 - x) * (point.1 - y)).sum();
    both / points.iter().map(|point| (point.0 - x) * (point.0 - x)).sum::<f32>()
}

pub(crate) fn draw(nodes: usize, seed: u64, size: u32) -> Result<(Picture, String), Failure> {
    let (tree, graph) = rivers(nodes, seed)?;
    let uphill =
        tree.edges().filter(|&(node, parent)| tree.positions()[parent].y >= tree.positions()[node].y).count();
    let measured =
        format!("Hack's exponent {:.3}, {uphill} of {} segments run uphill", hack(&tree), tree.segments());
    let steep = |p: Vec3| Vec3::new(p.x, p.y * 2.5, p.z);
    // Segments that drain enough to be seen as a river.
    let (areas, _) = drainage(&tree);
    let least = (nodes as f32 / 500.0).max(4.0);
    let (mut places, mut parents, mut positions, mut radii) =
        (vec![0; tree.len()], Vec::new(), Vec::new(), Vec::new());
    for node in (0..tree.len()).filter(|&node| areas[node] >= least) {
        places[node] = positions.len() as u32;
        parents.push(tree.parent(node).map(|parent| places[parent]));
        positions.push(steep(tree.positions()[node]) + Vec3::Y * 6.0);
        radii.push(85.0 * (areas[node] / tree.len() as f32).sqrt() + 6.0);
    }
    let river = Skeleton::new(positions, parents)?.with_radii(radii)?;
    let water = Tubes::default().mesh(&river)?;
    let land = land(&graph, seed, nodes, steep)?;
    let parts = [
        Part::new(&land).with_material(Material::white()),
        Part::new(&water).with_material(Material::bark().with_srgb([40, 84, 136]).with_roughness(0.4)),
    ];
    let paper = [0.97, 0.965, 0.955];
    let preview = Preview::default()
        .with_size(size, size * 3 / 4)
        .with_background(paper, paper)
        .with_ground(false)
        .with_camera(Camera::default().with_azimuth(0.0).with_elevation(0.85));
    Ok((preview.draw_parts(&parts)?, measured))
}

/// The land as a mesh, green below and grey above.
fn land(graph: &Graph, seed: u64, nodes: usize, steep: impl Fn(Vec3) -> Vec3) -> Result<Mesh, Failure> {
    let flat = Land { nodes }.flat(seed, &Silent)?;
    let mut mesh = Mesh::default();
    let top = graph.positions().iter().map(|p| p.y).fold(1.0, f32::max);
    for &position in graph.positions() {
        let share = position.y / top;
        let mix = |low: [f32; 3], high: [f32; 3], t: f32| [0, 1, 2].map(|i| low[i] + (high[i] - low[i]) * t);
        let (green, olive, grey) = ([0.07, 0.13, 0.035], [0.17, 0.17, 0.075], [0.27, 0.25, 0.23]);
        let color =
            if share < 0.5 { mix(green, olive, share * 2.0) } else { mix(olive, grey, share * 2.0 - 1.0) };
        mesh.positions.push(steep(position));
        mesh.normals.push(Vec3::ZERO);
        mesh.colors.push(color);
    }
    for corners in planar::triangles(&flat) {
        let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
        let normal = (b - a).cross(c - a);
        for corner in corners {
            mesh.normals[corner as usize] += normal;
        }
        mesh.indices.extend(corners);
    }
    mesh.normals.iter_mut().for_each(|normal| *normal = normal.normalize_or(Vec3::Y));
    Ok(mesh)
}
