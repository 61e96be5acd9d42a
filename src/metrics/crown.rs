//! Size and place of the crown.

use super::angle::length;
use super::hull;
use crate::{ParameterError, Skeleton};
use glam::{DVec2, DVec3};

/// A branch that has less than this share of the length of all branches does not begin the crown.
const STRAY: f64 = 0.01;

/// Height of the crown base above the trunk base, metres: the height at which the lowest main limb leaves the
/// trunk. A main limb is a first-order branch that has, with all that it bears, at least a hundredth of the
/// length of all branches. Single sprouts on the bole are no crown.
///
/// `None` for a trunk alone. O(n).
pub fn crown_base(skeleton: &Skeleton) -> Option<f64> {
    let mut borne = vec![0.0f64; skeleton.len()];
    for (node, parent) in skeleton.edges().rev() {
        borne[parent] += borne[node] + length(skeleton, node, parent);
    }
    let branches = skeleton.branches();
    let firsts = branches.iter().filter(|branch| branch.order() == 1).map(|branch| {
        let (fork, first) = (branch.nodes()[0] as usize, branch.nodes()[1] as usize);
        (fork, borne[first] + length(skeleton, first, fork))
    });
    let firsts: Vec<(usize, f64)> = firsts.collect();
    let all: f64 = firsts.iter().map(|&(_, length)| length).sum();
    let base = skeleton.positions()[0].y;
    let heights = firsts
        .into_iter()
        .filter(|&(_, length)| length >= STRAY * all)
        .map(|(fork, _)| f64::from(skeleton.positions()[fork].y) - f64::from(base));
    heights.reduce(f64::min)
}

/// Reach of the crown from the trunk's base to each side.
#[derive(Debug, Clone, PartialEq)]
pub struct CrownRadii {
    /// The largest horizontal distance of a node from the base of the trunk in each sector, metres, at least 0: the first sector
    /// about +X, then towards +Z (from +X over +Z to -X to -Z), all of one width.
    pub radii: Vec<f64>,
}

impl CrownRadii {
    /// The radii in `directions` sectors, at least 3; surveys take 4 or 8. O(n).
    ///
    /// # Errors
    /// Fewer than 3 directions, or more than 3600.
    pub fn of(skeleton: &Skeleton, directions: usize) -> Result<Self, ParameterError> {
        let holds = (3..=3600).contains(&directions);
        ParameterError::unless(holds, "CrownRadii.directions", directions, "3 to 3600")?;
        Ok(radii(skeleton, directions))
    }

    /// The mean radius, metres.
    pub fn mean(&self) -> f64 {
        self.radii.iter().sum::<f64>() / self.radii.len() as f64
    }

    /// Coefficient of variation: standard deviation (of a sample, by n - 1) over mean, 0 for a crown that reaches equally far to all sides. City trees
    /// in four directions have 0.14 to 0.35.
    pub fn variation(&self) -> f64 {
        let mean = self.mean();
        let square = self.radii.iter().map(|radius| (radius - mean) * (radius - mean)).sum::<f64>();
        if mean > 0.0 { (square / (self.radii.len() - 1) as f64).sqrt() / mean } else { 0.0 }
    }

    /// Distance of the crown's middle from the trunk base, as a share of the mean radius. The middle is that
    /// of the circle that fits the radii; for four radii it is the middle between opposite ends. City trees
    /// have 0.13 to 0.35.
    pub fn offset(&self) -> f64 {
        let directions = self.radii.len() as f64;
        let ends = self.radii.iter().enumerate().map(|(i, &radius)| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * i as f64 / directions);
            DVec2::new(cos, sin) * radius
        });
        // A circle that is off by d has radii of r + d cos, whose ends are off by half of d on the mean.
        let middle = ends.sum::<DVec2>() * (2.0 / directions);
        if self.mean() > 0.0 { middle.length() / self.mean() } else { 0.0 }
    }
}

/// As [`CrownRadii::of`], for a number of directions that is in range.
pub(super) fn radii(skeleton: &Skeleton, directions: usize) -> CrownRadii {
    let base = skeleton.positions()[0].as_dvec3();
    let mut radii = vec![0.0f64; directions];
    for position in skeleton.positions() {
        let way = position.as_dvec3() - base;
        let turn = libm::atan2(way.z, way.x) / std::f64::consts::TAU;
        let sector = (turn * directions as f64 + 0.5).floor().rem_euclid(directions as f64) as usize;
        radii[sector] = radii[sector].max(DVec2::new(way.x, way.z).length());
    }
    CrownRadii { radii }
}

/// Area of ground below the crown, square metres: of the convex hull of all nodes seen from above. O(n log n).
pub fn projected_area(skeleton: &Skeleton) -> f64 {
    let points = skeleton.positions().iter().map(|p| DVec2::new(f64::from(p.x), f64::from(p.z)));
    hull::area(&hull::convex_hull(points.collect()))
}

/// Volume of the convex hull of all nodes at or above the [crown's base](crown_base), cubic metres; of all nodes if there is
/// none. O(n log n).
pub fn crown_volume(skeleton: &Skeleton) -> f64 {
    let base = f64::from(skeleton.positions()[0].y);
    let low = crown_base(skeleton).map_or(f64::NEG_INFINITY, |above| base + above);
    let points = skeleton.positions().iter().map(|p| p.as_dvec3()).filter(|p| p.y >= low);
    hull::hull_volume(&points.collect::<Vec<DVec3>>())
}

/// The mean way from a tip to the base over the longest: 1 for a tree whose tips are all equally far along the wood, as in a
/// broom or an umbrella, about a half for a conifer (Smith et al. 2014, doi 10.1111/nph.12487). In (0, 1]; `None` for a tree without a length. O(n).
pub fn path_fraction(skeleton: &Skeleton) -> Option<f64> {
    let mut ways = vec![0.0f64; skeleton.len()];
    for (node, parent) in skeleton.edges() {
        ways[node] = ways[parent] + length(skeleton, node, parent);
    }
    let (count, sum, most) = skeleton.tips().fold((0.0, 0.0, 0.0f64), |(count, sum, most), tip| {
        (count + 1.0, sum + ways[tip], most.max(ways[tip]))
    });
    (most > 0.0).then(|| sum / count / most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radius::sample::any_skeleton;
    use glam::Vec3;
    use proptest::prelude::*;

    /// A trunk of 4 m with four limbs at 2 m, of 1, 2, 1 and 2 m to +X, +Z, -X and -Z, and a sprout of 2 cm at 1 m.
    fn cross() -> Skeleton {
        let up = |y: f32| Vec3::Y * y;
        let positions = vec![
            up(0.0),
            up(1.0),
            up(2.0),
            up(4.0),
            up(1.0) + Vec3::X * 0.02,
            up(2.0) + Vec3::X,
            up(2.0) + Vec3::Z * 2.0,
            up(2.0) - Vec3::X,
            up(2.0) - Vec3::Z * 2.0,
        ];
        let parents = vec![None, Some(0), Some(1), Some(2), Some(1), Some(2), Some(2), Some(2), Some(2)];
        let tree = Skeleton::new(positions, parents).expect("a tree");
        tree.with_orders(vec![0, 0, 0, 0, 1, 1, 1, 1, 1]).expect("orders")
    }

    #[test]
    fn a_cross_by_hand() {
        let tree = cross();
        assert_eq!(crown_base(&tree), Some(2.0));
        let radii = CrownRadii::of(&tree, 4).expect("in range");
        assert_eq!(radii.radii, [1.0, 2.0, 1.0, 2.0]);
        assert!(
            (radii.mean() - 1.5).abs() < 1e-12
                && (radii.variation() - (1.0f64 / 3.0).sqrt() / 1.5).abs() < 1e-12
        );
        assert!(radii.offset() < 1e-12);
        assert!((projected_area(&tree) - 4.0).abs() < 1e-12);
        // A pyramid on the rhombus of the limbs.
        assert!((crown_volume(&tree) - 4.0 * 2.0 / 3.0).abs() < 1e-9);
        let tips = [4.0, 1.02, 3.0, 4.0, 3.0, 4.0];
        let fraction = tips.iter().sum::<f64>() / 6.0 / 4.0;
        assert!(path_fraction(&tree).is_some_and(|found| (found - fraction).abs() < 1e-7));
    }

    #[test]
    fn a_crown_to_one_side() {
        let positions = vec![Vec3::ZERO, Vec3::Y, Vec3::new(3.0, 1.0, 0.0)];
        let tree = Skeleton::new(positions, vec![None, Some(0), Some(1)]).expect("a tree");
        let radii = CrownRadii::of(&tree, 4).expect("in range");
        assert!((radii.offset() - 2.0).abs() < 1e-12);
        // A round crown of 2 m about a middle that is half a metre off.
        let middle = Vec3::new(0.3, 1.0, 0.4);
        let rim = (0..720u32).map(|i| {
            let (sin, cos) = libm::sincosf(i as f32 / 720.0 * std::f32::consts::TAU);
            middle + Vec3::new(cos, 0.0, sin) * 2.0
        });
        let positions: Vec<Vec3> = [Vec3::ZERO].into_iter().chain(rim).collect();
        let parents = (0..positions.len()).map(|i| (i > 0).then_some(0)).collect();
        let round =
            CrownRadii::of(&Skeleton::new(positions, parents).expect("a tree"), 72).expect("in range");
        assert!((round.offset() * round.mean() - 0.5).abs() < 0.02, "{}", round.offset() * round.mean());
        assert_eq!(crown_base(&tree), None);
        for directions in [0, 2, 3601] {
            let error = CrownRadii::of(&tree, directions).expect_err("out of range");
            assert_eq!(error.parameter, "CrownRadii.directions");
        }
        let point = Skeleton::new(vec![Vec3::ZERO], vec![None]).expect("a point");
        let radii = CrownRadii::of(&point, 8).expect("in range");
        assert!(radii.variation() < 1e-12 && radii.offset() < 1e-12);
        assert_eq!((path_fraction(&point), projected_area(&point)), (None, 0.0));
    }

    proptest! {
        #[test]
        fn measures_fit_together(skeleton in any_skeleton(), directions in 3usize..40) {
            let radii = CrownRadii::of(&skeleton, directions).unwrap();
            let farthest = radii.radii.iter().copied().fold(0.0, f64::max);
            let width = super::super::crown_width(&skeleton);
            prop_assert!(farthest <= width + 1e-6 && width <= 2.0 * farthest + 1e-6);
            prop_assert!(projected_area(&skeleton) <= std::f64::consts::PI * farthest * farthest + 1e-6);
            prop_assert!(path_fraction(&skeleton).is_none_or(|fraction| 0.0 < fraction && fraction <= 1.0 + 1e-12));
        }
    }
}
