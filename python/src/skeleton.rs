//! Skeletons: positions, parents, radii, orders.

use crate::array::{Points, column, rows, vectors};
use crate::failure::{failure, refused};
use crate::file;
use crate::mesh::Mesh;
use crate::watch;
use numpy::{AllowTypeChange, PyArray1, PyArray2, PyArrayLike1};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::path::PathBuf;
use treesynth::Metrics;
use treesynth::export::{self, SvgOptions};
use treesynth::format::{write_mtg, write_qsm, write_swc};
use treesynth::metrics::diameter_at;
use treesynth::surface::{Implicit, Tubes};

/// A tree's nodes, each after its parent.
#[pyclass(frozen, eq, module = "treesynth")]
#[derive(PartialEq, Clone)]
pub(crate) struct Skeleton {
    pub(crate) tree: treesynth::Skeleton,
    parents: Vec<i64>,
}

impl From<treesynth::Skeleton> for Skeleton {
    fn from(tree: treesynth::Skeleton) -> Self {
        let parents =
            (0..tree.len()).map(|node| tree.parent(node).map_or(-1, |parent| parent as i64)).collect();
        Self { tree, parents }
    }
}

type Column<'py, T> = PyArrayLike1<'py, T, AllowTypeChange>;

fn numbers<T: numpy::Element + Copy>(column: Option<&Column<'_, T>>) -> Option<Vec<T>> {
    column.map(|column| column.as_array().iter().copied().collect())
}

/// Whole numbers of 0 to the greatest of their type.
fn whole<T: TryFrom<i64>>(name: &str, column: Option<&Column<'_, i64>>) -> PyResult<Option<Vec<T>>> {
    let Some(column) = column else { return Ok(None) };
    let one = |&value: &i64| {
        T::try_from(value).map_err(|_| {
            refused(format!("{name} is {value}, but must be 0 to {}", (1_u128 << (8 * size_of::<T>())) - 1))
        })
    };
    column.as_array().iter().map(one).collect::<PyResult<_>>().map(Some)
}

#[pymethods]
impl Skeleton {
    #[new]
    #[pyo3(signature = (positions, parents, radii = None, *, orders = None, stages = None, hops = None))]
    fn new(
        positions: Points<'_>,
        parents: Column<'_, i64>,
        radii: Option<Column<'_, f32>>,
        orders: Option<Column<'_, i64>>,
        stages: Option<Column<'_, i64>>,
        hops: Option<Column<'_, i64>>,
    ) -> PyResult<Self> {
        let parent = |&parent: &i64| match parent {
            -1 => Ok(None),
            parent => u32::try_from(parent).map(Some).map_err(|_| {
                refused(format!(
                    "parents has {parent}, but must have -1 for the root and 0 to 4294967295 for others"
                ))
            }),
        };
        let parents = parents.as_array().iter().map(parent).collect::<PyResult<_>>()?;
        let mut tree =
            treesynth::Skeleton::new(vectors("positions", &positions)?, parents).map_err(failure)?;
        if let Some(radii) = numbers(radii.as_ref()) {
            tree = tree.with_radii(radii).map_err(failure)?;
        }
        if let Some(orders) = whole("orders", orders.as_ref())? {
            tree = tree.with_orders(orders).map_err(failure)?;
        }
        if let Some(stages) = whole("stages", stages.as_ref())? {
            tree = tree.with_stages(stages).map_err(failure)?;
        }
        if let Some(hops) = whole("hops", hops.as_ref())? {
            tree = tree.with_hops(hops).map_err(failure)?;
        }
        Ok(tree.into())
    }

    #[getter]
    fn positions<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        rows(this.as_any(), this.get().tree.positions())
    }

    #[getter]
    fn parents<'py>(this: &Bound<'py, Self>) -> Bound<'py, PyArray1<i64>> {
        column(this.as_any(), &this.get().parents)
    }

    #[getter]
    fn radii<'py>(this: &Bound<'py, Self>) -> Bound<'py, PyArray1<f32>> {
        column(this.as_any(), this.get().tree.radii())
    }

    #[getter]
    fn orders<'py>(this: &Bound<'py, Self>) -> Bound<'py, PyArray1<u16>> {
        column(this.as_any(), this.get().tree.orders())
    }

    #[getter]
    fn stages<'py>(this: &Bound<'py, Self>) -> Bound<'py, PyArray1<u16>> {
        column(this.as_any(), this.get().tree.stages())
    }

    #[getter]
    fn hops<'py>(this: &Bound<'py, Self>) -> Bound<'py, PyArray1<u32>> {
        column(this.as_any(), this.get().tree.hops())
    }

    fn __len__(&self) -> usize {
        self.tree.len()
    }

    fn __repr__(&self) -> String {
        format!("<treesynth.Skeleton of {} nodes, {} tips>", self.tree.len(), self.tree.tips().count())
    }

    /// For `pickle` and `copy`.
    fn __reduce__<'py>(this: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let py = this.py();
        let text = treesynth_json(&this.get().tree)?;
        let read = this.get_type().getattr("_from_json")?;
        Ok((read, PyTuple::new(py, [text])?))
    }

    #[staticmethod]
    fn _from_json(text: &str) -> PyResult<Self> {
        Ok(export::read_skeleton(text.as_bytes()).map_err(failure)?.into())
    }

    fn metrics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let metrics = watch::run(py, None, |_| Ok(Metrics::of(&self.tree)))?;
        dict(py, &metrics)
    }

    fn diameter_at(&self, height: f64) -> Option<f64> {
        diameter_at(&self.tree, height)
    }

    #[pyo3(signature = (share = 0.5, passes = 3))]
    fn relaxed(&self, share: f32, passes: u32) -> PyResult<Self> {
        Ok(self.tree.relaxed(share, passes).map_err(failure)?.into())
    }

    #[pyo3(signature = (sides = 8, *, progress = None))]
    fn mesh(&self, py: Python<'_>, sides: u32, progress: Option<Py<PyAny>>) -> PyResult<Mesh> {
        let tubes = Tubes::default().with_sides(sides);
        watch::run(py, progress, |observer| {
            Ok(Mesh::new("bark", tubes.mesh_observed(&self.tree, observer).map_err(failure)?))
        })
    }

    #[pyo3(signature = (detail = 1.0, *, progress = None))]
    fn closed_mesh(&self, py: Python<'_>, detail: f32, progress: Option<Py<PyAny>>) -> PyResult<Mesh> {
        let surface = Implicit::default().with_detail(detail);
        watch::run(py, progress, |observer| {
            Ok(Mesh::new("bark", surface.mesh_observed(&self.tree, observer).map_err(failure)?))
        })
    }

    #[pyo3(signature = (path, *, up = "z", unit = 1.0, offset = None))]
    fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        up: &str,
        unit: f64,
        offset: Option<[f64; 3]>,
    ) -> PyResult<()> {
        let frame = file::frame(up, unit, offset)?;
        watch::run(py, None, |_| {
            let tree = &self.tree;
            match file::ending(&path).as_str() {
                "json" => file::write(&path, |file| export::write_skeleton(tree, file).map_err(failure)),
                "svg" => file::write(&path, |file| {
                    export::write_svg(tree, &SvgOptions::default(), file).map_err(failure)
                }),
                "swc" => file::write(&path, |file| write_swc(tree, &frame, file).map_err(failure)),
                "mtg" => file::write(&path, |file| write_mtg(tree, &frame, file).map_err(failure)),
                "csv" | "qsm" => file::write(&path, |file| write_qsm(tree, &frame, file).map_err(failure)),
                _ => Err(file::unknown(&path, ".json, .svg, .swc, .csv, .qsm or .mtg")),
            }
        })
    }
}

fn treesynth_json(tree: &treesynth::Skeleton) -> PyResult<String> {
    let mut text = Vec::new();
    export::write_skeleton(tree, &mut text).map_err(failure)?;
    String::from_utf8(text).map_err(failure)
}

/// A value that serializes, as Python's dictionaries, lists and numbers.
pub(crate) fn dict<'py>(py: Python<'py>, value: &impl serde::Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(failure)?;
    py.import("json")?.call_method1("loads", (text,))
}
