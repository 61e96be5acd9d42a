//! SWC: one line per node, `id type x y z radius parent`, after Cannon et al. 1998, "An on-line archive of
//! reconstructed hippocampal neurons", Journal of Neuroscience Methods 84;
//! <https://neuroinformatics.nl/swcPlus/>.

use std::io::{BufReader, BufWriter, Read, Write};

use glam::DVec3;

use super::assemble::{Names, Node, Row, assemble, sort};
use super::table::{finite, whole};
use super::{FormatError, Trees};
use crate::Skeleton;
use crate::cloud::Frame;
use crate::text::{Lines, quoted, stranger, words};

const FORMAT: &str = "SWC";
const COLUMNS: [&str; 7] = ["id", "type", "x", "y", "z", "radius", "parent"];

/// Reads SWC: lines of `id type x y z radius parent`, the parent -1 for a root; `#` begins a comment.
///
/// Ids may have gaps and stand in any order. Types and whatever follows the seven columns are passed over. Every root makes a
/// tree; [`Trees::single`] refuses several. A radius of 0 says that none is known. O(n log n).
///
/// ```
/// use treesynth::{cloud::Frame, format};
///
/// let text = "# id type x y z radius parent\n7 1 0 0 0 0.2 -1\n9 3 0 0 2 0.1 8\n8 3 0 0 1 0.1 7\n";
/// let tree = format::read_swc(&Frame::default(), text.as_bytes())?.single()?;
/// assert_eq!((tree.len(), tree.positions()[2].y), (3, 2.0));
/// # Ok::<(), format::FormatError>(())
/// ```
///
/// # Errors
/// A frame out of range; whatever the reader returns; a line with fewer columns, with what is no number, or with a radius below 0;
/// ids that are there twice; parents that are not there or lead in a circle; a file without nodes.
pub fn read_swc(frame: &Frame, reader: impl Read) -> Result<Trees, FormatError> {
    frame.check()?;
    let (mut rows, mut values) = (Vec::new(), Vec::new());
    let mut lines = Lines::new(BufReader::new(reader));
    while lines.read()? {
        let (line, number) = (lines.line(), lines.number());
        if let Some(what) = stranger(line).filter(|_| number == 1) {
            return Err(FormatError::line(FORMAT, number, "", what));
        }
        let text = line.split(|&byte| byte == b'#').next().unwrap_or(line);
        let fields: Vec<&[u8]> = words(text).take(COLUMNS.len()).collect();
        let Some(&first) = fields.first() else { continue };
        if fields.len() < COLUMNS.len() {
            let problem =
                format!("{} has {} words, but must have {}", quoted(text), fields.len(), COLUMNS.join(" "));
            return Err(FormatError::line(FORMAT, number, "", problem));
        }
        let [x, y, z, radius] = [2, 3, 4, 5].map(|at| finite(FORMAT, number, COLUMNS[at], fields[at]));
        let id = whole(FORMAT, number, "id", first)?;
        let parent = whole(FORMAT, number, "parent", fields[6])?;
        values.push((DVec3::new(x?, y?, z?), radius?));
        rows.push(Row { line: number, id, parent: (parent != -1).then_some(parent) });
    }
    let names = Names { format: FORMAT, id: "id", parent: "parent", none: "-1" };
    let sorted = sort(&rows, names)?;
    let mut places = vec![0; rows.len()];
    let mut nodes = Vec::with_capacity(rows.len());
    for &row in &sorted.order {
        places[row] = nodes.len();
        let (place, radius) = values[row];
        let parent = sorted.parents[row].map(|parent| places[parent]);
        nodes.push(Node { line: rows[row].line, parent, place, radius, order: None });
    }
    let trees = assemble(&nodes, frame, FORMAT)?;
    Ok(Trees { has_orders: false, ..trees })
}

/// Writes a skeleton as SWC: ids from 1, type 0 (none is known), the root's parent -1. O(n).
///
/// # Errors
/// A frame out of range; whatever the writer returns.
pub fn write_swc(skeleton: &Skeleton, frame: &Frame, writer: impl Write) -> Result<(), FormatError> {
    frame.check()?;
    let mut writer = BufWriter::new(writer);
    writeln!(writer, "# id type x y z radius parent")?;
    for (node, (&position, &radius)) in skeleton.positions().iter().zip(skeleton.radii()).enumerate() {
        let [x, y, z] = frame.written(position);
        let parent = skeleton.parent(node).map_or(-1, |parent| parent as i64 + 1);
        writeln!(writer, "{} 0 {x} {y} {z} {} {parent}", node + 1, frame.length(radius))?;
    }
    // Flushing by hand: dropping a BufWriter swallows the error.
    writer.flush()?;
    Ok(())
}
