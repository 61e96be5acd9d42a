//! Forests that grow season by season.

use crate::failure::{failure, refused};
use crate::skeleton::Skeleton;
use crate::watch;
use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};
use treesynth::glam::Vec3;
use treesynth::presets::{self, Found, Stand};
use treesynth::self_organizing::{Environment, ForestError};
use treesynth::{Observer, Progress, Work};

/// A forest in any environment, with its gardener.
trait Growing: Send {
    fn grow(&mut self, seasons: u32, observer: &dyn Observer) -> Result<(), ForestError>;
    fn season(&self) -> u16;
    fn metamers(&self) -> usize;
    fn skeletons(&self) -> Result<Vec<treesynth::Skeleton>, ForestError>;
    fn places(&self) -> Vec<Vec3>;
    fn json(&self) -> serde_json::Result<String>;
}

struct Tended<E: Environment + 'static> {
    forest: treesynth::Forest<E>,
    stand: &'static Stand<E>,
}

impl<E: Environment + serde::Serialize + Send + Sync> Growing for Tended<E> {
    fn grow(&mut self, seasons: u32, observer: &dyn Observer) -> Result<(), ForestError> {
        for index in 0..seasons {
            let one_of_all = |mut progress: Progress| {
                if let Work::Season { .. } = progress.work {
                    progress.work = Work::Season { index, of: seasons };
                }
                observer.report(progress)
            };
            self.forest.grow_observed(1, &one_of_all)?;
            self.stand.tend(&mut self.forest)?;
        }
        Ok(())
    }

    fn season(&self) -> u16 {
        self.forest.season()
    }

    fn metamers(&self) -> usize {
        self.forest.metamers()
    }

    fn skeletons(&self) -> Result<Vec<treesynth::Skeleton>, ForestError> {
        self.forest.skeletons()
    }

    fn places(&self) -> Vec<Vec3> {
        self.forest.trees().iter().map(treesynth::self_organizing::Tree::foot).collect()
    }

    fn json(&self) -> serde_json::Result<String> {
        serde_json::to_string(&self.forest)
    }
}

/// A stand of the self-organizing system.
#[pyclass(frozen, module = "treesynth")]
pub(crate) struct Forest {
    name: &'static str,
    forest: Mutex<Box<dyn Growing>>,
}

impl Forest {
    fn lock(&self) -> MutexGuard<'_, Box<dyn Growing>> {
        self.forest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The answer to `ask`; the forest may be growing on another thread, so Python goes on while
    /// this waits.
    fn ask<T: Send>(&self, py: Python<'_>, ask: impl FnOnce(&dyn Growing) -> T + Send) -> T {
        py.detach(|| ask(self.lock().as_ref()))
    }

    fn of<E>(
        stand: &'static Stand<E>,
        make: impl FnOnce(&Stand<E>) -> PyResult<treesynth::Forest<E>>,
    ) -> PyResult<Self>
    where
        E: Environment + serde::Serialize + Send + Sync + 'static,
    {
        let forest = make(stand)?;
        Ok(Self { name: stand.name, forest: Mutex::new(Box::new(Tended { forest, stand })) })
    }
}

/// The stand as it is planted.
fn planted<E: Environment>(
    stand: &Stand<E>,
    seed: Option<u64>,
    most_metamers: Option<usize>,
) -> PyResult<treesynth::Forest<E>> {
    let forest = stand.plant(seed.unwrap_or(stand.seed)).map_err(failure)?;
    Ok(match most_metamers {
        Some(metamers) => forest.with_most_metamers(metamers),
        None => forest,
    })
}

#[pymethods]
impl Forest {
    #[new]
    #[pyo3(signature = (name, *, seed = None, most_metamers = None))]
    fn new(name: &str, seed: Option<u64>, most_metamers: Option<usize>) -> PyResult<Self> {
        match presets::by_name(name).map_err(failure)? {
            Found::Space(stand) => Self::of(stand, |stand| planted(stand, seed, most_metamers)),
            found => Self::of(found.stand().map_err(failure)?, |stand| planted(stand, seed, most_metamers)),
        }
    }

    /// Goes on with a forest of this name that `to_json` has saved.
    #[staticmethod]
    fn from_json(name: &str, text: &str) -> PyResult<Self> {
        let wrong = |error: serde_json::Error| refused(format!("text: {error}"));
        match presets::by_name(name).map_err(failure)? {
            Found::Space(stand) => Self::of(stand, |_| serde_json::from_str(text).map_err(wrong)),
            found => {
                let stand = found.stand().map_err(failure)?;
                Self::of(stand, |_| serde_json::from_str(text).map_err(wrong))
            }
        }
    }

    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        self.ask(py, |forest| forest.json().map_err(failure))
    }

    #[getter]
    fn name(&self) -> &'static str {
        self.name
    }

    #[pyo3(signature = (seasons = 1, *, progress = None))]
    fn grow(&self, py: Python<'_>, seasons: u32, progress: Option<Py<PyAny>>) -> PyResult<()> {
        watch::run(py, progress, |observer| self.lock().grow(seasons, observer).map_err(failure))
    }

    #[getter]
    fn season(&self, py: Python<'_>) -> u16 {
        self.ask(py, |forest| forest.season())
    }

    #[getter]
    fn metamers(&self, py: Python<'_>) -> usize {
        self.ask(py, |forest| forest.metamers())
    }

    #[getter]
    fn trees(&self, py: Python<'_>) -> PyResult<Vec<Skeleton>> {
        let trees = self.ask(py, |forest| forest.skeletons()).map_err(failure)?;
        Ok(trees.into_iter().map(Skeleton::from).collect())
    }

    #[getter]
    fn places<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let places = self.ask(py, |forest| forest.places());
        let places: Vec<f32> = places.into_iter().flat_map(|place| place.to_array()).collect();
        let count = places.len() / 3;
        places.into_pyarray(py).reshape([count, 3])
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        self.ask(py, |forest| {
            let (trees, metamers, season) = (forest.places().len(), forest.metamers(), forest.season());
            format!(
                "<treesynth.Forest {:?} after {season} seasons: {trees} trees, {metamers} metamers>",
                self.name
            )
        })
    }

    fn __reduce__<'py>(this: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (&'static str, String))> {
        Ok((this.get_type().getattr("from_json")?, (this.get().name, this.get().to_json(this.py())?)))
    }
}
