//! PLY, binary and text, after Turk's description of 1994, <https://paulbourke.net/dataformats/ply/>.
//!
//! The positions of the vertices and the corners of the faces are read; every other element and property is passed over,
//! of any name and value. No count in the header is believed: memory grows with what is there.

use std::io::BufRead;

use glam::DVec3;

use super::soup::Soup;
use super::{MeshFormat, unreadable};
use crate::ply::{Element, Fault, Header, Kind, Values};
use crate::shape::TriangleMeshError;

const NEEDED: &str = "a solid needs vertex and face";

pub(super) fn read(mut reader: impl BufRead, soup: &mut Soup) -> Result<(), TriangleMeshError> {
    let header = Header::read(&mut reader)?;
    let vertex = header.element(b"vertex", NEEDED)?;
    let face = header.element(b"face", NEEDED)?;
    let axes = [b"x", b"y", b"z"].map(|axis| vertex.property(&[axis]));
    let [Some(x), Some(y), Some(z)] = axes else {
        let problem = format!("vertex has {}, but must have x, y and z", vertex.names());
        return Err(fault("header", problem));
    };
    if [x, y, z].iter().any(|&axis| matches!(vertex.properties[axis].kind, Kind::List(..))) {
        return Err(fault("header", "x, y or z of vertex is a list, but must be a number"));
    }
    let list = face.property(&[b"vertex_indices", b"vertex_index", b"vertex_indexes"]);
    let Some(list) = list.filter(|&list| matches!(face.properties[list].kind, Kind::List(..))) else {
        let problem = format!("face has {}, but must have the list vertex_indices", face.names());
        return Err(fault("header", problem));
    };
    let (vertex, face) = (vertex.name.clone(), face.name.clone());
    let mut values = Values::new(reader, header.encoding, header.lines, header.bytes);
    let mut vertices = None;
    // The highest vertex that a face names, and where.
    let (mut highest, mut at) = (None, 0);
    let mut faces = false;
    for element in &header.elements {
        if element.name == vertex && vertices.is_none() {
            read_vertices(&mut values, element, [x, y, z], soup)?;
            vertices = Some(soup.positions.len() as u64);
        } else if element.name == face && !faces {
            faces = true;
            read_faces(&mut values, element, list, soup, |index, values| {
                if highest.is_none_or(|highest| index > highest) {
                    (highest, at) = (Some(index), values.at());
                }
            })?;
        } else if vertices.is_none() || !faces {
            values.pass(element)?;
        }
    }
    let there = soup.positions.len();
    if let Some(index) = highest.filter(|&index| index as usize >= there) {
        let problem = format!("a face names the vertex {index}, but there are {there}, counted from 0");
        return Err(fault(values.place_of(at), problem));
    }
    Ok(())
}

impl From<Fault> for TriangleMeshError {
    fn from(fault: Fault) -> Self {
        unreadable(MeshFormat::Ply, fault.place, fault.problem)
    }
}

fn fault(place: impl std::fmt::Display, problem: impl std::fmt::Display) -> TriangleMeshError {
    unreadable(MeshFormat::Ply, place, problem)
}

fn read_vertices(
    values: &mut Values<impl BufRead>,
    element: &Element,
    axes: [usize; 3],
    soup: &mut Soup,
) -> Result<(), TriangleMeshError> {
    if element.count > u64::from(u32::MAX) {
        return Err(fault(
            "header",
            format!("{} vertices, but at most 4,294,967,295 can be named", element.count),
        ));
    }
    for number in 0..element.count {
        let mut position = DVec3::ZERO;
        values.begin(element, number)?;
        for (at, property) in element.properties.iter().enumerate() {
            let axis = axes.iter().position(|&axis| axis == at);
            match (property.kind, axis) {
                (Kind::Scalar(scalar), Some(axis)) => position[axis] = values.number(scalar)?,
                _ => values.pass_property(property)?,
            }
        }
        if !position.is_finite() {
            let problem = format!("vertex {number} is {position}, but must be finite");
            return Err(fault(values.place(), problem));
        }
        soup.positions.push(position);
    }
    Ok(())
}

fn read_faces<R: BufRead>(
    values: &mut Values<R>,
    element: &Element,
    list: usize,
    soup: &mut Soup,
    mut see: impl FnMut(u32, &Values<R>),
) -> Result<(), TriangleMeshError> {
    for number in 0..element.count {
        values.begin(element, number)?;
        for (at, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::List(count, item) if at == list => {
                    for _ in 0..values.whole(count, "a face's number of corners")? {
                        let index = values.whole(item, "a face's vertex")?;
                        let index = u32::try_from(index).map_err(|_| {
                            fault(
                                values.place(),
                                format!(
                                    "face {number} names the vertex {index}, but at most 4,294,967,295 can be"
                                ),
                            )
                        })?;
                        see(index, values);
                        soup.corner(index);
                    }
                    soup.close();
                    if soup.corners() > u32::MAX as usize {
                        return Err(fault(values.place(), "more than 4,294,967,295 corners of faces"));
                    }
                }
                _ => values.pass_property(property)?,
            }
        }
    }
    Ok(())
}
