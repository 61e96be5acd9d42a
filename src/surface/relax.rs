//! Kinks taken out of branches.

use crate::ParameterError;
use crate::skeleton::{Skeleton, SkeletonError};
use glam::Vec3;

/// The skeleton with its branches' kinks relaxed, for surfaces: paths through a graph are crooked at the scale of
/// the graph's edges.
///
/// In each of `passes` passes, at most 1000, every node along an axis moves `share`, in [0, 1], of the way to the
/// middle between the node before and the node after it on that axis; all at once. The root and the tips stay, and
/// branches stay attached. Branching, radii and attributes are unchanged. O(passes · n).
///
/// ```
/// use treesynth::{Skeleton, glam::Vec3, surface::relax};
///
/// let kinked = Skeleton::new(
///     vec![Vec3::ZERO, Vec3::new(0.2, 1.0, 0.0), Vec3::Y * 2.0],
///     vec![None, Some(0), Some(1)],
/// )?;
/// assert_eq!(relax(&kinked, 0.5, 1)?.positions()[1], Vec3::new(0.1, 1.0, 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A share or a number of passes out of range.
pub fn relax(skeleton: &Skeleton, share: f32, passes: u32) -> Result<Skeleton, ParameterError> {
    ParameterError::unless((0.0..=1.0).contains(&share), "relax.share", share, "in [0, 1]")?;
    ParameterError::unless(passes <= 1000, "relax.passes", passes, "at most 1000")?;
    let branches = skeleton.branches();
    let mut before = skeleton.positions().to_vec();
    let mut after = before.clone();
    for _ in 0..passes {
        for branch in branches.iter() {
            for nodes in branch.nodes().windows(3) {
                let [from, here, to] = [nodes[0], nodes[1], nodes[2]].map(|node| before[node as usize]);
                after[nodes[1] as usize] = here + (middle(from, to) - here) * share;
            }
        }
        before.copy_from_slice(&after);
    }
    skeleton.clone().with_positions(after).map_err(|error: SkeletonError| {
        ParameterError::new("relax.skeleton", error, "made of positions whose differences are finite")
    })
}

/// Halved first, so that huge coordinates do not overflow.
fn middle(a: Vec3, b: Vec3) -> Vec3 {
    a * 0.5 + b * 0.5
}
