//! Tip diameters from the area each tip supports: section 5, "Generation of shape sample nodes".

use std::f64::consts::TAU;
use std::num::NonZero;

use glam::Vec3;
use kiddo::SquaredEuclidean;
use kiddo::immutable::float::kdtree::ImmutableKdTree;

use super::pipe::{bundle, check_diameter, check_exponent, flows};
use super::{RadiusError, RadiusModel};
use crate::{ParameterError, Skeleton};

/// The [pipe model](super::PipeModel) on tips whose diameters follow from the area A of crown that each
/// supports: `d = 2 sqrt(A / 2π)` (section 5; a sphere over the sampled region), then equation 2 downwards.
///
/// In the paper every tip is a sample of the guidance shape and all have the average area, which is
/// [`uniform`](Self::uniform). For trees grown otherwise, [`guided`](Self::guided) divides the crown's area
/// among its tips, so that a lone tip in a wide part of the crown is thicker than one in a thicket.
///
/// Areas of crown give thick tips, 40 cm for a quarter of a square metre: the paper uses these diameters as
/// proportions. Set a [trunk diameter](Self::with_trunk_diameter) for wood of a natural scale, or pass areas of
/// leaf.
///
/// ```
/// use treesynth::radius::{RadiusModel, Variational};
/// use treesynth::{Skeleton, glam::Vec3};
///
/// let fork = Skeleton::new(
///     vec![Vec3::ZERO, Vec3::Y, Vec3::new(-0.5, 1.8, 0.0), Vec3::new(0.5, 1.8, 0.0)],
///     vec![None, Some(0), Some(1), Some(1)],
/// )?;
/// // Three quarters of the crown are on the left.
/// let crown = vec![Vec3::new(-1.0, 2.0, 0.0), Vec3::new(-2.0, 2.0, 0.0), Vec3::new(-1.0, 3.0, 0.0), Vec3::X];
/// let radii = Variational::guided(crown, 8.0).with_trunk_diameter(0.2).radii(&fork)?;
/// assert!((radii[2] / radii[3] - 3.0_f32.sqrt()).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Variational {
    exponent: f32,
    support: Support,
    minimum_share: f32,
    trunk_diameter: Option<f32>,
}

crate::recipe::readable!(Variational { minimum_share: f32 });

/// Area that each tip supports.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum Support {
    /// The same for every tip.
    Uniform {
        /// Area of one tip, square metres.
        area: f32,
    },
    /// Each sample of the crown goes to the tip nearest to it, and with it an equal part of the area.
    Samples {
        /// Points spread evenly in or on the crown, metres.
        positions: Vec<Vec3>,
        /// Area of the whole crown, square metres.
        total_area: f32,
    },
}

impl Default for Variational {
    /// Equal areas and a trunk base of 30 cm, our choice for a grown tree; the area then cancels out.
    fn default() -> Self {
        Self::uniform(1.0).with_trunk_diameter(0.3)
    }
}

impl Variational {
    /// Every tip supports `area` square metres, finite and above 0.
    pub fn uniform(area: f32) -> Self {
        Self::new(Support::Uniform { area })
    }

    /// The tips share `total_area` square metres, finite and above 0, by how many of the `samples` (metres, at
    /// least one, evenly spread in or on the crown) each is nearest to.
    pub fn guided(samples: impl Into<Vec<Vec3>>, total_area: f32) -> Self {
        Self::new(Support::Samples { positions: samples.into(), total_area })
    }

    fn new(support: Support) -> Self {
        Self { exponent: 2.5, support, minimum_share: 0.1, trunk_diameter: None }
    }

    /// Sets the exponent a of equation 2, above 1 and at most 10; 2.5, the middle of the paper's range, by
    /// default. Above the β of [`structure_energy`](super::structure_energy), merging branches saves cost.
    pub fn with_exponent(mut self, exponent: f32) -> Self {
        self.exponent = exponent;
        self
    }

    /// Sets the least area of a [guided](Self::guided) tip as a share of the mean area per tip, in [0, 1];
    /// 0.1 by default, our choice: tips that no sample is nearest to are there all the same. 0 leaves those
    /// without thickness; 1 lets only tips above the mean differ. The raised areas add to the total.
    pub fn with_minimum_share(mut self, share: f32) -> Self {
        self.minimum_share = share;
        self
    }

    /// Scales all radii so that the trunk base has this diameter, metres, finite and above 0. Not scaled by
    /// default.
    pub fn with_trunk_diameter(mut self, diameter: f32) -> Self {
        self.trunk_diameter = Some(diameter);
        self
    }

    /// The exponent a.
    pub fn exponent(&self) -> f32 {
        self.exponent
    }

    /// Area that each tip supports.
    pub fn support(&self) -> &Support {
        &self.support
    }

    /// The diameter of the trunk base, metres, if set.
    pub fn trunk_diameter(&self) -> Option<f32> {
        self.trunk_diameter
    }
}

impl RadiusModel for Variational {
    /// O(n), and O((t + s) log t) for s samples and t tips; the search is slower where tips share coordinates, on a
    /// plane some times, on one line up to O(t s).
    ///
    /// # Errors
    /// Options out of range, and [`RadiusError::NotFinite`] where the radii go beyond `f32`.
    fn radii(&self, skeleton: &Skeleton) -> Result<Vec<f32>, RadiusError> {
        self.check()?;
        // Areas over the largest of them, whose powers cannot overflow.
        let (flows, largest) = match &self.support {
            Support::Uniform { area } => (flows(skeleton, |_| 1.0), f64::from(*area)),
            Support::Samples { positions, total_area } => {
                let tips: Vec<usize> = skeleton.tips().collect();
                let mut shares = shares(skeleton.positions(), &tips, positions);
                let least = f64::from(self.minimum_share) / tips.len() as f64;
                for share in &mut shares {
                    *share = share.max(least);
                }
                let most = shares.iter().copied().fold(0.0, f64::max);
                let half = 0.5 * f64::from(self.exponent);
                // Both lists ascend by tip.
                let mut powers = shares.iter().map(|share| libm::pow(share / most, half));
                (flows(skeleton, |_| powers.next().unwrap_or(0.0)), most * f64::from(*total_area))
            }
        };
        let (flow, radius) = match self.trunk_diameter {
            None => (1.0, (largest / TAU).sqrt()),
            Some(diameter) => (flows[0], 0.5 * f64::from(diameter)),
        };
        bundle(skeleton, &flows, self.exponent, flow, radius)
    }

    fn check(&self) -> Result<(), ParameterError> {
        let area = |name, area: f32| {
            let holds = area > 0.0 && area.is_finite();
            ParameterError::unless(holds, name, area, "finite and above 0 square metres")
        };
        check_exponent("Variational.exponent", self.exponent)?;
        let share = self.minimum_share;
        ParameterError::unless(
            (0.0..=1.0).contains(&share),
            "Variational.minimum_share",
            share,
            "in [0, 1]",
        )?;
        if let Some(diameter) = self.trunk_diameter {
            check_diameter("Variational.trunk_diameter", diameter)?;
        }
        match &self.support {
            Support::Uniform { area: of_one } => area("Variational.area", *of_one),
            Support::Samples { positions, total_area } => {
                let least = "at least one sample";
                ParameterError::unless(!positions.is_empty(), "Variational.samples", positions, least)?;
                if let Some(sample) = positions.iter().find(|sample| !sample.is_finite()) {
                    ParameterError::unless(false, "Variational.samples", sample, "finite, metres")?;
                }
                area("Variational.total_area", *total_area)
            }
        }
    }
}

/// For each of `tips` the part of `samples` that is nearest to it; of tips equally near the first gets all.
fn shares(positions: &[Vec3], tips: &[usize], samples: &[Vec3]) -> Vec<f64> {
    // In f64, because squares of f32 may overflow; plus zero, to make -0 and 0 one place.
    let place = |p: Vec3| p.as_dvec3().to_array().map(|coordinate| coordinate + 0.0);
    // Only the first tip of each place goes into the search tree.
    let mut places: Vec<([f64; 3], usize)> =
        tips.iter().enumerate().map(|(i, &tip)| (place(positions[tip]), i)).collect();
    places.sort_by(|(a, i), (b, j)| {
        let by_place = a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne());
        by_place.unwrap_or_else(|| i.cmp(j))
    });
    places.dedup_by(|later, first| later.0.map(f64::to_bits) == first.0.map(f64::to_bits));
    places.sort_by_key(|&(_, i)| i);
    let points: Vec<[f64; 3]> = places.iter().map(|&(point, _)| point).collect();
    let tree = ImmutableKdTree::<f64, u32, 3, 32>::new_from_slice(&points);

    let mut counts = vec![0u64; tips.len()];
    for &sample in samples {
        let sample = place(sample);
        let nearest = tree.nearest_one::<SquaredEuclidean>(&sample);
        // The search tree may return any of several equally near tips first; the lowest is taken.
        let lowest = tree
            .best_n_within::<SquaredEuclidean>(&sample, nearest.distance, NonZero::<usize>::MIN)
            .next()
            .map_or(nearest.item, |best| best.item);
        counts[places[lowest as usize].1] += 1;
    }
    counts.into_iter().map(|count| count as f64 / samples.len() as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::super::pipe::tests::residual;
    use super::super::sample::{any_skeleton, chain, y_fork};
    use super::super::{PipeModel, check_radii};
    use super::*;
    use proptest::prelude::*;
    use std::error::Error;

    #[test]
    fn uniform_is_the_pipe_model_on_the_papers_diameter() -> Result<(), Box<dyn Error>> {
        let fork = y_fork()?;
        // A = 2π gives d = 2.
        let radii = Variational::uniform(std::f32::consts::TAU).with_exponent(2.0).radii(&fork)?;
        assert!((radii[2] - 1.0).abs() < 1e-6 && (radii[1] - 2.0_f32.sqrt()).abs() < 1e-6);
        let pipes = PipeModel::default().with_trunk_diameter(0.3).radii(&fork)?;
        assert_eq!(Variational::default().radii(&fork)?, pipes);
        assert_eq!(Variational::default().radii(&chain(1)?)?, [0.15]);
        Ok(())
    }

    #[test]
    fn samples_divide_the_area() -> Result<(), Box<dyn Error>> {
        let fork = y_fork()?;
        let left = Vec3::new(-3.0, 2.0, 0.0);
        let all_left = Variational::guided([left; 7], std::f32::consts::TAU);
        let radii = all_left.radii(&fork)?;
        assert!((radii[2] - 1.0).abs() < 1e-6, "all of the area");
        assert!((radii[3] - 0.05_f32.sqrt()).abs() < 1e-6, "a tenth of the mean, half of the whole");
        assert!(all_left.with_minimum_share(0.0).radii(&fork)?[3] <= 0.0);
        // A sample between the tips belongs to the first.
        let between = Variational::guided([Vec3::Y], 1.0).with_minimum_share(0.0).radii(&fork)?;
        assert!(between[2] > 0.0 && between[3] <= 0.0);
        // Distances whose squares f32 does not hold.
        let far = |x: f32| Vec3::X * (x * 1e38);
        let wide = Skeleton::new(vec![Vec3::ZERO, far(-1.0), far(1.0)], vec![None, Some(0), Some(0)])?;
        let radii = Variational::guided([far(-3.0), far(3.0), far(0.5)], 3.0).radii(&wide)?;
        assert!((radii[2] / radii[1] - 2.0_f32.sqrt()).abs() < 1e-6);
        Ok(())
    }

    #[test]
    fn bad_options_are_named() {
        let named = |model: &Variational| model.check().map_err(|error| error.parameter);
        let model = Variational::default();
        assert_eq!(named(&model), Ok(()));
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let refused = |name: &str| Err(format!("Variational.{name}"));
            assert_eq!(named(&Variational::uniform(bad)), refused("area"));
            assert_eq!(named(&Variational::guided([Vec3::ZERO], bad)), refused("total_area"));
            assert_eq!(named(&model.clone().with_exponent(bad)), refused("exponent"));
            assert_eq!(named(&model.clone().with_trunk_diameter(bad)), refused("trunk_diameter"));
            let samples = [Vec3::ZERO, Vec3::new(0.0, f32::NAN, bad)];
            assert_eq!(named(&Variational::guided(samples, 1.0)), refused("samples"));
        }
        assert_eq!(named(&Variational::guided([], 1.0)), Err("Variational.samples".into()));
        for bad in [-0.1, 1.1, f32::NAN] {
            let model = model.clone().with_minimum_share(bad);
            assert_eq!(named(&model), Err("Variational.minimum_share".into()));
        }
    }

    /// Tips with equal coordinates, and more of them than one leaf of the search tree holds.
    #[test]
    fn shares_are_exact_on_lattices() {
        for (flat, step) in [(1, 1), (1, 40), (40, 1), (7, 5)] {
            let tips: Vec<Vec3> = (0..280)
                .map(|i| Vec3::new((i % flat) as f32, ((i / flat) % step) as f32, (i % 3) as f32))
                .collect();
            let samples: Vec<Vec3> = (0..200)
                .map(|i| Vec3::new((i % 21) as f32 * 0.5, (i % 17) as f32 * 0.5, (i % 5) as f32 * 0.5))
                .collect();
            let indices: Vec<usize> = (0..tips.len()).collect();
            let mut want = vec![0.0; tips.len()];
            for &sample in &samples {
                let nearest = indices.iter().copied().min_by(|&a, &b| {
                    tips[a].distance_squared(sample).total_cmp(&tips[b].distance_squared(sample))
                });
                want[nearest.unwrap_or(0)] += 1.0 / 200.0;
            }
            for (tip, (share, want)) in shares(&tips, &indices, &samples).iter().zip(&want).enumerate() {
                assert!((share - want).abs() < 1e-9, "{flat} {step}: tip {tip}: {share} {want}");
            }
        }
    }

    proptest! {
        #[test]
        fn equation_2_holds(
            skeleton in any_skeleton(),
            samples in prop::collection::vec(prop::array::uniform3(-3.0f32..3.0), 1..80),
            exponent in 1.01f32..10.0,
            trunk in 0.01f32..3.0,
            share in 0.0f32..=1.0,
        ) {
            let samples: Vec<Vec3> = samples.into_iter().map(Vec3::from_array).collect();
            let model = Variational::guided(samples, 20.0).with_exponent(exponent).with_minimum_share(share);
            let radii = model.radii(&skeleton).unwrap();
            prop_assert_eq!(check_radii(&skeleton, &radii), Ok(()));
            prop_assert!(residual(&skeleton, &radii, exponent) < 1e-4);
            let radii = model.with_trunk_diameter(trunk).radii(&skeleton).unwrap();
            prop_assert!((2.0 * radii[0] - trunk).abs() <= 1e-5 * trunk);
        }
    }
}
