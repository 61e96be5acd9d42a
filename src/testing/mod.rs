//! proptest strategies, and one call for each trait of the pipeline that holds an implementation to its contract.
//!
//! Behind the feature `testing`, for dev-dependencies. A custom rule is property-tested in three lines (and a
//! `#[test]` before them):
//!
//! ```
//! # use treesynth::{GuidingRule, glam::Vec3, guided::Step};
//! # struct Wind;
//! # impl GuidingRule for Wind {
//! #     fn guide(&self, step: &Step<'_>) -> Vec3 { step.vector + Vec3::X * 0.1 }
//! # }
//! use treesynth::testing::proptest::prelude::*;
//!
//! proptest! {
//!     # #![proptest_config(ProptestConfig::with_cases(4))]
//!     fn wind_holds(graph in treesynth::testing::graphs(), seed: u64) {
//!         treesynth::testing::hold_rule(Wind, &graph, seed)?;
//!     }
//! }
//! # wind_holds();
//! ```
//!
//! The strategies: [`regions`], [`graphs`], [`options`] for whole pipelines, [`skeletons`]. The calls:
//! [`hold_builder`], [`hold_rule`], [`hold_weight`], [`hold_endpoints`], [`hold_radius`], [`hold_shape`],
//! [`hold_field`], and [`hold_synth`], [`hold_growth`] and [`hold_skeleton`] for what comes out.

pub use proptest;

mod hold;
mod options;
mod strategies;

pub use hold::{
    Held, hold_builder, hold_endpoints, hold_field, hold_growth, hold_radius, hold_rule, hold_shape,
    hold_skeleton, hold_synth, hold_weight,
};
pub use options::{Options, RuleOption, StageOptions, WeightOption, options};
pub use strategies::{Region, graphs, regions, skeletons};
