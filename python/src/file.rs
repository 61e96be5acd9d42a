//! Files: read by their endings, and written whole or not at all.

use crate::failure::{failure, refused};
use crate::skeleton::Skeleton;
use crate::watch;
use pyo3::prelude::*;
use std::fs::File;
use std::io::{BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use treesynth::cloud::Frame;
use treesynth::export;
use treesynth::format::{read_mtg, read_qsm, read_swc};
use treesynth::glam::DVec3;
use treesynth::shape::UpAxis;

/// The ending of a file's name, in small letters.
pub(crate) fn ending(path: &Path) -> String {
    path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// The refusal of a file by its ending.
pub(crate) fn unknown(path: &Path, endings: &str) -> PyErr {
    refused(format!("path is {:?}, but must end in {endings}", path.display().to_string()))
}

/// `y` or `z`.
pub(crate) fn up_axis(up: &str) -> PyResult<UpAxis> {
    match up {
        "y" | "Y" => Ok(UpAxis::Y),
        "z" | "Z" => Ok(UpAxis::Z),
        _ => Err(refused(format!("up is {up:?}, but must be \"y\" or \"z\""))),
    }
}

/// The axes, unit and offset of a table.
pub(crate) fn frame(up: &str, unit: f64, offset: Option<[f64; 3]>) -> PyResult<Frame> {
    let frame = Frame::default().with_up(up_axis(up)?).with_unit(unit);
    Ok(offset.map_or(frame, |offset| frame.with_offset(DVec3::from(offset))))
}

/// An error that names the file.
fn named(path: &Path, error: &std::io::Error) -> PyErr {
    std::io::Error::new(error.kind(), format!("{}: {error}", path.display())).into()
}

/// Opens a file to be read.
pub(crate) fn open(path: &Path) -> PyResult<File> {
    File::open(path).map_err(|error| named(path, &error))
}

/// Writes a file beside its place and moves it there when it is whole.
pub(crate) fn write(path: &Path, content: impl FnOnce(&mut dyn Write) -> PyResult<()>) -> PyResult<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    // As `open` makes them, so that others can read them.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let file = builder.prefix(".treesynth-").tempfile_in(folder).map_err(|error| named(path, &error))?;
    let mut writer = BufWriter::new(file);
    content(&mut writer)?;
    let file = writer.into_inner().map_err(|error| named(path, &error.into_error()))?;
    file.persist(path).map_err(|error| named(path, &error.error))?;
    Ok(())
}

/// All skeletons of a file, and what was taken off its coordinates.
#[pyfunction]
#[pyo3(signature = (path, *, up = "z", unit = 1.0, offset = None))]
pub(crate) fn read_trees(
    py: Python<'_>,
    path: PathBuf,
    up: &str,
    unit: f64,
    offset: Option<[f64; 3]>,
) -> PyResult<(Vec<Skeleton>, [f64; 3])> {
    let frame = frame(up, unit, offset)?;
    watch::run(py, None, |_| {
        let ending = ending(&path);
        if !["json", "swc", "csv", "qsm", "mtg"].contains(&ending.as_str()) {
            return Err(unknown(&path, ".json, .swc, .csv, .qsm or .mtg"));
        }
        let file = BufReader::new(open(&path)?);
        let trees = match ending.as_str() {
            "json" => {
                let tree = export::read_skeleton(file).map_err(failure)?;
                return Ok((vec![Skeleton::from(tree)], [0.0; 3]));
            }
            "swc" => read_swc(&frame, file),
            "mtg" => read_mtg(&frame, file),
            _ => read_qsm(&frame, file),
        };
        let trees = trees.map_err(failure)?;
        Ok((trees.trees.into_iter().map(Skeleton::from).collect(), trees.offset.to_array()))
    })
}
