//! The measures that botanists take on leaves.

use super::Leaves;
use crate::Skeleton;
use crate::math;
use crate::metrics::projected_area;
use glam::Vec3;

impl Leaves {
    /// One-sided area of all leaves, square metres: that of the triangles of each, so that folded leaves
    /// count in full. O(leaves).
    pub fn area(&self) -> f64 {
        let squares = self.instances.iter().map(|leaf| f64::from(leaf.scale) * f64::from(leaf.scale));
        f64::from(self.leaf.mesh().area()) * squares.sum::<f64>()
    }

    /// Leaf area index: [`area`](Self::area) over the [ground below the crown](projected_area) of `skeleton`. `None` where that
    /// is 0.
    pub fn area_index(&self, skeleton: &Skeleton) -> Option<f64> {
        let ground = projected_area(skeleton);
        (ground > 0.0).then(|| self.area() / ground)
    }

    /// Inclination of each leaf from the horizontal, radians: 0 for a leaf that lies flat, whichever side is
    /// up, π/2 for one that hangs or stands. In the order of the instances.
    pub fn inclinations(&self) -> impl ExactSizeIterator<Item = f32> + '_ {
        self.instances.iter().map(|leaf| {
            let normal = leaf.rotation_matrix() * Vec3::Z;
            math::acos(normal.y.abs().min(1.0))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::foliage::Leaf;
    use crate::surface::{Instance, Mesh};
    use glam::{Quat, Vec2};
    use std::f32::consts::FRAC_PI_2;

    #[test]
    fn leaves_by_hand() {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::ONE.with_z(0.0), Vec3::Y];
        let square =
            Mesh::new(corners, vec![Vec3::Z; 4], vec![0, 1, 2, 0, 2, 3]).with_uvs(vec![Vec2::ZERO; 4]);
        let level = Instance { rotation: Quat::from_rotation_x(-FRAC_PI_2), ..Instance::IDENTITY };
        let instances = vec![Instance { scale: 2.0, ..Instance::IDENTITY }, level];
        let leaves = Leaves { leaf: Leaf::new(square), instances };
        assert!((leaves.area() - 5.0).abs() < 1e-6);
        let angles: Vec<f32> = leaves.inclinations().collect();
        assert!((angles[0] - FRAC_PI_2).abs() < 1e-6 && angles[1].abs() < 1e-3, "{angles:?}");
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Z];
        let ground = Skeleton::new(positions, vec![None, Some(0), Some(1)]).expect("a tree");
        assert!(leaves.area_index(&ground).is_some_and(|index| (index - 10.0).abs() < 1e-5));
        let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)]).expect("a pole");
        assert_eq!(leaves.area_index(&pole), None);
    }
}
