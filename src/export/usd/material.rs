//! `UsdPreviewSurface` materials.

use crate::export::images::{Map, Uses, is_masked};
use crate::export::worn::{self, Textures};
use crate::surface::{Instance, Material, Part};
use std::io::{self, Write};

/// Look of a part; parts with the same look share a material.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Look {
    /// Name of the part.
    pub(super) name: String,
    material: Material,
    /// `true` if vertices or copies have colours.
    pub(super) colored: bool,
    color: Option<String>,
    normal: Option<String>,
    surface: Option<String>,
    cutoff: Option<f32>,
}

impl Look {
    /// The material of a part, which is number `index` in `uses`.
    pub(super) fn of(part: &Part<'_>, index: usize, uses: &Uses<'_>) -> Self {
        let file = |map| uses.name(index, map).map(str::to_owned);
        let tinted = part.copies().iter().any(Instance::is_tinted);
        Self {
            name: part.name().to_owned(),
            material: part.material(),
            colored: tinted || !part.mesh().colors.is_empty(),
            color: file(Map::Color),
            normal: file(Map::Normal),
            surface: file(Map::Surface),
            cutoff: worn::textures(part).filter(|_| is_masked(part)).and_then(Textures::alpha_cutoff),
        }
    }

    /// The prim `path`, whose last word is `name`.
    pub(super) fn write(&self, writer: &mut impl Write, path: &str, name: &str) -> io::Result<()> {
        let [red, green, blue] = self.material.color();
        let rough = self.material.roughness();
        writeln!(writer, "def Material \"{name}\"\n{{")?;
        writeln!(writer, "token outputs:surface.connect = <{path}/Surface.outputs:surface>")?;
        writeln!(writer, "def Shader \"Surface\"\n{{\nuniform token info:id = \"UsdPreviewSurface\"")?;
        if self.color.is_some() {
            writeln!(writer, "color3f inputs:diffuseColor.connect = <{path}/Color.outputs:rgb>")?;
        } else if self.colored {
            writeln!(writer, "color3f inputs:diffuseColor.connect = <{path}/Own.outputs:result>")?;
        } else {
            writeln!(writer, "color3f inputs:diffuseColor = ({red}, {green}, {blue})")?;
        }
        if self.surface.is_some() {
            writeln!(writer, "float inputs:occlusion.connect = <{path}/Surfaces.outputs:r>")?;
            writeln!(writer, "float inputs:roughness.connect = <{path}/Surfaces.outputs:g>")?;
            writeln!(writer, "float inputs:metallic.connect = <{path}/Surfaces.outputs:b>")?;
        } else {
            writeln!(writer, "float inputs:roughness = {rough}\nfloat inputs:metallic = 0")?;
        }
        if self.normal.is_some() {
            writeln!(writer, "normal3f inputs:normal.connect = <{path}/Normal.outputs:rgb>")?;
        }
        if let Some(cutoff) = self.cutoff {
            writeln!(writer, "float inputs:opacity.connect = <{path}/Color.outputs:a>")?;
            writeln!(writer, "float inputs:opacityThreshold = {cutoff}")?;
        }
        writeln!(writer, "token outputs:surface\n}}")?;
        if self.color.is_none() && self.colored {
            writeln!(writer, "def Shader \"Own\"\n{{\nuniform token info:id = \"UsdPrimvarReader_float3\"")?;
            writeln!(writer, "string inputs:varname = \"displayColor\"")?;
            writeln!(writer, "float3 inputs:fallback = ({red}, {green}, {blue})\nfloat3 outputs:result\n}}")?;
        }
        if self.color.is_some() || self.normal.is_some() || self.surface.is_some() {
            writeln!(writer, "def Shader \"Uv\"\n{{\nuniform token info:id = \"UsdPrimvarReader_float2\"")?;
            writeln!(writer, "string inputs:varname = \"st\"\nfloat2 outputs:result\n}}")?;
        }
        // Numbers are multiplied, then added to.
        let color = format!("float4 inputs:scale = ({red}, {green}, {blue}, 1)");
        let normal = "float4 inputs:scale = (2, 2, 2, 1)\nfloat4 inputs:bias = (-1, -1, -1, 0)".to_owned();
        let surface = format!("float4 inputs:scale = (1, {rough}, 1, 1)");
        for (name, file, space, numbers) in [
            ("Color", &self.color, "sRGB", color),
            ("Normal", &self.normal, "raw", normal),
            ("Surfaces", &self.surface, "raw", surface),
        ] {
            let Some(file) = file else { continue };
            writeln!(writer, "def Shader \"{name}\"\n{{\nuniform token info:id = \"UsdUVTexture\"")?;
            writeln!(writer, "asset inputs:file = @./{file}@\ntoken inputs:sourceColorSpace = \"{space}\"")?;
            writeln!(writer, "float2 inputs:st.connect = <{path}/Uv.outputs:result>\n{numbers}")?;
            writeln!(writer, "token inputs:wrapS = \"repeat\"\ntoken inputs:wrapT = \"repeat\"")?;
            writeln!(writer, "float outputs:r\nfloat outputs:g\nfloat outputs:b\nfloat outputs:a")?;
            writeln!(writer, "float3 outputs:rgb\n}}")?;
        }
        writeln!(writer, "}}")
    }
}
