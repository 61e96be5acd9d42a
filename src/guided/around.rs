//! Trees that something else has made, as the tree that stages begin with.

use super::graph::{Graph, GraphBuilder, GraphError};
use super::refine::Refinement;
use crate::observer::Observer;
use crate::parameter::ParameterError;
use crate::random::{Purpose, derive};
use crate::shape::Shape;
use crate::skeleton::Skeleton;
use glam::Vec3;

/// A graph around a finished tree, whatever made it: the stages begin with that tree instead of the root alone, and
/// fill in twigs.
///
/// The tree's nodes are nodes of the graph, and stay where they are unless the refinement
/// [asks for relaxation](Refinement::with_relaxation); longer internodes are divided along a smooth curve. Radii that
/// the tree has are the least that its branches have in the end. Guiding vectors of its nodes are the directions in
/// which the tree comes to them. The stages of the [`TreeSynth`](super::TreeSynth) are counted on from the tree's last.
///
/// ```
/// use treesynth::glam::Vec3;
/// use treesynth::guided::{AroundTree, Bend, HopSurface, Refinement, Stage, TreeSynth};
/// use treesynth::shape::{Cuboid, HalfEllipsoid};
/// use treesynth::variational::{GuidanceShape, VariationalSynth};
///
/// let crown = HalfEllipsoid::new(Vec3::Y * 2.0, Vec3::new(2.0, 3.0, 2.0));
/// let limbs = VariationalSynth::new(GuidanceShape::in_volume(&crown, 60, 1)?).synthesize(1)?;
/// let region = Cuboid::new(Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 6.0, 3.0));
/// let around = AroundTree::new(limbs.clone(), Refinement::new(region, 0.12));
/// let tree = TreeSynth::new(around)
///     .stage(Stage::new(Bend::piecewise(0.5, 0.0, 1), HopSurface::new(4, 300)))
///     .synthesize(1)?;
/// assert!(tree.tips().count() > limbs.tips().count() + 200);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct AroundTree<S> {
    tree: Skeleton,
    refinement: Refinement<S>,
}

impl<A> AroundTree<A> {
    /// The same in another region.
    pub(crate) fn map<B>(self, region: impl FnOnce(A) -> B) -> AroundTree<B> {
        AroundTree { tree: self.tree, refinement: self.refinement.map(region) }
    }
}

impl<S: Shape> AroundTree<S> {
    /// The surroundings of `tree` that `refinement` names; its region holds the root.
    pub fn new(tree: Skeleton, refinement: Refinement<S>) -> Self {
        Self { tree, refinement }
    }
}

impl<S: Shape> GraphBuilder for AroundTree<S> {
    fn build(&self, seed: u64, observer: &dyn Observer) -> Result<Graph, GraphError> {
        let carried = self.refinement.carry(&self.tree)?;
        self.refinement.surround(&carried, false, derive(seed, 0, Purpose::NODES), observer)
    }

    fn check(&self) -> Result<(), ParameterError> {
        self.refinement.check()?;
        let far = |position: &&Vec3| position.abs().max_element() > Graph::MAX_COORDINATE;
        match self.tree.positions().iter().find(far) {
            None => Ok(()),
            Some(position) => Err(ParameterError::new("AroundTree.tree", position, "within 1e9 metres of 0")),
        }
    }
}
