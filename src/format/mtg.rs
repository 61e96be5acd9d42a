//! MTG, the multiscale tree graph, after Godin and Caraglio 1998, "A multiscale model of plant topological structures", Journal of
//! Theoretical Biology 191; the text form as the manual of `OpenAlea.MTG` has it.

use std::collections::BTreeMap;
use std::io::{BufReader, BufWriter, Read, Write};

use glam::DVec3;

use super::assemble::{Names, Node, Row, assemble, sort};
use super::table::{finite, plain, whole_of};
use super::{FormatError, Trees};
use crate::Skeleton;
use crate::cloud::Frame;
use crate::text::{Lines, quoted, stranger, words};

const FORMAT: &str = "MTG";

/// Branch orders that are written, each in a column of its own.
const MOST_ORDERS: u16 = 500;

/// Reads the finest scale of an MTG as nodes, with their coordinates and thickness as features.
///
/// A vertex of a class of the finest scale in `CLASSES` is a node; `<` goes on along its axis, `+` begins a lateral, one order
/// higher; an edge of a coarser vertex (`+A2/N1`) counts for the first node in it. `^` goes on from the latest vertex in the
/// same column, and without it from that in the column before. Coordinates are the features `XX`, `YY`, `ZZ` or `X`, `Y`, `Z`,
/// thickness is `diameter`, `Diam`, `TopDia` or `radius`; a node without it is as thick as its parent. Each node without a
/// predecessor begins a tree. If the numbers in a tree's labels differ from each other, its nodes come in their order, parents first, else
/// as in the file. O(n log n).
///
/// ```
/// use treesynth::{cloud::Frame, format};
///
/// let text = "CODE:\tFORM-A\n\nCLASSES:\nSYMBOL\tSCALE\tDECOMPOSITION\tINDEXATION\tDEFINITION\n$\t0\tFREE\tFREE\tIMPLICIT\n\
///     P\t1\tFREE\tFREE\tIMPLICIT\nN\t2\tFREE\tFREE\tEXPLICIT\n\nDESCRIPTION:\nLEFT\tRIGHT\tRELTYPE\tMAX\nN\tN\t<,+\t?\n\n\
///     FEATURES:\nNAME\tTYPE\nXX\tREAL\nYY\tREAL\nZZ\tREAL\ndiameter\tREAL\n\nMTG:\nENTITY-CODE\t\tXX\tYY\tZZ\tdiameter\n\
///     /P1/N1\t\t0\t0\t0\t0.2\n^<N2\t\t0\t0\t1\t0.1\n\t+N3\t0.5\t0\t1.5\t0.05\n^<N4\t\t0\t0\t2\t0.1\n";
/// let tree = format::read_mtg(&Frame::default(), text.as_bytes())?.single()?;
/// assert_eq!(tree.orders(), [0, 0, 1, 0]);
/// # Ok::<(), format::FormatError>(())
/// ```
///
/// # Errors
/// A frame out of range; whatever the reader returns; sections or features that are missing; a code that is not one of `/`, `<`,
/// `+`, a class and a number (`<<`, `++` and sets of vertices are not read); a node without coordinates, or thinner than 0; a file
/// without nodes.
pub fn read_mtg(frame: &Frame, reader: impl Read) -> Result<Trees, FormatError> {
    frame.check()?;
    let mut lines = Lines::new(BufReader::new(reader));
    let mut scales: BTreeMap<String, u32> = BTreeMap::new();
    let mut section = String::new();
    let mut vertices: Option<Vertices> = None;
    while lines.read()? {
        let (line, number) = (lines.line(), lines.number());
        if let Some(what) = stranger(line).filter(|_| number == 1) {
            return Err(FormatError::line(FORMAT, number, "", what));
        }
        let text = line.split(|&byte| byte == b'#').next().unwrap_or(line);
        let Some(first) = words(text).next() else { continue };
        if let Some(vertices) = &mut vertices {
            vertices.row(text, number, &scales)?;
        } else if first.ends_with(b":") {
            section = String::from_utf8_lossy(first).into_owned();
        } else if section == "CLASSES:" && first != b"SYMBOL" {
            let scale = words(text).nth(1).and_then(whole_of).filter(|scale| (0..1000).contains(scale));
            let scale = scale.ok_or_else(|| {
                let problem =
                    format!("{} must be a class and its scale, 0 to 999", quoted(text.trim_ascii()));
                FormatError::line(FORMAT, number, "SCALE", problem)
            })?;
            scales.insert(String::from_utf8_lossy(first).into_owned(), scale as u32);
        } else if section == "MTG:" {
            vertices = Some(Vertices::new(text, number, &scales)?);
        }
    }
    let vertices = vertices.ok_or_else(|| {
        FormatError::file(FORMAT, "it has no section \"MTG:\" with a line that begins with ENTITY-CODE")
    })?;
    vertices.trees(frame)
}

/// State from which a row continues.
#[derive(Debug, Clone, Copy, Default)]
struct Cursor {
    /// The latest node.
    node: Option<usize>,
    /// A coarser vertex began a lateral, whose first node is to come.
    is_lateral: bool,
    /// `true` once there is a vertex.
    begun: bool,
}

struct Vertices {
    /// The columns of codes.
    codes: usize,
    place: [usize; 3],
    /// The column of thickness and its radii.
    thickness: Option<(usize, f64)>,
    names: Vec<String>,
    coarsest: u32,
    finest: u32,
    /// The latest vertex in each column.
    latest: Vec<Cursor>,
    nodes: Vec<Node>,
    /// The number in each node's label.
    labels: Vec<Option<i64>>,
}

impl Vertices {
    fn new(header: &[u8], line: u64, scales: &BTreeMap<String, u32>) -> Result<Self, FormatError> {
        let fault = |problem: String| FormatError::line(FORMAT, line, "", problem);
        let names: Vec<String> = header
            .split(|&byte| byte == b'\t')
            .map(|field| String::from_utf8_lossy(field.trim_ascii()).into_owned())
            .collect();
        let codes = names.iter().skip(1).position(|name| !name.is_empty()).map_or(names.len(), |at| at + 1);
        let column = |wanted: &[&str]| names.iter().position(|name| wanted.contains(&&*plain(name)));
        let listed =
            || names.iter().take(24).filter(|name| !name.is_empty()).cloned().collect::<Vec<_>>().join(", ");
        let axes = [["xx", "x"], ["yy", "y"], ["zz", "z"]].map(|names| column(&names));
        let [Some(x), Some(y), Some(z)] = axes else {
            return Err(fault(format!(
                "the columns are {}, but must have the features XX, YY and ZZ",
                listed()
            )));
        };
        let diameter = || column(&["diameter", "diam", "dia", "topdia", "topdiameter"]).map(|at| (at, 0.5));
        let thickness = column(&["radius"]).map(|at| (at, 1.0)).or_else(diameter);
        let coarsest = scales.values().copied().filter(|&scale| scale > 0).min();
        let (Some(coarsest), Some(&finest)) = (coarsest, scales.values().max()) else {
            return Err(fault("the section \"CLASSES:\" has no class of a scale above 0".into()));
        };
        let (nodes, labels) = (Vec::new(), Vec::new());
        let latest = Vec::new();
        Ok(Self { codes, place: [x, y, z], thickness, names, coarsest, finest, latest, nodes, labels })
    }

    fn row(&mut self, text: &[u8], line: u64, scales: &BTreeMap<String, u32>) -> Result<(), FormatError> {
        let fields: Vec<&[u8]> = text.split(|&byte| byte == b'\t').map(<[u8]>::trim_ascii).collect();
        let code = fields.iter().take(self.codes).enumerate().find(|(_, field)| !field.is_empty());
        let Some((column, &code)) = code else {
            let problem = "the line has features, but no vertex; one must stand in the first columns";
            return Err(FormatError::line(FORMAT, line, "ENTITY-CODE", problem));
        };
        let same = code.strip_prefix(b"^");
        let latest =
            |column: Option<usize>| column.and_then(|at| self.latest.get(at)).copied().unwrap_or_default();
        let before = latest(column.checked_sub(1));
        let mut cursor = if same.is_some() { latest(Some(column)) } else { before };
        if same.is_some() && !cursor.begun {
            cursor = before;
        }
        let made = self.nodes.len();
        self.follow(same.unwrap_or(code), &mut cursor, line, scales)?;
        self.latest.truncate(column);
        self.latest.resize(column, Cursor::default());
        cursor.begun = true;
        self.latest.push(cursor);
        if self.nodes.len() > made + 1 || (self.nodes.len() > made && cursor.node.is_none()) {
            let problem =
                format!("{} has several nodes, but one alone can have the line's coordinates", quoted(code));
            return Err(FormatError::line(FORMAT, line, "ENTITY-CODE", problem));
        }
        if self.nodes.len() == made {
            return Ok(());
        }
        let value =
            |at: usize| finite(FORMAT, line, &self.names[at], fields.get(at).copied().unwrap_or_default());
        let [x, y, z] = self.place.map(value);
        let place = DVec3::new(x?, y?, z?);
        let mut radius = self.nodes[made].parent.map_or(0.0, |parent| self.nodes[parent].radius);
        if let Some((at, radii)) = self.thickness {
            let word = fields.get(at).copied().unwrap_or_default();
            if !(word.is_empty() || word.eq_ignore_ascii_case(b"na")) {
                radius = finite(FORMAT, line, &self.names[at], word)? * radii;
            }
            if radius < 0.0 {
                let problem = format!("{} stands there, but must be at least 0", quoted(word));
                return Err(FormatError::line(FORMAT, line, &*self.names[at], problem));
            }
        }
        (self.nodes[made].place, self.nodes[made].radius) = (place, radius);
        Ok(())
    }

    /// Follows a code from a vertex, making the nodes in it.
    fn follow(
        &mut self,
        code: &[u8],
        cursor: &mut Cursor,
        line: u64,
        scales: &BTreeMap<String, u32>,
    ) -> Result<(), FormatError> {
        let fault = |problem: String| FormatError::line(FORMAT, line, "ENTITY-CODE", problem);
        let shown = quoted(code);
        let mut rest = code;
        if rest.is_empty() {
            return Err(fault("\"^\" stands alone, but a vertex must follow it, as in ^<N2".into()));
        }
        while let Some((&edge, after)) = rest.split_first() {
            if !b"/<+".contains(&edge) {
                return Err(fault(format!(
                    "{shown} must be made of \"/\", \"<\" or \"+\", a class and a number"
                )));
            }
            let letters =
                after.iter().take_while(|byte| byte.is_ascii_alphabetic() || **byte == b'_').count();
            let digits = after[letters..].iter().take_while(|byte| byte.is_ascii_digit()).count();
            let (class, number) = (&after[..letters], &after[letters..letters + digits]);
            rest = &after[letters + digits..];
            let class = String::from_utf8_lossy(class);
            let Some(&scale) = scales.get(&*class) else {
                let known: Vec<&str> = scales.keys().take(24).map(String::as_str).collect();
                let problem =
                    format!("{shown} has the class {class:?}, but the classes are {}", known.join(", "));
                return Err(fault(problem));
            };
            if scale == self.coarsest && (edge == b'/' || scale < self.finest) {
                *cursor = Cursor::default();
            }
            if scale < self.finest {
                cursor.is_lateral |= edge == b'+';
                continue;
            }
            if edge != b'/' && cursor.node.is_none() {
                return Err(fault(format!("{shown} follows nothing; a first vertex begins with \"/\"")));
            }
            let is_lateral = cursor.is_lateral || edge == b'+';
            let order = match cursor.node {
                Some(parent) => {
                    self.nodes[parent].order.and_then(|order| order.checked_add(is_lateral.into()))
                }
                None => Some(0),
            };
            let (place, radius) = (DVec3::ZERO, 0.0);
            self.nodes.push(Node { line, parent: cursor.node, place, radius, order });
            self.labels.push(whole_of(number));
            (cursor.node, cursor.is_lateral) = (Some(self.nodes.len() - 1), false);
        }
        Ok(())
    }

    fn trees(self, frame: &Frame) -> Result<Trees, FormatError> {
        let Self { nodes, labels, .. } = self;
        let mut trees = vec![0; nodes.len()];
        let mut count = 0;
        for (node, own) in nodes.iter().enumerate() {
            trees[node] = own.parent.map_or(count, |parent| trees[parent]);
            count += usize::from(own.parent.is_none());
        }
        // Trees one after the other, each in the order of its labels if they differ.
        let mut seen: Vec<Vec<Option<i64>>> = vec![Vec::new(); count];
        trees.iter().zip(&labels).for_each(|(&tree, &label)| seen[tree].push(label));
        let differ: Vec<bool> = seen
            .into_iter()
            .map(|mut labels| {
                labels.sort_unstable();
                labels.first().is_none_or(Option::is_some) && labels.windows(2).all(|pair| pair[0] != pair[1])
            })
            .collect();
        let mut order: Vec<usize> = (0..nodes.len()).collect();
        order.sort_by_key(|&node| (trees[node], labels[node].filter(|_| differ[trees[node]]), node));
        let rows: Vec<Row> = order
            .iter()
            .map(|&node| Row {
                line: nodes[node].line,
                id: node as i64,
                parent: nodes[node].parent.map(|parent| parent as i64),
            })
            .collect();
        let names = Names { format: FORMAT, id: "ENTITY-CODE", parent: "ENTITY-CODE", none: "/" };
        let sorted = sort(&rows, names)?;
        let mut places = vec![0; rows.len()];
        let mut put = Vec::with_capacity(rows.len());
        for &row in &sorted.order {
            places[row] = put.len();
            let parent = sorted.parents[row].map(|parent| places[parent]);
            put.push(Node { parent, ..nodes[order[row]].clone() });
        }
        assemble(&put, frame, FORMAT)
    }
}

/// Writes a skeleton as an MTG of two scales, a plant `P` and nodes `N`: `<` along an axis, `+` where a branch begins, the features
/// `XX`, `YY`, `ZZ` and `diameter`. Nodes are numbered from 1 as in the skeleton. O(n), and one tab per
/// order.
///
/// # Errors
/// A frame out of range; branch orders above 500, each of which is a column; whatever the writer returns.
pub fn write_mtg(skeleton: &Skeleton, frame: &Frame, writer: impl Write) -> Result<(), FormatError> {
    frame.check()?;
    let orders = skeleton.orders().iter().copied().max().unwrap_or(0);
    if orders > MOST_ORDERS {
        let problem =
            format!("the branch order is {orders}, but a file has at most {MOST_ORDERS}, a column each");
        return Err(FormatError::file(FORMAT, problem));
    }
    let mut writer = BufWriter::new(writer);
    write!(
        writer,
        "CODE:\tFORM-A\n\nCLASSES:\nSYMBOL\tSCALE\tDECOMPOSITION\tINDEXATION\tDEFINITION\n$\t0\tFREE\tFREE\tIMPLICIT\n\
         P\t1\tFREE\tFREE\tIMPLICIT\nN\t2\tFREE\tFREE\tEXPLICIT\n\nDESCRIPTION:\nLEFT\tRIGHT\tRELTYPE\tMAX\nN\tN\t<\t1\nN\tN\t+\t?\n\n\
         FEATURES:\nNAME\tTYPE\nXX\tREAL\nYY\tREAL\nZZ\tREAL\ndiameter\tREAL\n\nMTG:\nENTITY-CODE"
    )?;
    let tabs = |writer: &mut BufWriter<_>, count: usize| (0..count).try_for_each(|_| write!(writer, "\t"));
    let columns = usize::from(orders) + 1;
    tabs(&mut writer, columns)?;
    writeln!(writer, "XX\tYY\tZZ\tdiameter")?;
    let children = skeleton.children();
    let mut stack = vec![0_usize];
    while let Some(node) = stack.pop() {
        let order = skeleton.orders()[node];
        let column = usize::from(order);
        tabs(&mut writer, column)?;
        match skeleton.parent(node).map(|parent| skeleton.orders()[parent] == order) {
            None => write!(writer, "/P1/N{}", node + 1)?,
            Some(true) => write!(writer, "^<N{}", node + 1)?,
            Some(false) => write!(writer, "+N{}", node + 1)?,
        }
        tabs(&mut writer, columns - column)?;
        let [x, y, z] = frame.written(skeleton.positions()[node]);
        writeln!(writer, "{x}\t{y}\t{z}\t{}", frame.length(skeleton.radii()[node]).doubled())?;
        // Laterals come first, while their parent is the latest in its column.
        let children = children.of(node);
        let goes_on = |child: &&u32| skeleton.orders()[**child as usize] == order;
        stack.extend(children.iter().filter(goes_on).map(|&child| child as usize));
        stack.extend(children.iter().rev().filter(|child| !goes_on(child)).map(|&child| child as usize));
    }
    writer.flush()?;
    Ok(())
}
