//! Habits of trees that organize themselves, after eighteen seasons in the open.

use super::common::Failure;
use super::{Draw, PAPER, labelled};
use treesynth::glam::Vec3;
use treesynth::preview::{Camera, Picture, Preview};
use treesynth::self_organizing::{Forest, Habit, Phyllotaxis, Sag, ShadowPropagation, Shedding, VigorModel};
use treesynth::shape::Bounds;
use treesynth::surface::Tubes;

pub(crate) const STRIPS: &[(&str, Draw)] = &[
    ("apical-control", |size| {
        over(&[0.42, 0.46, 0.5, 0.54, 0.58], size, |control| {
            habit().with_vigor_model(VigorModel::BorchertHonda { apical_control: control })
        })
    }),
    ("vigor-multiplier", |size| {
        over(&[1.0, 1.5, 2.0, 2.5, 3.0], size, |factor| habit().with_vigor_multiplier(factor))
    }),
    ("lateral-angle", |size| {
        over(&[20.0, 35.0, 50.0, 65.0, 85.0], size, |angle| habit().with_lateral_angle(angle.to_radians()))
    }),
    ("divergence", |size| {
        over(&[72.0, 90.0, 120.0, 137.5, 180.0], size, |angle| {
            habit().with_phyllotaxis(Phyllotaxis::Spiral { divergence: f32::to_radians(angle) })
        })
    }),
    ("whorl", |size| {
        over(&[1.0, 2.0, 3.0, 4.0, 5.0], size, |count| {
            habit().with_phyllotaxis(Phyllotaxis::Whorled { count: count as u8 })
        })
    }),
    ("optimal-weight", |size| {
        over(&[0.0, 0.1, 0.2, 0.4, 0.8], size, |weight| habit().with_optimal_weight(weight))
    }),
    ("default-weight", |size| {
        over(&[0.2, 0.5, 1.0, 2.0, 4.0], size, |weight| habit().with_default_weight(weight))
    }),
    ("tropism", |size| {
        over(&[-0.3, -0.15, 0.0, 0.15, 0.3], size, |weight| habit().with_tropism(Vec3::Y, weight))
    }),
    ("shedding", |size| {
        over(&[0.0, 0.15, 0.3, 0.6, 0.9], size, |multiplier| {
            habit().with_shedding(Shedding::default().with_multiplier(multiplier))
        })
    }),
    ("width-exponent", |size| {
        over(&[1.8, 2.1, 2.5, 2.8, 3.2], size, |exponent| habit().with_width_exponent(exponent))
    }),
    ("sag", |size| {
        // Pascals, from rubber to wood.
        over(&[1e8, 3e8, 1e9, 3e9, 1e10], size, |modulus| {
            habit().with_sag(Sag::default().with_modulus(modulus))
        })
    }),
];

/// Metres of a metamer.
const LENGTH: f32 = 0.1;

fn habit() -> Habit {
    Habit::default().with_length(LENGTH).with_tip_radius(0.0025)
}

/// A tree for each value, all at one scale.
fn over(values: &[f32], size: u32, habit: impl Fn(f32) -> Habit) -> Result<Vec<Picture>, Failure> {
    let bounds = Bounds::new(Vec3::new(-10.0, 0.0, -10.0), Vec3::new(10.0, 14.0, 10.0));
    let mut meshes = Vec::new();
    for &value in values {
        let mut forest = Forest::new(ShadowPropagation::new(bounds).with_cell(LENGTH), habit(value), 3);
        forest.plant(Vec3::ZERO)?;
        forest.grow(16)?;
        meshes.push(Tubes::default().with_sides(6).mesh(&forest.skeletons()?[0])?);
    }
    let frame = meshes.iter().filter_map(treesynth::surface::Mesh::bounds).reduce(Bounds::union);
    let camera = Camera::default().with_frame(frame.unwrap_or(bounds));
    let preview = Preview::default().with_size(size, size).with_background(PAPER, PAPER).with_camera(camera);
    let label = |value: f32| if value >= 1e6 { format!("{value:e}") } else { value.to_string() };
    let drawn =
        meshes.iter().zip(values).map(|(mesh, &value)| Ok(labelled(preview.draw(mesh)?, &label(value))));
    drawn.collect()
}
