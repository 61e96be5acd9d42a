//! The error of every check of an option.

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

/// Numbers that may be infinite, in texts that know no such number: as the word `infinite`.
#[cfg(feature = "serde")]
#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde wants it")]
pub(crate) mod maybe_infinite {
    use serde::de::{Deserializer, Error, Visitor};
    use serde::{Serialize, Serializer};
    use std::fmt;

    const WORD: &str = "infinite";

    pub(crate) fn serialize<S: Serializer>(number: &f32, serializer: S) -> Result<S::Ok, S::Error> {
        if *number == f32::INFINITY { serializer.serialize_str(WORD) } else { number.serialize(serializer) }
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f32, D::Error> {
        deserializer.deserialize_any(Number)
    }

    struct Number;

    impl Visitor<'_> for Number {
        type Value = f32;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "a number or {WORD:?}")
        }

        fn visit_f64<E: Error>(self, number: f64) -> Result<f32, E> {
            Ok(number as f32)
        }

        fn visit_u64<E: Error>(self, number: u64) -> Result<f32, E> {
            Ok(number as f32)
        }

        fn visit_i64<E: Error>(self, number: i64) -> Result<f32, E> {
            Ok(number as f32)
        }

        fn visit_str<E: Error>(self, word: &str) -> Result<f32, E> {
            if word == WORD {
                Ok(f32::INFINITY)
            } else {
                Err(E::invalid_value(serde::de::Unexpected::Str(word), &self))
            }
        }
    }
}

/// As [`maybe_infinite`], of numbers that may be missing.
#[cfg(feature = "serde")]
#[allow(clippy::trivially_copy_pass_by_ref, clippy::ref_option, reason = "as serde wants it")]
pub(crate) mod maybe_infinite_or_none {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Serialize, Deserialize)]
    struct Number(#[serde(with = "super::maybe_infinite")] f32);

    pub(crate) fn serialize<S: Serializer>(number: &Option<f32>, serializer: S) -> Result<S::Ok, S::Error> {
        number.map(Number).serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f32>, D::Error> {
        Ok(Option::<Number>::deserialize(deserializer)?.map(|Number(number)| number))
    }
}
