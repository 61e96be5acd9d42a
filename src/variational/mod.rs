//! Trees that fill a given shape at the least cost: Wang and others 2014, "Variational Tree Modelling".
//!
//! A [`GuidanceShape`] says what to fill, one [`Level`] after the other how axes are built, and [`VariationalSynth`] looks
//! for the tree that costs the least wood, comes nearest to the shape and keeps to the levels' angles and lengths:
//! [`structure`], [`guidance`] and [`penalty`] are these three terms, each with its gradient.
//!
//! One level after the other, axes are built on the branch nodes that carry many shape nodes; then all nodes move to where
//! the energy is least, and every shape node changes to the nearest branch node, in turns as long as the energy falls.
//! Subtrees that cost less elsewhere are hung there. Then the finest branches are pruned, what they carried hangs on the
//! nearest of what is left, and the levels are run again; the tree of least energy is kept. In the end shape nodes that
//! crowd on a node are gathered on twigs. [`Growth::trace`] has every step, [`VariationalSynth::follow`] shows each tree.
//!
//! The stem's nodes bear n laterals each and no shape nodes, so that N and n can be seen in the finished tree; with n = 1
//! the last lateral is what the stem goes on as. Other nodes have four children at most, one more than n where n is more.
//!
//! ```
//! use treesynth::{glam::Vec3, shape::Ellipsoid};
//! use treesynth::variational::{GuidanceShape, Level, Phyllotaxis, VariationalSynth};
//!
//! let crown = Ellipsoid::new(Vec3::Y * 6.0, Vec3::new(3.0, 4.0, 3.0));
//! let shape = GuidanceShape::on_surface(&crown, 500, 1)?;
//! let trunk = Level::default().with_apical_control(0.5).with_phyllotaxis(Phyllotaxis::Decussate);
//! let tree = VariationalSynth::new(shape).with_levels([trunk, Level::default()]).synthesize(1)?;
//! assert_eq!(tree.tips().count(), 500);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod draft;
mod energy;
mod graft;
mod growth;
mod guidance;
mod letter;
mod level;
mod model;
mod preset;
mod run;
mod synth;
mod term;
mod thinning;
mod update;

pub use energy::{Energy, Wish, guidance, penalty, structure};
pub use growth::{Growth, Step, StepKind, VariationalError};
pub use guidance::GuidanceShape;
pub use level::{Level, Phyllotaxis};
pub use preset::{Preset, presets};
pub use synth::VariationalSynth;
