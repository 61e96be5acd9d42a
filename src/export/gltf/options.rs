//! The options of a glTF file.

use super::{Breeze, WindEncoding};
use crate::ParameterError;
use crate::surface::Material;
use glam::Vec3;

/// Form of a mesh with many copies in a glTF file.
///
/// ```
/// use treesynth::export::{GlbOptions, Instancing};
///
/// // A small file for three.js: each leaf's triangles once.
/// let options = GlbOptions::default().with_instancing(Instancing::Extension);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum Instancing {
    /// One mesh of all copies, multiplied out on their way into the file: core glTF, whole in every reader. A
    /// copy takes all bytes of its vertices; indices are shared by many copies. Tints are vertex colours
    /// (`COLOR_0`, 8 bits per channel).
    #[default]
    Merged,
    /// `EXT_mesh_gpu_instancing`: 40 bytes per instance, drawn at once; tints are `_COLOR_0`, 12 bytes more.
    /// Blender and three.js read it (`scripts/check_exports`), and others; a program that does not shows one
    /// leaf at the trunk base.
    Extension,
    /// One node per instance, which every program reads: about 200 bytes each, and as many objects in the
    /// program. Each tint is a material of its own, rounded to 32 steps per channel, so that there are not
    /// too many.
    Nodes,
}

/// Form of the levels of [`write_glb_levels`](super::write_glb_levels) in a glTF file.
///
/// To get one file per level, write each level by [`write_glb_parts`](super::write_glb_parts).
///
/// ```
/// use treesynth::export::{GlbOptions, LevelNodes};
///
/// // For Unity, Unreal and Godot: oak_LOD0, oak_LOD1 and so on.
/// let options = GlbOptions::default().with_name("oak").with_levels(LevelNodes::Named);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
#[doc(alias("LOD", "MSFT_lod"))]
pub enum LevelNodes {
    /// `MSFT_lod`: a program that does not know the extension shows the finest level alone.
    #[default]
    Extension,
    /// Nodes side by side, named `NAME_LOD0`, `NAME_LOD1` and so on, as the importers of Unity, Unreal and Godot take them. A
    /// program that does not know the names shows all levels at once.
    Named,
}

/// Contents of a glTF file in addition to the triangles.
///
/// glTF fixes the axes and the unit (+Y up, metres), so there is no choice of these; other formats have
/// [`Axes`](crate::export::Axes).
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct GlbOptions {
    pub(super) name: String,
    pub(super) material: Material,
    pub(super) instancing: Instancing,
    pub(super) levels: LevelNodes,
    pub(super) coverages: Vec<f32>,
    pub(super) quantization: bool,
    pub(super) origin: Vec3,
    pub(super) wind: WindEncoding,
    pub(super) breeze: Option<Breeze>,
    #[cfg(feature = "jpeg")]
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub(super) jpeg: Option<u8>,
}

impl GlbOptions {
    /// The name set by [`with_name`](Self::with_name).
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The coverages set by [`with_coverages`](Self::with_coverages).
    pub fn coverages(&self) -> &[f32] {
        &self.coverages
    }

    /// The breeze set by [`with_breeze`](Self::with_breeze).
    pub fn breeze(&self) -> Option<&Breeze> {
        self.breeze.as_ref()
    }
}

crate::recipe::readable!(GlbOptions {
    material: Material,
    instancing: Instancing,
    levels: LevelNodes,
    quantization: bool,
    origin: Vec3,
    wind: WindEncoding,
});
#[cfg(feature = "jpeg")]
crate::recipe::readable!(GlbOptions { jpeg: Option<u8> });

impl Default for GlbOptions {
    /// Named `tree`, [`Material::bark`], [`Instancing::Merged`], [`LevelNodes::Extension`], no screen coverages, not
    /// quantized, [`WindEncoding::Attributes`], no breeze, PNG images: a core glTF file.
    fn default() -> Self {
        Self {
            name: "tree".into(),
            material: Material::bark(),
            instancing: Instancing::default(),
            levels: LevelNodes::default(),
            coverages: Vec::new(),
            quantization: false,
            origin: Vec3::ZERO,
            wind: WindEncoding::default(),
            breeze: None,
            #[cfg(feature = "jpeg")]
            jpeg: None,
        }
    }
}

impl GlbOptions {
    /// The name of the scene's node; any text; default `tree`.
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Material of the mesh that [`write_glb`](super::write_glb) is given; default [`Material::bark`]. Parts bring their own.
    pub fn with_material(mut self, material: Material) -> Self {
        self.material = material;
        self
    }

    /// Form of instances; default [`Instancing::Merged`].
    pub fn with_instancing(mut self, instancing: Instancing) -> Self {
        self.instancing = instancing;
        self
    }

    /// Form of levels; default [`LevelNodes::Extension`].
    pub fn with_levels(mut self, levels: LevelNodes) -> Self {
        self.levels = levels;
        self
    }

    /// Part of the screen's height down to which each level of [`write_glb_levels`](super::write_glb_levels)
    /// is shown, 0 to 1, falling: `MSFT_screencoverage`. Default none: the program decides. Scenes have no
    /// levels: they ignore this.
    pub fn with_coverages(mut self, coverages: impl Into<Vec<f32>>) -> Self {
        self.coverages = coverages.into();
        self
    }

    /// Rounds numbers, so that a file has about half the bytes or less (`KHR_mesh_quantization`): positions
    /// to 1/65,535 of the mesh's longest side, normals, tangents and colours to 8 bits, texture coordinates
    /// to 16 bits where all lie in 0 to 1. Default false, for the extension is **required** then: readers
    /// without it reject the file. three.js, Blender, Godot, Babylon.js and glTFast know it.
    ///
    /// Each mesh's node scales it back. Moments and flutter of the wind are in the same numbers as the positions.
    pub fn with_quantization(mut self, quantization: bool) -> Self {
        self.quantization = quantization;
        self
    }

    /// The point, metres, that becomes the file's origin: by a translation of the root node, no vertex changes. Default zero.
    pub fn with_origin(mut self, origin: Vec3) -> Self {
        self.origin = origin;
        self
    }

    /// Encoding of the vertices' [`Wind`](crate::surface::Wind), if they have it; default [`WindEncoding::Attributes`].
    pub fn with_wind(mut self, encoding: WindEncoding) -> Self {
        self.wind = encoding;
        self
    }

    /// Bones and an animation of a breeze for the parts that have [`Wind`](crate::surface::Wind), in a file of one level that is
    /// not quantized; default none.
    pub fn with_breeze(mut self, breeze: Breeze) -> Self {
        self.breeze = Some(breeze);
        self
    }

    /// Quality, 1 to 100, of images without alpha as [JPEG](crate::texture::Image::jpeg); those with alpha stay PNG. Default none: all are PNG,
    /// as they are. An oak of three levels with images of 512 pixels has 4.0 MB so, 2.9 MB at 85.
    #[cfg(feature = "jpeg")]
    pub fn with_jpeg(mut self, quality: Option<u8>) -> Self {
        self.jpeg = quality;
        self
    }

    pub(super) fn check(&self, levels: usize) -> Result<(), ParameterError> {
        self.material.check()?;
        let coverages = &self.coverages;
        let holds = coverages.is_empty()
            || coverages.len() == levels
                && coverages.iter().all(|coverage| (0.0..=1.0).contains(coverage))
                && coverages.is_sorted_by(|a, b| a > b);
        let still = self.breeze.is_none();
        ParameterError::unless(still || levels == 1, "GlbOptions.breeze", levels, "in a file of one level")?;
        let exact = still || !self.quantization;
        ParameterError::unless(
            exact,
            "GlbOptions.quantization",
            true,
            "false with a breeze, whose bones are in metres",
        )?;
        let range = "falling numbers from 1 to 0, one per level, or none";
        ParameterError::unless(holds, "GlbOptions.coverages", coverages, range)?;
        #[cfg(feature = "jpeg")]
        if let Some(quality) = self.jpeg {
            ParameterError::unless((1..=100).contains(&quality), "GlbOptions.jpeg", quality, "1 to 100")?;
        }
        let origin = self.origin;
        ParameterError::unless(origin.is_finite(), "GlbOptions.origin", origin, "finite, metres")
    }
}
