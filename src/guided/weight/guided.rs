//! The paper's weight, powers of it, and plain length.

use super::edge::LANES;
use super::{Edge, Star, WeightFn};
use crate::math::powf;
use crate::parameter::ParameterError;

/// The paper's weight, `d (1 - e·v)`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Guided;

impl WeightFn for Guided {
    #[inline]
    fn weight(&self, edge: &Edge<'_>) -> f32 {
        edge.guided()
    }

    /// Four edges at once, each as [`weight`](Self::weight) says, to the bit.
    fn weights(&self, star: &Star<'_>, weights: &mut [f32]) {
        let edges = weights.len();
        if edges == 0 {
            return;
        }
        if edges < LANES {
            for (weight, guided) in
                weights.iter_mut().zip(star.guided([0, 1, 2, 3].map(|i| i.min(edges - 1))))
            {
                *weight = guided;
            }
            return;
        }
        let mut first = 0;
        loop {
            let four = star.guided([0, 1, 2, 3].map(|i| first + i));
            weights[first..first + LANES].copy_from_slice(&four);
            if first + LANES == edges {
                return;
            }
            // The last four again where fewer are left.
            first = (first + LANES).min(edges - LANES);
        }
    }
}

/// `d^a (1 - e·v)^b`: a power of the paper's weight where a = b.
///
/// b above 1 forgives small deviations and punishes large ones; a above 1 prefers many short edges to few long.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct GuidedPower {
    length_exponent: f32,
    deviation_exponent: f32,
}

crate::recipe::readable!(GuidedPower { length_exponent: f32, deviation_exponent: f32 });

impl GuidedPower {
    /// Both exponents, in [0, 16]: a power of the whole weight.
    pub fn new(exponent: f32) -> Self {
        Self { length_exponent: exponent, deviation_exponent: exponent }
    }

    /// The exponent of the edge's length alone, in [0, 16].
    pub fn with_length_exponent(mut self, exponent: f32) -> Self {
        self.length_exponent = exponent;
        self
    }

    /// The exponent of the deviation from the guiding vector alone, in [0, 16].
    pub fn with_deviation_exponent(mut self, exponent: f32) -> Self {
        self.deviation_exponent = exponent;
        self
    }
}

impl WeightFn for GuidedPower {
    fn weight(&self, edge: &Edge<'_>) -> f32 {
        powf(edge.length, self.length_exponent) * powf(edge.deviation(), self.deviation_exponent)
    }

    fn check(&self) -> Result<(), ParameterError> {
        for (parameter, exponent) in [
            ("GuidedPower.length_exponent", self.length_exponent),
            ("GuidedPower.deviation_exponent", self.deviation_exponent),
        ] {
            ParameterError::unless((0.0..=16.0).contains(&exponent), parameter, exponent, "in [0, 16]")?;
        }
        Ok(())
    }
}

/// Plain length: paths without guiding vectors, "crooked" as on the left of figure 2.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Length;

impl WeightFn for Length {
    fn weight(&self, edge: &Edge<'_>) -> f32 {
        edge.length
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, unit};
    use glam::Vec3;

    /// [`Guided`] without what it does for several edges at once.
    struct OneByOne;

    impl WeightFn for OneByOne {
        fn weight(&self, edge: &Edge<'_>) -> f32 {
            edge.guided()
        }
    }

    #[test]
    fn edges_together_weigh_what_they_weigh_alone() {
        let draw = |i: u64, axis| unit(5, axis, Purpose::CUSTOM, i) - 0.5;
        let point = |i: u64| Vec3::new(draw(i, 0), draw(i, 1), draw(i, 2));
        for i in 0..2000 {
            let start = point(i * 10);
            let edge = Edge::new(start, start + Vec3::Y, point(i * 10 + 1));
            let ends: Vec<(u32, Vec3)> = (0..i % 9).map(|to| (to as u32, point(i * 10 + 2 + to))).collect();
            let star = Star {
                context: edge.context,
                from: 0,
                source: 0,
                start,
                vector: edge.vector,
                cost: 0.0,
                hops: 0,
                path_length: 0.0,
                stage: 0,
                seed: 0,
                ends: &ends,
            };
            let bits = |weight: &dyn WeightFn| -> Vec<u32> {
                let mut weights = vec![f32::NAN; ends.len()];
                weight.weights(&star, &mut weights);
                weights.into_iter().map(f32::to_bits).collect()
            };
            assert_eq!(bits(&Guided), bits(&OneByOne), "{} edges", ends.len());
        }
    }
}
