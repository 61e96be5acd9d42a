//! A [`BlobTree`](super::BlobTree) in the order of evaluation: flat arrays, every part before what it is a part of.

use super::bend::Bend;
use super::bounded::Bounded;
use super::builder::{BlobTreeBuilder, Draft, Entry};
use super::error::BlobError;
use super::field::ISO;
use super::jet::Jet;
use super::limb::Fork;
use super::operator::{Operator, greatest};
use super::primitive::{Leaf, Range};
use crate::Bounds;
use crate::observer::Watch;
use crate::surface::implicit::span::{Passage, Span};
use glam::{Affine3A, Mat3A, Vec3};
use smallvec::SmallVec;

/// The greatest ratio of a warp's stretches.
const MOST_STRETCH: f32 = 1e5;

/// Parts put in order from one look at the watch to the next.
const STEPS: usize = 256;

/// One step of an evaluation, on a stack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// A part that is 0 everywhere.
    Nothing,
    /// A limb that is 0 everywhere, and all that stands on it.
    NoLimb,
    Leaf(u32),
    /// Takes as many parts off the stack.
    Combine {
        operator: u32,
        parts: u32,
    },
    /// Takes a bounding field off the stack, then as many parts.
    Bounded {
        style: u32,
        parts: u32,
    },
    /// Takes what it says off the stack, and puts the limb's own value there and the rest.
    Fork(Fork),
}

/// An affine map and its inverse.
#[derive(Debug, Clone, Copy)]
pub(super) struct Warp {
    forth: Affine3A,
    back: Affine3A,
    /// Upper bound of the stretch of the inverse.
    stretch: f32,
}

impl Warp {
    pub(super) const NONE: Self = Self { forth: Affine3A::IDENTITY, back: Affine3A::IDENTITY, stretch: 1.0 };

    /// `None` if the map is not finite, or cannot be inverted well enough.
    pub(super) fn new(forth: Affine3A) -> Option<Self> {
        let back = forth.inverse();
        let stretch = norm(back.matrix3);
        let holds = forth.is_finite() && back.is_finite() && norm(forth.matrix3) * stretch <= MOST_STRETCH;
        holds.then_some(Self { forth, back, stretch })
    }

    /// A box around the image of a box.
    pub(super) fn forth(&self, bounds: Bounds) -> Bounds {
        let image = Bounds::of(bounds.corners().map(|corner| self.forth.transform_point3(corner)));
        let rounding =
            [image.min, image.max, Vec3::from(self.forth.translation)].map(|v| v.abs().max_element());
        if bounds.is_empty() {
            Bounds::EMPTY
        } else {
            image.grown(rounding.into_iter().fold(0.0, f32::max) * 1e-5)
        }
    }
}

/// Upper bound of the stretch: the root of the greatest row sum of `AᵀA`, which is at least its greatest
/// eigenvalue.
fn norm(matrix: Mat3A) -> f32 {
    let square = matrix.transpose() * matrix;
    let row = |v: glam::Vec3A| v.abs().element_sum();
    (row(square.x_axis).max(row(square.y_axis)).max(row(square.z_axis))).sqrt() * 1.0001
}

/// All that is needed for evaluation.
#[derive(Debug)]
pub(super) struct Scene {
    pub(super) kinds: Vec<Kind>,
    /// Outside of its box a part is 0.
    pub(super) bounds: Vec<Bounds>,
    /// The first of the steps that make a part.
    pub(super) starts: Vec<u32>,
    pub(super) leaves: Vec<Leaf>,
    bends: Vec<Bend>,
    /// The operators of nodes, then both of each style.
    pub(super) operators: Vec<Operator>,
    first_of_styles: u32,
    pub(super) styles: Vec<Bounded>,
    warps: Vec<Warp>,
}

/// A node whose parts are being put in order.
struct Frame {
    node: u32,
    warp: u32,
    /// The number of its parts that are done.
    done: usize,
    start: u32,
}

impl Scene {
    /// The scene of all parts of `root`, moved so that `origin` is its origin.
    pub(super) fn new(
        mut drafts: BlobTreeBuilder,
        root: u32,
        origin: Vec3,
        watch: &Watch<'_>,
    ) -> Result<Self, BlobError> {
        let mut scene = Self {
            kinds: Vec::with_capacity(drafts.entries.len()),
            bounds: Vec::with_capacity(drafts.entries.len()),
            starts: Vec::with_capacity(drafts.entries.len()),
            leaves: Vec::with_capacity(drafts.leaves.len()),
            bends: std::mem::take(&mut drafts.bends),
            operators: drafts.operators.clone(),
            first_of_styles: drafts.operators.len() as u32,
            styles: drafts.styles.clone(),
            warps: vec![Warp::NONE],
        };
        scene.operators.extend(drafts.styles.iter().flat_map(|style| [style.inside, style.outside]));
        let mut frames = vec![Frame { node: root, warp: 0, done: 0, start: 0 }];
        // Where nothing is moved, boxes are those of the drafts.
        let is_moved = origin != Vec3::ZERO || !drafts.warps.is_empty();
        // Boxes of finished parts, if they are moved.
        let mut boxes: Vec<Bounds> = Vec::new();
        while let Some(frame) = frames.last_mut() {
            let Entry { draft, bounds, .. } = &drafts.entries[frame.node as usize];
            let parts = draft.parts(&drafts.parts);
            if let Some(&part) = parts.get(frame.done) {
                frame.done += 1;
                let mut warp = frame.warp;
                if let Draft::Warp { warp: own, .. } = draft {
                    warp = scene.warped(warp, &drafts.warps[*own as usize], origin)?;
                }
                let start = scene.kinds.len() as u32;
                frames.push(Frame { node: part, warp, done: 0, start });
                continue;
            }
            if scene.kinds.len().is_multiple_of(STEPS) {
                watch.pass(STEPS)?;
            }
            let leaf = scene.leaves.len() as u32;
            if let Some(kind) = draft.kind(leaf) {
                if let Draft::Leaf(number) = draft {
                    let offset = if frame.warp == 0 { origin } else { Vec3::ZERO };
                    scene.leaves.push(drafts.leaves[*number as usize].placed(offset, frame.warp));
                }
                let mut bounds = *bounds;
                if is_moved {
                    let own = boxes.len() - parts.len();
                    bounds = scene.moved(kind, &boxes[own..]);
                    boxes.truncate(own);
                    boxes.push(bounds);
                }
                scene.kinds.push(kind);
                scene.bounds.push(bounds);
                scene.starts.push(frame.start);
            }
            frames.pop();
        }
        Ok(scene)
    }

    fn warped(&mut self, around: u32, own: &Warp, origin: Vec3) -> Result<u32, BlobError> {
        let mut forth = self.warps[around as usize].forth * own.forth;
        if around == 0 {
            forth.translation -= glam::Vec3A::from(origin);
        }
        let warp = Warp::new(forth).ok_or_else(|| BlobError::Singular { map: Box::new(forth) })?;
        self.warps.push(warp);
        Ok(self.warps.len() as u32 - 1)
    }

    /// The operator where a style's bounding field is 1.
    pub(super) fn inside(&self, style: u32) -> u32 {
        self.first_of_styles + 2 * style
    }

    /// The operator where a style's bounding field is 0.
    pub(super) fn outside(&self, style: u32) -> u32 {
        self.inside(style) + 1
    }

    /// The box of a node by those of its parts.
    fn moved(&self, kind: Kind, parts: &[Bounds]) -> Bounds {
        match kind {
            Kind::Nothing | Kind::NoLimb => Bounds::EMPTY,
            Kind::Leaf(number) => {
                let leaf = &self.leaves[number as usize];
                let bounds = leaf.bounds(&self.bends);
                if leaf.warp == 0 { bounds } else { self.warps[leaf.warp as usize].forth(bounds) }
            }
            Kind::Combine { operator, .. } => self.operators[operator as usize].bounds(parts),
            Kind::Bounded { style, .. } => self.styles[style as usize].bounds(&parts[..parts.len() - 1]),
            Kind::Fork(fork) => self.styles[fork.style as usize].bounds(&parts[..2]),
        }
    }

    /// The steps that count where `counts` says so of their boxes, the last first.
    pub(super) fn backwards(&self, mut counts: impl FnMut(&Bounds) -> bool, mut step: impl FnMut(Kind)) {
        let mut i = self.kinds.len();
        while i > 0 {
            i -= 1;
            if counts(&self.bounds[i]) {
                step(self.kinds[i]);
            } else {
                step(if matches!(self.kinds[i], Kind::Fork(_)) { Kind::NoLimb } else { Kind::Nothing });
                i = self.starts[i] as usize;
            }
        }
    }

    /// The steps that count at a point, the last first.
    pub(super) fn near(&self, point: Vec3) -> SmallVec<[Kind; 64]> {
        let mut steps = SmallVec::new();
        self.backwards(|bounds| bounds.contains(point), |kind| steps.push(kind));
        steps
    }

    /// The field, from steps in their order.
    #[inline]
    fn run<J: Jet>(&self, steps: impl Iterator<Item = Kind>, leaf: impl Fn(&Leaf) -> J) -> J {
        let mut stack: SmallVec<[J; 24]> = SmallVec::new();
        for step in steps {
            let value = match step {
                Kind::Nothing => J::ZERO,
                Kind::Leaf(number) => leaf(&self.leaves[number as usize]),
                Kind::Combine { operator, parts } => {
                    let start = stack.len() - parts as usize;
                    let value = self.operators[operator as usize].combine(&stack[start..]);
                    stack.truncate(start);
                    value
                }
                Kind::Bounded { style, parts } => {
                    let field = stack.pop().unwrap_or(J::ZERO);
                    let start = stack.len() - parts as usize;
                    let value = self.styles[style as usize].combine(&stack[start..], field);
                    stack.truncate(start);
                    value
                }
                Kind::NoLimb => {
                    stack.push(J::ZERO);
                    J::ZERO
                }
                Kind::Fork(fork) => {
                    let start = stack.len() - fork.values();
                    let [own, rest] = fork.combine(&self.styles[fork.style as usize], &stack[start..]);
                    stack.truncate(start);
                    stack.push(own);
                    rest
                }
            };
            stack.push(value);
        }
        // A limb has two values.
        match stack[..] {
            [value] => value,
            _ => greatest(&stack),
        }
    }

    /// The value less 1/2.
    #[inline]
    pub(super) fn value(&self, steps: impl Iterator<Item = Kind>, point: Vec3) -> f32 {
        self.run(steps, |leaf| leaf.value(self.place(leaf, point), &self.bends)) - ISO
    }

    /// The value less 1/2, and the gradient.
    #[inline]
    pub(super) fn gradient(&self, steps: impl Iterator<Item = Kind>, point: Vec3) -> (f32, Vec3) {
        let (value, gradient) = self.run(steps, |leaf| {
            let (value, gradient) = leaf.gradient(self.place(leaf, point), &self.bends);
            if leaf.warp == 0 {
                return (value, gradient);
            }
            let back = self.warps[leaf.warp as usize].back.matrix3;
            (value, Vec3::from(back.transpose() * glam::Vec3A::from(gradient)))
        });
        // -0 and 0 are one.
        (value - ISO, gradient + Vec3::ZERO)
    }

    /// The colour.
    pub(super) fn color(&self, steps: impl Iterator<Item = Kind>, point: Vec3) -> [f32; 3] {
        let mut stack: SmallVec<[(f32, [f32; 3]); 24]> = SmallVec::new();
        for step in steps {
            let values =
                |stack: &[(f32, [f32; 3])]| stack.iter().map(|part| part.0).collect::<SmallVec<[f32; 8]>>();
            let felt = match step {
                Kind::Nothing => (0.0, [0.0; 3]),
                Kind::Leaf(number) => {
                    let leaf = &self.leaves[number as usize];
                    (leaf.value(self.place(leaf, point), &self.bends), leaf.color)
                }
                Kind::Combine { operator, parts } => {
                    let start = stack.len() - parts as usize;
                    let (operator, parts) = (self.operators[operator as usize], &stack[start..]);
                    let felt = (operator.combine(&values(parts)), operator.color(parts));
                    stack.truncate(start);
                    felt
                }
                Kind::Bounded { style, parts } => {
                    let field = stack.pop().map_or(0.0, |part| part.0);
                    let start = stack.len() - parts as usize;
                    let (style, parts) = (&self.styles[style as usize], &stack[start..]);
                    let felt = (style.combine(&values(parts), field), style.color_of(parts, field));
                    stack.truncate(start);
                    felt
                }
                Kind::NoLimb => {
                    stack.push((0.0, [0.0; 3]));
                    (0.0, [0.0; 3])
                }
                Kind::Fork(fork) => {
                    let start = stack.len() - fork.values();
                    let [own, rest] = fork.color(&self.styles[fork.style as usize], &stack[start..]);
                    stack.truncate(start);
                    stack.push(own);
                    rest
                }
            };
            // A part that is not felt has no colour either, whether its step is there or not.
            stack.push(if felt.0 > 0.0 { felt } else { (0.0, [0.0; 3]) });
        }
        let stronger =
            |best: (f32, [f32; 3]), part: (f32, [f32; 3])| if part.0 > best.0 { part } else { best };
        stack.into_iter().fold((0.0, [0.0; 3]), stronger).1
    }

    /// Bounds of a leaf's values within `reach` metres of a point, and the least radius there, metres.
    pub(super) fn range(&self, leaf: u32, point: Vec3, reach: f32) -> (Range, f32) {
        let leaf = &self.leaves[leaf as usize];
        if leaf.warp == 0 {
            return leaf.range(point, reach, &self.bends);
        }
        let warp = &self.warps[leaf.warp as usize];
        let rounding =
            1e-6 * (point.abs().max_element() * warp.stretch + warp.back.translation.abs().max_element());
        let (range, thin) = leaf.range(self.place(leaf, point), reach * warp.stretch + rounding, &self.bends);
        (Range { slope: range.slope * warp.stretch, ..range }, thin / warp.stretch)
    }

    /// Part of a passage where a leaf may be felt.
    #[cfg_attr(not(feature = "preview"), allow(dead_code, reason = "only rays ask"))]
    pub(super) fn span(&self, leaf: u32, passage: &Passage) -> Option<Span> {
        let leaf = &self.leaves[leaf as usize];
        if leaf.warp == 0 {
            return leaf.span(passage, &self.bends);
        }
        let back = self.warps[leaf.warp as usize].back;
        let (origin, way) = (back.transform_point3(passage.origin), back.transform_vector3(passage.way));
        leaf.span(&Passage { origin, way, ..*passage }, &self.bends)
    }

    /// A point in a leaf's own space.
    #[inline]
    fn place(&self, leaf: &Leaf, point: Vec3) -> Vec3 {
        if leaf.warp == 0 { point } else { self.warps[leaf.warp as usize].back.transform_point3(point) }
    }
}
