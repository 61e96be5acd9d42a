//! Coordinate frame of a survey's file.

use std::io::{self, Write};

use glam::{DVec3, Vec3};

use crate::ParameterError;
use crate::shape::{LARGEST, UpAxis, check_numbers};

/// Coordinates up to here, metres, stay as they are: an `f32` is then within 0.03 mm.
const NEAR: f64 = 1000.0;
/// Extent of coordinates that are farther off, metres: an `f32` is then within 0.5 mm.
const WIDEST: f64 = 1e4;

/// Coordinate frame of a file of measurements: the axis that points up, the unit, and the offset
/// that is taken off coordinates.
///
/// A file's numbers are read as `f64`; the offset is taken off in the file's own axes and unit; what is left is turned upright and
/// multiplied by the unit, and only then made `f32`. Writing goes the other way. Numbers in a survey's coordinates (UTM: hundreds of
/// kilometres east, thousands north) thus lose nothing that a scanner measures. Without an offset and in
/// metres, every `f32` comes back as the same bits; with one, to within the last bit of an `f64` of the
/// file's size, 1e-9 m for UTM.
///
/// ```
/// use treesynth::cloud::{Cloud, Frame};
///
/// let text = "478123.25 5429876.5 211.125\n478123.5 5429876.5 212.125\n";
/// let cloud = Cloud::read_xyz(&Frame::default(), text.as_bytes())?;
/// // +Z of the file is +Y here.
/// assert_eq!(cloud.points()[1] - cloud.points()[0], treesynth::glam::Vec3::new(0.25, 1.0, 0.0));
/// assert_eq!(cloud.offset().x, 478_123.0);
/// let mut back = Vec::new();
/// cloud.write_xyz(&Frame::default().with_offset(cloud.offset()), &mut back)?;
/// assert_eq!(String::from_utf8_lossy(&back), text);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    up: UpAxis,
    unit: f64,
    offset: Option<DVec3>,
}

impl Default for Frame {
    /// +Z up and metres, as surveyors and scanners have it; the offset as the file needs it.
    fn default() -> Self {
        Self { up: UpAxis::Z, unit: 1.0, offset: None }
    }
}

impl Frame {
    /// The file's axis that points up; default [`UpAxis::Z`].
    pub fn with_up(mut self, up: UpAxis) -> Self {
        self.up = up;
        self
    }

    /// Metres in a unit of the file, 1e-9 to 1e9; default 1. Radii and lengths are in this unit too.
    pub fn with_unit(mut self, metres: f64) -> Self {
        self.unit = metres;
        self
    }

    /// Offset that is taken off every position that is read and added to every one that is written,
    /// in the file's axes and unit, at most 1e12. By default nothing is added; and nothing is taken
    /// off if all coordinates are within 1 km of 0, else the lowest of each axis, rounded down to a
    /// whole number. Coordinates farther off must then lie within 10 km of each other.
    pub fn with_offset(mut self, offset: DVec3) -> Self {
        self.offset = Some(offset);
        self
    }

    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        check_numbers("Frame", self.unit, self.offset.unwrap_or_default())
    }

    /// The offset of a file whose coordinates are from `low` to `high`; what is wrong if none can keep them as `f32`.
    pub(crate) fn offset_of(&self, low: DVec3, high: DVec3) -> Result<DVec3, String> {
        if let Some(offset) = self.offset {
            return Ok(offset);
        }
        let is_near = low.abs().max(high.abs()).max_element() * self.unit <= NEAR;
        // Nothing may be there.
        if is_near || !low.is_finite() {
            return Ok(DVec3::ZERO);
        }
        if (high - low).max_element() * self.unit > WIDEST {
            return Err(format!(
                "they lie from {low} to {high}, but must be within 10 km of each other; leave out strays such as 0, 0, 0 for a \
                 beam without an echo, or choose Frame::with_offset"
            ));
        }
        Ok(low.floor())
    }

    /// A length of the file in metres.
    pub(crate) fn metres(&self, length: f64) -> f64 {
        length * self.unit
    }

    /// A place of the file in metres and +Y up; what it is if it lies too far off.
    pub(crate) fn local(&self, place: DVec3, offset: DVec3) -> Result<Vec3, String> {
        let local = self.up.upright((place - offset) * self.unit);
        if local.abs().cmple(DVec3::splat(LARGEST.into())).all() {
            return Ok(local.as_vec3());
        }
        Err(format!(
            "the position {place} is {local} m from the origin, but must be finite and at most 1e6 m on every axis; \
             Frame::with_offset moves it, Frame::with_unit scales it"
        ))
    }

    /// A place as it stands in the file, to be written as it is.
    pub(crate) fn written(&self, place: Vec3) -> [Number; 3] {
        let place = self.up.in_file(place).to_array();
        let offset = self.offset.unwrap_or_default().to_array();
        let is_short = self.is_short();
        std::array::from_fn(|axis| match self.number(place[axis], offset[axis]) {
            // All of a place alike, for files that have one kind of number.
            Number::Short(value) if !is_short => Number::Long(value.into()),
            number => number,
        })
    }

    /// A length as it stands in the file.
    pub(crate) fn length(&self, metres: f32) -> Number {
        self.number(metres, 0.0)
    }

    /// `true` if numbers are written as they are.
    pub(crate) fn is_short(&self) -> bool {
        self.is_metric() && self.offset.unwrap_or_default() == DVec3::ZERO
    }

    fn is_metric(&self) -> bool {
        self.unit.to_bits() == 1.0_f64.to_bits()
    }

    fn number(&self, metres: f32, offset: f64) -> Number {
        if self.is_metric() && offset == 0.0 {
            Number::Short(metres)
        } else {
            Number::Long(f64::from(metres) / self.unit + offset)
        }
    }
}

/// A number in as many digits as it needs.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Number {
    Short(f32),
    Long(f64),
}

impl Number {
    pub(crate) fn value(self) -> f64 {
        match self {
            Self::Short(value) => value.into(),
            Self::Long(value) => value,
        }
    }

    pub(crate) fn write(self, writer: &mut impl Write, is_big: bool) -> io::Result<()> {
        match (self, is_big) {
            (Self::Short(value), false) => writer.write_all(&value.to_le_bytes()),
            (Self::Short(value), true) => writer.write_all(&value.to_be_bytes()),
            (Self::Long(value), false) => writer.write_all(&value.to_le_bytes()),
            (Self::Long(value), true) => writer.write_all(&value.to_be_bytes()),
        }
    }

    pub(crate) fn doubled(self) -> Self {
        Self::Long(2.0 * self.value())
    }
}

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Short(value) => value.fmt(f),
            Self::Long(value) => value.fmt(f),
        }
    }
}
