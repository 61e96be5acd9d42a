//! Points: from arrays and files, from a simulated scanner, and to skeletons.

use crate::array::{Points, column, places, rows, vectors};
use crate::failure::failure;
use crate::file::{self, frame};
use crate::skeleton::Skeleton;
use crate::tree::Tree;
use crate::watch;
use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::prelude::*;
use std::path::PathBuf;
use treesynth::cloud::{self, PlyEncoding};
use treesynth::glam::Vec3;
use treesynth::reconstruct::{PointKind, Reconstruct, Reconstruction as Made, Twigs};
use treesynth::scan::{Scanner, Truth};

/// Points with what was taken off their coordinates.
#[pyclass(frozen, eq, module = "treesynth")]
#[derive(PartialEq)]
pub(crate) struct Cloud {
    cloud: cloud::Cloud,
}

#[pymethods]
impl Cloud {
    #[new]
    #[pyo3(signature = (points, *, up = "z", unit = 1.0, offset = None))]
    fn new(points: Points<'_>, up: &str, unit: f64, offset: Option<[f64; 3]>) -> PyResult<Self> {
        let places = places("points", &points)?;
        Ok(Self { cloud: cloud::Cloud::from_places(&frame(up, unit, offset)?, &places).map_err(failure)? })
    }

    /// From a `.ply`, `.las`, `.laz`, `.e57`, `.xyz`, `.txt`, `.asc` or `.pts` file.
    #[staticmethod]
    #[pyo3(signature = (path, *, up = "z", unit = 1.0, offset = None))]
    fn open(py: Python<'_>, path: PathBuf, up: &str, unit: f64, offset: Option<[f64; 3]>) -> PyResult<Self> {
        let frame = frame(up, unit, offset)?;
        watch::run(py, None, |_| Ok(Self { cloud: cloud::Cloud::open(&frame, &path).map_err(failure)? }))
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
        let frame = frame(up, unit, offset)?;
        watch::run(py, None, |_| match file::ending(&path).as_str() {
            "ply" => file::write(&path, |file| {
                self.cloud.write_ply(&frame, PlyEncoding::Little, file).map_err(failure)
            }),
            "xyz" | "txt" | "asc" | "pts" => {
                file::write(&path, |file| self.cloud.write_xyz(&frame, file).map_err(failure))
            }
            _ => Err(file::unknown(&path, ".ply, .xyz, .txt, .asc or .pts")),
        })
    }

    #[getter]
    fn points<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        rows(this.as_any(), this.get().cloud.points())
    }

    #[getter]
    fn offset(&self) -> [f64; 3] {
        self.cloud.offset().to_array()
    }

    fn thinned(&self, py: Python<'_>, side: f32) -> PyResult<Self> {
        watch::run(py, None, |_| Ok(Self { cloud: self.cloud.thinned(side).map_err(failure)? }))
    }

    fn __len__(&self) -> usize {
        self.cloud.len()
    }

    fn __repr__(&self) -> String {
        format!("<treesynth.Cloud of {} points>", self.cloud.len())
    }
}

/// The measurement of a simulated scanner, with the surface that each point lies on.
#[pyclass(frozen, module = "treesynth")]
pub(crate) struct Scan {
    cloud: Py<Cloud>,
    truth: Vec<Truth>,
}

#[pymethods]
impl Scan {
    #[getter]
    fn cloud(&self, py: Python<'_>) -> Py<Cloud> {
        self.cloud.clone_ref(py)
    }

    #[getter]
    fn is_wood<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        self.truth.iter().map(|truth| truth.part == 0).collect::<Vec<_>>().into_pyarray(py)
    }

    #[getter]
    fn is_ground<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        self.truth.iter().map(|truth| truth.part == Truth::GROUND).collect::<Vec<_>>().into_pyarray(py)
    }

    #[getter]
    fn nodes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        self.truth.iter().map(|truth| truth.node).collect::<Vec<_>>().into_pyarray(py)
    }
}

/// Scans a tree, with its leaves or without.
#[pyfunction]
#[pyo3(signature = (tree, *, places = None, distance = 10.0, stations = 3, step = 0.0006, noise = 0.002, range = 100.0,
    ground = None, leaves = true, seed = 1))]
pub(crate) fn scan(
    py: Python<'_>,
    tree: &Tree,
    places: Option<Points<'_>>,
    distance: f32,
    stations: usize,
    step: f32,
    noise: f32,
    range: f32,
    ground: Option<f32>,
    leaves: bool,
    seed: u64,
) -> PyResult<Scan> {
    let scanner = match places {
        Some(places) => Scanner::new(vectors("places", &places)?),
        None => Scanner::around(Vec3::Y * 1.5, distance, stations),
    };
    let mut scanner = scanner.with_step(step).with_noise(noise).with_range(range);
    if let Some(height) = ground {
        scanner = scanner.with_ground(height);
    }
    let measured = watch::run(py, None, |_| {
        let mesh = tree.scanned_bark()?;
        let mut parts = vec![treesynth::surface::Part::new(&mesh)];
        if leaves {
            parts.extend(tree.leaf_parts());
        }
        scanner.scan(&parts, seed).map_err(failure)
    })?;
    Ok(Scan { cloud: Py::new(py, Cloud { cloud: measured.cloud })?, truth: measured.truth })
}

/// A tree made of points.
#[pyclass(frozen, module = "treesynth")]
pub(crate) struct Reconstruction {
    skeleton: Py<Skeleton>,
    made: Made,
}

impl Reconstruction {
    fn of(py: Python<'_>, made: Made) -> PyResult<Self> {
        Ok(Self { skeleton: Py::new(py, Skeleton::from(made.skeleton.clone()))?, made })
    }
}

/// For each point whether it was taken for this.
fn kind<'py>(py: Python<'py>, kinds: &[PointKind], wanted: PointKind) -> Bound<'py, PyArray1<bool>> {
    kinds.iter().map(|&kind| kind == wanted).collect::<Vec<_>>().into_pyarray(py)
}

#[pymethods]
impl Reconstruction {
    #[getter]
    fn skeleton(&self, py: Python<'_>) -> Py<Skeleton> {
        self.skeleton.clone_ref(py)
    }

    #[getter]
    fn offset(&self) -> [f64; 3] {
        self.made.offset.to_array()
    }

    #[getter]
    fn is_measured<'py>(this: &Bound<'py, Self>) -> Bound<'py, PyArray1<bool>> {
        column(this.as_any(), &this.get().made.is_measured)
    }

    #[getter]
    fn is_wood<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        kind(py, &self.made.kinds, PointKind::Wood)
    }

    #[getter]
    fn is_leaf<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        kind(py, &self.made.kinds, PointKind::Leaf)
    }

    #[getter]
    fn ground(&self) -> usize {
        self.made.ground
    }

    #[pyo3(signature = (*, spacing = 0.08, reach = 6, thickest = 0.02, tip_radius = 0.0015, seed = 1))]
    fn completed(
        &self,
        py: Python<'_>,
        spacing: f32,
        reach: u32,
        thickest: f32,
        tip_radius: f32,
        seed: u64,
    ) -> PyResult<(Skeleton, usize)> {
        let twigs = Twigs::default().with_spacing(spacing).with_reach(reach);
        let twigs = twigs.with_thickest(thickest).with_tip_radius(tip_radius);
        let whole = watch::run(py, None, |_| self.made.completed(&twigs, seed).map_err(failure))?;
        Ok((whole.skeleton.into(), whole.measured))
    }
}

/// The trees of a cloud.
#[pyclass(frozen, module = "treesynth")]
pub(crate) struct ReconstructedStand {
    trees: Vec<Py<Reconstruction>>,
    owners: Vec<i64>,
    kinds: Vec<PointKind>,
}

#[pymethods]
impl ReconstructedStand {
    #[getter]
    fn trees(&self, py: Python<'_>) -> Vec<Py<Reconstruction>> {
        self.trees.iter().map(|tree| tree.clone_ref(py)).collect()
    }

    #[getter]
    fn owners<'py>(this: &Bound<'py, Self>) -> Bound<'py, PyArray1<i64>> {
        column(this.as_any(), &this.get().owners)
    }

    #[getter]
    fn is_wood<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        kind(py, &self.kinds, PointKind::Wood)
    }

    #[getter]
    fn is_leaf<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        kind(py, &self.kinds, PointKind::Leaf)
    }

    #[getter]
    fn is_ground<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        kind(py, &self.kinds, PointKind::Ground)
    }

    fn __len__(&self) -> usize {
        self.trees.len()
    }

    fn __repr__(&self) -> String {
        format!("<treesynth.ReconstructedStand of {} trees>", self.trees.len())
    }
}

/// The options that one tree and a stand share.
fn options(
    side: Option<f32>,
    gap: f32,
    tip_radius: f32,
    ground: bool,
    set_leaves_aside: bool,
) -> Reconstruct {
    let how = Reconstruct::default().with_gap(gap).with_tip_radius(tip_radius).with_ground(ground);
    let how = how.with_leaves_set_aside(set_leaves_aside);
    side.map_or(how, |side| how.with_side(side))
}

/// The skeleton and radii of the tree whose points these are.
#[pyfunction]
#[pyo3(signature = (cloud, *, base = None, side = None, gap = 0.5, tip_radius = 0.0015, ground = true,
    set_leaves_aside = false))]
pub(crate) fn reconstruct(
    py: Python<'_>,
    cloud: &Cloud,
    base: Option<[f32; 3]>,
    side: Option<f32>,
    gap: f32,
    tip_radius: f32,
    ground: bool,
    set_leaves_aside: bool,
) -> PyResult<Reconstruction> {
    let mut how = options(side, gap, tip_radius, ground, set_leaves_aside);
    if let Some(base) = base {
        how = how.with_base(Vec3::from(base));
    }
    let made = watch::run(py, None, |_| how.reconstruct(&cloud.cloud).map_err(failure))?;
    Reconstruction::of(py, made)
}

/// All trees of a cloud, one for each trunk, or for each of `bases`.
#[pyfunction]
#[pyo3(signature = (cloud, *, bases = None, side = None, gap = 0.5, tip_radius = 0.0015, ground = true,
    set_leaves_aside = false))]
pub(crate) fn reconstruct_stand(
    py: Python<'_>,
    cloud: &Cloud,
    bases: Option<Points<'_>>,
    side: Option<f32>,
    gap: f32,
    tip_radius: f32,
    ground: bool,
    set_leaves_aside: bool,
) -> PyResult<ReconstructedStand> {
    let how = options(side, gap, tip_radius, ground, set_leaves_aside);
    let bases = bases.map(|bases| vectors("bases", &bases)).transpose()?;
    let stand = watch::run(py, None, |_| {
        match &bases {
            Some(bases) => how.reconstruct_stand_at(&cloud.cloud, bases),
            None => how.reconstruct_stand(&cloud.cloud),
        }
        .map_err(failure)
    })?;
    let tree = |made| Py::new(py, Reconstruction::of(py, made)?);
    Ok(ReconstructedStand {
        trees: stand.trees.into_iter().map(tree).collect::<PyResult<_>>()?,
        owners: stand.owners.iter().map(|owner| owner.map_or(-1, i64::from)).collect(),
        kinds: stand.kinds,
    })
}
