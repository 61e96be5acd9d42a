//! Bend of tubes in the wind.

use super::Sway;
use super::axis::{Axes, Axis, Station};
use super::circle::Circles;
use super::collar::Curves;
use super::sway::Bend;
use super::wood::Place;
use glam::Vec3;

/// Bend of the stations of all axes. A branch moves with the triangles of its parent branch, and these are straight between
/// two rings, while the skeleton between is not.
pub(super) struct Swung<'a> {
    pub(super) sway: &'a Sway,
    axes: &'a Axes,
    /// Bend of each station.
    pub(super) bends: Vec<Bend>,
    /// Difference of each axis' moments from the skeleton's.
    offsets: Vec<[Vec3; 3]>,
}

impl<'a> Swung<'a> {
    pub(super) fn new(sway: &'a Sway, axes: &'a Axes) -> Self {
        let none = sway.bend_at(0, 0.0);
        Self { sway, axes, bends: vec![none; axes.stations.len()], offsets: Vec::new() }
    }

    /// Bends an axis; its parent axis must have been bent before.
    pub(super) fn swing(&mut self, number: usize) {
        let axis = &self.axes.all[number];
        let base = axis.base.position;
        let goes_on = number > 0 && self.axes.all[number - 1].branch == axis.branch;
        let offset = match axis.bearing {
            Some((bearer, ring)) => {
                let near = self.axes.wood(bearer).near(base, ring);
                let first = self.axes.all[bearer].wood + near.place.ring;
                let last = self.axes.all[bearer].stations.end - 1;
                let bend = self.bends[first].lerp(&self.bends[(first + 1).min(last)], near.place.part);
                let own = self.sway.bend_at(axis.branch, axis.base.at).moments_of(base);
                let borne = bend.moments_of(base);
                std::array::from_fn(|level| borne[level] - own[level])
            }
            None if goes_on => self.offsets[number - 1],
            None => [Vec3::ZERO; 3],
        };
        for station in axis.wood..axis.stations.end {
            let Station { position, at, .. } = self.axes.stations[station];
            let mut bend = self.sway.bend_at(axis.branch, at).moved_to(position);
            bend.moments = std::array::from_fn(|level| bend.moments[level] + offset[level]);
            self.bends[station] = bend;
        }
        self.offsets.push(offset);
    }

    /// For each foot of an axis' collar, the moments of its place on the parent axis less those of a ring that bends so, and
    /// the parent's node there.
    pub(super) fn feet(
        &self,
        circles: &Circles,
        axis: &Axis,
        curves: &[Curves],
        ring: &Bend,
    ) -> Vec<([Vec3; 3], u32)> {
        let Some((number, _)) = axis.bearing.filter(|_| axis.has_collar) else { return Vec::new() };
        let (bearer, wood) = (&self.axes.all[number], self.axes.wood(number));
        let circle = &circles.of(bearer.sides).corners;
        let bends = &self.bends[bearer.wood..bearer.stations.end];
        let foot = |(foot, &(place, turns)): (Vec3, &(Place, f32))| {
            let (mut moments, mut middle, mut angles) = ([Vec3::ZERO; 3], Vec3::ZERO, [0.0; 3]);
            let mut at = 0.0;
            for (ring, corner, weight) in wood.corners(circle, place, turns) {
                let theirs = bends[ring].moments_of(corner);
                moments = std::array::from_fn(|level| moments[level] + theirs[level] * weight);
                angles = std::array::from_fn(|level| angles[level] + bends[ring].angles[level] * weight);
                middle += corner * weight;
                at += wood.stations[ring].at * weight;
            }
            // It is sunk below the triangles.
            let there = Bend { at: middle, angles, moments }.moments_of(foot);
            let own = ring.moments_of(foot);
            (std::array::from_fn(|level| there[level] - own[level]), self.sway.node_at(bearer.branch, at))
        };
        let four = |curves: &Curves| curves.feet().to_array().into_iter().zip(curves.places);
        curves.iter().flat_map(four).map(|(point, place)| foot((point, &place))).collect()
    }
}
