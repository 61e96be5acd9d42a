//! Look of a surface.

use crate::{ParameterError, math};

/// A colour, a roughness, and whether both sides are seen: what glTF calls a non-metallic material.
///
/// ```
/// use treesynth::surface::Material;
///
/// let leaf = Material::leaf().with_srgb([86, 125, 50]);
/// assert!(leaf.is_double_sided());
/// assert_eq!(leaf.srgb(), [86, 125, 50]);
/// ```
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Material {
    color: [f32; 3],
    roughness: f32,
    double_sided: bool,
}

crate::recipe::readable!(Material { double_sided: bool });

impl Default for Material {
    /// As [`bark`](Self::bark).
    fn default() -> Self {
        Self::bark()
    }
}

impl Material {
    /// A grey-brown bark, roughness 0.9, seen from outside only.
    pub const fn bark() -> Self {
        Self { color: [0.16, 0.118, 0.088], roughness: 0.9, double_sided: false }
    }

    /// The green of a broad leaf in summer, roughness 0.6, seen from both sides.
    pub const fn leaf() -> Self {
        Self { color: [0.093, 0.205, 0.032], roughness: 0.6, double_sided: true }
    }

    /// White bark, for meshes with colours of their own ([`Mesh::colors`](super::Mesh::colors)), which materials are multiplied by.
    pub const fn white() -> Self {
        Self { color: [1.0; 3], ..Self::bark() }
    }

    /// The part of the light that is reflected: linear (not sRGB) red, green, blue, each 0 to 1.
    pub const fn with_color(mut self, linear: [f32; 3]) -> Self {
        self.color = linear;
        self
    }

    /// The same as [`with_color`](Self::with_color), from the 8 bits per channel that colour pickers show.
    pub fn with_srgb(self, encoded: [u8; 3]) -> Self {
        self.with_color(encoded.map(|channel| math::linear(f32::from(channel) / 255.0)))
    }

    /// 0 (a mirror) to 1 (chalk).
    pub const fn with_roughness(mut self, roughness: f32) -> Self {
        self.roughness = roughness;
        self
    }

    /// Makes triangles visible from behind too, as leaves should be.
    pub const fn with_double_sided(mut self, double_sided: bool) -> Self {
        self.double_sided = double_sided;
        self
    }

    /// Linear red, green, blue.
    pub fn color(&self) -> [f32; 3] {
        self.color
    }

    /// The colour as 8 bits per channel, sRGB.
    pub fn srgb(&self) -> [u8; 3] {
        self.color.map(|channel| (math::srgb(channel) * 255.0 + 0.5) as u8)
    }

    /// 0 (a mirror) to 1 (chalk).
    pub fn roughness(&self) -> f32 {
        self.roughness
    }

    /// `true` if triangles are visible from behind too.
    pub fn is_double_sided(&self) -> bool {
        self.double_sided
    }

    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        let holds = self.color.iter().all(|channel| (0.0..=1.0).contains(channel));
        ParameterError::unless(holds, "Material.color", self.color, "0 to 1 in each channel, linear")?;
        let holds = (0.0..=1.0).contains(&self.roughness);
        ParameterError::unless(holds, "Material.roughness", self.roughness, "0 to 1")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tone_comes_back() {
        for tone in 0..=255 {
            assert_eq!(Material::bark().with_srgb([tone; 3]).srgb(), [tone; 3]);
        }
        // The middle grey of photographers, 18% linear, is 118 in sRGB.
        assert_eq!(Material::bark().with_color([0.18; 3]).srgb(), [118; 3]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        assert!(Material::leaf().check().is_ok());
        let nan = f32::NAN;
        for wrong in [Material::bark().with_color([0.0, nan, 0.0]), Material::bark().with_color([1.1; 3])] {
            assert_eq!(wrong.check().expect_err("out of range").parameter, "Material.color");
        }
        for roughness in [nan, -0.1, 1.5] {
            let wrong = Material::bark().with_roughness(roughness);
            assert_eq!(wrong.check().expect_err("out of range").parameter, "Material.roughness");
        }
    }
}
