//! A tree over the years.

use crate::failure::{failure, refused};
use crate::tree::Tree;
use crate::watch;
use pyo3::prelude::*;
use serde_json::json;
use treesynth::growth;
use treesynth::presets::{self, Found, Grown};

/// One tree at all its ages.
#[pyclass(frozen, module = "treesynth")]
pub(crate) struct Growth {
    preset: &'static Grown,
    seed: u64,
    growth: growth::Growth,
}

#[pymethods]
impl Growth {
    #[new]
    #[pyo3(signature = (name, *, seed = None))]
    fn new(py: Python<'_>, name: &str, seed: Option<u64>) -> PyResult<Self> {
        let preset = presets::by_name(name).and_then(Found::grown).map_err(failure)?;
        let seed = seed.unwrap_or(preset.seed);
        let growth = watch::run(py, None, |_| preset.grow(seed).map_err(failure))?;
        Ok(Self { preset, seed, growth })
    }

    #[getter]
    fn years(&self) -> u16 {
        self.growth.years()
    }

    #[pyo3(signature = (age, *, progress = None))]
    fn at(&self, py: Python<'_>, age: f32, progress: Option<Py<PyAny>>) -> PyResult<Tree> {
        let stand =
            watch::run(py, progress, |observer| self.growth.at_observed(age, observer).map_err(failure))?;
        if stand.skeleton.segments() == 0 {
            return Err(refused(format!("age is {age}, but nothing has sprouted then")));
        }
        let leaves = self.preset.leaves(&stand);
        let bark = (self.preset.bark(), self.preset.bark_texture().with_seed(self.seed));
        Tree::new(py, (self.preset.name, self.seed), stand.skeleton, leaves, bark, json!({ "age": age }))
    }

    fn __repr__(&self) -> String {
        format!(
            "<treesynth.Growth {:?}, seed {}: {} years>",
            self.preset.name,
            self.seed,
            self.growth.years()
        )
    }
}
