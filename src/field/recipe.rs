//! Built-in fields as data.

use super::{Helix, Rotation, Scale, Sink, Source, SphericalMeridians, Sum, Uniform, VectorField, Vortex};
use crate::ParameterError;
use crate::recipe::recipe;
use glam::Vec3;
use std::fmt;

recipe! {
    /// A built-in field as data: what a [`guided::Recipe`](crate::guided::Recipe) can print, compare and save.
    FieldRecipe: VectorField {
        plain Uniform,
        plain Source,
        plain Sink,
        plain Vortex,
        plain Helix,
        plain Rotation,
        plain SphericalMeridians,
        nested Scale<FieldRecipe>,
        nested Sum<FieldRecipe>,
    }
}

impl fmt::Debug for Sum<FieldRecipe> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Sum").field("terms", &self.terms()).finish()
    }
}

impl VectorField for FieldRecipe {
    fn at(&self, point: Vec3) -> Vec3 {
        self.strategy().at(point)
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.strategy().check()
    }
}
