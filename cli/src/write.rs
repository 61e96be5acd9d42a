//! Files by the names of their formats.

use crate::Failure;
use crate::failure::refused;
use crate::files::Outputs;
use crate::number::{name, number};
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};
use treesynth::export::{self, Axes, GlbOptions, Instancing, LevelNodes, PlyFormat, SvgOptions, UsdStage};
use treesynth::preview::{Camera, Picture, Preview};
use treesynth::shape::UpAxis;
use treesynth::surface::{Material, Part, Scene};
use treesynth::{Skeleton, cloud::Frame, format};

/// A kind of file that is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// glTF 2.0, binary, with levels of detail and images
    Glb,
    /// Wavefront OBJ, with its .mtl and images beside it
    Obj,
    /// PLY, binary: triangles and colours
    Ply,
    /// STL, binary: triangles alone
    Stl,
    /// USD in one file, with levels of detail and images
    Usdz,
    /// USD as text, with its images beside it
    Usda,
    /// A shaded picture
    Png,
    /// A line drawing of the branches
    Svg,
    /// The skeleton as JSON, every number whole
    Json,
    /// The skeleton as SWC: one row per node
    Swc,
    /// The skeleton as a QSM table, .csv: a row a cylinder
    Qsm,
    /// The skeleton as MTG
    Mtg,
}

impl Format {
    /// Its name's ending.
    pub(crate) fn ending(self) -> &'static str {
        match self {
            Self::Glb => "glb",
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Stl => "stl",
            Self::Usdz => "usdz",
            Self::Usda => "usda",
            Self::Png => "png",
            Self::Svg => "svg",
            Self::Json => "json",
            Self::Swc => "swc",
            Self::Qsm => "csv",
            Self::Mtg => "mtg",
        }
    }

    /// `true` if it has the skeleton and no triangles.
    pub(crate) fn has_skeleton(self) -> bool {
        matches!(self, Self::Svg | Self::Json | Self::Swc | Self::Qsm | Self::Mtg)
    }
}

/// The axis that points up in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Up {
    /// +Y
    Y,
    /// +Z
    Z,
}

impl From<Up> for UpAxis {
    fn from(up: Up) -> Self {
        match up {
            Up::Y => Self::Y,
            Up::Z => Self::Z,
        }
    }
}

/// Form of a leaf's copies in .glb files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Instances {
    /// Multiplied out: every program reads it
    Merged,
    /// `EXT_mesh_gpu_instancing`
    Extension,
    /// One node each
    Nodes,
}

/// Form of images in .glb files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Images {
    /// Smaller; those with alpha are PNG
    Jpeg,
    /// Nothing is lost
    Png,
}

/// Quality of JPEG images: a bark from two metres looks as it does with PNG.
const JPEG: u8 = 85;

/// Options for writing files.
#[derive(Args, Debug)]
pub(crate) struct Out {
    /// Kinds of files, separated by commas
    #[arg(long, value_enum, value_delimiter = ',', default_value = "glb,png", value_name = "LIST")]
    pub(crate) format: Vec<Format>,
    /// Folder for files; made if it is not there
    #[arg(long, default_value = "out", value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Name of files, without folder and ending [default: the tree's]
    #[arg(long, value_name = "NAME", value_parser = name)]
    pub(crate) name: Option<String>,
    /// Axis that points up in .obj, .ply, .stl and .usd files
    #[arg(long, value_enum, default_value = "y", value_name = "AXIS")]
    pub(crate) up: Up,
    /// Metres in a unit of .obj, .ply, .stl and .usd files, 0.000001 to 1000000; 0.001 for printers
    #[arg(long, default_value = "1", value_name = "M", allow_negative_numbers = true, value_parser = number(1e-6..=1e6_f32, "metres"))]
    pub(crate) unit: f32,
    /// Leaves in .glb files
    #[arg(long, value_enum, default_value = "merged", value_name = "FORM")]
    pub(crate) instances: Instances,
    /// Levels in .glb files as nodes named `NAME_LOD0` and so on, as Unity, Unreal and Godot take them, not by `MSFT_lod`
    #[arg(long)]
    pub(crate) lod_names: bool,
    /// Round the vertices of .glb files: a third smaller, for readers of `KHR_mesh_quantization`
    #[arg(long)]
    pub(crate) quantize: bool,
    /// Images without alpha in .glb files, `jpeg` of quality 85 or `png`, which loses nothing
    #[arg(long, value_enum, default_value = "jpeg", value_name = "FORM")]
    pub(crate) images: Images,
    /// Side of the picture, 16 to 8192 pixels
    #[arg(long, default_value = "800", value_name = "N", allow_negative_numbers = true, value_parser = number(16..=8192_u32, "pixels"))]
    pub(crate) size: u32,
    /// Direction from which the picture is taken, degrees around the tree, -360 to 360
    #[arg(long, default_value = "0", value_name = "DEGREES", allow_negative_numbers = true, value_parser = number(-360.0..=360.0_f32, "degrees"))]
    pub(crate) azimuth: f32,
    /// Picture without sky and ground
    #[arg(long)]
    pub(crate) transparent: bool,
}

/// A tree to be written.
pub(crate) struct Tree<'a> {
    /// The finest level first.
    pub(crate) levels: &'a [Vec<Part<'a>>],
    pub(crate) coverages: &'a [f32],
    pub(crate) skeleton: &'a Skeleton,
    pub(crate) bark: Material,
}

impl Out {
    /// The folder, made and tried.
    pub(crate) fn outputs(&self) -> Result<Outputs, Failure> {
        Outputs::new("--out", &self.out)
    }

    pub(crate) fn preview(&self) -> Preview {
        let camera = Camera::default().with_elevation(0.05).with_azimuth(self.azimuth.to_radians());
        let preview = Preview::default().with_size(self.size, self.size).with_camera(camera);
        preview.with_ground(!self.transparent).with_transparency(self.transparent)
    }

    fn axes(&self) -> Axes {
        Axes::default().with_up(self.up.into()).with_unit(self.unit)
    }

    fn glb(&self, name: &str) -> GlbOptions {
        let instancing = match self.instances {
            Instances::Merged => Instancing::Merged,
            Instances::Extension => Instancing::Extension,
            Instances::Nodes => Instancing::Nodes,
        };
        let levels = if self.lod_names { LevelNodes::Named } else { LevelNodes::Extension };
        let options = GlbOptions::default().with_name(name).with_levels(levels);
        let jpeg = matches!(self.images, Images::Jpeg).then_some(JPEG);
        options.with_quantization(self.quantize).with_instancing(instancing).with_jpeg(jpeg)
    }

    /// Writes one tree; the paths of its files.
    pub(crate) fn tree(
        &self,
        outputs: &mut Outputs,
        name: &str,
        tree: &Tree<'_>,
    ) -> Result<Vec<PathBuf>, Failure> {
        let parts: &[Part<'_>] = tree.levels.first().map_or(&[], Vec::as_slice);
        let mut paths = Vec::new();
        for format in self.formats() {
            let path = outputs.path(&format!("{name}.{}", format.ending()));
            match format {
                Format::Glb => {
                    let glb = self.glb(name).with_coverages(tree.coverages);
                    outputs
                        .write(&path, |writer| Ok(export::write_glb_levels(tree.levels, &glb, writer)?))?;
                }
                Format::Usdz | Format::Usda => {
                    self.usd(outputs, &path, format, UsdStage::of_levels(tree.levels).with_name(name))?;
                }
                Format::Obj | Format::Ply | Format::Stl => self.triangles(outputs, &path, format, parts)?,
                Format::Png => {
                    let picture = self.preview().draw_parts(parts)?;
                    outputs.write(&path, |writer| Ok(picture.write_png(writer)?))?;
                }
                _ => outputs.write(&path, |writer| {
                    let z_up = Frame::default();
                    write_skeleton(format, tree.skeleton, &z_up, tree.bark, writer)
                })?,
            }
            paths.push(path);
        }
        Ok(paths)
    }

    /// Writes many trees in their places; the paths of their files.
    pub(crate) fn scene(
        &self,
        outputs: &mut Outputs,
        name: &str,
        scene: &Scene<'_>,
    ) -> Result<Vec<PathBuf>, Failure> {
        let mut paths = Vec::new();
        for format in self.formats() {
            let path = outputs.path(&format!("{name}.{}", format.ending()));
            match format {
                Format::Glb => {
                    outputs.write(&path, |writer| {
                        Ok(export::write_glb_scene(scene, &self.glb(name), writer)?)
                    })?;
                }
                Format::Usdz | Format::Usda => {
                    self.usd(outputs, &path, format, UsdStage::of_scene(scene).with_name(name))?;
                }
                Format::Png => {
                    let camera =
                        Camera::default().with_elevation(0.2).with_azimuth(self.azimuth.to_radians());
                    let picture = self.preview().with_camera(camera).draw_parts(&scene.parts())?;
                    outputs.write(&path, |writer| Ok(picture.write_png(writer)?))?;
                }
                _ => self.triangles(outputs, &path, format, &scene.parts())?,
            }
            paths.push(path);
        }
        Ok(paths)
    }

    /// Each format once, in the order asked for.
    pub(crate) fn formats(&self) -> Vec<Format> {
        let mut formats = Vec::new();
        for &format in &self.format {
            if !formats.contains(&format) {
                formats.push(format);
            }
        }
        formats
    }

    /// `true` if anything but skeletons is written.
    pub(crate) fn has_triangles(&self) -> bool {
        self.format.iter().any(|format| !format.has_skeleton())
    }

    /// Refuses what has one skeleton, where there are many.
    pub(crate) fn check_scene(&self) -> Result<(), Failure> {
        match self.format.iter().find(|format| format.has_skeleton()) {
            Some(format) => Err(refused(format!(
                "--format {} is of one skeleton, but a forest has many; it must be glb, obj, ply, stl, usdz, usda or png",
                value_name(*format)
            ))),
            None => Ok(()),
        }
    }

    fn usd(
        &self,
        outputs: &mut Outputs,
        path: &Path,
        format: Format,
        stage: UsdStage<'_>,
    ) -> Result<(), Failure> {
        let stage = stage.with_axes(self.axes());
        if format == Format::Usdz {
            return outputs.write(path, |writer| Ok(export::write_usdz(&stage, writer)?));
        }
        outputs.write(path, |writer| Ok(export::write_usda(&stage, writer)?))?;
        outputs.write_images(&export::usd_images(&stage))
    }

    fn triangles(
        &self,
        outputs: &mut Outputs,
        path: &Path,
        format: Format,
        parts: &[Part<'_>],
    ) -> Result<(), Failure> {
        let axes = self.axes();
        match format {
            Format::Obj => {
                let materials = path.with_extension("mtl");
                let name = materials.file_name().unwrap_or_default().to_string_lossy().into_owned();
                outputs.write(path, |writer| Ok(export::write_obj_with(parts, &name, axes, writer)?))?;
                outputs.write(&materials, |writer| Ok(export::write_mtl(parts, writer)?))?;
                outputs.write_images(&export::mtl_images(parts))
            }
            Format::Ply => outputs
                .write(path, |writer| Ok(export::write_ply_with(parts, PlyFormat::Binary, axes, writer)?)),
            _ => outputs.write(path, |writer| Ok(export::write_stl_with(parts, axes, writer)?)),
        }
    }
}

/// The word of `--format`.
pub(crate) fn value_name(format: Format) -> String {
    format.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}

/// Writes a skeleton; tables in the axes, unit and offset of the frame.
pub(crate) fn write_skeleton(
    format: Format,
    skeleton: &Skeleton,
    frame: &Frame,
    bark: Material,
    writer: impl std::io::Write,
) -> Result<(), Failure> {
    match format {
        Format::Svg => export::write_svg(skeleton, &SvgOptions::default().with_material(bark), writer)?,
        Format::Swc => format::write_swc(skeleton, frame, writer)?,
        Format::Qsm => format::write_qsm(skeleton, frame, writer)?,
        Format::Mtg => format::write_mtg(skeleton, frame, writer)?,
        _ => export::write_skeleton(skeleton, writer)?,
    }
    Ok(())
}

/// Writes a strip of pictures.
pub(crate) fn write_animation(
    outputs: &mut Outputs,
    path: &Path,
    frames: &[Picture],
    milliseconds: u16,
) -> Result<(), Failure> {
    outputs.write(path, |writer| Ok(Picture::write_animation(frames, milliseconds, writer)?))
}
