//! Triangles, and leaves: one mesh in many places.

use crate::array::{column, rows};
use crate::failure::refused;
use numpy::ndarray::ArrayView2;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, ToPyArray};
use pyo3::prelude::*;
use treesynth::foliage;
use treesynth::surface;

/// Triangles with what each vertex has.
#[pyclass(frozen, eq, module = "treesynth")]
#[derive(PartialEq)]
pub(crate) struct Mesh {
    name: String,
    pub(crate) mesh: surface::Mesh,
}

impl Mesh {
    pub(crate) fn new(name: impl Into<String>, mesh: surface::Mesh) -> Self {
        Self { name: name.into(), mesh }
    }
}

#[pymethods]
impl Mesh {
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    #[getter]
    fn positions<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        rows(this.as_any(), &this.get().mesh.positions)
    }

    #[getter]
    fn normals<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        rows(this.as_any(), &this.get().mesh.normals)
    }

    #[getter]
    fn uvs<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        rows(this.as_any(), &this.get().mesh.uvs)
    }

    #[getter]
    fn colors<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        rows(this.as_any(), &this.get().mesh.colors)
    }

    #[getter]
    fn triangles<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let indices: Bound<'py, PyArray1<u32>> = column(this.as_any(), &this.get().mesh.indices);
        indices.reshape([this.get().mesh.indices.len() / 3, 3])
    }

    fn __repr__(&self) -> String {
        format!(
            "<treesynth.Mesh {:?} of {} vertices, {} triangles>",
            self.name,
            self.mesh.positions.len(),
            self.mesh.triangles().len()
        )
    }
}

/// Leaves of one kind, or flowers, fruit, cones.
#[pyclass(frozen, module = "treesynth")]
pub(crate) struct Leaves {
    pub(crate) leaves: foliage::Leaves,
}

#[pymethods]
impl Leaves {
    #[getter]
    fn mesh(&self) -> Mesh {
        Mesh::new("leaf", self.leaves.leaf.mesh().clone())
    }

    #[getter]
    fn nodes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        self.leaves.instances.iter().map(|instance| instance.node).collect::<Vec<_>>().into_pyarray(py)
    }

    #[getter]
    fn tints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let tints: Vec<f32> = self.leaves.instances.iter().flat_map(|instance| instance.tint).collect();
        let view = ArrayView2::from_shape((self.leaves.instances.len(), 3), &tints)
            .map_err(|error| refused(error.to_string()))?;
        Ok(view.to_pyarray(py))
    }

    #[getter]
    fn matrices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let mut numbers = Vec::with_capacity(self.leaves.instances.len() * 16);
        for instance in &self.leaves.instances {
            let (matrix, place) = (instance.matrix(), instance.position);
            for row in 0..3 {
                numbers.extend(matrix.row(row).to_array());
                numbers.push(place[row]);
            }
            numbers.extend([0.0, 0.0, 0.0, 1.0]);
        }
        numbers.into_pyarray(py).reshape([self.leaves.instances.len(), 4, 4])
    }

    #[getter]
    fn area(&self) -> f64 {
        let each = f64::from(self.leaves.leaf.mesh().area());
        self.leaves.instances.iter().map(|instance| each * f64::from(instance.scale).powi(2)).sum()
    }

    fn __len__(&self) -> usize {
        self.leaves.instances.len()
    }

    fn __repr__(&self) -> String {
        format!("<treesynth.Leaves, {} of them>", self.leaves.instances.len())
    }
}
