//! The skin of a tree: smooth along and between its branches, with scars and ridges that age.

use super::error::BlobError;
use super::field::{FieldFunction, ISO};
use super::{BARK, BlobTree, BlobTreeBuilder, Bounded, Contact, Curve, Node, Operator, Primitive};
use crate::observer::{Observer, Silent, Watch, Work};
use crate::skeleton::Branches;
use crate::surface::far;
use crate::{ParameterError, Skeleton};
use glam::Vec3;

/// A scar fainter than this is none.
const FAINTEST: f32 = 0.01;
/// The least sine of the angle between a lateral and its parent branch; smaller ones count as this.
const LEAST_SINE: f32 = 0.35;
/// Length of the trunk base to which the cut at the ground is applied, in its radii.
const STANDING: f32 = 3.0;
/// A trunk that rises by less than this per metre lies on the ground.
const LEAST_RISE: f32 = 0.5;
/// Radius of the ball that cuts off the trunk base, in radii of the base: the cut bends by a hundredth of a
/// radius.
const FLAT: f32 = 50.0;
/// Depth below its root at which a trunk is cut off, in radii, so that the root is within.
const SUNK: f32 = 0.02;
/// Farther out than this, in metres, no ball is put.
const FARTHEST: f32 = 1e8;
/// Greatest fall of fields half a radius wide where bark bulges, times that half.
const NARROW: f32 = 0.25;

/// The skin of a whole tree as a [`BlobTree`]: section 3.2 of Galbraith, Mündermann and Wyvill 2004.
///
/// Each year's shoot is a [`Curve`]; the shoots of an axis are joined end to end, and a lateral is summed to
/// its parent branch, so that all is smooth there: a lateral's field reaches as far as its parent branch's,
/// so that the fillet below it is as soft on one as on the other. No other branches are summed: those that
/// pass each other, and laterals of one parent branch, meet as by a [union](Operator::Union), with a crease
/// and without a bridge. Where two years' shoots meet, precise contact takes the place of that within a
/// bounding field: the ring of the bud scale scar, which fades as the junction ages. At the base of a lateral
/// there is contact too: at first around the whole base, the bud scale scar of the lateral; with age the
/// bounding field moves into the axil, where the contact stays as the branch bark ridge and the rest of the
/// base becomes smooth. Both are darkened as far as their bounding field is felt.
///
/// The trunk base is cut off level, 2% of its radius below the root, so that it stands on the ground; across, if the trunk rises less
/// than 30° there. Bends are smooth on their inner side too, unless an axis turns within less than about two of its radii: there cone
/// segments meet in creases of at most [`with_turn`](Self::with_turn).
///
/// The year in which a shoot grew is that of its nodes in [`Skeleton::stages`]; so any skeleton can wear it, and ages as its
/// synthesizer counts. Kinks of coarse skeletons are rounded; [`Skeleton::relaxed`] takes them out first.
///
/// ```
/// use treesynth::{Skeleton, glam::Vec3, surface::blob::Skin};
///
/// let fork = Skeleton::new(vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::new(1.0, 2.0, 0.0)], vec![None, Some(0), Some(1), Some(1)])?
///     .with_radii(vec![0.1, 0.09, 0.07, 0.05])?
///     .with_stages(vec![0, 0, 1, 1])?;
/// let bark = Skin::default().with_age(4.0).blob_tree(&fork)?;
/// assert!(bark.value(Vec3::Y * 0.5) > 0.0 && bark.value(Vec3::X) < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Skin {
    age: Option<f32>,
    blend: f32,
    turn: f32,
    bulge: f32,
    scars: f32,
    ridges: f32,
    scar_years: f32,
    ridge_years: f32,
    bark: [f32; 3],
    mark: [f32; 3],
}

crate::recipe::readable!(Skin {
    age: Option<f32>, blend: f32, turn: f32, bulge: f32, scars: f32, ridges: f32, scar_years: f32,
    ridge_years: f32, bark: [f32; 3], mark: [f32; 3],
});

impl Default for Skin {
    /// As old as the last stage and one year; blends 0.7 radii wide; scars and ridges of full strength, bulge 2; scars
    /// gone, ridges formed after 10 years (figure 7); grey brown bark, blackened where it meets.
    fn default() -> Self {
        let (age, blend, turn, bulge) = (None, 0.7, 0.1, 2.0);
        let (scars, ridges, scar_years, ridge_years) = (1.0, 1.0, 10.0, 10.0);
        Self {
            age,
            blend,
            turn,
            bulge,
            scars,
            ridges,
            scar_years,
            ridge_years,
            bark: BARK,
            mark: [0.012, 0.01, 0.008],
        }
    }
}

impl Skin {
    /// The age of the tree in years, 0 to 100,000; default the last stage and one. A junction is as old as the tree less the
    /// stage of its younger shoot, or 0. Trees of [`growth`](crate::growth) count their years from 1: pass their age and one.
    pub fn with_age(mut self, years: f32) -> Self {
        self.age = Some(years);
        self
    }

    /// Reach of fields beyond the surface, and so the width of fillets, in radii: 0.01 to 1; default 0.7. The
    /// field of a lateral reaches as far as that of its parent branch where it leaves it, but no farther than
    /// one radius of its own.
    pub fn with_blend(mut self, radii: f32) -> Self {
        self.blend = radii;
        self
    }

    /// The greatest turn of a surface between two cone segments, and a third of that of a piece that bends, radians, 0.01 to 3; default
    /// 0.1. A smaller one makes more primitives.
    pub fn with_turn(mut self, radians: f32) -> Self {
        self.turn = radians;
        self
    }

    /// Height of the bark ridge where barks meet, 0 to 3; default 2; see [`Contact::with_bulge`].
    pub fn with_bulge(mut self, bulge: f32) -> Self {
        self.bulge = bulge;
        self
    }

    /// The strength of bud scale scars along axes when they are a year old, 0 to 1; default 1.
    pub fn with_scars(mut self, strength: f32) -> Self {
        self.scars = strength;
        self
    }

    /// The strength of laterals' scars and bark ridges, 0 to 1; default 1.
    pub fn with_ridges(mut self, strength: f32) -> Self {
        self.ridges = strength;
        self
    }

    /// Years after which the scars of axes are gone, above 1, to 100,000; default 10.
    pub fn with_scar_years(mut self, years: f32) -> Self {
        self.scar_years = years;
        self
    }

    /// Years after which the scar of a lateral has become a ridge, above 0, to 100,000; default 10.
    pub fn with_ridge_years(mut self, years: f32) -> Self {
        self.ridge_years = years;
        self
    }

    /// The linear RGB colour of the bark, each 0 to 1; default a grey brown.
    pub fn with_bark(mut self, linear: [f32; 3]) -> Self {
        self.bark = linear;
        self
    }

    /// The linear RGB colour of scars and ridges, each 0 to 1; default nearly black.
    pub fn with_mark(mut self, linear: [f32; 3]) -> Self {
        self.mark = linear;
        self
    }

    fn check(&self) -> Result<(), ParameterError> {
        let age = self.age.unwrap_or_default();
        ParameterError::unless((0.0..=1e5).contains(&age), "Skin.age", age, "0 to 100,000 years")?;
        ParameterError::unless((0.01..=1.0).contains(&self.blend), "Skin.blend", self.blend, "0.01 to 1")?;
        ParameterError::unless((0.01..=3.0).contains(&self.turn), "Skin.turn", self.turn, "0.01 to 3")?;
        ParameterError::unless((0.0..=3.0).contains(&self.bulge), "Skin.bulge", self.bulge, "0 to 3")?;
        ParameterError::unless((0.0..=1.0).contains(&self.scars), "Skin.scars", self.scars, "0 to 1")?;
        ParameterError::unless((0.0..=1.0).contains(&self.ridges), "Skin.ridges", self.ridges, "0 to 1")?;
        let holds = self.scar_years > 1.0 && self.scar_years <= 1e5;
        ParameterError::unless(holds, "Skin.scar_years", self.scar_years, "above 1, to 100,000")?;
        let holds = self.ridge_years > 0.0 && self.ridge_years <= 1e5;
        ParameterError::unless(holds, "Skin.ridge_years", self.ridge_years, "above 0, to 100,000")?;
        for (name, color) in [("Skin.bark", self.bark), ("Skin.mark", self.mark)] {
            let holds = color.iter().all(|channel| (0.0..=1.0).contains(channel));
            ParameterError::unless(holds, name, color, "0 to 1 each")?;
        }
        Ok(())
    }

    /// The skin of a skeleton. O(n log n) in its nodes.
    ///
    /// # Errors
    /// An option out of its range; a node whose radius is 0 or above 1e9 m, or whose place is beyond a million
    /// kilometres. The root's radius may be 0.
    pub fn blob_tree(&self, skeleton: &Skeleton) -> Result<BlobTree, BlobError> {
        self.blob_tree_observed(skeleton, &Silent)
    }

    /// As [`blob_tree`](Self::blob_tree), reporting progress to `observer`, which can cancel the work.
    ///
    /// # Errors
    /// As [`blob_tree`](Self::blob_tree), and [`BlobError::Cancelled`].
    pub fn blob_tree_observed(
        &self,
        skeleton: &Skeleton,
        observer: &dyn Observer,
    ) -> Result<BlobTree, BlobError> {
        let watch = Watch::part(observer, Work::Surface, 0.0..0.8, skeleton.len(), 256);
        self.check()?;
        let root_alone = skeleton.segments() == 0;
        for (node, &radius) in skeleton.radii().iter().enumerate() {
            if !(1e-9..=1e9).contains(&radius) && (node > 0 || root_alone || radius > 0.0) {
                return Err(BlobError::Radius { node, radius });
            }
        }
        let offset = far::offset_of(skeleton);
        let skeleton = &*far::near(skeleton, offset);
        let last = skeleton.stages().iter().copied().max().unwrap_or_default();
        let age = self.age.unwrap_or(f32::from(last) + 1.0);
        let branches = skeleton.branches();
        let mut tailor =
            Tailor { skin: self, skeleton, age, builder: BlobTreeBuilder::for_skin(skeleton.len()) };
        let parents = parents(skeleton, &branches);
        // Parent branches come first, so backwards laterals are ready before they are needed.
        let mut done: Vec<Option<Node>> = branches.iter().map(|_| None).collect();
        let mut borne: Vec<Vec<u32>> = vec![Vec::new(); branches.len()];
        let all: Vec<_> = branches.iter().collect();
        let springs: Vec<Option<Spring>> = all
            .iter()
            .zip(&parents)
            .map(|(branch, parent)| {
                parent.map(|(parent, place)| tailor.spring(branch.nodes(), all[parent].nodes(), place))
            })
            .collect();
        for (number, branch) in all.iter().enumerate().rev() {
            watch.pass(branch.nodes().len())?;
            let mut node = tailor.axis(branch.nodes(), springs[number].as_ref())?;
            for &lateral in borne[number].iter().rev() {
                let Some(part) = done[lateral as usize].take() else { continue };
                let Some(spring) = &springs[lateral as usize] else { continue };
                node = tailor.fork(node, part, spring)?;
            }
            done[number] = Some(node);
            if let Some((parent, _)) = parents[number] {
                borne[parent].push(number as u32);
            }
        }
        match done.first_mut().and_then(Option::take) {
            Some(root) => {
                let watch =
                    Watch::part(observer, Work::Surface, 0.8..1.0, tailor.builder.entries.len(), 8192);
                let tree = tailor.builder.finish_watched(root, &watch)?.moved_to(offset);
                watch.finish()?;
                Ok(tree)
            }
            None => Err(BlobError::Empty { most: 0.0 }),
        }
    }
}

/// The parent branch of each branch, and the place on its axis, in nodes; `None` for the trunk.
fn parents(skeleton: &Skeleton, branches: &Branches) -> Vec<Option<(usize, usize)>> {
    let mut home = vec![(0, 0); skeleton.len()];
    for (number, branch) in branches.iter().enumerate() {
        let own = usize::from(number > 0);
        for (place, &node) in branch.nodes().iter().enumerate().skip(own) {
            home[node as usize] = (number, place);
        }
    }
    let parent = |(number, branch): (usize, crate::skeleton::Branch<'_>)| {
        (number > 0).then(|| home[branch.nodes()[0] as usize])
    };
    branches.iter().enumerate().map(parent).collect()
}

/// Place and direction in which a lateral leaves its parent branch.
struct Spring {
    /// The position of the node on the parent branch's axis, and the lateral's first node of its own.
    start: Vec3,
    first: u32,
    /// The radii of the parent branch and the lateral there.
    thick: f32,
    own: f32,
    /// The ways of both axes, and the sine and cosine of the angle between them; the sine is at least
    /// [`LEAST_SINE`].
    along: Vec3,
    out: Vec3,
    sine: f32,
    cosine: f32,
}

/// Makes the parts of one skin.
struct Tailor<'a> {
    skin: &'a Skin,
    skeleton: &'a Skeleton,
    age: f32,
    builder: BlobTreeBuilder,
}

impl Tailor<'_> {
    fn position(&self, node: u32) -> Vec3 {
        self.skeleton.positions()[node as usize]
    }

    fn radius(&self, node: u32) -> f32 {
        self.skeleton.radii()[node as usize]
    }

    /// The age of a node's shoot, years.
    fn age_of(&self, node: u32) -> f32 {
        (self.age - f32::from(self.skeleton.stages()[node as usize])).max(0.0)
    }

    /// The spring of a lateral of these `nodes` on the node at `place` of its parent branch's `axis`.
    fn spring(&self, nodes: &[u32], axis: &[u32], place: usize) -> Spring {
        let (at, first) = (nodes[0], nodes[1]);
        let (start, own) = (self.position(at), self.radius(first));
        let thick = if self.radius(at) > 0.0 { self.radius(at) } else { own };
        let out = (self.position(first) - start).normalize_or(Vec3::Y);
        let along = self.direction(axis, place).unwrap_or(out);
        let cosine = along.dot(out);
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt().max(LEAST_SINE);
        Spring { start, first, thick, own, along, out, sine, cosine }
    }

    /// The shoots of an axis, end to end, with a scar between any two; `None` springs from nothing: the trunk.
    fn axis(&mut self, nodes: &[u32], spring: Option<&Spring>) -> Result<Node, BlobError> {
        let stage = |i: usize| self.skeleton.stages()[nodes[i] as usize];
        // The first node belongs to the parent branch, with its radius.
        let own = spring.is_none() && (nodes.len() == 1 || self.radius(nodes[0]) > 0.0);
        let first = if own { nodes[0] } else { nodes[1] };
        let radius = |i: usize| self.radius(if i == 0 { first } else { nodes[i] });
        let ways: Vec<Vec3> =
            nodes.windows(2).map(|pair| self.position(pair[1]) - self.position(pair[0])).collect();
        let ends: Vec<usize> =
            (1..nodes.len().saturating_sub(1)).filter(|&i| stage(i) != stage(i + 1)).collect();
        let starts = std::iter::once(0).chain(ends.iter().copied());
        let stops = ends.iter().copied().chain([nodes.len() - 1]);
        let tangent = |i: usize| {
            let [before, after] = [ways[i - 1], ways[i]].map(Vec3::normalize_or_zero);
            (before + after).try_normalize()
        };
        let joint = |i: usize| (i > 0 && i + 1 < nodes.len()).then(|| tangent(i)).flatten();
        let width = spring.map_or(self.skin.blend, |spring| spring.width(self.skin.blend));
        let place = |i: usize| {
            let shift =
                spring.filter(|_| i == 0).map(|spring| ways[0] * spring.shift(width, ways[0].length()));
            self.position(nodes[i]) + shift.unwrap_or_default()
        };
        let mut curves = Vec::with_capacity(ends.len() + 1);
        for (start, stop) in starts.zip(stops) {
            let points = (start..=stop).map(place).collect();
            let curve = Curve::new(points, (start..=stop).map(radius).collect())
                .with_tangents(joint(start), joint(stop))
                .with_turn(self.skin.turn)
                .with_field(FieldFunction::Smooth { width })
                .with_color(self.skin.bark);
            curves.push(curve);
        }
        let mut joints: Vec<u32> = ends.iter().map(|&i| nodes[i]).collect();
        let mut ages: Vec<f32> = ends.iter().map(|&i| self.age_of(nodes[i + 1])).collect();
        let mut shoots = Vec::with_capacity(curves.len());
        let base = radius(0);
        let mut standing = if spring.is_none() && nodes.len() > 1 { STANDING * base } else { 0.0 };
        for curve in &curves {
            shoots.push(if standing > 0.0 {
                self.standing(curve, [self.position(nodes[0]), ways[0]], base, &mut standing)?
            } else {
                self.builder.curve(curve)?
            });
        }
        // In pairs, then pairs of pairs, so that boxes stay small.
        while shoots.len() > 1 {
            let count = shoots.len();
            let mut rest = std::mem::take(&mut shoots).into_iter();
            let mut at = 0;
            while let Some(shoot) = rest.next() {
                let pair = match rest.next() {
                    Some(next) => self.scar(shoot, next, joints[at], ages[at])?,
                    None => shoot,
                };
                shoots.push(pair);
                at += 2;
            }
            // Every second junction is between pairs.
            let left = |i: &usize| i % 2 == 1;
            joints = (0..count - 1).filter(left).map(|i| joints[i]).collect();
            ages = (0..count - 1).filter(left).map(|i| ages[i]).collect();
        }
        shoots.pop().ok_or(BlobError::Empty { most: 0.0 })
    }

    /// A shoot of the trunk whose first `metres` metres stand on the ground: they are cut off there, by a
    /// ball so large that its surface is flat as far as they reach. Subtracts from `metres` the length of
    /// this shoot.
    fn standing(
        &mut self,
        curve: &Curve,
        [start, way]: [Vec3; 2],
        radius: f32,
        metres: &mut f32,
    ) -> Result<Node, BlobError> {
        let (mut below, mut above) = (Vec::new(), Vec::new());
        for cone in curve.primitives()? {
            let part = *metres / cone.length();
            let [low, high] = if part < 1.0 { cone.halves(part) } else { [cone; 2] };
            if *metres > 0.0 {
                below.push(self.builder.add(low)?);
            }
            if part < 1.0 {
                above.push(self.builder.add(high)?);
            }
            *metres = (*metres - cone.length()).max(0.0);
        }
        let (ball, along) = (FLAT * radius, way.normalize_or(Vec3::Y));
        // A trunk that lies on the ground has its end cut off across.
        let up = if along.y >= LEAST_RISE { Vec3::Y } else { along };
        let mut parts = Vec::new();
        if !below.is_empty() {
            let mut solid = self.builder.union(below)?;
            if start.abs().max_element() + 2.0 * ball <= FARTHEST {
                let ground = Primitive::point(start + up * (ball - SUNK * radius), ball)
                    .with_field(FieldFunction::Smooth { width: 1.0 / FLAT })
                    .with_color(self.skin.bark);
                let ground = self.builder.add(ground)?;
                solid = self.builder.intersection([solid, ground])?;
            }
            parts.push(solid);
        }
        if !above.is_empty() {
            parts.push(self.builder.union(above)?);
        }
        self.builder.union(parts)
    }

    /// Two shoots of an axis with a bud scale scar between them.
    fn scar(&mut self, shoot: Node, next: Node, joint: u32, age: f32) -> Result<Node, BlobError> {
        let skin = self.skin;
        let strength = skin.scars * (1.0 - smooth((age - 1.0) / (skin.scar_years - 1.0)));
        if strength < FAINTEST {
            return self.builder.union([shoot, next]);
        }
        let bounding = Primitive::point(self.position(joint), self.radius(joint) * 1.6)
            .with_field(FieldFunction::Bounding { inner: 0.66 })
            .with_strength(strength);
        let field = self.builder.add(bounding)?;
        let style = Bounded::new(self.pressed(), Operator::Union).with_color(skin.mark);
        self.builder.bounded([shoot, next], style, field)
    }

    /// A lateral on its parent branch, with a scar around its base or a ridge in its axil.
    fn fork(&mut self, parent: Node, lateral: Node, spring: &Spring) -> Result<Node, BlobError> {
        let skin = self.skin;
        if skin.ridges < FAINTEST {
            return self.builder.fork([parent, lateral], Bounded::new(Operator::Sum, Operator::Sum), None);
        }
        let &Spring { start, first, thick, own, along, out, sine, cosine } = spring;
        // The points at which the lateral's axis and its upper side leave the parent branch.
        let upper = (along - out * cosine).normalize_or(along);
        let base = start + out * (thick / sine);
        let axil = start + out * ((thick + own * cosine.max(0.0)) / sine) + upper * own;
        let old = smooth(self.age_of(first) / skin.ridge_years);
        let lerp = |young: f32, aged: f32| young + (aged - young) * old;
        let bounding = Primitive::point(base.lerp(axil, old), own * lerp(1.7 / sine, 2.6))
            .with_field(FieldFunction::Bounding { inner: lerp(0.7, 0.4) })
            .with_strength(skin.ridges);
        let field = self.builder.add(bounding)?;
        let style = Bounded::new(self.pressed(), Operator::Sum).with_color(skin.mark);
        self.builder.fork([parent, lateral], style, Some(field))
    }

    /// Direction in which an axis goes on at its i-th node, or comes from at its tip.
    fn direction(&self, axis: &[u32], i: usize) -> Option<Vec3> {
        let [from, to] = [axis[i.saturating_sub(1)], axis[(i + 1).min(axis.len() - 1)]];
        (self.position(to) - self.position(from)).try_normalize()
    }

    fn pressed(&self) -> Operator {
        // Fields that reach farther are flatter; a smaller reach keeps bulges as wide and high as ever.
        let reach = (NARROW / self.skin.blend).min(ISO);
        Operator::Contact(Contact::default().with_reach(reach).with_bulge(self.skin.bulge))
    }
}

impl Spring {
    /// The width of the lateral's field, in its radii: in metres it is that of its parent branch, so that
    /// neither end of the fillet is much sharper than the other.
    fn width(&self, blend: f32) -> f32 {
        (blend * self.thick / self.own).clamp(blend, 1.0)
    }

    /// Place from which on the lateral is needed, as a share of its first `length` metres: its round end
    /// stays within the parent branch, and is not felt on the far side of that, if possible.
    fn shift(&self, width: f32, length: f32) -> f32 {
        let beyond = (self.own * (1.0 + width) - self.thick).min(self.thick - self.own).max(0.0);
        (beyond / (self.sine * length).max(f32::MIN_POSITIVE)).min(0.75)
    }
}

/// Smooth step: goes from 0 to 1 as t does, with slope 0 at both ends.
pub(super) fn smooth(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
