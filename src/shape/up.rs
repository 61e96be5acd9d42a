//! The up axis of a file, and its numbers in metres.

use crate::ParameterError;
use glam::{DVec3, Vec3};

/// The axis that points up in a model file. In this crate it is always +Y.
///
/// ```
/// use treesynth::{export::Axes, shape::UpAxis};
///
/// // For Blender and printers, in millimetres.
/// let axes = Axes::default().with_up(UpAxis::Z).with_unit(0.001);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum UpAxis {
    /// +Y, as in glTF, OBJ and this crate.
    #[default]
    Y,
    /// +Z, as in Blender, in most STL and PLY files, for printers and point clouds. +Y here is +Z there, and
    /// +Z here is -Y there.
    Z,
}

impl UpAxis {
    /// A place of a file whose up axis this is, +Y up.
    pub(crate) fn upright(self, place: DVec3) -> DVec3 {
        match self {
            Self::Y => place,
            Self::Z => DVec3::new(place.x, place.z, -place.y),
        }
    }

    /// A place or direction, +Y up, as it stands in a file whose up axis this is.
    pub(crate) fn in_file(self, place: Vec3) -> Vec3 {
        match self {
            Self::Y => place,
            Self::Z => Vec3::new(place.x, -place.z, place.y),
        }
    }
}

/// Checks the unit and the offset of files that are read; `owner` is the type whose options they are.
pub(crate) fn check_numbers(owner: &str, unit: f64, offset: DVec3) -> Result<(), ParameterError> {
    let holds = (1e-9..=1e9).contains(&unit);
    ParameterError::unless(holds, &format!("{owner}.unit"), unit, "1e-9 to 1e9 metres")?;
    let holds = offset.abs().cmple(DVec3::splat(1e12)).all();
    ParameterError::unless(holds, &format!("{owner}.offset"), offset, "at most 1e12 units on every axis")
}
