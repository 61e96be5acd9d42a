//! Skeletons as JSON text.
//!
//! An object of six arrays, each with an entry per node:
//!
//! ```json
//! {
//!   "positions": [[0, 0, 0], [0, 1, 0]],
//!   "parents":   [null, 0],
//!   "radii":     [0.2, 0.1],
//!   "stages":    [0, 0],
//!   "orders":    [0, 0],
//!   "hops":      [0, 1]
//! }
//! ```
//!
//! Metres; `null` is the parent of the root and of nothing else. Other keys are refused.

use super::ExportError;
use crate::Skeleton;
use std::io::{self, BufRead, BufReader, BufWriter, Read, Write};

/// Error of reading a skeleton.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The reader failed.
    #[error("reading failed: {0}")]
    Io(#[from] io::Error),
    /// Not JSON, not the arrays of a skeleton, or arrays that are no [skeleton](crate::SkeletonError).
    #[error("not a skeleton in JSON{}: {reason}", place(*line, *column))]
    Syntax {
        /// The line at which reading stopped, from 1; 0 if the text is sound and what it says is not.
        line: usize,
        /// The column at which reading stopped.
        column: usize,
        /// Fault there.
        reason: String,
    },
}

fn place(line: usize, column: usize) -> String {
    if line == 0 { String::new() } else { format!(" (line {line}, column {column})") }
}

/// Writes `skeleton` as one line of JSON. Every number reads back as the same bits. O(n) time, O(n) memory.
///
/// ```
/// use treesynth::{Skeleton, export, glam::Vec3};
///
/// let twig = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)])?;
/// let mut text = Vec::new();
/// export::write_skeleton(&twig, &mut text)?;
/// assert_eq!(export::read_skeleton(&text[..])?, twig);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Whatever the writer returns.
pub fn write_skeleton(skeleton: &Skeleton, writer: impl Write) -> Result<(), ExportError> {
    let mut writer = BufWriter::new(writer);
    serde_json::to_writer(&mut writer, skeleton).map_err(io::Error::from)?;
    // Flushing by hand: dropping a BufWriter swallows the error.
    writer.flush()?;
    Ok(())
}

/// Reads a skeleton from JSON text to the end of `reader`, with a byte order mark before it or not. O(n).
///
/// # Errors
/// Whatever the reader returns; text that is cut short, followed by something else, or not JSON; missing, unknown
/// or repeated keys; numbers out of range; arrays of different lengths; anything [`Skeleton::check`] finds, such
/// as a parent that does not come before its child.
pub fn read_skeleton(reader: impl Read) -> Result<Skeleton, ReadError> {
    let mut reader = BufReader::with_capacity(1 << 16, reader);
    begin(&mut reader)?;
    serde_json::from_reader(reader).map_err(|error| {
        if error.is_io() {
            return ReadError::Io(error.into());
        }
        let (line, column) = (error.line(), error.column());
        let mut reason = error.to_string();
        let place = format!(" at line {line} column {column}");
        reason.truncate(reason.strip_suffix(&place).unwrap_or(&reason).len());
        // A word of the text may be as long as the text.
        if reason.chars().nth(MOST_REASON).is_some() {
            reason = reason.chars().take(MOST_REASON).chain(['…']).collect();
        }
        ReadError::Syntax { line, column, reason }
    })
}

/// Characters of a reason.
const MOST_REASON: usize = 300;

/// Passes over a byte order mark; refuses what begins as no text does.
fn begin(reader: &mut impl BufRead) -> Result<(), ReadError> {
    let start = loop {
        match reader.fill_buf() {
            Ok(bytes) => break [bytes.first().copied(), bytes.get(1).copied()],
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error.into()),
        }
    };
    let refused = |reason: &str| Err(ReadError::Syntax { line: 1, column: 1, reason: reason.into() });
    match start {
        [Some(0x1F), Some(0x8B)] => {
            refused("it begins with 1f 8b: it is compressed (gzip) and must be unpacked first")
        }
        [Some(0xFF | 0xFE), _] => {
            refused("it begins with ff or fe: it is UTF-16 text and must be saved as UTF-8")
        }
        [Some(0xEF), _] => {
            let mut mark = [0; 3];
            match reader.read_exact(&mut mark) {
                Ok(()) if mark == *b"\xEF\xBB\xBF" => Ok(()),
                Err(error) if error.kind() != io::ErrorKind::UnexpectedEof => Err(error.into()),
                _ => refused("expected value"),
            }
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    const FORK: &str = r#"{"positions":[[0,0,0],[0,1,0],[1,2,0],[-1,2,0.5]],"parents":[null,0,1,1],
        "radii":[0.2,0.1,0.05,0.05],"stages":[0,0,1,1],"orders":[0,0,0,1],"hops":[0,1,1,1]}"#;

    fn read(text: &str) -> Result<Skeleton, ReadError> {
        read_skeleton(text.as_bytes())
    }

    fn refused(text: &str, reason_has: &str) {
        match read(text) {
            Err(ReadError::Syntax { reason, .. }) => assert!(reason.contains(reason_has), "{reason}"),
            other => panic!("{text} gave {other:?}"),
        }
    }

    #[test]
    fn every_truncation_is_refused() {
        assert_eq!(read(FORK).map(|skeleton| skeleton.len()).ok(), Some(4));
        for end in 0..FORK.len() {
            assert!(matches!(read(&FORK[..end]), Err(ReadError::Syntax { .. })), "cut at {end}");
        }
    }

    #[test]
    fn foreign_text_is_refused() {
        refused("", "EOF");
        refused("[]", "invalid length");
        refused("42", "invalid type");
        refused("{}", "missing field `positions`");
        refused("\u{0}\u{1}glTF", "expected value");
        refused(&"[".repeat(100_000), "invalid type");
        refused(&format!("{FORK} and more"), "trailing");
        refused(&FORK.replace("\"hops\"", "\"leaves\""), "unknown field `leaves`");
        refused(&FORK.replace("\"hops\"", "\"radii\""), "duplicate field `radii`");
        assert!(matches!(read_skeleton(&b"{\"positions\":[[\xff"[..]), Err(ReadError::Syntax { .. })));
    }

    #[test]
    fn valid_text_is_read_however_it_is_written() {
        let plain = read(FORK).expect("a fork");
        let spaced = FORK.replace(',', " ,\n\t").replace(':', " : ") + "\r\n\n";
        let others = [
            format!("\u{feff}{FORK}"),
            spaced,
            FORK.replace("[0,0,0]", "[-0,0e9,0.0E+1]").replace("0.2", "2e-1"),
        ];
        for text in others
            .iter()
            .chain(&[FORK.replace("hops", "h\\u006fps"), FORK.replace("0.5]", "0.50000000000000000000000]")])
        {
            assert_eq!(read(text).expect(text), plain);
        }
        assert!(read(&FORK.replace("0.5]", "1e-60]")).is_ok(), "less than any f32 is 0");
        let mut parts: Vec<&str> =
            FORK.trim_matches(['{', '}']).split(",\"").flat_map(|part| part.split(",\n")).collect();
        parts.reverse();
        assert_eq!(parts.len(), 6);
        let reordered: Vec<String> =
            parts.iter().map(|part| format!("\"{}", part.trim().trim_start_matches('"'))).collect();
        assert_eq!(read(&format!("{{{}}}", reordered.join(","))).expect("in another order"), plain);
    }

    #[test]
    fn errors_are_short_and_say_where() {
        let text = |bytes: &[u8]| {
            read_skeleton(bytes).map(|skeleton| skeleton.len()).expect_err("no skeleton").to_string()
        };
        assert!(text(b"\x1f\x8b\x08\0").contains("gzip"));
        assert!(text(b"\xff\xfe{\0").contains("UTF-16"));
        assert!(text(b"\xef\xbb").contains("line 1, column 1"));
        let semantic = text(FORK.replace("0.2", "-0.2").as_bytes());
        assert!(semantic.starts_with("not a skeleton in JSON: node 0 has the radius"), "{semantic}");
        let syntax = text(FORK.replace("0.2", "x").as_bytes());
        assert!(syntax.contains("(line 2, column 18)") && !syntax.contains("at line"), "{syntax}");
        let long = text(format!("{{\"{}\":1}}", "k".repeat(5_000_000)).as_bytes());
        assert!(long.len() < 500, "{}", long.len());
    }

    #[test]
    fn bad_arrays_are_refused() {
        refused(&FORK.replace("[0,0,1,1]", "[0,0,1]"), "stages has 3 entries, but there are 4 nodes");
        refused(&FORK.replace("[0,0,0,1]", "[0,0,0,1,2]"), "orders has 5 entries");
        refused(&FORK.replace("[1,2,0]", "[1,2]"), "invalid length 2");
        refused(&FORK.replace("[1,2,0]", "[1,2,0,0]"), "trailing");
        refused(&FORK.replace("[0,0,1,1]", "[0,0,1,65536]"), "invalid value");
        refused(&FORK.replace("0.2", "-0.2"), "node 0 has the radius -0.2");
        let none = r#"{"positions":[],"parents":[],"radii":[],"stages":[],"orders":[],"hops":[]}"#;
        refused(none, "at least one node");
    }

    #[test]
    fn bad_parents_are_refused() {
        refused(&FORK.replace("[null,0,1,1]", "[null,2,1,1]"), "node 1 has the parent 2");
        refused(&FORK.replace("[null,0,1,1]", "[null,0,2,1]"), "node 2 has the parent 2");
        refused(&FORK.replace("[null,0,1,1]", "[null,0,1,900]"), "node 3 has the parent 900");
        refused(&FORK.replace("[null,0,1,1]", "[null,0,1,-1]"), "invalid value");
        refused(&FORK.replace("[null,0,1,1]", "[null,0,null,1]"), "node 2 has no parent");
        refused(&FORK.replace("[null,0,1,1]", "[0,0,1,1]"), "node 0 is the root");
    }

    #[test]
    fn what_is_no_number_is_refused() {
        refused(&FORK.replace("0.5]", "null]"), "invalid type: null");
        refused(&FORK.replace("0.2", "null"), "invalid type: null");
        refused(&FORK.replace("0.2", "NaN"), "expected value");
        refused(&FORK.replace("0.2", "1e999"), "out of range");
        refused(&FORK.replace("0.2", "1e39"), "");
        refused(&FORK.replace("0.5]", "-1e39]"), "");
    }

    /// Gives this number of bytes, then fails.
    struct Broken(usize);

    impl Read for Broken {
        fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
            let start = FORK.len() - self.0.min(FORK.len());
            let given = bytes.len().min(self.0).min(10);
            bytes[..given].copy_from_slice(&FORK.as_bytes()[start..start + given]);
            self.0 -= given;
            if given == 0 { Err(io::ErrorKind::ConnectionReset.into()) } else { Ok(given) }
        }
    }

    #[test]
    fn readers_may_fail() {
        assert!(matches!(read_skeleton(Broken(50)), Err(ReadError::Io(_) | ReadError::Syntax { .. })));
    }

    proptest! {
        #[test]
        fn a_round_trip_loses_nothing(
            nodes in prop::collection::vec((any::<prop::sample::Index>(), prop::array::uniform3(prop::num::f32::ANY),
                prop::num::f32::ANY, any::<u16>(), any::<u32>()), 1..40),
        ) {
            let sound = |x: f32| if x.is_finite() { x } else { -0.0 };
            let positions = nodes.iter().map(|n| Vec3::from_array(n.1.map(sound))).collect();
            let parents = nodes.iter().enumerate().map(|(i, n)| (i > 0).then(|| n.0.index(i) as u32)).collect();
            let skeleton = Skeleton::new(positions, parents)
                .and_then(|s| s.with_radii(nodes.iter().map(|n| sound(n.2).abs()).collect()))
                .and_then(|s| s.with_stages(nodes.iter().map(|n| n.3).collect()))
                .and_then(|s| s.with_hops(nodes.iter().map(|n| n.4).collect()))
                .expect("made to be sound");
            let mut text = Vec::new();
            write_skeleton(&skeleton, &mut text).expect("a vector takes everything");
            let back = read_skeleton(&text[..]).expect("what was written");
            prop_assert_eq!(&back, &skeleton);
            // Equality takes -0 for 0; the bits do not.
            let bits = |s: &Skeleton| s.positions().iter().map(|p| p.to_array().map(f32::to_bits)).collect::<Vec<_>>();
            prop_assert_eq!(bits(&back), bits(&skeleton));
        }

        #[test]
        fn no_text_is_trouble(text in ".{0,200}", at in 0usize..FORK.len(), byte in any::<u8>()) {
            prop_assert!(read(&text).is_err());
            let mut bent = FORK.as_bytes().to_vec();
            bent[at] = byte;
            if let Ok(skeleton) = read_skeleton(&bent[..]) {
                prop_assert!(skeleton.check().is_ok());
            }
        }
    }
}
