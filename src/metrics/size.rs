//! Amount and extent of wood.

use std::f64::consts::PI;

use glam::DVec2;

use super::angle::length;
use super::hull::convex_hull;
use crate::Skeleton;

/// Length of all internodes together, metres. O(n).
pub fn total_length(skeleton: &Skeleton) -> f64 {
    skeleton.edges().map(|(node, parent)| length(skeleton, node, parent)).sum()
}

/// Volume of the wood, cubic metres: `π r² l` of a cylinder for each internode, overlaps at forks counted twice.
/// O(n).
pub fn wood_volume(skeleton: &Skeleton) -> f64 {
    let of = |(node, parent)| {
        let radius = f64::from(skeleton.radii()[node]);
        PI * radius * radius * length(skeleton, node, parent)
    };
    skeleton.edges().map(of).sum()
}

/// Area of the bark, square metres: `2 π r l` of a cylinder for each internode, without its ends. O(n).
pub fn surface_area(skeleton: &Skeleton) -> f64 {
    let of = |(node, parent)| 2.0 * PI * f64::from(skeleton.radii()[node]) * length(skeleton, node, parent);
    skeleton.edges().map(of).sum()
}

/// Mean radius of the tips, metres, and their standard deviation over it, 0 where the mean is 0.
pub(super) fn tip_radii(skeleton: &Skeleton) -> (f64, f64) {
    let radii: Vec<f64> = skeleton.tips().map(|tip| f64::from(skeleton.radii()[tip])).collect();
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    let square =
        radii.iter().map(|radius| (radius - mean) * (radius - mean)).sum::<f64>() / radii.len() as f64;
    (mean, if mean > 0.0 { square.sqrt() / mean } else { 0.0 })
}

/// Height of the highest node above the root, metres; at least 0. O(n).
pub fn height(skeleton: &Skeleton) -> f64 {
    let positions = skeleton.positions();
    let top = positions.iter().fold(positions[0].y, |top, position| top.max(position.y));
    f64::from(top) - f64::from(positions[0].y)
}

/// The largest horizontal distance between two nodes, metres: foresters' maximum crown spread, without the
/// branches' thickness. Does not depend on how the tree stands to the axes. O(n log n).
pub fn crown_width(skeleton: &Skeleton) -> f64 {
    let ground = |p: &glam::Vec3| DVec2::new(f64::from(p.x), f64::from(p.z));
    let hull = convex_hull(skeleton.positions().iter().map(ground).collect());
    if hull.len() < 3 {
        return hull[0].distance(hull[hull.len() - 1]);
    }
    // Rotating calipers (Shamos 1978): the node farthest from each edge in turn moves on only one way round.
    let next = |i: usize| if i + 1 == hull.len() { 0 } else { i + 1 };
    let mut far = 1;
    let mut widest = 0.0_f64;
    for i in 0..hull.len() {
        let edge = hull[next(i)] - hull[i];
        while edge.perp_dot(hull[next(far)] - hull[i]) > edge.perp_dot(hull[far] - hull[i]) {
            far = next(far);
        }
        widest = widest.max(hull[i].distance(hull[far])).max(hull[next(i)].distance(hull[far]));
    }
    widest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radius::sample::{any_skeleton, chain, y_fork};
    use glam::Vec3;
    use proptest::prelude::*;
    use std::error::Error;

    #[test]
    fn y_fork_by_hand() -> Result<(), Box<dyn Error>> {
        let arm = 0.89_f64.sqrt();
        let fork = y_fork()?.with_radii(vec![0.5, 0.5, 0.25, 0.25])?;
        assert!((total_length(&fork) - (1.0 + 2.0 * arm)).abs() < 1e-6);
        assert!((wood_volume(&fork) - PI * (0.25 + 2.0 * arm * 0.0625)).abs() < 1e-6);
        assert!((surface_area(&fork) - PI * (1.0 + arm)).abs() < 1e-6);
        assert!((height(&fork) - 1.8).abs() < 1e-6);
        assert!((crown_width(&fork) - 1.0).abs() < 1e-12);
        Ok(())
    }

    #[test]
    fn widths_by_hand() -> Result<(), Box<dyn Error>> {
        let of = |points: &[[f32; 2]]| {
            let positions = points.iter().map(|p| Vec3::new(p[0], 7.0, p[1])).collect();
            let parents = (0..points.len() as u32).map(|i| i.checked_sub(1)).collect();
            Skeleton::new(positions, parents).map(|tree| crown_width(&tree))
        };
        assert!(of(&[[3., 4.]])? < 1e-12);
        assert!(of(&[[3., 4.]; 5])? < 1e-12);
        assert!((of(&[[0., 0.], [3., 4.]])? - 5.0).abs() < 1e-12);
        assert!((of(&[[0., 0.], [3., 4.], [6., 8.], [1.5, 2.0]])? - 10.0).abs() < 1e-12);
        assert!((of(&[[0., 0.], [1., 0.], [1., 1.], [0., 1.], [0.5, 0.5]])? - 2.0_f64.sqrt()).abs() < 1e-12);
        assert!((of(&[[0., 0.], [0.0, -0.0], [-0.0, 0.0]])?) < 1e-12);
        assert!(of(&[[f32::MAX, f32::MAX], [f32::MIN, f32::MIN], [f32::MAX, f32::MIN]])?.is_finite());
        Ok(())
    }

    #[test]
    fn one_node_and_trees_below_their_root() -> Result<(), Box<dyn Error>> {
        let one = chain(1)?;
        for measure in [total_length, wood_volume, surface_area, height, crown_width] {
            assert!(measure(&one).abs() < 1e-12);
        }
        let root = Skeleton::new(vec![Vec3::Y, Vec3::ZERO], vec![None, Some(0)])?;
        assert!(height(&root).abs() < 1e-12);
        Ok(())
    }

    proptest! {
        #[test]
        fn width_is_the_widest_pair(skeleton in any_skeleton()) {
            let flat: Vec<DVec2> =
                skeleton.positions().iter().map(|p| DVec2::new(f64::from(p.x), f64::from(p.z))).collect();
            let want = flat.iter().flat_map(|a| flat.iter().map(|b| a.distance(*b))).fold(0.0, f64::max);
            prop_assert!((crown_width(&skeleton) - want).abs() < 1e-9);
        }
    }
}
