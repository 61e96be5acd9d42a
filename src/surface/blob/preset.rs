//! The situations of figures 4 to 7 of Galbraith, Mündermann and Wyvill 2004.

use super::skin::smooth;
use super::{BARK, BlobError, BlobTree, BlobTreeBuilder, Bounded, FieldFunction, Operator, Primitive, Skin};
use crate::{Bounds, Skeleton, SkeletonError};
use glam::Vec3;

/// One picture of a figure.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct BlobPreset {
    /// E.g. `blob-07-04`.
    pub name: &'static str,
    /// The figure's number in the paper.
    pub figure: u8,
    /// One line that says what is seen.
    pub caption: &'static str,
    /// Box that a picture of it shows, metres.
    pub view: Bounds,
    scene: Scene,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Scene {
    /// Two lines under one operator.
    Lines(Operator),
    /// Two lines under both, with a colour where they meet.
    Bounded(Option<[f32; 3]>),
    /// A fork of this age, years.
    Fork(f32),
}

/// The green of figure 6.
const GREEN: [f32; 3] = [0.02, 0.35, 0.04];
/// Nearly black.
const BLACK: [f32; 3] = [0.012, 0.01, 0.008];
/// The two lines, all of them.
const LINES: Bounds = Bounds::new(Vec3::new(-0.4, -0.6, -0.2), Vec3::new(0.8, 0.75, 0.2));
/// The fork and its scars.
const FORK: Bounds = Bounds::new(Vec3::new(-0.07, 0.27, -0.03), Vec3::new(0.12, 0.46, 0.03));

/// All presets, in the order of the figures.
pub fn presets() -> impl Iterator<Item = BlobPreset> {
    let of = |name, figure, caption, view, scene| BlobPreset { name, figure, caption, view, scene };
    [
        of("blob-04-contact", 4, "two lines, B1: precise contact", LINES, Scene::Lines(Operator::contact())),
        of("blob-04-blend", 4, "two lines, B2: the sum", LINES, Scene::Lines(Operator::Sum)),
        of("blob-05", 5, "contact within a bounding field, the sum outside", LINES, Scene::Bounded(None)),
        of("blob-06-example", 6, "the colour of the bounding field", LINES, Scene::Bounded(Some(GREEN))),
        of("blob-06-ridge", 6, "a blackened branch bark ridge", LINES, Scene::Bounded(Some(BLACK))),
        of("blob-07-01", 7, "scars and ridge after 1 year", FORK, Scene::Fork(1.0)),
        of("blob-07-04", 7, "after 4 years", FORK, Scene::Fork(4.0)),
        of("blob-07-07", 7, "after 7 years", FORK, Scene::Fork(7.0)),
        of("blob-07-10", 7, "after 10 years", FORK, Scene::Fork(10.0)),
    ]
    .into_iter()
}

/// The preset of that name.
pub fn by_name(name: &str) -> Option<BlobPreset> {
    presets().find(|preset| preset.name == name)
}

impl BlobPreset {
    /// Content of the picture.
    ///
    /// # Errors
    /// None is known.
    pub fn blob_tree(&self) -> Result<BlobTree, BlobError> {
        match self.scene {
            Scene::Lines(operator) => {
                let mut builder = BlobTreeBuilder::default();
                let lines = lines(&mut builder)?;
                let root = builder.combine(operator, lines)?;
                builder.finish(root)
            }
            Scene::Bounded(color) => {
                let mut builder = BlobTreeBuilder::default();
                let lines = lines(&mut builder)?;
                let axil = Primitive::point(Vec3::new(0.36, 0.36, 0.0), 0.62);
                let field = builder.add(axil.with_field(FieldFunction::Bounding { inner: 0.4 }))?;
                let style = Bounded::default();
                let root =
                    builder.bounded(lines, color.map_or(style, |color| style.with_color(color)), field)?;
                builder.finish(root)
            }
            Scene::Fork(years) => match fork(years) {
                Ok(fork) => Skin::default().with_age(years + 1.0).blob_tree(&fork),
                Err(_) => Err(BlobError::Empty { most: 0.0 }),
            },
        }
    }
}

fn lines(builder: &mut BlobTreeBuilder) -> Result<[super::Node; 2], BlobError> {
    let [from, to] = [Vec3::new(0.0, -2.0, 0.0), Vec3::new(0.0, 2.0, 0.0)];
    let stem = builder.add(Primitive::line(from, to, 0.22).with_color(BARK))?;
    // It does not begin on the stem's axis, since it would be felt on the far side then.
    let lateral = Primitive::line(Vec3::new(0.06, -0.24, 0.0), Vec3::new(2.0, 1.7, 0.0), 0.17);
    Ok([stem, builder.add(lateral.with_color(BARK))?])
}

/// The fork of figure 7, after `years` from the second shoot on: a shoot of two years that goes on and bears one lateral, near
/// its end. Ages are of the [`Skin`]; it has been one more year from the first shoot on.
///
/// # Errors
/// Years that are negative or not finite, for then radii are.
pub fn fork(years: f32) -> Result<Skeleton, SkeletonError> {
    const STEP: f32 = 0.02;
    const FIRST: f32 = 0.2;
    /// End of the first shoot, where the lateral springs.
    const END: usize = 8;
    const LATERAL: u32 = 7;
    const NODES: usize = 21;
    if !(years >= 0.0 && years.is_finite()) {
        return Err(SkeletonError::Radius { node: 0, radius: years });
    }
    // All thickens year by year; a shoot is a year's ring thinner than the one that bore it.
    let thick = |years: f32| 0.003 + 0.0036 * years;
    let (mut positions, mut parents, mut radii, mut stages) = (vec![], vec![], vec![], vec![]);
    for i in 0..NODES {
        // The first internode is long, so that pictures do not show the end.
        let along = if i == 0 { 0.0 } else { FIRST + i as f32 * STEP };
        positions.push(Vec3::new(0.0, along, 0.0));
        parents.push(i.checked_sub(1).map(|parent| parent as u32));
        // The year's ring ends gently, over some steps around the junction.
        let younger = smooth((i as f32 - END as f32 + 6.0) / 12.0);
        radii.push(thick(years + 0.6 - 0.6 * younger) * (1.0 - 0.08 * younger));
        stages.push(u16::from(i > END));
    }
    let springs = positions[LATERAL as usize];
    for i in 1..=12 {
        let out = i as f32 * STEP;
        positions.push(springs + Vec3::new(0.68 * out, 0.72 * out + 0.4 * out * out, 0.1 * out));
        parents.push(Some(if i == 1 { LATERAL } else { positions.len() as u32 - 2 }));
        radii.push(0.62 * thick(years) * (1.0 - 0.01 * i as f32));
        stages.push(1);
    }
    Skeleton::new(positions, parents)?.with_radii(radii)?.with_stages(stages)
}
