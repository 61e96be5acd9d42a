//! What the crate promises, checked through its public interface alone.
#![allow(clippy::float_cmp, reason = "the same bits are often the point")]
#![allow(clippy::disallowed_methods, reason = "oracles take the platform's functions, in double precision")]

mod allocations;
#[cfg(feature = "json")]
mod bad_input;
mod blob;
mod exports;
mod figures;
mod foliage;
#[cfg(feature = "json")]
mod growth;
#[cfg(feature = "testing")]
mod editing;
#[cfg(feature = "testing")]
mod grove;
mod hull;
#[cfg(feature = "testing")]
mod invariants;
mod layers;
#[cfg(feature = "mint")]
mod mint_vectors;
mod oracles;
mod organizing;
mod outside;
#[cfg(feature = "testing")]
mod refinement;
mod sample;
mod shapes;
mod stability;
mod surface;
mod variational;
