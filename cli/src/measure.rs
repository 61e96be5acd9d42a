//! `measure`: what botanists measure on a tree.

use crate::arguments::Common;
use crate::failure::refused;
use crate::number::{number, text};
use crate::progress::Bar;
use crate::read::{Content, In};
use crate::wish::Wish;
use crate::{Failure, report};
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;
use treesynth::presets::{self, Found};
use treesynth::reconstruct::Reconstruct;
use treesynth::{Metrics, Skeleton};

/// Measure trees: of skeleton files, of scanned points, or of a species
#[derive(Args)]
#[command(after_help = "\
Examples:
  treesynth measure tree.json
  treesynth measure qsm.csv scan.xyz --json
  treesynth measure neuron.swc --unit-in 0.000001
  treesynth measure --species oak --dbh 0.4 --seed 3")]
pub(crate) struct Options {
    /// Skeletons (.json, .swc, .csv, .mtg), or points of one tree each (.ply, .las, .laz, .e57, .xyz, .txt), of which a skeleton is made
    #[arg(value_name = "FILE", required_unless_present = "species", conflicts_with = "species")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    input: In,
    /// A species instead of files
    #[arg(long, value_name = "NAME", value_parser = text)]
    species: Option<String>,
    /// Seed of the species' tree, 0 to 18446744073709551615
    #[arg(long, value_name = "N", default_value = "0", allow_negative_numbers = true, value_parser = number(0..=u64::MAX, ""))]
    seed: u64,
    #[command(flatten, next_help_heading = "Species")]
    wish: Wish,
}

pub(crate) fn run(options: &Options, common: &Common) -> Result<(), Failure> {
    let measured = match &options.species {
        Some(name) => options.species(name, common)?,
        None => options.files(common)?,
    };
    let entries = measured.iter().map(|(name, metrics, more)| {
        let mut entry = json!({ "name": name, "metrics": serde_json::to_value(metrics)? });
        if let (Some(entry), Value::Object(more)) = (entry.as_object_mut(), more) {
            entry.extend(more.clone());
        }
        Ok(entry)
    });
    let value = Value::Array(entries.collect::<Result<_, Failure>>()?);
    report::tell(common, &value, || measured.iter().map(|(name, metrics, _)| table(name, metrics)).collect())
}

/// A name, its measures, and what else is known of it.
type Measured = (String, Metrics, Value);

impl Options {
    fn species(&self, name: &str, common: &Common) -> Result<Vec<Measured>, Failure> {
        if self.input.from.is_some() || self.input.up_in.is_some() || self.input.unit_in.is_some() {
            return Err(refused("--from, --up-in and --unit-in go with files, not with --species"));
        }
        let species = presets::by_name(name).and_then(Found::species).map_err(refused)?;
        let (request, _) = self.wish.request(species, self.seed)?;
        let bar = Bar::new(common.quiet);
        bar.step(format!("growing {}", species.name));
        let tree = request.grow()?;
        bar.finish();
        let more = json!({ "seed": self.seed, "numbers": serde_json::to_value(tree.numbers)? });
        Ok(vec![(species.name.clone(), Metrics::of(&tree.skeleton), more)])
    }

    fn files(&self, common: &Common) -> Result<Vec<Measured>, Failure> {
        if let Some(option) = self.wish.first() {
            return Err(refused(format!("--{option} goes with --species, not with files")));
        }
        let kinds = self.files.iter().map(|path| self.input.kind(path)).collect::<Result<Vec<_>, _>>()?;
        let bar = Bar::new(common.quiet);
        let mut measured = Vec::new();
        for (path, kind) in self.files.iter().zip(kinds) {
            bar.step(format!("reading {}", path.display()));
            let name = path.display().to_string();
            match self.input.read(path, kind)? {
                Content::Points(cloud) => {
                    bar.step(format!("making a tree of {} points", cloud.len()));
                    let made = Reconstruct::default().reconstruct(&cloud);
                    let made = made.map_err(|error| format!("{name}: {error}"))?;
                    let more =
                        json!({ "points": cloud.len(), "ground": made.ground, "left_out": made.left_out });
                    measured.push((name, Metrics::of(&made.skeleton), more));
                }
                Content::Trees(trees, _) => {
                    let several = trees.len() > 1;
                    for (number, tree) in trees.iter().enumerate() {
                        let name =
                            if several { format!("{name}, tree {}", number + 1) } else { name.clone() };
                        measured.push((name, Metrics::of(tree), known(tree)));
                    }
                }
            }
        }
        bar.finish();
        Ok(measured)
    }
}

/// Properties that a skeleton may lack.
fn known(tree: &Skeleton) -> Value {
    json!({ "has_radii": tree.radii().iter().any(|&radius| radius > 0.0) })
}

fn table(name: &str, metrics: &Metrics) -> String {
    let maybe = |value: Option<f64>, digits: usize| {
        value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
    };
    let degrees = |value: Option<f64>| maybe(value.map(f64::to_degrees), 1);
    let list = |values: &[usize]| values.iter().map(usize::to_string).collect::<Vec<_>>().join(" ");
    let rows = [
        ("nodes, tips, branches", format!("{}, {}, {}", metrics.nodes, metrics.tips, metrics.branches)),
        ("branches of each order", list(&metrics.branches_by_order)),
        ("height, m", format!("{:.3}", metrics.height)),
        ("diameter at 1.3 m, m", maybe(metrics.breast_height_diameter, 3)),
        ("crown width, m", format!("{:.3}", metrics.crown_width)),
        ("crown base, m", maybe(metrics.crown_base, 3)),
        ("ground below the crown, m²", format!("{:.2}", metrics.projected_area)),
        ("volume of the crown, m³", format!("{:.2}", metrics.crown_volume)),
        ("length of all branches, m", format!("{:.2}", metrics.total_length)),
        ("volume of wood, m³", format!("{:.4}", metrics.wood_volume)),
        ("volume of the trunk, m³", format!("{:.4}", metrics.stem_volume)),
        ("form factor", maybe(metrics.form_factor, 3)),
        ("Strahler order", metrics.strahler_order.to_string()),
        ("bifurcation ratio", maybe(metrics.mean_bifurcation_ratio, 2)),
        ("branch angle, degrees", degrees(metrics.mean_branch_angle)),
        ("pipe exponent", maybe(metrics.pipe_exponent, 2)),
    ];
    let lines: Vec<String> = rows.iter().map(|(what, value)| format!("  {what:28} {value}")).collect();
    format!("{name}\n{}\n", lines.join("\n"))
}
