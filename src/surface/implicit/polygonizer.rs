//! A closed mesh of any [`BlobTree`].

use super::{COVERING, FINEST, Finish, Voxels, polygonize};
use crate::ParameterError;
use crate::observer::{Observer, Silent, Work, report};
use crate::surface::blob::BlobTree;
use crate::surface::{Mesh, SurfaceError, far};

/// Default voxels per radius, unless all have one side.
const DETAIL: f32 = 8.0;

/// One closed mesh of a [`BlobTree`], with its colours.
///
/// Voxels are all of one side if a [voxel](Self::with_voxel) is asked for; with a [detail](Self::with_detail)
/// they are as fine as the features near them: a part of the radius of the primitives that are felt there,
/// finer still where parts press on each other, but never finer than the finest. The method and what it
/// guarantees are those of [`Implicit`](super::Implicit): every side of a triangle is one of exactly two,
/// around each vertex there is one fan, the same bits come at any number of threads. Creases are cut off by a
/// part of a voxel. Features thinner than a voxel may break into pieces or be missed; each piece is closed.
///
/// Time and memory grow with the voxels at the surface, times the primitives felt at one place.
///
/// ```
/// use treesynth::surface::{Polygonizer, blob};
///
/// let fork = blob::by_name("blob-07-04").expect("a preset").blob_tree()?;
/// let even = Polygonizer::default().with_voxel(0.005).mesh(&fork)?;
/// assert!(even.check().is_ok() && even.colors.len() == even.positions.len());
/// let fine_where_it_is_thin = Polygonizer::default().with_voxel(0.005).with_detail(1.0).mesh(&fork)?;
/// assert!(fine_where_it_is_thin.positions.len() < even.positions.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Polygonizer {
    voxel: Option<f32>,
    detail: Option<f32>,
    most_blocks: usize,
    colors: bool,
}

crate::recipe::readable!(Polygonizer {
    voxel: Option<f32>, detail: Option<f32>, most_blocks: usize, colors: bool,
});

impl Default for Polygonizer {
    /// Eight voxels per radius, the finest 1/1024 of the longest side of the solid's box; colours; at most
    /// two million blocks.
    fn default() -> Self {
        Self { voxel: None, detail: None, most_blocks: 2_000_000, colors: true }
    }
}

impl Polygonizer {
    /// The side of the voxels, or with a [detail](Self::with_detail) of the finest, metres, at least 1/32768 of the solid's reach, for 32-bit floats to tell
    /// triangles' corners apart; default 1/1024 of the longest side of the box around all that is felt, or that limit.
    pub fn with_voxel(mut self, side: f32) -> Self {
        self.voxel = Some(side);
        self
    }

    /// The least number of voxels per radius of the primitives felt at a place, 0.867 to 64: voxels are the
    /// finest one's side times the greatest power of two that allows it. Triangles are few where it is thick,
    /// and a ball loses 0.7% of its volume with 8 voxels per radius, 3% with 4, a quarter with 1. Default: 8,
    /// or voxels all of one side if a [voxel](Self::with_voxel) is asked for.
    pub fn with_detail(mut self, voxels: f32) -> Self {
        self.detail = Some(voxels);
        self
    }

    /// The greatest number of blocks of 4 · 4 · 4 voxels, 1 to 100 million; default two million. A block in which many primitives or
    /// operators are felt counts once more for every 32 of them.
    pub fn with_most_blocks(mut self, blocks: usize) -> Self {
        self.most_blocks = blocks;
        self
    }

    /// Fills [`Mesh::colors`], which are absolute: draw and write them with
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
        self.mesh_observed(tree, &Silent)
    }

    /// As [`mesh`](Self::mesh), reporting progress to `observer`, which can cancel the work.
    ///
    /// # Errors
    /// As [`mesh`](Self::mesh), and [`SurfaceError::Cancelled`].
    pub fn mesh_observed(&self, tree: &BlobTree, observer: &dyn Observer) -> Result<Mesh, SurfaceError> {
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
        let even = if self.voxel.is_some() { f32::INFINITY } else { DETAIL };
        let per_detail = self.detail.unwrap_or(even);
        let holds = self.detail.is_none_or(|detail| (COVERING..=64.0).contains(&detail));
        ParameterError::unless(holds, "Polygonizer.detail", per_detail, "0.867 to 64")?;
        let voxels = Voxels { side: voxel, per_detail, most_blocks: self.most_blocks };
        let finish = if self.colors { Finish::Colored } else { Finish::Plain };
        let mesh = far::back_closed(polygonize(tree, &voxels, finish, observer)?, offset)?;
        report(observer, Work::Surface, 1.0)?;
        Ok(mesh)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{euler, volume};
    use super::*;
    use crate::surface::blob::{BlobTreeBuilder, Primitive, Skin, by_name, presets};
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
    fn a_ball_has_its_volume_and_triangles_as_long_as_a_voxel() {
        for (middle, radius) in
            [(Vec3::ZERO, 1.0), (Vec3::new(0.3, -0.2, 0.1), 0.05), (Vec3::new(40.0, 0.0, 9_000.0), 20.0)]
        {
            let mut parts = BlobTreeBuilder::default();
            let ball = parts.add(Primitive::point(middle, radius)).expect("a ball");
            let ball = parts.finish(ball).expect("a solid");
            let right = f64::from(radius).powi(3) * std::f64::consts::PI * 4.0 / 3.0;
            let mut before = 0;
            for (share, off) in [
                (None, 0.01),
                (Some(0.2), 0.025),
                (Some(0.1), 0.007),
                (Some(0.05), 0.002),
                (Some(0.02), 0.001),
            ] {
                let surface = Polygonizer::default();
                let surface = share.map_or(surface.clone(), |share| surface.with_voxel(share * radius));
                let mesh = surface.mesh(&ball).expect("a surface");
                assert_eq!(euler(&mesh), Ok(2));
                let moved = Mesh {
                    positions: mesh.positions.iter().map(|&position| position - middle).collect(),
                    ..mesh
                };
                let volume = volume(&moved) / right;
                assert!((volume - 1.0).abs() < off, "voxel {share:?} r: volume times {volume}");
                if let Some(share) = share {
                    assert!(moved.positions.len() > 3 * before, "no finer than before");
                    before = moved.positions.len();
                    let side = (f64::from(moved.area()) / moved.triangles().len() as f64 * 2.3).sqrt();
                    let side = side / f64::from(share * radius);
                    assert!((0.5..1.3).contains(&side), "triangles are {side} voxels long");
                }
            }
        }
    }

    #[test]
    fn detail_follows_what_is_thin() {
        let tree = by_name("blob-07-04").expect("a preset").blob_tree().expect("sound");
        let count = |detail: f32| {
            let mesh = Polygonizer::default().with_voxel(0.002).with_detail(detail).mesh(&tree);
            mesh.expect("a surface").positions.len()
        };
        let even = Polygonizer::default().with_voxel(0.002).mesh(&tree).expect("a surface").positions.len();
        assert!(2 * count(1.0) < count(4.0) && count(4.0) < even);
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
        for bad in [0.0, -1.0, 0.8, 64.1, f32::NAN, f32::INFINITY] {
            let error = Polygonizer::default().with_detail(bad).mesh(&tree).expect_err("out of range");
            assert!(error.to_string().contains("Polygonizer.detail"), "{error}");
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
