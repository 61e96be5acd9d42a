//! A writer that an observer watches.

use crate::observer::{Cancelled, Observer, Work, report};
use std::io::{self, Write};

/// Bytes from one report to the next.
const CHUNK: u64 = 1 << 17;

/// A writer that reports progress to an observer, which can cancel the work. It wraps the writer of any
/// exporter.
///
/// After the observer's `Break` every write fails, and the exporter ends with
/// [`ExportError::Cancelled`](super::ExportError): the file is cut off, and up to the caller to remove. The
/// checks before the first byte are not watched; they take some nanoseconds per vertex.
///
/// ```
/// use std::ops::ControlFlow;
/// use treesynth::surface::{Mesh, Part};
/// use treesynth::{Progress, export, glam::Vec3};
///
/// let triangle = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z; 3], vec![0, 1, 2]);
/// let mut stl = Vec::new();
/// let never = |_: Progress| ControlFlow::Break(());
/// let written = export::write_stl(&[Part::new(&triangle)], export::Watched::new(&mut stl, &never));
/// assert!(matches!(written, Err(export::ExportError::Cancelled)));
/// # Ok::<(), export::ExportError>(())
/// ```
pub struct Watched<'a, W> {
    writer: W,
    observer: &'a dyn Observer,
    bytes: u64,
    written: u64,
    next: u64,
    is_cancelled: bool,
}

impl<W: std::fmt::Debug> std::fmt::Debug for Watched<'_, W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut all = f.debug_struct("Watched");
        all.field("writer", &self.writer).field("bytes", &self.bytes).field("written", &self.written);
        all.field("is_cancelled", &self.is_cancelled).finish_non_exhaustive()
    }
}

impl<'a, W: Write> Watched<'a, W> {
    /// A writer for a file of unknown size: the reported fraction approaches 1.
    pub fn new(writer: W, observer: &'a dyn Observer) -> Self {
        Self { writer, observer, bytes: 0, written: 0, next: 0, is_cancelled: false }
    }

    /// Sets the expected size of the file, bytes: the fraction reported is that of these.
    #[must_use]
    pub fn with_bytes(mut self, bytes: u64) -> Self {
        self.bytes = bytes;
        self
    }

    /// The bytes written so far.
    pub fn written(&self) -> u64 {
        self.written
    }

    /// The writer itself.
    pub fn into_inner(self) -> W {
        self.writer
    }

    fn tell(&mut self, fraction: f32) -> io::Result<()> {
        if !self.is_cancelled {
            self.is_cancelled = report(self.observer, Work::File, fraction).is_err();
        }
        if self.is_cancelled { Err(io::Error::other(Cancelled)) } else { Ok(()) }
    }
}

impl<W: Write> Write for Watched<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.is_cancelled || self.written >= self.next {
            let written = self.written as f32;
            let of = if self.bytes > 0 { self.bytes as f32 } else { written + (64 * CHUNK) as f32 };
            self.tell((written / of).min(0.999))?;
            self.next = self.written + CHUNK;
        }
        let most = usize::try_from(self.next - self.written).unwrap_or(bytes.len());
        let count = self.writer.write(&bytes[..bytes.len().min(most)])?;
        self.written += count as u64;
        Ok(count)
    }

    /// Exporters flush once, when all is written.
    fn flush(&mut self) -> io::Result<()> {
        if self.is_cancelled {
            return self.tell(1.0);
        }
        self.writer.flush()?;
        self.tell(1.0)
    }
}
