//! Trees.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod guided;
pub mod math;
mod observer;
mod parallel;
mod parameter;
pub mod random;
pub mod shape;
pub mod skeleton;

pub use glam;
pub use observer::{Observer, Progress, Silent, Work};
pub use parameter::ParameterError;
pub use rand;
pub use skeleton::{Skeleton, SkeletonError};
