//! Arrays of numpy: views of what an object holds, and points from any array of numbers.

use crate::failure::refused;
use numpy::ndarray::{ArrayView1, ArrayView2};
use numpy::{AllowTypeChange, Element, PyArray1, PyArray2, PyArrayLike2, PyArrayMethods};
use pyo3::prelude::*;
use treesynth::glam::{DVec3, Vec2, Vec3};

/// Vectors that lie in memory as `N` numbers one after another.
///
/// # Safety
/// The type has `N` fields of type `f32` in the order of C and nothing else.
pub(crate) unsafe trait Row<const N: usize> {}

// SAFETY: glam's `Vec3` and `Vec2` are `repr(C)` with the fields x, y, z and x, y; the sizes are checked below.
unsafe impl Row<3> for Vec3 {}
// SAFETY: as above.
unsafe impl Row<2> for Vec2 {}
// SAFETY: an array of three.
unsafe impl Row<3> for [f32; 3] {}

/// A read-only view, `(n, N)`, of vectors that a frozen `owner` holds as long as it lives. Nothing is copied.
pub(crate) fn rows<'py, const N: usize, R: Row<N>>(
    owner: &Bound<'py, PyAny>,
    rows: &[R],
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    const { assert!(size_of::<R>() == N * size_of::<f32>()) };
    // SAFETY: by the contract of `Row` the slice is `N` numbers a row.
    let numbers = unsafe { std::slice::from_raw_parts(rows.as_ptr().cast::<f32>(), rows.len() * N) };
    let view =
        ArrayView2::from_shape((rows.len(), N), numbers).map_err(|error| refused(error.to_string()))?;
    // SAFETY: `rows` belongs to `owner`, which is frozen, so that they neither move nor change while it lives, and the array keeps it
    // alive.
    let array = unsafe { PyArray2::borrow_from_array(&view, owner.clone()) };
    Ok((*array.readwrite().make_nonwriteable()).clone())
}

/// A read-only view, `(n,)`, of numbers that a frozen `owner` holds as long as it lives. Nothing is copied.
pub(crate) fn column<'py, T: Element>(owner: &Bound<'py, PyAny>, numbers: &[T]) -> Bound<'py, PyArray1<T>> {
    // SAFETY: as in `rows`.
    let array = unsafe { PyArray1::borrow_from_array(&ArrayView1::from(numbers), owner.clone()) };
    (*array.readwrite().make_nonwriteable()).clone()
}

/// Numbers that can become an array of 64-bit floats, `(n, 3)`.
pub(crate) type Points<'py> = PyArrayLike2<'py, f64, AllowTypeChange>;

/// The rows of an array; `name` is the parameter that it is.
pub(crate) fn places(name: &str, points: &Points<'_>) -> PyResult<Vec<DVec3>> {
    let array = points.as_array();
    if array.ncols() != 3 {
        return Err(refused(format!("{name} has the shape {:?}, but must have (n, 3)", array.shape())));
    }
    Ok(array.rows().into_iter().map(|row| DVec3::new(row[0], row[1], row[2])).collect())
}

/// As [`places`], rounded to 32 bits.
pub(crate) fn vectors(name: &str, points: &Points<'_>) -> PyResult<Vec<Vec3>> {
    Ok(places(name, points)?.into_iter().map(DVec3::as_vec3).collect())
}
