//! Several favoured directions.

use super::{Edge, WeightFn, check_factor};
use crate::math::{UP, cos, sin};
use crate::parameter::ParameterError;
use glam::Vec3;

/// Several favoured directions at once (section 5, "multimodal edge weight adjustments"): an edge costs what it
/// deviates from the best of them.
#[must_use]
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Multimodal {
    /// (unit direction, factor of the cost)
    directions: Vec<(Vec3, f32)>,
    /// (sine and cosine of the angle to the guiding vector, factor of the cost)
    cones: Vec<(f32, f32)>,
}

impl Multimodal {
    /// Directions from each [`with_direction`](Self::with_direction).
    pub fn directions(&self) -> &[(Vec3, f32)] {
        &self.directions
    }

    /// Cones from each [`with_cone`](Self::with_cone).
    pub fn cones(&self) -> &[(f32, f32)] {
        &self.cones
    }
}

impl Multimodal {
    /// The guiding vector alone, as in [`Guided`](super::Guided).
    pub fn new() -> Self {
        Self::default()
    }

    /// Favours a direction in space too. `factor`, at least 0 and finite, multiplies the cost of deviating from
    /// it: above 1 the guiding vector is preferred, below 1 the direction is.
    pub fn with_direction(mut self, direction: Vec3, factor: f32) -> Self {
        self.directions.push((direction, factor));
        self
    }

    /// Favours all directions at `angle` radians, in [0, π], from the guiding vector too, as lateral branches
    /// of a fixed insertion angle do. `factor` as above.
    pub fn with_cone(mut self, angle: f32, factor: f32) -> Self {
        self.cones.push((angle, factor));
        self
    }
}

impl WeightFn for Multimodal {
    fn weight(&self, edge: &Edge<'_>) -> f32 {
        let mut least = edge.deviation();
        for &(direction, factor) in &self.directions {
            let cosine = edge.direction.dot(direction.normalize_or(UP));
            least = least.min(factor * (1.0 - cosine).max(0.0));
        }
        for &(angle, factor) in &self.cones {
            // cos(a - angle), with a the angle between the edge and the vector.
            let cosine = edge.direction.dot(edge.vector).clamp(-1.0, 1.0);
            let nearest = cosine * cos(angle) + (1.0 - cosine * cosine).max(0.0).sqrt() * sin(angle);
            least = least.min(factor * (1.0 - nearest).max(0.0));
        }
        edge.length * least
    }

    fn check(&self) -> Result<(), ParameterError> {
        for &(direction, factor) in &self.directions {
            let usable = direction.try_normalize().is_some();
            ParameterError::unless(usable, "Multimodal.direction", direction, "finite and not zero")?;
            check_factor("Multimodal.factor", factor, false)?;
        }
        for &(angle, factor) in &self.cones {
            let usable = (0.0..=std::f32::consts::PI).contains(&angle);
            ParameterError::unless(usable, "Multimodal.angle", angle, "in [0, π] radians")?;
            check_factor("Multimodal.factor", factor, false)?;
        }
        Ok(())
    }
}
