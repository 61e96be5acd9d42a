//! Pipelines of the guided system as data.

use crate::failure::failure;
use crate::skeleton::{Skeleton, dict};
use crate::watch;
use pyo3::prelude::*;
use treesynth::guided;
use treesynth::presets::{self, Found};

/// Graph, stages, shedding and radii of a tree of the guided system.
#[pyclass(frozen, eq, module = "treesynth")]
#[derive(PartialEq)]
pub(crate) struct Recipe {
    recipe: guided::Recipe,
}

#[pymethods]
impl Recipe {
    #[staticmethod]
    #[pyo3(signature = (name, nodes = 150_000))]
    fn preset(name: &str, nodes: usize) -> PyResult<Self> {
        let preset = presets::by_name(name).and_then(Found::guided).map_err(failure)?;
        let recipe = preset.recipe(nodes).with_seed(preset.seed);
        recipe.check().map_err(failure)?;
        Ok(Self { recipe })
    }

    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        Ok(Self { recipe: guided::Recipe::from_json(text).map_err(failure)? })
    }

    /// From what `data` gives, changed or not.
    #[staticmethod]
    fn from_data(data: &Bound<'_, PyAny>) -> PyResult<Self> {
        let text: String = data.py().import("json")?.call_method1("dumps", (data,))?.extract()?;
        Self::from_json(&text)
    }

    fn to_json(&self) -> PyResult<String> {
        self.recipe.to_json().map_err(failure)
    }

    #[getter]
    fn data<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        dict(py, &self.recipe)
    }

    #[getter]
    fn seed(&self) -> u64 {
        self.recipe.seed
    }

    #[pyo3(signature = (seed = None, *, progress = None))]
    fn grow(&self, py: Python<'_>, seed: Option<u64>, progress: Option<Py<PyAny>>) -> PyResult<Skeleton> {
        let seed = seed.unwrap_or(self.recipe.seed);
        watch::run(py, progress, |observer| {
            Ok(self.recipe.synth().synthesize_observed(seed, observer).map_err(failure)?.into())
        })
    }

    fn __repr__(&self) -> String {
        format!("<treesynth.Recipe of {} stages, seed {}>", self.recipe.stages.len(), self.recipe.seed)
    }

    fn __reduce__<'py>(this: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((this.get_type().getattr("from_json")?, (this.get().to_json()?,)))
    }
}
