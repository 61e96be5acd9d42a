//! The trees of the paper's figures 6, 7, 8, 12, 13 and 14.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::Phyllotaxis::{Alternate, Decussate, Opposite, Spiral, Whorled};
use super::letter::letter;
use super::{GuidanceShape, Level, Phyllotaxis, VariationalSynth};
use crate::radius::{PipeModel, Taper};
use crate::shape::{Cone, CrossProfile, Ellipsoid, Extrusion, HalfEllipsoid, Outline, Sketch, Union};
use crate::{ParameterError, Shape};

/// A tree of one of the figures.
///
/// N, P, n, θ and φ are the paper's where it gives them; crowns, and all of figure 14, are chosen so that the tree shows
/// what its figure shows.
///
/// ```
/// use treesynth::presets;
///
/// let spruce = presets::by_name("variational-14-spruce")?.variational()?;
/// let tree = spruce.synth(500)?.synthesize(spruce.seed)?;
/// assert_eq!(tree.tips().count(), 500);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Preset {
    /// Its name: the figure, two digits, then the tree in it, e.g. `variational-07-n5`.
    pub name: &'static str,
    /// The number of the figure.
    pub figure: u8,
    /// Caption of the tree's picture.
    pub caption: &'static str,
    /// The shape nodes of its picture: table 2 where it has them.
    pub shape_nodes: usize,
    /// The seed of its picture.
    pub seed: u64,
    build: fn(usize) -> Result<VariationalSynth, ParameterError>,
}

impl Preset {
    const fn new(
        name: &'static str,
        figure: u8,
        caption: &'static str,
        build: fn(usize) -> Result<VariationalSynth, ParameterError>,
    ) -> Self {
        Self { name, figure, caption, shape_nodes: 3500, seed: 1, build }
    }

    const fn with_shape_nodes(mut self, count: usize) -> Self {
        self.shape_nodes = count;
        self
    }

    /// The optimization with this number of shape nodes; pass the field [`shape_nodes`](Self::shape_nodes)
    /// for the figure's detail.
    ///
    /// # Errors
    /// Fewer shape nodes than 4, or more than 20,000,000.
    pub fn synth(&self, shape_nodes: usize) -> Result<VariationalSynth, ParameterError> {
        (self.build)(shape_nodes)
    }
}

/// All presets, in the order of the figures.
pub fn presets() -> impl Iterator<Item = &'static Preset> {
    PRESETS.iter()
}

const PRESETS: &[Preset] = &[
    Preset::new("variational-06-front", 6, "A crown sketched from the front, cut off behind.", |count| {
        let behind = CrossProfile::new([1.0, 1.1, 1.2, 1.1, 1.0, 0.6, 0.35, 0.6]);
        let crown = Sketch::new(outline(&WINDSWEPT)).with_profiles([
            CrossProfile::ROUND,
            behind,
            CrossProfile::ROUND,
        ]);
        tree(&crown, count, 0.4, &[axis(6, 0.8, 50.0, Spiral), axis(4, 0.8, 45.0, Spiral), twig(0.8)])
    }),
    Preset::new("variational-06-both", 6, "A crown sketched from the front and from the side.", |count| {
        let crown = Sketch::new(outline(&CLOUDS)).with_side(outline(&SLAB));
        tree(&crown, count, 0.5, &[axis(5, 0.7, 60.0, Spiral), axis(4, 0.8, 50.0, Spiral), twig(0.8)])
    }),
    Preset::new("variational-07-n5", 7, "N = 5.", |count| dome(count, axis(5, 0.8, 45.0, Spiral))),
    Preset::new("variational-07-n7", 7, "N = 7.", |count| dome(count, axis(7, 0.8, 45.0, Spiral))),
    Preset::new("variational-07-n9", 7, "N = 9.", |count| dome(count, axis(9, 0.8, 45.0, Spiral))),
    Preset::new("variational-07-p02", 7, "P = 0.2.", |count| dome(count, axis(5, 0.2, 45.0, Spiral))),
    Preset::new("variational-07-p06", 7, "P = 0.6.", |count| dome(count, axis(5, 0.6, 45.0, Spiral))),
    Preset::new("variational-07-p10", 7, "P = 1.0.", |count| dome(count, axis(5, 1.0, 45.0, Spiral))),
    Preset::new("variational-07-l1", 7, "n = 1.", |count| dome(count, axis(5, 0.8, 45.0, Alternate))),
    Preset::new("variational-07-l2", 7, "n = 2.", |count| dome(count, axis(5, 0.8, 45.0, Decussate))),
    Preset::new("variational-07-l3", 7, "n = 3.", |count| dome(count, axis(5, 0.8, 45.0, Whorled(3)))),
    Preset::new("variational-07-a25", 7, "θ = 25°.", |count| dome(count, axis(5, 0.8, 25.0, Spiral))),
    Preset::new("variational-07-a45", 7, "θ = 45°.", |count| dome(count, axis(5, 0.8, 45.0, Spiral))),
    Preset::new("variational-07-a65", 7, "θ = 65°.", |count| dome(count, axis(5, 0.8, 65.0, Spiral))),
    Preset::new("variational-08-alternate", 8, "Alternate branches.", |count| {
        dome(count, axis(8, 1.0, 55.0, Alternate))
    }),
    Preset::new("variational-08-opposite", 8, "Opposite branches in one plane.", |count| {
        dome(count, axis(8, 1.0, 55.0, Opposite))
    }),
    Preset::new(
        "variational-08-decussate",
        8,
        "Opposite branches, each pair across the one before.",
        |count| dome(count, axis(8, 1.0, 55.0, Decussate)),
    ),
    Preset::new("variational-12-left", 12, "P = 1: apical control in the main stem.", |count| {
        let crown = HalfEllipsoid::new(Vec3::Y * 1.6, Vec3::new(3.0, 8.6, 3.0));
        tree(&crown, count, 0.34, &[axis(8, 1.0, 60.0, Spiral), twig(0.5), twig(0.5)])
    }),
    Preset::new("variational-12-centre", 12, "P = 0.3 and 0.5: apical control is lost early.", |count| {
        let crown = Ellipsoid::new(Vec3::Y * 6.2, Vec3::new(4.4, 3.9, 4.4));
        tree(
            &crown,
            count,
            0.45,
            &[axis(3, 0.3, 45.0, Spiral), axis(3, 0.5, 45.0, Spiral), twig(0.8), twig(0.8)],
        )
    })
    .with_shape_nodes(4144),
    Preset::new(
        "variational-12-right",
        12,
        "P = 0.2, then 1: lost in the stem, kept in the branches.",
        |count| {
            let crown = HalfEllipsoid::new(Vec3::Y * 1.4, Vec3::new(3.6, 6.6, 3.6));
            tree(&crown, count, 0.36, &[axis(5, 0.2, 40.0, Spiral), axis(5, 1.0, 45.0, Spiral)])
        },
    )
    .with_shape_nodes(1792),
    Preset::new("variational-13-g", 13, "G of GRAPHICS.", |count| solid_letter(count, 'G'))
        .with_shape_nodes(5000),
    Preset::new("variational-13-r", 13, "R of GRAPHICS.", |count| solid_letter(count, 'R'))
        .with_shape_nodes(5000),
    Preset::new("variational-13-a", 13, "A of GRAPHICS.", |count| solid_letter(count, 'A'))
        .with_shape_nodes(5000),
    Preset::new("variational-13-p", 13, "P of GRAPHICS.", |count| solid_letter(count, 'P'))
        .with_shape_nodes(5000),
    Preset::new("variational-13-h", 13, "H of GRAPHICS.", |count| solid_letter(count, 'H'))
        .with_shape_nodes(5000),
    Preset::new("variational-13-i", 13, "I of GRAPHICS.", |count| solid_letter(count, 'I'))
        .with_shape_nodes(5000),
    Preset::new("variational-13-c", 13, "C of GRAPHICS.", |count| solid_letter(count, 'C'))
        .with_shape_nodes(5000),
    Preset::new("variational-13-s", 13, "S of GRAPHICS.", |count| solid_letter(count, 'S'))
        .with_shape_nodes(5000),
    Preset::new(
        "variational-14-maple",
        14,
        "A maple: opposite, round, the stem lost half way up.",
        |count| {
            let crown = Ellipsoid::new(Vec3::Y * 6.0, Vec3::new(4.0, 4.0, 4.0));
            tree(
                &crown,
                count,
                0.4,
                &[axis(4, 0.5, 45.0, Decussate), axis(4, 0.8, 45.0, Opposite), twig(0.8)],
            )
        },
    ),
    Preset::new("variational-14-pine", 14, "A Himalayan pine: whorls on a stem to the top.", |count| {
        let crown = Cone::new(Vec3::Y * 2.0, 2.6, 9.5);
        tree(&crown, count, 0.34, &[axis(9, 1.0, 75.0, Whorled(4)), axis(4, 1.0, 50.0, Opposite)])
    }),
    Preset::new("variational-14-ash", 14, "A white ash: opposite, oval, limbs that rise.", |count| {
        let crown = Ellipsoid::new(Vec3::Y * 6.6, Vec3::new(3.0, 4.4, 3.0));
        tree(&crown, count, 0.36, &[axis(5, 0.7, 35.0, Decussate), axis(5, 0.9, 35.0, Decussate), twig(0.9)])
    }),
    Preset::new("variational-14-camphor", 14, "A camphor tree: wide, on a short stem.", |count| {
        let crown = HalfEllipsoid::new(Vec3::Y * 2.4, Vec3::new(5.6, 5.0, 5.6));
        tree(
            &crown,
            count,
            0.7,
            &[axis(3, 0.35, 60.0, Whorled(2)), axis(4, 0.7, 45.0, Spiral), twig(0.8), twig(0.8)],
        )
    }),
    Preset::new("variational-14-oak", 14, "A scarlet oak: spreading limbs at wide angles.", |count| {
        let crown = HalfEllipsoid::new(Vec3::Y * 2.6, Vec3::new(4.2, 6.4, 4.2));
        tree(&crown, count, 0.5, &[axis(6, 0.7, 70.0, Spiral), axis(5, 0.8, 60.0, Spiral), twig(0.7)])
    }),
    Preset::new("variational-14-elm", 14, "A Siberian elm: a vase of limbs at narrow angles.", |count| {
        let top = Ellipsoid::new(Vec3::Y * 7.6, Vec3::new(3.8, 2.6, 3.8));
        let below = Ellipsoid::new(Vec3::Y * 5.0, Vec3::new(1.8, 3.0, 1.8));
        let levels = [axis(3, 0.25, 25.0, Whorled(2)), axis(5, 0.9, 25.0, Alternate), twig(0.9)];
        tree(&Union::new(top, below), count, 0.42, &levels)
    }),
    Preset::new("variational-14-spruce", 14, "A European spruce: a slim cone of level whorls.", |count| {
        let crown = Cone::new(Vec3::Y * 0.8, 2.3, 11.0);
        tree(&crown, count, 0.32, &[axis(12, 1.0, 90.0, Whorled(5)), axis(5, 1.0, 55.0, Opposite)])
    }),
    Preset::new("variational-14-birch", 14, "A birch: slim, a stem to the top, steep branches.", |count| {
        let crown = Ellipsoid::new(Vec3::Y * 6.6, Vec3::new(2.2, 4.8, 2.2));
        tree(&crown, count, 0.24, &[axis(10, 1.0, 35.0, Spiral), axis(4, 1.0, 35.0, Alternate), twig(1.0)])
    }),
    Preset::new("variational-14-boxelder", 14, "A box elder: leaning, uneven, forked low.", |count| {
        let large = Ellipsoid::new(Vec3::new(-0.8, 5.2, 0.2), Vec3::new(3.4, 3.2, 3.2));
        let small = Ellipsoid::new(Vec3::new(2.4, 3.6, -0.4), Vec3::new(2.4, 1.9, 2.2));
        let levels = [axis(3, 0.4, 50.0, Opposite), axis(4, 0.7, 45.0, Decussate), twig(0.7)];
        tree(&Union::new(large, small), count, 0.42, &levels)
    }),
];

/// N, P, θ in degrees, n and φ.
fn axis(metamers: u32, apical_control: f32, degrees: f32, phyllotaxis: Phyllotaxis) -> Level {
    Level::default()
        .with_metamers(metamers)
        .with_apical_control(apical_control)
        .with_angle(degrees / 180.0 * PI)
        .with_phyllotaxis(phyllotaxis)
}

/// The last level of most trees.
fn twig(apical_control: f32) -> Level {
    axis(4, apical_control, 40.0, Spiral)
}

/// Silhouettes, metres, drawn by hand.
const WINDSWEPT: [(f32, f32); 10] = [
    (0.2, 2.2),
    (2.0, 2.6),
    (4.6, 4.0),
    (5.4, 5.6),
    (4.0, 6.8),
    (2.2, 8.2),
    (0.2, 8.6),
    (-1.6, 7.2),
    (-2.2, 5.2),
    (-1.4, 3.0),
];
const CLOUDS: [(f32, f32); 14] = [
    (0.0, 2.6),
    (1.6, 3.0),
    (3.6, 3.2),
    (4.2, 4.4),
    (3.0, 5.4),
    (1.8, 5.9),
    (2.8, 6.8),
    (2.4, 8.2),
    (0.6, 8.9),
    (-1.4, 8.4),
    (-1.9, 7.0),
    (-1.6, 6.0),
    (-3.4, 5.0),
    (-2.6, 3.2),
];
const SLAB: [(f32, f32); 6] = [(0.0, 2.4), (1.6, 3.6), (1.8, 6.0), (0.8, 9.0), (-0.8, 9.0), (-1.6, 5.0)];

fn outline(points: &[(f32, f32)]) -> Outline {
    Outline::smooth(points.iter().map(|&point| Vec2::from(point)).collect::<Vec<_>>())
}

/// A letter on a trunk of its own, under a leg of the letter if it has one: from the middle, thick wood would
/// cross its gaps.
fn solid_letter(count: usize, of: char) -> Result<VariationalSynth, ParameterError> {
    let solid = Extrusion::new(letter(of, 1.6), 1.2);
    let under = match of {
        'A' | 'R' => 1.9,
        'C' | 'P' => -1.9,
        'G' => -1.5,
        'S' => 1.5,
        _ => 0.0,
    };
    // The trunk of an S has more bends.
    let trunk = if of == 'S' { 9 } else { 6 };
    let levels =
        [axis(trunk, 0.9, 45.0, Spiral), axis(6, 1.0, 45.0, Spiral), axis(4, 1.0, 40.0, Spiral), twig(1.0)];
    let price = if of == 'S' { 8.0 } else { 4.0 };
    Ok(tree(&solid, count, 0.26, &levels)?.with_root(Vec3::X * under).with_outside_price(price))
}

/// The shape of figure 7, the same for all of its trees.
fn dome(count: usize, trunk: Level) -> Result<VariationalSynth, ParameterError> {
    let crown = HalfEllipsoid::new(Vec3::Y * 2.5, Vec3::new(3.4, 7.0, 3.4));
    tree(&crown, count, 0.36, &[trunk, axis(4, 0.8, 45.0, Spiral), twig(0.8), twig(0.8)])
}

/// Half of the shape nodes on the crown's surface, half in it; the trunk base has the diameter `base`,
/// metres.
fn tree(
    crown: &dyn Shape,
    count: usize,
    base: f32,
    levels: &[Level],
) -> Result<VariationalSynth, ParameterError> {
    let shape = GuidanceShape::on_surface(crown, count / 2, 1)?.joined(&GuidanceShape::in_volume(
        crown,
        count - count / 2,
        1,
    )?);
    let radius = Taper::new(PipeModel::default().with_trunk_diameter(base));
    Ok(VariationalSynth::new(shape).with_levels(levels).with_radius(radius))
}
