//! A stroke of lightning: the cheapest way down through air of random resistance, and branches off it that die out.

use treesynth::field::Uniform;
use treesynth::glam::{Vec2, Vec3};
use treesynth::guided::{
    Bend, Blend, Count, Edge, FollowField, HopSurface, NearestTo, PoissonYao, Side, Stage, TreeSynth,
};
use treesynth::math::{exp, ln};
use treesynth::preview::Picture;
use treesynth::random::{Purpose, unit};
use treesynth::shape::Cuboid;
use treesynth::{Skeleton, WeightFn};

type Failure = Box<dyn std::error::Error>;

/// The cloud's base, metres.
const CLOUD: f32 = 1_000.0;
/// Target of the stroke.
const TARGET: Vec3 = Vec3::new(120.0, 0.0, 0.0);

/// The way along the guiding vector is cheap, but the air's resistance varies from edge to edge: a factor with a
/// log-normal tail.
struct Air {
    roughness: f32,
    /// Edges may be so long, metres: along the region's faces some are much longer, and would be straight strokes.
    longest: f32,
}

impl WeightFn for Air {
    fn weight(&self, edge: &Edge) -> f32 {
        if edge.length > self.longest {
            return f32::INFINITY;
        }
        let number =
            |stage| unit(edge.seed, stage, Purpose::CUSTOM, u64::from(edge.from) << 32 | u64::from(edge.to));
        // Near to normal: the logistic distribution's quantile.
        let draw = number(0).clamp(1e-4, 1.0 - 1e-4);
        let resistance = exp(self.roughness * ln(draw / (1.0 - draw)));
        edge.length * (0.15 + edge.deviation()) * resistance
    }

    fn forbids(&self) -> bool {
        true
    }
}

pub(crate) fn stroke(nodes: usize) -> TreeSynth {
    let region = Cuboid::new(Vec3::new(-420.0, 0.0, -160.0), Vec3::new(420.0, CLOUD, 160.0));
    let graph = PoissonYao::new(region).with_nodes(nodes).with_root(Vec3::Y * CLOUD);
    // An error here is one that synthesis reports.
    let longest = 2.5 * graph.spacing().unwrap_or(f32::NAN);
    let down = || FollowField::new(Uniform::new(Vec3::NEG_Y));
    let branches = |hops, count, share| {
        // Off to the side first, then down again.
        let rule = Blend::new(Bend::piecewise(0.9, 0.0, 1), down(), 0.35);
        let endpoints = HopSurface::new(hops, Count::UpTo(count)).with_outermost(share).only(Side::Lower);
        Stage::new(rule, endpoints).with_weight(Air { roughness: 0.5, longest })
    };
    TreeSynth::new(graph)
        .stage(Stage::new(down(), NearestTo::new(TARGET)).with_weight(Air { roughness: 0.6, longest }))
        .stage(branches(11, 8, 0.8))
        .stage(branches(5, 30, 0.9))
        .stage(branches(3, 90, 1.0))
}

/// Length of the main channel over the distance between its ends.
pub(crate) fn tortuosity(tree: &Skeleton) -> f32 {
    let channel = tree.edges().filter(|&(node, _)| tree.stages()[node] == 0);
    let length: f32 = channel.map(|(a, b)| tree.positions()[a].distance(tree.positions()[b])).sum();
    length / tree.positions()[0].distance(TARGET)
}

pub(crate) fn draw(nodes: usize, seed: u64, size: u32) -> Result<(Picture, String), Failure> {
    let tree = stroke(nodes).synthesize(seed)?;
    let measured = format!(
        "{} tips, main channel {:.2} times as long as straight",
        tree.tips().count(),
        tortuosity(&tree)
    );
    let mut picture = Picture::new(size, size, [14, 16, 30])?;
    // The night sky brightens to the horizon.
    for row in 0..size {
        let share = row as f32 / size as f32;
        let color = [14.0 + 22.0 * share, 16.0 + 20.0 * share, 30.0 + 26.0 * share].map(|c| c as u8);
        picture.rectangle(0, row as i32, size, 1, color);
    }
    let scale = size as f32 / (CLOUD * 1.06);
    let at = |p: Vec3| {
        Vec2::new(size as f32 * 0.5 + (p.x + 0.15 * p.z) * scale, size as f32 - (p.y + 30.0) * scale)
    };
    picture.rectangle(0, (size as f32 - 30.0 * scale) as i32, size, size, [9, 10, 16]);
    // From the dim glow around to the bright core; branches are thinner and dimmer stage by stage.
    let glow: [(f32, [f32; 3]); 6] = [
        (22.0, [44.0, 44.0, 78.0]),
        (14.0, [62.0, 62.0, 108.0]),
        (8.0, [92.0, 92.0, 156.0]),
        (4.5, [150.0, 148.0, 216.0]),
        (2.6, [214.0, 212.0, 246.0]),
        (1.5, [255.0, 254.0, 255.0]),
    ];
    for (width, color) in glow {
        for (node, parent) in tree.edges() {
            let stage = f32::from(tree.stages()[node]);
            let dim = 1.0 - 0.23 * stage;
            if stage > 0.0 && width > 10.0 {
                continue;
            }
            let width = width / (1.0 + 0.9 * stage) * size as f32 / 800.0;
            let color = [0, 1, 2].map(|i| (color[i] * dim + [14.0, 16.0, 34.0][i] * (1.0 - dim)) as u8);
            picture.line(at(tree.positions()[parent]), at(tree.positions()[node]), width, color);
        }
    }
    Ok((picture, measured))
}
