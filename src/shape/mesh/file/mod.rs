//! Models in files: OBJ, STL, PLY and glTF.

mod gltf;
mod obj;
mod ply;
mod polygon;
mod soup;
mod stl;

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek};
use std::path::Path;

use glam::DVec3;

use self::soup::Soup;
use super::{TriangleMesh, TriangleMeshError};
use crate::ParameterError;
use crate::shape::{UpAxis, check_numbers};

/// A kind of model file.
///
/// ```
/// use std::path::Path;
/// use treesynth::shape::MeshFormat;
///
/// assert_eq!(MeshFormat::of(Path::new("bunny.OBJ")), Some(MeshFormat::Obj));
/// assert_eq!(MeshFormat::of(Path::new("bunny.txt")), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Wavefront OBJ, `.obj`.
    Obj,
    /// STL, binary or text, `.stl`.
    Stl,
    /// PLY, binary or text, `.ply`.
    Ply,
    /// glTF 2.0, binary (`.glb`) or text (`.gltf`).
    Gltf,
}

impl MeshFormat {
    /// The kind that a file's name ends in, in capitals or not.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "obj" => Some(Self::Obj),
            "stl" => Some(Self::Stl),
            "ply" => Some(Self::Ply),
            "glb" | "gltf" => Some(Self::Gltf),
            _ => None,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Obj => "OBJ",
            Self::Stl => "STL",
            Self::Ply => "PLY",
            Self::Gltf => "glTF",
        }
    }
}

/// Options for reading a model from a file: up axis, unit, place.
///
/// Positions are read in double precision, moved by the offset, multiplied by the unit and turned upright, and only then
/// made `f32`; so a model in a survey's coordinates, hundreds of kilometres from 0, keeps its form if it is moved nearer.
/// All objects of a file are one solid. Polygons are cut into triangles whether they are convex or not; lines, points,
/// normals, colours and materials are passed over, whatever they hold.
///
/// ```
/// use treesynth::shape::{Import, MeshFormat, UpAxis};
///
/// // A box 1 m wide and deep and 2 m high, in millimetres and +Z up.
/// let obj = "v 0 0 0\nv 1000 0 0\nv 1000 1000 0\nv 0 1000 0\nv 0 0 2000\nv 1000 0 2000\nv 1000 1000 2000\nv 0 1000 2000\n\
///     f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
/// let import = Import::default().with_up(UpAxis::Z).with_unit(0.001);
/// let solid = import.read(MeshFormat::Obj, std::io::Cursor::new(obj))?;
/// assert!((treesynth::Shape::bounds(&solid).size().y - 2.0).abs() < 1e-6);
/// # Ok::<(), treesynth::shape::TriangleMeshError>(())
/// ```
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Import {
    up: UpAxis,
    unit: f64,
    offset: DVec3,
}

crate::recipe::readable!(Import { up: UpAxis, unit: f64, offset: DVec3 });

impl Default for Import {
    /// +Y up, metres, where it stands.
    fn default() -> Self {
        Self { up: UpAxis::Y, unit: 1.0, offset: DVec3::ZERO }
    }
}

impl Import {
    /// The axis that points up in the file; default [`UpAxis::Y`]. Most STL and PLY files are [`UpAxis::Z`].
    pub fn with_up(mut self, up: UpAxis) -> Self {
        self.up = up;
        self
    }

    /// Metres in a unit of the file, 1e-9 to 1e9; default 1. Most STL files are in millimetres, 0.001.
    pub fn with_unit(mut self, metres: f64) -> Self {
        self.unit = metres;
        self
    }

    /// Offset added to every position first, in the file's unit and axes, at most 1e12; default 0.
    pub fn with_offset(mut self, offset: DVec3) -> Self {
        self.offset = offset;
        self
    }

    fn check(&self) -> Result<(), ParameterError> {
        check_numbers("Import", self.unit, self.offset)
    }

    /// Reads a model. Takes about ten times as much memory as the file has bytes at most, whatever its header claims, and
    /// reads OBJ, STL and PLY as a stream. glTF files must have their buffers within, as `.glb` files do; those beside them
    /// are found by [`open`](Self::open).
    ///
    /// # Errors
    /// An option out of range; what cannot be read, by the line or byte; and as [`TriangleMesh::new`].
    pub fn read(
        &self,
        format: MeshFormat,
        reader: impl Read + Seek,
    ) -> Result<TriangleMesh, TriangleMeshError> {
        self.check()?;
        let mut soup = Soup::default();
        match format {
            MeshFormat::Obj => obj::read(BufReader::new(reader), &mut soup)?,
            MeshFormat::Stl => stl::read(reader, &mut soup)?,
            MeshFormat::Ply => ply::read(BufReader::new(reader), &mut soup)?,
            MeshFormat::Gltf => gltf::read(BufReader::new(reader), None, &mut soup)?,
        }
        soup.solid(format, self)
    }

    /// Reads a model from a file, of the kind that its name ends in: `.obj`, `.stl`, `.ply`, `.glb` or `.gltf`, in capitals
    /// or not.
    ///
    /// # Errors
    /// As [`read`](Self::read), with the file's name; another ending; a file that cannot be opened.
    pub fn open(&self, path: impl AsRef<Path>) -> Result<TriangleMesh, TriangleMeshError> {
        let path = path.as_ref();
        let named =
            |error: TriangleMeshError| TriangleMeshError::File(format!("{}: {error}", path.display()));
        let Some(format) = MeshFormat::of(path) else {
            let problem = "its name must end in .obj, .stl, .ply, .glb or .gltf".to_owned();
            return Err(named(TriangleMeshError::File(problem)));
        };
        let file = File::open(path).map_err(|error| named(TriangleMeshError::File(error.to_string())))?;
        if file.metadata().is_ok_and(|data| data.is_dir()) {
            return Err(named(TriangleMeshError::File("it is a folder".into())));
        }
        if format == MeshFormat::Gltf {
            self.check()?;
            let mut soup = Soup::default();
            gltf::read(BufReader::new(file), path.parent(), &mut soup).map_err(named)?;
            return soup.solid(format, self).map_err(named);
        }
        self.read(format, file).map_err(named)
    }
}

impl TriangleMesh {
    /// All objects of a Wavefront OBJ file as one solid, as [`Import`] reads it by default.
    ///
    /// Only its statements `v` and `f` are read; a weight or a colour after a position is ignored. Faces may
    /// name vertices that come later.
    ///
    /// # Errors
    /// As [`Import::read`].
    pub fn read_obj(reader: impl BufRead) -> Result<Self, TriangleMeshError> {
        let mut soup = Soup::default();
        obj::read(reader, &mut soup)?;
        soup.solid(MeshFormat::Obj, &Import::default())
    }

    /// All solids of an STL file, binary or text, as one, as [`Import`] reads it by default.
    ///
    /// A file is binary if its length says so: 84 bytes and 50 per triangle. Normals do not count.
    ///
    /// # Errors
    /// As [`Import::read`].
    pub fn read_stl(reader: impl Read + Seek) -> Result<Self, TriangleMeshError> {
        let mut soup = Soup::default();
        stl::read(reader, &mut soup)?;
        soup.solid(MeshFormat::Stl, &Import::default())
    }

    /// A PLY file, binary or text, with `x`, `y` and `z` of each `vertex` and the `vertex_indices` or `vertex_index` of
    /// each `face`, as [`Import`] reads it by default.
    ///
    /// # Errors
    /// As [`Import::read`].
    pub fn read_ply(reader: impl BufRead) -> Result<Self, TriangleMeshError> {
        let mut soup = Soup::default();
        ply::read(reader, &mut soup)?;
        soup.solid(MeshFormat::Ply, &Import::default())
    }

    /// All meshes of a glTF 2.0 scene where they stand, from a binary file (`.glb`) or a text with its buffers within, as
    /// [`Import`] reads it by default.
    ///
    /// Triangles, strips and fans count; lines, points, skins, morphs and animations do not. Instances by
    /// `EXT_mesh_gpu_instancing` are there.
    ///
    /// # Errors
    /// As [`Import::read`]; compressed meshes (Draco, meshopt).
    pub fn read_gltf(reader: impl BufRead) -> Result<Self, TriangleMeshError> {
        let mut soup = Soup::default();
        gltf::read(reader, None, &mut soup)?;
        soup.solid(MeshFormat::Gltf, &Import::default())
    }

    /// A model from a file, of the kind that its name ends in, as [`Import::open`] reads it by default.
    ///
    /// # Errors
    /// As [`Import::open`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, TriangleMeshError> {
        Import::default().open(path)
    }
}

/// Error of a file that cannot be read: the kind of file, the place in it, what was found and what
/// is required.
fn unreadable(
    format: MeshFormat,
    place: impl std::fmt::Display,
    problem: impl std::fmt::Display,
) -> TriangleMeshError {
    TriangleMeshError::File(format!("{}, {place}: {problem}", format.name()))
}
