//! Lines of text as they come: any line end, any bytes.

use std::io::{self, BufRead};

/// Lines of a reader: LF, CR LF or CR end a line, a byte order mark is passed over, and bytes need not be UTF-8.
pub(crate) struct Lines<R> {
    reader: R,
    line: Vec<u8>,
    number: u64,
    after_cr: bool,
}

impl<R: BufRead> Lines<R> {
    pub(crate) fn new(reader: R) -> Self {
        Self { reader, line: Vec::new(), number: 0, after_cr: false }
    }

    /// The number of the latest line, from 1.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// The latest line.
    pub(crate) fn line(&self) -> &[u8] {
        &self.line
    }

    /// Reads the next line; false at the end. Takes as much memory as the longest line.
    pub(crate) fn read(&mut self) -> io::Result<bool> {
        self.line.clear();
        self.append()
    }

    #[cfg(feature = "import")]
    /// Keeps the first `end` bytes of the latest line and appends the next line, after a space: a line that
    /// ends with a backslash continues so.
    pub(crate) fn join(&mut self, end: usize) -> io::Result<bool> {
        self.line.truncate(end);
        self.line.push(b' ');
        self.append()
    }

    fn append(&mut self) -> io::Result<bool> {
        let mut any = false;
        loop {
            let bytes = match self.reader.fill_buf() {
                Ok(bytes) => bytes,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(error),
            };
            if bytes.is_empty() {
                break;
            }
            if self.after_cr && bytes[0] == b'\n' {
                self.after_cr = false;
                self.reader.consume(1);
                continue;
            }
            self.after_cr = false;
            any = true;
            let end = bytes.iter().position(|&byte| byte == b'\n' || byte == b'\r');
            let taken = end.unwrap_or(bytes.len());
            self.line.extend_from_slice(&bytes[..taken]);
            if let Some(end) = end {
                self.after_cr = bytes[end] == b'\r';
                self.reader.consume(end + 1);
                break;
            }
            self.reader.consume(taken);
        }
        self.number += u64::from(any);
        if self.number == 1 && self.line.starts_with(BYTE_ORDER_MARK) {
            self.line.drain(..BYTE_ORDER_MARK.len());
        }
        Ok(any)
    }
}

/// Byte-order mark with which some editors begin UTF-8.
pub(crate) const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// The words of a line; NUL counts as white space.
pub(crate) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> + Clone {
    line.split(|&byte| byte.is_ascii_whitespace() || byte == 0 || byte == 0x0B)
        .filter(|word| !word.is_empty())
}

/// A number as C's `strtod` reads it in decimal.
pub(crate) fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Up to 40 characters of the bytes found, in quotes, for an error.
pub(crate) fn quoted(bytes: &[u8]) -> String {
    const MOST: usize = 40;
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * MOST)]);
    let mut text: String = start.chars().take(MOST).collect();
    if start.chars().nth(MOST).is_some() || bytes.len() > 4 * MOST {
        text.push('…');
    }
    format!("{text:?}")
}

/// Kind of a file that begins with these bytes, if these readers cannot read it.
pub(crate) fn stranger(start: &[u8]) -> Option<&'static str> {
    let word = start.trim_ascii_start();
    let word = &word[..word.len().min(9)];
    let kinds: [(&[u8], &str); 11] = [
        (b"\x1f\x8b", "it begins with 1f 8b: it is compressed (gzip) and must be unpacked first"),
        (b"PK\x03\x04", "it begins with 50 4b 03 04: it is a zip archive and must be unpacked first"),
        (b"BZh", "it begins with 42 5a 68: it is compressed (bzip2) and must be unpacked first"),
        (b"\xFD7zXZ", "it begins with fd 37 7a 58: it is compressed (xz) and must be unpacked first"),
        (
            b"\x28\xB5\x2F\xFD",
            "it begins with 28 b5 2f fd: it is compressed (zstd) and must be unpacked first",
        ),
        (b"\xFF\xFE", "it begins with ff fe: it is UTF-16 text and must be saved as UTF-8"),
        (b"\xFE\xFF", "it begins with fe ff: it is UTF-16 text and must be saved as UTF-8"),
        (b"LASF", "it is a LAS or LAZ file and must be saved as PLY or text first"),
        (b"ASTM-E57", "it is an E57 file and must be saved as PLY or text first"),
        (b"# .PCD", "it is a PCD file and must be saved as PLY or text first"),
        (b"version https://git-lfs", "it is a pointer of git-lfs, not the file itself"),
    ];
    if let Some((_, what)) = kinds.iter().find(|(magic, _)| start.starts_with(magic)) {
        return Some(what);
    }
    let page = word.eq_ignore_ascii_case(b"<!doctype")
        || word.get(..5).is_some_and(|w| w.eq_ignore_ascii_case(b"<html"));
    page.then_some("it is a web page: perhaps the page about the file was saved in its place")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_end_ends_a_line() -> io::Result<()> {
        for size in [1, 2, 3, 100] {
            let text = b"\xEF\xBB\xBFa b\r\nc\r\rd\n\n\x00e";
            let mut lines = Lines::new(io::BufReader::with_capacity(size, &text[..]));
            let mut found = Vec::new();
            while lines.read()? {
                found.push((lines.number(), lines.line().to_vec()));
            }
            let want: [(u64, &[u8]); 6] =
                [(1, b"a b"), (2, b"c"), (3, b""), (4, b"d"), (5, b""), (6, b"\x00e")];
            assert!(found.iter().map(|(n, l)| (*n, &l[..])).eq(want), "{size}: {found:?}");
        }
        Ok(())
    }

    #[test]
    fn numbers_are_those_of_c() {
        for (word, value) in
            [("+1", 1.0), (".5", 0.5), ("1.", 1.0), ("-1.0E+00", -1.0), ("1e400", f64::INFINITY)]
        {
            assert_eq!(number(word.as_bytes()), Some(value), "{word}");
        }
        assert!(number(b"nan").is_some_and(f64::is_nan));
        for word in ["", "1,5", "0x10", "1.#QNAN", "-nan(ind)", "--1", "1_000"] {
            assert_eq!(number(word.as_bytes()), None, "{word}");
        }
    }
}
