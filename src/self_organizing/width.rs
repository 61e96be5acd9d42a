//! Step 5: how thick branches are.

use super::habit::Habit;
use super::tree::Tree;
use crate::math;
use crate::radius::{RadiusError, RadiusModel};
use crate::{ParameterError, Skeleton};

/// `w^n = Σ w_child^n` over all buds a branch ever carried at once, living or dead, so that a parent does not thin
/// when it loses a branch: the width is that of a tip times the n-th root of the largest child count.
///
/// The counts are those of one tree, so the model fits that tree's skeleton only.
#[derive(Debug, Clone, PartialEq)]
pub struct Width {
    counts: Vec<u32>,
    exponent: f32,
    tip_radius: f32,
}

impl Width {
    /// The widths of `tree`, with the width exponent and the tip radius of `habit`.
    pub fn new(tree: &Tree, habit: &Habit) -> Self {
        let counts = tree.child_counts().collect();
        Self { counts, exponent: habit.width_exponent, tip_radius: habit.tip_radius }
    }
}

impl RadiusModel for Width {
    fn radii(&self, skeleton: &Skeleton) -> Result<Vec<f32>, RadiusError> {
        if self.counts.len() != skeleton.len() {
            return Err(RadiusError::Length { radii: self.counts.len(), nodes: skeleton.len() });
        }
        let root = 1.0 / self.exponent;
        let mut radii = Vec::with_capacity(self.counts.len());
        for (node, &count) in self.counts.iter().enumerate() {
            let radius = self.tip_radius * math::powf(count as f32, root);
            // Counts never grow towards the tips, but `powf` may round two neighbours the wrong way round.
            radii.push(skeleton.parent(node).map_or(radius, |parent| radius.min(radii[parent])));
        }
        Ok(radii)
    }

    fn check(&self) -> Result<(), ParameterError> {
        Habit::default().with_width_exponent(self.exponent).with_tip_radius(self.tip_radius).check()
    }
}
