//! Trees that fill a given shape at the least cost: Wang and others 2014, "Variational Tree Synthesis".

mod draft;
mod energy;
mod guidance;
mod level;
mod model;
mod nearest;
mod preset;
mod synth;
mod term;
mod thinning;
mod update;

pub use energy::{Energy, Wish, guidance, penalty, structure};
pub use guidance::GuidanceShape;
pub use level::{Level, Phyllotaxis};
pub use preset::{Preset, by_name, presets};
pub use synth::{Growth, Step, StepKind, VariationalError, VariationalSynth};
