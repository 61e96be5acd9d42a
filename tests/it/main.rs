//! What the crate promises, checked through its public interface alone.
#![allow(clippy::float_cmp, reason = "the same bits are often the point")]
#![allow(clippy::disallowed_methods, reason = "oracles take the platform's functions, in double precision")]

mod allocations;
#[cfg(feature = "json")]
mod bad_input;
mod blob;
#[cfg(feature = "testing")]
mod editing;
mod exports;
mod figures;
mod foliage;
#[cfg(feature = "testing")]
mod grove;
#[cfg(feature = "json")]
mod growth;
mod hull;
#[cfg(feature = "testing")]
mod invariants;
mod layers;
#[cfg(feature = "mint")]
mod mint_vectors;
mod oracles;
mod organizing;
mod outside;
mod planted;
#[cfg(feature = "testing")]
mod refinement;
mod sample;
mod shapes;
mod stability;
mod surface;
mod variational;
