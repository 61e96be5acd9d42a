//! Trees.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod export;
pub mod math;
mod parameter;
#[cfg(feature = "preview")]
pub mod preview;
pub mod random;
pub mod skeleton;
pub mod surface;

pub use glam;
pub use parameter::ParameterError;
pub use rand;
pub use skeleton::{Skeleton, SkeletonError};
