//! Serialized species: the name of a built-in one, the text of another.

use super::Species;
use serde::de::Error as _;
use serde::ser::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;

pub(super) fn serialize<S: Serializer>(species: &Species, serializer: S) -> Result<S::Ok, S::Error> {
    let is_built_in = super::by_name(&species.name).is_ok_and(|known| known == species);
    if is_built_in {
        return serializer.serialize_str(&species.name);
    }
    let text = species.to_text();
    match Species::parse(&text) {
        Ok(read) if read == *species => serializer.serialize_str(&text),
        Ok(_) => Err(S::Error::custom(format!("the text of species {:?} gives another", species.name))),
        Err(error) => Err(S::Error::custom(format!("the text of species {:?}: {error}", species.name))),
    }
}

/// A number, which JSON has no word for if it is not finite.
#[expect(clippy::ref_option, clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
pub(super) fn finite<S: Serializer>(value: &Option<f32>, serializer: S) -> Result<S::Ok, S::Error> {
    match value {
        Some(value) if !value.is_finite() => {
            Err(S::Error::custom(format!("{value} in a request, but numbers must be finite")))
        }
        value => value.serialize(serializer),
    }
}

pub(super) fn deserialize<'a, 'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Cow<'a, Species>, D::Error> {
    let text = String::deserialize(deserializer)?;
    if text.contains('=') {
        return Species::parse(&text).map(Cow::Owned).map_err(D::Error::custom);
    }
    super::by_name(&text).map(Cow::Borrowed).map_err(D::Error::custom)
}
