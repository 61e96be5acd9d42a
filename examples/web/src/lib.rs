//! The library as the page uses it: a list of trees with what can be set on them, and one tree as a
//! file.
//!
//! The functions below `module` are all that the WebAssembly module exports; the rest is plain Rust, which the program
//! `native` calls too, so that a test can compare the bytes.

mod ask;
mod file;
mod list;
#[cfg(target_arch = "wasm32")]
mod module;
mod preview;
mod tree;

pub use ask::{Answer, Ask, Progress, answer};
pub use list::list;
