//! Trees.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod field;
pub mod math;
mod parameter;
pub mod random;
pub mod shape;
pub mod skeleton;

pub use field::VectorField;
pub use glam;
pub use parameter::ParameterError;
pub use rand;
pub use shape::{Bounds, Shape};
pub use skeleton::{Skeleton, SkeletonError};
