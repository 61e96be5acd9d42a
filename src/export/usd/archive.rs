//! ZIP archives as USD wants them: nothing compressed, each file at a multiple of 64 bytes.

use crate::ParameterError;
use crate::export::ExportError;
use std::io::{self, Write};

const LOCAL: u32 = 0x0403_4B50;
const CENTRAL: u32 = 0x0201_4B50;
const END: u32 = 0x0605_4B50;
/// Version 1.0: stored files.
const VERSION: u16 = 10;
/// The first day that the format knows, 1 January 1980, so that the same content gives the same bytes.
const DAY: u16 = 0x21;
/// The field that pads, as USD's own tools have it.
const PADDING: u16 = 0x1986;
/// Bytes of a local header without its name, and of the start of a field.
const HEADER: u64 = 30;
const FIELD: u64 = 4;
const ALIGNMENT: u64 = 64;
/// Bytes of a name.
const LONGEST: usize = 65_000;

/// The length and CRC-32 of what is written to it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sum {
    length: u64,
    rest: u32,
}

impl Default for Sum {
    fn default() -> Self {
        Self { length: 0, rest: u32::MAX }
    }
}

/// The remainders of all bytes by the polynomial of Ethernet and ZIP, bits reversed.
const REMAINDERS: [u32; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut rest = byte as u32;
        let mut bit = 0;
        while bit < 8 {
            rest = if rest & 1 == 1 { (rest >> 1) ^ 0xEDB8_8320 } else { rest >> 1 };
            bit += 1;
        }
        table[byte] = rest;
        byte += 1;
    }
    table
};

impl Sum {
    pub(super) fn of(bytes: &[u8]) -> Self {
        let mut sum = Self::default();
        sum.add(bytes);
        sum
    }

    fn add(&mut self, bytes: &[u8]) {
        self.length += bytes.len() as u64;
        for byte in bytes {
            self.rest = REMAINDERS[usize::from(self.rest as u8 ^ byte)] ^ (self.rest >> 8);
        }
    }

    fn crc(self) -> u32 {
        !self.rest
    }
}

impl Write for Sum {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.add(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Files with their places.
#[derive(Debug)]
pub(super) struct Archive {
    files: Vec<Entry>,
    /// Offset of the list of files.
    list: u32,
}

#[derive(Debug)]
struct Entry {
    name: String,
    length: u32,
    crc: u32,
    /// Start of its header.
    start: u32,
    /// Bytes of zero before its content.
    padding: u16,
}

impl Archive {
    /// An archive of files with these names and sums, at least one.
    pub(super) fn new(files: Vec<(String, Sum)>) -> Result<Self, ExportError> {
        let limit = u64::from(u32::MAX);
        let held = |bytes: u64| u32::try_from(bytes).map_err(|_| ExportError::TooLarge { bytes, limit });
        let mut at = 0;
        let mut entries = Vec::new();
        for (index, (name, sum)) in files.into_iter().enumerate() {
            // Files are named after the stage and the parts, with something behind.
            let parameter = if index == 0 { "UsdStage.name" } else { "Part.name" };
            let range = "at most 65,000, for a ZIP archive counts the letters of a name in 16 bits";
            ParameterError::unless(
                name.len() <= LONGEST,
                parameter,
                format!("{} bytes long", name.len()),
                range,
            )?;
            let start = at;
            let bare = start + HEADER + name.len() as u64 + FIELD;
            let content = bare.next_multiple_of(ALIGNMENT);
            at = content + sum.length;
            entries.push(Entry {
                length: held(sum.length)?,
                crc: sum.crc(),
                start: held(start)?,
                padding: (content - bare) as u16,
                name,
            });
        }
        // With its own list at its end.
        held(at + entries.iter().map(|entry| 46 + entry.name.len() as u64).sum::<u64>() + 22)?;
        let images = entries.len() - 1;
        let range = "at most 65,534, for a ZIP archive counts its files in 16 bits";
        ParameterError::unless(images < usize::from(u16::MAX), "UsdStage.images", images, range)?;
        Ok(Self { files: entries, list: at as u32 })
    }

    /// Writes all; `content` must write what the sums were taken of.
    pub(super) fn write<W: Write>(
        &self,
        writer: &mut W,
        content: impl Fn(usize, &mut W) -> io::Result<()>,
    ) -> io::Result<()> {
        for (index, entry) in self.files.iter().enumerate() {
            writer.write_all(&LOCAL.to_le_bytes())?;
            entry.write(writer)?;
            writer.write_all(&(FIELD as u16 + entry.padding).to_le_bytes())?;
            writer.write_all(entry.name.as_bytes())?;
            for word in [PADDING, entry.padding] {
                writer.write_all(&word.to_le_bytes())?;
            }
            writer.write_all(&[0; ALIGNMENT as usize][..usize::from(entry.padding)])?;
            content(index, writer)?;
        }
        let mut length = 0;
        for entry in &self.files {
            writer.write_all(&CENTRAL.to_le_bytes())?;
            writer.write_all(&VERSION.to_le_bytes())?;
            entry.write(writer)?;
            // No extra field, no comment, disk 0, no attributes.
            writer.write_all(&[0; 12])?;
            writer.write_all(&entry.start.to_le_bytes())?;
            writer.write_all(entry.name.as_bytes())?;
            length += 46 + entry.name.len() as u32;
        }
        let count = self.files.len() as u16;
        writer.write_all(&END.to_le_bytes())?;
        for word in [0, 0, count, count] {
            writer.write_all(&word.to_le_bytes())?;
        }
        for word in [length, self.list] {
            writer.write_all(&word.to_le_bytes())?;
        }
        writer.write_all(&[0; 2])
    }
}

impl Entry {
    /// Fields that both headers share.
    fn write(&self, writer: &mut impl Write) -> io::Result<()> {
        // Version, flags, method, time, day.
        for word in [VERSION, 0, 0, 0, DAY] {
            writer.write_all(&word.to_le_bytes())?;
        }
        for word in [self.crc, self.length, self.length] {
            writer.write_all(&word.to_le_bytes())?;
        }
        writer.write_all(&(self.name.len() as u16).to_le_bytes())
    }
}
