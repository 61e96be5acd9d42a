//! The angles at which branches leave their parent axes.

use glam::DVec3;

use crate::skeleton::Branch;
use crate::{ParameterError, Skeleton, math};

/// The angle of one branch; see [`branch_angles`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct BranchAngle {
    /// The branch's first node of its own.
    pub node: usize,
    /// The branch's order: 1 where it leaves the trunk.
    pub order: u16,
    /// Angle between the branch and its parent axis, radians, in [0, π].
    pub angle: f32,
}

/// For each branch but the trunk, as in [`Skeleton::branches`], the angle between its direction and that in
/// which its parent axis arrives at the fork.
///
/// Both directions are chords over `reach` metres of arc length, the branch's from the fork on and the axis's
/// up to the fork, on its own branch; finite, at least 0. They span at least one internode that has a length,
/// so that 0 measures the first internode of the branch against the last of the axis, as a protractor at the
/// fork would; a longer reach smooths the crookedness out. Where no part of the axis leads up to the fork, as
/// at the trunk base, its direction from there on is taken. Branches and axes without any direction are left
/// out.
///
/// O(n + b log n) for b branches.
///
/// ```
/// use std::f32::consts::FRAC_PI_2;
/// use treesynth::{Skeleton, glam::Vec3, metrics::branch_angles};
///
/// let stem = vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::Y * 3.0, Vec3::new(1.0, 1.0, 0.0)];
/// let twig = Skeleton::new(stem, vec![None, Some(0), Some(1), Some(2), Some(1)])?;
/// let angles = branch_angles(&twig, 0.0)?;
/// assert_eq!((angles.len(), angles[0].node, angles[0].order), (1, 4, 1));
/// assert!((angles[0].angle - FRAC_PI_2).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When `reach` is out of range.
pub fn branch_angles(skeleton: &Skeleton, reach: f32) -> Result<Vec<BranchAngle>, ParameterError> {
    let holds = reach >= 0.0 && reach.is_finite();
    ParameterError::unless(holds, "reach", reach, "finite and at least 0 metres")?;
    Ok(angles(skeleton, f64::from(reach)))
}

pub(super) fn angles(skeleton: &Skeleton, reach: f64) -> Vec<BranchAngle> {
    let branches = skeleton.branches();
    // Ways along each branch from its origin, all in one array; where each node is on the branch it belongs to.
    let mut ways: Vec<f64> = Vec::with_capacity(skeleton.len() + branches.len());
    let mut home = vec![(0u32, 0u32); skeleton.len()];
    let mut starts = Vec::with_capacity(branches.len());
    let all: Vec<Branch<'_>> = branches.iter().collect();
    for (number, branch) in all.iter().enumerate() {
        starts.push(ways.len());
        let mut way = 0.0;
        let mut last = branch.nodes()[0] as usize;
        for (place, &node) in branch.nodes().iter().enumerate() {
            way += length(skeleton, last, node as usize);
            last = node as usize;
            ways.push(way);
            if place > 0 || number == 0 {
                home[last] = (number as u32, place as u32);
            }
        }
    }
    let course = |number: usize| {
        let nodes = all[number].nodes();
        Course { skeleton, nodes, ways: &ways[starts[number]..starts[number] + nodes.len()] }
    };
    let mut angles = Vec::with_capacity(all.len() - 1);
    for (number, branch) in all.iter().enumerate().skip(1) {
        let (parent, place) = home[branch.nodes()[0] as usize];
        let (axis, place) = (course(parent as usize), place as usize);
        let along_axis = axis.arriving(place, reach).or_else(|| axis.leaving(place, reach));
        if let (Some(axis), Some(off)) = (along_axis, course(number).leaving(0, reach)) {
            let angle = math::angle_between(axis.as_vec3(), off.as_vec3());
            angles.push(BranchAngle { node: branch.nodes()[1] as usize, order: branch.order(), angle });
        }
    }
    angles
}

/// Distance of two nodes, metres, in `f64`, where no distance of `f32` positions overflows.
pub(super) fn length(skeleton: &Skeleton, a: usize, b: usize) -> f64 {
    skeleton.positions()[a].as_dvec3().distance(skeleton.positions()[b].as_dvec3())
}

/// The mean of some angles, radians; `None` of none.
pub(super) fn mean(angles: &[BranchAngle]) -> Option<f64> {
    let sum: f64 = angles.iter().map(|angle| f64::from(angle.angle)).sum();
    (!angles.is_empty()).then(|| sum / angles.len() as f64)
}

/// A branch as a curve over its arc length.
struct Course<'a> {
    skeleton: &'a Skeleton,
    nodes: &'a [u32],
    /// The way to each node, metres; ascending.
    ways: &'a [f64],
}

impl Course<'_> {
    fn node(&self, place: usize) -> DVec3 {
        self.skeleton.positions()[self.nodes[place] as usize].as_dvec3()
    }

    /// The point after `way` metres, which must be within the curve.
    fn at(&self, way: f64) -> DVec3 {
        let next = self.ways.partition_point(|&other| other < way);
        if next == 0 || next == self.ways.len() {
            return self.node(next.min(self.ways.len() - 1));
        }
        let part = (way - self.ways[next - 1]) / (self.ways[next] - self.ways[next - 1]);
        self.node(next - 1).lerp(self.node(next), part)
    }

    fn leaving(&self, place: usize, reach: f64) -> Option<DVec3> {
        let here = self.ways[place];
        let next = self.ways.partition_point(|&way| way <= here);
        let least = *self.ways.get(next)?;
        // At a node without going through its arc length, which rounding would move.
        let there = if here + reach <= least { self.node(next) } else { self.at(here + reach) };
        (there - self.node(place)).try_normalize()
    }

    fn arriving(&self, place: usize, reach: f64) -> Option<DVec3> {
        let here = self.ways[place];
        let last = self.ways.partition_point(|&way| way < here).checked_sub(1)?;
        let there = if here - reach >= self.ways[last] { self.node(last) } else { self.at(here - reach) };
        (self.node(place) - there).try_normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radius::sample::{any_skeleton, chain, y_fork};
    use glam::Vec3;
    use proptest::prelude::*;
    use std::error::Error;
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

    #[test]
    fn by_hand() -> Result<(), Box<dyn Error>> {
        // A stem along Z, so that nothing hangs on up; a branch that leaves it at 45° and turns to 90°.
        let points = [[0., 0.], [0., 1.], [0., 2.], [0., 3.], [0., 4.], [1., 2.], [3., 2.]];
        let parents = [None, Some(0), Some(1), Some(2), Some(3), Some(1), Some(5)];
        let positions = points.iter().map(|p| Vec3::new(p[0], 0.0, p[1])).collect();
        let tree = Skeleton::new(positions, parents.to_vec())?;
        let first = branch_angles(&tree, 0.0)?;
        assert_eq!((first.len(), first[0].node, first[0].order), (1, 5, 1));
        assert!((first[0].angle - FRAC_PI_4).abs() < 1e-6);
        // After 1.414 m along the slope and 2 m level the chord goes (3, 1).
        let smooth = branch_angles(&tree, 100.0)?[0].angle;
        assert!((smooth - math::atan2(3.0, 1.0)).abs() < 1e-6);
        // One metre beyond the bend: (2, 1).
        let smooth = branch_angles(&tree, 2.0_f32.sqrt() + 1.0)?[0].angle;
        assert!((smooth - math::atan2(2.0, 1.0)).abs() < 1e-6);
        Ok(())
    }

    #[test]
    fn crooked_axes_are_smoothed_too() -> Result<(), Box<dyn Error>> {
        // The stem goes 1 up and 1 aside, then bears a branch that goes up.
        let positions =
            vec![Vec3::ZERO, Vec3::Y, Vec3::new(1., 1., 0.), Vec3::new(2., 1., 0.), Vec3::new(1., 3., 0.)];
        let tree = Skeleton::new(positions, vec![None, Some(0), Some(1), Some(2), Some(2)])?;
        assert!((branch_angles(&tree, 0.0)?[0].angle - FRAC_PI_2).abs() < 1e-6);
        assert!((branch_angles(&tree, 2.0)?[0].angle - FRAC_PI_4).abs() < 1e-6);
        Ok(())
    }

    #[test]
    fn where_directions_are_missing() -> Result<(), Box<dyn Error>> {
        // The fork is at the trunk base: the trunk's direction from there on counts.
        let tree = Skeleton::new(vec![Vec3::ZERO, Vec3::Y, Vec3::X], vec![None, Some(0), Some(0)])?;
        assert!((branch_angles(&tree, 0.0)?[0].angle - FRAC_PI_2).abs() < 1e-6);
        // A coincident node before and after the fork is passed over.
        let positions = vec![Vec3::ZERO, Vec3::Y, Vec3::Y, Vec3::Y * 2.0, Vec3::Y, Vec3::new(1.0, 1.0, 0.0)];
        let tree = Skeleton::new(positions, vec![None, Some(0), Some(1), Some(2), Some(2), Some(4)])?;
        assert_eq!(branch_angles(&tree, 0.0)?.len(), 1);
        assert!(branch_angles(&tree, 0.0)?.iter().all(|a| (a.angle - FRAC_PI_2).abs() < 1e-6));
        // No length at all, no branch at all.
        let still = Skeleton::new(vec![Vec3::X; 3], vec![None, Some(0), Some(0)])?;
        assert_eq!(branch_angles(&still, 0.0)?, []);
        assert_eq!(branch_angles(&chain(1)?, 1.0)?, []);
        assert_eq!(branch_angles(&y_fork()?, 0.0)?.len(), 1);
        for reach in [-1.0, f32::NAN, f32::INFINITY] {
            let refused = branch_angles(&still, reach).map_err(|error| error.parameter);
            assert_eq!(refused, Err("reach".into()));
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn angles_are_in_range(skeleton in any_skeleton(), reach in 0.0f32..5.0) {
            let angles = branch_angles(&skeleton, reach).unwrap();
            prop_assert!(angles.len() < skeleton.branches().len());
            for angle in angles {
                prop_assert!((0.0..=std::f32::consts::PI).contains(&angle.angle));
                prop_assert_eq!(angle.order, skeleton.orders()[angle.node]);
            }
        }
    }
}
