//! The cone segments of one branch, and which of them its parent branch can feel.

use super::primitive::Primitive;
use glam::Vec3;

/// How far from a lateral's base its bearer may be bent, as a multiple of the straight way.
const WINDING: f32 = 2.0;

/// A branch as cone segments, its shoots end to end.
#[derive(Debug)]
pub(super) struct Limb {
    pub(super) cones: Vec<Primitive>,
    /// For each shoot the number of the cone after its last.
    pub(super) shoots: Vec<usize>,
    /// For each place on the axis the number of the cone that begins there.
    begins: Vec<u32>,
    /// How many cones stand in the ground plane, and have to be cut off at it.
    pub(super) standing: usize,
}

impl Limb {
    /// Of cones that go through `places`, the axis' nodes from its base on.
    pub(super) fn new(
        cones: Vec<Primitive>,
        shoots: Vec<usize>,
        places: impl Iterator<Item = Vec3>,
    ) -> Self {
        let mut cone = 0;
        let mut before = None;
        let begins = places.map(|place| {
            // Nodes in one place have one cone.
            if before.is_some_and(|before| before != place) {
                cone += cones[cone..].iter().position(|cone| cone.ends[1] == place).map_or(0, |i| i + 1);
            }
            before = Some(place);
            cone as u32
        });
        let begins = begins.collect();
        Self { cones, shoots, begins, standing: 0 }
    }

    /// Cuts the cone in two that is so many metres from the base, and notes that those below it stand in the ground.
    pub(super) fn stand(&mut self, metres: f32) {
        let mut along = 0.0;
        for i in 0..self.cones.len() {
            let [from, to] = self.cones[i].ends;
            let length = from.distance(to);
            self.standing = i + 1;
            if along + length > metres {
                let t = (metres - along) / length;
                let [start, end] = self.cones[i].radii;
                let (middle, radius) = (from.lerp(to, t), start + (end - start) * t);
                let (mut below, mut above) = (self.cones[i], self.cones[i]);
                (below.ends[1], below.radii[1]) = (middle, radius);
                (above.ends[0], above.radii[0]) = (middle, radius);
                self.cones.splice(i..=i, [below, above]);
                self.shoots.iter_mut().filter(|end| **end > i).for_each(|end| *end += 1);
                self.begins.iter_mut().filter(|begin| **begin as usize > i).for_each(|begin| *begin += 1);
                return;
            }
            along += length;
        }
    }

    /// How many of its first cones the branch that bears it, at that place of its axis, can feel: up to the first that it
    /// cannot.
    pub(super) fn felt_by(&self, bearer: &Self, place: usize) -> usize {
        let Some((first, foot)) = self.cones.first().zip(bearer.begins.get(place)) else { return 0 };
        let foot = *foot as usize;
        let origin = if foot < bearer.cones.len() {
            bearer.cones[foot].ends[0]
        } else {
            bearer.cones.last().map_or(first.ends[0], |last| last.ends[1])
        };
        let mut along = origin.distance(first.ends[0]);
        // Cones beside one another are felt by cones beside one another.
        let mut hint = foot.min(bearer.cones.len().saturating_sub(1));
        for (i, cone) in self.cones.iter().enumerate() {
            along += cone.ends[0].distance(cone.ends[1]);
            let far = WINDING * (along + reach(cone));
            let meets = |k: usize| meet(cone, &bearer.cones[k]);
            if !meets(hint) {
                let up = within(&bearer.cones, foot..bearer.cones.len(), far);
                let down = within(&bearer.cones, (0..foot).rev(), far);
                match up.chain(down).find(|&k| meets(k)) {
                    Some(k) => hint = k,
                    None => return i,
                }
            }
        }
        self.cones.len()
    }
}

/// The numbers of cones in the order of `numbers`, as far as their way leads: so many metres, and their own reach.
fn within(
    cones: &[Primitive],
    numbers: impl Iterator<Item = usize>,
    metres: f32,
) -> impl Iterator<Item = usize> {
    let mut along = 0.0;
    numbers.take_while(move |&k| {
        let near = along <= metres + WINDING * reach(&cones[k]);
        along += cones[k].ends[0].distance(cones[k].ends[1]);
        near
    })
}

/// How far from its axis a cone is felt at most, metres.
fn reach(cone: &Primitive) -> f32 {
    cone.radii[0].max(cone.radii[1]) * cone.field.reach()
}

/// Whether both may be felt in one place.
fn meet(a: &Primitive, b: &Primitive) -> bool {
    // Nothing that is not a number is far.
    !(distance(a.ends, b.ends) > reach(a) + reach(b))
}

/// The least distance of two line segments, metres.
fn distance(a: [Vec3; 2], b: [Vec3; 2]) -> f32 {
    let (along, beside, between) = (a[1] - a[0], b[1] - b[0], b[0] - a[0]);
    let normal = along.cross(beside);
    let square = normal.length_squared();
    let [s, t] = [between.cross(beside), between.cross(along)].map(|cross| cross.dot(normal) / square);
    // Where their lines are nearest, if that is on both; else at an end of one.
    if square > 0.0 && (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
        return between.dot(normal).abs() / square.sqrt();
    }
    let ends = [to_segment(a[0], b), to_segment(a[1], b), to_segment(b[0], a), to_segment(b[1], a)];
    ends.into_iter().fold(f32::INFINITY, f32::min)
}

fn to_segment(point: Vec3, [from, to]: [Vec3; 2]) -> f32 {
    let way = to - from;
    let t = (point - from).dot(way) / way.length_squared().max(f32::MIN_POSITIVE);
    (point - from - way * t.clamp(0.0, 1.0)).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_as_far_apart_as_their_nearest_points() {
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        // Crossing at a height, end to side, end to end, parallel, a point.
        for (a, b, expected) in [
            ([at(-1., 0., 0.), at(1., 0., 0.)], [at(0., -1., 2.), at(0., 1., 2.)], 2.0),
            ([at(-1., 0., 0.), at(1., 0., 0.)], [at(0., 3., 0.), at(0., 9., 1.)], 3.0),
            ([at(0., 0., 0.), at(1., 0., 0.)], [at(4., 4., 0.), at(9., 9., 0.)], 5.0),
            ([at(0., 0., 0.), at(1., 0., 0.)], [at(0.5, 0.5, 0.), at(3., 0.5, 0.)], 0.5),
            ([at(0., 0., 0.), at(1., 0., 0.)], [at(0.3, 0., -1.), at(0.3, 0., -1.)], 1.0),
        ] {
            let found = [distance(a, b), distance(b, a)];
            assert!(found.iter().all(|found| (found - expected).abs() < 1e-6), "{found:?} not {expected}");
        }
    }

    /// A lateral that leaves a stem at right angles is felt up to where both reaches touch.
    #[test]
    fn a_lateral_is_felt_as_far_as_both_fields_reach() {
        let stem: Vec<Primitive> = (0..10)
            .map(|i| Primitive::line(Vec3::Y * i as f32 * 0.1, Vec3::Y * (i + 1) as f32 * 0.1, 0.1))
            .collect();
        let twig: Vec<Primitive> = (0..20)
            .map(|i| {
                let at = |i: i32| Vec3::new(i as f32 * 0.05, 0.5, 0.0);
                Primitive::line(at(i), at(i + 1), 0.02)
            })
            .collect();
        let places = (0..=10).map(|i| Vec3::Y * i as f32 * 0.1);
        let stem = Limb::new(stem, vec![10], places);
        let twig = Limb::new(twig, vec![20], (0..=20).map(|i| Vec3::new(i as f32 * 0.05, 0.5, 0.0)));
        // 0.15 m and 0.03 m: the fourth begins at 0.15 m, the fifth at 0.2 m.
        assert_eq!(twig.felt_by(&stem, 5), 4);
    }

    #[test]
    fn a_standing_limb_is_the_same_in_two_pieces() {
        let cone = |from: f32, to: f32| Primitive::cone([Vec3::Y * from, Vec3::Y * to], [0.2, 0.1]);
        let places = [0.0, 1.0, 2.0].map(|y| Vec3::Y * y);
        let mut limb = Limb::new(vec![cone(0.0, 1.0), cone(1.0, 2.0)], vec![1, 2], places.into_iter());
        limb.stand(0.25);
        assert_eq!((limb.standing, &limb.shoots[..], &limb.begins[..]), (1, &[2, 3][..], &[0, 2, 3][..]));
        let [below, above] = [limb.cones[0], limb.cones[1]];
        assert_eq!((below.ends[1], below.radii[1]), (above.ends[0], above.radii[0]));
        assert!((below.radii[1] - 0.175).abs() < 1e-6);
    }
}
