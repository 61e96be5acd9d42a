//! Masks for snow, moss and water on a surface.

use super::mesh::has_area;
use super::{Mesh, SurfaceError, Wind};
use crate::ParameterError;
use crate::math::UP;
use crate::random::{self, Purpose};
use glam::{IVec3, Vec3, Vec3Swizzles, Vec4};
use std::collections::BTreeMap;
use std::f32::consts::PI;

/// The covered part of a surface: by direction, by height, in patches.
///
/// At a vertex the mask is a number from 0 to 1, in this order: 0 to 1 as the normal turns from one angle off
/// the [direction](Self::with_direction) to another; times 1 to 0 between two [heights](Self::with_heights),
/// if these matter; plus [noise](Self::with_patches) in space, so that borders are irregular and levels of
/// detail agree. The surface is covered where the mask is above a half.
///
/// [`cut`](Self::cut) makes two meshes of one along the line where the mask is a half, of which the second wears images of
/// its own; so every engine and every format shows it, without layers, shaders or vertex alpha. [`tint`](Self::tint) multiplies
/// vertex colours instead, which can only darken: for wetness and green algae.
///
/// ```
/// use treesynth::surface::{Mask, Tubes};
/// use treesynth::{Skeleton, glam::Vec3};
///
/// let limb = Skeleton::new(vec![Vec3::ZERO, Vec3::X], vec![None, Some(0)])?.with_radii(vec![0.1; 2])?;
/// let [bark, snow] = Mask::snow().cut(&Tubes::default().mesh(&limb)?, 0.02)?;
/// assert!(snow.normals.iter().all(|normal| normal.y > 0.0));
/// assert!(!bark.is_empty() && !snow.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    direction: Vec3,
    /// Cosines of the angles off the direction at which there is nothing, and all.
    facing: [f32; 2],
    /// The angles themselves, radians, if a user gave them.
    angles: Option<[f32; 2]>,
    heights: Option<[f32; 2]>,
    size: f32,
    spread: f32,
    seed: u64,
}

/// Excess of the mask over a half at which a cover has its full thickness.
const FULL: f32 = 0.35;
/// Greatest number of times that a side is halved.
const ROUNDS: usize = 5;
/// A side is halved if the mask in its middle differs by more than this from the mean of its ends.
const BENT: f32 = 0.1;

impl Mask {
    /// Snow on surfaces that face up: none from 75° off, all within 40°; borders that wave over 15 cm.
    pub fn snow() -> Self {
        Self {
            direction: UP,
            facing: [0.26, 0.77],
            angles: None,
            heights: None,
            size: 0.15,
            spread: 0.35,
            seed: 0,
        }
    }

    /// Moss on the shaded side, towards -z and up, near the ground: fewer and fewer patches up to 4 m.
    pub fn moss() -> Self {
        let direction = Vec3::new(0.0, 0.5, -0.866);
        Self {
            direction,
            facing: [-0.6, 0.5],
            angles: None,
            heights: Some([0.0, 4.0]),
            size: 0.12,
            spread: 0.8,
            seed: 0,
        }
    }

    /// Patches of lichen all around, of which about a fifth of the bark is covered.
    pub fn lichen() -> Self {
        Self {
            direction: UP,
            facing: [-1.5, 6.0],
            angles: None,
            heights: None,
            size: 0.1,
            spread: 1.4,
            seed: 0,
        }
    }

    /// The surface that rain reaches: all that faces up, and the side of the trunk that faces towards +x;
    /// with streaks.
    pub fn rain() -> Self {
        let direction = Vec3::new(0.8, 0.6, 0.0);
        Self { direction, facing: [-0.2, 0.5], angles: None, heights: None, size: 0.25, spread: 0.6, seed: 0 }
    }

    /// Direction with which normals are compared, of any length above zero, and the angles between them,
    /// radians, at which nothing and everything is covered. With the same angle twice, everything nearer to
    /// the direction is covered.
    pub fn with_direction(mut self, direction: Vec3, nothing: f32, all: f32) -> Self {
        self.direction = direction.normalize_or_zero();
        self.facing = [nothing, all].map(crate::math::cos);
        self.angles = Some([nothing, all]);
        self
    }

    /// The height above y = 0, metres, up to which all is as the direction says, and the one from which there is nothing; the
    /// other way round for what comes only high up. `None` (the default of snow, lichen and rain) for any height.
    pub fn with_heights(mut self, heights: Option<[f32; 2]>) -> Self {
        self.heights = heights;
        self
    }

    /// The size of patches, metres, 1e-3 to 1e3, and how much there are, 0 to 4: below 1 what faces the direction is covered whole
    /// and what faces away not at all, and only the border waves.
    pub fn with_patches(mut self, size: f32, spread: f32) -> Self {
        (self.size, self.spread) = (size, spread);
        self
    }

    /// Another seed has patches in other places; default 0.
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// The mask where a surface at `position` faces towards `normal`, 0 to 1; 0 where options out of their ranges give no number.
    pub fn at(&self, position: Vec3, normal: Vec3) -> f32 {
        let [from, to] = self.facing;
        let facing = ((normal.dot(self.direction) - from) / (to - from).max(1e-6)).clamp(0.0, 1.0);
        let height = self.heights.map_or(1.0, |[all, nothing]| {
            let way = nothing - all;
            let way = if way.abs() < 1e-6 { 1e-6 } else { way };
            1.0 - ((position.y - all) / way).clamp(0.0, 1.0)
        });
        // Turned, so that the lattice's planes do not lie across trunks.
        let [x, y, z] = (position / self.size).to_array();
        let turned =
            Vec3::new(0.36 * x + 0.48 * y - 0.8 * z, -0.8 * x + 0.6 * y, 0.48 * x + 0.64 * y + 0.6 * z);
        let noise = self.noise(turned, 0) + 0.5 * self.noise(turned.zxy() * 2.3, 1);
        let value = facing * height + self.spread * noise * (1.0 / 1.5);
        if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) }
    }

    /// The mask at all vertices of a mesh, 0 to 1. O(vertices).
    pub fn values(&self, mesh: &Mesh) -> Vec<f32> {
        mesh.positions
            .iter()
            .zip(&mesh.normals)
            .map(|(&position, &normal)| self.at(position, normal))
            .collect()
    }

    /// Multiplies vertex colours by `color` (linear, each channel 0 to 1) where the mask is 1, by 1 where it is 0. O(vertices).
    ///
    /// # Errors
    /// An option or the colour out of its range.
    pub fn tint(&self, mesh: &mut Mesh, color: [f32; 3]) -> Result<(), SurfaceError> {
        self.check()?;
        let holds = color.iter().all(|channel| (0.0..=1.0).contains(channel));
        let name = "Mask.tint.color";
        ParameterError::unless(holds, name, format!("{color:?}"), "three channels of 0 to 1")?;
        check_mesh(mesh)?;
        let values = self.values(mesh);
        mesh.colors.resize(mesh.positions.len(), [1.0; 3]);
        for (own, value) in mesh.colors.iter_mut().zip(values) {
            for (own, color) in own.iter_mut().zip(color) {
                *own *= 1.0 + (color - 1.0) * value;
            }
        }
        Ok(())
    }

    /// The bare and the covered part of a mesh, cut along the line where the mask is a half; together they
    /// are the whole surface. The covered part lies up to `thickness` metres higher, less where sides of
    /// triangles are shorter, as on twigs, and at its rim as high as the rest.
    ///
    /// Sides near the border that are longer than half a [patch](Self::with_patches) are halved first, up to
    /// five times; then a triangle that the line crosses becomes three. Colours, texture coordinates,
    /// tangents and wind are those of the place. O(n log n).
    ///
    /// # Errors
    /// An option or the thickness out of its range, 0 to 1e3 m.
    pub fn cut(&self, mesh: &Mesh, thickness: f32) -> Result<[Mesh; 2], SurfaceError> {
        self.check()?;
        let holds = (0.0..=1e3).contains(&thickness);
        ParameterError::unless(holds, "Mask.cut.thickness", thickness, "0 to 1e3 m")?;
        check_mesh(mesh)?;
        let (mut all, mut values, mut room) = (mesh.clone(), self.values(mesh), room(mesh));
        self.refine(&mut all, &mut values, &mut room);
        let mut indices = [Vec::new(), Vec::new()];
        let mut crossed = BTreeMap::new();
        let triangles = std::mem::take(&mut all.indices);
        for corners in triangles.chunks_exact(3).map(|corners| [corners[0], corners[1], corners[2]]) {
            let is_covered = corners.map(|corner| values[corner as usize] > 0.5);
            let count = is_covered.iter().filter(|&&is| is).count();
            if count % 3 == 0 {
                indices[usize::from(count == 3)].extend_from_slice(&corners);
                continue;
            }
            // The corner that is alone comes first.
            let alone = (0..3).find(|&i| is_covered[i] == (count == 1)).unwrap_or(0);
            let [a, b, c] = [0, 1, 2].map(|i| corners[(alone + i) % 3]);
            let mut cross = |from: u32, to: u32| {
                // Both triangles at a side find one vertex.
                let (low, high) = (from.min(to), from.max(to));
                *crossed.entry((low, high)).or_insert_with(|| {
                    let [start, end] = [low, high].map(|corner| values[corner as usize]);
                    between(&mut all, low as usize, high as usize, (0.5 - start) / (end - start));
                    values.push(0.5);
                    room.push(0.0);
                    all.positions.len() as u32 - 1
                })
            };
            let (ab, ac) = (cross(a, b), cross(a, c));
            let sides = [usize::from(count == 1), usize::from(count != 1)];
            indices[sides[0]].extend_from_slice(&[a, ab, ac]);
            indices[sides[1]].extend_from_slice(&[ab, b, c, ab, c, ac]);
        }
        let thick = |vertex: usize| {
            let t = ((values[vertex] - 0.5) / FULL).clamp(0.0, 1.0);
            thickness.min(room[vertex]) * t * (2.0 - t)
        };
        let [(bare, _), (mut covered, vertices)] = indices.map(|indices| {
            let positions = &all.positions;
            let sound = |corners: [u32; 3]| has_area(corners.map(|corner| positions[corner as usize]));
            Mesh { indices, ..all.clone() }.selected(sound)
        });
        for (vertex, &old) in vertices.iter().enumerate() {
            covered.positions[vertex] += covered.normals[vertex] * thick(old as usize);
        }
        Ok([bare, covered])
    }

    /// Halves sides that are longer than half a patch where the mask is not straight along them and the border is near, in up to
    /// [`ROUNDS`] rounds. Both triangles at a side agree, so that no gap opens.
    fn refine(&self, mesh: &mut Mesh, values: &mut Vec<f32>, room: &mut Vec<f32>) {
        let longest = 0.5 * self.size;
        for _ in 0..ROUNDS {
            let mut halves: BTreeMap<(u32, u32), Option<u32>> = BTreeMap::new();
            let mut indices = Vec::with_capacity(mesh.indices.len());
            let triangles = std::mem::take(&mut mesh.indices);
            for corners in triangles.chunks_exact(3) {
                let middles: [Option<u32>; 3] = std::array::from_fn(|i| {
                    let (a, b) = (corners[i], corners[(i + 1) % 3]);
                    let (low, high) = (a.min(b), a.max(b));
                    *halves.entry((low, high)).or_insert_with(|| {
                        let (low, high) = (low as usize, high as usize);
                        let (from, to) = (mesh.positions[low], mesh.positions[high]);
                        if from.distance_squared(to) <= longest * longest {
                            return None;
                        }
                        let normal = mesh.normals[low] + mesh.normals[high];
                        let own = self.at(from.lerp(to, 0.5), normal.normalize_or(mesh.normals[low]));
                        let straight = 0.5 * (values[low] + values[high]);
                        let least = own.min(values[low]).min(values[high]);
                        let most = own.max(values[low]).max(values[high]);
                        if (own - straight).abs() < BENT || least > 0.5 || most <= 0.5 {
                            return None;
                        }
                        between(mesh, low, high, 0.5);
                        values.push(own);
                        room.push(0.5 * (room[low] + room[high]));
                        Some(mesh.positions.len() as u32 - 1)
                    })
                });
                divide([corners[0], corners[1], corners[2]], middles, &mut indices);
            }
            let is_done = indices.len() == triangles.len();
            mesh.indices = indices;
            if is_done {
                break;
            }
        }
    }

    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        let (name, range) = ("Mask.direction", "a direction: finite, and not zero");
        ParameterError::unless(self.direction.length_squared() > 0.5, name, self.direction, range)?;
        if let Some([nothing, all]) = self.angles {
            let holds = (0.0..=PI).contains(&all) && (all..=PI).contains(&nothing);
            let range = "radians from 0 to π, that of nothing not less than that of all";
            ParameterError::unless(holds, "Mask.direction.angles", format!("{nothing} and {all}"), range)?;
        }
        let heights = self.heights.is_none_or(|heights| heights.iter().all(|height| height.is_finite()));
        ParameterError::unless(heights, "Mask.heights", format!("{:?}", self.heights), "finite")?;
        ParameterError::unless(
            (1e-3..=1e3).contains(&self.size),
            "Mask.patches.size",
            self.size,
            "1e-3 to 1e3 m",
        )?;
        ParameterError::unless(
            (0.0..=4.0).contains(&self.spread),
            "Mask.patches.spread",
            self.spread,
            "0 to 4",
        )
    }

    /// Noise of -1 to 1: numbers at the points of a lattice, smooth in between.
    fn noise(&self, at: Vec3, octave: u32) -> f32 {
        let low = at.floor();
        let t = at - low;
        let [u, v, w] = (t * t * (Vec3::splat(3.0) - 2.0 * t)).to_array();
        let corner = low.as_ivec3();
        let number = |x: i32, y: i32, z: i32| {
            let at = corner
                .wrapping_add(IVec3::new(x, y, z))
                .to_array()
                .map(|i| u64::from(i as u32 & 0x001f_ffff));
            2.0 * random::unit(self.seed, octave, Purpose::COVER, at[0] | at[1] << 21 | at[2] << 42) - 1.0
        };
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let line = |y: i32, z: i32| mix(number(0, y, z), number(1, y, z), u);
        mix(mix(line(0, 0), line(1, 0), v), mix(line(0, 1), line(1, 1), v), w)
    }
}

/// Triangles in place of one, some of whose sides have a vertex in the middle: side i leads from corner i to the next.
fn divide(corners: [u32; 3], middles: [Option<u32>; 3], indices: &mut Vec<u32>) {
    let count = middles.iter().flatten().count();
    // One side alone, or two: the corner before the first of them comes first.
    let first = match count {
        1 => middles.iter().position(Option::is_some),
        2 => middles.iter().position(Option::is_none).map(|whole| (whole + 1) % 3),
        _ => Some(0),
    };
    let first = first.unwrap_or(0);
    let [a, b, c] = [0, 1, 2].map(|i| corners[(first + i) % 3]);
    match [0, 1, 2].map(|i| middles[(first + i) % 3]) {
        [Some(ab), None, _] => indices.extend_from_slice(&[a, ab, c, ab, b, c]),
        [Some(ab), Some(bc), None] => indices.extend_from_slice(&[a, ab, c, ab, b, bc, ab, bc, c]),
        [Some(ab), Some(bc), Some(ca)] => {
            indices.extend_from_slice(&[a, ab, ca, ab, b, bc, bc, c, ca, ab, bc, ca]);
        }
        _ => indices.extend_from_slice(&[a, b, c]),
    }
}

/// The shortest side at each vertex: nothing that lies on thin wood is thicker.
fn room(mesh: &Mesh) -> Vec<f32> {
    let mut room = vec![f32::MAX; mesh.positions.len()];
    for corners in mesh.triangles() {
        for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (corners[i] as usize, corners[j] as usize)) {
            let side = mesh.positions[a].distance(mesh.positions[b]);
            room[a] = room[a].min(side);
            room[b] = room[b].min(side);
        }
    }
    room
}

/// Adds a vertex between two others to a mesh.
fn between(mesh: &mut Mesh, from: usize, to: usize, t: f32) {
    let t = t.clamp(0.0, 1.0);
    mesh.positions.push(mesh.positions[from].lerp(mesh.positions[to], t));
    let normal = mesh.normals[from].lerp(mesh.normals[to], t).normalize_or(mesh.normals[from]);
    mesh.normals.push(normal);
    if !mesh.tangents.is_empty() {
        let (first, second) = (mesh.tangents[from], mesh.tangents[to]);
        let across = |tangent: Vec4| {
            let tangent = tangent.truncate();
            (tangent - normal * tangent.dot(normal)).try_normalize()
        };
        let tangent = across(first.lerp(second, t)).or_else(|| across(first));
        mesh.tangents.push(tangent.unwrap_or_else(|| crate::math::perpendicular(normal)).extend(first.w));
    }
    if !mesh.uvs.is_empty() {
        mesh.uvs.push(mesh.uvs[from].lerp(mesh.uvs[to], t));
    }
    if !mesh.colors.is_empty() {
        let [a, b] = [mesh.colors[from], mesh.colors[to]];
        mesh.colors.push(std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t));
    }
    if !mesh.wind.is_empty() {
        let [a, b] = [mesh.wind[from], mesh.wind[to]];
        mesh.wind.push(Wind {
            moments: std::array::from_fn(|level| a.moments[level].lerp(b.moments[level], t)),
            flutter: a.flutter + (b.flutter - a.flutter) * t,
            ..a
        });
    }
}

fn check_mesh(mesh: &Mesh) -> Result<(), SurfaceError> {
    let fault = |error| ParameterError::new("Mask.mesh", error, "a sound mesh".to_owned()).into();
    mesh.check_arrays().map_err(fault)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets;
    use crate::surface::Tubes;

    fn masks() -> [(&'static str, Mask); 4] {
        [("snow", Mask::snow()), ("moss", Mask::moss()), ("lichen", Mask::lichen()), ("rain", Mask::rain())]
    }

    #[test]
    fn there_is_no_place_without_a_number() {
        for [size, spread] in
            [[0.0, 1.0], [f32::NAN, 1.0], [f32::INFINITY, 0.0], [1.0, f32::NAN], [-0.0, f32::MAX]]
        {
            let mask = Mask::snow().with_patches(size, spread).with_heights(Some([f32::NAN, size]));
            let value = mask.at(Vec3::new(0.0, 1.0, 1e30), Vec3::Y);
            assert!((0.0..=1.0).contains(&value), "{size} {spread}: {value}");
        }
    }

    #[test]
    fn both_pieces_are_the_surface() {
        for (name, nodes) in [("figure-06b", 1500), ("figure-18", 2000)] {
            let preset = presets::by_name(name).expect("a preset").guided().expect("guided");
            for seed in 0..3 {
                let tree = preset.synth(nodes).synthesize(seed).expect("a tree");
                let mesh = Tubes::default().with_wind(true).mesh(&tree).expect("a surface");
                for (mask_name, mask) in masks() {
                    let [bare, covered] = mask.clone().with_seed(seed).cut(&mesh, 0.0).expect("in range");
                    bare.check().expect("sound");
                    covered.check().expect("sound");
                    let whole = f64::from(mesh.area());
                    let both = f64::from(bare.area()) + f64::from(covered.area());
                    assert!((both / whole - 1.0).abs() < 1e-3, "{mask_name} on {name}: {both} of {whole}");
                    let share = f64::from(covered.area()) / whole;
                    assert!((0.002..0.6).contains(&share), "{mask_name} on {name} covers {share}");
                }
            }
        }
    }

    #[test]
    fn snow_lies_on_what_faces_up() {
        let preset = presets::by_name("figure-06b").expect("a preset").guided().expect("guided");
        let tree = preset.synth(1500).synthesize(1).expect("a tree");
        let mesh = Tubes::default().mesh(&tree).expect("a surface");
        let [bare, covered] = Mask::snow().cut(&mesh, 0.01).expect("in range");
        // On a twig of four sides a triangle reaches from the top to below.
        let aside = covered.normals.iter().filter(|normal| normal.y < 0.2).count();
        assert!(aside * 10 < covered.normals.len(), "{aside} of {}", covered.normals.len());
        // Triangles that face straight up are white, whatever the patches are.
        let mut up =
            bare.triangles().filter(|corners| corners.iter().all(|&i| bare.normals[i as usize].y > 0.9));
        assert!(up.next().is_none());
    }

    #[test]
    fn what_is_wrong_is_named() {
        let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2]);
        for (mask, name) in [
            (Mask::snow().with_direction(Vec3::ZERO, 1.0, 0.5), "Mask.direction"),
            (Mask::snow().with_direction(Vec3::NAN, 1.0, 0.5), "Mask.direction"),
            (Mask::snow().with_direction(Vec3::Y, 0.5, 1.0), "Mask.direction.angles"),
            // Degrees.
            (Mask::snow().with_direction(Vec3::Y, 60.0, 30.0), "Mask.direction.angles"),
            (Mask::snow().with_heights(Some([0.0, f32::INFINITY])), "Mask.heights"),
            (Mask::snow().with_patches(0.0, 0.5), "Mask.patches.size"),
            (Mask::snow().with_patches(1.0, 5.0), "Mask.patches.spread"),
        ] {
            let error = mask.cut(&mesh, 0.1).expect_err("out of range").to_string();
            assert!(error.starts_with(name), "{error}");
        }
        assert!(Mask::snow().cut(&mesh, -1.0).is_err());
        assert!(Mask::snow().tint(&mut mesh.clone(), [2.0, 0.0, 0.0]).is_err());
    }
}
