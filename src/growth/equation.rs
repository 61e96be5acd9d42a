//! Equations 5 to 15 of the paper, each by itself.
//!
//! G with an index is a curve of the [`Architecture`](super::Architecture); lengths are metres, angles radians, times years.

use super::Curve;

/// Equation 5, `l_y + l_min <= l_(y+1)`: whether a branch grows as much in a year as every branch has to.
///
/// The paper writes "less than", but its equation 7 gives equality for branches at their least growth.
pub fn grows_enough(before: f32, after: f32, least_shoot: f32) -> bool {
    before + least_shoot <= after
}

/// Equation 6, `l_dy = l_py·((1 - t_y)·G_s1(x_y) + t_y·G_s2(x_y))`: the length that the silhouette wants of a branch.
///
/// `parent` is the length of its parent branch in the same year, `time` the year as a part of the greatest
/// age, and `young` and `mature` are the two silhouettes at the branch's relative position.
pub fn wanted_length(parent: f32, time: f32, young: f32, mature: f32) -> f32 {
    parent * ((1.0 - time) * young + time * mature)
}

/// Equation 7, `l_y = max(l_dy, l_(y-1) + l_min)`: the length a branch gets.
pub fn enforced_length(wanted: f32, before: f32, least_shoot: f32) -> f32 {
    wanted.max(before + least_shoot)
}

/// Equation 8, `s_θ = l_y / l_max`, cut off at 1.
pub fn length_share(length: f32, longest: f32) -> f32 {
    (length / longest).min(1.0)
}

/// Equation 9, `θ = (1 - s_θ)·G_o1(x_y) + s_θ·G_o2(x_y)`: the angle between a segment and its branch's first
/// heading, positive towards the parent branch.
///
/// `short` and `long` are the curves at the segment's relative position on its own branch.
pub fn heading(share: f32, short: f32, long: f32) -> f32 {
    (1.0 - share) * short + share * long
}

/// Equation 10, `s_b = G_bs(x_max)`: the scale of a first-order branch; `at_end` is its relative position in the last
/// year.
pub fn scale(branch_scale: &Curve, at_end: f32) -> f32 {
    branch_scale.at(at_end)
}

/// Equation 11, `a = G_a(s_b)`: the age at which a branch is lost.
pub fn lost_at(lifespan: &Curve, scale: f32) -> f32 {
    lifespan.at(scale)
}

/// Equation 12, `l_y = max(l_dy, l_(y-1) + l_min) / (0.5·order + 1)`, with the previous length and the least shoot times
/// that divisor.
///
/// As printed, the length of the year before would be divided anew every year and branches of order 2 would halve.
/// With both terms multiplied, equation 5 holds for every order, and what the silhouette wants is divided as printed.
/// At order 0 this is equation 7; the growth takes it as printed for all orders, 1.5 for the first.
pub fn higher_order_length(wanted: f32, before: f32, least_shoot: f32, order: u16) -> f32 {
    let divisor = order_divisor(order);
    (wanted / divisor).max(before + least_shoot)
}

/// The divisor of equation 12, `0.5·order + 1`.
pub fn order_divisor(order: u16) -> f32 {
    0.5 * f32::from(order) + 1.0
}

/// Equation 13, `s_b = s_bp·G_bs(x_max)`: the scale of a branch on one of scale `parent`.
pub fn inherited_scale(branch_scale: &Curve, parent: f32, at_end: f32) -> f32 {
    parent * scale(branch_scale, at_end)
}

/// Equation 14, `m = G_m(q)` with `q = l_s / l_smax`: the number of metamers of a shoot, rounded, at least 1.
pub fn metamers(metamers: &Curve, shoot: f32, longest_shoot: f32) -> u32 {
    let q = if longest_shoot > 0.0 { (shoot / longest_shoot).min(1.0) } else { 0.0 };
    (metamers.at(q) + 0.5).max(1.0) as u32
}

/// Equation 15, `s_b = G_ss(x_s)·s_bp·G_bs(x_max)`: the scale of a branch that springs at `on_shoot` of a
/// shoot that lies at `at_end` of the parent branch in its last year.
pub fn lateral_scale(
    shoot_scale: &Curve,
    branch_scale: &Curve,
    parent: f32,
    on_shoot: f32,
    at_end: f32,
) -> f32 {
    shoot_scale.at(on_shoot) * inherited_scale(branch_scale, parent, at_end)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f32, expected: f32) {
        assert!((found - expected).abs() < 1e-6, "{found} instead of {expected}");
    }

    fn line(from: f32, to: f32) -> Curve {
        Curve::new([[0.0, from], [1.0, to]]).unwrap()
    }

    #[test]
    fn equation_5() {
        assert!(grows_enough(1.0, 1.5, 0.5));
        assert!(grows_enough(1.0, 2.0, 0.5));
        assert!(!grows_enough(1.0, 1.25, 0.5));
    }

    #[test]
    fn equation_6() {
        // A trunk of 12 m at a third of its time: 12·(2/3·0.15 + 1/3·0.45) = 12·0.25.
        near(wanted_length(12.0, 1.0 / 3.0, 0.15, 0.45), 3.0);
        near(wanted_length(12.0, 0.0, 0.15, 0.45), 1.8);
        near(wanted_length(12.0, 1.0, 0.15, 0.45), 5.4);
    }

    #[test]
    fn equation_7() {
        near(enforced_length(3.0, 2.5, 0.02), 3.0);
        near(enforced_length(2.4, 2.5, 0.02), 2.52);
    }

    #[test]
    fn equation_8() {
        near(length_share(3.0, 12.0), 0.25);
        near(length_share(15.0, 12.0), 1.0);
    }

    #[test]
    fn equation_9() {
        // 0.75·0.4 + 0.25·(-0.8)
        near(heading(0.25, 0.4, -0.8), 0.1);
        near(heading(0.0, 0.4, -0.8), 0.4);
        near(heading(1.0, 0.4, -0.8), -0.8);
    }

    #[test]
    fn equation_10() {
        near(scale(&line(1.0, 0.5), 0.5), 0.75);
    }

    #[test]
    fn equation_11() {
        near(lost_at(&line(2.0, 30.0), 0.25), 9.0);
    }

    #[test]
    fn equation_12() {
        // Order 2 halves, order 3 divides by 2.5.
        near(higher_order_length(3.0, 1.0, 0.02, 2), 1.5);
        near(higher_order_length(3.0, 1.0, 0.02, 3), 1.2);
        near(higher_order_length(3.0, 1.6, 0.02, 2), 1.62);
        near(higher_order_length(3.0, 2.5, 0.02, 0), enforced_length(3.0, 2.5, 0.02));
    }

    #[test]
    fn equation_13() {
        near(inherited_scale(&line(1.0, 0.5), 0.6, 0.5), 0.45);
    }

    #[test]
    fn equation_14() {
        // q = 0.25: 2 + 0.25·20 = 7.
        assert_eq!(metamers(&line(2.0, 22.0), 0.3, 1.2), 7);
        assert_eq!(metamers(&line(2.0, 22.0), 9.0, 1.2), 22);
        assert_eq!(metamers(&line(0.0, 0.2), 0.3, 1.2), 1);
        // 2 + 0.275·20 = 7.5 rounds up.
        assert_eq!(metamers(&line(2.0, 22.0), 0.33, 1.2), 8);
    }

    #[test]
    fn equation_15() {
        // 0.8 · 0.6 · 0.75
        near(lateral_scale(&line(0.0, 1.0), &line(1.0, 0.5), 0.6, 0.8, 0.5), 0.36);
    }
}
