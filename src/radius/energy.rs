//! The cost of a branching structure: section 3.3, equations 5 and 6.

use crate::{ParameterError, Skeleton};

/// The intrinsic structure energy `F_I = Σ |p_i - p_j| d_j^β` over all internodes, from the skeleton's own
/// [radii](Skeleton::radii) (section 3.3, equations 5 and 6).
///
/// `beta` in [0, 6]: 2, the paper's choice, gives the wood's volume up to the factor π/4; 1 the surface up to π;
/// 0 the total length; 2n - 2 is proposed for forks into n. In `f64`, metres to the power of 1 + β; finite for
/// every skeleton. O(n).
///
/// ```
/// use treesynth::{Skeleton, glam::Vec3, radius::structure_energy};
///
/// let stem = Skeleton::new(vec![Vec3::ZERO, Vec3::Y * 3.0], vec![None, Some(0)])?.with_radii(vec![0.5, 0.25])?;
/// assert_eq!(structure_energy(&stem, 2.0)?, 3.0 * 0.5 * 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When `beta` is out of range.
pub fn structure_energy(skeleton: &Skeleton, beta: f32) -> Result<f64, ParameterError> {
    ParameterError::unless((0.0..=6.0).contains(&beta), "beta", beta, "in [0, 6]")?;
    let (positions, radii) = (skeleton.positions(), skeleton.radii());
    let cost = |(node, parent): (usize, usize)| {
        let length = positions[node].as_dvec3().distance(positions[parent].as_dvec3());
        length * libm::pow(2.0 * f64::from(radii[node]), f64::from(beta))
    };
    Ok(skeleton.edges().map(cost).sum())
}

#[cfg(test)]
mod tests {
    use super::super::sample::{chain, y_fork};
    use super::*;
    use glam::Vec3;
    use std::error::Error;

    #[test]
    fn y_fork_by_hand() -> Result<(), Box<dyn Error>> {
        let arm = 0.89_f64.sqrt();
        let fork = y_fork()?.with_radii(vec![0.5, 0.5, 0.25, 0.125])?;
        let close = |beta, want: f64| structure_energy(&fork, beta).map(|is| (is - want).abs() < 1e-6);
        assert!(close(0.0, 1.0 + 2.0 * arm)?);
        assert!(close(1.0, 1.0 + arm * 0.75)?);
        assert!(close(2.0, 1.0 + arm * (0.25 + 0.0625))?);
        Ok(())
    }

    #[test]
    fn edges_of_the_range() -> Result<(), Box<dyn Error>> {
        assert!(structure_energy(&chain(1)?, 2.0)?.abs() < 1e-12);
        let huge = Skeleton::new(vec![Vec3::splat(f32::MIN), Vec3::splat(f32::MAX)], vec![None, Some(0)])?
            .with_radii(vec![f32::MAX; 2])?;
        assert!(structure_energy(&huge, 6.0)?.is_finite());
        for beta in [-0.1, 6.1, f32::NAN, f32::INFINITY] {
            assert_eq!(structure_energy(&huge, beta).map_err(|error| error.parameter), Err("beta".into()));
        }
        Ok(())
    }
}
