//! Trees.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod export;
pub mod field;
pub mod guided;
pub mod math;
pub mod metrics;
mod observer;
mod parallel;
mod parameter;
pub mod presets;
#[cfg(feature = "preview")]
pub mod preview;
pub mod radius;
pub mod random;
pub mod shape;
pub mod skeleton;
pub mod surface;
#[cfg(feature = "testing")]
pub mod testing;

pub use field::VectorField;
pub use glam;
pub use guided::{EndpointPolicy, GraphBuilder, GuidingRule, SynthesisError, TreeSynth, WeightFn};
pub use metrics::Metrics;
pub use observer::{Observer, Progress, Silent, Work};
pub use parameter::ParameterError;
pub use radius::{RadiusError, RadiusModel};
pub use rand;
pub use shape::{Bounds, Shape};
pub use skeleton::{Skeleton, SkeletonError};
