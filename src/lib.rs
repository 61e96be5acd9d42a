//! Trees.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod math;
pub mod metrics;
mod parameter;
pub mod radius;
pub mod random;
pub mod skeleton;

pub use glam;
pub use metrics::Metrics;
pub use parameter::ParameterError;
pub use radius::{RadiusError, RadiusModel};
pub use rand;
pub use skeleton::{Skeleton, SkeletonError};
