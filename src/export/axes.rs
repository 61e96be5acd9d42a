//! The up axis of a file, and its unit.

use crate::ParameterError;
use crate::shape::UpAxis;
use glam::Vec3;

/// The axis that points up in a file, its unit, and where its origin is. OBJ, PLY and STL say none of these, and programs have
/// habits; USD says which. glTF fixes them: +Y up, metres; [`GlbOptions::with_origin`](super::GlbOptions::with_origin) alone is free.
///
/// Blender, slicers and programs for point clouds take +Z as up, slicers take millimetres: `UpAxis::Z` and a unit of 0.001.
/// The file's header has a note of both.
///
/// ```
/// use treesynth::export::{self, Axes};
/// use treesynth::{glam::Vec3, shape::UpAxis, surface::{Mesh, Part}};
///
/// let triangle = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2]);
/// let printer = Axes::default().with_up(UpAxis::Z).with_unit(0.001);
/// let mut stl = Vec::new();
/// export::write_stl_with(&[Part::new(&triangle)], printer, &mut stl)?;
/// assert!(stl.starts_with(b"treesynth, binary STL, millimetres, +Z up "));
/// // The third corner, 1 m above the first.
/// let height = f32::from_le_bytes([stl[128], stl[129], stl[130], stl[131]]);
/// assert!((height - 1000.0).abs() < 1e-3);
/// # Ok::<(), export::ExportError>(())
/// ```
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Axes {
    up: UpAxis,
    unit: f32,
    origin: Vec3,
}

crate::recipe::readable!(Axes { up: UpAxis, unit: f32, origin: Vec3 });

impl Default for Axes {
    /// +Y up, metres, the origin where it is, as everywhere in this crate.
    fn default() -> Self {
        Self { up: UpAxis::Y, unit: 1.0, origin: Vec3::ZERO }
    }
}

impl Axes {
    /// The axis that points up; default [`UpAxis::Y`].
    pub fn with_up(mut self, up: UpAxis) -> Self {
        self.up = up;
        self
    }

    /// Metres in a unit of the file, 1e-6 to 1e6; default 1. With 0.001 numbers are millimetres.
    pub fn with_unit(mut self, metres: f32) -> Self {
        self.unit = metres;
        self
    }

    /// The point, metres and +Y up, that becomes the file's origin; default zero.
    pub fn with_origin(mut self, origin: Vec3) -> Self {
        self.origin = origin;
        self
    }

    pub(super) fn check(self) -> Result<(), ParameterError> {
        let unit = self.unit;
        ParameterError::unless((1e-6..=1e6).contains(&unit), "Axes.unit", unit, "1e-6 to 1e6 metres")?;
        ParameterError::unless(self.origin.is_finite(), "Axes.origin", self.origin, "finite, metres")
    }

    /// A direction in the file's axes.
    pub(super) fn turned(self, direction: Vec3) -> Vec3 {
        self.up.in_file(direction)
    }

    /// A place in the file's axes and unit.
    pub(super) fn placed(self, place: Vec3) -> Vec3 {
        // Zero taken away leaves the same bits, minus zero too.
        let place = place - self.origin;
        self.turned(if self.unit.to_bits() == 1.0_f32.to_bits() { place } else { place / self.unit })
    }

    /// Note for the file's header.
    pub(super) fn note(self) -> String {
        let known = [(1.0_f32, "metres"), (0.001, "millimetres"), (0.01, "centimetres"), (0.0254, "inches")];
        let unit = known.iter().find(|(unit, _)| unit.to_bits() == self.unit.to_bits());
        let unit =
            unit.map_or_else(|| format!("units of {} metres", self.unit), |(_, name)| (*name).to_owned());
        format!("{unit}, {} up", if self.up == UpAxis::Y { "+Y" } else { "+Z" })
    }
}
