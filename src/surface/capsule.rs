//! Branches as capsules, for collisions.

use super::simplify::simplify;
use crate::{ParameterError, Skeleton};
use glam::Vec3;

/// A cylinder with round ends: all points within `radius` of the straight way from one point to the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule {
    /// One end of the axis, metres.
    pub from: Vec3,
    /// The other end, metres; the same for a ball.
    pub to: Vec3,
    /// Metres.
    pub radius: f32,
}

/// The branches of a tree as capsules, few enough for a physics engine.
///
/// Guaranteed: every internode that is not too thin, as a capsule with its node's radius, lies within the
/// union of the capsules grown by the tolerance; and no capsule is thicker than the thickest internode it
/// stands for.
///
/// ```
/// use treesynth::{Skeleton, glam::Vec3, surface::Capsules};
///
/// let y = |y: f32| Vec3::Y * y;
/// let pole = Skeleton::new(vec![y(0.0), y(1.0), y(2.0)], vec![None, Some(0), Some(1)])?.with_radii(vec![0.1; 3])?;
/// let capsules = Capsules::default().of(&pole)?;
/// assert_eq!((capsules.len(), capsules[0].to, capsules[0].radius), (1, y(2.0), 0.1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Capsules {
    tolerance: f32,
    least_radius: f32,
}

crate::recipe::readable!(Capsules { tolerance: f32, least_radius: f32 });

impl Default for Capsules {
    /// Within 2 cm, down to branches 2 cm across: what a hand, a head or a ball meets.
    fn default() -> Self {
        Self { tolerance: 0.02, least_radius: 0.01 }
    }
}

impl Capsules {
    /// Greatest error of the capsules, metres, at least 0; default 0.02.
    pub fn with_tolerance(mut self, tolerance: f32) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Branches get no capsules from where they are thinner than this on, metres, at least 0; default 0.01.
    pub fn with_least_radius(mut self, radius: f32) -> Self {
        self.least_radius = radius;
        self
    }

    /// The capsules of all branches, each parent branch before its laterals. O(nodes).
    ///
    /// # Errors
    /// An option out of range.
    pub fn of(&self, skeleton: &Skeleton) -> Result<Vec<Capsule>, ParameterError> {
        let range = "at least 0 m and finite";
        for (name, value) in [("tolerance", self.tolerance), ("least_radius", self.least_radius)] {
            let holds = (0.0..f32::INFINITY).contains(&value);
            ParameterError::unless(holds, &format!("Capsules.{name}"), value, range)?;
        }
        let mut capsules = Vec::new();
        for branch in skeleton.branches().iter() {
            let radius = |i: usize| skeleton.radii()[branch.nodes()[i] as usize];
            let position = |i: usize| skeleton.positions()[branch.nodes()[i] as usize];
            // The first node's radius is another internode's.
            let count = 1 + (1..branch.nodes().len()).take_while(|&i| radius(i) >= self.least_radius).count();
            let mut start = 0;
            while start + 1 < count {
                // As long as one radius stands for all.
                let (mut low, mut high) = (radius(start + 1), radius(start + 1));
                let mut end = start + 1;
                while end + 1 < count {
                    let next = radius(end + 1);
                    (low, high) = (low.min(next), high.max(next));
                    if high - low > self.tolerance {
                        break;
                    }
                    end += 1;
                }
                let kept = simplify(end - start + 1, |i| (position(start + i), 0.0), self.tolerance);
                for pair in kept.windows(2) {
                    let [from, to] = [start + pair[0] as usize, start + pair[1] as usize];
                    let radius = (from + 1..=to).map(radius).fold(0.0, f32::max);
                    capsules.push(Capsule { from: position(from), to: position(to), radius });
                }
                start = end;
            }
        }
        Ok(capsules)
    }
}
