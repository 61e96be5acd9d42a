//! Starts of tubes: each begins within the wood of its parent branch.

use super::Tubes;
use super::axis::{Axes, Axis, Station};
use super::collar::{Collar, LONGEST};
use super::wood::Near;
use crate::math;
use crate::observer::{Cancelled, Watch};
use std::f32::consts::PI;

/// The part of its radius with which a branch without a collar begins, so that its rim stays within the wood
/// it springs from.
const HIDDEN: f32 = 0.6;
/// Steepest taper that tilts a normal: a cone this flat is a disc.
const STEEPEST_TAPER: f32 = 1e3;
/// Tips of at least this number of sides are domes; others are cones.
pub(super) const DOME_SIDES: u32 = 7;

impl Axes {
    /// Makes each axis begin where it comes out of its parent branch, or hidden within it. To be
    /// called once, since parent axes come before their laterals.
    pub(super) fn attach(&mut self, options: &Tubes, watch: &Watch<'_>) -> Result<(), Cancelled> {
        for number in 0..self.all.len() {
            self.begin(number, options);
            let stations = self.all[number].stations.clone();
            watch.pass(stations.len())?;
            taper(&mut self.stations[stations]);
        }
        Ok(())
    }

    /// Makes one axis begin so.
    fn begin(&mut self, number: usize, options: &Tubes) {
        let axis = &self.all[number];
        let goes_on = number > 0 && self.all[number - 1].branch == axis.branch;
        if goes_on {
            // After a sharp turn.
            let tip = within_tip(self.all[number - 1].sides);
            self.stations[axis.stations.start].radius *= tip;
            return;
        }
        let Some((bearer, station)) = self.bearing(axis) else {
            if axis.bearer.is_some() && options.collars {
                self.stations[axis.stations.start].radius *= HIDDEN;
            }
            return;
        };
        let base = self.wood(bearer).near(axis.base.position, station);
        let collar = if options.collars { Collar::of(self, axis, bearer, &base) } else { None };
        let Some(collar) = collar.filter(|collar| options.blends(collar.end.radius)) else {
            self.hide(number, bearer, &base, options);
            self.all[number].bearing = Some((bearer, base.place.ring));
            return;
        };
        // Below the base of a trunk there is no wood for a collar to be filled with.
        let wood = self.wood(bearer);
        let below = collar.start.tangent.dot(wood.stations[0].tangent) < 0.0;
        let hollow = below && self.stands(bearer, &wood.near(collar.start.position, collar.bearing));
        let first = collar.next - 1;
        self.stations[first] = collar.end;
        self.stations[first - 1] = collar.start;
        let axis = &mut self.all[number];
        axis.bearing = Some((bearer, collar.bearing));
        axis.has_collar = true;
        axis.stations.start = first;
        axis.wood = if hollow { first } else { first - 1 };
    }

    /// The numbers of the axis out of which another comes, and of the station where.
    ///
    /// That is its parent branch; or the parent of that, if the parent branch is still within it
    /// where it has this lateral.
    fn bearing(&self, axis: &Axis) -> Option<(usize, usize)> {
        // A parent branch without a surface of its own would have the branch itself there.
        let (mut bearer, mut station) =
            self.place(axis.bearer?).filter(|(_, place)| !axis.stations.contains(place))?;
        while let Some((elder, at)) = self.all[bearer].bearing {
            let parent = &self.all[bearer];
            let wood = self.wood(elder);
            let far = self.stations[station].along - parent.base.along;
            let is_clear = if parent.has_collar {
                station > parent.stations.start
            } else {
                far > LONGEST * (wood.stations[at].radius + parent.base.radius)
            };
            if is_clear || wood.near(axis.base.position, at).outside() > 0.0 {
                break;
            }
            (bearer, station) = (elder, self.all[elder].wood + at);
        }
        let first = self.all[bearer].wood;
        Some((bearer, station.saturating_sub(first)))
    }

    /// `true` if a place on an axis is the base of a trunk, which has wood on one side only.
    fn stands(&self, bearer: usize, base: &Near) -> bool {
        self.all[bearer].bearing.is_none() && base.place.is_start()
    }

    /// Makes an axis begin within its parent branch, without a collar.
    fn hide(&mut self, number: usize, bearer: usize, base: &Near, options: &Tubes) {
        let inscribed = math::cos(PI / self.all[bearer].sides as f32);
        let within = base.radius * inscribed * self.wood(bearer).slimness(base.place);
        let stands = self.stands(bearer, base);
        let first = &mut self.stations[self.all[number].stations.start];
        first.radius = first.radius.min(within);
        if options.collars {
            first.position -= base.way;
            first.radius *= if stands { 0.0 } else { HIDDEN };
        }
    }
}

/// Sets how fast the radius grows at each station, between its neighbours.
fn taper(stations: &mut [Station]) {
    let mut before = 0.0;
    for i in 0..stations.len() {
        let (from, to) = (i.saturating_sub(1), (i + 1).min(stations.len() - 1));
        let after = stations[i].position.distance(stations[to].position);
        let length = before + after;
        let growth = stations[to].radius - stations[from].radius;
        stations[i].taper =
            if length > 0.0 { (growth / length).clamp(-STEEPEST_TAPER, STEEPEST_TAPER) } else { 0.0 };
        before = after;
    }
}

/// The largest ring that is within the tip of a tube around its end, whatever way it faces, in radii of the tube.
fn within_tip(sides: u32) -> f32 {
    let within = math::cos(PI / sides as f32);
    if sides >= DOME_SIDES {
        // Half a step from the end's ring to the dome's.
        within * math::cos(PI / 8.0)
    } else {
        // The height of a face of the pyramid above the middle of its base.
        within / (1.0 + within * within).sqrt()
    }
}
