//! Trees by name: species as data, grown to the height, trunk or age that is asked for.
//!
//! [`by_name`] finds a species, [`Species::request`] begins a request, [`Request::grow`] gives a
//! [`Specimen`]: skeleton, radii, leaves and the numbers behind them. A species is a text
//! ([`Species::parse`]); `docs/species.md` explains how to write one's own.
//!
//! ```
//! use treesynth::species;
//!
//! let oak = species::by_name("Quercus robur")?;
//! let tree = oak.request().with_dbh(0.3).with_seed(1).grow()?;
//! assert!((tree.numbers.dbh - 0.3).abs() < 0.003);
//! println!("{:.1} m tall, {:.0} m² of leaves", tree.numbers.height, tree.numbers.leaf_area);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod architecture;
#[cfg(feature = "texture")]
mod asset;
#[cfg(feature = "texture")]
mod bark;
mod bark_colors;
mod bear;
mod data;
mod decay;
mod draw;
mod dress;
mod fields;
mod growing;
mod limb;
mod model;
mod names;
mod organ;
mod outline;
mod request;
mod root;
#[cfg(feature = "serde")]
mod saved;
mod shade;
mod specimen;
mod sprig;
mod text;
mod thickness;
mod wood;

#[cfg(test)]
mod habit_tests;
#[cfg(all(test, feature = "preview"))]
mod picture_tests;
#[cfg(test)]
mod tests;

pub use data::{
    BarkData, BarkForm, Crown, Laterals, LeafData, LeafShape, Limbs, Shoots, Size, Species, Stand, Trunk,
};
pub use names::{UnknownSpecies, all, by_name};
pub(crate) use names::{names, nearest, plain};
pub use organ::{Organ, OrganKind, OrganPlace};
pub use request::{Numbers, Request};
pub use specimen::Specimen;
pub use text::SpeciesTextError;

use crate::foliage::FoliageError;
use crate::{ParameterError, SkeletonError};

/// Error of growing a tree of a species.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpeciesError {
    /// A request that the species cannot meet.
    #[error(transparent)]
    Wish(#[from] ParameterError),
    /// Its data make an invalid skeleton.
    #[error(transparent)]
    Skeleton(#[from] SkeletonError),
    /// Its data make leaves that cannot be placed.
    #[error(transparent)]
    Foliage(#[from] FoliageError),
    /// Its data make more than memory should be asked for.
    #[error("{species} would have more than {most} {what}, but {field} is {value}; make it {change}")]
    TooMany {
        /// The name of the species.
        species: String,
        /// Nodes or leaves.
        what: &'static str,
        /// The most there may be.
        most: usize,
        /// The field that most likely makes them so many, as `section.name`.
        field: &'static str,
        /// Its value, in the unit of the field.
        value: f32,
        /// Direction of the change that is needed: `greater` or `less`.
        change: &'static str,
    },
}
