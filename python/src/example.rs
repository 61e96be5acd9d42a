//! More trees of the kind of an example.

use crate::failure::failure;
use crate::skeleton::{Skeleton, dict};
use crate::watch;
use pyo3::prelude::*;
use serde_json::json;
use treesynth::guided;

/// Traits of a tree, and more trees of its kind.
#[pyclass(frozen, module = "treesynth")]
pub(crate) struct Example {
    example: guided::Example,
}

#[pymethods]
impl Example {
    #[new]
    fn new(py: Python<'_>, skeleton: &Skeleton) -> PyResult<Self> {
        let tree = &skeleton.tree;
        watch::run(py, None, |_| Ok(Self { example: guided::Example::of(tree).map_err(failure)? }))
    }

    #[pyo3(signature = (nodes = 40_000, trials = 8))]
    fn tuned(&self, py: Python<'_>, nodes: usize, trials: u32) -> PyResult<Self> {
        let example = self.example.clone();
        watch::run(py, None, |_| Ok(Self { example: example.tuned(nodes, trials).map_err(failure)? }))
    }

    #[pyo3(signature = (nodes = 40_000, seed = 1))]
    fn grow(&self, py: Python<'_>, nodes: usize, seed: u64) -> PyResult<Skeleton> {
        watch::run(py, None, |_| Ok(self.example.grow(nodes, seed).map_err(failure)?.into()))
    }

    #[getter]
    fn trunk<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let trunk = self.example.trunk();
        let traits = json!({
            "chord": trunk.chord.to_array(),
            "waywardness": trunk.waywardness,
            "clear_bole": trunk.clear_bole,
            "diameter": trunk.diameter,
        });
        dict(py, &traits)
    }

    #[getter]
    fn orders<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let traits = |order: &guided::OrderTraits| {
            json!({
                "count": order.count,
                "length": order.length,
                "length_spread": order.length_spread,
                "angle": order.angle,
                "angle_spread": order.angle_spread,
                "bend": order.bend,
                "spacing": order.spacing,
                "bare_base": order.bare_base,
            })
        };
        dict(py, &self.example.orders().iter().map(traits).collect::<Vec<_>>())
    }

    fn __repr__(&self) -> String {
        format!("<treesynth.Example of {} branching orders>", self.example.orders().len())
    }
}
