//! Vector fields that pull on a tree.
//!
//! A [`VectorField`] gives a direction at every point of space. Guided synthesis can take its guiding vectors
//! from one (section 3.2.1 of the paper): edges along the field are cheap, edges against it dear, so branches
//! follow it roughly, and leave it where that is shorter. Streamlines they are not.
//!
//! The fields for whole trees, those of the paper's figure 8, are [`Helix`], [`Rotation`] and
//! [`SphericalMeridians`]. The primitives to build others from, after Wejchert and Haumann 1991, "Animation
//! aerodynamics", are [`Uniform`], [`Source`], [`Sink`] and [`Vortex`], put together by [`Sum`] and [`Scale`].
//! [`FieldFn`] makes a field of a closure, [`GridField`] one of the vectors that a simulation has left on a grid, in memory or
//! in a file.
//!
//! Constructors accept anything; [`VectorField::check`] says what is wrong, once, where synthesis starts.
//!
//! ```
//! use treesynth::{VectorField, field::{Scale, Source, Sum, Uniform}, glam::Vec3};
//!
//! // Upwards, and away from a wall's corner.
//! let pull = Sum::new().with(Uniform::new(Vec3::Y)).with(Scale::new(Source::new(Vec3::X, 2.0), 1.5));
//! assert!(pull.check().is_ok());
//! assert!(pull.at(Vec3::ZERO).x < 0.0 && pull.at(Vec3::ZERO).y > 0.9);
//! ```

mod combine;
mod grid;
mod primitive;
mod recipe;
#[cfg(test)]
mod tests;
mod whole_tree;

pub use combine::{FieldFn, Scale, Sum};
pub use grid::{GridField, GridFieldError};
pub use primitive::{Sink, Source, Uniform, Vortex};
pub use recipe::FieldRecipe;
pub use whole_tree::{Helix, Rotation, SphericalMeridians};

use std::sync::Arc;

use glam::Vec3;

use crate::ParameterError;

/// A vector at every point of space.
///
/// # The contract
///
/// - `at` gives the same answer for the same point, always. If not, the same seed no longer gives the same
///   tree.
/// - `at` never returns NaN or an infinity, whatever the point. If it does, costs become NaN and paths
///   arbitrary. Where the field is undefined, at a singularity, it returns zero, which pulls nowhere.
/// - `check` refuses parameters that break the above. It is called once, where synthesis starts.
///
/// The caller decides whether the length of the vector matters; the fields for whole trees have length 1.
///
/// # A field of your own
///
/// ```
/// use treesynth::{VectorField, glam::Vec3};
///
/// /// Up, with a lean that grows with height: a tree on a windy coast.
/// struct Wind {
///     lean: f32,
/// }
///
/// impl VectorField for Wind {
///     fn at(&self, point: Vec3) -> Vec3 {
///         Vec3::new(self.lean * point.y, 1.0, 0.0).normalize_or_zero()
///     }
/// }
///
/// let wind = Wind { lean: 0.2 };
/// assert_eq!(wind.at(Vec3::ZERO), Vec3::Y);
/// assert!(wind.at(Vec3::new(0.0, 10.0, 0.0)).x > 0.8);
/// ```
pub trait VectorField: Send + Sync {
    /// The vector at `point` (metres): always finite, zero where the field is undefined.
    fn at(&self, point: Vec3) -> Vec3;

    /// Checks that the parameters make sense.
    ///
    /// # Errors
    /// The first parameter out of its range, named `Type.field`.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

macro_rules! forward {
    ($($pointer:ty),*) => {$(
        impl<T: VectorField + ?Sized> VectorField for $pointer {
            fn at(&self, point: Vec3) -> Vec3 {
                (**self).at(point)
            }

            fn check(&self) -> Result<(), ParameterError> {
                (**self).check()
            }
        }
    )*};
}

forward!(&T, Box<T>, Arc<T>);

/// Zero in place of what overflowed or was undefined.
fn finite_or_zero(vector: Vec3) -> Vec3 {
    if vector.is_finite() { vector } else { Vec3::ZERO }
}

fn check_position(parameter: &str, position: Vec3) -> Result<(), ParameterError> {
    ParameterError::unless(
        position.abs().cmple(Vec3::splat(1e6)).all(),
        parameter,
        position,
        "from -1e6 to 1e6 metres on every axis",
    )
}

fn check_vector(parameter: &str, vector: Vec3) -> Result<(), ParameterError> {
    let length = vector.length();
    ParameterError::unless(
        (1e-6..=1e6).contains(&length),
        parameter,
        vector,
        "a vector of length 1e-6 to 1e6",
    )
}

fn check_positive(parameter: &str, value: f32) -> Result<(), ParameterError> {
    ParameterError::unless((1e-6..=1e6).contains(&value), parameter, value, "from 1e-6 to 1e6")
}

fn check_nonzero(parameter: &str, value: f32) -> Result<(), ParameterError> {
    ParameterError::unless(
        (1e-6..=1e6).contains(&value.abs()),
        parameter,
        value,
        "from 1e-6 to 1e6, or the same below zero",
    )
}
