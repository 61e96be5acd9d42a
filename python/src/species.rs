//! Species: built in, or from a text of one's own.

use crate::failure::failure;
use crate::skeleton::dict;
use crate::tree::Tree;
use crate::watch;
use pyo3::prelude::*;
use treesynth::species::{self, Request};

/// A species: how its trees are shaped, how large they grow, their leaves and bark.
#[pyclass(frozen, eq, module = "treesynth")]
#[derive(PartialEq)]
pub(crate) struct Species {
    species: species::Species,
}

/// A request for a tree; values that are not given follow from the species' allometry.
#[derive(Clone, Copy, Default)]
pub(crate) struct Wish {
    pub(crate) height: Option<f32>,
    pub(crate) dbh: Option<f32>,
    pub(crate) age: Option<f32>,
    pub(crate) day: Option<f32>,
    pub(crate) stand_spacing: Option<f32>,
    pub(crate) years_dead: Option<f32>,
    pub(crate) storm_damage: Option<f32>,
}

impl Wish {
    /// The name of the first that is given.
    pub(crate) fn first(&self) -> Option<&'static str> {
        self.asked().into_iter().find(|(_, value)| value.is_some()).map(|(name, _)| name)
    }

    fn asked(&self) -> [(&'static str, Option<f32>); 7] {
        [
            ("height", self.height),
            ("dbh", self.dbh),
            ("age", self.age),
            ("day", self.day),
            ("stand_spacing", self.stand_spacing),
            ("years_dead", self.years_dead),
            ("storm_damage", self.storm_damage),
        ]
    }
}

/// Grows a tree of a species.
pub(crate) fn grow(py: Python<'_>, species: &species::Species, wish: Wish, seed: u64) -> PyResult<Tree> {
    type With<'a> = fn(Request<'a>, f32) -> Request<'a>;
    let setters: [With<'_>; 7] = [
        Request::with_height,
        Request::with_dbh,
        Request::with_age,
        Request::with_day,
        Request::in_a_stand,
        Request::with_years_dead,
        Request::with_storm_damage,
    ];
    let mut request = species.request().with_seed(seed);
    for ((_, value), set) in wish.asked().into_iter().zip(setters) {
        if let Some(value) = value {
            request = set(request, value);
        }
    }
    let specimen = watch::run(py, None, |_| request.grow().map_err(failure))?;
    Tree::of_specimen(py, specimen)
}

#[pymethods]
impl Species {
    #[staticmethod]
    fn named(name: &str) -> PyResult<Self> {
        Ok(Self { species: species::by_name(name).map_err(failure)?.clone() })
    }

    #[staticmethod]
    fn parse(text: &str) -> PyResult<Self> {
        Ok(Self { species: species::Species::parse(text).map_err(failure)? })
    }

    fn to_text(&self) -> String {
        self.species.to_text()
    }

    #[getter]
    fn name(&self) -> &str {
        &self.species.name
    }

    #[getter]
    fn latin(&self) -> &str {
        &self.species.latin
    }

    #[getter]
    fn data<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        dict(py, &self.species)
    }

    #[pyo3(signature = (*, seed = 0, height = None, dbh = None, age = None, day = None, stand_spacing = None,
        years_dead = None, storm_damage = None))]
    fn grow(
        &self,
        py: Python<'_>,
        seed: u64,
        height: Option<f32>,
        dbh: Option<f32>,
        age: Option<f32>,
        day: Option<f32>,
        stand_spacing: Option<f32>,
        years_dead: Option<f32>,
        storm_damage: Option<f32>,
    ) -> PyResult<Tree> {
        let wish = Wish { height, dbh, age, day, stand_spacing, years_dead, storm_damage };
        grow(py, &self.species, wish, seed)
    }

    fn __repr__(&self) -> String {
        format!("<treesynth.Species {:?}, {}>", self.species.name, self.species.latin)
    }

    fn __reduce__<'py>(this: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((this.get_type().getattr("parse")?, (this.get().to_text(),)))
    }
}
