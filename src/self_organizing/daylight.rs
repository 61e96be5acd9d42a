//! Directions that light comes from: the sky, and the sun's path by latitude.

use super::habit::within;
use crate::{ParameterError, math};
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, TAU};

/// Rings of the sky: the angle from the zenith, degrees; directions in the ring; the weight of the ring, which is the
/// light that a level surface gets from its part of a sky that is equally bright everywhere.
const RINGS: [(f32, u32, f32); 3] = [(0.0, 1, 0.07), (30.0, 6, 0.43), (58.0, 10, 0.5)];
/// The obliquity of the ecliptic, radians.
const OBLIQUITY: f32 = 23.44 * std::f32::consts::PI / 180.0;
/// The sun's place on the ecliptic in the middles of the thirds of a summer half-year, radians after the equinox.
const THIRDS: [f32; 3] = [TAU / 12.0, TAU / 4.0, TAU * 5.0 / 12.0];
/// The sun is followed in so many steps a day.
const HOURS: u32 = 24;
/// Below this sine of its height the sun does not count.
const LOWEST: f32 = 0.1;

/// The light of a growing season: of a sky that is equally bright everywhere, and of the sun on its path at a
/// latitude, as [directions with weights](Self::directions).
///
/// The season is the summer half-year, from equinox to equinox; between the tropics both halves of the year count, each
/// the more the nearer its solstice's sun is to the zenith. South is +Z, east is +X.
///
/// The sun's height and azimuth by latitude, declination and hour are those of spherical astronomy (Duffie and Beckman
/// 2013, "Solar engineering of thermal processes", section 1.6); what it sends through the air to a level surface is
/// that of Meinel and Meinel 1976, "Applied solar energy": `sin h · 0.7^((1 / sin h)^0.678)`.
///
/// ```
/// use treesynth::self_organizing::{Daylight, ShadowPropagation};
///
/// let kiev = Daylight::at_latitude(50f32.to_radians());
/// let mean: treesynth::glam::Vec3 = kiev.directions().iter().map(|(direction, weight)| *direction * *weight).sum();
/// assert!(mean.z > 0.1 && mean.x.abs() < 1e-3);
/// let light = ShadowPropagation::default().with_daylight(kiev);
/// # let _ = light;
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[must_use]
pub struct Daylight {
    latitude: f32,
    direct: f32,
}

crate::recipe::readable!(Daylight { direct: f32 });

impl Daylight {
    /// At a latitude, radians, in [-π/2, π/2], the southern ones below 0. Half of the light comes from the sun.
    pub fn at_latitude(radians: f32) -> Self {
        Self { latitude: radians, direct: 0.5 }
    }

    /// Sets the part of the light that comes from the sun itself, in [0, 1]; 0.5 by default. The rest is the sky's.
    pub fn with_direct(mut self, part: f32) -> Self {
        self.direct = part;
        self
    }

    /// The latitude in radians, as [`at_latitude`](Self::at_latitude) was given it.
    pub fn latitude(&self) -> f32 {
        self.latitude
    }

    /// Unit vectors towards the light, all above the horizon, with weights that add up to 1. Empty if the options are out of
    /// range.
    pub fn directions(self) -> Vec<(Vec3, f32)> {
        if self.check().is_err() {
            return Vec::new();
        }
        let sun = sun(self.latitude);
        let all: f32 = sun.iter().map(|(_, weight)| weight).sum();
        // At the poles the sun never rises high enough to be nothing; a sum of 0 cannot be, but a division by it must not.
        let direct = if all > 0.0 { self.direct } else { 0.0 };
        let sky =
            Self::overcast().into_iter().map(|(direction, weight)| (direction, weight * (1.0 - direct)));
        let sun = sun.into_iter().map(|(direction, weight)| (direction, weight * (direct / all.max(1e-9))));
        sky.chain(sun).filter(|&(_, weight)| weight > 0.0).collect()
    }

    /// The sky alone.
    pub(super) fn overcast() -> Vec<(Vec3, f32)> {
        RINGS
            .iter()
            .flat_map(|&(zenith, count, weight)| {
                let (sin, cos) = math::sin_cos(zenith.to_radians());
                (0..count).map(move |i| {
                    let (s, c) = math::sin_cos((i as f32 + 0.5) / count as f32 * TAU);
                    (Vec3::new(sin * c, cos, sin * s), weight / count as f32)
                })
            })
            .collect()
    }

    pub(super) fn check(self) -> Result<(), ParameterError> {
        within("Daylight.latitude", self.latitude, -FRAC_PI_2, FRAC_PI_2)?;
        within("Daylight.direct", self.direct, 0.0, 1.0)
    }
}

/// Places of the sun over the season, with what it sends to a level surface from there.
fn sun(latitude: f32) -> Vec<(Vec3, f32)> {
    let (sin, cos) = math::sin_cos(latitude);
    let north = (0.5 + 0.5 * latitude / OBLIQUITY).clamp(0.0, 1.0);
    let mut places = Vec::new();
    for (half, share) in [(1.0, north), (-1.0, 1.0 - north)] {
        for third in THIRDS {
            let up = half * math::sin(OBLIQUITY) * math::sin(third);
            let (sin_declination, cos_declination) = (up, (1.0 - up * up).sqrt());
            for hour in 0..HOURS {
                let (s, c) = math::sin_cos((hour as f32 + 0.5) / HOURS as f32 * TAU);
                let height = sin * sin_declination + cos * cos_declination * c;
                let south = sin * cos_declination * c - cos * sin_declination;
                if height > LOWEST && share > 0.0 {
                    let through = math::powf(0.7, math::powf(1.0 / height, 0.678));
                    let place = Vec3::new(-cos_declination * s, height, south);
                    places.push((place.normalize_or(Vec3::Y), share * height * through));
                }
            }
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(latitude: f32) -> Vec3 {
        let directions = Daylight::at_latitude(latitude.to_radians()).directions();
        let all: f32 = directions.iter().map(|(_, weight)| weight).sum();
        assert!((all - 1.0).abs() < 1e-4, "{all}");
        assert!(directions.iter().all(|(direction, weight)| {
            direction.is_normalized() && direction.y > 0.05 && (0.0..=1.0).contains(weight)
        }));
        directions.iter().map(|(direction, weight)| *direction * *weight).sum()
    }

    #[test]
    fn the_sun_stands_in_the_south_of_the_north() {
        assert!(mean(50.0).z > 0.15 && mean(-50.0).z < -0.15 && mean(0.0).z.abs() < 1e-3);
        assert!(mean(60.0).z > mean(40.0).z && mean(40.0).z > mean(20.0).z);
        for latitude in [-90.0f32, -66.0, -23.0, 0.0, 10.0, 45.0, 89.9, 90.0] {
            let mean = mean(latitude);
            assert!(mean.is_finite() && mean.x.abs() < 1e-3 && mean.y > 0.3, "{latitude}: {mean}");
        }
    }

    /// At noon of midsummer it stands at 90° - 50° + 23.44°.
    #[test]
    fn noon_is_where_astronomy_has_it() {
        let highest = sun(50f32.to_radians()).into_iter().map(|(place, _)| place.y).fold(0.0, f32::max);
        // The nearest step is half an hour from noon.
        assert!(
            (math::asin(highest).to_degrees() - 63.44).abs() < 1.5,
            "{}",
            math::asin(highest).to_degrees()
        );
    }

    #[test]
    fn bad_light_is_named() {
        for (light, name) in [
            (Daylight::at_latitude(2.0), "Daylight.latitude"),
            (Daylight::at_latitude(f32::NAN), "Daylight.latitude"),
            (Daylight::at_latitude(0.0).with_direct(1.5), "Daylight.direct"),
        ] {
            assert_eq!(light.check().unwrap_err().parameter, name);
            assert!(light.directions().is_empty());
        }
    }
}
