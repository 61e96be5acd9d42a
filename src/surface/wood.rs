//! The wood of a branch, as the rings of its tube span it.

use super::axis::Station;
use glam::Vec3;

/// The most rings that are passed on the way to a point. Points on a surface lie near; where very many rings stand
/// within a radius, one of them is as good as the next.
const FARTHEST: usize = 1024;

/// Steps to find where a ray comes out; every third halves what is left.
const MOST_STEPS: u32 = 24;

/// A place along a branch: the number of the ring below, and the part of the way to the next one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) ring: usize,
    pub(super) part: f32,
}

impl Place {
    /// `true` if it is where the branch begins.
    pub(super) fn is_start(self) -> bool {
        self.ring == 0 && self.part == 0.0
    }
}

/// Knowledge of a point near a branch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Near {
    pub(super) place: Place,
    /// The way from the axis to the point, and its length, metres.
    pub(super) way: Vec3,
    pub(super) distance: f32,
    /// The radius of the branch there.
    pub(super) radius: f32,
}

impl Near {
    /// Signed distance of the point from the branch; negative within.
    pub(super) fn outside(&self) -> f32 {
        self.distance - self.radius
    }
}

/// A tube between rings, with half a ball at either end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wood<'a> {
    pub(super) stations: &'a [Station],
}

impl<'a> Wood<'a> {
    /// Between the planes of which rings a point lies, looked for from ring `from`; an end where it lies beyond.
    #[inline]
    pub(super) fn place(&self, point: Vec3, from: usize) -> Place {
        let height = |station: &Station| (point - station.position).dot(station.tangent);
        let stations = self.stations;
        let mut ring = from.min(stations.len() - 1);
        let mut here = height(&stations[ring]);
        if here >= 0.0 {
            let last = (stations.len() - 1).min(ring + FARTHEST);
            while ring < last {
                let next = height(&stations[ring + 1]);
                if next <= 0.0 {
                    // Both are zero where two planes cross at the point.
                    return Place { ring, part: if here > 0.0 { here / (here - next) } else { 0.0 } };
                }
                (ring, here) = (ring + 1, next);
            }
        } else {
            let last = ring.saturating_sub(FARTHEST);
            while ring > last {
                let next = height(&stations[ring - 1]);
                ring -= 1;
                if next >= 0.0 {
                    return Place { ring, part: next / (next - here) };
                }
                here = next;
            }
        }
        Place { ring, part: 0.0 }
    }

    /// The rings below and above a place.
    #[inline]
    pub(super) fn around(&self, place: Place) -> (&'a Station, &'a Station) {
        let above = (place.ring + 1).min(self.stations.len() - 1);
        (&self.stations[place.ring], &self.stations[above])
    }

    /// The radius at a place.
    #[inline]
    pub(super) fn radius(&self, place: Place) -> f32 {
        let (below, above) = self.around(place);
        below.radius + (above.radius - below.radius) * place.part
    }

    /// Thickness of the tube about a place, in its radii: less than 1 where it bends, since its
    /// rings are oblique to it.
    pub(super) fn slimness(&self, place: Place) -> f32 {
        let rings = &self.stations[place.ring.saturating_sub(1)..(place.ring + 3).min(self.stations.len())];
        let obliqueness = rings.windows(2).map(|pair| {
            let way = (pair[1].position - pair[0].position).normalize_or(pair[0].tangent);
            way.dot(pair[0].tangent).min(way.dot(pair[1].tangent))
        });
        obliqueness.fold(1.0, f32::min).max(0.0)
    }

    /// Knowledge of a point, looked for from ring `from`.
    #[inline]
    pub(super) fn near(&self, point: Vec3, from: usize) -> Near {
        let place = self.place(point, from);
        let (below, above) = self.around(place);
        let way = point - below.position.lerp(above.position, place.part);
        Near { place, way, distance: way.length(), radius: self.radius(place) }
    }

    /// Place where a ray from within comes out, at most `longest` metres from its start: the
    /// distance, and knowledge of the point. `guess` metres are tried first. The secant method,
    /// which halves the interval where it would leave it, and every third time.
    #[inline]
    pub(super) fn exit(
        &self,
        (start, way): (Vec3, Vec3),
        guess: f32,
        longest: f32,
        tolerance: f32,
        from: usize,
    ) -> (f32, Near) {
        let (mut low, mut high) = (0.0, longest);
        let mut at = guess;
        let mut near = self.near(start + way * at, from);
        let mut outside = near.outside();
        let mut slope = near.way.dot(way) / near.distance;
        for step in 0..MOST_STEPS {
            if outside.abs() <= tolerance {
                break;
            }
            if outside < 0.0 {
                low = at;
            } else {
                high = at;
            }
            let next = at - outside / slope;
            let next = if step % 3 < 2 && next > low && next < high { next } else { 0.5 * (low + high) };
            near = self.near(start + way * next, near.place.ring);
            slope = (near.outside() - outside) / (next - at);
            (at, outside) = (next, near.outside());
        }
        (at, near)
    }

    /// The point `depth` below the tube's triangles at a place and an angle from where its rings begin, in turns, and
    /// the normal there, of no particular length. `circle` has the corners of the rings.
    #[inline]
    pub(super) fn surface(&self, circle: &[[f32; 2]], place: Place, turns: f32, depth: f32) -> (Vec3, Vec3) {
        let sides = circle.len() - 1;
        let at = (turns - turns.floor()) * sides as f32;
        let corner = (at as usize).min(sides - 1);
        let share = at - corner as f32;
        let [first, second] = [circle[corner], circle[corner + 1]];
        let between = [first[0] + (second[0] - first[0]) * share, first[1] + (second[1] - first[1]) * share];
        let (below, above) = self.around(place);
        let frame = |station: &Station| [station.normal, station.tangent.cross(station.normal)];
        let (low, high) = (frame(below), frame(above));
        let way = |[normal, binormal]: [Vec3; 2], [cos, sin]: [f32; 2]| normal * cos + binormal * sin;
        let (lower, upper) = (way(low, between), way(high, between));
        // A quad is two triangles; their common edge goes from the first corner below to the second above.
        let edge = if share >= place.part { second } else { first };
        let (from, to) =
            (below.position + way(low, edge) * below.radius, above.position + way(high, edge) * above.radius);
        let point = if share >= place.part {
            below.position + lower * below.radius + (to - from) * place.part
        } else {
            above.position + upper * above.radius - (to - from) * (1.0 - place.part)
        };
        let inward = lower.lerp(upper, place.part).normalize_or_zero() * depth;
        // The normals of a cone lean against its taper.
        let (lower, upper) = (lower - below.tangent * below.taper, upper - above.tangent * above.taper);
        (point - inward, lower.lerp(upper, place.part))
    }

    /// Corners of the triangle in which that point lies between the rings below and above, each
    /// with its weight.
    #[inline]
    pub(super) fn corners(&self, circle: &[[f32; 2]], place: Place, turns: f32) -> [(usize, Vec3, f32); 3] {
        let sides = circle.len() - 1;
        let at = (turns - turns.floor()) * sides as f32;
        let corner = (at as usize).min(sides - 1);
        let share = at - corner as f32;
        let rings = [place.ring, (place.ring + 1).min(self.stations.len() - 1)];
        let vertex = |above: usize, corner: usize, weight: f32| {
            let Station { position, radius, tangent, normal, .. } = self.stations[rings[above]];
            let [cos, sin] = circle[corner];
            (rings[above], position + (normal * cos + tangent.cross(normal) * sin) * radius, weight)
        };
        let part = place.part;
        if share >= part {
            [vertex(0, corner, 1.0 - share), vertex(0, corner + 1, share - part), vertex(1, corner + 1, part)]
        } else {
            [vertex(1, corner, part - share), vertex(1, corner + 1, share), vertex(0, corner, 1.0 - part)]
        }
    }
}
