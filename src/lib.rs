//! Trees.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod field;
pub mod guided;
pub mod math;
mod observer;
mod parallel;
pub mod metrics;
mod parameter;
pub mod radius;
pub mod random;
pub mod shape;
pub mod skeleton;

pub use glam;
pub use guided::{EndpointPolicy, GraphBuilder, GuidingRule, SynthesisError, TreeSynth, WeightFn};
pub use observer::{Observer, Progress, Silent, Work};
pub use metrics::Metrics;
pub use parameter::ParameterError;
pub use radius::{RadiusError, RadiusModel};
pub use rand;
pub use skeleton::{Skeleton, SkeletonError};
