//! Branches counted and followed.

use super::angle::{branch_angles, length};
use crate::skeleton::Branch;
use crate::{ParameterError, Skeleton};

/// Number of branches of each order, the trunk first, as in [`Skeleton::branches`]. The first entry is 1. O(n).
pub fn branch_counts(skeleton: &Skeleton) -> Vec<usize> {
    let mut counts = Vec::new();
    for branch in skeleton.branches().iter() {
        let order = usize::from(branch.order());
        if counts.len() <= order {
            counts.resize(order + 1, 0);
        }
        counts[order] += 1;
    }
    counts
}

/// Tortuosity of each branch, in the order of [`Skeleton::branches`]: the way along it, from the fork it leaves
/// to its tip, over the straight line between them. At least 1, and 1 for a straight branch.
///
/// `None` where the tip is at the fork. O(n).
pub fn tortuosities(skeleton: &Skeleton) -> Vec<Option<f64>> {
    let of = |nodes: &[u32]| {
        let way: f64 =
            nodes.windows(2).map(|pair| length(skeleton, pair[0] as usize, pair[1] as usize)).sum();
        let chord = length(skeleton, nodes[0] as usize, nodes[nodes.len() - 1] as usize);
        (chord > 0.0).then(|| (way / chord).max(1.0))
    };
    skeleton.branches().iter().map(|branch| of(branch.nodes())).collect()
}

/// Measures of one branch; see [`measure_branches`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct BranchMeasure {
    /// The branch's first node of its own; the root for the trunk.
    pub node: usize,
    /// 0 for the trunk.
    pub order: u16,
    /// Height above the trunk base at which the branch leaves its parent branch, metres.
    pub base_height: f64,
    /// Length along the branch from where it leaves its parent branch, metres.
    pub length: f64,
    /// Straight from there to the tip, metres.
    pub chord: f64,
    /// Diameter at the first node of its own, metres.
    pub base_diameter: f64,
    /// Diameter at the tip, metres.
    pub tip_diameter: f64,
    /// Angle to the parent branch, radians, as [`branch_angles`](super::branch_angles) has it; `None` for the trunk and where there is no direction.
    pub angle: Option<f32>,
}

/// Every branch with its measures, in the order of [`Skeleton::branches`]: for distributions by order or by height. Angles are
/// taken over `reach` metres. O(n + b log n) for b branches.
///
/// # Errors
/// A `reach` that is negative or not finite.
pub fn measure_branches(skeleton: &Skeleton, reach: f32) -> Result<Vec<BranchMeasure>, ParameterError> {
    let mut angles = branch_angles(skeleton, reach)?.into_iter().peekable();
    let base = f64::from(skeleton.positions()[0].y);
    let diameter = |node: usize| 2.0 * f64::from(skeleton.radii()[node]);
    // The trunk is the first, and has no node of another branch.
    let of = |(number, branch): (usize, Branch<'_>)| {
        let nodes = branch.nodes();
        let (start, tip) = (nodes[0] as usize, nodes[nodes.len() - 1] as usize);
        let first = nodes[number.min(1)] as usize;
        BranchMeasure {
            node: first,
            order: branch.order(),
            base_height: f64::from(skeleton.positions()[start].y) - base,
            length: nodes.windows(2).map(|pair| length(skeleton, pair[0] as usize, pair[1] as usize)).sum(),
            chord: length(skeleton, start, tip),
            base_diameter: diameter(first),
            tip_diameter: diameter(tip),
            angle: angles.next_if(|angle| angle.node == first).map(|angle| angle.angle),
        }
    };
    Ok(skeleton.branches().iter().enumerate().map(of).collect())
}

/// Number of nodes on the longest way from the root to a tip, both included; at least 1. O(n).
pub fn depth(skeleton: &Skeleton) -> usize {
    let mut depths = vec![1u32; skeleton.len()];
    let mut most = 1;
    for (node, parent) in skeleton.edges() {
        depths[node] = depths[parent] + 1;
        most = most.max(depths[node]);
    }
    most as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radius::sample::{any_skeleton, binary, chain, y_fork};
    use glam::Vec3;
    use proptest::prelude::*;
    use std::error::Error;

    #[test]
    fn counts_by_hand() -> Result<(), Box<dyn Error>> {
        assert_eq!(branch_counts(&chain(5)?), [1]);
        assert_eq!(branch_counts(&y_fork()?), [1, 1]);
        // Each level of forks adds one branch to each axis there is: binomial coefficients.
        assert_eq!(branch_counts(&binary(5)?), [1, 4, 6, 4, 1]);
        assert_eq!([depth(&chain(1)?), depth(&y_fork()?), depth(&binary(5)?)], [1, 3, 5]);
        assert_eq!(depth(&chain(1_000_000)?), 1_000_000);
        Ok(())
    }

    #[test]
    fn tortuosity_by_hand() -> Result<(), Box<dyn Error>> {
        assert!(tortuosities(&chain(100)?)[0].is_some_and(|t| (1.0..1.0 + 1e-6).contains(&t)));
        assert_eq!(tortuosities(&chain(1)?), [None]);
        // Two sides of a square, and back to the start.
        let square = [Vec3::ZERO, Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::X, Vec3::ZERO];
        let along = |nodes: usize| {
            let parents = (0..nodes as u32).map(|i| i.checked_sub(1)).collect();
            Skeleton::new(square[..nodes].to_vec(), parents)
        };
        assert!(tortuosities(&along(3)?)[0].is_some_and(|t| (t - 2.0_f64.sqrt()).abs() < 1e-12));
        assert_eq!(tortuosities(&along(4)?), [Some(3.0)]);
        assert_eq!(tortuosities(&along(5)?), [None]);
        Ok(())
    }

    #[test]
    fn measures_by_hand() -> Result<(), Box<dyn Error>> {
        let arm = 0.89_f64.sqrt();
        let fork = y_fork()?.with_radii(vec![0.5, 0.5, 0.25, 0.25])?;
        let all = measure_branches(&fork, 0.0)?;
        let [trunk, twig] = all[..] else { panic!("{all:?}") };
        assert_eq!((trunk.node, trunk.order, trunk.angle, twig.order), (0, 0, None, 1));
        assert!((trunk.length - 1.0 - arm).abs() < 1e-6 && (twig.length - arm).abs() < 1e-6);
        assert!((twig.base_height - 1.0).abs() < 1e-6 && (twig.chord - arm).abs() < 1e-6);
        assert_eq!((trunk.base_diameter, trunk.tip_diameter, twig.base_diameter), (1.0, 0.5, 0.5));
        assert!(twig.angle.is_some_and(|angle| angle > 0.3));
        assert_eq!(measure_branches(&fork, f32::NAN).unwrap_err().parameter, "reach");
        Ok(())
    }

    proptest! {
        #[test]
        fn all_branches_are_measured(skeleton in any_skeleton()) {
            let all = measure_branches(&skeleton, 0.0).unwrap();
            let sum: f64 = all.iter().map(|branch| branch.length).sum();
            prop_assert!((sum - super::super::total_length(&skeleton)).abs() < 1e-6);
            prop_assert_eq!(all.iter().filter(|branch| branch.angle.is_some()).count(), branch_angles(&skeleton, 0.0).unwrap().len());
            prop_assert!(all.iter().all(|branch| branch.chord <= branch.length + 1e-6));
        }

        #[test]
        fn counts_agree(skeleton in any_skeleton()) {
            let counts = branch_counts(&skeleton);
            prop_assert_eq!(counts[0], 1);
            // Each branch ends in a tip of its own.
            prop_assert_eq!(counts.iter().sum::<usize>(), skeleton.tips().count());
            prop_assert_eq!(counts.len(), usize::from(*skeleton.orders().iter().max().unwrap()) + 1);
            prop_assert!(tortuosities(&skeleton).iter().flatten().all(|&t| t >= 1.0 && t.is_finite()));
        }
    }
}
