//! SVG (`.svg`): a skeleton as a line drawing, for papers and plotters.

use super::ExportError;
use crate::surface::Material;
use crate::{ParameterError, Skeleton, math};
use glam::{Vec2, Vec3};
use std::io::{self, Write};

/// Style in which a skeleton is drawn.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct SvgOptions {
    size: f32,
    azimuth: f32,
    elevation: f32,
    material: Material,
    thinnest: f32,
}

crate::recipe::readable!(SvgOptions {
    size: f32,
    azimuth: f32,
    elevation: f32,
    material: Material,
    thinnest: f32,
});

impl Default for SvgOptions {
    /// 1000 units on the longer side, seen level from the front (+Z), [`Material::bark`], no line thinner than 0.3.
    fn default() -> Self {
        Self { size: 1000.0, azimuth: 0.0, elevation: 0.0, material: Material::bark(), thinnest: 0.3 }
    }
}

impl SvgOptions {
    /// The longer side of the drawing, units of SVG (96 per inch), 10 to 100,000; default 1000. Coordinates
    /// have two decimals.
    pub fn with_size(mut self, units: f32) -> Self {
        self.size = units;
        self
    }

    /// Direction from which it is seen, radians about the up axis: 0 is +Z, π/2 is +X; default 0.
    pub fn with_azimuth(mut self, azimuth: f32) -> Self {
        self.azimuth = azimuth;
        self
    }

    /// The angle at which it is looked down on, radians, -π/2 to π/2; default 0.
    pub fn with_elevation(mut self, elevation: f32) -> Self {
        self.elevation = elevation;
        self
    }

    /// Material whose colour the lines have; default [`Material::bark`].
    pub fn with_material(mut self, material: Material) -> Self {
        self.material = material;
        self
    }

    /// The width that thinner lines get too, units, 0 to 100; default 0.3. With 0, every width is true.
    pub fn with_thinnest(mut self, units: f32) -> Self {
        self.thinnest = units;
        self
    }

    fn check(&self) -> Result<(), ParameterError> {
        let check = |holds, name: &str, value, range| {
            ParameterError::unless(holds, &format!("SvgOptions.{name}"), value, range)
        };
        check((10.0..=1e5).contains(&self.size), "size", self.size, "10 to 100000 units")?;
        check(self.azimuth.abs() <= 1e4, "azimuth", self.azimuth, "within ±10000 rad")?;
        check(self.elevation.abs() <= 1.571, "elevation", self.elevation, "-π/2 to π/2 rad")?;
        check((0.0..=100.0).contains(&self.thinnest), "thinnest", self.thinnest, "0 to 100 units")?;
        self.material.check()
    }
}

/// Draws every internode of a skeleton as a line of its true width with round ends, in a parallel projection; what is
/// farther away is drawn first.
///
/// The document is as large as the drawing, with no border; one path per internode, in one group. O(n log n)
/// time, O(n) memory.
///
/// ```
/// use treesynth::{Skeleton, export, glam::Vec3};
///
/// let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)])?.with_radii(vec![0.1; 2])?;
/// let mut svg = Vec::new();
/// export::write_svg(&pole, &export::SvgOptions::default(), &mut svg)?;
/// assert!(String::from_utf8_lossy(&svg).contains("<path"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// An option out of range; a skeleton too large to be scaled down in 32-bit floats; whatever the writer returns. Once
/// a byte is written, nothing but the writer can fail.
pub fn write_svg(skeleton: &Skeleton, options: &SvgOptions, writer: impl Write) -> Result<(), ExportError> {
    options.check()?;
    let (sin, cos) = math::sin_cos(options.azimuth);
    let (rise, level) = math::sin_cos(options.elevation);
    let right = Vec3::new(cos, 0.0, -sin);
    let back = Vec3::new(sin * level, rise, cos * level);
    let up = back.cross(right);
    let project = |p: Vec3| Vec2::new(p.dot(right), -p.dot(up));

    let mut low = Vec2::INFINITY;
    let mut high = Vec2::NEG_INFINITY;
    let mut include = |node: usize, radius: f32| {
        let place = project(skeleton.positions()[node]);
        low = low.min(place - radius);
        high = high.max(place + radius);
    };
    include(0, 0.0);
    let mut lines = Vec::with_capacity(skeleton.segments());
    for (node, parent) in skeleton.edges() {
        let radius = skeleton.radii()[node];
        include(node, radius);
        include(parent, radius);
        let [near, far] = [node, parent].map(|end| skeleton.positions()[end].dot(back));
        lines.push((0.5 * near + 0.5 * far, node, parent));
    }
    lines.sort_by(|a, b| a.0.total_cmp(&b.0));
    let extent = high - low;
    let holds = extent.is_finite() && extent.max_element() < 1e30;
    ParameterError::unless(holds, "write_svg.skeleton", extent, "less than 1e30 m wide and high")?;
    let scale = options.size / extent.max_element().max(1e-30);

    let mut writer = io::BufWriter::with_capacity(1 << 16, writer);
    let Vec2 { x: width, y: height } = (extent * scale).max(Vec2::splat(0.01));
    let [red, green, blue] = options.material.srgb();
    writeln!(writer, r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.2} {height:.2}">"#)?;
    writeln!(writer, r##"<g fill="none" stroke="#{red:02x}{green:02x}{blue:02x}" stroke-linecap="round">"##)?;
    for (_, node, parent) in lines {
        let [from, to] = [parent, node].map(|end| (project(skeleton.positions()[end]) - low) * scale);
        let width = (skeleton.radii()[node] * 2.0 * scale).max(options.thinnest);
        writeln!(
            writer,
            r#"<path d="M{:.2} {:.2}L{:.2} {:.2}" stroke-width="{width:.2}"/>"#,
            from.x, from.y, to.x, to.y
        )?;
    }
    writeln!(writer, "</g>\n</svg>")?;
    // Flushing by hand: dropping a BufWriter swallows the error.
    writer.flush()?;
    Ok(())
}
