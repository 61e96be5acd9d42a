//! Guiding vectors from a vector field (section 3.2.1, figure 8).

use super::{GuidingRule, Source, Step};
use crate::field::VectorField;
use crate::parameter::ParameterError;
use glam::Vec3;

/// Guiding vectors straight from a [`VectorField`], the sources' included. Where the field is zero, nodes take the
/// vector of the node before.
///
/// Branches only tend to follow: they deviate "whenever doing so produces a shorter path".
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct FollowField<F> {
    field: F,
}

crate::recipe::mapped!(FollowField { field; });

impl<F: VectorField> FollowField<F> {
    /// Follows `field`.
    pub fn new(field: F) -> Self {
        Self { field }
    }

    fn at(&self, position: Vec3, otherwise: Vec3) -> Vec3 {
        let vector = self.field.at(position);
        if vector == Vec3::ZERO { otherwise } else { vector }
    }
}

impl<F: VectorField> GuidingRule for FollowField<F> {
    fn guide(&self, step: &Step<'_>) -> Vec3 {
        self.at(step.position, step.vector)
    }

    fn source(&self, source: &Source<'_>) -> Vec3 {
        self.at(source.position, source.vector)
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.field.check()
    }
}
