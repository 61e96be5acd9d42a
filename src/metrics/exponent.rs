//! The exponent of the pipe model, read back from the radii.

use crate::Skeleton;
use crate::skeleton::Children;

/// Exponents above this count as infinite: the children are as thick as the parent, within what radii tell.
const LARGEST: f64 = 64.0;

/// For each fork, ascending, its node and the exponent a with which `d^a = Σ d_j^a` holds between it and its
/// children; `None` where there is none.
///
/// There is one, and only one, when at least two children have a radius above 0 and all are thinner than the
/// fork itself. If children are nearly as thick, such that a would be above 64, it is `None` too. Children
/// without thickness carry nothing and do not matter.
///
/// Newton's method on `ln Σ exp(a ln(d_j / d))`, which is convex and falls in a: from 0 on it approaches the zero
/// from one side only, and needs some five steps where bisection needs fifty. O(n).
pub fn fork_exponents(skeleton: &Skeleton) -> Vec<(usize, Option<f64>)> {
    let children = skeleton.children();
    let logs: Vec<f64> = skeleton.radii().iter().map(|&radius| libm::log(f64::from(radius))).collect();
    let forks = (0..skeleton.len()).filter(|&node| children.of(node).len() >= 2);
    forks.map(|node| (node, exponent_at(node, &children, &logs))).collect()
}

/// The lower median of [`fork_exponents`], where a fork without one counts as infinite when its children are too
/// thick for any, and does not count when they have no thickness.
///
/// `None` without forks that count, and when most are infinite, as with one radius everywhere. A skeleton with
/// radii of the [`PipeModel`](crate::radius::PipeModel) gives the model's exponent. Leonardo's rule is 2,
/// and the paper on variational synthesis takes 2 to 3 from measured trees. O(n log n).
///
/// ```
/// use treesynth::radius::{PipeModel, RadiusModel};
/// use treesynth::{Skeleton, glam::Vec3, metrics::pipe_exponent};
///
/// let fork = Skeleton::new(vec![Vec3::ZERO; 3], vec![None, Some(0), Some(0)])?;
/// assert_eq!(pipe_exponent(&fork), None);
/// let radii = PipeModel::default().with_exponent(2.2).radii(&fork)?;
/// let fork = fork.with_radii(radii)?;
/// assert!(pipe_exponent(&fork).is_some_and(|exponent| (exponent - 2.2).abs() < 1e-5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn pipe_exponent(skeleton: &Skeleton) -> Option<f64> {
    let children = skeleton.children();
    let radii = skeleton.radii();
    let counts =
        |node: usize| children.of(node).iter().filter(|&&child| radii[child as usize] > 0.0).count() >= 2;
    let mut exponents: Vec<f64> = fork_exponents(skeleton)
        .into_iter()
        .filter(|&(node, _)| counts(node))
        .map(|(_, exponent)| exponent.unwrap_or(f64::INFINITY))
        .collect();
    exponents.sort_by(f64::total_cmp);
    let median = *exponents.get(exponents.len().checked_sub(1)? / 2)?;
    median.is_finite().then_some(median)
}

/// Solves one fork, given the logarithms of all radii; negative infinity for no radius.
fn exponent_at(node: usize, children: &Children, logs: &[f64]) -> Option<f64> {
    let ratios = || {
        let all = children.of(node).iter().map(|&child| logs[child as usize]);
        all.filter(|log| log.is_finite()).map(|log| log - logs[node])
    };
    // NaN and infinities from a fork without radius fail this as well.
    if ratios().count() < 2 || !ratios().all(|ratio| ratio < 0.0 && ratio.is_finite()) {
        return None;
    }
    let mut exponent = 0.0;
    for _ in 0..200 {
        let (mut sum, mut slope) = (0.0, 0.0);
        for ratio in ratios() {
            let power = libm::exp(exponent * ratio);
            sum += power;
            slope += power * ratio;
        }
        let step = -sum * libm::log(sum) / slope;
        exponent += step;
        // NaN fails this, and so does every exponent out of range.
        if !(exponent > 0.0 && exponent <= LARGEST) {
            return None;
        }
        if step.abs() <= 1e-12 * exponent {
            break;
        }
    }
    Some(exponent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radius::sample::{any_skeleton, binary, chain, y_fork};
    use crate::radius::{PipeModel, RadiusModel};
    use proptest::prelude::*;
    use std::error::Error;

    fn fork_with(radii: [f32; 4]) -> Result<Option<f64>, Box<dyn Error>> {
        Ok(pipe_exponent(&y_fork()?.with_radii(radii.to_vec())?))
    }

    #[test]
    fn by_hand() -> Result<(), Box<dyn Error>> {
        // 5² = 3² + 4², and 6³ = 3³ + 4³ + 5³ where the fork has a third child.
        assert!(fork_with([5.0, 5.0, 3.0, 4.0])?.is_some_and(|a| (a - 2.0).abs() < 1e-9));
        let three = Skeleton::new(vec![glam::Vec3::ZERO; 4], vec![None, Some(0), Some(0), Some(0)])?;
        let three = three.with_radii(vec![6.0, 3.0, 4.0, 5.0])?;
        assert_eq!(fork_exponents(&three).len(), 1);
        assert!(pipe_exponent(&three).is_some_and(|a| (a - 3.0).abs() < 1e-9));
        assert!(fork_with([2.0, 2.0, 1.0, 1.0])?.is_some_and(|a| (a - 1.0).abs() < 1e-9));
        Ok(())
    }

    #[test]
    fn where_there_is_none() -> Result<(), Box<dyn Error>> {
        assert_eq!(pipe_exponent(&chain(5)?), None);
        for radii in [
            [0.0; 4],
            [1.0; 4],
            [1.0, 1.0, 2.0, 0.5],
            [1.0, 1.0, 0.5, 0.0],
            [0.0, 0.0, 1.0, 1.0],
            [1.0, 1.0, 0.999_999_94, 0.999_999_94],
            [f32::MAX, f32::MAX, f32::MAX, f32::from_bits(1)],
        ] {
            assert_eq!(fork_with(radii)?, None, "{radii:?}");
        }
        let steep = fork_with([f32::MAX, f32::MAX, f32::from_bits(1), f32::from_bits(1)])?;
        assert!(steep.is_some_and(|a| a > 0.0 && a < 0.01));
        Ok(())
    }

    #[test]
    fn wide_and_uneven_forks() -> Result<(), Box<dyn Error>> {
        let wide =
            Skeleton::new(vec![glam::Vec3::ZERO; 1001], (0..1001).map(|i| (i > 0).then_some(0)).collect())?;
        let radii = PipeModel::default().with_exponent(2.25).radii(&wide)?;
        assert!(pipe_exponent(&wide.with_radii(radii)?).is_some_and(|a| (a - 2.25).abs() < 1e-5));
        let tall = binary(16)?;
        let radii = PipeModel::default().with_exponent(3.0).radii(&tall)?;
        assert!(pipe_exponent(&tall.with_radii(radii)?).is_some_and(|a| (a - 3.0).abs() < 1e-5));
        Ok(())
    }

    proptest! {
        #[test]
        fn gives_the_models_exponent(skeleton in any_skeleton(), exponent in 1.1f32..8.0) {
            let radii = PipeModel::default().with_exponent(exponent).radii(&skeleton).unwrap();
            let skeleton = skeleton.with_radii(radii).unwrap();
            let forks = fork_exponents(&skeleton);
            prop_assert_eq!(pipe_exponent(&skeleton).is_some(), !forks.is_empty());
            if let Some(fitted) = pipe_exponent(&skeleton) {
                prop_assert!((fitted - f64::from(exponent)).abs() < 1e-3 * fitted);
            }
        }

        #[test]
        fn solves_the_equation(radii in prop::array::uniform3(0.001f32..1.0)) {
            let [a, b, c] = radii;
            let thickest = a.max(b).max(c) * 1.01;
            let tree = Skeleton::new(vec![glam::Vec3::ZERO; 4], vec![None, Some(0), Some(0), Some(0)]).unwrap();
            let tree = tree.with_radii(vec![thickest, a, b, c]).unwrap();
            if let Some(exponent) = pipe_exponent(&tree) {
                let sum: f64 = radii.iter().map(|&r| libm::pow(f64::from(r) / f64::from(thickest), exponent)).sum();
                prop_assert!((sum - 1.0).abs() < 1e-9);
            }
        }
    }
}
