//! The events of a year: shoots unfold, leaves turn and fall, buds swell.

use super::curve::Curve;
use crate::ParameterError;
use std::f32::consts::PI;

/// The course of a year, from midwinter (0) to midwinter (1).
///
/// In the [season](Self::with_season) shoots unfold metamer by metamer, each in the same way (section 4.3): its
/// development starts the later the farther up it stands, by the [stagger](Self::with_stagger), and all are done at the
/// season's end. Leaves take the colours of the year, some a little before others, and fall.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Phenology {
    pub(super) season: [f32; 2],
    pub(super) leaf_years: u16,
    pub(super) leaf_colors: [Curve; 3],
    pub(super) stagger: f32,
    pub(super) bud_size: f32,
    pub(super) leaf_angle: f32,
    #[cfg_attr(feature = "serde", serde(default = "light_turn"))]
    pub(super) light_turn: f32,
    pub(super) internode_growth: Curve,
    pub(super) leaf_growth: Curve,
    pub(super) bud_growth: Curve,
    pub(super) leaf_size: Curve,
    pub(super) leaf_share: Curve,
}

crate::recipe::readable!(Phenology {
    season: [f32; 2],
    leaf_years: u16,
    stagger: f32,
    bud_size: f32,
    light_turn: f32,
    leaf_angle: f32,
});

crate::recipe::readable!(&Phenology {
    leaf_colors: [Curve; 3],
    internode_growth: Curve,
    leaf_growth: Curve,
    bud_growth: Curve,
    leaf_size: Curve,
    leaf_share: Curve,
});

#[cfg(feature = "serde")]
fn light_turn() -> f32 {
    super::kinds::LIGHT_TURN
}

impl Phenology {
    /// When shoots begin to unfold and when they are done, as parts of the year, 0 to 1, ascending by at least 0.01.
    pub fn with_season(mut self, start: f32, end: f32) -> Self {
        self.season = [start, end];
        self
    }

    /// Years that a leaf stays, 1 (deciduous) to 50; it falls in the last of them.
    pub fn with_leaf_years(mut self, years: u16) -> Self {
        self.leaf_years = years;
        self
    }

    /// The colour of leaves over the year: linear (not sRGB) red, green and blue, 0 to 1 each.
    pub fn with_leaf_colors(mut self, channels: [Curve; 3]) -> Self {
        self.leaf_colors = channels;
        self
    }

    /// Share of the season over which the metamers of a shoot start one after the other, 0 to 0.95: metamer k of m starts after k / m of it.
    pub fn with_stagger(mut self, part: f32) -> Self {
        self.stagger = part;
        self
    }

    /// The length of a full-grown bud, metres, 0 to 1; 0 for none.
    pub fn with_bud_size(mut self, metres: f32) -> Self {
        self.bud_size = metres;
        self
    }

    /// Weight with which the upper sides of leaves turn to the light from above, relative to that with which
    /// they keep facing along their twig, 0 to 100; 0 for not at all, 1.5 by default.
    pub fn with_light_turn(mut self, weight: f32) -> Self {
        self.light_turn = weight;
        self
    }

    /// The angle between leaves and their twig, radians, 0 to π.
    pub fn with_leaf_angle(mut self, radians: f32) -> Self {
        self.leaf_angle = radians;
        self
    }

    /// Length of an internode as a share of its full length, over its time of development: 0 at first, not
    /// falling, 1 at last.
    pub fn with_internode_growth(mut self, curve: Curve) -> Self {
        self.internode_growth = curve;
        self
    }

    /// Size of a leaf as a share of its full size, 0 to 1, over the same time.
    pub fn with_leaf_growth(mut self, curve: Curve) -> Self {
        self.leaf_growth = curve;
        self
    }

    /// Size of a bud as a share of its full size, 0 to 1, over the time from the start of its metamer to the
    /// year's end.
    pub fn with_bud_growth(mut self, curve: Curve) -> Self {
        self.bud_growth = curve;
        self
    }

    /// `G_l`: the length of leaves, metres, 0 to 100, over the relative position on the shoot.
    pub fn with_leaf_size(mut self, curve: Curve) -> Self {
        self.leaf_size = curve;
        self
    }

    /// Share of the leaves that are on the tree, 0 to 1, over the year. Each leaf falls when this share first
    /// gets as low as the leaf's own random number, and stays away for the rest of the year.
    pub fn with_leaf_share(mut self, curve: Curve) -> Self {
        self.leaf_share = curve;
        self
    }

    pub(super) fn curves(&self) -> impl Iterator<Item = (&'static str, &Curve)> {
        let colors = ["leaf_red", "leaf_green", "leaf_blue"].into_iter().zip(&self.leaf_colors);
        self.ranges().into_iter().map(|(name, curve, ..)| (name, curve)).chain(colors)
    }

    fn ranges(&self) -> [(&'static str, &Curve, f32, f32); 5] {
        [
            ("internode_growth", &self.internode_growth, 0.0, 1.0),
            ("leaf_growth", &self.leaf_growth, 0.0, 1.0),
            ("bud_growth", &self.bud_growth, 0.0, 1.0),
            ("leaf_size", &self.leaf_size, 0.0, 100.0),
            ("leaf_share", &self.leaf_share, 0.0, 1.0),
        ]
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let [start, end] = self.season;
        let holds = start >= 0.0 && end <= 1.0 && end - start >= 0.01;
        let range = "two parts of the year, 0 to 1, ascending by at least 0.01";
        ParameterError::unless(holds, "Phenology.season", self.season, range)?;
        let years = self.leaf_years;
        ParameterError::unless((1..=50).contains(&years), "Phenology.leaf_years", years, "1 to 50")?;
        for (name, value, most) in [
            ("stagger", self.stagger, 0.95),
            ("bud_size", self.bud_size, 1.0),
            ("leaf_angle", self.leaf_angle, PI),
            ("light_turn", self.light_turn, 100.0),
        ] {
            let holds = (0.0..=most).contains(&value);
            ParameterError::unless(holds, &format!("Phenology.{name}"), value, &format!("0 to {most}"))?;
        }
        for (name, curve, least, most) in self.ranges() {
            curve.check(&format!("Phenology.{name}"), least, most)?;
        }
        for channel in &self.leaf_colors {
            channel.check("Phenology.leaf_colors", 0.0, 1.0)?;
        }
        let rising = self.internode_growth.points().windows(2).all(|pair| pair[0][1] <= pair[1][1]);
        let ends = [0.0, 1.0].map(|time| self.internode_growth.at(time));
        let range = "0 at first, not falling, 1 at last";
        let holds = rising && ends[0] <= 0.0 && ends[1] >= 1.0;
        ParameterError::unless(holds, "Phenology.internode_growth", ends, range)
    }

    /// The least part of the leaves that there was in the year so far.
    pub(super) fn least_share(&self, time: f32) -> f32 {
        // Between two points curves are monotone.
        let before = self.leaf_share.points().iter().filter(|point| point[0] <= time);
        before.map(|point| point[1]).fold(self.leaf_share.at(time), f32::min)
    }

    /// Progress of the season at this part of the year, 0 to 1.
    pub(super) fn progress(&self, year: f32) -> f32 {
        let [start, end] = self.season;
        ((year - start) / (end - start)).clamp(0.0, 1.0)
    }

    /// Size of the bud of a shoot's metamer `number` of `of` at this part of the year, as a share of its full
    /// size.
    pub(super) fn bud(&self, year: f32, number: u32, of: u32) -> f32 {
        let [start, end] = self.season;
        let start = start + (end - start) * self.stagger * number as f32 / of as f32;
        self.bud_growth.at(((year - start) / (1.0 - start)).clamp(0.0, 1.0))
    }

    /// The development of a shoot's metamer `number` of `of`, 0 to 1, when the season has come so far.
    pub(super) fn development(&self, progress: f32, number: u32, of: u32) -> f32 {
        let late = self.stagger * number as f32 / of as f32;
        // The last metamer starts one step before the stagger's end, so that all are done in time.
        ((progress - late) / (1.0 - self.stagger)).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use crate::growth::Architecture;

    /// Computed by hand: season 0.3 to 0.7, stagger 0.5, four metamers: they start at 0, 0.125, 0.25 and
    /// 0.375 of the season and take half of it each.
    #[test]
    fn metamers_follow_each_other() {
        let architecture = Architecture::default();
        let year = architecture.phenology().clone().with_season(0.3, 0.7).with_stagger(0.5);
        assert!((year.progress(0.5) - 0.5).abs() < 1e-6);
        assert!(year.progress(0.1) <= 0.0 && year.progress(0.9) >= 1.0);
        let at = |progress| [0, 1, 2, 3].map(|k| year.development(progress, k, 4));
        for (found, expected) in at(0.5).iter().zip([1.0, 0.75, 0.5, 0.25]) {
            assert!((found - expected).abs() < 1e-6, "{found}");
        }
        assert!(at(0.0).iter().all(|&u| u <= 0.0) && at(1.0).iter().all(|&u| u >= 1.0));
    }
}
