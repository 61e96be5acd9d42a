//! Measurements on an example.

use super::axis::{Axis, frame};
use crate::guided::curve::Line;
use crate::guided::graph::Leader;
use crate::math::{UP, ln};
use crate::metrics::branch_angles;
use crate::skeleton::Skeleton;
use glam::Vec3;

/// A lateral of a branch.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lateral {
    /// Position of its base along its parent branch, as a share of that one's length.
    pub(super) share: f32,
    /// From its base to its tip, metres: along the parent branch, up and sideways; of the trunk's laterals in the
    /// world's axes.
    pub(super) chord: Vec3,
}

/// A branch of the example with its laterals, from its base on.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Model {
    pub(super) length: f32,
    pub(super) laterals: Vec<Lateral>,
}

/// Traits of the branches of one order.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct OrderTraits {
    /// Number present.
    pub count: usize,
    /// Mean length along them, metres.
    pub length: f32,
    /// Standard deviation of the length, metres.
    pub length_spread: f32,
    /// Mean angle to their parent branches at the first internode, radians; 0 for the trunk.
    pub angle: f32,
    /// Its standard deviation, radians.
    pub angle_spread: f32,
    /// Change of their tilt along the way, radians per metre, the mean weighted by length: above 0 they turn
    /// down.
    pub bend: f32,
    /// Metres of parent branches, bare bases not counted, for one of them; 0 for the trunk.
    pub spacing: f32,
    /// Mean share of the parent branches below the first of them, among those that have any; 0 for the trunk.
    pub bare_base: f32,
}

/// The branches of each order as models, the shortest first.
pub(super) fn models(skeleton: &Skeleton) -> Vec<Vec<Model>> {
    let branches = skeleton.branches();
    let axes: Vec<(u16, Axis)> =
        branches.iter().map(|branch| (branch.order(), Axis::of(skeleton, &branch))).collect();
    let mut home = vec![(0usize, 0usize); skeleton.len()];
    for (number, (order, axis)) in axes.iter().enumerate() {
        for (place, &node) in axis.nodes.iter().enumerate().skip(usize::from(*order > 0)) {
            home[node as usize] = (number, place);
        }
    }
    let mut all: Vec<Model> =
        axes.iter().map(|(_, axis)| Model { length: axis.length(), laterals: Vec::new() }).collect();
    for (_, axis) in axes.iter().skip(1) {
        let (parent, place) = home[axis.nodes[0] as usize];
        let (order, bearer) = &axes[parent];
        let chord = axis.chord();
        let chord = if *order == 0 {
            chord
        } else {
            Vec3::from_array(frame(bearer.direction(place)).map(|way| chord.dot(way)))
        };
        let share = bearer.line.ways[place] / bearer.length().max(f32::MIN_POSITIVE);
        all[parent].laterals.push(Lateral { share, chord });
    }
    let orders = axes.iter().map(|(order, _)| usize::from(*order) + 1).max().unwrap_or(1);
    let mut models = vec![Vec::new(); orders];
    for ((order, _), mut model) in axes.iter().zip(all) {
        model.laterals.sort_by(|a, b| a.share.total_cmp(&b.share));
        models[usize::from(*order)].push(model);
    }
    for models in &mut models {
        models.sort_by(|a, b| a.length.total_cmp(&b.length));
    }
    models
}

/// Indexed by order.
pub(super) fn traits(skeleton: &Skeleton, models: &[Vec<Model>]) -> Vec<OrderTraits> {
    // A reach of 0 is always in range.
    let angles = branch_angles(skeleton, 0.0).unwrap_or_default();
    let mut bends = vec![[0.0f32; 2]; models.len()];
    for branch in skeleton.branches().iter() {
        let axis = Axis::of(skeleton, &branch);
        let sums = &mut bends[usize::from(branch.order())];
        *sums = [sums[0] + axis.bend() * axis.length(), sums[1] + axis.length()];
    }
    let of = |order: usize| {
        let lengths: Vec<f32> = models[order].iter().map(|model| model.length).collect();
        let own: Vec<f32> = angles
            .iter()
            .filter(|angle| usize::from(angle.order) == order)
            .map(|angle| angle.angle)
            .collect();
        let (length, length_spread) = mean_and_spread(&lengths);
        let (angle, angle_spread) = mean_and_spread(&own);
        let (mut spacing, mut bare_base) = (0.0, 0.0);
        if order > 0 {
            let parents =
                models[order - 1].iter().filter_map(|parent| Some((parent, parent.laterals.first()?)));
            let bare: Vec<f32> = parents.clone().map(|(_, first)| first.share).collect();
            let clothed: f32 = parents.map(|(parent, first)| parent.length * (1.0 - first.share)).sum();
            spacing = clothed / lengths.len().max(1) as f32;
            bare_base = mean_and_spread(&bare).0;
        }
        let [sum, weight] = bends[order];
        let bend = if weight > 0.0 { sum / weight } else { 0.0 };
        let count = lengths.len();
        OrderTraits { count, length, length_spread, angle, angle_spread, bend, spacing, bare_base }
    };
    (0..models.len()).map(of).collect()
}

fn mean_and_spread(values: &[f32]) -> (f32, f32) {
    let count = values.len().max(1) as f32;
    let mean = values.iter().sum::<f32>() / count;
    (mean, (values.iter().map(|value| (value - mean) * (value - mean)).sum::<f32>() / count).sqrt())
}

/// Mean and standard deviation of the angles between branches of some order and the chords of their laterals, radians.
pub(super) fn chord_angles(models: &[Model], order: usize) -> [f32; 2] {
    // The trunk's laterals are in the world's axes.
    let axis = if order == 0 { UP } else { Vec3::X };
    let chords = models.iter().flat_map(|model| &model.laterals).map(|lateral| lateral.chord);
    let angles: Vec<f32> = chords.map(|chord| crate::math::angle_between(chord, axis)).collect();
    let (mean, spread) = mean_and_spread(&angles);
    [mean, spread]
}

/// Reach of a crown at each height, from the trunk base.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Crown {
    /// `false` if fewer limbs than layers say how far it reaches.
    is_known: bool,
    pub(super) base: Vec3,
    pub(super) low: f32,
    pub(super) high: f32,
    radii: [f32; Self::LAYERS],
}

impl Crown {
    const LAYERS: usize = 16;

    /// The crown of a tree with so many limbs.
    pub(super) fn of(skeleton: &Skeleton, limbs: usize) -> Self {
        let base = skeleton.positions()[0];
        let heights = || skeleton.positions().iter().map(|point| point.y - base.y);
        let low = heights().fold(0.0, f32::min);
        let high = heights().fold(0.0, f32::max).max(low + 1e-3);
        let mut crown = Self { is_known: limbs >= Self::LAYERS, base, low, high, radii: [0.0; Self::LAYERS] };
        for &point in skeleton.positions() {
            let (layer, radius) = (crown.layer(point), crown.radius(point));
            crown.radii[layer] = crown.radii[layer].max(radius);
        }
        crown
    }

    fn layer(&self, point: Vec3) -> usize {
        let share = (point.y - self.base.y - self.low) / (self.high - self.low);
        ((share * Self::LAYERS as f32) as usize).min(Self::LAYERS - 1)
    }

    fn radius(&self, point: Vec3) -> f32 {
        (point - self.base).with_y(0.0).length()
    }

    pub(super) fn widest(&self) -> f32 {
        self.radii.iter().copied().fold(0.0, f32::max)
    }

    pub(super) fn scaled(&self, wide: f32, high: f32) -> Self {
        let radii = self.radii.map(|radius| radius * wide);
        Self { radii, low: self.low * high, high: self.high * high, ..*self }
    }

    /// `true` if branches may end there.
    pub(super) fn contains(&self, point: Vec3) -> bool {
        let height = point.y - self.base.y;
        let is_level = height >= self.low && height <= self.high;
        !self.is_known || is_level && self.radius(point) <= self.radii[self.layer(point)]
    }
}

/// The trunk of an example.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TrunkTraits {
    /// From its base to its top, metres.
    pub chord: Vec3,
    /// From its base to where one to seven eighths of its way are done, metres: how it leans, and turns aside where its axis
    /// goes on in a limb.
    pub form: [Vec3; 7],
    /// [Waywardness](crate::guided::Leader::with_waywardness) of trunks of its kind about that form, at most 0.5.
    pub waywardness: f32,
    /// Metres of trunk below the first branch.
    pub clear_bole: f32,
    /// Diameter at the base, metres; 0 where the example has no thickness.
    pub diameter: f32,
}

impl TrunkTraits {
    pub(super) fn of(skeleton: &Skeleton, models: &[Vec<Model>]) -> Self {
        let Some(axis) = skeleton.branches().iter().next().map(|trunk| Axis::of(skeleton, &trunk)) else {
            return Self {
                chord: UP,
                form: FORM.map(|share| UP * share),
                waywardness: 0.0,
                clear_bole: 0.0,
                diameter: 0.0,
            };
        };
        let trunk = &models[0][0];
        let mut traits = Self {
            chord: axis.chord(),
            form: FORM.map(|share| axis.line.at(share) - axis.line.points[0]),
            waywardness: 0.0,
            clear_bole: trunk.laterals.first().map_or(1.0, |lateral| lateral.share) * trunk.length,
            diameter: base_radius(skeleton) * 2.0,
        };
        let line = traits.leader(axis.line.points[0], 1.0).line();
        traits.waywardness = waywardness(&axis.line.points, &line);
        traits
    }

    /// A trunk of its kind, so many times as high.
    pub(super) fn leader(&self, base: Vec3, high: f32) -> Leader {
        let at = |way: Vec3| base + way * Vec3::new(1.0, high, 1.0);
        Leader::new(base, at(self.chord)).with_points(self.form.map(at)).with_waywardness(self.waywardness)
    }
}

/// Shares of its way at which the form of a trunk is taken.
const FORM: [f32; 7] = [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875];

/// Waywardness of waves that a trunk of this form may have beside: as much as its axis strays from it in half of its eighths, since an
/// axis that goes on in a limb may turn there all at once; at least half of what its lower half strays from a straight line, so
/// that trunks of a kind differ.
fn waywardness(points: &[Vec3], form: &Line) -> f32 {
    let chord = points[0].distance(points[points.len() - 1]).max(1e-6);
    let stray = |points: &[Vec3], line: &Line| {
        points.iter().map(|&point| line.distance(point)).fold(0.0, f32::max) / chord
    };
    let mut eighths: Vec<f32> =
        points.chunks(points.len().div_ceil(8)).map(|points| stray(points, form)).collect();
    eighths.sort_by(f32::total_cmp);
    let lower = &points[..points.len().div_ceil(2).max(2).min(points.len())];
    let straight = Line::new(vec![lower[0], lower[lower.len() - 1]]);
    eighths[eighths.len() / 2].max(0.5 * stray(lower, &straight)).min(0.5)
}

/// The radius of the trunk base, metres; that of the thickest branch there if the root itself has none; 0 without thickness.
pub(super) fn base_radius(skeleton: &Skeleton) -> f32 {
    let root = skeleton.radii()[0];
    if root > 0.0 {
        return root;
    }
    let at_base = skeleton.edges().filter(|&(_, parent)| parent == 0);
    at_base.map(|(node, _)| skeleton.radii()[node]).fold(0.0, f32::max)
}

/// The number whose logarithm is the mean of the logarithms.
pub(super) fn geometric_mean(values: impl Iterator<Item = f32>) -> Option<f32> {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values.filter(|&value| value > 0.0) {
        sum += ln(value);
        count += 1.0;
    }
    (count > 0.0).then(|| crate::math::exp(sum / count))
}
