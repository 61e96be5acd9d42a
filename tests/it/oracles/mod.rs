//! Guarantees of the paper and the design, computed a second time in another way.

mod edges;
mod endpoints;
mod graded;
mod nodes;
mod paths;
mod radii;
mod vectors;
