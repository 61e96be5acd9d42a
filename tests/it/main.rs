//! The guarantees of the crate, checked through its public interface alone.
#![allow(clippy::float_cmp, reason = "the same bits are often the point")]
#![allow(clippy::disallowed_methods, reason = "oracles take the platform's functions, in double precision")]

mod allocations;
mod asset;
#[cfg(feature = "json")]
mod bad_input;
mod bent;
mod blob;
#[cfg(feature = "testing")]
mod climbing;
mod disturbed;
mod docs;
mod drawn;
mod editing;
mod example;
mod exports;
mod far;
mod figures;
mod foliage;
#[cfg(feature = "testing")]
mod grove;
#[cfg(feature = "json")]
mod growth;
mod hull;
#[cfg(feature = "import")]
mod import;
#[cfg(feature = "testing")]
mod invariants;
mod layers;
#[cfg(feature = "lidar")]
mod lidar;
mod limbs;
#[cfg(feature = "mint")]
mod mint_vectors;
mod oracles;
mod organizing;
mod outside;
#[cfg(all(feature = "testing", feature = "preview"))]
mod phenomena;
#[cfg(feature = "testing")]
mod planar;
mod planted;
#[cfg(all(feature = "json", feature = "preview", feature = "import"))]
mod readable;
#[cfg(feature = "json")]
mod recipe;
mod reconstruct;
#[cfg(feature = "testing")]
mod refinement;
mod sample;
mod shapes;
mod stability;
mod surface;
mod variational;
mod watched;
