//! proptest strategies, and for each trait of the pipeline one function that checks an implementation against
//! its contract.
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
//!         treesynth::testing::check_rule(Wind, &graph, seed)?;
//!     }
//! }
//! # wind_holds();
//! ```
//!
//! Strategies: [`regions`], [`graphs`], [`options`] for whole pipelines, [`skeletons`]. Checks of
//! implementations: [`check_builder`], [`check_rule`], [`check_weight`], [`check_endpoints`],
//! [`check_radius`], [`check_shape`], [`check_field`]. Checks of results: [`check_synth`], [`check_growth`]
//! and [`check_skeleton`].

pub use proptest;

mod check;
mod options;
mod strategies;

pub use check::{
    CheckResult, check_builder, check_endpoints, check_field, check_growth, check_radius, check_rule,
    check_shape, check_skeleton, check_synth, check_weight,
};
pub use options::{Options, RuleOption, StageOptions, WeightOption, options};
pub use strategies::{Region, graphs, regions, skeletons};
