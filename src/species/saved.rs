//! Serialized species: the name of a built-in one, the text of another.

use super::Species;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serializer};
use std::borrow::Cow;

pub(super) fn serialize<S: Serializer>(species: &Species, serializer: S) -> Result<S::Ok, S::Error> {
    let is_built_in = super::by_name(&species.name).is_ok_and(|known| known == species);
    if is_built_in {
        serializer.serialize_str(&species.name)
    } else {
        serializer.serialize_str(&species.to_text())
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
