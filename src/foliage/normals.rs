//! Normals that make a crown look round.

use crate::ParameterError;
use crate::shape::Bounds;
use crate::surface::Mesh;
use glam::Vec3;

/// Steepness with which the bending sets in, as a leaf turns from edge-on to the crown's surface to lying in
/// it.
const ONSET: f32 = 4.0;

/// Bends the normals of a crown's merged leaves or cards outwards, so that light falls on the crown as on a round body and
/// not on each leaf for itself. `share` is 0 (nothing changes) to 1 (all the way); 0.5 suits most crowns.
///
/// Outwards is across the ellipsoid in the mesh's bounds. A leaf whose upper side looks into the crown is bent inwards, since
/// renderers turn the normals of the side that is seen from behind: so each side has the normal of where it looks to, and no
/// back is black. A leaf edge-on to the crown's surface keeps its normal. Tangents are kept at right angles. O(vertices).
///
/// Instances share one mesh and cannot be bent; merge them first, as by
/// [`Leaves::mesh_in_wind`](super::Leaves::mesh_in_wind).
///
/// ```
/// use treesynth::foliage::{Foliage, Leaf, bend_normals};
/// use treesynth::{presets, surface::Sway};
///
/// let tree = presets::by_name("figure-06b").unwrap().guided().unwrap().synth(1000).synthesize(1)?;
/// let mut leaves = Foliage::new(Leaf::ovate()).place(&tree, 1)?.mesh_in_wind(&Sway::of(&tree)?)?;
/// bend_normals(&mut leaves, 0.5)?;
/// leaves.check()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A share that is not 0 to 1.
pub fn bend_normals(mesh: &mut Mesh, share: f32) -> Result<(), ParameterError> {
    ParameterError::unless((0.0..=1.0).contains(&share), "bend_normals", share, "0 to 1")?;
    if let Some(bounds) = mesh.bounds() {
        bend_about(mesh, bounds, share);
    }
    Ok(())
}

/// The same by the ellipsoid in a box, `share` from 0 to 1.
pub(crate) fn bend_about(mesh: &mut Mesh, bounds: Bounds, share: f32) {
    if share <= 0.0 {
        return;
    }
    let size = bounds.size();
    // A flat crown counts as a little thick.
    let half = (0.5 * size).max(Vec3::splat(1e-3 * size.max_element().max(f32::MIN_POSITIVE)));
    let center = bounds.center();
    for (position, normal) in mesh.positions.iter().zip(&mut mesh.normals) {
        let outwards = ((*position - center) / half / half * half.min_element()).normalize_or_zero();
        let side = (ONSET * normal.dot(outwards)).clamp(-1.0, 1.0);
        *normal = normal.lerp(outwards * side, share * side.abs()).normalize_or(*normal);
    }
    for (tangent, &normal) in mesh.tangents.iter_mut().zip(&mesh.normals) {
        let across = tangent.truncate() - normal * normal.dot(tangent.truncate());
        *tangent = across.normalize_or(normal.any_orthonormal_vector()).extend(tangent.w);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_side_has_the_normal_of_where_it_looks_to() {
        let corners = |center: Vec3| [center, center + Vec3::X * 0.1, center + Vec3::Y * 0.1];
        let centers = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|way| [way * 3.0, way * -3.0]);
        let positions: Vec<Vec3> = centers.flat_map(corners).collect();
        let tilted = Vec3::new(0.6, 0.0, 0.8);
        let mut mesh = Mesh::new(positions, vec![tilted; 18], (0..18).collect());
        mesh.tangents = vec![Vec3::Y.extend(1.0); 18];
        let before = mesh.clone();
        bend_normals(&mut mesh, 0.0).expect("in range");
        assert_eq!(mesh, before);
        bend_normals(&mut mesh, 0.7).expect("in range");
        mesh.check().expect("sound");
        let center = mesh.bounds().expect("vertices").center();
        for (position, (now, was)) in mesh.positions.iter().zip(mesh.normals.iter().zip(&before.normals)) {
            let outwards = (*position - center).normalize_or_zero() * was.dot(*position - center).signum();
            assert!(
                now.dot(*was) >= 0.0 && now.dot(outwards) >= was.dot(outwards) - 0.1,
                "{position}: {now}"
            );
        }
        assert!(
            mesh.normals[0].x > 0.8 && mesh.normals[3].x > 0.8,
            "{} {}",
            mesh.normals[0],
            mesh.normals[3]
        );
        for wrong in [-0.1, 1.1, f32::NAN] {
            assert!(bend_normals(&mut mesh, wrong).is_err());
        }
        bend_normals(&mut Mesh::default(), 0.5).expect("nothing to do");
    }
}
