//! glTF 2.0, binary and text: the triangles of a scene where they stand. Specification:
//! <https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>.

mod buffer;
mod document;

use std::io::BufRead;
use std::path::Path;

use glam::{DMat4, DQuat, DVec3};

use self::buffer::Buffers;
use self::document::{Document, Node, Primitive};
use super::soup::Soup;
use super::{MeshFormat, unreadable};
use crate::shape::TriangleMeshError;
use crate::text::{BYTE_ORDER_MARK, quoted, stranger};

/// Limit of vertices and corners where it is above the file's number of bytes: instances and nodes that share
/// a mesh may make more of them than the file has bytes.
const MOST_CORNERS: usize = 30_000_000;

/// The deepest tree of nodes.
const DEEPEST: usize = 10_000;

const TRIANGLES: u64 = 4;
const STRIP: u64 = 5;
const FAN: u64 = 6;

/// `folder` is the folder of the file's external buffers; without it they are refused.
pub(super) fn read(
    mut reader: impl BufRead,
    folder: Option<&Path>,
    soup: &mut Soup,
) -> Result<(), TriangleMeshError> {
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).map_err(|error| fault("byte 0", error))?;
    if bytes.is_empty() {
        return Err(fault("byte 0", "the file is empty"));
    }
    if let Some(what) = stranger(&bytes) {
        return Err(fault("byte 0", what));
    }
    let (text, binary) = if bytes.starts_with(b"glTF") { chunks(&bytes)? } else { (&bytes[..], None) };
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    if text.iter().find(|byte| !byte.is_ascii_whitespace()) != Some(&b'{') {
        let problem =
            format!("the file begins with {}, but must begin with \"glTF\" or \"{{\"", quoted(text));
        return Err(fault("byte 0", problem));
    }
    let document: Document = serde_json::from_slice(text).map_err(|error| {
        let reason: String = error.to_string().chars().take(200).collect();
        fault(format_args!("line {} of its JSON", error.line()), reason)
    })?;
    document.check()?;
    let buffers = Buffers::new(&document, binary, folder)?;
    let left = MOST_CORNERS.max(bytes.len());
    let mut scene = Scene { document: &document, buffers: &buffers, soup, left };
    scene.read()
}

fn fault(place: impl std::fmt::Display, problem: impl std::fmt::Display) -> TriangleMeshError {
    unreadable(MeshFormat::Gltf, place, problem)
}

/// The JSON chunk and the binary one of a `.glb` file.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), TriangleMeshError> {
    let word =
        |at: usize| bytes.get(at..at + 4).map(|word| u32::from_le_bytes(word.try_into().unwrap_or_default()));
    let cut = |at: usize| fault(format_args!("byte {at}"), "the file ends within a chunk: it is cut short");
    let version = word(4).ok_or_else(|| cut(4))?;
    if version != 2 {
        return Err(fault("byte 4", format!("the version is {version}, but must be 2")));
    }
    let (mut at, mut text, mut binary) = (12, None, None);
    while let Some(length) = word(at) {
        let kind = word(at + 4).ok_or_else(|| cut(at))?;
        let chunk =
            bytes.get(at + 8..).and_then(|rest| rest.get(..length as usize)).ok_or_else(|| cut(at))?;
        match kind {
            0x4E4F_534A => text = text.or(Some(chunk)),
            0x004E_4942 => binary = binary.or(Some(chunk)),
            _ => {}
        }
        at = (at + 8 + length as usize).next_multiple_of(4);
    }
    text.map(|text| (text, binary)).ok_or_else(|| fault("byte 12", "it has no JSON chunk"))
}

struct Scene<'a> {
    document: &'a Document,
    buffers: &'a Buffers<'a>,
    soup: &'a mut Soup,
    /// Vertices and corners that may still come.
    left: usize,
}

impl Scene<'_> {
    fn read(&mut self) -> Result<(), TriangleMeshError> {
        let nodes = &self.document.nodes;
        if nodes.is_empty() {
            return (0..self.document.meshes.len()).try_for_each(|mesh| {
                self.afford(mesh, 1)?;
                self.mesh(mesh, DMat4::IDENTITY)
            });
        }
        let mut seen = vec![false; nodes.len()];
        let mut waiting: Vec<(usize, DMat4, usize)> =
            self.document.roots()?.into_iter().map(|root| (root, DMat4::IDENTITY, 0)).collect();
        waiting.reverse();
        while let Some((number, above, depth)) = waiting.pop() {
            let place = format!("node {number}");
            let node =
                nodes.get(number).ok_or_else(|| fault(&place, format!("there are {} nodes", nodes.len())))?;
            if std::mem::replace(&mut seen[number], true) {
                return Err(fault(place, "it has two parents, or is its own ancestor; nodes must be a tree"));
            }
            if depth > DEEPEST {
                return Err(fault(place, format!("it is more than {DEEPEST} nodes deep")));
            }
            let matrix = above * node.matrix();
            if let Some(mesh) = node.mesh {
                self.stand(mesh, node, number, matrix)?;
            }
            waiting.extend(node.children.iter().rev().map(|&child| (child, matrix, depth + 1)));
        }
        Ok(())
    }

    /// A node's mesh, once or at each of its instances.
    fn stand(
        &mut self,
        mesh: usize,
        node: &Node,
        number: usize,
        matrix: DMat4,
    ) -> Result<(), TriangleMeshError> {
        let Some(instances) = node.extensions.as_ref().and_then(|all| all.instancing.as_ref()) else {
            self.afford(mesh, 1)?;
            // Joints place a mesh with a skin, and its node does not.
            let matrix = if node.skin.is_some() { DMat4::IDENTITY } else { matrix };
            return self.mesh(mesh, matrix);
        };
        let place = format!("node {number}");
        let array = |accessor: Option<usize>, width: usize| {
            accessor.map(|accessor| self.buffers.numbers(accessor, width)).transpose()
        };
        let [translations, scales] =
            [array(instances.attributes.translation, 3)?, array(instances.attributes.scale, 3)?];
        let rotations = array(instances.attributes.rotation, 4)?;
        let counts = [(&translations, 3), (&rotations, 4), (&scales, 3)];
        let mut counts = counts.into_iter().filter_map(|(array, width)| Some(array.as_ref()?.len() / width));
        let count = counts.next().unwrap_or(0);
        if counts.any(|other| other != count) {
            return Err(fault(
                place,
                "its instances have translations, rotations and scales of different counts",
            ));
        }
        self.afford(mesh, count)?;
        for i in 0..count {
            let vector = |array: &Option<Vec<f64>>, otherwise: DVec3| {
                array.as_ref().map_or(otherwise, |array| DVec3::from_slice(&array[3 * i..]))
            };
            let rotation = rotations
                .as_ref()
                .map_or(DQuat::IDENTITY, |array| document::rotation(&array[4 * i..4 * i + 4]));
            let instance = DMat4::from_scale_rotation_translation(
                vector(&scales, DVec3::ONE),
                rotation,
                vector(&translations, DVec3::ZERO),
            );
            self.mesh(mesh, matrix * instance)?;
        }
        Ok(())
    }

    /// Counts `copies` copies of a mesh, and refuses those above the limit.
    fn afford(&mut self, mesh: usize, copies: usize) -> Result<(), TriangleMeshError> {
        let count = |accessor: Option<usize>| {
            accessor
                .and_then(|accessor| self.document.accessors.get(accessor))
                .map_or(0, |accessor| accessor.count)
        };
        let primitives = self.document.meshes.get(mesh).map_or(&[][..], |mesh| &mesh.primitives);
        let each = primitives.iter().fold(0_usize, |sum, primitive| {
            sum.saturating_add(count(primitive.attributes.position)).saturating_add(count(primitive.indices))
        });
        let left = self.left.checked_sub(each.saturating_mul(copies));
        self.left = left.ok_or_else(|| {
            let problem = format!(
                "its {copies} copies of {each} vertices and indices are more than {MOST_CORNERS} in all"
            );
            fault(format_args!("mesh {mesh}"), problem)
        })?;
        Ok(())
    }

    fn mesh(&mut self, number: usize, matrix: DMat4) -> Result<(), TriangleMeshError> {
        let meshes = &self.document.meshes;
        let mesh = meshes.get(number).ok_or_else(|| {
            fault(format_args!("mesh {number}"), format!("there are {} meshes", meshes.len()))
        })?;
        mesh.primitives.iter().try_for_each(|primitive| self.primitive(primitive, number, matrix))
    }

    fn primitive(
        &mut self,
        primitive: &Primitive,
        mesh: usize,
        matrix: DMat4,
    ) -> Result<(), TriangleMeshError> {
        let place = format!("mesh {mesh}");
        let mode = primitive.mode.unwrap_or(TRIANGLES);
        let (Some(positions), TRIANGLES..=FAN) = (primitive.attributes.position, mode) else { return Ok(()) };
        let numbers = self.buffers.numbers(positions, 3)?;
        let count = numbers.len() / 3;
        let indices = primitive.indices.map(|indices| self.buffers.indices(indices)).transpose()?;
        let first = self.soup.positions.len();
        let corners = indices.as_ref().map_or(count, Vec::len);
        let triangles = if mode == TRIANGLES { corners / 3 } else { corners.saturating_sub(2) };
        for position in numbers.chunks_exact(3) {
            let position = matrix.transform_point3(DVec3::from_slice(position));
            if !position.is_finite() {
                return Err(fault(
                    place,
                    format!("it has a vertex at {position}, but positions must be finite"),
                ));
            }
            self.soup.positions.push(position);
        }
        if let Some(&index) = indices.iter().flatten().find(|&&index| index >= count as u64) {
            return Err(fault(place, format!("it names the vertex {index}, but has {count}")));
        }
        let corner = |i: usize| indices.as_ref().map_or(i, |indices| indices[i] as usize);
        let mirrored = matrix.determinant() < 0.0;
        for t in 0..triangles {
            let [a, b, c] = match mode {
                TRIANGLES => [3 * t, 3 * t + 1, 3 * t + 2],
                STRIP if t % 2 == 1 => [t + 1, t, t + 2],
                STRIP => [t, t + 1, t + 2],
                _ => [0, t + 1, t + 2],
            }
            .map(|i| (first + corner(i)) as u32);
            self.soup.polygon(if mirrored { [a, c, b] } else { [a, b, c] });
        }
        Ok(())
    }
}
