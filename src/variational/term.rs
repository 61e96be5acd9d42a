//! Angles and lengths of internodes, and how they change when nodes move.

use glam::DVec3;

/// A number and its gradients by the positions it was worked out from.
pub(super) struct Measured<const N: usize> {
    pub(super) value: f64,
    pub(super) gradient: [DVec3; N],
}

/// Length below which a direction is undefined, metres.
const TINY: f64 = 1e-9;

/// Angle between the internode from `from` to `to` and the one from `before` to `from`, by (before, from, to).
///
/// The angle in radians, [0, π]. If it is 0 or π, or a length is zero, the gradient is taken as zero.
pub(super) fn angle(before: DVec3, from: DVec3, to: DVec3) -> Measured<3> {
    let (u, v) = (to - from, from - before);
    let (cross, dot) = (u.cross(v), u.dot(v));
    let (sin, uu, vv) = (cross.length(), u.length_squared(), v.length_squared());
    let value = libm::atan2(sin, dot);
    if sin <= 1e-9 * (uu * vv).sqrt() || uu.min(vv) < TINY * TINY {
        return Measured { value, gradient: [DVec3::ZERO; 3] };
    }
    // Each direction turns in the plane of both, the faster the shorter it is.
    let by_u = (u * (dot / uu) - v) / sin;
    let by_v = (v * (dot / vv) - u) / sin;
    Measured { value, gradient: [-by_v, by_v - by_u, by_u] }
}

/// Angle by which `d` is turned against `a` about the axis from `b` to `c`, by (a, b, c, d).
///
/// The torsion angle in radians, (-π, π], right-handed. If a, b, c or b, c, d are in line, the gradient is
/// taken as zero. Blondel and Karplus 1996, "New formulation for derivatives of torsion angles", equation 27.
pub(super) fn turn(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> Measured<4> {
    let (f, g, h) = (a - b, b - c, d - c);
    let (m, n) = (f.cross(g), h.cross(g));
    let (mm, nn, length) = (m.length_squared(), n.length_squared(), g.length());
    let value = libm::atan2(n.cross(m).dot(g), m.dot(n) * length);
    let flat = |square: f64, other: DVec3| square <= 1e-9 * other.length_squared() * length * length;
    if length < TINY || flat(mm, f) || flat(nn, h) {
        return Measured { value, gradient: [DVec3::ZERO; 4] };
    }
    let (m, n) = (m / mm, n / nn);
    let along = (m * f.dot(g) - n * h.dot(g)) / length;
    Measured { value, gradient: [m * -length, m * length + along, -(n * length) - along, n * length] }
}

/// An angle brought into (-π, π].
pub(super) fn wrapped(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let turns = (angle / TAU).floor();
    let positive = angle - turns * TAU;
    if positive > PI { positive - TAU } else { positive }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    const O: DVec3 = DVec3::ZERO;

    #[test]
    fn by_hand() {
        assert!((angle(-DVec3::Y, O, DVec3::X).value - FRAC_PI_2).abs() < 1e-12);
        assert!((angle(-DVec3::Y, O, DVec3::new(1.0, 1.0, 0.0)).value - PI / 4.0).abs() < 1e-12);
        // About +Y, from +Z to +X is a quarter turn to the right hand.
        assert!((turn(DVec3::Z, O, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)).value - FRAC_PI_2).abs() < 1e-12);
        assert!((turn(DVec3::X, O, DVec3::Y, DVec3::new(0.0, 1.0, 1.0)).value + FRAC_PI_2).abs() < 1e-12);
        assert!((wrapped(3.5 * PI) + FRAC_PI_2).abs() < 1e-12 && (wrapped(-PI) - PI).abs() < 1e-12);
    }

    #[test]
    fn degenerate_places_have_no_gradient() {
        assert!(angle(O, O, DVec3::X).gradient.iter().all(|&g| g == O));
        assert!(angle(-DVec3::X, O, DVec3::X).gradient.iter().all(|&g| g == O));
        assert!(turn(DVec3::Y * 2.0, O, DVec3::Y, DVec3::X).gradient.iter().all(|&g| g == O));
        assert!(turn(DVec3::X, O, O, DVec3::X).value.is_finite());
    }

    fn slope<const N: usize>(points: [DVec3; N], f: impl Fn([DVec3; N]) -> Measured<N>) -> f64 {
        let at = f(points);
        let mut worst = 0.0_f64;
        for point in 0..N {
            for axis in 0..3 {
                let moved = |by: f64| {
                    let mut points = points;
                    points[point][axis] += by;
                    f(points).value
                };
                let measured = wrapped(moved(1e-6) - moved(-1e-6)) / 2e-6;
                worst = worst.max((measured - at.gradient[point][axis]).abs());
            }
        }
        worst
    }

    fn place() -> impl Strategy<Value = DVec3> {
        [-1.0..1.0, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from_array)
    }

    proptest! {
        #[test]
        fn gradients_are_slopes(a in place(), b in place(), c in place(), d in place()) {
            let area = |u: DVec3, v: DVec3| u.cross(v).length();
            prop_assume!(area(a - b, c - b) > 0.05 && area(b - c, d - c) > 0.05);
            prop_assert!(slope([a, b, c], |[a, b, c]| angle(a, b, c)) < 1e-4);
            prop_assert!(slope([a, b, c, d], |[a, b, c, d]| turn(a, b, c, d)) < 1e-4);
        }
    }
}
