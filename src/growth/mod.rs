//! Trees over the years, by positional information: curves say what grows where, not why.
//!
//! After Galbraith, Mündermann and Wyvill 2004, "Implicit visualization and inverse modeling of growing trees". All of a
//! tree, at every age, follows from [`Curve`]s over relative positions and relative time, which a [`Architecture`] holds.
//! [`Growth`] works out once which branches a tree ever has, then gives it at any real age as a [`Skeleton`] with radii,
//! leaves and buds; nodes keep their numbers from age to age. The paper's equations are functions in [`equation`].
//!
//! [`Timeline`] does the like for any skeleton that another system has made.
//!
//! Years count from germination: year 1 lasts from age 0 to 1, and each begins in midwinter.
//!
//! [`Skeleton`]: crate::Skeleton

mod architecture;
mod curve;
pub mod equation;
mod form;
mod kinds;
mod phenology;
mod sprouting;
mod structure;
mod thickness;
mod timeline;

pub use architecture::Architecture;
pub use curve::Curve;
pub use form::{Bud, Leaf, TreeAtAge};
pub use phenology::Phenology;
pub use timeline::Timeline;

use crate::ParameterError;
use crate::observer::{Cancelled, Observer, Silent};
use crate::skeleton::SkeletonError;
use structure::Structure;
use thickness::Thickness;

/// The most nodes unless it is said otherwise: some 400 MB.
const MOST_NODES: u32 = 4_000_000;

/// Error of growing a tree to an age.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GrowthError {
    /// An option or an age out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The tree has been worked out up to this year only. All ages before it are available.
    #[error(
        "year {year} would bring the tree to {nodes} nodes, lost ones included, or as many times eight years of branches, \
         but the limit is {limit}; it can \
         be grown up to the age of {}; Growth::with_most_nodes raises the limit", year - 1
    )]
    Limit {
        /// The first year that is missing.
        year: u16,
        /// The nodes there would be, at least; or an eighth of the years that all branches could live, for they take
        /// memory too.
        nodes: u64,
        /// The most there may be.
        limit: u32,
    },
    /// The observer cancelled the work.
    #[error("cancelled by the observer")]
    Cancelled,
    /// The grown nodes make no skeleton.
    #[error("the tree: {0}")]
    Skeleton(#[from] SkeletonError),
}

impl From<Cancelled> for GrowthError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// A tree of a species, available at any age.
///
/// ```
/// use treesynth::growth::{Growth, Architecture};
///
/// let tree = Growth::new(Architecture::default().with_most_order(1), 1)?;
/// let young = tree.at(4.5)?;
/// let old = tree.at(9.5)?;
/// assert!(old.skeleton.len() > young.skeleton.len());
/// // A node is known by its number: here the top of the first year's shoot.
/// let top = young.node(young.ids[10]).expect("it stands");
/// assert_eq!(young.ids[top], old.ids[old.node(young.ids[10]).expect("it still stands")]);
/// # Ok::<(), treesynth::growth::GrowthError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Growth {
    architecture: Architecture,
    seed: u64,
    most_nodes: u32,
    structure: Structure,
    thickness: Thickness,
}

impl Growth {
    /// Works out the structure of a tree up to the species' greatest age, at most 4 million nodes.
    ///
    /// O(branches · years) time; 12 bytes per branch and year, 44 bytes per branch.
    ///
    /// # Errors
    /// A parameter out of range, as [`Architecture::check`] reports it. A species that grows without bound is
    /// an error only in [`at`](Self::at), for the ages that are missing.
    pub fn new(architecture: Architecture, seed: u64) -> Result<Self, ParameterError> {
        Self::with_most_nodes(architecture, seed, MOST_NODES)
    }

    /// As [`new`](Self::new), with another limit of nodes, 1 to 2³¹. Nodes that are lost again count too. The year that
    /// would lead beyond the limit does not begin: [`years`](Self::years). Radii are measured by the wood of the last year there
    /// is, so that they differ with the limit if that cuts years off.
    ///
    /// # Errors
    /// As `new`, and a limit out of range.
    pub fn with_most_nodes(
        architecture: Architecture,
        seed: u64,
        most_nodes: u32,
    ) -> Result<Self, ParameterError> {
        Self::grown(architecture, seed, most_nodes, &Silent).map_err(|error| match error {
            GrowthError::Parameter(error) => error,
            // Nobody cancels it, and nothing else is refused.
            other => ParameterError::new("Growth", other, "grown"),
        })
    }

    /// As [`with_most_nodes`](Self::with_most_nodes), reporting progress to `observer`, which can cancel the
    /// work.
    ///
    /// # Errors
    /// As `with_most_nodes`, and [`GrowthError::Cancelled`].
    pub fn with_most_nodes_observed(
        architecture: Architecture,
        seed: u64,
        most_nodes: u32,
        observer: &dyn Observer,
    ) -> Result<Self, GrowthError> {
        Self::grown(architecture, seed, most_nodes, observer)
    }

    fn grown(
        architecture: Architecture,
        seed: u64,
        most_nodes: u32,
        observer: &dyn Observer,
    ) -> Result<Self, GrowthError> {
        architecture.check()?;
        let holds = (1..=1 << 31).contains(&most_nodes);
        ParameterError::unless(holds, "Growth.most_nodes", most_nodes, "1 to 2^31")?;
        let structure = Structure::observed(&architecture, seed, most_nodes, observer)?;
        let thickness = Thickness::new(&architecture, structure.trunk_length(), structure.all_pipes());
        Ok(Self { architecture, seed, most_nodes, structure, thickness })
    }

    /// The tree at an age in years since germination, 0 to the species' greatest age. At 0 it is a root alone, of which no
    /// mesh comes; a whole number is midwinter, when broad-leaved trees are bare: 20.6 is the 21st summer.
    ///
    /// Within a season shoots unfold; at the end of year y every branch is as long as equation 7 or 12 says for y. All
    /// places move smoothly with the age, and no wood ever gets thinner. A branch that dies, at the end of a year, stands
    /// bare for some time, a limb for years, with all it bears, before it breaks off: [`TreeAtAge::dead`]. O(nodes) time for the
    /// branches that ever were.
    ///
    /// # Errors
    /// An age that is negative, not finite or greater than the greatest; [`GrowthError::Limit`] where years are missing.
    pub fn at(&self, age: f32) -> Result<TreeAtAge, GrowthError> {
        self.at_observed(age, &Silent)
    }

    /// As [`at`](Self::at), reporting progress to `observer`, which can cancel the work.
    ///
    /// # Errors
    /// As [`at`](Self::at), and [`GrowthError::Cancelled`].
    pub fn at_observed(&self, age: f32, observer: &dyn Observer) -> Result<TreeAtAge, GrowthError> {
        let most = self.architecture.years;
        let holds = age >= 0.0 && age <= f32::from(most);
        let range = format!("0 to {most} years, the greatest age of the species");
        ParameterError::unless(holds, "Growth.age", age, &range)?;
        if let Some(nodes) = self.structure.refused.filter(|_| age > f32::from(self.structure.years)) {
            let year = self.structure.years + 1;
            return Err(GrowthError::Limit { year, nodes, limit: self.most_nodes });
        }
        form::at(self, age, observer)
    }

    /// The years that are available: all, unless the limit of nodes came first.
    pub fn years(&self) -> u16 {
        self.structure.years
    }

    /// The nodes that ever are, the root and the lost ones included; numbers of nodes are smaller.
    pub fn nodes(&self) -> usize {
        self.structure.nodes as usize
    }

    /// Branches of all orders that ever are.
    pub fn branches(&self) -> usize {
        self.structure.axes.iter().filter(|axis| axis.first_year <= self.structure.years).count()
    }

    /// The species.
    pub fn architecture(&self) -> &Architecture {
        &self.architecture
    }
}
