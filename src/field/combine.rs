//! Fields made of fields, and of closures.

use std::fmt;

use glam::Vec3;

use super::{VectorField, check_nonzero, finite_or_zero};
use crate::ParameterError;

/// The sum of any number of fields; zero everywhere if there are none.
///
/// ```
/// use treesynth::{VectorField, field::{Sum, Uniform, Vortex}, glam::Vec3};
///
/// let tornado = Sum::new()
///     .with(Uniform::new(Vec3::Y))
///     .with(Vortex::new(Vec3::ZERO, Vec3::Y, 5.0));
/// assert!(tornado.at(Vec3::X).y == 1.0 && tornado.at(Vec3::X).z < 0.0);
/// ```
#[must_use]
#[derive(Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Sum<F = Box<dyn VectorField>> {
    terms: Vec<F>,
}

impl<A> Sum<A> {
    /// The same of other fields.
    pub(crate) fn map<B>(self, term: impl FnMut(A) -> B) -> Sum<B> {
        Sum { terms: self.terms.into_iter().map(term).collect() }
    }
}

impl Default for Sum {
    fn default() -> Self {
        Self::new()
    }
}

impl Sum {
    /// A sum of no fields.
    pub const fn new() -> Self {
        Self { terms: Vec::new() }
    }

    /// Adds a field.
    pub fn with(mut self, field: impl VectorField + 'static) -> Self {
        self.terms.push(Box::new(field));
        self
    }
}

impl<F> Sum<F> {
    /// The fields.
    pub fn terms(&self) -> &[F] {
        &self.terms
    }

    /// Number of fields.
    pub fn len(&self) -> usize {
        self.terms.len()
    }

    /// `true` if there are no fields to add up.
    pub fn is_empty(&self) -> bool {
        self.terms.is_empty()
    }
}

impl<F: VectorField> From<Vec<F>> for Sum<F> {
    fn from(terms: Vec<F>) -> Self {
        Self { terms }
    }
}

impl fmt::Debug for Sum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Sum").field("len", &self.len()).finish_non_exhaustive()
    }
}

impl<F: VectorField> VectorField for Sum<F> {
    /// O(n) for n fields.
    fn at(&self, point: Vec3) -> Vec3 {
        finite_or_zero(self.terms.iter().map(|term| term.at(point)).sum())
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.terms.iter().try_for_each(VectorField::check)
    }
}

/// A field times a number.
///
/// ```
/// use treesynth::{VectorField, field::{Scale, Uniform}, glam::Vec3};
///
/// assert_eq!(Scale::new(Uniform::new(Vec3::Y), -0.5).at(Vec3::ZERO), Vec3::Y * -0.5);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Scale<F> {
    field: F,
    factor: f32,
}

crate::recipe::mapped!(Scale { field; factor });

impl<F> Scale<F> {
    /// `field` times `factor`, from 1e-6 to 1e6, or negative to reverse it.
    pub const fn new(field: F, factor: f32) -> Self {
        Self { field, factor }
    }
}

impl<F: VectorField> VectorField for Scale<F> {
    fn at(&self, point: Vec3) -> Vec3 {
        finite_or_zero(self.field.at(point) * self.factor)
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.field.check()?;
        check_nonzero("Scale.factor", self.factor)
    }
}

/// A closure as a field. Where it returns NaN or an infinity, the field is zero.
///
/// The closure must give the same vector for the same point, always.
///
/// ```
/// use treesynth::{VectorField, field::FieldFn, glam::Vec3};
///
/// let outwards = FieldFn::new(|point: Vec3| point / point.length());
/// assert_eq!(outwards.at(Vec3::X * 3.0), Vec3::X);
/// assert_eq!(outwards.at(Vec3::ZERO), Vec3::ZERO);
/// ```
#[derive(Clone, Copy)]
pub struct FieldFn<F> {
    function: F,
}

impl<F: Fn(Vec3) -> Vec3 + Send + Sync> FieldFn<F> {
    /// The field that is `function` of the point (metres).
    pub const fn new(function: F) -> Self {
        Self { function }
    }
}

impl<F> fmt::Debug for FieldFn<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FieldFn").finish_non_exhaustive()
    }
}

impl<F: Fn(Vec3) -> Vec3 + Send + Sync> VectorField for FieldFn<F> {
    fn at(&self, point: Vec3) -> Vec3 {
        finite_or_zero((self.function)(point))
    }
}
