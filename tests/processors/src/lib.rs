//! Hashes of what every part of the library makes: the same on every processor, or the crate's first promise is broken.
//! `scripts/check_processors` builds this for some of them and compares.

mod hash;
mod made;
#[cfg(target_arch = "wasm32")]
mod module;

pub use made::{Made, all};
