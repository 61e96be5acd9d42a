//! Few bones that bend as a tree does: for programs that know no wind.

use super::Mesh;
use super::sway::Sway;
use super::wind::Air;
use crate::Skeleton;
use crate::math::{self, UP, sin_cos};
use glam::{Quat, Vec3, Vec4};

/// Greatest number of bones of the trunk, without the one that stands still.
const TRUNK: usize = 4;
/// The part of a branch that bends, and where in it its joint is.
const BENDS: f32 = 0.5;
/// Bones that can move a vertex.
const MOST: usize = 4;

/// Bones by their number, and how much each counts.
type Weights = [(u16, f32); MOST];

/// Joint of a bone.
#[derive(Debug, Clone)]
pub(crate) struct Joint {
    pub(crate) position: Vec3,
    pub(crate) parent: Option<u16>,
    level: usize,
    axis: Vec3,
    /// Angle by which it turns, radians at the strongest gust.
    angle: f32,
}

/// Bones of a skeleton: the trunk has up to five, the largest limbs and twigs one each, and smaller branches
/// move with their parent branch.
///
/// At its base a branch has the weights of its parent branch, and its own bone takes over in its lower half;
/// so the motion is continuous at every junction.
#[derive(Debug)]
pub(crate) struct Rig {
    /// Parents first; the first does not move.
    pub(crate) joints: Vec<Joint>,
    /// Weights of each node.
    weights: Vec<Weights>,
    ends: Vec<Vec3>,
    parents: Vec<u32>,
}

impl Rig {
    /// A rig of at most `most` bones, at least two. O(n + branches · log branches).
    pub(crate) fn of(skeleton: &Skeleton, sway: &Sway, most: usize) -> Self {
        let positions = skeleton.positions();
        let parents: Vec<u32> =
            (0..skeleton.len()).map(|node| skeleton.parent(node).unwrap_or(0) as u32).collect();
        let mut borne = vec![0.0f32; skeleton.len()];
        for (node, parent) in skeleton.edges().rev() {
            borne[node] += positions[node].distance(positions[parent]);
            borne[parent] += borne[node];
        }
        let branches = skeleton.branches();
        let sizes = branches.iter().enumerate().skip(1).filter(|(_, branch)| branch.order() <= 2);
        let size = |nodes: &[u32]| nodes.get(1).map_or(0.0, |&first| borne[first as usize]);
        let mut largest: Vec<(f32, usize)> = sizes.map(|(i, branch)| (size(branch.nodes()), i)).collect();
        largest.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let zones = TRUNK.min(most - 1);
        let mut has_bone = vec![false; branches.len()];
        largest.iter().take(most - 1 - zones).for_each(|&(_, branch)| has_bone[branch] = true);

        let still = Joint { position: positions[0], parent: None, level: 0, axis: UP, angle: 0.0 };
        let none: Weights = [(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)];
        let mut rig = Self {
            joints: vec![still],
            weights: vec![none; skeleton.len()],
            ends: positions.to_vec(),
            parents,
        };
        for (number, branch) in branches.iter().enumerate() {
            let nodes = branch.nodes();
            let lengths = lengths(positions, nodes);
            let whole = lengths[lengths.len() - 1];
            if number == 0 {
                if whole > 0.0 {
                    rig.trunk(sway, nodes, &lengths, zones);
                }
                continue;
            }
            let base = rig.weights[nodes[0] as usize];
            let within = skeleton.radii()[nodes[0] as usize].min(0.5 * whole);
            let bends = (whole - within) * BENDS;
            if !(has_bone[number] && bends > 0.0) {
                nodes[1..].iter().for_each(|&node| rig.weights[node as usize] = base);
                continue;
            }
            let level = branch.order().min(2) as usize;
            let tip = nodes[nodes.len() - 1];
            let heaviest = base.iter().fold(base[0], |best, &bone| if bone.1 > best.1 { bone } else { best });
            let bone = rig.joints.len() as u16;
            rig.joints.push(Joint {
                position: along(positions, nodes, &lengths, within + 0.5 * bends),
                parent: Some(heaviest.0),
                level,
                axis: sway.wind(tip, positions[tip as usize]).axes[level - 1],
                angle: sway.angles(tip, positions[tip as usize])[level],
            });
            for (&node, length) in nodes.iter().zip(&lengths).skip(1) {
                let share = ((length - within) / bends).clamp(0.0, 1.0);
                rig.weights[node as usize] = mixed(&base, &[(bone, 1.0)], share);
            }
        }
        rig
    }

    fn trunk(&mut self, sway: &Sway, nodes: &[u32], lengths: &[f32], zones: usize) {
        let zone = lengths[lengths.len() - 1] / zones as f32;
        let angle = |length: f32| {
            let place = along(&self.ends, nodes, lengths, length);
            let next = lengths.partition_point(|&end| end < length).min(nodes.len() - 1);
            sway.angles(nodes[next], place)[0]
        };
        let angles: Vec<f32> = (0..=zones).map(|i| angle(zone * i as f32)).collect();
        for i in 0..zones {
            self.joints.push(Joint {
                position: along(&self.ends, nodes, lengths, zone * (i as f32 + 0.5)),
                parent: Some(i as u16),
                level: 0,
                axis: UP,
                angle: angles[i + 1] - angles[i],
            });
        }
        for (&node, length) in nodes.iter().zip(lengths) {
            let at = (length / zone).clamp(0.0, zones as f32);
            let below = (at as usize).min(zones - 1);
            let pair = [(below as u16, 1.0), (below as u16 + 1, 0.0)];
            self.weights[node as usize] = mixed(&pair, &[(below as u16 + 1, 1.0)], at - below as f32);
        }
    }

    /// Rotation of a joint relative to its parent.
    pub(crate) fn rotation(&self, joint: usize, air: &Air) -> Quat {
        let Joint { level, axis, angle, .. } = self.joints[joint];
        let turn = axis.cross(air.push(level, axis)) * angle;
        let angle = turn.length();
        if angle < 1e-9 {
            return Quat::IDENTITY;
        }
        let (sin, cos) = sin_cos(0.5 * angle);
        let axis = turn * (sin / angle);
        math::unit_rotation(Quat::from_xyzw(axis.x, axis.y, axis.z, cos))
    }

    /// The bones of each vertex of a mesh that has wind, and their weights, which add up to 1. O(vertices).
    pub(crate) fn skin(&self, mesh: &Mesh) -> (Vec<[u16; 4]>, Vec<Vec4>) {
        let of = |(&position, wind): (&Vec3, &super::Wind)| {
            let node = wind.node as usize;
            let parent = self.parents[node] as usize;
            let part = super::sway::part(position, self.ends[parent], self.ends[node]);
            let weights = mixed(&self.weights[parent], &self.weights[node], part);
            let sum: f32 = weights.iter().map(|bone| bone.1).sum();
            // Bones that do not count are to be the first, says the format.
            let bones = weights.map(|(bone, weight)| if weight > 0.0 { bone } else { 0 });
            (bones, Vec4::from_array(weights.map(|bone| bone.1 / sum)))
        };
        mesh.positions.iter().zip(&mesh.wind).map(of).unzip()
    }
}

/// Distance of each node of a branch from its first, metres along it.
fn lengths(positions: &[Vec3], nodes: &[u32]) -> Vec<f32> {
    let mut length = 0.0;
    let mut before = positions[nodes[0] as usize];
    let to = |&node: &u32| {
        let position = positions[node as usize];
        length += position.distance(before);
        before = position;
        length
    };
    nodes.iter().map(to).collect()
}

/// The point this far along a branch.
fn along(positions: &[Vec3], nodes: &[u32], lengths: &[f32], length: f32) -> Vec3 {
    let next = lengths.partition_point(|&end| end < length).clamp(1, nodes.len() - 1);
    let [from, to] = [next - 1, next].map(|i| (positions[nodes[i] as usize], lengths[i]));
    let way = to.1 - from.1;
    let part = if way > 0.0 { ((length - from.1) / way).clamp(0.0, 1.0) } else { 1.0 };
    from.0.lerp(to.0, part)
}

/// Two sets of weights, the second by its share; the four that count most.
fn mixed(first: &[(u16, f32)], second: &[(u16, f32)], share: f32) -> Weights {
    let mut all: Vec<(u16, f32)> = Vec::with_capacity(2 * MOST);
    let both = first.iter().map(|&(bone, weight)| (bone, weight * (1.0 - share)));
    for (bone, weight) in both.chain(second.iter().map(|&(bone, weight)| (bone, weight * share))) {
        if weight > 0.0 {
            match all.iter_mut().find(|other| other.0 == bone) {
                Some(other) => other.1 += weight,
                None => all.push((bone, weight)),
            }
        }
    }
    all.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    std::array::from_fn(|i| all.get(i).copied().unwrap_or((0, 0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets;
    use crate::surface::Tubes;

    #[test]
    fn bones_are_few_and_their_weights_continuous() {
        for name in ["figure-06c", "figure-17e", "figure-02-guided"] {
            let preset = presets::by_name(name).expect("a preset").guided().unwrap();
            let tree =
                preset.synth(3000).synthesize(preset.seed).expect("a tree").relaxed(0.5, 3).expect("sound");
            let sway = Sway::of(&tree).expect("radii");
            for most in [2, 9, 64] {
                let rig = Rig::of(&tree, &sway, most);
                assert!(rig.joints.len() <= most && rig.joints.len() >= 2);
                let mut parents = rig.joints.iter().enumerate().skip(1);
                assert!(parents.all(|(i, joint)| joint.parent.map_or(usize::MAX, usize::from) < i));
                assert_eq!(rig.weights[0][0], (0, 1.0));
                let mesh = Tubes::default().with_wind(true).mesh(&tree).expect("a mesh");
                let (bones, weights) = rig.skin(&mesh);
                for (bones, weights) in bones.iter().zip(&weights) {
                    assert!((weights.element_sum() - 1.0).abs() < 1e-6 && weights.min_element() >= 0.0);
                    assert!(bones.iter().all(|&bone| usize::from(bone) < rig.joints.len()));
                }
            }
        }
    }
}
