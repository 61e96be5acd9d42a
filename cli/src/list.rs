//! `list`: the names that other commands take.

use crate::arguments::Common;
use crate::{Failure, report};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use treesynth::presets::{self, Found};

/// List species, presets, stands, shapes and trees of growth over the years
#[derive(Args)]
#[command(after_help = "\
Examples:
  treesynth list
  treesynth list species
  treesynth list stands --json
  treesynth list --json | jq -r '.[] | select(.kind == \"species\") | .latin'")]
pub(crate) struct Options {
    /// Kind of things to list; everything if it is left out
    #[arg(value_enum)]
    kind: Option<Kind>,
    /// Only entries with this word in their name or description, in capitals or not
    #[arg(long, value_name = "WORD")]
    find: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Species: treesynth grow, treesynth forest
    Species,
    /// Presets of the guided system: treesynth grow
    Presets,
    /// Stands of the self-organizing system: treesynth forest
    Stands,
    /// Shapes of the variational system: treesynth shape
    Shapes,
    /// Trees of the growth system: treesynth years
    Years,
}

impl Kind {
    fn of(found: &Found) -> Self {
        match found {
            Found::Species(_) => Self::Species,
            Found::Stand(_) | Found::Space(_) => Self::Stands,
            Found::Variational(_) => Self::Shapes,
            Found::Grown(_) => Self::Years,
            _ => Self::Presets,
        }
    }

    /// The word of JSON, and the command that takes the name.
    fn words(self) -> [&'static str; 2] {
        match self {
            Self::Species => ["species", "grow"],
            Self::Presets => ["preset", "grow"],
            Self::Stands => ["stand", "forest"],
            Self::Shapes => ["shape", "shape"],
            Self::Years => ["years", "years"],
        }
    }
}

pub(crate) fn run(options: &Options, common: &Common) -> Result<(), Failure> {
    let word = options.find.as_deref().unwrap_or_default().to_lowercase();
    let known = presets::all().filter(|found| {
        let text = format!("{} {} {}", found.name(), latin(found), found.about()).to_lowercase();
        options.kind.is_none_or(|kind| Kind::of(found) == kind) && text.contains(&word)
    });
    let known: Vec<Found> = known.collect();
    let value = Value::Array(known.iter().map(entry).collect::<Result<_, _>>()?);
    report::tell(common, &value, || {
        let lines = known.iter().map(|found| {
            let [_, command] = Kind::of(found).words();
            let latin = latin(found);
            let latin = if latin.is_empty() { String::new() } else { format!("{latin}. ") };
            format!("{command:7} {:30} {latin}{}", found.name(), found.about())
        });
        lines.collect::<Vec<_>>().join("\n")
    })
}

fn latin(found: &Found) -> &'static str {
    if let Found::Species(species) = *found { &species.latin } else { "" }
}

fn entry(found: &Found) -> Result<Value, Failure> {
    let [kind, command] = Kind::of(found).words();
    let mut entry = json!({
        "kind": kind,
        "command": command,
        "name": found.name(),
        "about": found.about(),
    });
    match *found {
        Found::Species(species) => {
            let aliases = species.aliases.split(',').map(str::trim).filter(|name| !name.is_empty());
            entry["latin"] = json!(species.latin);
            entry["aliases"] = json!(aliases.collect::<Vec<_>>());
            entry["evergreen"] = json!(species.leaves.evergreen);
            entry["height"] = json!(species.size.height);
            entry["dbh"] = json!(species.size.diameter);
            // The greatest diameter is that of the greatest age.
            let oldest = species.request().with_dbh(species.size.diameter[1]).plan()?.age.floor();
            entry["age"] = json!([1.0, oldest]);
        }
        Found::Guided(preset) => entry["seed"] = json!(preset.seed),
        Found::Stand(stand) => {
            entry["seed"] = json!(stand.seed);
            entry["seasons"] = json!(stand.seasons);
        }
        Found::Space(stand) => {
            entry["seed"] = json!(stand.seed);
            entry["seasons"] = json!(stand.seasons);
        }
        Found::Variational(preset) => {
            entry["seed"] = json!(preset.seed);
            entry["nodes"] = json!(preset.shape_nodes);
        }
        Found::Grown(preset) => {
            entry["seed"] = json!(preset.seed);
            entry["ages"] = json!(preset.ages);
            entry["planar"] = json!(preset.planar);
        }
        _ => {}
    }
    Ok(entry)
}
