//! A whole tree as a few pictures.

use super::atlas::{self, Grid, PADDING};
use super::bake::{Baked, Pixel, View, Wanted};
use super::builder::check_side;
use super::fit::THICKER;
use super::measure::{Frame, Tally, bounds, draw, drawn, lit, reach, skins};
use super::{Asset, AssetError, Piece};
use crate::observer::{Observer, Silent, Watch, Work};
use crate::surface::{Instance, Material, Mesh, Part};
use crate::texture::{Image, Tones};
use crate::{ParameterError, math, parallel};
use glam::{Vec2, Vec3, Vec4};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// Drawn steps from one report to the next.
const DRAWN: usize = 1024;

/// Upward component that is added to billboards' unit normals.
const UPWARD: f32 = 0.6;
/// Share that is kept of their part toward the viewer.
const FACING: f32 = 0.35;
/// Points along each side of a baked pixel.
const SAMPLES: usize = 3;
/// Name of the part of crossed billboards.
pub(super) const IMPOSTOR: &str = "impostor";

/// Bakes a tree into pictures, for where it is small.
///
/// ```
/// use treesynth::asset::{AssetBuilder, Impostor};
/// use treesynth::presets;
///
/// let tree = presets::by_name("figure-06b").unwrap().guided().unwrap().synth(2000).synthesize(1)?;
/// let dense = AssetBuilder::default().with_triangles(None).build(&tree, 1)?;
/// let far = Impostor::default().with_texture_size(256).billboards(&dense.parts())?;
/// assert_eq!(far.triangles(), 12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[doc(alias("imposter", "billboard"))]
pub struct Impostor {
    planes: u32,
    lying: bool,
    texture_size: u32,
    grid: u32,
}

crate::recipe::readable!(Impostor { planes: u32, lying: bool, texture_size: u32, grid: u32 });

impl Default for Impostor {
    /// Three upright pictures and none that lies, in an image of 512 pixels; 8 x 8 views.
    fn default() -> Self {
        Self { planes: 3, lying: false, texture_size: 512, grid: 8 }
    }
}

impl Impostor {
    /// Upright billboards, 1 to 8, at even angles about the vertical; default 3.
    pub fn with_planes(mut self, planes: u32) -> Self {
        self.planes = planes;
        self
    }

    /// Adds a horizontal billboard at half the height, for views from above; default false.
    pub fn with_lying(mut self, lying: bool) -> Self {
        self.lying = lying;
        self
    }

    /// The longest side of the images, pixels: a power of two, 128 to 8192; default 512.
    pub fn with_texture_size(mut self, side: u32) -> Self {
        self.texture_size = side;
        self
    }

    /// Views along each side of the octahedral atlas, a power of two, 2 to 32; default 8.
    pub fn with_grid(mut self, views: u32) -> Self {
        self.grid = views;
        self
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless((1..=8).contains(&self.planes), "Impostor.planes", self.planes, "1 to 8")?;
        check_side("Impostor.texture_size", self.texture_size)?;
        let holds = self.grid.is_power_of_two() && (2..=32).contains(&self.grid);
        ParameterError::unless(holds, "Impostor.grid", self.grid, "a power of two, 2 to 32 views")?;
        let cell = self.texture_size / self.grid;
        let range = "at least 16 pixels per view: a larger texture_size or a smaller grid";
        ParameterError::unless(cell >= 16, "Impostor.grid", self.grid, range)
    }

    /// Crossed billboards, which every engine shows: a part `impostor` with four triangles per picture, two
    /// for each side. Their alpha is scaled so that the covered area, on the average of several views, is
    /// that of the model.
    ///
    /// # Errors
    /// An option out of range; parts that cannot be drawn; nothing to be seen.
    pub fn billboards(&self, parts: &[Part<'_>]) -> Result<Asset, AssetError> {
        self.billboards_observed(parts, &Silent)
    }

    /// As [`billboards`](Self::billboards), reporting progress to `observer`, which can cancel the work.
    ///
    /// # Errors
    /// As [`billboards`](Self::billboards), and [`AssetError::Cancelled`].
    pub fn billboards_observed(
        &self,
        parts: &[Part<'_>],
        observer: &dyn Observer,
    ) -> Result<Asset, AssetError> {
        let triangles: u64 = parts.iter().map(Part::triangles).sum();
        let watch = Watch::new(observer, Work::Asset, 60 * triangles as usize / 20, DRAWN);
        self.check()?;
        parts.iter().try_for_each(Part::check::<AssetError>)?;
        let bounds = bounds(parts).ok_or(AssetError::Nothing)?;
        let (center, size) = (bounds.center(), bounds.size());
        let tiny = 1e-3 * size.max_element().max(1e-6);
        let across = 0.5 * Vec2::new(size.x, size.z).length();
        let mut views: Vec<View> = (0..self.planes)
            .map(|plane| {
                let half = Vec2::new(across.max(tiny), (0.5 * size.y).max(tiny));
                View::around(center, half, plane as f32 / self.planes as f32 * PI, 0.0)
            })
            .collect();
        if self.lying {
            let half = Vec2::splat(across.max(tiny));
            views.push(View { right: Vec3::X, up: -Vec3::Z, toward: Vec3::Y, center, half });
        }
        let mut grid = Grid::of(views.len(), 1);
        grid.cell = (self.texture_size as usize / grid.columns.max(grid.rows)).max(4 * PADDING);
        let side = grid.cell - 2 * PADDING;
        let skins = skins(parts);
        let drawn = drawn(parts, &skins);
        let pictures = parallel::map(views.len(), |i| {
            let mut baked = draw(&drawn, views[i], [side; 2], SAMPLES, Wanted::Layers, &watch)
                .finish(|sample| sample.color);
            if i < self.planes as usize {
                baked.pixels.iter_mut().for_each(|pixel| pixel.normal = upright(pixel.normal));
            }
            baked
        });
        watch.pass(0)?;
        let mesh = sides(&views, grid);
        let texel = 2.0 * across.max(0.5 * size.y) / side as f32;
        // It is used well below the size at which a texel is a pixel.
        let frame = Frame::of(parts, (side / 4).clamp(16, 128))?;
        let tally = |parts: &[Part<'_>]| -> Result<Tally, AssetError> {
            let skins = self::skins(parts);
            let drawn = self::drawn(parts, &skins);
            let times = frame.times();
            let each = parallel::map(4 * times, |i| {
                let yaw = 0.3 + (i / times) as f32 / 4.0 * TAU;
                let view = frame.view_beside(yaw, 0.1, i % times);
                Tally::of(
                    &draw(&drawn, view, [frame.width, frame.height], 2, Wanted::Surface, &watch).finish(lit),
                )
            });
            let mut sum = Tally::default();
            for tally in &each {
                sum.add(tally);
            }
            watch.pass(0)?;
            Ok(sum)
        };
        let wanted = tally(parts)?;
        let with = |thicker: f32, gain: [f32; 3]| -> Result<Asset, AssetError> {
            let pictures: Vec<Baked> = pictures.iter().map(|baked| baked.thickened(thicker)).collect();
            let textures = Arc::new(atlas::textures(grid, &pictures, gain, Some(atlas::CUTOFF), &watch)?);
            let piece = Piece {
                name: IMPOSTOR,
                mesh: mesh.clone(),
                material: Material::leaf().with_color([1.0; 3]).with_double_sided(false),
                textures: Some(textures),
                instances: vec![Instance::IDENTITY],
                bent: None,
            };
            Ok(Asset::of_card(piece, texel))
        };
        let (mut low, mut high) = THICKER;
        let mut thicker = 1.0;
        let mut found = with(thicker, [1.0; 3])?;
        let mut now = tally(&found.parts())?;
        for _ in 0..7 {
            let off = now.cover / wanted.cover.max(1e-9) - 1.0;
            if off.abs() < 0.005 {
                break;
            }
            if off > 0.0 {
                high = thicker;
            } else {
                low = thicker;
            }
            thicker = (low * high).sqrt();
            found = with(thicker, [1.0; 3])?;
            now = tally(&found.parts())?;
        }
        let (mut color, wanted) = (now.color(), wanted.color());
        let mut gain = [1.0f32; 3];
        // Other texels are seen than are baked, and so the first change is not quite enough.
        for _ in 0..2 {
            gain = [0, 1, 2].map(|i| (gain[i] * wanted[i] / color[i].max(1e-6)).clamp(0.6, 1.6));
            found = with(thicker, gain)?;
            color = tally(&found.parts())?.color();
        }
        watch.finish()?;
        Ok(found)
    }

    /// Views from all of the upper half of the sphere in one atlas, for shaders that blend those nearest to the viewer's
    /// direction. O(views · triangles).
    ///
    /// # Errors
    /// As [`billboards`](Self::billboards).
    pub fn octahedral(&self, parts: &[Part<'_>]) -> Result<Octahedral, AssetError> {
        self.octahedral_observed(parts, &Silent)
    }

    /// As [`octahedral`](Self::octahedral), reporting progress to `observer`, which can cancel the work.
    ///
    /// # Errors
    /// As [`octahedral`](Self::octahedral), and [`AssetError::Cancelled`].
    pub fn octahedral_observed(
        &self,
        parts: &[Part<'_>],
        observer: &dyn Observer,
    ) -> Result<Octahedral, AssetError> {
        let triangles: u64 = parts.iter().map(Part::triangles).sum();
        let watch = Watch::new(observer, Work::Asset, 60 * triangles as usize / 20, DRAWN);
        self.check()?;
        parts.iter().try_for_each(Part::check::<AssetError>)?;
        let bounds = bounds(parts).ok_or(AssetError::Nothing)?;
        let center = bounds.center();
        let radius = reach(parts, center).max(1e-6);
        let (grid, cell) = (self.grid as usize, (self.texture_size / self.grid) as usize);
        let side = cell - 2 * (PADDING / 2);
        let skins = skins(parts);
        let drawn = drawn(parts, &skins);
        let cells = parallel::map(grid * grid, |number| {
            let view = hemisphere(number % grid, number / grid, grid, center, radius);
            let mut baked =
                draw(&drawn, view, [side; 2], 2, Wanted::Layers, &watch).finish(|sample| sample.color);
            for pixel in &mut baked.pixels {
                let normal = pixel.normal;
                pixel.normal = view.right * normal.x + view.up * normal.y + view.toward * normal.z;
            }
            baked
        });
        watch.finish()?;
        let (width, tones) = (grid * cell, Tones::new());
        let mut color = vec![0; width * width * 4];
        let mut normal = vec![0; width * width * 3];
        let mut depth = vec![0; width * width];
        for (number, baked) in cells.iter().enumerate() {
            let margin = (cell - side) / 2;
            let mut pixels = vec![Pixel::default(); cell * cell];
            for (row, line) in baked.pixels.chunks_exact(side).enumerate() {
                let at = (margin + row) * cell + margin;
                pixels[at..at + side].copy_from_slice(line);
            }
            for (i, pixel) in atlas::bled(&pixels, cell).iter().enumerate() {
                let at = (number / grid * cell + i / cell) * width + number % grid * cell + i % cell;
                for channel in 0..3 {
                    color[at * 4 + channel] = tones.of(pixel.color[channel]);
                    normal[at * 3 + channel] = (pixel.normal[channel] * 127.5 + 128.0) as u8;
                }
                color[at * 4 + 3] = (pixel.cover * 255.0 + 0.5) as u8;
                let near = if pixel.cover > 0.0 { 0.5 + 0.5 * pixel.depth / radius } else { 0.0 };
                depth[at] = (near.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
            }
        }
        let pixels = width as u32;
        Ok(Octahedral {
            color: Image::new(pixels, pixels, 4, color)?,
            normal: Image::new(pixels, pixels, 3, normal)?,
            depth: Image::new(pixels, pixels, 1, depth)?,
            grid: self.grid,
            margin: ((cell - side) / 2) as u32,
            center,
            radius,
        })
    }
}

/// Two triangles on each side of each picture, worn from the cells of a grid.
fn sides(views: &[View], grid: Grid) -> Mesh {
    let mut mesh = Mesh::default();
    for (number, view) in views.iter().enumerate() {
        let first = mesh.positions.len() as u32;
        let ([u, v], [wide, high]) = grid.inner(number);
        // Each side has triangles and a frame of its own. If both sides shared them, renderers would flip the
        // normals for the back, and light from the left would come from the right: there would be a seam
        // where billboards cross.
        for side in [1.0, -1.0] {
            for (sx, sy) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                mesh.positions
                    .push(view.center + view.right * (view.half.x * sx) + view.up * (view.half.y * sy));
                mesh.normals.push(view.toward * side);
                mesh.tangents.push(Vec4::from((view.right, side)));
                mesh.uvs.push(Vec2::new(u + wide * (0.5 + 0.5 * sx), v + high * (0.5 - 0.5 * sy)));
            }
        }
        mesh.indices.extend([0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 7, 6].map(|corner| first + corner));
    }
    mesh
}

/// The normal that a billboard shows where the tree has this one, in the frame of its view. A billboard
/// stands in the middle of the crown: there normals lie in its plane, or look up. With the normals of the
/// side from which it was baked, a billboard that is seen edge-on would be much darker or lighter than the
/// others.
fn upright(normal: Vec3) -> Vec3 {
    if normal == Vec3::ZERO {
        return normal;
    }
    Vec3::new(normal.x, normal.y + UPWARD, FACING * normal.z).normalize_or(Vec3::Y)
}

/// The view of one cell of the octahedral atlas.
fn hemisphere(column: usize, row: usize, grid: usize, center: Vec3, radius: f32) -> View {
    let at = |i: usize| 2.0 * i as f32 / (grid - 1) as f32 - 1.0;
    let (u, v) = (at(column), at(row));
    let (x, z) = (0.5 * (u + v), 0.5 * (u - v));
    let toward = Vec3::new(x, 1.0 - x.abs() - z.abs(), z).normalize_or(Vec3::Y);
    let right = Vec3::Y.cross(toward);
    let right = if right.length_squared() > 1e-6 { right.normalize() } else { math::perpendicular(toward) };
    View { right, up: toward.cross(right), toward, center, half: Vec2::splat(radius) }
}

/// A tree from all of the upper half of the sphere, for a shader.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Octahedral {
    /// Colours in sRGB, and how much of a pixel is covered.
    pub color: Image,
    /// Normals in the tree's own axes, each channel from -1 (0) to 1 (255).
    pub normal: Image,
    /// Offset of the surface toward the viewer, from -radius (0) to +radius (255); 0 where there is nothing.
    pub depth: Image,
    /// Views along each side.
    pub grid: u32,
    /// Empty pixels at each side of a view.
    pub margin: u32,
    /// Point in the middle of every view, metres.
    pub center: Vec3,
    /// Half of what a view is wide and high, metres.
    pub radius: f32,
}

impl Octahedral {
    /// All that a shader has to know, as JSON text to be stored with the images.
    pub fn json(&self) -> String {
        let Self { grid, margin, center, radius, .. } = self;
        let pixels = self.color.width();
        let cell = pixels / grid;
        format!(
            r#"{{
  "kind": "hemi-octahedral impostor",
  "grid": {grid},
  "pixels": {pixels},
  "cell": {cell},
  "margin": {margin},
  "center": [{}, {}, {}],
  "radius": {radius},
  "up": "+Y, right-handed, metres",
  "direction": "u = 2 * column / (grid - 1) - 1; v = 2 * row / (grid - 1) - 1; x = (u + v) / 2; z = (u - v) / 2; y = 1 - |x| - |z|; normalize (x, y, z): from the tree to the viewer",
  "cell_of_direction": "d = (x, y, z) / (|x| + |y| + |z|), y >= 0; u = d.x + d.z; v = d.x - d.z; column = (u + 1) / 2 * (grid - 1); row = (v + 1) / 2 * (grid - 1)",
  "view": "right = normalize(cross((0, 1, 0), direction)), (1, 0, 0) or any other straight from above; up = cross(direction, right); a view without its margin is 2 * radius wide and high about the center, rows from the top",
  "depth": "(value / 255 * 2 - 1) * radius, metres from the center toward the viewer",
  "normal": "value / 255 * 2 - 1 in the tree's axes"
}}
"#,
            center.x, center.y, center.z
        )
    }
}
