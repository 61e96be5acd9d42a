//! Models within a budget, and their files and pictures.

use crate::failure::{failure, refused};
use crate::file;
use crate::watch;
use numpy::{IntoPyArray, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use treesynth::asset;
use treesynth::export::{self, Axes, GlbOptions, LevelNodes, PlyFormat, UsdStage};
use treesynth::preview::{Camera, Preview};
use treesynth::surface::Part;

/// Quality of JPEG images.
const JPEG: u8 = 85;

/// The quality of a model's images without alpha, as GLB files take it.
pub(crate) fn jpeg(images: &str) -> PyResult<Option<u8>> {
    match images {
        "jpeg" => Ok(Some(JPEG)),
        "png" => Ok(None),
        _ => Err(refused(format!("images is {images:?}, but must be \"jpeg\" or \"png\""))),
    }
}

/// The files that a model is written to.
const ENDINGS: &str = ".glb, .obj, .ply, .stl, .usdz, .usda or .png";

/// A model of a tree: bark, leaves and cards of each level, the finest first.
#[pyclass(frozen, module = "treesynth")]
pub(crate) struct Asset {
    name: String,
    levels: Vec<asset::Asset>,
    height: f32,
}

impl Asset {
    pub(crate) fn new(name: String, levels: Vec<asset::Asset>, height: f32) -> Self {
        Self { name, levels, height }
    }

    fn parts(&self) -> Vec<Part<'_>> {
        self.levels.first().map(asset::Asset::parts).unwrap_or_default()
    }

    /// Refuses a file that cannot be one of a model.
    pub(crate) fn check(path: &Path) -> PyResult<()> {
        match file::ending(path).as_str() {
            "glb" | "obj" | "ply" | "stl" | "usdz" | "usda" | "png" => Ok(()),
            _ => Err(file::unknown(path, ENDINGS)),
        }
    }
}

#[pymethods]
impl Asset {
    #[getter]
    fn triangles(&self) -> Vec<usize> {
        self.levels.iter().map(asset::Asset::triangles).collect()
    }

    #[getter]
    fn errors(&self) -> Vec<f32> {
        self.levels.iter().map(asset::Asset::error).collect()
    }

    #[getter]
    fn height(&self) -> f32 {
        self.height
    }

    #[pyo3(signature = (path, *, up = "y", unit = 1.0, quantize = false, lod_names = false, images = "png"))]
    pub(crate) fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        up: &str,
        unit: f32,
        quantize: bool,
        lod_names: bool,
        images: &str,
    ) -> PyResult<()> {
        Self::check(&path)?;
        let jpeg = jpeg(images)?;
        let axes = Axes::default().with_up(file::up_axis(up)?).with_unit(unit);
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        watch::run(py, None, |_| {
            let levels: Vec<Vec<Part<'_>>> = self.levels.iter().map(asset::Asset::parts).collect();
            let parts = self.parts();
            let folder = path.parent().unwrap_or(Path::new(""));
            let images = |images: &[export::ImageFile]| {
                for image in images {
                    file::write(&folder.join(image.name()), |file| Ok(file.write_all(&image.png())?))?;
                }
                Ok(())
            };
            match file::ending(&path).as_str() {
                "glb" => {
                    let nodes = if lod_names { LevelNodes::Named } else { LevelNodes::Extension };
                    let options = GlbOptions::default()
                        .with_name(name)
                        .with_levels(nodes)
                        .with_quantization(quantize)
                        .with_jpeg(jpeg)
                        .with_coverages(asset::Asset::screen_coverages(&self.levels, self.height));
                    file::write(&path, |file| {
                        export::write_glb_levels(&levels, &options, file).map_err(failure)
                    })
                }
                "obj" => {
                    let materials = path.with_extension("mtl");
                    let library = materials.file_name().unwrap_or_default().to_string_lossy().into_owned();
                    file::write(&path, |file| {
                        export::write_obj_with(&parts, &library, axes, file).map_err(failure)
                    })?;
                    file::write(&materials, |file| export::write_mtl(&parts, file).map_err(failure))?;
                    images(&export::mtl_images(&parts))
                }
                "ply" => file::write(&path, |file| {
                    export::write_ply_with(&parts, PlyFormat::Binary, axes, file).map_err(failure)
                }),
                "stl" => {
                    file::write(&path, |file| export::write_stl_with(&parts, axes, file).map_err(failure))
                }
                "png" => file::write(&path, |file| {
                    let picture =
                        Preview::default().with_size(800, 800).draw_parts(&parts).map_err(failure)?;
                    picture.write_png(file).map_err(failure)
                }),
                ending => {
                    let stage = UsdStage::of_levels(&levels).with_name(name).with_axes(axes);
                    if ending == "usdz" {
                        return file::write(&path, |file| export::write_usdz(&stage, file).map_err(failure));
                    }
                    file::write(&path, |file| export::write_usda(&stage, file).map_err(failure))?;
                    images(&export::usd_images(&stage))
                }
            }
        })
    }

    #[pyo3(signature = (size = 800, *, azimuth = 0.0, elevation = 3.0, level = 0, transparent = false))]
    fn picture<'py>(
        &self,
        py: Python<'py>,
        size: u32,
        azimuth: f32,
        elevation: f32,
        level: usize,
        transparent: bool,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let asset = self.levels.get(level).ok_or_else(|| {
            refused(format!("level is {level}, but must be 0 to {}", self.levels.len().saturating_sub(1)))
        })?;
        let camera =
            Camera::default().with_azimuth(azimuth.to_radians()).with_elevation(elevation.to_radians());
        let preview = Preview::default().with_size(size, size).with_camera(camera);
        let preview = preview.with_ground(!transparent).with_transparency(transparent);
        let picture = watch::run(py, None, |_| preview.draw_parts(&asset.parts()).map_err(failure))?;
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let pixels = picture.pixels();
        let bytes: Vec<u8> = if transparent {
            pixels.iter().zip(picture.alpha()).flat_map(|(&[r, g, b], &a)| [r, g, b, a]).collect()
        } else {
            pixels.as_flattened().to_vec()
        };
        bytes.into_pyarray(py).reshape([height, width, if transparent { 4 } else { 3 }])
    }

    fn __repr__(&self) -> String {
        let triangles: Vec<String> = self.triangles().iter().map(usize::to_string).collect();
        format!("<treesynth.Asset {:?}: {} triangles>", self.name, triangles.join(" / "))
    }
}
