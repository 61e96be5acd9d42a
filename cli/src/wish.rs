//! Species, and what is asked of them.

use crate::Failure;
use crate::failure::refused;
use crate::number::number;
use clap::Args;
use std::path::Path;
use treesynth::species::{Numbers, Request, Species};

/// Wishes for trees of species. What is not said follows from the species' allometry and the seed.
#[derive(Args, Debug)]
pub(crate) struct Wish {
    /// Height of a species' tree, m, within its range: see `treesynth list species --json`
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = number(0.01..=1000.0_f32, "m"))]
    pub(crate) height: Option<f32>,
    /// Diameter of its trunk 1.3 m above the base, m, within the species' range
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = number(0.001..=100.0_f32, "m"))]
    pub(crate) dbh: Option<f32>,
    /// Its age, years, 1 to the species' greatest
    #[arg(long, value_name = "YEARS", allow_negative_numbers = true, value_parser = number(1.0..=10_000.0_f32, "years"))]
    pub(crate) age: Option<f32>,
    /// Day of the year, 1 to 366, of the northern half [default: 196, in July]
    #[arg(long, value_name = "DAY", allow_negative_numbers = true, value_parser = number(1.0..=366.0_f32, "(day of the year)"))]
    pub(crate) day: Option<f32>,
    /// In a stand of that spacing, 0.3 to 1000 m: narrower, with a higher crown [default: in the open]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = number(0.3..=1000.0_f32, "m"))]
    pub(crate) stand_spacing: Option<f32>,
    /// A snag, dead for 0 to 80 years
    #[arg(long, value_name = "YEARS", allow_negative_numbers = true, value_parser = number(0.0..=80.0_f32, "years"))]
    pub(crate) dead: Option<f32>,
    /// Part of the limbs that a storm broke, 0 to 1
    #[arg(long, value_name = "PART", allow_negative_numbers = true, value_parser = number(0.0..=1.0_f32, "of the limbs"))]
    pub(crate) storm: Option<f32>,
}

impl Wish {
    /// The names and values of what is asked for.
    fn asked(&self) -> [(&'static str, Option<f32>); 7] {
        [
            ("height", self.height),
            ("dbh", self.dbh),
            ("age", self.age),
            ("day", self.day),
            ("stand-spacing", self.stand_spacing),
            ("dead", self.dead),
            ("storm", self.storm),
        ]
    }

    /// The first option that is given.
    pub(crate) fn first(&self) -> Option<&'static str> {
        self.asked().into_iter().find(|(_, value)| value.is_some()).map(|(name, _)| name)
    }

    /// The request, checked: what the species cannot meet is refused by the options' names.
    pub(crate) fn request<'a>(
        &self,
        species: &'a Species,
        seed: u64,
    ) -> Result<(Request<'a>, Numbers), Failure> {
        type With<'a> = fn(Request<'a>, f32) -> Request<'a>;
        let with: [With<'a>; 7] = [
            Request::with_height,
            Request::with_dbh,
            Request::with_age,
            Request::with_day,
            Request::in_a_stand,
            Request::with_years_dead,
            Request::with_storm_damage,
        ];
        let mut request = species.request().with_seed(seed);
        for ((_, value), set) in self.asked().into_iter().zip(with) {
            if let Some(value) = value {
                request = set(request, value);
            }
        }
        let numbers = request.plan().map_err(|error| {
            let given =
                self.asked().into_iter().filter_map(|(name, value)| Some(format!("--{name} {}", value?)));
            refused(format!("{}: {error}", given.collect::<Vec<_>>().join(" ")))
        })?;
        Ok((request, numbers))
    }
}

/// A species from its text.
pub(crate) fn read_species(path: &Path) -> Result<Species, Failure> {
    let told = |error: &dyn std::fmt::Display| format!("--species-file {}: {error}", path.display());
    let text = std::fs::read_to_string(path).map_err(|error| told(&error))?;
    Ok(Species::parse(&text).map_err(|error| told(&error))?)
}

/// A name as files have it.
pub(crate) fn stem(name: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || c == '-' || c == '_' || c == '.' { c } else { '-' };
    let stem: String = name.to_lowercase().chars().map(plain).take(100).collect();
    let stem = stem.trim_matches(['.', '-']);
    if stem.is_empty() { "tree".to_owned() } else { stem.to_owned() }
}
