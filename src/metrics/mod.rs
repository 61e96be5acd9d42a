//! The measures that botanists take on a tree.
//!
//! [`Metrics::of`] takes all measures at once; each is a function of its own as well. All are exact in the
//! sense that they only sum and compare, in `f64`, so that no skeleton, however large or far out, makes one
//! infinite. A measure that a skeleton does not have, such as the branch angle of a single stem, is `None`.

mod angle;
mod branch;
mod crown;
mod exponent;
mod hull;
mod size;
mod stem;
mod strahler;

pub use angle::{BranchAngle, branch_angles};
pub use branch::{BranchMeasure, branch_counts, depth, measure_branches, tortuosities};
pub use crown::{CrownRadii, crown_base, crown_volume, path_fraction, projected_area};
pub use exponent::{fork_exponents, pipe_exponent};
pub use size::{crown_width, height, surface_area, total_length, wood_volume};
pub use stem::{BREAST_HEIGHT, diameter_at, form_factor, stem_volume};
pub use strahler::{
    bifurcation_ratios, horton_ratios, mean_bifurcation_ratio, strahler_orders, stream_counts,
    stream_diameters, stream_lengths,
};

use crate::Skeleton;

/// All measures of one skeleton.
///
/// ```
/// use treesynth::radius::{PipeModel, RadiusModel};
/// use treesynth::{Metrics, Skeleton, glam::Vec3};
///
/// let fork = Skeleton::new(
///     vec![Vec3::ZERO, Vec3::Y, Vec3::new(-0.5, 1.5, 0.0), Vec3::new(0.5, 1.5, 0.0)],
///     vec![None, Some(0), Some(1), Some(1)],
/// )?;
/// let radii = PipeModel::default().radii(&fork)?;
/// let metrics = Metrics::of(&fork.with_radii(radii)?);
/// assert_eq!((metrics.tips, metrics.depth, metrics.height), (2, 3, 1.5));
/// assert_eq!(metrics.branches_by_order, [1, 1]);
/// assert_eq!(metrics.bifurcation_ratios, [2.0]);
/// assert!(metrics.pipe_exponent.is_some_and(|exponent| (exponent - 2.5).abs() < 1e-5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Metrics {
    /// Number of nodes, at least 1.
    pub nodes: usize,
    /// Number of nodes without children, at least 1: the endpoints.
    pub tips: usize,
    /// Nodes on the longest way from the root to a tip; see [`depth`].
    pub depth: usize,
    /// Number of branches, the trunk included.
    pub branches: usize,
    /// Number of branches of each order, the trunk first; see [`branch_counts`].
    pub branches_by_order: Vec<usize>,
    /// Highest node above the root, metres; see [`height`].
    pub height: f64,
    /// Largest horizontal distance of two nodes, metres; see [`crown_width`].
    pub crown_width: f64,
    /// Height of the crown's base above the base of the trunk, metres; see [`crown_base`].
    pub crown_base: Option<f64>,
    /// Coefficient of variation of the crown's radii in four directions; see [`CrownRadii`].
    pub crown_variation: f64,
    /// Offset of the crown's middle from the trunk's base, as a share of its mean radius; see [`CrownRadii::offset`], of eight directions.
    pub crown_offset: f64,
    /// Ground below the crown, square metres; see [`projected_area`].
    pub projected_area: f64,
    /// Volume of the crown's convex hull, cubic metres; see [`crown_volume`].
    pub crown_volume: f64,
    /// Diameter of the trunk at 1.3 m above its base, metres; see [`diameter_at`].
    pub breast_height_diameter: Option<f64>,
    /// Volume of the trunk alone, cubic metres; see [`stem_volume`].
    pub stem_volume: f64,
    /// The trunk's volume over that of a cylinder; see [`form_factor`].
    pub form_factor: Option<f64>,
    /// Diameters of the trunk at a quarter, a half and three quarters of the tree's height, as shares of that at 1.3 m; `None`
    /// where the trunk does not reach or has no thickness.
    pub stem_taper: [Option<f64>; 3],
    /// Mean radius of the tips, metres.
    pub mean_tip_radius: f64,
    /// Standard deviation of the tips' radii over their mean; 0 where that is 0.
    pub tip_radius_variation: f64,
    /// Mean way from tips to the base over the longest; see [`path_fraction`].
    pub path_fraction: Option<f64>,
    /// Length of all internodes, metres; see [`total_length`].
    pub total_length: f64,
    /// Volume of the internodes as cylinders, cubic metres; see [`wood_volume`].
    pub wood_volume: f64,
    /// Area of the internodes as cylinders, square metres; see [`surface_area`].
    pub surface_area: f64,
    /// Horton-Strahler order of the tree: the root's; see [`strahler_orders`].
    pub strahler_order: u16,
    /// Number of streams of each Strahler order from 1 up; see [`stream_counts`].
    pub streams: Vec<usize>,
    /// Streams of each order for one of the next; see [`bifurcation_ratios`].
    pub bifurcation_ratios: Vec<f64>,
    /// Horton's ratio of the whole tree, by regression; see [`mean_bifurcation_ratio`].
    pub mean_bifurcation_ratio: Option<f64>,
    /// Mean length of the streams of each order over that of the order below; see [`stream_lengths`].
    pub length_ratios: Vec<f64>,
    /// Mean diameter of the streams of each order over that of the order below; see [`stream_diameters`].
    pub diameter_ratios: Vec<f64>,
    /// Mean angle between branches and parent axes at the first internode, radians; see [`branch_angles`].
    pub mean_branch_angle: Option<f64>,
    /// The same over an arc length of five internodes of mean length, which is beyond their crookedness: radians.
    pub mean_branch_angle_smoothed: Option<f64>,
    /// Mean over the branches of way over chord, each branch counting once; see [`tortuosities`].
    pub mean_tortuosity: Option<f64>,
    /// Exponent of the pipe model that the radii follow, the median over the forks; see [`pipe_exponent`].
    pub pipe_exponent: Option<f64>,
}

impl Metrics {
    /// Measures `skeleton`. O(n log n), and O(n) memory on the way.
    pub fn of(skeleton: &Skeleton) -> Self {
        let orders = strahler_orders(skeleton);
        let streams = strahler::streams_of(skeleton, &orders);
        let branches_by_order = branch_counts(skeleton);
        let total_length = total_length(skeleton);
        let internode = total_length / skeleton.segments().max(1) as f64;
        let tortuosities: Vec<f64> = tortuosities(skeleton).into_iter().flatten().collect();
        let mean_tortuosity =
            (!tortuosities.is_empty()).then(|| tortuosities.iter().sum::<f64>() / tortuosities.len() as f64);
        let diameter = diameter_at(skeleton, BREAST_HEIGHT);
        let at = |share: f64| diameter_at(skeleton, share * height(skeleton));
        let stem_taper = [0.25, 0.5, 0.75].map(|share| {
            diameter.filter(|&diameter| diameter > 0.0).and_then(|diameter| Some(at(share)? / diameter))
        });
        let (mean_tip_radius, tip_radius_variation) = size::tip_radii(skeleton);
        Self {
            nodes: skeleton.len(),
            tips: skeleton.tips().count(),
            depth: depth(skeleton),
            branches: branches_by_order.iter().sum(),
            branches_by_order,
            height: height(skeleton),
            crown_width: crown_width(skeleton),
            crown_base: crown_base(skeleton),
            crown_variation: crown::radii(skeleton, 4).variation(),
            crown_offset: crown::radii(skeleton, 8).offset(),
            projected_area: projected_area(skeleton),
            crown_volume: crown_volume(skeleton),
            breast_height_diameter: diameter,
            stem_volume: stem_volume(skeleton),
            form_factor: form_factor(skeleton),
            stem_taper,
            mean_tip_radius,
            tip_radius_variation,
            path_fraction: path_fraction(skeleton),
            total_length,
            wood_volume: wood_volume(skeleton),
            surface_area: surface_area(skeleton),
            strahler_order: orders[0],
            bifurcation_ratios: bifurcation_ratios(&streams),
            mean_bifurcation_ratio: mean_bifurcation_ratio(&streams),
            streams,
            length_ratios: horton_ratios(&stream_lengths(skeleton)),
            diameter_ratios: horton_ratios(&stream_diameters(skeleton)),
            mean_branch_angle: angle::mean(&angle::angles(skeleton, 0.0)),
            mean_branch_angle_smoothed: angle::mean(&angle::angles(skeleton, 5.0 * internode)),
            mean_tortuosity,
            pipe_exponent: pipe_exponent(skeleton),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radius::sample::{any_skeleton, binary, chain};
    use crate::radius::{PipeModel, RadiusModel, Taper};
    use glam::Vec3;
    use proptest::prelude::*;
    use std::error::Error;

    /// Every number there is, whether from a field or a list.
    fn numbers(metrics: &Metrics) -> Vec<f64> {
        let mut numbers = vec![
            metrics.height,
            metrics.crown_width,
            metrics.total_length,
            metrics.wood_volume,
            metrics.surface_area,
            metrics.crown_variation,
            metrics.crown_offset,
            metrics.projected_area,
            metrics.crown_volume,
            metrics.stem_volume,
            metrics.mean_tip_radius,
            metrics.tip_radius_variation,
        ];
        numbers.extend(metrics.crown_base.map(f64::abs));
        numbers.extend(metrics.breast_height_diameter);
        numbers.extend(metrics.form_factor);
        numbers.extend(metrics.path_fraction);
        numbers.extend(metrics.stem_taper.into_iter().flatten());
        numbers.extend(&metrics.length_ratios);
        numbers.extend(&metrics.diameter_ratios);
        numbers.extend(&metrics.bifurcation_ratios);
        numbers.extend(metrics.mean_bifurcation_ratio);
        numbers.extend(metrics.mean_branch_angle);
        numbers.extend(metrics.mean_branch_angle_smoothed);
        numbers.extend(metrics.mean_tortuosity);
        numbers.extend(metrics.pipe_exponent);
        numbers
    }

    #[test]
    fn one_node() -> Result<(), Box<dyn Error>> {
        let metrics = Metrics::of(&chain(1)?);
        assert_eq!((metrics.nodes, metrics.tips, metrics.depth, metrics.branches), (1, 1, 1, 1));
        assert_eq!((metrics.strahler_order, metrics.streams.as_slice()), (1, [1].as_slice()));
        assert!(numbers(&metrics).iter().all(|number| number.abs() < 1e-12));
        assert_eq!(metrics.mean_tortuosity.or(metrics.mean_branch_angle).or(metrics.pipe_exponent), None);
        Ok(())
    }

    #[test]
    fn a_million_nodes() -> Result<(), Box<dyn Error>> {
        let model = Taper::new(PipeModel::default());
        for tree in [chain(1_000_000)?, binary(20)?] {
            let radii = model.radii(&tree)?;
            let metrics = Metrics::of(&tree.with_radii(radii)?);
            assert!(numbers(&metrics).iter().all(|number| number.is_finite()));
        }
        // A comb: a twig at every node of the trunk.
        let nodes = 1_000_000u32;
        let comb = Skeleton::new(
            (0..nodes).map(|i| Vec3::new((i % 2) as f32, (i / 2) as f32, 0.0)).collect(),
            (0..nodes).map(|i| (i > 0).then(|| if i % 2 == 1 { i - 1 } else { i - 2 })).collect(),
        )?;
        let metrics = Metrics::of(&comb);
        assert_eq!((metrics.branches, metrics.strahler_order), (500_000, 2));
        assert!(metrics.mean_branch_angle.is_some_and(|a| (a - std::f64::consts::FRAC_PI_2).abs() < 1e-4));
        Ok(())
    }

    #[test]
    fn the_largest_numbers() -> Result<(), Box<dyn Error>> {
        let corner = |x: f32, y: f32| Vec3::new(x, y, f32::MAX);
        let positions = vec![
            corner(f32::MIN, f32::MIN),
            corner(f32::MAX, f32::MAX),
            corner(f32::MIN, f32::MAX),
            Vec3::splat(f32::from_bits(1)),
            Vec3::ZERO,
        ];
        let tree = Skeleton::new(positions, vec![None, Some(0), Some(1), Some(1), Some(3)])?;
        for radius in [0.0, f32::from_bits(1), f32::MAX] {
            let metrics = Metrics::of(&tree.clone().with_radii(vec![radius; 5])?);
            assert!(numbers(&metrics).iter().all(|number| number.is_finite()));
        }
        Ok(())
    }

    #[cfg(feature = "json")]
    #[test]
    fn serializes() -> Result<(), Box<dyn Error>> {
        let json = serde_json::to_value(Metrics::of(&chain(2)?))?;
        assert_eq!(json["nodes"], 2);
        assert!(json["pipe_exponent"].is_null());
        Ok(())
    }

    proptest! {
        #[test]
        fn every_number_is_finite(skeleton in any_skeleton(), radii in prop::collection::vec(0u8..4, 120)) {
            let radii = radii[..skeleton.len()].iter().map(|&radius| f32::from(radius)).collect();
            let skeleton = skeleton.with_radii(radii).unwrap();
            let metrics = Metrics::of(&skeleton);
            prop_assert!(numbers(&metrics).iter().all(|number| number.is_finite() && *number >= 0.0));
            prop_assert_eq!(metrics.branches, metrics.tips);
            prop_assert_eq!(&Metrics::of(&skeleton), &metrics);
        }
    }
}
