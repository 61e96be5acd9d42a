//! The bytes of a glTF file's buffers, and the numbers in them.

use std::borrow::Cow;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::document::{Accessor, Document};
use super::fault;
use crate::shape::TriangleMeshError;

pub(super) struct Buffers<'a> {
    document: &'a Document,
    all: Vec<Cow<'a, [u8]>>,
    /// Bytes in all.
    bytes: usize,
}

impl<'a> Buffers<'a> {
    pub(super) fn new(
        document: &'a Document,
        binary: Option<&'a [u8]>,
        folder: Option<&Path>,
    ) -> Result<Self, TriangleMeshError> {
        let mut buffers = Vec::new();
        for (number, buffer) in document.buffers.iter().enumerate() {
            let fault = |problem: String| fault(format_args!("buffer {number}"), problem);
            let bytes = match (&buffer.uri, binary) {
                (Some(uri), _) => Cow::Owned(load(uri, buffer.byte_length, folder).map_err(fault)?),
                (None, Some(binary)) if number == 0 => Cow::Borrowed(binary),
                // Extensions leave buffers empty; who needs them hears of it.
                (None, _) => Cow::Owned(Vec::new()),
            };
            buffers.push(bytes);
        }
        let bytes = buffers.iter().map(|buffer| buffer.len()).sum();
        Ok(Self { document, all: buffers, bytes })
    }

    /// The numbers of an accessor, `width` to an element.
    pub(super) fn numbers(&self, number: usize, width: usize) -> Result<Vec<f64>, TriangleMeshError> {
        let accessor = self.accessor(number)?;
        let fault = |problem: String| fault(format_args!("accessor {number}"), problem);
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][width - 1];
        if accessor.kind != kind {
            let found: String = accessor.kind.chars().take(20).collect();
            return Err(fault(format!("it is of the type {found:?}, but must be {kind}")));
        }
        let scalar = Scalar::of(accessor.component_type).map_err(fault)?;
        let mut numbers = match accessor.buffer_view {
            Some(view) => {
                let bytes = self
                    .elements(view, accessor.byte_offset, accessor.count, scalar.size() * width)
                    .map_err(fault)?;
                let mut numbers = Vec::with_capacity(accessor.count * width);
                for element in bytes {
                    numbers.extend(
                        element
                            .chunks_exact(scalar.size())
                            .map(|bytes| scalar.read(bytes, accessor.normalized)),
                    );
                }
                numbers
            }
            None if accessor.count <= self.bytes => vec![0.0; accessor.count * width],
            None => return Err(fault(format!("it counts {} elements, but has no buffer", accessor.count))),
        };
        if let Some(sparse) = &accessor.sparse {
            let place = Scalar::of(sparse.indices.component_type).map_err(fault)?;
            let (indices, values) = (&sparse.indices, &sparse.values);
            let indices = self
                .elements(indices.buffer_view, indices.byte_offset, sparse.count, place.size())
                .map_err(fault)?;
            let values = self
                .elements(values.buffer_view, values.byte_offset, sparse.count, scalar.size() * width)
                .map_err(fault)?;
            for (index, value) in indices.zip(values) {
                let index = place.read(index, false) as usize;
                let target = index.checked_mul(width).and_then(|start| numbers.get_mut(start..start + width));
                let target = target.ok_or_else(|| {
                    fault(format!("its sparse index is {index}, but it counts {}", accessor.count))
                })?;
                for (number, bytes) in target.iter_mut().zip(value.chunks_exact(scalar.size())) {
                    *number = scalar.read(bytes, accessor.normalized);
                }
            }
        }
        Ok(numbers)
    }

    /// The whole numbers of an accessor.
    pub(super) fn indices(&self, number: usize) -> Result<Vec<u64>, TriangleMeshError> {
        let accessor = self.accessor(number)?;
        if !matches!(accessor.component_type, 5121 | 5123 | 5125) {
            let problem = format!(
                "indices are of the type {}, but must be 5121, 5123 or 5125",
                accessor.component_type
            );
            return Err(fault(format_args!("accessor {number}"), problem));
        }
        Ok(self.numbers(number, 1)?.into_iter().map(|index| index as u64).collect())
    }

    fn accessor(&self, number: usize) -> Result<&'a Accessor, TriangleMeshError> {
        let accessors = &self.document.accessors;
        let problem =
            || fault(format_args!("accessor {number}"), format!("there are {} accessors", accessors.len()));
        accessors.get(number).ok_or_else(problem)
    }

    /// The bytes of each element of an accessor.
    fn elements(
        &self,
        view: usize,
        offset: usize,
        count: usize,
        size: usize,
    ) -> Result<impl Iterator<Item = &[u8]>, String> {
        let views = &self.document.buffer_views;
        let found = views
            .get(view)
            .ok_or_else(|| format!("it has the view {view}, but there are {}", views.len()))?;
        let buffer = self.all.get(found.buffer);
        let buffer = buffer.ok_or_else(|| {
            format!("view {view} has the buffer {}, but there are {}", found.buffer, self.all.len())
        })?;
        let stride = found.byte_stride.filter(|&stride| stride > 0).unwrap_or(size);
        let needed = count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size));
        let bytes = found
            .byte_offset
            .checked_add(found.byte_length)
            .and_then(|end| buffer.get(found.byte_offset..end));
        let bytes = bytes.ok_or_else(|| {
            format!(
                "view {view} has {} bytes from byte {} of a buffer of {}",
                found.byte_length,
                found.byte_offset,
                buffer.len()
            )
        })?;
        let bytes = needed.and_then(|needed| bytes.get(offset..)?.get(..needed)).ok_or_else(|| {
            format!(
                "its {count} elements of {size} bytes, {stride} apart, from byte {offset} of view {view}, do not fit into {} bytes",
                found.byte_length
            )
        })?;
        Ok((0..count).map(move |i| &bytes[i * stride..i * stride + size]))
    }
}

/// glTF's numbers for kinds of numbers.
#[derive(Clone, Copy)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Scalar {
    fn of(component_type: u32) -> Result<Self, String> {
        match component_type {
            5120 => Ok(Self::I8),
            5121 => Ok(Self::U8),
            5122 => Ok(Self::I16),
            5123 => Ok(Self::U16),
            5125 => Ok(Self::U32),
            5126 => Ok(Self::F32),
            other => Err(format!("its componentType is {other}, but must be 5120 to 5123, 5125 or 5126")),
        }
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    fn read(self, bytes: &[u8], normalized: bool) -> f64 {
        let mut word = [0; 4];
        word[..bytes.len()].copy_from_slice(bytes);
        let [a, b, ..] = word;
        let (value, most) = match self {
            Self::I8 => (f64::from(a as i8), 127.0),
            Self::U8 => (f64::from(a), 255.0),
            Self::I16 => (f64::from(i16::from_le_bytes([a, b])), 32_767.0),
            Self::U16 => (f64::from(u16::from_le_bytes([a, b])), 65_535.0),
            Self::U32 => (f64::from(u32::from_le_bytes(word)), 4_294_967_295.0),
            Self::F32 => return f64::from(f32::from_le_bytes(word)),
        };
        if normalized { (value / most).max(-1.0) } else { value }
    }
}

/// A buffer within the JSON or in a file beside it.
fn load(uri: &str, length: usize, folder: Option<&Path>) -> Result<Vec<u8>, String> {
    let shown: String = uri.chars().take(60).collect();
    if let Some(data) = uri.strip_prefix("data:") {
        let (kind, data) = data.split_once(',').ok_or_else(|| format!("{shown:?} has no comma"))?;
        if !kind.ends_with(";base64") {
            return Err(format!("{shown:?} is not in base64"));
        }
        return base64(data.as_bytes()).ok_or_else(|| format!("{shown:?} is not in base64"));
    }
    let Some(folder) = folder else {
        return Err(format!("it is in the file {shown:?}; Import::open finds it, a reader cannot"));
    };
    let name = percent_decoded(uri);
    if name.contains(':') || Path::new(&name).is_absolute() || name.starts_with(['/', '\\']) {
        return Err(format!("it is in {shown:?}, but must be in a file beside this one"));
    }
    let path = folder.join(&name);
    let named = |error: std::io::Error| format!("{}: {error}", path.display());
    let mut bytes = Vec::new();
    File::open(&path).map_err(named)?.take(length as u64).read_to_end(&mut bytes).map_err(named)?;
    if bytes.len() < length {
        return Err(format!("{} has {} bytes, but must have {length}", path.display(), bytes.len()));
    }
    Ok(bytes)
}

fn percent_decoded(uri: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = uri.as_bytes();
    while let Some((&byte, after)) = rest.split_first() {
        let code = after.get(..2).and_then(|code| std::str::from_utf8(code).ok());
        let code = code.and_then(|code| u8::from_str_radix(code, 16).ok()).filter(|_| byte == b'%');
        bytes.push(code.unwrap_or(byte));
        rest = if code.is_some() { &after[2..] } else { after };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// RFC 4648, padded or not.
fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count) = (0_u32, 0);
    for &letter in text {
        let value = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            b'=' => break,
            letter if letter.is_ascii_whitespace() => continue,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    Some(bytes)
}
