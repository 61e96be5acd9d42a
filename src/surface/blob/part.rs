//! The part of a [`BlobTree`] that counts within a cube.

use super::BlobTree;
use super::Operator::{Contact, Difference, Intersection, Pressed, Sum, SuperElliptic, Union};
use super::field::ISO;
use super::limb::Fork;
use super::primitive::Range;
use super::scene::{Kind, Scene};
use crate::Bounds;
use crate::surface::implicit::solid::{Coverage, Part, Solid};
use crate::surface::implicit::span::{Passage, Span, hull};
use glam::Vec3;
use smallvec::SmallVec;
use std::sync::Arc;

/// Factor on the size of the finest feature where parts press on each other.
const CREASE: f32 = 0.25;
/// A bounding field up to this makes no feature to speak of.
const FAINT: f32 = 0.05;

/// Part of a [`BlobTree`] that counts within a box: fast to evaluate at many points of it, and the same there to the bit.
///
/// Outside of the box its values mean nothing.
#[derive(Debug, Clone)]
pub struct BlobPart {
    scene: Arc<Scene>,
    origin: Vec3,
    steps: Box<[Kind]>,
    slope: f32,
    detail: f32,
}

impl BlobPart {
    /// As [`BlobTree::value`], at a point of the box.
    pub fn value(&self, point: Vec3) -> f32 {
        self.scene.value(self.steps.iter().copied(), point - self.origin)
    }

    /// As [`BlobTree::gradient`], at a point of the box.
    pub fn gradient(&self, point: Vec3) -> (f32, Vec3) {
        self.scene.gradient(self.steps.iter().copied(), point - self.origin)
    }

    /// As [`BlobTree::color`], at a point of the box.
    pub fn color(&self, point: Vec3) -> [f32; 3] {
        self.scene.color(self.steps.iter().copied(), point - self.origin)
    }

    /// The number of primitives and operators that count.
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// `true` if nothing counts: all values are -1/2.
    pub fn is_empty(&self) -> bool {
        matches!(*self.steps, [] | [Kind::Nothing | Kind::NoLimb])
    }

    /// No value in the box changes by more than this per metre.
    pub fn lipschitz(&self) -> f32 {
        self.slope
    }
}

impl Part for BlobPart {
    fn value(&self, point: Vec3) -> f32 {
        self.value(point)
    }

    fn gradient(&self, point: Vec3) -> (f32, Vec3) {
        self.gradient(point)
    }

    fn span(&self, passage: &Passage) -> Option<Span> {
        let passage = &Passage { origin: passage.origin - self.origin, ..*passage };
        // Nothing counts where only a bounding field is felt.
        let next = self.steps.iter().skip(1).map(Some).chain([None]);
        hull(self.steps.iter().zip(next).map(|step| match step {
            (Kind::Leaf(_), Some(Kind::Bounded { .. } | Kind::Fork(Fork { is_bounded: true, .. }))) => None,
            (Kind::Leaf(number), _) => self.scene.span(*number, passage),
            _ => None,
        }))
    }

    fn color(&self, point: Vec3) -> [f32; 3] {
        self.color(point)
    }

    fn detail(&self) -> f32 {
        self.detail
    }

    fn count(&self) -> usize {
        self.len()
    }

    fn lipschitz(&self) -> f32 {
        self.lipschitz()
    }
}

impl Solid for BlobTree {
    type Part = BlobPart;

    fn bounds(&self) -> Bounds {
        self.bounds()
    }

    fn part(&self, of: Option<&BlobPart>, cube: Bounds) -> Coverage<BlobPart> {
        let (part, range) = self.prune(of, cube);
        match range {
            Range { most, .. } if most < ISO => Coverage::Outside,
            Range { least, .. } if least > ISO => Coverage::Inside,
            _ => Coverage::Crossed(part),
        }
    }
}

/// Pruned form of a step.
#[derive(Debug, Clone, Copy)]
struct Fate {
    /// The first of the steps that make its part.
    start: u32,
    /// Range of its value; for a limb, that of its own value.
    range: Range,
    /// Range of all that stands on a limb; for other parts, nothing.
    rest: Range,
    /// The number of values that its replacement has.
    values: u8,
    detail: f32,
    /// Its replacement; `None` if its only part that counts does for it.
    step: Option<Kind>,
    /// `true` if the step that it is a part of needs it.
    needed: bool,
}

impl Fate {
    fn nothing(start: u32) -> Self {
        Self { detail: f32::INFINITY, ..Self::of(start, Range::NOTHING, Some(Kind::Nothing)) }
    }

    /// The fate of a part that is no limb.
    fn of(start: u32, range: Range, step: Option<Kind>) -> Self {
        let (rest, values, detail) = (Range::NOTHING, 1, 0.0);
        Self { start, range, rest, values, detail, step, needed: false }
    }

    fn is_nothing(&self) -> bool {
        self.range.is_nothing() && self.rest.is_nothing()
    }
}

impl BlobTree {
    /// Part that counts in a box, and the bounds of its values.
    pub(super) fn prune(&self, of: Option<&BlobPart>, cube: Bounds) -> (BlobPart, Range) {
        let (scene, origin) = (&self.scene, self.origin);
        let cube = Bounds::new(cube.min - origin, cube.max - origin);
        let mut gathered = Vec::new();
        let steps = of.map_or_else(
            || {
                scene.backwards(|bounds| !bounds.intersection(cube).is_empty(), |step| gathered.push(step));
                gathered.reverse();
                &gathered[..]
            },
            |part| &part.steps,
        );
        let (middle, half) = (cube.center(), cube.size() * 0.5);
        let ball = (middle, half.length() * 1.000_01);
        let mut fates: Vec<Fate> = Vec::with_capacity(steps.len());
        // The last steps of parts that wait.
        let mut waiting: Vec<u32> = Vec::new();
        for (i, &step) in steps.iter().enumerate() {
            let count = match step {
                Kind::Nothing | Kind::NoLimb | Kind::Leaf(_) => 0,
                Kind::Fork(fork) => fork.parts(),
                Kind::Combine { parts, .. } => parts as usize,
                Kind::Bounded { parts, .. } => parts as usize + 1,
            };
            let parts = waiting.len() - count;
            let start = waiting.get(parts).map_or(i as u32, |&first| fates[first as usize].start);
            let fate = match step {
                Kind::Nothing | Kind::NoLimb => Fate::nothing(start),
                Kind::Fork(fork) => scene.forked(fork, start, &waiting[parts..], &mut fates),
                Kind::Leaf(number) => {
                    let (range, detail) = scene.range(number, ball.0, ball.1);
                    if range.is_nothing() {
                        Fate::nothing(start)
                    } else {
                        Fate { detail, ..Fate::of(start, range, Some(step)) }
                    }
                }
                Kind::Combine { operator, .. } => {
                    scene.combined(operator, start, &waiting[parts..], &mut fates)
                }
                Kind::Bounded { style, .. } => scene.bounded(style, start, &waiting[parts..], &mut fates),
            };
            waiting.truncate(parts);
            waiting.push(i as u32);
            fates.push(fate);
        }
        let (range, detail) = fates.last().map_or((Range::NOTHING, f32::INFINITY), |fate| {
            let whole = if fate.values > 1 { Union.range(&[fate.range, fate.rest]) } else { fate.range };
            (whole, fate.detail)
        });
        let (scene, steps) = (scene.clone(), survivors(&mut fates));
        (BlobPart { scene, origin, steps, slope: range.slope, detail }, range)
    }
}

/// The steps that are needed, in their order.
fn survivors(fates: &mut [Fate]) -> Box<[Kind]> {
    let mut steps = Vec::new();
    if let Some(root) = fates.last_mut() {
        root.needed = true;
    }
    let mut i = fates.len();
    while i > 0 {
        i -= 1;
        let fate = fates[i];
        if fate.needed {
            steps.extend(fate.step);
        }
        if !fate.needed || fate.step == Some(Kind::Nothing) {
            i = fate.start as usize;
        }
    }
    steps.reverse();
    steps.into_boxed_slice()
}

impl Scene {
    /// Pruned form of an operator; marks the parts it needs.
    fn combined(&self, number: u32, start: u32, parts: &[u32], fates: &mut [Fate]) -> Fate {
        let operator = self.operators[number as usize];
        let ranges: SmallVec<[Range; 8]> = parts.iter().map(|&part| fates[part as usize].range).collect();
        let felt = |i: &usize| !ranges[*i].is_nothing();
        let all = || 0..parts.len();
        let best = |f: fn(&Range) -> f32, better: fn(f32, f32) -> f32| ranges.iter().map(f).reduce(better);
        let keep: SmallVec<[usize; 8]> = match operator {
            Sum | SuperElliptic(_) | Contact(_) => all().filter(felt).collect(),
            Union => {
                let least = best(|range| range.least, f32::max).unwrap_or_default();
                all().filter(|i| felt(i) && ranges[*i].most >= least).collect()
            }
            Intersection => {
                if !all().all(|i| felt(&i)) {
                    return Fate::nothing(start);
                }
                let most = best(|range| range.most, f32::min).unwrap_or_default();
                all().filter(|i| ranges[*i].least <= most).collect()
            }
            Difference if !felt(&0) => return Fate::nothing(start),
            Difference | Pressed(_) => all().filter(|i| *i == 0 || felt(i)).collect(),
        };
        if keep.is_empty() || !keep.iter().any(felt) {
            return Fate::nothing(start);
        }
        for &i in &keep {
            fates[parts[i] as usize].needed = true;
        }
        let kept: SmallVec<[Range; 8]> = keep.iter().map(|&i| ranges[i]).collect();
        let range = operator.range(&kept);
        let detail = keep.iter().map(|&i| fates[parts[i] as usize].detail).fold(f32::INFINITY, f32::min);
        // A difference cuts off what exceeds 1.
        let alone = keep.len() == 1 && (operator != Difference || kept[0].most <= 1.0);
        let parts = keep.len() as u32;
        let step = (!alone).then_some(Kind::Combine { operator: number, parts });
        let detail = if !alone && operator.is_contact() { detail * CREASE } else { detail };
        Fate { detail, ..Fate::of(start, range, step) }
    }

    /// Pruned form of a fork; marks the parts it needs.
    fn forked(&self, fork: Fork, start: u32, parts: &[u32], fates: &mut [Fate]) -> Fate {
        let mut numbers = parts.iter().map(|&part| part as usize);
        let mut next = |is_there: bool| if is_there { numbers.next() } else { None };
        let [parent, lateral, field] = [fork.parent > 0, fork.lateral > 0, fork.is_bounded].map(&mut next);
        let felt = |part: Option<usize>, fates: &[Fate]| part.filter(|&part| !fates[part].is_nothing());
        let (parent, lateral) = (felt(parent, fates), felt(lateral, fates));
        let Some(lateral) = lateral else {
            // The parent branch stays as it was.
            let Some(parent) = parent else { return Fate::nothing(start) };
            fates[parent].needed = true;
            return Fate { start, step: None, needed: false, ..fates[parent] };
        };
        let ranges = |part: usize| [fates[part].range, fates[part].rest];
        let [own, other] = [parent.map_or([Range::NOTHING; 2], ranges), ranges(lateral)];
        // Nothing blends where one of them is not felt.
        let blends = !own[0].is_nothing() && !other[0].is_nothing();
        let field = felt(field, fates).filter(|_| blends);
        let bounding = field.map_or(Range::NOTHING, |field| fates[field].range);
        let style = &self.styles[fork.style as usize];
        let rest = Fork::range(style, own, other, bounding);
        let limbs = || parent.into_iter().chain([lateral]);
        let detail = limbs().map(|part| fates[part].detail).fold(f32::INFINITY, f32::min);
        let creases = style.has_contact() && bounding.most > FAINT;
        let detail = if creases { detail * CREASE } else { detail };
        let fork = Fork {
            parent: parent.map_or(0, |part| fates[part].values),
            lateral: fates[lateral].values,
            is_bounded: field.is_some(),
            ..fork
        };
        for part in limbs().chain(field) {
            fates[part].needed = true;
        }
        let step = Some(Kind::Fork(fork));
        Fate { start, range: own[0], rest, values: 2, detail, step, needed: false }
    }

    /// Pruned form of a bounded blend; marks the parts it needs.
    fn bounded(&self, number: u32, start: u32, parts: &[u32], fates: &mut [Fate]) -> Fate {
        let style = &self.styles[number as usize];
        let (&field, parts) = parts.split_last().unwrap_or((&0, parts));
        let bounding = fates[field as usize].range;
        if bounding.is_nothing() {
            return self.combined(self.outside(number), start, parts, fates);
        }
        if bounding.least >= 1.0 && style.has_no_color() {
            return self.combined(self.inside(number), start, parts, fates);
        }
        let ignores = style.ignores_nothing();
        let ranges = parts.iter().map(|&part| fates[part as usize].range);
        let keep: SmallVec<[(u32, Range); 8]> =
            parts.iter().copied().zip(ranges).filter(|(_, range)| !ignores || !range.is_nothing()).collect();
        if keep.iter().all(|(_, range)| range.is_nothing()) && ignores {
            return Fate::nothing(start);
        }
        let detail = keep.iter().map(|(part, _)| fates[*part as usize].detail).fold(f32::INFINITY, f32::min);
        for (part, _) in &keep {
            fates[*part as usize].needed = true;
        }
        if let ([(_, range)], true) = (&keep[..], ignores) {
            return Fate { detail, ..Fate::of(start, *range, None) };
        }
        fates[field as usize].needed = true;
        let kept: SmallVec<[Range; 8]> = keep.iter().map(|(_, range)| *range).collect();
        let creases = style.has_contact() && bounding.most > FAINT;
        let step = Some(Kind::Bounded { style: number, parts: keep.len() as u32 });
        let detail = if creases { detail * CREASE } else { detail };
        Fate { detail, ..Fate::of(start, style.range(&kept, bounding), step) }
    }
}
