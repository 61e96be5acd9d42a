//! The outline of a crown, with its bulges, about a middle that is off the stem.

use super::data::Crown;
use super::draw::Draw;
use crate::math;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Waves of the outline: how often around, and how often from base to top.
const WAVES: [(f32, f32); 4] = [(2.0, 0.4), (3.0, -0.7), (4.0, 1.1), (5.0, -1.6)];

#[derive(Debug, Clone)]
pub(super) struct Outline {
    base: f32,
    top: f32,
    radius: f32,
    profile: Vec<f32>,
    eccentricity: f32,
    towards: f32,
    waves: [(f32, f32); WAVES.len()],
}

impl Outline {
    pub(super) fn new(crown: &Crown, base: f32, top: f32, radius: f32, draw: &mut Draw) -> Self {
        let eccentricity = draw.within(crown.eccentricity);
        let towards = draw.unit() * TAU;
        let waves = [0; WAVES.len()].map(|_| {
            let amplitude = crown.roughness * (0.5 + draw.unit()) * 0.7;
            (amplitude, draw.unit() * TAU)
        });
        Self { base, top, radius, profile: crown.profile.clone(), eccentricity, towards, waves }
    }

    /// The largest radius it would have without bulges, metres.
    pub(super) fn radius(&self) -> f32 {
        self.radius
    }

    pub(super) fn base(&self) -> f32 {
        self.base
    }

    pub(super) fn top(&self) -> f32 {
        self.top
    }

    /// Relative height in the crown: 0 at its base, 1 at its top.
    pub(super) fn share(&self, y: f32) -> f32 {
        ((y - self.base) / (self.top - self.base).max(1e-3)).clamp(0.0, 1.0)
    }

    /// From the stem to the outline at this height and azimuth, metres.
    pub(super) fn reach(&self, y: f32, azimuth: f32) -> f32 {
        let share = self.share(y);
        let at = share * (self.profile.len() - 1) as f32;
        let low = (at as usize).min(self.profile.len().saturating_sub(2));
        let high = (low + 1).min(self.profile.len() - 1);
        let profile = self.profile[low] + (self.profile[high] - self.profile[low]) * (at - low as f32);
        let mut factor = 1.0 + self.eccentricity * math::cos(azimuth - self.towards);
        for ((around, up), (amplitude, phase)) in WAVES.iter().zip(self.waves) {
            factor += amplitude * math::sin(around * azimuth + up * share * PI * 2.0 + phase);
        }
        self.radius * profile * factor.max(0.25)
    }

    fn is_outside(&self, point: Vec3, grace: f32) -> bool {
        let out = (point.x * point.x + point.z * point.z).sqrt();
        let azimuth = math::atan2(point.z, point.x);
        point.y > self.top || out > self.reach(point.y, azimuth) * grace
    }

    /// Distance from a point in a direction to the outline, at most `most` metres.
    pub(super) fn way_out(&self, from: Vec3, direction: Vec3, most: f32) -> f32 {
        let step = (self.radius * 0.06).clamp(0.02, most.max(0.02));
        let mut way = 0.0;
        while way < most {
            let next = (way + step).min(most);
            let point = from + direction * next;
            // A way that begins outside may still come in: near a slender top the stem itself is
            // out of the outline.
            if self.is_outside(point, 1.0) {
                return way;
            }
            way = next;
        }
        most
    }
}
