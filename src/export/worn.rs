//! The images that parts wear. Without the feature `texture` there are none, and the writers need not know.

use crate::surface::Part;

#[cfg(feature = "texture")]
pub(super) use crate::texture::{Image, Textures};

/// Images of a part.
#[cfg(feature = "texture")]
pub(super) fn textures<'a>(part: &Part<'a>) -> Option<&'a Textures> {
    part.textures()
}

#[cfg(not(feature = "texture"))]
pub(super) use none::{Image, Textures, textures};

#[cfg(not(feature = "texture"))]
mod none {
    use super::Part;

    pub(in crate::export) fn textures<'a>(_: &Part<'a>) -> Option<&'a Textures> {
        None
    }

    /// No value: there are no images.
    #[derive(Debug, Clone, PartialEq)]
    pub(in crate::export) enum Image {}

    impl Image {
        pub(in crate::export) fn width(&self) -> u32 {
            match *self {}
        }

        pub(in crate::export) fn height(&self) -> u32 {
            match *self {}
        }

        pub(in crate::export) fn channels(&self) -> u8 {
            match *self {}
        }

        pub(in crate::export) fn bytes(&self) -> &[u8] {
            match *self {}
        }

        pub(in crate::export) fn png(&self) -> Vec<u8> {
            match *self {}
        }
    }

    /// No value: nothing is worn.
    #[derive(Debug)]
    pub(in crate::export) enum Textures {}

    impl Textures {
        pub(in crate::export) fn base_color(&self) -> Option<&Image> {
            match *self {}
        }

        pub(in crate::export) fn normal(&self) -> Option<&Image> {
            match *self {}
        }

        pub(in crate::export) fn occlusion_roughness_metallic(&self) -> Option<&Image> {
            match *self {}
        }

        pub(in crate::export) fn transmission(&self) -> Option<&Image> {
            match *self {}
        }

        pub(in crate::export) fn alpha_cutoff(&self) -> Option<f32> {
            match *self {}
        }

        pub(in crate::export) fn is_masked(&self) -> bool {
            match *self {}
        }
    }
}
