//! One way to find a preset of any system by its name.

use super::{Grown, Preset, Stand, grown, guided, spaces, stands};
use crate::self_organizing::SpaceColonization;
use crate::species::{self, Species};
use crate::variational;
use std::fmt;

/// A system that grows trees.
///
/// ```
/// use treesynth::presets::{self, System};
///
/// assert_eq!(presets::by_name("figure-07")?.system(), System::Guided);
/// assert_eq!(presets::by_name("oak")?.system(), System::Species);
/// # Ok::<(), presets::PresetError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum System {
    /// [`guided`](crate::guided): least-cost paths in a graph.
    Guided,
    /// [`self_organizing`](crate::self_organizing): buds that compete.
    SelfOrganizing,
    /// [`variational`](crate::variational): trees that fill shapes.
    Variational,
    /// [`growth`](crate::growth): trees over the years.
    Growth,
    /// [`species`](crate::species): trees of a botanical name.
    Species,
}

impl fmt::Display for System {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Guided => "guided",
            Self::SelfOrganizing => "self-organizing",
            Self::Variational => "variational",
            Self::Growth => "growth",
            Self::Species => "species",
        })
    }
}

/// A preset of any system.
///
/// ```
/// use treesynth::presets::{self, Found};
///
/// let Found::Species(oak) = presets::by_name("oak")? else { panic!("a species") };
/// assert_eq!(oak.latin, "Quercus robur");
/// # Ok::<(), presets::PresetError>(())
/// ```
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum Found {
    /// Of [`System::Guided`].
    Guided(&'static Preset),
    /// Of [`System::SelfOrganizing`].
    Stand(&'static Stand),
    /// Of [`System::SelfOrganizing`], in space instead of light.
    Space(&'static Stand<SpaceColonization>),
    /// Of [`System::Variational`].
    Variational(&'static variational::Preset),
    /// Of [`System::Growth`].
    Grown(&'static Grown),
    /// Of [`System::Species`].
    Species(&'static Species),
}

/// Error of finding a preset.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PresetError {
    /// No system has one of this name.
    #[error("there is no preset {name:?}; near names: {}", near.join(", "))]
    Unknown {
        /// The name asked for.
        name: String,
        /// The nearest names there are, nearest first.
        near: Vec<String>,
    },
    /// Another system has it.
    #[error("{name:?} is a preset of the system {system}, not {wanted}")]
    System {
        /// The name of the preset.
        name: String,
        /// The system that it is of.
        system: System,
        /// The system that was asked for.
        wanted: System,
    },
}

impl Found {
    /// Its name: `figure-06c`, `stand-weeping`, `variational-14-oak`, `growth-15-cottonwood`, `silver birch`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Guided(preset) => preset.name,
            Self::Stand(preset) => preset.name,
            Self::Space(preset) => preset.name,
            Self::Variational(preset) => preset.name,
            Self::Grown(preset) => preset.name,
            Self::Species(species) => &species.name,
        }
    }

    /// The system that grows its tree.
    pub fn system(&self) -> System {
        match self {
            Self::Guided(_) => System::Guided,
            Self::Stand(_) | Self::Space(_) => System::SelfOrganizing,
            Self::Variational(_) => System::Variational,
            Self::Grown(_) => System::Growth,
            Self::Species(_) => System::Species,
        }
    }

    /// One line on what it shows.
    pub fn about(&self) -> &'static str {
        match self {
            Self::Guided(preset) => preset.caption,
            Self::Stand(preset) => preset.caption,
            Self::Space(preset) => preset.caption,
            Self::Variational(preset) => preset.caption,
            Self::Grown(preset) => preset.caption,
            Self::Species(species) => &species.about,
        }
    }

    fn not(self, wanted: System) -> PresetError {
        PresetError::System { name: self.name().to_owned(), system: self.system(), wanted }
    }

    /// The preset of [`guided`](crate::guided).
    ///
    /// # Errors
    /// A preset of another system.
    pub fn guided(self) -> Result<&'static Preset, PresetError> {
        if let Self::Guided(preset) = self { Ok(preset) } else { Err(self.not(System::Guided)) }
    }

    /// The preset of [`self_organizing`](crate::self_organizing).
    ///
    /// # Errors
    /// As [`guided`](Self::guided).
    pub fn stand(self) -> Result<&'static Stand, PresetError> {
        if let Self::Stand(preset) = self { Ok(preset) } else { Err(self.not(System::SelfOrganizing)) }
    }

    /// The preset of [`self_organizing`](crate::self_organizing) in space.
    ///
    /// # Errors
    /// As [`guided`](Self::guided), and one in light.
    pub fn space(self) -> Result<&'static Stand<SpaceColonization>, PresetError> {
        if let Self::Space(preset) = self { Ok(preset) } else { Err(self.not(System::SelfOrganizing)) }
    }

    /// The preset of [`variational`](crate::variational).
    ///
    /// # Errors
    /// As [`guided`](Self::guided).
    pub fn variational(self) -> Result<&'static variational::Preset, PresetError> {
        if let Self::Variational(preset) = self { Ok(preset) } else { Err(self.not(System::Variational)) }
    }

    /// The preset of [`growth`](crate::growth).
    ///
    /// # Errors
    /// As [`guided`](Self::guided).
    pub fn grown(self) -> Result<&'static Grown, PresetError> {
        if let Self::Grown(preset) = self { Ok(preset) } else { Err(self.not(System::Growth)) }
    }

    /// The species.
    ///
    /// # Errors
    /// As [`guided`](Self::guided).
    pub fn species(self) -> Result<&'static Species, PresetError> {
        if let Self::Species(species) = self { Ok(species) } else { Err(self.not(System::Species)) }
    }
}

/// The presets of all systems, one system after the other, each in its own order.
///
/// ```
/// use treesynth::presets;
///
/// for preset in presets::all() {
///     println!("{:15} {:26} {}", preset.system(), preset.name(), preset.about());
/// }
/// assert!(presets::all().count() > 120);
/// ```
pub fn all() -> impl Iterator<Item = Found> {
    guided()
        .map(Found::Guided)
        .chain(stands().map(Found::Stand))
        .chain(spaces().map(Found::Space))
        .chain(variational::presets().map(Found::Variational))
        .chain(grown().map(Found::Grown))
        .chain(species::all().iter().map(Found::Species))
}

/// The preset of this name, whatever makes it; species by their English, Latin and other names. Upper and lower case are
/// one, and so are blanks, hyphens and underscores. The system may come first: `species-silver-birch`.
///
/// ```
/// use treesynth::presets;
///
/// let ash = presets::by_name("figure-06c")?.guided()?;
/// assert_eq!(presets::by_name("Stand Weeping")?.stand()?.name, "stand-weeping");
/// assert_eq!(presets::by_name("betula_pendula")?.name(), "silver birch");
/// let error = presets::by_name("figure-6c").unwrap_err();
/// assert!(error.to_string().starts_with("there is no preset \"figure-6c\"; near names: figure-06c"));
/// # Ok::<(), presets::PresetError>(())
/// ```
///
/// # Errors
/// No preset of that name; the error lists near ones.
pub fn by_name(name: &str) -> Result<Found, PresetError> {
    let wanted = species::plain(name);
    let is_it = |found: &Found| {
        let bare = species::plain(&format!("{} ", found.system()));
        let rest = wanted.strip_prefix(&bare).map(str::trim_start);
        names(found).any(|known| {
            let known = species::plain(known);
            known == wanted || rest == Some(known.as_str())
        })
    };
    all().find(is_it).ok_or_else(|| {
        let near = species::nearest(name, all().flat_map(|found| names(&found).collect::<Vec<_>>()), 4);
        PresetError::Unknown { name: name.to_owned(), near }
    })
}

/// Every name of a preset.
fn names(found: &Found) -> impl Iterator<Item = &'static str> + use<> {
    let own = if let Found::Species(_) = found { None } else { Some(found.name()) };
    let species = if let Found::Species(species) = *found { Some(species) } else { None };
    own.into_iter().chain(species.into_iter().flat_map(species::names))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn each_preset_is_found_by_each_of_its_names() {
        let mut seen = BTreeSet::new();
        for found in all() {
            assert!(!found.about().is_empty() && !found.about().contains('\n'), "{}", found.name());
            for name in names(&found) {
                assert!(seen.insert(species::plain(name)), "{name} names two presets");
                let (loud, spaced) = (name.to_uppercase(), name.replace('-', " "));
                for written in
                    [name, &loud, &spaced, &spaced.replace(' ', "_"), &format!("{} {name}", found.system())]
                {
                    let again = by_name(written).unwrap();
                    assert_eq!((again.name(), again.system()), (found.name(), found.system()), "{written}");
                }
            }
            let kinds = [
                found.guided().is_ok(),
                found.stand().is_ok(),
                found.space().is_ok(),
                found.variational().is_ok(),
                found.grown().is_ok(),
                found.species().is_ok(),
            ];
            assert_eq!(kinds.iter().filter(|&&is| is).count(), 1);
        }
    }

    #[test]
    fn near_names_and_other_systems_are_told() {
        for (wrong, near) in [
            ("figure7", "figure-07"),
            ("Silver Brich", "silver birch"),
            ("weeping", "stand-weeping"),
            ("variational-14-oka", "variational-14-oak"),
            ("growth cottonwod", "growth-15-cottonwood"),
        ] {
            let error = by_name(wrong).unwrap_err();
            let PresetError::Unknown { near: found, .. } = &error else { panic!("{error}") };
            assert!(found.iter().any(|name| name == near), "{error}");
        }
        for name in ["", " ", "-", "species", "guided-", "\u{0}", &"x".repeat(10_000)] {
            assert!(by_name(name).is_err(), "{name:?}");
        }
        let error = by_name("stand-wind").unwrap().guided().unwrap_err();
        assert_eq!(error.to_string(), "\"stand-wind\" is a preset of the system self-organizing, not guided");
    }
}
