//! Skeletons and points from files.

use crate::Failure;
use crate::failure::refused;
use crate::number::number;
use crate::write::Up;
use clap::{Args, ValueEnum};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use treesynth::cloud::{Cloud, Frame};
use treesynth::format::{read_mtg, read_qsm, read_swc};
use treesynth::glam::DVec3;
use treesynth::{Skeleton, export};

/// A kind of file that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Kind {
    /// Skeleton as JSON, .json
    Json,
    /// Skeleton as SWC, .swc
    Swc,
    /// QSM table, .csv
    Qsm,
    /// MTG, .mtg
    Mtg,
    /// Points as PLY, .ply
    Ply,
    /// Points as text, .xyz, .txt, .asc or .pts
    Xyz,
    /// Points of a laser scanner, .las or .laz
    Las,
    /// Scans of a laser scanner, .e57
    E57,
}

impl Kind {
    /// The kind of a file by its name's ending, in capitals or not.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "json" => Some(Self::Json),
            "swc" => Some(Self::Swc),
            "csv" | "qsm" => Some(Self::Qsm),
            "mtg" => Some(Self::Mtg),
            "ply" => Some(Self::Ply),
            "xyz" | "txt" | "asc" | "pts" => Some(Self::Xyz),
            "las" | "laz" => Some(Self::Las),
            "e57" => Some(Self::E57),
            _ => None,
        }
    }

    pub(crate) fn has_points(self) -> bool {
        matches!(self, Self::Ply | Self::Xyz | Self::Las | Self::E57)
    }
}

/// Options for reading a file.
#[derive(Args, Debug)]
pub(crate) struct In {
    /// Kind of the file that is read [default: by its name's ending]
    #[arg(long, value_enum, value_name = "KIND")]
    pub(crate) from: Option<Kind>,
    /// Axis that points up in it; JSON is +Y always [default: z]
    #[arg(long, value_enum, value_name = "AXIS")]
    pub(crate) up_in: Option<Up>,
    /// Metres in a unit of it, 0.000000001 to 1000000000; JSON is metres always [default: 1]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = number(1e-9..=1e9_f64, "metres"))]
    pub(crate) unit_in: Option<f64>,
}

/// Contents of a file.
pub(crate) enum Content {
    /// Trees, and what was taken off their coordinates, in the file's axes and unit.
    Trees(Vec<Skeleton>, DVec3),
    Points(Cloud),
}

impl In {
    /// The kind of a file; refused before it is opened if its name does not say.
    pub(crate) fn kind(&self, path: &Path) -> Result<Kind, Failure> {
        let kind = self.from.or_else(|| Kind::of(path)).ok_or_else(|| {
            refused(format!(
                "{}: its name must end in .json, .swc, .csv, .mtg, .ply, .xyz, .txt, .asc, .pts, .las, .laz or .e57, or --from must say its kind",
                path.display()
            ))
        })?;
        if kind == Kind::Json && (self.up_in.is_some() || self.unit_in.is_some()) {
            return Err(refused(format!(
                "{}: --up-in and --unit-in do not go with JSON, which is +Y up and metres",
                path.display()
            )));
        }
        Ok(kind)
    }

    pub(crate) fn frame(&self) -> Frame {
        Frame::default().with_up(self.up_in.unwrap_or(Up::Z).into()).with_unit(self.unit_in.unwrap_or(1.0))
    }

    /// All that is in a file; failures name it.
    pub(crate) fn read(&self, path: &Path, kind: Kind) -> Result<Content, Failure> {
        self.content(path, kind).map_err(|error| format!("{}: {error}", path.display()).into())
    }

    fn content(&self, path: &Path, kind: Kind) -> Result<Content, Failure> {
        if path.is_dir() {
            return Err("it is a folder".into());
        }
        let file = File::open(path)?;
        let frame = self.frame();
        match kind {
            Kind::Las => return Ok(Content::Points(Cloud::read_las(&frame, file)?)),
            Kind::E57 => return Ok(Content::Points(Cloud::read_e57(&frame, file)?)),
            _ => {}
        }
        let file = BufReader::new(file);
        let trees = match kind {
            Kind::Json => return Ok(Content::Trees(vec![export::read_skeleton(file)?], DVec3::ZERO)),
            Kind::Ply => return Ok(Content::Points(Cloud::read_ply(&frame, file)?)),
            Kind::Xyz => return Ok(Content::Points(Cloud::read_xyz(&frame, file)?)),
            Kind::Swc => read_swc(&frame, file)?,
            Kind::Qsm => read_qsm(&frame, file)?,
            _ => read_mtg(&frame, file)?,
        };
        Ok(Content::Trees(trees.trees, trees.offset))
    }
}
