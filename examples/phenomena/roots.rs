//! A root system: a tap root, laterals that run out level and then down, fine roots; in soil with stones and hard clay.

use super::solid::{self, quad};
use treesynth::field::Uniform;
use treesynth::glam::Vec3;
use treesynth::guided::{
    Bend, Blend, Count, FollowField, Guided, HopSurface, InShape, NearestTo, PoissonYao, SourceElevation,
    Stage, TreeSynth, Within,
};
use treesynth::preview::{Camera, Picture, Preview};
use treesynth::radius::{PipeModel, Taper};
use treesynth::shape::{Cuboid, Ellipsoid, Sphere, Union};
use treesynth::surface::{Material, Mesh, Part, Tubes};
use treesynth::{Skeleton, WeightFn};

type Failure = Box<dyn std::error::Error>;

/// The soil's half width and depth, metres; below [`CLAY`] it is hard.
const HALF: f32 = 2.4;
const DEPTH: f32 = 2.2;
const CLAY: f32 = -1.5;

pub(crate) const STONES: [(Vec3, f32); 3] = [
    (Vec3::new(0.9, -0.75, 0.7), 0.42),
    (Vec3::new(-1.1, -0.55, 0.3), 0.34),
    (Vec3::new(0.1, -0.9, -1.2), 0.45),
];

/// Stones forbid, the topsoil is easier and clay harder to grow in.
fn soil() -> impl WeightFn + Clone {
    let slab = |low, high| Cuboid::new(Vec3::new(-9.0, low, -9.0), Vec3::new(9.0, high, 9.0));
    let [a, b, c] = STONES.map(|(center, radius)| Sphere::new(center, radius));
    let layers = Within::new(Within::new(Guided, slab(-0.4, 0.0), 0.6), slab(-9.0, CLAY), 4.0);
    Within::obstacle(layers, Union::new(a, Union::new(b, c)))
}

pub(crate) fn roots(nodes: usize) -> TreeSynth {
    let region = Cuboid::new(Vec3::new(-HALF, -DEPTH, -HALF), Vec3::new(HALF, 0.0, HALF));
    let down = || FollowField::new(Uniform::new(Vec3::NEG_Y));
    let degrees = f32::to_radians;
    // Laterals near the surface start level, deep ones steeply; all turn down a little at every node.
    let lateral = |pull| {
        let rule = Blend::new(Bend::none(), down(), pull);
        SourceElevation::new(rule, [degrees(150.0), degrees(97.0)], [-1.2, -0.1])
    };
    let spread = Ellipsoid::new(Vec3::ZERO, Vec3::new(2.2, 1.5, 2.2));
    let fine = |hops, count, pull| {
        Stage::new(lateral(pull), HopSurface::new(hops, Count::UpTo(count)).with_outermost(0.85))
            .with_weight(soil())
    };
    TreeSynth::new(PoissonYao::new(region).with_nodes(nodes))
        .stage(Stage::new(down(), NearestTo::new(Vec3::new(0.1, -1.45, 0.0))).with_weight(soil()))
        .stage(Stage::new(lateral(0.03), InShape::poisson_disc(spread, Count::UpTo(70))).with_weight(soil()))
        .stage(fine(3, 500, 0.06))
        .stage(fine(2, 2_500, 0.1))
        .with_radius(Taper::new(PipeModel::default().with_exponent(2.3).with_trunk_diameter(0.34)))
}

/// The share of the roots' length above a depth, metres below the ground.
pub(crate) fn share_above(tree: &Skeleton, depth: f32) -> f32 {
    let (mut above, mut all) = (0.0, 0.0);
    for (node, parent) in tree.edges() {
        let (from, to) = (tree.positions()[parent], tree.positions()[node]);
        all += from.distance(to);
        above += if (from.y + to.y) * 0.5 > -depth { from.distance(to) } else { 0.0 };
    }
    above / all
}

/// The far sides and the bottom of the soil, darker above, redder below.
fn pit() -> Mesh {
    let mut mesh = Mesh::default();
    let shade = |y: f32| {
        if y > -0.4 {
            [0.055, 0.036, 0.024]
        } else if y > CLAY {
            [0.15, 0.1, 0.065]
        } else {
            [0.19, 0.1, 0.062]
        }
    };
    for (low, high) in [(-0.4, 0.0), (CLAY, -0.4), (-DEPTH, CLAY)] {
        let color = [shade((low + high) * 0.5); 4];
        let at = Vec3::new;
        let back =
            [at(-HALF, low, -HALF), at(HALF, low, -HALF), at(HALF, high, -HALF), at(-HALF, high, -HALF)];
        let side =
            [at(-HALF, low, HALF), at(-HALF, low, -HALF), at(-HALF, high, -HALF), at(-HALF, high, HALF)];
        quad(&mut mesh, back, color);
        quad(&mut mesh, side, color);
    }
    let y = -DEPTH;
    let at = |x: f32, z: f32| Vec3::new(x * HALF, y, z * HALF);
    quad(&mut mesh, [at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0), at(-1.0, -1.0)], [shade(y); 4]);
    mesh
}

pub(crate) fn draw(nodes: usize, seed: u64, size: u32) -> Result<(Picture, String), Failure> {
    let tree = roots(nodes).synthesize(seed)?;
    let measured = format!(
        "{} tips, {:.0}% of the length in the upper half metre",
        tree.tips().count(),
        100.0 * share_above(&tree, 0.5)
    );
    let mesh = Tubes::default().mesh(&tree.relaxed(0.5, 3)?)?;
    // A stump stands above.
    let foot = tree.radii()[0];
    let stump =
        Skeleton::new(vec![Vec3::Y * -0.05, Vec3::Y * 0.12, Vec3::Y * 0.45], vec![None, Some(0), Some(1)])?
            .with_radii(vec![foot * 1.15, foot, foot * 0.85])?;
    let stump = Tubes::default().mesh(&stump)?;
    let stones = STONES.map(|(center, radius)| solid::ball(center, radius * 0.97, 48, 24));
    let pit = pit();
    let wood = Material::bark().with_srgb([176, 142, 104]);
    let mut parts = vec![
        Part::new(&mesh).with_material(wood),
        Part::new(&stump).with_material(Material::bark().with_srgb([112, 94, 76])),
        Part::new(&pit).with_material(Material::white().with_double_sided(true)),
    ];
    parts.extend(
        stones
            .iter()
            .map(|stone| Part::new(stone).with_material(Material::bark().with_srgb([112, 112, 110]))),
    );
    let paper = [0.97, 0.965, 0.955];
    let preview = Preview::default()
        .with_size(size, size * 5 / 8)
        .with_background(paper, paper)
        .with_ground(false)
        .with_sun(Vec3::new(0.5, 0.9, 0.8))
        .with_camera(Camera::default().with_azimuth(0.55).with_elevation(0.22));
    Ok((preview.draw_parts(&parts)?, measured))
}
