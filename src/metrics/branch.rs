//! Branches counted and followed.

use super::angle::length;
use crate::Skeleton;

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

    proptest! {
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
