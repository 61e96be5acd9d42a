//! Clouds in files: PLY and text.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::Path;

use glam::DVec3;

use super::{Cloud, CloudError, Frame};
use crate::ply::{Fault, Header, Kind, Values};
use crate::text::{Lines, number, quoted, stranger};

/// Encoding of a PLY file's numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum PlyEncoding {
    /// `binary_little_endian`.
    #[default]
    Little,
    /// `binary_big_endian`.
    Big,
    /// `ascii`.
    Text,
}

pub(super) fn fault(
    format: &'static str,
    place: impl std::fmt::Display,
    problem: impl std::fmt::Display,
) -> CloudError {
    CloudError::File { format, place: place.to_string(), problem: problem.to_string() }
}

impl From<Fault> for CloudError {
    fn from(Fault { place, problem }: Fault) -> Self {
        Self::File { format: "PLY", place, problem }
    }
}

/// `true` for a byte that separates numbers of a text.
fn is_between(byte: u8) -> bool {
    byte.is_ascii_whitespace() || matches!(byte, 0 | 0x0B)
}

/// The words of a line: between semicolons, else commas, else tabs if there are three columns of them, where a column may be
/// empty; else between blanks. A decimal comma stays in its word, which is no number then.
fn fields(line: &[u8]) -> Vec<&[u8]> {
    let line = line.trim_ascii();
    let between = [(b';', 1), (b',', 1), (b'\t', 2)];
    let columns = |byte| line.split(|&own| own == byte).count();
    match between.into_iter().find(|&(byte, least)| columns(byte) > least) {
        Some((byte, _)) => line.split(|&own| own == byte).map(<[u8]>::trim_ascii).collect(),
        None => line.split(|&byte| is_between(byte)).filter(|word| !word.is_empty()).collect(),
    }
}

impl Cloud {
    /// Reads the positions `x`, `y`, `z` of the element `vertex` of a PLY file: text or binary of either byte order, of any kind
    /// of number; everything else is passed over. No count in the header is believed. 24 bytes per point
    /// beside the cloud.
    ///
    /// # Errors
    /// A frame out of range; what cannot be read, by the line or byte; lines of a text with more numbers than its header
    /// says; points that are not finite or too far off.
    pub fn read_ply(frame: &Frame, reader: impl Read) -> Result<Self, CloudError> {
        frame.check()?;
        let mut reader = BufReader::with_capacity(1 << 16, reader);
        let header = Header::read(&mut reader)?;
        let vertex = header.element(b"vertex", "a cloud needs vertex")?;
        let axes = [b"x", b"y", b"z"].map(|axis| vertex.property(&[axis]));
        let [Some(x), Some(y), Some(z)] = axes else {
            let problem = format!("vertex has {}, but must have x, y and z", vertex.names());
            return Err(fault("PLY", "header", problem));
        };
        let axes = [x, y, z];
        if axes.iter().any(|&axis| matches!(vertex.properties[axis].kind, Kind::List(..))) {
            return Err(fault("PLY", "header", "x, y or z of vertex is a list, but must be a number"));
        }
        let name = vertex.name.clone();
        let mut values = Values::new(reader, header.encoding, header.lines, header.bytes);
        let mut places = Vec::new();
        for element in &header.elements {
            if element.name != name {
                values.pass(element)?;
                continue;
            }
            for number in 0..element.count {
                values.begin(element, number)?;
                let mut place = DVec3::ZERO;
                for (at, property) in element.properties.iter().enumerate() {
                    let axis = axes.iter().position(|&axis| axis == at);
                    match (property.kind, axis) {
                        (Kind::Scalar(scalar), Some(axis)) => place[axis] = values.number(scalar)?,
                        _ => values.pass_property(property)?,
                    }
                }
                if values.is_within_line() {
                    let problem =
                        format!("the line has more numbers than vertex has properties, {}", vertex.names());
                    return Err(fault("PLY", values.place(), problem));
                }
                if !place.is_finite() {
                    let problem = format!("point {number} is {place}, but must be finite");
                    return Err(fault("PLY", values.place(), problem));
                }
                places.push(place);
            }
            break;
        }
        Self::from_places(frame, &places)
    }

    /// Reads text with one point per line, as `.xyz`, `.csv`, `.txt`, `.asc` and `.pts` files have
    /// it: numbers with blanks, tabs, commas or semicolons between them. Numbers have a decimal
    /// point: a decimal comma is an error where it can be told from a separator.
    ///
    /// The first three are taken; where a line with the names `x`, `y` and `z` (in capitals or not, with `//` or `#` before or not)
    /// stands before the first point, those columns. Lines that begin with `#` or `//`, and a first line of one number alone (a
    /// count), are passed over.
    ///
    /// # Errors
    /// A frame out of range; whatever the reader returns; a line with fewer than three numbers, or with a
    /// word that is no number; points that are not finite or too far off.
    pub fn read_xyz(frame: &Frame, reader: impl Read) -> Result<Self, CloudError> {
        frame.check()?;
        let mut lines = Lines::new(BufReader::with_capacity(1 << 16, reader));
        let mut columns = [0, 1, 2];
        // Number of column names, and whether they stand in a comment.
        let mut names: Option<(usize, bool)> = None;
        let (mut passed, mut has_count) = (0, false);
        let mut places = Vec::new();
        while lines.read()? {
            let (line, number_of) = (lines.line(), lines.number());
            if let Some(what) = stranger(line).filter(|_| number_of == 1) {
                return Err(fault("XYZ", "line 1", what));
            }
            let comment = line.trim_ascii_start();
            let is_comment = comment.starts_with(b"#") || comment.starts_with(b"//");
            let mut words = fields(line);
            let Some(&first) = words.first() else { continue };
            let is_header = names.is_none_or(|(_, in_comment)| in_comment) && number(first).is_none();
            if is_comment || (places.is_empty() && is_header) {
                if let Some((found, count)) = named(line).filter(|_| places.is_empty()) {
                    (columns, names) = (found, Some((count, is_comment)));
                } else if !is_comment {
                    passed = number_of;
                }
                continue;
            }
            if places.is_empty() && !has_count && words.len() == 1 {
                has_count = true;
                continue;
            }
            match names {
                // A comment that only happens to have these words.
                Some((count, true)) if places.is_empty() && words.len() != count => columns = [0, 1, 2],
                // R names rows, and has no name for that column.
                Some((count, false)) if words.len() == count + 1 && !words[0].is_empty() => {
                    words.remove(0);
                }
                _ => {}
            }
            let mut place = DVec3::ZERO;
            let mut found = 0;
            for (at, word) in words.into_iter().enumerate() {
                let Some(axis) = columns.iter().position(|&column| column == at) else { continue };
                place[axis] = number(word).filter(|value| value.is_finite()).ok_or_else(|| {
                    let problem = format!("{} must be a finite number", quoted(word));
                    fault("XYZ", format_args!("line {number_of}, column {}", at + 1), problem)
                })?;
                found += 1;
                if found == 3 {
                    break;
                }
            }
            if found < 3 {
                let problem = format!("{} must have the three numbers of a point", quoted(line.trim_ascii()));
                return Err(fault("XYZ", format_args!("line {number_of}"), problem));
            }
            places.push(place);
        }
        if places.is_empty() && passed > 0 && names.is_none() {
            let problem = "no line begins with a number (with a decimal point): it is no text of points";
            return Err(fault("XYZ", format_args!("line {passed}"), problem));
        }
        Self::from_places(frame, &places)
    }

    /// Reads a file by its name's ending: `.ply`, `.las`, `.laz`, `.e57`, else text.
    ///
    /// # Errors
    /// As [`read_ply`](Self::read_ply) and the other readers; a file that cannot be opened; `.las`, `.laz` and `.e57` without the
    /// feature `lidar`.
    pub fn open(frame: &Frame, path: impl AsRef<Path>) -> Result<Self, CloudError> {
        let path = path.as_ref();
        let told = |error: io::Error| io::Error::new(error.kind(), format!("{}: {error}", path.display()));
        let file = File::open(path).map_err(told)?;
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        match ending.to_str() {
            Some("ply") => Self::read_ply(frame, file),
            #[cfg(feature = "lidar")]
            Some("las" | "laz") => Self::read_las(frame, file),
            #[cfg(feature = "lidar")]
            Some("e57") => Self::read_e57(frame, file),
            #[cfg(not(feature = "lidar"))]
            Some(ending @ ("las" | "laz" | "e57")) => {
                let problem = format!("it is .{ending}, for which treesynth needs its feature lidar");
                Err(fault("cloud", path.display(), problem))
            }
            _ => Self::read_xyz(frame, file),
        }
    }

    /// Writes a PLY file of the element `vertex`; its numbers are `double` if the frame has an offset or a unit other than metres,
    /// else `float`. O(n).
    ///
    /// # Errors
    /// A frame out of range; whatever the writer returns.
    pub fn write_ply(
        &self,
        frame: &Frame,
        encoding: PlyEncoding,
        writer: impl Write,
    ) -> Result<(), CloudError> {
        frame.check()?;
        let mut writer = BufWriter::with_capacity(1 << 16, writer);
        let name = match encoding {
            PlyEncoding::Little => "binary_little_endian",
            PlyEncoding::Big => "binary_big_endian",
            PlyEncoding::Text => "ascii",
        };
        let kind = if frame.is_short() { "float" } else { "double" };
        writeln!(writer, "ply\nformat {name} 1.0\ncomment treesynth\nelement vertex {}", self.len())?;
        for axis in ["x", "y", "z"] {
            writeln!(writer, "property {kind} {axis}")?;
        }
        writeln!(writer, "end_header")?;
        for &point in self.points() {
            let place = frame.written(point);
            if encoding == PlyEncoding::Text {
                let [x, y, z] = place;
                writeln!(writer, "{x} {y} {z}")?;
                continue;
            }
            for number in place {
                number.write(&mut writer, encoding == PlyEncoding::Big)?;
            }
        }
        writer.flush()?;
        Ok(())
    }

    /// Writes text with one point per line, `x y z`. O(n).
    ///
    /// # Errors
    /// A frame out of range; whatever the writer returns.
    pub fn write_xyz(&self, frame: &Frame, writer: impl Write) -> Result<(), CloudError> {
        frame.check()?;
        let mut writer = BufWriter::with_capacity(1 << 16, writer);
        for &point in self.points() {
            let [x, y, z] = frame.written(point);
            writeln!(writer, "{x} {y} {z}")?;
        }
        writer.flush()?;
        Ok(())
    }
}

/// The columns called x, y and z, and how many names there are.
fn named(line: &[u8]) -> Option<([usize; 3], usize)> {
    let text = line.trim_ascii_start();
    let text = text.strip_prefix(b"//").or(text.strip_prefix(b"#")).unwrap_or(text);
    let names: Vec<Vec<u8>> = fields(text)
        .into_iter()
        .map(|name| {
            name.iter().filter(|byte| byte.is_ascii_alphanumeric()).map(u8::to_ascii_lowercase).collect()
        })
        .collect();
    let [x, y, z] = [b"x", b"y", b"z"].map(|axis| names.iter().position(|name| name == axis));
    Some(([x?, y?, z?], names.len()))
}
