//! Meshes as arrays of the buffer, and the accessors that say where they lie.

use super::array::{Array, Attribute, Format, Grid, Vertices};
use super::text::{list, numbers};
use super::wind::WindEncoding;
use crate::export::ExportError;
use crate::surface::{Instance, Mesh};
use glam::{Vec2, Vec3};

/// The highest index of two bytes is 65,534: the next one means a new strip.
const SHORT: usize = 65_535;

/// Greatest number of pieces in which merged copies are drawn. If 16-bit indices would need more pieces,
/// indices have 32 bits.
const MOST_PIECES: usize = 256;

/// The arrays and their accessors.
#[derive(Debug, Default)]
pub(super) struct Buffer<'a> {
    arrays: Vec<Array<'a>>,
    accessors: Vec<Accessor>,
}

/// Place of some numbers.
#[derive(Debug)]
struct Accessor {
    view: usize,
    offset: u64,
    count: u64,
    format: Format,
    /// `,"min":[..],"max":[..]`, which positions must have.
    bounds: String,
}

/// Elements of a mesh of the file.
#[derive(Debug)]
pub(super) struct Geometry {
    pub(super) primitives: Vec<Primitive>,
    /// Step to which its positions are rounded.
    pub(super) grid: Option<Grid>,
}

/// Accessors by attributes, and that of the indices.
#[derive(Debug)]
pub(super) struct Primitive {
    pub(super) attributes: Vec<(&'static str, usize)>,
    pub(super) indices: usize,
}

impl<'a> Buffer<'a> {
    /// An array that is read as a whole; the accessor.
    pub(super) fn whole(&mut self, array: Array<'a>) -> usize {
        let count = array.count();
        // Keys of an animation must say from when to when they are.
        let bounds = match &array {
            Array::Times([first, .., last]) => {
                format!(r#","min":{},"max":{}"#, numbers(&[*first]), numbers(&[*last]))
            }
            _ => String::new(),
        };
        let view = self.view(array);
        self.accessor(view, 0, count, bounds)
    }

    /// An array; the buffer view.
    pub(super) fn view(&mut self, array: Array<'a>) -> usize {
        self.arrays.push(array);
        self.arrays.len() - 1
    }

    fn accessor(&mut self, view: usize, first: u64, count: u64, bounds: String) -> usize {
        let format = self.arrays[view].format();
        self.accessors.push(Accessor { view, offset: first * format.stride, count, format, bounds });
        self.accessors.len() - 1
    }

    /// A mesh, or all its copies multiplied out, in pieces that share their indices.
    pub(super) fn geometry(
        &mut self,
        mesh: &'a Mesh,
        copies: Option<&'a [Instance]>,
        rounded: bool,
        wind: WindEncoding,
    ) -> Result<Geometry, ExportError> {
        let (vertices, number) = (mesh.positions.len(), copies.map_or(1, <[_]>::len));
        let bytes = vertices as u64 * number as u64 * 12;
        if bytes > u64::from(u32::MAX) {
            return Err(ExportError::TooLarge { bytes, limit: u64::from(u32::MAX) });
        }
        let block = (SHORT / vertices).max(number.div_ceil(MOST_PIECES)).clamp(1, number);
        let blocks = number.div_ceil(block);
        let bounds: Vec<_> = (0..blocks)
            .map(|i| bounds(mesh, copies.map(|copies| &copies[i * block..copies.len().min((i + 1) * block)])))
            .collect();
        let [low, high] = bounds.iter().fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], corners| {
            [low.min(corners[0]), high.max(corners[1])]
        });
        let grid = if rounded { Grid::over(low, high) } else { None };
        let tinted = copies.is_some_and(|copies| copies.iter().any(Instance::is_tinted));
        let within = |uv: Vec2| (0.0..=1.0).contains(&uv.x) && (0.0..=1.0).contains(&uv.y);
        let mut primitives: Vec<_> =
            (0..blocks).map(|_| Primitive { attributes: Vec::new(), indices: 0 }).collect();
        for attribute in Attribute::all(mesh, wind) {
            if !(attribute.is_of(mesh) || attribute == Attribute::Color && tinted) {
                continue;
            }
            let rounded = match attribute {
                Attribute::Uv => mesh.uvs.iter().all(|&uv| if rounded { within(uv) } else { in_shorts(uv) }),
                Attribute::Color => rounded || tinted || mesh.colors.iter().all(in_bytes),
                _ => rounded,
            };
            let view = self.view(Array::Vertices(Vertices { attribute, mesh, copies, grid, rounded }));
            for (i, primitive) in primitives.iter_mut().enumerate() {
                let bounds = match (attribute, grid) {
                    (Attribute::Position, Some(grid)) => corners(bounds[i].map(|corner| {
                        // Rounding keeps the order, so that the bounds of the numbers are the bounds' numbers.
                        grid.numbers(corner).map(f32::from)
                    })),
                    (Attribute::Position, None) => corners(bounds[i].map(|corner| corner.to_array())),
                    _ => String::new(),
                };
                let (first, last) = (i * block, number.min((i + 1) * block));
                let count = (last - first) * vertices;
                let accessor = self.accessor(view, (first * vertices) as u64, count as u64, bounds);
                primitive.attributes.push((attribute.name(), accessor));
            }
        }
        let short = vertices * block <= SHORT;
        let view = self.view(Array::Indices { mesh, copies: block, short });
        let triangles = mesh.indices.len() as u64;
        let all = self.accessor(view, 0, triangles * block as u64, String::new());
        for primitive in &mut primitives {
            primitive.indices = all;
        }
        if let (Some(last), rest @ 1..) = (primitives.last_mut(), number % block) {
            last.indices = self.accessor(view, 0, triangles * rest as u64, String::new());
        }
        Ok(Geometry { primitives, grid })
    }

    pub(super) fn arrays(&self) -> &[Array<'a>] {
        &self.arrays
    }

    /// Size with the zeros between the arrays, so that each begins at a whole word.
    pub(super) fn bytes(&self) -> u64 {
        self.arrays.iter().map(|array| array.bytes().next_multiple_of(4)).sum()
    }

    pub(super) fn accessors_text(&self) -> String {
        list(&self.accessors, |Accessor { view, offset, count, format, bounds }| {
            let offset = if *offset > 0 { format!(r#""byteOffset":{offset},"#) } else { String::new() };
            let normalized = if format.normalized { r#""normalized":true,"# } else { "" };
            format!(
                r#"{{"bufferView":{view},{offset}"componentType":{},{normalized}"count":{count},"type":"{}"{bounds}}}"#,
                format.component, format.kind,
            )
        })
    }

    pub(super) fn views_text(&self) -> String {
        let mut uses = vec![0; self.arrays.len()];
        self.accessors.iter().for_each(|accessor| uses[accessor.view] += 1);
        let mut offset = 0;
        list(self.arrays.iter().zip(uses), |(array, uses)| {
            let start = offset;
            let (bytes, format) = (array.bytes(), array.format());
            offset += bytes.next_multiple_of(4);
            let vertices = matches!(array, Array::Vertices(_));
            // Must be said of vertices where accessors share a view or elements are padded, and only there.
            let stride = if vertices && (uses > 1 || format.padded) {
                format!(r#","byteStride":{}"#, format.stride)
            } else {
                String::new()
            };
            let target = array.target().map_or(String::new(), |target| format!(r#","target":{target}"#));
            format!(r#"{{"buffer":0,"byteOffset":{start},"byteLength":{bytes}{stride}{target}}}"#)
        })
    }
}

/// `true` if 8 bits per channel hold a colour exactly.
fn in_bytes(color: &[f32; 3]) -> bool {
    color.iter().all(|channel| {
        let steps = (channel.clamp(0.0, 1.0) * 255.0).round();
        (steps / 255.0).to_bits() == channel.to_bits()
    })
}

/// `true` if 16 bits per coordinate hold a texture coordinate exactly.
fn in_shorts(uv: Vec2) -> bool {
    uv.to_array().into_iter().all(|x| {
        let steps = (x.clamp(0.0, 1.0) * 65_535.0).round();
        (steps / 65_535.0).to_bits() == x.to_bits()
    })
}

fn corners([low, high]: [[f32; 3]; 2]) -> String {
    format!(r#","min":{},"max":{}"#, numbers(&low), numbers(&high))
}

/// The box around some copies, by the same steps by which they are written.
fn bounds(mesh: &Mesh, copies: Option<&[Instance]>) -> [Vec3; 2] {
    let around = |[low, high]: [Vec3; 2], point: Vec3| [low.min(point), high.max(point)];
    let nothing = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    let Some(copies) = copies else { return mesh.positions.iter().copied().fold(nothing, around) };
    copies.iter().fold(nothing, |all, copy| {
        let matrix = copy.matrix();
        mesh.positions.iter().fold(all, |all, &point| around(all, matrix * point + copy.position))
    })
}
