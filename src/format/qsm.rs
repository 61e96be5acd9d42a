//! Quantitative structure models as tables: one row per cylinder.

use std::collections::BTreeMap;
use std::io::{BufReader, BufWriter, Read, Write};

use glam::DVec3;

use super::assemble::{Names, Node, Row, Sorted, assemble, sort};
use super::table::{Table, whole_of};
use super::{FormatError, Trees};
use crate::Skeleton;
use crate::cloud::Frame;

const FORMAT: &str = "QSM";

/// Names that stand for three columns in what `TreeQSM` writes.
const WIDE: [(&str, [&str; 3]); 4] = [
    ("startpoint", ["startX", "startY", "startZ"]),
    ("start", ["startX", "startY", "startZ"]),
    ("axisdirection", ["axisX", "axisY", "axisZ"]),
    ("axis", ["axisX", "axisY", "axisZ"]),
];

/// A cylinder as it stands in the table.
struct Cylinder {
    start: DVec3,
    end: DVec3,
    radius: f64,
    order: Option<u16>,
}

/// Numbers of the columns.
struct Columns {
    id: Option<usize>,
    parent: usize,
    start: [usize; 3],
    end: Option<[usize; 3]>,
    /// The direction, and the length.
    axis: Option<([usize; 3], usize)>,
    radius: usize,
    /// Radii in a unit of that column.
    radii: f64,
    order: Option<usize>,
}

impl Columns {
    fn of(table: &Table<impl std::io::BufRead>) -> Result<Self, FormatError> {
        let missing = |what: &str| {
            let problem = format!("it has no column {what}, but {}", table.listed());
            FormatError::file(FORMAT, problem)
        };
        let place = |names: [[&str; 2]; 3]| {
            let [x, y, z] = names.map(|names| table.column(&names));
            Some([x?, y?, z?])
        };
        let length = table.column(&["length", "lengthm", "lengthcyl", "cyllength"]);
        let end = place([["endx", "end1"], ["endy", "end2"], ["endz", "end3"]]);
        let axis = place([["axisx", "axis1"], ["axisy", "axis2"], ["axisz", "axis3"]]);
        let axis = axis.zip(length);
        if end.is_none() && axis.is_none() {
            return Err(missing("endX, endY, endZ, nor axisX, axisY, axisZ and length"));
        }
        let start = place([["startx", "start1"], ["starty", "start2"], ["startz", "start3"]]);
        let diameter = || table.column(&["diameter", "diameterm", "diametercyl"]).map(|column| (column, 0.5));
        let radius = table.column(&["radius", "radiuscyl", "radiusm", "cylradius"]);
        let (radius, radii) =
            radius.map(|column| (column, 1.0)).or_else(diameter).ok_or_else(|| missing("radius"))?;
        let parent = table.column(&["parentid", "parent", "parentcylid", "cylparentid"]);
        Ok(Self {
            id: table.column(&["id", "cylid", "cylinderid"]),
            parent: parent.ok_or_else(|| missing("parentID"))?,
            start: start.ok_or_else(|| missing("startX, startY, startZ"))?,
            end,
            axis,
            radius,
            radii,
            order: table.column(&["branchorder", "branchingorder"]),
        })
    }
}

/// Reads a quantitative structure model from a table with a header: one row per cylinder.
///
/// | what | columns, in capitals or not, with `.`, `_` and blanks between or not |
/// |---|---|
/// | number | `ID`, `cyl_ID`; if there is none, rows count from 1 |
/// | parent | `parentID`, `parent`, `parent_ID`; 0, -1, `NA`, nothing or its own number where there is none |
/// | start | `startX`, `startY`, `startZ`, `start_1` ...; `start_point` stands for three columns |
/// | end | `endX`, `endY`, `endZ`; or `axisX`, `axisY`, `axisZ` (`axis_direction`) and `length` |
/// | radius | `radius`, `radius_cyl`, `radius (m)`; or `diameter` |
/// | branch order | `branchOrder`, `BranchOrder`, `branching_order`; may be missing |
///
/// These are the names of `rTwig` 1.4, `TreeQSM` 2.4 (its text files and MATLAB's `writetable`), `SimpleForest` and `aRchi`.
/// Everything else is passed over. Fields stand between commas, semicolons (numbers may then have decimal commas), tabs or blanks.
///
/// A cylinder becomes an internode that ends where the cylinder ends. It begins on its parent's axis, nearest to where the
/// cylinder begins: at the parent's end if that is within half of the parent's radius, else on a node that is put there
/// ([`Trees::inserted`]); the way across to the cylinder's start ([`Trees::widest_gap`]) is added to its length. Cylinders without
/// a parent that begin in one place are one tree, others are several. O(n log n).
///
/// ```
/// use treesynth::{cloud::Frame, format};
///
/// let table = "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius\n1,0,0,0,0,0,0,1,0.1\n2,1,0,0,1,0,0,2,0.05\n";
/// let tree = format::read_qsm(&Frame::default(), table.as_bytes())?.single()?;
/// assert_eq!(tree.radii(), [0.1, 0.1, 0.05]);
/// # Ok::<(), format::FormatError>(())
/// ```
///
/// # Errors
/// A frame out of range; whatever the reader returns; a column that is missing; a row with too few fields, with what is no number,
/// or with a radius below 0; numbers that are there twice; parents that are not there or lead in a circle; a table without rows.
pub fn read_qsm(frame: &Frame, reader: impl Read) -> Result<Trees, FormatError> {
    frame.check()?;
    let mut table = Table::new(FORMAT, BufReader::new(reader), &WIDE)?;
    let columns = Columns::of(&table)?;
    let (mut rows, mut cylinders) = (Vec::new(), Vec::new());
    while table.read()? {
        let place = |columns: [usize; 3]| {
            let [x, y, z] = columns.map(|column| table.finite(column));
            Ok::<_, FormatError>(DVec3::new(x?, y?, z?))
        };
        let start = place(columns.start)?;
        let end = match (columns.end, columns.axis) {
            (Some(end), _) => place(end)?,
            (None, Some((axis, length))) => {
                let direction = place(axis)?.try_normalize().ok_or_else(|| {
                    table.fault(axis[0], "the axis has no length, but must point from the start to the end")
                })?;
                let column = length;
                let length = table.finite(column)?;
                if length < 0.0 {
                    return Err(table.fault(column, format!("{length} stands there, but must be at least 0")));
                }
                start + direction * length
            }
            (None, None) => start,
        };
        let radius = table.finite(columns.radius)?;
        if radius < 0.0 {
            let problem = format!("{radius} stands there, but must be at least 0");
            return Err(table.fault(columns.radius, problem));
        }
        let id = columns.id.map_or(Ok(rows.len() as i64 + 1), |column| table.whole(column))?;
        let order = columns.order.and_then(|column| whole_of(table.field(column)));
        let order = order.and_then(|order| u16::try_from(order).ok());
        rows.push(Row { line: table.line(), id, parent: parent(&table, columns.parent)? });
        cylinders.push(Cylinder { start, end, radius: radius * columns.radii, order });
    }
    settle_firsts(&mut rows);
    // Some count orders from 1: the lowest order of a first cylinder is the trunk's.
    let firsts = rows.iter().zip(&cylinders).filter(|(row, _)| row.parent.is_none());
    let least = firsts.filter_map(|(_, own)| own.order).min().unwrap_or(0);
    for own in &mut cylinders {
        own.order = own.order.and_then(|order| order.checked_sub(least));
    }
    let id = columns.id.map_or("the row's number", |column| table.name(column));
    let names =
        Names { format: FORMAT, id, parent: table.name(columns.parent), none: "0, -1, NA or nothing" };
    let sorted = sort(&rows, names)?;
    let (nodes, inserted, gap) = nodes_of(&rows, &cylinders, &sorted);
    let trees = assemble(&nodes, frame, FORMAT)?;
    Ok(Trees { inserted, widest_gap: frame.metres(gap), ..trees })
}

fn parent(table: &Table<impl std::io::BufRead>, column: usize) -> Result<Option<i64>, FormatError> {
    let word = table.field(column);
    let is_none = word.is_empty() || word.eq_ignore_ascii_case(b"na") || word.eq_ignore_ascii_case(b"nan");
    if is_none { Ok(None) } else { table.whole(column).map(Some) }
}

/// Rows whose parent is their own number, or is 0 or -1 and no row's number, have none.
fn settle_firsts(rows: &mut [Row]) {
    let [zero, minus] = [0, -1].map(|id| rows.iter().any(|row| row.id == id));
    for row in rows {
        let is_none = row.parent == Some(row.id)
            || (row.parent == Some(0) && !zero)
            || (row.parent == Some(-1) && !minus);
        if is_none {
            row.parent = None;
        }
    }
}

/// Place at which a cylinder leaves its parent: share of the parent's length, and distance from its
/// axis.
fn leaves_at(child: &Cylinder, parent: &Cylinder) -> (f64, f64) {
    if child.start == parent.end {
        return (1.0, 0.0);
    }
    let axis = parent.end - parent.start;
    let length = axis.length();
    let share = ((child.start - parent.start).dot(axis) / (length * length)).clamp(0.0, 1.0);
    let near = 0.5 * parent.radius / length;
    // NaN where the parent has no length.
    let share = if share.is_nan() || 1.0 - share <= near {
        1.0
    } else if share <= near {
        0.0
    } else {
        share
    };
    (share, (child.start - (parent.start + axis * share)).length())
}

/// The ends of the cylinders and what lies between, parents first; how many were inserted, and the widest gap.
fn nodes_of(rows: &[Row], cylinders: &[Cylinder], sorted: &Sorted) -> (Vec<Node>, usize, f64) {
    let mut nodes: Vec<Node> = Vec::with_capacity(cylinders.len() + 1);
    let (mut inserted, mut widest) = (0, 0.0_f64);
    // Shares of each cylinder at which others leave it.
    let mut leaving: Vec<Vec<f64>> = vec![Vec::new(); cylinders.len()];
    let shares: Vec<f64> = (0..cylinders.len())
        .map(|row| {
            let Some(parent) = sorted.parents[row] else { return 1.0 };
            let (share, gap) = leaves_at(&cylinders[row], &cylinders[parent]);
            widest = widest.max(gap);
            if share > 0.0 && share < 1.0 {
                leaving[parent].push(share);
            }
            share
        })
        .collect();
    // The nodes along each cylinder, with their shares: its start first, its end last.
    let mut along: Vec<Vec<(f64, usize)>> = vec![Vec::new(); cylinders.len()];
    let mut firsts: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    for &row in &sorted.order {
        let cylinder = &cylinders[row];
        let line = rows[row].line;
        let start = match sorted.parents[row] {
            Some(parent) => {
                let share = shares[row];
                let at = along[parent].partition_point(|&(other, _)| other < share);
                along[parent][at.min(along[parent].len() - 1)].1
            }
            // Plus zero, to make -0 and 0 one place.
            None => *firsts
                .entry((cylinder.start + DVec3::ZERO).to_array().map(f64::to_bits))
                .or_insert_with(|| {
                    let (place, radius) = (cylinder.start, cylinder.radius);
                    nodes.push(Node { line, parent: None, place, radius, order: Some(0) });
                    nodes.len() - 1
                }),
        };
        // The root is as thick as the thickest cylinder at it.
        if nodes[start].parent.is_none() {
            nodes[start].radius = nodes[start].radius.max(cylinder.radius);
        }
        let places = &mut leaving[row];
        places.sort_unstable_by(f64::total_cmp);
        places.dedup();
        inserted += places.len();
        places.push(1.0);
        along[row].push((0.0, start));
        let mut parent = start;
        for &share in &*places {
            let place = if share < 1.0 {
                cylinder.start + (cylinder.end - cylinder.start) * share
            } else {
                cylinder.end
            };
            let (radius, order) = (cylinder.radius, cylinder.order);
            nodes.push(Node { line, parent: Some(parent), place, radius, order });
            parent = nodes.len() - 1;
            along[row].push((share, parent));
        }
    }
    (nodes, inserted, widest)
}

/// Writes the least table that `rTwig`'s users agreed on: `ID, parentID, startX, startY, startZ, endX, endY, endZ, radius, length,
/// branchOrder, branchID, segmentID, parentSegmentID`.
///
/// One row per internode, in the order of the nodes: number, branch and segment from 1, the parents' 0 where
/// there is none. A segment is the way from one fork to the next. O(n).
///
/// # Errors
/// A frame out of range; a skeleton of one node, which has no internode; whatever the writer returns.
pub fn write_qsm(skeleton: &Skeleton, frame: &Frame, writer: impl Write) -> Result<(), FormatError> {
    frame.check()?;
    if skeleton.segments() == 0 {
        return Err(FormatError::file(FORMAT, "the skeleton has one node, but must have two for a cylinder"));
    }
    let mut writer = BufWriter::new(writer);
    writeln!(
        writer,
        "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius,length,branchOrder,branchID,segmentID,parentSegmentID"
    )?;
    let mut branch_of = vec![0; skeleton.len()];
    for (number, branch) in skeleton.branches().iter().enumerate() {
        for &node in &branch.nodes()[1..] {
            branch_of[node as usize] = number + 1;
        }
    }
    let mut children = vec![0_u32; skeleton.len()];
    for (_, parent) in skeleton.edges() {
        children[parent] += 1;
    }
    let (mut segment_of, mut parent_segment_of, mut segments) =
        (vec![0; skeleton.len()], vec![0; skeleton.len()], 0);
    for (node, parent) in skeleton.edges() {
        if parent != 0 && children[parent] == 1 {
            (segment_of[node], parent_segment_of[node]) = (segment_of[parent], parent_segment_of[parent]);
        } else {
            segments += 1;
            (segment_of[node], parent_segment_of[node]) = (segments, segment_of[parent]);
        }
        let (start, end) = (skeleton.positions()[parent], skeleton.positions()[node]);
        write!(writer, "{node},{parent}")?;
        for number in [start, end].map(|place| frame.written(place)).as_flattened() {
            write!(writer, ",{number}")?;
        }
        let radius = frame.length(skeleton.radii()[node]);
        let length = frame.length(start.distance(end));
        let (order, branch) = (skeleton.orders()[node], branch_of[node]);
        let (segment, parent_segment) = (segment_of[node], parent_segment_of[node]);
        writeln!(writer, ",{radius},{length},{order},{branch},{segment},{parent_segment}")?;
    }
    writer.flush()?;
    Ok(())
}
