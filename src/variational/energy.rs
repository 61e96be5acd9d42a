//! The cost of a tree: section 3.3, equations 4 to 8.

use glam::DVec3;

use super::guidance::GuidanceShape;
use super::term::{Measured, angle, turn, wrapped};
use crate::nearest::nearest;
use crate::{ParameterError, Skeleton};

/// A term of the energy, and how it changes with every node's position.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Energy {
    /// The term.
    pub value: f64,
    /// Its gradient by each node's position; zero where a length is zero, or a direction has no slope.
    pub gradient: Vec<DVec3>,
}

/// Terms of equation 8 of one internode, by the botanical parameters.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Wish {
    pub(super) length: f64,
    pub(super) angle: Option<f64>,
    pub(super) turn: Option<(u32, f64)>,
}

crate::recipe::readable!(Wish { angle: Option<f64>, turn: Option<(u32, f64)> });

impl Wish {
    /// A length, metres, finite and above 0, and any direction.
    pub fn new(length: f64) -> Self {
        Self { length, angle: None, turn: None }
    }

    /// θ, the angle to the parent's internode, radians in [0, π]. Internodes that leave the root are free.
    pub fn with_angle(mut self, angle: f64) -> Self {
        self.angle = Some(angle);
        self
    }

    /// φ, the turn against another internode about the axis, radians in [-2π, 2π]: `mate` is that internode's node,
    /// and another child of the parent's parent than the parent.
    pub fn with_turn(mut self, mate: u32, turn: f64) -> Self {
        self.turn = Some((mate, turn));
        self
    }
}

/// `F_I = Σ |p_i - p_j| d_j^β`, equations 5 and 6, with its gradient: the value is that of
/// [`structure_energy`](crate::radius::structure_energy), diameters are the skeleton's own. O(n).
///
/// ```
/// use treesynth::{Skeleton, glam::{DVec3, Vec3}, variational::structure};
///
/// let stem = Skeleton::new(vec![Vec3::ZERO, Vec3::Y * 3.0], vec![None, Some(0)])?.with_radii(vec![0.5, 0.25])?;
/// let energy = structure(&stem, 2.0)?;
/// assert_eq!((energy.value, energy.gradient[1]), (0.75, DVec3::Y * 0.25));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When `beta` is not in [0, 6].
pub fn structure(skeleton: &Skeleton, beta: f32) -> Result<Energy, ParameterError> {
    let value = crate::radius::structure_energy(skeleton, beta)?;
    let mut gradient = vec![DVec3::ZERO; skeleton.len()];
    let at = |node: usize| skeleton.positions()[node].as_dvec3();
    for (node, parent) in skeleton.edges() {
        let thick = libm::pow(2.0 * f64::from(skeleton.radii()[node]), f64::from(beta));
        let pull = (at(node) - at(parent)).normalize_or_zero() * thick;
        gradient[node] += pull;
        gradient[parent] -= pull;
    }
    Ok(Energy { value, gradient })
}

/// `F_E = Σ d_i min_j |q_i - p_j| / Σ d_i`, equation 7, metres, with its gradient: the distance of the shape
/// nodes from the skeleton's nodes. If several nodes are equally near, the first counts. O((n + m) log n) for
/// m shape nodes.
///
/// The tree's own tips are shape nodes, so this says something of the [structure](super::Growth::structure) below them.
///
/// # Errors
/// A shape that fails its [check](GuidanceShape::check).
pub fn guidance(skeleton: &Skeleton, shape: &GuidanceShape) -> Result<Energy, ParameterError> {
    shape.check()?;
    let positions: Vec<DVec3> = skeleton.positions().iter().map(|position| position.as_dvec3()).collect();
    let total: f64 = shape.diameters().iter().map(|&d| f64::from(d)).sum();
    let mut energy = Energy { value: 0.0, gradient: vec![DVec3::ZERO; skeleton.len()] };
    let places: Vec<DVec3> = shape.positions().iter().map(|position| position.as_dvec3()).collect();
    for (i, node) in nearest(&positions, &places).into_iter().enumerate() {
        let share = f64::from(shape.diameters()[i]) / total;
        let away = positions[node as usize] - places[i];
        energy.value += share * away.length();
        energy.gradient[node as usize] += away.normalize_or_zero() * share;
    }
    Ok(energy)
}

/// `F_P`, equation 8, with its gradient: what the wishes ask for and do not get,
/// `Σ l d^β (|θ̄ - θ| + |φ̄ - φ| + |l̄ / l - 1|)`.
///
/// Angles count in radians, differences of φ the short way around, and lengths in the length l asked for, so that all
/// deviations are plain numbers. Unlike in the paper each internode's count as much as its wood, l d^β, by the skeleton's
/// own diameters: that gives `F_P` the unit of `F_I`, and without it a weight that bends limbs would rule over all twigs. The
/// root's wish is ignored. O(n).
///
/// # Errors
/// `beta` not in [0, 6], not one wish per node, or one out of its range.
pub fn penalty(skeleton: &Skeleton, wishes: &[Wish], beta: f32) -> Result<Energy, ParameterError> {
    ParameterError::unless((0.0..=6.0).contains(&beta), "beta", beta, "in [0, 6]")?;
    ParameterError::unless(wishes.len() == skeleton.len(), "wishes", wishes.len(), "one per node")?;
    let parents: Vec<u32> =
        (0..skeleton.len()).map(|node| skeleton.parent(node).unwrap_or(0) as u32).collect();
    for (node, wish) in wishes.iter().enumerate() {
        let holds = wish.length > 0.0 && wish.length.is_finite();
        ParameterError::unless(holds, "Wish.length", wish.length, "finite and above 0 metres")?;
        let holds = wish.angle.is_none_or(|angle| (0.0..=std::f64::consts::PI).contains(&angle));
        ParameterError::unless(holds, "Wish.angle", wish.angle, "in [0, π] radians")?;
        let holds = wish.turn.is_none_or(|(mate, turn)| {
            let parent = parents[node] as usize;
            turn.abs() <= std::f64::consts::TAU
                && (1..skeleton.len()).contains(&(mate as usize))
                && parent > 0
                && mate as usize != parent
                && parents[mate as usize] == parents[parent]
        });
        ParameterError::unless(
            holds,
            "Wish.turn",
            wish.turn,
            "in [-2π, 2π] radians, against another child of the parent's parent",
        )?;
    }
    let positions: Vec<DVec3> = skeleton.positions().iter().map(|position| position.as_dvec3()).collect();
    let mut gradient = vec![DVec3::ZERO; skeleton.len()];
    let thick = |&radius: &f32| libm::pow(2.0 * f64::from(radius), f64::from(beta));
    let thick: Vec<f64> = skeleton.radii().iter().map(thick).collect();
    let add = |node: usize, by: DVec3| gradient[node] += by;
    Ok(Energy { value: deviations(&positions, &parents, wishes, &thick, Soft::NONE, add), gradient })
}

/// Rounding of the kinks of the energy, so that it has a slope everywhere.
#[derive(Debug, Clone, Copy)]
pub(super) struct Soft {
    /// Lengths are sqrt(l² + soft²), metres.
    pub(super) length: f64,
    /// Deviations are sqrt(x² + soft²) - soft.
    pub(super) deviation: f64,
    /// A turn counts s² / (s² + soft²) of its weight, where s is the sine of the angle that the turned internode makes with
    /// the axis: in line with the axis a turn has no meaning and its slope no bound.
    pub(super) turn: f64,
}

impl Soft {
    /// No rounding.
    pub(super) const NONE: Self = Self { length: 0.0, deviation: 0.0, turn: 0.0 };
}

/// Factor on the weight of a turn at this angle to the axis; see [`Soft::turn`].
fn fade(angle: &Measured<3>, soft: f64) -> Measured<3> {
    let (sin, cos) = (libm::sin(angle.value), libm::cos(angle.value));
    let (square, floor) = (sin * sin, soft * soft);
    let slope = 2.0 * sin * cos * floor / ((square + floor) * (square + floor));
    Measured { value: square / (square + floor), gradient: angle.gradient.map(|by| by * slope) }
}

/// `F_P` for internodes of d^β = `thick`, its gradient added up by `add`, with its kinks rounded off as `soft` says.
/// Surfaces without thickness neither count nor turn others.
pub(super) fn deviations(
    positions: &[DVec3],
    parents: &[u32],
    wishes: &[Wish],
    thick: &[f64],
    soft: Soft,
    mut add: impl FnMut(usize, DVec3),
) -> f64 {
    // |x|, and its slope.
    let size = |x: f64| {
        let size = (x * x + soft.deviation * soft.deviation).sqrt();
        (size - soft.deviation, if size > 0.0 { x / size } else { 0.0 })
    };
    let at = |node: usize| positions[node];
    let mut sum = 0.0;
    for (node, wish) in wishes.iter().enumerate().skip(1).filter(|&(node, _)| thick[node] > 0.0) {
        let weight = wish.length * thick[node];
        let parent = parents[node] as usize;
        let before = parents[parent] as usize;
        let way = at(node) - at(parent);
        let (value, slope) = size(way.length() / wish.length - 1.0);
        let by = way.normalize_or_zero() * (slope * thick[node]);
        sum += weight * value;
        add(node, by);
        add(parent, -by);
        if parent == 0 {
            continue;
        }
        if let Some(wanted) = wish.angle {
            let measured = angle(at(before), at(parent), at(node));
            let (value, slope) = size(measured.value - wanted);
            sum += weight * value;
            for (node, by) in [before, parent, node].into_iter().zip(measured.gradient) {
                add(node, by * (slope * weight));
            }
        }
        if let Some((mate, wanted)) = wish.turn.filter(|&(mate, _)| thick[mate as usize] > 0.0) {
            let mate = mate as usize;
            let measured = turn(at(mate), at(before), at(parent), at(node));
            let (value, slope) = size(wrapped(measured.value - wanted));
            let mut weight = weight;
            if soft.turn > 0.0 {
                let near = fade(&angle(at(before), at(parent), at(node)), soft.turn);
                let far = fade(&angle(at(mate), at(before), at(parent)), soft.turn);
                for (node, by) in [before, parent, node].into_iter().zip(near.gradient) {
                    add(node, by * (weight * value * far.value));
                }
                for (node, by) in [mate, before, parent].into_iter().zip(far.gradient) {
                    add(node, by * (weight * value * near.value));
                }
                weight *= near.value * far.value;
            }
            sum += weight * value;
            for (node, by) in [mate, before, parent, node].into_iter().zip(measured.gradient) {
                add(node, by * (slope * weight));
            }
        }
    }
    sum
}
