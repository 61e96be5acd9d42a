//! The measures that foresters take on the trunk.

use super::angle::length;
use super::height;
use crate::Skeleton;
use std::f64::consts::PI;

/// The height above the base at which foresters of most countries measure the diameter, metres.
pub const BREAST_HEIGHT: f64 = 1.3;

/// Diameter of the trunk, metres, where it first reaches `above` metres over its base: linear between nodes. The trunk is the
/// first of [`Skeleton::branches`]; its bark is in the radii.
///
/// `None` where the trunk does not reach so high, or for a height that is negative or not a number. O(n).
///
/// ```
/// use treesynth::{Skeleton, glam::Vec3, metrics::diameter_at};
///
/// let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y * 2.0], vec![None, Some(0)])?.with_radii(vec![0.2, 0.1])?;
/// assert!(diameter_at(&pole, 1.0).is_some_and(|diameter| (diameter - 0.3).abs() < 1e-6));
/// assert_eq!(diameter_at(&pole, 2.1), None);
/// # Ok::<(), treesynth::SkeletonError>(())
/// ```
pub fn diameter_at(skeleton: &Skeleton, above: f64) -> Option<f64> {
    let branches = skeleton.branches();
    let nodes = branches.iter().next()?.nodes().to_vec();
    let base = f64::from(skeleton.positions()[0].y);
    let at = |node: u32| {
        let node = node as usize;
        (f64::from(skeleton.positions()[node].y) - base, 2.0 * f64::from(skeleton.radii()[node]))
    };
    if above == 0.0 {
        return Some(at(0).1);
    }
    nodes.windows(2).find_map(|pair| {
        let ((low, below), (high, over)) = (at(pair[0]), at(pair[1]));
        (low < above && above <= high).then(|| below + (over - below) * (above - low) / (high - low))
    })
}

/// Volume of the trunk, cubic metres: a frustum of a cone for each internode of the first of [`Skeleton::branches`]. O(n).
pub fn stem_volume(skeleton: &Skeleton) -> f64 {
    let branches = skeleton.branches();
    let Some(trunk) = branches.iter().next() else { return 0.0 };
    let frustum = |pair: &[u32]| {
        let (a, b) = (pair[0] as usize, pair[1] as usize);
        let (low, high) = (f64::from(skeleton.radii()[a]), f64::from(skeleton.radii()[b]));
        PI / 3.0 * length(skeleton, a, b) * (low * low + low * high + high * high)
    };
    trunk.nodes().windows(2).map(frustum).sum()
}

/// The breast height form factor: the trunk's volume over that of a cylinder as thick as the trunk at 1.3 m and as high as the
/// tree. Forest trees have 0.4 to 0.55.
///
/// `None` for trees below 1.3 m and for trunks without a thickness. O(n).
pub fn form_factor(skeleton: &Skeleton) -> Option<f64> {
    let diameter = diameter_at(skeleton, BREAST_HEIGHT).filter(|&diameter| diameter > 0.0)?;
    let factor = stem_volume(skeleton) / (PI / 4.0 * diameter * diameter * height(skeleton));
    factor.is_finite().then_some(factor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A pole of `height` metres in parts of half a metre whose radius is that at its place, from 0 to 1.
    fn pole(height: f32, radius: impl Fn(f32) -> f32) -> Skeleton {
        let parts = (height * 2.0) as u32;
        let at = |i: u32| i as f32 / parts as f32;
        let positions = (0..=parts).map(|i| Vec3::Y * height * at(i)).collect();
        let parents = (0..=parts).map(|i| i.checked_sub(1)).collect();
        let radii = (0..=parts).map(|i| radius(at(i))).collect();
        Skeleton::new(positions, parents).and_then(|tree| tree.with_radii(radii)).expect("a pole")
    }

    #[test]
    fn a_cone_and_a_cylinder() {
        let cone = pole(13.0, |at| 0.2 * (1.0 - at));
        let diameter = diameter_at(&cone, BREAST_HEIGHT).expect("it is higher");
        assert!((diameter - 0.36).abs() < 1e-6, "{diameter}");
        assert!((stem_volume(&cone) - PI / 3.0 * 0.04 * 13.0).abs() < 1e-6);
        // A third of the cylinder on its base, measured where it has nine tenths of that diameter.
        assert!(form_factor(&cone).is_some_and(|factor| (factor - 1.0 / 3.0 / 0.81).abs() < 1e-6));
        assert!(form_factor(&pole(5.0, |_| 0.1)).is_some_and(|factor| (factor - 1.0).abs() < 1e-6));
    }

    #[test]
    fn what_is_not_there() {
        let low = pole(1.0, |_| 0.1);
        assert_eq!((diameter_at(&low, BREAST_HEIGHT), form_factor(&low)), (None, None));
        assert_eq!(form_factor(&pole(3.0, |_| 0.0)), None);
        for above in [f64::NAN, -1.0, f64::INFINITY] {
            assert_eq!(diameter_at(&low, above), None);
        }
        assert!(diameter_at(&low, 0.0).is_some_and(|diameter| (diameter - 0.2).abs() < 1e-7));
        // A trunk that hangs and comes back up: where it first reaches the height.
        let way = [[0.0, 0.0], [1.0, -1.0], [2.0, 2.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
        let bent = Skeleton::new(way.to_vec(), vec![None, Some(0), Some(1)]).expect("a chain");
        let bent = bent.with_radii(vec![0.3, 0.2, 0.1]).expect("radii");
        assert!(diameter_at(&bent, 0.5).is_some_and(|diameter| (diameter - 0.3).abs() < 1e-6));
    }
}
