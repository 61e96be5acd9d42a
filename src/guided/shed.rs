//! Branches that fall.

use crate::parameter::ParameterError;
use crate::skeleton::{Skeleton, SkeletonError};

/// Takes branches away that bear less than their length deserves, as trees do with limbs in deep shade.
///
/// A branch ends at its last fork if more than the [bare end](Self::with_bare_end) lies beyond it, and falls whole, with
/// all it bears, if it has none or fewer tips per metre of its axis than the [least
/// density](Self::with_least_density). Branches that become bare by this fall too. The trunk stays.
///
/// ```
/// use treesynth::{Skeleton, glam::Vec3, guided::Shedding};
///
/// // A trunk with a twig of half a metre and a bare whip of three.
/// let nodes = [[0.0, 0.0], [0.0, 2.0], [0.0, 4.0], [0.5, 2.0], [1.5, 3.0], [3.0, 4.0]];
/// let nodes = nodes.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec();
/// let tree = Skeleton::new(nodes, vec![None, Some(0), Some(1), Some(1), Some(0), Some(4)])?;
/// let tree = tree.with_orders(vec![0, 0, 0, 1, 1, 1])?;
/// let (kept, nodes) = Shedding::new().with_bare_end(1.0).shed(&tree)?;
/// assert_eq!(nodes, [0, 1, 2, 3]);
/// assert_eq!(kept.tips().count(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Shedding {
    bare_end: f32,
    least_density: f32,
}

crate::recipe::readable!(Shedding { bare_end: f32, least_density: f32 });

impl Default for Shedding {
    fn default() -> Self {
        Self::new()
    }
}

impl Shedding {
    /// Bare ends of up to 1 m stay, and branches of any density.
    pub fn new() -> Self {
        Self { bare_end: 1.0, least_density: 0.0 }
    }

    /// The longest end of a branch that bears nothing, metres, above 0.
    pub fn with_bare_end(mut self, metres: f32) -> Self {
        self.bare_end = metres;
        self
    }

    /// The fewest tips per metre of a branch longer than the bare end, at least 0.
    pub fn with_least_density(mut self, tips: f32) -> Self {
        self.least_density = tips;
        self
    }

    /// Checks that the options are in range.
    ///
    /// # Errors
    /// The first that is not.
    pub fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless(self.bare_end > 0.0, "Shedding.bare_end", self.bare_end, "above 0 m")?;
        let fits = self.least_density >= 0.0 && self.least_density.is_finite();
        ParameterError::unless(
            fits,
            "Shedding.least_density",
            self.least_density,
            "finite and at least 0 per metre",
        )
    }

    /// The part of a tree that stays, and the number that each of its nodes had before, ascending.
    /// Orders are computed anew: where an axis has fallen, a branch that it bore goes on. O(n) per
    /// round; as many rounds as branches fall in a row.
    ///
    /// # Errors
    /// None for a sound skeleton.
    pub fn shed(&self, tree: &Skeleton) -> Result<(Skeleton, Vec<u32>), SkeletonError> {
        let mut kept: Vec<u32> = (0..tree.len() as u32).collect();
        let mut standing = part(tree, &kept)?;
        while let Some(stays) = self.round(&standing) {
            let mut stays = stays.into_iter();
            kept.retain(|_| stays.next() == Some(true));
            standing = part(tree, &kept)?;
        }
        Ok((standing, kept))
    }

    /// Nodes that stay, if something falls.
    fn round(self, tree: &Skeleton) -> Option<Vec<bool>> {
        let children = tree.children();
        let mut tips = vec![0u32; tree.len()];
        for (node, parent) in tree.edges().rev() {
            tips[node] = tips[node].max(1);
            tips[parent] += tips[node];
        }
        let mut stays = vec![true; tree.len()];
        for branch in tree.branches().iter().filter(|branch| branch.order() > 0) {
            // Its base is the parent branch's.
            let axis = branch.nodes();
            let place = |i: usize| tree.positions()[axis[i] as usize];
            let length =
                |from: usize| (from + 1..axis.len()).map(|i| place(i).distance(place(i - 1))).sum::<f32>();
            let last = (1..axis.len()).rev().find(|&i| children.of(axis[i] as usize).len() > 1).unwrap_or(0);
            let whole = length(0);
            let is_sparse =
                whole > self.bare_end && (tips[axis[1] as usize] as f32) < self.least_density * whole;
            if is_sparse {
                stays[axis[1] as usize] = false;
            } else if length(last) > self.bare_end {
                stays[axis[last + 1] as usize] = false;
            }
        }
        // A fallen node takes all above it along.
        for (node, parent) in tree.edges() {
            stays[node] &= stays[parent];
        }
        stays.contains(&false).then_some(stays)
    }
}

/// Some nodes of a tree, ascending, each with its parent.
fn part(tree: &Skeleton, nodes: &[u32]) -> Result<Skeleton, SkeletonError> {
    let mut new = vec![0u32; tree.len()];
    for (place, &node) in (0u32..).zip(nodes) {
        new[node as usize] = place;
    }
    let of = |node: &u32| *node as usize;
    let parent = |node: &u32| tree.parent(of(node)).map(|parent| new[parent]);
    Skeleton::new(
        nodes.iter().map(|node| tree.positions()[of(node)]).collect(),
        nodes.iter().map(parent).collect(),
    )?
    .with_stages(nodes.iter().map(|node| tree.stages()[of(node)]).collect())?
    .with_hops(nodes.iter().map(|node| tree.hops()[of(node)]).collect())?
    .with_radii(nodes.iter().map(|node| tree.radii()[of(node)]).collect())
}
