//! Guided.
mod graph;
pub use graph::*;
