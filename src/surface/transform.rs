//! Placement of a whole part, or a whole tree.

use super::Instance;
use crate::{ParameterError, math};
use glam::{Mat3, Quat, Vec3};

/// A place for a part or a tree: scaled, then turned, then moved.
///
/// ```
/// use treesynth::glam::Vec3;
/// use treesynth::surface::Transform;
///
/// let there = Transform { position: Vec3::X * 5.0, scale: 2.0, ..Transform::IDENTITY };
/// assert_eq!(there.point(Vec3::Y), Vec3::new(5.0, 2.0, 0.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    /// New position of the origin, metres.
    pub position: Vec3,
    /// Rotation; of length 1.
    pub rotation: Quat,
    /// Scale in all directions; positive.
    pub scale: f32,
}

impl Default for Transform {
    /// As [`IDENTITY`](Self::IDENTITY).
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Transform {
    /// Everything stays as it is.
    pub const IDENTITY: Self = Self { position: Vec3::ZERO, rotation: Quat::IDENTITY, scale: 1.0 };

    /// Moved only.
    pub fn at(position: Vec3) -> Self {
        Self { position, ..Self::IDENTITY }
    }

    /// `true` if everything stays as it is, to the bit.
    pub fn is_identity(&self) -> bool {
        *self == Self::IDENTITY
    }

    /// New position of a point.
    pub fn point(&self, point: Vec3) -> Vec3 {
        Mat3::from_quat(self.rotation) * self.scale * point + self.position
    }

    /// First `inner`, then this one. The same bits on every platform.
    #[must_use]
    pub fn after(&self, inner: &Self) -> Self {
        if inner.is_identity() {
            return *self;
        }
        if self.is_identity() {
            return *inner;
        }
        Self {
            position: self.point(inner.position),
            rotation: math::product(self.rotation, inner.rotation),
            scale: self.scale * inner.scale,
        }
    }

    /// A copy of a mesh, moved as well.
    pub fn instance(&self, copy: &Instance) -> Instance {
        let Self { position, rotation, scale } = self.after(&copy.transform());
        Instance { position, rotation, scale, ..*copy }
    }

    pub(crate) fn check(&self, name: &'static str) -> Result<(), ParameterError> {
        let [x, y, z, w] = self.rotation.to_array();
        let holds = self.position.is_finite()
            && self.scale > 0.0
            && self.scale.is_finite()
            && (x * x + y * y + z * z + w * w - 1.0).abs() <= 2e-3;
        let range = "a finite position, a rotation of length 1 and a positive scale";
        ParameterError::unless(holds, name, self, range)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_after_another() {
        let first = Transform {
            position: Vec3::new(1.0, 2.0, 3.0),
            rotation: Quat::from_rotation_x(0.7),
            scale: 0.5,
        };
        let then = Transform { position: Vec3::X, rotation: Quat::from_rotation_z(-1.2), scale: 3.0 };
        for point in [Vec3::ZERO, Vec3::X, Vec3::new(-3.0, 0.5, 9.0)] {
            assert!(then.after(&first).point(point).abs_diff_eq(then.point(first.point(point)), 1e-5));
        }
        assert_eq!(Transform::IDENTITY.after(&first), first);
        assert_eq!(first.after(&Transform::IDENTITY), first);
        let copy = Instance { node: 7, ..Instance::IDENTITY };
        let moved = then.instance(&copy);
        assert_eq!((moved.transform(), moved.node), (then, 7));
    }
}
