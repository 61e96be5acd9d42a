//! Trees in [Bevy](https://bevy.org): meshes with all their attributes, images with their smaller sizes, materials, levels of
//! detail, and what moves in the wind.
//!
//! [`pieces`] turns a level of a tree into Bevy's types, for which Bevy's small crates are enough; with the feature `pbr`,
//! `spawn` puts all levels of a tree into a world. Axes and unit are the same in both: +Y up, right-handed, metres.
//!
//! ```
//! use treesynth_bevy::pieces;
//!
//! let oak = treesynth::species::by_name("oak")?.request().with_height(4.0).with_seed(7).grow()?;
//! let levels = oak.levels(Some(3_000), 128, &[1.0, 0.3])?;
//! for piece in pieces(&levels[0]) {
//!     println!("{}: {} vertices, {} times", piece.name, piece.mesh.count_vertices(), piece.places.len());
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod image;
mod mesh;
mod piece;
#[cfg(feature = "pbr")]
mod scene;

pub use image::{Use, image};
pub use mesh::{WIND_LIMB, WIND_LIMB_AXIS, WIND_TRUNK, WIND_TWIG, WIND_TWIG_AXIS, merged, mesh};
pub use piece::{Images, Piece, pieces};
#[cfg(feature = "pbr")]
pub use scene::{Kept, keep, material, ranges, spawn};
