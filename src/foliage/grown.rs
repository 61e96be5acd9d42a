//! The leaves and buds of a tree that grows over the years: they know where they are.

use super::{Leaf, Leaves};
use crate::growth::TreeAtAge;
use crate::math;
use crate::surface::Instance;
use glam::{Mat3, Quat, Vec3};

impl Leaves {
    /// The leaves of a tree of [`growth`](crate::growth), all of this shape, one value for each of their
    /// colours, in the order in which colours first occur; none for a bare tree. The leaf's mesh is taken to
    /// be 1 long.
    ///
    /// ```
    /// use treesynth::foliage::{Leaf, Leaves};
    /// use treesynth::growth::{Growth, Architecture};
    ///
    /// let tree = Growth::new(Architecture::cottonwood(), 1)?;
    /// assert!(Leaves::grown(&tree.at(5.1)?, &Leaf::deltoid()).is_empty(), "it is winter");
    /// let summer = tree.at(5.6)?;
    /// let leaves = Leaves::grown(&summer, &Leaf::deltoid());
    /// assert_eq!(leaves.iter().map(|tone| tone.instances.len()).sum::<usize>(), summer.leaves.len());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn grown(tree: &TreeAtAge, leaf: &Leaf) -> Vec<Self> {
        let mut tones: Vec<([f32; 3], Self)> = Vec::new();
        for grown in &tree.leaves {
            let instance = Instance {
                position: grown.position,
                rotation: rotation(grown.midrib, grown.normal),
                scale: grown.length,
                node: grown.node,
                tint: [1.0; 3],
            };
            let known =
                tones.iter().position(|(color, _)| color.map(f32::to_bits) == grown.color.map(f32::to_bits));
            let tone = known.unwrap_or_else(|| {
                let leaf = leaf.clone().with_material(leaf.material().with_color(grown.color));
                tones.push((grown.color, Self { leaf, instances: Vec::new() }));
                tones.len() - 1
            });
            tones[tone].1.instances.push(instance);
        }
        tones.into_iter().map(|(_, leaves)| leaves).collect()
    }

    /// The buds of a tree of [`growth`](crate::growth): [`Leaf::bud`]s, or a mesh of your own.
    pub fn buds(tree: &TreeAtAge, bud: &Leaf) -> Self {
        let instances = tree.buds.iter().map(|grown| Instance {
            position: grown.position,
            rotation: rotation(grown.direction, math::perpendicular(grown.direction)),
            scale: grown.length,
            node: grown.node,
            tint: [1.0; 3],
        });
        Self { leaf: bud.clone(), instances: instances.collect() }
    }
}

/// Y to the midrib, Z to where the upper side looks.
fn rotation(midrib: Vec3, normal: Vec3) -> Quat {
    math::unit_rotation(Quat::from_mat3(&Mat3::from_cols(midrib.cross(normal), midrib, normal)))
}
