//! A shrub in the wind around a rock: guiding vectors from a flow on a grid, as a simulation leaves it in a file.

use super::solid;
use treesynth::field::{FieldFn, GridField};
use treesynth::foliage::{Foliage, Leaf};
use treesynth::glam::Vec3;
use treesynth::guided::{
    Bend, Blend, Count, FollowField, Guided, HopSurface, InShape, PoissonYao, Stage, TreeSynth, Within,
};
use treesynth::preview::{Camera, Picture, Preview};
use treesynth::radius::{PipeModel, Taper};
use treesynth::shape::{Cuboid, Sphere};
use treesynth::surface::{Material, Part, Tubes};
use treesynth::{Skeleton, VectorField};

type Failure = Box<dyn std::error::Error>;

/// The rock lies half in the ground, so that the flow around the whole of it keeps to the ground.
pub(crate) const ROCK: f32 = 1.5;

/// Root of the shrub, before the rock in the wind.
const ROOT: Vec3 = Vec3::new(-3.4, 0.0, 0.25);

/// The potential flow along +X around a ball (Batchelor 1967, "An introduction to fluid dynamics", section 6.8).
fn flow(point: Vec3) -> Vec3 {
    let distance = point.length();
    if distance < ROCK {
        return Vec3::ZERO;
    }
    let (half, outward) = (0.5 * (ROCK / distance) * (ROCK / distance) * (ROCK / distance), point / distance);
    Vec3::X * (1.0 + half) - outward * (3.0 * half * outward.x)
}

/// The flow as a simulation would leave it: sampled, written to a file, and read again.
pub(crate) fn simulated() -> Result<GridField, Failure> {
    let (origin, spacing) = (Vec3::new(-4.5, 0.0, -3.0), Vec3::splat(0.2));
    let mut file = Vec::new();
    GridField::sampled(&FieldFn::new(flow), origin, spacing, [51, 21, 31])?.write_vtk(&mut file)?;
    Ok(GridField::read_vtk(file.as_slice())?)
}

/// The shrub's stages; the first two follow a field.
pub(crate) fn shrub(nodes: usize, wind: impl VectorField + Clone + 'static) -> TreeSynth {
    let region = Cuboid::new(Vec3::new(-4.5, 0.0, -3.0), Vec3::new(5.5, 4.0, 3.0));
    let rock = Sphere::new(Vec3::ZERO, ROCK);
    let lee = Cuboid::new(Vec3::new(-2.0, 0.3, -2.2), Vec3::new(3.8, 2.4, 2.2));
    let twigs = |hops, count| {
        let rule = Blend::new(Bend::piecewise(0.5, 0.0, 1), FollowField::new(wind.clone()), 0.5);
        Stage::new(rule, HopSurface::new(hops, Count::UpTo(count)).with_outermost(0.8))
            .with_weight(Within::obstacle(Guided, rock))
    };
    TreeSynth::new(PoissonYao::new(region).with_nodes(nodes).with_root(ROOT))
        .stage(
            Stage::new(FollowField::new(wind.clone()), InShape::poisson_disc(lee, Count::UpTo(36)))
                .with_weight(Within::obstacle(Guided, rock)),
        )
        .stage(twigs(2, 240))
        .stage(twigs(2, 800))
        .with_radius(Taper::new(PipeModel::default().with_exponent(2.4).with_trunk_diameter(0.3)))
}

/// Mean cosine between the twigs and the wind, weighted by length. Where the limbs lead is decided by their endpoints, which lie in the lee.
pub(crate) fn along(tree: &Skeleton, wind: &impl VectorField) -> f32 {
    let (mut sum, mut length) = (0.0, 0.0);
    for (node, parent) in tree.edges().filter(|&(node, _)| tree.stages()[node] > 0) {
        let (from, to) = (tree.positions()[parent], tree.positions()[node]);
        sum += wind.at((from + to) * 0.5).normalize_or_zero().dot(to - from);
        length += from.distance(to);
    }
    sum / length
}

pub(crate) fn draw(nodes: usize, seed: u64, size: u32) -> Result<(Picture, String), Failure> {
    let wind = simulated()?;
    let tree = shrub(nodes, wind.clone()).synthesize(seed)?;
    let measured = format!("cosine to the wind {:.2}, {} tips", along(&tree, &wind), tree.tips().count());
    let mesh = Tubes::default().mesh(&tree)?;
    let leaves = Foliage::new(Leaf::lanceolate())
        .with_spacing(0.03)
        .with_size(0.12)
        .with_material(Material::leaf().with_srgb([98, 118, 66]))
        .place(&tree, seed)?;
    let rock = solid::ball(Vec3::ZERO, ROCK * 0.97, 96, 24);
    let parts = [
        Part::new(&mesh).with_material(Material::bark().with_srgb([120, 100, 82])),
        leaves.part(),
        Part::new(&rock).with_material(Material::bark().with_srgb([150, 148, 144])),
    ];
    let paper = [0.97, 0.965, 0.955];
    let preview = Preview::default()
        .with_size(size, size * 5 / 8)
        .with_background(paper, paper)
        .with_ground_height(0.0)
        .with_camera(Camera::default().with_azimuth(0.35).with_elevation(0.38));
    Ok((preview.draw_parts(&parts)?, measured))
}
