//! Skeletons in the formats of plant science: QSM tables, SWC and MTG, read and written.
//!
//! | format | module | who has it |
//! |---|---|---|
//! | QSM as CSV: one row per cylinder | [`read_qsm`], [`write_qsm`] | `rTwig`, `TreeQSM`, `SimpleForest`, `aRchi` |
//! | SWC: one row per node | [`read_swc`], [`write_swc`] | neuron and root tracers, `AdTree`'s converters |
//! | MTG: a graph with features | [`read_mtg`], [`write_mtg`] | `OpenAlea`, `AMAPstudio` |
//!
//! Parts of a [`Skeleton`] that each format keeps, written and read with one
//! [`Frame`](crate::cloud::Frame):
//!
//! | | QSM | SWC | MTG |
//! |---|---|---|---|
//! | positions, parents, numbers of nodes | yes | yes | yes |
//! | radii | all but the root's, which is that of its thickest child | yes | yes |
//! | [orders](Skeleton::orders) | yes | worked out anew | yes |
//! | [stages](Skeleton::stages), [hops](Skeleton::hops) | no | no | no |
//!
//! Rows may come in any order; a parent is put before its children, and rows that are so already
//! keep their order. No reader panics, hangs or believes a count: an error names the line, the
//! column, what was found there and what is required.

mod assemble;
mod mtg;
mod qsm;
mod swc;
mod table;
#[cfg(test)]
mod tests;

pub use mtg::{read_mtg, write_mtg};
pub use qsm::{read_qsm, write_qsm};
pub use swc::{read_swc, write_swc};

use std::io;

use glam::DVec3;

use crate::{ParameterError, Skeleton, SkeletonError};

/// The trees of a file, at least one.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Trees {
    /// In the order in which their first rows stand in the file.
    pub trees: Vec<Skeleton>,
    /// Offset that was taken off the file's coordinates, in its axes and unit;
    /// [`Frame::with_offset`](crate::cloud::Frame::with_offset) adds it again.
    pub offset: DVec3,
    /// Nodes that are not in the file: where a cylinder of a QSM begins beside the middle of its parent.
    pub inserted: usize,
    /// The farthest that a cylinder of a QSM begins from where its parent's axis is, metres.
    pub widest_gap: f64,
    /// `true` if the file gave branch orders that are those of a [`Skeleton`]; if false, they are
    /// computed.
    pub has_orders: bool,
}

impl Trees {
    /// The only tree.
    ///
    /// # Errors
    /// [`FormatError::Several`].
    pub fn single(mut self) -> Result<Skeleton, FormatError> {
        let trees = self.trees.len();
        self.trees.pop().filter(|_| trees == 1).ok_or(FormatError::Several { trees })
    }
}

/// Error of reading or writing a skeleton in a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The reader or writer failed.
    #[error("reading or writing failed: {0}")]
    Io(#[from] io::Error),
    /// An option out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Something in a line.
    #[error("{format}, line {line}{}: {problem}", in_column(column))]
    Line {
        /// The format's name.
        format: &'static str,
        /// The line, from 1.
        line: u64,
        /// The column's name, empty where it is the whole line.
        column: String,
        /// Description of what was found and what is required.
        problem: String,
    },
    /// Something in the whole file.
    #[error("{format}: {problem}")]
    File {
        /// The format's name.
        format: &'static str,
        /// Description of what is wrong and what is required.
        problem: String,
    },
    /// More than one tree where one is wanted.
    #[error("the file has {trees} trees, but one is wanted; Trees::trees has them all")]
    Several {
        /// Number present.
        trees: usize,
    },
    /// The file's tree is not a valid skeleton.
    #[error(transparent)]
    Skeleton(#[from] SkeletonError),
}

fn in_column(column: &str) -> String {
    if column.is_empty() { String::new() } else { format!(", column {column}") }
}

impl FormatError {
    fn line(format: &'static str, line: u64, column: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Line { format, line, column: column.into(), problem: problem.into() }
    }

    fn file(format: &'static str, problem: impl Into<String>) -> Self {
        Self::File { format, problem: problem.into() }
    }
}
