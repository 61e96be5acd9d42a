//! The numbers after the header, one after the other.

use std::io::{self, BufRead, Read};

use super::header::{Element, Encoding, Kind, Property, Scalar, whole, whole_of};
use super::{Fault, fault};
use crate::text::{Lines, number, quoted};

pub(crate) struct Values<R> {
    source: Source<R>,
    encoding: Encoding,
    /// Lines or bytes before.
    before: u64,
}

enum Source<R> {
    /// Lines, and how far the latest is read.
    Text(Lines<R>, usize),
    Binary {
        reader: R,
        bytes: u64,
    },
}

impl<R: BufRead> Values<R> {
    pub(crate) fn new(reader: R, encoding: Encoding, lines: u64, bytes: u64) -> Self {
        match encoding {
            Encoding::Text => Self { source: Source::Text(Lines::new(reader), 0), encoding, before: lines },
            _ => Self { source: Source::Binary { reader, bytes: 0 }, encoding, before: bytes },
        }
    }

    /// The line or byte that is read.
    pub(crate) fn at(&self) -> u64 {
        match &self.source {
            Source::Text(lines, _) => self.before + lines.number(),
            Source::Binary { bytes, .. } => self.before + bytes,
        }
    }

    /// A line or byte in words.
    pub(crate) fn place_of(&self, at: u64) -> String {
        format!("{} {at}", if self.encoding == Encoding::Text { "line" } else { "byte" })
    }

    /// Place of the reader in the file.
    pub(crate) fn place(&self) -> String {
        self.place_of(self.at())
    }

    /// Begins the next element; comments between the lines of a text are passed over.
    pub(crate) fn begin(&mut self, element: &Element, number: u64) -> Result<(), Fault> {
        if element.properties.is_empty() {
            return Ok(());
        }
        loop {
            let Source::Text(lines, at) = &mut self.source else { return Ok(()) };
            let rest = lines.line()[*at..].trim_ascii_start();
            if *at == 0 && (rest.starts_with(b"comment") || rest.starts_with(b"obj_info")) || is_blank(rest) {
                *at = 0;
                let read = lines.read();
                let place = self.before + lines.number();
                if !read.map_err(|error| fault(format_args!("line {place}"), error))? {
                    return Err(self.cut(Some((element, number))));
                }
                continue;
            }
            return Ok(());
        }
    }

    /// `true` if the line of text that the latest number came from has more content.
    pub(crate) fn is_within_line(&self) -> bool {
        matches!(&self.source, Source::Text(lines, at) if *at > 0 && !is_blank(&lines.line()[*at..]))
    }

    fn cut(&self, at: Option<(&Element, u64)>) -> Fault {
        let problem = match at {
            None => "the file ends within an element: it is cut short, or its header is wrong".into(),
            Some((element, number)) => format!(
                "the file ends after {number} of {}, but the header counts {}: it is cut short, or its header is wrong",
                quoted(&element.name),
                element.count
            ),
        };
        fault(self.place(), problem)
    }

    /// The next word of a text.
    fn word(&mut self) -> Result<&[u8], Fault> {
        loop {
            let Source::Text(lines, at) = &mut self.source else { return Ok(&[]) };
            let blank = is_blank(&lines.line()[*at..]);
            if !blank {
                break;
            }
            *at = 0;
            let read = lines.read();
            let place = self.before + lines.number();
            if !read.map_err(|error| fault(format_args!("line {place}"), error))? {
                return Err(self.cut(None));
            }
        }
        let Source::Text(lines, at) = &mut self.source else { return Ok(&[]) };
        let line = lines.line();
        let start = *at + line[*at..].iter().position(|&byte| !is_space(byte)).unwrap_or(0);
        let end = start + line[start..].iter().position(|&byte| is_space(byte)).unwrap_or(line.len() - start);
        *at = end;
        Ok(&line[start..end])
    }

    fn bytes(&mut self, size: usize) -> Result<[u8; 8], Fault> {
        let mut word = [0; 8];
        let Source::Binary { reader, bytes } = &mut self.source else { return Ok(word) };
        match reader.read_exact(&mut word[..size]) {
            Ok(()) => {}
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => return Err(self.cut(None)),
            Err(error) => return Err(fault(self.place(), error)),
        }
        *bytes += size as u64;
        if self.encoding == Encoding::Big {
            word[..size].reverse();
        }
        Ok(word)
    }

    /// A number of this kind.
    pub(crate) fn number(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        if self.encoding == Encoding::Text {
            let word = self.word()?;
            if let Some(value) = number(word) {
                return Ok(value);
            }
            let found = quoted(word);
            return Err(fault(self.place(), format!("a coordinate is {found}, but must be a number")));
        }
        let bytes = self.bytes(scalar.size())?;
        let [a, b, c, d, ..] = bytes;
        Ok(match scalar {
            Scalar::I8 => f64::from(a as i8),
            Scalar::U8 => f64::from(a),
            Scalar::I16 => f64::from(i16::from_le_bytes([a, b])),
            Scalar::U16 => f64::from(u16::from_le_bytes([a, b])),
            Scalar::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Scalar::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Scalar::I64 => i64::from_le_bytes(bytes) as f64,
            Scalar::U64 => u64::from_le_bytes(bytes) as f64,
            Scalar::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Scalar::F64 => f64::from_le_bytes(bytes),
        })
    }

    /// A number of this kind that counts or names something.
    pub(crate) fn whole(&mut self, scalar: Scalar, what: &str) -> Result<u64, Fault> {
        let (value, found) = if self.encoding == Encoding::Text {
            let word = self.word()?;
            let value = whole(word);
            (value, if value.is_none() { quoted(word) } else { String::new() })
        } else {
            let value = self.number(scalar)?;
            (whole_of(value), value.to_string())
        };
        value.ok_or_else(|| {
            fault(self.place(), format!("{what} is {found}, but must be a whole number from 0"))
        })
    }

    /// Passes over numbers, whatever they are.
    fn skip(&mut self, scalar: Scalar, count: u64) -> Result<(), Fault> {
        if let Source::Binary { reader, bytes } = &mut self.source {
            let length = (scalar.size() as u64).saturating_mul(count);
            let skipped = io::copy(&mut reader.take(length), &mut io::sink());
            *bytes += *skipped.as_ref().unwrap_or(&0);
            return match skipped {
                Ok(skipped) if skipped == length => Ok(()),
                Ok(_) => Err(self.cut(None)),
                Err(error) => Err(fault(self.place(), error)),
            };
        }
        for _ in 0..count {
            self.word()?;
        }
        Ok(())
    }

    pub(crate) fn pass_property(&mut self, property: &Property) -> Result<(), Fault> {
        match property.kind {
            Kind::Scalar(scalar) if self.encoding != Encoding::Text => self.bytes(scalar.size()).map(drop),
            Kind::Scalar(scalar) => self.skip(scalar, 1),
            Kind::List(count, item) => {
                let count = self.whole(count, "the length of a list")?;
                self.skip(item, count)
            }
        }
    }

    /// Passes over all of an element.
    pub(crate) fn pass(&mut self, element: &Element) -> Result<(), Fault> {
        if element.properties.is_empty() {
            return Ok(());
        }
        if let (Some(size), Source::Binary { .. }) = (element.size(), &self.source) {
            return self.skip(Scalar::U8, size.saturating_mul(element.count));
        }
        for number in 0..element.count {
            self.begin(element, number)?;
            element.properties.iter().try_for_each(|property| self.pass_property(property))?;
        }
        Ok(())
    }
}

fn is_space(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0 || byte == 0x0B
}

fn is_blank(bytes: &[u8]) -> bool {
    bytes.iter().all(|&byte| is_space(byte))
}
