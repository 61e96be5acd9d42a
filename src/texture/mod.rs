//! Images that a surface wears: colour, relief, gloss and light from behind.
//!
//! A [`Bark`] makes images of bark, a [`Coat`] those of snow, moss and lichen on it. An [`Image`] is made or read; [`Textures`] are the images of one material, named as glTF names them. A
//! [`Part`](crate::surface::Part) wears them, the writers of [`export`](crate::export) put them into files or beside them.

mod bark;
mod image;
mod mips;
mod textures;
mod tone;

pub use bark::{Bark, BarkKind, BarkSet, Coat};
pub use image::Image;
pub(crate) use mips::normal_mips;
#[cfg(feature = "preview")]
pub(crate) use mips::plain_mips;
pub use mips::{alpha_coverage, mips};
pub use textures::Textures;
pub(crate) use tone::Tones;

use crate::ParameterError;
use std::io;

/// Error of making or reading an image.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TextureError {
    /// An option out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The file is not a PNG, or is broken.
    #[error("cannot read the image: {0}; expected a PNG of at most {max} x {max} pixels", max = Image::LONGEST_SIDE)]
    Png(String),
    /// The reader or writer failed.
    #[error("cannot read or write the image: {0}")]
    Io(#[from] io::Error),
}
