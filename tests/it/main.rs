//! What the crate promises, checked through its public interface alone.
#![allow(missing_docs, clippy::float_cmp, reason = "tests: the same bits are often the point")]

#[cfg(feature = "json")]
mod bad_input;
mod oracles;
mod outside;
mod sample;
mod stability;
