//! The skeleton of a tree: every synthesizer ends in it, and everything else starts from it.

mod branch;
mod relax;

pub use branch::{Branch, Branches, Children};

use glam::Vec3;

/// The branching structure of a tree as plain data: node positions, each node's parent, and per-node numbers.
///
/// A node together with the way from its parent is an *internode*; its [radius](Self::radii) is that of the
/// internode. Node 0 is the root, and every other node's parent has a smaller index, so that one pass forwards
/// visits parents before children and one pass backwards visits children before parents.
///
/// A value of this type always satisfies [`check`](Self::check): the constructors refuse what does not.
///
/// Memory: 28 bytes per node.
///
/// ```
/// use treesynth::{Skeleton, glam::Vec3};
///
/// let fork = Skeleton::new(
///     vec![Vec3::ZERO, Vec3::Y, Vec3::new(-0.5, 1.8, 0.0), Vec3::new(0.5, 1.8, 0.0)],
///     vec![None, Some(0), Some(1), Some(1)],
/// )?;
/// assert_eq!(fork.tips().count(), 2);
/// # Ok::<(), treesynth::SkeletonError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Parts", into = "Parts"))]
#[doc(alias("branch", "tree", "trunk"))]
pub struct Skeleton {
    positions: Vec<Vec3>,
    /// The root's entry is 0.
    parents: Vec<u32>,
    radii: Vec<f32>,
    stages: Vec<u16>,
    orders: Vec<u16>,
    hops: Vec<u32>,
}

/// Error of making a skeleton.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SkeletonError {
    /// There is not even a root.
    #[error("a skeleton has at least one node, this has none")]
    Empty,
    /// More nodes than 32-bit indices can name.
    #[error("a skeleton has at most {} nodes, this has {nodes}", u32::MAX)]
    TooLarge {
        /// The number of nodes given.
        nodes: usize,
    },
    /// An array is not as long as the positions.
    #[error("{array} has {length} entries, but there are {nodes} nodes")]
    Length {
        /// The array's name.
        array: &'static str,
        /// Its length.
        length: usize,
        /// The number of positions.
        nodes: usize,
    },
    /// Node 0 has a parent.
    #[error("node 0 is the root, but has the parent {parent}")]
    RootHasParent {
        /// The parent named.
        parent: u32,
    },
    /// A node other than 0 has no parent.
    #[error("node {node} has no parent, but only node 0 is the root")]
    SecondRoot {
        /// The node.
        node: usize,
    },
    /// A parent that does not come before its child: dangling, or part of a cycle.
    #[error("node {node} has the parent {parent}, but a parent's index must be smaller than its child's")]
    ParentNotBefore {
        /// The child.
        node: usize,
        /// The parent named.
        parent: u32,
    },
    /// NaN or an infinity in a position.
    #[error("node {node} has the position {position}, but positions must be finite")]
    Position {
        /// The node.
        node: usize,
        /// Its position, metres.
        position: Vec3,
    },
    /// A radius that is negative, NaN or infinite.
    #[error("node {node} has the radius {radius}, but radii must be finite and not negative")]
    Radius {
        /// The node.
        node: usize,
        /// Its radius, metres.
        radius: f32,
    },
    /// Branch orders that no axes have.
    #[error(
        "node {node} has the order {order} after the order {parent}, but the root must have the order 0, at most one \
         child of a node the order of that node, and all other children one more"
    )]
    Order {
        /// The node.
        node: usize,
        /// Its order.
        order: u16,
        /// The order of its parent; 0 for the root.
        parent: u16,
    },
}

impl Skeleton {
    /// A skeleton of `positions` (metres) and each node's parent.
    ///
    /// Radii, stages and hops are zero until set with the `with_*` methods; [orders](Self::orders) are worked
    /// out from the branching. O(n).
    ///
    /// # Errors
    /// Whatever [`check`](Self::check) finds, and parents that are not exactly as many as positions.
    pub fn new(positions: Vec<Vec3>, parents: Vec<Option<u32>>) -> Result<Self, SkeletonError> {
        let nodes = positions.len();
        if nodes > u32::MAX as usize {
            return Err(SkeletonError::TooLarge { nodes });
        }
        same_length("parents", parents.len(), nodes)?;
        match parents.first() {
            None => return Err(SkeletonError::Empty),
            Some(Some(parent)) => return Err(SkeletonError::RootHasParent { parent: *parent }),
            Some(None) => {}
        }
        if let Some(node) = parents.iter().skip(1).position(Option::is_none) {
            return Err(SkeletonError::SecondRoot { node: node + 1 });
        }
        let mut skeleton = Self {
            positions,
            parents: parents.into_iter().map(Option::unwrap_or_default).collect(),
            radii: vec![0.0; nodes],
            stages: vec![0; nodes],
            orders: Vec::new(),
            hops: vec![0; nodes],
        };
        skeleton.orders = vec![0; nodes];
        skeleton.check()?;
        skeleton.orders = branch::orders(&skeleton);
        Ok(skeleton)
    }

    /// Moves the nodes (metres); the branching and all numbers stay.
    ///
    /// # Errors
    /// When there is not one position per node, or one is not finite.
    pub fn with_positions(mut self, positions: Vec<Vec3>) -> Result<Self, SkeletonError> {
        same_length("positions", positions.len(), self.len())?;
        self.positions = positions;
        self.check()?;
        Ok(self)
    }

    /// Sets the radius (metres) of every node's internode, the way from its parent to it.
    ///
    /// # Errors
    /// When there is not one radius per node, or one is negative, NaN or infinite.
    pub fn with_radii(mut self, radii: Vec<f32>) -> Result<Self, SkeletonError> {
        same_length("radii", radii.len(), self.len())?;
        self.radii = radii;
        self.check()?;
        Ok(self)
    }

    /// Sets the stage (iteration, growth cycle) in which each node came to be, and works out the
    /// [orders](Self::orders) anew, since the axis of an earlier stage goes before that of a later one.
    ///
    /// # Errors
    /// When there is not one stage per node.
    pub fn with_stages(mut self, stages: Vec<u16>) -> Result<Self, SkeletonError> {
        same_length("stages", stages.len(), self.len())?;
        self.stages = stages;
        self.orders = branch::orders(&self);
        Ok(self)
    }

    /// Sets the branch order of each node, for a tree that knows its axes; call it after
    /// [`with_stages`](Self::with_stages), which works orders out anew. Branches follow it: an axis goes on in the child
    /// of its order, and ends where there is none.
    ///
    /// ```
    /// use treesynth::{Skeleton, glam::Vec3};
    ///
    /// // The side shoot is the longer one, and bears most tips.
    /// let nodes = [[0.0, 0.0], [0.0, 1.0], [0.0, 1.1], [0.5, 1.5], [1.0, 2.0], [1.0, 1.6]];
    /// let nodes = nodes.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec();
    /// let fork = Skeleton::new(nodes, vec![None, Some(0), Some(1), Some(1), Some(3), Some(3)])?;
    /// assert_eq!(fork.orders(), [0, 0, 1, 0, 0, 1]);
    /// let fork = fork.with_orders(vec![0, 0, 0, 1, 1, 2])?;
    /// assert_eq!(fork.branches().iter().next().map(|trunk| trunk.nodes().len()), Some(3));
    /// # Ok::<(), treesynth::SkeletonError>(())
    /// ```
    ///
    /// # Errors
    /// When there is not one order per node, the root's is not 0, one is neither its parent's nor one more,
    /// or two children have their parent's.
    pub fn with_orders(mut self, orders: Vec<u16>) -> Result<Self, SkeletonError> {
        same_length("orders", orders.len(), self.len())?;
        branch::check_orders(&self, &orders)?;
        self.orders = orders;
        Ok(self)
    }

    /// Sets the hops of each node.
    ///
    /// # Errors
    /// Unless there is one number per node.
    pub fn with_hops(mut self, hops: Vec<u32>) -> Result<Self, SkeletonError> {
        same_length("hops", hops.len(), self.len())?;
        self.hops = hops;
        Ok(self)
    }

    /// Number of nodes; at least 1.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Always false: a skeleton has a root.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Number of internodes: one less than nodes.
    pub fn segments(&self) -> usize {
        self.len() - 1
    }

    /// Positions of the nodes, metres.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// The parent of `node`; `None` for the root.
    ///
    /// # Panics
    /// When there is no such node.
    pub fn parent(&self, node: usize) -> Option<usize> {
        (node != 0).then(|| self.parents[node] as usize)
    }

    /// Every (child, parent) in ascending order of the child: the internodes.
    pub fn edges(&self) -> impl DoubleEndedIterator<Item = (usize, usize)> + ExactSizeIterator + '_ {
        (1..self.len()).map(|node| (node, self.parents[node] as usize))
    }

    /// Radius of each node's internode, metres. The root's is that of the trunk base.
    pub fn radii(&self) -> &[f32] {
        &self.radii
    }

    /// The stage in which each node came to be, from 0.
    pub fn stages(&self) -> &[u16] {
        &self.stages
    }

    /// Branch order of each node (Gravelius): 0 on the trunk, one more on each branch than on its parent
    /// axis.
    ///
    /// Unless they were [set](Self::with_orders), the axis goes on at a fork in the child of the earliest stage, then in
    /// the one with the most tips, then in the one of the lowest index.
    pub fn orders(&self) -> &[u16] {
        &self.orders
    }

    /// Hops of each node from the source of its stage: 1 at the first node off the tree, 0 at the root.
    pub fn hops(&self) -> &[u32] {
        &self.hops
    }

    /// The children of every node, in two flat arrays. O(n).
    pub fn children(&self) -> Children {
        Children::new(&self.parents)
    }

    /// The nodes without children, ascending. O(n).
    pub fn tips(&self) -> impl Iterator<Item = usize> {
        let mut bears = vec![false; self.len()];
        for (_, parent) in self.edges() {
            bears[parent] = true;
        }
        bears.into_iter().enumerate().filter(|(_, bears)| !bears).map(|(node, _)| node)
    }

    /// The branches, each parent axis before its laterals. O(n).
    ///
    /// ```
    /// # use treesynth::{Skeleton, glam::Vec3};
    /// # let y = |y: f32| Vec3::new(0.0, y, 0.0);
    /// let twig = Skeleton::new(
    ///     vec![y(0.0), y(1.0), y(2.0), y(3.0), Vec3::new(1.0, 1.5, 0.0)],
    ///     vec![None, Some(0), Some(1), Some(2), Some(1)],
    /// )?;
    /// let nodes: Vec<_> = twig.branches().iter().map(|branch| branch.nodes().to_vec()).collect();
    /// assert_eq!(nodes, [vec![0, 1, 2, 3], vec![1, 4]]);
    /// # Ok::<(), treesynth::SkeletonError>(())
    /// ```
    pub fn branches(&self) -> Branches {
        Branches::new(self)
    }

    /// Checks that this is a tree: one root at index 0, every parent before its child (hence no cycle),
    /// finite positions, finite radii of at least zero, all arrays of one length. O(n).
    ///
    /// # Errors
    /// The first violation found.
    pub fn check(&self) -> Result<(), SkeletonError> {
        let nodes = self.len();
        if nodes == 0 {
            return Err(SkeletonError::Empty);
        }
        for (array, length) in [
            ("parents", self.parents.len()),
            ("radii", self.radii.len()),
            ("stages", self.stages.len()),
            ("orders", self.orders.len()),
            ("hops", self.hops.len()),
        ] {
            same_length(array, length, nodes)?;
        }
        for (node, &parent) in self.parents.iter().enumerate().skip(1) {
            if parent as usize >= node {
                return Err(SkeletonError::ParentNotBefore { node, parent });
            }
        }
        for (node, &position) in self.positions.iter().enumerate() {
            if !position.is_finite() {
                return Err(SkeletonError::Position { node, position });
            }
        }
        for (node, &radius) in self.radii.iter().enumerate() {
            if !(radius.is_finite() && radius >= 0.0) {
                return Err(SkeletonError::Radius { node, radius });
            }
        }
        Ok(())
    }
}

fn same_length(array: &'static str, length: usize, nodes: usize) -> Result<(), SkeletonError> {
    if length == nodes { Ok(()) } else { Err(SkeletonError::Length { array, length, nodes }) }
}

/// Form of a skeleton in a file.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Parts {
    positions: Vec<[f32; 3]>,
    parents: Vec<Option<u32>>,
    radii: Vec<f32>,
    stages: Vec<u16>,
    orders: Vec<u16>,
    hops: Vec<u32>,
}

#[cfg(feature = "serde")]
impl From<Skeleton> for Parts {
    fn from(skeleton: Skeleton) -> Self {
        Self {
            positions: skeleton.positions.iter().map(Vec3::to_array).collect(),
            parents: skeleton.parents.iter().enumerate().map(|(i, &p)| (i != 0).then_some(p)).collect(),
            radii: skeleton.radii,
            stages: skeleton.stages,
            orders: skeleton.orders,
            hops: skeleton.hops,
        }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<Parts> for Skeleton {
    type Error = SkeletonError;

    fn try_from(parts: Parts) -> Result<Self, SkeletonError> {
        let positions = parts.positions.into_iter().map(Vec3::from_array).collect();
        let skeleton = Self::new(positions, parts.parents)?
            .with_radii(parts.radii)?
            .with_stages(parts.stages)?
            .with_hops(parts.hops)?;
        skeleton.with_orders(parts.orders)
    }
}

#[cfg(test)]
mod tests;
