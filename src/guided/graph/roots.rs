//! Starting points of the trees of a graph.

use super::Leader;
use crate::parameter::ParameterError;
use glam::Vec3;

/// A leader for each root, the last one for all that follow; where they are themselves if no roots are named.
pub(super) fn place_leaders(leaders: &[Leader], roots: Option<&[Vec3]>) -> Vec<Leader> {
    let Some(roots) = roots else { return leaders.to_vec() };
    let of = |number: usize| leaders.get(number).or(leaders.last());
    roots.iter().enumerate().filter_map(|(number, &root)| Some(of(number)?.at(root))).collect()
}

/// 1 to 65,535 finite ones.
pub(super) fn check_roots(roots: &[Vec3], builder: &str) -> Result<(), ParameterError> {
    let count = roots.len();
    let fits = (1..=65_535).contains(&count);
    ParameterError::unless(fits, &format!("{builder}.roots"), count, "1 to 65535 roots")?;
    roots.iter().try_for_each(|root| {
        ParameterError::unless(root.is_finite(), &format!("{builder}.root"), root, "finite")
    })
}

/// No two roots nearer than the spacing at one of them. O(n log n) where they do not stand in one plane across x.
pub(super) fn check_apart(
    roots: &[Vec3],
    parameter: &str,
    spacing: impl Fn(Vec3) -> f32,
) -> Result<(), ParameterError> {
    let mut order: Vec<usize> = (0..roots.len()).collect();
    order.sort_by(|&a, &b| roots[a].x.total_cmp(&roots[b].x));
    let spacings: Vec<f32> = roots.iter().map(|&root| spacing(root)).collect();
    let widest = spacings.iter().copied().fold(0.0, f32::max);
    for (i, &a) in order.iter().enumerate() {
        let near = order[i + 1..].iter().take_while(|&&b| roots[b].x - roots[a].x < widest);
        for &b in near {
            let least = spacings[a].min(spacings[b]);
            if roots[a].distance(roots[b]) < least {
                let value = format_args!("{} (number {}) and {} (number {})", roots[a], a, roots[b], b);
                return Err(ParameterError::new(
                    parameter,
                    value,
                    format!("at least the spacing, {least} m, apart"),
                ));
            }
        }
    }
    Ok(())
}
