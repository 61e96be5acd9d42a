//! Trees that fill a given shape at the least cost: Wang and others 2014, "Variational Tree Synthesis".

mod energy;
mod guidance;
mod level;
mod nearest;
mod term;
mod thinning;

pub use energy::{Energy, Wish, guidance, penalty, structure};
pub use guidance::GuidanceShape;
pub use level::{Level, Phyllotaxis};
