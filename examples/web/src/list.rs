//! Trees that can be asked for, and their options, for the page to make controls of.

use serde_json::{Value, json};
use treesynth::presets;
use treesynth::species::{self, Species};

/// Species and presets, each with its controls.
pub fn list() -> Value {
    let species = species::all().iter().map(|species| {
        json!({
            "name": species.name,
            "latin": species.latin,
            "about": species.about,
            "kind": "species",
            "controls": controls(species),
        })
    });
    // A few that show what the guided system does; all can be asked for by name.
    let presets = presets::guided().filter(|preset| !preset.planar && preset.figure >= 6).map(|preset| {
        json!({
            "name": preset.name,
            "latin": "",
            "about": preset.caption,
            "kind": "preset",
            "seed": preset.seed,
            "controls": [
                slider("nodes", "Detail", "nodes of the graph", 2_000.0, 100_000.0, 1_000.0, 20_000.0,
                    "More nodes make finer branches and take longer."),
                json!({ "key": "season", "kind": "choice", "label": "Season", "options": ["winter", "summer", "autumn"],
                    "value": "summer", "about": "Leaves and their colour." }),
            ],
        })
    });
    let years = presets::grown().filter(|preset| !preset.planar).map(|preset| {
        let oldest = preset.architecture().map_or(20.0, |architecture| f32::from(architecture.years()));
        json!({
            "name": preset.name,
            "latin": "",
            "about": preset.caption,
            "kind": "years",
            "seed": preset.seed,
            "controls": [
                slider("age", "Age", "years", 0.6, oldest, 0.1, (0.5 * oldest).floor() + 0.6,
                    "One tree as it grows. Fractions are the time of the year: .0 is midwinter, .6 summer."),
            ],
        })
    });
    Value::Array(species.chain(presets).chain(years).collect())
}

fn controls(species: &Species) -> Value {
    let size = &species.size;
    let oldest =
        species.request().with_dbh(size.diameter[1]).plan().map_or(200.0, |numbers| numbers.age.floor());
    let usual = species.request().plan().map_or(oldest * 0.3, |numbers| numbers.age.round());
    let height = species.request().plan().map_or(size.height[1] * 0.5, |numbers| numbers.height.round());
    json!([
        slider(
            "age",
            "Age",
            "years",
            1.0,
            oldest,
            1.0,
            usual.clamp(1.0, oldest),
            "Height, trunk and crown follow from it. Not used when a height is set."
        ),
        optional(slider(
            "height",
            "Height",
            "m",
            size.height[0],
            size.height[1],
            0.1,
            height,
            "Height of the highest twig, met within 1%."
        )),
        optional(slider(
            "dbh",
            "Trunk",
            "m",
            size.diameter[0],
            size.diameter[1],
            0.01,
            size.usual_diameter,
            "Diameter 1.3 m above the ground, met within 1%."
        )),
        optional(slider(
            "spacing",
            "Stand",
            "m from tree to tree",
            0.3,
            30.0,
            0.1,
            4.0,
            "Neighbours make the crown narrower and begin higher."
        )),
        slider(
            "day",
            "Day of the year",
            "",
            1.0,
            366.0,
            1.0,
            196.0,
            "Buds, blossom, leaves, autumn colours, bare twigs; of the northern half."
        ),
        optional(slider(
            "dead",
            "Dead for",
            "years",
            0.0,
            80.0,
            1.0,
            10.0,
            "A snag: twigs, branches and bark fall one after the other."
        )),
        slider(
            "storm",
            "Storm",
            "of the limbs",
            0.0,
            1.0,
            0.05,
            0.0,
            "Part of the limbs that a storm broke."
        ),
    ])
}

#[allow(clippy::too_many_arguments, reason = "a row of a table")]
fn slider(
    key: &str,
    label: &str,
    unit: &str,
    min: f32,
    max: f32,
    step: f32,
    value: f32,
    about: &str,
) -> Value {
    json!({
        "key": key, "kind": "slider", "label": label, "unit": unit,
        "min": min, "max": max, "step": step, "value": value, "about": about,
    })
}

/// A slider that does nothing until it is switched on.
fn optional(mut slider: Value) -> Value {
    slider["optional"] = json!(true);
    slider
}
