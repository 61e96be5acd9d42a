//! STL, binary and text.
//!
//! Binary: a header of 80 bytes, a count, and 50 bytes per triangle. Text: solids of facets, each with a loop
//! of vertices; readers in use take keywords in any case and names of any bytes. Specification: the
//! `StereoLithography` Interface Specification of 3D Systems, 1988, as
//! <https://www.fabbers.com/tech/STL_Format> gives it.

use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};

use glam::{DVec3, Vec3};

use super::soup::Soup;
use super::{MeshFormat, unreadable};
use crate::shape::TriangleMeshError;
use crate::text::{BYTE_ORDER_MARK, Lines, number, quoted, stranger, words};

const HEADER: u64 = 84;
const TRIANGLE: u64 = 50;

pub(super) fn read(mut reader: impl Read + Seek, soup: &mut Soup) -> Result<(), TriangleMeshError> {
    let (length, start) = begin(&mut reader).map_err(|error| fault("byte 0", error))?;
    if length == 0 {
        return Err(fault("byte 0", "the file is empty"));
    }
    if let Some(what) = stranger(&start) {
        return Err(fault("byte 0", what));
    }
    let body = length.saturating_sub(HEADER);
    let count = start
        .get(80..84)
        .map_or(0, |bytes| u64::from(u32::from_le_bytes(bytes.try_into().unwrap_or_default())));
    let reader = BufReader::with_capacity(1 << 16, reader);
    // A text of 84 + 50 n bytes whose bytes 80 to 83 spell just that n would be of the petabytes.
    let exact = length >= HEADER && body == count * TRIANGLE;
    if !exact && is_text(&start) {
        return text(reader, soup);
    }
    if length < HEADER {
        let problem = format!(
            "the file has {length} bytes and is no text; a text begins with \"solid\", and a binary file has 84 bytes and 50 per triangle"
        );
        return Err(fault("byte 0", problem));
    }
    // Programs that write as they go leave a count of nothing, or of everything; the length tells.
    let counted = if body % TRIANGLE == 0 && (count < body / TRIANGLE || count == u64::from(u32::MAX)) {
        body / TRIANGLE
    } else {
        count
    };
    if counted * TRIANGLE > body {
        let problem = format!(
            "the header counts {counted} triangles, which take {} bytes, but the file has {length}: it is cut short, or no STL file; a text would begin with \"solid\"",
            HEADER + counted * TRIANGLE
        );
        return Err(fault("byte 80", problem));
    }
    binary(reader, counted, soup)
}

fn fault(place: impl std::fmt::Display, problem: impl std::fmt::Display) -> TriangleMeshError {
    unreadable(MeshFormat::Stl, place, problem)
}

/// The length of the file and its first bytes; the reader is back where it was.
fn begin(reader: &mut (impl Read + Seek)) -> io::Result<(u64, Vec<u8>)> {
    let from = reader.stream_position()?;
    let length = reader.seek(SeekFrom::End(0))?.saturating_sub(from);
    reader.seek(SeekFrom::Start(from))?;
    let mut start = Vec::new();
    reader.take(512).read_to_end(&mut start)?;
    reader.seek(SeekFrom::Start(from))?;
    Ok((length, start))
}

/// `true` if a file begins like a text: one that is an STL file, or was meant to be one.
fn is_text(start: &[u8]) -> bool {
    let start = start.strip_prefix(BYTE_ORDER_MARK).unwrap_or(start);
    start.iter().all(|&byte| byte >= b' ' || byte.is_ascii_whitespace() || byte == 0x0B || byte == 0x1A)
        && !start.iter().all(u8::is_ascii_whitespace)
}

fn binary(mut reader: impl BufRead, count: u64, soup: &mut Soup) -> Result<(), TriangleMeshError> {
    io::copy(&mut reader.by_ref().take(HEADER), &mut io::sink()).map_err(|error| fault("byte 0", error))?;
    if count * 3 > u64::from(u32::MAX) {
        return Err(fault("byte 80", format!("{count} triangles, but at most 1,431,655,765 can be read")));
    }
    let mut bytes = [0; TRIANGLE as usize];
    for triangle in 0..count {
        let place = HEADER + triangle * TRIANGLE;
        reader.read_exact(&mut bytes).map_err(|error| fault(format_args!("byte {place}"), error))?;
        let float = |at: usize| f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        // The first three numbers are a normal, which the corners give.
        let corners = [12, 24, 36].map(|at| Vec3::new(float(at), float(at + 4), float(at + 8)));
        if let Some((number, corner)) = (0..3).zip(corners).find(|(_, corner)| !corner.is_finite()) {
            let problem = format!("vertex {number} of triangle {triangle} is {corner}, but must be finite");
            return Err(fault(format_args!("byte {place}"), problem));
        }
        let first = soup.positions.len() as u32;
        soup.positions.extend(corners.map(Vec3::as_dvec3));
        soup.polygon([first, first + 1, first + 2]);
    }
    Ok(())
}

fn text(reader: impl BufRead, soup: &mut Soup) -> Result<(), TriangleMeshError> {
    let mut lines = Lines::new(reader);
    let (mut begun, mut ended, mut facets) = (false, false, 0_u64);
    // Vertices of the loop that is open.
    let mut loose = 0;
    while lines.read().map_err(|error| fault(format_args!("line {}", lines.number() + 1), error))? {
        let line = lines.number();
        let fault = |problem: String| fault(format_args!("line {line}"), problem);
        let mut rest = words(lines.line());
        while let Some(word) = rest.next() {
            let keyword = word.to_ascii_lowercase();
            let closes =
                matches!(&keyword[..], b"endloop" | b"endfacet" | b"end" | b"facet" | b"solid" | b"endsolid");
            if closes && loose > 0 {
                if loose < 3 {
                    return Err(fault(format!("a loop has {loose} vertices, but must have 3 or more")));
                }
                soup.close();
                loose = 0;
            }
            match &keyword[..] {
                // A name of any words follows.
                b"solid" | b"endsolid" => {
                    begun = true;
                    ended = keyword.starts_with(b"end");
                    break;
                }
                b"facet" => {
                    begun = true;
                    facets += 1;
                    // The normal follows from the vertices, and often is nan.
                    let after = rest.clone().next();
                    if after.is_some_and(|word| word.eq_ignore_ascii_case(b"normal")) {
                        rest.by_ref().take(4).for_each(drop);
                    }
                }
                b"vertex" => {
                    let vertex = vertex(&mut rest, soup.positions.len() / 3, facets).map_err(fault)?;
                    if soup.positions.len() >= u32::MAX as usize {
                        return Err(fault("more than 4,294,967,295 vertices".into()));
                    }
                    soup.corner(soup.positions.len() as u32);
                    soup.positions.push(vertex);
                    loose += 1;
                }
                _ if begun => {}
                _ => {
                    let found = quoted(lines.line().trim_ascii());
                    return Err(fault(format!(
                        "the file is a text that begins with {found}, but must begin with \"solid\"; its length is not that of a binary file, 84 bytes and 50 per triangle"
                    )));
                }
            }
        }
    }
    let place = format!("line {}", lines.number());
    if loose > 0 {
        return Err(fault(place, "the text ends within a facet: it is cut short"));
    }
    if !ended {
        return Err(fault(
            place,
            format!("the text ends after {facets} facets without \"endsolid\": it is cut short"),
        ));
    }
    Ok(())
}

fn vertex<'a>(
    rest: &mut impl Iterator<Item = &'a [u8]>,
    triangle: usize,
    facet: u64,
) -> Result<DVec3, String> {
    let mut vertex = DVec3::ZERO;
    for axis in 0..3 {
        let word = rest.next().unwrap_or_default();
        let value = number(word).filter(|value| (*value as f32).is_finite());
        vertex[axis] = value.ok_or_else(|| {
            format!(
                "a vertex of facet {facet} (triangle {triangle}) has the coordinate {}, but must have three finite numbers, at most 3.4e38",
                quoted(word)
            )
        })?;
    }
    Ok(vertex)
}
