//! The buffer of a glTF file, array by array: where the numbers come from, and how they are written.

use super::wind::{self, Column, WindEncoding};
use crate::surface::{Instance, Mesh, Transform, Wind};
use glam::{Mat3, Vec2, Vec3, Vec4};
use std::io::{self, Write};

const FLOAT: u32 = 5126;
const BYTE: u32 = 5120;
const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// One array of the buffer, which is a buffer view.
#[derive(Debug)]
pub(super) enum Array<'a> {
    Vertices(Vertices<'a>),
    /// Indices of `copies` copies of a mesh, of two bytes each if `short`.
    Indices {
        mesh: &'a Mesh,
        copies: usize,
        short: bool,
    },
    /// Positions of copies; for rounded meshes `grid` scales them back.
    Translations(&'a [Instance], Option<Grid>),
    Rotations(&'a [Instance]),
    Scales(&'a [Instance], Option<Grid>),
    Tints(&'a [Instance]),
    /// Four bones per vertex, and their weights.
    Bones(&'a [[u16; 4]]),
    Weights(&'a [Vec4]),
    /// Matrices of bones, column by column.
    Matrices(&'a [[f32; 16]]),
    /// Keys of an animation, and the rotations there.
    Times(&'a [f32]),
    Turns(&'a [Vec4]),
    /// A file within the file.
    Bytes(Vec<u8>),
}

/// An attribute of the vertices of a mesh, or of all its copies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertices<'a> {
    pub(super) attribute: Attribute,
    pub(super) mesh: &'a Mesh,
    /// Copies that are multiplied out.
    pub(super) copies: Option<&'a [Instance]>,
    /// Positions are whole numbers on it.
    pub(super) grid: Option<Grid>,
    /// Numbers in 8 or 16 bits, as the attribute needs.
    pub(super) rounded: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Attribute {
    Position,
    Normal,
    Tangent,
    Uv,
    Color,
    /// Attribute of its name in the file.
    Wind(&'static str, Column),
}

impl Attribute {
    /// The attributes of a mesh, in the order in which they are written.
    pub(super) fn all(mesh: &Mesh, encoding: WindEncoding) -> impl Iterator<Item = Self> {
        let own = [Self::Position, Self::Normal, Self::Tangent, Self::Uv, Self::Color];
        let wind = wind::columns(mesh, encoding).into_iter();
        own.into_iter().chain(wind.map(|(name, column)| Self::Wind(name, column)))
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Position => "POSITION",
            Self::Normal => "NORMAL",
            Self::Tangent => "TANGENT",
            Self::Uv => "TEXCOORD_0",
            Self::Color => "COLOR_0",
            Self::Wind(name, _) => name,
        }
    }

    /// `true` if the mesh has this attribute.
    pub(super) fn is_of(self, mesh: &Mesh) -> bool {
        match self {
            Self::Position | Self::Normal => true,
            Self::Tangent => !mesh.tangents.is_empty(),
            Self::Uv => !mesh.uvs.is_empty(),
            Self::Color => !mesh.colors.is_empty(),
            Self::Wind(..) => !mesh.wind.is_empty(),
        }
    }
}

/// Points of whole numbers from 0 to 65,535: `origin + step * number`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grid {
    origin: Vec3,
    step: f32,
}

impl Grid {
    /// The grid over a box; none if its sides are not finite.
    pub(super) fn over(low: Vec3, high: Vec3) -> Option<Self> {
        // A point has a step, too, by which can be divided.
        let step = ((high - low).max_element() / 65_535.0).max(1e-30);
        step.is_finite().then_some(Self { origin: low, step })
    }

    /// Factor that takes its numbers back to metres.
    pub(super) fn transform(self) -> Transform {
        Transform { position: self.origin, scale: self.step, ..Transform::IDENTITY }
    }

    /// The nearest point of the grid.
    pub(super) fn numbers(self, point: Vec3) -> [u16; 3] {
        ((point - self.origin) / self.step).to_array().map(|number| (number + 0.5) as u16)
    }
}

/// Type of an array's elements in glTF.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Format {
    pub(super) kind: &'static str,
    pub(super) component: u32,
    pub(super) normalized: bool,
    /// Bytes from an element to the next.
    pub(super) stride: u64,
    /// `true` if the last of these bytes are padding.
    pub(super) padded: bool,
}

impl Format {
    const fn floats(kind: &'static str, stride: u64) -> Self {
        Self { kind, component: FLOAT, normalized: false, stride, padded: false }
    }
}

impl Vertices<'_> {
    pub(super) fn count(&self) -> u64 {
        self.mesh.positions.len() as u64 * self.copies.map_or(1, <[_]>::len) as u64
    }

    pub(super) fn format(&self) -> Format {
        let rounded = |kind, component, stride, padded| Format {
            kind,
            component,
            normalized: component != UNSIGNED_SHORT || kind == "VEC2",
            stride,
            padded,
        };
        match (self.attribute, self.rounded) {
            (Attribute::Position, _) if self.grid.is_some() => rounded("VEC3", UNSIGNED_SHORT, 8, true),
            (Attribute::Normal, true) => rounded("VEC3", BYTE, 4, true),
            (Attribute::Tangent, true) => rounded("VEC4", BYTE, 4, false),
            (Attribute::Uv, true) => rounded("VEC2", UNSIGNED_SHORT, 4, false),
            (Attribute::Color, true) => rounded("VEC3", UNSIGNED_BYTE, 4, true),
            (Attribute::Tangent, false) => Format::floats("VEC4", 16),
            (Attribute::Uv, false) => Format::floats("VEC2", 8),
            (Attribute::Wind(_, column), _) => match column.words() {
                1 => Format::floats("SCALAR", 4),
                2 => Format::floats("VEC2", 8),
                _ => Format::floats("VEC3", 12),
            },
            _ => Format::floats("VEC3", 12),
        }
    }

    fn write(&self, writer: &mut impl Write) -> io::Result<()> {
        let (mesh, copies) = (self.mesh, self.copies);
        let white = [1.0; 3];
        match (self.attribute, self.rounded) {
            (Attribute::Position, _) => {
                let place = |copy: &Placement, point: &Vec3| copy.matrix * *point + copy.position;
                match self.grid {
                    None => vertices(writer, &mesh.positions, copies, place, |v| v.to_array().map(floats)),
                    Some(grid) => vertices(writer, &mesh.positions, copies, place, |v| {
                        let [x, y, z] = grid.numbers(*v).map(u16::to_le_bytes);
                        [[x[0], x[1], y[0], y[1]], [z[0], z[1], 0, 0]]
                    }),
                }
            }
            (Attribute::Normal, rounded) => {
                let turn = |copy: &Placement, normal: &Vec3| copy.rotation * *normal;
                if rounded {
                    return vertices(writer, &mesh.normals, copies, turn, |v| [bytes(v.extend(0.0))]);
                }
                vertices(writer, &mesh.normals, copies, turn, |v| v.to_array().map(floats))
            }
            (Attribute::Tangent, rounded) => {
                let turn =
                    |copy: &Placement, tangent: &Vec4| (copy.rotation * tangent.truncate()).extend(tangent.w);
                if rounded {
                    return vertices(writer, &mesh.tangents, copies, turn, |v| [bytes(*v)]);
                }
                vertices(writer, &mesh.tangents, copies, turn, |v| v.to_array().map(floats))
            }
            (Attribute::Uv, rounded) => {
                let keep = |_: &Placement, uv: &Vec2| *uv;
                if rounded {
                    return vertices(writer, &mesh.uvs, copies, keep, |uv| {
                        let [u, v] = uv.to_array().map(|x| ((x * 65_535.0 + 0.5) as u16).to_le_bytes());
                        [[u[0], u[1], v[0], v[1]]]
                    });
                }
                vertices(writer, &mesh.uvs, copies, keep, |v| v.to_array().map(floats))
            }
            (Attribute::Color, rounded) => {
                let tint = |copy: &Placement, own: &[f32; 3]| {
                    let [a, b, c] = *own;
                    [a * copy.tint[0], b * copy.tint[1], c * copy.tint[2]]
                };
                let whites =
                    if mesh.colors.is_empty() { vec![white; mesh.positions.len()] } else { Vec::new() };
                let colors = if mesh.colors.is_empty() { &whites } else { &mesh.colors };
                if rounded {
                    return vertices(writer, colors, copies, tint, |color| {
                        let [r, g, b] = color.map(|channel| (channel * 255.0 + 0.5) as u8);
                        [[r, g, b, 255]]
                    });
                }
                vertices(writer, colors, copies, tint, |color| color.map(floats))
            }
            (Attribute::Wind(_, column), _) => {
                let place = |copy: &Placement, wind: &Wind| Wind {
                    moments: wind.moments.map(|moment| copy.matrix * moment),
                    axes: wind.axes.map(|axis| copy.rotation * axis),
                    flutter: wind.flutter * copy.scale,
                    node: wind.node,
                };
                // Motion is linear in moments and flutter.
                let step = self.grid.map_or(1.0, |grid| grid.step);
                let scaled = |wind: &Wind| Wind {
                    moments: wind.moments.map(|moment| moment / step),
                    flutter: wind.flutter / step,
                    ..*wind
                };
                let of = |wind: &Wind| column.of(&scaled(wind)).map(floats);
                match column.words() {
                    1 => vertices(writer, &mesh.wind, copies, place, |wind| [of(wind)[0]]),
                    2 => vertices(writer, &mesh.wind, copies, place, |wind| {
                        let [x, y, _] = of(wind);
                        [x, y]
                    }),
                    _ => vertices(writer, &mesh.wind, copies, place, of),
                }
            }
        }
    }
}

impl Array<'_> {
    pub(super) fn count(&self) -> u64 {
        match self {
            Self::Vertices(vertices) => vertices.count(),
            Self::Indices { mesh, copies, .. } => mesh.indices.len() as u64 * *copies as u64,
            Self::Translations(copies, _)
            | Self::Scales(copies, _)
            | Self::Rotations(copies)
            | Self::Tints(copies) => copies.len() as u64,
            Self::Bones(bones) => bones.len() as u64,
            Self::Weights(vectors) | Self::Turns(vectors) => vectors.len() as u64,
            Self::Matrices(matrices) => matrices.len() as u64,
            Self::Times(times) => times.len() as u64,
            Self::Bytes(bytes) => bytes.len() as u64,
        }
    }

    pub(super) fn format(&self) -> Format {
        match self {
            Self::Vertices(vertices) => vertices.format(),
            Self::Indices { short, .. } => {
                let (component, stride) = if *short { (UNSIGNED_SHORT, 2) } else { (UNSIGNED_INT, 4) };
                Format { kind: "SCALAR", component, normalized: false, stride, padded: false }
            }
            Self::Bones(_) => Format { component: UNSIGNED_SHORT, ..Format::floats("VEC4", 8) },
            Self::Matrices(_) => Format::floats("MAT4", 64),
            Self::Times(_) => Format::floats("SCALAR", 4),
            Self::Rotations(_) | Self::Weights(_) | Self::Turns(_) => Format::floats("VEC4", 16),
            Self::Translations(..) | Self::Scales(..) | Self::Tints(_) => Format::floats("VEC3", 12),
            Self::Bytes(_) => Format { component: UNSIGNED_BYTE, ..Format::floats("SCALAR", 1) },
        }
    }

    pub(super) fn bytes(&self) -> u64 {
        self.count() * self.format().stride
    }

    /// Use of the array; instances and images are not for the vertex pipeline.
    pub(super) fn target(&self) -> Option<u32> {
        match self {
            Self::Vertices(_) | Self::Bones(_) | Self::Weights(_) => Some(ARRAY_BUFFER),
            Self::Indices { .. } => Some(ELEMENT_ARRAY_BUFFER),
            _ => None,
        }
    }

    /// Writes the numbers, and zeros until the next array begins at a whole word.
    pub(super) fn write(&self, writer: &mut impl Write) -> io::Result<()> {
        match self {
            Self::Vertices(vertices) => vertices.write(writer)?,
            Self::Indices { mesh, copies, short } => {
                let step = mesh.positions.len() as u32;
                for first in (0..*copies as u32).map(|copy| copy * step) {
                    if *short {
                        write_all(writer, &mesh.indices, |i| [((i + first) as u16).to_le_bytes()])?;
                    } else {
                        write_all(writer, &mesh.indices, |i| [(i + first).to_le_bytes()])?;
                    }
                }
            }
            Self::Translations(copies, grid) => {
                let grid = grid.map_or(Transform::IDENTITY, Grid::transform);
                let place = |copy: &Instance| copy.transform().after(&grid).position;
                write_all(writer, copies, |copy| place(copy).to_array().map(floats))?;
            }
            Self::Rotations(copies) => {
                write_all(writer, copies, |copy| copy.rotation.to_array().map(floats))?;
            }
            Self::Scales(copies, grid) => {
                let step = grid.map_or(1.0, |grid| grid.step);
                write_all(writer, copies, |copy| [copy.scale * step; 3].map(floats))?;
            }
            Self::Tints(copies) => write_all(writer, copies, |copy| copy.tint.map(floats))?,
            Self::Bones(bones) => write_all(writer, bones, |bones| bones.map(u16::to_le_bytes))?,
            Self::Weights(vectors) | Self::Turns(vectors) => {
                write_all(writer, vectors, |vector| vector.to_array().map(floats))?;
            }
            Self::Matrices(matrices) => write_all(writer, matrices, |matrix| matrix.map(floats))?,
            Self::Times(times) => write_all(writer, times, |time| [floats(*time)])?,
            Self::Bytes(bytes) => writer.write_all(bytes)?,
        }
        let bytes = self.bytes();
        writer.write_all(&[0; 3][..(bytes.next_multiple_of(4) - bytes) as usize])
    }
}

/// Transform of a vertex by a copy.
struct Placement {
    matrix: Mat3,
    rotation: Mat3,
    position: Vec3,
    scale: f32,
    tint: [f32; 3],
}

/// One value per vertex: those of the mesh, or of each copy of it one by one.
fn vertices<T, const N: usize>(
    writer: &mut impl Write,
    array: &[T],
    copies: Option<&[Instance]>,
    place: impl Fn(&Placement, &T) -> T,
    words: impl Fn(&T) -> [[u8; 4]; N],
) -> io::Result<()> {
    let Some(copies) = copies else { return write_all(writer, array, words) };
    let mut bytes = Vec::new();
    for copy in copies {
        let copy = Placement {
            matrix: copy.matrix(),
            rotation: copy.rotation_matrix(),
            position: copy.position,
            scale: copy.scale,
            tint: copy.tint,
        };
        for element in array {
            bytes.extend_from_slice(words(&place(&copy, element)).as_flattened());
        }
        if bytes.len() > 1 << 16 {
            writer.write_all(&bytes)?;
            bytes.clear();
        }
    }
    writer.write_all(&bytes)
}

/// Thousands of elements per call, since calls cost more than bytes.
fn write_all<T, const M: usize, const N: usize>(
    writer: &mut impl Write,
    array: &[T],
    words: impl Fn(&T) -> [[u8; M]; N],
) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(array.len().min(4096) * M * N);
    for elements in array.chunks(4096) {
        bytes.clear();
        for element in elements {
            bytes.extend_from_slice(words(element).as_flattened());
        }
        writer.write_all(&bytes)?;
    }
    Ok(())
}

#[inline]
fn floats(float: f32) -> [u8; 4] {
    float.to_le_bytes()
}

/// Numbers from -1 to 1, a byte each, as OpenGL counts them.
#[inline]
fn bytes(vector: Vec4) -> [u8; 4] {
    vector.to_array().map(|x| {
        let number = x * 127.0 + if x < 0.0 { -0.5 } else { 0.5 };
        (number as i8).max(-127) as u8
    })
}
