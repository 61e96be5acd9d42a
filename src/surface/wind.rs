//! Motion of a vertex in the wind: the reference that shaders follow.

use super::Mesh;
use crate::math::{UP, sin_cos};
use glam::Vec3;
use std::f32::consts::TAU;

/// Motion of a vertex in the wind, as a shader needs it.
///
/// The tree moves on three levels: the trunk sways, each limb (order 1) sways on the trunk, and each twig
/// (order 2, with all that it bears) sways on its limb. A vertex moves with the trunk, with its limb and with
/// its twig; leaves also flutter. With the gust **g** (a direction, as long as the wind is strong, at most 1)
/// and the time t in seconds, level i = 0, 1, 2 of a vertex is pushed by
///
/// ```text
/// a = 2π·t·[2, 5, 10][i] / 8 s + dot(axis, (11, 17, 13))        the axis of level 0, the trunk, is up
/// F = g·(0.6 + 0.4·sin a) + up·|g|·0.2·cos a
/// ```
///
/// which turns what it bears about `cross(axis, F)`, so that the vertex moves by
///
/// ```text
/// cross(cross(axis, F), moment) = F·dot(axis, moment) - axis·dot(F, moment)
/// ```
///
/// The moment is the integral, along the way from the level's base to the vertex, of the bending (radians per
/// metre, at the strongest gust) times the way from there to the vertex. Last, what flutters moves by
///
/// ```text
/// (up·|g| + g)·0.7·flutter·sin(2π·t·20 / 8 s + dot(position, (9, 7, 11)))
/// ```
///
/// Junctions stay closed because the motion is linear in the moments and a triangle's points move as its
/// corners do, so that a branch base with the moments of the place on its parent branch moves exactly as that
/// place. Its own level's moment is zero there. The cost of linear motion: a turn by the angle θ makes the
/// turned part longer by a factor of √(1 + θ²). The angles of a tip at the strongest gust are at most 0.12
/// rad by the trunk, 0.2 by the limb and 0.25 by the twig, and mostly half of that. Normals may stay as they
/// are.
///
/// Everything repeats after [`PERIOD`](Self::PERIOD) seconds. A level moves a vertex by at most 1.2·|g| times
/// its moment's length, and what has no moment does not move: roots never do.
///
/// Memory: 68 bytes per vertex. [`Tubes`](super::Tubes::with_wind), [`Levels`](super::Levels),
/// [`Implicit`](super::Implicit::with_wind) give it to their meshes, [`Sway`](super::Sway) to any other.
///
/// ```
/// use treesynth::{Skeleton, glam::Vec3, surface::Tubes};
///
/// let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y * 3.0], vec![None, Some(0)])?.with_radii(vec![0.02; 2])?;
/// let mesh = Tubes::default().with_wind(true).mesh(&pole)?;
/// let (wind, top) = (mesh.wind.last().unwrap(), *mesh.positions.last().unwrap());
/// assert!(wind.blown(top, 0.0, Vec3::X).x > top.x + 0.01);
/// assert_eq!(wind.blown(top, 0.0, Vec3::ZERO), top);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Wind {
    /// Moments of the trunk, the limb and the twig that bear the vertex: the integral of the bending times
    /// the distance, along the way to the vertex; metres times radians. Zero for levels that do not bear it.
    pub moments: [Vec3; 3],
    /// The unit directions of the limb and of the twig, from base to tip; the same on all that they bear, and zero where there
    /// is none.
    pub axes: [Vec3; 2],
    /// Flutter of a leaf's vertex, metres; zero on bark and where leaves are attached.
    pub flutter: f32,
    /// The node of the skeleton with whose internode it moves.
    pub node: u32,
}

/// Swings of trunk, limb and twig in a period, and of fluttering leaves.
const CYCLES: [f32; 3] = [2.0, 5.0, 10.0];
const FLUTTERS: f32 = 20.0;
/// Phase between a level's swings and another's, radians for its axis.
const PHASE: Vec3 = Vec3::new(11.0, 17.0, 13.0);
/// The same of fluttering leaves, radians per metre.
const WAVE: Vec3 = Vec3::new(9.0, 7.0, 11.0);
/// The mean push and its swings, along the gust; what lifts and lowers.
const MEAN: f32 = 0.6;
const SWING: f32 = 0.4;
const LIFT: f32 = 0.2;

impl Wind {
    /// Seconds after which the motion repeats.
    pub const PERIOD: f32 = 8.0;

    /// Position of a vertex, whose position at rest is `position`, at `time` seconds in the wind `gust`: a
    /// direction whose length is the strength, 1 for the strongest wind. Longer gusts are clamped to 1; a
    /// gust that is not finite counts as no wind. Without wind the position comes back bit by bit. See
    /// [`Wind`] for the formula.
    pub fn blown(&self, position: Vec3, time: f32, gust: Vec3) -> Vec3 {
        let Some(air) = Air::new(time, gust) else { return position };
        position + self.moved(position, &air)
    }

    pub(crate) fn moved(&self, position: Vec3, air: &Air) -> Vec3 {
        let axes = [UP, self.axes[0], self.axes[1]];
        let mut moved = Vec3::ZERO;
        for (level, (axis, moment)) in axes.into_iter().zip(self.moments).enumerate() {
            if moment != Vec3::ZERO {
                let push = air.push(level, axis);
                moved += push * axis.dot(moment) - axis * push.dot(moment);
            }
        }
        moved + air.flutter(position) * self.flutter
    }

    /// The rotation of a small thing on a branch, as an axis times radians, if the branch turns by these angles.
    pub(crate) fn turned(&self, angles: [f32; 3], air: &Air) -> Vec3 {
        let axes = [UP, self.axes[0], self.axes[1]];
        let levels = axes.into_iter().zip(angles).enumerate();
        levels.map(|(level, (axis, angle))| axis.cross(air.push(level, axis)) * angle).sum()
    }

    pub(super) fn is_finite(&self) -> bool {
        self.moments.iter().chain(&self.axes).all(|vector| vector.is_finite()) && self.flutter.is_finite()
    }
}

/// The air at a time, where it moves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Air {
    gust: Vec3,
    strength: f32,
    /// The part of the period that has passed.
    part: f32,
}

impl Air {
    /// `None` when nothing moves.
    pub(crate) fn new(time: f32, gust: Vec3) -> Option<Self> {
        let longest = gust.abs().max_element();
        if !gust.is_finite() || longest == 0.0 {
            return None;
        }
        // Scaled, so that nothing overflows.
        let length = (gust / longest).length() * longest;
        let gust = if length > 1.0 { gust / longest / (gust / longest).length() } else { gust };
        let time = if time.is_finite() { time } else { 0.0 };
        let part = time.rem_euclid(Wind::PERIOD) / Wind::PERIOD;
        Some(Self { gust, strength: length.min(1.0), part })
    }

    pub(super) fn push(&self, level: usize, axis: Vec3) -> Vec3 {
        let (sin, cos) = sin_cos(TAU * (self.part * CYCLES[level]) + axis.dot(PHASE));
        self.gust * (MEAN + SWING * sin) + UP * (self.strength * LIFT * cos)
    }

    /// Displacement of a leaf whose flutter is 1.
    pub(crate) fn flutter(&self, position: Vec3) -> Vec3 {
        let (sin, _) = sin_cos(TAU * (self.part * FLUTTERS) + position.dot(WAVE));
        (UP * self.strength + self.gust) * (0.7 * sin)
    }
}

impl Mesh {
    /// The mesh as the wind has moved it: each position is [blown](Wind::blown), and all else, the normals too, is as it
    /// was. A mesh without [`wind`](Self::wind) stays as it is. O(vertices).
    #[must_use]
    pub fn blown(&self, time: f32, gust: Vec3) -> Self {
        let mut mesh = self.clone();
        for (position, wind) in mesh.positions.iter_mut().zip(&self.wind) {
            *position = wind.blown(*position, time, gust);
        }
        mesh
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIND: Wind = Wind {
        moments: [Vec3::new(0.1, 0.5, 0.2), Vec3::new(0.3, 0.1, -0.2), Vec3::new(0.05, 0.02, 0.1)],
        axes: [Vec3::X, Vec3::Z],
        flutter: 0.02,
        node: 3,
    };

    #[test]
    fn still_air_moves_nothing() {
        let place = Vec3::new(-0.0, 3.0, f32::MIN_POSITIVE);
        for gust in [Vec3::ZERO, -Vec3::ZERO, Vec3::NAN, Vec3::new(1.0, f32::INFINITY, 0.0)] {
            let blown = WIND.blown(place, 1.3, gust);
            assert_eq!(blown.to_array().map(f32::to_bits), place.to_array().map(f32::to_bits));
        }
        assert_eq!(Wind::default().blown(Vec3::ONE, 1.0, Vec3::X), Vec3::ONE);
    }

    #[test]
    fn motion_is_bounded_continuous_and_repeats() {
        let place = Vec3::new(1.0, 4.0, -2.0);
        let bound = 1.2 * WIND.moments.iter().map(|m| m.length()).sum::<f32>() + 1.4 * WIND.flutter;
        for gust in [Vec3::X, Vec3::new(-0.3, 0.1, 0.4), Vec3::Y, Vec3::splat(1e30), Vec3::Z * 1e-30] {
            let mut before = WIND.blown(place, -3.0, gust);
            for step in 1..=11_000 {
                let time = -3.0 + step as f32 * 1e-3;
                let now = WIND.blown(place, time, gust);
                assert!(now.distance(place) <= bound, "{now}");
                assert!(now.distance(before) <= 1e-3 * 20.0 * bound, "{time}: {before} {now}");
                assert!(now.distance(WIND.blown(place, time + Wind::PERIOD, gust)) < 1e-4);
                before = now;
            }
        }
        assert_eq!(WIND.blown(place, 0.0, Vec3::X), WIND.blown(place, f32::NAN, Vec3::X * 7.0));
    }

    #[test]
    fn what_the_wind_pushes_goes_its_way() {
        // A pole on the trunk's level, and a limb across the wind.
        let pole = Wind { moments: [Vec3::Y, Vec3::ZERO, Vec3::ZERO], ..Wind::default() };
        let limb = Wind { moments: [Vec3::ZERO, Vec3::Z, Vec3::ZERO], axes: [Vec3::Z, Vec3::ZERO], ..pole };
        for time in [0.0, 0.7, 2.9, 6.0] {
            for wind in [pole, limb] {
                let moved = wind.blown(Vec3::ZERO, time, Vec3::X);
                assert!(moved.x >= 0.199 && moved.x <= 1.001, "{moved}");
            }
        }
    }
}
