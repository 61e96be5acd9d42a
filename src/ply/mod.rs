//! PLY files of any content, after Turk's description of 1994, <https://paulbourke.net/dataformats/ply/>: the header, then the
//! values one after the other. Meshes and point clouds are read with it.

mod header;
mod values;

#[cfg(feature = "import")]
pub(crate) use header::Element;
pub(crate) use header::{Header, Kind};
pub(crate) use values::Values;

/// A problem in a file, and its place.
#[derive(Debug)]
pub(crate) struct Fault {
    pub(crate) place: String,
    pub(crate) problem: String,
}

fn fault(place: impl std::fmt::Display, problem: impl std::fmt::Display) -> Fault {
    Fault { place: place.to_string(), problem: problem.to_string() }
}
