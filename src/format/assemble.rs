//! Rows with numbers and parents become skeletons.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use glam::DVec3;

use super::{FormatError, Trees};
use crate::Skeleton;
use crate::cloud::Frame;

/// A row of a file.
#[derive(Debug, Clone)]
pub(super) struct Row {
    pub(super) line: u64,
    pub(super) id: i64,
    pub(super) parent: Option<i64>,
}

/// Rows as trees.
#[derive(Debug)]
pub(super) struct Sorted {
    /// Each row's parent among the rows.
    pub(super) parents: Vec<Option<usize>>,
    /// All rows, parents before children, else as in the file.
    pub(super) order: Vec<usize>,
}

/// The names of the columns, for errors.
#[derive(Debug, Clone, Copy)]
pub(super) struct Names<'a> {
    pub(super) format: &'static str,
    pub(super) id: &'a str,
    pub(super) parent: &'a str,
    /// The parent's entry in a row without a parent.
    pub(super) none: &'a str,
}

/// Finds each row's parent and puts parents first. O(n log n).
pub(super) fn sort(rows: &[Row], names: Names<'_>) -> Result<Sorted, FormatError> {
    let mut places: BTreeMap<i64, usize> = BTreeMap::new();
    for (place, row) in rows.iter().enumerate() {
        if let Some(before) = places.insert(row.id, place) {
            let problem =
                format!("{} stands in line {} too, but must be there once", row.id, rows[before].line);
            return Err(FormatError::line(names.format, row.line, names.id, problem));
        }
    }
    let mut parents = Vec::with_capacity(rows.len());
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); rows.len()];
    let mut ready = BinaryHeap::new();
    for (place, row) in rows.iter().enumerate() {
        let parent = match row.parent {
            None => None,
            Some(id) => Some(*places.get(&id).ok_or_else(|| {
                let problem = format!("{id} is the {} of no row; a first row has {}", names.id, names.none);
                FormatError::line(names.format, row.line, names.parent, problem)
            })?),
        };
        match parent {
            None => ready.push(Reverse(place)),
            Some(parent) => children[parent].push(place),
        }
        parents.push(parent);
    }
    let mut order = Vec::with_capacity(rows.len());
    while let Some(Reverse(place)) = ready.pop() {
        order.push(place);
        ready.extend(children[place].iter().map(|&child| Reverse(child)));
    }
    if order.len() < rows.len() {
        let mut there = vec![false; rows.len()];
        for &place in &order {
            there[place] = true;
        }
        let row = there.iter().position(|there| !there).map_or(&rows[0], |place| &rows[place]);
        let problem = format!("the parents of {} lead in a circle, but must lead to a first row", row.id);
        return Err(FormatError::line(names.format, row.line, names.parent, problem));
    }
    Ok(Sorted { parents, order })
}

/// A node as the file has it.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub(super) line: u64,
    pub(super) parent: Option<usize>,
    pub(super) place: DVec3,
    /// In the file's unit.
    pub(super) radius: f64,
    pub(super) order: Option<u16>,
}

/// The skeletons of nodes whose parents come first.
pub(super) fn assemble(nodes: &[Node], frame: &Frame, format: &'static str) -> Result<Trees, FormatError> {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for node in nodes {
        (low, high) = (low.min(node.place), high.max(node.place));
    }
    let offset = frame.offset_of(low, high);
    let offset = offset.map_err(|problem| FormatError::file(format, format!("coordinates: {problem}")))?;
    let mut trees: Vec<Parts> = Vec::new();
    // Each node's tree, and its number there.
    let mut places: Vec<(usize, u32)> = Vec::with_capacity(nodes.len());
    for node in nodes {
        let (tree, parent) = match node.parent {
            None => {
                trees.push(Parts::default());
                (trees.len() - 1, None)
            }
            Some(parent) => (places[parent].0, Some(places[parent].1)),
        };
        let parts = &mut trees[tree];
        places.push((tree, parts.positions.len() as u32));
        let position = frame.local(node.place, offset);
        let position = position.map_err(|problem| FormatError::line(format, node.line, "", problem))?;
        let radius = frame.metres(node.radius) as f32;
        if !(radius.is_finite() && radius >= 0.0) {
            let problem = format!("the radius is {}, but must be finite and at least 0", node.radius);
            return Err(FormatError::line(format, node.line, "radius", problem));
        }
        parts.positions.push(position);
        parts.parents.push(parent);
        parts.radii.push(radius);
        parts.orders.extend(node.order);
    }
    if trees.is_empty() {
        return Err(FormatError::file(format, "the file has no rows, but must have one at least"));
    }
    let mut has_orders = true;
    let mut skeletons = Vec::with_capacity(trees.len());
    for parts in trees {
        let skeleton = Skeleton::new(parts.positions, parts.parents)?.with_radii(parts.radii)?;
        let ordered = skeleton.clone().with_orders(parts.orders);
        has_orders &= ordered.is_ok();
        skeletons.push(ordered.unwrap_or(skeleton));
    }
    Ok(Trees { trees: skeletons, offset, inserted: 0, widest_gap: 0.0, has_orders })
}

#[derive(Default)]
struct Parts {
    positions: Vec<glam::Vec3>,
    parents: Vec<Option<u32>>,
    radii: Vec<f32>,
    orders: Vec<u16>,
}
