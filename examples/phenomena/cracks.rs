//! Cracks in drying mud. A tree has no circles and closes no cell; but trees that grow from many seeds at once share
//! out the ground, and the borders between them are closed.

use super::planar;
use treesynth::glam::{Vec2, Vec3};
use treesynth::guided::{
    Bend, Count, Edge, Graph, GraphBuilder, GraphError, InShape, PoissonDelaunay, Search, Stage, TreeSynth,
};
use treesynth::preview::Picture;
use treesynth::random::{Purpose, unit};
use treesynth::shape::Cuboid;
use treesynth::{Observer, Silent, WeightFn};

type Failure = Box<dyn std::error::Error>;

/// A square metre of mud.
fn mud() -> Cuboid {
    Cuboid::new(Vec3::new(-0.5, -0.5, -1.0), Vec3::new(0.5, 0.5, 1.0))
}

/// A planar graph, and a root below it from which an edge leads to each of the cells' seeds: the branches from the root are as many
/// trees, each of which takes what it reaches first.
struct Cells {
    nodes: usize,
    /// Metres between seeds.
    spacing: f32,
}

impl Cells {
    fn flat(&self, seed: u64, observer: &dyn Observer) -> Result<Graph, GraphError> {
        PoissonDelaunay::new(mud()).with_nodes(self.nodes).build(seed, observer)
    }
}

impl GraphBuilder for Cells {
    fn build(&self, seed: u64, observer: &dyn Observer) -> Result<Graph, GraphError> {
        let flat = self.flat(seed, observer)?;
        let seeds = PoissonDelaunay::new(mud()).with_spacing(self.spacing).build(seed ^ 1, observer)?;
        let mut seeds: Vec<u32> = seeds.positions().iter().map(|&place| flat.nearest(place)).collect();
        seeds.sort_unstable();
        seeds.dedup();
        let hub = flat.nodes() as u32;
        let mut edges: Vec<(u32, u32)> = seeds.into_iter().map(|seed| (hub, seed)).collect();
        for from in 0..hub {
            edges.extend(flat.neighbours(from).iter().map(|&to| (from, to)));
        }
        let mut positions = flat.positions().to_vec();
        positions.push(Vec3::NEG_Z);
        Graph::new(positions, &edges, hub)
    }
}

/// The mud is tougher here than there.
struct Tough;

impl WeightFn for Tough {
    fn weight(&self, edge: &Edge) -> f32 {
        // All cells begin at once.
        if edge.start.z < -0.5 {
            return 0.0;
        }
        let ends = u64::from(edge.from.min(edge.to)) << 32 | u64::from(edge.from.max(edge.to));
        edge.length * (0.4 + 1.2 * unit(edge.seed, 0, Purpose::CUSTOM, ends))
    }
}

/// Cells and the cracks between them.
pub(crate) struct Mud {
    /// The planar graph.
    pub(crate) graph: Graph,
    /// The cell of each of its nodes.
    pub(crate) cells: Vec<u32>,
    /// Its triangles, and pairs of neighbouring ones with a crack from one to the other.
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) cracks: Vec<(u32, u32)>,
}

pub(crate) fn cracks(nodes: usize, seed: u64) -> Result<Mud, Failure> {
    let builder = Cells { nodes, spacing: 0.11 };
    let graph = builder.flat(seed, &Silent)?;
    let synth = TreeSynth::new(builder)
        .stage(Stage::new(Bend::none(), InShape::uniform(mud(), Count::Share(1.0))).with_weight(Tough));
    let hub = synth.build_graph(seed, &Silent)?;
    let growth = synth.grow(&mut Search::new(&hub), seed, &Silent)?;
    // The branch of the root that each node belongs to; parents come first.
    let mut cells = vec![0; hub.nodes()];
    for (node, parent) in growth.skeleton.edges() {
        let [here, before] = [node, parent].map(|place| growth.nodes[place]);
        cells[here as usize] = if before == hub.root() { here } else { cells[before as usize] };
    }
    cells.truncate(graph.nodes());
    let triangles = planar::triangles(&graph);
    // Both triangles at an edge whose ends lie in two cells.
    let mut sides: Vec<([u32; 2], u32)> = (0..)
        .zip(&triangles)
        .flat_map(|(number, &[a, b, c])| {
            [(a, b), (b, c), (c, a)].map(|(a, b)| ([a.min(b), a.max(b)], number))
        })
        .collect();
    sides.sort_unstable();
    let cracks = sides.chunk_by(|a, b| a.0 == b.0).filter_map(|same| match *same {
        [([a, b], one), (_, two)] if cells[a as usize] != cells[b as usize] => Some((one, two)),
        _ => None,
    });
    let cracks = cracks.collect();
    Ok(Mud { graph, cells, triangles, cracks })
}

impl Mud {
    fn middle(&self, triangle: u32) -> Vec3 {
        let [a, b, c] = self.triangles[triangle as usize].map(|corner| self.graph.position(corner));
        (a + b + c) / 3.0
    }
}

pub(crate) fn draw(nodes: usize, seed: u64, size: u32) -> Result<(Picture, String), Failure> {
    let found = cracks(nodes, seed)?;
    let mut names = found.cells.clone();
    names.sort_unstable();
    names.dedup();
    let measured = format!("{} closed cells, {} pieces of crack", names.len(), found.cracks.len());
    let mut picture = Picture::new(size, size, [172, 148, 120])?;
    let at = |p: Vec3| Vec2::new(p.x + 0.5, 0.5 - p.y) * size as f32;
    // Each cell has a tone of its own; a light rim where the mud curls up.
    let spacing = (1.0 / found.graph.nodes() as f32).sqrt() * size as f32;
    for (&cell, &position) in found.cells.iter().zip(found.graph.positions()) {
        let tone = 0.88 + 0.2 * unit(seed, 1, Purpose::CUSTOM, u64::from(cell));
        picture.disc(
            at(position),
            spacing * 0.9,
            [172.0, 148.0, 120.0].map(|channel| (channel * tone) as u8),
        );
    }
    for (width, color) in [(2.4, [196, 174, 146]), (1.5, [96, 76, 58]), (0.95, [44, 34, 27])] {
        for &(one, two) in &found.cracks {
            let (from, to) = (at(found.middle(one)), at(found.middle(two)));
            picture.line(from, to, width * size as f32 / 160.0 * 0.5, color);
        }
    }
    Ok((picture, measured))
}
