//! Limbs drawn by the user (section 5).

mod joined;
mod stroke;

pub use stroke::{Canvas, Stroke};

use crate::parameter::ParameterError;
use crate::skeleton::Skeleton;
use glam::Vec3;
use joined::Joined;
use std::f32::consts::{FRAC_PI_2, PI};

/// Strokes that become one tree: the first is the trunk, and each further one a limb of what is drawn before it.
///
/// A stroke starts at the nearest place of the drawing so far, in the middle of an internode if need be; a stroke on a
/// [`Canvas`] at the place that is nearest as the viewer sees it. If it starts farther away, a connecting piece
/// leaves the parent branch further down at a natural [angle](Self::with_angle) and runs smoothly into the stroke.
///
/// All points of the strokes are nodes of the tree. [`PoissonYao::with_tree`](super::PoissonYao::with_tree) puts it into
/// a graph, and stages of twigs clothe it.
///
/// ```
/// use treesynth::glam::{Vec2, Vec3};
/// use treesynth::guided::{Bend, Canvas, DrawnLimbs, ForkAngle, LimbSurface, PoissonYao, Stage, Stroke, TreeSynth};
/// use treesynth::shape::Cuboid;
///
/// let at = |points: &[[f32; 2]]| -> Vec<Vec2> { points.iter().map(|&p| Vec2::from(p)).collect() };
/// let stroke = |points: &[[f32; 2]]| Stroke::on(Canvas::front(), at(points)).smoothed();
/// let drawn = DrawnLimbs::new(stroke(&[[0.0, 0.0], [0.1, 1.5], [0.0, 3.0]]).with_diameters(0.2, 0.05))
///     .with_stroke(stroke(&[[0.1, 1.4], [0.8, 1.9], [1.6, 1.8]]))
///     .with_stroke(stroke(&[[-0.3, 2.2], [-1.0, 2.6], [-1.5, 3.4]]))
///     .with_depth(0.5);
/// let limbs = drawn.skeleton()?;
/// assert_eq!(limbs.tips().count(), 3);
///
/// let region = Cuboid::new(Vec3::new(-2.5, 0.0, -2.0), Vec3::new(2.5, 4.5, 2.0));
/// let twigs = ForkAngle::new(0.8, Bend::none());
/// let tree = TreeSynth::new(PoissonYao::new(region).with_spacing(0.15).with_tree(limbs))
///     .stage(Stage::new(twigs, LimbSurface::new(3, 0.3).with_least_order(1)))
///     .synthesize(1)?;
/// assert!(tree.tips().count() > 10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct DrawnLimbs {
    strokes: Vec<Stroke>,
    angle: f32,
    depth: f32,
    detail: Option<f32>,
}

crate::recipe::readable!(DrawnLimbs { angle: f32, depth: f32, detail: Option<f32> });

/// Parts of the longest stroke, unless the detail is given.
const PARTS: f32 = 64.0;
/// The most nodes of a drawing.
const MAX_NODES: f32 = 1e6;

impl DrawnLimbs {
    /// The trunk alone. Connecting pieces leave at 50°, flat drawings stay flat, and the longest stroke has 64 parts.
    pub fn new(trunk: Stroke) -> Self {
        Self { strokes: vec![trunk], angle: 50f32.to_radians(), depth: 0.0, detail: None }
    }

    /// The first stroke is the trunk; at least one.
    pub fn from_strokes(strokes: impl Into<Vec<Stroke>>) -> Self {
        Self { strokes: strokes.into(), ..Self::new(Stroke::new([])) }
    }

    /// One more limb.
    pub fn with_stroke(mut self, stroke: Stroke) -> Self {
        self.strokes.push(stroke);
        self
    }

    /// The angle, radians, in (0, π/2], between a parent branch and a piece that connects it to a stroke drawn away from
    /// it; larger where the parent branch does not reach far enough down.
    pub fn with_angle(mut self, angle: f32) -> Self {
        self.angle = angle;
        self
    }

    /// Has limbs drawn on a [`Canvas`] leave its plane, up to `angle` radians in [0, 1.4] towards the viewer and away in
    /// turn. Seen from there they stay where they are drawn. 0 leaves a flat drawing flat.
    pub fn with_depth(mut self, angle: f32) -> Self {
        self.depth = angle;
        self
    }

    /// The longest internode, metres, above 0; longer ways between points are divided. A drawing has at most a million
    /// nodes.
    pub fn with_detail(mut self, metres: f32) -> Self {
        self.detail = Some(metres);
        self
    }

    /// The strokes.
    pub fn strokes(&self) -> &[Stroke] {
        &self.strokes
    }

    /// The tree. Each stroke is a branch, or goes on with one whose tip it starts from. Its stages are the orders of its
    /// branches, and its radii those of the strokes, 0 where none are given. O(s n) for s strokes and n nodes.
    ///
    /// # Errors
    /// An option out of range; a stroke of less than two points, with one that is not finite, or with one where
    /// the tree has a node already.
    pub fn skeleton(&self) -> Result<Skeleton, ParameterError> {
        ParameterError::unless(!self.strokes.is_empty(), "DrawnLimbs.strokes", 0, "at least one stroke")?;
        let fits = self.angle > 0.0 && self.angle <= FRAC_PI_2;
        ParameterError::unless(fits, "DrawnLimbs.angle", self.angle, "in (0, π/2] radians")?;
        let fits = (0.0..=1.4).contains(&self.depth);
        ParameterError::unless(fits, "DrawnLimbs.depth", self.depth, "in [0, 1.4] radians")?;
        let name = |number: usize| format!("DrawnLimbs.strokes[{number}]");
        let strokes: Vec<Vec<Vec3>> = (self.strokes.iter().enumerate())
            .map(|(number, stroke)| stroke.points(&name(number)))
            .collect::<Result<_, _>>()?;
        let length =
            |points: &Vec<Vec3>| points.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f32>();
        let lengths: Vec<f32> = strokes.iter().map(length).collect();
        let detail = self.detail.unwrap_or(lengths.iter().copied().fold(0.0, f32::max) / PARTS);
        // Connecting pieces are no longer than the drawing is wide.
        let all = strokes.iter().flatten();
        let (low, high) =
            all.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
        let most = lengths.iter().sum::<f32>() + high.distance(low) * lengths.len() as f32 * PI;
        let fits = detail > 0.0 && most / detail <= MAX_NODES;
        ParameterError::unless(fits, "DrawnLimbs.detail", detail, "above 0 m, for at most 1000000 nodes")?;
        let mut joined = Joined::new(detail, self.angle, self.depth);
        for (number, (stroke, points)) in self.strokes.iter().zip(&strokes).enumerate() {
            joined.add(stroke, &stroke.course(points, detail), &name(number))?;
        }
        joined.skeleton()
    }
}
