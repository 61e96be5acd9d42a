//! Materials and images of a glTF file.

use super::options::GlbOptions;
use super::text::{entry, escaped, numbers, push};
use crate::export::pool::Pool;
use crate::export::worn::{self, Image, Textures};
use crate::parallel;
use crate::surface::{Material, Part};
use std::collections::BTreeMap;

/// Half of the light that a leaf scatters goes through it, where there is an image of that light.
const TRANSMITTED: f32 = 0.5;

/// Steps per channel of tints that are materials of their own.
const TINTS: f32 = 32.0;

/// All materials, and their images.
#[derive(Debug)]
pub(super) struct Looks<'a> {
    all: Vec<Look<'a>>,
    /// Materials for the tints of others.
    tinted: BTreeMap<(usize, [u8; 3]), usize>,
    images: Pool<'a, Image>,
    names: Vec<String>,
}

#[derive(Debug, Clone, PartialEq)]
struct Look<'a> {
    name: &'a str,
    material: Material,
    /// The image of each map, if there is one.
    base_color: Option<usize>,
    normal: Option<usize>,
    surface: Option<usize>,
    transmission: Option<usize>,
    /// Alpha below which nothing is drawn.
    cutoff: Option<f32>,
}

impl<'a> Looks<'a> {
    pub(super) fn new() -> Self {
        Self { all: Vec::new(), tinted: BTreeMap::new(), images: Pool::new(), names: Vec::new() }
    }

    /// The material of a part.
    pub(super) fn material(&mut self, part: &Part<'a>) -> usize {
        let textures = worn::textures(part);
        let mut image = |image: Option<&'a Image>, map: &str| {
            let index = self.images.index(image?);
            if index == self.names.len() {
                self.names.push(format!("{} {map}", part.name()));
            }
            Some(index)
        };
        let look = Look {
            name: part.name(),
            material: part.material(),
            base_color: image(textures.and_then(Textures::base_color), "colour"),
            normal: image(textures.and_then(Textures::normal), "normal"),
            surface: image(textures.and_then(Textures::occlusion_roughness_metallic), "surface"),
            transmission: image(textures.and_then(Textures::transmission), "transmission"),
            cutoff: textures.filter(|worn| worn.is_masked()).and_then(Textures::alpha_cutoff),
        };
        self.index(look)
    }

    fn index(&mut self, look: Look<'a>) -> usize {
        self.all.iter().position(|other| *other == look).unwrap_or_else(|| {
            self.all.push(look);
            self.all.len() - 1
        })
    }

    /// A material in the tint of a copy.
    pub(super) fn tinted(&mut self, material: usize, tint: [f32; 3]) -> usize {
        if tint.map(f32::to_bits) == [1.0_f32; 3].map(f32::to_bits) {
            return material;
        }
        let steps = tint.map(|channel| (channel * TINTS + 0.5) as u8);
        if let Some(&found) = self.tinted.get(&(material, steps)) {
            return found;
        }
        let mut look = self.all[material].clone();
        let [a, b, c] = look.material.color();
        let [d, e, f] = steps.map(|step| f32::from(step) / TINTS);
        look.material = look.material.with_color([a * d, b * e, c * f]);
        let index = self.index(look);
        self.tinted.insert((material, steps), index);
        index
    }

    /// `true` if a material lets light through from behind.
    pub(super) fn transmits(&self) -> bool {
        self.all.iter().any(|look| look.transmission.is_some())
    }

    /// The images as files, in order.
    pub(super) fn files(&self, options: &GlbOptions) -> Vec<Vec<u8>> {
        let images = self.images.items();
        parallel::map(images.len(), |i| file(images[i], options))
    }

    /// Materials, and if there are images, these, textures and a sampler; the first image lies in the buffer view `first`.
    pub(super) fn text(&self, first: usize, options: &GlbOptions) -> String {
        let materials = entry("materials", &self.all, Look::text);
        if self.names.is_empty() {
            return materials;
        }
        let images = entry("images", self.names.iter().enumerate(), |(index, name)| {
            let view = first + index;
            let form = if is_jpeg(self.images.items()[index], options) { "jpeg" } else { "png" };
            format!(r#"{{"name":{},"mimeType":"image/{form}","bufferView":{view}}}"#, escaped(name))
        });
        let textures = entry("textures", 0..self.names.len(), |i| format!(r#"{{"sampler":0,"source":{i}}}"#));
        // Linear, linear between mipmaps; repeated both ways.
        let sampler = r#""samplers":[{"magFilter":9729,"minFilter":9987,"wrapS":10497,"wrapT":10497}],"#;
        materials + &images + &textures + sampler
    }
}

/// `true` if an image is written as JPEG.
#[cfg(feature = "jpeg")]
fn is_jpeg(image: &Image, options: &GlbOptions) -> bool {
    options.jpeg.is_some() && !image.has_alpha()
}

#[cfg(not(feature = "jpeg"))]
fn is_jpeg(_: &Image, _: &GlbOptions) -> bool {
    false
}

#[cfg(feature = "jpeg")]
fn file(image: &Image, options: &GlbOptions) -> Vec<u8> {
    let quality = options.jpeg.filter(|_| is_jpeg(image, options));
    quality.and_then(|quality| image.jpeg(quality).ok()).unwrap_or_else(|| image.png())
}

#[cfg(not(feature = "jpeg"))]
fn file(image: &Image, _: &GlbOptions) -> Vec<u8> {
    image.png()
}

impl Look<'_> {
    fn text(&self) -> String {
        let [red, green, blue] = self.material.color();
        let texture = |key: &str, image: Option<usize>| {
            image.map_or(String::new(), |index| format!(r#","{key}":{{"index":{index}}}"#))
        };
        let mut text = format!(
            r#"{{"name":{},"pbrMetallicRoughness":{{"baseColorFactor":{},"metallicFactor":{},"roughnessFactor":{}{}{}}}"#,
            escaped(self.name),
            numbers(&[red, green, blue, 1.0]),
            u8::from(self.surface.is_some()),
            f64::from(self.material.roughness()),
            texture("baseColorTexture", self.base_color),
            texture("metallicRoughnessTexture", self.surface),
        );
        push(&mut text, format_args!(r#","doubleSided":{}"#, self.material.is_double_sided()));
        text += &texture("normalTexture", self.normal);
        text += &texture("occlusionTexture", self.surface);
        if let Some(cutoff) = self.cutoff {
            push(&mut text, format_args!(r#","alphaMode":"MASK","alphaCutoff":{}"#, f64::from(cutoff)));
        }
        if let Some(index) = self.transmission {
            push(
                &mut text,
                format_args!(
                    r#","extensions":{{"KHR_materials_diffuse_transmission":{{"diffuseTransmissionFactor":{TRANSMITTED},"diffuseTransmissionColorTexture":{{"index":{index}}}}}}}"#
                ),
            );
        }
        text + "}"
    }
}
