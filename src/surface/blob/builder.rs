//! From primitives and operators to a [`BlobTree`], each step checked.

use super::BlobTree;
use super::bend::Bend;
use super::bounded::Bounded;
use super::curve::Curve;
use super::error::BlobError;
use super::limb::Fork;
use super::operator::{Contact, Operator};
use super::primitive::{Leaf, Primitive, Range, STRAIGHT};
use super::scene::{Kind, Scene, Warp};
use crate::Bounds;
use crate::observer::Watch;
use crate::surface::far;
use glam::Affine3A;
use smallvec::SmallVec;
use std::sync::atomic::{AtomicU32, Ordering};

/// Farther out than this, in metres, products of coordinates leave the range of 32-bit floats.
const FARTHEST: f32 = 4e9;
/// More parts of one operator than this are put into groups, near ones together.
const GROUP: usize = 4;

/// What an operator has of its parts; more than so many are on the heap.
type Few<T> = SmallVec<[T; GROUP]>;

/// A part of a [`BlobTree`] in the making, to be used once: what takes it, owns it.
#[derive(Debug)]
pub struct Node {
    builder: u32,
    number: u32,
}

/// Tells builders apart.
static BUILDERS: AtomicU32 = AtomicU32::new(0);

/// Node before its parts are in order.
#[derive(Debug, Clone, Copy)]
pub(super) enum Draft {
    Leaf(u32),
    Combine { operator: u32, parts: [u32; 2] },
    Bounded { style: u32, parts: [u32; 2] },
    Fork { fork: Fork, parts: [u32; 2] },
    Warp { warp: u32, part: u32 },
}

/// A node with what is known of its field everywhere.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) draft: Draft,
    pub(super) bounds: Bounds,
    most: f32,
    taken: bool,
}

/// Makes a [`BlobTree`] from its leaves up. Every node is used once; what is not, is left out.
///
/// ```
/// use treesynth::glam::Vec3;
/// use treesynth::surface::blob::{BlobTreeBuilder, Bounded, Primitive};
///
/// let mut parts = BlobTreeBuilder::default();
/// let stem = parts.add(Primitive::line(Vec3::ZERO, Vec3::Y, 0.1))?;
/// let twig = parts.add(Primitive::cone([Vec3::Y * 0.5, Vec3::new(0.5, 1.0, 0.0)], [0.06, 0.04]))?;
/// let axil = parts.add(Primitive::point(Vec3::new(0.1, 0.7, 0.0), 0.2).bounding(1.0))?;
/// let fork = parts.bounded([stem, twig], Bounded::default(), axil)?;
/// let solid = parts.finish(fork)?;
/// assert!(solid.value(Vec3::Y * 0.2) > 0.0 && solid.value(Vec3::X) < 0.0);
/// # Ok::<(), treesynth::surface::blob::BlobError>(())
/// ```
#[must_use]
#[derive(Debug)]
pub struct BlobTreeBuilder {
    id: u32,
    pub(super) leaves: Vec<Leaf>,
    pub(super) bends: Vec<Bend>,
    pub(super) entries: Vec<Entry>,
    pub(super) parts: Vec<u32>,
    pub(super) operators: Vec<Operator>,
    pub(super) styles: Vec<Bounded>,
    pub(super) warps: Vec<Warp>,
}

impl Default for BlobTreeBuilder {
    /// A builder without nodes.
    fn default() -> Self {
        let id = BUILDERS.fetch_add(1, Ordering::Relaxed);
        let (leaves, bends, entries, parts) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (operators, styles, warps) = (Vec::new(), Vec::new(), Vec::new());
        Self { id, leaves, bends, entries, parts, operators, styles, warps }
    }
}

impl BlobTreeBuilder {
    /// With room for the skin of so many nodes: what grows is copied again and again.
    pub(super) fn for_skin(nodes: usize) -> Self {
        let mut builder = Self::default();
        // As many as spruces and maples have.
        builder.leaves.reserve(nodes + nodes / 2);
        builder.bends.reserve(nodes);
        builder.entries.reserve(2 * nodes + nodes / 2);
        builder.parts.reserve(2 * nodes);
        builder
    }

    /// A primitive.
    ///
    /// # Errors
    /// A coordinate beyond a million kilometres, a radius not from 1e-9 to 1e9 m, a field function, strength or colour out of
    /// its range.
    pub fn add(&mut self, primitive: Primitive) -> Result<Node, BlobError> {
        primitive.check()?;
        let number = self.leaves.len() as u32;
        let bend = if primitive.bend.is_some() { self.bends.len() as u32 } else { STRAIGHT };
        self.bends.extend(primitive.bend);
        let leaf = Leaf::new(&primitive, bend);
        self.leaves.push(leaf);
        self.push(Draft::Leaf(number), leaf.bounds(&self.bends), primitive.strength)
    }

    /// A curve: the union of the cone segments it is made of.
    ///
    /// # Errors
    /// No points, another number of radii, or what [`add`](Self::add) refuses.
    pub fn curve(&mut self, curve: &Curve) -> Result<Node, BlobError> {
        let primitives = curve.primitives()?;
        let mut nodes: Few<Node> = SmallVec::with_capacity(primitives.len());
        for primitive in primitives {
            nodes.push(self.add(primitive)?);
        }
        self.union(nodes)
    }

    /// The [sum](Operator::Sum) of parts.
    ///
    /// # Errors
    /// See [`combine`](Self::combine).
    pub fn sum(&mut self, parts: impl IntoIterator<Item = Node>) -> Result<Node, BlobError> {
        self.combine(Operator::Sum, parts)
    }

    /// The [super-elliptic blend](Operator::SuperElliptic) of parts.
    ///
    /// # Errors
    /// See [`combine`](Self::combine).
    pub fn super_elliptic(
        &mut self,
        power: f32,
        parts: impl IntoIterator<Item = Node>,
    ) -> Result<Node, BlobError> {
        self.combine(Operator::SuperElliptic(power), parts)
    }

    /// The [union](Operator::Union) of parts.
    ///
    /// # Errors
    /// See [`combine`](Self::combine).
    pub fn union(&mut self, parts: impl IntoIterator<Item = Node>) -> Result<Node, BlobError> {
        self.combine(Operator::Union, parts)
    }

    /// The [intersection](Operator::Intersection) of parts.
    ///
    /// # Errors
    /// See [`combine`](Self::combine).
    pub fn intersection(&mut self, parts: impl IntoIterator<Item = Node>) -> Result<Node, BlobError> {
        self.combine(Operator::Intersection, parts)
    }

    /// A part [without](Operator::Difference) another.
    ///
    /// # Errors
    /// See [`combine`](Self::combine).
    pub fn difference(&mut self, from: Node, other: Node) -> Result<Node, BlobError> {
        self.combine(Operator::Difference, [from, other])
    }

    /// Parts that [press on each other](Operator::Contact).
    ///
    /// # Errors
    /// See [`combine`](Self::combine).
    pub fn contact(
        &mut self,
        contact: Contact,
        parts: impl IntoIterator<Item = Node>,
    ) -> Result<Node, BlobError> {
        self.combine(Operator::Contact(contact), parts)
    }

    /// Any operator on parts. If their order does not matter and there are more than four, they are grouped
    /// by position.
    ///
    /// # Errors
    /// An operator's parameter out of its range; too few parts: none, or one where two are needed; a node of another
    /// builder.
    pub fn combine(
        &mut self,
        operator: Operator,
        parts: impl IntoIterator<Item = Node>,
    ) -> Result<Node, BlobError> {
        operator.check()?;
        let mut parts = self.take(operator, parts)?;
        let number = remember(&mut self.operators, operator);
        if operator.is_associative() && parts.len() > GROUP {
            self.group(number, &mut parts)
        } else {
            self.push_combined(number, &parts)
        }
    }

    /// Generalized bounded blending, equations 2 to 4: `F_b · B₁ + (1 - F_b) · B₂`, where both operators B get the same parts, and
    /// any field of at most 1 may be `F_b`.
    ///
    /// # Errors
    /// An operator's parameter out of its range; too few parts for one of them; a bounding field that may exceed 1; a
    /// node of another builder; a colour out of range.
    pub fn bounded(
        &mut self,
        parts: impl IntoIterator<Item = Node>,
        style: Bounded,
        field: Node,
    ) -> Result<Node, BlobError> {
        style.check()?;
        let mut parts = self.take(style.needy(), parts)?;
        let most = [style.inside, style.outside].map(|operator| self.most(operator, &parts));
        let bounds = style.bounds(&self.boxes(&parts));
        let field = self.take(Operator::Union, [field])?[0];
        let reaches = self.entries[field as usize].most;
        if reaches > 1.0 {
            return Err(BlobError::BoundingField { most: reaches });
        }
        parts.push(field);
        let style = remember(&mut self.styles, style);
        let parts = self.list(&parts);
        self.push(Draft::Bounded { style, parts }, bounds, most[0].max(most[1]))
    }

    /// A lateral on its parent branch: their axes blend within the field as the style says, if there is one,
    /// and as by the style's outer operator around it; all else that stands on both meets as by a union. Only
    /// this and [`finish`](Self::finish) may take the node that it returns.
    ///
    /// # Errors
    /// As of [`bounded`](Self::bounded), of parameters in range.
    pub(super) fn fork(
        &mut self,
        [parent, lateral]: [Node; 2],
        style: Bounded,
        field: Option<Node>,
    ) -> Result<Node, BlobError> {
        let mut parts = self.take(style.needy(), [parent, lateral])?;
        let values =
            |part: u32| if let Draft::Fork { .. } = self.entries[part as usize].draft { 2 } else { 1 };
        let (parent, lateral, is_bounded) = (values(parts[0]), values(parts[1]), field.is_some());
        let most = [style.inside, style.outside].map(|operator| self.most(operator, &parts));
        let bounds = style.bounds(&self.boxes(&parts));
        if let Some(field) = field {
            parts.extend(self.take(Operator::Union, [field])?);
        }
        let style = remember(&mut self.styles, style);
        let parts = self.list(&parts);
        let fork = Fork { style, parent, lateral, is_bounded };
        self.push(Draft::Fork { fork, parts }, bounds, most[0].max(most[1]))
    }

    /// A part moved, turned, scaled or sheared.
    ///
    /// # Errors
    /// A map that is not finite, or singular: its inverse does not exist, or stretches by more than 100,000 times its least
    /// stretch; a node of another builder.
    pub fn warp(&mut self, part: Node, map: Affine3A) -> Result<Node, BlobError> {
        let part = self.take(Operator::Union, [part])?[0];
        let warp = Warp::new(map).ok_or_else(|| BlobError::Singular { map: Box::new(map) })?;
        let Entry { bounds, most, .. } = self.entries[part as usize];
        let bounds = warp.forth(bounds);
        let number = self.warps.len() as u32;
        self.warps.push(warp);
        self.push(Draft::Warp { warp: number, part }, bounds, most)
    }

    /// The finished tree, of all that `root` is made of. O(n).
    ///
    /// # Errors
    /// A root whose field is nowhere 1/2, so that there is no surface; warps of warps that are
    /// [singular](Self::warp) together, or reach beyond four million kilometres; a node of another builder.
    pub fn finish(self, root: Node) -> Result<BlobTree, BlobError> {
        self.finish_watched(root, &Watch::silent())
    }

    /// As [`finish`](Self::finish), with one step per part.
    pub(super) fn finish_watched(mut self, root: Node, watch: &Watch<'_>) -> Result<BlobTree, BlobError> {
        let root = self.take(Operator::Union, [root])?[0];
        let Entry { bounds, most, .. } = self.entries[root as usize];
        if bounds.is_empty() || most < super::field::ISO {
            return Err(BlobError::Empty { most: if bounds.is_empty() { 0.0 } else { most } });
        }
        let origin = far::offset(bounds.center(), bounds);
        let tree = BlobTree::new(Scene::new(self, root, origin, watch)?, origin);
        let bounds = tree.bounds();
        if bounds.min.abs().max(bounds.max.abs()).max_element() > FARTHEST {
            return Err(BlobError::TooFar { bounds });
        }
        Ok(tree)
    }

    /// Marks nodes as used.
    fn take(&mut self, by: Operator, nodes: impl IntoIterator<Item = Node>) -> Result<Few<u32>, BlobError> {
        let mut numbers = Few::new();
        for Node { builder, number } in nodes {
            match self.entries.get_mut(number as usize) {
                Some(entry) if builder == self.id && !entry.taken => entry.taken = true,
                _ => return Err(BlobError::Stranger { node: number }),
            }
            numbers.push(number);
        }
        if numbers.len() < by.least_parts() {
            let (least, parts) = (by.least_parts(), numbers.len());
            return Err(BlobError::TooFewParts { operator: by.name(), least, parts });
        }
        Ok(numbers)
    }

    /// Near parts together, halving at the middle of the longest side: then a box holds little.
    fn group(&mut self, operator: u32, parts: &mut [u32]) -> Result<Node, BlobError> {
        if parts.len() <= GROUP {
            // Halving leaves open in which order they come.
            parts.sort_unstable();
            return self.push_combined(operator, parts);
        }
        let middle = |part: &u32| self.entries[*part as usize].bounds.center();
        let size = Bounds::of(parts.iter().map(middle)).size();
        let axis = if size.x >= size.max_element() {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let half = parts.len() / 2;
        parts.select_nth_unstable_by(half, |a, b| middle(a)[axis].total_cmp(&middle(b)[axis]).then(a.cmp(b)));
        let (before, after) = parts.split_at_mut(half);
        let halves = [self.group(operator, before)?.number, self.group(operator, after)?.number];
        self.push_combined(operator, &halves)
    }

    fn push_combined(&mut self, operator: u32, parts: &[u32]) -> Result<Node, BlobError> {
        if let ([part], true) = (parts, self.operators[operator as usize].ignores_nothing()) {
            self.entries[*part as usize].taken = false;
            return Ok(Node { builder: self.id, number: *part });
        }
        let operator_itself = self.operators[operator as usize];
        let (most, bounds) = (self.most(operator_itself, parts), operator_itself.bounds(&self.boxes(parts)));
        let parts = self.list(parts);
        self.push(Draft::Combine { operator, parts }, bounds, most)
    }

    /// The greatest value of parts together.
    fn most(&self, operator: Operator, parts: &[u32]) -> f32 {
        let most = parts.iter().map(|&part| self.entries[part as usize].most);
        let ranges: Few<Range> = most.map(|most| Range { least: 0.0, most, slope: 0.0 }).collect();
        operator.range(&ranges).most
    }

    fn boxes(&self, parts: &[u32]) -> Few<Bounds> {
        parts.iter().map(|&part| self.entries[part as usize].bounds).collect()
    }

    fn list(&mut self, parts: &[u32]) -> [u32; 2] {
        let start = self.parts.len() as u32;
        self.parts.extend(parts);
        [start, self.parts.len() as u32]
    }

    fn push(&mut self, draft: Draft, bounds: Bounds, most: f32) -> Result<Node, BlobError> {
        if self.entries.len() >= u32::MAX as usize / 4 {
            return Err(BlobError::TooLarge { nodes: self.entries.len() });
        }
        self.entries.push(Entry { draft, bounds, most, taken: false });
        Ok(Node { builder: self.id, number: self.entries.len() as u32 - 1 })
    }
}

/// The number of a value in a list, where it is one of the latest; added otherwise.
fn remember<T: PartialEq + Copy>(list: &mut Vec<T>, value: T) -> u32 {
    let latest = list.len().saturating_sub(8);
    let known = list[latest..].iter().rposition(|known| *known == value).map(|i| latest + i);
    known.unwrap_or_else(|| {
        list.push(value);
        list.len() - 1
    }) as u32
}

impl Draft {
    /// Its parts, in the order of evaluation.
    pub(super) fn parts<'a>(&'a self, lists: &'a [u32]) -> &'a [u32] {
        match self {
            Self::Leaf(_) => &[],
            Self::Combine { parts: [start, end], .. }
            | Self::Bounded { parts: [start, end], .. }
            | Self::Fork { parts: [start, end], .. } => &lists[*start as usize..*end as usize],
            Self::Warp { part, .. } => std::slice::from_ref(part),
        }
    }

    /// Operator that is evaluated after its parts; `None` for one that only moves its parts.
    pub(super) fn kind(&self, leaf: u32) -> Option<Kind> {
        match *self {
            Self::Leaf(_) => Some(Kind::Leaf(leaf)),
            Self::Combine { operator, parts: [start, end] } => {
                Some(Kind::Combine { operator, parts: end - start })
            }
            Self::Bounded { style, parts: [start, end] } => {
                Some(Kind::Bounded { style, parts: end - start - 1 })
            }
            Self::Fork { fork, .. } => Some(Kind::Fork(fork)),
            Self::Warp { .. } => None,
        }
    }
}
