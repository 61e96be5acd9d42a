//! Errors of the library as exceptions, with its words.

use pyo3::PyErr;
use pyo3::exceptions::PyValueError;
use std::error::Error;
use std::io;

pyo3::create_exception!(
    treesynth,
    TreesynthError,
    PyValueError,
    "A request that cannot be met; the text names the parameter, its value and its range."
);

/// An exception: `OSError` for files that cannot be opened, read or written, `TreesynthError` for all others.
pub(crate) fn failure(error: impl Error + 'static) -> PyErr {
    let text = error.to_string();
    let mut cause: Option<&(dyn Error + 'static)> = Some(&error);
    while let Some(next) = cause {
        if let Some(error) = next.downcast_ref::<io::Error>() {
            return io::Error::new(error.kind(), text).into();
        }
        cause = next.source();
    }
    TreesynthError::new_err(text)
}

/// A `TreesynthError` of these words.
pub(crate) fn refused(text: impl Into<String>) -> PyErr {
    TreesynthError::new_err(text.into())
}
