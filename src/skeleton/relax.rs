//! Kinks taken out of branches.

use super::Skeleton;
use crate::parameter::ParameterError;
use glam::Vec3;

impl Skeleton {
    /// This tree with the kinks of its branches relaxed, for surfaces and for finer graphs: paths through a graph are
    /// crooked at the scale of the graph's edges.
    ///
    /// In each of `passes` passes, at most 1000, every node along an axis moves `share`, in [0, 1], of the way to the
    /// middle between the node before and the node after it on that axis; all at once. The root and the tips stay,
    /// and branches stay attached. Branching, radii and attributes are unchanged. O(passes · n).
    ///
    /// ```
    /// use treesynth::{Skeleton, glam::Vec3};
    ///
    /// let kinked = Skeleton::new(
    ///     vec![Vec3::ZERO, Vec3::new(0.2, 1.0, 0.0), Vec3::Y * 2.0],
    ///     vec![None, Some(0), Some(1)],
    /// )?;
    /// assert_eq!(kinked.relaxed(0.5, 1)?.positions()[1], Vec3::new(0.1, 1.0, 0.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A share or a number of passes out of range.
    pub fn relaxed(&self, share: f32, passes: u32) -> Result<Self, ParameterError> {
        ParameterError::unless((0.0..=1.0).contains(&share), "relaxed.share", share, "in [0, 1]")?;
        ParameterError::unless(passes <= 1000, "relaxed.passes", passes, "at most 1000")?;
        let branches = self.branches();
        let mut before = self.positions.clone();
        let mut after = before.clone();
        for _ in 0..passes {
            for branch in branches.iter() {
                for nodes in branch.nodes().windows(3) {
                    let [from, here, to] = [nodes[0], nodes[1], nodes[2]].map(|node| before[node as usize]);
                    // Halved and scaled first, so that huge coordinates do not overflow.
                    let middle: Vec3 = from * 0.5 + to * 0.5;
                    after[nodes[1] as usize] = here * (1.0 - share) + middle * share;
                }
            }
            before.copy_from_slice(&after);
        }
        Ok(Self { positions: after, ..self.clone() })
    }
}
