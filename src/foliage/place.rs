//! Placement of leaves along every branch, from its tip backwards.

use super::{Foliage, FoliageError, MOST_LEAVES};
use crate::Skeleton;
use crate::math::{self, UP, parallel_transport, perpendicular};
use crate::observer::Watch;
use crate::random::{self, Purpose};
use crate::surface::{Instance, is_far, step};
use glam::{Mat3, Quat, Vec3};
use std::f32::consts::TAU;

/// Least length of a leaf in steps of 32-bit floats, so that it keeps its shape where it is copied to its
/// place.
const LEAST: f32 = 8.0;

/// Leaves placed from one report to the next.
pub(super) const STEPS: usize = 1 << 12;

/// Uses of a leaf's random numbers; the stages of its streams.
#[derive(Debug, Clone, Copy)]
enum Draw {
    Kept,
    Azimuth,
    Angle,
    Turn,
    Lean,
    Size,
    Brightness,
    Hue,
}

pub(super) fn place(
    foliage: &Foliage,
    skeleton: &Skeleton,
    seed: u64,
    watch: &Watch<'_>,
) -> Result<Vec<Instance>, FoliageError> {
    if skeleton.segments() > 0 && skeleton.radii().iter().all(|&radius| radius == 0.0) {
        return Err(FoliageError::NoRadii { nodes: skeleton.len() });
    }
    let farthest = farthest_tips(skeleton);
    let branches = skeleton.branches();
    let mut twigs = Vec::with_capacity(branches.len());
    let mut expected = 0.0;
    for (number, branch) in branches.iter().enumerate() {
        watch.pass(branch.nodes().len() / 4)?;
        if let Some(twig) = Twig::new(foliage, skeleton, &farthest, branch.nodes(), number as u32) {
            expected += twig.most_leaves();
            twigs.push(twig);
        }
    }
    if expected > MOST_LEAVES {
        return Err(FoliageError::TooMany { leaves: expected });
    }
    let mut leaves = Vec::with_capacity((expected * f64::from(foliage.kept)) as usize);
    for twig in &twigs {
        twig.place(seed, &mut leaves, watch);
    }
    watch.pass(0)?;
    if is_far(skeleton) {
        let size = foliage.leaf.mesh().bounds().map_or(0.0, |bounds| bounds.size().max_element());
        let shapeless = |leaf: &&Instance| leaf.scale * size < LEAST * step(leaf.position);
        if let Some(&Instance { position, scale, .. }) = leaves.iter().find(shapeless) {
            return Err(FoliageError::Shapeless { position, step: step(position), length: scale * size });
        }
    }
    Ok(leaves)
}

/// Distance from each node to the farthest tip it bears, metres along the branches.
fn farthest_tips(skeleton: &Skeleton) -> Vec<f32> {
    let mut farthest = vec![0.0f32; skeleton.len()];
    let positions = skeleton.positions();
    for (node, parent) in skeleton.edges().rev() {
        farthest[parent] = farthest[parent].max(farthest[node] + positions[node].distance(positions[parent]));
    }
    farthest
}

/// The part of a branch that may have leaves: it ends at the tip.
struct Twig<'a> {
    foliage: &'a Foliage,
    skeleton: &'a Skeleton,
    farthest: &'a [f32],
    nodes: &'a [u32],
    number: u32,
    /// Length of branch that bears leaves, from its tip, metres.
    leafy: f32,
    size: f32,
}

impl<'a> Twig<'a> {
    /// `None` if there is no room for leaves. Leaves stand where the branch is thin enough, near enough to
    /// the tips it bears, and outside of its parent branch.
    fn new(
        foliage: &'a Foliage,
        skeleton: &'a Skeleton,
        farthest: &'a [f32],
        nodes: &'a [u32],
        number: u32,
    ) -> Option<Self> {
        let none = f32::NEG_INFINITY;
        let mut twig = Self { foliage, skeleton, farthest, nodes, number, leafy: none, size: 0.0 };
        let (mut from_tip, mut goes_on) = (0.0, true);
        for i in (1..nodes.len()).rev() {
            let internode = twig.internode(i);
            if let Some(room) = twig.room(&internode).filter(|_| goes_on) {
                twig.leafy = from_tip + room;
                goes_on = room >= internode.length;
            } else {
                goes_on = false;
            }
            from_tip += internode.length;
        }
        if number > 0 {
            let buried = skeleton.radii()[nodes[0] as usize];
            twig.leafy = twig.leafy.min(from_tip - buried);
        }
        let order = skeleton.orders()[*nodes.get(1)? as usize];
        twig.size = foliage.size * math::powf(foliage.size_by_order, f32::from(order));
        (twig.leafy >= 0.0).then_some(twig)
    }

    /// The internode that ends at the branch's node `i`, from 1 on.
    fn internode(&self, i: usize) -> Internode {
        let (positions, radii) = (self.skeleton.positions(), self.skeleton.radii());
        let [from, to] = [self.nodes[i - 1], self.nodes[i]].map(|node| node as usize);
        // As the surface has it: a branch starts with the radius of its first internode, the trunk with that
        // of its base.
        let start = if i > 1 || self.number == 0 { radii[from] } else { radii[to] };
        let way = positions[to] - positions[from];
        Internode {
            node: self.nodes[i],
            tip: positions[to],
            length: way.length(),
            direction: way.normalize_or_zero(),
            radii: [start, radii[to]],
            farthest: self.farthest[to],
        }
    }

    /// Length of an internode that bears leaves, from its upper end; metres.
    fn room(&self, internode: &Internode) -> Option<f32> {
        let near = self.foliage.reach - internode.farthest;
        let [below, above] = internode.radii;
        let thickest = self.foliage.thickest;
        let thin = if below <= thickest {
            internode.length
        } else {
            internode.length * (thickest - above) / (below - above)
        };
        (near >= 0.0 && above <= thickest).then(|| near.min(thin).min(internode.length))
    }

    fn most_leaves(&self) -> f64 {
        let whorls = (f64::from(self.leafy) / f64::from(self.foliage.spacing)).floor() + 1.0;
        whorls * f64::from(self.foliage.arrangement.per_whorl())
    }

    fn place(&self, seed: u64, leaves: &mut Vec<Instance>, watch: &Watch<'_>) {
        let Foliage { arrangement, spacing, .. } = *self.foliage;
        let first = self.unit(seed, Draw::Azimuth, u32::MAX) * TAU;
        // The normal that azimuths count from is carried along, so that leaves do not wind about the twig with its
        // bends; a flat twig's lies level.
        let mut frame: Option<(Vec3, Vec3)> = None;
        let mut whorl = 0;
        let mut from_tip = 0.0;
        for i in (1..self.nodes.len()).rev() {
            let internode = self.internode(i);
            if internode.length == 0.0 || internode.direction == Vec3::ZERO {
                continue;
            }
            let along = internode.direction;
            let normal = match frame {
                Some((before, normal)) => parallel_transport(before, along, normal),
                None => along.cross(UP).try_normalize().unwrap_or_else(|| perpendicular(along)),
            };
            frame = Some((along, normal));
            let side = along.cross(normal);
            loop {
                let distance = whorl as f32 * spacing;
                if distance > self.leafy || !watch.steps(arrangement.per_whorl() as usize) {
                    return;
                }
                if distance > from_tip + internode.length {
                    break;
                }
                let back = (distance - from_tip).max(0.0);
                let radius = internode.radius(back);
                for leaf in 0..arrangement.per_whorl() {
                    let number = whorl * arrangement.per_whorl() + leaf;
                    if self.unit(seed, Draw::Kept, number) >= self.foliage.kept {
                        continue;
                    }
                    let off = self.disorder(seed, Draw::Azimuth, number);
                    let start = if arrangement.is_flat() { 0.0 } else { first };
                    let (sin, cos) = math::sin_cos(start + arrangement.azimuth(whorl, leaf) + off);
                    let outward = normal * cos + side * sin;
                    leaves.push(Instance {
                        position: internode.tip - along * back + outward * radius,
                        rotation: self.rotation(seed, number, along, outward),
                        scale: self.scale(seed, number, distance),
                        node: internode.node,
                        tint: self.tint(seed, number),
                    });
                }
                whorl += 1;
            }
            from_tip += internode.length;
        }
    }

    /// Y to the direction the leaf grows in, Z to where its upper side looks.
    fn rotation(&self, seed: u64, number: u32, along: Vec3, outward: Vec3) -> Quat {
        let Foliage { angle, rise, light, turn, .. } = *self.foliage;
        let (sin, cos) = math::sin_cos(angle + self.disorder(seed, Draw::Angle, number));
        let grown = along * cos + outward * sin;
        let midrib = (grown + UP * rise).normalize_or(grown);
        // The upper side is the one that lay against the bud above.
        let adaxial = along * sin - outward * cos;
        let towards = adaxial.lerp(light.normalize_or(UP), turn)
            + along.cross(outward) * self.disorder(seed, Draw::Turn, number)
            + outward * self.disorder(seed, Draw::Lean, number);
        // The part of a vector along the midrib is rounding.
        let upper = |v: Vec3| {
            let across = v - midrib * v.dot(midrib);
            (across.length_squared() > 1e-6 * v.length_squared()).then(|| across.normalize())
        };
        let normal = upper(towards).or_else(|| upper(adaxial)).unwrap_or_else(|| perpendicular(midrib));
        math::unit_rotation(Quat::from_mat3(&Mat3::from_cols(midrib.cross(normal), midrib, normal)))
    }

    fn scale(&self, seed: u64, number: u32, from_tip: f32) -> f32 {
        let Foliage { size_at_tip, size_variation, .. } = *self.foliage;
        let t = if self.leafy > 0.0 { (from_tip / self.leafy).min(1.0) } else { 0.0 };
        let variation = 1.0 + size_variation * (2.0 * self.unit(seed, Draw::Size, number) - 1.0);
        (self.size * (size_at_tip + (1.0 - size_at_tip) * t) * variation).clamp(1e-30, 1e30)
    }

    /// Darker than the others by chance, and yellower or bluer.
    fn tint(&self, seed: u64, number: u32) -> [f32; 3] {
        let spread = self.foliage.tint_variation;
        if spread == 0.0 {
            return [1.0; 3];
        }
        let light = 1.0 - spread * self.unit(seed, Draw::Brightness, number);
        let hue = (2.0 * self.unit(seed, Draw::Hue, number) - 1.0) * spread / 3.0;
        [light * (1.0 - hue.max(0.0)), light, light * (1.0 + hue.min(0.0))]
    }

    fn disorder(&self, seed: u64, draw: Draw, number: u32) -> f32 {
        self.foliage.disorder * (2.0 * self.unit(seed, draw, number) - 1.0)
    }

    /// A random number of a leaf, in [0, 1).
    fn unit(&self, seed: u64, draw: Draw, number: u32) -> f32 {
        let index = u64::from(self.number) << 32 | u64::from(number);
        random::unit(seed, draw as u32, Purpose::LEAVES, index)
    }
}

/// The way from one node of a branch to the next.
struct Internode {
    node: u32,
    tip: Vec3,
    length: f32,
    direction: Vec3,
    /// Radii at its lower and at its upper end, metres.
    radii: [f32; 2],
    farthest: f32,
}

impl Internode {
    /// The radius `back` metres below its upper end.
    fn radius(&self, back: f32) -> f32 {
        let [below, above] = self.radii;
        above + (below - above) * (back / self.length).min(1.0)
    }
}
