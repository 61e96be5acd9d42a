//! Trees and forests that organize themselves: buds compete for light, space and vigor.
//!
//! After Pałubicki et al. 2009, "Self-organizing tree models for image synthesis", as the program `TreeGen` and the
//! text about it work it out. "The text" in this module is that one; its six steps are
//!
//! 1. light at each bud, summed to the root: [`Environment`], [`ShadowPropagation`], [`SpaceColonization`];
//! 2. vigor, shared out from the root to the buds: [`VigorModel`];
//! 3. shoots of buds whose vigor is at least 1, and 4. shedding of branches that do not pay: [`Habit`];
//! 5. width: [`Width`], a [`RadiusModel`](crate::RadiusModel);
//! 6. seeds: [`Offspring`].
//!
//! [`SelfOrganizing`] grows one tree, [`Forest`] many that share an environment.

mod axis;
mod colonization;
#[cfg(feature = "json")]
mod compact;
mod cut;
mod daylight;
mod dead;
mod environment;
mod forest;
mod garden;
mod grid;
mod habit;
mod inventory;
mod landscape;
mod lapse;
mod offspring;
mod pass;
mod phyllotaxis;
mod planting;
mod region;
mod room;
mod sag;
#[cfg(feature = "serde")]
mod saved;
mod season;
mod shadow;
mod single;
mod sky;
mod slice;
mod stature;
mod terrain;
#[cfg(test)]
mod tests;
mod tree;
mod vigor;
mod width;

pub use axis::Axis;
pub use colonization::SpaceColonization;
#[cfg(feature = "json")]
pub use compact::ReadForestError;
pub use cut::Regrowth;
pub use daylight::Daylight;
pub use dead::DeadWood;
pub use environment::{Bud, Environment};
pub use forest::{Forest, ForestError};
pub use habit::{Habit, Shedding};
pub use inventory::TreeRecord;
pub use landscape::Landscape;
pub use offspring::Offspring;
pub use phyllotaxis::Phyllotaxis;
pub use planting::PlantingMap;
pub use sag::Sag;
pub use shadow::ShadowPropagation;
pub use single::SelfOrganizing;
pub use stature::Stature;
pub use terrain::{Heightmap, Terrain};
pub use tree::{NodeId, Site, Tree};
pub use vigor::VigorModel;
pub use width::Width;
