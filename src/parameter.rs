//! What every check of an option says when it fails.

/// An option out of its range. Displays as `name is value, but must be range`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{parameter} is {value}, but must be {range}")]
#[non_exhaustive]
pub struct ParameterError {
    /// The parameter's name as its `with_*` method or constructor has it, e.g. `HopSurface.hops`.
    pub parameter: String,
    /// The value it had.
    pub value: String,
    /// The values allowed, in words, with the unit.
    pub range: String,
}

impl ParameterError {
    /// Says that `parameter` has a `value` outside `range`.
    pub fn new(
        parameter: impl Into<String>,
        value: impl std::fmt::Display,
        range: impl Into<String>,
    ) -> Self {
        Self { parameter: parameter.into(), value: value.to_string(), range: range.into() }
    }

    /// `Ok` if `holds`; the error otherwise. The value is formatted with `Debug`, which suits vectors too.
    ///
    /// Write conditions so that NaN fails them: `value > 0.0`, not `!(value <= 0.0)`.
    ///
    /// # Errors
    /// When `holds` is false.
    pub fn unless(
        holds: bool,
        parameter: &str,
        value: impl std::fmt::Debug,
        range: &str,
    ) -> Result<(), Self> {
        if holds { Ok(()) } else { Err(Self::new(parameter, format_args!("{value:?}"), range)) }
    }
}
