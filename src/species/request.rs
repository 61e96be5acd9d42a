//! Requests for a tree of a species, and the numbers that follow from them.

use super::data::Species;
use super::draw::Draw;
use super::{SpeciesError, Specimen};
use crate::ParameterError;
use crate::math;
use std::borrow::Cow;

/// Request for a tree. Values that are not given follow from the species' allometry with its natural spread.
///
/// ```
/// use treesynth::species;
///
/// let birch = species::by_name("silver birch")?;
/// let tree = birch.request().with_height(6.0).with_seed(3).grow()?;
/// assert!((tree.numbers.height - 6.0).abs() < 0.06);
/// let error = birch.request().with_height(60.0).grow().unwrap_err();
/// assert!(error.to_string().starts_with("height of silver birch is 60 m, but must be 2 to"), "{error}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Serialized, the species is its name, or its [text](Species::to_text) if it is one of your own. What could not be read back as it is, is
/// an error: numbers that are not finite, and a species whose text gives another.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Request<'a> {
    #[cfg_attr(feature = "serde", serde(with = "super::saved"))]
    species: Cow<'a, Species>,
    #[cfg_attr(feature = "serde", serde(serialize_with = "super::saved::finite"))]
    height: Option<f32>,
    #[cfg_attr(feature = "serde", serde(serialize_with = "super::saved::finite"))]
    dbh: Option<f32>,
    #[cfg_attr(feature = "serde", serde(serialize_with = "super::saved::finite"))]
    age: Option<f32>,
    #[cfg_attr(feature = "serde", serde(serialize_with = "super::saved::finite"))]
    spacing: Option<f32>,
    day: f32,
    #[cfg_attr(feature = "serde", serde(serialize_with = "super::saved::finite"))]
    years_dead: Option<f32>,
    storm_damage: f32,
    seed: u64,
}

crate::recipe::readable!(Request<'_> {
    height: Option<f32>, dbh: Option<f32>, age: Option<f32>, day: f32, years_dead: Option<f32>, storm_damage: f32, seed: u64
});

/// The numbers that a tree was grown by, and what came of them.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Numbers {
    /// Height of the highest node above the base, metres.
    pub height: f32,
    /// Diameter of the thickest stem 1.3 m above the base, metres.
    pub dbh: f32,
    /// Age by the species' growth, years.
    pub age: f32,
    /// Mean diameter of the crown, metres.
    pub crown_width: f32,
    /// Height of the lowest limb's base, metres.
    pub crown_base: f32,
    /// One-sided area that all leaves have in summer, square metres.
    pub leaf_area: f32,
    /// Narrowing of the crown by neighbours, 0 (in the open) to 1.
    pub crowding: f32,
    /// Day of the year, 1 to 366, of the northern half.
    pub day: f32,
    /// Years since it died; none if it lives.
    pub dead: Option<f32>,
    /// The part of its limbs that a storm broke, 0 to 1.
    pub damage: f32,
}

impl Species {
    /// A tree of this species to be asked for: in the open, on a day in July, seed 0.
    pub fn request(&self) -> Request<'_> {
        Request {
            species: Cow::Borrowed(self),
            height: None,
            dbh: None,
            age: None,
            spacing: None,
            day: 196.0,
            years_dead: None,
            storm_damage: 0.0,
            seed: 0,
        }
    }
}

/// Diameters of trunks for which the data give sizes, metres.
const TRUNKS: [f32; 2] = [0.2, 0.4];

/// Least height of a tree whose diameter at 1.3 m is asked for, metres.
const LOWEST: f32 = 1.6;

/// Power of the height by which the trunk of a tree above usual height is thicker.
const TALL: f32 = 1.25;

/// The power of the trunk's diameter that goes through both sizes.
fn power(at: [f32; 2]) -> f32 {
    math::ln(at[1] / at[0]) / math::ln(TRUNKS[1] / TRUNKS[0])
}

fn at_trunk(at: [f32; 2], diameter: f32) -> f32 {
    at[0] * math::powf(diameter / TRUNKS[0], power(at))
}

impl Request<'_> {
    /// The height of the grown tree, metres; met within 1%, before anything [breaks](Self::with_storm_damage) or
    /// [falls](Self::with_years_dead).
    pub fn with_height(mut self, metres: f32) -> Self {
        self.height = Some(metres);
        self
    }

    /// The diameter of the trunk 1.3 m above the base, metres; met within 1%. Of several stems the thickest has it; a trunk
    /// that divides or ends lower has it there. The tree is at least 1.6 m tall then.
    pub fn with_dbh(mut self, metres: f32) -> Self {
        self.dbh = Some(metres);
        self
    }

    /// The age, years; if height or diameter are asked for too, they go before it.
    pub fn with_age(mut self, years: f32) -> Self {
        self.age = Some(years);
        self
    }

    /// In the open, which is the default.
    pub fn open_grown(mut self) -> Self {
        self.spacing = None;
        self
    }

    /// Grows in a stand of such trees, `spacing` metres from one to the next: a crown that is
    /// narrower and begins higher, on a thinner trunk. Wider than the crown grows in the open, it
    /// changes nothing.
    pub fn in_a_stand(mut self, spacing: f32) -> Self {
        self.spacing = Some(spacing);
        self
    }

    /// The day of the year, 1 to 366, as the seasons of the northern half have it; default 196, mid-July.
    pub fn with_day(mut self, day: f32) -> Self {
        self.day = day;
        self
    }

    /// A snag, dead for this number of years, 0 to 80. Leaves are gone (evergreens drop theirs,
    /// brown, over two years), then shoots, twigs, branches and limbs break off one after the
    /// other, each to a stub with splinters, the top from the fourth year on; bark falls in patches
    /// from the second year, wood turns grey. Default: it lives.
    pub fn with_years_dead(mut self, years: f32) -> Self {
        self.years_dead = Some(years);
        self
    }

    /// Damage by a winter storm, 0 (none, the default) to 1: about this part of the limbs, and some of the branches and
    /// twigs, are broken off with splintered stubs; above 0.5 the top may be, too.
    pub fn with_storm_damage(mut self, part: f32) -> Self {
        self.storm_damage = part;
        self
    }

    /// The seed; default 0. Species of different Latin names grow different trees from one seed.
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// The species.
    pub fn species(&self) -> &Species {
        &self.species
    }

    /// Metres from tree to tree [in its stand](Self::in_a_stand); none in the open.
    pub fn spacing(&self) -> Option<f32> {
        self.spacing
    }

    /// The tree. Same request, same bits.
    ///
    /// # Errors
    /// A request that the species cannot meet, with the range that it can.
    pub fn grow(&self) -> Result<Specimen, SpeciesError> {
        super::specimen::grow(&self.species, self.plan()?, self.dbh, self.seed)
    }

    /// Numbers of the tree to be, without growing it.
    ///
    /// # Errors
    /// As [`grow`](Self::grow).
    pub fn plan(&self) -> Result<Numbers, SpeciesError> {
        let species = &*self.species;
        let size = &species.size;
        let name = &species.name;
        let unless = |holds: bool, what: &str, value: String, range: String| {
            if holds { Ok(()) } else { Err(ParameterError::new(format!("{what} of {name}"), value, range)) }
        };
        let within = |what: &str, value: Option<f32>, [low, high]: [f32; 2], unit: &str| {
            let holds = value.is_none_or(|value| (low..=high).contains(&value));
            unless(holds, what, format!("{} {unit}", value.unwrap_or(0.0)), format!("{low} to {high} {unit}"))
        };
        within("height", self.height, size.height, "m")?;
        within("dbh", self.dbh, size.diameter, "m")?;
        let oldest = age_of(species, size.diameter[1]).floor();
        within("age", self.age, [1.0, oldest], "years")?;
        within("spacing", self.spacing, [0.3, 1000.0], "m")?;
        within("day", Some(self.day), [1.0, 366.0], "(day of the year)")?;
        within("years dead", self.years_dead, [0.0, 80.0], "years")?;
        within("storm damage", Some(self.storm_damage), [0.0, 1.0], "of the limbs")?;

        let mut draw = Draw::new(Draw::seed_of(&species.latin, self.seed));
        let [taller, wider, leafier] = size.spread.map(|spread| draw.factor(spread));
        let usual = size.usual_diameter * draw.factor(0.22);
        let vigor = draw.factor(0.15);
        let height_of = |diameter: f32| at_trunk(size.height_at, diameter) * taller;

        // Without a word on size, a tree of usual age. In a stand trunks are thinner for their height.
        let from_age = self.age.map(|age| diameter_at(species, age) * vigor);
        let from_height = self.height.map(|height| {
            // Trees above the usual height are tall rather than thick: they grew with company.
            let known = height.min(height_of(size.usual_diameter));
            let trunk =
                TRUNKS[0] * math::powf(known / (size.height_at[0] * taller), 1.0 / power(size.height_at));
            trunk * math::powf(height / known, TALL.min(1.0 / power(size.height_at)))
        });
        let open = self.dbh.or(from_height).or(from_age).unwrap_or(usual);
        let open = open.clamp(size.diameter[0], size.diameter[1]);
        let open_width = at_trunk(size.width_at, open) * wider;
        let crowding =
            self.spacing.map_or(0.0, |spacing| (1.0 - spacing * 1.05 / open_width).clamp(0.0, 0.9));
        let (mut dbh, mut height) = match (self.dbh, self.height) {
            (Some(dbh), Some(height)) => (dbh, height),
            (Some(dbh), None) => (dbh, height_of(dbh) * (1.0 + 0.8 * crowding)),
            (None, Some(height)) => (open * (1.0 - 0.83 * crowding), height),
            (None, None) => (open * (1.0 - 0.5 * crowding), height_of(open)),
        };
        let [slowest, fastest] = size.slenderness;
        if let (Some(dbh), Some(_)) = (self.dbh, self.height) {
            // A trunk this thin belongs to a tree that is too low to be measured at 1.3 m.
            let [low, high] = [LOWEST / fastest, size.diameter[1]];
            let holds = dbh >= low;
            unless(
                holds,
                "dbh",
                format!("{dbh} m on a tree of a given height"),
                format!("{low:.4} to {high} m"),
            )?;
        }
        if let (Some(dbh), Some(height)) = (self.dbh, self.height) {
            let [low, high] = [(dbh * slowest).max(LOWEST), dbh * fastest];
            unless(
                (low..=high).contains(&height),
                "height",
                format!("{height} m on a trunk of {dbh} m"),
                format!("{low:.1} to {high:.1} m on it"),
            )?;
        } else if self.dbh.is_some() {
            height = height.clamp(dbh * slowest, dbh * fastest).clamp(size.height[0], size.height[1]);
            height = height.max(LOWEST);
        } else if self.height.is_some() {
            dbh = dbh.clamp(height / fastest, height / slowest).clamp(size.diameter[0], size.diameter[1]);
        } else {
            height = height.clamp(size.height[0], size.height[1]);
        }
        // A tree that is taller than its trunk lets expect has a crown in proportion.
        let stature = math::powf(height / height_of(open).max(0.1), 0.5).clamp(0.5, 1.5);
        let leafy = at_trunk(size.leaf_area_at, open) * leafier;
        let mut width = open_width * stature;
        if let Some(spacing) = self.spacing {
            width = width.min(spacing * 1.05).max(0.3 * open_width);
        }
        let share = (width / open_width).min(1.0);
        let clear = species.trunk.clear;
        // High crowns differ by as little as they are deep.
        let jitter = draw.within([0.8, 1.2]);
        let base =
            if clear[0] <= 0.5 { clear[0] * jitter } else { clear[0] + (1.0 - clear[0]) * (jitter - 1.0) };
        let base = base + (clear[1] - base).max(0.0) * (crowding * 1.6).min(1.0);
        Ok(Numbers {
            height,
            dbh,
            age: self.age.unwrap_or_else(|| age_of(species, open)),
            crown_width: width,
            crown_base: base * height,
            leaf_area: leafy * share * share.sqrt(),
            crowding,
            day: self.day,
            dead: self.years_dead,
            damage: self.storm_damage,
        })
    }
}

/// The diameter at an age: growth that slows down towards the greatest one.
fn diameter_at(species: &Species, age: f32) -> f32 {
    let most = species.size.diameter[1] * 1.05;
    most * (1.0 - math::exp(-species.size.growth * age / most))
}

fn age_of(species: &Species, diameter: f32) -> f32 {
    let most = species.size.diameter[1] * 1.05;
    -math::ln(1.0 - (diameter / most).min(0.999)) * most / species.size.growth
}
