//! Eight species that differ by curves and limits alone. Heights and habits are as floras give them; the
//! curves are drawn by eye.

use super::{Architecture, Curve, Phenology};
use crate::math;
use std::f32::consts::FRAC_PI_2;

/// Turn of leaves to the light.
pub(super) const LIGHT_TURN: f32 = 1.5;

/// The golden angle, as the paper rounds it.
const DIVERGENCE: f32 = 2.399_827_7;

impl Default for Architecture {
    /// As [`cottonwood`](Self::cottonwood).
    fn default() -> Self {
        Self::cottonwood()
    }
}

impl Default for Phenology {
    /// A broad-leaved tree of the temperate zone: shoots unfold from mid-April to the end of July, leaves turn yellow in
    /// October and fall until the middle of November.
    fn default() -> Self {
        Self {
            season: [0.29, 0.58],
            leaf_years: 1,
            leaf_colors: colors([
                (0.3, [150, 168, 70]),
                (0.42, [104, 140, 56]),
                (0.55, [78, 118, 46]),
                (0.72, [84, 118, 46]),
                (0.78, [180, 166, 56]),
                (0.83, [222, 180, 52]),
                (0.88, [176, 128, 58]),
            ]),
            stagger: 0.55,
            bud_size: 0.012,
            leaf_angle: 65.0f32.to_radians(),
            light_turn: LIGHT_TURN,
            internode_growth: Curve::of([[0.0, 0.0], [0.25, 0.12], [0.6, 0.85], [1.0, 1.0]]),
            leaf_growth: Curve::of([[0.0, 0.0], [0.2, 0.15], [0.7, 0.9], [1.0, 1.0]]),
            bud_growth: Curve::of([[0.0, 0.0], [0.3, 0.1], [0.7, 1.0]]),
            leaf_size: Curve::of([[0.0, 0.06], [0.5, 0.11], [1.0, 0.09]]),
            leaf_share: Curve::of([[0.0, 1.0], [0.77, 1.0], [0.82, 0.85], [0.89, 0.0]]),
        }
    }
}

impl Architecture {
    /// *Populus deltoides*, the Eastern cottonwood, over 27 years: the paper's tree.
    ///
    /// For some years a broom stick with short branches, it gets a rounded crown of long, well developed limbs, which
    /// leave the trunk at 35° if they are vigorous and at up to 80° if not, sink at first and turn up again to their
    /// tips. Small branches inside of the crown are lost.
    pub fn cottonwood() -> Self {
        Self {
            years: 27,
            least_shoot: 0.012,
            longest_branch: 10.0,
            least_scale: 0.25,
            most_order: 4,
            divergence: DIVERGENCE,
            whorl: 1,
            forking: 0.0,
            stoutness: 0.0095,
            twig_radius: 0.0022,
            variation: 0.13,
            scale_variation: 0.25,
            tropism: 0.3,
            height: Curve::of([[0.0, 0.0], [0.11, 4.2], [0.3, 11.0], [0.6, 18.5], [1.0, 24.0]]),
            young_silhouette: Curve::of([[0.0, 0.33], [0.4, 0.33], [0.8, 0.22], [1.0, 0.06]]),
            mature_silhouette: Curve::of([
                [0.0, 0.8],
                [0.3, 0.82],
                [0.6, 0.66],
                [0.8, 0.45],
                [0.93, 0.22],
                [1.0, 0.06],
            ]),
            short_heading: Curve::degrees([[0.0, 0.0], [0.4, 8.0], [1.0, 25.0]]),
            long_heading: Curve::degrees([[0.0, -6.0], [0.3, -28.0], [0.6, -24.0], [1.0, 18.0]]),
            branch_scale: even_branches(),
            lifespan: Curve::of([
                [0.0, 1.0],
                [0.25, 4.0],
                [0.45, 8.0],
                [0.6, 12.0],
                [0.74, 17.0],
                [0.84, 40.0],
                [1.0, 60.0],
            ]),
            metamers: Curve::of([[0.0, 2.0], [0.1, 3.0], [0.3, 5.0], [1.0, 10.0]]),
            shoot_scale: spread_shoots(),
            branching_angle: Curve::degrees([[0.0, 80.0], [0.1, 66.0], [0.3, 46.0], [0.6, 35.0]]),
            phenology: Phenology {
                leaf_size: Curve::of([[0.0, 0.07], [0.5, 0.13], [1.0, 0.105]]),
                ..Phenology::default()
            },
        }
    }

    /// A spruce over 40 years: one straight trunk to the top and a slender cone; short level branches that hang a little,
    /// with flat sprays, needles of five years, and laterals all from the upper end of each shoot.
    pub fn spruce() -> Self {
        Self {
            years: 40,
            least_shoot: 0.03,
            longest_branch: 4.0,
            least_scale: 0.42,
            most_order: 3,
            stoutness: 0.007,
            twig_radius: 0.002,
            variation: 0.05,
            scale_variation: 0.25,
            tropism: 0.12,
            height: Curve::of([[0.0, 0.0], [0.1, 1.2], [0.35, 6.5], [0.7, 13.0], [1.0, 17.0]]),
            young_silhouette: Curve::of([[0.0, 0.62], [0.6, 0.36], [1.0, 0.05]]),
            mature_silhouette: Curve::of([[0.0, 0.42], [0.4, 0.32], [0.8, 0.13], [1.0, 0.03]]),
            short_heading: Curve::degrees([[0.0, 0.0], [1.0, 12.0]]),
            long_heading: Curve::degrees([[0.0, -4.0], [0.4, -22.0], [0.75, -14.0], [1.0, 22.0]]),
            branch_scale: Curve::constant_of(1.0),
            lifespan: Curve::of([[0.0, 1.5], [0.4, 4.0], [0.55, 8.0], [0.64, 15.0], [0.7, 60.0]]),
            metamers: Curve::of([[0.0, 1.0], [0.1, 3.0], [0.3, 6.0], [1.0, 12.0]]),
            shoot_scale: Curve::of([[0.0, 0.0], [0.5, 0.0], [0.7, 0.6], [0.85, 0.92], [1.0, 1.0]]),
            branching_angle: Curve::degrees([[0.0, 80.0], [1.0, 75.0]]),
            phenology: Phenology {
                season: [0.35, 0.55],
                leaf_years: 5,
                leaf_colors: colors([(0.0, [46, 72, 44]), (0.4, [58, 92, 48]), (0.7, [46, 74, 44])]),
                leaf_angle: 12.0f32.to_radians(),
                leaf_size: Curve::of([[0.0, 0.13], [1.0, 0.16]]),
                leaf_share: Curve::of([[0.0, 1.0], [1.0, 0.0]]),
                ..Phenology::default()
            },
            ..Self::cottonwood()
        }
    }

    /// A Lombardy poplar over 30 years: a column of branches that all stand up steeply along the trunk, from the ground on.
    pub fn lombardy_poplar() -> Self {
        Self {
            least_scale: 0.28,
            most_order: 3,
            lifespan: long_lived(),
            metamers: Curve::of([[0.0, 2.0], [0.1, 5.0], [0.3, 7.0], [1.0, 12.0]]),
            years: 30,
            longest_branch: 8.0,
            tropism: 0.5,
            variation: 0.08,
            height: Curve::of([[0.0, 0.0], [0.1, 4.0], [0.5, 18.0], [1.0, 27.0]]),
            young_silhouette: Curve::of([[0.0, 0.42], [0.5, 0.4], [0.85, 0.22], [1.0, 0.05]]),
            mature_silhouette: Curve::of([[0.0, 0.75], [0.5, 0.62], [0.8, 0.36], [1.0, 0.06]]),
            short_heading: Curve::degrees([[0.0, 0.0], [0.3, 10.0], [1.0, 22.0]]),
            long_heading: Curve::degrees([[0.0, 0.0], [0.2, 16.0], [1.0, 24.0]]),
            branching_angle: Curve::degrees([[0.0, 64.0], [0.15, 50.0], [0.5, 36.0]]),
            phenology: Phenology::default(),
            ..Self::cottonwood()
        }
    }

    /// A weeping birch over 30 years: limbs rise, their ends and all twigs hang, long and thin.
    pub fn weeping_birch() -> Self {
        Self {
            metamers: Curve::of([[0.0, 1.0], [0.1, 4.0], [0.3, 5.0], [0.6, 5.0], [1.0, 9.0]]),
            lifespan: Curve::of([
                [0.0, 1.2],
                [0.2, 3.0],
                [0.4, 6.0],
                [0.55, 11.0],
                [0.66, 20.0],
                [0.75, 40.0],
                [1.0, 60.0],
            ]),
            most_order: 4,
            least_scale: 0.27,
            years: 30,
            longest_branch: 5.0,
            stoutness: 0.0045,
            twig_radius: 0.0012,
            tropism: -2.2,
            variation: 0.1,
            height: Curve::of([[0.0, 0.0], [0.1, 2.4], [0.5, 11.0], [1.0, 16.0]]),
            young_silhouette: Curve::of([[0.0, 0.5], [0.6, 0.4], [1.0, 0.06]]),
            mature_silhouette: Curve::of([[0.0, 1.1], [0.4, 1.1], [0.8, 0.75], [1.0, 0.12]]),
            short_heading: Curve::degrees([[0.0, 0.0], [1.0, -10.0]]),
            long_heading: Curve::degrees([[0.0, 8.0], [0.35, 30.0], [0.7, 30.0], [1.0, -20.0]]),
            branching_angle: Curve::degrees([[0.0, 70.0], [0.3, 48.0], [0.6, 38.0]]),
            phenology: Phenology {
                leaf_size: Curve::of([[0.0, 0.05], [1.0, 0.065]]),
                bud_size: 0.007,
                ..Phenology::default()
            },
            ..Self::cottonwood()
        }
    }

    /// A Norway maple in the open over 40 years: opposite branches, a trunk that forks low into limbs of like strength, a round
    /// crown on dense twigs.
    pub fn norway_maple() -> Self {
        Self {
            whorl: 2,
            divergence: FRAC_PI_2,
            forking: 0.03,
            years: 40,
            longest_branch: 8.0,
            least_scale: 0.57,
            most_order: 3,
            stoutness: 0.011,
            scale_variation: 0.15,
            twig_radius: 0.0014,
            variation: 0.14,
            tropism: 0.5,
            height: Curve::of([[0.0, 0.0], [0.1, 2.6], [0.4, 8.4], [1.0, 13.0]]),
            young_silhouette: Curve::of([[0.0, 0.6], [0.5, 0.5], [1.0, 0.06]]),
            mature_silhouette: Curve::of([[0.0, 0.95], [0.35, 0.95], [0.7, 0.75], [0.9, 0.4], [1.0, 0.08]]),
            short_heading: Curve::degrees([[0.0, 0.0], [1.0, 22.0]]),
            long_heading: Curve::degrees([[0.0, 0.0], [0.3, -8.0], [1.0, 26.0]]),
            branch_scale: Curve::of([[0.0, 0.75], [0.08, 0.93], [1.0, 0.89]]),
            lifespan: long_lived(),
            shoot_scale: spread_shoots(),
            metamers: Curve::of([[0.0, 1.0], [0.1, 2.0], [0.3, 3.0], [1.0, 6.0]]),
            branching_angle: Curve::degrees([[0.0, 62.0], [0.3, 52.0], [0.7, 42.0]]),
            phenology: Phenology {
                leaf_size: Curve::of([[0.0, 0.1], [1.0, 0.13]]),
                leaf_angle: 60.0f32.to_radians(),
                ..Phenology::default()
            },
            ..Self::cottonwood()
        }
    }

    /// A European ash over 40 years: opposite, open, stout shoots that turn up, long feathered leaves.
    pub fn european_ash() -> Self {
        Self {
            whorl: 2,
            divergence: FRAC_PI_2,
            forking: 0.02,
            years: 40,
            longest_branch: 9.0,
            least_scale: 0.62,
            most_order: 3,
            stoutness: 0.01,
            scale_variation: 0.15,
            twig_radius: 0.0022,
            variation: 0.12,
            tropism: 0.7,
            height: Curve::of([[0.0, 0.0], [0.1, 3.0], [0.4, 10.5], [1.0, 17.0]]),
            young_silhouette: Curve::of([[0.0, 0.4], [0.6, 0.36], [1.0, 0.08]]),
            mature_silhouette: Curve::of([[0.0, 0.75], [0.4, 0.8], [0.75, 0.6], [1.0, 0.1]]),
            short_heading: Curve::degrees([[0.0, 0.0], [1.0, 30.0]]),
            long_heading: Curve::degrees([[0.0, 0.0], [0.35, -18.0], [0.7, -8.0], [1.0, 34.0]]),
            branch_scale: Curve::of([[0.0, 0.75], [0.06, 0.95], [1.0, 0.92]]),
            lifespan: long_lived(),
            shoot_scale: spread_shoots(),
            metamers: Curve::of([[0.0, 1.0], [0.1, 2.0], [0.3, 3.0], [1.0, 5.0]]),
            branching_angle: Curve::degrees([[0.0, 58.0], [0.3, 48.0], [0.7, 38.0]]),
            phenology: Phenology {
                season: [0.34, 0.56],
                leaf_size: Curve::of([[0.0, 0.22], [1.0, 0.3]]),
                leaf_angle: 52.0f32.to_radians(),
                ..Phenology::default()
            },
            ..Self::cottonwood()
        }
    }

    /// A horse chestnut over 40 years: opposite stout shoots, limbs that rise, dip and turn up at their ends; shoots that flower
    /// fork.
    pub fn horse_chestnut() -> Self {
        Self {
            whorl: 2,
            divergence: FRAC_PI_2,
            forking: 0.045,
            years: 40,
            longest_branch: 8.0,
            least_scale: 0.66,
            most_order: 3,
            stoutness: 0.0125,
            scale_variation: 0.15,
            twig_radius: 0.0024,
            variation: 0.1,
            tropism: 0.35,
            height: Curve::of([[0.0, 0.0], [0.1, 2.4], [0.4, 8.0], [1.0, 12.5]]),
            young_silhouette: Curve::of([[0.0, 0.55], [0.5, 0.5], [1.0, 0.08]]),
            mature_silhouette: Curve::of([[0.0, 0.95], [0.4, 0.95], [0.75, 0.75], [1.0, 0.12]]),
            short_heading: Curve::degrees([[0.0, 0.0], [1.0, 28.0]]),
            long_heading: Curve::degrees([[0.0, 6.0], [0.4, -26.0], [0.75, -20.0], [1.0, 40.0]]),
            branch_scale: Curve::of([[0.0, 0.8], [0.06, 0.95], [1.0, 0.86]]),
            lifespan: long_lived(),
            shoot_scale: spread_shoots(),
            metamers: Curve::of([[0.0, 1.0], [0.1, 2.0], [0.3, 3.0], [1.0, 6.0]]),
            branching_angle: Curve::degrees([[0.0, 62.0], [0.3, 54.0], [0.7, 46.0]]),
            phenology: Phenology {
                season: [0.27, 0.5],
                leaf_size: Curve::of([[0.0, 0.14], [1.0, 0.2]]),
                leaf_angle: 70.0f32.to_radians(),
                bud_size: 0.022,
                ..Phenology::default()
            },
            ..Self::cottonwood()
        }
    }

    /// An oak in the open over 40 years: a short trunk and a crown wider than high, on level, crooked limbs.
    pub fn spreading_oak() -> Self {
        Self {
            branch_scale: Curve::of([[0.0, 0.85], [0.2, 1.0], [1.0, 0.95]]),
            metamers: Curve::of([[0.0, 1.0], [0.1, 2.0], [0.3, 3.0], [1.0, 6.0]]),
            lifespan: long_lived(),
            least_scale: 0.36,
            most_order: 4,
            years: 40,
            least_shoot: 0.015,
            longest_branch: 10.0,
            stoutness: 0.012,
            twig_radius: 0.0015,
            tropism: 0.35,
            variation: 0.24,
            height: Curve::of([[0.0, 0.0], [0.1, 2.2], [0.4, 7.0], [1.0, 11.0]]),
            young_silhouette: Curve::of([[0.0, 1.0], [0.5, 0.8], [1.0, 0.1]]),
            mature_silhouette: Curve::of([[0.0, 1.15], [0.4, 1.2], [0.75, 0.95], [0.92, 0.6], [1.0, 0.1]]),
            short_heading: Curve::degrees([[0.0, 0.0], [1.0, 20.0]]),
            long_heading: Curve::degrees([[0.0, 0.0], [0.3, -14.0], [0.7, -6.0], [1.0, 26.0]]),
            branching_angle: Curve::degrees([[0.0, 80.0], [0.2, 68.0], [0.6, 58.0]]),
            ..Self::cottonwood()
        }
    }
}

/// The scale of branches along their parent branch, where those at its base are nearly as strong as the others, so that limbs are
/// clothed from their bases on.
fn even_branches() -> Curve {
    Curve::of([[0.0, 0.75], [0.2, 0.95], [1.0, 0.9]])
}

/// The lifespan of branches of trees whose twigs stay: all but the weakest live as long as the tree.
fn long_lived() -> Curve {
    Curve::of([[0.0, 1.0], [0.25, 4.0], [0.45, 9.0], [0.6, 16.0], [0.75, 30.0], [0.85, 60.0], [1.0, 80.0]])
}

/// The scale of laterals where the lower half of a shoot bears some too, so that limbs are clothed along their length.
fn spread_shoots() -> Curve {
    Curve::of([[0.0, 0.0], [0.3, 0.2], [0.6, 0.6], [0.85, 0.9], [1.0, 1.0]])
}

/// Channels over the year from colours as pickers show them.
fn colors<const N: usize>(tones: [(f32, [u8; 3]); N]) -> [Curve; 3] {
    [0, 1, 2].map(|channel: usize| {
        Curve::of(tones.map(|(time, tone)| [time, math::linear(f32::from(tone[channel]) / 255.0)]))
    })
}
