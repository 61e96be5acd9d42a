//! Forests that grow season by season.

use crate::failure::failure;
use crate::skeleton::Skeleton;
use crate::watch;
use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};
use treesynth::presets::{self, Found};

/// A stand of the self-organizing system.
#[pyclass(frozen, module = "treesynth")]
pub(crate) struct Forest {
    forest: Mutex<treesynth::Forest>,
}

impl Forest {
    fn lock(&self) -> MutexGuard<'_, treesynth::Forest> {
        self.forest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What `ask` finds; the forest may be growing on another thread, so Python goes on while this waits.
    fn ask<T: Send>(&self, py: Python<'_>, ask: impl FnOnce(&treesynth::Forest) -> T + Send) -> T {
        py.detach(|| ask(&self.lock()))
    }
}

#[pymethods]
impl Forest {
    #[new]
    #[pyo3(signature = (name, *, seed = None, most_metamers = None))]
    fn new(name: &str, seed: Option<u64>, most_metamers: Option<usize>) -> PyResult<Self> {
        let stand = presets::by_name(name).and_then(Found::stand).map_err(failure)?;
        let mut forest = stand.plant(seed.unwrap_or(stand.seed)).map_err(failure)?;
        if let Some(metamers) = most_metamers {
            forest = forest.with_most_metamers(metamers);
        }
        Ok(Self { forest: Mutex::new(forest) })
    }

    /// Goes on with a forest that `to_json` has saved.
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        Ok(Self { forest: Mutex::new(serde_json::from_str(text).map_err(failure)?) })
    }

    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        self.ask(py, |forest| serde_json::to_string(forest).map_err(failure))
    }

    #[pyo3(signature = (seasons = 1, *, progress = None))]
    fn grow(&self, py: Python<'_>, seasons: u32, progress: Option<Py<PyAny>>) -> PyResult<()> {
        watch::run(py, progress, |observer| self.lock().grow_observed(seasons, observer).map_err(failure))
    }

    #[getter]
    fn season(&self, py: Python<'_>) -> u16 {
        self.ask(py, treesynth::Forest::season)
    }

    #[getter]
    fn metamers(&self, py: Python<'_>) -> usize {
        self.ask(py, treesynth::Forest::metamers)
    }

    #[getter]
    fn trees(&self, py: Python<'_>) -> PyResult<Vec<Skeleton>> {
        let trees = self.ask(py, treesynth::Forest::skeletons).map_err(failure)?;
        Ok(trees.into_iter().map(Skeleton::from).collect())
    }

    #[getter]
    fn places<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let places: Vec<f32> =
            self.ask(py, |forest| forest.trees().iter().flat_map(|tree| tree.foot().to_array()).collect());
        let count = places.len() / 3;
        places.into_pyarray(py).reshape([count, 3])
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        self.ask(py, |forest| {
            let (trees, metamers, season) = (forest.trees().len(), forest.metamers(), forest.season());
            format!("<treesynth.Forest after {season} seasons: {trees} trees, {metamers} metamers>")
        })
    }

    fn __reduce__<'py>(this: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((this.get_type().getattr("from_json")?, (this.get().to_json(this.py())?,)))
    }
}
