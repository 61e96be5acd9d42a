//! The images of one material.

use super::{Image, TextureError};
use crate::ParameterError;

/// The images that a mesh with texture coordinates wears, in glTF's meaning. Each is optional; what a
/// [`Material`](crate::surface::Material) says of the same property is multiplied by it.
///
/// ```
/// use treesynth::texture::{Image, Textures};
///
/// let half = Image::new(2, 1, 4, vec![90, 130, 50, 255, 90, 130, 50, 0])?;
/// let card = Textures::default().with_base_color(half).with_alpha_cutoff(0.5);
/// assert!(card.is_masked());
/// # Ok::<(), treesynth::texture::TextureError>(())
/// ```
#[must_use]
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Textures {
    base_color: Option<Image>,
    normal: Option<Image>,
    occlusion_roughness_metallic: Option<Image>,
    transmission: Option<Image>,
    alpha_cutoff: Option<f32>,
}

impl Textures {
    /// The colour, sRGB; with a fourth channel, how much of a pixel is covered.
    pub fn with_base_color(mut self, image: Image) -> Self {
        self.base_color = Some(image);
        self
    }

    /// The normals in tangent space, linear: red along the tangent, green **up** the image (+Y), blue out of the surface; each
    /// channel from -1 (0) to 1 (255).
    pub fn with_normal(mut self, image: Image) -> Self {
        self.normal = Some(image);
        self
    }

    /// Linear: red how open a point is to light from everywhere, green how rough, blue how metallic (0 for plants).
    pub fn with_occlusion_roughness_metallic(mut self, image: Image) -> Self {
        self.occlusion_roughness_metallic = Some(image);
        self
    }

    /// The colour of light that passes through from behind, sRGB: black where none does. glTF has it in
    /// `KHR_materials_diffuse_transmission`.
    pub fn with_transmission(mut self, image: Image) -> Self {
        self.transmission = Some(image);
        self
    }

    /// Pixels whose alpha is below this, 0 to 1, are not drawn at all (`alphaMode: MASK`). Without it alpha is ignored.
    pub fn with_alpha_cutoff(mut self, cutoff: f32) -> Self {
        self.alpha_cutoff = Some(cutoff);
        self
    }

    /// The colour, if there is an image of it.
    pub fn base_color(&self) -> Option<&Image> {
        self.base_color.as_ref()
    }

    /// The normals, if there is an image of them.
    pub fn normal(&self) -> Option<&Image> {
        self.normal.as_ref()
    }

    /// Occlusion, roughness and metal, if there is an image of them.
    pub fn occlusion_roughness_metallic(&self) -> Option<&Image> {
        self.occlusion_roughness_metallic.as_ref()
    }

    /// Light from behind, if there is an image of it.
    pub fn transmission(&self) -> Option<&Image> {
        self.transmission.as_ref()
    }

    /// Alpha below which nothing is drawn, if anything is cut out.
    pub fn alpha_cutoff(&self) -> Option<f32> {
        self.alpha_cutoff
    }

    /// `true` if there are holes: an alpha channel and a cutoff.
    pub fn is_masked(&self) -> bool {
        self.alpha_cutoff.is_some() && self.base_color.as_ref().is_some_and(Image::has_alpha)
    }

    /// Checks that they can be written and drawn.
    ///
    /// # Errors
    /// A cutoff outside 0 to 1; maps other than the colour that do not have three channels; a colour of one channel.
    pub fn check(&self) -> Result<(), TextureError> {
        if let Some(cutoff) = self.alpha_cutoff {
            ParameterError::unless((0.0..=1.0).contains(&cutoff), "Textures.alpha_cutoff", cutoff, "0 to 1")?;
        }
        let channels = |image: &Option<Image>| image.as_ref().map_or(3, Image::channels);
        let holds = channels(&self.base_color) != 1;
        ParameterError::unless(holds, "Textures.base_color", "1 channel", "of 3 or 4 channels")?;
        for (name, image) in [
            ("Textures.normal", &self.normal),
            ("Textures.occlusion_roughness_metallic", &self.occlusion_roughness_metallic),
            ("Textures.transmission", &self.transmission),
        ] {
            ParameterError::unless(channels(image) == 3, name, channels(image), "of 3 channels")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_is_named() {
        let image =
            |channels| Image::new(1, 1, channels, vec![128; usize::from(channels)]).expect("sizes are right");
        let fine = Textures::default().with_base_color(image(4)).with_alpha_cutoff(0.5);
        assert!(fine.check().is_ok() && fine.is_masked());
        for (wrong, name) in [
            (fine.clone().with_alpha_cutoff(f32::NAN), "Textures.alpha_cutoff"),
            (Textures::default().with_base_color(image(1)), "Textures.base_color"),
            (Textures::default().with_normal(image(4)), "Textures.normal"),
            (Textures::default().with_transmission(image(1)), "Textures.transmission"),
        ] {
            let error = wrong.check().expect_err("out of range").to_string();
            assert!(error.starts_with(name), "{error}");
        }
    }
}
