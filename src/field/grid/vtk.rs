//! Grids in files: the legacy VTK format's structured points, as `ParaView` and flow solvers write them.
//!
//! "VTK File Formats", section "Simple Legacy Formats": a header of text lines, then the vectors, as text or as
//! big-endian numbers.

use std::io::{BufRead, ErrorKind, Write};
use std::str::FromStr;

use glam::Vec3;

use super::{GridField, GridFieldError, check, is_usable};

/// Longest line of a file, bytes: what is no text does not fill the memory.
const LONGEST_LINE: u64 = 1 << 16;

impl GridField {
    /// A field from a file in the legacy VTK format, with one set of vectors at structured points.
    ///
    /// ```text
    /// # vtk DataFile Version 3.0
    /// any title
    /// ASCII
    /// DATASET STRUCTURED_POINTS
    /// DIMENSIONS nx ny nz
    /// ORIGIN x y z
    /// SPACING x y z
    /// POINT_DATA n
    /// VECTORS name float
    /// u v w ...
    /// ```
    ///
    /// `BINARY` in place of `ASCII` means big-endian numbers; `double` in place of `float` has 64 bits each.
    /// The lines from `DIMENSIONS` to `SPACING` may come in any order, empty lines are skipped, and what
    /// follows the vectors is not read. Distances are metres, and +Y is up: simulations with +Z up must be
    /// turned before. Vectors in `double` are rounded to the nearest 32-bit ones.
    ///
    /// Memory grows with what is read, not with what the header promises.
    ///
    /// # Errors
    /// A line or, in binary data, a byte that is not what it has to be, each with its number; what
    /// [`new`](Self::new) refuses; the reader's own errors.
    ///
    /// ```
    /// use treesynth::{VectorField, field::{GridField, Rotation}, glam::Vec3};
    ///
    /// let field = GridField::sampled(&Rotation::new(Vec3::ZERO, Vec3::Y), Vec3::ZERO, Vec3::ONE, [3, 2, 2])?;
    /// let mut file = Vec::new();
    /// field.write_vtk(&mut file)?;
    /// assert_eq!(GridField::read_vtk(file.as_slice())?, field);
    /// # Ok::<(), treesynth::field::GridFieldError>(())
    /// ```
    pub fn read_vtk(reader: impl BufRead) -> Result<Self, GridFieldError> {
        Reader { source: reader, line: 0, byte: 0, text: String::new() }.field()
    }

    /// Writes the field in the same format, as 32-bit big-endian numbers.
    ///
    /// # Errors
    /// Whatever the writer returns.
    pub fn write_vtk(&self, mut writer: impl Write) -> Result<(), GridFieldError> {
        let [nx, ny, nz] = self.dimensions;
        let (o, s) = (self.origin, self.spacing);
        write!(
            writer,
            "# vtk DataFile Version 3.0\nvector field\nBINARY\nDATASET STRUCTURED_POINTS\n\
             DIMENSIONS {nx} {ny} {nz}\nORIGIN {} {} {}\nSPACING {} {} {}\nPOINT_DATA {}\nVECTORS field float\n",
            o.x,
            o.y,
            o.z,
            s.x,
            s.y,
            s.z,
            self.samples.len()
        )?;
        for sample in self.samples.iter() {
            writer.write_all(sample.to_array().map(f32::to_be_bytes).as_flattened())?;
        }
        Ok(writer.write_all(b"\n")?)
    }
}

struct Reader<R> {
    source: R,
    /// Lines and bytes read so far.
    line: usize,
    byte: u64,
    text: String,
}

impl<R: BufRead> Reader<R> {
    fn wrong(&self, message: impl Into<String>) -> GridFieldError {
        GridFieldError::Line { line: self.line, message: message.into() }
    }

    /// The next line into `text`, without its end; false at the end of the file.
    fn next_line(&mut self) -> Result<bool, GridFieldError> {
        let mut bytes = Vec::new();
        let read = std::io::Read::take(&mut self.source, LONGEST_LINE).read_until(b'\n', &mut bytes)? as u64;
        if read == 0 {
            return Ok(false);
        }
        (self.line, self.byte) = (self.line + 1, self.byte + read);
        if read == LONGEST_LINE && bytes.last() != Some(&b'\n') {
            return Err(self.wrong("longer than 65536 bytes"));
        }
        let text = String::from_utf8(bytes).map_err(|_| self.wrong("is not text"))?;
        self.text.clear();
        self.text.push_str(text.trim());
        Ok(true)
    }

    /// The next line that is not empty.
    fn expect_line(&mut self, what: &str) -> Result<(), GridFieldError> {
        loop {
            if !self.next_line()? {
                self.line += 1;
                return Err(self.wrong(format!("the file ends, but {what} must follow")));
            }
            if !self.text.is_empty() {
                return Ok(());
            }
        }
    }

    fn field(mut self) -> Result<GridField, GridFieldError> {
        self.expect_line("`# vtk DataFile Version 3.0`")?;
        if !self.text.starts_with("# vtk DataFile Version") {
            return Err(self.wrong("must begin with `# vtk DataFile Version`"));
        }
        // The title: any one line, even an empty one.
        if !self.next_line()? {
            return Err(self.wrong("the file ends, but a title must follow"));
        }
        self.expect_line("`ASCII` or `BINARY`")?;
        let binary = match self.text.as_str() {
            "ASCII" => false,
            "BINARY" => true,
            other => return Err(self.wrong(format!("must be `ASCII` or `BINARY`, is `{}`", short(other)))),
        };
        self.expect_line("`DATASET STRUCTURED_POINTS`")?;
        if self.text.split_whitespace().ne(["DATASET", "STRUCTURED_POINTS"]) {
            let message = format!("must be `DATASET STRUCTURED_POINTS`, is `{}`", short(&self.text));
            return Err(self.wrong(message));
        }
        let (mut dimensions, mut origin, mut spacing) = (None, None, None);
        let points = loop {
            self.expect_line("`POINT_DATA` and a number")?;
            let words: Vec<&str> = self.text.split_whitespace().collect();
            match words[..] {
                ["DIMENSIONS", x, y, z] => dimensions = Some(self.numbers::<usize, _>([x, y, z])?),
                ["ORIGIN", x, y, z] => origin = Some(Vec3::from_array(self.numbers([x, y, z])?)),
                ["SPACING" | "ASPECT_RATIO", x, y, z] => {
                    spacing = Some(Vec3::from_array(self.numbers([x, y, z])?));
                }
                ["POINT_DATA", count] => break self.numbers::<usize, _>([count])?[0],
                _ => {
                    let message = "must be `DIMENSIONS`, `ORIGIN` or `SPACING` with three numbers, or `POINT_DATA` with one";
                    return Err(self.wrong(format!("{message}; is `{}`", short(&self.text))));
                }
            }
        };
        let missing = |what: &str| self.wrong(format!("{what} must come before `POINT_DATA`"));
        let dimensions = dimensions.ok_or_else(|| missing("`DIMENSIONS`"))?;
        let origin = origin.ok_or_else(|| missing("`ORIGIN`"))?;
        let spacing = spacing.ok_or_else(|| missing("`SPACING`"))?;
        let expected = check(origin, spacing, dimensions)?;
        if points != expected {
            return Err(self.wrong(format!("must be `POINT_DATA {expected}`, as the dimensions say")));
        }
        self.expect_line("`VECTORS name float`")?;
        let double = match self.text.split_whitespace().collect::<Vec<_>>()[..] {
            ["VECTORS", _, "float"] => false,
            ["VECTORS", _, "double"] => true,
            _ => {
                let message = format!("must be `VECTORS name float` or `double`, is `{}`", short(&self.text));
                return Err(self.wrong(message));
            }
        };
        let samples = match (binary, double) {
            (true, false) => self.binary(points, |bytes: [u8; 4]| f32::from_be_bytes(bytes))?,
            (true, true) => self.binary(points, |bytes: [u8; 8]| f64::from_be_bytes(bytes) as f32)?,
            (false, _) => self.text(points)?,
        };
        GridField::new(origin, spacing, dimensions, samples)
    }

    fn numbers<T: FromStr, const N: usize>(&self, words: [&str; N]) -> Result<[T; N], GridFieldError>
    where
        [T; N]: Default,
    {
        let mut numbers = <[T; N]>::default();
        for (number, word) in numbers.iter_mut().zip(words) {
            *number = word
                .parse()
                .map_err(|_| self.wrong(format!("`{}` is no number that fits here", short(word))))?;
        }
        Ok(numbers)
    }

    /// Vectors as text, as many on a line as the file likes.
    fn text(&mut self, count: usize) -> Result<Vec<Vec3>, GridFieldError> {
        let mut samples = Vec::new();
        let mut sample = Vec3::ZERO;
        let mut axis = 0;
        while samples.len() < count {
            if !self.next_line()? {
                self.line += 1;
                let message = format!("the file ends after {} of {count} vectors", samples.len());
                return Err(self.wrong(message));
            }
            for word in self.text.split_whitespace() {
                if samples.len() == count {
                    return Err(self.wrong(format!("there are more than {count} vectors")));
                }
                [sample[axis]] = self.numbers([word])?;
                axis = (axis + 1) % 3;
                if axis == 0 {
                    if !is_usable(sample) {
                        let message =
                            format!("vector {} is {sample}, beyond 1e18 or no number", samples.len());
                        return Err(self.wrong(message));
                    }
                    samples.push(sample);
                }
            }
        }
        Ok(samples)
    }

    /// Vectors of three numbers, each of `SIZE` bytes.
    fn binary<const SIZE: usize>(
        &mut self,
        count: usize,
        number: impl Fn([u8; SIZE]) -> f32,
    ) -> Result<Vec<Vec3>, GridFieldError> {
        let mut samples = Vec::new();
        for index in 0..count {
            let mut sample = Vec3::ZERO;
            for axis in 0..3 {
                let mut bytes = [0; SIZE];
                let mut filled = 0;
                while filled < SIZE {
                    match self.source.read(&mut bytes[filled..]) {
                        Ok(0) => {
                            let byte = self.byte + filled as u64;
                            let message = format!("the file ends after {index} of {count} vectors");
                            return Err(GridFieldError::Byte { byte, message });
                        }
                        Ok(read) => filled += read,
                        Err(error) if error.kind() == ErrorKind::Interrupted => {}
                        Err(error) => return Err(error.into()),
                    }
                }
                sample[axis] = number(bytes);
                if !is_usable(Vec3::splat(sample[axis])) {
                    let message = format!(
                        "vector {index} has a component of {}, beyond 1e18 or no number",
                        sample[axis]
                    );
                    return Err(GridFieldError::Byte { byte: self.byte, message });
                }
                self.byte += SIZE as u64;
            }
            samples.push(sample);
        }
        Ok(samples)
    }
}

/// The beginning of what a file has, for messages.
fn short(text: &str) -> String {
    text.chars().take(40).collect()
}
