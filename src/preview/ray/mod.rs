//! Pictures of implicit solids, cast ray by ray, without a mesh (section 5 of Galbraith, Mündermann and Wyvill 2004).

mod cast;
mod octree;
mod outline;
mod walk;

pub(super) use cast::{Cast, Hit, Look, Sunbeams, Sunlight};
pub(super) use walk::{Beam, Ray};

use super::{Picture, Preview, PreviewError};
use crate::surface::blob::BlobTree;
use crate::surface::solid::Solid;
use crate::surface::{Implicit, Part};
use crate::{Observer, ParameterError, Skeleton};
use glam::Vec3;
use octree::Octree;

/// The work that crowds of primitives may make for each sample of a picture, in values of 32 primitives: a sample takes about ten
/// values, so that a picture takes a hundred times as long as others at the most.
const MOST_WORK: usize = 1000;

/// Draws implicit surfaces as they are, without triangles: the same camera, sun, sky, ground and background as
/// [`Preview`], and meshes, such as leaves, in the same picture.
///
/// A ray for each sample of a pixel finds the first root of the field, in steps that the field's steepness allows, so
/// that no twig is stepped over; rays to points all over the sun make soft shadows. Where every other sample of a pixel shows one
/// smooth surface, the rest are not cast. The sky is darkened by all surface in a coarse grid, as in a preview.
///
/// An octree of the solid's parts is split where rays come, down to a pixel or the thickness of what is in a cube. So time and memory grow
/// with the pixels that show something, and hardly with the number of primitives: 768 by 768 pixels of a tree of 388,000
/// primitives take about 8 s on two threads. With the feature `parallel` on rayon's threads; the same pixels at any number of them.
/// Within a solid it is dark: a camera there sees black.
///
/// ```
/// use treesynth::preview::{Preview, RayCaster};
/// use treesynth::{Silent, Skeleton, glam::Vec3, surface::blob::Skin};
///
/// let pole = Skeleton::new(vec![Vec3::ZERO, Vec3::Y], vec![None, Some(0)])?.with_radii(vec![0.1, 0.05])?;
/// let caster = RayCaster::new(Preview::default().with_size(60, 80));
/// let picture = caster.draw(&Skin::default().blob_tree(&pole)?, &[], &Silent)?;
/// assert_eq!((picture.width(), picture.height()), (60, 80));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct RayCaster {
    preview: Preview,
    shadows: bool,
    most_cubes: usize,
}

crate::recipe::readable!(RayCaster { shadows: bool, most_cubes: usize });

impl Default for RayCaster {
    /// Of the default [`Preview`], with shadows, at most 20 million cubes.
    fn default() -> Self {
        Self::new(Preview::default())
    }
}

impl RayCaster {
    /// Of pictures as `preview` has them: its size, samples, camera, sun, background and ground. Its bark is not used.
    pub fn new(preview: Preview) -> Self {
        Self { preview, shadows: true, most_cubes: 20_000_000 }
    }

    /// Lets the solid cast shadows, on itself, on meshes and on the ground; default true.
    pub fn with_shadows(mut self, shadows: bool) -> Self {
        self.shadows = shadows;
        self
    }

    /// The greatest number of cubes that the surface may pass, 1 to a billion; default 20 million. One in which many primitives
    /// are felt counts once more for every 32 of them. A cube takes some 300 bytes; the tree above needs about 2 million.
    pub fn with_most_cubes(mut self, cubes: usize) -> Self {
        self.most_cubes = cubes;
        self
    }

    /// A picture of a `BlobTree`, and of meshes beside it.
    ///
    /// # Errors
    /// As of [`Preview::draw_parts`]; more cubes than were allowed; the observer's `Break`.
    pub fn draw(
        &self,
        tree: &BlobTree,
        parts: &[Part<'_>],
        observer: &dyn Observer,
    ) -> Result<Picture, PreviewError> {
        self.cast(tree, parts, observer)
    }

    /// A picture of a tree in one smooth skin, as [`Implicit`] has it without its voxels, and of meshes beside it.
    ///
    /// # Errors
    /// As of [`Implicit::mesh`] and [`Preview::draw_parts`]; more cubes than were allowed; the observer's `Break`.
    pub fn draw_implicit(
        &self,
        surface: &Implicit,
        skeleton: &Skeleton,
        parts: &[Part<'_>],
        observer: &dyn Observer,
    ) -> Result<Picture, PreviewError> {
        let field = surface.field_there(skeleton)?;
        self.cast(&&field, parts, observer)
    }

    /// A picture of any solid, and of meshes beside it.
    pub(crate) fn cast(
        &self,
        solid: &impl Solid,
        parts: &[Part<'_>],
        observer: &dyn Observer,
    ) -> Result<Picture, PreviewError> {
        self.check()?;
        self.preview.check()?;
        let bounds = solid.bounds();
        if bounds.is_empty() {
            return Err(PreviewError::EmptySolid);
        }
        if bounds.min.abs().max(bounds.max.abs()).max_element() > super::FARTHEST {
            return Err(PreviewError::TooFar { bounds });
        }
        let axes = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
        let directions = [&axes[..], &self.preview.directions()].concat();
        let stage = self.preview.stage(parts, &outline::outline(solid, &directions))?;
        let samples = self.preview.supersampling as usize;
        let rays = self.preview.width as usize * self.preview.height as usize * samples * samples;
        let most = [self.most_cubes, rays.saturating_mul(MOST_WORK)];
        let octree = Octree::with_work(solid, &stage.view, self.preview.supersampling, most);
        let picture = self.preview.paint(&stage, Some(&octree), self.shadows, observer)?;
        if octree.is_full() {
            return Err(PreviewError::TooManyCubes { most: self.most_cubes });
        }
        if octree.is_crowded() {
            return Err(PreviewError::Crowded);
        }
        Ok(picture)
    }

    fn check(&self) -> Result<(), ParameterError> {
        let holds = (1..=1_000_000_000).contains(&self.most_cubes);
        ParameterError::unless(holds, "RayCaster.most_cubes", self.most_cubes, "1 to 1,000,000,000")
    }
}

#[cfg(test)]
mod sample;
#[cfg(test)]
mod tests;
