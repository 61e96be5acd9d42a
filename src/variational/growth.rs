//! The result of the optimization: the tree, and the energy of every step.

use super::energy::Wish;
use crate::observer::Cancelled;
use crate::radius::RadiusError;
use crate::{ParameterError, Skeleton, SkeletonError};

/// A finished tree, and how it came about.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Growth {
    /// The tree: the branch nodes, then the shape nodes in their order. Its stages are the levels.
    pub skeleton: Skeleton,
    /// Number of branch nodes, the root included.
    pub branch_nodes: usize,
    /// Terms asked of each branch node's internode.
    pub wishes: Vec<Wish>,
    /// The energy after every step. The last steps, from [`StepKind::Twigs`] on, start from the tree of least energy of all
    /// refinements, which need not be the last one's.
    pub trace: Vec<Step>,
    /// The step of the trace whose tree this is: the last.
    pub best: usize,
}

/// The energy after one step of the optimization: a point of figure 10.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Step {
    /// Result of the step.
    pub kind: StepKind,
    /// F, metres to the power of 1 + β.
    pub total: f64,
    /// `F_I`, metres to the power of 1 + β.
    pub structure: f64,
    /// `F_E`, metres, to the branch nodes on which the shape nodes hang. After an update others may be nearer.
    pub guidance: f64,
    /// `F_P`, metres to the power of 1 + β.
    pub penalty: f64,
    /// Cost of wood outside of the shape, see
    /// [`VariationalSynth::with_outside_price`](super::VariationalSynth::with_outside_price); metres to the
    /// power of 1 + β.
    pub outside: f64,
    /// Branch nodes, the root included.
    pub branch_nodes: usize,
}

/// Result of a step of the optimization.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum StepKind {
    /// Built axes of a level, and partitioned the shape among them.
    Initialization {
        /// The level, from 0.
        level: usize,
    },
    /// Moved all nodes. Within a level, F never rises.
    Update {
        /// The level, from 0.
        level: usize,
    },
    /// Hung each shape node on the nearest branch node. Within a level, F never rises.
    Partition {
        /// The level, from 0.
        level: usize,
    },
    /// Took out internodes that had shrunk to less than a tenth of the length asked for. Within a level, F never rises.
    Contraction {
        /// The level, from 0.
        level: usize,
    },
    /// Hung subtrees on other branch nodes, where that saves. Within a level, F never rises.
    Rehanging {
        /// The level, from 0.
        level: usize,
    },
    /// Hung shape nodes on internodes nearby, and gathered what was too many for a node on twigs.
    Twigs,
    /// Pruned the nodes of low order, and partitioned the shape among the others.
    Refinement {
        /// The highest order that was pruned.
        order: u32,
    },
}

/// Error of growing a tree by variational synthesis.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VariationalError {
    /// An option is out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The radius model failed.
    #[error("the radii: {0}")]
    Radius(#[from] RadiusError),
    /// The result is no tree.
    #[error("the tree: {0}")]
    Skeleton(#[from] SkeletonError),
    /// The observer cancelled the work.
    #[error("cancelled by the observer")]
    Cancelled,
}

impl From<Cancelled> for VariationalError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl Growth {
    /// The branch nodes without the shape nodes: what fills the shape.
    ///
    /// # Errors
    /// None; the type is that of [`Skeleton::new`].
    pub fn structure(&self) -> Result<Skeleton, SkeletonError> {
        let tree = &self.skeleton;
        let parents = (0..self.branch_nodes).map(|node| tree.parent(node).map(|parent| parent as u32));
        Skeleton::new(tree.positions()[..self.branch_nodes].to_vec(), parents.collect())?
            .with_radii(tree.radii()[..self.branch_nodes].to_vec())?
            .with_stages(tree.stages()[..self.branch_nodes].to_vec())
    }
}
