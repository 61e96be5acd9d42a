//! Clouds in the files of laser scanners: LAS, LAZ and E57.

use std::io::{BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};

use e57::{CartesianCoordinate, E57Reader};
use glam::DVec3;
use las::point::Format;
use las::{Builder, PointDataBuilder, Reader, Transform, Vector, Writer};

use super::file::fault;
use super::{Cloud, CloudError, Frame};

/// Points that are read or written at a time.
const CHUNK: u64 = 1 << 16;
/// Steps in a unit of a LAS file's coordinates: a tenth of a millimetre for metres.
const STEP: f64 = 1e-4;

/// The crate's error for one of a LAS file: errors of the disk stay as they are.
fn las_fault(place: impl std::fmt::Display, error: las::Error) -> CloudError {
    match error {
        las::Error::Io(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => CloudError::Io(error),
        error => fault("LAS", place, error),
    }
}

fn number<const BYTES: usize>(reader: &mut impl Read) -> std::io::Result<u64> {
    let mut bytes = [0; 8];
    reader.read_exact(&mut bytes[..BYTES])?;
    Ok(u64::from_le_bytes(bytes))
}

/// Refuses lengths and counts that the file cannot hold, for which the readers would take memory before they look.
fn check_lengths(reader: &mut (impl Read + Seek)) -> Result<(), CloudError> {
    let length = reader.seek(SeekFrom::End(0))?;
    reader.rewind()?;
    // Errors in the header are reported by the reader of the whole file.
    let Ok(header) = las::raw::Header::read_from(&mut *reader) else { return Ok(()) };
    let within = |place: &str, number: u64| {
        let error = || format!("{number} is more than the file of {length} bytes can hold");
        if number <= length { Ok(()) } else { Err(fault("LAS", place, error())) }
    };
    if let Some(records) = header.evlr {
        let mut at = records.start_of_first_evlr;
        within("extended records", at)?;
        for _ in 0..records.number_of_evlrs {
            reader.seek(SeekFrom::Start(at.saturating_add(20)))?;
            // At the end of the file, the reader of the whole file reports the error.
            let Ok(bytes) = number::<8>(reader) else { break };
            at = at.saturating_add(60).saturating_add(bytes);
            within("extended record", at)?;
        }
    }
    if header.point_data_record_format & 0x80 != 0 {
        let start = u64::from(header.offset_to_point_data);
        reader.seek(SeekFrom::Start(start))?;
        let mut table = number::<8>(reader).unwrap_or(0);
        if table as i64 <= start as i64 {
            reader.seek(SeekFrom::Start(length.saturating_sub(8)))?;
            table = number::<8>(reader).unwrap_or(0);
        }
        if table as i64 > start as i64 {
            within("table of chunks", table)?;
            // After its version.
            reader.seek(SeekFrom::Start(table + 4))?;
            within("table of chunks", number::<4>(reader).unwrap_or(0))?;
        }
    }
    Ok(())
}

fn las_places(reader: impl Read + Seek + Send + Sync + 'static) -> Result<Vec<DVec3>, CloudError> {
    let mut reader = BufReader::with_capacity(1 << 16, reader);
    check_lengths(&mut reader)?;
    reader.rewind()?;
    let mut reader = Reader::new(reader).map_err(|error| las_fault("header", error))?;
    let count = reader.header().number_of_points();
    let mut chunk = PointDataBuilder::new().for_header(reader.header()).build();
    // The header's count is not believed before the points are there.
    let mut places = Vec::new();
    while (places.len() as u64) < count {
        let read = reader.fill_points(CHUNK, &mut chunk);
        let read = read.map_err(|error| las_fault(format_args!("points from {}", places.len()), error))?;
        if read == 0 {
            break;
        }
        places.extend(chunk.x().zip(chunk.y()).zip(chunk.z()).map(|((x, y), z)| DVec3::new(x, y, z)));
    }
    Ok(places)
}

impl Cloud {
    /// Reads the positions of all points of a LAS or LAZ file, versions 1.0 to 1.4; everything else is passed
    /// over. 24 bytes per point beside the cloud. Where compressed points are damaged, the decoder's panic is
    /// caught: its message goes to standard error, and a program built with `panic = "abort"` ends.
    ///
    /// # Errors
    /// A frame out of range; a header or a point that cannot be read, by its number; a file cut short; points that are not finite or
    /// too far off.
    pub fn read_las(
        frame: &Frame,
        reader: impl Read + Seek + Send + Sync + 'static,
    ) -> Result<Self, CloudError> {
        frame.check()?;
        // The decoder of LAZ panics where bits cannot be what an encoder has written.
        let places = catch_unwind(AssertUnwindSafe(|| las_places(reader)));
        let unsound = |_| fault("LAS", "points", "the compressed points are damaged");
        Self::from_places(frame, &places.map_err(unsound)??)
    }

    /// Writes a LAS file of version 1.2, or LAZ if it is to be compressed: positions alone, to a tenth of a thousandth of the
    /// frame's unit. O(n).
    ///
    /// # Errors
    /// A frame out of range; coordinates that do not fit 32 bits in those steps; whatever the writer returns.
    pub fn write_las(
        &self,
        frame: &Frame,
        is_compressed: bool,
        writer: impl Write + Seek + Send + Sync + std::fmt::Debug + 'static,
    ) -> Result<(), CloudError> {
        frame.check()?;
        let place = |point| DVec3::from(frame.written(point).map(super::frame::Number::value));
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &point in self.points() {
            let place = place(point);
            (low, high) = (low.min(place), high.max(place));
        }
        let middle = if self.is_empty() { DVec3::ZERO } else { (0.5 * (low + high)).floor() };
        let axis = |offset| Transform { scale: STEP, offset };
        let mut builder = Builder::from((1, 2));
        builder.point_format = Format::new(0).map_err(|error| las_fault("header", error))?;
        builder.point_format.is_compressed = is_compressed;
        builder.transforms = Vector { x: axis(middle.x), y: axis(middle.y), z: axis(middle.z) };
        builder.generating_software = "treesynth".into();
        let header = builder.into_header().map_err(|error| las_fault("header", error))?;
        let mut writer = Writer::new(BufWriter::with_capacity(1 << 16, writer), header)
            .map_err(|error| las_fault("header", error))?;
        let written = self.points().iter().enumerate().try_for_each(|(number, &point)| {
            let DVec3 { x, y, z } = place(point);
            let written = writer.write_point(las::Point { x, y, z, ..las::Point::default() });
            written.map_err(|error| las_fault(format_args!("point {number}"), error))
        });
        let written = written.and_then(|()| writer.close().map_err(|error| las_fault("end", error)));
        if written.is_err() {
            // It would try again when it is dropped, and panic when that fails too.
            std::mem::forget(writer);
        }
        written
    }

    /// Reads all scans of an E57 file, each moved to where its pose puts it. Points that are marked as invalid are left out, and
    /// everything but positions is passed over. 24 bytes per point beside the cloud.
    ///
    /// # Errors
    /// A frame out of range; what cannot be read, by the scan's number; points that are not finite or too far off.
    pub fn read_e57(frame: &Frame, reader: impl Read + Seek) -> Result<Self, CloudError> {
        frame.check()?;
        let mut reader = E57Reader::new(reader).map_err(|error| fault("E57", "header", error))?;
        let mut places = Vec::new();
        for (number, scan) in reader.pointclouds().iter().enumerate() {
            let told = |error| fault("E57", format_args!("scan {number}"), error);
            for point in reader.pointcloud_simple(scan).map_err(told)? {
                if let CartesianCoordinate::Valid { x, y, z } = point.map_err(told)?.cartesian {
                    places.push(DVec3::new(x, y, z));
                }
            }
        }
        Self::from_places(frame, &places)
    }
}
