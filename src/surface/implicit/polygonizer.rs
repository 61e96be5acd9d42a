//! A closed mesh of any [`BlobTree`].

use super::{FINEST, Finish, polygonize};
use crate::ParameterError;
use crate::surface::blob::BlobTree;
use crate::surface::{Mesh, SurfaceError, far};

/// One closed mesh of a [`BlobTree`], with its colours.
///
/// Voxels are as fine as the features near them: a part of the radius of the primitives that are felt there, finer still
/// where parts press on each other, but never finer than the finest. The method and what it guarantees are those of
/// [`Implicit`](super::Implicit): every side of a triangle is one of exactly two, around each vertex there is one fan, the same
/// bits come at any number of threads. Creases are cut off by a part of a voxel. What is thinner than a voxel may break into
/// pieces or be missed, each piece closed.
///
/// Time and memory grow with the voxels at the surface, times the primitives felt at one place.
///
/// ```
/// use treesynth::surface::{Polygonizer, blob};
///
/// let fork = blob::by_name("blob-07-04").expect("a preset").blob_tree()?;
/// let mesh = Polygonizer::default().with_voxel(0.005).mesh(&fork)?;
/// assert!(mesh.check().is_ok() && mesh.colors.len() == mesh.positions.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Polygonizer {
    voxel: Option<f32>,
    most_blocks: usize,
    colors: bool,
}

crate::recipe::readable!(Polygonizer { voxel: Option<f32>, most_blocks: usize, colors: bool });

impl Default for Polygonizer {
    /// Finest voxels of 1/1024 of the longest side of the solid's box, colours, at most two million blocks.
    fn default() -> Self {
        Self { voxel: None, most_blocks: 2_000_000, colors: true }
    }
}

impl Polygonizer {
    /// The side of the finest voxels, metres, at least 1/32768 of the solid's reach, for 32-bit floats to tell
    /// triangles' corners apart; default 1/1024 of the longest side of the box around all that is felt, or that limit.
    pub fn with_voxel(mut self, side: f32) -> Self {
        self.voxel = Some(side);
        self
    }

    /// The greatest number of blocks of 4 · 4 · 4 voxels, 1 to 100 million; default two million.
    pub fn with_most_blocks(mut self, blocks: usize) -> Self {
        self.most_blocks = blocks;
        self
    }

    /// Whether [`Mesh::colors`] are filled, which are absolute: draw and write them with
    /// [`Material::white`](crate::surface::Material::white), as by
    /// [`GlbOptions::with_material`](crate::export::GlbOptions::with_material). Default true.
    pub fn with_colors(mut self, colors: bool) -> Self {
        self.colors = colors;
        self
    }

    /// The surface. With the feature `parallel`, on rayon's threads.
    ///
    /// # Errors
    /// An option out of its range; more blocks than were allowed, or more vertices than 32-bit indices can name; a solid so far
    /// out that floats cannot tell its vertices apart, [`SurfaceError::Shapeless`].
    pub fn mesh(&self, tree: &BlobTree) -> Result<Mesh, SurfaceError> {
        let offset = tree.origin();
        let tree = &tree.at_origin();
        let bounds = tree.bounds();
        let finest = bounds.min.abs().max(bounds.max.abs()).max_element() * FINEST;
        let voxel = self.voxel.unwrap_or((bounds.size().max_element() / 1024.0).max(finest));
        let range = format!("at least {finest} m, 1/32768 of the solid's reach, and finite");
        let holds = voxel >= finest && voxel > 0.0 && voxel.is_finite();
        ParameterError::unless(holds, "Polygonizer.voxel", voxel, &range)?;
        let holds = (1..=100_000_000).contains(&self.most_blocks);
        ParameterError::unless(holds, "Polygonizer.most_blocks", self.most_blocks, "1 to 100 million")?;
        let finish = if self.colors { Finish::Colored } else { Finish::Plain };
        far::back_closed(polygonize(tree, voxel, self.most_blocks, finish)?, offset)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::euler;
    use super::*;
    use crate::surface::blob::{Skin, by_name, presets};
    use crate::{Skeleton, math};
    use glam::Vec3;
    use proptest::prelude::*;

    #[test]
    fn every_preset_is_closed() {
        for preset in presets() {
            let tree = preset.blob_tree().expect("a preset");
            let voxel = tree.bounds().size().max_element() / 200.0;
            let mesh = Polygonizer::default().with_voxel(voxel).mesh(&tree).expect("a surface");
            assert_eq!(euler(&mesh).map(|e| e % 2), Ok(0));
            assert!(!mesh.is_empty());
            // The zero set is nearer than half a voxel: there are both signs around.
            let around: Vec<Vec3> = (0..27)
                .map(|i| Vec3::new((i % 3 - 1) as f32, (i / 3 % 3 - 1) as f32, (i / 9 - 1) as f32))
                .map(|way| way.normalize_or_zero() * (0.5 * voxel))
                .collect();
            for &position in &mesh.positions {
                let value = tree.value(position);
                let is_near = |way: &Vec3| tree.value(position + *way) * value <= 0.0;
                assert!(value.abs() < 1e-3 || around.iter().any(is_near), "{value} at {position}");
            }
        }
    }

    #[test]
    fn colors_are_the_solids() {
        let tree = by_name("blob-07-04").expect("a preset").blob_tree().expect("sound");
        let voxel = tree.bounds().size().max_element() / 100.0;
        let mesh = Polygonizer::default().with_voxel(voxel).mesh(&tree).expect("a surface");
        for (&position, color) in mesh.positions.iter().zip(&mesh.colors) {
            assert_eq!(tree.color(position).map(f32::to_bits), color.map(f32::to_bits));
        }
        let plain =
            Polygonizer::default().with_voxel(voxel).with_colors(false).mesh(&tree).expect("a surface");
        assert_eq!((plain.colors.len(), plain.positions), (0, mesh.positions));
    }

    #[test]
    fn faults_are_named() {
        let tree = by_name("blob-07-04").expect("a preset").blob_tree().expect("sound");
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-9] {
            let error = Polygonizer::default().with_voxel(bad).mesh(&tree).expect_err("out of range");
            assert!(error.to_string().contains("Polygonizer.voxel"), "{error}");
        }
        let error = Polygonizer::default().with_most_blocks(0).mesh(&tree).expect_err("out of range");
        assert!(error.to_string().contains("Polygonizer.most_blocks"), "{error}");
        assert!(matches!(
            Polygonizer::default().with_most_blocks(5).mesh(&tree),
            Err(SurfaceError::TooManyBlocks { most: 5, .. })
        ));
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 30, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn skins_are_closed(radius in 0.01f32..0.1, angle in 0.3f32..2.8, age in 1.0f32..12.0) {
            let (sin, cos) = math::sin_cos(angle);
            let points = vec![Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0, Vec3::Y + Vec3::new(sin, cos, 0.0)];
            let skeleton = Skeleton::new(points, vec![None, Some(0), Some(1), Some(1)])
                .and_then(|s| s.with_radii(vec![0.1, 0.1, 0.1, radius]))
                .and_then(|s| s.with_stages(vec![0, 0, 1, 1]))
                .expect("sound");
            let tree = Skin::default().with_age(age).blob_tree(&skeleton).expect("a skin");
            let mesh = Polygonizer::default().with_voxel(radius / 4.0).mesh(&tree).expect("a surface");
            prop_assert!(euler(&mesh).map_err(TestCaseError::fail)? % 2 == 0);
        }
    }
}
