//! `convert`: from one kind of file to another.

use crate::arguments::Common;
use crate::failure::refused;
use crate::files::Outputs;
use crate::number::number;
use crate::progress::Bar;
use crate::read::{Content, In, Kind};
use crate::write::{Format, Up, value_name, write_skeleton};
use crate::{Failure, report};
use clap::Args;
use serde_json::json;
use std::path::{Path, PathBuf};
use treesynth::cloud::{Cloud, Frame, PlyEncoding};
use treesynth::export::{self, Axes, GlbOptions, PlyFormat, UsdStage};
use treesynth::glam::DVec3;
use treesynth::reconstruct::Reconstruct;
use treesynth::surface::{Material, Part, Tubes};
use treesynth::{Skeleton, preview::Preview};

/// Convert skeletons, and points: to other kinds, to meshes, to pictures
#[derive(Args)]
#[command(after_help = "\
Examples:
  treesynth convert tree.json tree.swc
  treesynth convert qsm.csv model.glb
  treesynth convert forest.mtg third.json --tree 3
  treesynth convert scan.laz thin.ply --thin 0.01
  treesynth convert scan.xyz tree.csv
A skeleton becomes .json, .swc, .csv, .mtg, .svg, .png, .glb, .obj, .ply, .stl or .usdz (branches as tubes). Points become
.ply or .xyz, or, made into a skeleton, anything else; leaves must have been set aside.")]
pub(crate) struct Options {
    /// File that is read: .json, .swc, .csv, .mtg; points: .ply, .las, .laz, .e57, .xyz, .txt, .asc, .pts
    input: PathBuf,
    /// File that is written, of the kind that its name ends in
    output: PathBuf,
    #[command(flatten)]
    reading: In,
    /// Axis that points up in the file that is written; JSON, glTF and pictures have +Y always
    /// [default: z for skeletons and points, y for meshes]
    #[arg(long, value_enum, value_name = "AXIS")]
    up: Option<Up>,
    /// Metres in a unit of the file that is written, 0.000001 to 1000000 [default: 1]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = number(1e-6..=1e6_f64, "metres"))]
    unit: Option<f64>,
    /// Number of the tree to read from a file with several, from 1
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = number(1..=u32::MAX, ""))]
    tree: Option<u32>,
    /// Keep one point of each cube of this side, 0.0001 to 1000 m
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = number(1e-4..=1e3_f32, "m"))]
    thin: Option<f32>,
}

/// The kind of output.
enum Target {
    Points(Kind),
    Tree(Format),
}

pub(crate) fn run(options: &Options, common: &Common) -> Result<(), Failure> {
    let kind = options.reading.kind(&options.input)?;
    let target = options.target(kind)?;
    let folder = options.output.parent().filter(|folder| !folder.as_os_str().is_empty());
    let mut outputs = Outputs::new("output", folder.unwrap_or(Path::new(".")))?;
    Outputs::check("output", &options.output)?;
    let bar = Bar::new(common.quiet);
    bar.step(format!("reading {}", options.input.display()));
    let content = options.reading.read(&options.input, kind)?;
    let said = match (content, target) {
        (Content::Points(cloud), target) => {
            let cloud = options.thin.map_or(Ok(cloud.clone()), |side| cloud.thinned(side))?;
            match target {
                Target::Points(kind) => options.points(&mut outputs, &cloud, kind)?,
                Target::Tree(format) => {
                    bar.step(format!("making a tree of {} points", cloud.len()));
                    let made = Reconstruct::default().reconstruct(&cloud);
                    let made = made.map_err(|error| format!("{}: {error}", options.input.display()))?;
                    options.tree(&mut outputs, &made.skeleton, made.offset, format)?
                }
            }
        }
        (Content::Trees(trees, offset), Target::Tree(format)) => {
            let tree = options.chosen(&trees)?;
            options.tree(&mut outputs, tree, offset, format)?
        }
        (Content::Trees(..), Target::Points(_)) => return Err("a skeleton has no points".into()),
    };
    outputs.finish()?;
    let milliseconds = bar.finish();
    let value = json!({
        "input": options.input,
        "output": options.output,
        "wrote": said,
        "milliseconds": milliseconds,
    });
    report::tell(common, &value, || format!("{}: {said}", options.output.display()))
}

impl Options {
    fn target(&self, kind: Kind) -> Result<Target, Failure> {
        let ending = self.output.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        let target = match ending.to_ascii_lowercase().as_str() {
            "json" => Target::Tree(Format::Json),
            "swc" => Target::Tree(Format::Swc),
            "csv" | "qsm" => Target::Tree(Format::Qsm),
            "mtg" => Target::Tree(Format::Mtg),
            "svg" => Target::Tree(Format::Svg),
            "png" => Target::Tree(Format::Png),
            "glb" => Target::Tree(Format::Glb),
            "obj" => Target::Tree(Format::Obj),
            "stl" => Target::Tree(Format::Stl),
            "usdz" => Target::Tree(Format::Usdz),
            "ply" if kind.has_points() => Target::Points(Kind::Ply),
            "ply" => Target::Tree(Format::Ply),
            "xyz" | "txt" | "asc" | "pts" if kind.has_points() => Target::Points(Kind::Xyz),
            "xyz" | "txt" | "asc" | "pts" => {
                return Err(refused(format!("{}: a skeleton has no points to write", self.output.display())));
            }
            _ => {
                return Err(refused(format!(
                    "{}: its name must end in .json, .swc, .csv, .mtg, .svg, .png, .glb, .obj, .ply, .stl, .usdz or .xyz",
                    self.output.display()
                )));
            }
        };
        if self.thin.is_some() && !kind.has_points() {
            return Err(refused(format!(
                "--thin goes with points, but {} has a skeleton",
                self.input.display()
            )));
        }
        if self.tree.is_some() && (kind.has_points() || kind == Kind::Json) {
            return Err(refused(format!(
                "--tree goes with files of several trees, but {} has one",
                self.input.display()
            )));
        }
        if let Target::Tree(format @ (Format::Json | Format::Svg | Format::Png | Format::Glb)) = target
            && (self.up.is_some() || self.unit.is_some())
        {
            let name = value_name(format);
            return Err(refused(format!("--up and --unit do not go with {name}, which is +Y up and metres")));
        }
        Ok(target)
    }

    fn chosen<'a>(&self, trees: &'a [Skeleton]) -> Result<&'a Skeleton, Failure> {
        let count = trees.len();
        match (self.tree, trees) {
            (None, [tree]) => Ok(tree),
            (None, _) => Err(refused(format!(
                "{} has {count} trees; --tree 1 to {count} chooses one",
                self.input.display()
            ))),
            (Some(number), _) => trees.get(number as usize - 1).ok_or_else(|| {
                refused(format!(
                    "--tree is {number}, but {} has the trees 1 to {count}",
                    self.input.display()
                ))
            }),
        }
    }

    /// Axes and unit of what is written, with what was taken off the coordinates put back.
    fn frame(&self, offset: DVec3) -> Frame {
        let (from, to) = (self.reading.up_in.unwrap_or(Up::Z), self.up.unwrap_or(Up::Z));
        let (from_unit, to_unit) = (self.reading.unit_in.unwrap_or(1.0), self.unit.unwrap_or(1.0));
        let frame = Frame::default().with_up(to.into()).with_unit(to_unit);
        if offset == DVec3::ZERO {
            return frame;
        }
        let turned = match (from, to) {
            (Up::Z, Up::Y) => DVec3::new(offset.x, offset.z, -offset.y),
            (Up::Y, Up::Z) => DVec3::new(offset.x, -offset.z, offset.y),
            _ => offset,
        };
        // The same unit leaves the same bits.
        let is_same = from_unit.to_bits() == to_unit.to_bits();
        frame.with_offset(if is_same { turned } else { turned * from_unit / to_unit })
    }

    fn points(&self, outputs: &mut Outputs, cloud: &Cloud, kind: Kind) -> Result<String, Failure> {
        let frame = self.frame(cloud.offset());
        outputs.write(&self.output, |writer| {
            if kind == Kind::Ply {
                cloud.write_ply(&frame, PlyEncoding::Little, writer)?;
            } else {
                cloud.write_xyz(&frame, writer)?;
            }
            Ok(())
        })?;
        Ok(format!("{} points", cloud.len()))
    }

    fn tree(
        &self,
        outputs: &mut Outputs,
        tree: &Skeleton,
        offset: DVec3,
        format: Format,
    ) -> Result<String, Failure> {
        let bark = Material::bark();
        let mut said = format!("{} nodes", tree.len());
        if format.has_skeleton() {
            let frame = self.frame(offset);
            outputs.write(&self.output, |writer| write_skeleton(format, tree, &frame, bark, writer))?;
            if offset != DVec3::ZERO && matches!(format, Format::Json | Format::Svg) {
                said += &moved(offset);
            }
            return Ok(said);
        }
        if tree.radii().iter().all(|&radius| radius == 0.0) {
            return Err(
                format!("{}: it tells no thickness, and a mesh needs one", self.input.display()).into()
            );
        }
        let mesh = Tubes::default().with_root_flare(0.0).mesh(tree)?;
        let parts = [Part::new(&mesh).with_material(bark)];
        let axes = Axes::default()
            .with_up(self.up.unwrap_or(Up::Y).into())
            .with_unit(self.unit.unwrap_or(1.0) as f32);
        let path = &self.output;
        match format {
            Format::Glb => {
                outputs.write(path, |w| Ok(export::write_glb_parts(&parts, &GlbOptions::default(), w)?))?;
            }
            Format::Usdz => {
                let stage = UsdStage::of_parts(&parts).with_axes(axes);
                outputs.write(path, |w| Ok(export::write_usdz(&stage, w)?))?;
            }
            Format::Obj => {
                let materials = path.with_extension("mtl");
                let name = materials.file_name().unwrap_or_default().to_string_lossy().into_owned();
                outputs.write(path, |w| Ok(export::write_obj_with(&parts, &name, axes, w)?))?;
                outputs.write(&materials, |w| Ok(export::write_mtl(&parts, w)?))?;
            }
            Format::Ply => {
                outputs.write(path, |w| Ok(export::write_ply_with(&parts, PlyFormat::Binary, axes, w)?))?;
            }
            Format::Stl => outputs.write(path, |w| Ok(export::write_stl_with(&parts, axes, w)?))?,
            _ => {
                let picture = Preview::default().with_size(800, 800).draw_parts(&parts)?;
                outputs.write(path, |w| Ok(picture.write_png(w)?))?;
            }
        }
        said = format!("{said}, {} triangles", mesh.triangles().len());
        if offset != DVec3::ZERO {
            said += &moved(offset);
        }
        Ok(said)
    }
}

/// A note of the offset, for files without one of their own.
fn moved(offset: DVec3) -> String {
    format!("; moved by -{offset}, which was taken off the coordinates")
}
