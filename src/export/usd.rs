//! Pixar's Universal Scene Description: text (`.usda`) and archives of it with its images (`.usdz`).
//!
//! `Mesh` prims, `PointInstancer` for instances, `UsdPreviewSurface` materials with `UsdUVTexture`, a variant set for levels or
//! seasons, and instances of whole trees for scenes. Specification: <https://openusd.org/release/api/index.html>,
//! <https://openusd.org/release/spec_usdpreviewsurface.html>, <https://openusd.org/release/spec_usdz.html>.

mod archive;
mod material;
mod prim;
mod stage;

use super::images::{Map, Uses};
use super::{Axes, ExportError, check_parts, check_scene};
use crate::ParameterError;
use crate::surface::{Part, Scene};
use stage::Layer;
use std::collections::BTreeSet;
use std::io::{self, Write};

/// Contents of a USD file: parts, or several lists of them to choose from, or trees in their places.
///
/// ```
/// use treesynth::export::{UsdStage, write_usda};
/// use treesynth::glam::Vec3;
/// use treesynth::surface::{Mesh, Part};
///
/// let triangle = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2]);
/// let parts = [Part::new(&triangle)];
/// let mut usda = Vec::new();
/// write_usda(&UsdStage::of_parts(&parts).with_name("elm"), &mut usda)?;
/// assert!(String::from_utf8_lossy(&usda).contains("def Mesh \"bark\""));
/// # Ok::<(), treesynth::export::ExportError>(())
/// ```
#[must_use]
#[derive(Debug, Clone)]
pub struct UsdStage<'a> {
    name: String,
    axes: Axes,
    content: Content<'a>,
}

impl UsdStage<'_> {
    /// The name set by [`with_name`](Self::with_name).
    pub fn name(&self) -> &str {
        &self.name
    }
}

crate::recipe::readable!(UsdStage<'_> { axes: Axes });

#[derive(Debug, Clone)]
enum Content<'a> {
    Parts(Vec<Part<'a>>),
    /// The name of the set, and what there is to choose from.
    Variants(String, Vec<(String, Vec<Part<'a>>)>),
    Scene(Scene<'a>),
}

impl<'a> UsdStage<'a> {
    fn new(content: Content<'a>) -> Self {
        Self { name: "tree".into(), axes: Axes::default(), content }
    }

    /// One tree.
    pub fn of_parts(parts: &[Part<'a>]) -> Self {
        Self::new(Content::Parts(parts.to_vec()))
    }

    /// One tree in several levels of detail, the finest first: the variants `LOD0`, `LOD1` and so on of the set `LOD`, of which
    /// the finest is chosen.
    pub fn of_levels(levels: &[impl AsRef<[Part<'a>]>]) -> Self {
        let named =
            |(index, level): (usize, &_)| (format!("LOD{index}"), AsRef::<[_]>::as_ref(level).to_vec());
        Self::new(Content::Variants("LOD".into(), levels.iter().enumerate().map(named).collect()))
    }

    /// One tree in several ways to choose from, such as seasons; the first is chosen. Names are letters, digits and `_`.
    pub fn of_variants(set: &str, variants: &[(&str, &[Part<'a>])]) -> Self {
        let variants = variants.iter().map(|(name, parts)| ((*name).to_owned(), parts.to_vec())).collect();
        Self::new(Content::Variants(set.into(), variants))
    }

    /// Trees in their places: those that are the same are instances of one.
    pub fn of_scene(scene: &Scene<'a>) -> Self {
        Self::new(Content::Scene(scene.clone()))
    }

    /// The name of the root, default `tree`; characters other than letters and digits become `_`.
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Up axis (`upAxis`), unit (`metersPerUnit`) and origin; default +Y, metres, zero.
    pub fn with_axes(mut self, axes: Axes) -> Self {
        self.axes = axes;
        self
    }

    /// All parts, in the order in which they are written.
    fn parts(&self) -> Vec<Part<'a>> {
        match &self.content {
            Content::Parts(parts) => parts.clone(),
            Content::Variants(_, variants) => variants.iter().flat_map(|(_, parts)| parts.clone()).collect(),
            Content::Scene(scene) => scene.assets().iter().flat_map(|asset| asset.parts().to_vec()).collect(),
        }
    }

    fn check(&self) -> Result<(), ExportError> {
        self.axes.check()?;
        match &self.content {
            Content::Parts(parts) => check_parts(parts),
            Content::Scene(scene) => check_scene(scene),
            Content::Variants(set, variants) => {
                if variants.is_empty() {
                    return Err(ExportError::EmptyMesh);
                }
                let range = "letters, digits and _, beginning with no digit";
                let sound = |name: &str| !name.is_empty() && prim::identifier(name) == name;
                ParameterError::unless(sound(set), "UsdStage.set", set, range)?;
                let names: BTreeSet<_> = variants.iter().map(|(name, _)| name).collect();
                let holds = names.len() == variants.len() && names.iter().all(|name| sound(name));
                let all: Vec<_> = variants.iter().map(|(name, _)| name).collect();
                let range = "names that differ, of letters, digits and _, beginning with no digit";
                ParameterError::unless(holds, "UsdStage.variants", all, range)?;
                variants.iter().try_for_each(|(_, parts)| check_parts(parts))
            }
        }
    }

    fn uses(&self) -> Uses<'a> {
        Uses::of(&self.parts(), &[Map::Color, Map::Normal, Map::Surface])
    }
}

/// Writes a stage as text. Instances are points of a `PointInstancer`, their rotations in 16-bit floats, as
/// USD has them; tints are its `displayColor`, which parts without an image of their colour are drawn in; a
/// mesh with colours of its own and tinted copies is written once with all of them in it, since the two
/// cannot be multiplied. Images are named as `usd_images` (feature `texture`) gives them, and belong next to
/// the file. Data that `UsdPreviewSurface` cannot express is left out: light from behind, tangents, wind.
///
/// O(vertices + triangles + instances) time; O(instances) memory, and that of the copies which are written as one mesh.
///
/// # Errors
/// Parts, variants or scenes without a triangle, or that are not sound; axes out of range; names of variants that are no words;
/// whatever the writer returns. Once a byte is written, nothing but the writer can fail.
pub fn write_usda(stage: &UsdStage<'_>, writer: impl Write) -> Result<(), ExportError> {
    stage.check()?;
    let mut writer = io::BufWriter::with_capacity(1 << 16, writer);
    Layer::new(stage, &stage.uses()).write(&mut writer)?;
    // Flushing by hand: dropping a BufWriter swallows the error.
    writer.flush()?;
    Ok(())
}

/// Writes a stage and all its images as one archive (`.usdz`): stored, each file at a multiple of 64 bytes. The text is
/// made twice, first for its checksum, so that it never is in memory as a whole.
///
/// # Errors
/// As of [`write_usda`]; more than 4 GiB; a stage's or a part's name of more than 65,000 bytes, for those of files in an archive have
/// 16-bit lengths.
pub fn write_usdz(stage: &UsdStage<'_>, writer: impl Write) -> Result<(), ExportError> {
    stage.check()?;
    let uses = stage.uses();
    let layer = Layer::new(stage, &uses);
    let mut writer = io::BufWriter::with_capacity(1 << 16, writer);
    let name = format!("{}.usda", prim::identifier(&stage.name));
    let mut sum = archive::Sum::default();
    layer.write(&mut sum)?;
    let images: Vec<_> = uses.files().iter().map(|file| (file.name().to_owned(), file.png())).collect();
    let texts = [(name, sum)].into_iter();
    let files = texts.chain(images.iter().map(|(name, png)| (name.clone(), archive::Sum::of(png)))).collect();
    let archive = archive::Archive::new(files)?;
    archive.write(&mut writer, |index, writer| match index.checked_sub(1) {
        None => layer.write(writer),
        Some(image) => writer.write_all(&images[image].1),
    })?;
    writer.flush()?;
    Ok(())
}

/// The images that the text of [`write_usda`] names, each once, to be written next to it.
#[cfg(feature = "texture")]
pub fn usd_images<'a>(stage: &UsdStage<'a>) -> Vec<super::ImageFile<'a>> {
    stage.uses().files()
}

#[cfg(test)]
mod tests;
