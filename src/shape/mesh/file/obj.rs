//! Wavefront OBJ. Specification: <https://paulbourke.net/dataformats/obj/>.
//!
//! Positions (`v`) and faces (`f`, in old files `fo`) are read; every other statement is passed over, known or not.

use std::io::BufRead;

use glam::DVec3;

use super::soup::Soup;
use super::{MeshFormat, unreadable};
use crate::shape::TriangleMeshError;
use crate::text::{Lines, number, quoted, stranger, words};

/// Number of lines so far of each kind to which faces refer.
#[derive(Default)]
struct Counts {
    positions: i64,
    texture: i64,
    normals: i64,
}

/// The highest vertex that a face has named before it was there.
#[derive(Default)]
struct Latest {
    vertex: i64,
    line: u64,
}

pub(super) fn read(reader: impl BufRead, soup: &mut Soup) -> Result<(), TriangleMeshError> {
    let mut lines = Lines::new(reader);
    let (mut counts, mut latest) = (Counts::default(), Latest::default());
    loop {
        let read = lines.read();
        if !read.map_err(|error| fault(lines.number() + 1, error))? {
            break;
        }
        let first = lines.number();
        if first == 1
            && let Some(what) = stranger(lines.line())
        {
            return Err(fault(first, what));
        }
        let Some(keyword) = words(lines.line()).next().map(<[u8]>::to_ascii_lowercase) else { continue };
        if matches!(&keyword[..], b"v" | b"f" | b"fo") {
            let mut start = 0;
            while let Some(part) = data(&lines.line()[start..]).trim_ascii_end().strip_suffix(b"\\") {
                let end = start + part.len();
                if !lines.join(end).map_err(|error| fault(first, error))? {
                    break;
                }
                start = end;
            }
        }
        let rest = words(data(lines.line())).skip(1);
        match &keyword[..] {
            b"v" => {
                soup.positions.push(position(rest).map_err(|problem| fault(first, problem))?);
                counts.positions += 1;
                if counts.positions > i64::from(u32::MAX) {
                    return Err(fault(first, "more than 4,294,967,295 vertices"));
                }
            }
            b"vt" => counts.texture += 1,
            b"vn" => counts.normals += 1,
            b"f" | b"fo" => {
                for word in rest {
                    let vertex = corner(word, &counts).map_err(|problem| fault(first, problem))?;
                    if vertex > latest.vertex {
                        latest = Latest { vertex, line: first };
                    }
                    soup.corner((vertex - 1) as u32);
                }
                soup.close();
                if soup.corners() > u32::MAX as usize {
                    return Err(fault(first, "more than 4,294,967,295 corners of faces"));
                }
            }
            _ => {}
        }
    }
    if lines.number() == 0 {
        return Err(unreadable(MeshFormat::Obj, "byte 0", "the file is empty"));
    }
    if latest.vertex > counts.positions {
        let problem = format!(
            "a face names the vertex {}, but the file has {} (v lines)",
            latest.vertex, counts.positions
        );
        return Err(fault(latest.line, problem));
    }
    Ok(())
}

fn fault(line: u64, problem: impl std::fmt::Display) -> TriangleMeshError {
    unreadable(MeshFormat::Obj, format_args!("line {line}"), problem)
}

/// A line up to a comment: a `#` at its start or after white space.
fn data(line: &[u8]) -> &[u8] {
    let comment = |at: usize| line[at] == b'#' && (at == 0 || line[at - 1].is_ascii_whitespace());
    &line[..(0..line.len()).find(|&at| comment(at)).unwrap_or(line.len())]
}

/// The first three numbers; a weight and colours behind them do not matter to polygons.
fn position<'a>(mut rest: impl Iterator<Item = &'a [u8]>) -> Result<DVec3, String> {
    let mut position = DVec3::ZERO;
    for axis in 0..3 {
        let word = rest.next().ok_or_else(|| format!("a vertex has {axis} coordinates, but must have 3"))?;
        let value = number(word).filter(|value| value.is_finite());
        position[axis] =
            value.ok_or_else(|| format!("a coordinate is {}, but must be a finite number", quoted(word)))?;
    }
    Ok(position)
}

/// The vertex of `v`, `v/vt`, `v//vn` or `v/vt/vn`, from 1. A negative number counts back from the latest line of its kind.
fn corner(word: &[u8], counts: &Counts) -> Result<i64, String> {
    let mut parts = word.split(|&byte| byte == b'/');
    let absolute = |part: &[u8], kind: &str, count: i64| -> Result<i64, String> {
        let digits = part.strip_prefix(b"-").unwrap_or(part);
        let whole = !digits.is_empty() && digits.iter().all(u8::is_ascii_digit);
        let range = || match count {
            0 => format!("but there is no {kind} line before it"),
            _ => format!("but must be from -{count} to -1, or from 1"),
        };
        if !whole {
            return Err(format!(
                "a face has the corner {}, but must name a {kind} line by a whole number",
                quoted(word)
            ));
        }
        let value = std::str::from_utf8(part).ok().and_then(|text| text.parse::<i64>().ok());
        let value = value.filter(|&value| value != 0 && (-count..=i64::from(u32::MAX)).contains(&value));
        let value =
            value.ok_or_else(|| format!("a face names the {kind} line {}, {}", quoted(part), range()))?;
        Ok(if value < 0 { count + value + 1 } else { value })
    };
    let vertex = absolute(parts.next().unwrap_or_default(), "v", counts.positions)?;
    for (part, kind, count) in [(parts.next(), "vt", counts.texture), (parts.next(), "vn", counts.normals)] {
        // Their targets do not matter, but one that counts back beyond the first shows that the file is
        // damaged.
        if let Some(part) = part.filter(|part| part.first() == Some(&b'-')) {
            absolute(part, kind, count)?;
        }
    }
    Ok(vertex)
}
