//! The header of a PLY file: the elements and properties that it declares.

use std::io::{self, BufRead};

use super::{Fault, fault};
use crate::text::{BYTE_ORDER_MARK, number, quoted, stranger, words};

/// Encoding of numbers in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    Text,
    Little,
    Big,
}

/// A kind of number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &[u8]) -> Option<Self> {
        match name.to_ascii_lowercase().as_slice() {
            b"char" | b"int8" => Some(Self::I8),
            b"uchar" | b"uint8" => Some(Self::U8),
            b"short" | b"int16" => Some(Self::I16),
            b"ushort" | b"uint16" => Some(Self::U16),
            b"int" | b"int32" => Some(Self::I32),
            b"uint" | b"uint32" => Some(Self::U32),
            b"int64" => Some(Self::I64),
            b"uint64" => Some(Self::U64),
            b"float" | b"float32" => Some(Self::F32),
            b"double" | b"float64" => Some(Self::F64),
            _ => None,
        }
    }

    /// Bytes in a binary file.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// One number, or a list: the kind of its length, then of its items.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Scalar(Scalar),
    List(Scalar, Scalar),
}

#[derive(Debug)]
pub(crate) struct Property {
    pub(crate) name: Vec<u8>,
    pub(crate) kind: Kind,
}

#[derive(Debug)]
pub(crate) struct Element {
    pub(crate) name: Vec<u8>,
    pub(crate) count: u64,
    pub(crate) properties: Vec<Property>,
}

impl Element {
    /// The first property of one of these names, in capitals or not.
    pub(crate) fn property(&self, names: &[&[u8]]) -> Option<usize> {
        self.properties
            .iter()
            .position(|property| names.iter().any(|name| property.name.eq_ignore_ascii_case(name)))
    }

    pub(crate) fn names(&self) -> String {
        listed(self.properties.iter().map(|property| &property.name[..]))
    }

    /// Bytes of each in a binary file, if it has no lists.
    pub(crate) fn size(&self) -> Option<u64> {
        self.properties
            .iter()
            .map(|property| match property.kind {
                Kind::Scalar(scalar) => Some(scalar.size() as u64),
                Kind::List(..) => None,
            })
            .sum()
    }
}

#[derive(Debug)]
pub(crate) struct Header {
    pub(crate) encoding: Encoding,
    pub(crate) elements: Vec<Element>,
    /// Lines and bytes of the header.
    pub(crate) lines: u64,
    pub(crate) bytes: u64,
}

impl Header {
    /// The element of a name, in capitals or not; `needed` says what the file must have.
    pub(crate) fn element(&self, name: &[u8], needed: &str) -> Result<&Element, Fault> {
        let found = self.elements.iter().find(|element| element.name.eq_ignore_ascii_case(name));
        found.ok_or_else(|| {
            let there = listed(self.elements.iter().map(|element| &element.name[..]));
            let name = String::from_utf8_lossy(name);
            fault("header", format!("it has no element {name}, but {there}; {needed}"))
        })
    }

    pub(crate) fn read(reader: &mut impl BufRead) -> Result<Self, Fault> {
        let (mut lines, mut bytes) = (0, 0_u64);
        let (mut line, mut end) = (Vec::new(), b'\n');
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        loop {
            line.clear();
            let read = if lines == 0 {
                first_line(reader, &mut line, &mut end)
            } else {
                reader.read_until(end, &mut line)
            };
            lines += 1;
            let fault = |problem: String| fault(format_args!("line {lines}"), problem);
            let read = read.map_err(|error| fault(error.to_string()))?;
            bytes += read as u64;
            if lines == 1 {
                let text = line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&line);
                if let Some(what) = stranger(text) {
                    return Err(fault(what.into()));
                }
                if read == 0 {
                    return Err(fault("the file is empty".into()));
                }
                if text.trim_ascii() != b"ply" {
                    return Err(fault(format!(
                        "the file begins with {}, but must begin with \"ply\"",
                        quoted(text.trim_ascii())
                    )));
                }
                continue;
            }
            if read == 0 {
                return Err(fault("the file ends within the header, before end_header".into()));
            }
            let parts: Vec<&[u8]> = words(&line).take(6).collect();
            match parts[..] {
                [b"end_header", ..] => break,
                [] | [b"comment" | b"obj_info", ..] => {}
                [b"format", kind, version, ..] => {
                    encoding = Some(match kind {
                        b"ascii" => Encoding::Text,
                        b"binary_little_endian" => Encoding::Little,
                        b"binary_big_endian" => Encoding::Big,
                        _ => {
                            let range = "ascii, binary_little_endian or binary_big_endian";
                            return Err(fault(format!(
                                "the format is {}, but must be {range}",
                                quoted(kind)
                            )));
                        }
                    });
                    if !version.starts_with(b"1.") {
                        return Err(fault(format!("the version is {}, but must be 1.0", quoted(version))));
                    }
                }
                [b"element", name, count, ..] => {
                    let count = std::str::from_utf8(count).ok().and_then(|count| count.parse().ok());
                    let count = count.ok_or_else(|| {
                        fault(format!("{} is no number of elements", quoted(line.trim_ascii())))
                    })?;
                    elements.push(Element { name: name.to_vec(), count, properties: Vec::new() });
                }
                [b"property", ..] => {
                    let Some(element) = elements.last_mut() else {
                        return Err(fault("a property stands before any element".into()));
                    };
                    element.properties.push(property(&parts).map_err(fault)?);
                }
                _ => {
                    let known = "format, element, property, comment, obj_info or end_header";
                    return Err(fault(format!(
                        "the header has {}, but must have {known}",
                        quoted(line.trim_ascii())
                    )));
                }
            }
        }
        let encoding = encoding.ok_or_else(|| fault("header", "it has no format line"))?;
        Ok(Self { encoding, elements, lines, bytes })
    }
}

/// The first line shows how lines end: with CR alone, or with LF, perhaps after a CR.
fn first_line(reader: &mut impl BufRead, line: &mut Vec<u8>, end: &mut u8) -> io::Result<usize> {
    let mut read = 0;
    loop {
        let bytes = match reader.fill_buf() {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        // CR, and then something other than LF.
        let alone = line.last() == Some(&b'\r') && bytes.first() != Some(&b'\n');
        if bytes.is_empty() || alone {
            *end = if alone { b'\r' } else { b'\n' };
            return Ok(read);
        }
        line.push(bytes[0]);
        let done = bytes[0] == b'\n';
        reader.consume(1);
        read += 1;
        // A first line is three bytes and its end; no need to read a large binary file as one line.
        if done || read > 200 {
            return Ok(read);
        }
    }
}

/// A name may hold anything, white space between too.
fn property(parts: &[&[u8]]) -> Result<Property, String> {
    let scalar = |word: &[u8]| {
        let range = "char, uchar, short, ushort, int, uint, float, double, or int8 to float64";
        Scalar::named(word)
            .ok_or_else(|| format!("a property has the type {}, but must have {range}", quoted(word)))
    };
    let named = |name: Option<&&[u8]>| name.map(|name| name.to_vec()).unwrap_or_default();
    match parts {
        [_, b"list", count, item, name @ ..] => {
            Ok(Property { name: named(name.first()), kind: Kind::List(scalar(count)?, scalar(item)?) })
        }
        [_, kind, name @ ..] => Ok(Property { name: named(name.first()), kind: Kind::Scalar(scalar(kind)?) }),
        _ => Err("a property has no type".into()),
    }
}

/// The first ten names.
fn listed<'a>(names: impl Iterator<Item = &'a [u8]>) -> String {
    let mut names: Vec<String> = names.take(11).map(quoted).collect();
    if names.is_empty() {
        return "none".into();
    }
    if names.len() > 10 {
        names[10] = "others".into();
    }
    names.join(", ")
}

/// A whole number that a text has, perhaps written as a fraction.
pub(crate) fn whole(word: &[u8]) -> Option<u64> {
    let plain = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
    plain.or_else(|| number(word).and_then(whole_of))
}

/// A number without a fraction, from 0 to 2^53.
pub(crate) fn whole_of(value: f64) -> Option<u64> {
    let holds = (0.0..9_007_199_254_740_992.0).contains(&value) && value.fract() == 0.0;
    holds.then_some(value as u64)
}
