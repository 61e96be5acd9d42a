//! Leaves as images: veins, colour from base to rim, and how one leaf differs from the next.

use super::AssetError;
use super::atlas::{self, Grid, PADDING};
use super::bake::{Baked, Pixel};
use super::skin::Skin;
use crate::foliage::Leaf;
use crate::math;
use crate::observer::Watch;
use crate::random::{self, Purpose};
use crate::surface::{Material, Mesh};
use crate::texture::Textures;
use crate::{ParameterError, parallel};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Points along each side of a pixel.
const SAMPLES: usize = 3;
/// Lateral veins along a main vein.
const LATERALS: f32 = 9.0;

/// A leaf with images: a mesh for each variant, all of which wear the same atlas.
///
/// ```
/// use treesynth::{asset::LeafImages, foliage::Leaf};
///
/// let maple = LeafImages::of(&Leaf::lobed(), 4, 128, 1)?;
/// assert_eq!(maple.meshes().len(), 4);
/// assert_eq!(maple.front().base_color().map(|image| image.width()), Some(256));
/// # Ok::<(), treesynth::asset::AssetError>(())
/// ```
#[derive(Debug, Clone)]
pub struct LeafImages {
    meshes: Vec<Mesh>,
    front: Textures,
}

impl LeafImages {
    /// The images of a leaf in this number of `variants`, 1 to 16, each in a cell of `side` x `side` pixels,
    /// a power of two, 32 to 2048.
    ///
    /// The mesh's texture coordinates say what part of the image it wears; they should be within 0 to 1. The colours are those
    /// of the leaf's material; they are in the images, so that the material to go with them is white. There is an alpha channel
    /// but no cutoff, for the mesh has the leaf's outline; set one to wear the images on rectangles. O(pixels).
    ///
    /// # Errors
    /// Numbers out of range; a mesh without texture coordinates, or whose arrays do not fit together.
    pub fn of(leaf: &Leaf, variants: u32, side: u32, seed: u64) -> Result<Self, AssetError> {
        Self::watched(leaf, variants, side, seed, &Watch::silent())
    }

    fn watched(
        leaf: &Leaf,
        variants: u32,
        side: u32,
        seed: u64,
        watch: &Watch<'_>,
    ) -> Result<Self, AssetError> {
        ParameterError::unless((1..=16).contains(&variants), "LeafImages.variants", variants, "1 to 16")?;
        let holds = side.is_power_of_two() && (32..=2048).contains(&side);
        ParameterError::unless(holds, "LeafImages.side", side, "a power of two, 32 to 2048 pixels")?;
        let mesh = leaf.mesh();
        mesh.check_arrays()?;
        ParameterError::unless(
            !mesh.uvs.is_empty(),
            "LeafImages.leaf",
            "a mesh without uvs",
            "a mesh with uvs",
        )?;
        let grid = Grid::of(variants as usize, side as usize);
        let veins = Veins::of(mesh);
        let color = leaf.material().color();
        let cells = parallel::map(variants as usize, |variant| {
            bake(mesh, &veins, color, grid.cell - 2 * PADDING, [seed, variant as u64], watch)
        });
        watch.pass(0)?;
        let front = atlas::textures(grid, &cells, [1.0; 3], None, watch)?;
        let meshes = (0..variants as usize).map(|variant| {
            let ([u, v], [across, down]) = grid.inner(variant);
            let mut mesh = mesh.clone();
            for uv in &mut mesh.uvs {
                let inside = uv.clamp(Vec2::ZERO, Vec2::ONE);
                *uv = Vec2::new(u + inside.x * across, v + inside.y * down);
            }
            mesh
        });
        Ok(Self { meshes: meshes.collect(), front })
    }

    /// The leaf's mesh once per variant, its texture coordinates in the variant's cell.
    pub fn meshes(&self) -> &[Mesh] {
        &self.meshes
    }

    /// The images of both sides: files and renderers have one set for a material.
    pub fn front(&self) -> &Textures {
        &self.front
    }
}

/// For each vertex the least one of its piece: of all that triangles connect it with. O(triangles · log vertices).
fn pieces(mesh: &Mesh) -> Vec<usize> {
    fn least(pieces: &mut [usize], mut vertex: usize) -> usize {
        while pieces[vertex] != vertex {
            pieces[vertex] = pieces[pieces[vertex]];
            vertex = pieces[vertex];
        }
        vertex
    }
    let mut pieces: Vec<usize> = (0..mesh.positions.len()).collect();
    for corners in mesh.triangles() {
        let ends = corners.map(|corner| least(&mut pieces, corner as usize));
        let first = ends.into_iter().min().unwrap_or(0);
        for end in ends {
            pieces[end] = first;
        }
    }
    for vertex in 0..pieces.len() {
        pieces[vertex] = least(&mut pieces, vertex);
    }
    pieces
}

/// The veins that others branch from, in texture coordinates.
struct Veins {
    /// Start and end of each, one or more per piece of the mesh.
    main: Vec<[Vec2; 2]>,
    /// For each vertex, the range of these that belong to its piece.
    of: Vec<(u32, u32)>,
}

impl Veins {
    /// Pieces of the mesh are leaflets; from the end of each nearest to the leaf's base a vein leads to every
    /// lobe. O(triangles · log vertices).
    fn of(mesh: &Mesh) -> Self {
        let count = mesh.positions.len();
        let pieces = pieces(mesh);
        let by_base = |vertex: usize| {
            let p = mesh.positions[vertex];
            p.x.abs() + p.y.abs() + p.z.abs()
        };
        // For each piece, by its first vertex: the vertex nearest to the leaf's base.
        let mut base: Vec<usize> = (0..count).collect();
        for vertex in 0..count {
            let nearest = &mut base[pieces[vertex]];
            if by_base(vertex) < by_base(*nearest) {
                *nearest = vertex;
            }
        }
        // A lobe's tip is farther from the base than its neighbours.
        let far = |vertex: usize| mesh.positions[vertex].distance(mesh.positions[base[pieces[vertex]]]);
        let mut is_tip: Vec<Option<bool>> = vec![None; count];
        for corners in mesh.triangles() {
            for vertex in corners.map(|corner| corner as usize) {
                let others = corners.iter().filter(|other| **other as usize != vertex);
                let farther = others.into_iter().all(|&other| far(other as usize) < far(vertex));
                is_tip[vertex] = Some(farther && is_tip[vertex].unwrap_or(true));
            }
        }
        let mut tips: Vec<usize> = (0..count).filter(|&vertex| is_tip[vertex] == Some(true)).collect();
        tips.sort_by_key(|&vertex| (pieces[vertex], vertex));
        let mut veins = Self { main: Vec::new(), of: vec![(0, 0); count] };
        let mut of_piece = vec![(0, 0); count];
        for tip in tips {
            let piece = pieces[tip];
            let number = veins.main.len() as u32;
            if of_piece[piece].1 == 0 {
                of_piece[piece].0 = number;
            }
            of_piece[piece].1 = number + 1;
            veins.main.push([mesh.uvs[base[piece]], mesh.uvs[tip]]);
        }
        for vertex in 0..count {
            veins.of[vertex] = of_piece[pieces[vertex]];
        }
        veins
    }

    /// Strength of the vein at a point, 0 to 1, and the point's distance from its main vein and place along
    /// it, both relative to that vein's length.
    fn at(&self, (start, end): (u32, u32), at: Vec2, pixel: f32) -> (f32, f32, f32) {
        let (mut vein, mut nearest, mut along) = (0.0f32, f32::INFINITY, 0.0);
        for &[from, to] in &self.main[start as usize..end as usize] {
            let way = to - from;
            let length = way.length().max(1e-6);
            let t = ((at - from).dot(way) / (length * length)).clamp(0.0, 1.0);
            let off = at.distance(from + way * t) / length;
            if off < nearest {
                (nearest, along) = (off, t);
            }
            let soft = pixel / length;
            let width = 0.022 * (1.0 - 0.7 * t);
            vein = vein.max(1.0 - ((off - width) / soft.max(1e-6)).clamp(0.0, 1.0));
            // Laterals leave at half a right angle and bow to the tip.
            let phase = (t - 0.75 * off + 0.5 * off * off) * LATERALS;
            let near = (phase - phase.round()).abs() / LATERALS;
            let thin = 0.006 * (1.0 - t) + 0.003;
            let lateral = 1.0 - ((near - thin) / soft.max(1e-6)).clamp(0.0, 1.0);
            if t > 0.02 && t < 0.95 && off < 0.6 {
                vein = vein.max(0.55 * lateral);
            }
        }
        (vein, nearest.min(1.0), along)
    }
}

/// One variant, as its texture coordinates see it.
fn bake(
    mesh: &Mesh,
    veins: &Veins,
    color: [f32; 3],
    side: usize,
    [seed, variant]: [u64; 2],
    watch: &Watch<'_>,
) -> Baked {
    let draw = |stage: u32| random::unit(seed, stage, Purpose::CARDS, variant) * 2.0 - 1.0;
    let (light, hue, spots) = (1.0 + 0.12 * draw(1), 0.10 * draw(2), draw(3));
    let mut pixels = vec![Pixel::default(); side * side];
    let points = side * SAMPLES;
    let share = 1.0 / (SAMPLES * SAMPLES) as f32;
    let mut seen = vec![false; points * points];
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|corner| mesh.uvs[corner as usize] * points as f32);
        let area = (b - a).perp_dot(c - a);
        if area == 0.0 || !area.is_finite() {
            continue;
        }
        let piece = veins.of[corners[0] as usize];
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let range = |low: f32, high: f32| {
            (low.floor().max(0.0) as usize)..((high.ceil().max(0.0) as usize).min(points))
        };
        for row in range(low.y, high.y) {
            // Nobody looks at it once it is cancelled.
            if !watch.steps(1 + (high.x - low.x) as usize / 16) {
                break;
            }
            for column in range(low.x, high.x) {
                let point = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
                let u = (b - point).perp_dot(c - point) / area;
                let v = (c - point).perp_dot(a - point) / area;
                let w = 1.0 - u - v;
                if u < 0.0 || v < 0.0 || w < 0.0 || std::mem::replace(&mut seen[row * points + column], true)
                {
                    continue;
                }
                let uv = point / points as f32;
                let (vein, off, along) = veins.at(piece, uv, 1.0 / side as f32);
                // Lighter at the base and beside the midrib, darker to the rim.
                let rim = (off * 2.2).min(1.0);
                let tone = light * (1.12 - 0.2 * rim - 0.06 * along);
                let blotch = 0.05 * spots * math::sin(uv.x * 9.0 + variant as f32) * math::sin(uv.y * 11.0);
                let vein = vein * 0.45;
                let pixel = &mut pixels[row / SAMPLES * side + column / SAMPLES];
                for i in 0..3 {
                    let shift = [1.0 + hue, 1.0, 1.0 - 0.5 * hue][i];
                    let mut channel = color[i] * tone * shift * (1.0 + blotch);
                    channel += vein * (color[1] * [1.25, 1.35, 0.75][i] - channel);
                    pixel.color[i] += channel.clamp(0.0, 1.0) * share;
                }
                pixel.cover += share;
                pixel.layers += share;
            }
        }
    }
    for pixel in pixels.iter_mut().filter(|pixel| pixel.cover > 0.0) {
        let whole = 1.0 / pixel.cover;
        pixel.color = pixel.color.map(|channel| channel * whole);
        pixel.layers *= whole;
        pixel.normal = Vec3::Z;
        pixel.cover = pixel.cover.min(1.0);
    }
    relief(&mut pixels, side);
    Baked { width: side, height: side, pixels }
}

/// Veins stand below the blade: normals lean away from what is lighter.
fn relief(pixels: &mut [Pixel], side: usize) {
    let height: Vec<f32> =
        pixels.iter().map(|pixel| if pixel.cover > 0.0 { pixel.color[1] } else { f32::NAN }).collect();
    let mean = {
        let there = height.iter().filter(|height| !height.is_nan());
        let (sum, count) = there.fold((0.0, 0.0f32), |(sum, count), height| (sum + height, count + 1.0));
        if count > 0.0 { (sum / count).max(1e-6) } else { 1.0 }
    };
    for row in 1..side.saturating_sub(1) {
        for column in 1..side.saturating_sub(1) {
            let at = row * side + column;
            let across = (height[at + 1] - height[at - 1]) / mean;
            let down = (height[at + side] - height[at - side]) / mean;
            if across.is_finite() && down.is_finite() {
                pixels[at].normal = Vec3::new(0.5 * across, -0.5 * down, 1.0).normalize_or(Vec3::Z);
            }
        }
    }
}

/// Look of an asset's leaves: a mesh, a material and its images.
#[derive(Debug, Clone)]
pub(super) struct Dress {
    pub(super) mesh: Mesh,
    pub(super) material: Material,
    pub(super) textures: Option<Arc<Textures>>,
    pub(super) skin: Option<Arc<Skin>>,
}

impl Dress {
    /// The variants of a leaf, with images of this side each; the leaf as it is where there are to be none.
    pub(super) fn of(
        leaf: &Leaf,
        side: Option<u32>,
        variants: u32,
        watch: &Watch<'_>,
    ) -> Result<Vec<Self>, AssetError> {
        let mesh = leaf.mesh();
        let Some(side) = side.filter(|_| !mesh.uvs.is_empty() && !mesh.is_empty()) else {
            let (mesh, material) = (mesh.clone(), leaf.material());
            return Ok(vec![Self { mesh, material, textures: None, skin: None }]);
        };
        let images = LeafImages::watched(leaf, variants, side, 0, watch)?;
        let textures = Arc::new(images.front);
        let skin = Arc::new(Skin::new(&textures));
        let material = leaf.material().with_color([1.0; 3]);
        let dress = |mesh| Self {
            mesh,
            material,
            textures: Some(Arc::clone(&textures)),
            skin: Some(Arc::clone(&skin)),
        };
        Ok(images.meshes.into_iter().map(dress).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares of two triangles, where there are any.
    fn grid(side: u32, is_there: impl Fn(u32, u32) -> bool) -> Mesh {
        let corner = |i: u32| Vec2::new((i % (side + 1)) as f32, (i / (side + 1)) as f32) / side as f32;
        let corners: Vec<Vec2> = (0..(side + 1) * (side + 1)).map(corner).collect();
        let positions: Vec<Vec3> = corners.iter().map(|uv| uv.extend(0.0)).collect();
        let mut indices = Vec::new();
        for (x, y) in (0..side * side).map(|i| (i % side, i / side)).filter(|(x, y)| is_there(*x, *y)) {
            let at = y * (side + 1) + x;
            indices.extend([at, at + 1, at + side + 2, at, at + side + 2, at + side + 1]);
        }
        Mesh::new(positions.clone(), vec![Vec3::Z; positions.len()], indices).with_uvs(corners)
    }

    #[test]
    fn each_piece_has_veins_of_its_own() {
        // Four bands with a gap between them.
        let mesh = grid(11, |_, y| y % 3 != 2);
        let found = pieces(&mesh);
        for corners in mesh.triangles() {
            let band = corners.map(|corner| corner / 12 / 3);
            assert!(band.iter().all(|other| *other == band[0]));
            assert!(corners.iter().all(|corner| found[*corner as usize] as u32 == band[0] * 36));
        }
        let veins = Veins::of(&mesh);
        for corners in mesh.triangles() {
            let (start, end) = veins.of[corners[0] as usize];
            assert!(end > start, "a band without a vein");
            let band = corners[0] / 12 / 3;
            for [from, to] in &veins.main[start as usize..end as usize] {
                let rows = [from.y, to.y].map(|y| (y * 11.0).round() as u32 / 3);
                assert_eq!(rows, [band; 2]);
            }
        }
    }

    #[test]
    fn fine_meshes_take_no_longer_by_the_square() {
        // 160,000 triangles: by the square it would be minutes.
        let leaf = Leaf::new(grid(283, |_, _| true));
        assert!(LeafImages::of(&leaf, 1, 32, 0).is_ok());
    }
}
