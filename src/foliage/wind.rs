//! Leaves in the wind: each moves with its twig, and flutters.

use super::Leaves;
use crate::math::{self, sin_cos};
use crate::surface::{Air, Instance, Mesh, SurfaceError, Sway, Wind};
use glam::{Quat, Vec3};

/// Flutter of a leaf, as a share of the distance from its attachment.
const FLUTTER: f32 = 0.25;

/// Motion of a leaf in the wind: at its attachment it moves as its twig does there, and the whole leaf turns with the twig.
///
/// 80 bytes. A shader moves the leaf by what [`wind`](Self::wind) says, turns it by the sum of
/// `cross(axis, F)·angle` of the three [levels](Wind), and has it flutter by a quarter of the distance from where it is
/// attached.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LeafWind {
    /// Wind of the place where the leaf is attached.
    pub wind: Wind,
    /// Angles by which trunk, limb and twig turn there, radians at the strongest gust.
    pub angles: [f32; 3],
}

impl Leaves {
    /// Motion of each instance in the wind. O(leaves).
    ///
    /// # Panics
    /// When a leaf's node is not in the skeleton of the sway.
    pub fn wind(&self, sway: &Sway) -> Vec<LeafWind> {
        let of = |leaf: &Instance| LeafWind {
            wind: sway.wind(leaf.node, leaf.position),
            angles: sway.angles(leaf.node, leaf.position),
        };
        self.instances.iter().map(of).collect()
    }

    /// The leaves as the wind has moved and turned them; see [`Wind::blown`] for the time and the gust.
    /// Fluttering leaves are turned about their base here, while a shader may bend them. Without wind all
    /// leaves stay, to the bit. O(leaves).
    ///
    /// ```
    /// use treesynth::foliage::{Foliage, Leaf};
    /// use treesynth::{Skeleton, glam::Vec3, surface::Sway};
    ///
    /// let twig = Skeleton::new(vec![Vec3::ZERO, Vec3::Y * 0.3], vec![None, Some(0)])?.with_radii(vec![0.003; 2])?;
    /// let leaves = Foliage::new(Leaf::ovate()).place(&twig, 7)?;
    /// let blown = leaves.blown(&Sway::of(&twig)?, 1.5, Vec3::X);
    /// assert!(blown.instances[0].position.x > leaves.instances[0].position.x);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    /// When a leaf's node is not in the skeleton of the sway.
    #[must_use]
    pub fn blown(&self, sway: &Sway, time: f32, gust: Vec3) -> Self {
        let mut leaves = self.clone();
        let Some(air) = Air::new(time, gust) else { return leaves };
        for (leaf, moved) in leaves.instances.iter_mut().zip(self.wind(sway)) {
            let midrib = leaf.rotation_matrix().y_axis;
            let turn =
                moved.wind.turned(moved.angles, &air) + midrib.cross(air.flutter(leaf.position)) * FLUTTER;
            leaf.position += moved.wind.moved(leaf.position, &air);
            let angle = turn.length();
            if angle > 1e-9 {
                let (sin, cos) = sin_cos(0.5 * angle);
                let axis = turn * (sin / angle);
                let turned = math::product(Quat::from_xyzw(axis.x, axis.y, axis.z, cos), leaf.rotation);
                leaf.rotation = math::unit_rotation(turned);
            }
        }
        leaves
    }

    /// All leaves as one mesh that carries their [`Wind`], for what knows no instances; tints are in its colours. O(leaves)
    /// time, and the memory of all copies.
    ///
    /// # Errors
    /// More vertices than 32-bit indices can name.
    ///
    /// # Panics
    /// When a leaf's node is not in the skeleton of the sway.
    pub fn mesh_in_wind(&self, sway: &Sway) -> Result<Mesh, SurfaceError> {
        let one = self.leaf.mesh();
        let mut mesh = one.merged(&self.instances)?;
        mesh.wind.reserve(mesh.positions.len());
        for (leaf, corners) in
            self.instances.iter().zip(mesh.positions.chunks_exact(one.positions.len().max(1)))
        {
            for &position in corners {
                // A leaf is turned as a whole by the twig where it is attached.
                let wind = sway.carried(leaf.node, leaf.position, position);
                mesh.wind.push(Wind { flutter: FLUTTER * position.distance(leaf.position), ..wind });
            }
        }
        Ok(mesh)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::foliage::{Foliage, Leaf};
    use crate::presets;

    #[test]
    fn leaves_stay_on_their_twigs() {
        for name in ["figure-06c", "figure-17e", "fine-oak"] {
            let preset = presets::by_name(name).expect("a preset").guided().unwrap();
            let tree =
                preset.synth(4000).synthesize(preset.seed).expect("a tree").relaxed(0.5, 3).expect("sound");
            let leaves = Foliage::new(Leaf::ovate().with_petiole(0.3)).place(&tree, 1).expect("leaves");
            let sway = Sway::of(&tree).expect("radii");
            let mesh = leaves.mesh_in_wind(&sway).expect("few vertices");
            mesh.check_arrays().expect("sound");
            let each = leaves.leaf.mesh().positions.len();
            let base = leaves.leaf.mesh().positions.iter().position(|p| p.length() < 0.03).expect("a base");
            assert_eq!(leaves.blown(&sway, 3.0, Vec3::ZERO), leaves);
            for (time, gust) in [(0.0, Vec3::X), (2.3, Vec3::new(-0.6, 0.0, 0.8)), (5.1, Vec3::Z * 0.3)] {
                let blown = leaves.blown(&sway, time, gust);
                let moved = mesh.blown(time, gust);
                for (i, (leaf, before)) in blown.instances.iter().zip(&leaves.instances).enumerate() {
                    let twig = sway.wind(before.node, before.position).blown(before.position, time, gust);
                    assert!(leaf.position.distance(twig) < 1e-5, "{name}: the leaf comes off");
                    // In the mesh the vertex nearest to the twig goes with it too.
                    let vertex = i * each + base;
                    let off = moved.positions[vertex] - twig - (mesh.positions[vertex] - before.position);
                    assert!(off.length() < 0.05 * before.scale, "{name}: {off}");
                    // Instances and the mesh agree, as far as a turn is linear.
                    for (k, &local) in leaves.leaf.mesh().positions.iter().enumerate() {
                        let (one, other) =
                            (leaf.matrix() * local + leaf.position, moved.positions[i * each + k]);
                        assert!(one.distance(other) < 0.6 * leaf.scale, "{name}: {one} {other}");
                    }
                }
            }
        }
    }
}
