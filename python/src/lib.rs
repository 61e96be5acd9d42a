//! The extension module behind the Python package `treesynth`. What each name does is said in `treesynth/_treesynth.pyi`.

mod array;
mod asset;
mod cloud;
mod example;
mod failure;
mod file;
mod forest;
mod growth;
mod landscape;
mod mesh;
mod recipe;
mod skeleton;
mod species;
mod tree;
mod watch;

use pyo3::prelude::*;

#[pymodule]
fn _treesynth(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("TreesynthError", module.py().get_type::<failure::TreesynthError>())?;
    module.add_class::<skeleton::Skeleton>()?;
    module.add_class::<mesh::Mesh>()?;
    module.add_class::<mesh::Leaves>()?;
    module.add_class::<tree::Tree>()?;
    module.add_class::<asset::Asset>()?;
    module.add_class::<species::Species>()?;
    module.add_class::<recipe::Recipe>()?;
    module.add_class::<forest::Forest>()?;
    module.add_class::<growth::Growth>()?;
    module.add_class::<landscape::Landscape>()?;
    module.add_class::<landscape::Tile>()?;
    module.add_class::<cloud::Cloud>()?;
    module.add_class::<cloud::Scan>()?;
    module.add_class::<cloud::Reconstruction>()?;
    module.add_class::<cloud::ReconstructedStand>()?;
    module.add_class::<example::Example>()?;
    module.add_function(wrap_pyfunction!(tree::grow, module)?)?;
    module.add_function(wrap_pyfunction!(tree::fill, module)?)?;
    module.add_function(wrap_pyfunction!(tree::names, module)?)?;
    module.add_function(wrap_pyfunction!(file::read_trees, module)?)?;
    module.add_function(wrap_pyfunction!(cloud::scan, module)?)?;
    module.add_function(wrap_pyfunction!(cloud::reconstruct, module)?)?;
    module.add_function(wrap_pyfunction!(cloud::reconstruct_stand, module)?)?;
    module.add_function(wrap_pyfunction!(landscape::write_tileset, module)?)
}
